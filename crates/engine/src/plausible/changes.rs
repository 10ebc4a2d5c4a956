//! Whether a sensor measures the motion from some time on otherwise than before: a unit or a range that changes, an IMU that is turned.
//!
//! What fixes and sensors say of each window of about a second ([`super::turns`]) is summed in at most [`BLOCKS`] blocks in order of
//! time. At the end the log is cut between two of them where two regressions, one of either side, leave least, and the slopes
//! are compared.
//!
//! | finding | from |
//! |---|---|
//! | scale, none | turns of the course on turns of the vertical gyro; another slope, or none |
//! | turned | accelerations over ground on the two horizontal specific forces; a rotation from one side to the other |
//! | force scale | the same; one of the two a multiple |
//!
//! Sums about the means: a bias and its changes do not count. A scale between 0.6 and 1.7 is left to the states of the filter, and
//! to the banks of those that lean into turns.

use super::regression::{ENOUGH_PUSH, ENOUGH_TURN, Regression, TURN_SCALE};
use alloc::vec::Vec;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::{ComplexField, RealField};
use nalgebra::{Matrix2, Vector2};
use undrift_events::{ChangeOf, SensorChange};

/// Most blocks; where there are more, two become one.
const BLOCKS: usize = 64;
/// Windows of a block at first.
const WINDOWS: u32 = 8;
/// Windows on either side that it takes to compare.
const LEAST_WINDOWS: f64 = 20.0;
/// Coefficients of determination on either side that turns and accelerations have to have, and below which there is nothing left.
const FITS: f64 = 0.8;
const FITS_PUSH: f64 = 0.5;
const NOTHING: f64 = 0.1;
/// What one regression of both sides leaves, at least, over what one of either side does.
const BETTER: f64 = 2.0;
const BETTER_PUSH: f64 = 1.5;
/// An angle from which an IMU is turned, rather than a mounting a little wrong \[rad\].
const TURNED: f64 = 0.35;
/// Largest share of what a rotation or a scale does not explain of the change.
const REST: f64 = 0.35;

/// Sums of accelerations over ground, along the course and to its right, and of horizontal specific forces.
#[derive(Clone, Copy, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
struct Push {
    n: f64,
    force: Vector2<f64>,
    seen: Vector2<f64>,
    force_force: Matrix2<f64>,
    /// Seen by row, force by column.
    seen_force: Matrix2<f64>,
    seen_seen: Vector2<f64>,
}

/// Of accelerations: the map from specific force to what is seen, what it leaves, and the scatter, by output.
struct PushFit {
    map: Matrix2<f64>,
    left: Vector2<f64>,
    power: Vector2<f64>,
}

impl Push {
    fn add(&mut self, force: Vector2<f64>, seen: Vector2<f64>) {
        self.join(&Self {
            n: 1.0,
            force,
            seen,
            force_force: force * force.transpose(),
            seen_force: seen * force.transpose(),
            seen_seen: seen.component_mul(&seen),
        });
    }

    fn join(&mut self, other: &Self) {
        self.n += other.n;
        self.force += other.force;
        self.seen += other.seen;
        self.force_force += other.force_force;
        self.seen_force += other.seen_force;
        self.seen_seen += other.seen_seen;
    }

    fn fit(&self) -> Option<PushFit> {
        let n = self.n.max(1.0);
        let of_force = self.force_force - self.force * self.force.transpose() / n;
        let both = self.seen_force - self.seen * self.force.transpose() / n;
        let power = self.seen_seen - self.seen.component_mul(&self.seen) / n;
        let map = both * of_force.try_inverse()?;
        let left = Vector2::new(0, 1).map(|k| power[k] - map.row(k).dot(&both.row(k)));
        Some(PushFit { map, left, power })
    }
}

/// What the windows from `start` to `end` \[s\] say.
#[derive(Clone, Copy, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
struct Block {
    start: f64,
    end: f64,
    windows: u32,
    turns: Regression,
    /// Sum of the variances of the turns that noise makes \[rad²\].
    noise: f64,
    push: Push,
}

impl Block {
    fn join(&mut self, other: &Self) {
        if self.windows == 0 {
            self.start = other.start;
        }
        self.end = other.end;
        self.windows += other.windows;
        self.turns.join(&other.turns);
        self.noise += other.noise;
        self.push.join(&other.push);
    }
}

/// A window: times \[s\], turns \[rad\] of the course, with their variance \[rad²\], and of the gyros, specific force along body
/// forward and right and accelerations along the course and to its right [m/s²].
pub(super) struct Compared {
    pub(super) start: f64,
    pub(super) end: f64,
    pub(super) turn: f64,
    pub(super) noise: f64,
    pub(super) gyro: f64,
    pub(super) force: [f64; 2],
    pub(super) seen: [f64; 2],
}

/// What is known so far.
#[derive(Clone, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Changes {
    blocks: Vec<Block>,
    /// Windows of a block.
    windows: u32,
}

