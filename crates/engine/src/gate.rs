//! Which fixes to believe: gates on the innovations, with recovery, and the receiver's own accuracy.
//!
//! A stated accuracy may be wrong by a large factor for a whole log, so limits are relative to the
//! usual size of the innovations: the median of the last normalised innovations squared over the
//! median of χ². A fix far beyond them is rejected, a doubtful one weakened (Huber's weights; Zhang 1997).
//!
//! Fixes that are left out one after the other and agree with each other may mean that it is the
//! solution that is wrong. After long enough the solution is reset to the fixes; at once while it is
//! unconfirmed: at its start, after a span without fixes, after such a reset. There a doubtful fix
//! also waits for a second one that agrees with it, so that an outlier alone never moves the solution.
//!
//! | state of the solution | down-weighted from | rejected from |
//! |---|---|---|
//! | confirmed | 5 times the usual NIS | 30 times |
//! | unconfirmed: fewer than 3 fixes accepted since a start, a gap of 3 s or a reset | 5 times | 10.2 times: one right fix in a million |
//! | NIS usually above 400 | never | never: there is nothing to judge by |
//!
//! The usual NIS is per degree of freedom, at least 1: 30 until ten innovations are known, then the median of
//! the last 40 over that of χ²(3)/3.

use super::summary::Summary;
use crate::median::upper_median;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_events::{Contradiction, Part};
use undrift_nav::{
    Matrix3, Vector3,
    filter::{Gate, Outcome, Update},
};

/// Innovations that the usual size is taken from.
const WINDOW: usize = 40;
/// Median of χ²(3)/3.
const MEDIAN: f64 = 0.789;

/// Innovations after which their usual size is known. Sizes are NIS per degree of freedom.
const LEAST: usize = 10;
/// Usual NIS until [`LEAST`] innovations are known: standard deviations five times too small.
const FIRST_USUAL: f64 = 30.0;
/// Usual NIS above which everything passes: twenty times the standard deviation.
const SENSELESS: f64 = 400.0;
/// NIS relative to the usual from which a fix is down-weighted.
const WEAKEN: f64 = 5.0;
/// NIS relative to the usual from which a fix is rejected.
const REJECT: f64 = 30.0;
/// [`REJECT`] while the solution is unconfirmed, where rejecting a right fix costs most: one in a million of right ones has
/// 30.7 of 3.
const REJECT_UNCONFIRMED: f64 = 10.2;
/// The solution is unconfirmed after this long without a fix \[s\].
const GAP: f64 = 3.0;
/// The solution is confirmed once it has accepted this many fixes.
const CONFIRM: u32 = 3;
/// Innovations agree when they differ by less than this part of their size.
const AGREE: f64 = 0.3;
/// Innovations also agree when they differ by less than this many standard deviations of two fixes.
const AGREE_SIGMAS: f64 = 2.0;
/// Fixes rejected within this time after the solution accepted others belong to the run before \[s\].
pub(super) const GOES_ON: f64 = 3.0;

/// Information of the logarithm of a [`Scale`] at first: a standard deviation of a factor of ten in the variance.
const PRIOR: f64 = 0.2;
/// Information that a [`Scale`] remembers; the logarithm's standard deviation is this to the power −½.
const MEMORY: f64 = 300.0;
/// Largest change of the logarithm by one fix.
const STEP: f64 = 0.5;
/// Largest logarithm.
const RANGE: f64 = 9.2;
/// Updates before the mean of a [`Scale`] is taken.
const SETTLE: u64 = 40;

/// What to do with a fix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Verdict {
    /// Update past these limits.
    Limits(Gate),
    /// Reset the solution to the fix: fixes that agree with each other have contradicted it for so long \[s\].
    ResetToFixes(f64),
}

/// The gate of one kind of measurement.
#[derive(Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct FixGate {
    part: Part,
    /// Whether it judges the height of positions alone.
    ///
    /// Noted in the contradiction, for messages.
    height: bool,
    /// NIS per degree of freedom of the last fixes, in a ring.
    #[cfg_attr(feature = "checkpoint", serde(with = "crate::kept::array"))]
    recent: [f64; WINDOW],
    count: usize,
    /// Time of the last fix of this kind, and of the last one accepted \[s\].
    seen: f64,
    accepted: f64,
    /// Accepted one after the other since the solution was last in doubt.
    confirmed: u32,
    /// Since when the fixes left out agree with each other \[s\], and the last one's innovation.
    agreeing: Option<(f64, Vector3)>,
    /// What is being left out.
    open: Option<Contradiction>,
    /// When the solution was last reset to the fixes \[s\], the latest first.
    resets: [f64; 3],
}

