//! Alignment in motion: attitude and biases from a bounded window of samples and fixes.
//!
//! Two steps. A least-squares search over the window ([`super::wahba`]) proposes attitude and biases at its
//! start; then the navigation filter itself goes through the window from there, with a wide
//! covariance, and so says how certain the result is and whether its innovations fit. An uncertain
//! or ambiguous result waits for more motion. Only the window is kept.

use super::{
    segments::segments,
    wahba::{Guess, Problem, Solution},
};
use crate::replay::{GnssUse, STAMP_ROUNDING, Settings};
use std::collections::VecDeque;
use undrift_nav::{
    Matrix3, Vector3,
    filter::{Filter, InitialStd},
    mechanisation::NavState,
    sample::{GnssFix, ImuSample},
    shaping::ShapingFilter,
};

/// The window is no longer than this [s] …
const LONGEST: f64 = 60.0;
/// … nor than a gyro bias of one standard deviation needs for this angle [rad] …
const BIAS_TURN: f64 = 1.2;
/// … and no shorter than this [s].
const SHORTEST: f64 = 20.0;
/// Fixes in the search are at least this far apart [s]; a sample longer than this ends the window.
const SPACING: f64 = 0.45;
const LONGEST_SAMPLE: f64 = 0.2;
/// Between two searches [s].
const EVERY: f64 = 1.0;
/// Velocities needed, and how far apart they must be [m/s] for a search to be worth it.
const FEWEST: usize = 6;
const SPREAD: f64 = 1.0;
/// A second minimum is out of the question when the best one's squared residuals are less by this much.
const RIVAL: f64 = 25.0;
/// Attitude's standard deviation about any axis for an alignment [rad].
const CERTAIN: f64 = 0.05;
/// Normalised innovations squared for each degree of freedom in the later half of the window, at most.
const FIT: f64 = 10.0;
/// Standard deviation of the attitude with which the filter enters the window [rad].
const ENTRY: f64 = 0.3;
/// Standard deviation of what no model says of a bias [rad/s], [m/s²]: nothing is known exactly.
const BIAS_FLOOR: (f64, f64) = (1e-4, 1e-2);

/// What is known of the gyro bias from rest: mean [rad/s] and variance.
pub(super) type GyroBias = (Vector3, f64);

/// Why the last search had no result.
#[derive(Clone, Copy, Debug, Default)]
enum Outcome {
    #[default]
    NoVelocity,
    TooFew,
    TooSteady,
    Ambiguous,
    Uncertain(f64),
    Misfit(f64),
}

/// The window and what became of the last search in it.
#[derive(Default)]
pub(super) struct Motion {
    /// Samples of the window, whole; the last one may reach beyond the last fix.
    samples: VecDeque<ImuSample>,
    fixes: VecDeque<GnssFix>,
    longest: f64,
    searched: Option<f64>,
    outcome: Outcome,
    /// Largest spread of velocities in a window [m/s].
    spread: f64,
}

/// A result: the filter at the last fix of the window.
pub(super) struct Found<const N: usize> {
    pub(super) filter: Filter<N>,
    /// Length of the window [s].
    pub(super) duration: f64,
}

impl Motion {
    pub(super) fn new(settings: &Settings) -> Self {
        let turn_on = bias_variances(&settings.sensors[..3], BIAS_FLOOR.0)
            .max()
            .sqrt();
        Self {
            longest: (BIAS_TURN / turn_on).clamp(SHORTEST, LONGEST),
            ..Self::default()
        }
    }

    /// Takes up a sample; once for each.
    pub(super) fn sample(&mut self, sample: &ImuSample) {
        if sample.dt > LONGEST_SAMPLE {
            self.samples.clear();
            self.fixes.clear();
            return;
        }
        self.samples.push_back(*sample);
        let start = sample.time - self.longest;
        while self.fixes.front().is_some_and(|fix| fix.time < start) {
            self.fixes.pop_front();
        }
        // Nothing before the first fix is of use.
        let start = self
            .fixes
            .front()
            .map_or(sample.time - sample.dt, |fix| fix.time);
        while self.samples.front().is_some_and(|s| s.time < start) {
            self.samples.pop_front();
        }
    }

