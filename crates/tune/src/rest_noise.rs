//! The sensor before the drive: a model of it at rest, or what its quietest moments in the drive show.

use undrift_base::order_statistics::upper_median;
use undrift_drive::replay::{Measurement, vibration::VIBRATES_FROM};
use undrift_nav::{covariance::AXES, sample::ImuSample};
use undrift_noise::{AxisModel, BiasModel, ImuModel, ModelError, temperature::Temperature};

/// Turn-on constants of a consumer's sensor, gyro [rad/s] and accelerometer [m/s²], one standard deviation: where
/// nothing is known.
const TURN_ON: [f64; 2] = [8.7e-3, 0.3];
/// Length of the stretches whose quietest shows the noise at rest \[s\].
const QUIET: f64 = 1.0;
/// The quietest is taken as this quantile of them, so that a stretch of repeated values is not.
const QUIETEST: f64 = 0.02;

/// Below this speed by the fixes the vehicle is at rest [m/s], if for so long \[s\].
const AT_REST: (f64, f64) = (0.15, 3.0);
/// Length of the stretches whose means are compared at a standstill \[s\], and how many differences it takes.
const IDLE: (f64, usize) = (1.0, 10);
/// The median of squares of normal values of variance one.
const MEDIAN_OF_SQUARES: f64 = 0.4549;

/// Density of the white noise of each axis [unit·√s] while the vehicle is at rest with the engine running:
/// by the Allan deviation at one second, by medians, so that a door does not count. `None` where it is hardly at rest.
pub fn idle(imu: &[ImuSample], aiding: &[Measurement]) -> Option<[f64; AXES]> {
    let fixes = aiding.iter().filter_map(|m| match m {
        Measurement::Gnss(fix) => Some((fix.time, fix.velocity?.0.norm())),
        _ => None,
    });
    // Spans between fixes that say that it is at rest.
    let mut spans: Vec<(f64, f64)> = Vec::new();
    let mut before: Option<f64> = None;
    for (time, speed) in fixes {
        let at_rest = speed < AT_REST.0;
        match (before, spans.last_mut()) {
            (Some(last), Some(span)) if at_rest && span.1 == last => span.1 = time,
            (Some(last), _) if at_rest => spans.push((last, time)),
            _ => {}
        }
        before = at_rest.then_some(time);
    }
    let mut squares: [Vec<f64>; AXES] = Default::default();
    for (from, to) in spans {
        if to - from < AT_REST.1 {
            continue;
        }
        // The last second may be that of pulling away, the first of braking.
        let first = imu.partition_point(|s| s.time < from + IDLE.0);
        let last = imu.partition_point(|s| s.time <= to - IDLE.0);
        let stretches = imu.get(first..last).unwrap_or_default();
        let mut before: Option<[f64; AXES]> = None;
        let (mut sum, mut span) = ([0.0; AXES], 0.0);
        for sample in stretches {
            for i in 0..3 {
                sum[i] += sample.dtheta[i];
                sum[3 + i] += sample.dvel[i];
            }
            span += sample.dt;
            if span >= IDLE.0 {
                let mean = sum.map(|sum| sum / span);
                if let Some(before) = before {
                    for (list, (a, b)) in squares.iter_mut().zip(mean.iter().zip(before)) {
                        list.push(0.5 * (a - b).powi(2) * span);
                    }
                }
                before = Some(mean);
                (sum, span) = ([0.0; AXES], 0.0);
            }
        }
    }
    let mut density = [0.0; AXES];
    for (slot, mut list) in density.iter_mut().zip(squares) {
        if list.len() < IDLE.1 {
            return None;
        }
        *slot = (upper_median(&mut list) / MEDIAN_OF_SQUARES).sqrt();
    }
    Some(density)
}

