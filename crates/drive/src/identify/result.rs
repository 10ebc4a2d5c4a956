//! [`Identified`] as the stored result [`Identify`]: fields copied, sentences by `say`, nothing computed. SI units. Called by
//! the command, the Python package and the demo.

use super::Identified;
use undrift_noise::{
    allan::{Interval, Point, Terms},
    arma::Selection,
    composite::{Parameter, ParameterInterval},
    drift_score::HorizonScore,
    identify::{Axis, Candidate, GRID_ORDER, Origin as Found, RecordRemark},
    pandit_wu::{PAPER_CRITICAL, PanditWu},
    temperature::{Estimate, NORMAL_95},
};
use undrift_results::{
    self as results, Adf, Allan, ArmaOrigin, BoxJenkins, GridFit, Identify, Number, Numbers,
    OrderRow, OrderTest, Origin, PanditWuOrders, SCHEMA, Say, Statement, VERSION, by_name, numbers,
};

impl Identified {
    /// The result under its schema; `record` is the name of the record, `say` makes the sentences: `undrift_report::sentence`.
    pub fn result(&self, record: &str, say: Say<'_>) -> Identify {
        let axes = self
            .axes
            .iter()
            .zip(&self.series)
            .map(|((name, found), series)| {
                let axis = match found {
                    Ok(found) => {
                        let mut axis = axis(name, found, say);
                        let others = self.pool.iter().flat_map(|pool| pool.remarks(name));
                        axis.warnings.extend(others.map(|(record, remark)| {
                            format!("{record}: {}", say(Statement::Record(remark)))
                        }));
                        if let Some(turn_on) = self.pool.as_ref().and_then(|p| p.turn_on(name)) {
                            axis.chosen.turn_on = turn_on.with(0.0).into();
                        }
                        results::Axis {
                            series: series.result(found),
                            ..axis
                        }
                    }
                    Err(error) => results::Axis {
                        error: Some(error.to_string()),
                        ..results::Axis::default()
                    },
                };
                (*name, axis)
            });
        Identify {
            undrift: VERSION.into(),
            schema: SCHEMA,
            record: record.into(),
            rate_hz: self.rate_hz.into(),
            timing: self.timing.clone(),
            skipped_rows: self.skipped_rows,
            used: self.used.clone(),
            guessed_units: self.guessed_units.clone(),
            axes: by_name(axes),
            pool: self.pool.as_ref().map(super::Pool::result),
        }
    }
}

fn axis(name: &str, axis: &Axis, say: Say<'_>) -> results::Axis {
    let normal = &axis.normality;
    let ranking = axis.ranking().into_iter();
    let by_rule = axis.adf_chosen.iter();
    results::Axis {
        error: None,
        samples: axis.samples as u64,
        mean: axis.mean.into(),
        unit: unit(name).into(),
        detrend: axis.removed,
        temperature: axis.temperature.as_ref().map(temperature),
        outliers: axis.outliers.clone(),
        moving: axis.motion.as_ref().map(|m| m.moving),
        motion: axis.motion.clone(),
        saturation: axis.saturation.clone(),
        hanging: axis.hanging.clone(),
        noise_shown: axis.noise_shown.map(Number),
        adf: Adf {
            fixed: axis.adf,
            by_rule: by_name(by_rule.copied()),
        },
        kpss: axis.kpss,
        phillips_perron: axis.phillips_perron,
        stationarity: say(Statement::Stationarity(&axis.stationarity)),
        jarque_bera: normal.jarque_bera,
        ks: normal.ks,
        lilliefors: normal.lilliefors,
        skewness: normal.skewness.into(),
        kurtosis_excess: normal.kurtosis_excess.into(),
        quantisation_step: normal.quantisation.map(|q| q.step).into(),
        acf: values(&axis.acf),
        pacf: values(&axis.pacf),
        ljung_box: axis.whiteness,
        lines: axis.lines.clone(),
        allan: deviation(&axis.allan.points, &axis.allan_intervals, &axis.allan_terms),
        allan_terms: axis.allan_terms,
        pandit_wu: axis.pandit_wu.as_ref().map(order_rows).unwrap_or_default(),
        adequacy: axis.pandit_wu.as_ref().map(order_tests).unwrap_or_default(),
        pandit_wu_orders: axis.pandit_wu.as_ref().map(|table| PanditWuOrders {
            by_f: table.by_f.into(),
            by_aic: table.by_aic.into(),
            by_bic: table.by_bic.into(),
        }),
        box_jenkins: axis.box_jenkins.as_ref().map(box_jenkins),
        scales: axis.scales.clone(),
        candidates: (axis.candidates.iter())
            .map(|one| candidate(one, say))
            .collect(),
        not_fitted: (axis.not_fitted.iter())
            .map(|method| results::NotFitted {
                name: method.name.clone(),
                reason: say(Statement::NotFitted(&method.reason)),
            })
            .collect(),
        ranking: ranking.map(|i| axis.candidates[i].name.clone()).collect(),
        chosen: results::Candidate {
            reason: Some(say(Statement::Recommended(&axis.reason))),
            ..candidate(axis.recommended(), say)
        },
        intervals: intervals(axis),
        warnings: warnings(axis, say),
        series: results::AxisSeries::default(),
    }
}

