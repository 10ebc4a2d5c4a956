//! Names of the components of errors, the keys of results.

/// Names of the components of an error against a reference, as in the JSON: metres, metres a second, degrees.
pub const COMPONENTS: [&str; 10] = [
    "north_m",
    "east_m",
    "down_m",
    "horizontal_m",
    "vn_mps",
    "ve_mps",
    "vd_mps",
    "roll_deg",
    "pitch_deg",
    "yaw_deg",
];
