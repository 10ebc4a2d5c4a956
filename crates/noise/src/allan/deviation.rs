//! Overlapping Allan, modified Allan, overlapping Hadamard and total deviation of samples of a rate (angular rate, specific
//! force). Pure computation; called by [`crate::identify`] (the overlapping kind only) and the Python package.
//!
//! With `S_k` the sum of the first k samples less their mean and `m` samples to a τ, the variances
//! are mean squares of `S_{i+2m} − 2 S_{i+m} + S_i` and its kin. The mean only adds a straight line
//! to `S`, which none of them sees; without it `S` stays small and keeps its digits.

use super::{every_factor, octaves};
use crate::screening::record::{RecordError, check, check_rate, mean, prefix_sums};
use undrift_base::parallel;

/// Kind of deviation. The terms of IEEE Std 952 are defined by the overlapping one, and [`fit_terms`](super::fit_terms) takes
/// no other. The others are for a look: the modified one where quantisation hides what is slower, Hadamard's where
/// the bias drifts in a straight line, the total one for averaging times near the record's length.
///
/// Of quantisation, whose rate errors are the differences of white noise, the modified deviation falls as
/// τ^−3/2, the Allan deviation as 1/τ:
///
/// ```
/// use undrift_noise::allan::{DeviationKind, deviations_at};
/// let states = std::iter::successors(Some(1_u32), |s| Some(s.wrapping_mul(1_664_525).wrapping_add(1_013_904_223)));
/// let rounding: Vec<f64> = states.map(f64::from).take(20_001).collect();
/// let rates: Vec<f64> = rounding.windows(2).map(|pair| pair[1] - pair[0]).collect();
/// let fall = |kind| deviations_at(&rates, 100.0, kind, &[1, 16]).map(|of| of.points[0].deviation / of.points[1].deviation);
/// assert!((fall(DeviationKind::Overlapping)? / 16.0).ln().abs() < 0.2);
/// assert!((fall(DeviationKind::Modified)? / 64.0).ln().abs() < 0.3);
/// # Ok::<(), undrift_noise::screening::RecordError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeviationKind {
    /// Fully overlapping Allan deviation, NIST SP 1065 section 5.2.4, equation 11.
    Overlapping,
    /// Modified Allan deviation, section 5.2.5, equation 14: distinguishes white phase noise (quantisation)
    /// from flicker phase noise.
    Modified,
    /// Overlapping Hadamard deviation, section 5.2.10, equation 24: blind to a linear ramp.
    Hadamard,
    /// Total deviation, section 5.2.11, equation 25: the record is continued by reflection at both
    /// ends, for better confidence at the longest τ; τ up to the record's length.
    Total,
}

/// Averaging times of a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grid {
    /// m = 1, 2, 4, 8, … samples.
    Octave,
    /// m = 1, 2, 5, 10, 20, 50, … samples.
    Decade,
    /// This many averaging times to a factor of two, rounded to whole samples, each once.
    PerOctave(u32),
    /// Every m from 1 on, spread over the cores. The overlapping kind takes O(N log² N) time and some
    /// 80 bytes a sample, deviations within 5e-10 of the definition; the others O(N²).
    All,
}

/// Deviation at one averaging time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Samples averaged, the averaging factor.
    pub m: usize,
    /// Averaging time τ = m / rate \[s\].
    pub tau_s: f64,
    /// Deviation [unit of the samples].
    pub deviation: f64,
    /// Number of differences whose squares were averaged; overlapping ones are not independent ([`edf`](super::confidence::edf)).
    pub terms: usize,
}

/// A deviation over averaging time: what is drawn on double logarithmic axes, slopes −½ for white noise, 0 for bias instability, ½ for
/// a random walk.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Kind of deviation.
    pub kind: DeviationKind,
    /// Sample rate \[Hz\].
    pub rate_hz: f64,
    /// Number of samples of the record.
    pub samples: usize,
    /// The points by growing τ.
    pub points: Vec<Point>,
}