fn temperature(found: &Estimate) -> results::AxisTemperature {
    let of = &found.effect;
    let interval = |value: f64, sigma: f64| {
        let reach = NORMAL_95 * sigma;
        [(value - reach).into(), (value + reach).into()]
    };
    let is_curved = of.quadratic_sigma > 0.0;
    results::AxisTemperature {
        determined: found.determined,
        reference_c: of.reference_c.into(),
        range_c: of.range_c.map(Number),
        slope: of.slope.into(),
        slope_interval: interval(of.slope, of.slope_sigma),
        quadratic: is_curved.then_some(of.quadratic).map(Number),
        quadratic_interval: is_curved.then(|| interval(of.quadratic, of.quadratic_sigma)),
        noise: found.noise.into(),
        explained: found.explained.into(),
    }
}

fn values(values: &[f64]) -> Vec<Number> {
    numbers(values.iter().copied())
}

/// Unit of an axis' samples.
pub(super) fn unit(name: &str) -> &'static str {
    match name.starts_with("accel") {
        true => "m/s^2",
        false => "rad/s",
    }
}

pub(super) fn deviation(points: &[Point], intervals: &[Interval], terms: &Terms) -> Allan {
    Allan {
        tau_s: numbers(points.iter().map(|p| p.tau_s)),
        adev: numbers(points.iter().map(|p| p.deviation)),
        lower: numbers(intervals.iter().map(|i| i.lower)),
        upper: numbers(intervals.iter().map(|i| i.upper)),
        fit: numbers(points.iter().map(|p| terms.variance(p.tau_s).sqrt())),
        fit_from_s: terms.from_s.into(),
    }
}

/// The table of orders as a result.
pub fn order_rows(table: &PanditWu) -> Vec<OrderRow> {
    let rows = table.rows.iter();
    rows.map(|row| OrderRow {
        order: row.order().into(),
        rss: row.fit.residual_sum_of_squares.into(),
        aic: row.fit.aic.into(),
        aic_per_sample: row.aic_per_sample().into(),
        bic: row.fit.bic.into(),
        ar: values(&row.fit.ar),
        ma: values(&row.fit.ma),
        f: row.test.map(|t| t.f).into(),
        f_critical: row.test.map(|t| t.critical).into(),
        f_paper: PAPER_CRITICAL.into(),
    })
    .collect()
}

/// The tests of its neighbours as a result.
pub fn order_tests(table: &PanditWu) -> Vec<OrderTest> {
    let tests = table.neighbours.iter();
    tests
        .map(|test| OrderTest {
            smaller: test.smaller.into(),
            larger: test.larger.into(),
            f: test.f.into(),
            f_critical: test.critical.into(),
            p_value: test.p_value.into(),
        })
        .collect()
}

fn box_jenkins(selection: &Selection) -> BoxJenkins {
    let fits = &selection.fits;
    let order = |index: usize| fits[index].order().into();
    let grid = fits.iter().map(|fit| GridFit {
        order: fit.order().into(),
        log_likelihood: fit.log_likelihood.into(),
        aic: fit.aic.into(),
        aicc: fit.aicc.into(),
        bic: fit.bic.into(),
    });
    BoxJenkins {
        samples: fits[selection.by_aicc].n as u64,
        p_max: GRID_ORDER as u64,
        q_max: GRID_ORDER as u64,
        by_aic: order(selection.by_aic),
        by_aicc: order(selection.by_aicc),
        by_bic: order(selection.by_bic),
        grid: grid.collect(),
    }
}

