//! Everything found, as a result. SI units.

use super::Identified;
use crate::results::{
    self, Allan, AllanTerms, ArmaOrigin, BoxJenkins, CompositeOrigin, Detrend, GridFit, Hanging,
    Identify, Lifted, Line, Number, Numbers, Order, OrderRow, Origin, PanditWuOrders, Process,
    SCHEMA, ScaleFit, ScaleOrigin, Scales, Term, Terms, Test, VERSION, WaveletMoments, numbers,
};
use undrift_noise::{
    allan::{self, Point},
    arma::{ArmaFit, Selection},
    composite::CompositeTerms,
    drift_score::HorizonScore,
    identify::{Axis, Candidate, GRID_ORDER, Origin as Found, Removed},
    normality::JARQUE_BERA_CRITICAL_5,
    pandit_wu::PAPER_CRITICAL,
    scales,
    screening::Trend,
    stationarity::{Adf, Critical},
};

impl Identified {
    /// Everything as a result; `record` is what the record is called.
    pub fn result(&self, record: &str) -> Identify {
        let axes = self
            .axes
            .iter()
            .zip(&self.series)
            .map(|((name, found), series)| {
                let axis = match found {
                    Ok(found) => results::Axis {
                        series: series.result(found),
                        ..axis(name, found)
                    },
                    Err(error) => results::Axis {
                        error: Some(error.to_string()),
                        ..results::Axis::default()
                    },
                };
                ((*name).to_owned(), axis)
            });
        Identify {
            undrift: VERSION.into(),
            schema: SCHEMA,
            record: record.into(),
            rate_hz: self.rate_hz.into(),
            timing: self.timing.clone(),
            skipped_rows: self.skipped_rows,
            axes: axes.collect(),
        }
    }
}

fn axis(name: &str, axis: &Axis) -> results::Axis {
    let normal = &axis.normality;
    let ranking = axis.ranking().into_iter();
    let line = |l: &undrift_noise::spectrum::Line| Line {
        frequency_hz: l.frequency_hz.into(),
        amplitude: l.amplitude.into(),
    };
    let hanging = |(index, samples): &(usize, usize)| Hanging {
        index: *index as u64,
        samples: *samples as u64,
    };
    let by_rule = axis
        .adf_chosen
        .iter()
        .map(|(rule, test)| ((*rule).to_owned(), adf(test)));
    results::Axis {
        error: None,
        samples: axis.samples as u64,
        mean: axis.mean.into(),
        unit: if name.starts_with("accel") {
            "m/s^2"
        } else {
            "rad/s"
        }
        .into(),
        detrend: detrend(&axis.removed),
        outliers: axis.outliers.clone(),
        moving: axis.motion.as_ref().map(|m| m.moving),
        motion: axis.motion.clone(),
        saturation: axis.saturation.clone(),
        hanging: axis.hanging.iter().map(hanging).collect(),
        adf: Test {
            by_rule: Some(by_rule.collect()),
            ..adf(&axis.adf)
        },
        kpss: Test {
            p_is_bound: Some(axis.kpss.p_is_bound),
            ..unit_root(
                axis.kpss.statistic,
                axis.kpss.p_value,
                axis.kpss.lags,
                &axis.kpss.critical,
            )
        },
        phillips_perron: {
            let test = &axis.phillips_perron;
            unit_root(test.z_tau, test.p_value, test.lags, &test.critical)
        },
        stationarity: axis.stationarity.sentence.clone(),
        jarque_bera: plain(
            normal.jarque_bera,
            JARQUE_BERA_CRITICAL_5,
            normal.jarque_bera_p,
        ),
        ks: plain(normal.distance, normal.plain_critical_5, normal.plain_p),
        lilliefors: plain(
            normal.distance,
            normal.lilliefors_critical_5,
            normal.lilliefors_p,
        ),
        skewness: normal.skewness.into(),
        kurtosis_excess: normal.kurtosis_excess.into(),
        quantisation_step: normal.quantisation.map(|q| q.step).into(),
        acf: values(&axis.acf),
        pacf: values(&axis.pacf),
        ljung_box: Test {
            lags: Some(axis.whiteness.lags as u64),
            ..test(axis.whiteness.ljung_box, axis.whiteness.ljung_box_p)
        },
        lines: axis.lines.iter().map(line).collect(),
        allan: deviation(axis),
        allan_terms: allan_terms(&axis.allan_terms),
        pandit_wu: pandit_wu(axis),
        pandit_wu_orders: axis.pandit_wu.as_ref().map(|table| PanditWuOrders {
            by_f: table.by_f.into(),
            by_aic: table.by_aic.into(),
            by_bic: table.by_bic.into(),
        }),
        box_jenkins: axis.box_jenkins.as_ref().map(box_jenkins),
        scales: axis.scales.as_ref().map(of_scales),
        candidates: axis.candidates.iter().map(candidate).collect(),
        ranking: ranking.map(|i| axis.candidates[i].name.clone()).collect(),
        chosen: results::Candidate {
            reason: Some(axis.reason.clone()),
            ..candidate(axis.recommended())
        },
        warnings: axis.warnings.clone(),
        series: results::AxisSeries::default(),
    }
}

