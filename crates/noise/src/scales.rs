//! Identification at several time scales.
//!
//! A record is averaged in blocks of m = 1, 5, 20, 100, 500 samples, each set of averages fitted by
//! ARMA(1,1), and the slow part lifted back exactly to the full rate: averages over m samples of an
//! AR(1) plus white noise are an ARMA(1,1) with φ_m = φ^m, so that with γ the autocovariance of the
//! averages, a = −ln φ and σ the AR(1)'s standard deviation
//!
//! ```text
//! γ₁ = σ² φ^m B    γ₀ = σ² C + r/m    C = (1/m²) ΣΣ φ^|i−j|    B = C + (2/m²) Σ (m−d) sinh(a d)
//! ```
//!
//! and for φ = 1 (docs/theory.md, section 1) a random walk of step variance `q = (1−θ)² σ_a²/m` beside white
//! noise `r = m (θ σ_a² + q (m²−1)/(6m))`. One-step likelihood at the full rate describes a sensor's
//! short memory; what drifts shows where blocks have averaged that away, and is the same from there
//! on. Hamilton 1994, section 4.7; Wei 2006, chapter 20 (temporal aggregation).

mod lift;

pub use lift::{Lifted, lift};

use crate::arma::{ArmaError, ArmaFit, FitOptions, fit};
use crate::composite::{CompositeError, average_in_blocks};
use serde::{Deserialize, Serialize};
use undrift_base::number::OrNull;
use undrift_base::parallel;
use undrift_nav::shaping::ShapingFilter;

/// Block lengths that are tried, in samples.
pub const BLOCKS: [usize; 5] = [1, 5, 20, 100, 500];

/// Fewest averages that are fitted.
const FEWEST: usize = 200;
/// Two scales agree where each lifted parameter differs by less than so many standard errors…
const ERRORS: f64 = 3.0;
/// … or by less than this share.
const SHARE: f64 = 0.02;
/// A slow part is seen where its standard errors are below this share (in logarithms).
const SEEN: f64 = 1.0;

/// Remark on a scale, to be read beside its numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flag {
    /// Fewer than 200 averages: not fitted.
    TooFewAverages,
    /// The fit failed.
    NoFit,
    /// φ ≤ 0 or φ ≤ θ: the best ARMA(1,1) describes a short memory and has no slow part.
    NoSlowPart,
    /// The averages are smoother than any slow part under white noise: white is put to 0.
    NoWhite,
    /// The correlation time exceeds a tenth of the record, or φ is 1: a random walk in effect.
    LongCorrelation,
    /// The correlation time is below two blocks: a coarser scale does not see it as slow.
    FastForBlock,
    /// The slow part is not distinguishable from none: φ − θ within two standard errors of 0.
    NotDistinguishable,
}

/// ARMA(1,1) of the record at one scale, and the slow part that it implies at the full rate.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ScaleFit {
    /// Number of samples averaged to a block.
    pub block: usize,
    /// Number of averages present.
    pub points: usize,
    /// φ of the averages' ARMA(1,1).
    #[serde(with = "OrNull")]
    pub phi: f64,
    /// θ of the averages' ARMA(1,1).
    #[serde(with = "OrNull")]
    pub theta: f64,
    /// Standard deviation of the innovations of the averages' ARMA(1,1) \[unit\].
    #[serde(with = "OrNull")]
    pub sigma: f64,
    /// The slow part and white noise at the full rate; absent where there is no slow part.
    pub lifted: Option<Lifted>,
    /// Standard errors of the logarithms of white, sigma, tau and drive; infinite where not known.
    pub relative_errors: Lifted,
    /// Shaping filter at the full rate; absent where there is no slow part.
    #[serde(skip)]
    pub filter: Option<ShapingFilter>,
    /// Whether the slow part is there and determined.
    pub seen: bool,
    /// Remarks to be read beside the numbers.
    #[serde(skip)]
    pub flags: Vec<Flag>,
}

