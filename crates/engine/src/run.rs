//! The state of the navigator between samples, and what a sample and a fix do to it.
//!
//! A sample goes through here in this order, and no other module decides it:
//!
//! 1. checked one sample late ([`crate::inertial`]), turned to body axes where the mounting is looked for, cut
//!    where it ends a gap of more than a minute;
//! 2. shown to the watches that need no solution ([`crate::plausible`], [`crate::vibration`]);
//! 3. taken up by the solution, which stops at each measurement that falls due within it
//!    ([`Queue::next_until`]), in order of their own times;
//! 4. ended: doubts stated by the settings, constraints of the vehicle, the alignment that goes on, nodes of a
//!    smoother, the mounting.
//!
//! Everything that may not be known twice is in [`Run`]; a copy of it goes on exactly as the original would,
//! which is how late measurements and checkpoints are made.
//!
//! Ownership: [`Navigator`](crate::Navigator) holds measurements and samples, `Run` the state; the
//! latter never looks at a sample twice. Cost a sample: one prediction, O(N²) for N states, plus an
//! update for each measurement.
//!
//! A log that is replayed in pieces, or with measurements that come late, gives the same result to
//! the last bit. So nothing here may depend on when a measurement arrived, on the clock of the
//! computer, or on the size of a batch.

mod axes;
mod end;
mod few_satellites;
mod fix;
mod magnetometer;
mod pose;
mod progress;

use super::{
    aid::Measurement,
    checked::Checked,
    constraints::{self, Vehicle},
    course::CourseWatch,
    forward::ForwardWatch,
    heading::Headings,
    inertial::Inertial,
    magnetometer::Compass,
    measurement::{Latency, Measured, Queue},
    observer::Observer,
    plausible::Plausible,
    receiver::Receiver,
    rocking::Rocking,
    solution::Solution,
    summary::Summary,
    vertical::VerticalVelocity,
    vibration::Vibration,
    watch::Streak,
};
use crate::{
    align::{Aligner, Heading, Stamps},
    estimator::{Estimator, STAMP_ROUNDING},
    fixes::FixWatch,
    mounting::Search,
    settings::Settings,
};
use alloc::{boxed::Box, sync::Arc};
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use progress::{LogProgress, begins, part};
use undrift_events::{Restart, RestartCause};
use undrift_nav::{Vector3, filter::FilterError, sample::ImuSample};

/// The state of the navigator between samples.
#[derive(Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Run {
    /// Shared by copies; changed by [`Arc::make_mut`] when a mounting or the errors of fixes are
    /// found.
    #[cfg_attr(
        feature = "checkpoint",
        serde(skip, default = "crate::kept::no_settings")
    )]
    settings: Arc<Settings>,
    /// Measurements that were taken in and are not due yet.
    queue: Queue,
    /// Counts and events so far.
    summary: Summary,
    /// The filter that navigates; absent before the first alignment and after a divergence.
    solution: Option<Solution>,
    /// Fed with samples and fixes while there is no solution or a failed one.
    alignment: CurrentAlignment,
    /// Times of the last sample and fixes.
    log: LogProgress,
    /// Watch over solution and fixes.
    receiver: Receiver,
    vertical: VerticalVelocity,
    /// Watch of the innovations' size.
    streak: Streak,
    plausible: Plausible,
    /// Watch of the heading.
    course: CourseWatch,
    /// Watch of the direction of motion in the body.
    forward: ForwardWatch,
    /// Watch of a loose mount.
    rocking: Rocking,
    /// Watch of the headings by two antennas.
    headings: Headings,
    /// Watch of the magnetic field.
    compass: Compass,
    /// Rest and constraints.
    vehicle: Vehicle,
    /// Faults of the sensors; holds one sample back.
    inertial: Inertial,
    vibration: Option<Vibration>,
    /// Where the mounting is to be found on the way.
    search: Option<Box<Search>>,
    /// Where the fixes are to show what they are wrong by.
    fixes: Option<FixWatch>,
}

