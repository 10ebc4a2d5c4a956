//! Signals that end the command: INT, TERM and HUP. Unfinished files are removed, then the process ends by the signal, so
//! that a shell sees it. A verb that can end early with what it has may ask to be told of the first INT instead.

use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

static ENDS_EARLY: AtomicBool = AtomicBool::new(false);
static ASKED: AtomicBool = AtomicBool::new(false);

/// From here on the first INT does not end the process but makes [`asked_to_end`] true.
pub fn end_early() {
    ENDS_EARLY.store(true, Relaxed);
}

/// Whether the first INT has come after [`end_early`].
pub fn asked_to_end() -> bool {
    ASKED.load(Relaxed)
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
            if signal == SIGINT && ENDS_EARLY.swap(false, Relaxed) {
                ASKED.store(true, Relaxed);
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
