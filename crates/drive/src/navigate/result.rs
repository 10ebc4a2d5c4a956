//! The result of a navigated drive.

use super::{Hindsight, Report};
use crate::{
    consistency::GROUP,
    replay::{self, Aid, Innovations},
    settings::fix_errors::{self, Correlated},
};
use undrift_noise::BiasModel;
use undrift_results::{
    Drive, FixErrors, Keyed, Navigate, Nis, Number, Parameter, SCHEMA, Say, Statement, StdFactors,
    Summary, VERSION, by_name,
};

/// Components of a velocity.
const AXES: [&str; 3] = ["north", "east", "down"];

impl Report {
    /// The result under its schema; `drive` describes what was navigated, `say` makes the sentences: `undrift_report::sentence`.
    pub fn result(&self, kind: BiasModel, drive: Drive, say: Say<'_>) -> Navigate {
        let s = &self.summary;
        let findings = self.findings();
        let skipped = [
            ("imu", &self.imu_skipped),
            ("gnss", &self.gnss_skipped),
            ("truth", &self.truth_skipped),
        ]
        .map(|(log, skipped)| (log.to_owned(), skipped.to_string()));
        let groups = GROUP.iter().zip(&self.consistency.nees);
        let [position, velocity] = self.std_factors;
        Navigate {
            undrift: VERSION.into(),
            schema: SCHEMA,
            drive,
            bias_model: kind.name().into(),
            smooth: self.hindsight == Hindsight::Smooth,
            look_ahead: self.hindsight != Hindsight::Causal,
            clock: self.clock.name().into(),
            mounting: self.mounted().map(say),
            position: nis(&s.innovations[Aid::Position]),
            velocity: nis(&s.innovations[Aid::Velocity]),
            std_factors: StdFactors { position, velocity },
            velocity_sign_wrong: s.wrong_signs.iter().map(|i| AXES[*i].into()).collect(),
            rms_error: self.rmse.as_ref().map(|(errors, _)| errors.numbers()),
            nees_per_dof: by_name(
                groups.map(|((name, ..), mean)| (name.replace(' ', "_"), mean.per_freedom())),
            ),
            compared_samples: self.rmse.as_ref().map(|(_, n)| *n),
            skipped: skipped.into(),
            summary: summary(s, say),
            windows: s.windows.iter().copied().collect(),
            warnings: findings.iter().map(Statement::Finding).map(say).collect(),
            findings,
            series: (self.recording.as_ref()).map(|recording| recording.series(&s.windows)),
        }
    }

    /// The last of the mountings found on the way, else the one that was estimated before.
    fn mounted(&self) -> Option<Statement<'_>> {
        let on_the_way = &self.summary.mountings;
        let (since, mounting) = match (on_the_way.first(), on_the_way.last()) {
            (Some((since, _)), Some((_, last))) => (Some(*since), last),
            _ => (None, self.mounting.as_ref()?),
        };
        Some(Statement::Mounting { mounting, since })
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

fn fix_errors((time, errors): &(f64, fix_errors::FixErrors)) -> FixErrors {
    let part = |part: &Correlated| (Number(part.share), Number(part.time));
    FixErrors {
        from: Number(*time),
        position_factor: Number(errors.position_factor),
        height_factor: Number(errors.height_factor),
        velocity_factor: errors.velocity_factor.map(Number).into(),
        correlated: errors.correlated.as_ref().map(part),
        velocity_correlated: errors.velocity_correlated.as_ref().map(part),
        step: errors.step.map(Number).into(),
        jitter: Number(errors.jitter),
        velocity_bias: errors.velocity_bias.map(Number).into(),
    }
}

fn summary(s: &replay::Summary, say: Say<'_>) -> Summary {
    let parameter = |(kind, value, std): &(_, Vec<f64>, Vec<f64>)| {
        let [value, std] = [value, std].map(|values| values.iter().copied().map(Number).collect());
        (format!("{kind:?}"), Parameter { value, std })
    };
    let (gap, long) = s.longest_without_gnss;
    Summary {
        samples: s.samples,
        align_samples: s.align_samples,
        started: s.started.into(),
        alignment: (s.alignment.as_ref())
            .map(|how| say(Statement::Alignment(how)))
            .unwrap_or_default(),
        ended: s.ended.into(),
        fixes: s.fixes,
        withheld: s.withheld,
        fixes_before: s.fixes_before,
        bad_fixes: s.bad_fixes,
        innovations: Keyed::new(|aid| s.innovations[aid]),
        parameters: by_name(s.parameters.iter().map(parameter)),
        contradictions: s.contradictions.clone(),
        more_contradictions: s.more_contradictions,
        leans: s.leans.clone(),
        restarts: s.restarts.clone(),
        fix_errors: s.fix_errors.iter().map(fix_errors).collect(),
        adapted: s.adapted,
        louder: s.louder.map(|louder| louder.map(Number)),
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
