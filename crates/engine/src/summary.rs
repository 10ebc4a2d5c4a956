//! Counts, alignment, innovations, estimated parameters and faults of a run.

use super::{
    CovarianceHealth,
    events::{Contradiction, Event, HeadingOff, Implausible, Lean, Restart, SampleFault},
};
#[cfg(feature = "checkpoint")]
use crate::aid::Aid;
use crate::{
    aid::ByAid,
    align::Alignment,
    estimator::Estimator,
    fixes::FixStudy,
    mounting::{Mounting, MountingError},
    settings::{Doubt, fix_errors::FixErrors},
    windows::Windows,
};
use alloc::vec::Vec;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_nav::{
    Vector3,
    covariance::AXES,
    filter::{Outcome, Update},
    parameters::Parameter,
};

/// Sums of the normalised innovations squared of one kind of measurement.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(default))]
pub struct Innovations {
    /// Updates made.
    pub updates: u64,
    /// Sum of NIS over them.
    pub nis_sum: f64,
    /// Sum of their degrees of freedom: what `nis_sum` is on average when the model is right.
    pub dof_sum: u64,
    /// Measurements used with less weight than stated.
    pub weakened: u64,
    /// Measurements rejected.
    pub rejected: u64,
    /// Sums of the products of whitened innovations with those of the update before, of the squares,
    /// and their number: for their autocorrelation.
    lagged: (f64, f64, u64),
    /// Whitened innovation of the last update, if it was used.
    #[cfg_attr(feature = "serde", serde(skip))]
    last: Option<[f64; 3]>,
}

impl Innovations {
    /// Adds what an update did.
    pub fn add(&mut self, update: Update) {
        match update.outcome {
            Outcome::Rejected => {
                self.rejected += 1;
                self.last = None;
                return;
            }
            Outcome::Weakened(_) => self.weakened += 1,
            Outcome::Used => {}
        }
        self.updates += 1;
        self.nis_sum += update.nis;
        self.dof_sum += update.dof as u64;
        if let Some(last) = self.last {
            for (now, before) in update.whitened.iter().zip(last) {
                self.lagged.0 += now * before;
                self.lagged.1 += 0.5 * (now * now + before * before);
            }
            self.lagged.2 += update.dof as u64;
        }
        self.last = Some(update.whitened);
    }

    /// NIS per degree of freedom: 1 if the model is correct. `None` without updates.
    pub fn per_dof(&self) -> Option<f64> {
        (self.dof_sum > 0).then(|| self.nis_sum / self.dof_sum as f64)
    }

    /// Autocorrelation of the whitened innovations from one update to the next, and what it stays
    /// below 19 times out of 20 when the model is right: `1.96/√n`.
    pub fn autocorrelation(&self) -> Option<(f64, f64)> {
        let (products, squares, n) = self.lagged;
        (n > 0 && squares > 0.0).then(|| (products / squares, 1.96 / (n as f64).sqrt()))
    }
}

/// Standard deviations from which a difference between the clocks is not by chance, and matters to the position.
const SIGMAS: f64 = 3.0;

/// Where the samples turn out to be late ([`ReceiverClock::lateness`](crate::estimator::ReceiverClock::lateness)), and that
/// matters.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct LateSamples {
    /// Positions used.
    pub positions: u64,
    /// Those at which the solution was behind the receiver's clock by more than three standard deviations of its position.
    pub behind: u64,
    /// The furthest that it was behind at one of them \[m\].
    pub most: f64,
    /// The time by which the samples were late there, negative if early, and its standard deviation \[s\].
    pub delay: (f64, f64),
}

impl LateSamples {
    /// Of the filter after a position.
    pub(super) fn note(&mut self, filter: &dyn Estimator) {
        self.positions += 1;
        let Some(clock) = filter.receiver_clock() else {
            return;
        };
        let (speed, std) = (filter.nav().v_n.xy().norm(), filter.nav_std());
        let behind = clock.offset.abs() * speed;
        let is_sure = clock.offset.abs() > SIGMAS * clock.offset_std;
        if is_sure && clock.lateness() != 0.0 && behind > SIGMAS * std[0].max(std[1]) {
            self.behind += 1;
            if behind > self.most {
                (self.most, self.delay) = (behind, (clock.offset, clock.offset_std));
            }
        }
    }
}

