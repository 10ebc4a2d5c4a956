//! Headings by two antennas: which of them the filter is updated with.
//!
//! A receiver that finds a wrong number of carrier wavelengths has a heading that is wrong by tens of degrees and as certain as a
//! right one, for one epoch or for minutes. So:
//!
//! * a heading is gated by the solution; where the solution hardly knows it, most of the last ten seconds have to agree with it;
//! * headings that agree with each other and contradict the solution for a minute mean that the antennas lie otherwise than configured
//!   ([`Parameter::HeadingOffset`] is renewed), or, of a solution that began with them and never moved, that it began with wrong
//!   ones, if those were fewer (its heading's σ grows to what is seen);
//! * the stated σ is scaled by what innovations show, never below what is stated; of several headings within a second, whose errors are
//!   those of the same reflections, the information is that of one.

use crate::{
    aid::Aiding,
    consensus::{AGREE, FLOOR, LASTS, Recent},
    estimator::Estimator,
    gate::Scale,
    summary::{MOST_EVENTS, Summary},
};
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_events::{Aid, RejectedHeadings};
use undrift_nav::{
    Matrix3,
    earth::wrap_pi,
    filter::{Gate, Outcome},
    parameters::Parameter,
    sample::Scalar,
};

/// NIS from which a heading is down-weighted, and from which it is rejected: ten standard deviations.
const GATE: Gate = Gate {
    weaken: 9.0,
    reject: 100.0,
};
/// Information of [`Scale`] at first: a standard deviation of 1.4 in the variance.
const PRIOR: f64 = 10.0;
/// Standard deviation of a predicted heading above which a wrong one cannot be seen by it \[rad\].
const UNSURE: f64 = 0.05;
/// Standard deviation of a direction that may be any \[rad\].
const ANY: f64 = 1.8;
/// Headings that contradict the solution agree within this \[rad\].
const SAME: f64 = 0.2;
/// Headings in a row that disagree with those before are others.
const OTHERS: u32 = 3;
/// Headings that agree contradict the solution for so long before they are believed \[s\].
const PATIENCE: f64 = 60.0;
/// Speed from which GNSS shows a wrong heading \[m/s\].
const MOVES: f64 = 3.0;
/// Rejected headings in a row that are an event; single ones are counted.
const EVENT: u64 = 3;

/// The headings beside a solution.
#[derive(Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Headings {
    scale: Scale,
    last: f64,
    recent: Recent,
    /// Time at which the solution began, and whether anything but headings shows its heading.
    began: f64,
    moved: bool,
    /// Headings that are being rejected.
    open: Option<RejectedHeadings>,
    /// Last ones of them that are others.
    others: u32,
}

impl Headings {
    pub(crate) fn new() -> Self {
        Self {
            scale: Scale::with_information(PRIOR),
            last: f64::NEG_INFINITY,
            recent: Recent::default(),
            began: f64::NEG_INFINITY,
            moved: false,
            open: None,
            others: 0,
        }
    }

    /// Another solution begins at `time` \[s\], `by_headings` alone.
    pub(crate) fn restart(&mut self, time: f64, by_headings: bool, summary: &mut Summary) {
        self.close(summary);
        self.recent = Recent::default();
        (self.began, self.moved) = (time, !by_headings);
    }

    /// Updates the filter with the heading of antennas that lie at `baseline` \[rad\] in the body, or rejects it.
    pub(crate) fn update(
        &mut self,
        filter: &mut dyn Estimator,
        measured: &Scalar,
        baseline: f64,
        summary: &mut Summary,
    ) {
        let heading = measured.value;
        let aiding = &Aiding::Heading { heading, baseline };
        let innovation = |filter: &dyn Estimator| filter.innovation(aiding).map(|v| v.x);
        let Some(off) = innovation(filter) else {
            return;
        };
        self.moved |= filter.nav().v_n.xy().norm() > MOVES;
        self.recent.add(measured, -off);
        if predicted_std(filter) > UNSURE {
            let Some((angle, std)) = self.recent.agreed(measured.time) else {
                return;
            };
            if wrap_pi(angle + off).abs() > AGREE + 3.0 * std.hypot(measured.std) {
                summary.innovations[Aid::Heading].rejected += 1;
                return;
            }
        }
        let alike = (LASTS / (measured.time - self.last)).max(1.0);
        self.last = measured.time;
        let std = measured.std.max(FLOOR);
        // What the antennas turn by in the time that the fixes' delay is unsure by.
        let late = filter.time_offset(Parameter::TimeOffset);
        let late = late.map_or(0.0, |(_, std)| std) * filter.omega_nb_b().norm();
        let variance = std * std * alike * self.scale.least_factor() + late * late;
        let noise = Matrix3::identity() * variance;
        let Ok(Some(update)) = filter.update(aiding, &noise, &GATE) else {
            return;
        };
        summary.innovations[Aid::Heading].add(update);
        self.scale.learn_no_less(&update);
        if update.outcome == Outcome::Rejected {
            self.reject(filter, measured.time, -off, summary);
        } else {
            self.close(summary);
            self.recent
                .turn(off - innovation(filter).unwrap_or_default());
        }
    }

    /// Notes a rejected heading that is `angle` \[rad\] off; where they have agreed for long, what contradicts them is doubted.
    fn reject(&mut self, filter: &mut dyn Estimator, time: f64, angle: f64, summary: &mut Summary) {
        // A wrong one among those that agree ends nothing.
        let other = |open: RejectedHeadings| wrap_pi(open.angle - angle).abs() > SAME;
        self.others = match self.open.is_some_and(other) {
            true => self.others + 1,
            false => 0,
        };
        match self.others {
            0 => {}
            OTHERS.. => self.close(summary),
            _ => return,
        }
        let open = self.open.get_or_insert(RejectedHeadings {
            start: time,
            end: time,
            headings: 0,
            angle,
            accepted_in_the_end: false,
        });
        (open.end, open.angle) = (time, angle);
        open.headings += 1;
        let estimated = filter.parameters().prior(Parameter::HeadingOffset);
        // At rest the others are believed that went on for longer.
        let patience = match self.moved {
            true => PATIENCE,
            false => PATIENCE.max(open.start - self.began),
        };
        if time - open.start < patience || (self.moved && estimated.is_none()) {
            return;
        }
        open.accepted_in_the_end = true;
        match self.moved {
            true => filter.renew(Parameter::HeadingOffset, ANY),
            false => filter.inflate_heading(angle.abs(), 0.0),
        }
        self.close(summary);
    }

    /// Ends the run of rejected headings that is open, if any.
    pub(crate) fn close(&mut self, summary: &mut Summary) {
        if let Some(open) = self.open.take()
            && open.headings >= EVENT
            && summary.rejected_headings.len() < MOST_EVENTS
        {
            summary.rejected_headings.push(open);
        }
    }
}

/// Standard deviation of a predicted heading of level antennas \[rad\].
fn predicted_std(filter: &dyn Estimator) -> f64 {
    let p = filter.covariance();
    let at = filter.parameter_start(Parameter::HeadingOffset);
    let offset = at.map_or(0.0, |at| p[(at, at)] + 2.0 * p[(8, at)]);
    (p[(8, 8)] + offset).max(0.0).sqrt()
}