/// Samples that are differenced together before the next averaging time takes its turn: the
/// stretches that the averaging times share stay in the first cache.
const STRETCH: usize = 2048;

/// Number of averaging times from which on the work is spread over the cores, and FFTs may be faster.
const SPREAD: usize = 128;

impl DeviationKind {
    /// Order of the differences of the phase.
    pub(super) fn order(self) -> usize {
        2 + usize::from(self == Self::Hadamard)
    }

    /// Largest averaging factor of a record of `samples` rates, that leaves one difference; 0 where it is too short for any.
    ///
    /// A record of 1000 samples: 500 overlapping, 333 modified and Hadamard, 1000 total.
    pub fn largest_m(self, samples: usize) -> usize {
        match self {
            Self::Overlapping => samples / 2,
            Self::Modified => (samples + 1) / 3,
            Self::Hadamard => samples / 3,
            Self::Total => samples,
        }
    }

    /// Differences that `m` leaves of `samples` rates; 0 where `m` is too large.
    fn terms(self, samples: usize, m: usize) -> usize {
        let phases = samples + 1;
        match self {
            Self::Overlapping => phases.saturating_sub(2 * m),
            Self::Modified => (phases + 1).saturating_sub(3 * m),
            Self::Hadamard => phases.saturating_sub(3 * m),
            Self::Total => phases.saturating_sub(2),
        }
    }
}

impl Grid {
    /// The averaging factors of the grid up to `largest`, growing.
    ///
    /// ```
    /// use undrift_noise::allan::Grid;
    /// assert_eq!(Grid::Octave.factors(20), [1, 2, 4, 8, 16]);
    /// assert_eq!(Grid::Decade.factors(20), [1, 2, 5, 10, 20]);
    /// ```
    pub fn factors(self, largest: usize) -> Vec<usize> {
        let mut factors = Vec::new();
        match self {
            Self::Octave => {
                let doubled = |&m: &usize| m.checked_mul(2);
                factors
                    .extend(std::iter::successors(Some(1), doubled).take_while(|&m| m <= largest));
            }
            Self::Decade => {
                let mut decade = 1usize;
                while decade <= largest {
                    factors.extend(
                        [1, 2, 5]
                            .map(|k| k * decade)
                            .into_iter()
                            .filter(|&m| m <= largest),
                    );
                    decade = decade.saturating_mul(10);
                }
            }
            Self::PerOctave(count) => {
                let step = 1.0 / f64::from(count.max(1));
                let mut exponent = 0.0f64;
                while exponent.exp2().round() <= largest as f64 {
                    let m = exponent.exp2().round() as usize;
                    if factors.last() != Some(&m) {
                        factors.push(m);
                    }
                    exponent += step;
                }
            }
            Self::All => factors.extend(1..=largest),
        }
        factors
    }
}

/// The averaging factors nearest to the averaging times `taus_s` \[s\] at the sample rate `rate_hz` \[Hz\], growing, each once; at least 1. For
/// [`deviations_at`].
///
/// ```
/// use undrift_noise::allan::{DeviationKind, deviations_at, factors_of};
/// let rates: Vec<f64> = (0..1000).map(|k| f64::from(k * 7919 % 101)).collect();
/// let factors = factors_of(&[0.1, 1.0], 100.0)?;
/// assert_eq!(factors, [10, 100]);
/// let curve = deviations_at(&rates, 100.0, DeviationKind::Overlapping, &factors)?;
/// assert_eq!(curve.points[1].tau_s, 1.0);
/// # Ok::<(), undrift_noise::screening::RecordError>(())
/// ```
///
/// # Errors
/// A time that is not positive, a rate that is not positive.
pub fn factors_of(taus_s: &[f64], rate_hz: f64) -> Result<Vec<usize>, RecordError> {
    check_rate(rate_hz)?;
    if !taus_s.iter().all(|tau| *tau > 0.0 && tau.is_finite()) {
        return Err(RecordError::Argument(
            "averaging times must be positive numbers",
        ));
    }
    let mut factors: Vec<usize> = taus_s
        .iter()
        .map(|tau| (tau * rate_hz).round() as usize)
        .collect();
    factors.sort_unstable();
    factors.dedup();
    Ok(factors)
}

