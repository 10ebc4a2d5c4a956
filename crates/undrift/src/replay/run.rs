//! The state of a replay between samples, and what a sample and a fix do to it.

mod constrain;

use super::{
    GnssUse, Observer, ReplayError, STAMP_ROUNDING, Settings, Summary,
    bridge::Bridge,
    events::{Restart, RestartCause},
    plausible::Plausible,
    receiver::Receiver,
    rest::RestDetector,
    summary::Streak,
};
use crate::align::{Aligner, Heading};
use constrain::CONSTRAINT_GATE;
use undrift_nav::{
    filter::{Filter, Outcome},
    parameters::Parameter,
    sample::{GnssFix, ImuSample},
    tape::Tape,
};

/// A gap longer than this many sample intervals is not one late sample …
const GAP_INTERVALS: f64 = 1.5;
/// What a vehicle may do unseen in a long gap: acceleration [m/s²] and turn rate [rad/s], one sigma.
const GAP_ACCEL: f64 = 2.0;
const GAP_RATE: f64 = 0.2;
/// A gap longer than this [s] ends the solution: nothing is left of the attitude by then.
const LONGEST_GAP: f64 = 60.0;
/// The state of a replay between samples.
pub(super) struct Run<'a, const N: usize> {
    pub(super) filter: Option<Filter<N>>,
    pub(super) aligner: Aligner,
    pub(super) settings: &'a Settings,
    pub(super) summary: Summary,
    pub(super) last_fix: Option<f64>,
    /// Time of the last fix, and the least and greatest speed over ground that it leaves possible.
    pub(super) last_speed: Option<(f64, (f64, f64))>,
    pub(super) streak: Streak,
    /// Whether an alignment goes on beside the solution.
    pub(super) anew: bool,
    pub(super) previous: Option<ImuSample>,
    /// While a gap is being bridged.
    pub(super) bridge: Option<Bridge>,
    pub(super) receiver: Receiver,
    pub(super) rest: RestDetector,
    pub(super) plausible: Plausible,
    pub(super) last_constraint: f64,
    /// Since the last node, and its time.
    pub(super) tape: Option<Box<Tape<N>>>,
    pub(super) last_node: f64,
}

impl<'a, const N: usize> Run<'a, N> {
    pub(super) fn new(settings: &'a Settings) -> Self {
        Self {
            filter: None,
            aligner: Aligner::new(settings),
            settings,
            summary: Summary::default(),
            last_fix: None,
            last_speed: None,
            streak: Streak::default(),
            anew: false,
            previous: None,
            bridge: None,
            receiver: Receiver::new(f64::NEG_INFINITY),
            rest: RestDetector::new(&settings.sensors),
            plausible: Plausible::new(settings),
            last_constraint: f64::NEG_INFINITY,
            tape: None,
            last_node: f64::NEG_INFINITY,
        }
    }

    /// By how much fixes hold later than their stamps, as estimated [s].
    pub(super) fn fix_offset(&self) -> f64 {
        let filter = self.filter.as_ref();
        let offset = filter.and_then(|filter| filter.parameter(Parameter::TimeOffset));
        offset.map_or(0.0, |(value, _)| value[0])
    }

    /// The solution is none any more: it ends here, and another one begins as soon as it is aligned,
    /// without what was told of the start.
    fn give_up(&mut self, time: f64) {
        if !self.settings.gating {
            self.summary.diverged = Some(time);
            return;
        }
        self.begin_anew(time, RestartCause::Impossible);
        self.filter = None;
    }

    /// Aligns anew beside a solution that does not agree with the fixes; it goes on until that is done.
    fn begin_anew(&mut self, time: f64, why: RestartCause) {
        if self.anew {
            return;
        }
        self.anew = true;
        self.summary.restarts.push(Restart {
            time,
            why,
            resumed: None,
        });
        self.aligner = self.second_aligner();
    }

    /// An aligner that does not know what was told of the start.
    fn second_aligner(&self) -> Aligner {
        let mut settings = self.settings.clone();
        settings.align.attitude = None;
        settings.align.velocity = None;
        if let Heading::Given(..) = settings.align.heading {
            settings.align.heading = Heading::Auto;
        }
        Aligner::new(&settings)
    }

