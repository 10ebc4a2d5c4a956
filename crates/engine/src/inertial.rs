//! Samples that cannot be right: replaced before the filter has them, and doubted for as long as they last.
//!
//! Looked for on each axis of the sensor, in its own axes: a *spike*, one sample far from both of its neighbours, which
//! agree with each other; a *frozen* axis, which repeats a value far longer than it usually does; a *saturated* one, which
//! does so at the end of its range. A spike is replaced by the mean of its neighbours, the two others by what the
//! axis reads on the average. What an axis may have read meanwhile is in doubt by its usual spread: correlated
//! over [`TURN_LASTS`], so that it grows with the time squared first and linearly then.

use super::summary::Summary;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_nav::{Matrix3, Vector3, covariance::AXES, sample::ImuSample};

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
/// By what part the usual distance to the neighbours' mean follows each sample.
const STEP_GAIN: f64 = 0.05;
/// The replacement of a spike is uncertain by this many usual distances.
const REPLACED_STEPS: f64 = 5.0;
/// A frozen axis repeats a value for this long \[s\].
const FROZEN: f64 = 0.5;
/// A frozen axis repeats a value for this many times the usual number of samples.
const FROZEN_TIMES: f64 = 20.0;
/// If all axes of a sensor repeat their values for this long at rest \[s\], repetitions carry no information.
const NOISELESS: f64 = 5.0;
/// Speed of the solution above which the vehicle does not rest \[m/s\]: walking pace.
pub(super) const MOVES: f64 = 1.0;
/// A saturated axis repeats its largest or smallest value for this many times the usual number of samples.
const SATURATED_TIMES: f64 = 4.0;
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

/// A sample as the filter is to have it.
#[derive(Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Checked {
    pub(super) sample: ImuSample,
    /// Covariances of the turn \[rad²\] and of the change of velocity \[m²/s²\] in it that are in doubt, body axes.
    pub(super) doubt: Option<[Matrix3; 2]>,
}

/// Watches the six axes; one sample is held back, to see what follows it.
#[derive(Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Inertial {
    /// From the sensor's axes to the body's.
    rotation: Matrix3,
    before: Option<[f64; AXES]>,
    pending: Option<(ImuSample, [f64; AXES])>,
    /// Whether all axes repeat their values while the vehicle stands: a simulated sensor without noise.
    noiseless: bool,
    axes: [AxisWatch; AXES],
}

/// What an axis usually does. Values are rates \[rad/s\] and specific forces \[m/s²\].
#[derive(Clone, Copy, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
struct AxisWatch {
    /// The present value, the interval of its first sample \[s\], since when \[s\], and in how many samples.
    value: f64,
    dt: f64,
    since: f64,
    samples: u64,
    /// Values that came to an end, and their samples.
    ended: u64,
    of_ended: u64,
    least: f64,
    most: f64,
    /// Mean and variance over [`USUAL`].
    mean: f64,
    variance: f64,
    known: f64,
    /// Nine in ten samples are closer than this to the mean of their neighbours.
    step: f64,
    seen: u64,
    /// Whether the present value came by a jump that is none of a vehicle, and stays.
    jumped: bool,
    /// Since when the axis has been in doubt \[s\].
    doubted: Option<f64>,
}

impl AxisWatch {
    /// Takes in a value; whether the axis holds it for longer than it can.
    fn is_stuck(&mut self, (time, dt): (f64, f64), value: f64) -> bool {
        // Of a log of increments those repeat, while the rounding of its times changes the rates.
        if is_same(value, self.value) || is_same(value * dt, self.value * self.dt) {
            self.samples += 1;
        } else {
            if self.samples > 0 {
                self.ended += 1;
                self.of_ended += self.samples;
                if self.value < self.least {
                    self.least = self.value;
                }
                if self.value > self.most {
                    self.most = self.value;
                }
            }
            (self.value, self.dt) = (value, dt);
            (self.since, self.samples) = (time, 1);
            self.jumped = false;
        }
        if self.ended < LEAST_VALUES {
            return false;
        }
        let lasts = time - self.since >= FROZEN;
        let extreme = value <= self.least || value >= self.most;
        // Most values are neither.
        if self.jumped || !(lasts || extreme) {
            return self.jumped;
        }
        let usual = self.of_ended as f64 / self.ended as f64;
        let times = self.samples as f64 / usual;
        let far = (value - self.mean).abs() > SATURATED_SPREAD * self.variance.sqrt();
        (lasts && times >= FROZEN_TIMES) || (far && extreme && times >= SATURATED_TIMES)
    }

