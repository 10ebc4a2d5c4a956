//! Signals that end the command: INT, TERM and HUP. Unfinished files are removed, then the process ends by the signal, so
//! that a shell sees it.

#[cfg(not(target_family = "wasm"))]
pub use run::{end_the_run, is_asked_to_end};

/// The end of a run that goes on until it is asked to end.
#[cfg(not(target_family = "wasm"))]
mod run {
    use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

    /// Whether there is such a run, and whether it was asked to end.
    static RUNS: AtomicBool = AtomicBool::new(false);
    static ASKED: AtomicBool = AtomicBool::new(false);

    /// From here on the first signal asks the run to end ([`is_asked_to_end`]); the next ends the process.
    pub fn end_the_run() {
        RUNS.store(true, Relaxed);
    }

    /// Whether a signal asked the run to end.
    pub fn is_asked_to_end() -> bool {
        ASKED.load(Relaxed)
    }

    /// Asks a run to end; whether there is one that was not asked before.
    #[cfg(unix)]
    pub fn ask() -> bool {
        RUNS.load(Relaxed) && !ASKED.swap(true, Relaxed)
    }
}

/// Watches for the signals, but for those that the caller has the process ignore (`nohup`).
#[cfg(unix)]
pub fn watch() {
    use signal_hook::{
        consts::{SIGHUP, SIGINT, SIGTERM},
        iterator::Signals,
        low_level::emulate_default_handler,
    };

    let watched = [SIGINT, SIGTERM, SIGHUP];
    let ignored = ignored();
    let watched = watched
        .iter()
        .filter(|signal| ignored >> (*signal - 1) & 1 == 0);
    // Without them the signals do what they do by default.
    let Ok(mut signals) = Signals::new(watched) else {
        return;
    };
    std::thread::spawn(move || {
        for signal in signals.forever() {
            if run::ask() {
                continue;
            }
            undrift::io::write::remove_unfinished();
            let _ = emulate_default_handler(signal);
        }
    });
}

/// Signals that this process ignores, the first in the lowest bit; only Linux says so.
#[cfg(unix)]
fn ignored() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.map_or(0, |mask| u64::from_str_radix(mask.trim(), 16).unwrap_or(0))
}

/// This system has no such signals.
#[cfg(not(unix))]
pub fn watch() {}
