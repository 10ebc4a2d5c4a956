//! One-step prediction under a shaping filter: the Kalman filter of the model alone, which settles.
//!
//! State x̂ and covariance P before a sample: `v = y − H x̂`, `V = H P Hᵀ + r`, `K = (F P Hᵀ + s)/V`,
//! `x̂ ← F x̂ + K v`. With r > 0 the driving noise is first freed of its correlation with the sample's
//! own (Anderson & Moore 1979, section 5.3): `A = F − s H/r`, `P ← A (P − P HᵀH P/V) Aᵀ + q − s sᵀ/r`,
//! so that the P of a model in innovations form falls to zero without a difference of large numbers.

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
    f: [[f64; N]; N],
    pub(crate) h: [f64; N],
    q: [[f64; N]; N],
    s: [f64; N],
    r: f64,
    /// F, q without the correlation with the sample's own noise; none where r = 0.
    freed: Option<Freed<N>>,
    /// Predicted state.
    pub(crate) x: [f64; N],
    /// Its covariance \[unit²\].
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
    kept: u32,
    since: u32,
    seen: ([f64; N], f64),
}

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
    pub(crate) fn settling(filter: &ShapingFilter, still: f64) -> Self {
        Self {
            stride: Steps::of(filter, LOG_LOOK),
            ..Self::until(filter, still)
        }
    }

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

    /// Carries the covariance over the samples for which the gains were kept.
    fn stride(&mut self) {
        if let Some(p) = self.stride.and_then(|steps| steps.after(&self.p)) {
            self.p = p;
            self.weigh();
        }
        self.look();
    }

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