    /// Whether this value, as far from the one before as a spike, comes again: a range that ends there.
    fn jumps(&mut self, least: f64, around: [f64; 2], value: f64) -> bool {
        // What comes again is rare, and quickly seen.
        if self.jumped || !is_same(value, around[1]) || self.seen < LEAST_VALUES {
            return self.jumped;
        }
        let off = (value - around[0]).abs();
        // Of an axis that never repeats a value less is enough.
        let repeats = self.of_ended as f64 > ALONE * self.ended as f64;
        let limit = if repeats {
            (SPIKE_STEPS * self.step).max(least)
        } else {
            (JUMP_STEPS * self.step).max(0.5 * least)
        };
        self.jumped = off > limit;
        self.jumped
    }

    /// Learns from a sound value of `dt` \[s\].
    fn learn(&mut self, dt: f64, value: f64) {
        self.known = (self.known + dt).min(USUAL);
        let gain = dt / self.known;
        let off = value - self.mean;
        self.mean += gain * off;
        self.variance += gain * (off * off - self.variance);
    }

    /// Whether a value is a spike between its neighbours.
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

fn is_same(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME * (1.0 + a.abs())
}

impl Inertial {
    pub(super) fn new(rotation: Matrix3) -> Self {
        let axis = AxisWatch {
            value: f64::NAN,
            least: f64::INFINITY,
            most: f64::NEG_INFINITY,
            ..AxisWatch::default()
        };
        Self {
            rotation,
            before: None,
            pending: None,
            noiseless: false,
            axes: [axis; AXES],
        }
    }

    /// Takes in a sample; the one before it, now that it is known what follows.
    ///
    /// `moves` is whether the solution moves: all axes of a simulated sensor without noise repeat their values with the
    /// vehicle at rest. Of such a sensor a value that lasts says nothing, not in a turn of constant rate either.
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

    fn check(
        &mut self,
        (mut sample, values): (ImuSample, [f64; AXES]),
        next: Option<(&ImuSample, [f64; AXES])>,
        moves: bool,
        summary: &mut Summary,
    ) -> Checked {
        let before = self.before.replace(values);
        // A neighbour beyond a gap is none.
        let next = next.filter(|(next, _)| next.dt < 1.5 * sample.dt);
        let mut replaced = values;
        let mut sound = true;
        let mut doubt = [0.0; AXES];
        let mut stuck = [false; AXES];
        for (i, axis) in self.axes.iter_mut().enumerate() {
            stuck[i] = axis.is_stuck((sample.time, sample.dt), values[i]);
        }
        let still = |axis: &AxisWatch| sample.time - axis.since >= NOISELESS;
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
                    None => axis.since,
                };
                let since = *axis.doubted.get_or_insert(axis.since);
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
mod tests {
    use super::{super::summary::MOST_EVENTS, *};
    use alloc::vec::Vec;

    /// A number between −1 and 1 that does not repeat soon.
    fn noise(k: usize, axis: usize) -> f64 {
        ((k * AXES + axis) as f64 * 78.233).sin()
    }

    /// Two minutes at 100 Hz, altered: what comes out, and what is noted.
    fn run(value: impl Fn(usize, usize) -> f64) -> (Vec<Checked>, Summary) {
        run_after(Summary::default(), value)
    }

    /// The same after what was noted before.
    fn run_after(
        mut summary: Summary,
        value: impl Fn(usize, usize) -> f64,
    ) -> (Vec<Checked>, Summary) {
        let turn = undrift_nav::attitude::from_rpy(&Vector3::new(0.3, -0.2, 2.0));
        let rotation = turn.to_rotation_matrix().into_inner();
        let mut inertial = Inertial::new(rotation);
        let mut out = Vec::new();
        for k in 0..12_000 {
            let of = |from: usize| Vector3::from_fn(|i, _| value(k, from + i)) * 0.01;
            let sample = ImuSample {
                time: 0.01 * (k + 1) as f64,
                dt: 0.01,
                dtheta: rotation * of(0),
                dvel: rotation * of(3),
            };
            out.extend(inertial.next(sample, true, &mut summary));
        }
        out.extend(inertial.last(true, &mut summary));
        assert_eq!(out.len(), 12_000);
        (out, summary)
    }

