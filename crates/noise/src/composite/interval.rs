//! Confidence intervals of a composite model's parameters, from the profile of its restricted likelihood; that of white noise
//! from its standard error. Called by [`crate::identify`] for the recommended model.
//!
//! A correlation time that is not short against the record is far from normally distributed about its estimate, in
//! any scale: a standard error says little of it, and the record may not contradict a random walk at all. A profile
//! interval holds the values that the record does not contradict (Pawitan 2001, section 3.4); with the level integrated
//! out, its probability holds up to a unit root (Chen & Deo 2009).

use super::averages::{Averages, Marginal, NO_MARGINAL, OVERLAP_COORDINATE};
use super::fit::CompositeFit;
use super::{CompositeError, TermSet};
use crate::quasi_newton::{Objective, Point, bfgs};
use crate::terms::SCALES;
use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF, Normal};

/// Block averages that the profile is of, at most…
const POINTS: usize = 10_000;
/// …but so many to the shortest correlation time.
const RESOLVED: f64 = 10.0;
/// Predicted decrease at which the search over the other parameters stops.
const TOLERANCE: f64 = 1e-3;
/// Accuracy of an end, as a share of its distance from the estimate.
const SHARE: f64 = 0.01;
/// An end so far away, in logarithms, is open.
const OPEN: f64 = 14.0;
/// First step from the estimate without a standard error, in logarithms.
const STEP: f64 = 0.5;

/// A parameter of composite terms.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Parameter {
    /// White noise N [unit·√s].
    White,
    /// Quantisation Q [unit·s].
    Quantisation,
    /// Random walk K [unit/√s].
    RandomWalk,
    /// Flicker noise B \[unit\].
    Flicker,
    /// σ \[unit\] of the Gauss-Markov process of this index.
    Sigma(usize),
    /// τ \[s\] of the Gauss-Markov process of this index.
    Tau(usize),
}

/// Profile interval of a parameter.
///
/// An open end is an answer: a record in which the correlation time may be infinite does not tell a process
/// from a random walk.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ParameterInterval {
    /// Parameter that it is of.
    pub parameter: Parameter,
    /// Most likely value, in the parameter's unit, as the ends.
    pub estimate: f64,
    /// Lower end; 0 where the record does not bound it.
    pub low: f64,
    /// Upper end; infinite where the record does not bound it.
    pub high: f64,
}

impl ParameterInterval {
    /// Whether both ends are bounded.
    ///
    /// ```
    /// use undrift_noise::composite::{Parameter, ParameterInterval};
    /// // A correlation time of at least 200 s: the record does not exclude a random walk.
    /// let tau = ParameterInterval { parameter: Parameter::Tau(0), estimate: 900.0, low: 200.0, high: f64::INFINITY };
    /// assert!(!tau.is_determined());
    /// ```
    pub fn is_determined(&self) -> bool {
        self.low > 0.0 && self.high.is_finite()
    }
}

/// Confidence intervals of all parameters of a fit to `record`; `interval` is the sampling interval \[s\], `level` the confidence
/// level (0.95, say). Hundreds of likelihood evaluations, mostly of up to 10 000 block averages; with quantisation of every
/// sample.
///
/// ```
/// use undrift_noise::composite::{CompositeTerms, FitOptions, TermSet, fit, intervals};
/// use undrift_noise::synthesis::NoiseGenerator;
/// let truth = CompositeTerms { white: 0.01, random_walk: 0.01, ..CompositeTerms::default() };
/// let record: Vec<f64> = NoiseGenerator::new(&truth.to_shaping(0.1)?, 1).take(2000).collect();
/// let set = TermSet { white: true, random_walk: true, ..TermSet::default() };
/// let fitted = fit(&record, 0.1, set, &FitOptions::default())?;
/// for interval in intervals(&record, 0.1, &fitted, 0.99)? {
///     assert!(interval.is_determined() && interval.low < 0.01 && 0.01 < interval.high);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// A record that is not that of the fit; a likelihood that is not finite at its optimum.
pub fn intervals(
    record: &[f64],
    interval: f64,
    fit: &CompositeFit,
    level: f64,
) -> Result<Vec<ParameterInterval>, CompositeError> {
    intervals_of_several(&[record], interval, fit, level)
}

