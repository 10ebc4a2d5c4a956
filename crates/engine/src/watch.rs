//! Whether innovations stay as large as their covariance says, and without a lean to one side.
//!
//! Two watches on innovations, the first on those of accepted updates, the second on rejected ones too:
//!
//! - [`Streak`]: the NIS per degree of freedom over 20 updates. Above 25 the solution is suspect, and after 30
//!   s of that an alignment begins beside it.
//! - [`LeanWatch`]: the mean of 40 whitened innovations. Of white ones its square is a χ² of three; a receiver
//!   that is drawn away slowly, by multipath or on purpose, leans to one side while each fix by itself looks
//!   right.
//!
//! The first is fed by [`crate::run`], with updates that were accepted, the second by
//! [`crate::receiver`]; neither touches the filter. What they find is acted on elsewhere: a sick
//! solution is replaced by a second alignment, a lean is an [`Event`](crate::Event) only, since the
//! filter cannot know whether receiver or solution is pulled away.
//!
//! NIS is νᵀ S⁻¹ ν; per degree of freedom it is 1 on average if covariances are right (Bar-Shalom,
//! Li & Kirubarajan 2001).

use super::summary::{MOST_EVENTS, Summary};
use crate::median::upper_median;
use undrift_events::{Lean, Part};
use undrift_nav::{Vector3, filter::Update};

/// Updates over which the NIS of a solution is judged.
const SUSPECT_UPDATES: u32 = 20;
/// NIS per degree of freedom over them that makes a solution suspect of divergence.
const SUSPECT_NIS: f64 = 25.0;
/// NIS of a sound solution.
const SOUND_NIS: f64 = 4.0;
/// A solution that has been suspect for this long is re-initialised \[s\].
const SICK: f64 = 30.0;
/// Starts that are tried where none was ever sound: of accuracies that are stated far too small every solution is suspect.
const STARTS: usize = 3;
/// Fixes in a block over which innovations are averaged for a lean to one side.
const LEAN_BLOCK: usize = 40;
/// The mean over a block leans when it is this many times the usual and the expected size, squared.
const LEANS: f64 = 60.0;
/// Blocks after which the usual size of their means is known.
const LEAST_BLOCKS: usize = 5;
/// Whitened innovations count up to this size: a single outlier does not make a lean.
const CLIP: f64 = 4.0;
/// Prior standard deviations beyond which an estimated parameter is remarked on.
pub(super) const FAR: f64 = 5.0;

/// Updates, their NIS and degrees of freedom since the count began, and when that was \[s\].
///
/// One block of 20 updates at a time: its mean NIS decides. 25 is five times the predicted standard
/// deviation, far beyond what wrong noise settings do.
#[derive(Clone, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Streak {
    /// Updates in the present block.
    updates: u32,
    nis: f64,
    dof: u32,
    start: f64,
    /// Whether the solution was ever sound, and since when it is not \[s\].
    sound: bool,
    sick_since: Option<f64>,
}

impl Streak {
    /// Watches for innovations far beyond their covariance, block by block.
    ///
    /// Rejected updates are not to be given: of them the size says nothing of the solution.
    ///
    /// `time` \[s\] of the fix. The first block above the limit sets `summary.suspect`, once a run.
    pub(super) fn watch(&mut self, update: Update, time: f64, summary: &mut Summary) {
        if self.updates == 0 {
            self.start = time;
        }
        self.updates += 1;
        self.nis += update.nis;
        self.dof += update.dof as u32;
        if self.updates == SUSPECT_UPDATES {
            self.judge(summary);
        }
    }

    /// Whether a solution has been beyond its size for long [`SICK`]: one that was sound, or one of the first few that never
    /// were, after so many `restarts`.
    ///
    /// `restarts` counts the alignments that were begun again; from the third solution on one that
    /// was never sound is kept, since the fixes' accuracies, not the solution, are then wrong.
    pub(super) fn is_sick(&self, time: f64, restarts: usize) -> bool {
        let judged = self.sound || restarts + 1 < STARTS;
        judged && self.sick_since.is_some_and(|since| time - since > SICK)
    }

