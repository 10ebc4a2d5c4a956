//! The navigation state: a filter, and how far it has come within the present sample.
//!
//! Between two samples a solution is a filter and nothing else. Within one it may stop at the times of
//! measurements, go through a gap in steps of the usual interval, and grow its covariance by two things that
//! the linear model leaves out: motion in a long gap, and products of large errors.
//!
//! | gap before a sample | what happens |
//! |---|---|
//! | up to 1.5 intervals | nothing: a late sample |
//! | up to 0.2 s | bridged by rates on a line between both sides |
//! | up to 60 s | bridged, and the covariance grows: 0.2 rad/s of turn, 2 m/s² of acceleration, one σ each |
//! | longer | the solution ends ([`LONGEST_GAP`]), an alignment follows |

use super::{
    bridge::Bridge, measurement::Latency, observer::Observer, summary::Summary, watch::FAR,
};
use crate::estimator::{Estimator, STAMP_ROUNDING};
use alloc::boxed::Box;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_nav::{
    Vector3, aiding::Stretch, earth::STANDARD_GRAVITY, parameters::Parameter, sample::ImuSample,
};

/// A sample after more than this many intervals is a gap, not just late.
const GAP_INTERVALS: f64 = 1.5;
/// A gap longer than this is too long to interpolate over \[s\].
const LONGEST_BRIDGE: f64 = 0.2;
/// Acceleration that a vehicle may have unseen in a longer gap, one standard deviation \[m/s²\].
const UNSEEN_ACCEL: f64 = 2.0;
/// Turn rate that it may have there, one standard deviation \[rad/s\].
const UNSEEN_RATE: f64 = 0.2;
/// A gap longer than this ends the solution: the attitude is lost by then \[s\].
pub(super) const LONGEST_GAP: f64 = 60.0;
/// A time offset of more prior standard deviations than this is no offset but an error of the sensors.
pub(super) const MOST_LATE: f64 = 10.0;

/// Products of errors below this are negligible \[m/s²\].
const LEAST_PRODUCT: f64 = 1e-3;
/// Standard deviation beyond which an angle's error is not small \[rad\]: the heading's counts up to it, and of a tilt beyond it no product
/// does.
const MOST_ANGLE: f64 = 0.5;
/// How long a product of errors lasts, until a vehicle has turned or the errors are known \[s\].
const PRODUCT_LASTS: f64 = 5.0;

/// A mean velocity begins at the fix before within this \[s\]: rounded stamps, and a latency that changed.
const SAME_START: f64 = 2e-3;

#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Solution {
    /// Error state, covariance, and the navigation state.
    #[cfg_attr(feature = "checkpoint", serde(with = "crate::kept::filter"))]
    pub(super) filter: Box<dyn Estimator>,
    /// Time of its start \[s\].
    pub(super) began: f64,
    /// Motion since the last fix that was not withheld.
    stretch: Option<Stretch>,
    /// While a gap is being bridged.
    bridge: Option<Bridge>,
    /// Time of the last node of a smoother \[s\].
    last_node: f64,
    /// Up to when products of errors are in the covariance \[s\], and the velocity after the last fix [m/s].
    products_until: f64,
    velocity: Vector3,
}

/// A copy that records nothing for a smoother.
impl Clone for Solution {
    fn clone(&self) -> Self {
        Self {
            filter: self.filter.boxed(),
            bridge: self.bridge.clone(),
            ..*self
        }
    }
}

/// Moves the filter within its sample to `time` \[s\], with `None` to its end, and notes the motion.
fn advance(filter: &mut dyn Estimator, stretch: &mut Option<Stretch>, time: Option<f64>) {
    let before = *filter.nav();
    filter.advance(time);
    if let Some(stretch) = stretch {
        stretch.add(&before, filter.nav());
    }
}

impl Solution {
    pub(super) fn new(filter: Box<dyn Estimator>) -> Self {
        Self {
            began: filter.nav().time,
            products_until: filter.nav().time,
            velocity: filter.nav().v_n,
            filter,
            stretch: None,
            bridge: None,
            last_node: f64::NEG_INFINITY,
        }
    }

    /// Delay of the fixes against their stamps, as estimated, within ten prior standard deviations; of a solution that `failed`
    /// one beyond five is an error of it, which the next start must not inherit.
    ///
    /// A delay beyond that is no delay of a receiver but an error of the sensors that looks like one.
    pub(super) fn latency(&self, failed: bool) -> Latency {
        let offset = |kind| {
            let std = self.filter.parameters().prior(kind)?.std;
            let (offset, most) = (self.filter.time_offset(kind)?.0, MOST_LATE * std);
            Some(match failed && offset.abs() > FAR * std {
                true => 0.0,
                false => offset.clamp(-most, most),
            })
        };
        Latency {
            position: offset(Parameter::TimeOffset).unwrap_or(0.0),
            velocity: offset(Parameter::VelocityTimeOffset),
        }
    }

