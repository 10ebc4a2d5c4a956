//! Poses as fixes with an attitude: positions as baselines from the origin of their frame.

use undrift_nav::earth::Geodetic;
use undrift_nav::sample::{FixQuality, GnssFix, Position};
use undrift_nav::{Matrix3, Quaternion, Vector3};

use crate::fix::independent;
use crate::poses::{LocalPose, PoseSource, Poses};

/// How the poses of a local frame become fixes.
#[derive(Clone, Debug)]
pub struct PoseFixes {
    /// The log.
    pub source: PoseSource,
    /// Place that the frame's origin is taken to have: its latitude and height say what gravity is.
    pub base: Geodetic,
    /// Rotation from the frame's axes to north, east, down, where north is any level direction that stays.
    pub rotation: Quaternion,
    /// Standard deviations of positions along the frame's axes \[m\], where the log states none.
    pub position_std: Option<[f64; 3]>,
    /// Standard deviations of attitudes about the frame's axes \[rad\], where the log states none.
    pub attitude_std: Option<[f64; 3]>,
    /// Least time between two poses that are used \[s\]: poses of a tracker that smooths have errors in common.
    pub interval: f64,
}

/// Poses as they become fixes.
pub(super) struct Placed {
    pub(super) poses: Poses,
    fixes: PoseFixes,
    /// Time from which on the next one is used \[s\].
    next: Option<f64>,
    /// Position and attitude of the one before.
    last: Option<(Option<Vector3>, Option<Quaternion>)>,
}

/// A pose this share of the interval early is on time: stamps jitter.
const EARLY: f64 = 0.02;

impl Placed {
    pub(super) fn new(poses: Poses, fixes: &PoseFixes) -> Self {
        Self {
            poses,
            fixes: fixes.clone(),
            next: None,
            last: None,
        }
    }

    /// The fix of a pose; `None` where it repeats the one before, comes too soon after another one, or has nothing whose accuracy is known.
    pub(super) fn fix(&mut self, (time, pose): (f64, LocalPose)) -> Option<(f64, GnssFix)> {
        // A tracker that has lost its marker repeats the last pose.
        let now = (pose.position, pose.attitude);
        if self.last.replace(now) == Some(now) && pose.attitude.is_some() {
            return None;
        }
        let interval = self.fixes.interval;
        // A log may begin again: then so does this.
        let wait = self.next.map_or(0.0, |next| next - time);
        if (EARLY * interval..=interval).contains(&wait) && interval > 0.0 {
            return None;
        }
        let q_rw = self.fixes.rotation;
        let c_rw = q_rw.to_rotation_matrix().into_inner();
        let turned = |covariance: Matrix3| c_rw * covariance * c_rw.transpose();
        let known = |own: Option<Matrix3>, stated: Option<[f64; 3]>| {
            own.or(stated.and_then(|std| independent(&Vector3::from(std))))
        };
        let position = pose.position.and_then(|position| {
            let ned = q_rw * position;
            let base = self.fixes.base;
            let covariance = known(pose.position_covariance, self.fixes.position_std)?;
            Some((Position::Baseline { base, ned }, turned(covariance)))
        });
        let attitude = pose.attitude.and_then(|q_wk| {
            let covariance = known(pose.attitude_covariance, self.fixes.attitude_std)?;
            Some((q_rw * q_wk, turned(covariance)))
        });
        position.as_ref()?;
        // By the clock, so that the mean rate is the one asked for; from here on after a gap.
        let due = self.next.filter(|next| (time - next).abs() < interval);
        self.next = Some(due.unwrap_or(time) + interval);
        let fix = GnssFix {
            time,
            position,
            velocity: None,
            attitude,
            mean_velocity: None,
            quality: FixQuality::Unknown,
        };
        Some((time, fix))
    }
}