/// The intervals of [`intervals`] for a fit to several records ([`fit_several`](super::fit_several)), which are given again.
///
/// # Errors
/// As [`intervals`].
pub fn intervals_of_several(
    records: &[&[f64]],
    interval: f64,
    fit: &CompositeFit,
    level: f64,
) -> Result<Vec<ParameterInterval>, CompositeError> {
    intervals_marginal(records, interval, fit, level, NO_MARGINAL)
}

/// Does [`intervals_of_several`] for a fit with something else integrated out of the records.
pub(crate) fn intervals_marginal(
    records: &[&[f64]],
    interval: f64,
    fit: &CompositeFit,
    level: f64,
    marginal: Marginal,
) -> Result<Vec<ParameterInterval>, CompositeError> {
    let samples: usize = records.iter().map(|record| record.len()).sum();
    let set = fit.terms.set();
    let taus = fit.terms.gauss_markov.iter().filter(|g| g.sigma > 0.0);
    let shortest = taus.map(|g| g.tau_s).fold(f64::INFINITY, f64::min);
    let most = (shortest / (RESOLVED * interval)).clamp(1.0, 1e9) as usize;
    let block = if set.quantisation {
        1
    } else {
        samples.div_ceil(POINTS).min(most)
    };
    let block = block.max(fit.block);
    let mut averages = Averages::new(records, block, interval)?.marginal(marginal);
    // The covariance of two blocks is the same however long they are.
    averages.overlap = fit.overlap * fit.block as f64 / block as f64;
    let longest = records.iter().map(|record| record.len()).max();
    let longest_s = longest.unwrap_or(0) as f64 * interval;
    let half = 0.5 * Normal::standard().inverse_cdf(0.5 + 0.5 * level).powi(2);
    let profile = Profile {
        averages: &averages,
        set,
        tau_range: (0.05 * interval).ln()..(1e3 * longest_s).ln(),
    };
    let start = profile.coordinates(fit);
    let cost = |w: &[Vec<f64>]| w.iter().map(|w| profile.cost(w)).collect();
    let mut objective = Objective::new(&cost, SCALES);
    let start = Point::new(start.clone(), profile.cost(&start));
    let best = bfgs(&mut objective, &start, TOLERANCE, 60);
    if !best.value.is_finite() {
        return Err(CompositeError::NoOptimum);
    }
    let ends =
        |at: usize| [-1.0, 1.0].map(|sign| profile.end(&best, at, sign, half).map(|end| end.exp()));
    let parameters = profile.parameters().into_iter().enumerate();
    let interval_of = |(at, parameter): (usize, Parameter)| {
        if parameter == Parameter::White {
            return white(records, fit, level);
        }
        let [low, high] = ends(at);
        ParameterInterval {
            parameter,
            estimate: best.z[at].exp(),
            low: low.unwrap_or(0.0),
            high: high.unwrap_or(f64::INFINITY),
        }
    };
    let mut found: Vec<ParameterInterval> = parameters.map(interval_of).collect();
    // A τ that may be a hundred records may be any, and then σ too, which grows with its root.
    let longest = 100.0 * longest_s;
    for i in 0..set.gauss_markov {
        let is_open = |b: &ParameterInterval| b.parameter == Parameter::Tau(i) && b.high > longest;
        if found.iter().any(is_open) {
            let of_it = [Parameter::Tau(i), Parameter::Sigma(i)];
            let open = found.iter_mut().filter(|b| of_it.contains(&b.parameter));
            open.for_each(|b| b.high = f64::INFINITY);
        }
    }
    Ok(found)
}