impl ScaleFit {
    /// See [`ScaleFit::seen`].
    fn is_seen(&self) -> bool {
        self.lifted.is_some()
            && self.relative_errors.drive < SEEN
            && !self.flags.contains(&Flag::NotDistinguishable)
            && !self.flags.contains(&Flag::FastForBlock)
    }

    /// Whether two scales give the same white density, drive and (where both have one) correlation
    /// time, within three standard errors of the differences or 2 %. The errors are added as if
    /// independent, though the record is the same: agreement is granted rather too easily.
    ///
    /// ```
    /// use undrift_noise::scales::{Lifted, ScaleFit};
    /// let seen = |white: f64| ScaleFit {
    ///     lifted: Some(Lifted { white, sigma: 1.0, tau_s: 100.0, drive: 0.1 }),
    ///     relative_errors: Lifted { white: 0.01, sigma: 0.1, tau_s: 0.2, drive: 0.1 },
    ///     ..ScaleFit::default()
    /// };
    /// assert!(seen(1.0).agrees_with(&seen(1.04))); // Within 3 · 0.014, three errors of the difference.
    /// assert!(!seen(1.0).agrees_with(&seen(1.06)));
    /// assert!(!seen(1.0).agrees_with(&ScaleFit::default()), "which has no slow part");
    /// ```
    pub fn agrees_with(&self, other: &Self) -> bool {
        let (Some(a), Some(b)) = (self.lifted, other.lifted) else {
            return false;
        };
        let (ea, eb) = (self.relative_errors, other.relative_errors);
        let near = |a: f64, b: f64, ea: f64, eb: f64| {
            let gap = (a / b).ln().abs();
            gap <= SHARE || gap <= ERRORS * ea.hypot(eb)
        };
        let white =
            (a.white == 0.0 && b.white == 0.0) || near(a.white, b.white, ea.white, eb.white);
        let tau = a.tau_s.is_infinite()
            || b.tau_s.is_infinite()
            || near(a.tau_s, b.tau_s, ea.tau_s, eb.tau_s);
        white && tau && near(a.drive, b.drive, ea.drive, eb.drive)
    }
}

/// A record at several scales, and the scale that shows what drifts.
///
/// Read `chosen` first: where it is `None`, no scale sees a slow part, and the record bounds the bias from
/// above only. Where it is not the finest block, the samples have a short memory of their own, as of a low-pass
/// filter, that an ARMA at the full rate would have fitted.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Scales {
    /// The scales, by growing block length.
    #[serde(rename = "fits")]
    pub scales: Vec<ScaleFit>,
    /// The finest scale that sees a slow part and agrees with every coarser one that sees one; where
    /// none does, the coarsest that sees one.
    #[serde(skip)]
    pub chosen: Option<usize>,
    /// Block length of the chosen scale \[samples\].
    pub chosen_block: Option<usize>,
    /// The number of scales that agree with the chosen one, itself included.
    pub agreeing: usize,
}

