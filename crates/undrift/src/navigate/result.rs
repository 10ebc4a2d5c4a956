//! A navigated drive as its result.

use super::Report;
use crate::{
    consistency::GROUP,
    remarks,
    replay::{self, Innovations},
    results::{Drive, Navigate, Nis, Number, Parameter, SCHEMA, StdFactors, Summary, VERSION},
};
use undrift_noise::BiasModel;

/// Components of a velocity.
const AXES: [&str; 3] = ["north", "east", "down"];

impl Report {
    /// Everything as a result; `drive` is what was navigated.
    pub fn result(&self, kind: BiasModel, drive: Drive) -> Navigate {
        let s = &self.summary;
        let mut warnings = Vec::from_iter(self.divergence());
        warnings.extend(self.warnings());
        let skipped = self
            .logs()
            .map(|(log, skipped)| (log.to_lowercase(), skipped.to_string()));
        let groups = GROUP.iter().zip(&self.consistency.nees);
        let [position, velocity] = self.std_factors;
        Navigate {
            undrift: VERSION.into(),
            schema: SCHEMA,
            drive,
            bias_model: kind.name().into(),
            smooth: self.smooth,
            mounting: self.mounting.as_ref().map(ToString::to_string),
            position: nis(&s.position),
            velocity: nis(&s.velocity),
            std_factors: StdFactors { position, velocity },
            velocity_sign_wrong: s.wrong_signs().map(|i| AXES[i].into()).collect(),
            rms_error: self.rmse.as_ref().map(|(errors, _)| errors.numbers()),
            nees_per_dof: groups
                .map(|((name, ..), mean)| (name.replace(' ', "_"), mean.per_freedom().into()))
                .collect(),
            compared_samples: self.rmse.as_ref().map(|(_, n)| *n),
            skipped: skipped.into(),
            summary: summary(s),
            warnings,
            series: self.recording.as_ref().map(|recording| recording.series()),
        }
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

fn nis(sums: &Innovations) -> Nis {
    let correlation = sums.autocorrelation();
    Nis {
        nis_per_dof: sums.per_dof().into(),
        autocorrelation: correlation.map(|c| c.0).into(),
        autocorrelation_bound: correlation.map(|c| c.1).into(),
    }
}

fn summary(s: &replay::Summary) -> Summary {
    let parameter = |(kind, value, std): &(_, Vec<f64>, Vec<f64>)| {
        let [value, std] = [value, std].map(|values| values.iter().copied().map(Number).collect());
        (format!("{kind:?}"), Parameter { value, std })
    };
    let (gap, long) = s.longest_without_gnss;
    Summary {
        samples: s.samples,
        align_samples: s.align_samples,
        started: s.started.into(),
        alignment: s
            .alignment
            .as_ref()
            .map_or(String::new(), remarks::of_alignment),
        ended: s.ended.into(),
        fixes: s.fixes,
        withheld: s.withheld,
        fixes_before: s.fixes_before,
        bad_fixes: s.bad_fixes,
        position: s.position,
        velocity: s.velocity,
        non_holonomic: s.non_holonomic,
        zero_velocity: s.zero_velocity,
        odometer: s.odometer,
        barometer: s.barometer,
        parameters: s.parameters.iter().map(parameter).collect(),
        contradictions: s.contradictions.clone(),
        more_contradictions: s.more_contradictions,
        leans: s.leans.clone(),
        restarts: s.restarts.clone(),
        adapted: s.adapted,
        bridged: s.bridged,
        long_gaps: s
            .long_gaps
            .map(|(count, first, longest)| (count, first.into(), longest.into())),
        longest_without_gnss: (gap.into(), long.into()),
        implausible: s.implausible.clone(),
        diverged: s.diverged,
        covariance: s.covariance,
        suspect: s.suspect,
    }
}
