//! Positions and velocities of one time as one fix, in the order of their times.
//!
//! A velocity that the receiver calls late, since it is the mean over an interval, is a fix of its own at
//! the time that it belongs to; so the others wait for as long as velocities are late.

use undrift_nav::sample::Position;

use super::messages::{BestPosition, Motion, Solution};
use crate::entry::Fix;
use crate::fix::on_earth;
use crate::log::receiver::Ready;

/// The fixes that wait are those of the longest latency at 100 Hz; beyond that the first goes.
const MAX_HELD: usize = 500;

#[derive(Default)]
pub(super) struct Fixes {
    /// Message and fix of the last time.
    open: Option<(u64, Fix)>,
    /// Those before it, in order.
    held: Vec<(u64, Fix)>,
    /// The longest latency so far \[s\].
    latency: f64,
}

impl Fixes {
    pub(super) fn position(&mut self, at: u64, time: f64, place: &BestPosition, ready: &mut Ready) {
        let Some(position) = ready.usable(at, on_earth(place.position)) else {
            return;
        };
        let fix = self.open(at, time, ready);
        fix.position = Some((Position::Geodetic(position), place.covariance));
        fix.quality = place.quality;
    }

    pub(super) fn velocity(&mut self, at: u64, time: f64, motion: &Motion, ready: &mut Ready) {
        let velocity = Some((motion.velocity, None));
        if motion.latency == 0.0 {
            self.open(at, time, ready).velocity = velocity;
            return;
        }
        self.latency = self.latency.max(motion.latency);
        // Puts what is before this time in order, too.
        self.open(at, time, ready);
        let late = Fix {
            velocity,
            ..empty(time - motion.latency)
        };
        self.hold(at, late);
    }

    pub(super) fn both(&mut self, at: u64, time: f64, solution: &Solution, ready: &mut Ready) {
        self.position(at, time, &solution.place, ready);
        let velocity = solution.pose.v_n.map(|v_n| (v_n, solution.velocity));
        self.open(at, time, ready).velocity = velocity;
    }

    /// The fix of this time.
    fn open(&mut self, at: u64, time: f64, ready: &mut Ready) -> &mut Fix {
        if self.open.as_ref().is_some_and(|(_, fix)| fix.time != time) {
            self.close(ready);
        }
        let (_, fix) = self.open.get_or_insert_with(|| (at, empty(time)));
        fix
    }

    fn close(&mut self, ready: &mut Ready) {
        let Some((at, fix)) = self.open.take() else {
            return;
        };
        let sure = fix.time - self.latency;
        if fix.position.is_some() || fix.velocity.is_some() {
            self.hold(at, fix);
        }
        let known = self.held.partition_point(|(_, held)| held.time <= sure);
        let many = self.held.len().saturating_sub(MAX_HELD);
        for (at, fix) in self.held.drain(..known.max(many)) {
            ready.fix(at, fix);
        }
    }

    fn hold(&mut self, at: u64, fix: Fix) {
        let place = self.held.partition_point(|(_, held)| held.time <= fix.time);
        self.held.insert(place, (at, fix));
    }

    pub(super) fn end(&mut self, ready: &mut Ready) {
        self.close(ready);
        for (at, fix) in self.held.drain(..) {
            ready.fix(at, fix);
        }
    }
}

fn empty(time: f64) -> Fix {
    Fix {
        mean_velocity: None,
        time,
        position: None,
        velocity: None,
        quality: Default::default(),
    }
}
