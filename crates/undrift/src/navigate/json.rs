//! A navigated drive as JSON.

use super::Report;
use crate::{
    consistency::GROUP,
    remarks,
    replay::Innovations,
    results::{Kind, with_head},
};
use serde_json::{Map, Value, json};
use undrift_noise::BiasModel;

/// Components of a velocity.
const AXES: [&str; 3] = ["north", "east", "down"];

impl Report {
    /// Everything as JSON; `drive` is [`crate::results::drive`] of what was navigated.
    pub fn json(&self, kind: BiasModel, drive: Value) -> Value {
        let s = &self.summary;
        let of = |sums: &Innovations| {
            let correlation = sums.autocorrelation();
            json!({
                "nis_per_dof": sums.per_dof(),
                "autocorrelation": correlation.map(|c| c.0),
                "autocorrelation_bound": correlation.map(|c| c.1),
            })
        };
        let mut warnings = Vec::from_iter(self.divergence());
        warnings.extend(self.warnings());
        let signs: Vec<&str> = s.wrong_signs().map(|i| AXES[i]).collect();
        let skipped: Map<String, Value> = self
            .logs()
            .into_iter()
            .map(|(log, skipped)| (log.to_lowercase(), skipped.to_string().into()))
            .collect();
        let nees: Map<String, Value> = GROUP
            .iter()
            .zip(&self.consistency.nees)
            .map(|((name, ..), mean)| (name.replace(' ', "_"), json!(mean.per_freedom())))
            .collect();
        with_head(
            Kind::Navigate,
            json!({
                "drive": drive,
                "bias_model": kind.name(),
                "smooth": self.smooth,
                "mounting": self.mounting.as_ref().map(ToString::to_string),
                "position": of(&s.position),
                "velocity": of(&s.velocity),
                "std_factors": {"position": self.std_factors[0], "velocity": self.std_factors[1]},
                "velocity_sign_wrong": signs,
                "rms_error": self.rmse.as_ref().map(|(errors, _)| errors),
                "nees_per_dof": nees,
                "compared_samples": self.rmse.as_ref().map(|(_, n)| n),
                "skipped": skipped,
                "summary": s,
                "warnings": warnings,
                "series": self.recording.as_ref().map(|recording| recording.json()),
            }),
        )
    }

    /// That the solution came to an end, if it did.
    pub fn divergence(&self) -> Option<String> {
        let time = self.summary.diverged?;
        Some(format!(
            "the solution diverged at {time:.3} s; what was written ends there"
        ))
    }

    /// Everything else that should be said with the solution, in sentences.
    pub fn warnings(&self) -> Vec<String> {
        let s = &self.summary;
        let mut warnings = Vec::from_iter(self.no_comparison());
        warnings.extend(remarks::of_health(s));
        warnings.extend(remarks::of_held(&self.held));
        warnings.extend(remarks::of_disagreement(s));
        for (name, skipped, gaps) in &self.scalars {
            let sums = if *name == "odometer" {
                &s.odometer
            } else {
                &s.barometer
            };
            warnings.extend(remarks::of_scalar(name, skipped, gaps, sums));
        }
        // With a wrong unit or axis the innovations say nothing of the accuracy.
        let factors = self.std_factors.iter().filter(|_| s.implausible.is_empty());
        for (part, factor) in ["position", "velocity"].iter().zip(factors) {
            warnings.extend(factor.map(|factor| remarks::of_accuracy(part, factor, s)));
        }
        warnings.extend(remarks::of_skipped(&self.logs()));
        warnings
    }

    /// What was left out of each log.
    fn logs(&self) -> [(&'static str, &undrift_io::skipped::Skipped); 3] {
        [
            ("IMU", &self.imu_skipped),
            ("GNSS", &self.gnss_skipped),
            ("truth", &self.truth_skipped),
        ]
    }

    /// Why there is no error although there is a truth.
    fn no_comparison(&self) -> Option<String> {
        let (None, Some((from, to))) = (&self.rmse, self.truth_read) else {
            return None;
        };
        let started = self.summary.started.unwrap_or(f64::NAN);
        let ended = self.summary.ended;
        let why = if to < started || from > ended {
            "the truth does not overlap the solution"
        } else {
            "the truth has no two samples within 2 s of each other beside the solution"
        };
        Some(format!(
            "{why}, so there is no error: it was read from {from:.3} s to {to:.3} s, the solution runs from {started:.3} s to {ended:.3} s; compare the time columns, truth.time_offset moves one"
        ))
    }
}
