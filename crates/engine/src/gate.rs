//! Which fixes to believe: gates on the innovations, with recovery, and the receiver's own accuracy.
//!
//! A stated accuracy may be wrong by a large factor for a whole log, so limits are relative to the
//! usual size of the innovations: the median of the last normalised innovations squared over the
//! median of χ². A fix far beyond them is rejected, a doubtful one weakened (Huber's weights; Zhang 1997).
//!
//! Fixes that are left out one after the other and agree with each other may mean that it is the
//! solution that is wrong. It gives way to them when they have gone on for a while; at once while it is
//! unconfirmed: at its start, after a span without fixes, after it gave way. There a doubtful fix
//! also waits for a second one that agrees with it, so that an outlier alone never moves the solution.

use super::{
    events::{Contradiction, Part},
    summary::Summary,
};
use crate::median::upper_median;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
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
/// The same while the solution is unconfirmed, where rejecting a right fix costs most: one in a million of right ones has
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
const GOES_ON: f64 = 3.0;

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
    /// Past these limits.
    Limits(Gate),
    /// The solution has to give way to it; the fixes have contradicted it for so long \[s\].
    GiveWay(f64),
}

/// The gate of one kind of measurement.
#[derive(Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct FixGate {
    part: Part,
    /// Whether it judges the height of positions alone.
    height: bool,
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
    /// When the solution last gave way \[s\], the latest first.
    gave_way: [f64; 3],
}

impl FixGate {
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
            gave_way: [f64::NEG_INFINITY; 3],
        }
    }

    /// A gate of the height of positions alone.
    pub(super) fn of_height(time: f64) -> Self {
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
                    return Verdict::GiveWay((time - self.accepted).max(1.0));
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

    /// Notes what became of a fix; `frozen` where the receiver repeats itself while the solution moves.
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
                open.gave_way |= (innovation - last).norm() < AGREE * innovation.norm();
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
            gave_way: false,
        });
        open.end = time;
        open.fixes += 1;
        open.last = size;
        open.largest = open.largest.max(size);
        open.frozen |= frozen;
    }

    /// The solution gave way to a fix of this innovation.
    pub(super) fn give_way(&mut self, time: f64, innovation: &Vector3, summary: &mut Summary) {
        if let Some(open) = &mut self.open {
            open.end = time;
            open.last = innovation.norm();
            open.largest = open.largest.max(open.last);
            open.gave_way = true;
        }
        self.close(summary);
        self.gave_way = [time, self.gave_way[0], self.gave_way[1]];
        self.accepted = time;
        self.unconfirm();
    }

    /// Writes down what was being left out.
    pub(super) fn close(&mut self, summary: &mut Summary) {
        if let Some(mut open) = self.open.take() {
            if open.end > open.start {
                open.growth = (open.last - open.first) / (open.end - open.start);
            }
            summary.contradicted(open, GOES_ON);
        }
    }

    /// Since when the solution has given way three times \[s\].
    pub(super) fn third_last(&self) -> f64 {
        self.gave_way[2]
    }

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
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Scale {
    log: f64,
    information: f64,
    updates: u64,
    /// Weighted sum of the logarithm, and of the weights: later ones count for more.
    sum: f64,
    weight: f64,
}

