//! Shapes of disturbances, and their sizes.

use std::f64::consts::TAU;

/// Fall of −2 ln likelihood that a warm-up takes to be found beside others; a cycle, which has a phase as well and which slow noise
/// resembles most; and a step, which has as many places as there are averages. Of 3000 records of honest random walks, flicker and Gauss-Markov noise nine had something found with 14 in place of 17.
const ENOUGH: f64 = 17.0;
const ENOUGH_OF_CYCLE: f64 = 21.0;
const ENOUGH_OF_STEP: f64 = 19.0;

/// Shape of a disturbance, its times in values of the series.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// The level is another one: before `from` surely the old, from `to` on surely the new.
    Step {
        /// First value that may have the new level.
        from: usize,
        /// First value that has the new level.
        to: usize,
    },
    /// exp(−t/τ) from the first value on, τ in values.
    WarmUp(f64),
    /// A sine of a period in values.
    Cycle(f64),
}

/// A disturbance of a level: a step, a warm-up or a slow cycle.
///
/// ```
/// use undrift_noise::screening::{Disturbance, Shape};
/// let warm_up = Disturbance { shape: Shape::WarmUp(10.0), coefficients: [2.0, 0.0], fall: 100.0 };
/// assert_eq!(warm_up.size(), 2.0);
/// assert!((warm_up.value(10.0) - 2.0 / std::f64::consts::E).abs() < 1e-12); // After one time constant.
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disturbance {
    /// Shape, with its times.
    pub shape: Shape,
    /// Coefficients of the shape \[unit\]: of a step its height, of a warm-up its value at the start, of a cycle the parts of sine and cosine.
    pub coefficients: [f64; 2],
    /// Fall of −2 ln likelihood by it: its evidence.
    pub fall: f64,
}

impl Disturbance {
    /// Height of a step, value of a warm-up at the start, amplitude of a cycle \[unit\].
    pub fn size(&self) -> f64 {
        match self.shape {
            Shape::Cycle(_) => self.coefficients[0].hypot(self.coefficients[1]),
            Shape::Step { .. } | Shape::WarmUp(_) => self.coefficients[0],
        }
    }

    /// Its value \[unit\] at a time in values: 0.5 is amid the first.
    pub fn value(&self, time: f64) -> f64 {
        let parts = self.shape.parts(time);
        parts[0] * self.coefficients[0] + parts[1] * self.coefficients[1]
    }
}

impl Shape {
    /// Values of its two parts at a time, for coefficients of 1.
    fn parts(self, time: f64) -> [f64; 2] {
        match self {
            Self::Step { to, .. } => [f64::from(time > to as f64), 0.0],
            Self::WarmUp(tau) => [(-time / tau).exp(), 0.0],
            Self::Cycle(period) => {
                let (sine, cosine) = (TAU * time / period).sin_cos();
                [sine, cosine]
            }
        }
    }

    /// The shape as regressors of `count` values: two of a cycle, one of others.
    pub(super) fn columns(self, count: usize) -> Vec<Vec<f64>> {
        let parts = match self {
            Self::Cycle(_) => 2,
            Self::Step { .. } | Self::WarmUp(_) => 1,
        };
        let column = |part: usize| {
            let values = (0..count).map(|k| self.parts(k as f64 + 0.5)[part]);
            values.collect()
        };
        (0..parts).map(column).collect()
    }

    /// Fall of −2 ln likelihood that it takes to be found.
    pub(super) fn enough(self) -> f64 {
        match self {
            Self::Step { .. } => ENOUGH_OF_STEP,
            Self::WarmUp(_) => ENOUGH,
            Self::Cycle(_) => ENOUGH_OF_CYCLE,
        }
    }

    /// The shape in a series whose values are `width` averages each.
    pub(super) fn in_values(self, width: usize) -> Self {
        match self {
            Self::Step { to, .. } => Self::Step {
                from: (to - 1) * width,
                to: (to + 1) * width,
            },
            Self::WarmUp(tau) => Self::WarmUp(tau * width as f64),
            Self::Cycle(period) => Self::Cycle(period * width as f64),
        }
    }

    /// Shapes of nearby times, that grow by a factor of 2 to this power; of a cycle by a quarter of it.
    pub(super) fn nearby(self, power: f64) -> Vec<Self> {
        let times = (-5..=5).map(|k| f64::from(k) * power);
        match self {
            Self::Step { .. } => vec![self],
            Self::WarmUp(tau) => times.map(|k| Self::WarmUp(tau * k.exp2())).collect(),
            Self::Cycle(period) => times
                .map(|k| Self::Cycle(period * (0.25 * k).exp2()))
                .collect(),
        }
    }
}
