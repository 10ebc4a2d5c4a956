//! A static record of six axes, or one, into a model file and the reasoning behind it.

use crate::record::Record;
use rayon::prelude::*;
use serde_json::{Map, Value, json};
use undrift_noise::{
    ImuModel, Provenance,
    identify::{Axis, Candidate, IdentifyError, Options, identify},
    model_file::AXES,
    normality::JARQUE_BERA_CRITICAL_5,
    stationarity::Critical,
};

/// The axes of a record, identified.
pub struct Identified {
    /// Sample rate [Hz].
    pub rate_hz: f64,
    /// Name of each axis with what was found, or why nothing was.
    pub axes: Vec<(&'static str, Result<Axis, IdentifyError>)>,
}

/// Identifies every axis of a record, on all cores. `done` is called after each axis.
pub fn run(record: &Record, options: &Options, done: impl Fn() + Sync) -> Identified {
    let axes = record
        .axes
        .par_iter()
        .zip(&record.samples)
        .map(|(name, samples)| {
            let found = identify(samples, name.starts_with("accel"), options);
            done();
            (*name, found)
        })
        .collect();
    Identified {
        rate_hz: options.rate_hz,
        axes,
    }
}

impl Identified {
    /// The model file's contents: identified axes over those of `base`, which must have the others.
    /// The standard deviation of the turn-on constant is the base's where it has one, else the
    /// constant seen in the record.
    ///
    /// # Errors
    /// A sentence for the user when an axis is neither identified nor in a base.
    pub fn model(
        &self,
        base: Option<&ImuModel>,
        name: &str,
        provenance: Provenance,
    ) -> Result<ImuModel, String> {
        let mut model = base.cloned().unwrap_or_default();
        model.name = name.to_owned();
        model.source = "identified from a static record".into();
        model.provenance = provenance;
        for (index, axis) in AXES.iter().enumerate() {
            let slot = if index < 3 {
                &mut model.gyro[index]
            } else {
                &mut model.accel[index - 3]
            };
            match self.axes.iter().find(|(name, _)| name == axis) {
                Some((_, Ok(found))) => {
                    // One record shows one turn-on; a data sheet knows how they scatter.
                    let known = slot.turn_on;
                    *slot = found.model();
                    if known > 0.0 {
                        slot.turn_on = known;
                    }
                }
                Some((name, Err(error))) if base.is_none() => {
                    return Err(format!("{name}: {error}"));
                }
                None if base.is_none() => {
                    return Err(format!(
                        "a model needs six axes and {axis} is not in the record; give the others with --base PRESET or FILE"
                    ));
                }
                _ => {}
            }
        }
        Ok(model)
    }

