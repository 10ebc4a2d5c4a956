//! One drive through the filter and into a file, streamed: memory does not grow with the log.

mod clock;
mod findings;
mod hindsight;
mod outputs;
mod recorder;
mod recording;
mod result;
mod start;

pub use clock::{Clock, UnknownClock};
pub use hindsight::Hindsight;
pub use outputs::FRESH;
pub use recorder::{Rows, Wanted, solution_row};
pub use recording::Recording;
pub use start::{Started, start};

use crate::{
    align::{AlignSettings, Heading},
    consistency::Consistency,
    drive::{Drive, DriveError, SensorRead},
    engine::derived::with_velocities,
    findings::{Finding, Log},
    fixes::{self, FixStudy},
    hand_eye,
    mounting::{self, EstimateError, Mounting},
    reference::Errors,
    rejected::Rejected,
    replay::{Aid, Measurement, ReplayError, Settings, Summary, replay},
    settings::fix_errors::{Correlation, FixErrors, FromFixes},
    smooth,
    vehicle::Constraints,
};
use recorder::Recorder;
use undrift_io::{
    ReadError,
    axis_faults::AxisFaults,
    gnss::GnssSource,
    imu::{GapSummary, ThermalSummary},
    skipped::Skipped,
    write::solution::SolutionRow,
};
use undrift_nav::{
    Matrix3, Quaternion, Vector3,
    parameters::{Parameter, Parameters},
    sample::GnssFix,
};
use undrift_noise::{BiasModel, ImuModel};
use undrift_results::findings::PosesApart;

/// A navigated drive: the run's summary, what reading the logs showed, and what was asked for in [`Wanted`]. Its findings are values
/// ([`Report::findings`]), its result for other programs is [`Report::result`].
#[derive(Debug)]
pub struct Report {
    /// Factors by which the stated standard deviations of position and velocity should be multiplied [–], as far
    /// as the innovations show; `None` where they need no change.
    pub std_factors: [Option<f64>; 2],
    /// Counts, alignment and innovations of the run.
    pub summary: Summary,
    /// How much of the log the solution knows at each instant.
    pub hindsight: Hindsight,
    /// Clock of the solution's times.
    pub clock: Clock,
    /// What the fixes show of their own errors.
    pub study: Option<FixStudy>,
    /// Errors of the fixes beyond what they state, as all of them show.
    pub fix_errors: FixErrors,
    /// The mounting, where the drive asks for an estimate and it was found: the solution is that of the vehicle's axes, in a
    /// causal run from the first of [`Summary::mountings`] on.
    pub mounting: Option<Mounting>,
    /// Rotation matrix from the sensor's axes to the body's.
    pub rotation: Matrix3,
    /// Root-mean-square error over all samples that have a truth [m, m/s, deg], and their number.
    pub rmse: Option<(Errors, u64)>,
    /// The filter's errors against its covariance once a second, where there is a truth; not for the
    /// smoothed solution.
    pub consistency: Consistency,
    /// First and last time of the truth as far as it was read \[s\], if there is a truth.
    pub truth_read: Option<(f64, f64)>,
    /// Records of the inertial log that were skipped, and why.
    pub imu_skipped: Skipped,
    /// Records of the GNSS log that were skipped, and why.
    pub gnss_skipped: Skipped,
    /// Skipped records and gaps of each log of another sensor.
    pub sensors: Vec<SensorRead>,
    /// Records of the truth that were skipped, and why.
    pub truth_skipped: Skipped,
    /// Samples that were corrected for temperature, where the model knows its effect.
    pub thermal: Option<ThermalSummary>,
    /// Gaps of the inertial log: number and length.
    pub gaps: GapSummary,
    /// What the axes of the IMU show without any model, as values that a logger repeats.
    pub axis_faults: AxisFaults,
    /// Curves of the run over time, where [`Wanted::recording`] asks for them.
    pub recording: Option<Box<Recording>>,
    /// The solution at every sample, where [`Wanted::rows`] asks for it.
    pub rows: Vec<SolutionRow>,
    /// Fixes that were rejected, where [`Wanted::rejected`] asks for them.
    pub rejected: Rejected,
    /// Time of the first inertial sample \[s\].
    pub first_sample: Option<f64>,
    /// Noise model that the drive was navigated with.
    pub model: Option<ImuModel>,
    /// Rate of the samples \[Hz\], where it is a guess.
    pub guessed_rate: Option<f64>,
    /// What is wrong with the poses of a drive by poses.
    pub pose_faults: Vec<Finding>,
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
    Mounting(#[from] EstimateError),
    /// No noise model is named.
    #[error(
        "no noise model: specify one with --model or with model = \"…\" in the drive file; {}",
        undrift_noise::presets::LISTED
    )]
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

