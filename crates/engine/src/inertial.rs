//! Samples that cannot be right: replaced before the filter has them, and doubted for as long as they last.
//!
//! Looked for on each axis of the sensor, in its own axes: a *spike*, one sample far from both of its neighbours, which
//! agree with each other; a *frozen* axis, which repeats a value far longer than it usually does; a *saturated* one, which
//! does so at the end of its range. A spike is replaced by the mean of its neighbours, the two others by what the
//! axis reads on the average. What an axis may have read meanwhile is in doubt by its usual spread: correlated
//! over [`TURN_LASTS`], so that it grows with the time squared first and linearly then.
//!
//! The usual behaviour of an axis is learned from its sound values: how far nine samples in ten are from the
//! mean of their neighbours (by stochastic approximation of that quantile), how many samples a value lasts,
//! mean and variance over a minute, and the largest and smallest value so far. Until 500 values are known
//! nothing is judged. A sensor that repeats all of its values at rest for 5 s is a simulated one without noise,
//! of which repetitions say nothing.
//!
//! Units inside are rates [rad/s] and specific forces [m/s²]: increments over their interval,
//! turned to the sensor's own axes, since a fault is of one axis. What comes out is a sample in
//! body axes again, with the covariance of what is in doubt ([`Checked`]), which [`crate::run`]
//! adds to the filter after the sample.
//!
//! Price: the solution is one sample behind the log. Cost O(1) a sample. It may replace values and
//! name faults in the summary; whether a sample is used at all is decided before, by
//! [`Navigator::imu`](crate::Navigator::imu).

use super::{checked::Checked, summary::Summary};
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_nav::{
    Matrix3, Vector3,
    covariance::AXES,
    repeats::{FROZEN_TIMES, Repeats, SATURATED_TIMES},
    sample::ImuSample,
};

/// Values of an axis after which its usual behaviour is known.
const LEAST_VALUES: u64 = 500;
/// A spike is this many times further from the mean of its neighbours than nine in ten samples.
const SPIKE_STEPS: f64 = 25.0;
/// Least distance of a gyro's spike from that mean \[rad/s\].
const SPIKE_RATE: f64 = 1.0;
/// Least distance of an accelerometer's spike from that mean \[m/s²\]: a pothole does less in one sample.
const SPIKE_FORCE: f64 = 30.0;
/// The neighbours of a spike are apart by no more than this part of how far it is from their mean.
const SPIKE_APART: f64 = 0.3;
/// An axis whose values usually last fewer samples than this never repeats one.
const ALONE: f64 = 1.5;
/// On such an axis a repeated value this many times further from the previous one is the end of its range.
const JUMP_STEPS: f64 = 5.0;
/// Share by which the usual distance to the neighbours' mean follows each sample.
const STEP_GAIN: f64 = 0.05;
/// The replacement of a spike is uncertain by this many usual distances.
const REPLACED_STEPS: f64 = 5.0;
/// A frozen axis repeats a value for this long \[s\].
const FROZEN: f64 = 0.5;
/// If all axes of a sensor repeat their values for this long at rest \[s\], repetitions carry no information.
const NOISELESS: f64 = 5.0;
/// Speed of the solution above which the vehicle does not rest \[m/s\]: walking pace.
pub(super) const MOVES: f64 = 1.0;
/// The value of a saturated axis is this many usual standard deviations from its mean.
const SATURATED_SPREAD: f64 = 4.0;
/// Time over which the usual behaviour of an axis is averaged \[s\].
const USUAL: f64 = 60.0;
/// Duration of a turn or an acceleration that a stuck axis misses \[s\].
const TURN_LASTS: f64 = 5.0;
/// Turn rate that a stuck axis may at least miss \[rad/s\].
const RATE: f64 = 0.3;
/// Acceleration that a stuck axis may at least miss \[m/s²\].
const FORCE: f64 = 1.0;

/// Watches the six axes; one sample is held back, to see what follows it.
#[derive(Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Inertial {
    /// Rotation from the sensor's axes to the body's.
    rotation: Matrix3,
    before: Option<[f64; AXES]>,
    pending: Option<(ImuSample, [f64; AXES])>,
    /// Whether all axes repeat their values while the vehicle is at rest: a simulated sensor without noise.
    noiseless: bool,
    axes: [AxisWatch; AXES],
}

/// What an axis usually does. Values are rates \[rad/s\] and specific forces \[m/s²\].
#[derive(Clone, Copy, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
struct AxisWatch {
    /// How long values last.
    values: Repeats,
    /// Interval of the present value's first sample \[s\].
    dt: f64,
    /// Mean and variance over [`USUAL`].
    mean: f64,
    variance: f64,
    /// How much of [`USUAL`] has been seen \[s\]: the gain of the averages is dt over it.
    known: f64,
    /// Nine in ten samples are closer than this to the mean of their neighbours.
    step: f64,
    /// Values that the usual step was learned from.
    seen: u64,
    /// Whether the present value came by a jump that no vehicle makes, and stays.
    jumped: bool,
    /// Since when the axis has been in doubt \[s\].
    doubted: Option<f64>,
}

