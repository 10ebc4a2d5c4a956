//! What the carrier phases of too few satellites for a fix do to the solution.
//!
//! Two or three satellites show one or two directions of the way since the fix or epoch before, four show it all: each direction is a measurement
//! of one number, independent of the others. Nothing but the solution checks them, so that the gate is narrow: a slip of half a cycle is
//! 0.1 m in the way.

use super::Run;
use crate::{aid::Aiding, observer::Observer, settings::GnssUse};
use undrift_events::Aid;
use undrift_nav::{Matrix3, filter::Gate, sample::GnssFix};

/// NIS of a direction from which it is used with less weight, and from which it is rejected.
const GATE: Gate = Gate {
    weaken: 9.0,
    reject: 25.0,
};

impl Run {
    /// Takes a fix without position and velocity, which has a mean velocity alone.
    pub(super) fn few_satellites(
        &mut self,
        fix: &GnssFix,
        withheld: bool,
        observer: &mut dyn Observer,
    ) {
        let due = fix.time + self.latency().position;
        let unused = withheld || self.settings.gnss_use == GnssUse::Position;
        let Some(solution) = self.solution.as_mut().filter(|_| !unused) else {
            return;
        };
        if due < solution.began {
            return;
        }
        solution.advance_to(due);
        solution.grow_to(due);
        if self.settings.gating {
            solution.grow_by_products(due, self.settings.accel_scale_error);
        }
        let mean = fix.mean_velocity;
        let stretch = mean.and_then(|mean| solution.stretch(mean.over, due));
        if let (Some(mean), Some(stretch)) = (mean, stretch) {
            for (direction, variance) in mean.directions() {
                let aiding = Aiding::MeanVelocityAlong {
                    direction,
                    mean,
                    lever_arm: self.settings.lever_arm,
                    stretch,
                };
                let noise = Matrix3::identity() * variance;
                let update = solution.filter.update(&aiding, &noise, &GATE);
                match update {
                    Ok(Some(update)) => self.summary.innovations[Aid::Velocity].add(update),
                    Ok(None) => {}
                    Err(_) => self.summary.bad_fixes += 1,
                }
            }
        }
        solution.updated(true);
        solution.node(self.settings.nodes, observer);
    }
}
