//! Random noise of any shaping filter, from a named generator: a seed means the same noise on
//! every machine.
//!
//! A sample is `ε_k = H x_k + D w_k`, the state then goes on by `x_{k+1} = F x_k + G w_k`, w standard normal (docs/conventions.md,
//! Noise). The state starts at a draw from the filter's `p0`: stationary where it is, the turn-on constant included.

use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use undrift_nav::shaping::{MAX_ORDER, ShapingFilter};

/// Draws the samples ε_0, ε_1, … of a shaping filter, without end: an iterator, or one by one.
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::synthesis::NoiseGenerator;
/// let filter = ShapingFilter::arma(&[0.9], &[0.5], 0.01, 0.005)?;
/// let mut record = vec![0.0; 1000];
/// NoiseGenerator::new(&filter, 1).fill(&mut record);
/// // A seed means the same noise, whether filled or iterated.
/// assert!(record.iter().copied().eq(NoiseGenerator::new(&filter, 1).take(1000)));
/// assert_ne!(record[0], NoiseGenerator::new(&filter, 2).sample());
/// # Ok::<(), undrift_nav::shaping::ShapingError>(())
/// ```
#[derive(Clone, Debug)]
pub struct NoiseGenerator {
    filter: ShapingFilter,
    factor: [[f64; MAX_ORDER + 1]; MAX_ORDER + 1],
    state: [f64; MAX_ORDER],
    rng: Xoshiro256PlusPlus,
}

impl NoiseGenerator {
    /// A generator with the state drawn from the filter's `p0`, from xoshiro256++ seeded with `seed`.
    ///
    /// ```
    /// use undrift_nav::shaping::ShapingFilter;
    /// use undrift_noise::synthesis::NoiseGenerator;
    /// // A thousand switch-ons: the constants scatter by the turn-on's standard deviation.
    /// let turn_on = ShapingFilter::constant(0.02, 0.01)?;
    /// let squares: f64 = (0..1000).map(|seed| NoiseGenerator::new(&turn_on, seed).bias().powi(2)).sum();
    /// assert!(((squares / 1000.0).sqrt() / 0.02 - 1.0).abs() < 0.1);
    /// # Ok::<(), undrift_nav::shaping::ShapingError>(())
    /// ```
    pub fn new(filter: &ShapingFilter, seed: u64) -> Self {
        Self::with_rng(filter, Xoshiro256PlusPlus::seed_from_u64(seed))
    }

    /// A generator that draws from `rng` of the caller, for example one jumped ahead for each axis, so that axes are independent.
    ///
    /// ```
    /// use rand_xoshiro::{Xoshiro256PlusPlus, rand_core::SeedableRng};
    /// use undrift_nav::shaping::ShapingFilter;
    /// use undrift_noise::synthesis::NoiseGenerator;
    /// let filter = ShapingFilter::white(1e-3, 0.01)?;
    /// let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
    /// let [mut x, mut y] = [(); 2].map(|()| {
    ///     rng.jump(); // 2¹²⁸ numbers on: the axes share none.
    ///     NoiseGenerator::with_rng(&filter, rng.clone())
    /// });
    /// assert_ne!(x.sample(), y.sample());
    /// # Ok::<(), undrift_nav::shaping::ShapingError>(())
    /// ```
    pub fn with_rng(filter: &ShapingFilter, mut rng: Xoshiro256PlusPlus) -> Self {
        let initial = filter.initial_factor();
        let mut state = [0.0; MAX_ORDER];
        for j in 0..filter.order {
            let w: f64 = StandardNormal.sample(&mut rng);
            for i in j..filter.order {
                state[i] += initial[i][j] * w;
            }
        }
        Self {
            filter: *filter,
            factor: filter.noise_factor(),
            state,
            rng,
        }
    }

    /// The next sample ε_k [rad/s or m/s²].
    pub fn sample(&mut self) -> f64 {
        let n = self.filter.order;
        let mut w = [0.0; MAX_ORDER + 1];
        for slot in &mut w[..=n] {
            *slot = StandardNormal.sample(&mut self.rng);
        }
        let mut value = self.factor[0][0] * w[0];
        let mut next = [0.0; MAX_ORDER];
        for i in 0..n {
            value += self.filter.h[i] * self.state[i];
            for j in 0..n {
                next[i] += self.filter.f[i][j] * self.state[j];
            }
            for j in 0..=i + 1 {
                next[i] += self.factor[i + 1][j] * w[j];
            }
        }
        self.state = next;
        value
    }

    /// Fills `out` with the next samples [rad/s or m/s²].
    ///
    /// As many calls of [`Self::sample`]:
    ///
    /// ```
    /// use undrift_nav::shaping::ShapingFilter;
    /// use undrift_noise::synthesis::NoiseGenerator;
    /// let process = ShapingFilter::gauss_markov(1e-3, 0.5, 0.01)?;
    /// let (mut a, mut b) = (NoiseGenerator::new(&process, 7), NoiseGenerator::new(&process, 7));
    /// let mut samples = [0.0; 3];
    /// a.fill(&mut samples);
    /// assert_eq!(samples, [b.sample(), b.sample(), b.sample()]);
    /// # Ok::<(), undrift_nav::shaping::ShapingError>(())
    /// ```
    pub fn fill(&mut self, out: &mut [f64]) {
        for slot in out {
            *slot = self.sample();
        }
    }

    /// What can be predicted of the next sample, `h · x` [rad/s or m/s²]: the true bias.
    ///
    /// Asked for before [`Self::sample`], it is what a perfect estimator would subtract from that sample; what
    /// is left is `D w_k`.
    ///
    /// ```
    /// use undrift_nav::shaping::ShapingFilter;
    /// use undrift_noise::synthesis::NoiseGenerator;
    /// let turn_on = ShapingFilter::constant(0.02, 0.01)?; // Nothing white beside it: the sample is the bias.
    /// let mut noise = NoiseGenerator::new(&turn_on, 1);
    /// let bias = noise.bias();
    /// assert!((0..5).all(|_| noise.sample() == bias));
    /// assert_eq!(NoiseGenerator::new(&ShapingFilter::white(1e-3, 0.01)?, 1).bias(), 0.0);
    /// # Ok::<(), undrift_nav::shaping::ShapingError>(())
    /// ```
    pub fn bias(&self) -> f64 {
        (0..self.filter.order)
            .map(|i| self.filter.h[i] * self.state[i])
            .sum()
    }
}

impl Iterator for NoiseGenerator {
    type Item = f64;

    /// The next sample; never ends.
    fn next(&mut self) -> Option<f64> {
        Some(self.sample())
    }
}
