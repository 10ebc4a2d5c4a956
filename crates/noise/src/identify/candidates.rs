//! The candidate models of an axis, fitted on the first half of its record, scored on the second.

use super::screened::bridge;
use super::{Candidate, GRID_ORDER, HIGH_ORDER_SAMPLES, Origin, SEARCH_SAMPLES, remarks};
use crate::{
    BiasModel,
    allan::Terms,
    arma::{self, ArmaFit, FitOptions, Selection},
    composite::{self, CompositeTerms, Flag, TermSet},
    drift_score,
    model_file::{Arma, AxisModel},
    pandit_wu::{self, PanditWu, PanditWuOptions},
    scales::{self, ScaleFit, Scales},
    whiteness,
};

/// Effort of the search over orders.
const SEARCH_EFFORT: f64 = 0.3;
/// Effort of fitting an order again to the whole half.
const REFINE_EFFORT: f64 = 0.2;
/// Effort of each fit of the grid of orders: each starts from its neighbours' optima besides.
const GRID_EFFORT: f64 = 0.03;
/// Effort of each fit of block averages.
const SCALE_EFFORT: f64 = 0.1;
/// Highest order of the autoregressive candidate: with the turn-on constant it fills an axis.
const MOST_AR: usize = 5;

/// The record split for fitting and scoring.
pub(super) struct Half<'a> {
    /// Screened record about its mean, NaN where a sample was left out.
    pub(super) record: &'a [f64],
    /// Samples of the first half, which is fitted.
    pub(super) first: usize,
    pub(super) rate_hz: f64,
    /// Standard deviation of the turn-on constant [unit].
    pub(super) turn_on: f64,
    pub(super) horizons: Vec<f64>,
    /// Quantisation is large enough to be a term.
    pub(super) quantised: bool,
}

/// All that was tried.
pub(super) struct Tried {
    pub(super) pandit_wu: Option<PanditWu>,
    pub(super) box_jenkins: Option<Selection>,
    pub(super) scales: Option<Scales>,
    pub(super) candidates: Vec<Candidate>,
}

impl Half<'_> {
    pub(super) fn fitted(&self) -> &[f64] {
        &self.record[..self.first]
    }

    /// The part of the first half that a search over orders sees.
    fn searched(&self) -> &[f64] {
        &self.record[..self.first.min(SEARCH_SAMPLES)]
    }

    /// A candidate with its score on the second half; `None` where the model makes no filter.
    fn candidate(
        &self,
        name: String,
        mut model: AxisModel,
        parameters: usize,
        origin: Origin,
    ) -> Option<Candidate> {
        model.turn_on = self.turn_on;
        let filter = model.shaping(BiasModel::Arma, 1.0 / self.rate_hz).ok()?;
        let score = drift_score::score(self.record, self.first, &filter, &self.horizons).ok()?;
        let warnings = match &origin {
            Origin::Allan | Origin::Burg => Vec::new(),
            Origin::Arma(fit) => remarks::of_arma(fit),
            Origin::Composite(fit) => remarks::of_composite(fit),
            Origin::Scale(fit) => remarks::of_scale(fit),
        };
        Some(Candidate {
            name,
            states: filter.order,
            model,
            parameters,
            origin,
            ljung_box_p: None,
            score,
            warnings,
        })
    }

    fn arma(&self, fit: &ArmaFit, name: String) -> Option<Candidate> {
        let arma = Arma {
            ar: fit.ar.clone(),
            ma: fit.ma.clone(),
            sigma: fit.sigma,
            rate_hz: self.rate_hz,
        };
        let model = AxisModel {
            arma: Some(arma),
            ..AxisModel::default()
        };
        let origin = Origin::Arma(Box::new(fit.clone()));
        let mut candidate = self.candidate(name, model, fit.parameters, origin)?;
        candidate.ljung_box_p = fit.residuals(self.searched()).ok().and_then(|residuals| {
            let present: Vec<f64> = residuals.into_iter().filter(|r| r.is_finite()).collect();
            let fitted = fit.ar.len() + fit.ma.len();
            whiteness::portmanteau(&present, &[20], fitted)
                .ok()
                .map(|t| t[0].ljung_box_p)
        });
        Some(candidate)
    }

    /// None too where the likelihood leaves a term out: the model without it is a candidate itself.
    fn composite(&self, set: TermSet) -> Option<Candidate> {
        let interval = 1.0 / self.rate_hz;
        let fit = composite::fit(
            self.fitted(),
            interval,
            set,
            &composite::FitOptions::default(),
        )
        .ok()?;
        if fit.flags.iter().any(|f| matches!(f, Flag::Vanished(_))) {
            return None;
        }
        let (model, parameters) = (in_terms(&fit.terms), fit.parameters);
        self.candidate(
            name_of(set),
            model,
            parameters,
            Origin::Composite(Box::new(fit)),
        )
    }

    /// The model of a block scale at the full rate; none where it has no slow part.
    fn scale(&self, fit: &ScaleFit) -> Option<Candidate> {
        let model = in_terms(&fit.lifted?.terms());
        let name = format!("ARMA(1,1) of means of {}", fit.block);
        // φ, θ, σ and the mean.
        self.candidate(name, model, 4, Origin::Scale(Box::new(fit.clone())))
    }
}

/// "white + two Gauss-Markov + random walk".
fn name_of(set: TermSet) -> String {
    let mut name = "white".to_owned();
    if set.quantisation {
        name += " + quantisation";
    }
    match set.gauss_markov {
        0 => {}
        1 => name += " + Gauss-Markov",
        _ => name += " + two Gauss-Markov",
    }
    if set.random_walk {
        name += " + random walk";
    }
    name
}

