//! The sensor before the drive: a model of it at rest, or what its quietest moments in the drive show.

use undrift_nav::{covariance::AXES, sample::ImuSample};
use undrift_noise::{AxisModel, BiasModel, ImuModel, ModelError};

/// Turn-on constants of a consumer's sensor, gyro [rad/s] and accelerometer [m/s²], one standard deviation: where
/// nothing is known.
const TURN_ON: [f64; 2] = [8.7e-3, 0.3];
/// Length of the stretches whose quietest shows the noise at rest \[s\].
const QUIET: f64 = 1.0;
/// The quietest is taken as this quantile of them, so that a stretch of repeated values is not.
const QUIETEST: f64 = 0.02;

/// A sensor at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// Name of the sensor.
    pub name: String,
    /// Whether it is a guess from the drive itself.
    pub guessed: bool,
    /// Density of the white noise of each axis [unit·√s].
    pub white: [f64; AXES],
    /// Random walk, or what a Gauss-Markov process has of it over short times [unit/√s]; 0 where there is none.
    pub walk: [f64; AXES],
    /// Standard deviation of the turn-on constant [unit].
    pub turn_on: [f64; AXES],
}

impl Start {
    /// Of a model.
    ///
    /// # Errors
    /// A model with an axis of which nothing is known.
    pub fn of_model(model: &ImuModel, interval: f64) -> Result<Self, ModelError> {
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
        })
    }

    /// Of the drive itself; `None` of too short a log.
    pub fn of_samples(imu: &[ImuSample]) -> Option<Self> {
        let interval = imu.get(imu.len() / 2)?.dt;
        let length = (QUIET / interval).ceil() as usize;
        let mut quiet: [Vec<f64>; AXES] = Default::default();
        for stretch in imu.chunks_exact(length.max(8)) {
            let value = |s: &ImuSample, i: usize| match i {
                0..3 => s.dtheta[i] / s.dt,
                _ => s.dvel[i - 3] / s.dt,
            };
            for (i, list) in quiet.iter_mut().enumerate() {
                // Half the variance of differences: slow motion is none of it.
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
        })
    }

    /// As a model under other densities.
    pub fn model(&self, white: &[f64; AXES], walk: &[f64; AXES]) -> ImuModel {
        let axis = |i: usize| AxisModel {
            turn_on: self.turn_on[i],
            white: Some(white[i]),
            random_walk: Some(walk[i]),
            ..AxisModel::default()
        };
        let mut model = ImuModel::default();
        model.name.clone_from(&self.name);
        model.gyro = std::array::from_fn(axis);
        model.accel = std::array::from_fn(|i| axis(3 + i));
        model
    }
}
