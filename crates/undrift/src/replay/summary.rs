//! What a replay was like.

use super::{
    CovarianceHealth,
    events::{Contradiction, Implausible, Lean, Part, Restart},
};
use crate::align::Alignment;
use serde::{Deserialize, Serialize};
use undrift_nav::{
    Vector3,
    filter::{Outcome, Update},
    parameters::Parameter,
};
use undrift_noise::order_statistics::upper_median;

/// Sums of the normalised innovations squared of one kind of measurement.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Innovations {
    /// Updates made.
    pub updates: u64,
    /// Sum of NIS over them.
    pub nis_sum: f64,
    /// Sum of their degrees of freedom: what `nis_sum` is on average when the model is right.
    pub dof_sum: u64,
    /// Measurements used with less weight than stated.
    pub weakened: u64,
    /// Measurements left out.
    pub rejected: u64,
    /// Sums of the products of whitened innovations with those of the update before, of the squares,
    /// and their number: for their autocorrelation.
    lagged: (f64, f64, u64),
    /// Whitened innovation of the last update, if it was used.
    #[serde(skip)]
    last: Option<[f64; 3]>,
}

impl Innovations {
    /// Adds what an update did.
    pub fn add(&mut self, update: Update) {
        match update.outcome {
            Outcome::Rejected => {
                self.rejected += 1;
                self.last = None;
                return;
            }
            Outcome::Weakened(_) => self.weakened += 1,
            Outcome::Used => {}
        }
        self.updates += 1;
        self.nis_sum += update.nis;
        self.dof_sum += update.dof as u64;
        if let Some(last) = self.last {
            for (now, before) in update.whitened.iter().zip(last) {
                self.lagged.0 += now * before;
                self.lagged.1 += 0.5 * (now * now + before * before);
            }
            self.lagged.2 += update.dof as u64;
        }
        self.last = Some(update.whitened);
    }

    /// NIS per degree of freedom: 1 when the model is right. `None` without updates.
    pub fn per_dof(&self) -> Option<f64> {
        (self.dof_sum > 0).then(|| self.nis_sum / self.dof_sum as f64)
    }

    /// Autocorrelation of the whitened innovations from one update to the next, and what it stays
    /// below 19 times out of 20 when the model is right: `1.96/√n`.
    pub fn autocorrelation(&self) -> Option<(f64, f64)> {
        let (products, squares, n) = self.lagged;
        (n > 0 && squares > 0.0).then(|| (products / squares, 1.96 / (n as f64).sqrt()))
    }
}

/// What a replay was like.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Summary {
    /// Samples processed after alignment.
    pub samples: u64,
    /// Samples used up by alignment.
    pub align_samples: u64,
    /// When navigation began [s].
    pub started: Option<f64>,
    /// How the first attitude was found, where navigation began.
    pub alignment: Option<Alignment>,
    /// Time of the last sample [s].
    pub ended: f64,
    /// Fixes used.
    pub fixes: u64,
    /// Fixes withheld by outages.
    pub withheld: u64,
    /// Fixes before the first sample or before alignment could use them.
    pub fixes_before: u64,
    /// Fixes that could not be used because their covariance is not one.
    pub bad_fixes: u64,
    /// Position updates.
    pub position: Innovations,
    /// Velocity updates.
    pub velocity: Innovations,
    /// Non-holonomic constraints.
    pub non_holonomic: Innovations,
    /// Zero-velocity updates.
    pub zero_velocity: Innovations,
    /// Odometer updates.
    pub odometer: Innovations,
    /// Barometer updates.
    pub barometer: Innovations,
    /// Parameters estimated: their last values and standard deviations, in the units of [`Parameter`].
    pub parameters: Vec<(Parameter, Vec<f64>, Vec<f64>)>,
    /// Fixes that were left out, run by run; the first [`MOST_EVENTS`].
    pub contradictions: Vec<Contradiction>,
    /// Runs of fixes left out beyond those.
    pub more_contradictions: u64,
    /// Spans in which innovations leaned to one side; the first [`MOST_EVENTS`].
    pub leans: Vec<Lean>,
    /// When and why the solution was aligned again.
    pub restarts: Vec<Restart>,
    /// Mean factors on the stated standard deviations of position and velocity, where they were adapted.
    pub adapted: [Option<f64>; 2],
    /// Regression of the innovations of velocity on the measured velocity, component by component:
    /// sums of products and of squares.
    pub(super) against_velocity: [(f64, f64); 3],
    /// Short gaps in the samples that were bridged by interpolation.
    pub bridged: u64,
    /// Gaps too long for that: their number, the first one's time [s], the longest [s]. The covariance was
    /// grown over each of up to a minute; a longer one ended the solution, and is among `restarts`.
    pub long_gaps: Option<(u64, f64, f64)>,
    /// Longest span without a fix, outages aside: start and length [s].
    pub longest_without_gnss: (f64, f64),
    /// Units, axes, signs or times that cannot be right.
    pub implausible: Vec<Implausible>,
    /// When the solution stopped being one, if it did and did not begin anew [s].
    pub diverged: Option<f64>,
    /// The covariance at the end, if there is a solution.
    pub covariance: Option<CovarianceHealth>,
    /// Start of the first [`SUSPECT_UPDATES`] updates on end, or fewer at the end of the log, whose
    /// innovations were far beyond their predicted size [s].
    pub suspect: Option<f64>,
}

