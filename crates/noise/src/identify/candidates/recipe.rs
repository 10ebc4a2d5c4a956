//! What is fitted, and the fits.
//!
//! A recipe is fitted to the whole, which gives the model, and to each part of it that a score leaves over,
//! from the optimum of the whole. A part may miss a term that the whole shows; a whole in which a term vanishes
//! is no candidate, since the smaller model is one.
//!
//! | recipe | data | method |
//! |---|---|---|
//! | `White`, `AllanWalk` | Allan deviation | [`crate::allan::fit_terms`] |
//! | `Terms` | block averages | restricted maximum likelihood |
//! | `Arma`, `UnitRoot` | samples | exact maximum likelihood |
//! | `Burg` | samples, bridged | Burg 1975, no search |
//! | `Compared` | Allan deviation, spectrum or autocorrelation | as published, [`crate::compared`] |
//!
//! To add one: a variant here with name, count of parameters and fit, and its place in
//! [`recipes`](super::recipes).

use super::{
    super::{HIGH_ORDER_SAMPLES, Origin},
    REFINE_EFFORT, average,
    folds::TrainingSet,
};
use crate::{
    BiasModel,
    allan::Terms,
    arma::{self, ArmaFit, FitOptions},
    compared::Method,
    composite::{self, CompositeTerms, Flag, TermSet},
    model_file::{Arma, AxisModel},
};
use undrift_nav::shaping::ShapingFilter;

/// What is fitted.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Recipe {
    /// White noise of the Allan deviation.
    White,
    /// White noise and random walk of the Allan deviation.
    AllanWalk,
    /// A sum of terms by maximum likelihood.
    Terms(TermSet),
    /// ARMA(p, q) by maximum likelihood.
    Arma(usize, usize),
    /// The same of an order that F tests or AIC have chosen, as the source paper does. Pairs of roots that cancel pass both by
    /// chance ([`crate::pandit_wu`]), so that it is not recommended: BIC's order is.
    ArmaByTest(usize, usize),
    /// ARMA(1,1) with a unit root.
    UnitRoot,
    /// AR(p) by Burg's method.
    Burg(usize),
    /// As others fit it.
    Compared(Method),
    /// The average of the sums of terms that the record does not tell apart; made of their fits, not fitted.
    Average,
}

/// A recipe fitted.
pub(super) struct Fitted {
    /// In the terms of a model file, without the turn-on constant.
    pub(super) model: AxisModel,
    /// Free parameters, the level included.
    pub(super) parameters: usize,
    /// How it was fitted, with the result of the fit.
    pub(super) origin: Origin,
}

impl Recipe {
    /// Name of the candidate in tables.
    pub(super) fn name(self) -> String {
        match self {
            Self::White => "white".to_owned(),
            Self::AllanWalk => "white + random walk (Allan)".to_owned(),
            Self::Terms(set) => name_of(set),
            Self::Arma(p, q) | Self::ArmaByTest(p, q) => format!("ARMA({p},{q})"),
            Self::UnitRoot => "ARMA(1,1), unit root".to_owned(),
            Self::Burg(p) => format!("AR({p}), Burg"),
            Self::Compared(method) => method.candidate().to_owned(),
            Self::Average => "average of likely models".to_owned(),
        }
    }

    /// Parameters beside the level.
    ///
    /// ARMA: p + q coefficients and σ².
    pub(super) fn parameters(self) -> usize {
        match self {
            Self::White => 1,
            Self::AllanWalk | Self::UnitRoot => 2,
            Self::Terms(set) => set.parameters(),
            Self::Arma(p, q) | Self::ArmaByTest(p, q) => p + q + 1,
            Self::Burg(p) => p + 1,
            Self::Compared(_) => Method::PARAMETERS,
            Self::Average => average::SET.parameters(),
        }
    }

    /// Whether it is scored for comparison alone.
    pub(super) fn is_compared(self) -> bool {
        matches!(
            self,
            Self::ArmaByTest(..) | Self::AllanWalk | Self::Compared(_)
        )
    }

    /// Fits a part of the record, from the optimum of the whole where that is known; `known`: coefficients
    /// near which that of an ARMA may lie.
    ///
    /// `part` is the whole (then `whole` is `None`) or a fold. `None` where the fit fails, or where
    /// the whole shows none of what distinguishes the recipe, since the smaller recipe is then the
    /// same model.
    pub(super) fn fit(
        self,
        part: &TrainingSet,
        whole: Option<&Fitted>,
        known: &[(Vec<f64>, Vec<f64>)],
    ) -> Option<Fitted> {
        let of_whole = whole.and_then(|whole| match &whole.origin {
            Origin::Arma(fit) => Some(fit),
            _ => None,
        });
        let (model, origin) = match self {
            Self::White => (white(&part.allan), Origin::Allan),
            Self::AllanWalk => {
                let walk = part.allan.random_walk.value;
                let model = AxisModel {
                    random_walk: (walk > 0.0).then_some(walk),
                    ..white(&part.allan)
                };
                // A half may show no walk; the whole has to.
                (walk > 0.0 || whole.is_some()).then_some((model, Origin::Allan))?
            }
            Self::Terms(set) => {
                let fit = terms(set, part, whole)?;
                (in_terms(&fit.terms), Origin::Composite(Box::new(fit)))
            }
            Self::Arma(p, q) | Self::ArmaByTest(p, q) => {
                let most = if p > 1 {
                    HIGH_ORDER_SAMPLES
                } else {
                    usize::MAX
                };
                let most = most / part.records.len();
                let first = |record: &&'_ [f64]| -> usize { record.len().min(most) };
                let records: Vec<_> = part.records.iter().map(|r| &r[..first(r)]).collect();
                let fit = match of_whole {
                    Some(whole) => arma::refit(&records, whole),
                    None => arma::fit_several(&records, p, q, &with_effort(REFINE_EFFORT), known),
                };
                arma_of(fit.ok()?, part.rate_hz)
            }
            Self::UnitRoot => {
                let options = FitOptions {
                    unit_root: true,
                    ..with_effort(REFINE_EFFORT)
                };
                let fit = match of_whole {
                    Some(whole) => arma::refit(&part.records, whole),
                    None => arma::fit_several(&part.records, 1, 1, &options, &[]),
                };
                arma_of(fit.ok()?, part.rate_hz)
            }
            Self::Burg(p) => (burg(p, part)?, Origin::Burg),
            Self::Compared(method) => {
                let model = match part.compared(method) {
                    Ok(terms) => in_terms(&terms),
                    // A half of which the method makes nothing is white noise; the whole has to have more.
                    Err(_) if whole.is_some() => white(&part.allan),
                    Err(_) => return None,
                };
                (model, Origin::Compared(method))
            }
            Self::Average => return None,
        };
        Some(self.fitted((model, origin)))
    }

