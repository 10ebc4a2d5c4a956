//! A fix into the filter: gated, scaled, watched.
//!
//! Position and velocity are judged one by one, each by a [`FixGate`] of its own, the height by a third. What
//! makes a fix wrong is not only its size:
//!
//! - **frozen**: a receiver that repeats a position while the solution moves off, or keeps its velocity back
//!   again and again;
//! - **contradicting**: fixes that are rejected one after the other and agree with each other. After a while
//!   the solution is reset to them, since it is then the likelier one to be wrong. How long that takes depends
//!   on what contradicts:
//!
//! | contradicts | patience |
//! |---|---|
//! | velocity, or position and velocity | 3 s |
//! | position of a receiver without velocity | 5 s |
//! | position alone, velocity agrees | 15 s |
//! | a frozen receiver | 60 s |
//!
//! With the reset the covariance grows by what explains the contradiction: its size in position, its size over
//! the time in velocity, and the tilt that makes such a velocity.
//!
//! The order within a fix: is it a repetition; position with its height; velocity; how far both
//! have moved the solution. All comparisons are on innovations, predicted less measured, in north,
//! east, down; the covariance of a gate is the stated one times what [`Scale`] has learned, plus
//! the solution's own.
//!
//! What it may do to the filter: an update, and an inflation where the solution is reset. It never
//! sets a state.

mod height;
mod motion;
mod offer;
mod stamps;
mod steps;

pub(crate) use self::offer::Held;
use self::{height::HeightGate, motion::Motion, offer::Offer, stamps::Stamps, steps::Steps};
use super::{
    gate::{FixGate, Scale, Verdict},
    summary::{MOST_EVENTS, Summary},
    watch::LeanWatch,
};
use crate::{
    estimator::{Aiding, Estimator},
    settings::{Doubt, GnssUse, Settings},
};
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use nalgebra::Vector2;
use undrift_events::{Aid, Part};
use undrift_nav::{
    Vector3,
    earth::STANDARD_GRAVITY,
    filter::{FilterError, Gate, Outcome, Update},
    sample::{GnssFix, Position},
};

/// Lets nothing through: used while a receiver repeats itself.
const SHUT: Gate = Gate {
    weaken: -1.0,
    reject: -1.0,
};
/// A receiver that repeats a position while the solution moves by more than this many of its standard deviations is
/// frozen.
const FROZEN_SIGMAS: f64 = 3.0;
/// Speed of the solution above which such a receiver is frozen \[m/s\].
const FROZEN_SPEED: f64 = 1.0;
/// A receiver is also frozen if its repeated fix has pulled at the velocity by more than this \[m/s\] of late, beyond
/// what the attitude explains.
const PULL: f64 = 0.5;
/// Time constant with which a pull is forgotten \[s\].
const PULL_TIME: f64 = 4.0;
/// Fixes further apart than this are not compared by [`Receiver::is_consistent`] \[s\].
const ODD_GAP: f64 = 2.5;
/// What the way between closer fixes and their velocity may differ by \[m/s\].
const ODD_SPEED: f64 = 1.0;
/// What they may differ by beyond that, by an acceleration between the fixes \[m/s²\].
const ODD_ACCEL: f64 = 5.0;
/// What they may differ by beyond both, in standard deviations.
const ODD_SIGMAS: f64 = 5.0;
/// Time that fixes which agree with each other are rejected before a confirmed solution follows them \[s\]: a receiver
/// finds position and velocity in different ways, so where velocity or both contradict the solution, the solution is
/// more likely to be wrong.
const PATIENCE: f64 = 3.0;
/// [`PATIENCE`] where position alone contradicts: then the position is more likely to be wrong \[s\].
const PATIENCE_POSITION_ALONE: f64 = 15.0;
/// [`PATIENCE`] where there is no velocity \[s\].
const PATIENCE_NO_VELOCITY: f64 = 5.0;
/// [`PATIENCE`] where the receiver repeats itself \[s\].
const PATIENCE_FROZEN: f64 = 60.0;
/// Tilt that a contradiction is taken to stand for, at most \[rad\].
const MOST_TILT: f64 = 0.1;
/// A solution that followed contradicting positions and velocities three times within this time has diverged \[s\].
const THREE_TIMES: f64 = 90.0;

/// One part of the fixes.
#[derive(Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
struct FixPart {
    /// Which of the two.
    part: Part,
    /// Limits and the state of confirmation.
    gate: FixGate,
    /// Stated against actual accuracy.
    scale: Scale,
    /// Slow drift to one side.
    lean: LeanWatch,
}

