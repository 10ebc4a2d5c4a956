//! Minimisation of a smooth function of a few variables by BFGS, with gradients that are known or numeric. Nocedal &
//! Wright 2006, chapters 3 and 6. What differs between the searches of [`crate::arma`] and of
//! [`crate::composite`] is in [`Scales`].
//!
//! A search steps along −B∇f, B an estimate of the inverse Hessian that each step corrects by what the gradient
//! changed (Broyden, Fletcher, Goldfarb, Shanno), and ends where the decrease that is predicted, ½ ∇fᵀB∇f, is
//! below a tolerance: in log-likelihood, so that an end is judged by what it could still gain, not by how far
//! the parameters moved along a flat direction.
//!
//! Likelihoods here are evaluated at several points for little more than one, so gradients by differences ask
//! for all of theirs at once.
//!
//! Two ways of use, chosen by [`Scales::curved`]: ARMA coordinates have unit scale, so that a
//! search starts from the unit metric; logarithms of composite terms differ in curvature by orders
//! of magnitude, so that second differences make the first metric. Values of +∞ are walls: a line
//! search steps back from them, differences into them count as flat. A NaN counts as +∞.
//!
//! Local: it ends in an optimum near its start, so that finding the global one depends on the
//! starts.

use nalgebra::{DMatrix, DVector};

/// How a search measures and moves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scales {
    /// Difference step.
    pub(crate) step: f64,
    /// Longest move of one iteration, per coordinate.
    pub(crate) longest: f64,
    /// Coordinates are kept within this.
    pub(crate) edge: f64,
    /// Gradients are central from the start, and the second differences that these give for nothing make the
    /// first metric. Otherwise they are forward until the search is nearly done, and it starts from the unit
    /// metric with short steps.
    pub(crate) curved: bool,
}

/// Longest move while nothing is known of the curvature.
const FIRST: f64 = 0.3;
/// Least curvature of the first metric.
const LEAST_CURVATURE: f64 = 0.1;
/// Decrease of one iteration below which gradients are central.
const NEAR: f64 = 1e-2;

/// A point and its value.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    /// Coordinates, within the edge of [`Scales`].
    pub(crate) z: Vec<f64>,
    /// Value of the function there.
    pub(crate) value: f64,
    /// The predicted remaining decrease was below the tolerance.
    pub(crate) converged: bool,
    /// Estimate of the inverse Hessian to go on with.
    pub(crate) inverse: Option<DMatrix<f64>>,
}

impl Point {
    /// A point nothing is known about but its value.
    pub(crate) fn new(z: Vec<f64>, value: f64) -> Self {
        Self {
            z,
            value,
            converged: false,
            inverse: None,
        }
    }
}

/// Gradient at a point; `None` where it is not to be had.
pub(crate) type Gradient<'a> = dyn Fn(&[f64]) -> Option<Vec<f64>> + 'a;

/// A function of several points at once, which may be cheaper than one after the other. Counts
/// evaluations and turns NaN into +∞.
///
/// The function is minimised: callers pass negative log-likelihoods. Every call checks for an
/// interrupt, so a search can be cancelled.
pub(crate) struct Objective<'a> {
    /// Values at several points of one dimension.
    function: &'a dyn Fn(&[Vec<f64>]) -> Vec<f64>,
    /// Exact gradient, where one is known.
    gradient: Option<&'a Gradient<'a>>,
    /// Steps and limits of this search.
    scales: Scales,
    /// Evaluations so far.
    pub(crate) evaluations: usize,
}

impl<'a> Objective<'a> {
    /// Gradients by differences; see [`Self::with_gradient`].
    pub(crate) fn new(function: &'a dyn Fn(&[Vec<f64>]) -> Vec<f64>, scales: Scales) -> Self {
        Self {
            function,
            gradient: None,
            scales,
            evaluations: 0,
        }
    }

    /// This objective with a gradient in place of differences.
    pub(crate) fn with_gradient(self, gradient: &'a Gradient<'a>) -> Self {
        Self {
            gradient: Some(gradient),
            ..self
        }
    }

