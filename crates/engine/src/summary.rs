//! Counts, alignment, innovations, estimated parameters and faults of a run: what is known of a solution beside its states.

use crate::{aid::ByAid, estimator::Estimator, fixes::FixStudy, mounting::MountingError};
use alloc::vec::Vec;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
#[cfg(feature = "checkpoint")]
use undrift_events::Aid;
use undrift_events::{
    Alignment, Contradiction, CovarianceHealth, DisturbedField, Doubt, Event, FixErrors,
    HeadingOff, Implausible, Innovations, Lean, Mismatch, Mounting, RejectedHeadings, Restart,
    SampleFault, Windows,
};
use undrift_nav::{Vector3, covariance::AXES, parameters::Parameter};

/// Standard deviations from which a difference between the clocks is not by chance, and matters to the position.
const SIGMAS: f64 = 3.0;

/// How late the samples turn out to be ([`ReceiverClock::lateness`](crate::estimator::ReceiverClock::lateness)), where that
/// matters to the position.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct LateSamples {
    /// Number of positions used.
    pub positions: u64,
    /// Sums of the squared speed over ground there [m²/s²], and of the larger horizontal variance of the position \[m²\].
    pub squares: [f64; 2],
    /// Sum of the delay of the velocities that the filter had there, negative if they are late \[s\].
    pub velocities: f64,
    /// Number of those at which the solution was behind the receiver's clock by more than three standard deviations of its position.
    pub behind: u64,
    /// Largest distance that it was behind at one of them \[m\].
    pub most: f64,
    /// Delay of the samples there \[s\], negative if they were early, and its standard deviation \[s\].
    pub delay: (f64, f64),
}

