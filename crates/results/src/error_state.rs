//! Names of the components of the error state and of their groups, the keys of results.

use undrift_nav::covariance::{AXES, NAV};

/// Components of an error state: position, velocity, misalignment, gyro and accelerometer bias.
pub const COMPONENTS: usize = NAV + AXES;

/// Names of the components with their units.
pub const COMPONENT_NAMES: [&str; COMPONENTS] = [
    "north_m",
    "east_m",
    "down_m",
    "vn_mps",
    "ve_mps",
    "vd_mps",
    "psi_north_rad",
    "psi_east_rad",
    "psi_down_rad",
    "gyro_x_radps",
    "gyro_y_radps",
    "gyro_z_radps",
    "accel_x_mps2",
    "accel_y_mps2",
    "accel_z_mps2",
];

/// Number of groups.
pub const GROUPS: usize = 6;

/// The groups of components whose NEES is reported: name, first component, number of them.
pub const GROUP: [(&str, usize, usize); GROUPS] = [
    ("position", 0, 3),
    ("velocity", 3, 3),
    ("attitude", 6, 3),
    ("gyro bias", 9, 3),
    ("accel bias", 12, 3),
    ("all", 0, COMPONENTS),
];
