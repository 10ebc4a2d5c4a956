//! Several samples at once through a filter whose gains do not change.
//!
//! With `A = F − K H` the state after n samples is `Aⁿ x̂ + Σ Aⁿ⁻¹⁻ᵏ K y_k`: sums that do not wait for each other, where
//! sample by sample each would wait for the one before.

use crate::composite::predictor::{Predictor, dot};

/// Samples that a settled filter takes in at once, at most.
pub(super) const LEAP: usize = 32;
/// Samples that a filter which has not settled takes in at once: few, since its gains are soon others.
pub(super) const STEP: usize = 8;
/// What is left in a state of what it was, below which it is forgotten: rounding of a state that is
/// a thousand times what a sample adds.
const FORGOTTEN: f64 = 1e-19;

/// `A x`.
fn closed<const N: usize>(filter: &Predictor<N>, x: &[f64; N]) -> [f64; N] {
    let (v, next) = (dot(&filter.h, x), filter.advance(x));
    std::array::from_fn(|i| next[i] - filter.gain[i] * v)
}

/// What each of the last samples adds, the newest last.
fn weights<const N: usize, const COUNT: usize>(filter: &Predictor<N>) -> [[f64; COUNT]; N] {
    let mut g = [[0.0; COUNT]; N];
    let mut gain = filter.gain;
    for k in (0..COUNT).rev() {
        (0..N).for_each(|i| g[i][k] = gain[i]);
        gain = closed(filter, &gain);
    }
    g
}

fn product<const N: usize>(a: &[[f64; N]; N], b: &[[f64; N]; N]) -> [[f64; N]; N] {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..N).map(|k| a[i][k] * b[k][j]).sum()))
}

/// `A`.
fn transition<const N: usize>(filter: &Predictor<N>) -> [[f64; N]; N] {
    std::array::from_fn(|i| std::array::from_fn(|j| filter.f[i][j] - filter.gain[i] * filter.h[j]))
}

/// Samples about a level as the last of [`LEAP`], the others 0.
pub(super) fn about(samples: &[f64], level: f64) -> [f64; LEAP] {
    let mut about = [0.0; LEAP];
    for (about, y) in about[LEAP - samples.len()..].iter_mut().zip(samples) {
        *about = y - level;
    }
    about
}

/// Whether all are finite.
pub(super) fn is_finite<const COUNT: usize>(samples: &[f64; COUNT]) -> bool {
    by_lanes(samples, &[0.0; COUNT]) == 0.0
}

/// Sum of products, eight sums side by side; a multiple of eight of them.
fn by_lanes<const COUNT: usize>(a: &[f64; COUNT], b: &[f64; COUNT]) -> f64 {
    let mut lanes = [0.0; 8];
    for (a, b) in a.as_chunks::<8>().0.iter().zip(b.as_chunks::<8>().0) {
        for i in 0..8 {
            lanes[i] += a[i] * b[i];
        }
    }
    lanes.iter().sum()
}

/// [`STEP`] samples.
pub(super) struct Step<const N: usize> {
    power: [[f64; N]; N],
    g: [[f64; STEP]; N],
}

impl<const N: usize> Step<N> {
    pub(super) fn new(filter: &Predictor<N>) -> Self {
        let two = transition(filter);
        let two = product(&two, &two);
        let four = product(&two, &two);
        Self {
            power: product(&four, &four),
            g: weights(filter),
        }
    }

    /// The state after so many samples about the level.
    pub(super) fn after(&self, x: &[f64; N], samples: &[f64; STEP]) -> [f64; N] {
        std::array::from_fn(|i| by_lanes(&self.g[i], samples) + dot(&self.power[i], x))
    }
}

/// Up to [`LEAP`] samples.
pub(super) struct Leap<const N: usize> {
    /// A⁰ to the power of [`LEAP`].
    powers: Vec<[[f64; N]; N]>,
    g: [[f64; LEAP]; N],
}

impl<const N: usize> Leap<N> {
    pub(super) fn new(filter: &Predictor<N>) -> Self {
        let one = transition(filter);
        let nothing = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(i == j)));
        let grown = |power: &[[f64; N]; N]| Some(product(&one, power));
        Self {
            powers: std::iter::successors(Some(nothing), grown)
                .take(LEAP + 1)
                .collect(),
            g: weights(filter),
        }
    }

    /// The state after `count` samples, which [`about`] gives.
    pub(super) fn after(&self, x: &[f64; N], samples: &[f64; LEAP], count: usize) -> [f64; N] {
        let power = &self.powers[count];
        std::array::from_fn(|i| by_lanes(&self.g[i], samples) + dot(&power[i], x))
    }

    /// Samples after which nothing is left of a state, a power of two times [`LEAP`]; none where some of it stays for
    /// more than `most`.
    pub(super) fn memory(&self, most: usize) -> Option<usize> {
        let (mut power, mut samples) = (self.powers[LEAP], LEAP);
        while samples <= most {
            if power.iter().flatten().all(|left| left.abs() < FORGOTTEN) {
                return Some(samples);
            }
            power = product(&power, &power);
            samples *= 2;
        }
        None
    }
}