/// Longest span between two nodes of the smoother \[s\]; between nodes the solution is interpolated along the samples.
pub const NODE_SPAN: f64 = 1.0;

/// The filter's settings for a drive under one bias model of its IMU; for a drive whose mounting is to be estimated it is
/// found on the way, but where [`resolve_mounting`] came first.
///
/// # Errors
/// [`NavigateError::NoModel`] for a drive without a model; a model that makes no filter of this kind; an
/// inertial log that cannot be read or is at another rate than stated.
///
/// ```
/// # use undrift_drive as undrift;
/// use undrift::{BiasModel, Drive, ImuModel, navigate::settings, vehicle::Profile};
/// # use undrift_simulate::{GnssNoise, Trajectory, simulate};
/// # let log = simulate(&Trajectory::car(10.0, 1), 50.0, None, &GnssNoise::default(), 1)?;
/// let drive = Drive { model: ImuModel::preset("adis16465"), ..Drive::from_samples(&log.imu, &log.gnss) };
/// let settings = settings(&drive.with_vehicle(Profile::Car), BiasModel::Arma)?;
/// assert!(settings.constraints.non_holonomic.is_some() && (settings.sensors[0].interval - 0.02).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn settings(drive: &Drive, kind: BiasModel) -> Result<Settings, NavigateError> {
    let model = drive.model.as_ref().ok_or(NavigateError::NoModel)?;
    let stated = stated(drive);
    let fix_errors = fix_errors(drive);
    Ok(Settings {
        fix_errors,
        // A tracker's noise is stated, and its positions lie on no road.
        from_fixes: drive.poses.is_none().then_some(stated),
        marker: drive.poses.map(|poses| poses.marker),
        earth_rate: drive.poses.is_none_or(|poses| poses.earth_rate),
        rotation: drive.imu.1.rotation,
        find_mounting: drive.estimate_mounting,
        mounting_std: drive.mounting_std,
        lever_arm: drive.lever_arm,
        gnss_use: drive.gnss_use,
        align: drive.align.clone(),
        parameters: fix_errors.with_states(drive.parameters),
        accel_scale_error: match drive.parameters.prior(Parameter::AccelScale) {
            Some(_) => 0.0,
            None => drive.accel_scale_error,
        },
        constraints: drive.constraints.clone(),
        magnetometer: drive.magnetometer_known(),
        gating: drive.gating,
        adapt: drive.adapt,
        quality: drive.quality,
        vibration: drive.vibration,
        ..Settings::new(model.shaping(kind, drive.sample_interval()?)?)
    })
}

/// The errors of fixes or poses as the drive file states them.
pub(crate) fn fix_errors(drive: &Drive) -> FixErrors {
    let mut errors = FixErrors::default();
    if let (Some(_), Correlation::Given(given)) = (&drive.poses, drive.correlation) {
        // What bends a mount or drifts in a camera's map turns the poses as it moves them.
        errors.velocity_correlated = Some(given);
    }
    errors.under(&stated(drive))
}

/// What the fixes of a drive show of their own errors ([`fixes::study`]), under the drive's rule for kinds of solution; `None` where there are
/// too few.
///
/// # Errors
/// Those of the fixes.
pub fn study<E>(
    drive: &Drive,
    fixes: impl IntoIterator<Item = Result<GnssFix, E>>,
) -> Result<Option<FixStudy>, E> {
    if drive.poses.is_some() {
        return Ok(None);
    }
    let mut failed = None;
    let fixes = fixes.into_iter().map_while(|fix| match fix {
        Ok(fix) => Some(drive.quality.apply(&fix)),
        Err(error) => {
            failed = Some(error);
            None
        }
    });
    let study = fixes::study(fixes);
    failed.map_or(Ok(study), Err)
}

/// What a drive states of its fixes' errors: their correlation in time and the factors on their standard deviations.
pub fn stated(drive: &Drive) -> FromFixes {
    FromFixes {
        correlation: drive.correlation,
        factors: drive.std_factors,
    }
}

/// Errors of the fixes by a study of them and what is stated.
fn errors(study: Option<&FixStudy>, stated: &FromFixes, parameters: &Parameters) -> FixErrors {
    study.map_or_else(
        || FixErrors::default().under(stated),
        |study| study.errors(stated, parameters),
    )
}

/// Puts what all of the fixes show of their errors into `settings`, so that the filter uses it from the first fix on.
pub fn look_ahead(settings: &mut Settings, study: Option<&FixStudy>) {
    let Some(stated) = settings.from_fixes.take() else {
        return;
    };
    let errors = errors(study, &stated, &settings.parameters);
    settings.parameters = errors.with_states(settings.parameters);
    settings.fix_errors = errors;
}

