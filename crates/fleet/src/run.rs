//! Many jobs on the cores of one machine, their outcomes in a folder.

use super::{FleetOutcome, Job, Say, fingerprint, process};
use rayon::{ThreadPoolBuildError, ThreadPoolBuilder};
use std::{
    collections::HashSet,
    io,
    path::{Path, PathBuf},
    sync::{
        Mutex,
        atomic::{AtomicUsize, Ordering::Relaxed},
    },
};
use undrift_drive::drive::ConfigError;
use undrift_io::write::write_whole;

/// Why a fleet cannot be worked through. A log that fails is no reason.
#[derive(Debug, thiserror::Error)]
pub enum FleetError {
    /// A file cannot be written or read.
    #[error("{}: {error}", path.display())]
    File {
        /// The file or folder.
        path: PathBuf,
        /// Why.
        error: io::Error,
    },
    /// An outcome's file holds none.
    #[error(transparent)]
    Outcome(#[from] ConfigError),
    /// Outcomes are missing.
    #[error(
        "{missing} of {all} logs are not processed yet, first {first}; run without --gather, or run the remaining shards"
    )]
    Missing {
        /// How many.
        missing: usize,
        /// Of how many.
        all: usize,
        /// The first one's name.
        first: String,
    },
    /// There are no threads.
    #[error(transparent)]
    Threads(#[from] ThreadPoolBuildError),
}

impl FleetError {
    pub(super) fn file(path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_path_buf();
        |error| Self::File { path, error }
    }
}

/// How a fleet is worked through.
#[derive(Clone, Copy, Debug, Default)]
pub struct Options {
    /// Threads, and jobs at a time; 0 for as many as there are cores.
    pub threads: usize,
    /// Work out again what failed.
    pub retry_failed: bool,
    /// Only find out what is up to date.
    pub look_only: bool,
}

/// What was done.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Done {
    /// The fingerprint of each job, in the order of the jobs, each once.
    pub fingerprints: Vec<String>,
    /// Jobs that were worked out.
    pub processed: usize,
    /// Jobs that were up to date.
    pub skipped: usize,
    /// Outcomes that were there but damaged, so that their jobs were worked out again.
    pub damaged: usize,
    /// Jobs that are not worked out, if it was only looked.
    pub missing: usize,
    /// The first of them.
    pub first_missing: Option<String>,
}

/// The jobs of one of `of` shards, counted from 1: every `of`-th one.
pub fn shard(jobs: Vec<Job>, which: usize, of: usize) -> Vec<Job> {
    let mine = |place: &usize| place % of.max(1) + 1 == which;
    let places = jobs.into_iter().enumerate();
    places
        .filter(|(place, _)| mine(place))
        .map(|(_, job)| job)
        .collect()
}

/// As [`process()`], on so many threads; 0 for as many as there are cores.
///
/// # Errors
/// If there are no threads to be had.
pub fn process_on(job: &Job, threads: usize, say: Say) -> Result<FleetOutcome, FleetError> {
    let pool = ThreadPoolBuilder::new().num_threads(threads).build()?;
    Ok(pool.install(|| process(job, say)))
}

/// Where the outcome of a job with this fingerprint is kept.
pub fn job_path(folder: &Path, fingerprint: &str) -> PathBuf {
    folder.join("jobs").join(format!("{fingerprint}.json"))
}

/// Works all jobs out that are not up to date, and keeps each outcome in a file of its own under
/// [`job_path`], which appears whole: whatever ends this, a later run goes on. `done` is called after each job with its
/// outcome, `None` where it was up to date.
///
/// # Errors
/// If an outcome cannot be kept.
pub fn run(
    jobs: &[Job],
    folder: &Path,
    options: Options,
    say: Say,
    done: impl Fn(Option<&FleetOutcome>) + Sync,
) -> Result<Done, FleetError> {
    let outcomes = folder.join("jobs");
    std::fs::create_dir_all(&outcomes).map_err(FleetError::file(&outcomes))?;
    let pool = ThreadPoolBuilder::new()
        .num_threads(options.threads)
        .build()?;
    let threads = pool.current_num_threads();
    // A thread of the pool that waits for a part of its job would begin another one, and so on: memory
    // stays bounded because no more jobs are handed out than there are threads.
    let next = AtomicUsize::new(0);
    let seen = Mutex::new(HashSet::new());
    let results: Mutex<Vec<(usize, Result<JobDone, FleetError>)>> = Mutex::default();
    let work = || {
        while let Some((place, job)) = {
            let place = next.fetch_add(1, Relaxed);
            jobs.get(place).map(|job| (place, job))
        } {
            let step = pool.install(|| one(job, folder, options, say, &seen));
            // The outcome goes no further: memory does not grow with the number of jobs.
            let step = step.map(|(step, outcome)| {
                done(outcome.as_ref());
                step
            });
            let failed = step.is_err();
            if let Ok(mut results) = results.lock() {
                results.push((place, step));
            }
            if failed {
                next.store(jobs.len(), Relaxed);
            }
        }
    };
    std::thread::scope(|scope| {
        (0..threads.min(jobs.len())).for_each(|_| {
            scope.spawn(work);
        });
    });
    let mut results = results.into_inner().unwrap_or_default();
    results.sort_by_key(|(place, _)| *place);
    let mut done = Done::default();
    let mut counted = HashSet::new();
    for (place, step) in results {
        let step = step?;
        done.damaged += usize::from(step.damaged);
        match step.state {
            State::Processed => done.processed += 1,
            State::UpToDate => done.skipped += 1,
            State::Missing => {
                done.missing += 1;
                let name = jobs.get(place).map(|job| job.log.clone());
                done.first_missing = done.first_missing.or(name);
            }
            State::Twice => {}
        }
        if counted.insert(step.fingerprint.clone()) {
            done.fingerprints.push(step.fingerprint);
        }
    }
    Ok(done)
}

#[derive(Clone, Copy)]
enum State {
    Processed,
    UpToDate,
    Missing,
    /// Another job is the same.
    Twice,
}

struct JobDone {
    fingerprint: String,
    state: State,
    /// Whether an outcome was there that cannot be used.
    damaged: bool,
}

fn one(
    job: &Job,
    folder: &Path,
    options: Options,
    say: Say,
    seen: &Mutex<HashSet<String>>,
) -> Result<(JobDone, Option<FleetOutcome>), FleetError> {
    let fingerprint = fingerprint(job);
    let mut step = JobDone {
        fingerprint: fingerprint.clone(),
        state: State::Twice,
        damaged: false,
    };
    if seen
        .lock()
        .is_ok_and(|mut seen| !seen.insert(fingerprint.clone()))
    {
        return Ok((step, None));
    }
    let path = job_path(folder, &fingerprint);
    // A damaged outcome is that of a log that is not processed yet.
    let text = std::fs::read(&path).ok();
    let known = text.as_ref().and_then(|text| {
        let text = std::str::from_utf8(text).ok()?;
        FleetOutcome::from_json(text, "").ok()
    });
    step.damaged = text.is_some() && known.is_none();
    if known.is_some_and(|outcome| !(options.retry_failed && outcome.failed.is_some())) {
        step.state = State::UpToDate;
        return Ok((step, None));
    }
    if options.look_only {
        step.state = State::Missing;
        return Ok((step, None));
    }
    let outcome = process(job, say);
    write_whole(&path, outcome.to_json()).map_err(FleetError::file(&path))?;
    step.state = State::Processed;
    Ok((step, Some(outcome)))
}
