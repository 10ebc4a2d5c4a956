//! The parameters that are identified: standard deviations, by their logarithms.

use super::steps::{LinearStep, MOST};
use undrift_engine::{estimator::Channel, settings::fix_errors::StdFactors, vehicle::NonHolonomic};
use undrift_nav::covariance::AXES;

/// Number of parameters.
pub const COUNT: usize = 19;
/// Place of the sensors' white noise, of their random walks, of the white and of the lasting parts of the fixes'
/// position and velocity, and of the non-holonomic constraint.
pub const WHITE: usize = 0;
/// See [`WHITE`].
pub const WALK: usize = 6;
/// See [`WHITE`].
pub const FIX: usize = 12;
/// See [`WHITE`].
pub const LASTING: usize = 14;
/// See [`WHITE`].
pub const RULE: usize = 16;

/// The parameters' logarithms, or their derivatives.
pub type Vector = [f64; COUNT];

/// The noise under which a condensed drive is filtered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Density of the white noise of each axis [unit·√s]; where it follows the vibration, the factor on what the samples show.
    pub white: [f64; AXES],
    /// Random walk of each axis [unit/√s].
    pub walk: [f64; AXES],
    /// Of the fixes.
    pub factors: StdFactors,
    /// Non-holonomic constraint: right, down \[m/s\], side slip \[s\].
    pub rule: [f64; 3],
}

impl Noise {
    /// Of logarithms.
    pub fn new(ln: &Vector) -> Self {
        let at = |i: usize| ln[i].exp();
        Self {
            white: std::array::from_fn(|i| at(WHITE + i)),
            walk: std::array::from_fn(|i| at(WALK + i)),
            factors: StdFactors {
                white: std::array::from_fn(|i| at(FIX + i)),
                correlated: std::array::from_fn(|i| at(LASTING + i)),
            },
            rule: std::array::from_fn(|i| at(RULE + i)),
        }
    }

    /// The logarithms.
    pub fn ln(&self) -> Vector {
        let all = [
            &self.white[..],
            &self.walk,
            &self.factors.white,
            &self.factors.correlated,
            &self.rule,
        ];
        let mut ln = [0.0; COUNT];
        for (slot, value) in ln.iter_mut().zip(all.concat()) {
            *slot = value.ln();
        }
        ln
    }
}

/// A measurement's covariance under a noise.
pub(super) fn covariance<const N: usize>(
    step: &LinearStep<N>,
    noise: &Noise,
    was: &NonHolonomic,
) -> [[f64; MOST]; MOST] {
    let mut r = step.noise;
    let factor = step.weakened
        * match step.channel {
            Channel::Position => noise.factors.white[0] * noise.factors.white[0],
            Channel::Velocity | Channel::Attitude => {
                noise.factors.white[1] * noise.factors.white[1]
            }
            Channel::NonHolonomic => {
                let right = noise.rule[0] + noise.rule[2] * lateral(step, was);
                (r[0][0], r[1][1]) = (right * right, noise.rule[1] * noise.rule[1]);
                1.0
            }
            Channel::Other => 1.0,
        };
    for row in &mut r[..step.size] {
        for value in &mut row[..step.size] {
            *value *= factor;
        }
    }
    r
}

impl Noise {
    /// This one against another: of the fixes' errors what it multiplies those of the other by, else as it is.
    pub fn against(&self, other: &Self) -> Self {
        let by = |a: [f64; 2], b: [f64; 2]| [a[0] / b[0], a[1] / b[1]];
        Self {
            factors: StdFactors {
                white: by(self.factors.white, other.factors.white),
                correlated: by(self.factors.correlated, other.factors.correlated),
            },
            ..*self
        }
    }
}

/// Adds to a gradient what the derivative `by` of a measurement's covariance comes to.
pub(super) fn add_covariance_gradient<const N: usize>(
    step: &LinearStep<N>,
    noise: &Noise,
    was: &NonHolonomic,
    by: &[[f64; MOST]; MOST],
    gradient: &mut Vector,
) {
    let channel = match step.channel {
        Channel::Position => 0,
        Channel::Velocity | Channel::Attitude => 1,
        Channel::NonHolonomic => {
            let lateral = lateral(step, was);
            let right = noise.rule[0] + noise.rule[2] * lateral;
            let by_right = 2.0 * step.weakened * right * by[0][0];
            gradient[RULE] += by_right * noise.rule[0];
            gradient[RULE + 1] += 2.0 * step.weakened * noise.rule[1] * noise.rule[1] * by[1][1];
            gradient[RULE + 2] += by_right * noise.rule[2] * lateral;
            return;
        }
        Channel::Other => return,
    };
    let r = covariance(step, noise, was);
    let pairs = r.as_flattened().iter().zip(by.as_flattened());
    let used = pairs
        .enumerate()
        .filter(|(k, _)| k / MOST < step.size && k % MOST < step.size);
    gradient[FIX + channel] += 2.0 * used.map(|(_, (r, by))| r * by).sum::<f64>();
}

