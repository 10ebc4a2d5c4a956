//! Whether samples and fixes can be of one vehicle: units, axes, signs and time bases that are wrong.
//!
//! A wrong unit or a swapped column lets a filter struggle on with fixes left out and weights enlarged,
//! which hides the cause. Three things are known whatever the noise model says: the specific force is
//! gravity on the average; the course of a vehicle turns as its gyros say; positions move as velocities
//! say. Streamed: sums and a bounded window are kept.

use super::Settings;
use crate::align::Heading;
use serde::Serialize;
use std::collections::VecDeque;
use undrift_nav::{
    Vector3,
    earth::{Geodetic, STANDARD_GRAVITY, wrap_pi},
    sample::{GnssFix, ImuSample, Position},
};

/// What cannot be.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Implausible {
    /// The mean specific force, as a multiple of gravity.
    Gravity(f64),
    /// Gravity lies along another axis than body down, which is `[0, 0, 1]` of it.
    Down([f64; 3]),
    /// The course turns by this multiple of what the gyros say.
    TurnScale(f64),
    /// The course turns as the gyro of this axis says (0 to 2), which is not the vertical one.
    TurnAxis(usize),
    /// The gyros do not see the turns of the course.
    NoTurn,
    /// The gyros saw the turns so much later than the course's stamps say [s].
    Late(f64),
    /// The body axis along which the vehicle accelerates and the one along which it is pushed in turns to
    /// the right: 1 forward, 2 right, with sign, as far as that is seen.
    Push {
        /// When it accelerates: to be 1.
        forward: Option<i8>,
        /// In turns to the right: to be 2.
        right: Option<i8>,
    },
    /// Positions move as the velocities say only if something is changed; `None` where nothing simple is.
    Velocity(Option<&'static str>),
}

/// Length of the blocks that specific force is averaged over [s], and how many there must be.
const BLOCK: f64 = 1.0;
const LEAST_BLOCKS: u32 = 10;
/// Multiples of gravity that a block of a vehicle may have, and the least share of such blocks.
const GRAVITY: std::ops::Range<f64> = 0.7..1.4;
const LEAST_SHARE: f64 = 0.1;
/// Cosine of the angle between gravity and body down below which axes are not forward, right, down.
const DOWN: f64 = 0.5;

/// Speed below which there is no course [m/s], and its largest standard deviation [rad].
const COURSE_SPEED: f64 = 3.0;
const COURSE_STD: f64 = 0.1;
/// Length of a turn's window [s]; what turns further in it is an outlier [rad].
const TURN_WINDOW: std::ops::Range<f64> = 0.9..2.5;
const MOST_TURN: f64 = 1.0;
/// Sum of squares of the turns that is enough to judge by [rad²]: one right-angle bend.
const ENOUGH_TURN: f64 = 0.25;
/// Lags at which turns are compared: so many steps of so many seconds to each side.
const LAGS: usize = 120;
const LAG: f64 = 0.25;
/// Windows that have to be compared before a lag is believed.
const LAG_WINDOWS: f64 = 20.0;
/// From one entry of the history of turns to the next [s].
const HISTORY_STEP: f64 = 0.1;
/// Multiples of the gyros' turns that the course may turn by: a bank makes 1/cos of it.
const TURN_SCALE: std::ops::Range<f64> = 0.6..1.7;

/// Length of the windows over which position and velocity are compared [s], and how many there must be.
const MOVE_WINDOW: f64 = 2.0;
const LEAST_MOVES: u32 = 8;
/// Fixes further apart than this do not belong together [s].
const APART: f64 = 2.5;
/// Least share of windows of motion that are as they should be.
const LEAST_SANE: f64 = 0.4;
/// Sum of squares of the accelerations that is enough to judge by [m²/s⁴]: some ten seconds of 0.5 m/s².
const ENOUGH_PUSH: f64 = 2.5;
/// Two displacements agree to this part of the larger one.
const AGREE: f64 = 0.2;

