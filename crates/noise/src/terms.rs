//! The terms of a composite model: independent processes, whose parameters hold at every sample rate.

use crate::quasi_newton::Scales;
use nalgebra::DMatrix;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use undrift_nav::shaping::{MAX_ORDER, ShapingError, ShapingFilter};

/// How their parameters are searched: functions are log-likelihoods of logarithms, with curvatures 0.1 to 1e6.
pub(crate) const SCALES: Scales = Scales {
    step: 1e-3,
    longest: 1.5,
    edge: f64::INFINITY,
    curved: true,
};

/// Correlation times \[s\] of the Gauss-Markov processes that make flicker noise, a decade apart; what is slower
/// is a random walk.
pub const FLICKER_TAUS: [f64; 4] = [1.0, 10.0, 100.0, 1000.0];

/// Largest number of Gauss-Markov processes in one model.
pub const MAX_GAUSS_MARKOV: usize = 2;

/// Why a composite model cannot be evaluated on a record or fitted to it.
///
/// Too few samples, or all alike, are the recording's fault; [`CompositeError::BadTerms`] and
/// [`CompositeError::Shaping`] the caller's.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum CompositeError {
    /// Fewer samples than needed (missing ones not counted).
    #[error("too few samples: {present}, {needed} are needed")]
    TooShort {
        /// Samples present.
        present: usize,
        /// Samples needed.
        needed: usize,
    },
    /// All samples present are equal.
    #[error("the recording is constant")]
    Constant,
    /// A sample or the result is infinite.
    #[error("the recording has values that are not finite")]
    NotFinite,
    /// The model gives a sample no variance at all.
    #[error("the model has zero variance at some sample")]
    NoVariance,
    /// The set of terms is empty or too large.
    #[error("a composite model needs at least one term and at most two Gauss-Markov processes")]
    BadTerms,
    /// No start gave a finite likelihood.
    #[error("the likelihood is not finite at any start")]
    NoOptimum,
    /// The terms make no shaping filter.
    #[error(transparent)]
    Shaping(#[from] ShapingError),
}

/// A first-order Gauss-Markov process.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GaussMarkov {
    /// Standard deviation σ \[unit\]; 0 without a process.
    pub sigma: f64,
    /// Correlation time τ \[s\].
    pub tau_s: f64,
}

impl GaussMarkov {
    /// Coefficient σ √(2/τ) [unit/√s] of the random walk that the process is at times far below τ.
    ///
    /// ```
    /// use undrift_noise::GaussMarkov;
    /// // Over seconds a bias of 10 deg/h and 300 s is a walk of 0.82 deg/h/√s.
    /// let bias = GaussMarkov { sigma: 10.0, tau_s: 300.0 };
    /// assert!((bias.drive() - 0.816).abs() < 1e-3);
    /// ```
    pub fn drive(&self) -> f64 {
        if self.sigma > 0.0 {
            self.sigma * (2.0 / self.tau_s).sqrt()
        } else {
            0.0
        }
    }
}

/// The terms of a composite model; a term of 0 is absent.
///
/// A set of terms is a model at every rate: only [`CompositeTerms::to_shaping`] asks for one.
///
/// ```
/// use undrift_noise::composite::{CompositeTerms, GaussMarkov};
/// let gyro = CompositeTerms {
///     white: 1e-4,         // N [rad/√s]
///     random_walk: 1e-6,   // K [rad/s/√s]
///     gauss_markov: [GaussMarkov { sigma: 2e-5, tau_s: 100.0 }, GaussMarkov::default()], // σ [rad/s]
///     ..CompositeTerms::default()
/// };
/// let [fast, slow] = [0.005, 0.02].map(|interval| gyro.to_shaping(interval));
/// let (fast, slow) = (fast?, slow?);
/// assert_eq!(fast.order, 2); // The process and the walk.
/// assert!((fast.r / slow.r - 4.0).abs() < 1e-12); // White variance a sample: N²/T.
/// assert_eq!(fast.p0[0][0], slow.p0[0][0]); // The variance of the process is that at any rate.
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CompositeTerms {
    /// White noise density N [unit·√s = unit/√Hz].
    pub white: f64,
    /// Quantisation Q [unit·s], the standard deviation of the rounding error of the integrated
    /// signal: ε_k = (e_k − e_{k−1}) Q/T with e white, an MA(1) with θ = 1 of σ_Q = Q/T a sample.
    pub quantisation: f64,
    /// Random walk coefficient K [unit/√s].
    pub random_walk: f64,
    /// Coefficient B of flicker noise (bias instability) \[unit\], of power density `B²/(2πf)`; see [`flicker`].
    pub flicker: f64,
    /// Gauss-Markov processes, by growing correlation time after a fit.
    #[serde(serialize_with = "list", deserialize_with = "listed")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<GaussMarkov>"))]
    pub gauss_markov: [GaussMarkov; MAX_GAUSS_MARKOV],
}

