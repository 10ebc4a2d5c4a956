//! The demo as its result.

use super::{BOUND, CUTS, Demo, Estimate, PRESET, Paper, Pooled, Source, Track};
use std::collections::BTreeMap;
use undrift_drive::{
    identify::{order_rows, order_tests, residuals},
    outages::thinned_track,
};
use undrift_noise::arma::ArmaFit;
use undrift_results::{
    self as results, Curve, CutLength, DemoModel, Drift, OneOne, SCHEMA, Say, ScanPoint, Statement,
    VERSION, by_name, numbers,
    series::{to_digits, to_millimetre, to_millisecond},
};

impl Demo {
    /// Everything as a result; `say` makes the sentences: `undrift_report::sentence`.
    pub fn result(&self, say: Say<'_>) -> results::Demo {
        let models = self.models.iter().map(|(name, without)| DemoModel {
            name: (*name).into(),
            bound: *name == BOUND,
            without: without.iter().map(|axis| (*axis).into()).collect(),
        });
        let lengths = self.lengths.iter().zip(CUTS).map(|(of, cuts)| CutLength {
            length_s: cuts.length.into(),
            cuts: (cuts.count * self.experiment.drives) as u64,
            models: self.by_name(of),
        });
        let (truth, cuts) = &self.first;
        let recorded = matches!(self.experiment.source, Source::Recorded { .. });
        let record = match recorded {
            true => self.record.name.display().to_string(),
            false => format!("Simulated static recording of {PRESET}"),
        };
        let result = results::Demo {
            undrift: VERSION.into(),
            schema: SCHEMA,
            seed: self.experiment.seed,
            drives: self.experiment.drives as u64,
            recorded,
            identification: self.identified.result(&record, say),
            models: models.collect(),
            lengths: lengths.collect(),
            track: thinned_track(truth),
            cuts: cuts.first().into_iter().flatten().map(Into::into).collect(),
            paper: self.paper.as_ref().map(Into::into),
            conclusion: String::new(),
        };
        results::Demo {
            conclusion: say(Statement::Demo(&result)),
            ..result
        }
    }

    fn by_name(&self, of: &[Pooled]) -> BTreeMap<String, results::PooledErrors> {
        by_name(self.models.iter().map(|(name, _)| *name).zip(of))
    }
}

impl From<Estimate> for results::Estimate {
    fn from(of: Estimate) -> Self {
        Self {
            value: of.value.into(),
            interval: of.interval.map(Into::into),
        }
    }
}

impl From<&Pooled> for results::PooledErrors {
    fn from(of: &Pooled) -> Self {
        Self {
            max: of.max.numbers(),
            rms: of.rms.numbers(),
            horizontal_m: of.horizontal.into(),
            less_than_white: of.less_than_white.into(),
            over_least: of.over_least.into(),
            largest_m: numbers(of.largest.iter().copied()),
            drift: Drift {
                since_cut_s: numbers(of.drift.iter().map(|p| to_millisecond(p.0))),
                horizontal_rms_m: numbers(of.drift.iter().map(|p| to_digits(p.1))),
            },
            failed: of.failed.clone(),
        }
    }
}

impl From<&Paper> for results::Paper {
    fn from(of: &Paper) -> Self {
        let largest = of.largest.iter();
        let solutions = of.tracks.iter();
        let [free, unit_root] = &of.one_one;
        let one_one = [(free, false), (unit_root, true)];
        let one_one = one_one
            .into_iter()
            .filter_map(|(fit, held)| Some(one_one_of(fit.as_ref()?, held)));
        Self {
            orders: of.orders.as_ref().map(order_rows).unwrap_or_default(),
            adequacy: of.orders.as_ref().map(order_tests).unwrap_or_default(),
            one_one: one_one.collect(),
            residuals: of.residuals.as_ref().map(residuals),
            largest: by_name(largest.map(|(name, e)| (name.as_str(), e.numbers()))),
            solutions: by_name(solutions.map(|t| (t.name, t))),
            scan: of
                .scan
                .iter()
                .map(|(scale, error)| ScanPoint {
                    scale: (*scale).into(),
                    horizontal_m: (*error).into(),
                })
                .collect(),
        }
    }
}

fn one_one_of(fit: &ArmaFit, unit_root: bool) -> OneOne {
    OneOne {
        unit_root,
        phi: fit.ar.first().copied().into(),
        theta: fit.ma.first().copied().into(),
        sigma: fit.sigma.into(),
    }
}

impl From<&Track> for results::PaperSolution {
    fn from(of: &Track) -> Self {
        let column = |at, round| of.rows.column(at, round);
        let error = |at| Curve {
            time_s: column(0, to_millisecond),
            value: column(at, to_digits),
        };
        Self {
            track: results::Track {
                time_s: column(0, to_millisecond),
                lat_deg: column(1, to_millimetre),
                lon_deg: column(2, to_millimetre),
                height_m: Vec::new(),
            },
            error_m: [3, 4, 5].map(error),
        }
    }
}