/// What is known of the receiver so far.
#[derive(Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Receiver {
    position: FixPart,
    velocity: FixPart,
    height: HeightGate,
    steps: Steps,
    motion: Motion,
    stamps: Stamps,
    /// By how much the delay has changed since the fix before, one standard deviation \[s\].
    wander: f64,
    /// The last position, since when it has been the same \[s\], and the velocity then.
    same: Option<(Position, f64, Option<Vector3>)>,
    /// Change of the velocity, north and east, by updates with the same fix of late \[m/s\], and the time of the last \[s\].
    pull: (Vector2<f64>, f64),
    /// How much of that the attitude may be to blame for, one standard deviation, the least since the fix is the same \[m/s\].
    tilted: f64,
    /// Whether the last fix was frozen.
    frozen: bool,
    /// The last fix that an alignment was to see.
    before: Option<GnssFix>,
}

impl Receiver {
    pub(super) fn new(time: f64) -> Self {
        let channel = |part| FixPart {
            part,
            gate: FixGate::new(part, time),
            scale: Scale::new(),
            lean: LeanWatch::new(part),
        };
        Self {
            position: channel(Part::Position),
            velocity: channel(Part::Velocity),
            height: HeightGate::new(time),
            steps: Steps::default(),
            motion: Motion::default(),
            stamps: Stamps::default(),
            wander: 0.0,
            same: None,
            pull: (Vector2::zeros(), time),
            tilted: f64::INFINITY,
            frozen: false,
            before: None,
        }
    }

    /// Starts for a new solution, but keeps what is known of the receiver's accuracy.
    ///
    /// After an alignment, at `time` \[s\]: gates begin unconfirmed.
    pub(super) fn forget_solution(&mut self, time: f64, summary: &mut Summary) {
        let scales = (self.position.scale, self.velocity.scale);
        self.close(summary);
        let stamps = core::mem::take(&mut self.stamps);
        *self = Self {
            stamps,
            ..Self::new(time)
        };
        (self.position.scale, self.velocity.scale) = scales;
    }

    /// Takes in the stamp of a fix \[s\], before anything is done with it.
    pub(super) fn stamp(&mut self, time: f64) {
        self.wander = self.stamps.next(time);
    }

    /// Whether a fix may serve to align: its velocity and its way from the fix before are the same to
    /// what their standard deviations and a vehicle's acceleration allow.
    ///
    /// True where there is nothing to compare: without velocity or position, of the first fix, after a gap of
    /// 2.5 s or of another kind of position.
    pub(super) fn is_consistent(&mut self, fix: &GnssFix) -> bool {
        let before = self.before.replace(*fix);
        let (Some((to, r)), Some((v, r_v))) = (&fix.position, &fix.velocity) else {
            return true;
        };
        let Some((before, (from, _))) = before.and_then(|b| Some((b, b.position?))) else {
            return true;
        };
        let span = fix.time - before.time;
        let way = match (from, to) {
            (Position::Geodetic(from), Position::Geodetic(to)) => from.offset_to(to),
            (Position::Baseline { ned: from, .. }, Position::Baseline { ned: to, .. }) => to - from,
            _ => return true,
        };
        if !(0.0..ODD_GAP).contains(&span) {
            return true;
        }
        let sigmas = (2.0 * r.trace()).sqrt() / span + r_v.trace().sqrt();
        (way / span - v).norm() < ODD_SPEED + ODD_ACCEL * span + ODD_SIGMAS * sigmas
    }