/// A sensor at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct RestNoise {
    /// Name of the sensor.
    pub name: String,
    /// Whether it is a guess from the drive itself.
    pub guessed: bool,
    /// Density of the white noise of each axis [unit·√s].
    pub white: [f64; AXES],
    /// Random walk [unit/√s]: the model's own, or that to which its Gauss-Markov process amounts over short times; else 0.
    pub walk: [f64; AXES],
    /// Standard deviation of the turn-on constant \[unit\].
    pub turn_on: [f64; AXES],
    /// White noise while the vehicle is at rest with its engine running [unit·√s], where it is known.
    pub idle: Option<[f64; AXES]>,
    /// White noise that the samples of the drives show above the band of motion [unit·√s], where it is known.
    pub vibrating: Option<[f64; AXES]>,
    /// The bias over temperature, which the model goes on with.
    pub temperature: [Option<Temperature>; AXES],
}

impl RestNoise {
    /// Of a model.
    ///
    /// # Errors
    /// A model with an axis of which nothing is known.
    pub fn from_model(model: &ImuModel, interval: f64) -> Result<Self, ModelError> {
        let walks = model.shaping(BiasModel::RandomWalk, interval)?;
        let axes = model.axes();
        Ok(Self {
            name: model.name.clone(),
            guessed: false,
            white: axes.map(|(_, axis)| axis.white_density()),
            walk: std::array::from_fn(|i| match walks[i].order {
                0 => 0.0,
                _ => (walks[i].q[0][0].max(0.0) / interval).sqrt(),
            }),
            turn_on: std::array::from_fn(|i| match axes[i].1.turn_on {
                given if given > 0.0 => given,
                _ => TURN_ON[i / 3],
            }),
            idle: None,
            vibrating: None,
            temperature: axes.map(|(_, axis)| axis.temperature),
        })
    }

    /// Of the drive itself; `None` of too short a log.
    pub fn from_samples(imu: &[ImuSample]) -> Option<Self> {
        let interval = imu.get(imu.len() / 2)?.dt;
        let length = (QUIET / interval).ceil() as usize;
        let mut quiet: [Vec<f64>; AXES] = Default::default();
        for stretch in imu.chunks_exact(length.max(8)) {
            let value = |s: &ImuSample, i: usize| match i {
                0..3 => s.dtheta[i] / s.dt,
                _ => s.dvel[i - 3] / s.dt,
            };
            for (i, list) in quiet.iter_mut().enumerate() {
                // Half the variance of the differences, which slow motion hardly enters.
                let pairs = stretch.windows(2);
                let sum: f64 = pairs
                    .map(|w| (value(&w[1], i) - value(&w[0], i)).powi(2))
                    .sum();
                let variance = 0.5 * sum / (stretch.len() - 1) as f64;
                if variance > 0.0 {
                    list.push(variance.sqrt());
                }
            }
        }
        let quietest = |mut list: Vec<f64>| {
            list.sort_by(f64::total_cmp);
            let at = (QUIETEST * list.len() as f64) as usize;
            list.get(at).copied()
        };
        let mut white = [0.0; AXES];
        for (slot, list) in white.iter_mut().zip(quiet) {
            *slot = quietest(list)? * interval.sqrt();
        }
        Some(Self {
            name: "sensor of unknown kind".into(),
            guessed: true,
            white,
            walk: [0.0; AXES],
            turn_on: std::array::from_fn(|i| TURN_ON[i / 3]),
            idle: None,
            vibrating: None,
            temperature: [None; AXES],
        })
    }

    /// Whether the samples show more noise of an axis than the sensor has at rest.
    pub fn shakes(&self, axis: usize) -> bool {
        let shown = self.vibrating.map_or(0.0, |vibrating| vibrating[axis]);
        shown > VIBRATES_FROM * self.white[axis]
    }

    /// As a model under other densities.
    pub fn model(&self, white: &[f64; AXES], walk: &[f64; AXES]) -> ImuModel {
        let axis = |i: usize| AxisModel {
            turn_on: self.turn_on[i],
            white: Some(white[i]),
            random_walk: Some(walk[i]),
            temperature: self.temperature[i],
            ..AxisModel::default()
        };
        let mut model = ImuModel::default();
        model.name.clone_from(&self.name);
        model.gyro = std::array::from_fn(axis);
        model.accel = std::array::from_fn(|i| axis(3 + i));
        model
    }
}

#[cfg(test)]
mod tests;