    /// Values at several points, +∞ in place of NaN; each counts as an evaluation.
    pub(crate) fn at_all(&mut self, z: &[Vec<f64>]) -> Vec<f64> {
        undrift_base::interrupt::check();
        self.evaluations += z.len();
        let mut values = (self.function)(z);
        for value in values.iter_mut().filter(|value| value.is_nan()) {
            *value = f64::INFINITY;
        }
        values
    }

    /// Value at one point.
    pub(crate) fn at(&mut self, z: &[f64]) -> f64 {
        self.at_all(&[z.to_vec()])[0]
    }

    /// Points with their values.
    pub(crate) fn points(&mut self, z: Vec<Vec<f64>>) -> Vec<Point> {
        let values = self.at_all(&z);
        let pairs = z.into_iter().zip(values);
        pairs.map(|(z, value)| Point::new(z, value)).collect()
    }

    /// Gradient: where it is not known by differences.
    ///
    /// `value` is the value at `z`, needed by forward differences; `central` costs 2n evaluations
    /// instead of n.
    pub(crate) fn gradient(&mut self, z: &[f64], value: f64, central: bool) -> DVector<f64> {
        let known = self.gradient.and_then(|of| of(z));
        known.map_or_else(|| self.differences(z, value, central).0, DVector::from_vec)
    }

    /// Gradient and the metric to start from.
    fn first(&mut self, z: &[f64], value: f64, central: bool) -> (DVector<f64>, DMatrix<f64>) {
        match self.scales.curved {
            true => self.differences(z, value, central),
            false => (
                self.gradient(z, value, central),
                DMatrix::identity(z.len(), z.len()),
            ),
        }
    }

    /// Gradient by forward differences, or central ones (twice the cost), and the metric to start from. A
    /// direction into an invalid region counts as flat.
    ///
    /// The error of a forward difference is half the step times the curvature, that of a central one a sixth of
    /// the step squared times the third derivative: forward ones lead a search to where the gradient is small,
    /// central ones end it.
    pub(crate) fn differences(
        &mut self,
        z: &[f64],
        value: f64,
        central: bool,
    ) -> (DVector<f64>, DMatrix<f64>) {
        let n = z.len();
        let Scales { step, curved, .. } = self.scales;
        let mut around: Vec<_> = (0..n).map(|i| moved(z, i, step)).collect();
        if central {
            around.extend((0..n).map(|i| moved(z, i, -step)));
        }
        let values = self.at_all(&around);
        let finite = |v: f64| if v.is_finite() { v } else { 0.0 };
        let gradient = DVector::from_fn(n, |i, _| {
            finite(if central {
                (values[i] - values[n + i]) / (2.0 * step)
            } else {
                (values[i] - value) / step
            })
        });
        if !curved {
            return (gradient, DMatrix::identity(n, n));
        }
        let curvature =
            |i: usize| finite((values[i] + values[n + i] - 2.0 * value) / (step * step));
        let metric = DVector::from_fn(n, |i, _| 1.0 / curvature(i).abs().max(LEAST_CURVATURE));
        (gradient, DMatrix::from_diagonal(&metric))
    }

