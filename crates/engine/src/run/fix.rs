//! What a fix does to the navigator: it aligns, is studied, corrects the solution, or is judged.
//!
//! What is done with a fix, in this order: what its quality usually means replaces its covariances; a vertical
//! velocity that nobody measured is left open; the fixes' own errors are studied and applied; an outage
//! withholds it; an alignment that goes on sees it; the solution is moved to the time at which it holds;
//! [`crate::receiver`] judges its position and velocity, [`super::pose`] its attitude; the watches see the
//! innovations; and what they found may start another alignment.
//!
//! A fix with a latency of its own for the velocity comes twice, position and velocity each at its time: what
//! counts fixes counts the first of the two.
//!
//! Times: `fix.time` is the stamp, `due` the time at which the fix holds, stamp plus estimated
//! latency. The filter is at `due`, or later where the latency has shrunk since; [`crate::aid`]
//! takes that span back from the prediction.
//!
//! | happens to the fix | counted in the summary as |
//! |---|---|
//! | no solution yet, or before its start | `fixes_before` |
//! | in an outage of the settings | `withheld` |
//! | covariance not positive definite, not finite | `bad_fixes` |
//! | accepted, with full or less weight | `fixes` |
//! | rejected by a gate | innovations' `rejected` |

use super::{
    Run, pose,
    progress::{begins, carries_velocity, part},
};
use crate::{
    align::Aligned, course::CourseWatch, estimator::STAMP_ROUNDING, forward::ForwardWatch,
    observer::Observer, receiver::Held, settings::GnssUse, solution::Solution, watch::Streak,
};
use alloc::sync::Arc;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_events::{HeadingSource, Part, Restart, RestartCause};
use undrift_nav::{
    filter::{FilterError, Outcome, Update},
    sample::{GnssFix, ImuSample, Scalar},
};

/// A heading that motion shows confirms one within so many standard deviations of both, and any within this \[rad\].
const CONFIRMS: f64 = 3.0;
const SAME_HEADING: f64 = 0.1;
/// A solution by poses begins with degrees of doubt about its attitude and the marker's, metres per second about its velocity, and
/// poses of millimetres contradict what is linear in them for so long \[s\]: a pose that is rejected then is the first of many.
const SETTLES: f64 = 10.0;

impl Run {
    /// Shows the aligner a fix, which is moved to `due` before; what it finds with it.
    ///
    /// Only fixes that agree with the one before ([`crate::receiver::Receiver::is_consistent`]) serve, and velocities only where the
    /// settings use them.
    ///
    /// # Errors
    /// The filter of a complete alignment cannot be built.
    fn find_start(
        &mut self,
        fix: &GnssFix,
        sample: &ImuSample,
    ) -> Result<Option<Aligned>, FilterError> {
        let aligner = &mut self.alignment.aligner;
        aligner.advance(sample, fix.time);
        if self.settings.gating && !self.receiver.is_consistent(fix) {
            return Ok(None);
        }
        let mut seen = *fix;
        if self.settings.gnss_use == GnssUse::Position {
            seen.velocity = None;
        }
        aligner.fix(&seen, &self.settings)
    }

    /// Whether the heading with which the solution began, by a magnetometer, is that which motion has shown now.
    fn is_confirmed_by(&self, found: &Aligned) -> bool {
        self.solution.as_ref().is_some_and(|solution| {
            let [own, other] = [&solution.filter, &found.filter];
            let turn = own.nav().q_nb * other.nav().q_nb.inverse();
            let std = own.nav_std()[8].hypot(other.nav_std()[8]);
            turn.scaled_axis().z.abs() < SAME_HEADING.max(CONFIRMS * std)
        })
    }

