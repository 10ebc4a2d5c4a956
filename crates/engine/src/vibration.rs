//! The white noise that the samples themselves show: engine, road and rotors, beside the sensor's own.
//!
//! Above the band of a vehicle's motion there is nothing but noise in the samples. Of blocks of them the median of the
//! periodogram from half to seven eighths of the Nyquist frequency is taken, which lines of an engine do not reach;
//! where it exceeds what the model has there, the filter's white noise is that much larger. Welch 1967 (windowed
//! periodograms); the median over ln 2 as the robust mean of exponential values.

use crate::median::upper_median;
use crate::settings::Settings;
use alloc::sync::Arc;
use core::f64::consts::PI;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use nalgebra::{Complex, SMatrix, SVector};
use undrift_nav::{
    Matrix3,
    covariance::{AXES, four_lanes},
    filter::Each,
    sample::ImuSample,
    shaping::{MAX_ORDER, ShapingFilter},
};

/// Means of samples in a block.
const BLOCK: usize = 64;
/// The lowest frequency, in periods a block, and how many.
const FIRST: usize = 16;
const BINS: usize = 13;
/// Sums of a block of an axis: with cosines, with sines, and nothing, for whole vectors of four.
const SUMS: usize = 2 * BINS + 2;
/// Expectation of the median of so many exponential values of mean 1: Σ 1/i from 7 to 13.
const MEDIAN: f64 = 0.7301;

/// Samples are averaged to at most about this rate \[Hz\]: a low-pass filter of the sensor reaches less far.
const RATE: f64 = 100.0;
/// Below this rate \[Hz\] the motion of the vehicle reaches the band that is looked at.
const LEAST_RATE: f64 = 20.0;
/// Density of the white noise over the model's from which it is vibration; less is chance.
pub const VIBRATES_FROM: f64 = 1.5;
/// Time over which the noise is averaged \[s\].
const MEMORY: f64 = 3.0;
/// A sample longer than this many intervals ends a block.
const GAP: f64 = 1.5;

/// What the samples of a drive have shown so far.
#[derive(Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct Vibration {
    /// Time over which the noise is averaged \[s\].
    memory: f64,
    /// By how much the standard deviation beyond the model's is multiplied, axis by axis.
    factors: [f64; AXES],
    /// Samples in a mean, and its length \[s\]; zero samples: too slow a log to look.
    each: usize,
    interval: f64,
    /// Cosines and sines of the frequencies under Hann's window, for periodograms as two-sided densities.
    waves: Arc<[[f64; SUMS]]>,
    /// Density of the model in the band [unit²·s], the variance of its white noise \[unit²\], and a sample's interval \[s\].
    model: [f64; AXES],
    white: [f64; AXES],
    step: f64,
    /// The samples of the present mean.
    sum: [f64; AXES],
    count: usize,
    /// The sums of the present block, axis by axis.
    block: [[f64; SUMS]; AXES],
    means: usize,
    /// Density in the band [unit²·s], and for how long it is known \[s\].
    level: [f64; AXES],
    known: f64,
    /// Sum of the density beyond the model's over the blocks, and their number.
    beyond: [f64; AXES],
    blocks: u64,
}

impl Vibration {
    /// Of a filter whose models these are, before its first sample. `factors` are what the standard deviation of the noise
    /// beyond the model's is multiplied by.
    pub fn new(sensors: &[ShapingFilter; AXES], factors: &[f64; AXES]) -> Self {
        let step = sensors[0].interval;
        let rate = 1.0 / step;
        let each = match rate >= LEAST_RATE {
            true => (rate / RATE).round().max(1.0) as usize,
            false => 0,
        };
        let interval = step * each as f64;
        // Hann's window has a mean square of 3/8.
        let scale = (interval / (0.375 * BLOCK as f64)).sqrt();
        let wave = |k: usize, bin: usize| {
            let window = 0.5 - 0.5 * (2.0 * PI * (k as f64 + 0.5) / BLOCK as f64).cos();
            let angle = 2.0 * PI * ((FIRST + bin) * k % BLOCK) as f64 / BLOCK as f64;
            // Of sums, which are means times the interval.
            [angle.cos(), angle.sin()].map(|w| w * window * scale / interval)
        };
        let waves = |k| {
            let mut row = [0.0; SUMS];
            for bin in 0..BINS {
                [row[bin], row[BINS + bin]] = wave(k, bin);
            }
            row
        };
        let waves = (0..BLOCK).map(waves).collect();
        let hertz = |bin: usize| (FIRST + bin) as f64 / (BLOCK as f64 * interval);
        let density = |sensor: &ShapingFilter| {
            let sum: f64 = (0..BINS).map(|bin| spectrum(sensor, hertz(bin))).sum();
            sum / BINS as f64
        };
        Self {
            memory: MEMORY,
            factors: *factors,
            each,
            interval,
            waves,
            model: core::array::from_fn(|i| if each > 0 { density(&sensors[i]) } else { 0.0 }),
            white: core::array::from_fn(|i| sensors[i].r),
            step,
            sum: [0.0; AXES],
            count: 0,
            block: [[0.0; SUMS]; AXES],
            means: 0,
            level: [0.0; AXES],
            known: 0.0,
            beyond: [0.0; AXES],
            blocks: 0,
        }
    }

