//! Minimisation of a smooth function whose gradient is known, by BFGS. Nocedal & Wright 2006, section 6.1.

use nalgebra::{DMatrix, DVector};

/// Longest move of one iteration, per coordinate.
const LONGEST: f64 = 0.7;
/// Decrease of the objective below which nothing more is gained.
const GAIN: f64 = 5e-3;
/// Share of the decrease that the slope promises which is enough (Armijo).
const ENOUGH: f64 = 1e-4;
/// Halvings of a move.
const HALVINGS: usize = 12;

/// The least found.
pub struct Least {
    /// Where.
    pub z: DVector<f64>,
    /// How little.
    pub value: f64,
    /// Evaluations of the function.
    pub evaluations: usize,
    /// The inverse Hessian as far as it is known.
    pub inverse: DMatrix<f64>,
    /// Whether nothing more was to be gained; else `most` evaluations were made or the search was stopped.
    pub converged: bool,
}

/// Minimises `function`, which gives value and gradient, from `z` with `first` as the inverse Hessian to
/// begin with. `goes_on` gets the value before each iteration and says whether to make it.
pub fn minimise(
    function: impl Fn(&DVector<f64>) -> (f64, DVector<f64>),
    mut z: DVector<f64>,
    first: &DMatrix<f64>,
    most: usize,
    mut goes_on: impl FnMut(f64) -> bool,
) -> Least {
    let (mut value, mut slope) = function(&z);
    let mut evaluations = 1;
    let mut inverse = first.clone();
    let mut idle = 0;
    let mut converged = false;
    while evaluations < most && goes_on(value) {
        let mut direction = -(&inverse * &slope);
        if direction.dot(&slope) >= 0.0 {
            inverse.clone_from(first);
            direction = -(&inverse * &slope);
        }
        let longest = direction.amax();
        if longest > LONGEST {
            direction *= LONGEST / longest;
        }
        let promised = direction.dot(&slope);
        let mut length = 1.0;
        let mut found = None;
        for _ in 0..HALVINGS {
            let there = &z + &direction * length;
            let (there_value, there_slope) = function(&there);
            evaluations += 1;
            if there_value <= value + ENOUGH * length * promised {
                found = Some((there, there_value, there_slope));
                break;
            }
            length *= 0.5;
        }
        let Some((there, there_value, there_slope)) = found else {
            converged = idle > 0;
            if converged {
                break;
            }
            // Perhaps the metric was at fault.
            inverse = first * 0.1;
            idle += 1;
            continue;
        };
        updated(&mut inverse, &(&there - &z), &(&there_slope - &slope));
        let gained = value - there_value;
        (z, value, slope) = (there, there_value, there_slope);
        idle = if gained < GAIN { idle + 1 } else { 0 };
        if idle > 1 {
            converged = true;
            break;
        }
    }
    Least {
        z,
        value,
        evaluations,
        inverse,
        converged,
    }
}

/// Puts into the inverse Hessian by how much the slope has changed over a move, where it has grown along that.
pub(super) fn updated(inverse: &mut DMatrix<f64>, s: &DVector<f64>, y: &DVector<f64>) {
    let curvature = s.dot(y);
    if curvature > 1e-10 * s.norm() * y.norm() {
        let rho = 1.0 / curvature;
        let left = DMatrix::identity(s.len(), s.len()) - s * y.transpose() * rho;
        *inverse = &left * &*inverse * left.transpose() + s * s.transpose() * rho;
    }
}

#[cfg(test)]
mod tests;
