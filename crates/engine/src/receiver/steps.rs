//! Positions that step and stay where they went, by too little for the gate: RTK that takes a wrong integer, another base.
//!
//! The solution may be wrong by more than the step, but not by another amount from one fix to the next: what an innovation differs by from
//! what the one before has left is the change of the fix's error, but for noise and what a velocity that is wrong makes in between.
//! A step is, beside the track, far beyond what the fixes state and beyond what is usual; it counts when no step leads back within some seconds,
//! as it does after a fix that is wrong by itself.

use crate::{gate::GOES_ON, median::upper_median, summary::Summary};
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_events::{Contradiction, Part};
use undrift_nav::{Matrix3, Vector3};

/// Standard deviations of two fixes from which a change is a step, and multiples of the usual change.
const SIGMAS: f64 = 5.0;
const USUAL: f64 = 8.0;
/// Changes that the usual size is taken from, and how many there must be.
const WINDOW: usize = 32;
const LEAST: usize = 10;
/// Speed from which there is a track [m/s].
const MOVES: f64 = 0.5;
/// Fixes further apart are not compared \[s\].
const APART: f64 = 2.5;
/// A step counts that stays for longer than this \[s\].
const STAYS: f64 = 5.5;
/// A change back is within this part of the step.
const BACK: f64 = 0.5;

/// Watches the changes of the positions' innovations.
#[derive(Clone, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Steps {
    /// Time of the last position \[s\], what its innovation has left \[m\], and its covariance \[m²\].
    last: Option<(f64, Vector3, Matrix3)>,
    /// Squares of the last changes \[m²\], in a ring.
    #[cfg_attr(feature = "checkpoint", serde(with = "crate::kept::array"))]
    usual: [f64; WINDOW],
    count: usize,
    /// The last step: its time \[s\] and the change \[m\].
    open: Option<(f64, Vector3)>,
}

impl Steps {
    /// Takes in a position that was used, its innovation before and after the update \[m\], the covariance it states \[m²\], and what the
    /// solution may drift by meanwhile, with its velocity [m/s]: what lies along the track is as well a stamp that is wrong.
    pub(super) fn used(
        &mut self,
        time: f64,
        [before, after]: [&Vector3; 2],
        stated: &Matrix3,
        (drift, v_n): (f64, &Vector3),
        summary: &mut Summary,
    ) {
        let Some((last, left, r)) = self.last.replace((time, *after, *stated)) else {
            return;
        };
        let dt = time - last;
        if !(dt > 0.0 && dt < APART) {
            self.open = None;
            return;
        }
        let change = before - left;
        let along = v_n.try_normalize(MOVES).unwrap_or_default();
        let size = (change - along * change.dot(&along)).norm_squared();
        let mut known = self.usual;
        let usual = upper_median(&mut known[..self.count.min(WINDOW)]);
        let stated = SIGMAS * (stated + r).trace().sqrt() + drift * dt;
        let step = self.count >= LEAST && size > (stated * stated).max(USUAL * USUAL * usual);
        if let Some((since, open)) = self.open {
            if (change + open).norm() < BACK * open.norm() {
                self.open = None;
                return;
            }
            if time - since > STAYS {
                let size = open.norm();
                let found = Contradiction {
                    part: Part::Position,
                    height: open.xy().norm() < BACK * open.z.abs(),
                    start: since,
                    end: time,
                    fixes: 0,
                    first: size,
                    last: size,
                    growth: 0.0,
                    largest: size,
                    frozen: false,
                    accepted_in_the_end: true,
                };
                summary.contradicted(found, GOES_ON);
                self.open = None;
            }
        }
        if step {
            self.open = Some((time, change));
        } else {
            self.usual[self.count % WINDOW] = size;
            self.count += 1;
        }
    }

    /// A position was rejected: the gate says what becomes of it.
    pub(super) fn rejected(&mut self) {
        (self.last, self.open) = (None, None);
    }
}

#[cfg(test)]
mod tests;
