//! What a fix says to an alignment: place, velocity, and how much of that is noise of positions.

use super::{Aligner, HAND, PAIR_SPAN, diagonal};
use crate::derived::antenna;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_nav::{Matrix3, Vector3, earth::Geodetic, sample::GnssFix};

/// A fix as an alignment takes it, each part with its covariance.
pub(super) struct Seen {
    pub(super) time: f64,
    pub(super) position: (Geodetic, Matrix3),
    pub(super) velocity: (Vector3, Matrix3),
    /// Standard deviation of the velocity over ground for the noise of the positions that it is from \[m/s\]; 0 of a
    /// measured one.
    pub(super) noise: f64,
}

impl Aligner {
    /// Position and velocity by a fix: the velocity given, measured, or from two positions.
    ///
    /// In that order: as the settings state it, as the fix has it, from several positions, from two. A velocity
    /// from positions held half their span ago; what the vehicle may have accelerated by since is in its
    /// covariance.
    pub(super) fn see(&mut self, fix: &GnssFix) -> Option<Seen> {
        let (antenna, (_, covariance)) = (antenna(fix)?, fix.position?);
        self.fixes += 1;
        let before = self.last_fix.replace((fix.time, antenna));
        let before = before.filter(|(time, _)| fix.time - time <= PAIR_SPAN && fix.time > *time);
        let given = self.settings.velocity.map(|(v, std)| (v, diagonal(&std)));
        let posed = fix.attitude.is_some();
        let derived = self.positions.add(fix).filter(|_| !posed).map(|derived| {
            // It held a while ago: a vehicle's acceleration since then.
            let age = fix.time - derived.time;
            let covariance = derived.covariance + Matrix3::identity() * age * age;
            ((derived.v_n, covariance), over_ground(&derived.covariance))
        });
        let measured = given.or(fix.velocity).map(|velocity| (velocity, 0.0));
        let (velocity, noise) = measured.or(derived).or_else(|| {
            let (time, place) = before?;
            let span = fix.time - time;
            let v = place.offset_to(&antenna) / span;
            // Two positions' errors, and half the span at a vehicle's acceleration, or at that of a hand or a copter.
            let covariance = covariance * (2.0 / (span * span));
            let noise = over_ground(&covariance);
            let change = if posed { HAND * span } else { span };
            Some((
                (v, covariance + Matrix3::identity() * change * change),
                noise,
            ))
        })?;
        Some(Seen {
            time: fix.time,
            position: (antenna, covariance),
            velocity,
            noise,
        })
    }
}

/// Standard deviation of a velocity along an axis over ground \[m/s\].
pub(super) fn over_ground(covariance: &Matrix3) -> f64 {
    (covariance.fixed_view::<2, 2>(0, 0).trace() / 2.0).sqrt()
}