/// Serialises the processes that are there, as a list.
fn list<S: Serializer>(processes: &[GaussMarkov], to: S) -> Result<S::Ok, S::Error> {
    to.collect_seq(processes.iter().filter(|process| process.sigma > 0.0))
}

fn listed<'de, D: Deserializer<'de>, const N: usize>(
    from: D,
) -> Result<[GaussMarkov; N], D::Error> {
    let mut there = Vec::deserialize(from)?.into_iter();
    Ok(std::array::from_fn(|_| there.next().unwrap_or_default()))
}

/// The shaping filter of quantisation Q [unit·s] at a sample interval \[s\], see
/// [`CompositeTerms::quantisation`].
///
/// One state, the rounding before: `x_{k+1} = −w_k`, `ε_k = x_k + w_k`, w of standard deviation Q/T.
pub(crate) fn quantisation(q: f64, interval: f64) -> Result<ShapingFilter, ShapingError> {
    if !(q >= 0.0 && q.is_finite()) {
        return Err(ShapingError::BadParameter("the quantisation"));
    }
    let variance = (q / interval).powi(2);
    let mut filter = ShapingFilter::none(interval)?;
    filter.order = 1;
    filter.h[0] = 1.0;
    filter.r = variance;
    filter.q[0][0] = variance;
    filter.s[0] = -variance;
    filter.p0[0][0] = variance;
    Ok(filter)
}

/// Flicker noise of coefficient B \[unit\] as a sum: Gauss-Markov processes at [`FLICKER_TAUS`] and the coefficient
/// [unit/√s] of the random walk that the slower ones are over any drive. Processes of one σ, spaced by a factor ρ in τ, sum
/// to the power density `σ²/(2 f ln ρ)` within 5 % for ρ = 10, so `σ² = B² ln ρ/π`; those of τ = 10⁴, 10⁵… s drive
/// `K² = Σ 2σ²/τ`. Keshner 1982; IEEE Std 952-1997, C.1.1 for B.
///
/// ```
/// use undrift_noise::composite::{FLICKER_TAUS, flicker};
/// let (processes, walk) = flicker(1e-4);
/// // One σ at all correlation times, σ² = B² ln 10/π; what is slower is a walk.
/// assert!(processes.iter().all(|process| process.sigma == processes[0].sigma));
/// assert!((processes[0].sigma / 1e-4 - 0.856).abs() < 1e-3);
/// assert_eq!(processes[3].tau_s, FLICKER_TAUS[3]);
/// assert!(walk > 0.0 && walk < processes[3].drive());
/// ```
pub fn flicker(b: f64) -> ([GaussMarkov; FLICKER_TAUS.len()], f64) {
    let sigma = b * (10f64.ln() / std::f64::consts::PI).sqrt();
    let next = 10.0 * FLICKER_TAUS[FLICKER_TAUS.len() - 1];
    let walk = sigma * (2.0 / (0.9 * next)).sqrt();
    (FLICKER_TAUS.map(|tau_s| GaussMarkov { sigma, tau_s }), walk)
}

impl CompositeTerms {
    /// All slow terms as Gauss-Markov processes and the coefficient of a random walk [unit/√s], flicker noise as the sum that approximates it.
    /// Flicker noise adds the processes of [`FLICKER_TAUS`] and, in squares, the walk that stands for slower
    /// ones: see [`flicker`].
    pub fn slow(&self) -> (Vec<GaussMarkov>, f64) {
        let mut processes: Vec<GaussMarkov> = self.gauss_markov.to_vec();
        processes.retain(|process| process.sigma != 0.0);
        if self.flicker == 0.0 {
            return (processes, self.random_walk);
        }
        let (decades, walk) = flicker(self.flicker);
        processes.extend(decades);
        (processes, self.random_walk.hypot(walk))
    }

