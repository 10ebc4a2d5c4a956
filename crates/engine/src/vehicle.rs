//! What is known of the vehicle: which constraints hold and how firmly.

pub use crate::aid::NonHolonomic;

use undrift_nav::Vector3;

/// What the vehicle is, as a set of defaults.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub enum Profile {
    /// Nothing is known of it.
    #[default]
    None,
    /// A wheeled vehicle on a road: no side slip, no hopping, stands still at times.
    Car,
    /// An aircraft: no constraint but that it may stand on the ground.
    Aircraft,
    /// A person on foot carrying the sensor: stands still at times.
    Pedestrian,
}

/// The constraints in force. Standard deviations are of one update.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct Constraints {
    /// No velocity along the vehicle's right and down axes.
    pub non_holonomic: Option<NonHolonomic>,
    /// Standard deviation of the velocity at rest [m/s].
    pub zero_velocity: Option<f64>,
    /// Standard deviation of the angular rate at rest beyond the gyros' noise [rad/s].
    pub zero_angular_rate: Option<f64>,
    /// Standard deviation of the heading against the course over ground \[rad\], and the speed above
    /// which it holds [m/s].
    pub course: Option<(f64, f64)>,
    /// IMU → wheel that turns the odometer, body axes \[m\].
    pub odometer_lever: Vector3,
}

impl Profile {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::None, Self::Car, Self::Aircraft, Self::Pedestrian];

    /// Its name in a drive file.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Car => "car",
            Self::Aircraft => "aircraft",
            Self::Pedestrian => "pedestrian",
        }
    }

    /// The constraints of the profile.
    pub fn constraints(self) -> Constraints {
        let rest = Constraints {
            zero_velocity: Some(0.02),
            zero_angular_rate: Some(2e-4),
            ..Constraints::default()
        };
        match self {
            Self::None => Constraints::default(),
            Self::Car => Constraints {
                non_holonomic: Some(NonHolonomic::CAR),
                ..rest
            },
            Self::Aircraft | Self::Pedestrian => rest,
        }
    }
}
