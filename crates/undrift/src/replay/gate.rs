//! Which fixes to believe: gates on the innovations, with recovery.
//!
//! A stated accuracy may be wrong by a large factor for a whole log, so limits are relative to the
//! usual size of the innovations: the median of the last normalised innovations squared over the
//! median of χ². A fix far beyond them is left out, a doubtful one weakened. Fixes that are left out
//! one after the other and agree with each other mean that it is the solution that is wrong: at
//! once after a span without GNSS, otherwise when they have gone on for [`PATIENCE`].

use undrift_nav::{
    Vector3,
    filter::{Gate, Outcome},
};

/// Innovations that the usual size is taken from.
const WINDOW: usize = 40;
/// Below so many the gate is open.
const LEAST: usize = 10;
/// NIS per degree of freedom, relative to the usual, from which a fix is weakened …
const WEAKEN: f64 = 5.0;
/// … and left out.
const REJECT: f64 = 20.0;
/// Without an accepted fix for so long [s], the solution is doubted as soon as two fixes agree.
const GAP: f64 = 3.0;
/// Otherwise it is doubted after so long [s].
const PATIENCE: f64 = 15.0;
/// Innovations agree when they differ by less than this part of their size.
const AGREE: f64 = 0.3;

/// The gate of one kind of measurement.
pub(super) struct FixGate {
    recent: [f64; WINDOW],
    count: usize,
    accepted: Option<f64>,
    /// Time of the first and innovation of the last fix left out since one was accepted.
    refused: Option<(f64, Vector3)>,
}

impl FixGate {
    pub(super) fn new() -> Self {
        Self {
            recent: [0.0; WINDOW],
            count: 0,
            accepted: None,
            refused: None,
        }
    }

    /// The gate for a fix now; `None` when the solution has to give way to it.
    pub(super) fn gate(&self, time: f64, innovation: &Vector3, dof: usize) -> Option<Gate> {
        if let (Some((since, last)), Some(accepted)) = (self.refused, self.accepted) {
            let agree = (innovation - last).norm() < AGREE * innovation.norm();
            let patience = if since - accepted > GAP {
                0.0
            } else {
                PATIENCE
            };
            if agree && time - since >= patience {
                return None;
            }
        }
        if self.count < LEAST {
            return Some(Gate::OPEN);
        }
        let unit = self.usual().max(1.0) * dof as f64;
        Some(Gate {
            weaken: WEAKEN * unit,
            reject: REJECT * unit,
        })
    }

    /// Notes what became of a fix.
    pub(super) fn note(
        &mut self,
        time: f64,
        innovation: &Vector3,
        nis_per_dof: f64,
        outcome: Outcome,
    ) {
        self.recent[self.count % WINDOW] = nis_per_dof;
        self.count += 1;
        if outcome == Outcome::Rejected {
            let since = self.refused.map_or(time, |(since, _)| since);
            self.refused = Some((since, *innovation));
        } else {
            self.accepted = Some(time);
            self.refused = None;
        }
    }

    /// Usual NIS per degree of freedom: 1 when the stated accuracy is right.
    pub(super) fn usual(&self) -> f64 {
        let mut sorted = self.recent;
        let sorted = &mut sorted[..self.count.min(WINDOW)];
        if sorted.is_empty() {
            return 1.0;
        }
        sorted.sort_unstable_by(f64::total_cmp);
        // Median of χ²(3)/3.
        sorted[sorted.len() / 2] / 0.789
    }
}