    /// The one of a replay with these settings, where its noise follows the vibration.
    pub fn of(settings: &Settings) -> Option<Self> {
        let factors = settings.vibration?;
        Some(Self::new(&settings.sensors, &factors))
    }

    /// Takes in a sample; at the end of a block the variance that each axis's white noise of a sample has by now \[unit²\].
    pub fn next(&mut self, sample: &ImuSample) -> Option<[f64; AXES]> {
        if self.each == 0 {
            return None;
        }
        if sample.dt > GAP * self.step {
            (self.count, self.sum, self.means) = (0, [0.0; AXES], 0);
            return None;
        }
        for i in 0..3 {
            self.sum[i] += sample.dtheta[i];
            self.sum[3 + i] += sample.dvel[i];
        }
        self.count += 1;
        if self.count < self.each {
            return None;
        }
        if self.means == 0 {
            self.block = [[0.0; SUMS]; AXES];
        }
        let (waves, sum) = (&self.waves[self.means], self.sum);
        four_lanes(
            #[inline(always)]
            || {
                for (sums, sum) in self.block.iter_mut().zip(sum) {
                    for k in 0..SUMS {
                        sums[k] += waves[k] * sum;
                    }
                }
            },
        );
        (self.count, self.sum) = (0, [0.0; AXES]);
        self.means += 1;
        if self.means < BLOCK {
            return None;
        }
        self.means = 0;
        self.learn();
        Some(self.variances())
    }

    /// Body axes turn by `c`: the noise is that of independent axes, the block begins again.
    pub(crate) fn turn(&mut self, c: &Matrix3) {
        self.level = turned_variances(c, &self.level);
        self.beyond = turned_variances(c, &self.beyond);
        (self.count, self.sum, self.means) = (0, [0.0; AXES], 0);
    }

    /// Takes in a whole block.
    fn learn(&mut self) {
        let length = self.interval * BLOCK as f64;
        self.known = (self.known + length).min(self.memory.max(length));
        let gain = length / self.known;
        for (i, level) in self.level.iter_mut().enumerate() {
            let sums = &self.block[i];
            let power = |bin: usize| sums[bin] * sums[bin] + sums[BINS + bin] * sums[BINS + bin];
            let mut powers: [f64; BINS] = core::array::from_fn(power);
            *level += gain * (upper_median(&mut powers) / MEDIAN - *level);
        }
    }

    /// Density beyond the model's [unit²·s], with its factor.
    fn excess(&self, axis: usize) -> f64 {
        let (level, model) = (self.level[axis], self.model[axis]);
        let known = self.known >= self.memory;
        match known && level > VIBRATES_FROM * VIBRATES_FROM * model {
            true => self.factors[axis].powi(2) * (level - model),
            false => 0.0,
        }
    }

    /// Variance of the white noise of a sample of each axis \[unit²\].
    pub fn variances(&self) -> [f64; AXES] {
        core::array::from_fn(|i| self.white[i] + self.excess(i) / self.step)
    }

    /// The factors.
    pub fn factors(&self) -> [f64; AXES] {
        self.factors
    }

    /// Variance of the white noise of a sample of each axis by the model \[unit²\].
    pub fn white_noise(&self) -> [f64; AXES] {
        self.white
    }

    /// Calls `each` with every number that samples change, always in the same order: to keep them and to put them back.
    pub fn numbers(&mut self, each: &mut Each) {
        for number in [&mut self.count, &mut self.means] {
            let mut value = *number as f64;
            each(&mut value);
            *number = value as usize;
        }
        let blocks = self.block.iter_mut().flatten();
        let axes = [&mut self.sum, &mut self.level, &mut self.beyond];
        blocks
            .chain(axes.into_iter().flatten())
            .for_each(&mut *each);
        each(&mut self.known);
        let mut blocks = self.blocks as f64;
        each(&mut blocks);
        self.blocks = blocks as u64;
    }