    /// The shaping filter of the sum at a sample interval \[s\]: states in the order Gauss-Markov (flicker noise last),
    /// random walk (starting at zero), quantisation. At another rate build it again from the terms:
    /// the quantisation's pole at 0 keeps `ShapingFilter::at_interval` from it.
    ///
    /// # Errors
    /// A term or the interval is negative or not finite.
    ///
    /// ```
    /// use undrift_noise::composite::CompositeTerms;
    /// // A walk of K over T has the step variance K²T, white noise of density N the sample variance N²/T.
    /// let terms = CompositeTerms { white: 0.1, random_walk: 2.0, ..CompositeTerms::default() };
    /// let filter = terms.to_shaping(0.01)?;
    /// assert!((filter.q[0][0] - 0.04).abs() < 1e-15 && (filter.r - 1.0).abs() < 1e-12);
    /// # Ok::<(), undrift_nav::shaping::ShapingError>(())
    /// ```
    pub fn to_shaping(&self, interval: f64) -> Result<ShapingFilter, ShapingError> {
        let mut sum = ShapingFilter::white(self.white, interval)?;
        let (processes, walk) = self.slow();
        for process in processes {
            let part = ShapingFilter::gauss_markov(process.sigma, process.tau_s, interval)?;
            sum = sum.plus(&part)?;
        }
        if walk != 0.0 {
            sum = sum.plus(&ShapingFilter::random_walk(walk, interval)?)?;
        }
        if self.quantisation != 0.0 {
            sum = sum.plus(&quantisation(self.quantisation, interval)?)?;
        }
        Ok(sum)
    }

    /// The set of terms that are present, to fit them again.
    ///
    /// ```
    /// use undrift_noise::composite::{CompositeTerms, GaussMarkov};
    /// let process = GaussMarkov { sigma: 1e-4, tau_s: 100.0 };
    /// let gauss_markov = [process, GaussMarkov::default()];
    /// let terms = CompositeTerms { white: 1e-3, gauss_markov, ..CompositeTerms::default() };
    /// let set = terms.set();
    /// assert_eq!((set.white, set.gauss_markov, set.parameters()), (true, 1, 3)); // N, σ and τ.
    /// ```
    pub fn set(&self) -> TermSet {
        TermSet {
            white: self.white != 0.0,
            quantisation: self.quantisation != 0.0,
            random_walk: self.random_walk != 0.0,
            flicker: self.flicker != 0.0,
            gauss_markov: self.gauss_markov.iter().filter(|g| g.sigma != 0.0).count(),
        }
    }

    /// These terms with every amplitude times `factor` (correlation times kept): of a sensor that is as noisy by that factor.
    ///
    /// ```
    /// use undrift_noise::composite::{CompositeTerms, GaussMarkov};
    /// let process = GaussMarkov { sigma: 2e-5, tau_s: 100.0 };
    /// let terms = CompositeTerms { white: 1e-4, gauss_markov: [process, GaussMarkov::default()], ..CompositeTerms::default() };
    /// let noisier = terms.scaled(3.0);
    /// assert_eq!((noisier.gauss_markov[0].sigma, noisier.gauss_markov[0].tau_s), (3.0 * 2e-5, 100.0));
    /// assert_eq!(noisier.set(), terms.set());
    /// ```
    pub fn scaled(&self, factor: f64) -> Self {
        let process = |g: GaussMarkov| GaussMarkov {
            sigma: g.sigma * factor,
            ..g
        };
        Self {
            white: self.white * factor,
            quantisation: self.quantisation * factor,
            random_walk: self.random_walk * factor,
            flicker: self.flicker * factor,
            gauss_markov: self.gauss_markov.map(process),
        }
    }
}

/// Terms that a fit may use.
///
/// ```
/// use undrift_noise::composite::TermSet;
/// let set = TermSet { white: true, random_walk: true, gauss_markov: 1, ..TermSet::default() };
/// assert_eq!(set.parameters(), 4); // N, K, σ and τ.
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TermSet {
    /// Whether with white noise.
    pub white: bool,
    /// Whether with quantisation.
    pub quantisation: bool,
    /// Whether with a random walk.
    pub random_walk: bool,
    /// Whether with flicker noise.
    pub flicker: bool,
    /// Number of Gauss-Markov processes, at most [`MAX_GAUSS_MARKOV`].
    pub gauss_markov: usize,
}

impl TermSet {
    /// Number of parameters, the level of a record not counted.
    pub fn parameters(&self) -> usize {
        self.amplitudes() + self.gauss_markov
    }

    /// Number of amplitudes: all parameters but the correlation times.
    pub(crate) fn amplitudes(&self) -> usize {
        usize::from(self.white)
            + usize::from(self.quantisation)
            + usize::from(self.random_walk)
            + usize::from(self.flicker)
            + self.gauss_markov
    }

    pub(crate) fn check(&self) -> Result<(), CompositeError> {
        if self.parameters() == 0 || self.gauss_markov > MAX_GAUSS_MARKOV {
            return Err(CompositeError::BadTerms);
        }
        Ok(())
    }