    /// Takes up a sample, bridged where samples are missing before it; `interval` is the usual one \[s\].
    ///
    /// `previous` is the sample before, for the rates on the other side of the gap.
    pub(super) fn begin(
        &mut self,
        sample: &ImuSample,
        previous: Option<&ImuSample>,
        interval: f64,
        summary: &mut Summary,
    ) {
        if sample.dt <= GAP_INTERVALS * interval {
            self.filter.begin(sample);
            return;
        }
        let mut bridge = Bridge::new(
            sample,
            previous.filter(|p| p.dt > 0.0),
            interval,
            LONGEST_BRIDGE,
        );
        match bridge.unknown_since {
            Some(start) => summary.long_gap(start, sample.dt),
            None => summary.bridged += 1,
        }
        if let Some(first) = bridge.next() {
            self.filter.begin(&first);
        }
        self.bridge = Some(bridge);
    }

    /// Moves the filter to `time` \[s\] within the present sample.
    ///
    /// In order of time; within a bridge it steps from one made-up sample to the next.
    pub(super) fn advance_to(&mut self, time: f64) {
        if let Some(bridge) = &mut self.bridge {
            while bridge.reached() < time - STAMP_ROUNDING
                && let Some(next) = bridge.next()
            {
                advance(&mut *self.filter, &mut self.stretch, None);
                self.filter.begin(&next);
            }
        }
        advance(&mut *self.filter, &mut self.stretch, Some(time));
    }

    /// Takes in that a fix, which is here, has updated the filter; where it begins, a stretch begins.
    pub(super) fn updated(&mut self, begins: bool) {
        self.velocity = self.filter.nav().v_n;
        if begins {
            self.stretch = Some(Stretch::new(self.filter.nav()));
        }
    }

    /// The motion over the `span` \[s\] before `due` \[s\], where a fix began it and the filter is not past its end.
    pub(super) fn stretch(&self, span: f64, due: f64) -> Option<Stretch> {
        let off = |stretch: &Stretch| (due - span - stretch.start).abs();
        let past = self.filter.nav().time - due;
        let stretch = self.stretch.filter(|stretch| off(stretch) < SAME_START);
        stretch.filter(|_| past.abs() < SAME_START)
    }

    /// Grows the covariance for the part of a long gap up to `time` \[s\] that it has not grown for.
    ///
    /// Called before a measurement is used in the gap, and at its end.
    pub(super) fn grow_to(&mut self, time: f64) {
        if let Some(bridge) = &mut self.bridge
            && let Some(since) = bridge.unknown_since
        {
            self.filter
                .inflate_over_gap((time - since).max(0.0), UNSEEN_RATE, UNSEEN_ACCEL);
            bridge.unknown_since = Some(time);
        }
    }

    /// Grows the covariance up to `time` \[s\] by what it leaves out: the specific force is wrong by the product of the errors of attitude
    /// and accelerometers, and by gravity times half the square of the tilt's. Of a sensor whose constants are hardly known (0.1 g, so
    /// 6 deg of tilt) that is 0.1 m/s² and more, and what a turn shows of tilt and constants would otherwise be taken to be exact. So is the
    /// product of the acceleration since the last fix and `scale`, one standard deviation of the accelerometers' scale factors [–]: lever arm
    /// and delays would be learned from it.
    ///
    /// The rest of a second-order filter's terms is neglected. Velocity grows by product · √(span ·
    /// 5 s) [m/s], one standard deviation of each axis.
    pub(super) fn grow_by_products(&mut self, time: f64, scale: f64) {
        let span = time - self.products_until;
        if span <= STAMP_ROUNDING {
            return;
        }
        self.products_until = time;
        let acceleration = (self.filter.nav().v_n - self.velocity).norm() / span;
        let (std, error) = (self.filter.nav_std(), self.filter.sensor_error_std());
        let tilt = std[6].hypot(std[7]);
        let attitude = tilt.hypot(std[8].min(MOST_ANGLE));
        let accel = error[3].max(error[4]).max(error[5]);
        let product =
            0.5 * STANDARD_GRAVITY * tilt * tilt + attitude * accel + scale * acceleration;
        if product > LEAST_PRODUCT && tilt < MOST_ANGLE {
            let velocity = product * (span * PRODUCT_LASTS).sqrt();
            self.filter.inflate(&Vector3::zeros(), velocity, 0.0);
        }
    }

    /// Whether the present sample ends a gap too long to say how the vehicle moved in it.
    pub(super) fn in_long_gap(&self) -> bool {
        let bridge = self.bridge.as_ref();
        bridge.is_some_and(|bridge| bridge.unknown_since.is_some())
    }

    /// The present sample ends.
    pub(super) fn end_sample(&mut self, time: f64) {
        self.advance_to(time);
        self.grow_to(time);
        self.bridge = None;
    }

    /// Reports a node to the observer, if there is a smoother: `span` is the longest one between two \[s\].
    ///
    /// `None` for `span` means that no smoother listens.
    pub(super) fn node(&mut self, span: Option<f64>, observer: &mut dyn Observer) {
        if span.is_some() {
            observer.node(&*self.filter, self.filter.adjoint().as_ref());
            self.filter.record();
            self.last_node = self.filter.nav().time;
        }
    }

    /// Whether a node is due at `time` \[s\].
    pub(super) fn node_is_due(&self, span: Option<f64>, time: f64) -> bool {
        span.is_some_and(|span| time - self.last_node >= span - STAMP_ROUNDING)
    }
}