    /// Updates the filter, which is at or after the time at which the fix holds, with its position and velocity, or with one of them. A mean
    /// velocity takes the velocity's place where the motion since its start is known.
    ///
    /// Returns the updates of position and velocity, each `None` where the fix, the settings or
    /// the part leave it out.
    ///
    /// # Errors
    /// In each: [`FilterError`] of a covariance that is no covariance, or of a correction that the
    /// filter refuses.
    pub(super) fn update(
        &mut self,
        filter: &mut dyn Estimator,
        fix: &GnssFix,
        &Held {
            part,
            due,
            stretch,
            settling,
        }: &Held,
        settings: &Settings,
        summary: &mut Summary,
    ) -> [Option<Result<Update, FilterError>>; 2] {
        let lever_arm = settings.lever_arm;
        let with_velocity = fix.velocity.is_some() && settings.gnss_use != GnssUse::Position;
        let mut updates = [None, None];
        let before = filter.nav().v_n.xy();
        let open = !settings.gating
            || self.position.gate.is_senseless()
            || self.velocity.gate.is_senseless();
        if part != Some(Part::Velocity) {
            let frozen = settings.gating && self.is_frozen(filter, fix, &lever_arm);
            if self.frozen && !frozen {
                self.position.gate.unconfirm();
                self.velocity.gate.unconfirm();
            }
            self.frozen = frozen;
            if settings.gating && self.wander > 0.0 {
                filter.inflate_time_offsets(self.wander);
            }
        }
        let frozen = self.frozen;
        self.motion.follow(filter);
        if let Some((_, r)) = fix.position
            && let Some((aiding, mut white)) =
                Aiding::position(fix, due, lever_arm, &settings.fix_errors)
            && settings.gnss_use != GnssUse::Velocity
            && part != Some(Part::Velocity)
        {
            let patience = match (frozen, with_velocity) {
                (true, _) => PATIENCE_FROZEN,
                (_, false) => PATIENCE_NO_VELOCITY,
                _ if self.velocity.gate.is_in_doubt() => PATIENCE,
                _ => PATIENCE_POSITION_ALONE,
            };
            let judged = !open && !settling && !frozen && !self.position.gate.is_in_doubt();
            let before = filter.innovation(&aiding);
            let mut blind = 0.0;
            if judged && let Some(innovation) = &before {
                blind = (self.height).judge(filter, fix.time, innovation, &r, patience, summary);
                white[(2, 2)] += blind;
            }
            let offer = Offer {
                aiding,
                stated: white,
                time: fix.time,
                open,
                settling,
                frozen,
                patience,
                speed_doubted: !with_velocity,
                leans: fix.attitude.is_none(),
            };
            let update = self.position.update(filter, &offer, settings, summary);
            match (&update, before, filter.innovation(&offer.aiding)) {
                (Ok(update), Some(before), Some(after))
                    if update.outcome != Outcome::Rejected && blind == 0.0 =>
                {
                    let changes = [&before, &after];
                    let moves = (self.motion.drift(filter), &filter.nav().v_n);
                    self.steps.used(fix.time, changes, &r, moves, summary);
                }
                _ => self.steps.rejected(),
            }
            updates[0] = Some(update);
        }
        if let Some((v_n, r)) = fix.velocity
            && with_velocity
            && part != Some(Part::Position)
        {
            let (mut white, correlated) = settings.fix_errors.split_velocity(&r);
            let mut aiding = Aiding::Velocity {
                v_n,
                lever_arm,
                correlated,
                due,
            };
            if let Some(innovation) = filter.innovation(&aiding) {
                summary.regress(&innovation, &v_n, &r.diagonal());
            }
            if let (Some(mean), Some(stretch)) = (&fix.mean_velocity, stretch) {
                white = mean.covariance;
                aiding = Aiding::MeanVelocity {
                    v_n: mean.v_n,
                    lever_arm,
                    stretch,
                };
            }
            // One that goes on while the position is held is of use.
            let held = self.same.is_some_and(|(.., held)| held == Some(v_n));
            let frozen = frozen && (held || v_n.norm() < 0.5 * filter.nav().v_n.norm());
            let offer = Offer {
                aiding,
                stated: white,
                time: fix.time,
                open,
                settling,
                frozen,
                patience: if frozen { PATIENCE_FROZEN } else { PATIENCE },
                speed_doubted: true,
                leans: true,
            };
            updates[1] = Some(self.velocity.update(filter, &offer, settings, summary));
        }
        self.pulled(before, filter, fix.time);
        updates
    }

    /// Notes how far an update has moved the velocity from what it was `before`.
    /// Pulls (horizontal, before less after) are forgotten with a time constant of 4 s.
    fn pulled(&mut self, before: Vector2<f64>, filter: &dyn Estimator, time: f64) {
        let left = (-(time - self.pull.1) / PULL_TIME).exp();
        let pull = self.pull.0 * left + before - filter.nav().v_n.xy();
        self.pull = (pull, time);
    }

    /// Whether the same fix, again and again, keeps a solution back that moves off: from the sensors it has a velocity that
    /// no error of its attitude explains.
    ///
    /// Beyond 0.5 m/s and three standard deviations of what a tilt makes in 4 s, g σ t.
    fn keeps_back(&mut self, filter: &dyn Estimator) -> bool {
        let std = filter.nav_std();
        // Kept back for a while, a solution doubts its attitude.
        self.tilted = (STANDARD_GRAVITY * std[6].max(std[7]) * PULL_TIME).min(self.tilted);
        self.pull.0.norm() > PULL + FROZEN_SIGMAS * self.tilted
    }

