//! The source paper's experiment: one sensor, identified from a static record, on several drives whose GNSS is cut.
//!
//! The sensor's random errors are those of a real ADIS16405 (demo/sensor.rs), simulated or played back from its
//! records. All models but one run on the same samples, from which the means over the rest before the drive are
//! removed, as is practised.

mod models;
mod paper;
mod pooled;
mod result;
mod sensor;

pub use paper::{Paper, SCALES, Track};
pub use pooled::{Estimate, Pooled};
pub use undrift_results::demo::{
    BOUND, PAPER, PAPER_EXACT, PRESET, RECOMMENDED, REST, UNCALIBRATED, WHITE,
};

use models::Model;
use sensor::Ride;
use undrift_base::parallel;
use undrift_drive::{
    identify::{self, Identified, RecordingError},
    outages::{self, ModelOutcome, Schedule, ScheduleError},
    record::Record,
    replay::{Outage, Settings},
};
use undrift_noise::{ModelError, identify::Options, model_file::AXES};
use undrift_simulate::{REST_BEFORE, SimulationError};

/// Sample rate, the nominal one of the real records \[Hz\].
pub const RATE_HZ: f64 = 100.0;
/// Length of the simulated static record \[s\].
pub const STATIC_DURATION: f64 = 1800.0;
/// Length of a drive \[s\].
pub const DURATION: f64 = 900.0;
/// Drives, unless another number is asked for.
pub const DRIVES: usize = 5;
const _: () = assert!(REST == REST_BEFORE);
/// Start of the first outage after the first fix \[s\]: by then heading is known from the turns of the drive.
pub const FIRST_CUT: f64 = 200.0;

/// Outages of one length, on a replay of their own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuts {
    /// \[s\]
    pub length: f64,
    /// From start to start \[s\].
    pub every: f64,
    /// In each drive.
    pub count: usize,
}

/// The outages of each drive; of 10 s as many as in the source paper.
pub const CUTS: [Cuts; 3] = [
    Cuts {
        length: 10.0,
        every: 45.0,
        count: 15,
    },
    Cuts {
        length: 30.0,
        every: 75.0,
        count: 9,
    },
    Cuts {
        length: 60.0,
        every: 110.0,
        count: 6,
    },
];

/// Where the sensor's errors come from.
#[derive(Clone, Debug, Default)]
pub enum Source {
    /// Drawn.
    #[default]
    Simulated,
    /// Real records of one sensor.
    Recorded {
        /// The static record that is identified.
        identified: Box<Record>,
        /// Another one, whose stretches are the errors on the drives.
        played: Box<Record>,
    },
}

/// What is run.
#[derive(Clone, Debug)]
pub struct Experiment {
    /// Seed of sensors, drives and receiver.
    pub seed: u64,
    /// Number of drives, at least one.
    pub drives: usize,
    /// Where the sensor's errors come from.
    pub source: Source,
    /// Whether the source paper's tables and figures are made too.
    pub paper: bool,
}

/// What was identified, and what each model made of the drives.
pub struct Demo {
    /// What was run.
    pub experiment: Experiment,
    /// The static record.
    pub record: Record,
    /// What was identified from it.
    pub identified: Identified,
    /// The models' names, with the axes of which a method has no model: there it is white noise.
    pub models: Vec<(&'static str, Vec<&'static str>)>,
    /// Truth of the first drive, ten rows a second, and its outages of each length.
    pub first: (Vec<undrift_nav::sample::TruthSample>, Vec<Vec<Outage>>),
    /// For each of [`CUTS`], model by model.
    pub lengths: Vec<Vec<Pooled>>,
    /// The source paper's tables and figures.
    pub paper: Option<Paper>,
}

/// Why there is no demo.
#[derive(Debug, thiserror::Error)]
pub enum DemoError {
    /// A model made no shaping filter.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// Nothing was simulated.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// The outages do not fit the drive.
    #[error(transparent)]
    Outages(#[from] ScheduleError),
    /// No axis could be identified.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// A record has not the six axes.
    #[error("{}: {axes} axes, where gyro_x to accel_z are needed", record.display())]
    Axes {
        /// The record.
        record: std::path::PathBuf,
        /// How many it has.
        axes: usize,
    },
    /// The record that is played back is too short.
    #[error(
        "{}: {seconds:.0} s, where {drives} x {DURATION:.0} s are needed: give a longer recording or fewer drives",
        record.display()
    )]
    TooShort {
        /// The record.
        record: std::path::PathBuf,
        /// Its length \[s\].
        seconds: f64,
        /// Number of drives.
        drives: usize,
    },
    /// No axis of the record has a model.
    #[error("{axis}: {error}")]
    Axis {
        /// Name of the axis.
        axis: &'static str,
        /// Why it has none.
        error: String,
    },
}

