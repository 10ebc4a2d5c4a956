//! Turns and accelerations: what the fixes show of them and what the sensors do.
//!
//! Windows of 0.9 to 2.5 s between two velocities give the turn of the course, and the gain of speed. Samples
//! for the longest lag come later, so that a window waits until it can be compared at all lags. Turns of the
//! gyros are about the mean direction of the specific force, so that a mounting that is unknown does not matter
//! to them.
//!
//! A lag is believed where its regression explains the turns (r² above 0.8) and leaves a quarter of what no lag
//! leaves. Then the scale is judged, or another axis that explains nine tenths of the turns.
//!
//! Signs: course and yaw grow clockwise seen from above (from north to east); up is the direction
//! of the mean specific force, so that yaw is minus the rotation about it. A lag is positive where
//! the samples' stamps are later than the fixes' for the same motion.
//!
//! Memory: the history of 65 s at 10 Hz, and 241 regressions of six sums. What it cannot see: a
//! constant heading, speeds below 3 m/s, and a scale between 0.6 and 1.7, which the bank of a
//! two-wheeler makes too.

use super::changes::{Changes, Compared};
use super::lags::{self, Lag, SIGMAS};
use super::regression::{ENOUGH_PUSH, ENOUGH_TURN, OnForce, Regression, TURN_SCALE};
use alloc::collections::VecDeque;
use alloc::vec::Vec;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::RealField;
use undrift_events::{Implausible, Mismatch, SensorChange};
use undrift_nav::{Matrix3, Vector3, earth::wrap_pi, sample::ImuSample};

/// Lags at which turns are compared: so many steps of so many seconds to each side.
const LAGS: usize = 120;
/// Step between the lags at which turns are compared \[s\].
const LAG: f64 = 0.25;
/// Windows that have to be compared before a lag is believed.
const LAG_WINDOWS: f64 = 20.0;
/// Speed below which there is no course \[m/s\].
const COURSE_SPEED: f64 = 3.0;
/// Largest standard deviation of a course \[rad\].
const COURSE_STD: f64 = 0.1;
/// Shortest and longest window of a turn \[s\].
const TURN_WINDOW: [f64; 2] = [0.9, 2.5];
/// A larger turn in a window is an outlier \[rad\].
const MOST_TURN: f64 = 1.0;
/// Lags at which gains of speed are compared: so many steps of so many seconds to each side.
const SPEED_LAGS: usize = 8;
const SPEED_LAG: f64 = 0.1;
/// Lags of the turns among which that of the velocities is looked for: so many steps to each side.
const NEAR_LAGS: usize = 4;
/// A difference of times that matters: less may be the shape of a motion \[s\].
const LATE: f64 = 0.08;
/// From one entry of the history of turns to the next \[s\].
const HISTORY_STEP: f64 = 0.1;

/// Angles about the vertical and about the body axes \[rad\], and specific force over time [m/s], body axes.
#[derive(Clone, Copy, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
struct Integrals {
    /// About the vertical, positive to the right \[rad\].
    yaw: f64,
    /// About body x, y, z \[rad\].
    angle: Vector3,
    /// ∫ f dt, body axes [m/s].
    velocity: Vector3,
}

/// What a vehicle did over ground from `start` to `end` \[s\].
#[derive(Clone, Copy)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
struct Turn {
    start: f64,
    end: f64,
    /// Turn of the course \[rad\], and the variance that noise makes of it \[rad²\].
    turn: f64,
    noise: f64,
    /// Mean speed, and how much it grew [m/s].
    speed: f64,
    faster: f64,
}

/// What is known so far.
#[derive(Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Turns {
    /// What was gathered since the start, now and at the last times in order.
    sums: Integrals,
    /// Interval of the last sample \[s\]: no delay is known better.
    interval: f64,
    history: VecDeque<(f64, Integrals)>,
    /// Where the present window of turning began: time \[s\], course \[rad\] and speed [m/s].
    course: Option<(f64, f64, f64)>,
    /// Windows whose later samples are still to come.
    ///
    /// At most some 30 s of windows.
    waiting: VecDeque<Turn>,
    /// Regressions of the turns on those of the vertical at each lag, and of each axis at none.
    #[cfg_attr(feature = "checkpoint", serde(with = "crate::kept::array"))]
    lags: [Regression; 2 * LAGS + 1],
    axes: [Regression; 3],
    /// Regressions of the accelerations along the course and to its right on the forces along forward and right.
    pushes: [[Regression; 2]; 2],
    /// Regressions of the gains of speed on the specific force at each lag.
    #[cfg_attr(feature = "checkpoint", serde(with = "crate::kept::array"))]
    gains: [OnForce; 2 * SPEED_LAGS + 1],
    /// The same of speed times the gyros' turns.
    #[cfg_attr(feature = "checkpoint", serde(with = "crate::kept::array"))]
    swings: [OnForce; 2 * SPEED_LAGS + 1],
    changes: Changes,
    /// Sum of the variances of the turns that noise makes \[rad²\].
    ///
    /// Twice the variance of a course for each window.
    noise: f64,
}