impl LateSamples {
    /// Counts the filter's state after a position.
    pub(super) fn note(&mut self, filter: &dyn Estimator) {
        self.positions += 1;
        let (speed, std) = (filter.nav().v_n.xy().norm(), filter.nav_std());
        let largest = std[0].max(std[1]);
        for (sum, of) in self.squares.iter_mut().zip([speed, largest]) {
            *sum += of * of;
        }
        self.velocities += velocity_offset(filter).map_or(0.0, |(offset, _)| offset);
        let Some(clock) = filter.receiver_clock() else {
            return;
        };
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

/// Time by which velocities hold later than stamped, and its standard deviation \[s\]; `None` where no time offset is estimated.
pub(super) fn velocity_offset(filter: &dyn Estimator) -> Option<(f64, f64)> {
    let own = filter.time_offset(Parameter::VelocityTimeOffset);
    own.or_else(|| filter.time_offset(Parameter::TimeOffset))
}

impl LateSamples {
    /// Delay of velocities that are `delay` \[s\] late on the mean which the filter did not have.
    pub(super) fn unknown(&self, delay: f64) -> f64 {
        (delay + self.velocities / (self.positions as f64).max(1.0)).abs()
    }

    /// How far positions are off, as a rule, where times are wrong by `delay` \[s\]: in metres, where that is beyond three standard deviations.
    pub(super) fn beyond(&self, delay: f64) -> Option<f64> {
        let count = (self.positions as f64).max(1.0);
        let [speed, std] = self.squares.map(|sum| (sum / count).sqrt());
        let moved = delay * speed;
        (moved > SIGMAS * std).then_some(moved)
    }
}

/// A vehicle that moves across its forward axis although the non-holonomic constraint says that it does not; the constraint holds
/// as much less.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct SideSlip {
    /// Time at which it was seen first \[s\].
    pub start: f64,
    /// The greatest velocity across over a minute of motion, RMS of the components to the right and down [m/s].
    pub speed: f64,
}

/// Counts and events of a run of the navigator, and what it has learnt on the way: [`Navigator::summary`](crate::Navigator::summary)
/// while it runs, [`Navigator::end`](crate::Navigator::end) at last.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct Summary {
    /// Number of samples processed after alignment.
    pub samples: u64,
    /// Number of samples used up by alignment.
    pub align_samples: u64,
    /// Time at which navigation began \[s\].
    pub started: Option<f64>,
    /// The alignment that navigation began with.
    pub alignment: Option<Alignment>,
    /// Time of the last sample processed \[s\].
    pub ended: f64,
    /// Number of fixes used, in whole or in part.
    pub fixes: u64,
    /// Number of fixes withheld by outages.
    pub withheld: u64,
    /// Number of fixes before the first sample or before alignment could use them.
    pub fixes_before: u64,
    /// Number of fixes that could not be used because their covariance is not positive definite.
    pub bad_fixes: u64,
    /// Number of fixes that repeat the previous one, held by the logger: not used.
    pub repeated: u64,
    /// Time from which on \[s\] the vertical velocities, which were all 0, were taken as not measured.
    pub no_vertical_velocity: Option<f64>,
    /// Where the vehicle moves across its forward axis more than the non-holonomic constraint has it.
    pub side_slip: Option<SideSlip>,
    /// Statistics of the innovations, `innovations[Aid::Position]`.
    pub innovations: ByAid<Innovations>,
    /// Agreement of solution and fixes over time, window by window.
    ///
    /// ```
    /// use undrift_engine::{Navigator, WindowPart, settings::Settings};
    /// # use undrift_nav::shaping::ShapingFilter;
    /// # use undrift_simulate::{GnssNoise, Trajectory, simulate};
    /// # let (gyro, accel) = (ShapingFilter::white(1e-4, 0.02)?, ShapingFilter::white(1e-3, 0.02)?);
    /// # let sensors = [gyro, gyro, gyro, accel, accel, accel];
    /// # let log = simulate(&Trajectory::car(180.0, 1), 50.0, Some(&sensors), &GnssNoise::default(), 1)?;
    /// let mut navigator = Navigator::new(Settings::new(sensors));
    /// for fix in log.gnss {
    ///     navigator.fix(fix)?;
    /// }
    /// for sample in log.imu {
    ///     navigator.imu(sample)?;
    /// }
    /// let windows = &navigator.summary().windows;
    /// assert_eq!(windows.spans().count(), 0, "solution and fixes agree throughout");
    /// assert!(windows.overall(WindowPart::Position).share().is_some_and(|share| share > 0.95));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub windows: Windows,
    /// Parameters estimated, in order, with their last values and standard deviations, in the units of [`Parameter`]: corrections to
    /// what is configured.
    pub parameters: Vec<(Parameter, Vec<f64>, Vec<f64>)>,
    /// Runs of fixes that were rejected; the first [`MOST_EVENTS`].
    pub contradictions: Vec<Contradiction>,
    /// Number of further runs of rejected fixes.
    pub more_contradictions: u64,
    /// Spans in which innovations leaned to one side; the first [`MOST_EVENTS`].
    pub leans: Vec<Lean>,
    /// Samples that could not be right and were replaced; the first [`MOST_EVENTS`] runs of them.
    pub sample_faults: Vec<SampleFault>,
    /// Second alignments: when and why.
    pub restarts: Vec<Restart>,
    /// Delay of the samples against their stamps, where it shows.
    pub late_samples: LateSamples,
    /// Mean factors on the stated standard deviations of position and velocity [–], where they were adapted
    /// ([`Settings::adapt`](crate::settings::Settings::adapt)).
    pub adapted: [Option<f64>; 2],
    /// Density of each axis's white noise in multiples of the model's [–], as the samples show it, gyro and accelerometer x, y, z; `None` where
    /// it was the model's.
    pub louder: Option<[f64; AXES]>,
    /// Regression of the innovations of velocity on the measured velocity, component by component:
    /// sums of products and of squares.
    pub(super) against_velocity: [(f64, f64); 3],
    /// Components of the velocity, 0 to 2 for north, east, down, that seem to have the wrong sign.
    pub wrong_signs: Vec<usize>,
    /// Number of short gaps in the samples that were bridged by interpolation.
    pub bridged: u64,
    /// Gaps too long for that: their number, the first one's time \[s\], the longest \[s\]. The covariance was
    /// grown over each of up to a minute; a longer one ended the solution, and is among `restarts`.
    pub long_gaps: Option<(u64, f64, f64)>,
    /// Longest span without a fix, outages aside: start and length \[s\].
    pub longest_without_gnss: (f64, f64),
    /// Units, axes, signs or times that cannot be right.
    pub implausible: Vec<Implausible>,
    /// What of samples and fixes does not go together and is no error of the configuration.
    pub mismatches: Vec<Mismatch>,
    /// Spans after which the solution was reset to fixes that contradict its velocity or both of its parts; the first
    /// [`MOST_EVENTS`].
    pub doubts: Vec<Doubt>,
    /// Parameters that ended far from their prior: the estimate, and the prior standard deviations that it is off [–].
    pub far: Vec<(Parameter, f64, f64)>,
    /// Spans in which the course contradicted the heading; the first [`MOST_EVENTS`].
    pub heading_off: Vec<HeadingOff>,
    /// Headings by two antennas that were rejected, runs of three and more; the first [`MOST_EVENTS`].
    pub rejected_headings: Vec<RejectedHeadings>,
    /// Spans in which the magnetic field was disturbed; the first [`MOST_EVENTS`].
    pub disturbed_fields: Vec<DisturbedField>,
    /// What all of the fixes show of their own errors; at the end of a run that learns them
    /// ([`Settings::from_fixes`](crate::settings::Settings::from_fixes)).
    pub study: Option<FixStudy>,
    /// Times from which on \[s\] the filter used these errors of the fixes; one entry for each change.
    pub fix_errors: Vec<(f64, FixErrors)>,
    /// Times after which \[s\] body axes are the vehicle's by this mounting, where it was to be found on the way; one entry for each change.
    pub mountings: Vec<(f64, Mounting)>,
    /// Reason why no mounting was found, where one was to be.
    pub no_mounting: Option<MountingError>,
    /// Time at which the solution diverged \[s\], if it did and was not re-initialised.
    pub diverged: Option<f64>,
    /// Symmetry and definiteness of the covariance at the end, if there is a solution.
    pub covariance: Option<CovarianceHealth>,
    /// Start of the first twenty updates in a row, or fewer at the end of the log, whose innovations were far beyond
    /// their predicted size \[s\].
    pub suspect: Option<f64>,
}

