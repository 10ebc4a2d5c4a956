//! Signals that end the command: INT, TERM and HUP. Unfinished files are removed, then the process ends by the signal, so
//! that a shell sees it.

use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Whether a signal is to end a run that has an end of its own, and whether one came.
static HAS_END: AtomicBool = AtomicBool::new(false);
static ENDED: AtomicBool = AtomicBool::new(false);

/// From here on the first signal asks the run to end ([`is_asked_to_end`]); the next ends the process.
pub fn end_the_run() {
    HAS_END.store(true, Relaxed);
}

/// Whether a signal asked the run to end.
pub fn is_asked_to_end() -> bool {
    ENDED.load(Relaxed)
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
            if HAS_END.load(Relaxed) && !ENDED.swap(true, Relaxed) {
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