    /// Counts the present noise in what [`Vibration::louder`] is the mean of.
    pub(crate) fn count(&mut self) {
        for i in 0..AXES {
            self.beyond[i] += self.excess(i);
        }
        self.blocks += 1;
    }

    /// How many times the model's the density of the noise was, the root mean square; `None` where it was the
    /// model's.
    pub(crate) fn louder(&self) -> Option<[f64; AXES]> {
        let ratio = |i: usize| {
            let beyond = self.beyond[i] / self.blocks as f64;
            (1.0 + beyond / self.model[i].max(f64::MIN_POSITIVE)).sqrt()
        };
        let any = self.beyond.iter().any(|beyond| *beyond > 0.0);
        any.then(|| core::array::from_fn(ratio))
    }
}

/// Variances of the axes of both triads, which are independent, after the axes turned by `c`.
pub(crate) fn turned_variances(c: &Matrix3, variances: &[f64; AXES]) -> [f64; AXES] {
    core::array::from_fn(|i| {
        let triad = i / 3 * 3;
        let share = |j: usize| c[(i % 3, j)] * c[(i % 3, j)] * variances[triad + j];
        share(0) + share(1) + share(2)
    })
}

/// Density of the white noise in the band that samples show [unit·√s], the root mean square of all blocks; `None`
/// of a log that is too slow or too short.
pub fn densities(imu: &[ImuSample], settings: &Settings) -> Option<[f64; AXES]> {
    let mut vibration = Vibration {
        memory: f64::INFINITY,
        ..Vibration::new(&settings.sensors, &[1.0; AXES])
    };
    for sample in imu {
        vibration.next(sample);
    }
    (vibration.known > 0.0).then(|| vibration.level.map(f64::sqrt))
}