/// Of the record, and of the recommended model under its name.
fn warnings(axis: &Axis, say: Say<'_>) -> Vec<String> {
    let chosen = axis.recommended();
    let of_fit = remarks(chosen, say);
    let of_fit = of_fit.map(|remark| format!("{}: {remark}", chosen.name));
    let of_record = axis.remarks.iter();
    let of_record = of_record.map(|remark: &RecordRemark| say(Statement::Record(remark)));
    of_record.chain(of_fit).collect()
}

fn remarks<'a>(of: &'a Candidate, say: Say<'a>) -> impl Iterator<Item = String> + 'a {
    of.remarks.iter().map(|remark| say(Statement::Fit(remark)))
}

fn candidate(candidate: &Candidate, say: Say<'_>) -> results::Candidate {
    let by_horizon = |of: fn(&HorizonScore) -> f64| -> Numbers {
        let scores = candidate.score.iter();
        by_name(scores.map(|s| (s.horizon_s.round().to_string(), of(s))))
    };
    let model = &candidate.model;
    let arma = model.arma.as_ref();
    let (method, origin) = origin(&candidate.origin);
    let flicker = candidate.composite().map(|fit| fit.terms.flicker);
    let flicker = flicker.filter(|b| *b > 0.0);
    results::Candidate {
        name: candidate.name.clone(),
        compared: candidate.compared,
        states: candidate.states as u64,
        parameters: candidate.parameters as u64,
        block_aic: candidate.aic.into(),
        ljung_box_p: candidate.ljung_box_p.into(),
        drift_score: by_horizon(|s| s.rms),
        drift_score_error: by_horizon(|s| s.standard_error),
        drift_predicted: by_horizon(|s| s.predicted_rms),
        warnings: remarks(candidate, say).collect(),
        p: arma.map(|a| a.ar.len() as u64),
        q: arma.map(|a| a.ma.len() as u64),
        ar: arma.map(|a| values(&a.ar)),
        ma: arma.map(|a| values(&a.ma)),
        sigma: arma.map(|a| a.sigma).into(),
        white: model.white.into(),
        quantisation: model.quantisation.into(),
        random_walk: model.random_walk.into(),
        flicker: flicker.into(),
        gauss_markov: model.instability.clone(),
        turn_on: model.turn_on.into(),
        method: method.into(),
        origin,
        reason: None,
    }
}

fn intervals(axis: &Axis) -> Vec<results::ParameterInterval> {
    let fit = axis.recommended().composite();
    let several = fit.is_some_and(|fit| fit.terms.set().gauss_markov > 1);
    let numbered = |letter: &str, i: usize| match several {
        true => format!("{letter}{}", i + 1),
        false => letter.to_owned(),
    };
    let name = |parameter| match parameter {
        Parameter::White => "N".to_owned(),
        Parameter::Quantisation => "Q".to_owned(),
        Parameter::RandomWalk => "K".to_owned(),
        Parameter::Flicker => "B".to_owned(),
        Parameter::Sigma(i) => numbered("σ", i),
        Parameter::Tau(i) => numbered("τ", i),
    };
    let interval = |found: &ParameterInterval| results::ParameterInterval {
        parameter: name(found.parameter),
        estimate: found.estimate.into(),
        low: found.low.into(),
        high: found.high.into(),
    };
    axis.intervals.iter().map(interval).collect()
}

fn origin(found: &Found) -> (&'static str, Option<Origin>) {
    match found {
        Found::Allan => ("allan", None),
        Found::Burg => ("burg", None),
        Found::Average => ("average", None),
        Found::Compared(method) => (method.name(), None),
        Found::Arma(fit) => (
            "maximum likelihood",
            Some(Origin::Arma(ArmaOrigin {
                log_likelihood: fit.log_likelihood,
                aic: fit.aic,
                bic: fit.bic,
                standard_errors: fit.standard_errors.as_deref().map(values),
                near_cancelling: fit.near_cancelling,
                flat_likelihood: fit.flat_likelihood,
                unit_root: fit.unit_root,
            })),
        ),
        Found::Composite(fit) => ("maximum likelihood", Some(Origin::Composite(fit.clone()))),
    }
}