/// The interval of white noise, by a standard error and not by the profile: it is known so well that its logarithm is normal.
/// Estimated at the full rate, its square has the relative variance κ/n of n samples, κ the noise's kurtosis; else the error of
/// the fit's curvature, which holds for normal noise, is multiplied by √((κ − 1)/2), κ that of the block averages.
fn white(records: &[&[f64]], fit: &CompositeFit, level: f64) -> ParameterInterval {
    let estimate = fit.terms.white;
    let present = |record: &&[f64]| record.iter().filter(|value| !value.is_nan()).count();
    let samples: usize = records.iter().map(present).sum();
    let kurtosis = kurtosis(records).max(3.0);
    let error = match fit.relative_errors {
        _ if estimate == fit.white_full_rate => 0.5 * (kurtosis / samples as f64).sqrt(),
        Some(errors) => {
            // Of averages of so many samples.
            let averaged = 3.0 + (kurtosis - 3.0) / fit.block.max(1) as f64;
            errors.white * (0.5 * (averaged - 1.0)).sqrt()
        }
        None => f64::INFINITY,
    };
    let reach = (error * Normal::standard().inverse_cdf(0.5 + 0.5 * level)).exp();
    ParameterInterval {
        parameter: Parameter::White,
        estimate,
        low: estimate / reach,
        high: estimate * reach,
    }
}

/// Kurtosis of the white noise, by the differences of neighbours: theirs is κ/2 + 3/2.
fn kurtosis(records: &[&[f64]]) -> f64 {
    let (mut squares, mut fourths, mut count) = (0.0, 0.0, 0.0);
    for pair in records.iter().flat_map(|record| record.windows(2)) {
        let square = (pair[1] - pair[0]).powi(2);
        if square.is_finite() {
            squares += square;
            fourths += square * square;
            count += 1.0;
        }
    }
    2.0 * count * fourths / (squares * squares) - 3.0
}

/// The restricted likelihood as a function of one parameter, the others at their best.
struct Profile<'a> {
    averages: &'a Averages<'a>,
    set: TermSet,
    tau_range: std::ops::Range<f64>,
}