    /// Shows the aligner a fix; whether it completes the alignment and navigation begins.
    ///
    /// What comes of a second alignment replaces the solution that failed; the receiver keeps what it has
    /// learned of its accuracy, the other watches are reset.
    ///
    /// # Errors
    /// The filter of a complete alignment cannot be built.
    ///
    /// On success the watches begin again and the rest of the sample is taken up by the new filter.
    fn align(
        &mut self,
        fix: &GnssFix,
        sample: &ImuSample,
        observer: &mut dyn Observer,
    ) -> Result<bool, FilterError> {
        let Some(mut aligned) = self.find_start(fix, sample)? else {
            return Ok(false);
        };
        if self.alignment.checks {
            self.alignment.checks = false;
            if self.is_confirmed_by(&aligned) {
                return Ok(false);
            }
            self.summary.restarts.push(Restart {
                time: fix.time,
                why: RestartCause::WrongHeading,
                resumed: None,
            });
        }
        match self.summary.restarts.last_mut() {
            Some(restart) => {
                restart.resumed = Some(fix.time);
                let failed = match restart.why {
                    RestartCause::LargeInnovations => !self.streak.was_sound(),
                    why => why == RestartCause::WrongHeading,
                };
                if failed {
                    self.summary.forget_failed_start();
                }
            }
            None => {
                self.summary.started = Some(fix.time);
                self.summary.alignment = Some(aligned.how);
                if let Some(start) = &self.settings.start {
                    aligned.filter.apply_correction(start);
                }
            }
        }
        if !self.settings.earth_rate {
            aligned.filter.without_earth_rate();
        }
        self.alignment.again = false;
        self.log.shown(fix.time, true);
        observer.used(fix.time);
        self.streak = Streak::default();
        self.receiver.forget_solution(fix.time, &mut self.summary);
        self.course = CourseWatch::new();
        self.forward = ForwardWatch::default();
        let by = |source| aligned.how.source.is_by(source);
        self.headings
            .restart(fix.time, by(HeadingSource::Antennas), &mut self.summary);
        let by_field = by(HeadingSource::Magnetometer);
        self.compass.restart(by_field, &mut self.summary);
        self.alignment.checks = by_field && self.settings.gating && self.settings.restart;
        if by_field {
            self.alignment.aligner.without_field();
        }
        let mut filter = aligned.filter;
        filter.set_mounting_std(&self.mounting_std());
        let solution = self.solution.insert(Solution::new(filter));
        if let Some(vibration) = &self.vibration {
            solution.filter.set_white_noise(&vibration.variances());
        }
        if let Some(log) = &self.settings.log {
            solution.filter.log_to(log.clone());
        }
        solution.node(self.settings.nodes, observer);
        // The rest of this sample's interval.
        let rest = sample.time - fix.time;
        if rest > STAMP_ROUNDING {
            self.begin(&part(sample, rest));
        }
        Ok(true)
    }

    /// A heading by two antennas within the present sample: an outage withholds it as it does a fix.
    pub(super) fn heading(&mut self, measured: &Scalar, sample: &ImuSample) {
        let outages = &self.settings.outages;
        if outages.iter().any(|o| o.contains(measured.time)) {
            return;
        }
        // It holds as late as a position.
        let time = measured.time + self.latency().position;
        let measured = &Scalar { time, ..*measured };
        if self.solution.is_none() || self.alignment.again {
            let aligner = &mut self.alignment.aligner;
            aligner.antennas(measured, sample, &self.settings);
        }
        if let Some(solution) = &mut self.solution
            && !solution.in_long_gap()
        {
            solution.advance_to(time);
            let baseline = self.settings.constraints.heading_baseline;
            let filter = &mut *solution.filter;
            self.headings
                .update(filter, measured, baseline, &mut self.summary);
        }
    }

    /// What the fixes show of themselves, where it is time to look: the filter follows it from now on.
    ///
    /// States for errors that last may be added to the filter or removed from it; all that the others know stays.
    ///
    /// The change of the filter's size keeps all other estimates; the standard deviations of the
    /// new states are those of the fix at hand.
    ///
    /// # Errors
    /// The filter with these states cannot be built.
    fn study(&mut self, fix: &GnssFix) -> Result<(), FilterError> {
        let Some(study) = self.fixes.as_mut().and_then(|fixes| fixes.next(fix)) else {
            return Ok(());
        };
        let stated = self.settings.from_fixes.unwrap_or_default();
        let errors = study.errors(&stated, &self.settings.parameters);
        let before = self.settings.fix_errors;
        if errors == before {
            return Ok(());
        }
        self.summary.fix_errors.push((fix.time, errors));
        let settings = Arc::make_mut(&mut self.settings);
        settings.fix_errors = errors;
        settings.parameters = errors.with_states(settings.parameters);
        if let (Some(solution), Some((_, covariance))) =
            (&mut self.solution, errors.apply(fix).position)
        {
            let lasting = errors.lasting(&before, &covariance);
            solution.filter = solution.filter.with_lasting(&lasting)?;
        }
        Ok(())
    }