    /// Whether the fix repeats a position that the solution has left.
    ///
    /// Either the solution has moved by more than the fix's accuracy, faster than its own velocity is
    /// uncertain, or repeated fixes have pulled at its velocity by more than its tilt explains. In the second
    /// case the pull is given back to the solution as uncertainty.
    fn is_frozen(&mut self, filter: &mut dyn Estimator, fix: &GnssFix, lever: &Vector3) -> bool {
        let Some((position, r)) = &fix.position else {
            return false;
        };
        let since = match &self.same {
            Some((last, since, _)) if last == position => *since,
            _ => {
                self.same = Some((*position, fix.time, fix.velocity.map(|(v, _)| v)));
                self.pull = (Vector2::zeros(), fix.time);
                self.tilted = f64::INFINITY;
                return false;
            }
        };
        if self.frozen {
            return true;
        }
        if self.keeps_back(filter) {
            let (pull, time) = (self.pull.0.norm(), PULL_TIME);
            let tilt = pull / (STANDARD_GRAVITY * time);
            let moved = Vector3::repeat(pull * time);
            filter.inflate(&moved, pull, tilt.min(MOST_TILT));
            return true;
        }
        let velocity = filter.antenna_velocity(lever).xy();
        let std = filter.nav_std();
        let unsure = std[3].max(std[4]);
        let moved = velocity.norm() * (fix.time - since);
        velocity.norm() > FROZEN_SPEED + FROZEN_SIGMAS * unsure
            && moved > FROZEN_SIGMAS * r.fixed_view::<2, 2>(0, 0).trace().sqrt()
    }

    /// Whether the receiver repeats itself while the solution moves.
    pub(super) fn repeats(&self) -> bool {
        self.frozen
    }

    /// Whether position and velocity have both been reset to fixes again and again.
    /// Three resets of each within 90 s: the solution does not follow the fixes any more.
    pub(super) fn is_hopeless(&self, time: f64) -> bool {
        let both = self
            .position
            .gate
            .third_last()
            .min(self.velocity.gate.third_last());
        time - both < THREE_TIMES
    }

    /// Ends what is open at the end of the log.
    pub(super) fn close(&mut self, summary: &mut Summary) {
        self.height.close(summary);
        for (i, channel) in [&mut self.position, &mut self.velocity]
            .into_iter()
            .enumerate()
        {
            channel.gate.close(summary);
            channel.lean.close(summary);
            summary.adapted[i] = channel.scale.mean();
        }
    }
}

impl FixPart {
    /// Judges one part of a fix, updates the filter with it where it passes, and learns from the innovation.
    fn update(
        &mut self,
        filter: &mut dyn Estimator,
        offer: &Offer,
        settings: &Settings,
        summary: &mut Summary,
    ) -> Result<Update, FilterError> {
        let r = if settings.adapt {
            offer.stated * self.scale.factor()
        } else {
            offer.stated
        };
        let time = offer.time;
        let innovation = filter
            .innovation(&offer.aiding)
            .ok_or(FilterError::BadMeasurement)?;
        let mut limits = Gate::OPEN;
        if settings.gating {
            match self.gate.judge(time, &innovation, &r, offer.patience) {
                Verdict::Limits(_) if offer.open => {}
                Verdict::Limits(_) if offer.frozen => limits = SHUT,
                Verdict::Limits(gate) if offer.settling => limits.weaken = gate.weaken,
                Verdict::Limits(gate) => limits = gate,
                Verdict::ResetToFixes(duration) => {
                    let size = innovation.norm();
                    let (position, velocity) = match (self.part, offer.speed_doubted) {
                        (Part::Velocity, _) => (0.0, size),
                        (Part::Position, true) => (size, size / duration),
                        (Part::Position, false) => (size, 0.0),
                    };
                    let tilt = (velocity / (STANDARD_GRAVITY * duration)).min(MOST_TILT);
                    filter.inflate(&Vector3::repeat(position), velocity, tilt);
                    if velocity > 0.0 && summary.doubts.len() < MOST_EVENTS {
                        summary.doubts.push(Doubt {
                            start: time - duration,
                            end: time,
                            position,
                            velocity,
                            tilt,
                        });
                    }
                    self.gate.reset_to_fix(time, &innovation, summary);
                }
            }
        }
        let update = filter
            .update(&offer.aiding, &r, &limits)?
            .ok_or(FilterError::BadMeasurement)?;
        if settings.gating {
            self.gate
                .note(time, &innovation, &update, offer.frozen, summary);
        }
        if settings.adapt {
            self.scale.learn(&update);
        }
        if offer.leans {
            self.lean.add(time, &innovation, &update, summary);
        }
        summary.windows.add(self.part, time, &update);
        match self.part {
            Part::Position => summary.innovations[Aid::Position].add(update),
            Part::Velocity => summary.innovations[Aid::Velocity].add(update),
        }
        Ok(update)
    }
}

#[cfg(test)]
mod tests;
