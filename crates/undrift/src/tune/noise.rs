//! The parameters that are identified: standard deviations, by their logarithms.

use super::steps::{LinearStep, MOST};
use crate::{estimator::Channel, settings::fix_errors::StdFactors, vehicle::NonHolonomic};
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
            Channel::Velocity => noise.factors.white[1] * noise.factors.white[1],
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
pub(super) fn of_covariance<const N: usize>(
    step: &LinearStep<N>,
    noise: &Noise,
    was: &NonHolonomic,
    by: &[[f64; MOST]; MOST],
    gradient: &mut Vector,
) {
    let channel = match step.channel {
        Channel::Position => 0,
        Channel::Velocity => 1,
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