fn values(values: &[f64]) -> Vec<Number> {
    numbers(values.iter().copied())
}

fn test(statistic: f64, p_value: f64) -> Test {
    Test {
        statistic: statistic.into(),
        p_value: p_value.into(),
        ..Test::default()
    }
}

fn plain(statistic: f64, critical: f64, p_value: f64) -> Test {
    Test {
        critical_5: Some(critical.into()),
        ..test(statistic, p_value)
    }
}

fn unit_root(statistic: f64, p_value: f64, lags: usize, critical: &Critical) -> Test {
    let critical = [
        ("1%", critical.one),
        ("5%", critical.five),
        ("10%", critical.ten),
    ];
    Test {
        lags: Some(lags as u64),
        critical: named(critical),
        ..test(statistic, p_value)
    }
}

fn adf(adf: &Adf) -> Test {
    Test {
        criterion: Some(adf.criterion.into()),
        ..unit_root(adf.statistic, adf.p_value, adf.lags, &adf.critical)
    }
}

fn named<const N: usize>(numbers: [(&str, f64); N]) -> Numbers {
    numbers
        .map(|(name, value)| (name.to_owned(), Number(value)))
        .into()
}

fn detrend(removed: &Removed) -> Detrend {
    let (slope, explained) = (removed.slope.into(), removed.explained.into());
    match removed.trend {
        Trend::Constant => Detrend::Constant,
        Trend::Linear => Detrend::Linear {
            slope_per_hour: slope,
            explained,
        },
        Trend::Temperature => Detrend::Temperature {
            slope_per_kelvin: slope,
            explained,
        },
    }
}

fn deviation(axis: &Axis) -> Allan {
    let points = &axis.allan.points;
    let of = |value: &dyn Fn(&Point) -> f64| numbers(points.iter().map(value));
    let terms = &axis.allan_terms;
    Allan {
        tau_s: of(&|p| p.tau_s),
        adev: of(&|p| p.deviation),
        lower: numbers(axis.allan_intervals.iter().map(|i| i.lower)),
        upper: numbers(axis.allan_intervals.iter().map(|i| i.upper)),
        fit: of(&|p| terms.variance(p.tau_s).sqrt()),
        fit_from_s: terms.from_s.into(),
    }
}

fn allan_terms(terms: &allan::Terms) -> AllanTerms {
    let term = |t: &allan::Term| Term {
        value: t.value.into(),
        standard_error: t.standard_error.into(),
        upper_95: t.upper_95.into(),
        seen: t.seen,
    };
    AllanTerms {
        quantisation: term(&terms.quantisation),
        white: term(&terms.white),
        bias_instability: term(&terms.bias_instability),
        random_walk: term(&terms.random_walk),
        ramp: term(&terms.ramp),
        white_variance: terms.white_variance.into(),
    }
}

fn order(fit: &ArmaFit) -> Order {
    fit.order().into()
}

fn pandit_wu(axis: &Axis) -> Vec<OrderRow> {
    let rows = axis.pandit_wu.iter().flat_map(|t| &t.rows);
    rows.map(|row| {
        let Order { p, q } = order(&row.fit);
        OrderRow {
            p,
            q,
            rss: row.fit.residual_sum_of_squares.into(),
            aic: row.fit.aic.into(),
            bic: row.fit.bic.into(),
            ar: values(&row.fit.ar),
            ma: values(&row.fit.ma),
            f: row.test.map(|t| t.f).into(),
            f_critical: row.test.map(|t| t.critical).into(),
            f_paper: PAPER_CRITICAL.into(),
        }
    })
    .collect()
}

fn box_jenkins(selection: &Selection) -> BoxJenkins {
    let grid = |fit: &ArmaFit| {
        let Order { p, q } = order(fit);
        GridFit {
            p,
            q,
            log_likelihood: fit.log_likelihood.into(),
            aic: fit.aic.into(),
            aicc: fit.aicc.into(),
            bic: fit.bic.into(),
        }
    };
    let fits = &selection.fits;
    BoxJenkins {
        samples: fits[selection.by_aicc].n as u64,
        p_max: GRID_ORDER as u64,
        q_max: GRID_ORDER as u64,
        by_aic: order(&fits[selection.by_aic]),
        by_aicc: order(&fits[selection.by_aicc]),
        by_bic: order(&fits[selection.by_bic]),
        grid: fits.iter().map(grid).collect(),
    }
}