/// Number of events of a kind that are kept one by one; further ones are counted or dropped.
pub const MOST_EVENTS: usize = 1000;

/// A component of the velocity has the wrong sign where its innovations are this part of it, on the average: −2 if the
/// solution ignores it, closer to 0 the more it follows.
const WRONG_SIGN: f64 = -0.6;
/// Sum of the squares of the component that is enough to judge by \[m²/s²\].
const SIGN_MOTION: f64 = 5.0;

impl Summary {
    /// Events so far, each kind in order of time; [`Navigator::events`](crate::Navigator::events) has them as they come.
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
            .chain(
                self.rejected_headings
                    .iter()
                    .copied()
                    .map(Event::HeadingsRejected),
            )
            .chain(
                self.disturbed_fields
                    .iter()
                    .copied()
                    .map(Event::FieldDisturbed),
            )
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

    /// Last whitened innovation of each kind of measurement, for a checkpoint.
    #[cfg(feature = "checkpoint")]
    pub(super) fn last_innovations(&self) -> [Option<[f64; 3]>; Aid::COUNT] {
        self.innovations.0.map(|kind| kind.last)
    }

    /// Restores [`Summary::last_innovations`].
    #[cfg(feature = "checkpoint")]
    pub(super) fn set_last_innovations(&mut self, last: [Option<[f64; 3]>; Aid::COUNT]) {
        for (kind, last) in self.innovations.0.iter_mut().zip(last) {
            kind.last = last;
        }
    }

    /// Drops what a start that failed made of innovations, when another one replaces it: the solution is judged by itself.
    pub(super) fn forget_failed_start(&mut self) {
        self.innovations = ByAid::default();
        self.windows = Windows::default();
        self.against_velocity = <[(f64, f64); 3]>::default();
        self.late_samples = LateSamples::default();
        self.heading_off.clear();
        self.rejected_headings.clear();
        self.disturbed_fields.clear();
        self.leans.clear();
        self.suspect = None;
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

    /// Notes a run of rejected fixes; where the solution accepted others of the kind less than `goes_on` \[s\]
    /// before, it continues the run before.
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
