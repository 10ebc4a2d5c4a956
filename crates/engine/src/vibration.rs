//! The white noise that the samples themselves show: engine, road and rotors, beside the sensor's own.
//!
//! Above the band of a vehicle's motion there is nothing but noise in the samples. Of blocks of them the median of the
//! periodogram from half to seven eighths of the Nyquist frequency is taken, which lines of an engine do not reach;
//! where it exceeds what the model has there, the filter's white noise is that much larger. Welch 1967 (windowed
//! periodograms). A bin is exponential, so the median of thirteen over its expectation, 0.730 of the mean, is a
//! robust mean.

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
/// Ratio of the white noise's density to the model's from which it is vibration [–]; less is chance.
pub const VIBRATES_FROM: f64 = 1.5;
/// Time over which the noise is averaged \[s\].
const MEMORY: f64 = 3.0;
/// Standard deviation of the change of a bias as vibration begins, for each density of its noise \[√Hz\], and of what
/// it changes by in a second of it [1/s]: on a quadrotor a gyro's bias went from 0.04 to −0.2 deg/s at a density of
/// 0.12 deg/s/√Hz, and an accelerometer's by 0.1 m/s² in some minutes at 0.1 m/s²/√Hz.
const RECTIFIED: f64 = 1.0;
const WANDERS: f64 = 0.05;
/// A sample longer than this many intervals ends a block.
const GAP: f64 = 1.5;

/// White noise of the samples as they come: [`Vibration::next`] with each sample gives the variance for the filter.
///
/// ```
/// use undrift_engine::{settings::Settings, vibration::Vibration};
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_simulate::{GnssNoise, Trajectory, simulate};
/// let sensors = |factor: f64| -> Result<_, Box<dyn std::error::Error>> {
///     let gyro = ShapingFilter::white(factor * 1e-4, 0.01)?;
///     let accel = ShapingFilter::white(factor * 1e-3, 0.01)?;
///     Ok([gyro, gyro, gyro, accel, accel, accel])
/// };
/// // An engine that makes the noise five times that of the model.
/// let log = simulate(&Trajectory::rest(60.0), 100.0, Some(&sensors(5.0)?), &GnssNoise::default(), 1)?;
/// let mut vibration = Vibration::new(&sensors(1.0)?, &[1.0; 6]);
/// for sample in &log.imu {
///     vibration.next(sample);
/// }
/// let ratio = vibration.variances()[0] / vibration.white_noise()[0];
/// assert!((15.0..35.0).contains(&ratio), "{ratio}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct Vibration {
    /// Time over which the noise is averaged \[s\].
    memory: f64,
    /// Factors on the standard deviation beyond the model's, axis by axis [–].
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
    /// The largest density beyond the model's so far [unit²·s].
    most: [f64; AXES],
    /// Sum of the density beyond the model's over the blocks, and their number.
    beyond: [f64; AXES],
    blocks: u64,
}

