//! The experiment as JSON.

use super::{ModelRun, Outcome, drift::drift_curve};
use crate::{
    replay::Outage,
    results::{self, Kind, with_head},
    series::{ROWS, Thinned, to_digits, to_millimetre, to_millisecond},
};
use serde_json::{Map, Value, json};
use undrift_nav::sample::{GnssFix, Position, TruthSample};

/// A finished experiment, and what it was made of.
pub struct Experiment<'a> {
    /// What was navigated, [`results::drive`], or what was simulated.
    pub drive: Value,
    /// Where GNSS was cut.
    pub outages: &'a [Outage],
    /// Model by model.
    pub results: &'a [Outcome],
    /// "truth", or "gnss" where the withheld fixes are the reference.
    pub reference: &'a str,
    /// The way driven.
    pub track: &'a [TruthSample],
    /// Whether the errors are those of the smoothed solutions.
    pub smooth: bool,
    /// What should be said of the logs.
    pub warnings: Vec<String>,
}

impl Experiment<'_> {
    /// The models that were run, in their order.
    pub fn runs(&self) -> impl Iterator<Item = &ModelRun> {
        self.results.iter().filter_map(|(_, run)| run.as_ref().ok())
    }

    /// Everything as JSON.
    pub fn json(&self) -> Value {
        let by_name = |of: &dyn Fn(&ModelRun) -> Value| -> Map<String, Value> {
            self.runs().map(|run| (run.name.clone(), of(run))).collect()
        };
        let failed: Map<String, Value> = self
            .results
            .iter()
            .filter_map(|(name, run)| Some((name.clone(), run.as_ref().err()?.to_string().into())))
            .collect();
        let names: Vec<&str> = self.runs().map(|run| run.name.as_str()).collect();
        with_head(
            Kind::Outages,
            json!({
                "drive": self.drive,
                "outages": results::outages(self.outages),
                "order": names,
                "models": by_name(&|run| json!(run.errors)),
                "failed": failed,
                "reference": self.reference,
                "smooth": self.smooth,
                "nis_per_dof": by_name(&|run| json!({
                    "position": run.summary.position.per_dof(),
                    "velocity": run.summary.velocity.per_dof(),
                })),
                "warnings": self.warnings,
                "series": {
                    "track": path(self.track),
                    "drift": by_name(&|run| {
                        let (times, errors): (Vec<_>, Vec<_>) = drift_curve(run)
                            .points
                            .into_iter()
                            .map(|(time, error)| (to_millisecond(time), to_digits(error)))
                            .unzip();
                        json!({"since_cut_s": times, "horizontal_rms_m": errors})
                    }),
                },
            }),
        )
    }
}

/// The way as JSON.
fn path(track: &[TruthSample]) -> Value {
    let mut thinned = Thinned::new(ROWS);
    for sample in track {
        let (lat, lon) = (sample.position.lat, sample.position.lon);
        thinned.add([sample.time, lat.to_degrees(), lon.to_degrees()]);
    }
    thinned.json([
        ("time_s", to_millisecond),
        ("lat_deg", to_millimetre),
        ("lon_deg", to_millimetre),
    ])
}

/// What to draw as the way: the truth, or the fixes where there is none.
pub fn track(truth: &[TruthSample], gnss: &[GnssFix]) -> Vec<TruthSample> {
    if !truth.is_empty() {
        return truth.to_vec();
    }
    gnss.iter()
        .filter_map(|fix| match fix.position {
            Some((Position::Geodetic(position), _)) => Some(TruthSample {
                time: fix.time,
                position,
                v_n: None,
                rpy: None,
            }),
            _ => None,
        })
        .collect()
}