impl FixGate {
    /// `time` \[s\] from which a gap is counted.
    pub(super) fn new(part: Part, time: f64) -> Self {
        Self {
            part,
            height: false,
            recent: [0.0; WINDOW],
            count: 0,
            seen: time,
            accepted: time,
            confirmed: 0,
            agreeing: None,
            open: None,
            resets: [f64::NEG_INFINITY; 3],
        }
    }

    /// A gate of the height of positions alone.
    pub(super) fn for_height(time: f64) -> Self {
        Self {
            height: true,
            ..Self::new(Part::Position, time)
        }
    }

    /// The solution has been without aid for a while.
    pub(super) fn unconfirm(&mut self) {
        self.confirmed = 0;
        self.agreeing = None;
    }

    /// Whether fixes are being left out, or the solution is unconfirmed.
    pub(super) fn is_in_doubt(&self) -> bool {
        self.agreeing.is_some() || self.confirmed < CONFIRM
    }

    /// What to do with a fix of this innovation and covariance; `patience` is for how long fixes that
    /// agree with each other are left out \[s\].
    ///
    /// A fix agrees with the one before where their innovations differ by less than 0.3 of their size, or by
    /// less than two standard deviations of two fixes.
    ///
    /// Limits are on the NIS of all three numbers, not per degree of freedom. The innovation is
    /// predicted less measured, `r` the covariance of the fix alone. Changes nothing but the state
    /// of doubt: [`FixGate::note`] follows with the outcome.
    pub(super) fn judge(
        &mut self,
        time: f64,
        innovation: &Vector3,
        r: &Matrix3,
        patience: f64,
    ) -> Verdict {
        if time - self.seen > GAP {
            self.unconfirm();
        }
        self.seen = time;
        let unconfirmed = self.confirmed < CONFIRM;
        if let Some((since, last)) = self.agreeing {
            let noise = AGREE_SIGMAS * (2.0 * r.trace()).sqrt();
            if (innovation - last).norm() > noise.max(AGREE * innovation.norm()) {
                self.agreeing = None;
            } else {
                if unconfirmed || time - since >= patience {
                    return Verdict::ResetToFixes((time - self.accepted).max(1.0));
                }
            }
        }
        let unit = self.usual().max(1.0) * 3.0;
        let weaken = WEAKEN * unit;
        let reject = if unconfirmed {
            REJECT_UNCONFIRMED * unit
        } else {
            REJECT * unit
        };
        Verdict::Limits(Gate { weaken, reject })
    }

    /// Notes whether a fix was used, weakened or rejected; `frozen` where the receiver repeats itself while the solution moves.
    ///
    /// A rejected fix opens a contradiction or prolongs it; an accepted one closes it.
    pub(super) fn note(
        &mut self,
        time: f64,
        innovation: &Vector3,
        update: &Update,
        frozen: bool,
        summary: &mut Summary,
    ) {
        let nis = update.nis / update.dof as f64;
        if update.outcome != Outcome::Rejected {
            self.learn(nis);
            self.accepted = time;
            self.confirmed += 1;
            if let (Some((_, last)), Some(open)) = (self.agreeing.take(), &mut self.open) {
                // The solution has become so unsure that it takes in what it rejected.
                open.accepted_in_the_end |= (innovation - last).norm() < AGREE * innovation.norm();
            }
            self.close(summary);
            return;
        }
        if self.agreeing.is_none() && self.open.is_some() {
            // Noise of a new size and not a jump: the usual size is to follow.
            self.learn(nis.min(REJECT * self.usual().max(1.0)));
        }
        let since = self.agreeing.map_or(time, |(since, _)| since);
        self.agreeing = Some((since, *innovation));
        let size = innovation.norm();
        let open = self.open.get_or_insert(Contradiction {
            part: self.part,
            height: self.height,
            start: time,
            end: time,
            fixes: 0,
            first: size,
            last: size,
            growth: 0.0,
            largest: size,
            frozen: false,
            accepted_in_the_end: false,
        });
        open.end = time;
        open.fixes += 1;
        open.last = size;
        open.largest = open.largest.max(size);
        open.frozen |= frozen;
    }

