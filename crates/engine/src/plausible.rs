//! Whether samples and fixes can be of one vehicle: units, axes, signs and time bases that are wrong.
//!
//! A wrong unit or a swapped column lets a filter run on with fixes rejected and covariances enlarged,
//! which hides the cause. Three things are known whatever the noise model says: the specific force is
//! gravity on the average; the course of a vehicle turns as its gyros say; positions move as velocities
//! say. Streamed: sums and a bounded window are kept.
//!
//! | finding | from |
//! |---|---|
//! | gravity | the mean specific force of one-second blocks: fewer than a tenth between 0.7 and 1.4 of gravity; exchanged where the gyros' size is steady in its place |
//! | down | its direction against body down, where axes are promised to be forward, right, down |
//! | turns: scale, axis, late, none | regression of the course's turns on those of the gyros, at lags of −30 to 30 s |
//! | pushes | regression of accelerations over ground on specific force along forward and right |
//! | velocity | displacements against integrated velocity, and which of eleven mistakes explains the difference |
//! | changed | the same regressions on either side of some time |
//! | velocity scale | displacements against integrated velocity: a multiple beyond chance |
//! | late velocities, accelerometers | lags of turns and of gains of speed |
//! | held positions | steps from where a receiver stood still to where it is |
//! | alternates | changes of the slope of positions that alternate: two receivers in one log |
//!
//! Each needs enough of what it judges by (turns, accelerations, ways); without it says nothing. None changes
//! the solution: they are named beside it.

mod alternation;
mod changes;
mod held;
mod lags;
mod moves;
mod regression;
mod turns;

use crate::{align::Heading, derived::Positions, settings::Settings};
use alloc::vec::Vec;
use alternation::Alternation;
use core::ops::Range;
use held::Held;
use moves::Moves;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use turns::Turns;
use undrift_events::{Implausible, Mismatch};
use undrift_nav::{
    Matrix3, Vector3,
    earth::STANDARD_GRAVITY,
    sample::{GnssFix, ImuSample},
};

/// Fixes further apart than this do not belong together \[s\].
const APART: f64 = 2.5;
/// Length of the blocks that specific force is averaged over \[s\].
const BLOCK: f64 = 1.0;
/// Blocks that it takes to judge.
const LEAST_BLOCKS: u32 = 10;
/// Multiples of gravity that a block of a vehicle has.
const GRAVITY: Range<f64> = 0.7..1.4;
/// Least share of blocks with such a multiple.
const LEAST_SHARE: f64 = 0.1;
/// Variance of the logarithm of a block's size, at most where it is that of gravity: a standard deviation of 15 %.
const STEADY: f64 = 0.0225;
/// Cosine of the angle between gravity and body down below which axes are not forward, right, down.
const DOWN: f64 = 0.5;

/// Cosine of that angle from which the two others are level enough for their accelerations to be compared.
const LEVEL: f64 = 0.9;

/// Whether body axes are promised to be forward, right, down.
fn promises_level(settings: &Settings) -> bool {
    settings.align.attitude.is_none()
        && (settings.align.heading == Heading::Course
            || settings.constraints.non_holonomic.is_some())
}

/// Sums of logarithms and of their squares.
#[derive(Clone, Copy, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
struct Logarithms {
    sum: f64,
    squares: f64,
}

impl Logarithms {
    fn add(&mut self, size: f64) {
        let logarithm = size.max(1e-9).ln();
        self.sum += logarithm;
        self.squares += logarithm * logarithm;
    }

    fn mean(&self, count: f64) -> f64 {
        self.sum / count
    }

    fn variance(&self, count: f64) -> f64 {
        self.squares / count - self.mean(count) * self.mean(count)
    }
}

/// What is known so far.
#[derive(Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Plausible {
    /// Whether body axes are promised to be forward, right, down.
    level: bool,
    /// Specific force of the present block [m/s], the turn in it \[rad\], its length \[s\].
    block: (Vector3, Vector3, f64),
    /// Sum of the directions of the blocks' specific force: n times as long as they agree.
    direction: Vector3,
    /// Logarithms of the specific force over gravity, whose mean is that of a wrong unit's factor, and of the turn rate.
    force: Logarithms,
    rate: Logarithms,
    /// Number of blocks, and of those whose force is one of a vehicle.
    blocks: u32,
    sound: u32,
    turns: Turns,
    moves: Moves,
    alternation: Alternation,
    held: Held,
    positions: Positions,
}