    #[test]
    fn what_is_sound_stays_as_it_is() {
        let (out, summary) = run(noise);
        assert!(out.iter().all(|checked| checked.doubt.is_none()));
        assert!(summary.sample_faults.is_empty());
        // Rounded coarsely, at rest: values repeat.
        let (out, _) = run(|k, axis| (0.6 * noise(k, axis)).round() * 0.01);
        assert!(out.iter().all(|checked| checked.doubt.is_none()));
    }

    #[test]
    fn a_spike_is_replaced_by_its_neighbours() {
        let value = |k, axis| {
            if (k, axis) == (5000, 2) {
                35.0
            } else {
                0.01 * noise(k, axis)
            }
        };
        let (out, summary) = run(value);
        let doubted: Vec<usize> = (0..out.len()).filter(|k| out[*k].doubt.is_some()).collect();
        assert_eq!(doubted, [5000]);
        assert!(out[5000].sample.dtheta.norm() < 0.01 * 0.05);
        assert_eq!(summary.sample_faults.len(), 1);
        assert_eq!(summary.sample_faults[0].axis, 2);
    }

    #[test]
    fn a_frozen_axis_is_in_doubt_by_what_it_usually_does() {
        let (from, to) = (6000, 9000);
        let value = |k: usize, axis: usize| {
            let k = if axis == 2 && (from..to).contains(&k) {
                from
            } else {
                k
            };
            0.2 * (0.002 * k as f64).sin() + 0.01 * noise(k, axis)
        };
        let (out, summary) = run(value);
        let doubted = out.iter().filter(|checked| checked.doubt.is_some()).count();
        // Half a second goes by before it is known.
        assert!((2945..=2955).contains(&doubted), "{doubted}");
        let total: f64 = out
            .iter()
            .filter_map(|checked| checked.doubt)
            .map(|doubt| doubt[0].trace())
            .sum();
        // 0.2/√2 rad/s, at least what a vehicle may do, over 30 s, independent after 5 s.
        let std = (0.2 / 2f64.sqrt()).max(RATE);
        let expected = std * std * 5.0 * (2.0 * 30.0 - 5.0);
        assert!(
            (0.7..1.4).contains(&(total / expected)),
            "{}",
            total / expected
        );
        let fault = summary.sample_faults[0];
        assert_eq!((fault.axis, summary.sample_faults.len()), (2, 1));
        assert!((fault.start - 60.01).abs() < 0.02 && (fault.end - 90.0).abs() < 0.02);
    }

    #[test]
    fn an_axis_is_in_doubt_by_as_much_where_no_more_faults_are_noted() {
        let value = |k: usize, axis: usize| {
            let k = if axis == 2 { k.min(6000) } else { k };
            let burst = axis == 3 && k > 3000 && k % 1000 < 30;
            if burst { 40.0 } else { noise(k, axis) }
        };
        let mut full = Summary::default();
        for k in 0..MOST_EVENTS {
            full.spike(5, k as f64 - 2000.0);
        }
        assert_eq!(full.sample_faults.len(), MOST_EVENTS);
        let ((out, noted), (after, full)) = (run(value), run_after(full, value));
        assert!(noted.sample_faults.len() > 1 && full.sample_faults.len() == MOST_EVENTS);
        for (one, other) in out.iter().zip(&after) {
            assert_eq!(one.doubt, other.doubt, "{}", one.sample.time);
        }
    }

    #[test]
    fn a_saturated_axis_is_in_doubt() {
        let value = |k: usize, axis: usize| {
            let burst = axis == 0 && k > 3000 && k % 1000 < 30;
            if burst { 4.0 } else { 0.1 * noise(k, axis) }
        };
        let (out, summary) = run(value);
        let doubted = out.iter().filter(|checked| checked.doubt.is_some()).count();
        // Nine bursts, the first from its second sample on.
        assert_eq!(doubted, 29 + 8 * 30);
        assert_eq!(summary.sample_faults.len(), 9);
    }

    /// An axis of numbers between −1 and 1 that has once reached ±6, a value at a time.
    fn known_axis() -> (AxisWatch, f64) {
        let mut axis = Inertial::new(Matrix3::identity()).axes[0];
        let mut time = 0.0;
        for k in 0..2000 {
            time += 0.01;
            let value = match k {
                1000 => 6.0,
                1010 => -6.0,
                _ => noise(k, 0),
            };
            assert!(!axis.is_stuck((time, 0.01), value));
            axis.learn(0.01, value);
        }
        (axis, time)
    }

