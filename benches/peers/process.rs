//! What a task takes: the programs of the comparison with other packages and the examples of noise share this file by
//! its path. Linux only.

use std::{error::Error, fmt, fs, time::Duration};

/// Any error.
pub type Failure = Box<dyn Error>;

/// Of a task; its text is that of the fields in `process.py`.
pub struct Measured {
    /// CPU time of the best call, all threads [s].
    pub cpu_s: f64,
    /// Largest resident memory of the process [KiB].
    pub peak_kib: u64,
    /// The same before the first call [KiB].
    pub before_kib: u64,
}

impl fmt::Display for Measured {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let (cpu, peak, before) = (self.cpu_s, self.peak_kib, self.before_kib);
        write!(
            f,
            "\"cpu_s\":{cpu:?},\"peak_kib\":{peak},\"before_kib\":{before}"
        )
    }
}

/// Calls a task so many times, once at least: its last answer and what the best call took.
///
/// # Errors
/// Those of the task; a system without /proc.
pub fn measured<T>(
    repeats: usize,
    mut task: impl FnMut() -> Result<T, Failure>,
) -> Result<(T, Measured), Failure> {
    let before_kib = peak_kib()?;
    let mut timed = || {
        let start = cpu_seconds()?;
        let answer = task()?;
        Ok::<_, Failure>((answer, cpu_seconds()? - start))
    };
    let (mut answer, mut cpu_s) = timed()?;
    for _ in 1..repeats {
        let (again, took) = timed()?;
        (answer, cpu_s) = (again, cpu_s.min(took));
    }
    let peak_kib = peak_kib()?;
    let taken = Measured {
        cpu_s,
        peak_kib,
        before_kib,
    };
    Ok((answer, taken))
}

/// CPU time of all threads so far [s]. The kernel brings a thread's count up to date when it leaves
/// the core: hence the nap.
fn cpu_seconds() -> Result<f64, Failure> {
    std::thread::sleep(Duration::from_millis(2));
    let mut total = 0.0;
    for thread in fs::read_dir("/proc/self/task")? {
        let text = fs::read_to_string(thread?.path().join("schedstat"))?;
        let first = text.split_whitespace().next();
        total += first.ok_or("/proc has no CPU times")?.parse::<f64>()?;
    }
    Ok(total * 1e-9)
}

/// Largest resident memory of the process so far [KiB].
fn peak_kib() -> Result<u64, Failure> {
    let status = fs::read_to_string("/proc/self/status")?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let size = line.and_then(|rest| rest.split_whitespace().next());
    Ok(size.ok_or("/proc has no peak memory")?.parse()?)
}
