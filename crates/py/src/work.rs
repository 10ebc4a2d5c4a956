//! Long computations: without the interpreter's lock, on threads of this process, heeding Ctrl-C.

use crate::error::error;
use pyo3::{exceptions::PyKeyboardInterrupt, prelude::*};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::{
    panic::{AssertUnwindSafe, catch_unwind, resume_unwind},
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, AtomicU64, Ordering},
        mpsc::{self, RecvTimeoutError},
    },
    time::Duration,
};
use undrift::noise::interrupt::{self, Stopped};

/// How often signals are looked for and progress is reported.
const LISTEN: Duration = Duration::from_millis(50);

/// How much of a computation is done.
#[derive(Default)]
pub struct Progress {
    done: Arc<AtomicU64>,
    total: AtomicU64,
}

impl Progress {
    /// By a counter that the computation keeps.
    pub fn counted(done: &Arc<AtomicU64>) -> Self {
        Self {
            done: Arc::clone(done),
            total: AtomicU64::default(),
        }
    }

    /// How much there is to do, in units of its own; 0 where it is not known.
    pub fn set_total(&self, total: u64) {
        self.total.store(total, Ordering::Relaxed);
    }

    /// So much more is done.
    pub fn add(&self, done: u64) {
        self.done.fetch_add(done, Ordering::Relaxed);
    }

    fn seen(&self) -> (u64, u64) {
        let now = [&*self.done, &self.total].map(|of| of.load(Ordering::Relaxed));
        now.into()
    }
}

/// Threads that compute for one call at a time, and what stops them.
struct Team {
    pool: ThreadPool,
    stop: Arc<AtomicBool>,
}

/// The teams at rest, and the process that they belong to: threads do not survive a fork.
static RESTING: Mutex<(u32, Vec<Team>)> = Mutex::new((0, Vec::new()));

impl Team {
    /// A team at rest, or a new one. Taken and given back under the interpreter's lock, as a fork is made: a child never
    /// finds the list in use.
    fn take(_: Python<'_>) -> PyResult<Self> {
        let mut resting = RESTING.lock().unwrap_or_else(PoisonError::into_inner);
        let process = std::process::id();
        if resting.0 != process {
            // The parent's: dropping them would wait for threads that are not here.
            std::mem::forget(std::mem::take(&mut resting.1));
            resting.0 = process;
        }
        if let Some(team) = resting.1.pop() {
            return Ok(team);
        }
        let stop = Arc::new(AtomicBool::new(false));
        let heeded = Arc::clone(&stop);
        let pool = ThreadPoolBuilder::new()
            .thread_name(|k| format!("undrift-{k}"))
            .start_handler(move |_| interrupt::heed(Arc::clone(&heeded)))
            .build();
        let pool = pool.map_err(|problem| error(format!("no threads to compute on: {problem}")))?;
        Ok(Self { pool, stop })
    }

    fn give_back(self, _: Python<'_>) {
        self.stop.store(false, Ordering::Relaxed);
        let mut resting = RESTING.lock().unwrap_or_else(PoisonError::into_inner);
        if resting.0 == std::process::id() {
            resting.1.push(self);
        }
    }
}

/// Runs `work` on all cores, without the interpreter's lock.
///
/// # Errors
/// Ctrl-C, or another signal whose handler raises.
pub fn run<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    run_with(py, None, &Progress::default(), work)
}

/// As [`run`]; `report` is called with what is done and what there is to do by `progress`.
///
/// # Errors
/// As [`run`], and what `report` raises.
pub fn run_with<T: Send>(
    py: Python<'_>,
    report: Option<&Py<PyAny>>,
    progress: &Progress,
    work: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    let team = Team::take(py)?;
    let (done, raised) = py.detach(|| {
        let (send, receive) = mpsc::channel();
        team.pool.in_place_scope(|scope| {
            scope.spawn(|_| {
                let done = catch_unwind(AssertUnwindSafe(work));
                // The receiver waits for it.
                let _ = send.send(done);
            });
            let mut raised = None;
            let mut seen = (0, 0);
            loop {
                match receive.recv_timeout(LISTEN) {
                    Ok(done) => return (Some(done), raised),
                    Err(RecvTimeoutError::Disconnected) => return (None, raised),
                    Err(RecvTimeoutError::Timeout) if raised.is_some() => {}
                    Err(RecvTimeoutError::Timeout) => {
                        let listened = Python::attach(|py| {
                            py.check_signals()?;
                            report_progress(py, report, progress, &mut seen)
                        });
                        if let Err(problem) = listened {
                            team.stop.store(true, Ordering::Relaxed);
                            raised = Some(problem);
                        }
                    }
                }
            }
        })
    });
    team.give_back(py);
    if let Some(raised) = raised {
        return Err(raised);
    }
    match done {
        Some(Ok(done)) => {
            report_progress(py, report, progress, &mut (0, 0))?;
            Ok(done)
        }
        Some(Err(panic)) if !panic.is::<Stopped>() => resume_unwind(panic),
        _ => Err(PyKeyboardInterrupt::new_err(())),
    }
}

/// Reports progress where there is some since `seen`.
fn report_progress(
    py: Python<'_>,
    report: Option<&Py<PyAny>>,
    progress: &Progress,
    seen: &mut (u64, u64),
) -> PyResult<()> {
    let now = progress.seen();
    if let Some(report) = report
        && now != *seen
    {
        *seen = now;
        report.call1(py, now)?;
    }
    Ok(())
}