/// The alignment that goes on: the first one, or another one beside or after a solution.
#[derive(Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
struct CurrentAlignment {
    /// Sums of a rest and the window of motion.
    aligner: Aligner,
    /// Whether one goes on beside the solution, to replace it.
    again: bool,
    /// Whether one goes on beside a solution that began with the heading of a magnetometer, to see whether motion shows the same.
    checks: bool,
}

impl Run {
    /// Where the mounting is looked for, the settings lose what needs vehicle axes: [`Search`]
    /// keeps it. Fixes are studied only where the settings ask for it and no smoother or log of
    /// updates needs a filter of constant size.
    pub(super) fn new(mut settings: Settings) -> Self {
        let search = Search::from_settings(&mut settings);
        let settings = Arc::new(settings);
        Self {
            queue: Queue::new(),
            summary: Summary::default(),
            solution: None,
            alignment: CurrentAlignment {
                aligner: Aligner::new(&settings),
                again: false,
                checks: false,
            },
            log: LogProgress::default(),
            receiver: Receiver::new(f64::NEG_INFINITY),
            vertical: VerticalVelocity::default(),
            streak: Streak::default(),
            plausible: Plausible::new(&settings),
            course: CourseWatch::new(),
            forward: ForwardWatch::default(),
            rocking: Rocking::default(),
            headings: Headings::new(),
            compass: Compass::new(),
            vehicle: Vehicle::new(&settings),
            inertial: Inertial::new(settings.rotation),
            vibration: Vibration::from_settings(&settings),
            search,
            fixes: (settings.from_fixes.is_some()
                && settings.nodes.is_none()
                && settings.log.is_none())
            .then(FixWatch::default),
            settings,
        }
    }

    /// How many measurements were taken in.
    /// Those before it are no longer needed by this run; a copy that is older may need them.
    pub(super) fn taken(&self) -> u64 {
        self.queue.taken()
    }

    /// The latest stamp for which measurements were looked for \[s\].
    pub(super) fn asked(&self) -> f64 {
        self.queue.asked()
    }

    /// End of the last sample that was processed \[s\].
    pub(super) fn reached(&self) -> f64 {
        self.log
            .first_sample
            .map_or(f64::NEG_INFINITY, |_| self.summary.ended)
    }

    /// Counts and events so far.
    pub(super) fn summary(&self) -> &Summary {
        &self.summary
    }

    /// The settings in force.
    #[cfg(feature = "checkpoint")]
    pub(super) fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Replaces the settings; false where one of old and new asks for the mounting and the other does not.
    #[cfg(feature = "checkpoint")]
    pub(super) fn go_on_under(&mut self, settings: Settings) -> bool {
        let mut in_sensor_axes = settings.clone();
        let looks = Search::from_settings(&mut in_sensor_axes).is_some();
        self.settings = Arc::new(match self.has_vehicle_axes() {
            true => settings,
            false => in_sensor_axes,
        });
        looks == self.search.is_some()
    }

    /// Counts and events so far, to be restored.
    #[cfg(feature = "checkpoint")]
    pub(super) fn summary_mut(&mut self) -> &mut Summary {
        &mut self.summary
    }

    /// The filter, once there is a solution.
    pub(super) fn filter(&self) -> Option<&dyn Estimator> {
        self.solution.as_ref().map(|solution| &*solution.filter)
    }

    /// Whether the solution diverged and no other is to begin.
    /// Without gating a divergence ends the run; with it an alignment begins.
    pub(super) fn has_ended(&self) -> bool {
        self.summary.diverged.is_some()
    }

    /// Checks a sample: returns the one before it, replaced where it cannot be right.
    ///
    /// `None` of the first sample: each waits for the next one.
    pub(super) fn check(&mut self, sample: ImuSample) -> Option<Checked> {
        let moves = self.moves();
        self.inertial.next(sample, moves, &mut self.summary)
    }

    /// The last sample, if there is one that was not given out.
    pub(super) fn check_last(&mut self) -> Option<Checked> {
        if self.has_ended() {
            return None;
        }
        let moves = self.moves();
        self.inertial.last(moves, &mut self.summary)
    }