/// The drive with its mounting estimated from its beginning, where it asks for that: from the first sample on its body axes
/// are the vehicle's. The logs are read once for it, twice where there is a lever arm, which is known in the vehicle's axes only. A
/// drive that does not ask for an estimate is returned as it is.
///
/// # Errors
/// As [`mounting::estimate`], or where the drive cannot be set up.
pub fn resolve_mounting(drive: &Drive) -> Result<(Drive, Option<Mounting>), NavigateError> {
    let mut resolved = drive.clone();
    if !drive.estimate_mounting {
        return Ok((resolved, None));
    }
    let mut found: Option<Mounting> = None;
    // The lever arm is known in vehicle axes only: without it first, then with it.
    let passes = if drive.lever_arm == Vector3::zeros() {
        1
    } else {
        2
    };
    let fixes = drive.open_gnss()?.collect::<Result<Vec<_>, _>>()?;
    let fixes = with_velocities(fixes);
    for _ in 0..passes {
        let mut settings = settings(drive, BiasModel::Arma)?;
        settings.find_mounting = false;
        settings.align = AlignSettings {
            heading: Heading::Auto,
            ..AlignSettings::default()
        };
        settings.parameters = Parameters::none();
        (settings.fix_errors, settings.from_fixes) = (FixErrors::default(), None);
        settings.constraints = Constraints::default();
        settings.lever_arm = found.map_or(Vector3::zeros(), |m| m.q_vb.inverse() * drive.lever_arm);
        let mut fixes = fixes.iter().map(|fix| Ok(Measurement::Gnss(*fix)));
        found = Some(mounting::estimate(
            &mut drive.open_imu()?,
            &mut fixes,
            &settings,
        )?);
    }
    resolved.estimate_mounting = false;
    if let Some(mounting) = &found {
        resolved.imu.1.rotation = mounting.matrix();
        resolved.mounting_std = mounting.std;
    }
    Ok((resolved, found))
}

/// Does [`resolve_mounting`] for a solution that may look ahead; a causal one finds the mounting on its way.
///
/// # Errors
/// As [`resolve_mounting`].
pub fn resolve_ahead(
    drive: &Drive,
    hindsight: Hindsight,
) -> Result<(Drive, Option<Mounting>), NavigateError> {
    match hindsight {
        Hindsight::Causal => Ok((drive.clone(), None)),
        Hindsight::LookAhead | Hindsight::Smooth => resolve_mounting(drive),
    }
}