    /// Search coordinates: the logarithms of N, Q, K, B, of each process's drive σ√(2/τ), then of each
    /// τ. The drive, unlike σ, stays determined when τ is beyond the record.
    /// A term of 0 has the coordinate −∞, and is not in a set that is fitted.
    pub(crate) fn coordinates(&self, terms: &CompositeTerms) -> Vec<f64> {
        let mut z = Vec::with_capacity(self.parameters());
        if self.white {
            z.push(terms.white.ln());
        }
        if self.quantisation {
            z.push(terms.quantisation.ln());
        }
        if self.random_walk {
            z.push(terms.random_walk.ln());
        }
        if self.flicker {
            z.push(terms.flicker.ln());
        }
        let processes = &terms.gauss_markov[..self.gauss_markov];
        z.extend(processes.iter().map(|g| g.drive().ln()));
        z.extend(processes.iter().map(|g| g.tau_s.ln()));
        z
    }

    /// The terms at search coordinates.
    pub(crate) fn terms(&self, z: &[f64]) -> CompositeTerms {
        let mut values = z.iter().map(|v| v.exp());
        let mut next = |wanted: bool| match wanted {
            true => values.next().unwrap_or(0.0),
            false => 0.0,
        };
        let mut terms = CompositeTerms {
            white: next(self.white),
            quantisation: next(self.quantisation),
            random_walk: next(self.random_walk),
            flicker: next(self.flicker),
            ..CompositeTerms::default()
        };
        let drives: [f64; MAX_GAUSS_MARKOV] = std::array::from_fn(|i| next(i < self.gauss_markov));
        for (i, drive) in drives.into_iter().enumerate() {
            let tau_s = next(i < self.gauss_markov);
            let sigma = drive * (0.5 * tau_s).sqrt();
            terms.gauss_markov[i] = GaussMarkov { sigma, tau_s };
        }
        terms
    }

    /// Standard errors of the logarithms of the terms' own parameters from the covariance of the
    /// search coordinates: `ln σ = ln drive + ½ ln τ − ½ ln 2`.
    pub(crate) fn relative_errors(&self, covariance: &DMatrix<f64>) -> CompositeTerms {
        let at = |i: usize, j: usize| covariance[(i, j)];
        let mut index = 0;
        let mut next = |wanted: bool| {
            if !wanted {
                return 0.0;
            }
            index += 1;
            at(index - 1, index - 1).max(0.0).sqrt()
        };
        let mut errors = CompositeTerms {
            white: next(self.white),
            quantisation: next(self.quantisation),
            random_walk: next(self.random_walk),
            flicker: next(self.flicker),
            ..CompositeTerms::default()
        };
        let first = self.amplitudes() - self.gauss_markov;
        for i in 0..self.gauss_markov {
            let (drive, tau) = (first + i, first + self.gauss_markov + i);
            let sigma = at(drive, drive) + at(drive, tau) + 0.25 * at(tau, tau);
            errors.gauss_markov[i] = GaussMarkov {
                sigma: sigma.max(0.0).sqrt(),
                tau_s: at(tau, tau).max(0.0).sqrt(),
            };
        }
        errors
    }
}

// Six states of an axis: two Gauss-Markov, random walk and quantisation leave two for the caller.
const _: () = assert!(MAX_GAUSS_MARKOV + 2 <= MAX_ORDER);

/// Sorts the processes by correlation time (and `errors` with them); absent ones last.
pub(crate) fn sort_processes(terms: &mut CompositeTerms, errors: Option<&mut CompositeTerms>) {
    let [a, b] = terms.gauss_markov;
    if b.sigma != 0.0 && (a.sigma == 0.0 || b.tau_s < a.tau_s) {
        terms.gauss_markov.swap(0, 1);
        if let Some(errors) = errors {
            errors.gauss_markov.swap(0, 1);
        }
    }
}

/// Mean of the samples present \[unit\], and their number.
pub(crate) fn present_mean(record: &[f64]) -> Result<(f64, usize), CompositeError> {
    let (mut total, mut present) = (0.0, 0usize);
    for block in record.chunks(256) {
        let (mut sum, mut count) = (0.0, 0);
        for &value in block {
            if !value.is_nan() {
                sum += value;
                count += 1;
            }
        }
        total += sum;
        present += count;
    }
    let mean = total / present.max(1) as f64;
    if mean.is_finite() {
        Ok((mean, present))
    } else {
        Err(CompositeError::NotFinite)
    }
}

#[cfg(test)]
mod tests;