    /// Whether the solution moves.
    fn moves(&self) -> bool {
        let solution = self.solution.as_ref();
        let least = crate::inertial::MOVES;
        solution.is_some_and(|solution| solution.filter.nav().v_n.norm() > least)
    }

    /// Processes a sample and the measurements up to its end.
    ///
    /// # Errors
    /// Where an alignment is complete and its filter cannot be built: more states than there is room for. A
    /// solution that diverges is no error; it is noted in the summary, and an alignment begins.
    pub(super) fn sample(
        &mut self,
        checked: Checked,
        measured: &Measured,
        observer: &mut dyn Observer,
    ) -> Result<(), FilterError> {
        let Checked { sample, doubt } = match &mut self.search {
            Some(search) => search.in_body_axes(checked),
            None => checked,
        };
        let (sample, broken_off) = self.after_gap(sample);
        if self.log.first_sample.is_none() || broken_off {
            self.log.first_sample.get_or_insert(sample.time);
            let start = sample.time - sample.dt - STAMP_ROUNDING;
            while let Some((before, _)) = self.queue.next_until(start, Latency::default(), measured)
            {
                if let Measurement::Gnss(fix) = before {
                    self.log.stamps = Some(Stamps::and(self.log.stamps, fix.time));
                    self.summary.fixes_before += 1;
                }
            }
        }
        self.plausible.sample(&sample);
        if let Some(vibration) = &mut self.vibration
            && let Some(variances) = vibration.next(&sample)
            && let Some(solution) = &mut self.solution
        {
            solution.filter.set_white_noise(&variances);
            vibration.count();
            if self.settings.constraints.air.is_some() {
                solution
                    .filter
                    .inflate_sensor_errors(&vibration.rectified());
            }
        }
        self.begin(&sample);
        let end = sample.time + STAMP_ROUNDING;
        while let Some((measurement, part)) = self.queue.next_until(end, self.latency(), measured) {
            match measurement {
                Measurement::Gnss(fix) => {
                    if begins(&fix, part) {
                        self.log.stamps = Some(Stamps::and(self.log.stamps, fix.time));
                        self.log.fixes += 1;
                        // A marker's course says nothing of its axes.
                        if fix.attitude.is_none() {
                            self.plausible.fix(&fix);
                        }
                    }
                    self.fix(&fix, part, &sample, observer)?;
                }
                other if other.needs_vehicle_axes() && !self.has_vehicle_axes() => {}
                Measurement::Heading(heading) => self.heading(&heading, &sample),
                Measurement::Magnetometer(reading) => self.magnetometer(&reading, &sample),
                other => {
                    if let Some(solution) = &mut self.solution {
                        constraints::scalar(solution, &other, &self.settings, &mut self.summary);
                    }
                }
            }
            if self.has_ended() {
                return Ok(());
            }
        }
        if let (Some([turn, velocity]), Some(solution)) = (doubt, &mut self.solution) {
            solution.advance_to(sample.time);
            solution.filter.inflate_missed_motion(&turn, &velocity);
        }
        self.finish(&sample, observer);
        Ok(())
    }

    /// Delay of the fixes as estimated; none without a solution.
    /// That of a failed solution beside which another alignment goes on is limited more tightly, see
    /// [`Solution::latency`].
    fn latency(&self) -> Latency {
        let solution = self.solution.as_ref();
        let failed = self.alignment.again;
        solution.map_or(Latency::default(), |solution| solution.latency(failed))
    }

    /// Whether an alignment goes on.
    fn aligns(&self) -> bool {
        self.solution.is_none() || self.alignment.again || self.alignment.checks
    }

    /// The solution has diverged: ends it and realigns. Without gating it only notes the time \[s\], and no other begins.
    ///
    /// `time` \[s\] is that of the fix or sample at which the check failed.
    fn give_up(&mut self, time: f64) {
        if !self.settings.gating {
            self.summary.diverged = Some(time);
            return;
        }
        self.align_again(time, RestartCause::Impossible);
        self.solution = None;
    }