    /// Whether a block of the solution's innovations was ever of about the size predicted.
    pub(super) fn was_sound(&self) -> bool {
        self.sound
    }

    /// Judges the solution by the updates since the count began, and counts again.
    ///
    /// An incomplete block counts as well: at the end of a log it is all there is.
    pub(super) fn judge(&mut self, summary: &mut Summary) {
        if self.dof == 0 {
            return;
        }
        let nis = self.nis / f64::from(self.dof);
        if nis > SUSPECT_NIS {
            if summary.suspect.is_none() {
                summary.suspect = Some(self.start);
            }
            self.sick_since.get_or_insert(self.start);
        } else {
            self.sick_since = None;
            self.sound |= nis < SOUND_NIS;
        }
        (self.updates, self.nis, self.dof) = (0, 0.0, 0);
    }
}

/// Blocks that the usual size is taken from, and how many there must be.
const BLOCKS: usize = 20;

/// Watches the means of whitened innovations for a slow drift of fixes that each pass the gate.
///
/// Of whitened innovations that are independent the sum of 40 squared over 40 is χ²(3); divided by
/// 3 its mean is 1. A block leans from 60 times the median of the last 20 such sizes, at least 1.
#[derive(Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct LeanWatch {
    /// Position or velocity.
    part: Part,
    start: f64,
    updates: usize,
    /// Sum of the whitened innovations of the block, each clipped to ±4.
    white: Vector3,
    /// Sum of the innovations as they are [m or m/s].
    innovation: Vector3,
    /// Sizes of blocks without a lean, in a ring.
    usual: [f64; BLOCKS],
    count: usize,
    open: Option<Lean>,
}

impl LeanWatch {
    pub(super) fn new(part: Part) -> Self {
        Self {
            part,
            start: 0.0,
            updates: 0,
            white: Vector3::zeros(),
            innovation: Vector3::zeros(),
            usual: [0.0; BLOCKS],
            count: 0,
            open: None,
        }
    }

    /// Adds an innovation; at the end of a block its mean is compared with the usual size of such means.
    ///
    /// A lean goes on while blocks lean, and keeps the largest mean; the first block that does not
    /// lean ends it.
    pub(super) fn add(
        &mut self,
        time: f64,
        innovation: &Vector3,
        update: &Update,
        summary: &mut Summary,
    ) {
        if self.updates == 0 {
            self.start = time;
        }
        self.updates += 1;
        self.white += Vector3::from(update.whitened).map(|w| w.clamp(-CLIP, CLIP));
        self.innovation += innovation;
        if self.updates < LEAN_BLOCK {
            return;
        }
        // χ²(3)/3 for white innovations.
        let size = self.white.norm_squared() / (3.0 * LEAN_BLOCK as f64);
        let mean: [f64; 3] = (self.innovation / LEAN_BLOCK as f64).into();
        (self.updates, self.white, self.innovation) = (0, Vector3::zeros(), Vector3::zeros());
        let mut known = self.usual;
        let usual = upper_median(&mut known[..self.count.min(BLOCKS)]);
        if self.count >= LEAST_BLOCKS && size > LEANS * usual.max(1.0) {
            let length = |m: &[f64; 3]| Vector3::from(*m).norm();
            let open = self.open.get_or_insert(Lean {
                part: self.part,
                start: self.start,
                end: time,
                mean,
            });
            open.end = time;
            if length(&mean) > length(&open.mean) {
                open.mean = mean;
            }
        } else {
            self.usual[self.count % BLOCKS] = size;
            self.count += 1;
            self.close(summary);
        }
    }

    /// Writes down the lean that goes on, if there is one.
    pub(super) fn close(&mut self, summary: &mut Summary) {
        if let Some(lean) = self.open.take()
            && summary.leans.len() < MOST_EVENTS
        {
            summary.leans.push(lean);
        }
    }
}

#[cfg(test)]
mod tests;
