//! Turns and accelerations: what the fixes show of them and what the sensors do.

use crate::{
    events::Implausible,
    settings::{PlausibilitySettings, within},
};
use alloc::collections::VecDeque;
use alloc::vec::Vec;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::RealField;
use undrift_nav::{Vector3, earth::wrap_pi, sample::ImuSample};

/// Lags at which turns are compared: so many steps of so many seconds to each side.
const LAGS: usize = 120;

/// Sums of a regression of y on x with means.
#[derive(Clone, Copy, Default)]
struct Regression {
    n: f64,
    x: f64,
    y: f64,
    xx: f64,
    xy: f64,
    yy: f64,
}

impl Regression {
    fn add(&mut self, x: f64, y: f64) {
        self.n += 1.0;
        self.x += x;
        self.y += y;
        self.xx += x * x;
        self.xy += x * y;
        self.yy += y * y;
    }

    /// Sum of squares of y about its mean.
    fn power(&self) -> f64 {
        self.yy - self.y * self.y / self.n.max(1.0)
    }

    /// Slope and coefficient of determination; zeros where x does not vary.
    fn fit(&self) -> (f64, f64) {
        let n = self.n.max(1.0);
        let (xx, xy) = (self.xx - self.x * self.x / n, self.xy - self.x * self.y / n);
        let yy = self.power();
        if xx > 1e-12 && yy > 1e-12 {
            (xy / xx, xy * xy / (xx * yy))
        } else {
            (0.0, 0.0)
        }
    }
}

/// Angles about the vertical and about the body axes \[rad\], and specific force over time [m/s], body axes.
#[derive(Clone, Copy, Default)]
struct Integrals {
    yaw: f64,
    angle: Vector3,
    velocity: Vector3,
}

/// What a vehicle did over ground from `start` to `end` \[s\].
#[derive(Clone, Copy)]
struct Turn {
    start: f64,
    end: f64,
    /// Of the course \[rad\].
    turn: f64,
    /// On the average, and by how much it grew [m/s].
    speed: f64,
    faster: f64,
}

/// What is known so far.
#[derive(Clone)]
pub(super) struct Turns {
    set: PlausibilitySettings,
    /// What was gathered since the start, now and at the last times in order.
    sums: Integrals,
    history: VecDeque<(f64, Integrals)>,
    /// Where the present window of turning began: time \[s\], course \[rad\] and speed [m/s].
    course: Option<(f64, f64, f64)>,
    /// Windows whose later samples are still to come.
    waiting: VecDeque<Turn>,
    /// Of the turns on those of the vertical at each lag, and of each axis at none.
    lags: [Regression; 2 * LAGS + 1],
    axes: [Regression; 3],
    /// Of the accelerations along the course and to its right on the forces along forward and right.
    pushes: [[Regression; 2]; 2],
    /// Sum of the variances of the turns that noise makes \[rad²\].
    noise: f64,
}

impl Turns {
    pub(super) fn new(set: PlausibilitySettings) -> Self {
        Self {
            set,
            sums: Integrals::default(),
            history: VecDeque::new(),
            course: None,
            waiting: VecDeque::new(),
            lags: [Regression::default(); 2 * LAGS + 1],
            axes: [Regression::default(); 3],
            pushes: [[Regression::default(); 2]; 2],
            noise: 0.0,
        }
    }

    /// Takes in a sample; `up` is the direction of the specific force, if it is known.
    pub(super) fn sample(&mut self, sample: &ImuSample, up: Option<Vector3>) {
        if let Some(up) = up {
            self.sums.yaw -= sample.dtheta.dot(&up);
        }
        self.sums.angle += sample.dtheta;
        self.sums.velocity += sample.dvel;
        let last = self.history.back();
        if last.is_some_and(|(last, _)| sample.time - last < self.set.history_step) {
            return;
        }
        self.history.push_back((sample.time, self.sums));
        let keep = 2.0 * LAGS as f64 * self.set.lag + 2.0 * self.set.turn_window[1];
        while let Some((first, _)) = self.history.front()
            && sample.time - first > keep
        {
            self.history.pop_front();
        }
        while let Some(window) = self.waiting.front().copied()
            && window.end + LAGS as f64 * self.set.lag + self.set.history_step <= sample.time
        {
            self.waiting.pop_front();
            self.compare(&window);
        }
    }

    /// At the end of the log: what still waits is compared with what there is.
    pub(super) fn finish(&mut self) {
        while let Some(window) = self.waiting.pop_front() {
            self.compare(&window);
        }
    }

    /// Takes in a velocity over ground at `time` \[s\] and its horizontal variance [m²/s²].
    pub(super) fn velocity(&mut self, time: f64, velocity: &Vector3, variance: f64) {
        let speed = velocity.xy().norm();
        let noise = variance / (speed * speed);
        if speed < self.set.course_speed || noise > self.set.course_std * self.set.course_std {
            self.course = None;
            return;
        }
        let course = velocity.y.atan2(velocity.x);
        let Some((start, before, slow)) = self.course else {
            self.course = Some((time, course, speed));
            return;
        };
        if time - start < self.set.turn_window[0] {
            return;
        }
        self.course = Some((time, course, speed));
        let turn = wrap_pi(course - before);
        if time - start <= self.set.turn_window[1] && turn.abs() < self.set.most_turn {
            self.noise += 2.0 * noise;
            self.waiting.push_back(Turn {
                start,
                end: time,
                turn,
                speed: 0.5 * (slow + speed),
                faster: speed - slow,
            });
        }
    }

