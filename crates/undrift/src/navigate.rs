//! One drive through the filter and into a file, streamed: memory does not grow with the log.

mod findings;
mod outputs;
mod recorder;
mod recording;
mod result;

pub use recording::Recording;

use crate::{
    align::Heading,
    consistency::Consistency,
    drive::{Drive, DriveError},
    findings::Log,
    mounting::{self, Mounting, MountingError},
    reference::{COMPONENTS, Errors, TruthCursor},
    replay::{Measurement, Observer, ReplayError, Settings, Summary, merge, replay},
    smooth::{self, History, Path as SmoothedPath},
};
use outputs::Outputs;
use recorder::{Readable, Recorder};
use std::path::Path;
use undrift_io::{
    ReadError,
    gnss::GnssReader,
    held::Held,
    imu::GapSummary,
    scalar::ScalarReader,
    skipped::Skipped,
    write::{SolutionFile, SolutionFormat, SolutionOptions, solution::SolutionRow},
};
use undrift_nav::{
    Vector3,
    attitude::to_rpy,
    covariance::{AXES, NAV},
    filter::Filter,
    mechanisation::NavState,
    sample::{GnssFix, Scalar},
};
use undrift_noise::BiasModel;

/// What came of it.
#[derive(Debug)]
pub struct Report {
    /// By how much the stated standard deviations of position and velocity should be multiplied, as far
    /// as the innovations tell; only where it matters.
    pub std_factors: [Option<f64>; 2],
    /// Counts, alignment, innovations.
    pub summary: Summary,
    /// Whether the solution is the smoothed one.
    pub smooth: bool,
    /// The mounting, where the drive asks for an estimate: the solution is that of the vehicle's axes.
    pub mounting: Option<Mounting>,
    /// Root-mean-square error over all samples that have a truth, and their number.
    pub rmse: Option<(Errors, u64)>,
    /// The filter's errors against its covariance once a second, where there is a truth; not for the
    /// smoothed solution.
    pub consistency: Consistency,
    /// First and last time of the truth as far as it was read [s], if there is a truth.
    pub truth_read: Option<(f64, f64)>,
    /// What was left out of the inertial log.
    pub imu_skipped: Skipped,
    /// What was left out of the GNSS log.
    pub gnss_skipped: Skipped,
    /// What was left out of the odometer's and the barometer's logs, and their gaps, where there are such.
    pub scalars: Vec<(Log, Skipped, GapSummary)>,
    /// What was left out of the truth.
    pub truth_skipped: Skipped,
    /// Gaps of the inertial log.
    pub gaps: GapSummary,
    /// Axes of the IMU that held a value for long.
    pub held: Vec<Held>,
    /// The run over time, where it was asked for.
    pub recording: Option<Box<Recording>>,
    /// The solution at every sample, where it was asked for.
    pub rows: Vec<SolutionRow>,
}