/// Fits a record sampled every `interval` \[s\] at block lengths `blocks` (as [`BLOCKS`]); `effort` is
/// that of each ARMA search ([`FitOptions`]; 0.1 is enough). NaN is a missing sample.
///
/// # Errors
/// A record too short for the shortest block, or infinite; a bad interval.
///
/// ```
/// use undrift_noise::{composite::CompositeTerms, scales::identify, synthesis::NoiseGenerator};
/// let truth = CompositeTerms { white: 0.01, random_walk: 0.005, ..CompositeTerms::default() };
/// let record: Vec<f64> = NoiseGenerator::new(&truth.to_shaping(0.01)?, 1).take(50_000).collect();
/// let found = identify(&record, 0.01, &[5, 20, 100], 0.1)?;
/// let chosen = &found.scales[found.chosen.expect("a slow part")];
/// let lifted = chosen.lifted.expect("seen");
/// assert!((lifted.white / 0.01).ln().abs() < 0.1 && (lifted.drive / 0.005).ln().abs() < 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn identify(
    record: &[f64],
    interval: f64,
    blocks: &[usize],
    effort: f64,
) -> Result<Scales, CompositeError> {
    ShapingFilter::none(interval)?;
    let shortest = blocks.iter().copied().min().unwrap_or(1);
    if record.len() < FEWEST * shortest {
        return Err(CompositeError::TooShort {
            present: record.len(),
            needed: FEWEST * shortest,
        });
    }
    if record.iter().any(|v| v.is_infinite()) {
        return Err(CompositeError::NotFinite);
    }
    let of_block = |k: usize| scale(record, interval, blocks[k], effort);
    let mut scales: Vec<ScaleFit> = parallel::map(blocks.len(), of_block);
    scales.sort_by_key(|s| s.block);
    let seen: Vec<usize> = (0..scales.len()).filter(|&i| scales[i].seen).collect();
    let agreeable = |&i: &usize| {
        let mut coarser = seen.iter().filter(|&&j| j > i);
        coarser.all(|&j| scales[i].agrees_with(&scales[j]))
    };
    // The coarsest agrees with all coarser ones, there being none.
    let chosen = seen.iter().copied().find(agreeable);
    let agreeing = chosen.map_or(0, |i| {
        let same = |&&j: &&usize| i == j || scales[i].agrees_with(&scales[j]);
        seen.iter().filter(same).count()
    });
    Ok(Scales {
        chosen_block: chosen.map(|i| scales[i].block),
        scales,
        chosen,
        agreeing,
    })
}