/// Navigates a drive under one bias model for what is `wanted` of it. The files get their names if all went well.
///
/// Smoothed, the solution written and compared is the smoothed one: the filter's nodes go to a
/// temporary file, and the log is read twice.
///
/// ```
/// # use undrift_drive as undrift;
/// use undrift::{BiasModel, Drive, ImuModel, navigate::{Hindsight, NavigateError, Wanted}, navigate_drive};
/// # use undrift_simulate::{GnssNoise, Trajectory, simulate};
/// # let log = simulate(&Trajectory::car(150.0, 1), 50.0, None, &GnssNoise::default(), 1)?;
/// let drive = Drive {
///     model: ImuModel::preset("adis16465"),
///     ..Drive::from_samples(&log.imu, &log.gnss)
/// };
/// // Standard deviation of the yaw [rad] 10 s after the alignment: smoothed, it knows the turns to come.
/// let yaw_std = |hindsight| -> Result<f64, NavigateError> {
///     let wanted = Wanted { hindsight, rows: true, ..Wanted::default() };
///     Ok(navigate_drive(&drive, BiasModel::Arma, wanted)?.rows[500].nav_std[8])
/// };
/// assert!(yaw_std(Hindsight::Smooth)? < yaw_std(Hindsight::Causal)?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`settings`]; a log that cannot be read or ends before the alignment; a mounting that cannot be
/// estimated; a file that cannot be written; a filter that cannot be built.
pub fn navigate(drive: &Drive, kind: BiasModel, wanted: Wanted) -> Result<Report, NavigateError> {
    let (hindsight, clock) = (wanted.hindsight, wanted.clock);
    let (drive, mounting) = resolve_ahead(drive, hindsight)?;
    let smooth = hindsight == Hindsight::Smooth;
    let mut settings = settings(&drive, kind)?;
    let mut seen_ahead = None;
    if wanted.hindsight != Hindsight::Causal {
        seen_ahead = study(&drive, drive.open_gnss()?)?;
        look_ahead(&mut settings, seen_ahead.as_ref());
    }
    settings.nodes = smooth.then_some(NODE_SPAN);
    if smooth {
        settings.start = smooth::better_start(
            &mut drive.open_imu()?,
            &mut drive.open_aids()?.measurements(),
            &settings,
        )?;
        settings.doubts = smooth::doubts(
            &mut drive.open_imu()?,
            &mut drive.open_aids()?.measurements(),
            &settings,
        )?;
    }
    let mut imu = drive.open_imu()?;
    let mut aids = drive.open_aids()?;
    let mut recorder = Recorder::new(wanted, drive.open_truth()?)?;
    recorder.mounted = !settings.find_mounting;
    let mut first_sample = None;
    let mut samples = imu.by_ref().inspect(|sample| {
        if let Ok(sample) = sample {
            first_sample.get_or_insert(sample.time);
        }
    });
    let replayed = replay(
        &mut samples,
        &mut aids.measurements(),
        &settings,
        &mut recorder,
    );
    let summary = replayed.map_err(|error| match error {
        // What was left out is often why.
        ReplayError::NotAligned(mut why) => {
            why.skipped = vec![
                (Log::Imu, imu.skipped().clone()),
                (Log::Gnss, aids.gnss.skipped().clone()),
            ];
            ReplayError::NotAligned(why)
        }
        other => other,
    })?;
    recorder.smooth(&drive)?;
    let seen = recorder.finish()?;
    let mounting = mounting.or(summary.mountings.last().map(|(_, mounting)| *mounting));
    let study = seen_ahead.or(summary.study);
    let fix_errors = match settings.from_fixes {
        Some(stated) => errors(study.as_ref(), &stated, &settings.parameters),
        None => settings.fix_errors,
    };
    Ok(Report {
        // Poses state theirs, and `undrift tune` finds the factor beside the IMU's noise.
        std_factors: match drive.poses {
            Some(_) => [None; 2],
            None => std_factors(&drive, &settings, &summary)?,
        },
        hindsight,
        clock,
        study,
        fix_errors,
        summary,
        mounting,
        rotation: mounting.map_or(drive.imu.1.rotation, |mounting| mounting.matrix()),
        rmse: seen.rmse,
        consistency: seen.consistency,
        recording: seen.recording,
        rows: seen.rows,
        rejected: seen.rejected,
        first_sample,
        model: drive.model.clone(),
        guessed_rate: drive.guessed_rate,
        pose_faults: pose_faults(&drive)?,
        truth_read: seen.truth_read,
        imu_skipped: imu.skipped().clone(),
        gnss_skipped: aids.gnss.skipped().clone(),
        truth_skipped: seen.truth_skipped,
        thermal: imu.thermal(),
        gaps: imu.gaps(),
        axis_faults: imu.axis_faults(),
        sensors: aids.sensors_read(),
    })
}

/// What is wrong with the poses of a drive: all of them and of the samples are read. Nothing of a drive by fixes.
///
/// # Errors
/// A log that cannot be read.
pub fn pose_faults(drive: &Drive) -> Result<Vec<Finding>, NavigateError> {
    if drive.poses.is_none() {
        return Ok(Vec::new());
    }
    let samples = drive.open_imu()?.collect::<Result<Vec<_>, _>>()?;
    let poses = drive.open_gnss()?.collect::<Result<Vec<_>, _>>()?;
    let mended = drive.pose_faults.iter().map(|fault| {
        Finding::Poses(PosesApart {
            fault: fault.clone(),
            mended: true,
        })
    });
    let frame = match &drive.gnss.1 {
        GnssSource::Poses(poses) => poses.rotation,
        _ => Quaternion::identity(),
    };
    let found = hand_eye::findings(&samples, &poses, &frame);
    Ok(mended.chain(found).collect())
}

/// NIS per degree of freedom outside of which the stated accuracy is looked into.
const PLAUSIBLE: std::ops::RangeInclusive<f64> = 0.6..=1.6;
/// Report a factor on a standard deviation only outside this range.
const WORTH_A_WORD: std::ops::RangeInclusive<f64> = 0.75..=1.33;

/// Factors on the stated standard deviations, as an adaptive run finds them. The innovations of
/// a run with wrong ones do not show it, because its predictions are as wrong; so where they look wrong the
/// log is read once more.
fn std_factors(
    drive: &Drive,
    settings: &Settings,
    summary: &Summary,
) -> Result<[Option<f64>; 2], NavigateError> {
    let plausible = [Aid::Position, Aid::Velocity]
        .map(|aid| &summary.innovations[aid])
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
        let mut aids = drive.open_aids()?;
        let (imu, aiding) = (&mut drive.open_imu()?, &mut aids.measurements());
        replay(imu, aiding, &settings, &mut ())?.adapted
    };
    Ok(adapted.map(|factor| factor.filter(|f| !WORTH_A_WORD.contains(f))))
}
