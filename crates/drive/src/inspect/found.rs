//! Which columns of a table are what.

use undrift_results::inspect::Known;

/// Eastings and northings from here on are those of a grid of the Earth, not of a local frame \[m\].
pub(super) const GRID: f64 = 100_000.0;

/// Columns found: their places.
#[derive(Default)]
pub(super) struct Found {
    pub(super) time: Option<usize>,
    /// All columns that are times by their names.
    pub(super) times: Vec<usize>,
    pub(super) gyro: [Option<usize>; 3],
    pub(super) accel: [Option<usize>; 3],
    /// Of the times, where these are times of day.
    pub(super) date: Option<usize>,
    pub(super) place: [Option<usize>; 3],
    /// Easting and northing, and the zone and the letter of its band.
    pub(super) grid: [Option<usize>; 2],
    pub(super) zone: [Option<usize>; 2],
    /// Earth-centred, Earth-fixed.
    pub(super) ecef: [Option<usize>; 3],
    pub(super) ecef_velocity: [Option<usize>; 3],
    pub(super) velocity: [Option<usize>; 3],
    pub(super) up: bool,
    pub(super) position_std: [Option<usize>; 3],
    pub(super) velocity_std: [Option<usize>; 3],
    /// Speed and course over ground.
    pub(super) polar: [Option<usize>; 2],
    /// Accuracies of the horizontal position, the height, the speed.
    pub(super) accuracy: [Option<usize>; 3],
    pub(super) attitude: [Option<usize>; 3],
    /// Heading by two antennas.
    pub(super) antennas: Option<usize>,
    /// Magnetic field.
    pub(super) field: [Option<usize>; 3],
    /// How they were found.
    pub(super) known: Known,
}
