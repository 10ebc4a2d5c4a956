//! Gives the programs of benches/peers that navigate raw logs a pass of a drive instead: `FOLDER PASS MODEL OUT`. The same names as in
//! benches/peers/raw_logs.rs, whose place it takes. No standard deviations: those programs do not write any.

use std::{env, error::Error, fs, path::Path};

pub type Failure = Box<dyn Error>;

/// Numbers of the files of the same names.
pub struct Logs {
    pub imu: Vec<f64>,
    pub gnss: Vec<f64>,
    pub start: Vec<f64>,
    pub model: Model,
}

/// White noise, random walk, turn-on; standard deviations of fixes and of the attitude at the start, all SI.
pub struct Model {
    pub gyro: f64,
    pub gyro_walk: f64,
    pub gyro_turn_on: f64,
    pub accel: f64,
    pub accel_walk: f64,
    pub accel_turn_on: f64,
    pub position: f64,
    pub velocity: f64,
    pub attitude: [f64; 3],
}

pub fn run(_who: &str, navigate: fn(&Logs) -> Result<Vec<f64>, Failure>) -> Result<(), Failure> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [folder, pass, model, out] = &arguments[..] else {
        return Err("give the folder, pass, model and output".into());
    };
    let folder = Path::new(folder);
    let get = |name: &str| read(&folder.join(format!("{name}.f64")));
    let numbers: [f64; 11] = get(&format!("model-{model}"))?
        .try_into()
        .map_err(|_| "the model has other numbers")?;
    let [
        gyro,
        gyro_walk,
        gyro_turn_on,
        accel,
        accel_walk,
        accel_turn_on,
        position,
        velocity,
        roll,
        pitch,
        yaw,
    ] = numbers;
    let start = get("start")?;
    let fixes = get(&format!("pass{pass}"))?;
    let logs = Logs {
        imu: get("imu")?,
        // The programs take the first fix for that of the start.
        gnss: start[..7]
            .iter()
            .copied()
            .chain(
                fixes
                    .chunks_exact(13)
                    .filter(|row| row[0] > start[0])
                    .flat_map(|row| row[..7].to_vec()),
            )
            .collect(),
        start,
        model: Model {
            gyro,
            gyro_walk,
            gyro_turn_on,
            accel,
            accel_walk,
            accel_turn_on,
            position,
            velocity,
            attitude: [roll, pitch, yaw],
        },
    };
    let solution = navigate(&logs)?;
    let mut rows = solution.chunks_exact(10).peekable();
    let mut answers = Vec::new();
    for time in get(&format!("wanted{pass}"))? {
        while rows.next_if(|row| row[0] < time).is_some() {}
        let Some(row) = rows.peek() else { break };
        answers.extend_from_slice(&row[..7]);
        answers.extend([f64::NAN, f64::NAN, f64::NAN, row[9]]);
    }
    let bytes: Vec<u8> = answers
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect();
    Ok(fs::write(out, bytes)?)
}

/// Mean interval of the samples \[s\].
pub fn interval(imu: &[f64]) -> f64 {
    (imu[imu.len() - 7] - imu[0]) / (imu.len() / 7 - 1) as f64
}

fn read(path: &Path) -> Result<Vec<f64>, Failure> {
    let bytes = fs::read(path)?;
    let (numbers, _) = bytes.as_chunks::<8>();
    Ok(numbers.iter().map(|b| f64::from_le_bytes(*b)).collect())
}