impl Turns {
    pub(super) fn new() -> Self {
        Self {
            sums: Integrals::default(),
            interval: 0.0,
            history: VecDeque::new(),
            course: None,
            waiting: VecDeque::new(),
            lags: [Regression::default(); 2 * LAGS + 1],
            axes: [Regression::default(); 3],
            pushes: [[Regression::default(); 2]; 2],
            gains: [OnForce::default(); 2 * SPEED_LAGS + 1],
            swings: [OnForce::default(); 2 * SPEED_LAGS + 1],
            changes: Changes::default(),
            noise: 0.0,
        }
    }

    /// Takes in a sample; `up` is the direction of the specific force, if it is known.
    ///
    /// Yaw is minus the turn about up, positive to the right as the course is. The history goes back as far as
    /// the longest lag needs.
    pub(super) fn sample(&mut self, sample: &ImuSample, up: Option<Vector3>) {
        if let Some(up) = up {
            self.sums.yaw -= sample.dtheta.dot(&up);
        }
        self.interval = sample.dt;
        self.sums.angle += sample.dtheta;
        self.sums.velocity += sample.dvel;
        let last = self.history.back();
        if last.is_some_and(|(last, _)| sample.time - last < HISTORY_STEP) {
            return;
        }
        self.history.push_back((sample.time, self.sums));
        let keep = 2.0 * LAGS as f64 * LAG + 2.0 * TURN_WINDOW[1];
        while let Some((first, _)) = self.history.front()
            && sample.time - first > keep
        {
            self.history.pop_front();
        }
        while let Some(window) = self.waiting.front().copied()
            && window.end + LAGS as f64 * LAG + HISTORY_STEP <= sample.time
        {
            self.waiting.pop_front();
            self.compare(&window);
        }
    }

    /// Body axes turn by `c`: what each of them has shown begins again.
    pub(super) fn turn(&mut self, c: &Matrix3) {
        let entries = self.history.iter_mut().map(|(_, sums)| sums);
        for sums in entries.chain([&mut self.sums]) {
            sums.angle = c * sums.angle;
            sums.velocity = c * sums.velocity;
        }
        self.axes = Default::default();
        self.pushes = Default::default();
        self.gains = [OnForce::default(); 2 * SPEED_LAGS + 1];
        self.swings = self.gains;
        self.changes.turn();
    }

    /// Ends the log: what still waits is compared with what there is.
    pub(super) fn finish(&mut self) {
        while let Some(window) = self.waiting.pop_front() {
            self.compare(&window);
        }
    }

    /// Takes in a velocity over ground at `time` \[s\] and its horizontal variance [m²/s²].
    pub(super) fn velocity(&mut self, time: f64, velocity: &Vector3, variance: f64) {
        let speed = velocity.xy().norm();
        let noise = variance / (speed * speed);
        if speed < COURSE_SPEED || noise > COURSE_STD * COURSE_STD {
            self.course = None;
            return;
        }
        let course = velocity.y.atan2(velocity.x);
        let Some((start, before, slow)) = self.course else {
            self.course = Some((time, course, speed));
            return;
        };
        if time - start < TURN_WINDOW[0] {
            return;
        }
        self.course = Some((time, course, speed));
        let turn = wrap_pi(course - before);
        if time - start <= TURN_WINDOW[1] && turn.abs() < MOST_TURN {
            self.noise += 2.0 * noise;
            self.waiting.push_back(Turn {
                start,
                end: time,
                turn,
                noise: 2.0 * noise,
                speed: 0.5 * (slow + speed),
                faster: speed - slow,
            });
        }
    }

    /// What was gathered until `time` \[s\], if that is in the history.
    ///
    /// Linear between two entries of the history, a tenth of a second apart.
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

