//! What the programs that navigate the raw logs of `navigation.py` share: reading the logs, writing the
//! solution, CPU time and memory. `navigation.py` copies this file beside the `main.rs` of a peer.

use std::{error::Error, fs, path::Path, time::Duration};

pub type Failure = Box<dyn Error>;

/// Numbers of the files of the same names.
pub struct Logs {
    /// Rows of time [s], angular rate [rad/s], specific force [m/s²].
    pub imu: Vec<f64>,
    /// Rows of time [s], latitude, longitude [rad], height [m], velocity north, east, down [m/s].
    pub gnss: Vec<f64>,
    /// Time [s], latitude, longitude [rad], height [m], velocity [m/s], roll, pitch, yaw [rad].
    pub start: Vec<f64>,
    /// White noise, random walk, turn-on of gyros and of accelerometers, standard deviations of position and
    /// velocity, then of roll, pitch, yaw at the start, all SI.
    pub model: Vec<f64>,
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
    let (imu, gnss) = (read("imu.f64")?, read("gnss.f64")?);
    let (start, model) = (read("start.f64")?, read("model.f64")?);
    let logs = Logs {
        imu,
        gnss,
        start,
        model,
    };
    let before = peak_kib()?;
    let mut fastest = f64::INFINITY;
    let mut solution = Vec::new();
    for _ in 0..repeats.max(1) {
        let since = cpu_seconds()?;
        solution = navigate(&logs)?;
        fastest = fastest.min(cpu_seconds()? - since);
    }
    let bytes: Vec<u8> = solution
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect();
    fs::write(folder.join(format!("{who}.f64")), bytes)?;
    println!(
        "{{\"values\":[{}],\"cpu_s\":{fastest:?},\"peak_kib\":{},\"before_kib\":{before}}}",
        solution.len() / 10,
        peak_kib()?
    );
    Ok(())
}

fn read(path: &Path) -> Result<Vec<f64>, Failure> {
    let bytes = fs::read(path)?;
    let (numbers, _) = bytes.as_chunks::<8>();
    Ok(numbers
        .iter()
        .map(|bytes| f64::from_le_bytes(*bytes))
        .collect())
}

/// CPU time so far [s], brought up to date by the nap.
fn cpu_seconds() -> Result<f64, Failure> {
    std::thread::sleep(Duration::from_millis(2));
    let text = fs::read_to_string("/proc/self/schedstat")?;
    let first = text.split_whitespace().next();
    Ok(first.ok_or("/proc has no CPU times")?.parse::<f64>()? * 1e-9)
}

/// Largest resident memory so far [KiB].
fn peak_kib() -> Result<u64, Failure> {
    let status = fs::read_to_string("/proc/self/status")?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let size = line.and_then(|rest| rest.split_whitespace().next());
    Ok(size.ok_or("/proc has no peak memory")?.parse()?)
}
