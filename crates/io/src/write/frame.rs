//! The frame of the poses of a drive.

use undrift_nav::attitude::from_rpy;
use undrift_nav::earth::Geodetic;
use undrift_nav::{Quaternion, Vector3};

use super::solution::SolutionRow;

/// Where the poses of a drive are, and of what.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseFrame {
    /// Origin of their frame.
    pub origin: Geodetic,
    /// From the axes of the frame to north, east, down, `q_rw`.
    pub rotation: Quaternion,
    /// Axes of the marker in the body, `q_bk`.
    pub marker: Quaternion,
    /// From the body's origin to the marker, body axes \[m\].
    pub lever_arm: Vector3,
    /// What is added to the poses' times \[s\].
    pub time_offset: f64,
}

impl PoseFrame {
    /// Place \[m\] and attitude `q_wk` of the marker.
    pub(super) fn pose(&self, row: &SolutionRow) -> (Vector3, Quaternion) {
        let q_nb = from_rpy(&row.rpy);
        let ned = self.origin.ned_to(&row.position) + q_nb * self.lever_arm;
        let q_wr = self.rotation.inverse();
        (q_wr * ned, q_wr * q_nb * self.marker)
    }
}