impl Plausible {
    pub(super) fn new(settings: &Settings) -> Self {
        Self {
            level: promises_level(settings),
            block: Default::default(),
            direction: Vector3::zeros(),
            force: Logarithms::default(),
            rate: Logarithms::default(),
            blocks: 0,
            sound: 0,
            turns: Turns::new(),
            moves: Moves::default(),
            alternation: Alternation::default(),
            held: Held::default(),
            positions: Positions::default(),
        }
    }

    /// Body axes turn by `c`; of which kind they are from now on, `settings` says.
    pub(super) fn turn(&mut self, c: &Matrix3, settings: &Settings) {
        self.level = promises_level(settings);
        self.block.0 = c * self.block.0;
        self.block.1 = c * self.block.1;
        self.direction = c * self.direction;
        self.turns.turn(c);
    }

    /// Takes in a sample.
    pub(super) fn sample(&mut self, sample: &ImuSample) {
        self.block.0 += sample.dvel;
        self.block.1 += sample.dtheta;
        self.block.2 += sample.dt;
        if self.block.2 >= BLOCK {
            let (sum, turn, length) = core::mem::take(&mut self.block);
            let ratio = sum.norm() / length / STANDARD_GRAVITY;
            let rate = turn.norm() / length;
            if ratio.is_finite() && rate.is_finite() {
                self.blocks += 1;
                self.sound += u32::from(GRAVITY.contains(&ratio));
                self.force.add(ratio);
                self.rate.add(rate);
                self.direction += sum.try_normalize(1e-9).unwrap_or_else(Vector3::zeros);
            }
        }
        self.turns
            .sample(sample, self.direction.try_normalize(1e-9));
    }

    /// Takes in a fix.
    ///
    /// Velocities of a fix, or derived from positions where it has none.
    pub(super) fn fix(&mut self, fix: &GnssFix) {
        self.alternation.fix(fix);
        self.held.fix(fix);
        if let Some((velocity, r)) = &fix.velocity {
            let variance = r.fixed_view::<2, 2>(0, 0).trace() / 2.0;
            self.turns.velocity(fix.time, velocity, variance);
            self.moves.fix(fix, velocity);
        } else if let Some(derived) = self.positions.add(fix) {
            let variance = derived.covariance.fixed_view::<2, 2>(0, 0).trace() / 2.0;
            self.turns.velocity(derived.time, &derived.v_n, variance);
        }
    }

    /// What of samples and fixes does not go together and is no error of the configuration, after [`Plausible::findings`].
    pub(super) fn mismatches(&self) -> Vec<Mismatch> {
        let held = self.held.finding();
        self.turns.late().into_iter().chain(held).collect()
    }

    /// What cannot be, at the end of the log.
    ///
    /// Where positions and velocities do not belong together, turns and pushes are not judged: the course would
    /// be no measure of the sensors.
    pub(super) fn findings(&mut self) -> Vec<Implausible> {
        self.turns.finish();
        let mut found = Vec::new();
        found.extend(self.alternation.distance().map(Implausible::Alternates));
        let blocks = f64::from(self.blocks);
        let down = self.direction.try_normalize(0.5 * blocks).map(|up| -up);
        if self.blocks >= LEAST_BLOCKS {
            if f64::from(self.sound) < LEAST_SHARE * blocks {
                let ratio = self.force.mean(blocks).exp();
                let [force, rate] = [&self.force, &self.rate].map(|size| size.variance(blocks));
                let exchanged = rate < STEADY && 4.0 * rate < force;
                found.push(Implausible::Gravity { ratio, exchanged });
                if exchanged {
                    return found;
                }
            }
            if let Some(down) = down.filter(|down| self.level && down.z < DOWN) {
                found.push(Implausible::Down(down.into()));
            }
        }
        if let Some(wrong) = self.moves.scale().or_else(|| self.moves.finding()) {
            // Then the course is no measure of the sensors.
            found.push(wrong);
        } else if let Some(down) = down {
            // What changes is neither right nor wrong in the whole log; another axis is wrong in all of it.
            let of_turns = self.turns.turns(&down);
            let of_axis = |of: &Implausible| matches!(of, Implausible::TurnAxis(_));
            let changed = self.turns.change(down.z.abs() > LEVEL);
            if let Some(changed) = changed.filter(|_| !of_turns.iter().any(of_axis)) {
                found.push(Implausible::Changed(changed));
            } else {
                found.extend(of_turns);
                if self.level && down.z > DOWN {
                    found.extend(self.turns.pushes());
                }
            }
        }
        found
    }
}
