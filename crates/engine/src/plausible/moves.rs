//! Whether positions move as velocities say.
//!
//! Over windows of 2 s the way between two positions is compared with the velocities integrated over it; a
//! window counts where the way is large against the noise of two positions. Fewer than 0.4 of them as they
//! should be is a finding; a mistake that explains four fifths of the ways is named with it.
//!
//! Each mistake is a 2 × 2 matrix on the velocity, so that one pass judges all eleven. Needs
//! geodetic positions with a velocity and at least eight windows of motion, each of more than 2 m
//! and ten standard deviations of a position.

use super::APART;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_events::{FixMend, FixMend::*, Implausible};
use undrift_nav::{
    Vector3,
    earth::Geodetic,
    sample::{GnssFix, Position},
};

/// Length of the windows over which position and velocity are compared \[s\].
const MOVE_WINDOW: f64 = 2.0;
/// Windows that it takes to judge.
const LEAST_MOVES: u32 = 8;
/// Least share of windows of motion that are as they should be.
const LEAST_SANE: f64 = 0.4;
/// Two displacements agree to this part of the larger one.
const AGREE: f64 = 0.2;

/// Cosine of the turn of the velocity from fix to fix, beyond which half their sum is not the velocity between them.
const STRAIGHT: f64 = 0.95;
/// Share of the larger of two ways from which their difference is another fault than a scale.
const OUTLIER: f64 = 0.5;
/// Windows that it takes to judge a scale, how far it has to be from 1, and how many of its standard deviations.
const LEAST_STRAIGHT: u32 = 20;
const SCALE: (f64, f64) = (0.03, 6.0);

/// What may be wrong with the fixes, and the matrix on the velocity (north, east) that mends it.
const MENDS: [(FixMend, [f64; 4]); 11] = [
    (VelocityEastNorth, [0.0, 1.0, 1.0, 0.0]),
    (PositionSwapped, [0.0, 1.0, 1.0, 0.0]),
    (EastReversed, [1.0, 0.0, 0.0, -1.0]),
    (NorthReversed, [-1.0, 0.0, 0.0, 1.0]),
    (VelocityReversed, [-1.0, 0.0, 0.0, -1.0]),
    (KilometresPerHour, [1.0 / 3.6, 0.0, 0.0, 1.0 / 3.6]),
    (Knots, [0.514_444, 0.0, 0.0, 0.514_444]),
    (FeetPerSecond, [0.3048, 0.0, 0.0, 0.3048]),
    (CentimetresPerSecond, [0.01, 0.0, 0.0, 0.01]),
    (MillimetresPerSecond, [0.001, 0.0, 0.0, 0.001]),
    (PositionInRadians, [0.017_453_3, 0.0, 0.0, 0.017_453_3]),
];

/// What is known so far.
#[derive(Clone, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Moves {
    /// Time and velocity of the last fix, where the present window of motion began, and how far velocity went since \[m\].
    last: Option<(f64, Vector3)>,
    began: Option<(f64, Geodetic)>,
    moved: Vector3,
    /// Windows of motion, those that are as they should be, and the sum of what each of [`MENDS`] leaves
    /// unexplained.
    moves: u32,
    sane: u32,
    unexplained: [f64; MENDS.len()],
    /// Whether the velocity turned far from fix to fix in the present window, so that it is not known between them.
    turned: bool,
    /// Over the other windows: sums of the products of seen and stated ways, seen and seen, stated and stated \[m²\], and their number.
    scale: [f64; 3],
    straight: u32,
}

impl Moves {
    /// Takes in a fix of this velocity.
    ///
    /// Velocities are integrated by the trapezoidal rule; fixes more than 2.5 s apart begin a new
    /// window.
    pub(super) fn fix(&mut self, fix: &GnssFix, velocity: &Vector3) {
        let (time, velocity) = (fix.time, *velocity);
        let position = match &fix.position {
            Some((Position::Geodetic(place), r)) => {
                Some((*place, r.fixed_view::<2, 2>(0, 0).trace().sqrt()))
            }
            _ => None,
        };
        let last = self.last.replace((time, velocity));
        let Some((position, std)) = position else {
            self.began = None;
            return;
        };
        let (Some((last, before)), Some((start, origin))) = (last, self.began) else {
            (self.began, self.moved) = (Some((time, position)), Vector3::zeros());
            return;
        };
        self.moved += (velocity + before) * (0.5 * (time - last));
        let along = velocity.xy().dot(&before.xy());
        self.turned |= along < STRAIGHT * velocity.xy().norm() * before.xy().norm();
        if time - last <= APART && time - start < MOVE_WINDOW {
            return;
        }
        let (seen, stated) = (origin.offset_to(&position), self.moved);
        let together = time - last <= APART;
        (self.began, self.moved) = (Some((time, position)), Vector3::zeros());
        let turned = core::mem::take(&mut self.turned);
        let size = seen.xy().norm().max(stated.xy().norm());
        // Noise of two positions is to be small against the way.
        if !together || size < 2.0 + 10.0 * std || !size.is_finite() {
            return;
        }
        self.moves += 1;
        let left = (seen - stated).xy().norm();
        if !turned && left < OUTLIER * size {
            let [a, b] = [seen.xy(), stated.xy()];
            for (sum, product) in self.scale.iter_mut().zip([a.dot(&b), a.dot(&a), b.dot(&b)]) {
                *sum += product;
            }
            self.straight += 1;
        }
        self.sane += u32::from(left < AGREE * size + 3.0 * std);
        for (unexplained, (mend, matrix)) in self.unexplained.iter_mut().zip(MENDS) {
            let [nn, mut ne, mut en, ee] = matrix;
            if mend == PositionSwapped {
                // The circle of latitude that is meant is that of the longitude given.
                (ne, en) = (1.0 / position.lon.cos(), position.lat.cos());
            }
            let mended = [nn * stated.x + ne * stated.y, en * stated.x + ee * stated.y];
            let size = seen.xy().norm().max(mended[0].hypot(mended[1]));
            let left = (seen.x - mended[0]).hypot(seen.y - mended[1]);
            *unexplained += (left / size).min(1.0);
        }
    }

    /// A multiple of the ways that the velocities are, where it is neither 1 nor a mistake that has a name.
    pub(super) fn scale(&self) -> Option<Implausible> {
        let [both, seen, stated] = self.scale;
        let ratio = both / seen;
        // Of two axes each.
        let left = (stated - ratio * both).max(0.0) / (2.0 * f64::from(self.straight));
        let std = (left / seen).sqrt();
        let off = (ratio - 1.0).abs();
        let is_seen = self.straight >= LEAST_STRAIGHT && off > SCALE.0.max(SCALE.1 * std);
        let has_name = matches!(self.finding(), Some(Implausible::Velocity(Some(_))));
        (is_seen && !has_name).then_some(Implausible::VelocityScale([ratio, std]))
    }

    /// What the moves show.
    ///
    /// `None` for too few windows, or where 40 % of them are as they should be.
    pub(super) fn finding(&self) -> Option<Implausible> {
        let moves = f64::from(self.moves);
        if self.moves < LEAST_MOVES || f64::from(self.sane) >= LEAST_SANE * moves {
            return None;
        }
        let best = (0..MENDS.len())
            .min_by(|a, b| self.unexplained[*a].total_cmp(&self.unexplained[*b]))
            .filter(|k| self.unexplained[*k] < AGREE * moves);
        Some(Implausible::Velocity(best.map(|k| MENDS[k].0)))
    }
}

#[cfg(test)]
mod tests;
