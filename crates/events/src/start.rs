//! How a solution begins, and how the IMU sits.

use undrift_nav::{Matrix3, Quaternion, Vector3, attitude::to_rpy};

/// Source and accuracy of the first attitude.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct Alignment {
    /// Source of the attitude.
    pub source: AttitudeSource,
    /// Standard deviation of the tilt, the larger of its two axes \[rad\].
    pub level_std: f64,
    /// Standard deviation of the heading \[rad\].
    pub heading_std: f64,
    /// Standard deviation of the gyro bias, the largest of the axes \[rad/s\].
    pub gyro_bias_std: f64,
    /// Excess of the specific force at rest over gravity \[m/s²\], where that is more than the accelerometers' noise
    /// model has: the filter then starts with so large constant errors.
    pub force_excess: Option<f64>,
}

/// Source of the first attitude.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub enum AttitudeSource {
    /// The settings state it (`AlignSettings::attitude`).
    Given,
    /// The first pose, by the marker's rotation.
    Pose,
    /// Level and gyro bias from the mean over a rest.
    Rest {
        /// Length of the rest \[s\].
        duration: f64,
        /// Source of the heading, which rest does not show.
        heading: HeadingSource,
    },
    /// All of it from velocity changes seen by sensors and GNSS.
    Motion {
        /// Length of the window of motion \[s\].
        duration: f64,
        /// Whether the gyro bias is known from a rest before.
        bias_at_rest: bool,
    },
}

impl AttitudeSource {
    /// Whether the heading is by this after a rest.
    pub fn is_by(&self, source: HeadingSource) -> bool {
        matches!(self, Self::Rest { heading, .. } if *heading == source)
    }
}

/// Source of the heading after a rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub enum HeadingSource {
    /// The settings state it (`Heading::Given`).
    Given,
    /// The GNSS course once the vehicle moved.
    Course,
    /// Headings by two antennas.
    Antennas,
    /// A magnetometer, at rest.
    Magnetometer,
}

/// Attitude of the sensor's axes in the vehicle, with its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct Mounting {
    /// Takes sensor axes `b` to vehicle axes `v`, forward, right, down.
    pub q_vb: Quaternion,
    /// Standard deviations of the error angles about the vehicle's forward, right and down \[rad\].
    pub std: Vector3,
    /// Length of the driving that it is based on \[s\].
    pub duration: f64,
    /// Whether that driving was straight; else it turned, slowly.
    pub straight: bool,
}

impl Mounting {
    /// Roll, pitch, yaw \[rad\] of the rotation from the sensor's to the vehicle's axes, as `imu.mounting` of a drive file takes them.
    ///
    /// ```
    /// use undrift_events::Mounting;
    /// use undrift_nav::{Vector3, attitude::from_rpy};
    /// // The sensor lies upside down.
    /// let upside_down = Mounting {
    ///     q_vb: from_rpy(&Vector3::new(180f64.to_radians(), 0.0, 0.0)),
    ///     std: Vector3::repeat(0.01),
    ///     duration: 60.0,
    ///     straight: true,
    /// };
    /// assert!((upside_down.rpy().x.abs().to_degrees() - 180.0).abs() < 1e-9);
    /// assert!((upside_down.matrix() * Vector3::z() + Vector3::z()).norm() < 1e-12);
    /// ```
    pub fn rpy(&self) -> Vector3 {
        to_rpy(&self.q_vb)
    }

    /// Rotation matrix C_b^v, from the sensor's to the vehicle's axes.
    pub fn matrix(&self) -> Matrix3 {
        self.q_vb.to_rotation_matrix().into_inner()
    }
}