    /// Hessian by second differences of a point, its value, a step for each coordinate and the values at plus and
    /// minus that step; `None` where it is not finite.
    ///
    /// 2n values beside the point are given; n (n − 1) more, at the corners of each pair of coordinates, are
    /// computed here.
    ///
    /// Of a negative log-likelihood at its minimum this is the observed information.
    pub(crate) fn second_differences(
        &mut self,
        z: &[f64],
        value: f64,
        steps: &[f64],
        beside: &[[f64; 2]],
    ) -> Option<DMatrix<f64>> {
        let n = z.len();
        let pairs: Vec<_> = (0..n).flat_map(|i| (0..i).map(move |j| (i, j))).collect();
        let corners = pairs.iter().flat_map(|&(i, j)| {
            [1.0, -1.0].map(|sign| moved(&moved(z, i, sign * steps[i]), j, sign * steps[j]))
        });
        let corners = self.at_all(&Vec::from_iter(corners));
        let rise = |[plus, minus]: [f64; 2]| plus + minus - 2.0 * value;
        let mut out = DMatrix::from_fn(n, n, |i, _| rise(beside[i]) / (steps[i] * steps[i]));
        for (&(i, j), corner) in pairs.iter().zip(corners.chunks(2)) {
            // Abramowitz & Stegun 25.3.27: both moves at once less each alone.
            let both = rise([corner[0], corner[1]]) - rise(beside[i]) - rise(beside[j]);
            out[(i, j)] = both / (2.0 * steps[i] * steps[j]);
            out[(j, i)] = out[(i, j)];
        }
        out.iter().all(|c| c.is_finite()).then_some(out)
    }

    /// Goes from `here` along `direction`, of `slope` below zero, by at most `share` of it.
    ///
    /// Returns the point and value at the end of the line search: not below the start where 25
    /// tries have not helped, which the caller must check.
    pub(crate) fn line(
        &mut self,
        here: &Point,
        direction: &DVector<f64>,
        slope: f64,
        share: f64,
    ) -> (Vec<f64>, f64) {
        let edge = self.scales.edge;
        let mut next = here.z.clone();
        let at = |t: f64| {
            for (i, next) in next.iter_mut().enumerate() {
                *next = (here.z[i] + t * direction[i]).clamp(-edge, edge);
            }
            self.at(&next)
        };
        let value = backtrack(at, here.value, slope, share);
        (next, value)
    }

    /// The share of a step that is no longer in any coordinate than what the scales allow.
    pub(crate) fn share(&self, direction: &DVector<f64>) -> f64 {
        (self.scales.longest / direction.amax()).min(1.0)
    }
}

/// The best end of the searches from the `count` best of the starts, if any has a finite value.
///
/// `None` where no start has a finite value. Ends at which the tolerance was not met count as well.
///
/// Deterministic: equal values keep the order of the starts.
pub(crate) fn best_of(
    objective: &mut Objective,
    starts: Vec<Vec<f64>>,
    count: usize,
    tolerance: f64,
    iterations: usize,
) -> Option<Point> {
    let mut starts = objective.points(starts);
    starts.retain(|start| start.value.is_finite());
    starts.sort_by(|a, b| a.value.total_cmp(&b.value));
    let ends = starts.iter().take(count);
    ends.map(|start| bfgs(objective, start, tolerance, iterations))
        .min_by(|a, b| a.value.total_cmp(&b.value))
}

/// A point moved along one coordinate.
pub(crate) fn moved(z: &[f64], coordinate: usize, by: f64) -> Vec<f64> {
    let mut moved = z.to_vec();
    moved[coordinate] += by;
    moved
}

