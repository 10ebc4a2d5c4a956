//! A bar for what takes time: how far, how fast, how long still.
//!
//! The work counts in an atomic number; a thread beside it looks at the number and draws ([`drawn`]). It begins
//! after two seconds, on a terminal only, and never when quiet. WebAssembly has no threads: there the work writes its
//! progress itself, as lines that begin with a carriage return.

use std::{
    sync::{
        Arc, Mutex,
        atomic::{AtomicU64, Ordering::Relaxed},
    },
    time::{Duration, Instant},
};

/// Work shorter than this has no bar.
const PATIENCE: Duration = Duration::from_secs(2);
/// From one look at the number to the next.
const LOOK: Duration = Duration::from_millis(200);

/// What is counted, and how many there are; 0 where that is not known.
struct Stage {
    /// Such as "identified".
    name: String,
    /// Such as "axes", or "bytes".
    unit: &'static str,
    total: u64,
    since: Instant,
}

impl Stage {
    fn new(name: &str, total: u64, unit: &'static str) -> Self {
        Self {
            name: name.to_owned(),
            unit,
            total,
            since: Instant::now(),
        }
    }
}

/// A bar, as long as it lives.
pub struct Bar {
    done: Arc<AtomicU64>,
    stage: Arc<Mutex<Stage>>,
    #[cfg(not(target_family = "wasm"))]
    _watcher: Option<drawn::Watcher>,
}

impl Bar {
    /// A bar for `total` of something.
    pub fn new(name: &str, total: u64, unit: &'static str) -> Self {
        Self::watching(Arc::default(), name, total, unit)
    }

    /// A bar that is shown from the beginning, for work that is known to take long.
    pub fn at_once(name: &str, total: u64, unit: &'static str) -> Self {
        Self::after(LOOK, Arc::default(), name, total, unit)
    }

    /// A bar for a number that somebody else counts.
    pub fn watching(done: Arc<AtomicU64>, name: &str, total: u64, unit: &'static str) -> Self {
        Self::after(PATIENCE, done, name, total, unit)
    }

    #[cfg_attr(target_family = "wasm", expect(unused_variables))]
    fn after(
        patience: Duration,
        done: Arc<AtomicU64>,
        name: &str,
        total: u64,
        unit: &'static str,
    ) -> Self {
        let stage = Arc::new(Mutex::new(Stage::new(name, total, unit)));
        Self {
            #[cfg(not(target_family = "wasm"))]
            _watcher: drawn::Watcher::start(&done, &stage, patience),
            done,
            stage,
        }
    }

    /// Counts.
    pub fn add(&self, more: u64) {
        self.done.fetch_add(more, Relaxed);
        #[cfg(target_family = "wasm")]
        self.write();
    }

    /// A line of the progress, at most ten in a second.
    #[cfg(target_family = "wasm")]
    fn write(&self) {
        static BEFORE: Mutex<Option<Instant>> = Mutex::new(None);
        let (Ok(mut before), Ok(stage)) = (BEFORE.lock(), self.stage.lock()) else {
            return;
        };
        if before.is_none_or(|before| before.elapsed().as_millis() >= 100) {
            *before = Some(Instant::now());
            eprint!(
                "\r{}\n",
                text(&stage, self.done.load(Relaxed), stage.since.elapsed())
            );
        }
    }

    /// Goes on to another stage, if it is one.
    pub fn stage(&self, name: &str, total: u64, unit: &'static str) {
        if let Ok(mut stage) = self.stage.lock()
            && (stage.name != name || stage.total != total)
        {
            *stage = Stage::new(name, total, unit);
            self.done.store(0, Relaxed);
        }
    }
}

/// How far, how fast, how long still.
fn text(stage: &Stage, done: u64, elapsed: Duration) -> String {
    let Stage {
        name, unit, total, ..
    } = stage;
    let seconds = elapsed.as_secs_f64();
    if *total == 0 {
        return format!("{name}, {}", clock(seconds));
    }
    let share = (done as f64 / *total as f64).min(1.0);
    let rate = done as f64 / seconds;
    let left = if share > 0.0 {
        format!(", {} left", clock(seconds * (1.0 - share) / share))
    } else {
        String::new()
    };
    let (far, fast) = if *unit == "bytes" {
        (
            format!("{:.0} % of {:.1} MB", 100.0 * share, *total as f64 / 1e6),
            format!("{:.1} MB/s", rate / 1e6),
        )
    } else if *total > 10_000 {
        (
            format!("{:.0} %", 100.0 * share),
            format!("{rate:.0} {unit}/s"),
        )
    } else {
        (format!("{done} of {total} {unit}"), format!("{rate:.2}/s"))
    };
    format!("{name}: {far}, {fast}{left}")
}