    /// Everything as JSON.
    pub fn json(&self) -> Value {
        let axes: Map<String, Value> = self
            .axes
            .iter()
            .map(|(name, found)| {
                let value = match found {
                    Ok(axis) => axis_json(name, axis),
                    Err(error) => json!({"error": error.to_string()}),
                };
                ((*name).to_owned(), value)
            })
            .collect();
        json!({"rate_hz": self.rate_hz, "axes": axes})
    }
}

fn critical(c: &Critical) -> Value {
    json!({"1%": c.one, "5%": c.five, "10%": c.ten})
}

fn axis_json(name: &str, axis: &Axis) -> Value {
    let unit = if name.starts_with("accel") {
        "m/s^2"
    } else {
        "rad/s"
    };
    let normal = &axis.normality;
    let terms = &axis.allan_terms;
    let term = |t: &undrift_noise::allan::Term| json!({"value": t.value, "standard_error": finite(t.standard_error), "upper_95": finite(t.upper_95), "seen": t.seen});
    let points = &axis.allan.points;
    let tau: Vec<f64> = points.iter().map(|p| p.tau_s).collect();
    let adev: Vec<f64> = points.iter().map(|p| p.deviation).collect();
    let lower: Vec<f64> = axis.allan_intervals.iter().map(|i| i.lower).collect();
    let upper: Vec<f64> = axis.allan_intervals.iter().map(|i| i.upper).collect();
    let candidates: Vec<Value> = axis.candidates.iter().map(candidate_json).collect();
    let table: Vec<Value> = axis.pandit_wu.iter().flat_map(|t| &t.rows).map(|row| {
        let (p, q) = row.order();
        json!({
            "p": p, "q": q, "rss": row.fit.residual_sum_of_squares, "aic": row.fit.aic, "bic": row.fit.bic,
            "ar": row.fit.ar, "ma": row.fit.ma,
            "f": row.test.map(|t| finite(t.f)), "f_critical": row.test.map(|t| t.critical),
            "f_paper": undrift_noise::pandit_wu::PAPER_CRITICAL,
        })
    }).collect();
    json!({
        "samples": axis.samples,
        "mean": axis.mean,
        "unit": unit,
        "outliers": axis.outliers.iter().map(|o| json!({"index": o.index, "value": o.value, "sigmas": o.sigmas})).collect::<Vec<_>>(),
        "moving": axis.motion.as_ref().map(|m| m.moving),
        "adf": {"statistic": axis.adf.statistic, "p_value": axis.adf.p_value, "lags": axis.adf.lags, "critical": critical(&axis.adf.critical)},
        "kpss": {"statistic": axis.kpss.statistic, "p_value": axis.kpss.p_value, "p_is_bound": axis.kpss.p_is_bound, "lags": axis.kpss.lags, "critical": critical(&axis.kpss.critical)},
        "phillips_perron": {"statistic": axis.phillips_perron.z_tau, "p_value": axis.phillips_perron.p_value, "lags": axis.phillips_perron.lags, "critical": critical(&axis.phillips_perron.critical)},
        "stationarity": axis.stationarity.sentence,
        "jarque_bera": {"statistic": normal.jarque_bera, "critical_5": JARQUE_BERA_CRITICAL_5, "p_value": normal.jarque_bera_p},
        "ks": {"statistic": normal.distance, "critical_5": normal.plain_critical_5, "p_value": normal.plain_p},
        "lilliefors": {"statistic": normal.distance, "critical_5": normal.lilliefors_critical_5, "p_value": normal.lilliefors_p},
        "skewness": normal.skewness,
        "kurtosis_excess": normal.kurtosis_excess,
        "quantisation_step": normal.quantisation.map(|q| q.step),
        "acf": axis.acf,
        "pacf": axis.pacf,
        "ljung_box": {"statistic": axis.whiteness.ljung_box, "p_value": finite(axis.whiteness.ljung_box_p), "lags": axis.whiteness.lags},
        "lines": axis.lines.iter().map(|l| json!({"frequency_hz": l.frequency_hz, "amplitude": l.amplitude})).collect::<Vec<_>>(),
        "allan": {"tau_s": tau, "adev": adev, "lower": lower, "upper": upper},
        "allan_terms": {
            "quantisation": term(&terms.quantisation),
            "white": term(&terms.white),
            "bias_instability": term(&terms.bias_instability),
            "random_walk": term(&terms.random_walk),
            "ramp": term(&terms.ramp),
            "white_variance": terms.white_variance,
        },
        "pandit_wu": table,
        "candidates": candidates,
        "chosen": {"name": axis.recommended().name, "reason": axis.reason},
        "warnings": axis.warnings,
    })
}

fn candidate_json(candidate: &Candidate) -> Value {
    let score: Map<String, Value> = candidate
        .score
        .iter()
        .map(|s| (format!("{}", s.horizon_s.round()), json!(s.rms)))
        .collect();
    let arma = candidate.model.arma.as_ref();
    let fit = candidate.fit.as_ref();
    json!({
        "name": candidate.name,
        "p": arma.map(|a| a.ar.len()),
        "q": arma.map(|a| a.ma.len()),
        "ar": arma.map(|a| &a.ar),
        "ma": arma.map(|a| &a.ma),
        "sigma": arma.map(|a| a.sigma),
        "white": candidate.model.white,
        "random_walk": candidate.model.random_walk,
        "gauss_markov": candidate.model.instability.as_ref().map(|g| json!({"sigma": g.sigma, "tau_s": g.tau})),
        "log_likelihood": fit.map(|f| f.log_likelihood),
        "aic": fit.map(|f| f.aic),
        "bic": fit.map(|f| f.bic),
        "standard_errors": fit.and_then(|f| f.standard_errors.as_ref()),
        "near_cancelling": fit.map(|f| f.near_cancelling),
        "ljung_box_p": candidate.ljung_box_p.and_then(finite),
        "drift_score": score,
        "drift_score_error": candidate.score.iter().map(|s| s.standard_error).collect::<Vec<_>>(),
    })
}

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}
