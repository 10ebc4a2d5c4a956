//! Everything found, as JSON. SI units; a number that is not finite is null.

use super::Identified;
use crate::results::{Kind, with_head};
use serde_json::{Map, Value, json};
use undrift_noise::{
    AxisModel, Instability,
    allan::Term,
    arma::Selection,
    composite::CompositeTerms,
    identify::{Axis, Candidate, GRID_ORDER, Origin, Removed},
    model_file::Arma,
    normality::JARQUE_BERA_CRITICAL_5,
    pandit_wu::PAPER_CRITICAL,
    scales::Scales,
    screening::Timing,
    stationarity::{Adf, Critical},
};

impl Identified {
    /// Everything as JSON; `record` is what the record is called.
    pub fn json(&self, record: &str) -> Value {
        let axes: Map<String, Value> = self
            .axes
            .iter()
            .zip(&self.series)
            .map(|((name, found), series)| {
                let value = match found {
                    Ok(axis) => {
                        let mut value = axis_json(name, axis);
                        value["series"] = series.json(axis);
                        value
                    }
                    Err(error) => json!({"error": error.to_string()}),
                };
                ((*name).to_owned(), value)
            })
            .collect();
        with_head(
            Kind::Identify,
            json!({
                "record": record,
                "rate_hz": self.rate_hz,
                "timing": self.timing.as_ref().map(timing),
                "skipped_rows": self.skipped_rows,
                "axes": axes,
            }),
        )
    }
}

fn timing(timing: &Timing) -> Value {
    let gaps: Vec<Value> = timing
        .gaps
        .iter()
        .map(|g| json!({"index": g.index, "start_s": g.start_s, "length_s": g.length_s, "missing": g.missing}))
        .collect();
    json!({
        "rate_hz": timing.rate_hz,
        "interval_s": timing.interval_s,
        "jitter_rms_s": timing.jitter_rms_s,
        "jitter_max_s": timing.jitter_max_s,
        "gaps": gaps,
        "not_increasing": timing.not_increasing,
        "even": timing.even,
    })
}

fn critical(c: &Critical) -> Value {
    json!({"1%": c.one, "5%": c.five, "10%": c.ten})
}

fn adf(test: &Adf) -> Value {
    json!({
        "statistic": test.statistic,
        "p_value": test.p_value,
        "lags": test.lags,
        "critical": critical(&test.critical),
        "criterion": test.criterion,
    })
}

/// The test at fixed lags, with its variants by the rule that chooses the lags.
fn adf_json(axis: &Axis) -> Value {
    let mut value = adf(&axis.adf);
    let chosen: Map<String, Value> = axis
        .adf_chosen
        .iter()
        .map(|(rule, test)| ((*rule).to_owned(), adf(test)))
        .collect();
    value["by_rule"] = chosen.into();
    value
}

fn removed(removed: &Removed) -> Value {
    match removed {
        Removed::Constant => json!({"kind": "constant"}),
        Removed::Linear {
            slope_per_hour,
            explained,
        } => {
            json!({"kind": "linear", "slope_per_hour": slope_per_hour, "explained": explained})
        }
        Removed::Temperature {
            slope_per_kelvin,
            explained,
        } => {
            json!({"kind": "temperature", "slope_per_kelvin": slope_per_kelvin, "explained": explained})
        }
    }
}

fn allan(axis: &Axis) -> Value {
    let points = &axis.allan.points;
    let of = |value: fn(&undrift_noise::allan::Point) -> f64| -> Vec<f64> {
        points.iter().map(value).collect()
    };
    let lower: Vec<f64> = axis.allan_intervals.iter().map(|i| i.lower).collect();
    let upper: Vec<f64> = axis.allan_intervals.iter().map(|i| i.upper).collect();
    let terms = &axis.allan_terms;
    let fit: Vec<f64> = points
        .iter()
        .map(|p| terms.variance(p.tau_s).sqrt())
        .collect();
    json!({"tau_s": of(|p| p.tau_s), "adev": of(|p| p.deviation), "lower": lower, "upper": upper, "fit": fit, "fit_from_s": terms.from_s})
}

fn allan_terms(axis: &Axis) -> Value {
    let terms = &axis.allan_terms;
    let term = |t: &Term| json!({"value": t.value, "standard_error": t.standard_error, "upper_95": t.upper_95, "seen": t.seen});
    json!({
        "quantisation": term(&terms.quantisation),
        "white": term(&terms.white),
        "bias_instability": term(&terms.bias_instability),
        "random_walk": term(&terms.random_walk),
        "ramp": term(&terms.ramp),
        "white_variance": terms.white_variance,
    })
}

