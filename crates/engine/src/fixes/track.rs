//! Fixes in order of time, as they are looked at.
//!
//! The study needs them of one kind: those with position and velocity, or where no fix has a velocity, all positions.
//!
//! Positions become a path in metres, north, east, down, summed from fix to fix: each step is
//! measured in the local frame of its beginning, so that the path of a long drive has no distortion
//! by the Earth's curvature over one step. Velocities are kept as measured. No fix is interpolated,
//! and none is rejected here: medians in [`super`] do without that.

use alloc::{vec, vec::Vec};
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_nav::{
    Vector3,
    sample::{GnssFix, Position},
};

/// What is looked at of a fix.
#[derive(Clone, Copy)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Seen {
    /// Stamp \[s\].
    pub(super) time: f64,
    /// Geodetic, or a baseline in the base station's frame.
    pub(super) position: Position,
    /// Stated variances of the position, north, east, down \[m²\].
    pub(super) stated: Vector3,
    /// Velocity north, east, down [m/s] and its stated variances [m²/s²].
    pub(super) velocity: Option<(Vector3, Vector3)>,
}

impl Seen {
    /// Position and velocity of a fix; `None` of one without a position.
    /// Nor of one with a variance that is not positive and finite.
    ///
    /// Off-diagonal elements of the covariances are not used: the study goes axis by axis.
    pub(super) fn from_fix(fix: &GnssFix) -> Option<Self> {
        let (position, r) = fix.position?;
        let seen = Self {
            time: fix.time,
            position,
            stated: r.diagonal(),
            velocity: fix.velocity.map(|(v_n, r)| (v_n, r.diagonal())),
        };
        let usable = |r: &Vector3| r.iter().all(|r| *r > 0.0 && r.is_finite());
        let moves = seen.velocity.as_ref();
        (usable(&seen.stated) && moves.is_none_or(|(_, r)| usable(r))).then_some(seen)
    }
}

/// Fixes in order of time: those with position and velocity, or, where none has a velocity, all with a position.
///
/// All vectors but `velocity` and `stated_velocity` have one entry a fix; those two have as many or
/// are empty.
#[derive(Default)]
pub(super) struct Track {
    pub(super) time: Vec<f64>,
    /// Position against the first \[m\].
    pub(super) place: Vec<Vector3>,
    pub(super) velocity: Vec<Vector3>,
    /// Stated variances of position and velocity.
    pub(super) stated: Vec<Vector3>,
    pub(super) stated_velocity: Vec<Vector3>,
    /// Coordinates as they are written [rad or m], and metres a unit.
    pub(super) written: Vec<Vector3>,
    pub(super) metres: Vector3,
}

impl Track {
    /// The metres a unit are those of the last fix.
    pub(super) fn from_fixes<'a>(fixes: impl Iterator<Item = &'a Seen> + Clone) -> Self {
        let by_velocity = fixes.clone().any(|fix| fix.velocity.is_some());
        let mut track = Self::default();
        let mut before: Option<(Position, Vector3)> = None;
        for fix in fixes.filter(|fix| fix.velocity.is_some() == by_velocity) {
            let (place, written, metres) = match (fix.position, before) {
                (Position::Geodetic(here), last) => {
                    let place = match last {
                        Some((Position::Geodetic(last), place)) => place + last.offset_to(&here),
                        _ => Vector3::zeros(),
                    };
                    let unit = undrift_nav::earth::Geodetic {
                        lat: here.lat + 1e-6,
                        lon: here.lon + 1e-6,
                        height: here.height,
                    };
                    let mut metres = here.offset_to(&unit) * 1e6;
                    metres.z = 1.0;
                    (place, Vector3::new(here.lat, here.lon, here.height), metres)
                }
                (Position::Baseline { ned, .. }, _) => (ned, ned, Vector3::repeat(1.0)),
            };
            before = Some((fix.position, place));
            track.time.push(fix.time);
            track.place.push(place);
            track.stated.push(fix.stated);
            if let Some((v_n, stated)) = fix.velocity {
                track.velocity.push(v_n);
                track.stated_velocity.push(stated);
            }
            track.written.push(written);
            track.metres = metres;
        }
        track
    }

    /// Positions less the integral of the velocities \[m\], with the four-point rule where intervals are even
    /// (Abramowitz & Stegun 25.4.15).
    ///
    /// `interval` is the usual one \[s\]; three intervals within a tenth of it use the four-point
    /// rule, others the trapezoidal one. The result begins at the first position. Its noise is that
    /// of the positions plus the integrated error of the velocities.
    pub(super) fn less_velocity(&self, interval: f64) -> Vec<Vector3> {
        let (t, v) = (&self.time, &self.velocity);
        let even = |k: usize| ((t[k + 1] - t[k]) / interval - 1.0).abs() < 0.1;
        let mut integral = Vector3::zeros();
        let mut out = vec![self.place[0]];
        for k in 0..t.len() - 1 {
            let dt = t[k + 1] - t[k];
            let sum = if k > 0 && k + 2 < t.len() && even(k - 1) && even(k) && even(k + 1) {
                ((v[k] + v[k + 1]) * 13.0 - v[k - 1] - v[k + 2]) / 24.0
            } else {
                (v[k] + v[k + 1]) * 0.5
            };
            integral += sum * dt;
            out.push(self.place[k + 1] - integral);
        }
        out
    }
}
