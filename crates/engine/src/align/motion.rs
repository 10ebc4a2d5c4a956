//! Alignment in motion: attitude and biases from a bounded window of samples and fixes, by the fixes' velocities or, where
//! they have none, by their positions.
//!
//! A least-squares search over the window ([`super::wahba`]) finds attitude, velocity and biases at its end
//! with their covariance, which the filter takes over. An uncertain or ambiguous result waits for
//! more motion. Only the window is kept.

mod handover;

use super::{
    basis::{bias_variances, noise_of_mean},
    result::MotionFailure,
    segments::{Segment, moving, segments},
    sightings::{Sighting, held_late, least_spread, sightings, spread},
    wahba::{Guess, Problem},
};
use crate::{derived::antenna, estimator::Estimator, settings::Settings};
use alloc::collections::VecDeque;
use alloc::{boxed::Box, vec::Vec};
use handover::{delay, filter};
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_nav::{
    Vector3,
    mechanisation::NavState,
    parameters::Parameter,
    sample::{GnssFix, ImuSample},
};

/// The window is no longer than this \[s\].
const LONGEST: f64 = 60.0;
/// The window is no longer than a gyro bias of one standard deviation needs for this angle \[rad\].
const BIAS_TURN: f64 = 1.2;
/// The window may be this long whatever the gyro bias \[s\].
const SHORTEST: f64 = 20.0;
/// Fixes in the search are at least this far apart \[s\].
const SPACING: f64 = 0.45;
/// A sample longer than this ends the window \[s\].
const LONGEST_SAMPLE: f64 = 0.2;
/// Least time between two searches \[s\].
const EVERY: f64 = 1.0;
/// Least time between two searches, as a share of the window, while none has succeeded.
const PAUSE: f64 = 0.1;
/// Searches of the longest window that may find nothing before [`PAUSE`] grows.
const PATIENCE: usize = 5;
/// Factor by which it then grows each time: a log that nothing explains shall not take long to say so.
const GROWTH: f64 = 1.5;
/// Largest share of the window between two searches.
const LONGEST_PAUSE: f64 = 5.0;
/// Velocities needed for a search to be worth it.
const FEWEST: usize = 6;
/// A second minimum is out of the question when the best one's squared residuals are less by this much.
const RIVAL: f64 = 25.0;
/// Largest standard deviation of the attitude about any axis for a start at once \[rad\]: the filter, unlike the window,
/// cannot undo what it took from an attitude that was some degrees off.
const GOOD: f64 = 0.017;
/// After so long without a start \[s\] it may be larger …
const PATIENT: f64 = 20.0;
/// … by so much for each second more \[rad/s\] …
const LENIENT: f64 = 0.0009;
/// … up to 3 deg after a minute, and from four minutes on further \[s\]: windows that say little have wrong minima, too …
const PLATEAU: [f64; 2] = [60.0, 240.0];
/// … and never larger than this \[rad\].
const CERTAIN: f64 = 0.2;
/// Variances of positions in the search, times what their scatter shows: what fits nothing may fit positions whose errors
/// last for a second, or sensors that shake.
const LOOSER: [f64; 3] = [1.0, 10.0, 100.0];
/// Positions alone have to move for this long \[s\], faster than 0.5 m/s: a receiver's own filter holds them back for
/// seconds after a rest.
const LEAST_MOTION: f64 = 15.0;
/// Squared residuals for each degree of freedom, at most, where positions may be taken to be looser.
const CLOSE: f64 = 2.0;
/// A change of that time that matters no more \[s\].
const SAME_TIME: f64 = 0.01;
/// Searches about a time by which positions are late, at most.
const MOST_ROUNDS: usize = 6;
/// Accelerometer biases are no larger than this, in standard deviations of their prior: else motion and fixes do not belong
/// together.
const MOST_BIAS: f64 = 5.0;
/// These are at least this: a noise model may know no bias at all \[m/s²\].
const LEAST_BIAS: f64 = 0.2;
/// Squared residuals for each degree of freedom, at most.
const FIT: f64 = 10.0;
/// Standard deviation of unmodelled gyro bias \[rad/s\]: nothing is known exactly.
const GYRO_FLOOR: f64 = 1e-4;
/// Standard deviation of unmodelled accelerometer bias \[m/s²\].
const ACCEL_FLOOR: f64 = 1e-2;