    /// Yaw of the history at a time; `after` is the first entry that is not before an earlier time, and moves on.
    ///
    /// For lags in ascending order: the search goes on from where the last one ended, O(1)
    /// amortised.
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
    ///
    /// A lag beyond the history is left without this window.
    fn compare(&mut self, window: &Turn) {
        let mut after = [0; 2];
        for k in 0..self.lags.len() {
            let late = (k as f64 - LAGS as f64) * LAG;
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
        for k in 0..self.gains.len() {
            let late = (k as f64 - SPEED_LAGS as f64) * SPEED_LAG;
            let then = [window.start, window.end].map(|time| self.sums_at(time + late));
            if let [Some(from), Some(to)] = then {
                let force = to.velocity - from.velocity;
                self.gains[k].add(&force, window.faster);
                self.swings[k].add(&force, window.speed * (b.yaw - a.yaw));
            }
        }
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
        self.changes.add(&Compared {
            start: window.start,
            end: window.end,
            turn: window.turn,
            noise: window.noise,
            gyro: b.yaw - a.yaw,
            force: [force.x, force.y],
            seen,
        });
    }

    /// What a sensor does otherwise from some time on, where body down is `level`.
    pub(super) fn change(&self, level: bool) -> Option<SensorChange> {
        self.changes.finding(level)
    }

    /// Whether turns show enough above the noise of the courses to judge by.
    fn is_enough(&self) -> bool {
        let now = &self.lags[LAGS];
        let signal = now.power() - self.noise;
        signal > ENOUGH_TURN && signal > 2.0 * self.noise
    }

    /// What is late of velocities, gyros and accelerometers: the velocities against the gyros' turns, and the accelerometers against
    /// the gyros.
    ///
    /// The latter in two ways, of which the smaller counts: gains of speed against turns, both by the velocities, whose
    /// speed may lag otherwise than their course; and what pushes a vehicle to the side against speed times the gyros' turns, which an
    /// IMU ahead of the axle feels earlier. Both look earlier in sound cars: accelerometers that are earlier are not named.
    pub(super) fn late(&self) -> Vec<Mismatch> {
        let near = &self.lags[LAGS - NEAR_LAGS..=LAGS + NEAR_LAGS];
        let enough = self.is_enough() && near[NEAR_LAGS].n >= LAG_WINDOWS;
        let first = -LAG * NEAR_LAGS as f64;
        let Some(turns) =
            lags::best(near.iter().map(Regression::determined), first, LAG).filter(|_| enough)
        else {
            return Vec::new();
        };
        let mut found = Vec::new();
        if turns.lag < -LATE.max(SIGMAS * turns.std).max(self.interval) {
            found.push(Mismatch::LateVelocities {
                delay: -turns.lag,
                beyond: None,
            });
        }
        let ways = [&self.gains, &self.swings].map(|rows| {
            let pushed = rows[SPEED_LAGS].power() > ENOUGH_PUSH;
            let first = -SPEED_LAG * SPEED_LAGS as f64;
            lags::best(rows.iter().map(OnForce::determined), first, SPEED_LAG).filter(|_| pushed)
        });
        if let [Some(gains), Some(swings)] = ways {
            let gains = gains.less(&turns);
            let sure = |of: &Lag| of.lag > LATE.max(SIGMAS * of.std);
            if [gains, swings].iter().all(sure) {
                found.push(Mismatch::LateAccelerometers(gains.lag.min(swings.lag)));
            }
        }
        found
    }

    /// Whether the vehicle accelerates along body forward, and is pushed along body right in turns.
    ///
    /// Axes as ±1 (forward) and ±2 (right): along which body axis the vehicle accelerates when its
    /// speed grows, and when it turns right; `None` where neither axis explains it (r² above 0.6 of
    /// one, below 0.3 of the other). `Some` only where one of both is not as promised.
    pub(super) fn pushes(&self) -> Option<Implausible> {
        let along = |of: usize| -> Option<i8> {
            let [x, y] = [&self.pushes[of][0], &self.pushes[of][1]];
            if x.power() < ENOUGH_PUSH {
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
    ///
    /// At most one lag and one of axis, scale, none: in that order of precedence.
    pub(super) fn turns(&self, down: &Vector3) -> Vec<Implausible> {
        let now = &self.lags[LAGS];
        if !self.is_enough() {
            return Vec::new();
        }
        let (mut scale, mut r2) = now.fit();
        let mut found = Vec::new();
        let fits = self.lags.iter().map(|lag| match lag {
            lag if lag.n >= LAG_WINDOWS && lag.power() > 0.5 * now.power() => lag.fit(),
            _ => (0.0, 0.0),
        });
        let best = fits.enumerate().max_by(|a, b| a.1.1.total_cmp(&b.1.1));
        if let Some((k, (there, best))) = best
            && best > 0.8
            && 1.0 - r2 > 4.0 * (1.0 - best) + 0.05
        {
            let late = (k as f64 - LAGS as f64) * LAG;
            if late.abs() > self.interval {
                found.push(Implausible::Late(late));
            }
            (scale, r2) = (there, best);
        }
        let of_axis = self.axes.iter().map(Regression::fit).enumerate();
        let best = of_axis.max_by(|a, b| a.1.1.total_cmp(&b.1.1));
        match best {
            Some((axis, (of, best)))
                if best > 0.9
                    && best > r2
                    && down[axis].abs() < 0.3
                    && TURN_SCALE.contains(&of.abs()) =>
            {
                found.push(Implausible::TurnAxis(axis));
            }
            _ if r2 > 0.7 && !TURN_SCALE.contains(&scale) => {
                found.push(Implausible::TurnScale(scale));
            }
            _ if r2 < 0.1 => found.push(Implausible::NoTurn),
            _ => {}
        }
        found
    }
}

#[cfg(test)]
mod tests;
