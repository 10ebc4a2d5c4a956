//! How a marker and its frame lie against an IMU, by the motion that poses and samples have in common.
//!
//! A rigid body turns by the same angles whoever watches: `δ_k = R_bkᵀ δ_b` for the turns between two poses, in the marker's axes and in the
//! body's, gives the marker's rotation (Wahba 1965; Tsai & Lenz 1989 for hand and eye) and, by its fit, the offset between the clocks. With
//! that the specific force can be turned into the frame of the poses, where a double difference of positions
//!
//! ```text
//! (p₂ − p₁)/h₂ − (p₁ − p₀)/h₁ = ∫ w (R_wb (f − b) + g) dt + D(R_wb) l,   w the triangle over the three
//! ```
//!
//! is linear in gravity, in the lever arm l, in the accelerometers' bias b and, as a check of the unit, in a scale of the positions.

mod breaks;
mod force;
mod path;
mod turns;

use breaks::{Breaks, Jump, TURNED};
use force::{Forces, Shift};
use std::ops::Range;
use turns::{Fit, LEAST, Motion};
use undrift_io::poses::LocalPose;
use undrift_nav::sample::{GnssFix, Position};
use undrift_nav::{Quaternion, Vector3, sample::ImuSample};
use undrift_results::{
    findings::{Finding, PosesApart},
    inspect::PoseFault,
};

/// Time between the poses that are compared \[s\], at least.
pub(crate) const INTERVAL: f64 = 0.1;

/// How poses lie against an IMU.
#[derive(Clone, Debug)]
pub(crate) struct HandEye {
    /// What is to be added to the times of the poses \[s\].
    pub clock: f64,
    /// Axes of the marker in the body, `q_bk`.
    pub marker: Quaternion,
    /// Their standard deviation, each way \[rad\].
    pub marker_std: f64,
    /// Gravity in the frame of the poses [m/s²].
    pub gravity: Vector3,
    /// IMU → marker, body axes \[m\].
    pub lever_arm: Vector3,
    /// Its standard deviation, each way \[m\].
    pub lever_arm_std: f64,
    /// Standard deviation of the positions, each way \[m\].
    pub position_std: f64,
    /// Standard deviation of the attitudes, each way \[rad\].
    pub attitude_std: f64,
    /// Correlation of the turns [–].
    pub correlation: f64,
    /// What is wrong with the poses as they are read, where something else fits, and where marker and IMU do not move as one.
    pub faults: Vec<PoseFault>,
}

/// Turns that fit belong together above this correlation.
const FITS: f64 = 0.9;

/// What is left of the misfit if another reading of the numbers is right, at most.
const BETTER: f64 = 0.3;

/// Compares samples and poses, both in order of time, as the numbers of the poses are read and, where that fits better or alone, in
/// another way.
///
/// # Errors
/// What they lack or contradict.
pub(crate) fn hand_eye(samples: &[ImuSample], poses: &[LocalPose]) -> Result<HandEye, PoseFault> {
    let (poses, frozen) = without_repeats(poses);
    let as_read = compared(samples, &poses);
    let others = [
        (PoseFault::ScalarFirst, of_each(&poses, scalar_first)),
        (PoseFault::Inverse, of_each(&poses, inverse)),
    ];
    let others = others.into_iter().filter_map(|(fault, reading)| {
        let mut found = compared(samples, &reading).ok()?;
        found.faults.insert(0, fault);
        Some(found)
    });
    let misfit = |of: &HandEye| 1.0 - of.correlation;
    // Turns do not show which of the two it is: in other axes of marker and frame one is the other.
    let best = others.min_by(|a, b| a.position_std.total_cmp(&b.position_std));
    let mut found = match (as_read, best) {
        (Ok(found), Some(other)) if misfit(&other) < BETTER * misfit(&found) => other,
        (Err(PoseFault::Mirrored), _) => return Err(PoseFault::Mirrored),
        (Ok(found), _) | (Err(_), Some(found)) => found,
        (Err(PoseFault::NoFit { correlation }), None) => {
            let other_rate = turns::rate(samples, &poses).filter(|rate| (rate - 1.0).abs() > RATE);
            return Err(
                other_rate.map_or(PoseFault::NoFit { correlation }, |ratio| PoseFault::Rate {
                    ratio,
                }),
            );
        }
        (Err(fault), None) => return Err(fault),
    };
    if found.clock.abs() > OTHER_CLOCK {
        found.faults.push(PoseFault::Clock {
            offset: found.clock,
        });
    }
    found.faults.extend(frozen);
    Ok(found)
}

/// Clocks that are further apart are two, and not one with a delay \[s\].
const OTHER_CLOCK: f64 = 3.0;