fn of_scales(scales: &scales::Scales) -> Scales {
    let lifted = |l: scales::Lifted| Lifted {
        white: l.white.into(),
        sigma: l.sigma.into(),
        tau_s: l.tau_s.into(),
        drive: l.drive.into(),
    };
    let fit = |s: &scales::ScaleFit| ScaleFit {
        block: s.block as u64,
        points: s.points as u64,
        phi: s.phi.into(),
        theta: s.theta.into(),
        sigma: s.sigma.into(),
        lifted: s.lifted.map(lifted),
        relative_errors: lifted(s.relative_errors),
        seen: s.is_seen(),
    };
    let chosen = scales.chosen.and_then(|i| scales.scales.get(i));
    Scales {
        fits: scales.scales.iter().map(fit).collect(),
        chosen_block: chosen.map(|s| s.block as u64),
        agreeing: scales.agreeing as u64,
    }
}

fn candidate(candidate: &Candidate) -> results::Candidate {
    let by_horizon = |of: fn(&HorizonScore) -> f64| -> Numbers {
        let scores = candidate.score.iter();
        scores
            .map(|s| (format!("{}", s.horizon_s.round()), of(s).into()))
            .collect()
    };
    let model = &candidate.model;
    let arma = model.arma.as_ref();
    let processes = model.instability.iter();
    results::Candidate {
        name: candidate.name.clone(),
        states: candidate.states as u64,
        parameters: candidate.parameters as u64,
        ljung_box_p: candidate.ljung_box_p.into(),
        drift_score: by_horizon(|s| s.rms),
        drift_score_error: by_horizon(|s| s.standard_error),
        drift_predicted: by_horizon(|s| s.predicted_rms),
        warnings: candidate.warnings.clone(),
        p: arma.map(|a| a.ar.len() as u64),
        q: arma.map(|a| a.ma.len() as u64),
        ar: arma.map(|a| values(&a.ar)),
        ma: arma.map(|a| values(&a.ma)),
        sigma: arma.map(|a| a.sigma).into(),
        white: model.white.into(),
        quantisation: model.quantisation.into(),
        random_walk: model.random_walk.into(),
        gauss_markov: processes.map(|g| process(g.sigma, g.tau)).collect(),
        turn_on: model.turn_on.into(),
        origin: Some(origin(&candidate.origin)),
        reason: None,
    }
}

fn process(sigma: f64, tau_s: f64) -> Process {
    Process {
        sigma: sigma.into(),
        tau_s: tau_s.into(),
    }
}

fn origin(origin: &Found) -> Origin {
    let likelihood = || "maximum likelihood".into();
    match origin {
        Found::Allan => Origin::Plain {
            method: "allan".into(),
        },
        Found::Burg => Origin::Plain {
            method: "burg".into(),
        },
        Found::Arma(fit) => Origin::Arma(ArmaOrigin {
            method: likelihood(),
            log_likelihood: fit.log_likelihood.into(),
            aic: fit.aic.into(),
            bic: fit.bic.into(),
            standard_errors: fit.standard_errors.as_deref().map(values),
            near_cancelling: fit.near_cancelling,
            flat_likelihood: fit.flat_likelihood,
            unit_root: fit.unit_root,
        }),
        Found::Composite(fit) => Origin::Composite(CompositeOrigin {
            method: likelihood(),
            block: fit.block as u64,
            log_likelihood: fit.log_likelihood.into(),
            aic: fit.aic.into(),
            bic: fit.bic.into(),
            relative_errors: fit.relative_errors.as_ref().map(terms),
            wavelet_moments: WaveletMoments {
                terms: terms(&fit.moments.terms),
                relative_errors: fit.moments.relative_errors.as_ref().map(terms),
                deviance: fit.moments.deviance.into(),
                degrees_of_freedom: fit.moments.degrees_of_freedom as u64,
            },
        }),
        Found::Scale(fit) => {
            let e = &fit.relative_errors;
            Origin::Scale(ScaleOrigin {
                method: "block averages".into(),
                block: fit.block as u64,
                phi: fit.phi.into(),
                theta: fit.theta.into(),
                relative_errors: named([
                    ("white", e.white),
                    ("sigma", e.sigma),
                    ("tau_s", e.tau_s),
                ]),
            })
        }
    }
}

fn terms(terms: &CompositeTerms) -> Terms {
    let processes = terms.gauss_markov.iter().filter(|g| g.sigma > 0.0);
    Terms {
        white: terms.white.into(),
        quantisation: terms.quantisation.into(),
        random_walk: terms.random_walk.into(),
        gauss_markov: processes.map(|g| process(g.sigma, g.tau_s)).collect(),
    }
}