impl Changes {
    pub(super) fn add(&mut self, window: &Compared) {
        let mut one = Block {
            start: window.start,
            end: window.end,
            windows: 1,
            noise: window.noise,
            ..Block::default()
        };
        one.turns.add(window.gyro, window.turn);
        one.push.add(window.force.into(), window.seen.into());
        self.windows = self.windows.max(WINDOWS);
        match self.blocks.last_mut() {
            Some(last) if last.windows < self.windows => last.join(&one),
            _ => self.blocks.push(one),
        }
        if self.blocks.len() > BLOCKS {
            let pairs = self.blocks.chunks(2).map(|pair| {
                let mut both = pair[0];
                pair[1..].iter().for_each(|second| both.join(second));
                both
            });
            self.blocks = pairs.collect();
            self.windows *= 2;
        }
    }

    /// Body axes are others from now on: what the accelerometers have shown begins again.
    pub(super) fn turn(&mut self) {
        for block in &mut self.blocks {
            block.push = Push::default();
        }
    }

    /// The change that is seen, if one is; of accelerations only where body down is `level`.
    pub(super) fn finding(&self, level: bool) -> Option<SensorChange> {
        let splits = (1..self.blocks.len()).map(|k| {
            let of = |blocks: &[Block]| {
                blocks.iter().fold(Block::default(), |mut all, block| {
                    all.join(block);
                    all
                })
            };
            let (before, after) = self.blocks.split_at(k);
            [of(before), of(after)]
        });
        let splits: Vec<_> = splits
            .filter(|sides| sides.iter().all(|side| side.turns.n >= LEAST_WINDOWS))
            .collect();
        let best = |left: &dyn Fn(&[Block; 2]) -> Option<f64>| {
            let scored = splits
                .iter()
                .filter_map(|sides| Some((left(sides)?, sides)));
            scored.min_by(|a, b| a.0.total_cmp(&b.0))
        };
        let turns = best(&|sides| Some(sides.iter().map(|side| side.turns.left()).sum()))
            .and_then(|(left, sides)| Some((turn_change(left, sides)?, sides)));
        let changed = turns.or_else(|| {
            let left = |sides: &[Block; 2]| {
                let [before, after] = sides.each_ref().map(|side| side.push.fit());
                Some(product(&(before?.left + after?.left)))
            };
            let (left, sides) = best(&left).filter(|_| level)?;
            Some((push_change(left, sides)?, sides))
        });
        let (what, [before, after]) = changed?;
        Some(SensorChange {
            between: [before.end, after.start],
            what,
        })
    }
}

/// Of what is left of both accelerations: each counts by its own size.
fn product(left: &Vector2<f64>) -> f64 {
    left.x * left.y
}

/// Another slope of the turns after than before, or none.
fn turn_change(left: f64, sides: &[Block; 2]) -> Option<ChangeOf> {
    let [before, after] = sides;
    let enough = |side: &Block| {
        let signal = side.turns.power() - side.noise;
        signal > ENOUGH_TURN && signal > 2.0 * side.noise
    };
    let mut all = before.turns;
    all.join(&after.turns);
    if !(enough(before) && enough(after)) {
        return None;
    }
    let ((slope, fits), (then, still)) = (before.turns.fit(), after.turns.fit());
    if fits < FITS {
        return None;
    }
    let ratio = slope / then;
    if still < NOTHING {
        Some(ChangeOf::NoTurn)
    } else if still > FITS && !TURN_SCALE.contains(&ratio) && all.left() > BETTER * left {
        Some(ChangeOf::TurnScale(ratio))
    } else {
        None
    }
}

/// Another map from specific forces to accelerations: a rotation, or a multiple of one of them.
fn push_change(left: f64, [before, after]: &[Block; 2]) -> Option<ChangeOf> {
    let mut all = before.push;
    all.join(&after.push);
    let fits = [before.push.fit()?, after.push.fit()?];
    let explained = |fit: &PushFit| {
        (0..2).all(|k| fit.power[k] > ENOUGH_PUSH && fit.left[k] < (1.0 - FITS_PUSH) * fit.power[k])
    };
    if !(fits.iter().all(explained) && product(&all.fit()?.left) > BETTER_PUSH * left) {
        return None;
    }
    // Specific forces before by those after.
    let back = fits[0].map.try_inverse()? * fits[1].map;
    let size = back.determinant().abs().sqrt();
    let angle = (back[(1, 0)] - back[(0, 1)]).atan2(back[(0, 0)] + back[(1, 1)]);
    let (sin, cos) = angle.sin_cos();
    let rotation = Matrix2::new(cos, -sin, sin, cos);
    if angle.abs() > TURNED {
        let rest = (back / size - rotation).norm();
        return (TURN_SCALE.contains(&size) && rest < REST * back.norm() / size)
            .then_some(ChangeOf::Turned(angle));
    }
    let ratios = [0, 1].map(|k| 1.0 / back[(k, k)]);
    let aside = back[(0, 1)].abs().max(back[(1, 0)].abs());
    let other = |k: usize| TURN_SCALE.contains(&ratios[1 - k]);
    let scaled = (0..2).find(|k| !TURN_SCALE.contains(&ratios[*k]) && other(*k))?;
    (aside < REST * back.norm()).then_some(ChangeOf::ForceScale(scaled, ratios[scaled]))
}

#[cfg(test)]
mod tests;