/// The deviation of `rates` sampled at `rate_hz` \[Hz\] at a grid of averaging times.
///
/// A missing sample has to be filled in by the caller: a gap that is closed up shifts noise to other averaging times.
///
/// ```
/// use undrift_noise::allan::{DeviationKind, Grid, deviations};
/// // A ramp R of 0.5 a second: its Allan deviation is R τ/√2, and Hadamard's does not see it.
/// let ramp: Vec<f64> = (0..1000).map(|k| 0.5 * f64::from(k) / 100.0).collect();
/// let allan = deviations(&ramp, 100.0, DeviationKind::Overlapping, Grid::Octave)?;
/// for point in &allan.points {
///     assert!((point.deviation - 0.5 * point.tau_s / 2f64.sqrt()).abs() < 1e-9);
/// }
/// let hadamard = deviations(&ramp, 100.0, DeviationKind::Hadamard, Grid::Octave)?;
/// assert!(hadamard.points.iter().all(|point| point.deviation < 1e-9));
/// # Ok::<(), undrift_noise::screening::RecordError>(())
/// ```
///
/// # Errors
/// Too short for m = 1 (2 samples, 3 for Hadamard), a sample that is not finite,
/// a rate that is not positive.
pub fn deviations(
    rates: &[f64],
    rate_hz: f64,
    kind: DeviationKind,
    grid: Grid,
) -> Result<Curve, RecordError> {
    deviations_at(
        rates,
        rate_hz,
        kind,
        &grid.factors(kind.largest_m(rates.len())),
    )
}

/// The deviation of [`deviations`] at averaging factors of the caller, in samples; those too large for the record or 0 are ignored.
///
/// # Errors
/// As [`deviations`].
pub fn deviations_at(
    rates: &[f64],
    rate_hz: f64,
    kind: DeviationKind,
    factors: &[usize],
) -> Result<Curve, RecordError> {
    let needed = kind.order();
    if rates.len() < needed {
        return Err(RecordError::TooShort {
            needed,
            got: rates.len(),
        });
    }
    check_rate(rate_hz)?;
    let samples = rates.len();
    let largest = kind.largest_m(samples);
    let factors: Vec<usize> = factors
        .iter()
        .copied()
        .filter(|&m| m >= 1 && m <= largest)
        .collect();
    let energies = energies(rates, kind, &factors)?;
    let mut points = Vec::with_capacity(factors.len());
    for (&m, energy) in factors.iter().zip(energies) {
        let terms = kind.terms(samples, m);
        let width = m as f64;
        let divisor = match kind {
            DeviationKind::Overlapping | DeviationKind::Total => 2.0 * width * width,
            DeviationKind::Modified => 2.0 * width.powi(4),
            DeviationKind::Hadamard => 6.0 * width * width,
        };
        let variance = energy / (divisor * terms as f64);
        points.push(Point {
            m,
            tau_s: width / rate_hz,
            deviation: variance.sqrt(),
            terms,
        });
    }
    Ok(Curve {
        kind,
        rate_hz,
        samples,
        points,
    })
}