/// What a velocity may be instead of north, east in m/s, and the matrix that mends it.
const MENDS: [(&str, [f64; 4]); 12] = [
    ("", [1.0, 0.0, 0.0, 1.0]),
    (
        "the velocity is east, north, not north, east",
        [0.0, 1.0, 1.0, 0.0],
    ),
    ("latitude and longitude are swapped", [0.0, 1.0, 1.0, 0.0]),
    (
        "the velocity east (or the longitude) has the wrong sign",
        [1.0, 0.0, 0.0, -1.0],
    ),
    (
        "the velocity north (or the latitude) has the wrong sign",
        [-1.0, 0.0, 0.0, 1.0],
    ),
    ("the velocity has the wrong signs", [-1.0, 0.0, 0.0, -1.0]),
    ("the velocity is in km/h", [1.0 / 3.6, 0.0, 0.0, 1.0 / 3.6]),
    ("the velocity is in knots", [0.514_444, 0.0, 0.0, 0.514_444]),
    ("the velocity is in ft/s", [0.3048, 0.0, 0.0, 0.3048]),
    ("the velocity is in cm/s", [0.01, 0.0, 0.0, 0.01]),
    ("the velocity is in mm/s", [0.001, 0.0, 0.0, 0.001]),
    (
        "latitude and longitude are in rad, not deg",
        [0.017_453_3, 0.0, 0.0, 0.017_453_3],
    ),
];
/// Place of swapped latitude and longitude in [`MENDS`].
const SWAPPED: usize = 2;

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

/// Angles about the vertical and about the body axes [rad], and specific force over time [m/s], body axes.
#[derive(Clone, Copy, Default)]
struct Sums {
    yaw: f64,
    angle: Vector3,
    velocity: Vector3,
}

/// What a vehicle did over ground from `start` to `end` [s].
#[derive(Clone, Copy)]
struct Turn {
    start: f64,
    end: f64,
    /// Of the course [rad].
    turn: f64,
    /// On the average, and by how much it grew [m/s].
    speed: f64,
    faster: f64,
}

/// A fix with velocity: time [s], velocity and position.
type Place = (f64, Vector3, Option<(Geodetic, f64)>);

/// What is known so far.
pub(super) struct Plausible {
    /// Whether body axes are promised to be forward, right, down.
    level: bool,
    /// Specific force of the present block [m/s], its length [s].
    block: (Vector3, f64),
    /// Sum of the directions of the blocks' specific force, of the logarithms of its size over gravity,
    /// their number, and that of those of a vehicle.
    direction: Vector3,
    logarithms: f64,
    blocks: u32,
    sound: u32,
    /// What was gathered since the start, now and at the last times in order.
    sums: Sums,
    history: VecDeque<(f64, Sums)>,
    /// Where the present window of turning began: time [s], course [rad] and speed [m/s].
    course: Option<(f64, f64, f64)>,
    /// Windows whose later samples are still to come.
    waiting: VecDeque<Turn>,
    /// Of the turns on those of the vertical at each lag, and of each axis at none.
    lags: [Regression; 2 * LAGS + 1],
    axes: [Regression; 3],
    /// Of the accelerations along the course and to its right on the forces along forward and right.
    pushes: [[Regression; 2]; 2],
    /// Sum of the variances of the turns that noise makes [rad²].
    noise: f64,
    /// The last fix, where the present window of motion began, and how far velocity went since [m].
    last: Option<Place>,
    began: Option<(f64, Geodetic)>,
    moved: Vector3,
    /// Windows of motion, those that are as they should be, and the sum of what each of [`MENDS`] leaves
    /// unexplained.
    moves: u32,
    sane: u32,
    unexplained: [f64; MENDS.len()],
}

impl Plausible {
    pub(super) fn new(settings: &Settings) -> Self {
        Self {
            level: settings.align.attitude.is_none() && settings.align.heading == Heading::Course,
            block: (Vector3::zeros(), 0.0),
            direction: Vector3::zeros(),
            logarithms: 0.0,
            blocks: 0,
            sound: 0,
            sums: Sums::default(),
            history: VecDeque::new(),
            course: None,
            waiting: VecDeque::new(),
            lags: [Regression::default(); 2 * LAGS + 1],
            axes: [Regression::default(); 3],
            pushes: [[Regression::default(); 2]; 2],
            noise: 0.0,
            last: None,
            began: None,
            moved: Vector3::zeros(),
            moves: 0,
            sane: 0,
            unexplained: [0.0; MENDS.len()],
        }
    }

