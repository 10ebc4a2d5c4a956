//! The restricted likelihood, its maximum, and contrasts of the fixed effects.

use super::{ALIASED, Grouping, Nested, sums::Sums};
use nalgebra::{DMatrix, DVector, Matrix2, Matrix3, Vector2, Vector3};
use statrs::distribution::{ContinuousCDF, StudentsT};

/// The profiled restricted likelihood at some ratios of variances.
pub(super) struct Likelihood {
    /// Residual sum of squares r′V⁻¹r for σ² = 1.
    pub squares: f64,
    /// ln|V| + ln|X′V⁻¹X|.
    determinants: f64,
    /// Rows less estimated coefficients.
    pub freedom: f64,
    pub beta: DVector<f64>,
    /// (X′V⁻¹X)⁻¹; zero for columns that are combinations of others.
    pub inverse: DMatrix<f64>,
    pub aliased: Vec<bool>,
}

impl Likelihood {
    pub fn of(sums: &Sums, ratios: [f64; 2]) -> Option<Self> {
        let (all, determinant) = sums.weighted(ratios);
        let p = all.nrows() - 1;
        let (inverse, aliased, of_x) = inverted(&all, &sums.products, p);
        let xy = DVector::from_fn(p, |i, _| all[(p, i)]);
        let beta = &inverse * &xy;
        let squares = all[(p, p)] - beta.dot(&xy);
        let estimated = aliased.iter().filter(|aliased| !**aliased).count() as f64;
        let freedom = sums.freedom - estimated;
        let sound = freedom >= 1.0 && squares > 1e-12 * sums.products[(p, p)];
        sound.then_some(Self {
            squares,
            determinants: determinant + of_x,
            freedom,
            beta,
            inverse,
            aliased,
        })
    }

    /// −2 ln of the restricted likelihood with the best σ², but for a constant.
    fn criterion(&self) -> f64 {
        self.freedom * (self.squares / self.freedom).ln() + self.determinants
    }
}

/// The inverse of the upper left block of a symmetric matrix by Cholesky's decomposition, without the columns that
/// are combinations of those before; which these are, and the logarithm of the determinant.
fn inverted(all: &DMatrix<f64>, scale: &DMatrix<f64>, p: usize) -> (DMatrix<f64>, Vec<bool>, f64) {
    let mut lower = DMatrix::<f64>::zeros(p, p);
    let mut aliased = vec![false; p];
    let mut determinant = 0.0;
    for (j, aliased) in aliased.iter_mut().enumerate() {
        let known: f64 = (0..j).map(|k| lower[(j, k)] * lower[(j, k)]).sum();
        let pivot = all[(j, j)] - known;
        if pivot <= ALIASED * scale[(j, j)].abs() || !pivot.is_finite() {
            *aliased = true;
            continue;
        }
        determinant += pivot.ln();
        let root = pivot.sqrt();
        lower[(j, j)] = root;
        for i in j + 1..p {
            let known: f64 = (0..j).map(|k| lower[(i, k)] * lower[(j, k)]).sum();
            lower[(i, j)] = (all[(i, j)] - known) / root;
        }
    }
    let kept: Vec<usize> = (0..p).filter(|j| !aliased[*j]).collect();
    let small = DMatrix::from_fn(kept.len(), kept.len(), |i, j| lower[(kept[i], kept[j])]);
    let root = small
        .solve_lower_triangular(&DMatrix::identity(kept.len(), kept.len()))
        .unwrap_or_else(|| DMatrix::zeros(kept.len(), kept.len()));
    let small = root.transpose() * root;
    let mut inverse = DMatrix::zeros(p, p);
    for (a, i) in kept.iter().enumerate() {
        for (b, j) in kept.iter().enumerate() {
            inverse[(*i, *j)] = small[(a, b)];
        }
    }
    (inverse, aliased, determinant)
}

/// The model with the most likely variances.
pub struct Fit {
    /// λ of logs and of units.
    pub ratios: [f64; 2],
    /// Variance of a row.
    pub variance: f64,
    pub(super) profile: Likelihood,
    /// The covariance of ln σ² and of the ln λ that are not zero, and the changes of (X′V⁻¹X)⁻¹ with the latter.
    curvature: Option<(Matrix3<f64>, [DMatrix<f64>; 2])>,
}

/// A linear combination of the fixed effects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contrast {
    pub estimate: f64,
    pub standard_error: f64,
    /// Degrees of freedom of t.
    pub freedom: f64,
}

impl Contrast {
    /// Half of the width of the 95 % interval.
    pub fn half_width(&self) -> f64 {
        quantile_95(self.freedom) * self.standard_error
    }

    /// Probability of as large a magnitude where the combination is zero.
    pub fn probability(&self) -> f64 {
        two_sided(self.estimate / self.standard_error, self.freedom)
    }
}

