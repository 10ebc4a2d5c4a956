//! The candidate models of an axis, fitted on the first half of its record, scored on the second.

use super::{Candidate, HIGH_ORDER_SAMPLES, Options, SEARCH_SAMPLES, bridge};
use crate::{
    BiasModel,
    allan::Terms,
    arma::{self, ArmaFit, FitOptions},
    composite::{self, CompositeTerms, TermSet},
    drift_score,
    model_file::{Arma, AxisModel, Instability},
    pandit_wu::{self, PanditWu, PanditWuOptions},
    whiteness,
};

/// Effort of the search over orders.
const SEARCH_EFFORT: f64 = 0.3;
/// Effort of fitting an order again to the whole half.
const REFINE_EFFORT: f64 = 0.2;
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
}

impl Half<'_> {
    fn fitted(&self) -> &[f64] {
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
    ) -> Option<Candidate> {
        model.turn_on = self.turn_on;
        let filter = model.shaping(BiasModel::Arma, 1.0 / self.rate_hz).ok()?;
        let score = drift_score::score(self.record, self.first, &filter, &self.horizons).ok()?;
        Some(Candidate {
            name,
            states: filter.order,
            model,
            parameters,
            fit: None,
            ljung_box_p: None,
            score,
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
        let mut candidate = self.candidate(name, model, fit.parameters)?;
        candidate.ljung_box_p = fit.residuals(self.searched()).ok().and_then(|residuals| {
            let present: Vec<f64> = residuals.into_iter().filter(|r| r.is_finite()).collect();
            let fitted = fit.ar.len() + fit.ma.len();
            whiteness::portmanteau(&present, &[20], fitted)
                .ok()
                .map(|t| t[0].ljung_box_p)
        });
        candidate.fit = Some(fit.clone());
        Some(candidate)
    }

    fn composite(&self, name: &str, set: TermSet) -> Option<Candidate> {
        let interval = 1.0 / self.rate_hz;
        let fit = composite::fit(
            self.fitted(),
            interval,
            set,
            &composite::FitOptions::default(),
        )
        .ok()?;
        self.candidate(name.into(), in_terms(&fit.terms), fit.parameters)
    }
}

/// A composite model in the terms of the model file.
fn in_terms(terms: &CompositeTerms) -> AxisModel {
    let process = terms.gauss_markov.iter().find(|g| g.sigma > 0.0);
    AxisModel {
        white: Some(terms.white),
        instability: process.map(|g| Instability {
            sigma: g.sigma,
            tau: g.tau_s,
        }),
        random_walk: (terms.random_walk > 0.0).then_some(terms.random_walk),
        ..AxisModel::default()
    }
}

/// All candidates, fitted on the first half and scored on the second.
pub(super) fn candidates(
    half: &Half,
    options: &Options,
    terms: &Terms,
) -> (Option<PanditWu>, Vec<Candidate>) {
    let mut list = Vec::new();
    let white = terms.white.value.max(f64::MIN_POSITIVE);
    list.extend(half.candidate(
        "white".into(),
        AxisModel {
            white: Some(white),
            ..AxisModel::default()
        },
        1,
    ));
    let allan_walk = AxisModel {
        white: Some(white),
        random_walk: (terms.random_walk.value > 0.0).then_some(terms.random_walk.value),
        ..AxisModel::default()
    };
    if allan_walk.random_walk.is_some() {
        list.extend(half.candidate("white + random walk (Allan)".into(), allan_walk, 2));
    }
    for (name, random_walk, gauss_markov) in [
        ("white + random walk", true, 0),
        ("white + Gauss-Markov", false, 1),
        ("white + Gauss-Markov + random walk", true, 1),
    ] {
        let set = TermSet {
            white: true,
            quantisation: false,
            random_walk,
            gauss_markov,
        };
        list.extend(half.composite(name, set));
    }

    let search = FitOptions {
        effort: SEARCH_EFFORT,
        ..FitOptions::default()
    };
    let pandit_wu = pandit_wu::pandit_wu(
        half.searched(),
        &PanditWuOptions {
            n_max: options.n_max,
            fit: search,
            ..PanditWuOptions::default()
        },
    )
    .ok();
    let mut orders = vec![(1, 1), (2, 1)];
    if let Some(table) = &pandit_wu {
        for order in [table.by_f, table.by_aic, table.by_bic] {
            if !orders.contains(&order) {
                orders.push(order);
            }
        }
    }
    // The search has found the place; the whole half only moves it a little.
    let refine = FitOptions {
        effort: REFINE_EFFORT,
        ..search
    };
    for (p, q) in orders {
        let known: Vec<_> = pandit_wu
            .iter()
            .filter_map(|table| table.fit((p, q)))
            .map(|fit| (fit.ar.clone(), fit.ma.clone()))
            .collect();
        let samples = if p > 1 {
            half.first.min(HIGH_ORDER_SAMPLES)
        } else {
            half.first
        };
        if let Ok(fit) = arma::fit_from(&half.fitted()[..samples], p, q, &refine, &known) {
            list.extend(half.arma(&fit, format!("ARMA({p},{q})")));
        }
    }
    let walk = FitOptions {
        unit_root: true,
        ..refine
    };
    if let Ok(fit) = arma::fit(half.fitted(), 1, 1, &walk) {
        list.extend(half.arma(&fit, "ARMA(1,1), unit root".into()));
    }
    list.extend(autoregression(half));
    (pandit_wu, list)
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
    half.candidate(format!("AR({p}), Burg"), model, p + 1)
}