/// What a replay was like.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct Summary {
    /// Samples processed after alignment.
    pub samples: u64,
    /// Samples used up by alignment.
    pub align_samples: u64,
    /// When navigation began \[s\].
    pub started: Option<f64>,
    /// How the first attitude was found, where navigation began.
    pub alignment: Option<Alignment>,
    /// Time of the last sample \[s\].
    pub ended: f64,
    /// Fixes used.
    pub fixes: u64,
    /// Fixes withheld by outages.
    pub withheld: u64,
    /// Fixes before the first sample or before alignment could use them.
    pub fixes_before: u64,
    /// Fixes that could not be used because their covariance is not one.
    pub bad_fixes: u64,
    /// Fixes that repeat the previous one, held by the logger: not used.
    pub repeated: u64,
    /// From when on \[s\] the vertical velocities, which were all 0, were taken as not measured.
    pub no_vertical_velocity: Option<f64>,
    /// Updates by kind of measurement.
    pub innovations: ByAid<Innovations>,
    /// How well solution and fixes agree, window by window.
    pub windows: Windows,
    /// Parameters estimated: their last values and standard deviations, in the units of [`Parameter`].
    pub parameters: Vec<(Parameter, Vec<f64>, Vec<f64>)>,
    /// Fixes that were rejected, run by run; the first [`MOST_EVENTS`].
    pub contradictions: Vec<Contradiction>,
    /// Runs of rejected fixes beyond those.
    pub more_contradictions: u64,
    /// Spans in which innovations leaned to one side; the first [`MOST_EVENTS`].
    pub leans: Vec<Lean>,
    /// Samples that could not be right and were replaced; the first [`MOST_EVENTS`] runs of them.
    pub sample_faults: Vec<SampleFault>,
    /// When and why the solution was aligned again.
    pub restarts: Vec<Restart>,
    /// Where the samples turn out to be later than their stamps.
    pub late_samples: LateSamples,
    /// Mean factors on the stated standard deviations of position and velocity, where they were adapted.
    pub adapted: [Option<f64>; 2],
    /// How many times the model's the white noise of each axis was, as the samples show; `None` where it was the model's.
    pub louder: Option<[f64; AXES]>,
    /// Regression of the innovations of velocity on the measured velocity, component by component:
    /// sums of products and of squares.
    pub(super) against_velocity: [(f64, f64); 3],
    /// Components of the velocity, 0 to 2 for north, east, down, that seem to have the wrong sign.
    pub wrong_signs: Vec<usize>,
    /// Short gaps in the samples that were bridged by interpolation.
    pub bridged: u64,
    /// Gaps too long for that: their number, the first one's time \[s\], the longest \[s\]. The covariance was
    /// grown over each of up to a minute; a longer one ended the solution, and is among `restarts`.
    pub long_gaps: Option<(u64, f64, f64)>,
    /// Longest span without a fix, outages aside: start and length \[s\].
    pub longest_without_gnss: (f64, f64),
    /// Units, axes, signs or times that cannot be right.
    pub implausible: Vec<Implausible>,
    /// Where the solution accepted fixes that contradict its velocity or both of its parts; the first
    /// [`MOST_EVENTS`].
    pub doubts: Vec<Doubt>,
    /// Parameters that ended far from what was known of them: estimate, and prior standard deviations that it is off.
    pub far: Vec<(Parameter, f64, f64)>,
    /// Where the course has contradicted the heading; the first [`MOST_EVENTS`].
    pub heading_off: Vec<HeadingOff>,
    /// What all of the fixes show of themselves; at the end, where they are looked at.
    pub study: Option<FixStudy>,
    /// From when on \[s\] the filter has taken them to be wrong by what; each time it changed.
    pub fix_errors: Vec<(f64, FixErrors)>,
    /// After when \[s\] body axes are the vehicle's, where the mounting was to be found on the way; each time it changed.
    pub mountings: Vec<(f64, Mounting)>,
    /// Why it was not found until the end.
    pub no_mounting: Option<MountingError>,
    /// When the solution diverged, if it did and was not re-initialised \[s\].
    pub diverged: Option<f64>,
    /// The covariance at the end, if there is a solution.
    pub covariance: Option<CovarianceHealth>,
    /// Start of the first twenty updates in a row, or fewer at the end of the log, whose innovations were far beyond
    /// their predicted size \[s\].
    pub suspect: Option<f64>,
}

/// Events of a kind that are kept one by one.
pub const MOST_EVENTS: usize = 1000;

/// A component of the velocity has the wrong sign where its innovations are this part of it, on the average: −2 if the
/// solution ignores it, closer to 0 the more it follows.
const WRONG_SIGN: f64 = -0.6;
/// Sum of the squares of the component that is enough to judge by \[m²/s²\].
const SIGN_MOTION: f64 = 5.0;

