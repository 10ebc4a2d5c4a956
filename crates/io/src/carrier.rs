//! Mean velocities between fixes by the carrier phases of two epochs.

use undrift_nav::Vector3;
use undrift_nav::earth::Geodetic;
use undrift_nav::sample::{MeanVelocity, Position};
use undrift_observables::{Ephemerides, Epoch, displacement};

/// Clocks of receivers are off by less than this \[s\].
pub(crate) const CLOCK: f64 = 0.02;

/// The way from fix to fix.
#[derive(Default)]
pub(crate) struct Way {
    /// Raw measurements of the last fix.
    pub(crate) before: Option<Epoch>,
    /// The last place that is known.
    place: Option<Geodetic>,
}

impl Way {
    /// Mean velocity since the last fix, up to this one with the raw measurements `now`, where those of both are there and give it. An epoch
    /// without position and velocity, of a receiver that sees too few satellites, has the directions that they show.
    pub(crate) fn mean_velocity(
        &mut self,
        ephemerides: &Ephemerides,
        now: Option<Epoch>,
        place: Option<&Position>,
        v_n: Option<Vector3>,
    ) -> Option<MeanVelocity> {
        let fixed = place.is_some() || v_n.is_some();
        let known = place.map(|place| match place {
            Position::Geodetic(place) => *place,
            Position::Baseline { base, ned } => base.displaced(ned),
        });
        self.place = known.or(self.place);
        let before = std::mem::replace(&mut self.before, now);
        let (before, now, place) = (before?, self.before.as_ref()?, self.place?);
        let about = v_n.unwrap_or_else(Vector3::zeros);
        let way = displacement(ephemerides, &before, now, &place, &about)?;
        // A receiver's own fix is better than what nothing checks.
        if fixed && !way.is_checked() {
            return None;
        }
        Some(MeanVelocity {
            over: way.over,
            v_n: way.ned / way.over,
            covariance: way.covariance / (way.over * way.over),
            place,
            by_place: way.by_place / way.over,
        })
    }
}
