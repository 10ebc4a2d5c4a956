//! What a replay was like.

use undrift_nav::{
    filter::{Outcome, Update},
    parameters::Parameter,
};

/// Sums of the normalised innovations squared of one kind of measurement.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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
}

impl Innovations {
    /// Adds what an update did.
    pub fn add(&mut self, update: Update) {
        match update.outcome {
            Outcome::Rejected => {
                self.rejected += 1;
                return;
            }
            Outcome::Weakened(_) => self.weakened += 1,
            Outcome::Used => {}
        }
        self.updates += 1;
        self.nis_sum += update.nis;
        self.dof_sum += update.dof as u64;
    }

    /// NIS per degree of freedom: 1 when the model is right. `None` without updates.
    pub fn per_dof(&self) -> Option<f64> {
        (self.dof_sum > 0).then(|| self.nis_sum / self.dof_sum as f64)
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
    /// How the heading was found, in words.
    pub alignment: String,
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
    /// Parameters estimated: their last values and standard deviations.
    pub parameters: Vec<(Parameter, Vec<f64>, Vec<f64>)>,
    /// Times at which the solution gave way to fixes that had contradicted it for a while [s], and by
    /// how much they differed [m].
    pub resets: Vec<(f64, f64)>,
    /// Short gaps in the samples that were bridged by interpolation.
    pub bridged: u64,
    /// Gaps too long for that, covariance grown: their number, the first one's time [s], the longest [s].
    pub long_gaps: Option<(u64, f64, f64)>,
    /// Longest span without a fix, outages aside: start and length [s].
    pub longest_without_gnss: (f64, f64),
    /// When the solution stopped being one, if it did [s].
    pub diverged: Option<f64>,
    /// Start of the first [`SUSPECT_UPDATES`] updates on end, or fewer at the end of the log, whose
    /// innovations were far beyond their predicted size [s].
    pub suspect: Option<f64>,
}

/// NIS per degree of freedom over this many updates …
pub const SUSPECT_UPDATES: u32 = 20;
/// … and above this value makes a solution suspect of divergence.
pub const SUSPECT_NIS: f64 = 25.0;

/// Updates, their NIS and degrees of freedom since the count began, and when that was [s].
#[derive(Default)]
pub(super) struct Streak {
    updates: u32,
    nis: f64,
    dof: u32,
    start: f64,
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

    pub(super) fn judge(&mut self, summary: &mut Summary) {
        let streak = std::mem::take(self);
        if streak.nis > SUSPECT_NIS * f64::from(streak.dof) && summary.suspect.is_none() {
            summary.suspect = Some(streak.start);
        }
    }
}