    /// How many samples of one value it takes until it is stuck.
    fn samples_until_stuck(value: f64) -> usize {
        let (mut axis, time) = known_axis();
        (1..1000)
            .find(|k| axis.is_stuck((time + 0.01 * *k as f64, 0.01), value))
            .unwrap()
    }

    #[test]
    fn an_axis_is_saturated_at_the_ends_of_what_it_has_read() {
        // No value ever came twice: four times the usual number is four.
        for end in [6.0, 6.1, 30.0] {
            assert_eq!(
                (samples_until_stuck(end), samples_until_stuck(-end)),
                (4, 4)
            );
        }
        // Inside its range, however far out, it has to last for half a second.
        for inside in [5.9, 3.5, 0.5] {
            assert_eq!(
                (samples_until_stuck(inside), samples_until_stuck(-inside)),
                (51, 51)
            );
        }
    }

    #[test]
    fn what_an_axis_usually_does_is_its_mean_and_variance() {
        let mut axis = AxisWatch::default();
        // 3 and 7 in turn, of which the first counts as the mean.
        for k in 0..5_000 {
            axis.learn(0.01, if k % 2 == 0 { 3.0 } else { 7.0 });
        }
        assert!((axis.mean - 5.0).abs() < 1e-3, "{}", axis.mean);
        // The mean on the way is off by 1/k: of five thousand two thousandths.
        assert!((axis.variance - 4.0).abs() < 0.02, "{}", axis.variance);
        assert!((axis.known - 50.0).abs() < 1e-6);
        // Over a minute the past is forgotten by e.
        axis.known = 60.0;
        let (mean, span) = (axis.mean, 6000);
        for _ in 0..span {
            axis.learn(0.01, mean + 1.0);
        }
        let expected = 1.0 - (1.0 - 0.01f64 / 60.0).powi(span);
        assert!((axis.mean - mean - expected).abs() < 1e-9);
    }

    #[test]
    fn a_spike_is_far_from_neighbours_that_agree() {
        let is = |seen: u64, step: f64, around: [f64; 2], value: f64| {
            let mut axis = AxisWatch {
                seen,
                step,
                ..AxisWatch::default()
            };
            axis.is_spike(1.0, around, value)
        };
        let known = LEAST_VALUES;
        // Further than the least of 1, and than 25 usual steps.
        assert!(is(known, 0.01, [0.0, 0.0], 1.01) && !is(known, 0.01, [0.0, 0.0], 0.99));
        assert!(is(known, 0.1, [1.0, 1.0], -1.51) && !is(known, 0.1, [1.0, 1.0], -1.49));
        // Of neighbours that are apart by less than three tenths of that.
        assert!(is(known, 0.01, [-0.59, 0.59], 4.0) && !is(known, 0.01, [-0.61, 0.61], 4.0));
        assert!(!is(known - 1, 0.01, [0.0, 0.0], 5.0));
    }

    /// Nine in ten distances are smaller than the step.
    #[test]
    fn the_step_is_a_quantile_of_nine_in_ten() {
        let mut axis = AxisWatch::default();
        let (mut sum, mut count) = (0.0, 0);
        for k in 0..20_000 {
            // Distances that are uniform from 0 to 1.
            let off = (k as f64 * 0.618_033_988_75).fract();
            axis.is_spike(1e9, [0.0, 0.0], off);
            if k > 2000 {
                (sum, count) = (sum + axis.step, count + 1);
            }
        }
        let mean = sum / f64::from(count);
        // By steps of a twentieth it scatters about that.
        assert!((mean - 0.9).abs() < 0.03, "{mean}");
    }

    /// Samples at 100 Hz of an IMU that reads these, from a watch that knows its axes; what comes out.
    fn through(
        values: &[[f64; AXES]],
        dts: &[f64],
        moves: bool,
        prepare: impl Fn(&mut Inertial),
    ) -> (Vec<Checked>, Inertial) {
        let mut summary = Summary::default();
        let mut inertial = Inertial::new(Matrix3::identity());
        prepare(&mut inertial);
        let (mut out, mut time) = (Vec::new(), 0.0);
        for (values, dt) in values.iter().zip(dts) {
            time += dt;
            let of = |from: usize| Vector3::from_column_slice(&values[from..from + 3]) * *dt;
            let sample = ImuSample {
                time,
                dt: *dt,
                dtheta: of(0),
                dvel: of(3),
            };
            out.extend(inertial.next(sample, moves, &mut summary));
        }
        out.extend(inertial.last(moves, &mut summary));
        assert_eq!(
            inertial.last(moves, &mut summary).map(|of| of.sample.time),
            None
        );
        (out, inertial)
    }