/// What is wrong with the poses of a drive that is read, each a fix with an attitude, where they have attitudes.
/// `frame` turns the axes of their frame to north, east, down.
pub(crate) fn findings(
    samples: &[ImuSample],
    poses: &[GnssFix],
    frame: &Quaternion,
) -> Vec<Finding> {
    let back = frame.inverse();
    let pose = |fix: &GnssFix| {
        let position = fix.position.and_then(|(position, _)| match position {
            Position::Baseline { ned, .. } => Some(back * ned),
            Position::Geodetic(_) => None,
        });
        Some(LocalPose {
            time: fix.time,
            position,
            attitude: Some(back * fix.attitude?.0),
            position_covariance: None,
            attitude_covariance: None,
        })
    };
    let poses = Vec::from_iter(poses.iter().filter_map(pose));
    if poses.is_empty() {
        return Vec::new();
    }
    let faults = match hand_eye(samples, &poses) {
        Ok(found) => found.faults,
        Err(fault) => vec![fault],
    };
    let finding = |fault| {
        Finding::Poses(PosesApart {
            fault,
            mended: false,
        })
    };
    faults.into_iter().map(finding).collect()
}

/// Clocks that differ by more than this share do not fit.
const RATE: f64 = 5e-4;
/// Poses that repeat the one before are a tracker's that has lost its marker, if they are more than this share.
const REPEATED: f64 = 0.01;

/// The poses without those that repeat the one before, which are named where they are many.
fn without_repeats(poses: &[LocalPose]) -> (Vec<LocalPose>, Option<PoseFault>) {
    let (mut left, mut time) = (Vec::<LocalPose>::with_capacity(poses.len()), None);
    for pose in poses {
        let same =
            |last: &LocalPose| last.position == pose.position && last.attitude == pose.attitude;
        match left.last().is_some_and(same) {
            true => _ = time.get_or_insert(pose.time),
            false => left.push(*pose),
        }
    }
    let repeated = poses.len() - left.len();
    let many = repeated as f64 > REPEATED * poses.len() as f64;
    let poses = repeated as u64;
    let fault = time
        .filter(|_| many)
        .map(|time| PoseFault::Frozen { poses, time });
    (left, fault)
}

/// Turns with one marker, and what forces show of them.
struct Piece {
    turns: Range<usize>,
    /// On the clock of the samples \[s\].
    start: f64,
    end: f64,
    /// The move of the frame that it begins with.
    shift: Option<Shift>,
    fit: Fit,
    forces: Result<Forces, PoseFault>,
}

/// Looks at turns, which begin with a move of the frame or not, and again at their parts where the lever arm changes or the frame moves.
fn pieces(
    samples: &[ImuSample],
    poses: &[LocalPose],
    motion: &Motion,
    (turns, shift): (Range<usize>, Option<Shift>),
    into: &mut Vec<Piece>,
) {
    let (first, last) = (motion.turns[turns.start], motion.turns[turns.end - 1]);
    let within = |pose: &&LocalPose| first.from <= pose.time && pose.time <= last.to;
    let of_piece = Vec::from_iter(poses.iter().filter(within).copied());
    let fit = motion.fit(turns.clone());
    let forces = Forces::find(samples, &of_piece, motion, &fit.marker);
    let seen = forces.as_ref().ok();
    let steps = seen.and_then(|forces| forces.step);
    let moves = seen.and_then(|forces| forces.shift);
    let changes = steps.map(|time| (time, None));
    let changes = changes.or(moves.map(|shift| (shift.time, Some(shift))));
    if let Some((time, moved)) = changes {
        let later = |turn: &turns::Turn| turn.from + motion.clock < time;
        let at = motion.turns.partition_point(later);
        if turns.start + LEAST <= at && at + LEAST <= turns.end {
            pieces(samples, poses, motion, (turns.start..at, shift), into);
            pieces(samples, poses, motion, (at..turns.end, moved), into);
            return;
        }
    }
    into.push(Piece {
        start: first.from + motion.clock,
        end: last.to + motion.clock,
        turns,
        shift,
        fit,
        forces,
    });
}

