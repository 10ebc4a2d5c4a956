//! One-step prediction under a shaping filter: the Kalman filter of the model alone, which settles.
//!
//! State x̂ and covariance P before a sample: `v = y − H x̂`, `V = H P Hᵀ + r`, `K = (F P Hᵀ + s)/V`,
//! `x̂ ← F x̂ + K v`. With r > 0 the driving noise is first freed of its correlation with the sample's
//! own (Anderson & Moore 1979, section 5.3): `A = F − s H/r`, `P ← A (P − P HᵀH P/V) Aᵀ + q − s sᵀ/r`,
//! so that the P of a model in innovations form falls to zero without a difference of large numbers.
//!
//! A filter that has settled no longer carries its covariance. It counts as settled where neither gains nor
//! variance change by more than a given share over 64 samples; [`Predictor::settling`] is for uses that need
//! less, and goes over such spans by the doubled recursion of [`Steps`].
//!
//! Used where samples come one by one: by [`crate::drift_score`], by models without a steady state,
//! and by [`crate::temperature`], which whitens several signals with one gain. N is the filter's
//! order, known at compile time; O(N³) a sample until settled, O(N²) after.

use crate::steady::Steps;
use undrift_nav::shaping::ShapingFilter;

/// Samples between two looks whether the filter has settled, and their logarithm to base 2.
const LOOK: u32 = 1 << LOG_LOOK;
const LOG_LOOK: u32 = 6;
/// Relative change of every gain and of V over [`LOOK`] samples below which it has. A moving-average
/// root 1 − d off the circle leaves 1e-12/(128 d) of the gain to go, whose share of V is d: 1e-14.
const SETTLED: f64 = 1e-12;
/// Change between looks below which a filter that may settle early keeps its gains from look to look: what that
/// costs is the square of it.
const SLOW: f64 = 1e-3;

/// F and q freed of the correlation of the driving noise with the sample's own.
type Freed<const N: usize> = ([[f64; N]; N], [[f64; N]; N]);

/// The filter with N states.
#[derive(Clone, Debug)]
pub(crate) struct Predictor<const N: usize> {
    /// Transition over one sample.
    pub(crate) f: [[f64; N]; N],
    /// Output: the sample is H x plus its own noise.
    pub(crate) h: [f64; N],
    /// Covariance of the driving noise, GGᵀ.
    q: [[f64; N]; N],
    /// Its covariance with the sample's own noise, GDᵀ.
    s: [f64; N],
    /// Variance of the sample's own noise, DDᵀ \[unit²\].
    r: f64,
    /// F, q without the correlation with the sample's own noise; none where r = 0.
    freed: Option<Freed<N>>,
    /// Predicted state before the next sample.
    pub(crate) x: [f64; N],
    /// Covariance of the predicted state \[unit²\].
    pub(crate) p: [[f64; N]; N],
    /// Gain of the next sample.
    pub(crate) gain: [f64; N],
    /// Variance V of the next sample \[unit²\].
    pub(crate) variance: f64,
    /// Covariance and gain no longer change.
    pub(crate) settled: bool,
    /// Relative change over [`LOOK`] samples below which they do not.
    still: f64,
    /// What [`LOOK`] samples make of P; none where the gains are those of every sample until they settle.
    stride: Option<Steps<N>>,
    /// Samples for which the gains are kept.
    ///
    /// Samples for which they are still kept.
    kept: u32,
    /// Samples since the last missing one.
    since: u32,
    /// Gain and variance at the last look.
    seen: ([f64; N], f64),
}

/// The leading block of a matrix of an axis, of N states.
fn leading<const N: usize>(a: &[[f64; 6]; 6]) -> [[f64; N]; N] {
    std::array::from_fn(|i| std::array::from_fn(|j| a[i][j]))
}

/// `a m aᵀ + q`, symmetric.
fn carried<const N: usize>(
    a: &[[f64; N]; N],
    m: &[[f64; N]; N],
    q: &[[f64; N]; N],
) -> [[f64; N]; N] {
    let mut am = [[0.0; N]; N];
    for i in 0..N {
        for k in 0..N {
            for j in 0..N {
                am[i][j] += a[i][k] * m[k][j];
            }
        }
    }
    let mut out = *q;
    for i in 0..N {
        for j in 0..=i {
            let mut sum = q[i][j];
            for k in 0..N {
                sum += am[i][k] * a[j][k];
            }
            out[i][j] = sum;
            out[j][i] = sum;
        }
    }
    out
}

/// Sum of products, in order.
pub(crate) fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    let mut sum = 0.0;
    for i in 0..N {
        sum += a[i] * b[i];
    }
    sum
}

impl<const N: usize> Predictor<N> {
    /// Before the first sample: state 0, covariance `p0`. N must be the filter's order.
    pub(crate) fn new(filter: &ShapingFilter) -> Self {
        Self::until(filter, SETTLED)
    }