    /// Aligns again beside a solution that does not agree with the fixes; it goes on until that is done.
    ///
    /// Without effect while one goes on already.
    ///
    /// The old solution goes on meanwhile and is replaced when the new alignment is complete.
    fn align_again(&mut self, time: f64, why: RestartCause) {
        if self.alignment.again {
            return;
        }
        self.summary.restarts.push(Restart {
            time,
            why,
            resumed: None,
        });
        self.alignment = CurrentAlignment {
            aligner: self.second_aligner(),
            again: true,
            checks: false,
        };
    }

    /// An aligner without what the settings say of the start.
    ///
    /// Stated attitude and velocity held at the start of the log only; a stated heading becomes
    /// automatic.
    fn second_aligner(&self) -> Aligner {
        let mut settings = Settings::clone(&self.settings);
        settings.align.attitude = None;
        settings.align.velocity = None;
        if let Heading::Given(..) = settings.align.heading {
            settings.align.heading = Heading::Auto;
        }
        Aligner::new(&settings)
    }

    /// The sample as it is, or after a gap too long for anything to be known behind it the last interval
    /// of it alone, with which the log begins as if there was nothing before.
    ///
    /// The flag is true where the log begins again after the gap: the attitude is lost, and with it the solution and the
    /// alignments.
    fn after_gap(&mut self, sample: ImuSample) -> (ImuSample, bool) {
        if sample.dt <= crate::solution::LONGEST_GAP {
            return (sample, false);
        }
        let before = sample.time - sample.dt;
        self.summary.long_gap(before, sample.dt);
        if self.solution.take().is_some() {
            self.align_again(before, RestartCause::NoSamples);
        }
        // Nor does an alignment that was under way, a first one or a second, know anything any more.
        self.alignment.aligner = if self.summary.restarts.is_empty() {
            Aligner::new(&self.settings)
        } else {
            self.second_aligner()
        };
        self.log.previous = None;
        let dt = self.settings.sensors[0].interval;
        (part(&sample, dt), true)
    }

    /// Takes up a sample.
    ///
    /// A gap before the sample, of more than 1.5 intervals, is bridged ([`Solution::begin`]).
    fn begin(&mut self, sample: &ImuSample) {
        if let Some(solution) = &mut self.solution {
            let interval = self.settings.sensors[0].interval;
            let previous = self.log.previous.as_ref();
            solution.begin(sample, previous, interval, &mut self.summary);
        }
    }

    /// Ends the sample, after its fixes: constraints, mounting, nodes.
    ///
    /// A doubt of the settings grows the covariance in proportion to the time: over its span the
    /// given standard deviations are reached, √(share) of them in each sample.
    fn finish(&mut self, sample: &ImuSample, observer: &mut dyn Observer) {
        self.log.previous = Some(*sample);
        self.summary.ended = sample.time;
        if let Some(solution) = &mut self.solution {
            solution.end_sample(sample.time);
            for doubt in &self.settings.doubts {
                let span = sample.time.min(doubt.end) - (sample.time - sample.dt).max(doubt.start);
                if span > 0.0 {
                    let share = (span / (doubt.end - doubt.start)).sqrt();
                    let [position, velocity, tilt] =
                        [doubt.position, doubt.velocity, doubt.tilt].map(|std| std * share);
                    solution
                        .filter
                        .inflate(&Vector3::repeat(position), velocity, tilt);
                }
            }
            self.vehicle.end_sample(
                &mut *solution.filter,
                sample,
                self.log.last_velocity,
                &self.settings,
                &mut self.summary,
                observer,
            );
        }
        if self.aligns() {
            self.alignment.aligner.advance(sample, sample.time);
        }
        let Some(solution) = &mut self.solution else {
            self.summary.align_samples += 1;
            return;
        };
        if solution.filter.check().is_err() {
            self.give_up(sample.time);
            return;
        }
        self.summary.samples += 1;
        observer.sample(&*solution.filter);
        if solution.node_is_due(self.settings.nodes, sample.time) {
            solution.node(self.settings.nodes, observer);
        }
        self.look_for_mounting(observer);
        self.look_for_loose_mount();
    }
}