    /// A fit with its parameters counted.
    pub(super) fn fitted(self, (model, origin): (AxisModel, Origin)) -> Fitted {
        Fitted {
            model,
            // The level is one.
            parameters: self.parameters() + 1,
            origin,
        }
    }
}

impl Fitted {
    /// The sum of terms that it is, if it is one without quantisation.
    pub(super) fn sum(&self) -> Option<CompositeTerms> {
        match &self.origin {
            Origin::Composite(fit) => Some(fit.terms).filter(|terms| terms.quantisation == 0.0),
            Origin::Allan => Some(CompositeTerms {
                white: self.model.white?,
                ..CompositeTerms::default()
            }),
            _ => None,
        }
    }

    /// The filter that is scored: exact, with the turn-on constant; `None` where the model has no filter at this rate.
    ///
    /// `turn_on` \[unit\] is 0 for likelihoods, whose level is estimated.
    pub(super) fn shaping(&self, turn_on: f64, rate_hz: f64) -> Option<ShapingFilter> {
        let model = AxisModel {
            turn_on,
            ..self.model.clone()
        };
        model.shaping(BiasModel::Arma, 1.0 / rate_hz).ok()
    }
}

/// "white + two Gauss-Markov + random walk".
pub(super) fn name_of(set: TermSet) -> String {
    let mut name = "white".to_owned();
    if set.quantisation {
        name += " + quantisation";
    }
    match set.gauss_markov {
        0 => {}
        1 => name += " + Gauss-Markov",
        _ => name += " + two Gauss-Markov",
    }
    if set.flicker {
        name += " + flicker";
    }
    if set.random_walk {
        name += " + random walk";
    }
    name
}

/// White noise of an Allan deviation alone.
pub(super) fn white(terms: &Terms) -> AxisModel {
    AxisModel {
        white: Some(terms.white.value.max(f64::MIN_POSITIVE)),
        ..AxisModel::default()
    }
}

/// A composite model in the terms of the model file.
pub(super) fn in_terms(terms: &CompositeTerms) -> AxisModel {
    let (instability, walk) = terms.slow();
    AxisModel {
        white: Some(terms.white),
        quantisation: (terms.quantisation > 0.0).then_some(terms.quantisation),
        instability,
        random_walk: (walk > 0.0).then_some(walk),
        ..AxisModel::default()
    }
}

/// A sum of terms by maximum likelihood. None too where the likelihood of the whole leaves a term out: the
/// model without it is a candidate itself. A half may leave one out.
pub(super) fn terms(
    set: TermSet,
    part: &TrainingSet,
    whole: Option<&Fitted>,
) -> Option<composite::CompositeFit> {
    let start = whole.and_then(|whole| match &whole.origin {
        Origin::Composite(fit) => Some(fit.terms),
        _ => None,
    });
    let options = composite::FitOptions {
        start,
        block: Some(part.blocks.samples),
        filtered: part.blocks.filtered,
        ..composite::FitOptions::default()
    };
    let curve = part.wavelet.as_ref()?;
    let (records, averages) = (&part.records, part.averages.as_ref());
    let fit =
        composite::fit_marginal(records, curve, averages, set, &options, part.marginal).ok()?;
    let is_smaller = fit.flags.iter().any(|f| matches!(f, Flag::Vanished(_)));
    (whole.is_some() || !is_smaller).then_some(fit)
}

/// A fitted ARMA as a model of the axis at a rate \[Hz\].
pub(super) fn arma_of(fit: ArmaFit, rate_hz: f64) -> (AxisModel, Origin) {
    let arma = Arma {
        ar: fit.ar.clone(),
        ma: fit.ma.clone(),
        sigma: fit.sigma,
        rate_hz,
    };
    let model = AxisModel {
        arma: Some(arma),
        ..AxisModel::default()
    };
    (model, Origin::Arma(Box::new(fit)))
}

/// AR(p) by Burg's method on the parts of the training set, laid end to end.
///
/// Products across the seam of two records are p of N and do not matter.
pub(super) fn burg(p: usize, part: &TrainingSet) -> Option<AxisModel> {
    let fit = arma::burg(&part.end_to_end, p).ok()?;
    let arma = Arma {
        ar: fit.ar,
        ma: Vec::new(),
        sigma: fit.variance.sqrt(),
        rate_hz: part.rate_hz,
    };
    Some(AxisModel {
        arma: Some(arma),
        ..AxisModel::default()
    })
}

/// Options of an ARMA fit with the mean estimated and this effort.
pub(super) fn with_effort(effort: f64) -> FitOptions {
    FitOptions {
        effort,
        ..FitOptions::default()
    }
}