/// The record in blocks of one length: its ARMA(1,1), lifted, with flags.
fn scale(record: &[f64], interval: f64, block: usize, effort: f64) -> ScaleFit {
    let mut scale = ScaleFit {
        block,
        phi: f64::NAN,
        theta: f64::NAN,
        sigma: f64::NAN,
        relative_errors: Lifted::unknown(),
        ..ScaleFit::default()
    };
    let averages = average_in_blocks(record, block).unwrap_or_default();
    scale.points = averages.iter().filter(|v| !v.is_nan()).count();
    if scale.points < FEWEST {
        scale.flags.push(Flag::TooFewAverages);
        return scale;
    }
    let options = FitOptions {
        effort,
        ..FitOptions::default()
    };
    let fitted: Result<ArmaFit, ArmaError> = fit(&averages, 1, 1, &options);
    let Ok(model) = fitted else {
        scale.flags.push(Flag::NoFit);
        return scale;
    };
    scale.phi = model.ar[0];
    scale.theta = model.ma[0];
    scale.sigma = model.sigma;
    let Some(lifted) = lift(scale.phi, scale.theta, scale.sigma, block, interval) else {
        scale.flags.push(Flag::NoSlowPart);
        return scale;
    };
    scale.relative_errors = lift::relative_errors(&model, block, interval);
    if lifted.white == 0.0 {
        scale.flags.push(Flag::NoWhite);
    }
    let length_s = record.len() as f64 * interval;
    if lifted.tau_s > 0.1 * length_s {
        scale.flags.push(Flag::LongCorrelation);
    }
    if lifted.tau_s < 2.0 * block as f64 * interval {
        scale.flags.push(Flag::FastForBlock);
    }
    if model.near_cancelling {
        scale.flags.push(Flag::NotDistinguishable);
    }
    scale.filter = lifted.terms().to_shaping(interval).ok();
    scale.lifted = Some(lifted);
    scale.seen = scale.is_seen();
    scale
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(white: f64, tau_s: f64, drive: f64, error: f64) -> ScaleFit {
        ScaleFit {
            lifted: Some(Lifted {
                white,
                sigma: 1.0,
                tau_s,
                drive,
            }),
            relative_errors: Lifted {
                white: error,
                sigma: error,
                tau_s: error,
                drive: error,
            },
            ..ScaleFit::default()
        }
    }

    #[test]
    fn scales_agree_within_two_percent_or_three_standard_errors_of_each_parameter() {
        let one = at(1.0, 10.0, 0.1, 0.0);
        for (by, agrees) in [
            (0.019f64, true),
            (0.021, false),
            (-0.019, true),
            (-0.021, false),
        ] {
            let by = by.exp();
            for other in [
                at(by, 10.0, 0.1, 0.0),
                at(1.0, 10.0 * by, 0.1, 0.0),
                at(1.0, 10.0, 0.1 * by, 0.0),
            ] {
                assert_eq!(one.agrees_with(&other), agrees, "{other:?}");
                assert_eq!(other.agrees_with(&one), agrees, "{other:?}");
            }
        }
        // Errors of 3 and 4 % make 5 % of the difference.
        let wide = at(1.0, 10.0, 0.1, 0.03);
        for (by, agrees) in [(0.149f64, true), (0.151, false)] {
            let by = by.exp();
            for other in [
                at(by, 10.0, 0.1, 0.04),
                at(1.0, 10.0 * by, 0.1, 0.04),
                at(1.0, 10.0, 0.1 * by, 0.04),
            ] {
                assert_eq!(wide.agrees_with(&other), agrees, "{other:?}");
            }
        }
    }

    #[test]
    fn without_a_correlation_time_or_white_noise_the_others_decide() {
        let walk = at(1.0, f64::INFINITY, 0.1, 0.0);
        assert!(
            walk.agrees_with(&at(1.0, 5.0, 0.1, 0.0)) && at(1.0, 5.0, 0.1, 0.0).agrees_with(&walk)
        );
        assert!(!walk.agrees_with(&at(1.0, 5.0, 0.2, 0.0)));
        let smooth = at(0.0, 10.0, 0.1, 0.0);
        assert!(smooth.agrees_with(&at(0.0, 10.0, 0.1, 0.0)));
        assert!(
            !smooth.agrees_with(&at(1.0, 10.0, 0.1, 0.0))
                && !at(1.0, 10.0, 0.1, 0.0).agrees_with(&smooth)
        );
        let nothing = ScaleFit::default();
        assert!(!nothing.agrees_with(&smooth) && !smooth.agrees_with(&nothing));
    }

    #[test]
    fn a_slow_part_is_seen_where_its_drive_is_determined_and_nothing_speaks_against_it() {
        assert!(at(1.0, 10.0, 0.1, 0.99).is_seen());
        assert!(!at(1.0, 10.0, 0.1, 1.0).is_seen());
        assert!(!ScaleFit::default().is_seen());
        for (flag, seen) in [
            (Flag::NotDistinguishable, false),
            (Flag::FastForBlock, false),
            (Flag::LongCorrelation, true),
            (Flag::NoWhite, true),
        ] {
            let scale = ScaleFit {
                flags: vec![flag],
                ..at(1.0, 10.0, 0.1, 0.1)
            };
            assert_eq!(scale.is_seen(), seen, "{flag:?}");
        }
    }

    #[test]
    fn a_record_is_refused_below_two_hundred_of_the_shortest_blocks() {
        let record: Vec<f64> = (0..1999).map(|k| f64::from(k * k % 17)).collect();
        let error = identify(&record, 0.1, &[20, 10], 0.1).unwrap_err();
        assert_eq!(
            error,
            CompositeError::TooShort {
                present: 1999,
                needed: 2000
            }
        );
        let mut infinite = record.clone();
        infinite[3] = f64::INFINITY;
        assert_eq!(
            identify(&infinite, 0.1, &[1], 0.1).unwrap_err(),
            CompositeError::NotFinite
        );
        // 199 averages are not fitted.
        let few = scale(&record, 0.1, 10, 0.1);
        assert_eq!(
            (few.block, few.points, &few.flags[..]),
            (10, 199, &[Flag::TooFewAverages][..])
        );
        assert!(!few.seen && few.phi.is_nan() && few.lifted.is_none());
    }
}
