//! A fix into the filter: gated, scaled, watched.

use super::{
    GnssUse, STAMP_ROUNDING, Settings,
    events::Part,
    gate::{FixGate, Scale, Verdict},
    summary::{LeanWatch, Summary},
};
use undrift_nav::{
    Matrix3, Vector3,
    aiding::Observation,
    earth::STANDARD_GRAVITY,
    filter::{Filter, FilterError, Gate, Update},
    sample::{GnssFix, Position},
    tape::Tape,
};

/// A receiver that repeats a position while the solution moves on by more than this many of its
/// standard deviations, and faster than this [m/s], is frozen.
const FROZEN_SIGMAS: f64 = 3.0;
const FROZEN_SPEED: f64 = 1.0;
/// Fixes further apart than this [s] are not compared before the alignment; closer ones may differ by
/// so much [m/s, m/s²], and so many standard deviations.
const GAP: f64 = 2.5;
const ODD_SPEED: f64 = 1.0;
const ODD_ACCEL: f64 = 5.0;
const ODD_SIGMAS: f64 = 5.0;
/// For how long fixes that agree with each other are left out before a confirmed solution gives way [s].
/// A receiver finds position and velocity in different ways: where both contradict the solution, or
/// velocity does, it is more likely the solution that is wrong; where position alone does, the position.
const PATIENCE: f64 = 3.0;
const PATIENCE_POSITION_ALONE: f64 = 15.0;
/// The same where there is no velocity to tell, and where the receiver repeats itself.
const PATIENCE_NO_VELOCITY: f64 = 5.0;
const PATIENCE_FROZEN: f64 = 60.0;
/// Lets nothing through.
const SHUT: Gate = Gate {
    weaken: -1.0,
    reject: -1.0,
};
/// Tilt that a contradiction is taken to stand for, at most [rad].
const MOST_TILT: f64 = 0.1;
/// Position and velocity both gave way three times within so long [s]: the solution is no longer one.
const THREE_TIMES: f64 = 90.0;

/// One part of the fixes.
struct Channel {
    part: Part,
    gate: FixGate,
    scale: Scale,
    lean: LeanWatch,
}

/// What is known of the receiver so far.
pub(super) struct Receiver {
    position: Channel,
    velocity: Channel,
    /// The last position, since when it has been the same [s], and the velocity then.
    same: Option<(Position, f64, Option<Vector3>)>,
    /// Whether the last fix was frozen.
    frozen: bool,
    /// The last fix that an alignment was to see.
    before: Option<GnssFix>,
}

impl Receiver {
    pub(super) fn new(time: f64) -> Self {
        let channel = |part| Channel {
            part,
            gate: FixGate::new(part, time),
            scale: Scale::new(),
            lean: LeanWatch::new(part),
        };
        Self {
            position: channel(Part::Position),
            velocity: channel(Part::Velocity),
            same: None,
            frozen: false,
            before: None,
        }
    }

    /// As new, but for what is known of the receiver's accuracy.
    pub(super) fn forget_solution(&mut self, time: f64, summary: &mut Summary) {
        let scales = (self.position.scale, self.velocity.scale);
        self.close(summary);
        *self = Self::new(time);
        (self.position.scale, self.velocity.scale) = scales;
    }