    /// The sample as it is, or after a gap too long for anything to be known behind it the last interval
    /// of it alone, with which the log begins as if there was nothing before.
    pub(super) fn after_gap(&mut self, sample: ImuSample) -> (ImuSample, bool) {
        if sample.dt <= LONGEST_GAP {
            return (sample, false);
        }
        let before = sample.time - sample.dt;
        self.note_long_gap(before, sample.dt);
        if self.filter.take().is_some() {
            self.begin_anew(before, RestartCause::NoSamples);
        }
        // Nor does an alignment that was under way, a first one or a second, know anything any more.
        self.aligner = if self.summary.restarts.is_empty() {
            Aligner::new(self.settings)
        } else {
            self.second_aligner()
        };
        self.previous = None;
        let dt = self.settings.sensors[0].interval;
        let part = dt / sample.dt;
        let last = ImuSample {
            dt,
            dtheta: sample.dtheta * part,
            dvel: sample.dvel * part,
            ..sample
        };
        (last, true)
    }

    fn note_long_gap(&mut self, start: f64, length: f64) {
        let (count, first, longest) = self.summary.long_gaps.unwrap_or((0, start, 0.0));
        self.summary.long_gaps = Some((count + 1, first, longest.max(length)));
    }

    /// Tells the observer of a node, if there is a smoother.
    pub(super) fn node(&mut self, observer: &mut impl Observer) -> Result<(), ReplayError> {
        if let (Some(_), Some(filter)) = (self.settings.nodes, &self.filter) {
            observer.node(filter, self.tape.as_deref())?;
            self.tape = Some(Box::default());
            self.last_node = filter.nav().time;
        }
        Ok(())
    }

    /// Takes up a sample: the filter's, bridged where samples are missing before it, or the aligner's.
    pub(super) fn begin(&mut self, sample: &ImuSample) {
        let Some(filter) = &mut self.filter else {
            return;
        };
        let interval = self.settings.sensors[0].interval;
        if sample.dt <= GAP_INTERVALS * interval {
            filter.begin(sample);
            return;
        }
        let before = self.previous.filter(|p| p.dt > 0.0);
        let mut bridge = Bridge::new(sample, before.as_ref(), interval);
        match bridge.unknown_since {
            Some(start) => self.note_long_gap(start, sample.dt),
            None => self.summary.bridged += 1,
        }
        if let (Some(filter), Some(first)) = (&mut self.filter, bridge.next()) {
            filter.begin(&first);
        }
        self.bridge = Some(bridge);
    }

    /// Moves the filter to `time` [s] within the present sample.
    fn advance_to(&mut self, time: f64) {
        let Some(filter) = &mut self.filter else {
            return;
        };
        if let Some(bridge) = &mut self.bridge {
            while bridge.reached() < time - STAMP_ROUNDING
                && let Some(next) = bridge.next()
            {
                filter.advance_recorded(1.0, self.tape.as_deref_mut());
                filter.begin(&next);
            }
        }
        filter.advance_to_recorded(time, STAMP_ROUNDING, self.tape.as_deref_mut());
    }

    /// Grows the covariance for the part of a long gap up to `time` [s] that it has not grown for.
    fn grow_to(&mut self, time: f64) {
        if let (Some(filter), Some(bridge)) = (&mut self.filter, &mut self.bridge)
            && let Some(since) = bridge.unknown_since
        {
            filter.grow((time - since).max(0.0), GAP_RATE, GAP_ACCEL);
            bridge.unknown_since = Some(time);
        }
    }

    /// Shows the aligner a fix; whether it completes the alignment and navigation begins.
    fn align(
        &mut self,
        fix: &GnssFix,
        sample: &ImuSample,
        observer: &mut impl Observer,
    ) -> Result<bool, ReplayError> {
        self.aligner.advance(sample, fix.time);
        if self.settings.gating && !self.receiver.is_consistent(fix) {
            return Ok(false);
        }
        let fix = &match self.settings.gnss_use {
            GnssUse::Position => GnssFix {
                velocity: None,
                ..*fix
            },
            _ => *fix,
        };
        let Some(aligned) = self.aligner.fix::<N>(fix, self.settings)? else {
            return Ok(false);
        };
        match self.summary.restarts.last_mut() {
            Some(restart) => restart.resumed = Some(fix.time),
            None => {
                self.summary.started = Some(fix.time);
                self.summary.alignment = Some(aligned.how);
            }
        }
        self.anew = false;
        self.last_fix = Some(fix.time);
        observer.used(fix.time);
        let mut filter = aligned.filter;
        if let (Some(start), true) = (&self.settings.start, self.summary.restarts.is_empty()) {
            filter.take_out(&nalgebra::SVector::from_fn(|i, _| {
                start.get(i).copied().unwrap_or(0.0)
            }));
        }
        self.filter = Some(filter);
        self.tape = None;
        self.bridge = None;
        self.streak = Streak::default();
        self.receiver.forget_solution(fix.time, &mut self.summary);
        self.node(observer)?;
        // The rest of this sample's interval.
        let rest = sample.time - fix.time;
        if rest > STAMP_ROUNDING {
            let part = rest / sample.dt;
            self.begin(&ImuSample {
                time: sample.time,
                dt: rest,
                dtheta: sample.dtheta * part,
                dvel: sample.dvel * part,
            });
        }
        Ok(true)
    }