    /// Takes in a sample.
    pub(super) fn sample(&mut self, sample: &ImuSample) {
        self.block.0 += sample.dvel;
        self.block.1 += sample.dt;
        if self.block.1 >= BLOCK {
            let (sum, length) = std::mem::replace(&mut self.block, (Vector3::zeros(), 0.0));
            let ratio = sum.norm() / length / STANDARD_GRAVITY;
            if ratio.is_finite() {
                self.blocks += 1;
                self.sound += u32::from(GRAVITY.contains(&ratio));
                self.logarithms += ratio.max(1e-9).ln();
                self.direction += sum.try_normalize(1e-9).unwrap_or_else(Vector3::zeros);
            }
        }
        if let Some(up) = self.direction.try_normalize(1e-9) {
            self.sums.yaw -= sample.dtheta.dot(&up);
        }
        self.sums.angle += sample.dtheta;
        self.sums.velocity += sample.dvel;
        if self
            .history
            .back()
            .is_none_or(|(last, ..)| sample.time - last >= HISTORY_STEP)
        {
            self.history.push_back((sample.time, self.sums));
            let keep = 2.0 * LAGS as f64 * LAG + 2.0 * TURN_WINDOW.end;
            while let Some((first, ..)) = self.history.front()
                && sample.time - first > keep
            {
                self.history.pop_front();
            }
            while let Some(window) = self.waiting.front()
                && window.end + LAGS as f64 * LAG + HISTORY_STEP <= sample.time
            {
                let window = *window;
                self.waiting.pop_front();
                self.compare(&window);
            }
        }
    }

    /// Takes in a fix.
    pub(super) fn fix(&mut self, fix: &GnssFix) {
        let Some((velocity, r)) = &fix.velocity else {
            return;
        };
        let variance = r.fixed_view::<2, 2>(0, 0).trace() / 2.0;
        self.turn(fix.time, velocity, variance);
        let place = match &fix.position {
            Some((Position::Geodetic(place), r)) => {
                Some((*place, r.fixed_view::<2, 2>(0, 0).trace().sqrt()))
            }
            _ => None,
        };
        self.motion((fix.time, *velocity, place));
    }