    /// Whether a fix may serve to align: its velocity and its way from the fix before are the same to
    /// what their standard deviations and a vehicle's acceleration allow.
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
        if !(0.0..GAP).contains(&span) {
            return true;
        }
        let sigmas = (2.0 * r.trace()).sqrt() / span + r_v.trace().sqrt();
        (way / span - v).norm() < ODD_SPEED + ODD_ACCEL * span + ODD_SIGMAS * sigmas
    }

    /// Updates the filter, which stands at or after the time `due` [s] at which the fix holds, with its
    /// position and velocity.
    pub(super) fn update<const N: usize>(
        &mut self,
        filter: &mut Filter<N>,
        fix: &GnssFix,
        due: f64,
        settings: &Settings,
        mut tape: Option<&mut Tape<N>>,
        summary: &mut Summary,
    ) -> [Option<Result<Update, FilterError>>; 2] {
        let lever = &settings.lever_arm;
        let with_velocity = fix.velocity.is_some() && settings.gnss_use != GnssUse::Position;
        let mut updates = [None, None];
        let open = !settings.gating
            || self.position.gate.is_senseless()
            || self.velocity.gate.is_senseless();
        let frozen = settings.gating && self.is_frozen(filter, fix, lever);
        if self.frozen && !frozen {
            self.position.gate.unconfirm();
            self.velocity.gate.unconfirm();
        }
        self.frozen = frozen;
        if let Some((position, r)) = &fix.position
            && settings.gnss_use != GnssUse::Velocity
        {
            let observe = |filter: &Filter<N>| {
                let mut observed = filter.observe_position(position, lever);
                let late = filter.nav().time - due;
                if late > STAMP_ROUNDING {
                    let c_mn = observed.h.fixed_view::<3, 3>(0, 0);
                    let moved = filter.antenna_velocity(lever) * late
                        - filter.acceleration() * (0.5 * late * late);
                    observed.innovation -= c_mn * moved;
                }
                observed
            };
            let doubt = |size: f64, duration: f64| {
                let speed = if with_velocity { 0.0 } else { size / duration };
                (size, speed)
            };
            let tape = tape.as_deref_mut();
            let patience = match (frozen, with_velocity) {
                (true, _) => PATIENCE_FROZEN,
                (_, false) => PATIENCE_NO_VELOCITY,
                _ if self.velocity.gate.is_in_doubt() => PATIENCE,
                _ => PATIENCE_POSITION_ALONE,
            };
            let channel = &mut self.position;
            updates[0] = Some(channel.update(
                filter, observe, r, fix.time, open, frozen, patience, doubt, settings, tape,
                summary,
            ));
        }
        if let Some((v_n, r)) = &fix.velocity
            && with_velocity
        {
            let observe = |filter: &Filter<N>| {
                let mut observed = filter.observe_velocity(v_n, lever);
                let late = filter.nav().time - due;
                if late > STAMP_ROUNDING {
                    observed.innovation -= filter.acceleration() * late;
                }
                observed
            };
            let innovation = observe(filter).innovation;
            summary.regress(&innovation, v_n, &r.diagonal());
            let doubt = |size: f64, _| (0.0, size);
            // One that goes on while the position is held is of use.
            let held = self.same.is_some_and(|(.., held)| held == Some(*v_n));
            let frozen = frozen && (held || v_n.norm() < 0.5 * filter.nav().v_n.norm());
            let patience = if frozen { PATIENCE_FROZEN } else { PATIENCE };
            let channel = &mut self.velocity;
            updates[1] = Some(channel.update(
                filter, observe, r, fix.time, open, frozen, patience, doubt, settings, tape,
                summary,
            ));
        }
        updates
    }

    /// Whether the fix repeats a position that the solution has left.
    fn is_frozen<const N: usize>(
        &mut self,
        filter: &Filter<N>,
        fix: &GnssFix,
        lever: &Vector3,
    ) -> bool {
        let Some((position, r)) = &fix.position else {
            return false;
        };
        let since = match &self.same {
            Some((last, since, _)) if last == position => *since,
            _ => {
                self.same = Some((*position, fix.time, fix.velocity.map(|(v, _)| v)));
                return false;
            }
        };
        let velocity = filter.antenna_velocity(lever).xy();
        let std = filter.nav_std();
        let unsure = std[3].max(std[4]);
        let moved = velocity.norm() * (fix.time - since);
        velocity.norm() > FROZEN_SPEED + FROZEN_SIGMAS * unsure
            && moved > FROZEN_SIGMAS * r.fixed_view::<2, 2>(0, 0).trace().sqrt()
    }

    /// Whether position and velocity have both given way to fixes again and again.
    pub(super) fn is_hopeless(&self, time: f64) -> bool {
        let both = self
            .position
            .gate
            .third_last()
            .min(self.velocity.gate.third_last());
        time - both < THREE_TIMES
    }

    /// Writes down what goes on at the end.
    pub(super) fn close(&mut self, summary: &mut Summary) {
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

impl Channel {
    #[allow(clippy::too_many_arguments)]
    fn update<const N: usize>(
        &mut self,
        filter: &mut Filter<N>,
        observe: impl Fn(&Filter<N>) -> Observation<3, N>,
        stated: &Matrix3,
        time: f64,
        open: bool,
        frozen: bool,
        patience: f64,
        doubt: impl Fn(f64, f64) -> (f64, f64),
        settings: &Settings,
        tape: Option<&mut Tape<N>>,
        summary: &mut Summary,
    ) -> Result<Update, FilterError> {
        let r = if settings.adapt {
            stated * self.scale.factor()
        } else {
            *stated
        };
        let mut observed = observe(filter);
        let mut limits = Gate::OPEN;
        if settings.gating {
            match self.gate.judge(time, &observed.innovation, &r, patience) {
                Verdict::Limits(_) if open => {}
                Verdict::Limits(_) if frozen => limits = SHUT,
                Verdict::Limits(gate) => limits = gate,
                Verdict::GiveWay(duration) => {
                    let size = observed.innovation.norm();
                    let (position, velocity) = doubt(size, duration);
                    let tilt = (velocity / (STANDARD_GRAVITY * duration)).min(MOST_TILT);
                    filter.doubt(position, velocity, tilt);
                    self.gate.give_way(time, &observed.innovation, summary);
                    observed = observe(filter);
                }
            }
        }
        let update = filter.update_recorded(&observed, &r, &limits, tape)?;
        if settings.gating {
            let innovation = &observed.innovation;
            self.gate.note(time, innovation, &update, frozen, summary);
        }
        if settings.adapt {
            self.scale.learn(&update);
        }
        self.lean.add(time, &observed.innovation, &update, summary);
        match self.part {
            Part::Position => summary.position.add(update),
            Part::Velocity => summary.velocity.add(update),
        }
        Ok(update)
    }
}
