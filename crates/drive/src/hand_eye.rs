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

mod force;
mod path;
mod turns;

use force::Forces;
use turns::Turns;
use undrift_io::poses::LocalPose;
use undrift_nav::{Quaternion, Vector3, sample::ImuSample};
use undrift_results::inspect::PoseFault;

/// Time between the poses that are compared \[s\], at least.
pub(crate) const INTERVAL: f64 = 0.1;

/// How poses lie against an IMU.
#[derive(Clone, Copy, Debug)]
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
    /// What is wrong with the poses as they are read, where something else fits.
    pub fault: Option<PoseFault>,
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
    let as_read = compared(samples, poses);
    let others = [
        (PoseFault::ScalarFirst, of_each(poses, scalar_first)),
        (PoseFault::Inverse, of_each(poses, inverse)),
    ];
    let others = others.into_iter().filter_map(|(fault, reading)| {
        let found = compared(samples, &reading).ok()?;
        let fault = Some(fault);
        Some(HandEye { fault, ..found })
    });
    let misfit = |of: &HandEye| 1.0 - of.correlation;
    let best = others.min_by(|a, b| misfit(a).total_cmp(&misfit(b)));
    match (as_read, best) {
        (Ok(found), Some(other)) if misfit(&other) < BETTER * misfit(&found) => Ok(other),
        (Err(_), Some(other)) => Ok(other),
        (as_read, _) => as_read,
    }
}

/// Compares samples and poses.
fn compared(samples: &[ImuSample], poses: &[LocalPose]) -> Result<HandEye, PoseFault> {
    let turns = Turns::find(samples, poses)?;
    if turns.correlation < FITS {
        return Err(match turns.mirrored > FITS {
            true => PoseFault::Mirrored,
            false => PoseFault::NoFit {
                correlation: turns.correlation,
            },
        });
    }
    let forces = Forces::find(samples, poses, &turns)?;
    Ok(HandEye {
        clock: turns.clock,
        marker: turns.marker,
        marker_std: turns.marker_std,
        gravity: forces.gravity,
        lever_arm: forces.lever_arm,
        lever_arm_std: forces.lever_arm_std,
        position_std: forces.position_std,
        attitude_std: turns.attitude_std,
        correlation: turns.correlation,
        fault: forces.fault,
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