impl Vibration {
    /// Starts with the models' white noise. `factors` [–], gyro and accelerometer x, y, z, are what the standard deviation of the noise
    /// beyond the model's is multiplied by: 1 takes it as the samples show it.
    ///
    /// Below 20 Hz of samples nothing is looked for: the variances stay the model's.
    ///
    /// ```
    /// use undrift_engine::vibration::Vibration;
    /// use undrift_nav::shaping::ShapingFilter;
    /// let sensors = [ShapingFilter::white(1e-3, 0.01)?; 6]; // N²/T = 1e-4.
    /// let vibration = Vibration::new(&sensors, &[1.0; 6]);
    /// assert_eq!(vibration.variances(), vibration.white_noise()); // Nothing was seen yet.
    /// # Ok::<(), undrift_nav::shaping::ShapingError>(())
    /// ```
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
            most: [0.0; AXES],
            beyond: [0.0; AXES],
            blocks: 0,
        }
    }

    /// That of a navigator with these settings; `None` where its noise does not follow the vibration.
    pub fn from_settings(settings: &Settings) -> Option<Self> {
        let factors = settings.vibration?;
        Some(Self::new(&settings.sensors, &factors))
    }

    /// Processes a sample; at the end of a block, about every 0.6 s at 100 Hz, the variances of a sample's white noise by now, gyro x, y, z
    /// [rad²/s²], accelerometer x, y, z [m²/s⁴].
    ///
    /// A sample after a gap of more than 1.5 intervals begins a new block. O(1) a sample: 28
    /// products an axis for each mean of samples.
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
        self.most = turned_variances(c, &self.most);
        self.beyond = turned_variances(c, &self.beyond);
        (self.count, self.sum, self.means) = (0, [0.0; AXES], 0);
    }

    /// Learns from a whole block.
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
    ///
    /// 0 until [`MEMORY`] has been seen, or below [`VIBRATES_FROM`] times the model's standard
    /// deviation.
    fn excess(&self, axis: usize) -> f64 {
        let (level, model) = (self.level[axis], self.model[axis]);
        let known = self.known >= self.memory;
        match known && level > VIBRATES_FROM * VIBRATES_FROM * model {
            true => self.factors[axis].powi(2) * (level - model),
            false => 0.0,
        }
    }

    /// Variance of the white noise of a sample by now, gyro x, y, z [rad²/s²], accelerometer x, y, z [m²/s⁴].
    pub fn variances(&self) -> [f64; AXES] {
        core::array::from_fn(|i| self.white[i] + self.excess(i) / self.step)
    }

    /// Factors on the standard deviation of the noise beyond the model's [–], gyro and accelerometer x, y, z.
    pub fn factors(&self) -> [f64; AXES] {
        self.factors
    }

    /// Variance of the white noise of a sample by the model, gyro x, y, z [rad²/s²], accelerometer x, y, z [m²/s⁴].
    pub fn white_noise(&self) -> [f64; AXES] {
        self.white
    }

    /// Calls `each` with every number that samples change, always in the same order: to store them and to restore them.
    pub fn numbers(&mut self, each: &mut Each) {
        for number in [&mut self.count, &mut self.means] {
            let mut value = *number as f64;
            each(&mut value);
            *number = value as usize;
        }
        let blocks = self.block.iter_mut().flatten();
        let axes = [
            &mut self.sum,
            &mut self.level,
            &mut self.most,
            &mut self.beyond,
        ];
        blocks
            .chain(axes.into_iter().flatten())
            .for_each(&mut *each);
        each(&mut self.known);
        let mut blocks = self.blocks as f64;
        each(&mut blocks);
        self.blocks = blocks as u64;
    }

    /// Variance by which the biases change under the vibration of the last block, gyro x, y, z [rad²/s²], accelerometer x, y, z
    /// [m²/s⁴]: sensors rectify vibration, so that a bias found on the ground is another in flight, and wanders with the rotors' speed.
    pub(crate) fn rectified(&mut self) -> [f64; AXES] {
        let length = self.interval * BLOCK as f64;
        core::array::from_fn(|i| {
            let excess = self.excess(i);
            let rise = (excess - self.most[i]).max(0.0);
            self.most[i] += rise;
            RECTIFIED * RECTIFIED * rise + WANDERS * WANDERS * excess * length
        })
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
///
/// ```
/// use undrift_engine::{settings::Settings, vibration::densities};
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_simulate::{GnssNoise, Trajectory, simulate};
/// let sensors = |factor: f64| -> Result<_, Box<dyn std::error::Error>> {
///     let gyro = ShapingFilter::white(factor * 1e-4, 0.01)?;
///     let accel = ShapingFilter::white(factor * 1e-3, 0.01)?;
///     Ok([gyro, gyro, gyro, accel, accel, accel])
/// };
/// // The sensors are three times as noisy as their model says.
/// let log = simulate(&Trajectory::rest(60.0), 100.0, Some(&sensors(3.0)?), &GnssNoise::default(), 1)?;
/// let shown = densities(&log.imu, &Settings::new(sensors(1.0)?)).expect("100 Hz is enough");
/// assert!((shown[0] / 3e-4 - 1.0).abs() < 0.1 && (shown[5] / 3e-3 - 1.0).abs() < 0.1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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
mod tests;
