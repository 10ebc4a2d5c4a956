//! Where the navigation of a drive begins, for callers that then run the filter step by step.

use super::{NavigateError, look_ahead, resolve_mounting, settings, study};
use crate::{
    drive::Drive,
    estimator::{Estimator, STAMP_ROUNDING},
    replay::{ReplayError, Settings, Vibration, begin},
};
use undrift_noise::BiasModel;

/// A drive where its navigation has begun.
pub struct Started {
    /// The filter at the end of the sample that it began in, with the fixes up to there.
    pub filter: Box<dyn Estimator>,
    /// Settings that a replay of the drive continues with.
    pub settings: Settings,
    /// What the samples up to there have shown of their noise, where the filter's follows it.
    pub vibration: Option<Vibration>,
}

/// Aligns a drive: its filter as [`super::navigate`] begins it, to be stepped by the caller.
///
/// ```
/// # use undrift_drive as undrift;
/// use undrift::{BiasModel, Drive, ImuModel, navigate::start};
/// # use undrift_simulate::{GnssNoise, Trajectory, simulate};
/// # let log = simulate(&Trajectory::car(120.0, 1), 50.0, None, &GnssNoise::default(), 1)?;
/// let drive = Drive { model: ImuModel::preset("adis16465"), ..Drive::from_samples(&log.imu, &log.gnss) };
/// let started = start(&drive, BiasModel::Arma)?;
/// // Aligned with the first metres after a minute at rest, to some degrees of heading.
/// assert!(started.filter.nav().time > 30.0 && started.filter.nav_std()[8] < 0.1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`super::navigate`].
pub fn start(drive: &Drive, kind: BiasModel) -> Result<Started, NavigateError> {
    let (drive, _) = resolve_mounting(drive)?;
    let mut settings = settings(&drive, kind)?;
    // Who goes on step by step has a filter whose states stay the same.
    let study = study(&drive, drive.open_gnss()?)?;
    look_ahead(&mut settings, study.as_ref());
    let mut aids = drive.open_aids()?;
    let begun = begin(&mut drive.open_imu()?, &mut aids.measurements(), &settings)?;
    let Some(filter) = begun else {
        // It ended with the sample that it began in.
        return Err(ReplayError::Filter(undrift_nav::filter::FilterError::Diverged).into());
    };
    let mut vibration = Vibration::from_settings(&settings);
    if let Some(vibration) = &mut vibration {
        let end = filter.nav().time + STAMP_ROUNDING;
        for sample in drive.open_imu()? {
            let sample = sample?;
            if sample.time > end {
                break;
            }
            vibration.next(&sample);
        }
    }
    Ok(Started {
        filter,
        settings,
        vibration,
    })
}