/// Why there is no solution.
#[derive(Debug, thiserror::Error)]
pub enum NavigateError {
    /// The drive cannot be set up.
    #[error(transparent)]
    Drive(#[from] DriveError),
    /// The replay stopped.
    #[error(transparent)]
    Replay(#[from] ReplayError),
    /// The mounting cannot be estimated.
    #[error(transparent)]
    Mounting(#[from] MountingError),
    /// No noise model is named.
    #[error("no noise model: name one with --model or with model = \"…\" in the drive file; presets: {}", undrift_noise::ImuModel::preset_names().join(", "))]
    NoModel,
}

impl From<ReadError> for NavigateError {
    fn from(e: ReadError) -> Self {
        Self::Drive(e.into())
    }
}

impl From<undrift_noise::ModelError> for NavigateError {
    fn from(e: undrift_noise::ModelError) -> Self {
        Self::Drive(e.into())
    }
}

/// Longest span between two nodes of the smoother [s].
pub const NODE_SPAN: f64 = 1.0;

/// The filter's settings for a drive under one bias model of its IMU; for a drive whose mounting is
/// to be estimated, [`mounting::resolve`] comes first, else the axes are the sensor's.
///
/// # Errors
/// [`NavigateError::NoModel`] for a drive without a model; a model that makes no filter of this kind; an
/// inertial log that cannot be read or is at another rate than stated.
pub fn settings(drive: &Drive, kind: BiasModel) -> Result<Settings, NavigateError> {
    let model = drive.model.as_ref().ok_or(NavigateError::NoModel)?;
    let mut align = drive.align.clone();
    if drive.estimate_mounting && align.heading == Heading::Course {
        // Axes that are not the vehicle's have no course.
        align.heading = Heading::Auto;
    }
    Ok(Settings {
        lever_arm: drive.lever_arm,
        gnss_use: drive.gnss_use,
        align,
        parameters: drive.parameters,
        constraints: drive.constraints.clone(),
        gating: drive.gating,
        adapt: drive.adapt,
        quality: drive.quality,
        ..Settings::new(model.shaping(kind, drive.sample_interval()?)?)
    })
}

/// What a drive is navigated for.
#[derive(Default)]
pub struct Wanted {
    /// Where the solution goes.
    pub files: Vec<SolutionFile>,
    /// The smoothed solution instead of the filter's.
    pub smooth: bool,
    /// The run over time in [`Report::recording`].
    pub recording: bool,
    /// The solution at every sample in [`Report::rows`]: 31 numbers each.
    pub rows: bool,
}

/// Navigates a drive; the solution at every sample goes to `output` as CSV, if there is one.
///
/// As [`navigate_for`], without a recording.
///
/// # Errors
/// As [`navigate_for`], or if `output` cannot be written.
pub fn navigate(
    drive: &Drive,
    kind: BiasModel,
    output: Option<&Path>,
    smooth: bool,
) -> Result<Report, NavigateError> {
    let create = |path| {
        SolutionFile::create(path, SolutionFormat::Csv, &SolutionOptions::default())
            .map_err(ReplayError::Write)
    };
    let wanted = Wanted {
        files: output.map(create).transpose()?.into_iter().collect(),
        smooth,
        ..Wanted::default()
    };
    navigate_for(drive, kind, wanted)
}

/// Navigates a drive for what is wanted of it. The files get their names if all went well.
///
/// With `smooth`, the solution written and compared is the smoothed one: the filter's nodes go to a
/// temporary file, and the log is read twice.
///
/// # Errors
/// As [`settings`]; a log that cannot be read or ends before the alignment; a mounting that cannot be
/// estimated; a file that cannot be written; a filter that cannot be built.
pub fn navigate_for(
    drive: &Drive,
    kind: BiasModel,
    wanted: Wanted,
) -> Result<Report, NavigateError> {
    let Wanted {
        files,
        smooth,
        recording,
        rows,
    } = wanted;
    let (drive, mounting) = mounting::resolve(drive)?;
    let mut settings = settings(&drive, kind)?;
    settings.nodes = smooth.then_some(NODE_SPAN);
    if smooth {
        settings.start = smooth::better_start(
            drive.open_imu()?,
            aiding(
                &mut drive.open_gnss()?,
                &mut drive.open_odometer()?,
                &mut drive.open_barometer()?,
            ),
            &settings,
        )?;
    }
    let mut imu = drive.open_imu()?;
    let mut gnss = drive.open_gnss()?;
    let mut odometer = drive.open_odometer()?;
    let mut barometer = drive.open_barometer()?;
    let mut recorder = Recorder {
        outputs: Outputs::new(files),
        truth: drive.open_truth()?.map(|reader| {
            TruthCursor::new(Readable {
                reader,
                error: None,
                read: None,
            })
        }),
        squares: [0.0; COMPONENTS.len()],
        compared: 0,
        history: smooth
            .then(History::new)
            .transpose()
            .map_err(ReplayError::Write)?,
        consistency: Consistency::default(),
        next_nees: f64::NEG_INFINITY,
        recording: recording.then(Box::default),
        rows: rows.then(Vec::new),
    };
    let measurements = aiding(&mut gnss, &mut odometer, &mut barometer);
    let replayed = replay(&mut imu, measurements, &settings, &mut recorder);
    let summary = replayed.map_err(|error| match error {
        // What was left out is often why.
        ReplayError::NotAligned(mut why) => {
            why.skipped = vec![
                (Log::Imu, imu.skipped().clone()),
                (Log::Gnss, gnss.skipped().clone()),
            ];
            ReplayError::NotAligned(why)
        }
        other => other,
    })?;
    recorder.outputs.fixes_end();
    if let Some(smoothed) = recorder
        .history
        .take()
        .map(History::smooth)
        .transpose()
        .map_err(ReplayError::Write)?
        .flatten()
        && let Some(mut path) = SmoothedPath::new(&smoothed)
    {
        for sample in drive.open_imu()? {
            path.add(&sample?, |node| {
                let (error, std) = (node.sensor_error, node.sensor_error_std);
                recorder
                    .record(&node.nav, node.nav_std, error, std)
                    .map(drop)
            })?;
        }
    }
    let mut truth_skipped = Skipped::default();
    let mut truth_read = None;
    if let Some(cursor) = recorder.truth {
        let Readable {
            reader,
            error,
            read,
        } = cursor.into_inner();
        if let Some(error) = error {
            return Err(error.into());
        }
        truth_skipped = reader.skipped().clone();
        truth_read = read;
    }
    // Last: with an error there is no file.
    recorder.outputs.finish().map_err(ReplayError::Write)?;
    let n = recorder.compared;
    Ok(Report {
        std_factors: std_factors(&drive, &settings, &summary)?,
        summary,
        smooth,
        mounting,
        rmse: (n > 0).then(|| (Errors(recorder.squares.map(|s| (s / n as f64).sqrt())), n)),
        consistency: recorder.consistency,
        recording: recorder.recording,
        rows: recorder.rows.unwrap_or_default(),
        truth_read,
        imu_skipped: imu.skipped().clone(),
        gnss_skipped: gnss.skipped().clone(),
        truth_skipped,
        gaps: imu.gaps(),
        held: imu.held(),
        scalars: [(Log::Odometer, odometer), (Log::Barometer, barometer)]
            .into_iter()
            .filter_map(|(log, reader)| {
                reader.map(|reader| (log, reader.skipped().clone(), reader.gaps()))
            })
            .collect(),
    })
}

/// The solution at an instant: state, standard deviations as of [`Filter::nav_std`], and sensor errors,
/// [`Filter::sensor_error`], with theirs.
pub fn solution_row(
    nav: &NavState,
    nav_std: [f64; NAV],
    e: [f64; AXES],
    error_std: [f64; AXES],
) -> SolutionRow {
    SolutionRow {
        time: nav.time,
        position: nav.position,
        v_n: nav.v_n,
        rpy: to_rpy(&nav.q_nb),
        nav_std,
        gyro_error: Vector3::new(e[0], e[1], e[2]),
        accel_error: Vector3::new(e[3], e[4], e[5]),
        error_std,
    }
}

/// Fixes, wheel speeds and heights in order of time.
fn aiding(
    gnss: &mut GnssReader,
    odometer: &mut Option<ScalarReader>,
    barometer: &mut Option<ScalarReader>,
) -> impl Iterator<Item = Result<Measurement, ReadError>> {
    merge(
        gnss.map(|fix| fix.map(Measurement::Gnss)),
        merge(
            scalars(odometer, Measurement::Odometer),
            scalars(barometer, Measurement::Barometer),
        ),
    )
}

/// The measurements of a log that may not be there.
pub fn scalars(
    reader: &mut Option<ScalarReader>,
    kind: fn(Scalar) -> Measurement,
) -> impl Iterator<Item = Result<Measurement, ReadError>> {
    let scalars = reader.iter_mut().flatten();
    scalars.map(move |scalar| scalar.map(kind))
}

/// NIS per degree of freedom outside of which the stated accuracy is looked into.
const PLAUSIBLE: std::ops::RangeInclusive<f64> = 0.6..=1.6;
/// Factors on a standard deviation that are worth a word lie outside of this.
const WORTH_A_WORD: std::ops::RangeInclusive<f64> = 0.75..=1.33;

/// By how much the stated standard deviations are wrong: what an adaptive run found. The innovations of
/// a run with wrong ones do not tell, because its predictions are as wrong; so where they look wrong the
/// log is read once more.
fn std_factors(
    drive: &Drive,
    settings: &Settings,
    summary: &Summary,
) -> Result<[Option<f64>; 2], NavigateError> {
    let plausible = [&summary.position, &summary.velocity]
        .iter()
        .all(|sums| sums.per_dof().is_none_or(|nis| PLAUSIBLE.contains(&nis)));
    let adapted = if settings.adapt {
        summary.adapted
    } else if plausible || summary.diverged.is_some() {
        return Ok([None; 2]);
    } else {
        let settings = Settings {
            adapt: true,
            ..settings.clone()
        };
        let (mut gnss, mut odometer, mut barometer) = (
            drive.open_gnss()?,
            drive.open_odometer()?,
            drive.open_barometer()?,
        );
        let measurements = aiding(&mut gnss, &mut odometer, &mut barometer);
        replay(drive.open_imu()?, measurements, &settings, &mut Nobody)?.adapted
    };
    Ok(adapted.map(|factor| factor.filter(|f| !WORTH_A_WORD.contains(f))))
}

/// Watches nothing.
struct Nobody;

impl Observer for Nobody {
    fn sample<const N: usize>(&mut self, _: &Filter<N>) -> Result<(), ReplayError> {
        Ok(())
    }

    fn fix<const N: usize>(&mut self, _: &Filter<N>, _: &GnssFix, _: bool) {}
}