/// What is known of the gyro bias from rest: mean [rad/s] and variance.
pub(super) type GyroBias = (Vector3, f64);

/// How long a window may be with a gyro bias of this variance \[rad²/s²\], \[s\].
///
/// A bias of σ turns a window of length T by σT: 1.2 rad are as much as a search can undo. Between
/// 20 and 60 s.
fn longest(variance: f64) -> f64 {
    (BIAS_TURN / variance.sqrt()).clamp(SHORTEST, LONGEST)
}

/// The window and the outcome of the searches in it.
#[derive(Clone, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct MotionAligner {
    /// Samples of the window, whole; the last one may reach beyond the last fix.
    samples: VecDeque<ImuSample>,
    fixes: VecDeque<GnssFix>,
    /// Length of the window while there is no solution \[s\].
    longest: f64,
    /// The solution so far, at the window's start; the window then grows from there to [`LONGEST`].
    solved: Option<Solved>,
    searched: Option<f64>,
    /// Time of the first fix of all \[s\].
    began: Option<f64>,
    /// Least time between two searches, as a share of the window, while none has succeeded; it grows where they keep failing.
    pause: f64,
    /// Searches of the whole window that found nothing.
    failed: usize,
    failure: MotionFailure,
    /// Largest spread of velocities in a window [m/s].
    spread: f64,
}

/// A solution that is not certain enough yet.
#[derive(Clone, Copy)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
struct Solved {
    guess: Guess,
    /// Delay of the fixes against their stamps \[s\].
    late: f64,
    /// The one of [`LOOSER`].
    looser: f64,
}

/// A result: the filter at the last fix of the window.
pub(super) struct AlignedInMotion {
    pub(super) filter: Box<dyn Estimator>,
    /// Length of the window \[s\].
    pub(super) duration: f64,
}

impl MotionAligner {
    pub(super) fn new(settings: &Settings) -> Self {
        let turn_on = bias_variances(&settings.sensors[..3], GYRO_FLOOR).max();
        Self {
            longest: longest(turn_on),
            pause: PAUSE,
            ..Self::default()
        }
    }