/// What differs from one piece to the next, if anything does: the marker and the lever arm beyond chance, or its frame.
fn between(before: &Piece, after: &Piece, jumps: &[Jump], motion: &Motion) -> Option<PoseFault> {
    let at = before.turns.end.saturating_sub(LEAST)..after.turns.start + LEAST;
    let mut lasting = jumps.iter().filter(|jump| jump.lasting);
    let jump = lasting.find(|jump| at.contains(&jump.turns.start));
    let time = match jump {
        Some(jump) => motion.turns[jump.turns.start].to + motion.clock,
        None => 0.5 * (before.end + after.start),
    };
    let turned = before.fit.marker.angle_to(&after.fit.marker);
    let beyond = |by: f64, std: [f64; 2]| by > 4.0 * std[0].hypot(std[1]);
    let mut distance = 0.0;
    if let (Ok(before), Ok(after)) = (&before.forces, &after.forces) {
        let moved = (before.lever_arm - after.lever_arm).norm();
        if moved > force::STEP && beyond(moved, [before.lever_arm_std, after.lever_arm_std]) {
            distance = moved;
        }
    }
    let turned = match turned > TURNED && beyond(turned, [before.fit.std, after.fit.std]) {
        true => turned,
        false => 0.0,
    };
    if turned > 0.0 || distance > 0.0 {
        return Some(PoseFault::Slipped {
            time,
            angle_deg: turned.to_degrees(),
            distance_m: distance,
        });
    }
    let jumped = jump.map(|jump| PoseFault::Jumped {
        time,
        end: time,
        angle_deg: jump.size.to_degrees(),
        lasting: true,
    });
    jumped.or(after.shift.map(|shift| PoseFault::Shifted {
        time: shift.time,
        distance_m: shift.distance,
    }))
}

/// Slips on end without a jump that are a slide.
const SLIDES: usize = 3;

/// Compares samples and poses.
fn compared(samples: &[ImuSample], poses: &[LocalPose]) -> Result<HandEye, PoseFault> {
    let mut motion = Motion::find(samples, poses)?;
    let breaks = Breaks::find(&mut motion);
    let mut all = Vec::new();
    for turns in breaks.pieces.clone() {
        pieces(samples, poses, &motion, (turns, None), &mut all);
    }
    let pairs = all.iter().zip(all.iter().skip(1));
    let differ = pairs.map(|(a, b)| between(a, b, &breaks.jumps, &motion));
    let mut faults = Vec::from_iter(differ.flatten());
    let gone = breaks.jumps.iter().filter(|jump| !jump.lasting);
    let mut gone = gone.map(|jump| PoseFault::Jumped {
        time: motion.turns[jump.turns.start].to + motion.clock,
        end: motion.turns[jump.turns.end - 1].to + motion.clock,
        angle_deg: jump.size.to_degrees(),
        lasting: false,
    });
    let cut = all.len() > 1 && !faults.is_empty();
    let slides = breaks.jumps.iter().all(|jump| !jump.lasting) && faults.len() >= SLIDES;
    let longest = all.iter().max_by_key(|piece| piece.turns.len());
    let Some(longest) = longest else {
        let last = gone.next_back();
        return Err(last.unwrap_or(PoseFault::NoFit { correlation: 0.0 }));
    };
    if let (true, Some(first), Some(last)) = (slides, all.first(), all.last()) {
        faults = vec![PoseFault::Slid {
            start: first.end,
            end: last.start,
            angle_deg: first.fit.marker.angle_to(&last.fit.marker).to_degrees(),
        }];
    }
    let fit = longest.fit;
    if fit.correlation < FITS {
        return Err(match fit.mirrored > FITS {
            true => PoseFault::Mirrored,
            false => PoseFault::NoFit {
                correlation: fit.correlation,
            },
        });
    }
    if cut {
        faults.push(PoseFault::Piece {
            start: longest.start,
            end: longest.end,
        });
    }
    faults.extend(gone.take(1));
    let forces = longest.forces.clone()?;
    faults.splice(0..0, forces.fault);
    Ok(HandEye {
        clock: motion.clock,
        marker: fit.marker,
        marker_std: fit.std,
        gravity: forces.gravity,
        lever_arm: forces.lever_arm,
        lever_arm_std: forces.lever_arm_std,
        position_std: forces.position_std,
        attitude_std: fit.scatter / std::f64::consts::SQRT_2,
        correlation: fit.correlation,
        faults,
    })
}

/// What a quaternion is whose scalar part was written first and read as the last number.
fn scalar_first(read: &Quaternion) -> Quaternion {
    let q = read.quaternion();
    Quaternion::from_quaternion(nalgebra::Quaternion::new(q.i, q.j, q.k, q.w))
}

fn inverse(read: &Quaternion) -> Quaternion {
    read.inverse()
}

fn of_each(poses: &[LocalPose], of: impl Fn(&Quaternion) -> Quaternion) -> Vec<LocalPose> {
    let turned = |pose: &LocalPose| LocalPose {
        attitude: pose.attitude.as_ref().map(&of),
        ..*pose
    };
    poses.iter().map(turned).collect()
}

#[cfg(test)]
mod tests;