fn pandit_wu(axis: &Axis) -> Vec<Value> {
    let rows = axis.pandit_wu.iter().flat_map(|t| &t.rows);
    rows.map(|row| {
        let (p, q) = row.order();
        json!({
            "p": p, "q": q, "rss": row.fit.residual_sum_of_squares, "aic": row.fit.aic, "bic": row.fit.bic,
            "ar": row.fit.ar, "ma": row.fit.ma,
            "f": row.test.map(|t| t.f), "f_critical": row.test.map(|t| t.critical),
            "f_paper": PAPER_CRITICAL,
        })
    })
    .collect()
}

fn box_jenkins(selection: &Selection) -> Value {
    let order = |index: usize| {
        let (p, q) = selection.fits[index].order();
        json!({"p": p, "q": q})
    };
    let grid: Vec<Value> = selection
        .fits
        .iter()
        .map(|fit| {
            let (p, q) = fit.order();
            json!({"p": p, "q": q, "log_likelihood": fit.log_likelihood, "aic": fit.aic, "aicc": fit.aicc, "bic": fit.bic})
        })
        .collect();
    json!({
        "samples": selection.fits[selection.by_aicc].n,
        "p_max": GRID_ORDER,
        "q_max": GRID_ORDER,
        "by_aic": order(selection.by_aic),
        "by_aicc": order(selection.by_aicc),
        "by_bic": order(selection.by_bic),
        "grid": grid,
    })
}

fn scales(scales: &Scales) -> Value {
    let fits: Vec<Value> = scales
        .scales
        .iter()
        .map(|s| {
            let lifted = s.lifted.map(
                |l| json!({"white": l.white, "sigma": l.sigma, "tau_s": l.tau_s, "drive": l.drive}),
            );
            let e = s.relative_errors;
            json!({
                "block": s.block, "points": s.points,
                "phi": s.phi, "theta": s.theta, "sigma": s.sigma,
                "lifted": lifted,
                "relative_errors": {"white": e.white, "sigma": e.sigma, "tau_s": e.tau_s, "drive": e.drive},
                "seen": s.is_seen(),
            })
        })
        .collect();
    let chosen = scales.chosen.and_then(|i| scales.scales.get(i));
    json!({"fits": fits, "chosen_block": chosen.map(|s| s.block), "agreeing": scales.agreeing})
}

fn axis_json(name: &str, axis: &Axis) -> Value {
    let unit = if name.starts_with("accel") {
        "m/s^2"
    } else {
        "rad/s"
    };
    let normal = &axis.normality;
    let candidates: Vec<Value> = axis.candidates.iter().map(candidate_json).collect();
    let ranking: Vec<&str> = axis
        .ranking()
        .into_iter()
        .map(|i| axis.candidates[i].name.as_str())
        .collect();
    let mut chosen = candidate_json(axis.recommended());
    chosen["reason"] = axis.reason.as_str().into();
    let motion = axis.motion.as_ref().map(|m| {
        json!({"moving": m.moving, "ratio": m.ratio, "windows": m.windows, "moving_windows": m.moving_windows})
    });
    // One object in two parts: the macro's recursion has a limit.
    let mut value = json!({
        "samples": axis.samples,
        "mean": axis.mean,
        "unit": unit,
        "detrend": removed(&axis.removed),
        "outliers": axis.outliers.iter().map(|o| json!({"index": o.index, "value": o.value, "sigmas": o.sigmas})).collect::<Vec<_>>(),
        "moving": axis.motion.as_ref().map(|m| m.moving),
        "motion": motion,
        "saturation": axis.saturation.iter().map(|s| json!({"value": s.value, "samples": s.samples})).collect::<Vec<_>>(),
        "hanging": axis.hanging.iter().map(|(index, samples)| json!({"index": index, "samples": samples})).collect::<Vec<_>>(),
        "adf": adf_json(axis),
        "kpss": {"statistic": axis.kpss.statistic, "p_value": axis.kpss.p_value, "p_is_bound": axis.kpss.p_is_bound, "lags": axis.kpss.lags, "critical": critical(&axis.kpss.critical)},
        "phillips_perron": {"statistic": axis.phillips_perron.z_tau, "p_value": axis.phillips_perron.p_value, "lags": axis.phillips_perron.lags, "critical": critical(&axis.phillips_perron.critical)},
        "stationarity": axis.stationarity.sentence,
        "jarque_bera": {"statistic": normal.jarque_bera, "critical_5": JARQUE_BERA_CRITICAL_5, "p_value": normal.jarque_bera_p},
        "ks": {"statistic": normal.distance, "critical_5": normal.plain_critical_5, "p_value": normal.plain_p},
        "lilliefors": {"statistic": normal.distance, "critical_5": normal.lilliefors_critical_5, "p_value": normal.lilliefors_p},
        "skewness": normal.skewness,
        "kurtosis_excess": normal.kurtosis_excess,
        "quantisation_step": normal.quantisation.map(|q| q.step),
    });
    let rest = json!({
        "acf": axis.acf,
        "pacf": axis.pacf,
        "ljung_box": {"statistic": axis.whiteness.ljung_box, "p_value": axis.whiteness.ljung_box_p, "lags": axis.whiteness.lags},
        "lines": axis.lines.iter().map(|l| json!({"frequency_hz": l.frequency_hz, "amplitude": l.amplitude})).collect::<Vec<_>>(),
        "allan": allan(axis),
        "allan_terms": allan_terms(axis),
        "pandit_wu": pandit_wu(axis),
        "box_jenkins": axis.box_jenkins.as_ref().map(box_jenkins),
        "scales": axis.scales.as_ref().map(scales),
        "candidates": candidates,
        "ranking": ranking,
        "chosen": chosen,
        "warnings": axis.warnings,
    });
    if let (Some(value), Value::Object(rest)) = (value.as_object_mut(), rest) {
        value.extend(rest);
    }
    value
}