/// BFGS from `start` until the predicted decrease is below `tolerance` or `iterations` are spent.
///
/// The end has `converged` set where the predicted decrease ½ gᵀB g fell below `tolerance`, and
/// carries its inverse Hessian, from which a later search or a standard error may go on. `n` = 0
/// counts as converged. Each iteration costs one gradient and one to 25 values.
pub(crate) fn bfgs(
    objective: &mut Objective,
    start: &Point,
    tolerance: f64,
    iterations: usize,
) -> Point {
    let n = start.z.len();
    let mut here = Point::new(start.z.clone(), start.value);
    if n == 0 || !here.value.is_finite() {
        here.converged = n == 0;
        return here;
    }
    let curved = objective.scales.curved;
    let mut central = curved || objective.gradient.is_some();
    let (mut gradient, metric) = objective.first(&here.z, here.value, central);
    let known = start.inverse.as_ref().filter(|known| known.nrows() == n);
    let mut fresh = known.is_none();
    let mut inverse = known.cloned().unwrap_or(metric);
    let mut refused = 0;
    for _ in 0..iterations {
        let mut direction = -(&inverse * &gradient);
        let mut slope = direction.dot(&gradient);
        if !curved && (slope.is_nan() || slope >= 0.0) {
            (inverse, fresh) = (DMatrix::identity(n, n), true);
            direction = -&gradient;
            slope = -gradient.norm_squared();
        }
        // Before anything is known of the curvature, a short first step.
        let share = if fresh && !curved {
            (FIRST / direction.amax()).min(1.0)
        } else {
            objective.share(&direction)
        };
        let predicted = -0.5 * slope * if curved { share } else { 1.0 };
        if predicted < tolerance && (curved || !fresh) {
            if central {
                (here.converged, here.inverse) = (true, Some(inverse));
                return here;
            }
            central = true;
            gradient = objective.gradient(&here.z, here.value, central);
            continue;
        }
        let (next, value) = objective.line(&here, &direction, slope, share);
        if value >= here.value {
            refused += 1;
            if if curved { fresh } else { refused > 2 } {
                here.converged = !curved && predicted < 10.0 * tolerance;
                return here;
            }
            // Start again from the first metric with the better gradient.
            (central, fresh) = (true, true);
            (gradient, inverse) = objective.first(&here.z, here.value, central);
            continue;
        }
        central |= here.value - value < NEAR;
        let next_gradient = objective.gradient(&next, value, central);
        let s = DVector::from_fn(n, |i, _| next[i] - here.z[i]);
        update(
            &mut inverse,
            &s,
            &(&next_gradient - &gradient),
            fresh && !curved,
        );
        (here.z, here.value) = (next, value);
        (gradient, fresh) = (next_gradient, false);
    }
    here.inverse = (!fresh).then_some(inverse);
    here
}

/// Halvings of a step at most before a line search gives up.
const TRIES: usize = 25;
/// Sufficient decrease of the step that is taken, as a share of the slope's.
const SUFFICIENT: f64 = 1e-4;

/// Shortens the step along a direction of `slope` below zero until the function is sufficiently below
/// `value`, by quadratic interpolation kept within a tenth and a half; gives the last value tried.
/// `at` moves to a fraction of the direction and evaluates.
///
/// Armijo's condition (Nocedal & Wright, section 3.1); the next fraction is the minimum of the parabola through
/// value, slope and the value tried.
fn backtrack(mut at: impl FnMut(f64) -> f64, value: f64, slope: f64, longest: f64) -> f64 {
    let mut t = longest;
    let mut next = f64::INFINITY;
    for _ in 0..TRIES {
        next = at(t);
        if next <= value + SUFFICIENT * t * slope {
            break;
        }
        let guess = -slope * t * t / (2.0 * (next - value - slope * t));
        t = if guess.is_finite() {
            guess.clamp(0.1 * t, 0.5 * t)
        } else {
            0.2 * t
        };
    }
    next
}

/// BFGS update of an inverse Hessian for a step `s` along which the gradient changed by `y`; left out
/// where the curvature is not positive. With `scale`, what is known so far is first scaled to the
/// curvature along the step (Nocedal & Wright, equation 6.20).
///
/// `s` and `y` keep sᵀy > 0 for a positive definite metric (the curvature condition); a step on
/// which that fails is not used.
fn update(inverse: &mut DMatrix<f64>, s: &DVector<f64>, y: &DVector<f64>, scale: bool) {
    let (sy, yy, ss) = (s.dot(y), y.norm_squared(), s.norm_squared());
    if sy.is_nan() || sy <= 1e-10 * (ss * yy).sqrt() {
        return;
    }
    if scale {
        *inverse *= sy / yy;
    }
    let hy = &*inverse * y;
    let along = (1.0 + y.dot(&hy) / sy) / sy;
    inverse.ger(along, s, s, 1.0);
    inverse.ger(-1.0 / sy, &hy, s, 1.0);
    inverse.ger(-1.0 / sy, s, &hy, 1.0);
}

#[cfg(test)]
mod tests;
