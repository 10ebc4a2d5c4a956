//! What of the log went by, and what of a fix or a sample counts.

use crate::align::Stamps;
use undrift_events::Part;
use undrift_nav::sample::{GnssFix, ImuSample};

/// What of the log went by.
#[derive(Clone, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct LogProgress {
    /// Time of the first sample \[s\].
    pub(super) first_sample: Option<f64>,
    /// Stamps of the fixes read so far.
    pub(super) stamps: Option<Stamps>,
    /// Fixes since the first sample, withheld ones too.
    pub(super) fixes: u64,
    /// The sample before, for bridging a gap.
    pub(super) previous: Option<ImuSample>,
    /// Time of the last fix that was used or withheld \[s\], and of the last one that was so with its velocity.
    pub(super) last_fix: Option<f64>,
    pub(super) last_velocity: Option<f64>,
}

impl LogProgress {
    /// Notes a fix, or a part of it, that was used or withheld; when the one before was.
    pub(super) fn shown(&mut self, time: f64, with_velocity: bool) -> Option<f64> {
        if with_velocity {
            self.last_velocity = Some(time);
        }
        // The parts of two fixes may come in turns.
        let before = self.last_fix;
        self.last_fix = Some(before.map_or(time, |before| before.max(time)));
        before
    }
}

/// Whether this part of a fix is the one that is counted: each fix counts once.
pub(super) fn begins(fix: &GnssFix, part: Option<Part>) -> bool {
    part != Some(Part::Velocity) || fix.position.is_none()
}

/// Whether this part of a fix has all of its velocity.
pub(super) fn carries_velocity(fix: &GnssFix, part: Option<Part>) -> bool {
    part != Some(Part::Position) || fix.velocity.is_none()
}

/// The last `dt` \[s\] of a sample.
///
/// Rates are taken as constant over a sample, so increments are divided in proportion.
pub(super) fn part(sample: &ImuSample, dt: f64) -> ImuSample {
    let part = dt / sample.dt;
    ImuSample {
        time: sample.time,
        dt,
        dtheta: sample.dtheta * part,
        dvel: sample.dvel * part,
    }
}