fn candidate_json(candidate: &Candidate) -> Value {
    let by_horizon =
        |of: fn(&undrift_noise::drift_score::HorizonScore) -> f64| -> Map<String, Value> {
            let scores = candidate.score.iter();
            scores
                .map(|s| (format!("{}", s.horizon_s.round()), json!(of(s))))
                .collect()
        };
    let mut value = json!({
        "name": candidate.name,
        "states": candidate.states,
        "parameters": candidate.parameters,
        "ljung_box_p": candidate.ljung_box_p,
        "drift_score": by_horizon(|s| s.rms),
        "drift_score_error": by_horizon(|s| s.standard_error),
        "drift_predicted": by_horizon(|s| s.predicted_rms),
        "warnings": candidate.warnings,
    });
    let parts = [model_json(&candidate.model), origin_json(&candidate.origin)];
    if let Some(value) = value.as_object_mut() {
        value.extend(parts.into_iter().flatten());
    }
    value
}

/// The parameters of a candidate.
fn model_json(model: &AxisModel) -> Map<String, Value> {
    let arma = model.arma.as_ref();
    let of = |value: fn(&Arma) -> Value| arma.map_or(Value::Null, value);
    let process = |g: &Instability| json!({"sigma": g.sigma, "tau_s": g.tau});
    [
        ("p", of(|a| a.ar.len().into())),
        ("q", of(|a| a.ma.len().into())),
        ("ar", of(|a| json!(a.ar))),
        ("ma", of(|a| json!(a.ma))),
        ("sigma", of(|a| json!(a.sigma))),
        ("white", json!(model.white)),
        ("quantisation", json!(model.quantisation)),
        ("random_walk", json!(model.random_walk)),
        (
            "gauss_markov",
            model.instability.iter().map(process).collect(),
        ),
        ("turn_on", json!(model.turn_on)),
    ]
    .into_iter()
    .map(|(key, value)| (key.to_owned(), value))
    .collect()
}

/// What the fit says of itself. The likelihood of a composite model is that of the means of
/// `block` samples, not comparable to an ARMA's.
fn origin_json(origin: &Origin) -> Map<String, Value> {
    let value = match origin {
        Origin::Allan => json!({"method": "allan"}),
        Origin::Burg => json!({"method": "burg"}),
        Origin::Arma(fit) => json!({
            "method": "maximum likelihood",
            "log_likelihood": fit.log_likelihood,
            "aic": fit.aic,
            "bic": fit.bic,
            "standard_errors": fit.standard_errors,
            "near_cancelling": fit.near_cancelling,
            "flat_likelihood": fit.flat_likelihood,
            "unit_root": fit.unit_root,
        }),
        Origin::Composite(fit) => json!({
            "method": "maximum likelihood",
            "block": fit.block,
            "log_likelihood": fit.log_likelihood,
            "aic": fit.aic,
            "bic": fit.bic,
            "relative_errors": fit.relative_errors.as_ref().map(terms),
            "wavelet_moments": {
                "terms": terms(&fit.moments.terms),
                "relative_errors": fit.moments.relative_errors.as_ref().map(terms),
                "deviance": fit.moments.deviance,
                "degrees_of_freedom": fit.moments.degrees_of_freedom,
            },
        }),
        Origin::Scale(fit) => json!({
            "method": "block averages",
            "block": fit.block,
            "phi": fit.phi,
            "theta": fit.theta,
            "relative_errors": {"white": fit.relative_errors.white, "sigma": fit.relative_errors.sigma, "tau_s": fit.relative_errors.tau_s},
        }),
    };
    match value {
        Value::Object(map) => map,
        _ => Map::new(),
    }
}

fn terms(terms: &CompositeTerms) -> Value {
    let processes = terms.gauss_markov.iter().filter(|g| g.sigma > 0.0);
    json!({
        "white": terms.white,
        "quantisation": terms.quantisation,
        "random_walk": terms.random_walk,
        "gauss_markov": processes.map(|g| json!({"sigma": g.sigma, "tau_s": g.tau_s})).collect::<Vec<_>>(),
    })
}