impl Scale {
    pub(super) fn new() -> Self {
        Self {
            log: 0.0,
            information: PRIOR,
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

    /// Learns from an update with the covariance as scaled.
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
mod tests {
    use super::*;
    use alloc::{string::String, vec::Vec};

    const SIGMA: f64 = 0.1;

    fn update(nis: f64, gate: &Gate) -> Update {
        Update {
            nis,
            dof: 3,
            whitened: [0.0; 3],
            score: 0.0,
            information: 1.5,
            outcome: if nis > gate.reject {
                Outcome::Rejected
            } else {
                Outcome::Used
            },
        }
    }

    /// Shows fixes with these innovations north at 4 Hz from `start` on; what became of each.
    fn show(gate: &mut FixGate, start: f64, innovations: &[f64], summary: &mut Summary) -> String {
        let r = Matrix3::identity() * (SIGMA * SIGMA);
        let mut time = start;
        let mut seen = String::new();
        for x in innovations {
            let innovation = Vector3::new(*x, 0.0, 0.0);
            match gate.judge(time, &innovation, &r, 15.0) {
                Verdict::GiveWay(_) => {
                    gate.give_way(time, &innovation, summary);
                    seen.push('g');
                }
                Verdict::Limits(limits) => {
                    let update = update((x / SIGMA).powi(2), &limits);
                    gate.note(time, &innovation, &update, false, summary);
                    seen.push(if update.outcome == Outcome::Rejected {
                        'r'
                    } else {
                        '.'
                    });
                }
            }
            time += 0.25;
        }
        seen
    }

    fn settled(summary: &mut Summary) -> FixGate {
        let mut gate = FixGate::new(Part::Position, 0.0);
        assert_eq!(show(&mut gate, 0.0, &[0.15; 40], summary), ".".repeat(40));
        gate
    }

    #[test]
    fn a_jump_is_left_out_and_written_down() {
        let mut summary = Summary::default();
        let mut gate = settled(&mut summary);
        assert_eq!(
            show(&mut gate, 10.0, &[0.1, 50.0, 0.1], &mut summary),
            ".r."
        );
        let jump = summary.contradictions[0];
        assert_eq!((jump.start, jump.end, jump.fixes), (10.25, 10.25, 1));
        assert_eq!(jump.largest, 50.0);
    }

    #[test]
    fn jumps_that_do_not_agree_never_win_but_noise_of_a_new_size_does() {
        let mut summary = Summary::default();
        let mut gate = settled(&mut summary);
        let wild: Vec<f64> = (0..12)
            .map(|i| if i % 2 == 0 { 30.0 } else { -50.0 })
            .collect();
        assert_eq!(show(&mut gate, 10.0, &wild, &mut summary), "r".repeat(12));
        let noisier: Vec<f64> = (0..60)
            .map(|i| if i % 2 == 0 { 1.5 } else { -1.5 })
            .collect();
        let seen = show(&mut gate, 13.0, &noisier, &mut summary);
        assert!(seen.starts_with('r') && seen.ends_with('.'), "{seen}");
    }

    #[test]
    fn a_lasting_jump_wins_after_the_patience() {
        let mut summary = Summary::default();
        let mut gate = settled(&mut summary);
        let seen = show(&mut gate, 10.0, &[20.0; 61], &mut summary);
        assert_eq!(seen, "r".repeat(60) + "g");
        assert!(summary.contradictions[0].gave_way);
    }

    #[test]
    fn after_an_outage_two_that_agree_win_and_one_alone_does_not() {
        let mut summary = Summary::default();
        let mut gate = settled(&mut summary);
        assert_eq!(show(&mut gate, 40.0, &[9.0, 0.1, 0.1], &mut summary), "r..");
        let mut gate = settled(&mut summary);
        assert_eq!(show(&mut gate, 40.0, &[9.0, 9.1], &mut summary), "rg");
    }

    #[test]
    fn the_scale_finds_the_variance() {
        // Scalar innovations of variance 1 + 4·R, R stated 1.
        let mut scale = Scale::new();
        for i in 0..2000 {
            // Quantiles of the uniform distribution with the right variance, out of order.
            let u = f64::from((i * 617) % 2000) / 1999.0 * 2.0 - 1.0;
            let nu = u * (3.0f64 * 5.0).sqrt();
            let r = scale.factor();
            let s = 1.0 + r;
            let share = r / s;
            scale.learn(&Update {
                nis: nu * nu / s,
                dof: 1,
                whitened: [0.0; 3],
                score: 0.5 * share * (nu * nu / s - 1.0),
                information: 0.5 * share * share,
                outcome: Outcome::Used,
            });
        }
        assert!(
            (scale.factor() / 4.0 - 1.0).abs() < 0.2,
            "{}",
            scale.factor()
        );
    }

    #[test]
    fn a_fix_is_weakened_where_right_ones_are_rare_and_rejected_where_there_are_no_right_ones() {
        let limits = |size: f64| {
            let mut summary = Summary::default();
            let mut gate = FixGate::new(Part::Position, 0.0);
            let usual = [size * SIGMA; 40];
            assert_eq!(show(&mut gate, 0.0, &usual, &mut summary), ".".repeat(40));
            let r = Matrix3::identity() * (SIGMA * SIGMA);
            gate.judge(10.0, &Vector3::zeros(), &r, 15.0)
        };
        // χ² of three components is beyond 15 once in 540 right fixes, beyond 90 never.
        let (weaken, reject) = (15.0, 90.0);
        assert_eq!(limits(1.0), Verdict::Limits(Gate { weaken, reject }));
        // Where innovations are usually larger, the limits are as many times the usual: here a squared size of 9 in place
        // of the median of χ², 2.366 (Abramowitz & Stegun, table 26.8; MEDIAN has three digits).
        let Verdict::Limits(larger) = limits(3.0) else {
            panic!("nothing was rejected");
        };
        let times = 9.0 / 2.366;
        assert!((larger.weaken / (weaken * times) - 1.0).abs() < 1e-3);
        assert!((larger.reject / (reject * times) - 1.0).abs() < 1e-3);
    }
    #[test]
    fn after_a_gap_the_solution_is_to_be_confirmed_again() {
        let mut summary = Summary::default();
        let r = Matrix3::identity() * (SIGMA * SIGMA);
        for (pause, doubted) in [(0.99 * GAP, false), (1.01 * GAP, true)] {
            let mut gate = settled(&mut summary);
            assert!(!gate.is_in_doubt());
            // The last of the forty came at 9.75 s.
            gate.judge(9.75 + pause, &Vector3::zeros(), &r, 15.0);
            assert_eq!(gate.is_in_doubt(), doubted, "{pause}");
        }
    }

    #[test]
    fn a_solution_that_takes_in_what_it_rejected_has_given_way_to_it() {
        let gave_way = |rejected: f64, then: f64| {
            let mut summary = Summary::default();
            let mut gate = settled(&mut summary);
            let note = |gate: &mut FixGate, time, x, outcome, summary: &mut Summary| {
                let limits = Gate {
                    weaken: 1e9,
                    reject: 1e9,
                };
                let update = Update {
                    outcome,
                    ..update(1e6, &limits)
                };
                gate.note(time, &Vector3::new(x, 0.0, 0.0), &update, false, summary);
            };
            note(&mut gate, 10.0, rejected, Outcome::Rejected, &mut summary);
            note(&mut gate, 10.25, then, Outcome::Used, &mut summary);
            assert_eq!(summary.contradictions.len(), 1);
            summary.contradictions[0].gave_way
        };
        // As large to three tenths, whatever its size.
        for size in [0.1, 1.0, 20.0] {
            assert!(gave_way(1.29 * size, size) && gave_way(0.71 * size, size));
            assert!(!gave_way(1.31 * size, size) && !gave_way(0.69 * size, size));
            assert!(!gave_way(-size, size));
        }
    }
}
