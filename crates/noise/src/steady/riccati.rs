//! The steady state of a shaping filter's prediction.
//!
//! The recursion of the covariance over one sample is a linear fractional map; two of them in a row are one of
//! the same form, so that k doublings give 2ᵏ samples: 22 are half a day at 100 Hz.
//!
//! Structure-preserving doubling for `P = A P (I + G P)⁻¹ Aᵀ + Q`, G = HᵀH/r. Each doubling costs
//! O(N³); the error of P∞ is not accumulated over the samples that it covers. It is refused
//! rather than approximated: the end is checked by one step of the plain recursion.
//!
//! Requires a noise r > 0 of a sample's own (white noise, or the innovations of an ARMA): without
//! it G does not exist and the caller runs the plain filter.

use super::Innovations;
use super::matrix::{Matrix, Vector, add, apply, dot, identity, product, solve, transposed};
use undrift_nav::shaping::ShapingFilter;

/// Most doublings: 2⁶⁰ samples.
const DOUBLINGS: usize = 60;
/// Relative change at which the doubling has ended.
const STILL: f64 = 1e-15;
/// Share of P∞ by which one step more may change it.
const EXACT: f64 = 1e-11;

/// What some samples make of the covariance before them: `P ↦ p + aᵀ P (I + g P)⁻¹ a`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Steps<const N: usize> {
    /// Transposed transition, freed of the correlation with the sample's noise.
    a: Matrix<N>,
    /// Information that the samples bring about the state before them.
    g: Matrix<N>,
    /// Covariance that they leave of a state that was known exactly.
    p: Matrix<N>,
}

impl<const N: usize> Steps<N> {
    /// One sample; none where the filter has no noise of a sample's own.
    ///
    /// The driving noise is freed of its correlation s with the sample's own first: `F − s H/r` and
    /// `q − s sᵀ/r` (Anderson & Moore 1979, section 5.3).
    fn one(filter: &ShapingFilter) -> Option<Self> {
        let r = filter.r;
        if !(r > 0.0 && r.is_finite()) {
            return None;
        }
        let (h, s) = (&filter.h, &filter.s);
        let entries = |value: &dyn Fn(usize, usize) -> f64| -> Matrix<N> {
            std::array::from_fn(|i| std::array::from_fn(|j| value(i, j)))
        };
        Some(Self {
            a: entries(&|i, j| filter.f[j][i] - s[j] * h[i] / r),
            g: entries(&|i, j| h[i] * h[j] / r),
            p: entries(&|i, j| filter.q[i][j] - s[i] * s[j] / r),
        })
    }

    /// The recursion over 2ᵏ samples.
    ///
    /// The result's [`Steps::after`] is over 2ᵏ samples, none of them missing.
    pub(crate) fn doubled(filter: &ShapingFilter, k: u32) -> Option<Self> {
        (0..k).try_fold(Self::one(filter)?, |steps, _| steps.twice())
    }

    /// Two equal maps composed: a ← a (I + g p)⁻¹ a, g and p by the same inverse. `None` where it
    /// is singular.
    fn twice(&self) -> Option<Self> {
        let Self { a, g, p } = self;
        let weight = add(&identity(), &product(g, p), 1.0);
        let (wa, _) = solve(&weight, a)?;
        let (wg, _) = solve(&weight, g)?;
        let turned = transposed(a);
        Some(Self {
            a: product(a, &wa),
            g: symmetric(&add(g, &product(a, &product(&wg, &turned)), 1.0)),
            p: symmetric(&add(p, &product(&turned, &product(p, &wa)), 1.0)),
        })
    }

    /// The covariance after them.
    ///
    /// `None` where `I + g P` is singular to working precision.
    pub(crate) fn after(&self, before: &Matrix<N>) -> Option<Matrix<N>> {
        let weight = add(&identity(), &product(&self.g, before), 1.0);
        let (wa, _) = solve(&weight, &self.a)?;
        let added = product(&transposed(&self.a), &product(before, &wa));
        Some(symmetric(&add(&self.p, &added, 1.0)))
    }
}

/// The N × N block of a filter's matrix, whose arrays have the size of the largest order.
fn leading<const N: usize>(a: &[[f64; 6]; 6]) -> Matrix<N> {
    std::array::from_fn(|i| std::array::from_fn(|j| a[i][j]))
}

/// The innovations form, its P, Q in units of V, and V \[unit²\]. N must be the filter's order. `None` where no steady
/// state was found, or the filter has no noise of a sample's own.
///
/// `P = A P (I + HᵀH P/r)⁻¹ Aᵀ + q`, A and q freed of the correlation with the sample's own noise, by the doubling of
/// Anderson 1978 (Int. J. Control 28).
///
/// A random walk has a steady state in the presence of white noise. A constant without driving
/// noise has P∞ = 0 and gain 0: what `p0` adds to it is Δ of [`super`], which is then never
/// forgotten.
pub(crate) fn steady_state<const N: usize>(
    filter: &ShapingFilter,
) -> Option<(Innovations<N>, f64)> {
    let one = Steps::<N>::one(filter)?;
    let (freed, own, r) = (transposed(&one.a), one.p, filter.r);
    let h: Vector<N> = std::array::from_fn(|i| filter.h[i]);
    let s: Vector<N> = std::array::from_fn(|i| filter.s[i]);
    let (f, driving) = (leading(&filter.f), leading(&filter.q));
    let (mut steps, mut still) = (one, N == 0);
    for _ in 0..DOUBLINGS {
        if still {
            break;
        }
        let before = steps.p;
        steps = steps.twice()?;
        still = (0..N).all(|i| (steps.p[i][i] - before[i][i]).abs() <= STILL * steps.p[i][i].abs());
    }
    let p = steps.p;
    let ph = apply(&p, &h);
    let v = dot(&h, &ph) + r;
    if !(still && v > 0.0 && v.is_finite()) {
        return None;
    }
    let gain: Vector<N> = std::array::from_fn(|i| (dot(&f[i], &ph) + s[i]) / v);
    // One step of the filter must leave P where it is.
    let after: Matrix<N> =
        std::array::from_fn(|i| std::array::from_fn(|j| p[i][j] - ph[i] * ph[j] / v));
    let after = add(
        &product(&freed, &product(&after, &transposed(&freed))),
        &own,
        1.0,
    );
    let seen = |i: usize| h[i] * h[i] * (after[i][i] - p[i][i]).abs();
    let exact = (0..N)
        .all(|i| (after[i][i] - p[i][i]).abs() <= EXACT * p[i][i].abs() || seen(i) <= 1e-15 * v);
    exact.then(|| {
        let in_v = |m: &Matrix<N>| m.map(|row| row.map(|value| value / v));
        let model = Innovations {
            f,
            h,
            gain,
            q: in_v(&driving),
            p: in_v(&p),
        };
        (model, v)
    })
}

/// Mean of a matrix and its transpose: rounding must not make a covariance asymmetric.
fn symmetric<const N: usize>(a: &Matrix<N>) -> Matrix<N> {
    std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (a[i][j] + a[j][i])))
}
