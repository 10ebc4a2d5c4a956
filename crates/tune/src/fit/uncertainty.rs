//! How sure the most likely noise is: 95 % intervals.
//!
//! The windows of the objective overlap, and those of each length count as much, so that what it says of a parameter is not what that is worth:
//! white noise of an accelerometer shows in all windows, the random walk of its bias in the longest alone, three of which overlap. So
//! the variance of the logarithm that was found is Godambe's sandwich `A⁻¹ (J + Λ) A⁻¹`, `A = −∂²ℓ + Λ` (Varin, Reid & Firth 2011,
//! section 2.3), Λ the prior's precision and J the covariance of the gradient, once by the scatter of the gradients of spans of the drives and once by
//! that of drives whose errors are drawn under the noise found: few spans may scatter less than they ought to, and drives may err by what the
//! model does not have. Of that all parameters together say more than a single one (section 2.4 there): J is λ times −∂²ℓ, too. The widest
//! of the three holds.
//!
//! A noise may be larger by far less than it may be smaller. So the ends of the interval are not that variance's, but where the cost, at its least
//! by all other parameters, has risen by 1.96²/2 times what that variance is of the one by A⁻¹ alone: where it is quadratic the same.

use super::{DETERMINED, Linear, cost};
use crate::{
    noise::{COUNT, Vector},
    objective::normal,
    prior::{INTERVAL, Prior},
    search::updated,
};
use nalgebra::{DMatrix, DVector};

/// Difference step for the curvature.
const STEP: f64 = 0.05;
/// Spans whose gradients are drawn: their variance is then known to √(2/40), a standard deviation to 11 %.
const DRAWN: f64 = 40.0;
/// Fewest and most drives that are drawn.
const DRAWS: (f64, f64) = (2.0, 14.0);
/// Most evaluations of the cost for one end.
const EVALUATIONS: usize = 8;
/// An end is found where the rise is right to this share: its distance then to half of that.
const NEAR: f64 = 0.1;
/// Longest move of the other parameters from one evaluation to the next.
const LONGEST: f64 = 0.5;

/// Ends of the intervals of the logarithms; as wide as the prior's where the drives say little.
pub(super) fn intervals<const N: usize>(
    linear: &mut Linear<N>,
    prior: &Prior,
    z: &Vector,
) -> [(f64, f64); COUNT] {
    let before: Vector = std::array::from_fn(|i| prior.std(i, z[i]));
    let within = |i: usize, std: f64| (z[i] - INTERVAL * std, z[i] + INTERVAL * std);
    let at = DVector::from_row_slice(&linear.score(z).gradient);
    let of_data = curvature(linear, prior, z, &at);
    let precision = DMatrix::from_fn(COUNT, COUNT, |i, j| {
        f64::from(u8::from(i == j)) * before[i].powi(-2)
    });
    let Some(inverse) = (&of_data + &precision).try_inverse() else {
        return std::array::from_fn(|i| within(i, before[i]));
    };
    let sandwich = |filling: DMatrix<f64>| &inverse * (filling + &precision) * &inverse;
    let blocks = linear.by_block(z);
    let n = blocks.len() as f64;
    // The gradients are taken where their sum vanishes. That removes one span's scatter where all inform the same
    // parameters, and one for each parameter where each informs its own; here it is half of the parameters.
    let informed = (&inverse * &of_data).trace();
    let fitted = 0.5 * informed;
    let lost = n / (n - fitted.clamp(1.0, 0.75 * n.max(2.0)));
    let seen = scatter(&blocks, &at, 0.5) * lost;
    let lambda = ((&inverse * &seen).trace() / informed).max(1.0);
    let together = sandwich(&of_data * lambda);
    let seen = sandwich(seen);
    let mut one = normal();
    let draws = (DRAWN / n).ceil().clamp(DRAWS.0, DRAWS.1);
    let mut filling = DMatrix::zeros(COUNT, COUNT);
    for _ in 0..draws as usize {
        let drawn = linear.drawn(z, &mut one);
        filling += scatter(&drawn, &DVector::zeros(COUNT), 1.0) / draws;
    }
    let drawn = sandwich(filling);
    let linear = &*linear;
    let profile = Profile {
        cost: &|z| cost(&linear.score(z), prior, z),
        z,
        inverse: &inverse,
    };
    std::array::from_fn(|i| {
        let variances = [&seen, &together, &drawn].map(|of| of[(i, i)]);
        let variance = variances.into_iter().fold(0.0, f64::max);
        let std = variance.sqrt();
        if !prior.used[i] || std >= DETERMINED * before[i] {
            return within(i, before[i]);
        }
        let worth = variance / inverse[(i, i)];
        let [low, high] = [-INTERVAL, INTERVAL]
            .map(|side| profile.end(i, side * std, side.abs() * before[i], worth));
        (low, high)
    })
}