impl Profile<'_> {
    /// The parameters in the order of the coordinates, whose logarithms those are.
    fn parameters(&self) -> Vec<Parameter> {
        let set = &self.set;
        let amplitudes = [
            (set.white, Parameter::White),
            (set.quantisation, Parameter::Quantisation),
            (set.random_walk, Parameter::RandomWalk),
            (set.flicker, Parameter::Flicker),
        ];
        let amplitudes = amplitudes.into_iter().filter(|(there, _)| *there);
        let mut list: Vec<Parameter> = amplitudes.map(|(_, parameter)| parameter).collect();
        list.extend((0..set.gauss_markov).map(Parameter::Sigma));
        list.extend((0..set.gauss_markov).map(Parameter::Tau));
        list
    }

    /// The search coordinates with σ in place of the drive σ√(2/τ).
    fn coordinates(&self, fit: &CompositeFit) -> Vec<f64> {
        let mut w = self.set.coordinates(&fit.terms);
        let tau = self.set.amplitudes();
        for i in 0..self.set.gauss_markov {
            w[tau - self.set.gauss_markov + i] = fit.terms.gauss_markov[i].sigma.ln();
        }
        if self.averages.overlap != 0.0 {
            w.push(self.averages.overlap * OVERLAP_COORDINATE);
        }
        w
    }

    /// Negative log-likelihood at coordinates with σ in place of the drive; infinite outside the range of τ.
    fn cost(&self, w: &[f64]) -> f64 {
        let (tau, count) = (self.set.amplitudes(), self.set.gauss_markov);
        let taus = &w[tau..tau + count];
        if taus.iter().any(|t| !self.tau_range.contains(t)) {
            return f64::INFINITY;
        }
        let mut z = w.to_vec();
        for i in 0..count {
            z[tau - count + i] += 0.5 * (2f64.ln() - w[tau + i]);
        }
        self.averages.cost_at(self.set, &z)
    }

    /// The end of one parameter's interval on one side, where the profile has fallen by `half`; none where
    /// it does not.
    ///
    /// False position on the root of the fall, from [`STEP`] outwards; at most 20 steps.
    fn end(&self, best: &Point, at: usize, sign: f64, half: f64) -> Option<f64> {
        let others = |w: &[f64]| -> Vec<f64> {
            w.iter()
                .enumerate()
                .filter(|(i, _)| *i != at)
                .map(|(_, v)| *v)
                .collect()
        };
        let mut from = others(&best.z);
        // √(2 fall) is about linear in the distance.
        let mut root_fall = |distance: f64| {
            let with = |free: &Vec<f64>| {
                let mut w = free.clone();
                w.insert(at, best.z[at] + sign * distance);
                self.cost(&w)
            };
            let cost = |w: &[Vec<f64>]| w.iter().map(with).collect();
            let start = Point::new(from.clone(), with(&from));
            let least = bfgs(&mut Objective::new(&cost, SCALES), &start, TOLERANCE, 40);
            if least.value.is_finite() {
                from = least.z;
            }
            (least.value - best.value).max(0.0).sqrt()
        };
        let wanted = half.sqrt();
        let (mut near, mut near_fall) = (0.0, 0.0);
        let (mut far, mut far_fall) = (STEP, root_fall(STEP));
        while far_fall < wanted {
            if far > OPEN {
                return None;
            }
            // As far as the slope says, and a little more; twice as far at most.
            let slope = (far_fall - near_fall) / (far - near);
            let step = (1.1 * (wanted - far_fall) / slope.max(1e-6)).min(far);
            (near, near_fall) = (far, far_fall);
            far += step;
            far_fall = root_fall(far);
        }
        for _ in 0..20 {
            if far - near < SHARE * far {
                break;
            }
            let linear = match far_fall.is_finite() {
                true => near + (far - near) * (wanted - near_fall) / (far_fall - near_fall),
                false => 0.5 * (near + far),
            };
            let margin = 0.1 * (far - near);
            let middle = linear.clamp(near + margin, far - margin);
            let fall = root_fall(middle);
            if fall < wanted {
                (near, near_fall) = (middle, fall);
            } else {
                (far, far_fall) = (middle, fall);
            }
        }
        Some(best.z[at] + sign * 0.5 * (near + far))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::composite::{CompositeTerms, FitOptions, GaussMarkov};

    /// Differences of 1 and 2 in turn: squares 1 and 4.
    #[test]
    fn the_kurtosis_is_that_of_the_differences_twice_less_three() {
        let steps: Vec<f64> = (0..40).map(|k| f64::from(k / 2 * 3 + k % 2)).collect();
        // Twenty of 1 and nineteen of 2.
        let (squares, fourths) = (20.0 + 19.0 * 4.0, 20.0 + 19.0 * 16.0);
        let exact = 2.0 * 39.0 * fourths / (squares * squares) - 3.0;
        assert!((kurtosis(&[&steps]) - exact).abs() < 1e-12);
        // Of a missing sample neither difference counts, and none from record to record.
        let mut gap = steps.clone();
        gap.insert(20, f64::NAN);
        let (squares, fourths) = (20.0 + 18.0 * 4.0, 20.0 + 18.0 * 16.0);
        let exact = 2.0 * 38.0 * fourths / (squares * squares) - 3.0;
        assert!((kurtosis(&[&gap]) - exact).abs() < 1e-12);
        assert!((kurtosis(&[&steps[..20], &steps[20..]]) - exact).abs() < 1e-12);
    }

    #[test]
    fn white_noise_is_as_certain_as_its_source_makes_it() {
        let record: Vec<f64> = (0..1200)
            .map(|k| f64::from(k * 7919 % 101).powi(3))
            .collect();
        let set = TermSet {
            white: true,
            ..TermSet::default()
        };
        let fit = crate::composite::fit(&record, 0.5, set, &FitOptions::default()).unwrap();
        let of = |fit: &CompositeFit| {
            let found = white(&[&record[..700], &record[700..]], fit, 0.95);
            assert_eq!(
                (found.parameter, found.estimate),
                (Parameter::White, fit.terms.white)
            );
            assert!((found.high / found.estimate - found.estimate / found.low).abs() < 1e-9);
            (found.high / found.estimate).ln() / 1.959_963_985
        };
        let kurtosis = kurtosis(&[&record[..700], &record[700..]]).max(3.0);
        // From the full rate: κ over twice the samples' root.
        let full = CompositeFit {
            white_full_rate: fit.terms.white,
            ..fit.clone()
        };
        assert!((of(&full) - 0.5 * (kurtosis / 1200.0).sqrt()).abs() < 1e-8);
        // From the curvature: √((κ − 1)/2) of it, κ − 3 a fourth of blocks of four.
        let blocks = CompositeFit {
            white_full_rate: 0.0,
            relative_errors: Some(CompositeTerms {
                white: 0.04,
                ..CompositeTerms::default()
            }),
            block: 4,
            ..fit.clone()
        };
        let averaged = 3.0 + (kurtosis - 3.0) / 4.0;
        assert!((of(&blocks) - 0.04 * (0.5 * (averaged - 1.0)).sqrt()).abs() < 1e-8);
        let unknown = CompositeFit {
            relative_errors: None,
            ..blocks
        };
        let found = white(&[&record], &unknown, 0.95);
        assert_eq!(
            (found.low, found.high, found.is_determined()),
            (0.0, f64::INFINITY, false)
        );
    }

    #[test]
    fn the_profile_s_coordinates_are_the_logarithms_of_the_parameters() {
        let terms = CompositeTerms {
            white: 0.5,
            random_walk: 0.1,
            gauss_markov: [
                GaussMarkov {
                    sigma: 1.0,
                    tau_s: 5.0,
                },
                GaussMarkov {
                    sigma: 2.0,
                    tau_s: 60.0,
                },
            ],
            ..CompositeTerms::default()
        };
        let record: Vec<f64> = (0..400).map(|k| f64::from(k * 7919 % 101) / 30.0).collect();
        let averages = Averages::new(&[&record], 1, 1.0).unwrap();
        let profile = Profile {
            averages: &averages,
            set: terms.set(),
            tau_range: 0.0..6.0,
        };
        use Parameter::{Flicker, Quantisation, RandomWalk, Sigma, Tau, White};
        let found = profile.parameters();
        assert_eq!(
            found,
            [White, RandomWalk, Sigma(0), Sigma(1), Tau(0), Tau(1)]
        );
        let all = TermSet {
            quantisation: true,
            flicker: true,
            ..terms.set()
        };
        let more = Profile {
            set: all,
            tau_range: 0.0..6.0,
            ..profile
        };
        let found = more.parameters();
        assert_eq!(found[..4], [White, Quantisation, RandomWalk, Flicker]);
        let set = TermSet {
            white: true,
            ..TermSet::default()
        };
        let fit = crate::composite::fit(&record, 1.0, set, &FitOptions::default()).unwrap();
        let w = profile.coordinates(&CompositeFit { terms, ..fit });
        let exact = [0.5, 0.1, 1.0, 2.0, 5.0, 60.0].map(f64::ln);
        for (w, exact) in w.iter().zip(exact) {
            assert!((w - exact).abs() < 1e-12);
        }
        assert!((profile.cost(&w) - averages.cost(&terms)).abs() < 1e-9);
        // Of another σ and τ, too; none of a τ outside of the range.
        let other = CompositeTerms {
            gauss_markov: [
                terms.gauss_markov[0],
                GaussMarkov {
                    sigma: 3.0,
                    tau_s: 40.0,
                },
            ],
            ..terms
        };
        let mut moved = w.clone();
        (moved[3], moved[5]) = (3f64.ln(), 40f64.ln());
        assert!((profile.cost(&moved) - averages.cost(&other)).abs() < 1e-9);
        moved[4] = 6.1;
        assert_eq!(profile.cost(&moved), f64::INFINITY);
        moved[4] = -0.1;
        assert_eq!(profile.cost(&moved), f64::INFINITY);
    }

    #[test]
    fn an_interval_is_determined_at_both_ends() {
        let interval = |low, high| ParameterInterval {
            parameter: Parameter::White,
            estimate: 1.0,
            low,
            high,
        };
        assert!(interval(0.5, 2.0).is_determined());
        assert!(
            !interval(0.0, 2.0).is_determined() && !interval(0.5, f64::INFINITY).is_determined()
        );
    }
}