/// What takes time in a demo.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// The drives.
    Simulation,
    /// Identification, axis by axis.
    Identification,
    /// The noise models over the drives, sample by sample.
    Navigation,
}

/// Runs the experiment; `done` is called with the stage, how much more of it is done, and how much it is in all.
///
/// # Errors
/// [`DemoError`]: a record too short for the drives, an axis that could not be identified, a model that makes no filter.
pub fn run(
    mut experiment: Experiment,
    done: impl Fn(Stage, u64, u64) + Sync,
) -> Result<Demo, DemoError> {
    experiment.drives = experiment.drives.max(1);
    let drives = experiment.drives as u64;
    done(Stage::Simulation, 0, drives);
    let rides = sensor::rides(&experiment, &|| done(Stage::Simulation, 1, drives))?;
    let record = sensor::static_record(&experiment)?;
    let axes = AXES.len() as u64;
    done(Stage::Identification, 0, axes);
    let one_more = || done(Stage::Identification, 1, axes);
    let identified = identify::run(&record, &Options::at(RATE_HZ), one_more);
    let models = models::models(&experiment.source, &identified)?;

    let total = samples(models.len(), rides.len(), paper::replays(&experiment));
    let progress = |more| done(Stage::Navigation, more, total);
    progress(0);
    let runs: Vec<_> = (0..CUTS.len())
        .map(|length| ridden(&rides, length, &models, &progress))
        .collect();
    let lengths = runs.iter().map(|runs| pooled::pooled(&models, runs));
    let lengths = lengths.collect();
    let paper = match experiment.paper {
        true => Some(paper::paper(
            &rides,
            &models,
            &runs[0],
            &identified,
            &record,
            &progress,
        )?),
        false => None,
    };
    let first = rides.into_iter().next().map_or_else(Default::default, |r| {
        let truth = r.simulation.truth.into_iter().step_by(10).collect();
        (truth, r.cuts)
    });
    Ok(Demo {
        experiment,
        record,
        identified,
        models: models.into_iter().map(|m| (m.name, m.without)).collect(),
        first,
        lengths,
        paper,
    })
}

/// Samples of all replays: of each model on each drive with the outages of each length, and of some more.
fn samples(models: usize, drives: usize, more: usize) -> u64 {
    let replays = models * drives * CUTS.len() + more;
    replays as u64 * (DURATION * RATE_HZ) as u64
}

/// The outages of a drive.
fn cuts(of: &Cuts, first: f64, last: f64) -> Result<Vec<Outage>, ScheduleError> {
    let plan = Schedule::Every {
        start: FIRST_CUT,
        every: of.every,
        count: Some(of.count),
    };
    outages::schedule(&plan, of.length, first, last)
}

/// Every model through the outages of one length of all drives, on all cores: by model, then by drive.
fn ridden(
    rides: &[Ride],
    length: usize,
    models: &[Model],
    done: &(dyn Fn(u64) + Sync),
) -> Vec<Vec<ModelOutcome>> {
    let of_model = |model: &Model| {
        let outcomes = parallel::map(rides.len(), |drive| {
            let ride = &rides[drive];
            let settings = settings(ride, length, model);
            let named = [(model.name.to_owned(), settings)];
            let samples = ride.samples(model.samples);
            outages::run(samples, &ride.fixes, &ride.simulation.truth, &named, done)
        });
        outcomes.into_iter().flatten().collect()
    };
    parallel::map(models.len(), |k| of_model(&models[k]))
}

/// How a model navigates a drive.
fn settings(ride: &Ride, length: usize, model: &Model) -> Settings {
    Settings {
        lever_arm: sensor::LEVER_ARM.into(),
        outages: ride.cuts[length].clone(),
        ..Settings::new(model.filters)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn progress_is_of_all_samples() {
        // Three lengths, 900 s of 100 Hz.
        assert_eq!(samples(11, 5, 7), (11 * 5 * 3 + 7) * 90_000);
    }
}
