//! The whole navigator as bytes, to go on with it in another process.
//!
//! Kept is the state before the oldest sample that a late measurement may still ask for, and what came since: what is
//! restored does that again, to the last bit. The settings are not in it; nor is what a smoother records.

use crate::{
    estimator::Estimator,
    measurement::Measured,
    navigator::{Navigator, Snapshot},
    run::Run,
    settings::{Settings, fix_errors::FixErrors},
};
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};
use undrift_events::Event;
use undrift_nav::{
    covariance::AXES,
    parameters::{Parameter, Parameters},
    sample::ImuSample,
};

/// Version of the bytes' layout: changes whenever what is kept does.
const FORMAT: u32 = 14;

/// Why a navigator cannot be restored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RestoreError {
    /// The bytes are not those of a checkpoint, or not all of them, or damaged: the checksum differs.
    #[error("these bytes are no checkpoint of a navigator, or are cut off")]
    NoCheckpoint,
    /// The bytes are of this format, which another version of the navigator made.
    #[error(
        "the checkpoint has format {0}, this navigator reads {FORMAT}: it was made by another version"
    )]
    OtherFormat(u32),
    /// The navigator that was kept had other sensor models or parameters than these settings.
    #[error("the checkpoint is of a navigator with other settings: its filter does not go on")]
    OtherSettings,
}

#[derive(Serialize, Deserialize)]
struct Kept {
    run: Run,
    /// What the fixes and the filter's parameters were found to be: in the settings of the run.
    fix_errors: FixErrors,
    parameters: Parameters,
    innovations: [Option<[f64; 3]>; undrift_events::Aid::COUNT],
    measured: Measured,
    horizon: f64,
    samples: Vec<ImuSample>,
    gone: u64,
    /// Number of the first sample behind the snapshot that `run` is, and its time; absent without a horizon.
    since: Option<(u64, f64)>,
    last: Option<f64>,
    too_late: u64,
    rejected: Vec<Event>,
    handed_out: Vec<Event>,
}

impl Navigator {
    /// The whole navigator as bytes: format number, state and a checksum. They are read by the same version of the format alone
    /// ([`RestoreError::OtherFormat`]).
    ///
    /// ```
    /// use undrift_engine::{Navigator, settings::Settings};
    /// # use undrift_nav::shaping::ShapingFilter;
    /// # use undrift_simulate::{GnssNoise, Trajectory, simulate};
    /// # let (gyro, accel) = (ShapingFilter::white(1e-4, 0.02)?, ShapingFilter::white(1e-3, 0.02)?);
    /// # let sensors = [gyro, gyro, gyro, accel, accel, accel];
    /// # let log = simulate(&Trajectory::car(120.0, 1), 50.0, Some(&sensors), &GnssNoise::default(), 1)?;
    /// let run = |navigator: &mut Navigator, from: usize, to: usize| {
    ///     let (first, last) = (log.imu[from].time, log.imu[to - 1].time);
    ///     for fix in log.gnss.iter().filter(|fix| first <= fix.time && fix.time < last) {
    ///         navigator.fix(*fix)?;
    ///     }
    ///     log.imu[from..to].iter().try_for_each(|sample| navigator.imu(*sample))
    /// };
    /// let mut navigator = Navigator::new(Settings::new(sensors));
    /// run(&mut navigator, 0, 5000)?;
    /// let mut again = Navigator::restore(Settings::new(sensors), &navigator.checkpoint())?;
    /// run(&mut navigator, 5000, 6000)?;
    /// run(&mut again, 5000, 6000)?;
    /// let place = |navigator: &Navigator| navigator.filter().map(|filter| filter.nav().position);
    /// assert!(place(&again).is_some() && place(&again) == place(&navigator), "to the last bit");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// Format number and state in postcard's encoding, then a checksum of eight bytes,
    /// little-endian. The size grows with the horizon, over which samples and measurements are
    /// kept.
    pub fn checkpoint(&self) -> Vec<u8> {
        let oldest = self.past.front();
        let run = oldest.map_or(&self.run, |oldest| &oldest.run).clone();
        let kept = Kept {
            fix_errors: run.settings().fix_errors,
            parameters: run.settings().parameters,
            innovations: run.summary().last_innovations(),
            run,
            measured: self.measured.clone(),
            horizon: self.horizon,
            samples: self.samples.iter().copied().collect(),
            gone: self.gone,
            since: oldest.map(|oldest| (oldest.next, oldest.time)),
            last: self.last,
            too_late: self.too_late,
            rejected: self.rejected.clone(),
            handed_out: self.handed_out.clone(),
        };
        // Into memory, of types that have no way to fail.
        let mut bytes = postcard::to_allocvec(&(FORMAT, kept)).unwrap_or_default();
        bytes.extend(checksum(&bytes).to_le_bytes());
        bytes
    }

    /// The navigator of a `checkpoint`, under the settings that it was made with: it continues as the other one would have,
    /// to the last bit. What is observed or recorded for a smoother restarts empty.
    ///
    /// # Errors
    /// [`RestoreError`]: bytes that are damaged or of another format, settings with other parameters or sensor models of
    /// another order.
    pub fn restore(settings: Settings, checkpoint: &[u8]) -> Result<Self, RestoreError> {
        let bad = |_| RestoreError::NoCheckpoint;
        let (format, rest) = postcard::take_from_bytes::<u32>(checkpoint).map_err(bad)?;
        if format != FORMAT {
            return Err(RestoreError::OtherFormat(format));
        }
        let (body, sum) = checkpoint
            .split_last_chunk()
            .ok_or(RestoreError::NoCheckpoint)?;
        if checksum(body) != u64::from_le_bytes(*sum) {
            return Err(RestoreError::NoCheckpoint);
        }
        let start = (checkpoint.len() - rest.len()).min(body.len());
        let kept: Kept = postcard::from_bytes(&body[start..]).map_err(bad)?;
        let mut settings = settings;
        let sensors = settings.sensors;
        let constants = |parameters: Parameters| {
            let without = parameters.without(Parameter::PositionError);
            without.without(Parameter::VelocityError)
        };
        if constants(settings.parameters) != constants(kept.parameters) {
            return Err(RestoreError::OtherSettings);
        }
        settings.fix_errors = kept.fix_errors;
        settings.parameters = kept.parameters;
        let mut run = kept.run;
        if !run.go_on_under(settings.clone()) {
            return Err(RestoreError::OtherSettings);
        }
        run.summary_mut().set_last_innovations(kept.innovations);
        let same = |filter: &dyn Estimator| {
            (0..AXES).all(|k| filter.sensors().axis(k).order == sensors[k].order)
        };
        if !run.filter().is_none_or(same) {
            return Err(RestoreError::OtherSettings);
        }
        let mut navigator = Self::new(settings).with_horizon(kept.horizon);
        navigator.run = run.clone();
        navigator.measured = kept.measured;
        navigator.samples = kept.samples.into();
        navigator.gone = kept.gone;
        navigator.last = kept.last;
        navigator.too_late = kept.too_late;
        navigator.rejected = kept.rejected;
        navigator.handed_out = kept.handed_out;
        if let Some((next, time)) = kept.since {
            navigator.past.push_back(Snapshot { run, next, time });
            navigator
                .again(0)
                .map_err(|_| RestoreError::OtherSettings)?;
        }
        Ok(navigator)
    }
}

/// FNV-1a of 64 bits (Fowler, Noll & Vo): what was damaged on the way is not restored.
///
/// Against damage, not against tampering.
fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |sum, byte| {
        (sum ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3)
    })
}

#[cfg(test)]
mod tests;