    /// A fix within the present sample, or a part of it.
    ///
    /// `part` is `None` for a whole fix; a fix with two latencies comes as position and as
    /// velocity. Without gating (`settings.gating` false) nothing is rejected and nothing realigns:
    /// for fixes that are known to be right.
    ///
    /// # Errors
    /// [`FilterError`] of a filter that cannot be built after an alignment or a study. Refused
    /// measurements are counted, not returned.
    pub(super) fn fix(
        &mut self,
        fix: &GnssFix,
        part: Option<Part>,
        sample: &ImuSample,
        observer: &mut dyn Observer,
    ) -> Result<(), FilterError> {
        let withheld = self.settings.outages.iter().any(|o| o.contains(fix.time));
        if fix.mean_velocity.is_some() && fix.position.is_none() && fix.velocity.is_none() {
            self.few_satellites(fix, withheld, observer);
            return Ok(());
        }
        let begins = begins(fix, part);
        let fix = self.settings.quality.apply(fix);
        let fix = &self.vertical.judge(fix, begins, &mut self.summary);
        if begins && !withheld {
            self.receiver.stamp(fix.time);
            self.study(fix)?;
        }
        let settings = Arc::clone(&self.settings);
        let fix = &settings.fix_errors.apply(fix);
        if self.solution.is_none() && withheld {
            self.summary.withheld += u64::from(begins);
            return Ok(());
        }
        let latency = self.latency();
        let due = fix.time
            + match part {
                Some(Part::Velocity) => latency.velocity.unwrap_or(latency.position),
                _ => latency.position,
            };
        if self.aligns() && begins && !withheld {
            // A solution before this one says when it holds: within this sample.
            let held = GnssFix { time: due, ..*fix };
            if self.align(&held, sample, observer)? {
                return Ok(());
            }
        }
        let Some(solution) = &mut self.solution else {
            self.summary.fixes_before += u64::from(begins);
            return Ok(());
        };
        if due < solution.began - STAMP_ROUNDING {
            // Of a time before the start, in which an alignment had it already.
            self.summary.fixes_before += u64::from(begins);
            return Ok(());
        }
        solution.advance_to(due);
        if !withheld {
            solution.grow_to(due);
            if settings.gating {
                solution.grow_by_products(due, settings.accel_scale_error);
            }
        }
        if begins {
            observer.fix(&*solution.filter, fix, withheld);
        }
        if withheld {
            self.summary.withheld += u64::from(begins);
            // An outage is no fault of the receiver's.
            self.log.shown(fix.time, carries_velocity(fix, part));
            solution.node(self.settings.nodes, observer);
            return Ok(());
        }
        let mean = fix.mean_velocity.as_ref();
        let stretch = mean.and_then(|mean| solution.stretch(mean.over, due));
        let filter = &mut *solution.filter;
        // Its own velocity would be late by another delay.
        let apart = mean.is_some() && stretch.is_none() && latency.velocity.is_some();
        let part = if apart { Some(Part::Position) } else { part };
        let settling = fix.attitude.is_some() && due - solution.began < SETTLES;
        let held = Held {
            part,
            due,
            stretch,
            settling,
        };
        let updates = self
            .receiver
            .update(filter, fix, &held, &self.settings, &mut self.summary);
        if begins {
            // One that the filter refuses is a bad fix as well.
            let attitude = pose::update(filter, fix, due, settling, &settings, &mut self.summary);
            let failed = attitude.is_some_and(|update| update.is_err());
            self.summary.bad_fixes += u64::from(failed);
        }
        if carries_velocity(fix, part) {
            self.vehicle.fix(filter, fix, &self.settings);
            self.forward.fix(filter);
            let confirmed = self.compass.agrees(fix.time);
            if self.settings.gating && !self.receiver.repeats() && !confirmed {
                self.course.fix(filter, fix, &mut self.summary);
            }
        }
        let done = updates.each_ref();
        observer.updated(fix.time, done.map(|u| u.as_ref()?.as_ref().ok().copied()));
        // A solution that only a fix would throw off the Earth has nothing in common with the fixes any more.
        let off = |update: &Result<Update, FilterError>| *update == Err(FilterError::Implausible);
        if updates[0].is_some() {
            self.summary.late_samples.note(filter);
        }
        let diverged = filter.check().is_err() || updates.iter().flatten().any(off);
        self.note_updates(fix, part, updates, observer);
        if diverged {
            self.give_up(fix.time);
        } else if self.settings.gating && self.settings.restart {
            if self.streak.is_sick(fix.time, self.summary.restarts.len()) {
                self.align_again(fix.time, RestartCause::LargeInnovations);
            } else if self.receiver.is_hopeless(fix.time) {
                self.align_again(fix.time, RestartCause::RejectedThenAccepted);
            }
        }
        if let Some(solution) = &mut self.solution {
            solution.updated(begins);
            solution.node(self.settings.nodes, observer);
        }
        Ok(())
    }

    /// Notes whether a fix was used, weakened or rejected.
    /// A measurement that would move the solution off the Earth counts as neither; one whose covariance is no
    /// covariance counts as bad.
    ///
    /// A used fix ends an outage: the summary notes the span without GNSS before it.
    fn note_updates(
        &mut self,
        fix: &GnssFix,
        part: Option<Part>,
        updates: [Option<Result<Update, FilterError>>; 2],
        observer: &mut dyn Observer,
    ) {
        let time = fix.time;
        let mut used = false;
        for update in updates.into_iter().flatten() {
            match update {
                Ok(update) if update.outcome == Outcome::Rejected => {}
                Ok(update) => {
                    used = true;
                    self.streak.watch(update, time, &mut self.summary);
                }
                Err(FilterError::Implausible) => {}
                Err(_) => self.summary.bad_fixes += 1,
            }
        }
        if used {
            self.summary.fixes += u64::from(begins(fix, part));
            observer.used(time);
            if let Some(last) = self.log.shown(time, carries_velocity(fix, part)) {
                self.summary.without_gnss(last, time);
            }
        }
    }
}