    /// A fix within the present sample.
    pub(super) fn fix(
        &mut self,
        fix: &GnssFix,
        sample: &ImuSample,
        observer: &mut impl Observer,
    ) -> Result<(), ReplayError> {
        let withheld = self.settings.outages.iter().any(|o| o.contains(fix.time));
        let fix = &self.settings.quality.apply(fix);
        if self.filter.is_none() && withheld {
            self.summary.withheld += 1;
            return Ok(());
        }
        if (self.filter.is_none() || self.anew) && !withheld {
            if self.align(fix, sample, observer)? {
                return Ok(());
            }
            if self.filter.is_none() {
                self.summary.fixes_before += 1;
                return Ok(());
            }
        }
        let due = fix.time + self.fix_offset();
        self.advance_to(due);
        if !withheld {
            self.grow_to(due);
        }
        let Some(filter) = &mut self.filter else {
            return Ok(());
        };
        observer.fix(filter, fix, withheld);
        if withheld {
            self.summary.withheld += 1;
            // An outage is no fault of the receiver's.
            self.last_fix = Some(fix.time);
            return self.node(observer);
        }
        let updates = self.receiver.update(
            filter,
            fix,
            due,
            self.settings,
            self.tape.as_deref_mut(),
            &mut self.summary,
        );
        if let Some((v_n, covariance)) = &fix.velocity {
            let error = covariance.fixed_view::<2, 2>(0, 0).trace().sqrt();
            let speed = v_n.xy().norm();
            self.last_speed = Some((fix.time, ((speed - error).max(0.0), speed + error)));
            if let Some((std, min_speed)) = self.settings.constraints.course
                && speed > min_speed
                && let Some(observed) = filter.observe_course(v_n.y.atan2(v_n.x))
            {
                let noise = 0.5 * error * error / (speed * speed) + std * std;
                let _ = filter.update_recorded(
                    &observed,
                    &nalgebra::Matrix1::new(noise),
                    &CONSTRAINT_GATE,
                    self.tape.as_deref_mut(),
                );
            }
        }
        let done = updates.each_ref();
        observer.updated(fix.time, done.map(|u| u.as_ref()?.as_ref().ok().copied()));
        let diverged = filter.check().is_err();
        let mut used = false;
        for update in updates.into_iter().flatten() {
            match update {
                Ok(update) if update.outcome == Outcome::Rejected => {}
                Ok(update) => {
                    used = true;
                    self.streak.watch(update, fix.time, &mut self.summary);
                }
                Err(_) => self.summary.bad_fixes += 1,
            }
        }
        if used {
            self.summary.fixes += 1;
            observer.used(fix.time);
            if let Some(last) = self.last_fix.replace(fix.time) {
                self.note_span_without_gnss(last, fix.time);
            }
        }
        if diverged {
            self.give_up(fix.time);
        } else if self.settings.gating && self.settings.restart {
            if self.streak.is_sick(fix.time) {
                self.begin_anew(fix.time, RestartCause::LargeInnovations);
            } else if self.receiver.is_hopeless(fix.time) {
                self.begin_anew(fix.time, RestartCause::GaveWayOften);
            }
        }
        self.node(observer)
    }

    /// The rest of the sample, after its fixes.
    pub(super) fn finish(
        &mut self,
        sample: &ImuSample,
        observer: &mut impl Observer,
    ) -> Result<(), ReplayError> {
        self.previous = Some(*sample);
        self.summary.ended = sample.time;
        self.advance_to(sample.time);
        self.grow_to(sample.time);
        self.bridge = None;
        self.constrain(sample, observer);
        if self.filter.is_none() || self.anew {
            self.aligner.advance(sample, sample.time);
        }
        let Some(filter) = &self.filter else {
            self.summary.align_samples += 1;
            return Ok(());
        };
        if filter.check().is_err() {
            self.give_up(sample.time);
            return Ok(());
        }
        self.summary.samples += 1;
        observer.sample(filter)?;
        if let Some(span) = self.settings.nodes
            && sample.time - self.last_node >= span - STAMP_ROUNDING
        {
            self.node(observer)?;
        }
        Ok(())
    }

    pub(super) fn note_span_without_gnss(&mut self, from: f64, to: f64) {
        if to - from > self.summary.longest_without_gnss.1 {
            self.summary.longest_without_gnss = (from, to - from);
        }
    }
}
