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
    /// What a replay of the drive goes on with.
    pub settings: Settings,
    /// What the samples up to there have shown of their noise, where the filter's follows it.
    pub vibration: Option<Vibration>,
}

/// Aligns a drive: its filter as [`super::navigate`] begins it.
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
