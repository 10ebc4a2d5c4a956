//! Where the marker does not move as the IMU does: turns that jump, and rotations and lever arms that change.

use super::turns::{LEAST, Motion};
use nalgebra::Matrix3;
use std::ops::Range;
use undrift_nav::Vector3;

/// What a linear model leaves, and what it is of three numbers.
pub(super) struct Row {
    pub left: Vector3,
    pub by: Matrix3<f64>,
}

/// Gain in twice the log-likelihood below which a change is one of chance, or of what a model of so few numbers does not have.
const GAIN: f64 = 80.0;

/// The row from which on the three numbers differ by more than `least`, where that explains much (the score test of a change at an
/// unknown time, Andrews 1993); `margin` rows are on each side.
pub(super) fn step(rows: &[Row], scatter: f64, margin: usize, least: f64) -> Option<usize> {
    // No single row decides.
    let clipped = |of: &Row| of.left * (5.0 * scatter / of.left.norm()).min(1.0);
    let (mut after, mut score) = (Matrix3::zeros(), Vector3::zeros());
    for row in rows {
        after += row.by.transpose() * row.by;
        score += row.by.transpose() * clipped(row);
    }
    let inverse = after.try_inverse()?;
    let start = inverse * score;
    let mut best: Option<(usize, f64)> = None;
    for (at, row) in rows.iter().enumerate() {
        if at >= margin
            && at + margin <= rows.len()
            && let Some(of) = (after - after * inverse * after).try_inverse()
        {
            let score = score - after * start;
            let change = of * score;
            let gain = change.dot(&score) / (scatter * scatter);
            if change.norm() > least && gain > best.map_or(GAIN, |best| best.1) {
                best = Some((at, gain));
            }
        }
        after -= row.by.transpose() * row.by;
        score -= row.by.transpose() * clipped(row);
    }
    best.map(|(at, _)| at)
}

/// A marker that turns by less against the IMU is the same \[rad\].
pub(super) const TURNED: f64 = 5e-3;
/// A turn that misses by more jumps \[rad\], and by more than so many times its usual error.
const JUMP: (f64, f64) = (0.05, 8.0);
/// Jumps within this \[s\] are of one event.
const AT_ONCE: f64 = 1.0;
/// A frame that is turned for no longer than this is another body's, or of a tracker that was lost \[s\].
const LOST: f64 = 20.0;
/// What turns miss in sum and the gyros may explain \[rad\].
const RETURNED: f64 = 0.05;

/// Turns that go together, of which each range has one marker.
pub(super) struct Breaks {
    pub pieces: Vec<Range<usize>>,
    pub jumps: Vec<Jump>,
}

/// Turns of the marker that the gyros do not measure, within a second.
#[derive(Clone)]
pub(super) struct Jump {
    /// From the first to the last.
    pub turns: Range<usize>,
    /// The largest \[rad\].
    pub size: f64,
    /// Whether the frame stays turned.
    pub lasting: bool,
}

impl Breaks {
    /// Looks at all turns; those that jump are not used any more.
    pub(super) fn find(motion: &mut Motion) -> Self {
        let mut splits = Vec::new();
        let mut jumps: Vec<Jump> = Vec::new();
        search(
            motion,
            0..motion.turns.len(),
            &mut splits,
            &mut |at, turns, size| {
                let time = |at: usize| turns[at].to;
                match jumps.last_mut() {
                    Some(last) if time(at) - time(last.turns.end - 1) < AT_ONCE => {
                        last.turns.end = at + 1;
                        last.size = last.size.max(size);
                    }
                    _ => jumps.push(Jump {
                        turns: at..at + 1,
                        size,
                        lasting: false,
                    }),
                }
            },
        );
        for jump in &mut jumps {
            jump.lasting = misses(motion, jump.turns.clone()) > RETURNED;
        }
        // There and back.
        let mut at = 0;
        while at < jumps.len() {
            let start = jumps[at].turns.start;
            let since = |to: &Jump| motion.turns[to.turns.start].from - motion.turns[start].from;
            let returns = |to: &Jump| to.lasting && misses(motion, start..to.turns.end) < RETURNED;
            let back = (at + 1..jumps.len())
                .take_while(|to| since(&jumps[*to]) < LOST)
                .find(|to| returns(&jumps[*to]));
            if let (true, Some(to)) = (jumps[at].lasting, back) {
                let sizes = jumps[at..=to].iter().map(|jump| jump.size);
                let whole = Jump {
                    turns: start..jumps[to].turns.end,
                    size: sizes.fold(0.0, f64::max),
                    lasting: false,
                };
                jumps.splice(at..=to, [whole]);
            }
            at += 1;
        }
        let mut pieces = Vec::new();
        let mut from = 0;
        let mut ends = Vec::from_iter(splits.into_iter().map(|at| at..at));
        let apart = |jump: &&Jump| jump.lasting || jump.turns.len() > LEAST / 2;
        ends.extend(jumps.iter().filter(apart).map(|jump| jump.turns.clone()));
        ends.sort_by_key(|of| of.start);
        for end in ends {
            // A change is seen beside its jump.
            if end.start >= from + LEAST {
                pieces.push(from..end.start);
            }
            from = end.end.max(from);
        }
        pieces.push(from..motion.turns.len());
        pieces.retain(|of| of.len() >= LEAST);
        Self { pieces, jumps }
    }
}

/// By how much the turns of marker and body differ from the first to the last of these \[rad\].
fn misses(motion: &Motion, of: Range<usize>) -> f64 {
    let (from, to) = (
        of.start.saturating_sub(1),
        (of.end + 1).min(motion.turns.len()),
    );
    // The marker of those before.
    let marker = motion
        .fit(from.saturating_sub(20 * LEAST)..from.max(1))
        .marker;
    let (first, last) = (motion.turns[from], motion.turns[to - 1]);
    let of_body = motion
        .path
        .turn(first.from + motion.clock, last.to + motion.clock);
    let of_marker = marker * first.before.inverse() * last.after * marker.inverse();
    of_body.map_or(0.0, |turn| {
        (undrift_nav::attitude::from_rotation_vector(&turn).inverse() * of_marker).angle()
    })
}

type Jumps<'a> = dyn FnMut(usize, &[super::turns::Turn], f64) + 'a;

/// Looks for changes of the marker's rotation in a range of turns, in each part of it again, and for jumps where it does not change.
fn search(motion: &mut Motion, of: Range<usize>, splits: &mut Vec<usize>, jumps: &mut Jumps) {
    let fit = motion.fit(of.clone());
    let limit = JUMP.0.max(JUMP.1 * fit.scatter);
    let (mut rows, mut at, mut far) = (Vec::new(), Vec::new(), Vec::new());
    for k in of.clone() {
        let turn = &motion.turns[k];
        let Some(body) = motion.of_body(turn, motion.clock) else {
            continue;
        };
        let here = fit.marker * turn.turn;
        let left = body - here;
        if left.norm() > limit {
            far.push((k, left.norm()));
            continue;
        }
        rows.push(Row {
            left,
            by: -here.cross_matrix(),
        });
        at.push(k);
    }
    let split = step(&rows, fit.scatter, LEAST, TURNED).map(|row| at[row]);
    if let Some(split) = split {
        search(motion, of.start..split, splits, jumps);
        splits.push(split);
        search(motion, split..of.end, splits, jumps);
        return;
    }
    for k in of {
        motion.turns[k].used = true;
    }
    for (k, size) in far {
        motion.turns[k].used = false;
        jumps(k, &motion.turns, size);
    }
}