/// Quantile of t that 95 % of magnitudes stay below.
pub fn quantile_95(freedom: f64) -> f64 {
    // Beyond this t is normal to 1e-6, and its quantile is found by bisection.
    let freedom = freedom.clamp(1e-3, 1e6);
    StudentsT::new(0.0, 1.0, freedom).map_or(f64::INFINITY, |t| t.inverse_cdf(0.975))
}

/// Probability of a larger magnitude of t.
pub fn two_sided(t: f64, freedom: f64) -> f64 {
    if !t.is_finite() {
        return 1.0;
    }
    let freedom = freedom.clamp(1e-3, 1e6);
    StudentsT::new(0.0, 1.0, freedom).map_or(1.0, |known| 2.0 * known.cdf(-t.abs()))
}

/// Ratios below this are zero.
const NEGLIGIBLE: f64 = 1e-10;
/// Where the search begins, for each ratio.
const STARTS: [f64; 5] = [0.0, 0.03, 0.3, 3.0, 30.0];
/// Step of differences in ln λ.
const STEP: f64 = 1e-3;
/// Of the same for second derivatives, whose rounding errors are larger.
const WIDE: f64 = 1e-2;

/// Where the search begins for the ratios that are free; from a similar fit only where one of them is zero.
pub(super) fn starts(free: [bool; 2], near: bool) -> Vec<[f64; 2]> {
    let [of_logs, of_units] = free.map(|free| if free { &STARTS[..] } else { &STARTS[..1] });
    let pairs = of_logs
        .iter()
        .flat_map(|a| of_units.iter().map(|b| [*a, *b]));
    pairs.filter(|pair| !near || pair.contains(&0.0)).collect()
}

impl Nested {
    /// The most likely variances; from `near`, those of a similar fit, it takes less time. `None` where the rows are
    /// too few, or leave nothing beside the fixed effects.
    pub fn fit(&self, near: Option<[f64; 2]>) -> Option<Fit> {
        let sums = Sums::of(self);
        let free = [Grouping::Log, Grouping::Unit].map(|level| self.has(level));
        let mut best = near.unwrap_or_default();
        let mut least = sums.criterion(best);
        for start in starts(free, near.is_some()) {
            let value = sums.criterion(start);
            if value < least {
                (best, least) = (start, value);
            }
        }
        if !least.is_finite() {
            return None;
        }
        for _ in 0..60 {
            let before = least;
            (best, least) = sums.newton(best, least);
            (best, least) = sums.ends(best, least, free);
            if before - least < 1e-9 {
                break;
            }
        }
        let profile = Likelihood::of(&sums, best)?;
        let variance = profile.squares / profile.freedom;
        Some(Fit {
            ratios: best,
            variance,
            curvature: sums.curvature(best, variance),
            profile,
        })
    }

    /// Degrees of freedom between units: units less the coefficients that are the same all over a unit.
    pub fn between_freedom(&self, fit: &Fit) -> f64 {
        let aside = self.aside[1].iter().filter(|aside| **aside).count();
        let columns = self.between.iter().zip(&fit.profile.aliased).enumerate();
        let columns = columns.filter(|(_, (between, aliased))| **between && !**aliased);
        let columns: Vec<usize> = columns.map(|(column, _)| column).collect();
        // The mean is a column of ones, or the sum of those of the parts.
        let ones = |column: &usize| self.products[(*column, *column)] == self.rows();
        let mean = usize::from(!columns.iter().any(ones));
        let coefficients = columns.len() + mean;
        self.units.len() as f64 - aside as f64 - coefficients as f64
    }
}

impl Sums {
    pub fn criterion(&self, ratios: [f64; 2]) -> f64 {
        Likelihood::of(self, ratios).map_or(f64::INFINITY, |profile| profile.criterion())
    }

    /// A step of Newton's method in the logarithms of the ratios that are not zero.
    fn newton(&self, from: [f64; 2], least: f64) -> ([f64; 2], f64) {
        let moved = |steps: [f64; 2]| [0, 1].map(|k| from[k] * steps[k].exp());
        let at = |a: f64, b: f64| self.criterion(moved([a, b]));
        let free = from.map(|ratio| ratio > 0.0);
        let mut slope = [0.0; 2];
        let mut bend = [1.0; 2];
        for k in [0, 1].into_iter().filter(|k| free[*k]) {
            let unit = |h: f64| if k == 0 { at(h, 0.0) } else { at(0.0, h) };
            let (up, down) = (unit(STEP), unit(-STEP));
            slope[k] = (up - down) / (2.0 * STEP);
            bend[k] = (up - 2.0 * least + down) / (STEP * STEP);
        }
        let mixed = if free[0] && free[1] {
            let sides = at(WIDE, WIDE) - at(WIDE, -WIDE) - at(-WIDE, WIDE) + at(-WIDE, -WIDE);
            sides / (4.0 * WIDE * WIDE)
        } else {
            0.0
        };
        let curved = Matrix2::new(bend[0], mixed, mixed, bend[1]).cholesky();
        let newton = match curved {
            Some(curved) => curved.solve(&Vector2::from(slope)).map(|step| -step).into(),
            None => slope.map(|slope| -slope.signum()),
        };
        let [a, b]: [f64; 2] = newton;
        let mut scale = (1.5 / a.abs().max(b.abs())).min(1.0);
        for _ in 0..12 {
            let next = moved(newton.map(|step| scale * step));
            let value = self.criterion(next);
            if value < least {
                return (next, value);
            }
            scale *= 0.4;
        }
        (from, least)
    }