/// Sums of squared differences of each factor, by the cheapest way there is.
///
/// # Errors
/// A sample that is not finite.
fn energies(
    rates: &[f64],
    kind: DeviationKind,
    factors: &[usize],
) -> Result<Vec<f64>, RecordError> {
    if kind == DeviationKind::Overlapping && factors.iter().all(|m| m.is_power_of_two()) {
        let octave = |m: usize| m.trailing_zeros() as usize;
        let octaves = factors.iter().map(|&m| octave(m) + 1).max().unwrap_or(1);
        let energies = octaves::energies(rates, octaves);
        if !energies[0].is_finite() {
            check(rates, 2)?;
        }
        return Ok(factors.iter().map(|&m| energies[octave(m)]).collect());
    }
    check(rates, 2)?;
    let sums = prefix_sums(rates, mean(rates));
    let one = |&m: &usize| energy(&sums, rates.len(), kind, m);
    Ok(match kind {
        // A constant has no second differences, and by FFT only rounding.
        DeviationKind::Overlapping if rates.iter().all(|rate| *rate == rates[0]) => {
            vec![0.0; factors.len()]
        }
        DeviationKind::Overlapping if factors.len() >= SPREAD => {
            every_factor::energies(&sums, factors, |m| one(&m))
        }
        _ if factors.len() >= SPREAD => parallel::map(factors.len(), |k| one(&factors[k])),
        DeviationKind::Overlapping | DeviationKind::Hadamard => {
            shared_pass(&sums, rates.len(), kind, factors)
        }
        _ => factors.iter().map(one).collect(),
    })
}

/// Sums of squared differences of all factors, one stretch of the record after the other.
fn shared_pass(sums: &[f64], samples: usize, kind: DeviationKind, factors: &[usize]) -> Vec<f64> {
    let mut energies = vec![0.0; factors.len()];
    for start in (0..=samples).step_by(STRETCH) {
        for (&m, energy) in factors.iter().zip(&mut energies) {
            let end = kind.terms(samples, m).min(start + STRETCH);
            if start < end {
                *energy += stretch_energy(sums, kind, m, start, end);
            }
        }
    }
    energies
}

/// Sum of squared differences of one factor.
fn energy(sums: &[f64], samples: usize, kind: DeviationKind, m: usize) -> f64 {
    undrift_base::interrupt::check();
    match kind {
        DeviationKind::Overlapping | DeviationKind::Hadamard => {
            let terms = kind.terms(samples, m);
            let starts = (0..terms).step_by(STRETCH);
            starts
                .map(|start| stretch_energy(sums, kind, m, start, terms.min(start + STRETCH)))
                .sum()
        }
        DeviationKind::Modified => modified_energy(sums, m),
        DeviationKind::Total => total_energy(sums, m),
    }
}

/// Sum of squared second (Allan) or third (Hadamard) differences that start in `start..end`.
fn stretch_energy(sums: &[f64], kind: DeviationKind, m: usize, start: usize, end: usize) -> f64 {
    undrift_base::interrupt::check();
    let at = |shift: usize| &sums[start + shift * m..end + shift * m];
    if kind == DeviationKind::Hadamard {
        return third_energy(at(0), at(1), at(2), at(3));
    }
    second_energy(at(0), at(1), at(2))
}

/// Σ (c − 2b + a)².
fn second_energy(a: &[f64], b: &[f64], c: &[f64]) -> f64 {
    let ((a8, a_tail), (b8, b_tail), (c8, c_tail)) =
        (a.as_chunks::<8>(), b.as_chunks::<8>(), c.as_chunks::<8>());
    let mut lanes = [0.0; 8];
    for ((a, b), c) in a8.iter().zip(b8).zip(c8) {
        for i in 0..8 {
            let difference = (c[i] - b[i]) - (b[i] - a[i]);
            lanes[i] += difference * difference;
        }
    }
    let mut total: f64 = lanes.iter().sum();
    for ((a, b), c) in a_tail.iter().zip(b_tail).zip(c_tail) {
        let difference = (c - b) - (b - a);
        total += difference * difference;
    }
    total
}

/// Σ (d − 3c + 3b − a)².
fn third_energy(a: &[f64], b: &[f64], c: &[f64], d: &[f64]) -> f64 {
    let mut lanes = [0.0; 8];
    let stretch = a.len() / 8 * 8;
    for k in (0..stretch).step_by(8) {
        let (a, b, c, d) = (&a[k..k + 8], &b[k..k + 8], &c[k..k + 8], &d[k..k + 8]);
        for i in 0..8 {
            let difference = (d[i] - a[i]) - 3.0 * (c[i] - b[i]);
            lanes[i] += difference * difference;
        }
    }
    let mut total: f64 = lanes.iter().sum();
    for k in stretch..a.len() {
        let difference = (d[k] - a[k]) - 3.0 * (c[k] - b[k]);
        total += difference * difference;
    }
    total
}