    /// Takes a fix inside the last sample; the filter, if that makes an alignment.
    pub(super) fn fix<const N: usize>(
        &mut self,
        fix: &GnssFix,
        settings: &Settings,
        rest: Option<GyroBias>,
    ) -> Option<Found<N>> {
        if fix.position.is_none() || fix.velocity.is_none() || self.samples.is_empty() {
            return None;
        }
        self.fixes.push_back(*fix);
        if self.searched.is_some_and(|at| fix.time < at + EVERY) {
            return None;
        }
        self.searched = Some(fix.time);
        match self.search(settings, rest) {
            Ok(found) => Some(found),
            Err(outcome) => {
                self.outcome = outcome;
                None
            }
        }
    }

    fn search<const N: usize>(
        &mut self,
        settings: &Settings,
        rest: Option<GyroBias>,
    ) -> Result<Found<N>, Outcome> {
        let (low, high) = self.fixes.iter().filter_map(|fix| fix.velocity).fold(
            (
                Vector3::repeat(f64::INFINITY),
                Vector3::repeat(f64::NEG_INFINITY),
            ),
            |(low, high), (v, _)| (low.inf(&v), high.sup(&v)),
        );
        let spread = (high - low).xy().norm();
        self.spread = self.spread.max(spread);
        let segments = segments(self.samples.iter(), self.fixes.iter(), SPACING);
        if segments.len() < FEWEST {
            return Err(Outcome::TooFew);
        }
        if spread < SPREAD {
            return Err(Outcome::TooSteady);
        }
        let (gyro, accel) = settings.sensors.split_at(3);
        let gyro_prior = match rest {
            Some((mean, variance)) => (mean, Vector3::repeat(variance)),
            None => (Vector3::zeros(), bias_variances(gyro, BIAS_FLOOR.0)),
        };
        let first = self.fixes.front().ok_or(Outcome::TooFew)?;
        let problem = Problem {
            segments: &segments,
            place: super::antenna(first).ok_or(Outcome::TooFew)?,
            lever_arm: settings.lever_arm,
            gyro: gyro_prior,
            accel: (Vector3::zeros(), bias_variances(accel, BIAS_FLOOR.1)),
            gyro_noise: super::noise_of_mean(gyro, 1.0),
            accel_noise: super::noise_of_mean(accel, 1.0),
        };
        let solutions = problem.solve();
        let best = solutions.first().ok_or(Outcome::Ambiguous)?;
        // Noise larger than stated makes the residuals larger and the difference mean less.
        let scale = (best.cost / (3 * (segments.len() - 1)) as f64).max(1.0);
        if let Some(rival) = solutions.get(1)
            && rival.cost - best.cost < RIVAL * scale
        {
            return Err(Outcome::Ambiguous);
        }
        self.run(best, settings, rest)
    }

    /// The filter through the window from a solution.
    fn run<const N: usize>(
        &self,
        solution: &Solution,
        settings: &Settings,
        rest: Option<GyroBias>,
    ) -> Result<Found<N>, Outcome> {
        let mut fixes = self.fixes.iter();
        let (Some(first), Some(last)) = (fixes.next(), self.fixes.back()) else {
            return Err(Outcome::TooFew);
        };
        let failed = |_| Outcome::Misfit(f64::INFINITY);
        let mut filter = self
            .enter(first, &solution.guess, settings)
            .map_err(failed)?;
        if let Some((bias, variance)) = rest {
            let observed = filter.observe_earth_rate(&bias);
            filter
                .update_with(&observed, &(Matrix3::identity() * variance))
                .map_err(failed)?;
        }
        let middle = 0.5 * (first.time + last.time);
        let (mut nis, mut dof) = (0.0, 0);
        let mut next = fixes.next();
        for sample in &self.samples {
            // Of the first one the part after the first fix, with its mean rates.
            let dt = (sample.time - first.time).min(sample.dt);
            if dt <= STAMP_ROUNDING {
                continue;
            }
            let part = dt / sample.dt;
            filter.begin(&ImuSample {
                time: sample.time,
                dt,
                dtheta: sample.dtheta * part,
                dvel: sample.dvel * part,
            });
            while let Some(fix) = next.filter(|fix| fix.time <= sample.time + STAMP_ROUNDING) {
                filter.advance_to(fix.time, STAMP_ROUNDING);
                for update in updates(&mut filter, fix, settings) {
                    let update = update.map_err(failed)?;
                    if fix.time > middle {
                        nis += update.nis;
                        dof += update.dof;
                    }
                }
                next = fixes.next();
                if next.is_none() {
                    filter.check().map_err(failed)?;
                    return judge(filter, nis / dof.max(1) as f64, last.time - first.time);
                }
            }
            filter.advance(1.0);
        }
        Err(Outcome::TooFew)
    }