    fn known(inertial: &mut Inertial) {
        for axis in &mut inertial.axes {
            (axis.seen, axis.step) = (LEAST_VALUES, 0.02);
        }
    }

    #[test]
    fn a_replaced_spike_is_in_doubt_by_the_usual_steps_and_its_neighbours_distance() {
        let at = |k: usize| {
            let mut values: [f64; AXES] = core::array::from_fn(|axis| 0.001 * noise(k, axis));
            values[0] = [0.1, 4.0, 0.3, 0.2][k];
            values[4] = [0.0, 0.0, 90.0, 2.0][k];
            values
        };
        let values: Vec<[f64; AXES]> = (0..4).map(at).collect();
        let (out, _) = through(&values, &[0.01; 4], true, known);
        let doubt = |k: usize| out[k].doubt.unwrap();
        assert!(out[0].doubt.is_none() && out[3].doubt.is_none());
        // (5 · 0.02 + 0.2) rad/s over 0.01 s, about one axis.
        let spread = |std: f64| (std * 0.01) * (std * 0.01);
        let [turn, gain] = doubt(1);
        assert!(
            (turn[(0, 0)] / spread(0.3) - 1.0).abs() < 1e-9
                && (turn.sum() / turn[(0, 0)] - 1.0).abs() < 1e-9
        );
        assert_eq!(gain, Matrix3::zeros());
        assert!((out[1].sample.dtheta.x - 0.2 * 0.01).abs() < 1e-12);
        // Accelerometer y between 0 and 2, after a step that was beyond the usual one.
        let [turn, gain] = doubt(2);
        let step = 0.02 * (1.0 + 0.9 * STEP_GAIN);
        assert!((gain[(1, 1)] / spread(2.0 + 5.0 * step) - 1.0).abs() < 1e-9);
        assert_eq!(turn, Matrix3::zeros());
        assert!((out[2].sample.dvel.y - 1.0 * 0.01).abs() < 1e-12);
        // The neighbour of the next one is what stands in its place: 0.2, not 4.
        assert!((out[2].sample.dtheta.x - 0.3 * 0.01).abs() < 1e-12);
    }

    #[test]
    fn a_sample_beyond_a_gap_is_no_neighbour() {
        let values: Vec<[f64; AXES]> = (0..3)
            .map(|k| {
                let mut values = [0.001; AXES];
                values[2] = [0.1, 9.0, 0.1][k];
                values
            })
            .collect();
        for (after, is_spike) in [(0.0149, true), (0.0151, false)] {
            let (out, _) = through(&values, &[0.01, 0.01, after], true, known);
            assert_eq!(out[1].doubt.is_some(), is_spike, "{after}");
        }
        // Nor are the first and the last sample between two.
        let ends = [[9.0; AXES], [0.1; AXES], [9.0; AXES]];
        let (out, _) = through(&ends, &[0.01; 3], true, known);
        assert!(out[0].doubt.is_none() && out[2].doubt.is_none());
    }

    #[test]
    fn a_sensor_that_repeats_all_its_values_at_rest_has_no_noise() {
        let values = [[0.5; AXES]; 620];
        for (moves, noiseless) in [(false, true), (true, false)] {
            let (_, inertial) = through(&values, &[0.01; 620], moves, |_| ());
            assert_eq!(inertial.noiseless, noiseless);
        }
        // Five seconds of it.
        let (_, short) = through(&values[..499], &[0.01; 499], false, |_| ());
        assert!(!short.noiseless);
        // One axis that changes is enough.
        let mut alive = values;
        for (k, values) in alive.iter_mut().enumerate() {
            values[5] = noise(k, 5);
        }
        assert!(!through(&alive, &[0.01; 620], false, |_| ()).1.noiseless);
    }

    #[test]
    fn values_are_the_same_to_a_part_in_ten_to_the_twelve() {
        assert!(is_same(3.0, 3.0 + 3.9e-12) && !is_same(3.0, 3.0 + 4.1e-12));
        assert!(is_same(0.0, -0.9e-12) && !is_same(0.0, -1.1e-12) && !is_same(-2.0, 2.0));
    }
}
