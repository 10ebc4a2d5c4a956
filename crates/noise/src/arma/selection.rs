//! Choice of the order over a grid, after Box and Jenkins.

use super::fit::{FitOptions, climb_to};
use super::model::ArmaFit;
use super::search::Ladder;
use super::{ArmaError, MAX_FIT_ORDER};

/// All fits of a grid of orders, and the orders that the criteria choose. BIC's is the one to use for long records: AIC adds pairs of
/// roots that cancel.
///
/// Differences of a criterion below 2 do not tell two orders apart (Burnham & Anderson 2002, section 2.6).
/// Criteria are comparable within one record only, with the same samples, mean and unit root.
#[derive(Clone, Debug, PartialEq)]
pub struct Selection {
    /// The fits, by p, then q; an order that the record is too short for is left out.
    pub fits: Vec<ArmaFit>,
    /// Index in `fits` of the least AIC.
    pub by_aic: usize,
    /// Index in `fits` of the least AICc.
    pub by_aicc: usize,
    /// Index in `fits` of the least BIC.
    pub by_bic: usize,
}

/// Fits every ARMA(p, q) with p ≤ `p_max`, q ≤ `q_max` (with a unit root, p from 1) and names the
/// orders of least AIC, AICc and BIC. Each fit starts from its neighbours of lower order too, so
/// the likelihood never falls with the order. Box, Jenkins & Reinsel section 6.2; Hurvich & Tsai 1989.
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::{arma::{FitOptions, select}, synthesis::NoiseGenerator};
/// let process = ShapingFilter::arma(&[0.9], &[], 1e-3, 0.01)?;
/// let record: Vec<f64> = NoiseGenerator::new(&process, 1).take(1000).collect();
/// let orders = select(&record, 1, 1, &FitOptions::default())?;
/// assert_eq!(orders.fits[orders.by_bic].order(), (1, 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`super::fit()`] where no order at all can be fitted.
pub fn select(
    samples: &[f64],
    p_max: usize,
    q_max: usize,
    options: &FitOptions,
) -> Result<Selection, ArmaError> {
    select_with_starts(samples, p_max, q_max, options, &[])
}

/// Does [`select`]; `made` are fits of the same record and mean, which are used where no neighbour is likelier.
pub(crate) fn select_with_starts(
    samples: &[f64],
    p_max: usize,
    q_max: usize,
    options: &FitOptions,
    made: &[ArmaFit],
) -> Result<Selection, ArmaError> {
    if p_max.max(q_max) > MAX_FIT_ORDER {
        return Err(ArmaError::OrderTooHigh);
    }
    let mut fits: Vec<ArmaFit> = Vec::new();
    let mut ladder = Ladder::default();
    let mut failure = ArmaError::NoUnitRootWithoutAr;
    for p in usize::from(options.unit_root)..=p_max {
        for q in 0..=q_max {
            let is_below = |fit: &&ArmaFit| {
                let (a, b) = fit.order();
                a <= p && b <= q && p + q <= a + b + 1
            };
            let below: Vec<&ArmaFit> = fits.iter().filter(is_below).collect();
            let likeliest = |fit: &&ArmaFit| {
                let least = |other: &&ArmaFit| other.log_likelihood <= fit.log_likelihood;
                fit.order() == (p, q) && below.iter().all(least)
            };
            if let Some(fit) = made.iter().find(likeliest) {
                fits.push(fit.clone());
                continue;
            }
            let start = |fit: &&ArmaFit| (fit.ar.clone(), fit.ma.clone());
            let known: Vec<_> = below.iter().map(start).collect();
            match climb_to(samples, p, q, options, &known, &mut ladder) {
                Ok(fit) => fits.push(fit),
                Err(error) => failure = error,
            }
        }
    }
    let least = |score: fn(&ArmaFit) -> f64| {
        (0..fits.len()).min_by(|&i, &j| score(&fits[i]).total_cmp(&score(&fits[j])))
    };
    match (
        least(|fit| fit.aic),
        least(|fit| fit.aicc),
        least(|fit| fit.bic),
    ) {
        (Some(by_aic), Some(by_aicc), Some(by_bic)) => Ok(Selection {
            fits,
            by_aic,
            by_aicc,
            by_bic,
        }),
        _ => Err(failure),
    }
}
