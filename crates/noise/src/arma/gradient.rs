//! Gradient of the exact likelihood of an unbroken record.
//!
//! In the letters of [`super::likelihood`], with x₀ and the mean at their best, S is a sum of squares at its minimum
//! over them, so that only what depends on the coefficients directly counts:
//!
//! ```text
//! dS       = 2 Σ a_t da_t − cᵀ dP c,   c = Σ h_tᵀ a_t = (I + M P)⁻¹ b
//! d log|V| = tr (I + M P)⁻¹ M dP + tr (P⁻¹ + M)⁻¹ dM
//! ∂a_t/∂φ_i = −w_{t−i},   w = y/θ(B);     ∂a_t/∂θ_j = v_{t−j},   v = a/θ(B)
//! ```
//!
//! P solves `P = F P Fᵀ + G Gᵀ`: a trace `tr Q dP` is that of `Z = Fᵀ Z F + Q` with the right side's own derivative. M is
//! `Σ_{t<N} (Aᵗ)ᵀ HᵀH Aᵗ`, computed by doubling, and its derivative by going back over the doublings (reverse mode: Griewank &
//! Walther 2008, chapter 3).
//!
//! Used for orders of two and more; below, differences are as cheap. Checked against differences in
//! the tests. Cost: one pass for the sums, one for the products, O(N (p + q)) for all derivatives,
//! where central differences take 2 (p + q) evaluations; the matrices are r × r.
//!
//! Assumes an unbroken record and a stationary φ (no unit root). Of a record with gaps the search
//! takes the gradient of the bridged record, which is near enough far from the optimum.

use super::kernel::{accumulate, products};
use super::likelihood::{Mean, information};
use super::linear::{initial_covariance, padded, semidefinite_cholesky};
use nalgebra::{DMatrix, DVector};

/// A power of a companion matrix below this adds nothing that is seen.
const VANISHED: f64 = 1e-18;

/// A record at a point, with all that its gradient needs.
///
/// All matrices are r × r, r = max(p, q), in units of σ².
pub(super) struct At<'a> {
    samples: &'a [f64],
    phi: &'a [f64],
    theta: &'a [f64],
    /// The record's level \[unit\], given or estimated.
    level: f64,
    /// S, the sum of squares \[unit²\].
    pub(super) squares: f64,
    /// Stationary covariance P of the state before the first sample.
    p: DMatrix<f64>,
    /// `(P⁻¹ + M)⁻¹`.
    k: DMatrix<f64>,
    /// `(I + M P)⁻¹ M`.
    m: DMatrix<f64>,
    /// c of the module's equations.
    c: DVector<f64>,
    /// x₀, the most likely state before the first sample.
    start: DVector<f64>,
}

impl<'a> At<'a> {
    /// `None` where there is no likelihood.
    ///
    /// `mean` estimated: the level is moved to its best value first, so that its own derivative
    /// vanishes.
    pub(super) fn new(
        samples: &'a [f64],
        mean: Mean,
        centre: f64,
        phi: &'a [f64],
        theta: &'a [f64],
    ) -> Option<Self> {
        let estimated = mean == Mean::Estimated;
        let centre = match mean {
            Mean::Known(value) => value,
            Mean::Estimated => centre,
        };
        let point = (phi.to_vec(), theta.to_vec());
        let sums = accumulate(samples, centre, &[point], estimated).pop()?;
        let p = initial_covariance(phi, theta, false)?;
        let r = p.nrows();
        let inside = |a: &DMatrix<f64>, l: &DMatrix<f64>| {
            (DMatrix::identity(r, r) + l.tr_mul(&(a * l))).cholesky()
        };
        let m = information(&sums);
        // Of both, factors: no difference of large numbers is taken.
        let root = semidefinite_cholesky(&p)?;
        let w = inside(&m, &root)?;
        let k = &root * w.solve(&root.transpose());
        let root = semidefinite_cholesky(&m)?;
        let m = &root * inside(&p, &root)?.solve(&root.transpose());
        // (I + M P)⁻¹ = I − (I + M P)⁻¹ M P.
        let less = |b: &[f64]| {
            let b = DVector::from_column_slice(b);
            let taken = &m * (&p * &b);
            b - taken
        };
        let (mut b, mut level) = (DVector::from_column_slice(&sums.state_cross), centre);
        let mut squares = sums.squares - b.dot(&(&k * &b));
        if estimated {
            let ones = DVector::from_column_slice(&sums.ones_state);
            let ones_squares = sums.ones_squares - ones.dot(&(&k * &ones));
            let cross = sums.ones_cross - ones.dot(&(&k * &b));
            // See `likelihood`.
            if ones_squares > 1e-13 * sums.ones_squares {
                let off = cross / ones_squares;
                squares -= off * cross;
                level += off;
                b -= ones * off;
            }
        }
        Some(Self {
            samples,
            phi,
            theta,
            level,
            squares,
            c: less(b.as_slice()),
            start: &k * b,
            p,
            k,
            m,
        })
    }