    fn turn(&mut self, time: f64, velocity: &Vector3, variance: f64) {
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
        if time - start < TURN_WINDOW.start {
            return;
        }
        self.course = Some((time, course, speed));
        let turn = wrap_pi(course - before);
        if time - start <= TURN_WINDOW.end && turn.abs() < MOST_TURN {
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

    /// What was gathered until `time` [s], if that is in the history.
    fn sums_at(&self, time: f64) -> Option<Sums> {
        let after = self.history.partition_point(|entry| entry.0 < time);
        let (a, b) = (
            self.history.get(after.checked_sub(1)?)?,
            self.history.get(after)?,
        );
        let part = (time - a.0) / (b.0 - a.0);
        Some(Sums {
            yaw: a.1.yaw + part * (b.1.yaw - a.1.yaw),
            angle: a.1.angle.lerp(&b.1.angle, part),
            velocity: a.1.velocity.lerp(&b.1.velocity, part),
        })
    }

    /// Compares what a vehicle did over ground with what its sensors saw, turns at every lag.
    fn compare(&mut self, window: &Turn) {
        for k in 0..self.lags.len() {
            let late = (k as f64 - LAGS as f64) * LAG;
            let (start, end) = (window.start + late, window.end + late);
            let (Some(a), Some(b)) = (self.sums_at(start), self.sums_at(end)) else {
                continue;
            };
            self.lags[k].add(b.yaw - a.yaw, window.turn);
            if k != LAGS {
                continue;
            }
            for (axis, regression) in self.axes.iter_mut().enumerate() {
                regression.add(b.angle[axis] - a.angle[axis], window.turn);
            }
            let span = end - start;
            let force = (b.velocity - a.velocity) / span;
            let seen = [window.faster, window.speed * window.turn].map(|change| change / span);
            for (seen, regressions) in seen.into_iter().zip(&mut self.pushes) {
                for (axis, regression) in regressions.iter_mut().enumerate() {
                    regression.add(force[axis], seen);
                }
            }
        }
    }

    fn motion(&mut self, place: Place) {
        let (time, velocity, position) = place;
        let last = self.last.replace(place);
        let Some((position, std)) = position else {
            self.began = None;
            return;
        };
        let (Some((last, before, _)), Some((start, origin))) = (last, self.began) else {
            (self.began, self.moved) = (Some((time, position)), Vector3::zeros());
            return;
        };
        self.moved += (velocity + before) * (0.5 * (time - last));
        if time - last <= APART && time - start < MOVE_WINDOW {
            return;
        }
        let (seen, told) = (origin.offset_to(&position), self.moved);
        let together = time - last <= APART;
        (self.began, self.moved) = (Some((time, position)), Vector3::zeros());
        let size = seen.xy().norm().max(told.xy().norm());
        // Noise of two positions is to be small against the way.
        if !together || size < 2.0 + 10.0 * std || !size.is_finite() {
            return;
        }
        self.moves += 1;
        for (k, (_, matrix)) in MENDS.iter().enumerate() {
            let [nn, mut ne, mut en, ee] = *matrix;
            if k == SWAPPED {
                // The circle of latitude that is meant is that of the longitude given.
                (ne, en) = (1.0 / position.lon.cos(), position.lat.cos());
            }
            let mended = [nn * told.x + ne * told.y, en * told.x + ee * told.y];
            let size = seen.xy().norm().max(mended[0].hypot(mended[1]));
            let left = (seen.x - mended[0]).hypot(seen.y - mended[1]);
            self.unexplained[k] += (left / size).min(1.0);
            self.sane += u32::from(k == 0 && left < AGREE * size + 3.0 * std);
        }
    }

    /// What cannot be, at the end of the log.
    pub(super) fn findings(&mut self) -> Vec<Implausible> {
        while let Some(window) = self.waiting.pop_front() {
            self.compare(&window);
        }
        let mut found = Vec::new();
        let blocks = f64::from(self.blocks);
        if self.blocks >= LEAST_BLOCKS {
            if f64::from(self.sound) < LEAST_SHARE * blocks {
                found.push(Implausible::Gravity((self.logarithms / blocks).exp()));
            }
            if self.level
                && let Some(up) = self.direction.try_normalize(0.5 * blocks)
                && -up.z < DOWN
            {
                found.push(Implausible::Down((-up).into()));
            }
        }
        let moves = f64::from(self.moves);
        if self.moves >= LEAST_MOVES && f64::from(self.sane) < LEAST_SANE * moves {
            let best = (1..MENDS.len())
                .min_by(|a, b| self.unexplained[*a].total_cmp(&self.unexplained[*b]))
                .filter(|k| self.unexplained[*k] < AGREE * moves);
            found.push(Implausible::Velocity(best.map(|k| MENDS[k].0)));
            return found;
        }
        if let Some(up) = self.direction.try_normalize(0.5 * blocks) {
            found.extend(self.turns(&-up));
            if self.level && -up.z > DOWN {
                found.extend(self.pushes());
            }
        }
        found
    }

    /// Whether the vehicle accelerates along body forward, and is pushed along body right in turns.
    fn pushes(&self) -> Option<Implausible> {
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

    fn turns(&self, down: &Vector3) -> Vec<Implausible> {
        let now = &self.lags[LAGS];
        let signal = now.power() - self.noise;
        if signal < ENOUGH_TURN || signal < 2.0 * self.noise {
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
            found.push(Implausible::Late((k as f64 - LAGS as f64) * LAG));
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