/// −∂²ℓ by differences of the gradient, which is `at` where they begin.
fn curvature<const N: usize>(
    linear: &Linear<N>,
    prior: &Prior,
    z: &Vector,
    at: &DVector<f64>,
) -> DMatrix<f64> {
    let mut a = DMatrix::<f64>::zeros(COUNT, COUNT);
    for j in (0..COUNT).filter(|j| prior.used[*j]) {
        let mut moved = *z;
        moved[j] += STEP;
        let there = DVector::from_row_slice(&linear.score(&moved).gradient);
        a.set_column(j, &((at - there) / STEP));
    }
    (&a + a.transpose()) * 0.5
}

/// Covariance of a sum whose parts these are and whose expectation is `mean`, with the products of neighbours in so far (Newey & West 1987).
fn scatter(parts: &[Vector], mean: &DVector<f64>, neighbours: f64) -> DMatrix<f64> {
    let mean = mean / parts.len() as f64;
    let mut sum = DMatrix::zeros(COUNT, COUNT);
    let mut before = DVector::zeros(COUNT);
    for part in parts {
        let off = DVector::from_row_slice(part) - &mean;
        let across = &off * before.transpose() * neighbours;
        sum += &off * off.transpose() + &across + across.transpose();
        before = off;
    }
    sum
}

/// Cost and slope.
type Cost<'a> = &'a dyn Fn(&Vector) -> (f64, DVector<f64>);

/// The cost about its least.
struct Profile<'a> {
    cost: Cost<'a>,
    /// Where that is.
    z: &'a Vector,
    /// The inverse of the curvature there.
    inverse: &'a DMatrix<f64>,
}

impl Profile<'_> {
    /// Where the least cost with parameter `i` held has risen by 1.96²/2 times `worth`, looked for from a step on, no further than `most`.
    fn end(&self, i: usize, mut step: f64, most: f64, worth: f64) -> f64 {
        let z = DVector::from_row_slice(self.z);
        let at = |there: &DVector<f64>| (self.cost)(&std::array::from_fn(|k| there[k]));
        let (least, mut slope) = at(&z);
        let rise = 0.5 * INTERVAL * INTERVAL * worth;
        let mut inverse = self.inverse.clone();
        let mut from = z.clone();
        let mut there = &z + inverse.column(i) * (step / inverse[(i, i)]);
        let mut before: Option<(f64, f64)> = None;
        for _ in 0..EVALUATIONS {
            let (value, new) = at(&there);
            updated(&mut inverse, &(&there - &from), &(&new - &slope));
            (from, slope) = (there.clone(), new);
            let back = towards_least(&inverse, &slope, i);
            // What the others would gain.
            let risen = (value + 0.5 * back.dot(&slope) - least).max(0.05 * rise);
            if (risen / rise - 1.0).abs() < NEAR && back.amax() < LONGEST {
                break;
            }
            let power = match before {
                Some((step_before, risen_before)) if step_before != step => {
                    ((risen / risen_before).ln() / (step / step_before).ln()).clamp(1.0, 4.0)
                }
                _ => 2.0,
            };
            before = Some((step, risen));
            let factor = (rise / risen).powf(1.0 / power).clamp(0.5, 2.0);
            let next = (step * factor).clamp(-most, most);
            if next == step && factor > 1.0 {
                break;
            }
            there = &z + (&there + back - &z) * (next / step);
            step = next;
        }
        self.z[i] + step
    }
}

/// The move to the least cost with parameter `i` held, not too long.
fn towards_least(inverse: &DMatrix<f64>, slope: &DVector<f64>, i: usize) -> DVector<f64> {
    let column = inverse.column(i);
    let mut back = column * (column.dot(slope) / inverse[(i, i)]) - inverse * slope;
    back[i] = 0.0;
    let longest = back.amax();
    if longest > LONGEST {
        back *= LONGEST / longest;
    }
    back
}

#[cfg(test)]
mod tests;
