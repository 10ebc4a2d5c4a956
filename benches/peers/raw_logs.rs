//! What the programs that navigate the raw logs of `navigation.py` share: reading the logs, writing the
//! solution. `navigation.py` copies this file and `process.rs` beside the `main.rs` of a peer.

#[path = "process.rs"]
mod process;

pub use process::Failure;
use process::measured;
use std::{fs, path::Path};

/// Numbers of the files of the same names.
pub struct Logs {
    /// Rows of time [s], angular rate [rad/s], specific force [m/s²].
    pub imu: Vec<f64>,
    /// Rows of time [s], latitude, longitude [rad], height [m], velocity north, east, down [m/s].
    pub gnss: Vec<f64>,
    /// Time [s], latitude, longitude [rad], height [m], velocity [m/s], roll, pitch, yaw [rad].
    pub start: Vec<f64>,
    pub model: Model,
}

/// What a filter is told, all SI.
pub struct Model {
    /// White noise, random walk and turn-on of gyros and of accelerometers.
    pub gyro: f64,
    pub gyro_walk: f64,
    pub gyro_turn_on: f64,
    pub accel: f64,
    pub accel_walk: f64,
    pub accel_turn_on: f64,
    /// Standard deviations of fixes.
    pub position: f64,
    pub velocity: f64,
    /// Those of roll, pitch and yaw at the start.
    pub attitude: [f64; 3],
}

impl Model {
    fn new(numbers: &[f64]) -> Option<Self> {
        let (
            &[
                gyro,
                gyro_walk,
                gyro_turn_on,
                accel,
                accel_walk,
                accel_turn_on,
                position,
                velocity,
            ],
            rest,
        ) = numbers.split_first_chunk()?;
        Some(Self {
            gyro,
            gyro_walk,
            gyro_turn_on,
            accel,
            accel_walk,
            accel_turn_on,
            position,
            velocity,
            attitude: rest.try_into().ok()?,
        })
    }
}

/// Navigates the logs of the folder that the command line names as often as it says, leaves `WHO.f64` there
/// and prints the best CPU time and the memory. A solution has rows of time, latitude, longitude, height,
/// velocity, roll, pitch, yaw.
pub fn run(who: &str, navigate: fn(&Logs) -> Result<Vec<f64>, Failure>) -> Result<(), Failure> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().ok_or("give the folder of the logs")?;
    let repeats: usize = arguments.next().map_or(Ok(1), |text| text.parse())?;
    let folder = Path::new(&folder);
    let read = |name: &str| read(&folder.join(name));
    let logs = Logs {
        imu: read("imu.f64")?,
        gnss: read("gnss.f64")?,
        start: read("start.f64")?,
        model: Model::new(&read("model.f64")?).ok_or("the model has other numbers")?,
    };
    let (solution, taken) = measured(repeats, || navigate(&logs))?;
    let bytes: Vec<u8> = solution
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect();
    fs::write(folder.join(format!("{who}.f64")), bytes)?;
    println!("{{\"values\":[{}],{taken}}}", solution.len() / 10);
    Ok(())
}

/// Mean interval of the samples \[s\].
pub fn interval(imu: &[f64]) -> f64 {
    (imu[imu.len() - 7] - imu[0]) / (imu.len() / 7 - 1) as f64
}

fn read(path: &Path) -> Result<Vec<f64>, Failure> {
    let bytes = fs::read(path)?;
    let (numbers, _) = bytes.as_chunks::<8>();
    Ok(numbers
        .iter()
        .map(|bytes| f64::from_le_bytes(*bytes))
        .collect())
}