    /// The same for states to be trusted to `still` alone: settled below that relative change, and the gains kept over
    /// [`LOOK`] samples where they change slowly.
    ///
    /// For scores, whose error is the square of the gain's; not for likelihoods.
    pub(crate) fn settling(filter: &ShapingFilter, still: f64) -> Self {
        Self {
            stride: Steps::doubled(filter, LOG_LOOK),
            ..Self::until(filter, still)
        }
    }

    /// A predictor that counts as settled below the relative change `still`.
    fn until(filter: &ShapingFilter, still: f64) -> Self {
        let mut this = Self {
            f: leading(&filter.f),
            h: std::array::from_fn(|i| filter.h[i]),
            q: leading(&filter.q),
            s: std::array::from_fn(|i| filter.s[i]),
            r: filter.r,
            freed: None,
            x: [0.0; N],
            p: leading(&filter.p0),
            gain: [0.0; N],
            variance: 0.0,
            settled: false,
            still,
            stride: None,
            kept: 0,
            since: 0,
            seen: ([0.0; N], 0.0),
        };
        if this.r > 0.0 {
            let (mut a, mut q) = (this.f, this.q);
            for i in 0..N {
                for j in 0..N {
                    a[i][j] -= this.s[i] * this.h[j] / this.r;
                    let shared = this.s[i] * this.s[j] / this.r;
                    q[i][j] -= shared;
                    // Nothing of its own is left: that is the rounding of it.
                    if q[i][j].abs() <= 4.0 * f64::EPSILON * shared.abs() {
                        q[i][j] = 0.0;
                    }
                }
            }
            this.freed = Some((a, q));
        }
        this.weigh();
        this
    }

    /// Variance and gain of the next sample from P.
    ///
    /// V = H P Hᵀ + r, K = (F P Hᵀ + s)/V.
    fn weigh(&mut self) {
        let mut ph = [0.0; N];
        for i in 0..N {
            ph[i] = dot(&self.p[i], &self.h);
        }
        self.variance = dot(&self.h, &ph) + self.r;
        for i in 0..N {
            self.gain[i] = (dot(&self.f[i], &ph) + self.s[i]) / self.variance;
        }
    }

    /// F x, for any vector.
    pub(crate) fn advance(&self, x: &[f64; N]) -> [f64; N] {
        std::array::from_fn(|i| dot(&self.f[i], x))
    }

    /// Takes in a sample; returns its prediction error v. The variance is that before the call.
    ///
    /// `y` about the level \[unit\], finite. Standardised, v/√V is white with unit variance if the
    /// model is right.
    pub(crate) fn observe(&mut self, y: f64) -> f64 {
        let v = y - dot(&self.h, &self.x);
        let mut next = self.advance(&self.x);
        for i in 0..N {
            next[i] += self.gain[i] * v;
        }
        self.x = next;
        self.move_on();
        v
    }

    /// Carries the covariance over a sample that was taken in.
    ///
    /// For callers that predict several signals with one filter: they take gain and variance before
    /// this call.
    pub(crate) fn move_on(&mut self) {
        if self.settled {
            return;
        }
        if self.kept > 0 {
            self.kept -= 1;
            if self.kept == 0 {
                self.stride();
            }
            return;
        }
        match &self.freed {
            Some((a, q)) => {
                let mut m = self.p;
                let mut ph = [0.0; N];
                for i in 0..N {
                    ph[i] = dot(&self.p[i], &self.h);
                }
                for i in 0..N {
                    for j in 0..N {
                        m[i][j] -= ph[i] * ph[j] / self.variance;
                    }
                }
                self.p = carried(a, &m, q);
            }
            None => {
                let mut q = self.q;
                for i in 0..N {
                    for j in 0..N {
                        q[i][j] -= self.gain[i] * self.gain[j] * self.variance;
                    }
                }
                self.p = carried(&self.f, &self.p, &q);
            }
        }
        self.weigh();
        self.since += 1;
        if self.since.is_multiple_of(LOOK) {
            self.look();
        }
    }

    /// Samples for which the gains are still kept; none of a filter that has settled.
    pub(crate) fn kept(&self) -> usize {
        self.kept as usize
    }

    /// Carries the covariance over samples that were taken in with gains that are kept for as many or more; whether
    /// they were the last of these.
    pub(crate) fn pass(&mut self, samples: usize) -> bool {
        self.kept -= samples as u32;
        if self.kept == 0 {
            self.stride();
            return true;
        }
        false
    }

    /// Carries the covariance over the samples for which the gains were kept.
    fn stride(&mut self) {
        if let Some(p) = self.stride.and_then(|steps| steps.after(&self.p)) {
            self.p = p;
            self.weigh();
        }
        self.look();
    }

    /// Looks whether the gains have settled since the last look, and whether they may be kept up to the next.
    ///
    /// A gain near zero is judged against the largest one.
    fn look(&mut self) {
        let (gain, variance) = self.seen;
        let largest = self.gain.iter().fold(0.0f64, |m, g| m.max(g.abs()));
        let changes_less_than = |share: f64| {
            let gains = (0..N).all(|i| {
                let change = (self.gain[i] - gain[i]).abs();
                change <= share * (self.gain[i].abs() + 1e-3 * share * largest)
            });
            gains && (self.variance - variance).abs() <= share * self.variance
        };
        self.settled = changes_less_than(self.still);
        if !self.settled && self.stride.is_some() && changes_less_than(SLOW) {
            self.kept = LOOK;
        }
        self.seen = (self.gain, self.variance);
    }