    /// The filter at the first fix.
    fn enter<const N: usize>(
        &self,
        fix: &GnssFix,
        guess: &Guess,
        settings: &Settings,
    ) -> Result<Filter<N>, undrift_nav::filter::FilterError> {
        let diverged = undrift_nav::filter::FilterError::Diverged;
        let antenna = super::antenna(fix).ok_or(diverged)?;
        let (Some((_, position)), Some((v_n, velocity))) = (fix.position, fix.velocity) else {
            return Err(diverged);
        };
        let rate = self
            .samples
            .front()
            .map_or(Vector3::zeros(), |s| s.dtheta / s.dt)
            - guess.gyro;
        let nav = NavState {
            time: fix.time,
            position: antenna.displaced(&-(guess.q_nb * settings.lever_arm)),
            v_n: v_n - guess.q_nb * rate.cross(&settings.lever_arm),
            q_nb: guess.q_nb,
        };
        let std = InitialStd {
            position: Vector3::repeat(1.0),
            velocity: Vector3::repeat(1.0),
            attitude: Vector3::repeat(ENTRY),
        };
        let mut filter = Filter::new(nav, &std, settings.sensors)?;
        filter.set_position_velocity_covariance(&position, &velocity);
        let (g, a) = (guess.gyro, guess.accel);
        filter.set_sensor_error(&[g.x, g.y, g.z, a.x, a.y, a.z]);
        Ok(filter)
    }

    /// Why there is no alignment, in words.
    pub(super) fn why_not(&self) -> String {
        match self.outcome {
            Outcome::NoVelocity | Outcome::TooFew if self.searched.is_none() => {
                "the fixes carry no velocity, which an alignment in motion needs".into()
            }
            Outcome::NoVelocity | Outcome::TooFew => {
                "there were never enough fixes with a velocity on end for an alignment in motion".into()
            }
            Outcome::TooSteady => format!(
                "the velocity changed by {:.1} m/s at most within {:.0} s, which says too little of the heading: \
                 an alignment in motion needs speeding up, braking or turning",
                self.spread, self.longest
            ),
            Outcome::Ambiguous => {
                "the velocity changes fit more than one attitude: an alignment in motion needs more speeding up, \
                 braking or turning"
                    .into()
            }
            Outcome::Uncertain(std) => format!(
                "the velocity changes give the attitude to {:.1} deg only: an alignment in motion needs more \
                 speeding up, braking or turning, or the noise model is too modest",
                std.to_degrees()
            ),
            Outcome::Misfit(nis) => format!(
                "samples and fixes do not fit together (normalised innovations squared {nis:.0}, 1 when the model \
                 is right): compare axes, units, time columns and standard deviations"
            ),
        }
    }
}

fn updates<const N: usize>(
    filter: &mut Filter<N>,
    fix: &GnssFix,
    settings: &Settings,
) -> Vec<Result<undrift_nav::filter::Update, undrift_nav::filter::FilterError>> {
    let mut made = Vec::with_capacity(2);
    if let Some((position, covariance)) = &fix.position
        && settings.gnss_use != GnssUse::Velocity
    {
        let observed = filter.observe_position(position, &settings.lever_arm);
        made.push(filter.update_with(&observed, covariance));
    }
    if let Some((v_n, covariance)) = &fix.velocity {
        let observed = filter.observe_velocity(v_n, &settings.lever_arm);
        made.push(filter.update_with(&observed, covariance));
    }
    made
}

/// Whether the filter at the end of the window is certain, and fits.
fn judge<const N: usize>(filter: Filter<N>, nis: f64, duration: f64) -> Result<Found<N>, Outcome> {
    let std = filter.nav_std();
    let worst = std[6].max(std[7]).max(std[8]);
    if nis > FIT {
        Err(Outcome::Misfit(nis))
    } else if worst > CERTAIN {
        Err(Outcome::Uncertain(worst))
    } else {
        Ok(Found { filter, duration })
    }
}

/// Variances of the biases before the first sample [unit²], no less than a floor [unit].
fn bias_variances(axes: &[ShapingFilter], floor: f64) -> Vector3 {
    Vector3::from_fn(|axis, _| {
        let filter = &axes[axis];
        let mut variance = floor * floor;
        for i in 0..filter.order {
            for j in 0..filter.order {
                variance += filter.h[i] * filter.p0[i][j] * filter.h[j];
            }
        }
        variance
    })
}