/// Sum of squares of the sums over m second differences each. The sum slides on by one third
/// difference; it is recomputed after m steps (but not below 1024) before rounding adds up.
fn modified_energy(sums: &[f64], m: usize) -> f64 {
    let terms = (sums.len() + 1).saturating_sub(3 * m);
    let second = |i: usize| (sums[i + 2 * m] - sums[i + m]) - (sums[i + m] - sums[i]);
    let mut total = 0.0;
    let mut start = 0;
    while start < terms {
        let end = terms.min(start + m.max(1024));
        let mut window: f64 = (start..start + m).map(second).sum();
        let mut energy = window * window;
        for j in start + 1..end {
            window += second(j + m - 1) - second(j - 1);
            energy += window * window;
        }
        total += energy;
        start = end;
    }
    total
}

/// Sum of squared second differences about every inner phase of the record continued by reflection.
fn total_energy(sums: &[f64], m: usize) -> f64 {
    let last = sums.len() - 1;
    let left = |i: usize| {
        if i >= m {
            sums[i - m]
        } else {
            2.0 * sums[0] - sums[m - i]
        }
    };
    let right = |i: usize| {
        if i + m <= last {
            sums[i + m]
        } else {
            2.0 * sums[last] - sums[2 * last - i - m]
        }
    };
    let square = |i: usize| {
        let difference = (right(i) - sums[i]) - (sums[i] - left(i));
        difference * difference
    };
    if 2 * m > last {
        return (1..last).map(square).sum();
    }
    // Phases m … last − m see no reflection; the others are 1 … m − 1 and last − m + 1 … last − 1.
    let ends: f64 = (1..m).chain(last - m + 1..last).map(square).sum();
    let inner_end = last - 2 * m + 1;
    let inner: f64 = (0..inner_end)
        .step_by(STRETCH)
        .map(|start| {
            stretch_energy(
                sums,
                DeviationKind::Overlapping,
                m,
                start,
                inner_end.min(start + STRETCH),
            )
        })
        .sum();
    ends + inner
}
/// The curve of several records of one process, of the same kind, rate and factors: at each averaging time the mean square
/// over all their terms. `None` if `curves` is empty.
///
/// Records of one sensor that was switched off in between may be pooled so; to concatenate them would turn the step of the
/// turn-on constants into a random walk.
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::{allan::{DeviationKind, Grid, deviations, pooled}, synthesis::NoiseGenerator};
/// let white = ShapingFilter::white(1e-3, 0.01)?;
/// let curve = |seed| {
///     let record: Vec<f64> = NoiseGenerator::new(&white, seed).take(2000).collect();
///     deviations(&record, 100.0, DeviationKind::Overlapping, Grid::Octave)
/// };
/// let both = pooled(&[curve(1)?, curve(2)?]).expect("two curves");
/// assert_eq!(both.samples, 4000);
/// assert!((both.points[0].deviation / 0.01 - 1.0).abs() < 0.05); // N/√T
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn pooled(curves: &[Curve]) -> Option<Curve> {
    if let [one] = curves {
        return Some(one.clone());
    }
    let mut pooled = curves
        .iter()
        .max_by_key(|curve| curve.points.len())?
        .clone();
    pooled.samples = curves.iter().map(|curve| curve.samples).sum();
    for point in &mut pooled.points {
        let all = curves.iter().flat_map(|curve| &curve.points);
        let alike = all.filter(|other| other.m == point.m);
        let (squares, terms) = alike.fold((0.0, 0), |(squares, terms), other| {
            let more = other.deviation.powi(2) * other.terms as f64;
            (squares + more, terms + other.terms)
        });
        point.deviation = (squares / terms as f64).sqrt();
        point.terms = terms;
    }
    Some(pooled)
}