    /// Samples of the record.
    pub(super) fn observations(&self) -> usize {
        self.samples.len()
    }

    /// Derivatives of `½ (weight S + log|V|)` by φ and by θ.
    ///
    /// `weight` is N/S over all records that share σ² [1/unit²]: the derivative of ½ N ln S.
    pub(super) fn gradient(&self, weight: f64) -> (Vec<f64>, Vec<f64>) {
        let Self { phi, theta, .. } = *self;
        let r = self.p.nrows();
        let sums = products(self.samples, self.level, phi, theta, self.start.as_slice());
        let mut by_phi: Vec<f64> = sums.with_record.iter().map(|sum| -weight * sum).collect();
        let mut by_theta: Vec<f64> = sums.with_own.iter().map(|sum| weight * sum).collect();
        // By way of P.
        let f = companion(phi, r);
        let (phi, theta) = (padded(phi, r), padded(theta, r));
        let g = DVector::from_fn(r, |i, _| phi[i] - theta[i]);
        let z = lasting(f.clone(), &self.m - weight * &self.c * self.c.transpose());
        let by_own = &z * (f * self.p.column(0) + &g);
        let by_gain = &z * g;
        for (by, own) in by_phi.iter_mut().zip(&by_own) {
            *by += own;
        }
        // By way of M.
        let by_m = by_moving_average(&theta, self.samples.len(), &self.k);
        for (j, by) in by_theta.iter_mut().enumerate() {
            *by += 0.5 * by_m[j] - by_gain[j];
        }
        (by_phi, by_theta)
    }
}

/// The companion matrix, coefficients in its first column.
fn companion(coefficients: &[f64], r: usize) -> DMatrix<f64> {
    DMatrix::from_fn(r, r, |i, j| match j {
        0 => coefficients.get(i).copied().unwrap_or(0.0),
        _ => f64::from(i + 1 == j),
    })
}

/// `Σ (Fᵏ)ᵀ Q Fᵏ`, by doubling.
///
/// Solves `Z = Fᵀ Z F + Q`, a discrete Lyapunov equation; at most 64 doublings, which is any memory
/// that a double can hold.
fn lasting(mut f: DMatrix<f64>, mut q: DMatrix<f64>) -> DMatrix<f64> {
    for _ in 0..64 {
        if f.amax() < VANISHED {
            break;
        }
        q += f.tr_mul(&q) * &f;
        f = &f * &f;
    }
    q
}

/// Derivatives by θ of `tr K M`, M the information that `n` samples have of the state before them.
///
/// Forward over the bits of n, from the leading one: a doubling `M ← M + (Aᵏ)ᵀ M Aᵏ` for each, one
/// more sample where the bit is set. Then backwards over the same steps with the adjoints of M and
/// Aᵏ; O(r³ log n).
fn by_moving_average(theta: &[f64], n: usize, k: &DMatrix<f64>) -> Vec<f64> {
    let r = theta.len();
    let a = companion(theta, r);
    let mut first = DMatrix::zeros(r, r);
    first[(0, 0)] = 1.0;
    // M and Aⁿ of n = the leading bits of the number of samples; whether a sample was added after the doubling.
    let (mut m, mut power) = (first.clone(), a.clone());
    let mut way: Vec<(DMatrix<f64>, DMatrix<f64>, bool)> = Vec::new();
    for bit in (0..n.max(1).ilog2()).rev() {
        if power.amax() < VANISHED {
            break;
        }
        let twice = &m + power.tr_mul(&m) * &power;
        let square = &power * &power;
        let odd = n >> bit & 1 == 1;
        way.push((m, power, odd));
        (m, power) = match odd {
            true => (&first + a.tr_mul(&twice) * &a, &a * &square),
            false => (twice, square),
        };
    }
    let (mut by_m, mut by_power) = (k.clone(), DMatrix::zeros(r, r));
    let mut by_a = DMatrix::zeros(r, r);
    for (m, power, odd) in way.iter().rev() {
        if *odd {
            let twice = m + power.tr_mul(m) * power;
            by_a += 2.0 * twice * &a * &by_m;
            by_a += &by_power * (power * power).transpose();
            by_m = &a * by_m * a.transpose();
            by_power = a.tr_mul(&by_power);
        }
        by_power =
            2.0 * m * power * &by_m + &by_power * power.transpose() + power.tr_mul(&by_power);
        by_m += power * &by_m * power.transpose();
    }
    by_a += by_power;
    by_a.column(0).iter().copied().collect()
}