    /// Goes over a missing sample.
    ///
    /// P grows by one step without a sample; the filter has to settle again.
    pub(crate) fn skip(&mut self) {
        self.x = self.advance(&self.x);
        self.p = carried(&self.f, &self.p, &self.q);
        self.settled = false;
        self.kept = 0;
        self.since = 0;
        self.seen = ([0.0; N], 0.0);
        self.weigh();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::composite::{CompositeTerms, GaussMarkov};

    /// White noise over a process, of a sample interval of 1 s.
    fn slow_under_white(sigma: f64, tau_s: f64) -> ShapingFilter {
        let terms = CompositeTerms {
            white: 1.0,
            gauss_markov: [GaussMarkov { sigma, tau_s }, GaussMarkov::default()],
            ..CompositeTerms::default()
        };
        terms.to_shaping(1.0).unwrap()
    }

    /// P of a state that a sample of variance r shows: P ← φ² P r/(P + r) + q.
    #[test]
    fn covariance_and_gain_are_those_of_a_scalar_filter() {
        let (phi, q) = ((-0.1f64).exp(), 4.0 * (1.0 - (-0.2f64).exp()));
        let mut predictor = Predictor::<1>::new(&slow_under_white(2.0, 10.0));
        let (mut p, mut x) = (4.0, 0.0);
        for k in 0..40 {
            let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{k}: {a} {b}");
            near(predictor.p[0][0], p);
            near(predictor.variance, p + 1.0);
            near(predictor.gain[0], phi * p / (p + 1.0));
            near(predictor.x[0], x);
            if k % 7 == 3 {
                predictor.skip();
                (x, p) = (phi * x, phi * phi * p + q);
                continue;
            }
            let y = f64::from(k * 37 % 11);
            near(predictor.observe(y), y - x);
            x = phi * (x + p / (p + 1.0) * (y - x));
            p = phi * phi * p / (p + 1.0) + q;
        }
    }

    #[test]
    fn a_filter_settles_at_the_second_look_that_sees_no_change() {
        // Of a process without other noise the state is known after a sample.
        let filter = ShapingFilter::gauss_markov(2.0, 10.0, 1.0).unwrap();
        let mut predictor = Predictor::<1>::new(&filter);
        for round in 0..2 {
            for k in 1..=128 {
                assert!(!predictor.settled, "{round} {k}");
                predictor.observe(1.0);
            }
            assert!(predictor.settled, "{round}");
            predictor.skip();
            assert!(!predictor.settled);
        }
        // A gain that goes on changing by a thousandth a look has not settled.
        let mut predictor = Predictor::<1>::new(&slow_under_white(0.01, 1e5));
        (0..640).for_each(|_| predictor.move_on());
        assert!(!predictor.settled);
    }

    #[test]
    fn gains_that_change_slowly_are_kept_from_look_to_look() {
        let filter = slow_under_white(0.02, 3000.0);
        let (mut exact, mut kept) = (
            Predictor::<1>::new(&filter),
            Predictor::<1>::settling(&filter, 1e-6),
        );
        let (mut held, mut last) = (0, f64::NAN);
        for k in 1..=12_800 {
            exact.move_on();
            kept.move_on();
            let apart = (kept.p[0][0] / exact.p[0][0] - 1.0).abs();
            // Where they are kept, P is that of up to 64 samples ago, and of now at each look.
            assert!(apart < 0.05, "{k}: {apart}");
            if k % 64 == 0 {
                assert!(apart < 1e-4, "{k}: {apart}");
            }
            held += i32::from(kept.gain[0] == last);
            last = kept.gain[0];
        }
        assert!(held > 5000, "{held}");
        assert!(kept.settled && !exact.settled);
        // A missing sample ends it.
        kept.skip();
        assert!(!kept.settled && kept.kept == 0 && kept.since == 0);
        let before = kept.gain[0];
        kept.move_on();
        assert!(kept.gain[0] != before);
    }

    #[test]
    fn noise_that_a_sample_shares_with_the_state_is_freed_of_it() {
        // An MA(1): the state is the last innovation, known to rounding while θ is inside the circle.
        let filter = ShapingFilter::arma(&[], &[0.5], 2.0, 1.0).unwrap();
        let mut predictor = Predictor::<1>::new(&filter);
        // Variances of one-step predictions of an MA(1): σ² (1 − θ^(2k+2))/(1 − θ^2k).
        for k in 1..60 {
            let power = |n: i32| 1.0 - 0.25f64.powi(n);
            let expected = 4.0 * power(k + 1) / power(k);
            let miss = predictor.variance / expected - 1.0;
            assert!(miss.abs() < 1e-12, "{k}: {miss}");
            predictor.observe(0.3);
        }
        assert!(predictor.p[0][0].abs() < 1e-12);
    }
}