impl Summary {
    /// What happened so far, each kind in order of time.
    pub fn events(&self) -> impl Iterator<Item = Event> + '_ {
        let started = self.started.zip(self.alignment);
        let resumed = self.restarts.iter().filter_map(|restart| restart.resumed);
        let started = started
            .into_iter()
            .map(|(time, how)| Event::Started(time, how));
        started
            .chain(self.sample_faults.iter().copied().map(Event::SampleFault))
            .chain(self.contradictions.iter().copied().map(Event::Rejected))
            .chain(self.doubts.iter().copied().map(Event::Doubted))
            .chain(self.heading_off.iter().copied().map(Event::HeadingOff))
            .chain(self.leans.iter().copied().map(Event::Leant))
            .chain(
                self.restarts
                    .iter()
                    .map(|r| Event::AlignsAgain(r.time, r.why)),
            )
            .chain(resumed.map(Event::Resumed))
            .chain(
                self.fix_errors
                    .iter()
                    .map(|(time, errors)| Event::FixErrors(*time, *errors)),
            )
            .chain(
                self.mountings
                    .iter()
                    .map(|(time, mounting)| Event::Mounting(*time, *mounting)),
            )
            .chain(self.diverged.map(Event::Diverged))
    }

    /// The last innovations of each kind of measurement, which are not among what is shown of them.
    #[cfg(feature = "checkpoint")]
    pub(super) fn last_innovations(&self) -> [Option<[f64; 3]>; Aid::COUNT] {
        self.innovations.0.map(|kind| kind.last)
    }

    /// Puts them in place.
    #[cfg(feature = "checkpoint")]
    pub(super) fn set_last_innovations(&mut self, last: [Option<[f64; 3]>; Aid::COUNT]) {
        for (kind, last) in self.innovations.0.iter_mut().zip(last) {
            kind.last = last;
        }
    }

    /// Judges the signs of the velocity, at the end of the log.
    pub(super) fn judge_signs(&mut self) {
        let wrong = |i: &usize| {
            let (products, squares) = self.against_velocity[*i];
            squares > SIGN_MOTION && products < WRONG_SIGN * squares
        };
        self.wrong_signs = (0..3).filter(wrong).collect();
    }

    /// Notes a gap of `length` \[s\] too long to interpolate over.
    pub(super) fn long_gap(&mut self, start: f64, length: f64) {
        let (count, first, longest) = self.long_gaps.unwrap_or((0, start, 0.0));
        self.long_gaps = Some((count + 1, first, longest.max(length)));
    }

    /// Notes a sample replaced between its neighbours.
    pub(super) fn spike(&mut self, axis: usize, time: f64) {
        if self.sample_faults.len() < MOST_EVENTS {
            self.sample_faults.push(SampleFault {
                axis,
                start: time,
                end: time,
                stuck: false,
            });
        }
    }

    /// Notes that an axis has been stuck from `since` to `time` \[s\].
    pub(super) fn stuck(&mut self, axis: usize, since: f64, time: f64) {
        let room = self.sample_faults.len() < MOST_EVENTS;
        let same = |fault: &&mut SampleFault| fault.stuck && fault.axis == axis;
        match self.sample_faults.iter_mut().rev().find(same) {
            Some(last) if last.start == since => last.end = time,
            _ if room => self.sample_faults.push(SampleFault {
                axis,
                start: since,
                end: time,
                stuck: true,
            }),
            _ => {}
        }
    }

    /// Notes a heading that the course contradicts, for the first time or still.
    pub(super) fn heading_off(&mut self, time: f64, angle: f64, goes_on: bool) {
        let room = self.heading_off.len() < MOST_EVENTS;
        match self.heading_off.last_mut() {
            Some(last) if goes_on => {
                last.end = time;
                if angle.abs() > last.angle.abs() {
                    last.angle = angle;
                }
            }
            _ if room => self.heading_off.push(HeadingOff {
                start: time,
                end: time,
                angle,
            }),
            _ => {}
        }
    }

    /// Notes a span without a fix.
    pub(super) fn without_gnss(&mut self, from: f64, to: f64) {
        if to - from > self.longest_without_gnss.1 {
            self.longest_without_gnss = (from, to - from);
        }
    }

    /// Takes in the innovation (predicted less measured) of a measured velocity and the variances of its
    /// noise, which is in both and would correlate them at rest.
    pub(super) fn regress(&mut self, innovation: &Vector3, measured: &Vector3, noise: &Vector3) {
        for (i, sums) in self.against_velocity.iter_mut().enumerate() {
            sums.0 += innovation[i] * measured[i] + noise[i];
            sums.1 += measured[i] * measured[i] - noise[i];
        }
    }

    /// Notes a run of rejected fixes; where the solution has accepted others of the kind less than `goes_on` \[s\]
    /// before, it is the same one that goes on.
    pub(super) fn contradicted(&mut self, what: Contradiction, goes_on: f64) {
        let same = |c: &&mut Contradiction| (c.part, c.height) == (what.part, what.height);
        if let Some(last) = self.contradictions.iter_mut().rev().find(same)
            && last.accepted_in_the_end
            && what.start - last.end < goes_on
        {
            last.end = what.end;
            last.fixes += what.fixes;
            last.largest = last.largest.max(what.largest);
            return;
        }
        if self.contradictions.len() < MOST_EVENTS {
            self.contradictions.push(what);
        } else {
            self.more_contradictions += 1;
        }
    }
}