/// Hours, minutes and seconds, as many as are needed.
fn clock(seconds: f64) -> String {
    let s = seconds.round() as u64;
    match (s / 3600, s / 60 % 60, s % 60) {
        (0, 0, s) => format!("{s} s"),
        (0, m, s) => format!("{m} min {s} s"),
        (h, m, _) => format!("{h} h {m} min"),
    }
}

/// The bar of a terminal.
#[cfg(not(target_family = "wasm"))]
mod drawn {
    use super::{Arc, AtomicU64, Duration, Instant, LOOK, Mutex, Relaxed, Stage, text};
    use crate::terminal;
    use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
    use std::{
        io::IsTerminal,
        sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel},
        thread::JoinHandle,
    };

    /// The thread that draws, as long as it lives.
    pub struct Watcher(Option<(Sender<()>, JoinHandle<()>)>);

    impl Watcher {
        pub fn start(
            done: &Arc<AtomicU64>,
            stage: &Arc<Mutex<Stage>>,
            patience: Duration,
        ) -> Option<Self> {
            let watched = std::io::stderr().is_terminal() && !terminal::is_quiet();
            watched.then(|| {
                let (stop, stopped) = channel();
                let (done, stage) = (done.clone(), stage.clone());
                let thread = std::thread::spawn(move || watch(&done, &stage, &stopped, patience));
                Self(Some((stop, thread)))
            })
        }
    }

    impl Drop for Watcher {
        fn drop(&mut self) {
            if let Some((stop, thread)) = self.0.take() {
                drop(stop);
                // It only draws: what went wrong there is no matter here.
                let _ = thread.join();
            }
        }
    }

    /// Draws until the bar is dropped.
    fn watch(
        done: &AtomicU64,
        stage: &Mutex<Stage>,
        stopped: &Receiver<()>,
        mut patience: Duration,
    ) {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        let mut before = 0;
        while stopped.recv_timeout(patience) == Err(RecvTimeoutError::Timeout) {
            patience = LOOK;
            let Ok(mut stage) = stage.lock() else { break };
            let done = done.load(Relaxed);
            // A number that fell is that of another pass.
            if done < before {
                stage.since = Instant::now();
            }
            before = done;
            let template = match stage.total {
                0 => "{wide_msg}",
                _ => "{bar:24} {wide_msg}",
            };
            if let Ok(style) = ProgressStyle::with_template(template) {
                bar.set_style(style.progress_chars("=> "));
            }
            bar.set_length(stage.total);
            bar.set_position(done.min(stage.total));
            bar.set_message(text(&stage, done, stage.since.elapsed()));
            // What is drawn first has all of it.
            if bar.is_hidden() {
                bar.set_draw_target(ProgressDrawTarget::stderr());
            }
        }
        bar.finish_and_clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(name: &str, unit: &'static str, total: u64, done: u64, seconds: u64) -> String {
        let stage = Stage::new(name, total, unit);
        text(&stage, done, Duration::from_secs(seconds))
    }

    #[test]
    fn how_far_how_fast_how_long_still() {
        assert_eq!(
            of("imu.csv.gz", "bytes", 40_000_000, 10_000_000, 5),
            "imu.csv.gz: 25 % of 40.0 MB, 2.0 MB/s, 15 s left"
        );
        assert_eq!(
            of("simulated", "runs", 100, 4, 8),
            "simulated: 4 of 100 runs, 0.50/s, 3 min 12 s left"
        );
        assert_eq!(
            of("navigated", "samples", 1_000_000, 250_000, 2700),
            "navigated: 25 %, 93 samples/s, 2 h 15 min left"
        );
        // No estimate of the remaining time before any work is done.
        assert_eq!(
            of("identified", "axes", 6, 0, 3),
            "identified: 0 of 6 axes, 0.00/s"
        );
        assert_eq!(of("imu.bag", "bytes", 0, 7, 65), "imu.bag, 1 min 5 s");
    }
}