#[cfg(test)]
mod tests {
    use super::super::likelihood::unbroken;
    use super::*;

    #[test]
    fn it_is_that_of_the_likelihood() {
        let mut seed = 1u64;
        let mut uniform = || {
            seed = seed
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let mut slow = 0.0;
        let record: Vec<f64> = (0..5000)
            .map(|_| {
                slow = 0.999 * slow + 0.05 * uniform();
                slow + uniform() + 0.3
            })
            .collect();
        for (phi, theta) in [
            (&[0.999, 0.0][..], &[0.98][..]),
            (&[0.3], &[-0.7, 0.1]),
            (&[0.999, 0.0005], &[1.95, -0.9510]),
            (&[0.5, 0.2, -0.1, 0.05], &[0.3, -0.2, 0.8]),
            (&[0.5], &[0.1, 0.2, 0.1, -0.3, 0.2, 0.1, 0.05]),
            (&[0.5, 0.2], &[]),
            (&[], &[0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -0.4]),
        ] {
            for mean in [Mean::Known(0.2), Mean::Estimated] {
                for n in [5000, 2048, 700] {
                    let samples = &record[..n];
                    let at = At::new(samples, mean, 0.25, phi, theta).unwrap();
                    let points = [(phi.to_vec(), theta.to_vec())];
                    let value = unbroken(samples, mean, 0.25, &points)[0].unwrap();
                    assert!((at.squares / value.sum_of_squares - 1.0).abs() < 1e-9);
                    let (by_phi, by_theta) = at.gradient(n as f64 / at.squares);
                    for (i, exact) in by_phi.iter().chain(&by_theta).enumerate() {
                        let step = 1e-6;
                        let moved = |by: f64| {
                            let (mut phi, mut theta) = (phi.to_vec(), theta.to_vec());
                            match phi.get_mut(i) {
                                Some(phi) => *phi += by,
                                None => theta[i - phi.len()] += by,
                            }
                            let found = unbroken(samples, mean, 0.25, &[(phi, theta)]);
                            -found[0].unwrap().log_likelihood
                        };
                        let numeric = (moved(step) - moved(-step)) / (2.0 * step);
                        // Rounding of a value of 1e3 to 1e4 over the step; its third derivative is 1e6 times the first.
                        assert!(
                            (numeric - exact).abs() < 1e-3 + 1e-5 * exact.abs(),
                            "{phi:?} {theta:?} {mean:?} {n}, {i}: {numeric} {exact}"
                        );
                    }
                }
            }
        }
    }
    /// Against differences of the sum over every sample, `M = Σ (Aᵗ)ᵀ e eᵀ Aᵗ`, t below n.
    #[test]
    fn the_information_of_a_state_is_of_so_many_samples() {
        let k = DMatrix::from_row_slice(2, 2, &[1.0, 0.3, 0.3, 2.0]);
        let trace = |theta: &[f64], n: usize| -> f64 {
            let a = companion(theta, 2);
            let mut power = DMatrix::<f64>::identity(2, 2);
            let mut sum = 0.0;
            for _ in 0..n {
                let row = power.row(0).transpose();
                sum += row.dot(&(&k * &row));
                power = &a * power;
            }
            sum
        };
        let theta = [0.9, -0.1];
        for n in [1, 2, 3, 5, 6, 13, 40] {
            let found = by_moving_average(&theta, n, &k);
            for i in 0..2 {
                let at = |h: f64| {
                    let mut moved = theta;
                    moved[i] += h;
                    trace(&moved, n)
                };
                let slope = (at(1e-5) - at(-1e-5)) / 2e-5;
                assert!(
                    (found[i] - slope).abs() < 1e-6 * (1.0 + slope.abs()),
                    "{n} {i}: {} {slope}",
                    found[i]
                );
            }
        }
    }
}