impl AxisWatch {
    /// Takes in a value; whether the axis holds it for longer than it can.
    ///
    /// Frozen: for half a second and 20 times the usual number of samples. Saturated: at the largest or
    /// smallest value so far, four standard deviations from the mean, for five times the usual number.
    ///
    /// `time` and `dt` \[s\] of the sample. A value counts as the same to 1e-12 of its size, as a
    /// rate or as an increment.
    fn is_stuck(&mut self, (time, dt): (f64, f64), value: f64) -> bool {
        // Of a log of increments those repeat, while the rounding of its times changes the rates.
        let present = self.values.present;
        let same = is_same(value, present.value) || is_same(value * dt, present.value * self.dt);
        if same && present.samples > 0 {
            self.values.prolong(time);
        } else {
            self.values.renew(time, value);
            self.dt = dt;
            self.jumped = false;
        }
        let values = &self.values;
        if values.ended < LEAST_VALUES {
            return false;
        }
        let lasts = time - values.present.start >= FROZEN;
        let extreme = value <= values.least.value || value >= values.most.value;
        // Most values are neither.
        if self.jumped || !(lasts || extreme) {
            return self.jumped;
        }
        let times = values.present.samples as f64 / values.usual();
        let far = (value - self.mean).abs() > SATURATED_SPREAD * self.variance.sqrt();
        (lasts && times >= FROZEN_TIMES) || (far && extreme && times >= SATURATED_TIMES)
    }

    /// Whether this value, as far from the one before as a spike, comes again: a range that ends there.
    ///
    /// `least` is [`SPIKE_RATE`] or [`SPIKE_FORCE`], `around` the values before and after; true as
    /// long as the value stays.
    fn jumps(&mut self, least: f64, around: [f64; 2], value: f64) -> bool {
        // What comes again is rare, and quickly seen.
        if self.jumped || !is_same(value, around[1]) || self.seen < LEAST_VALUES {
            return self.jumped;
        }
        let off = (value - around[0]).abs();
        // Of an axis that never repeats a value less is enough.
        let repeats = self.values.usual() > ALONE;
        let limit = if repeats {
            (SPIKE_STEPS * self.step).max(least)
        } else {
            (JUMP_STEPS * self.step).max(0.5 * least)
        };
        self.jumped = off > limit;
        self.jumped
    }

    /// Learns from a sound value of `dt` \[s\].
    ///
    /// Exponential averages with a memory of a minute; sound values only, so that a fault does not
    /// become the usual.
    fn learn(&mut self, dt: f64, value: f64) {
        self.known = (self.known + dt).min(USUAL);
        let gain = dt / self.known;
        let off = value - self.mean;
        self.mean += gain * off;
        self.variance += gain * (off * off - self.variance);
    }

    /// Whether a value is a spike between its neighbours.
    ///
    /// 25 times the usual distance from the mean of its neighbours and `least`, while these agree to 0.3 of
    /// that; any other sample is learned from.
    ///
    /// The quantile goes up by 4.5 % when exceeded and down by 0.5 % otherwise: in balance where
    /// one value in ten exceeds it.
    fn is_spike(&mut self, least: f64, around: [f64; 2], value: f64) -> bool {
        let off = (value - 0.5 * (around[0] + around[1])).abs();
        let apart = (around[1] - around[0]).abs();
        let known = self.seen >= LEAST_VALUES;
        if known && off > (SPIKE_STEPS * self.step).max(least) && apart < SPIKE_APART * off {
            return true;
        }
        self.seen += 1;
        // The quantile by stochastic approximation: up nine times as far as down.
        if self.step == 0.0 {
            self.step = off;
        } else if off > self.step {
            self.step *= 1.0 + 0.9 * STEP_GAIN;
        } else {
            self.step *= 1.0 - 0.1 * STEP_GAIN;
        }
        false
    }
}

/// Values that differ by less, relative to their size, are the same: turned to the body's axes and back.
const SAME: f64 = 1e-12;

/// Whether an axis repeats its value, to the rounding of a rotation.
fn is_same(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME * (1.0 + a.abs())
}

impl Inertial {
    pub(super) fn new(rotation: Matrix3) -> Self {
        Self {
            rotation,
            before: None,
            pending: None,
            noiseless: false,
            axes: [AxisWatch::default(); AXES],
        }
    }