/// Lateral acceleration that the replay widened the constraint by \[m/s²\].
fn lateral<const N: usize>(step: &LinearStep<N>, was: &NonHolonomic) -> f64 {
    if was.slip > 0.0 {
        ((step.noise[0][0].sqrt() - was.right) / was.slip).max(0.0)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::steps::Input;
    use nalgebra::{Matrix3, Vector3};
    use undrift_nav::covariance::NAV;

    /// A measurement of three correlated components, of two of the constraint.
    fn step(channel: Channel) -> LinearStep<NAV> {
        let size = if channel == Channel::NonHolonomic {
            2
        } else {
            3
        };
        LinearStep {
            time: 0.0,
            span: 0.0,
            nav: [[0.0; NAV]; NAV],
            shift: [0.0; NAV],
            left: [0.0; NAV],
            inputs: [Input::default(); AXES],
            shape: [1.0; AXES],
            channel,
            size,
            h: [[0.0; NAV]; MOST],
            innovation: [2.0, -1.5, 0.5],
            noise: match size {
                2 => [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 1.0]],
                _ => [[1.0, 0.3, -0.2], [0.3, 2.0, 0.4], [-0.2, 0.4, 3.0]],
            },
            weakened: 1.7,
            correction: [0.0; NAV],
        }
    }

    /// Log-likelihood of the innovation where the prediction has a covariance of its own, and its derivative by R:
    /// `½ (e eᵀ − S⁻¹)`, e = S⁻¹ ν.
    fn likelihood(step: &LinearStep<NAV>, z: &Vector) -> (f64, [[f64; MOST]; MOST]) {
        let own = Matrix3::new(0.5, 0.1, 0.0, 0.1, 0.4, 0.1, 0.0, 0.1, 0.6);
        let r = covariance(step, &Noise::new(z), &NonHolonomic::CAR);
        let within = |i: usize, j: usize| i < step.size && j < step.size;
        // Beside the components that there are, those of a unit matrix.
        let s = Matrix3::from_fn(|i, j| match within(i, j) {
            true => own[(i, j)] + r[i][j],
            false => f64::from(u8::from(i == j)),
        });
        let nu = Vector3::from_fn(|i, _| f64::from(u8::from(i < step.size)) * step.innovation[i]);
        let inverse = s.try_inverse().unwrap();
        let e = inverse * nu;
        let by = (e * e.transpose() - inverse) * 0.5;
        let by = std::array::from_fn(|i| std::array::from_fn(|j| by[(i, j)]));
        (-0.5 * (s.determinant().ln() + nu.dot(&e)), by)
    }

    /// Of the fixes' noise and of the constraint's, against central differences; of nothing else.
    #[test]
    fn the_score_of_a_measurement_s_noise_is_the_slope_of_its_likelihood() {
        let mut z = [0.1; COUNT];
        z[RULE..].copy_from_slice(&[-1.0, -0.5, -2.0]);
        for (channel, moved) in [
            (Channel::Position, FIX..FIX + 1),
            (Channel::Velocity, FIX + 1..LASTING),
            (Channel::Attitude, FIX + 1..LASTING),
            (Channel::NonHolonomic, RULE..COUNT),
            (Channel::Other, 0..0),
        ] {
            let step = step(channel);
            let mut gradient = [0.0; COUNT];
            let (noise, (_, by)) = (Noise::new(&z), likelihood(&step, &z));
            add_covariance_gradient(&step, &noise, &NonHolonomic::CAR, &by, &mut gradient);
            for i in 0..COUNT {
                let at = |off: f64| {
                    let mut z = z;
                    z[i] += off;
                    likelihood(&step, &z).0
                };
                // Second order in a step of 1e-4, and rounding of 1e-15/1e-4.
                let difference = (at(1e-4) - at(-1e-4)) / 2e-4;
                assert!(
                    (gradient[i] - difference).abs() < 1e-7,
                    "{channel:?} {i}: {} {difference}",
                    gradient[i]
                );
                assert_eq!(difference != 0.0, moved.contains(&i), "{channel:?} {i}");
            }
        }
    }
}