    /// Takes up a sample; once for each.
    pub(super) fn sample(&mut self, sample: &ImuSample) {
        if sample.dt > LONGEST_SAMPLE {
            self.samples.clear();
            self.fixes.clear();
            self.solved = None;
            return;
        }
        self.samples.push_back(*sample);
        let longest = match self.solved {
            // Its start must stay; it ends at the first fix beyond that.
            Some(_) => 2.0 * LONGEST,
            None => self.longest,
        };
        let start = sample.time - longest;
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
    pub(super) fn fix(
        &mut self,
        fix: &GnssFix,
        settings: &Settings,
        rest: Option<GyroBias>,
    ) -> Option<AlignedInMotion> {
        if fix.position.is_none() || self.samples.is_empty() {
            return None;
        }
        let alone = fix.velocity.is_none();
        if self
            .fixes
            .front()
            .is_some_and(|first| first.velocity.is_none() != alone)
        {
            if alone {
                // Between fixes that have a velocity.
                return None;
            }
            self.fixes.clear();
            self.solved = None;
        }
        self.began.get_or_insert(fix.time);
        if let Some((_, variance)) = rest {
            self.longest = longest(variance);
        }
        self.fixes.push_back(*fix);
        let window = self
            .fixes
            .front()
            .map_or(0.0, |first| fix.time - first.time);
        let pause = match self.solved {
            Some(_) => EVERY,
            None => EVERY.max(self.pause * window),
        };
        if self.searched.is_some_and(|at| fix.time < at + pause) {
            return None;
        }
        self.searched = Some(fix.time);
        let from = self.solved.map_or(0.0, |solved| solved.looser);
        let mut looser = LOOSER.into_iter().filter(|looser| *looser >= from);
        let found = looser.find_map(|looser| {
            let found = self.search(settings, rest, alone, looser);
            let misfit = matches!(found, Err(MotionFailure::Misfit(_)));
            let last = looser == LOOSER[2] || !alone;
            (last || !misfit).then_some(found)
        });
        match found.unwrap_or(Err(MotionFailure::TooFew)) {
            Ok(found) => Some(found),
            Err(failure) => {
                let nothing =
                    matches!(failure, MotionFailure::Ambiguous | MotionFailure::Misfit(_));
                if nothing && window + self.pause * window > self.longest {
                    self.failed += 1;
                    if self.failed > PATIENCE {
                        self.pause = (self.pause * GROWTH).min(LONGEST_PAUSE);
                    }
                }
                // The furthest that it ever came says most.
                if failure.stage() >= self.failure.stage() {
                    self.failure = failure;
                }
                None
            }
        }
    }

    /// Searches the window, whose fixes are positions `alone` or have velocities.
    fn search(
        &mut self,
        settings: &Settings,
        rest: Option<GyroBias>,
        alone: bool,
        looser: f64,
    ) -> Result<AlignedInMotion, MotionFailure> {
        let [first, last] = [self.fixes.front(), self.fixes.back()];
        let (first, last) = (
            *first.ok_or(MotionFailure::TooFew)?,
            *last.ok_or(MotionFailure::TooFew)?,
        );
        let place = antenna(&first).ok_or(MotionFailure::TooFew)?;
        let solved = self.solved;
        let mut late = solved.map_or(0.0, |solved| solved.late);
        let stamped = sightings(&self.fixes, alone, looser);
        let held = |late: f64| match alone {
            true => held_late(&stamped, late, last.time),
            false => stamped.clone(),
        };
        let mut seen = held(late);
        let spread = spread(&seen);
        self.spread = self.spread.max(spread);
        let (gyro, accel) = settings.sensors.split_at(3);
        let gyro_prior = match rest {
            Some((mean, variance)) => (mean, Vector3::repeat(variance)),
            None => (Vector3::zeros(), bias_variances(gyro, GYRO_FLOOR)),
        };
        let segments = self.segments(&seen, &gyro_prior.0);
        if segments.len() < FEWEST {
            return Err(MotionFailure::TooFew);
        }
        if spread < least_spread(&seen, alone) {
            return Err(MotionFailure::TooSteady {
                change: self.spread,
                within: self.longest,
            });
        }
        if alone && moving(&segments) < LEAST_MOTION {
            return Err(MotionFailure::Ambiguous);
        }
        self.solved = None;
        let variance_of = |kind: Parameter| {
            let prior = settings.parameters.prior(kind);
            prior.map_or(0.0, |prior| prior.std * prior.std)
        };
        let delay = delay(settings, alone);
        let lateness = delay.map_or(0.0, |(_, std)| std * std);
        let problem = Problem {
            segments: &segments,
            reference: gyro_prior.0,
            place,
            lever_arm: settings.lever_arm,
            gyro: gyro_prior,
            accel: (Vector3::zeros(), bias_variances(accel, ACCEL_FLOOR)),
            gyro_noise: noise_of_mean(gyro, 1.0),
            accel_noise: noise_of_mean(accel, 1.0),
            by_position: alone,
            late: (-late, lateness),
            arm: variance_of(Parameter::LeverArm),
        };
        // Noise larger than stated makes residuals and covariance larger, and a difference mean less.
        let fit = |cost: f64| (cost / (3 * (segments.len() - 1)) as f64).max(1.0);
        let mut guess = match solved {
            Some(solved) => solved.guess,
            None => {
                let solutions = problem.solve();
                let best = solutions.first().ok_or(MotionFailure::Ambiguous)?;
                let rival = solutions.get(1).map_or(f64::INFINITY, |rival| rival.cost);
                if rival - best.cost < RIVAL * fit(best.cost) {
                    return Err(MotionFailure::Ambiguous);
                }
                best.guess
            }
        };
        // Once more about the bias found, in which a segment is linear, and about the time by which fixes are late, in
        // which their positions are not.
        let mut rounds = MOST_ROUNDS;
        let (end, fit) = loop {
            let again = self.segments(&seen, &guess.gyro);
            if again.len() < FEWEST {
                return Err(MotionFailure::TooFew);
            }
            let problem = Problem {
                segments: &again,
                reference: guess.gyro,
                late: (-late, lateness),
                ..problem
            };
            let solution = problem.refine(&guess);
            guess = solution.guess;
            let end = problem.end(&guess).ok_or(MotionFailure::Ambiguous)?;
            rounds -= 1;
            // Where velocities are late they are so by a line: the window stays where it is.
            if rounds == 0 || !alone || end.late.abs() < SAME_TIME {
                break (end, fit(solution.cost));
            }
            late += end.late;
            seen = held(late);
        };
        let (mean, variance) = &problem.accel;
        let std = variance.map(|variance| variance.sqrt().max(LEAST_BIAS));
        let bias = (guess.accel - mean).component_div(&std);
        let most = if alone && looser < LOOSER[2] {
            CLOSE
        } else {
            FIT
        };
        if fit > most || alone && bias.amax() > MOST_BIAS {
            return Err(MotionFailure::Misfit(fit));
        }
        let c_nb = end.q_nb.to_rotation_matrix().into_inner();
        let attitude = end.covariance.fixed_view::<3, 3>(3, 3) * fit;
        let worst = (c_nb * attitude * c_nb.transpose()).diagonal().max().sqrt();
        let waited = last.time - self.began.unwrap_or(last.time);
        let grows = last.time - first.time < LONGEST;
        let (enough, certain) = certainty(waited, alone, grows);
        // A number that is not one is not certain either.
        if worst.is_nan() || worst > certain {
            return Err(MotionFailure::Uncertain(worst));
        }
        if worst > enough {
            if grows {
                self.solved = Some(Solved {
                    guess,
                    late,
                    looser,
                });
            }
            return Err(MotionFailure::Settling(worst));
        }
        let position = match end.place {
            Some(moved) => place.displaced(&moved),
            None => antenna(&last)
                .ok_or(MotionFailure::TooFew)?
                .displaced(&-(end.q_nb * settings.lever_arm)),
        };
        let nav = NavState {
            time: last.time,
            position,
            v_n: end.v_n,
            q_nb: end.q_nb,
        };
        let late = delay.map(|(kind, std)| (kind, late + end.late, std));
        let filter = filter(&nav, late, &last, &guess, &(end.covariance * fit), settings)
            .ok_or(MotionFailure::Misfit(fit))?;
        Ok(AlignedInMotion {
            filter,
            duration: last.time - first.time,
        })
    }

    /// Motion of the window between the fixes of a search, linear about the gyro bias `gyro` [rad/s].
    fn segments(&self, seen: &[Sighting], gyro: &Vector3) -> Vec<Segment> {
        segments(self.samples.iter(), seen.iter(), SPACING, gyro)
    }

    /// Why there is no alignment.
    pub(super) fn failure(&self) -> MotionFailure {
        match self.failure {
            MotionFailure::TooSteady { within, .. } => MotionFailure::TooSteady {
                change: self.spread,
                within,
            },
            other => other,
        }
    }
}

/// Standard deviation of the attitude \[rad\] that is enough for a start, and beyond which a solution is dropped, after so
/// long \[s\] without a start; of a window of positions `alone` or of velocities, which still `grows` or not.
fn certainty(waited: f64, alone: bool, grows: bool) -> (f64, f64) {
    let lenient = |waited: f64| (GOOD + LENIENT * (waited - PATIENT).max(0.0)).min(CERTAIN);
    let [from, to] = PLATEAU;
    let by_now = lenient(waited.min(from) + (waited - to).max(0.0));
    // Velocities become certain soon: their window is waited for.
    let settled = by_now.max(lenient(from));
    match (alone, grows) {
        (true, _) => (by_now, CERTAIN),
        (false, true) => (GOOD, settled),
        (false, false) => (settled, settled),
    }
}

#[cfg(test)]
mod tests;