    /// A ratio at zero, or away from it, if that is more likely.
    fn ends(&self, from: [f64; 2], least: f64, free: [bool; 2]) -> ([f64; 2], f64) {
        let (mut best, mut least) = (from, least);
        for k in [0, 1].into_iter().filter(|k| free[*k]) {
            let others: &[f64] = if best[k] > 0.0 {
                &[0.0]
            } else {
                &[1e-4, 1e-2, 0.1]
            };
            for other in others {
                let mut next = best;
                next[k] = *other;
                let value = self.criterion(next);
                // At zero rather than next to it.
                if value < least || (*other == 0.0 && best[k] < NEGLIGIBLE) {
                    (best, least) = (next, value);
                }
            }
        }
        (best, least)
    }

    /// Curvature of the restricted likelihood at its maximum, over ln σ² and the ln λ that are not zero.
    fn curvature(
        &self,
        ratios: [f64; 2],
        variance: f64,
    ) -> Option<(Matrix3<f64>, [DMatrix<f64>; 2])> {
        let at = |a: f64, b: f64| {
            let ratios = [ratios[0] * (WIDE * a).exp(), ratios[1] * (WIDE * b).exp()];
            Likelihood::of(self, ratios)
        };
        let value = |p: &Likelihood| p.squares / variance + p.determinants;
        let (middle, p) = (at(0.0, 0.0)?, self.products.nrows() - 1);
        let mut bend = Matrix3::<f64>::identity();
        bend[(0, 0)] = middle.freedom;
        let mut changes = [DMatrix::zeros(p, p), DMatrix::zeros(p, p)];
        for k in [0, 1].into_iter().filter(|k| ratios[*k] > 0.0) {
            let (a, b) = if k == 0 { (1.0, 0.0) } else { (0.0, 1.0) };
            let (up, down) = (at(a, b)?, at(-a, -b)?);
            bend[(k + 1, k + 1)] =
                (value(&up) - 2.0 * value(&middle) + value(&down)) / (WIDE * WIDE);
            let slope = (up.squares - down.squares) / (2.0 * WIDE * variance);
            bend[(0, k + 1)] = -slope;
            bend[(k + 1, 0)] = -slope;
            changes[k] = (&up.inverse - &down.inverse) / (2.0 * WIDE);
        }
        if ratios[0] > 0.0 && ratios[1] > 0.0 {
            let sides = value(&at(1.0, 1.0)?) - value(&at(1.0, -1.0)?) - value(&at(-1.0, 1.0)?)
                + value(&at(-1.0, -1.0)?);
            let mixed = sides / (4.0 * WIDE * WIDE);
            (bend[(1, 2)], bend[(2, 1)]) = (mixed, mixed);
        }
        Some((2.0 * bend.try_inverse()?, changes))
    }
}

impl Fit {
    /// A combination of the coefficients with Satterthwaite's degrees of freedom; where it differs between units
    /// alone these are at most those between units. `None` if the rows do not determine it.
    pub fn contrast(&self, nested: &Nested, of: &[(usize, f64)]) -> Option<Contrast> {
        let p = self.profile.beta.len();
        let mut weights = DVector::zeros(p);
        for (column, weight) in of {
            *weights.get_mut(*column)? += weight;
            if *weight != 0.0 && *self.profile.aliased.get(*column)? {
                return None;
            }
        }
        let form = |matrix: &DMatrix<f64>| (weights.transpose() * matrix * &weights)[(0, 0)];
        let shape = form(&self.profile.inverse);
        let square = self.variance * shape;
        if square <= 0.0 || !square.is_finite() {
            return None;
        }
        let mut freedom = self.profile.freedom;
        if let Some((covariance, changes)) = &self.curvature {
            let slope = |k: usize| self.variance * form(&changes[k]);
            let slopes = Vector3::new(square, slope(0), slope(1));
            let scatter = (slopes.transpose() * covariance * slopes)[(0, 0)];
            if scatter > 0.0 {
                freedom = freedom.min(2.0 * square * square / scatter);
            }
        }
        let between = of
            .iter()
            .all(|(column, _)| nested.between.get(*column) == Some(&true));
        if between && nested.has(Grouping::Unit) {
            freedom = freedom.min(nested.between_freedom(self));
        }
        Some(Contrast {
            estimate: weights.dot(&self.profile.beta),
            standard_error: square.sqrt(),
            freedom: freedom.max(1.0),
        })
    }
}
