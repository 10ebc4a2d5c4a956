//! Poses of a marker, as motion capture or a camera gives them, with white noise and errors that last.

use super::sensors::{GNSS_STREAM, stream_seed};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use undrift_nav::{
    Quaternion, Vector3,
    attitude::{from_rotation_vector, from_rpy},
    earth::Geodetic,
    sample::TruthSample,
};

const POSE_STREAM: usize = GNSS_STREAM + 3;

/// A marker, the frame that it is seen in, and how well.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseNoise {
    /// Standard deviation of the position, each way \[m\].
    pub position_std: f64,
    /// Standard deviation of the attitude, about each axis \[rad\].
    pub attitude_std: f64,
    /// Standard deviations of Gauss-Markov errors beside these, of the position \[m\] and the attitude \[rad\], and how long they last \[s\].
    pub lasting: [f64; 2],
    /// See there.
    pub correlation_time: f64,
    /// Axes of the marker in the body, `q_bk`.
    pub marker: Quaternion,
    /// IMU → marker, body axes \[m\].
    pub lever_arm: Vector3,
    /// From north, east, down to the axes of the frame.
    pub frame: Quaternion,
    /// What has to be added to the stamps \[s\].
    pub clock: f64,
}

/// A pose in the axes of its frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Stamp \[s\].
    pub time: f64,
    /// Position of the marker \[m\].
    pub position: Vector3,
    /// Turns vectors of the marker's axes into those of the frame.
    pub attitude: Quaternion,
}

impl Default for PoseNoise {
    /// Motion capture of 1 mm and 0.1°, a marker at the IMU with its axes, z up and x north.
    fn default() -> Self {
        Self {
            position_std: 1e-3,
            attitude_std: 0.1_f64.to_radians(),
            lasting: [0.0; 2],
            correlation_time: 1.0,
            marker: Quaternion::identity(),
            lever_arm: Vector3::zeros(),
            frame: from_rpy(&Vector3::new(std::f64::consts::PI, 0.0, 0.0)),
            clock: 0.0,
        }
    }
}

impl PoseNoise {
    /// A pose for each of the `truth` that has an attitude, from the place `origin` of the frame. The same seed draws the same noise.
    pub fn measure(
        &self,
        truth: impl IntoIterator<Item = TruthSample>,
        origin: &Geodetic,
        seed: u64,
    ) -> Vec<Pose> {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(stream_seed(seed, POSE_STREAM));
        let mut noise = |std: f64| {
            Vector3::from_fn(|_, _| {
                let one: f64 = StandardNormal.sample(&mut random);
                std * one
            })
        };
        let mut last: Option<(f64, [Vector3; 2])> = None;
        let pose = |row: TruthSample| {
            let q_nb = from_rpy(&row.rpy?);
            let marker = origin.ned_to(&row.position) + q_nb * self.lever_arm;
            let error = from_rotation_vector(&noise(self.attitude_std));
            let position = self.frame * marker + noise(self.position_std);
            // Nothing is drawn where nothing lasts.
            let lasting = match (self.lasting, last) {
                ([0.0, 0.0], _) => [Vector3::zeros(); 2],
                (std, None) => std.map(&mut noise),
                (std, Some((time, before))) => {
                    let left = ((time - row.time) / self.correlation_time).exp();
                    let drawn = std.map(|std| noise(std * (1.0 - left * left).sqrt()));
                    [0, 1].map(|k| before[k] * left + drawn[k])
                }
            };
            last = Some((row.time, lasting));
            let turned = from_rotation_vector(&lasting[1]);
            Some(Pose {
                time: row.time - self.clock,
                position: position + lasting[0],
                attitude: turned * self.frame * q_nb * self.marker * error,
            })
        };
        truth.into_iter().filter_map(pose).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{GnssNoise, Trajectory, simulate};

    #[test]
    fn poses_are_the_marker_s_in_the_frame_with_the_noise_stated() {
        let hand = Trajectory::handheld(60.0, 0.6, 3);
        let log = simulate(&hand, 50.0, None, &GnssNoise::default(), 3).unwrap();
        let of = PoseNoise {
            marker: from_rpy(&Vector3::new(0.3, -0.2, 1.0)),
            lever_arm: Vector3::new(0.1, -0.05, 0.2),
            clock: 0.04,
            ..PoseNoise::default()
        };
        let poses = of.measure(log.truth.clone(), &hand.start, 3);
        let mut squares = [0.0; 2];
        for (pose, row) in poses.iter().zip(&log.truth) {
            assert_eq!(pose.time, row.time - 0.04);
            let q_nb = from_rpy(&row.rpy.unwrap());
            // North is x, and down is −z.
            let ned = hand.start.ned_to(&row.position) + q_nb * of.lever_arm;
            let position = Vector3::new(ned.x, -ned.y, -ned.z) - pose.position;
            let turned =
                (of.frame.inverse() * pose.attitude * of.marker.inverse()).inverse() * q_nb;
            squares[0] += position.norm_squared();
            squares[1] += turned.scaled_axis().norm_squared();
        }
        let n = 3.0 * poses.len() as f64;
        let [position, attitude] = squares.map(|sum| (sum / n).sqrt());
        // 9000 numbers: within 2 %.
        assert!((position / 1e-3 - 1.0).abs() < 0.03, "{position}");
        assert!(
            (attitude / of.attitude_std - 1.0).abs() < 0.03,
            "{attitude}"
        );
        // It stays in a room and turns about all axes.
        assert!(poses.iter().all(|pose| pose.position.norm() < 5.0));
    }
}