/// Two-sided density of a model at a frequency \[Hz\], [unit²·s]: T |H (z − F)⁻¹ G + D|², z on the unit circle.
fn spectrum(sensor: &ShapingFilter, hertz: f64) -> f64 {
    type Square = SMatrix<Complex<f64>, MAX_ORDER, MAX_ORDER>;
    let (sin, cos) = (2.0 * PI * hertz * sensor.interval).sin_cos();
    let z = Complex::new(cos, sin);
    let real = |x: f64| Complex::new(x, 0.0);
    // States beyond the order are those of an identity.
    let resolvent = Square::from_fn(|i, j| {
        let own = if i == j { z } else { real(0.0) };
        own - real(sensor.f[i][j])
    });
    let h = SVector::<_, MAX_ORDER>::from_fn(|i, _| real(sensor.h[i]));
    // g' = h (z − F)⁻¹, from its transpose.
    let Some(g) = resolvent.transpose().lu().solve(&h) else {
        return sensor.r * sensor.interval;
    };
    let mut sum = sensor.r;
    for i in 0..sensor.order {
        sum += 2.0 * (g[i] * sensor.s[i]).re;
        for j in 0..sensor.order {
            sum += (g[i] * g[j].conj() * sensor.q[i][j]).re;
        }
    }
    sum.max(0.0) * sensor.interval
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_xoshiro::Xoshiro256PlusPlus;

    const STEP: f64 = 0.01;
    const WHITE: f64 = 1e-3;

    fn sensors() -> [ShapingFilter; AXES] {
        let white = ShapingFilter::white(WHITE, STEP).unwrap();
        let slow = ShapingFilter::gauss_markov(1e-3, 100.0, STEP).unwrap();
        [white.plus(&slow).unwrap(); AXES]
    }

    /// Half a minute of samples whose axes read this beside white noise of a density: what the noise is taken for, as a
    /// density.
    fn seen(density: f64, rest: impl Fn(f64) -> f64) -> [f64; AXES] {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(7);
        let mut vibration = Vibration::new(&sensors(), &[1.0; AXES]);
        let mut raised = false;
        for k in 0..30_000 {
            let time = STEP * k as f64;
            let mut value = || {
                let noise: f64 = StandardNormal.sample(&mut random);
                (density / STEP.sqrt() * noise + rest(time)) * STEP
            };
            let sample = ImuSample {
                time,
                dt: STEP,
                dtheta: undrift_nav::Vector3::from_fn(|_, _| value()),
                dvel: undrift_nav::Vector3::from_fn(|_, _| value()),
            };
            let now = vibration.next(&sample);
            if now.is_some() {
                vibration.count();
            }
            raised |= now.is_some_and(|now| now != vibration.white);
        }
        let louder = vibration.louder();
        assert_eq!(louder.is_some(), raised);
        louder.map_or([WHITE; AXES], |louder| louder.map(|times| times * WHITE))
    }

    #[test]
    fn noise_beyond_the_model_is_found() {
        // Some 450 independent values of 13 frequencies each: 2 % of the density.
        for density in seen(5.0 * WHITE, |_| 0.0) {
            assert!((density / (5.0 * WHITE) - 1.0).abs() < 0.06, "{density}");
        }
    }

    #[test]
    fn noise_of_the_model_is_not_touched() {
        assert_eq!(seen(WHITE, |_| 0.0), [WHITE; AXES]);
    }

    #[test]
    fn lines_and_motion_are_no_noise() {
        let line = |t: f64| 0.1 * (2.0 * PI * 31.3 * t).sin();
        let motion = |t: f64| 3.0 * (2.0 * PI * 0.3 * t).sin() + 0.5 * (2.0 * PI * 2.0 * t).sin();
        for density in seen(WHITE, |t| line(t) + motion(t)) {
            // Ten times the noise of a sample, 70 times the density where it lies; with four of thirteen frequencies
            // taken the median is the upper third of the others.
            assert!(density < 1.5 * WHITE, "{density}");
        }
    }

    #[test]
    fn a_slow_log_shows_nothing() {
        let slow = [ShapingFilter::white(WHITE, 0.1).unwrap(); AXES];
        let mut vibration = Vibration::new(&slow, &[1.0; AXES]);
        for k in 0..1000 {
            let sample = ImuSample {
                time: 0.1 * k as f64,
                dt: 0.1,
                dtheta: undrift_nav::Vector3::repeat(f64::from(k % 2)),
                dvel: undrift_nav::Vector3::zeros(),
            };
            assert_eq!(vibration.next(&sample), None);
        }
    }

    #[test]
    fn spectrum_of_a_model() {
        // σ² T (1 − φ²) / |z − φ|², and the white noise.
        let (phi, sigma) = (0.9, 0.2);
        let white = ShapingFilter::white(0.05, STEP).unwrap();
        let lasting = ShapingFilter::ar(&[phi], sigma, STEP).unwrap();
        let model = white.plus(&lasting).unwrap();
        for hertz in [1.0, 10.0, 37.0] {
            let away = (Complex::cis(2.0 * PI * hertz * STEP) - phi).norm_sqr();
            let expected = 0.05 * 0.05 + sigma * sigma * STEP / away;
            let density = spectrum(&model, hertz);
            assert!(
                (density / expected - 1.0).abs() < 1e-12,
                "{density} {expected}"
            );
        }
    }

    #[test]
    fn what_the_model_has_in_the_band_is_not_added_again() {
        let factor = 1.5;
        let mut vibration = Vibration::new(&sensors(), &[factor; AXES]);
        // Nine times the model's density: eight are beyond it, times the factor's square.
        vibration.level = vibration.model.map(|model| 9.0 * model);
        vibration.known = MEMORY;
        // In the band the Gauss-Markov process of the model is nothing: its density is that of the white noise.
        let expected = (1.0 + factor * factor * 8.0) * WHITE * WHITE / STEP;
        for variance in vibration.variances() {
            assert!((variance / expected - 1.0).abs() < 1e-4, "{variance}");
        }
        vibration.count();
        let louder = (1.0 + factor * factor * 8.0).sqrt();
        for times in vibration.louder().unwrap() {
            assert!((times / louder - 1.0).abs() < 1e-12, "{times}");
        }
    }

    /// Samples at 100 Hz whose axes read white noise of `times` the model's density, seed 3.
    fn noisy(times: [f64; AXES], count: usize) -> Vec<ImuSample> {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(3);
        let sample = |k: usize| {
            let mut value = |axis: usize| {
                let noise: f64 = StandardNormal.sample(&mut random);
                times[axis] * WHITE / STEP.sqrt() * noise * STEP
            };
            ImuSample {
                time: STEP * (k + 1) as f64,
                dt: STEP,
                dtheta: undrift_nav::Vector3::from_fn(|i, _| value(i)),
                dvel: undrift_nav::Vector3::from_fn(|i, _| value(3 + i)),
            }
        };
        (0..count).map(sample).collect()
    }

    #[test]
    fn each_axis_shows_its_own_density() {
        let times = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        let settings = Settings::new(sensors());
        let imu = noisy(times, 30_000);
        for (found, times) in densities(&imu, &settings).unwrap().into_iter().zip(times) {
            // Some 450 independent values of 13 frequencies each: 2 % of the density.
            assert!(
                (found / (times * WHITE) - 1.0).abs() < 0.06,
                "{found} {times}"
            );
        }
        // A log too short for a block, or too slow.
        assert_eq!(densities(&imu[..20], &settings), None);
        let slow = Settings::new([ShapingFilter::white(WHITE, 0.1).unwrap(); AXES]);
        assert_eq!(densities(&imu, &slow), None);
    }

    #[test]
    fn a_gap_begins_the_block_again_and_a_sample_a_bit_longer_does_not() {
        let blocks = |at: usize, dt: f64| {
            let mut vibration = Vibration::new(&sensors(), &[1.0; AXES]);
            let mut ends = Vec::new();
            for (k, mut sample) in noisy([1.0; AXES], 2000).into_iter().enumerate() {
                if k == at {
                    sample.dt = dt;
                }
                if vibration.next(&sample).is_some() {
                    ends.push(k + 1);
                }
            }
            ends
        };
        let usual = blocks(0, STEP);
        let length = usual[0];
        assert!(
            usual
                .iter()
                .enumerate()
                .all(|(k, end)| *end == (k + 1) * length)
        );
        let at = length + length / 2;
        assert_eq!(blocks(at, 1.49 * STEP), usual);
        // The sample after the gap is none of either block.
        let gap = blocks(at, 1.51 * STEP);
        assert_eq!(gap[..2], [length, at + 1 + length]);
    }

    #[test]
    fn variances_of_turned_axes_are_sums_over_the_squares_of_their_parts() {
        let variances = [1.0, 2.0, 4.0, 10.0, 20.0, 40.0];
        // North to east about down: x reads what y read, y what x read.
        let quarter = Matrix3::new(0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
        assert_eq!(
            turned_variances(&quarter, &variances),
            [2.0, 1.0, 4.0, 20.0, 10.0, 40.0]
        );
        let half = core::f64::consts::FRAC_1_SQRT_2;
        let eighth = Matrix3::new(half, half, 0.0, -half, half, 0.0, 0.0, 0.0, 1.0);
        for (found, exact) in turned_variances(&eighth, &variances)
            .into_iter()
            .zip([1.5, 1.5, 4.0, 15.0, 15.0, 40.0])
        {
            assert!((found - exact).abs() < 1e-12);
        }
        let mut vibration = Vibration::new(&sensors(), &[1.0; AXES]);
        (vibration.level, vibration.beyond) = (variances, variances.map(|v| 3.0 * v));
        (vibration.count, vibration.means, vibration.sum) = (1, 3, [1.0; AXES]);
        vibration.turn(&quarter);
        assert_eq!(
            (vibration.count, vibration.means, vibration.sum),
            (0, 0, [0.0; AXES])
        );
        assert_eq!((vibration.level[0], vibration.beyond[0]), (2.0, 6.0));
    }

    #[test]
    fn what_samples_change_can_be_kept_and_put_back() {
        let imu = noisy([5.0; AXES], 3000);
        let mut first = Vibration::new(&sensors(), &[1.5; AXES]);
        for sample in &imu[..1777] {
            if first.next(sample).is_some() {
                first.count();
            }
        }
        let mut kept = Vec::new();
        first.numbers(&mut |number: &mut f64| kept.push(*number));
        let mut second = Vibration::new(&sensors(), &[1.5; AXES]);
        let mut put = kept.iter();
        second.numbers(&mut |number: &mut f64| *number = *put.next().unwrap());
        assert_eq!(put.next(), None);
        for sample in &imu[1777..] {
            assert_eq!(first.next(sample), second.next(sample));
            if sample.time > 25.0 {
                first.count();
                second.count();
            }
        }
        assert_eq!(first.variances(), second.variances());
        assert!(first.louder().is_some() && first.louder() == second.louder());
        assert_eq!(
            (first.factors(), first.white_noise()),
            ([1.5; AXES], first.white)
        );
    }

    #[test]
    fn noise_counts_after_three_seconds_and_beyond_twice_the_density_and_a_quarter() {
        let mut vibration = Vibration::new(&sensors(), &[1.0; AXES]);
        let of = |vibration: &Vibration| {
            vibration
                .variances()
                .map(|v| v > WHITE * WHITE / STEP * 1.001)
        };
        vibration.known = MEMORY;
        vibration.level = vibration.model.map(|model| 2.24 * model);
        assert_eq!(of(&vibration), [false; AXES]);
        vibration.level = vibration.model.map(|model| 2.26 * model);
        assert_eq!(of(&vibration), [true; AXES]);
        vibration.known = 0.99 * MEMORY;
        assert_eq!(of(&vibration), [false; AXES]);
        assert_eq!(vibration.louder(), None);
    }
}