/// A composite model in the terms of the model file.
fn in_terms(terms: &CompositeTerms) -> AxisModel {
    let processes = terms.gauss_markov.iter().filter(|g| g.sigma > 0.0);
    AxisModel {
        white: Some(terms.white),
        quantisation: (terms.quantisation > 0.0).then_some(terms.quantisation),
        instability: processes.copied().collect(),
        random_walk: (terms.random_walk > 0.0).then_some(terms.random_walk),
        ..AxisModel::default()
    }
}

/// All candidates, fitted on the first half and scored on the second.
pub(super) fn candidates(half: &Half, n_max: usize, terms: &Terms) -> Tried {
    let mut candidates = allan(half, terms);
    candidates.extend(composites(half));
    let search = PanditWuOptions {
        n_max,
        fit: with_effort(SEARCH_EFFORT),
        ..PanditWuOptions::default()
    };
    let pandit_wu = pandit_wu::pandit_wu(half.searched(), &search).ok();
    candidates.extend(armas(half, pandit_wu.as_ref()));
    candidates.extend(autoregression(half));
    // The averages of one sample are the ARMA(1,1) above.
    let blocks = &scales::BLOCKS[1..];
    let scales = scales::identify(half.fitted(), 1.0 / half.rate_hz, blocks, SCALE_EFFORT).ok();
    let fits = scales.iter().flat_map(|s| &s.scales);
    candidates.extend(fits.filter_map(|fit| half.scale(fit)));
    let grid = with_effort(GRID_EFFORT);
    Tried {
        box_jenkins: arma::select(half.searched(), GRID_ORDER, GRID_ORDER, &grid).ok(),
        pandit_wu,
        scales,
        candidates,
    }
}

fn with_effort(effort: f64) -> FitOptions {
    FitOptions {
        effort,
        ..FitOptions::default()
    }
}

/// The white noise of the Allan deviation, and its random walk beside it.
fn allan(half: &Half, terms: &Terms) -> Vec<Candidate> {
    let white = AxisModel {
        white: Some(terms.white.value.max(f64::MIN_POSITIVE)),
        ..AxisModel::default()
    };
    let walk = terms.random_walk.value;
    let walk = (walk > 0.0).then(|| AxisModel {
        random_walk: Some(walk),
        ..white.clone()
    });
    let walk = walk.and_then(|model| {
        half.candidate(
            "white + random walk (Allan)".into(),
            model,
            2,
            Origin::Allan,
        )
    });
    let white = half.candidate("white".into(), white, 1, Origin::Allan);
    white.into_iter().chain(walk).collect()
}

/// Sums of terms.
fn composites(half: &Half) -> Vec<Candidate> {
    let plain = [(0, true), (1, false), (1, true), (2, false), (2, true)];
    let rounded = [(0, true), (1, false)];
    let rounded = rounded.iter().filter(|_| half.quantised);
    let sets = plain.iter().map(|of| (false, of));
    let sets = sets.chain(rounded.map(|of| (true, of)));
    let fit = |(quantisation, &(gauss_markov, random_walk))| {
        half.composite(TermSet {
            white: true,
            quantisation,
            random_walk,
            gauss_markov,
        })
    };
    sets.filter_map(fit).collect()
}

/// ARMA models of the orders that the table chooses and of two that are always tried, and one with a unit root.
fn armas(half: &Half, table: Option<&PanditWu>) -> Vec<Candidate> {
    let mut orders = vec![(1, 1), (2, 1)];
    for order in table.iter().flat_map(|t| [t.by_f, t.by_aic, t.by_bic]) {
        if !orders.contains(&order) {
            orders.push(order);
        }
    }
    // The search has found the place; the whole half only moves it a little.
    let refine = with_effort(REFINE_EFFORT);
    let fit = |(p, q)| {
        let known = table.and_then(|table| table.fit((p, q)));
        let known: Vec<_> = known
            .iter()
            .map(|fit| (fit.ar.clone(), fit.ma.clone()))
            .collect();
        let samples = if p > 1 {
            half.first.min(HIGH_ORDER_SAMPLES)
        } else {
            half.first
        };
        let fit = arma::fit_from(&half.fitted()[..samples], p, q, &refine, &known).ok()?;
        half.arma(&fit, format!("ARMA({p},{q})"))
    };
    let mut list: Vec<Candidate> = orders.into_iter().filter_map(fit).collect();
    let walk = FitOptions {
        unit_root: true,
        ..refine
    };
    if let Ok(fit) = arma::fit(half.fitted(), 1, 1, &walk) {
        list.extend(half.arma(&fit, "ARMA(1,1), unit root".into()));
    }
    list
}

/// AR(p) by Burg's method, p by AICc.
fn autoregression(half: &Half) -> Option<Candidate> {
    let bridged = bridge(half.fitted());
    let searched = &bridged[..half.searched().len()];
    let p = arma::order_by_aicc(searched, MOST_AR).ok()?.max(1);
    let fit = arma::burg(&bridged, p).ok()?;
    let arma = Arma {
        ar: fit.ar,
        ma: Vec::new(),
        sigma: fit.variance.sqrt(),
        rate_hz: half.rate_hz,
    };
    let model = AxisModel {
        arma: Some(arma),
        ..AxisModel::default()
    };
    half.candidate(format!("AR({p}), Burg"), model, p + 1, Origin::Burg)
}