    /// What was gathered until `time` \[s\], if that is in the history.
    fn sums_at(&self, time: f64) -> Option<Integrals> {
        let after = self.history.partition_point(|entry| entry.0 < time);
        let (a, b) = (
            self.history.get(after.checked_sub(1)?)?,
            self.history.get(after)?,
        );
        let part = (time - a.0) / (b.0 - a.0);
        Some(Integrals {
            yaw: a.1.yaw + part * (b.1.yaw - a.1.yaw),
            angle: a.1.angle.lerp(&b.1.angle, part),
            velocity: a.1.velocity.lerp(&b.1.velocity, part),
        })
    }

    /// The same of the yaw alone; `after` is the first entry that is not before an earlier time, and moves on.
    fn yaw_at(&self, time: f64, after: &mut usize) -> Option<f64> {
        while self.history.get(*after).is_some_and(|entry| entry.0 < time) {
            *after += 1;
        }
        let (a, b) = (
            self.history.get(after.checked_sub(1)?)?,
            self.history.get(*after)?,
        );
        Some(a.1.yaw + (time - a.0) / (b.0 - a.0) * (b.1.yaw - a.1.yaw))
    }

    /// Compares what a vehicle did over ground with what its sensors saw, turns at every lag.
    fn compare(&mut self, window: &Turn) {
        let mut after = [0; 2];
        for k in 0..self.lags.len() {
            let late = (k as f64 - LAGS as f64) * self.set.lag;
            let (start, end) = (window.start + late, window.end + late);
            let a = self.yaw_at(start, &mut after[0]);
            let b = self.yaw_at(end, &mut after[1]);
            if let (Some(a), Some(b)) = (a, b) {
                self.lags[k].add(b - a, window.turn);
            }
        }
        let (Some(a), Some(b)) = (self.sums_at(window.start), self.sums_at(window.end)) else {
            return;
        };
        for (axis, regression) in self.axes.iter_mut().enumerate() {
            regression.add(b.angle[axis] - a.angle[axis], window.turn);
        }
        let span = window.end - window.start;
        let force = (b.velocity - a.velocity) / span;
        let seen = [window.faster, window.speed * window.turn].map(|change| change / span);
        for (seen, regressions) in seen.into_iter().zip(&mut self.pushes) {
            for (axis, regression) in regressions.iter_mut().enumerate() {
                regression.add(force[axis], seen);
            }
        }
    }

    /// Whether the vehicle accelerates along body forward, and is pushed along body right in turns.
    pub(super) fn pushes(&self) -> Option<Implausible> {
        let along = |of: usize| -> Option<i8> {
            let [x, y] = [&self.pushes[of][0], &self.pushes[of][1]];
            if x.power() < self.set.enough_push {
                return None;
            }
            let ((x, of_x), (y, of_y)) = (x.fit(), y.fit());
            if of_x > 0.6 && of_y < 0.3 {
                Some(if x > 0.0 { 1 } else { -1 })
            } else if of_y > 0.6 && of_x < 0.3 {
                Some(if y > 0.0 { 2 } else { -2 })
            } else {
                None
            }
        };
        let (forward, right) = (along(0), along(1));
        let wrong = forward.is_some_and(|axis| axis != 1) || right.is_some_and(|axis| axis != 2);
        wrong.then_some(Implausible::Push { forward, right })
    }

    /// What the turns show, where body `down` is the direction of gravity.
    pub(super) fn turns(&self, down: &Vector3) -> Vec<Implausible> {
        let now = &self.lags[LAGS];
        let signal = now.power() - self.noise;
        if signal < self.set.enough_turn || signal < 2.0 * self.noise {
            return Vec::new();
        }
        let (mut scale, mut r2) = now.fit();
        let mut found = Vec::new();
        let fits = self.lags.iter().map(|lag| match lag {
            lag if lag.n >= self.set.lag_windows && lag.power() > 0.5 * now.power() => lag.fit(),
            _ => (0.0, 0.0),
        });
        let best = fits.enumerate().max_by(|a, b| a.1.1.total_cmp(&b.1.1));
        if let Some((k, (there, best))) = best
            && best > 0.8
            && 1.0 - r2 > 4.0 * (1.0 - best) + 0.05
        {
            found.push(Implausible::Late((k as f64 - LAGS as f64) * self.set.lag));
            (scale, r2) = (there, best);
        }
        let of_axis = self.axes.iter().map(Regression::fit).enumerate();
        let best = of_axis.max_by(|a, b| a.1.1.total_cmp(&b.1.1));
        match best {
            Some((axis, (of, best)))
                if best > 0.9
                    && best > r2
                    && down[axis].abs() < 0.3
                    && within(self.set.turn_scale, of.abs()) =>
            {
                found.push(Implausible::TurnAxis(axis));
            }
            _ if r2 > 0.7 && !within(self.set.turn_scale, scale) => {
                found.push(Implausible::TurnScale(scale));
            }
            _ if r2 < 0.1 => found.push(Implausible::NoTurn),
            _ => {}
        }
        found
    }
}