    /// The solution was reset to a fix of this innovation.
    pub(super) fn reset_to_fix(&mut self, time: f64, innovation: &Vector3, summary: &mut Summary) {
        if let Some(open) = &mut self.open {
            open.end = time;
            open.last = innovation.norm();
            open.largest = open.largest.max(open.last);
            open.accepted_in_the_end = true;
        }
        self.close(summary);
        self.resets = [time, self.resets[0], self.resets[1]];
        self.accepted = time;
        self.unconfirm();
    }

    /// Ends the run of rejected fixes that is open, if any.
    pub(super) fn close(&mut self, summary: &mut Summary) {
        if let Some(mut open) = self.open.take() {
            if open.end > open.start {
                open.growth = (open.last - open.first) / (open.end - open.start);
            }
            summary.contradicted(open, GOES_ON);
        }
    }

    /// Time since which the solution was reset three times \[s\].
    pub(super) fn third_last(&self) -> f64 {
        self.resets[2]
    }

    /// Keeps the normalised innovation squared of a fix, per degree of freedom, for the usual size.
    ///
    /// Accepted fixes, and of rejected ones that do not agree with each other the NIS up to the
    /// limit.
    fn learn(&mut self, nis: f64) {
        self.recent[self.count % WINDOW] = nis;
        self.count += 1;
    }

    /// Whether innovations are usually so large that there is nothing to judge a fix by: the solution
    /// does not predict the fixes.
    pub(super) fn is_senseless(&self) -> bool {
        self.usual() > SENSELESS
    }

    /// Usual NIS per degree of freedom: 1 when the stated accuracy is right.
    fn usual(&self) -> f64 {
        if self.count < LEAST {
            return FIRST_USUAL;
        }
        let mut recent = self.recent;
        upper_median(&mut recent[..self.count.min(WINDOW)]) / MEDIAN
    }
}

/// The factor between stated and actual covariance of one kind of measurement, by recursive maximum
/// likelihood of the innovations (Ljung & Söderström 1983, section 3.6): a step along the score over
/// the information.
///
/// A factor of ten in the variance is one standard deviation of what is expected at first; 300 units of
/// information are remembered, so that it follows a receiver whose accuracy changes. One outlier moves its
/// logarithm by at most a half.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Scale {
    /// Logarithm of the factor on the variance.
    log: f64,
    /// Information about it, at most [`MEMORY`].
    information: f64,
    updates: u64,
    /// Weighted sum of the logarithm, and of the weights: later ones count for more.
    sum: f64,
    weight: f64,
}

impl Scale {
    pub(super) fn new() -> Self {
        Self::with_information(PRIOR)
    }

    /// With so much information that the stated covariance is right.
    pub(super) fn with_information(information: f64) -> Self {
        Self {
            log: 0.0,
            information,
            updates: 0,
            sum: 0.0,
            weight: 0.0,
        }
    }

    /// Factor on the covariance.
    pub(super) fn factor(&self) -> f64 {
        self.log.exp()
    }

    /// Mean factor on the standard deviation, once it has settled.
    pub(super) fn mean(&self) -> Option<f64> {
        (self.updates > 2 * SETTLE).then(|| (0.5 * self.sum / self.weight).exp())
    }

    /// Learns as [`Scale::learn`], never to less than is stated.
    pub(super) fn learn_no_less(&mut self, update: &Update) {
        self.learn(update);
        self.log = self.log.max(0.0);
    }

    /// Factor on the covariance that is at least necessary, within a standard deviation.
    pub(super) fn least_factor(&self) -> f64 {
        let std = self.information.sqrt().recip();
        (self.log - std).max(0.0).exp()
    }

    /// Learns from an update with the covariance as scaled.
    ///
    /// `update.score` is the derivative of the log-likelihood by the logarithm of the factor,
    /// `update.information` its variance.
    pub(super) fn learn(&mut self, update: &Update) {
        if update.outcome == Outcome::Rejected {
            return;
        }
        self.information = (self.information + update.information).min(MEMORY);
        let score = update.score.min(4.0 * update.information.sqrt());
        self.log += (score / self.information).clamp(-STEP, STEP);
        self.log = self.log.clamp(-RANGE, RANGE);
        self.updates += 1;
        if self.updates > SETTLE {
            let weight = (self.updates - SETTLE) as f64;
            self.sum += weight * self.log;
            self.weight += weight;
        }
    }
}

#[cfg(test)]
mod tests;