/// Fixes left out within so long after the solution gave way belong to what went before [s].
const GOES_ON: f64 = 3.0;
/// Events of a kind that are kept one by one.
pub const MOST_EVENTS: usize = 1000;
/// NIS per degree of freedom over this many updates …
pub const SUSPECT_UPDATES: u32 = 20;
/// … and above this value makes a solution suspect of divergence.
pub const SUSPECT_NIS: f64 = 25.0;
/// A component of the velocity has the wrong sign where its innovations are this part of it, on the
/// average: −2 if the solution ignores it, closer to 0 the more it follows …
const WRONG_SIGN: f64 = -0.6;
/// … and there has been this much motion [m²/s²].
const MOTION: f64 = 5.0;

impl Summary {
    /// Components of the velocity, 0 to 2 for north, east, down, that seem to have the wrong sign.
    pub fn wrong_signs(&self) -> impl Iterator<Item = usize> + '_ {
        (0..3).filter(|i| {
            let (products, squares) = self.against_velocity[*i];
            squares > MOTION && products < WRONG_SIGN * squares
        })
    }

    /// Takes in the innovation (predicted less measured) of a measured velocity and the variances of its
    /// noise, which is in both and would correlate them at rest.
    pub(super) fn regress(&mut self, innovation: &Vector3, measured: &Vector3, noise: &Vector3) {
        for (i, sums) in self.against_velocity.iter_mut().enumerate() {
            sums.0 += innovation[i] * measured[i] + noise[i];
            sums.1 += measured[i] * measured[i] - noise[i];
        }
    }

    /// Notes a run of fixes left out; where the solution has just given way to others of the kind, it is
    /// the same one that goes on.
    pub(super) fn contradicted(&mut self, what: Contradiction) {
        let same = |c: &&mut Contradiction| c.part == what.part;
        if let Some(last) = self.contradictions.iter_mut().rev().find(same)
            && last.gave_way
            && what.start - last.end < GOES_ON
        {
            last.end = what.end;
            last.fixes += what.fixes;
            last.largest = last.largest.max(what.largest);
            return;
        }
        if self.contradictions.len() < MOST_EVENTS {
            self.contradictions.push(what);
        } else {
            self.more_contradictions += 1;
        }
    }
}

/// A solution that was sound and whose innovations have been far beyond their size for so long [s] begins
/// anew.
const SICK: f64 = 30.0;
/// NIS per degree of freedom of a sound solution.
const SOUND_NIS: f64 = 4.0;

/// Updates, their NIS and degrees of freedom since the count began, and when that was [s].
#[derive(Default)]
pub(super) struct Streak {
    updates: u32,
    nis: f64,
    dof: u32,
    start: f64,
    /// Whether the solution was ever sound, and since when it is not [s].
    sound: bool,
    sick_since: Option<f64>,
}

impl Streak {
    /// Watches for innovations far beyond their covariance, block by block.
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

    /// Whether a solution that was sound has been beyond its size for long [`SICK`].
    pub(super) fn is_sick(&self, time: f64) -> bool {
        self.sick_since.is_some_and(|since| time - since > SICK)
    }

    pub(super) fn judge(&mut self, summary: &mut Summary) {
        if self.dof == 0 {
            return;
        }
        let nis = self.nis / f64::from(self.dof);
        if nis > SUSPECT_NIS {
            if summary.suspect.is_none() {
                summary.suspect = Some(self.start);
            }
            if self.sound {
                self.sick_since.get_or_insert(self.start);
            }
        } else {
            self.sick_since = None;
            self.sound |= nis < SOUND_NIS;
        }
        (self.updates, self.nis, self.dof) = (0, 0.0, 0);
    }
}

/// Fixes in a block of [`LeanWatch`].
const BLOCK: usize = 40;
/// The mean over a block leans when it is this many times the usual and the expected size, squared.
const LEANS: f64 = 60.0;
/// Blocks that the usual size is taken from, and how many there must be.
const BLOCKS: usize = 20;
const LEAST_BLOCKS: usize = 5;
/// Whitened innovations count up to this size: an outlier alone does not make a lean.
const CLIP: f64 = 4.0;

/// Watches the means of whitened innovations for a slow drift of fixes that each pass the gate.
pub(super) struct LeanWatch {
    part: Part,
    start: f64,
    updates: usize,
    white: Vector3,
    innovation: Vector3,
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
        if self.updates < BLOCK {
            return;
        }
        // χ²(3)/3 for white innovations.
        let size = self.white.norm_squared() / (3.0 * BLOCK as f64);
        let mean: [f64; 3] = (self.innovation / BLOCK as f64).into();
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

    pub(super) fn close(&mut self, summary: &mut Summary) {
        if let Some(lean) = self.open.take()
            && summary.leans.len() < MOST_EVENTS
        {
            summary.leans.push(lean);
        }
    }
}