    /// Takes in a sample; the one before it, now that it is known what follows.
    ///
    /// `moves` is whether the solution moves: all axes of a simulated sensor without noise repeat their values with the
    /// vehicle at rest. Of such a sensor a value that lasts says nothing, not in a turn of constant rate either.
    ///
    /// `None` of the first sample. Faults are noted in `summary` with axis and span.
    pub(super) fn next(
        &mut self,
        sample: ImuSample,
        moves: bool,
        summary: &mut Summary,
    ) -> Option<Checked> {
        let to_sensor = |v: &Vector3| self.rotation.tr_mul(v) / sample.dt;
        let (rate, force) = (to_sensor(&sample.dtheta), to_sensor(&sample.dvel));
        let values = [rate.x, rate.y, rate.z, force.x, force.y, force.z];
        let ready = self.pending.replace((sample, values));
        ready.map(|ready| self.check(ready, Some((&sample, values)), moves, summary))
    }

    /// The last sample.
    pub(super) fn last(&mut self, moves: bool, summary: &mut Summary) -> Option<Checked> {
        let ready = self.pending.take()?;
        Some(self.check(ready, None, moves, summary))
    }

    /// Replaces what cannot be right in a sample, given the one after it, and says what is in doubt of it.
    ///
    /// Doubt of a stuck axis of usual spread σ (at least [`RATE`] or [`FORCE`]): the integral of an
    /// error that lasts for 5 s, variance σ² t² up to then and σ² · 5 s · (2t − 5 s) beyond, of
    /// which each sample gets its share. Doubt of a spike: five usual steps and the distance of its
    /// neighbours, times dt.
    fn check(
        &mut self,
        (mut sample, values): (ImuSample, [f64; AXES]),
        next: Option<(&ImuSample, [f64; AXES])>,
        moves: bool,
        summary: &mut Summary,
    ) -> Checked {
        let before = self.before.replace(values);
        // Ignores neighbours across a gap.
        let next = next.filter(|(next, _)| next.dt < 1.5 * sample.dt);
        let mut replaced = values;
        let mut sound = true;
        let mut doubt = [0.0; AXES];
        let mut stuck = [false; AXES];
        for (i, axis) in self.axes.iter_mut().enumerate() {
            stuck[i] = axis.is_stuck((sample.time, sample.dt), values[i]);
        }
        let still = |axis: &AxisWatch| sample.time - axis.values.present.start >= NOISELESS;
        self.noiseless |= !moves && self.axes.iter().all(still);
        if self.noiseless {
            stuck = [false; AXES];
        }
        for (i, axis) in self.axes.iter_mut().enumerate() {
            let value = values[i];
            let (spike, floor) = if i < 3 {
                (SPIKE_RATE, RATE)
            } else {
                (SPIKE_FORCE, FORCE)
            };
            let around = match (&before, &next) {
                (Some(a), Some((_, b))) => Some([a[i], b[i]]),
                _ => None,
            };
            let ends = |around| !self.noiseless && axis.jumps(spike, around, value);
            if stuck[i] || around.is_some_and(ends) {
                // The samples before were not known to be stuck.
                let from = match axis.doubted {
                    Some(_) => sample.time - sample.dt,
                    None => axis.values.present.start,
                };
                let since = *axis.doubted.get_or_insert(axis.values.present.start);
                let std = axis.variance.sqrt().max(floor);
                let grown = |t: f64| {
                    let t = t.max(0.0);
                    let linear = TURN_LASTS;
                    std * std
                        * if t < linear {
                            t * t
                        } else {
                            linear * (2.0 * t - linear)
                        }
                };
                doubt[i] = grown(sample.time - since) - grown(from - since);
                replaced[i] = axis.mean;
                sound = false;
                summary.stuck(i, since, sample.time);
                if let Some(before) = &mut self.before {
                    before[i] = replaced[i];
                }
                continue;
            }
            axis.doubted = None;
            if let Some(around) = around
                && axis.is_spike(spike, around, value)
            {
                replaced[i] = 0.5 * (around[0] + around[1]);
                sound = false;
                let std = REPLACED_STEPS * axis.step + (around[1] - around[0]).abs();
                doubt[i] = std * std * sample.dt * sample.dt;
                summary.spike(i, sample.time);
                // Not the neighbour of the next one.
                if let Some(before) = &mut self.before {
                    before[i] = replaced[i];
                }
                continue;
            }
            axis.learn(sample.dt, value);
        }
        if sound || replaced == values {
            return Checked {
                sample,
                doubt: None,
            };
        }
        let to_body = |v: &[f64]| self.rotation * Vector3::from_column_slice(v) * sample.dt;
        (sample.dtheta, sample.dvel) = (to_body(&replaced[..3]), to_body(&replaced[3..]));
        let spread = |v: &[f64]| {
            let turned = self.rotation * Matrix3::from_diagonal(&Vector3::from_column_slice(v));
            turned * self.rotation.transpose()
        };
        Checked {
            sample,
            doubt: Some([spread(&doubt[..3]), spread(&doubt[3..])]),
        }
    }
}

#[cfg(test)]
mod tests;
