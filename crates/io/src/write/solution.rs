//! A row of the navigation solution, and its columns: state, standard deviations, estimated sensor errors.

use undrift_nav::Vector3;
use undrift_nav::earth::Geodetic;

use crate::epoch::Epoch;

/// Columns of a row, the names with their units, and decimals: a latitude of 1e-11° is a micrometre; of sensor errors
/// there are as many decimals as a navigation-grade unit would need.
pub(super) const COLUMNS: [(&str, usize); 31] = [
    ("time_s", 4),
    ("lat_deg", 11),
    ("lon_deg", 11),
    ("height_m", 4),
    ("vn_mps", 5),
    ("ve_mps", 5),
    ("vd_mps", 5),
    ("roll_deg", 6),
    ("pitch_deg", 6),
    ("yaw_deg", 6),
    ("north_std_m", 4),
    ("east_std_m", 4),
    ("down_std_m", 4),
    ("vn_std_mps", 5),
    ("ve_std_mps", 5),
    ("vd_std_mps", 5),
    ("roll_std_deg", 6),
    ("pitch_std_deg", 6),
    ("yaw_std_deg", 6),
    ("gyro_bias_x_dps", 8),
    ("gyro_bias_y_dps", 8),
    ("gyro_bias_z_dps", 8),
    ("accel_bias_x_mps2", 7),
    ("accel_bias_y_mps2", 7),
    ("accel_bias_z_mps2", 7),
    ("gyro_bias_x_std_dps", 8),
    ("gyro_bias_y_std_dps", 8),
    ("gyro_bias_z_std_dps", 8),
    ("accel_bias_x_std_mps2", 7),
    ("accel_bias_y_std_mps2", 7),
    ("accel_bias_z_std_mps2", 7),
];
/// The last column where the log has a date: Unix time \[s\].
pub(super) const UNIX_TIME: &str = "unix_time_s";
/// The column of the yaw.
pub(super) const YAW: usize = 9;

/// One instant of the solution, in SI units and radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolutionRow {
    /// Time \[s\].
    pub time: f64,
    /// Position.
    pub position: Geodetic,
    /// Velocity north, east, down [m/s].
    pub v_n: Vector3,
    /// Roll, pitch, yaw \[rad\]; yaw of any turn.
    pub rpy: Vector3,
    /// Standard deviations: position north, east, down \[m\], velocity north, east, down [m/s],
    /// roll, pitch, yaw \[rad\]. What is not known of the offset between the clocks of samples and fixes, where it is estimated, is
    /// in them with the speed.
    pub nav_std: [f64; 9],
    /// Estimated slow gyro error, body axes [rad/s].
    pub gyro_error: Vector3,
    /// Estimated slow accelerometer error, body axes [m/s²].
    pub accel_error: Vector3,
    /// Standard deviations of the gyro [rad/s] and accelerometer errors [m/s²], x y z each.
    pub error_std: [f64; 6],
}

impl SolutionRow {
    /// A row of which nothing is known but time \[s\] and place.
    pub fn at(time: f64, position: Geodetic) -> Self {
        let unknown = Vector3::repeat(f64::NAN);
        Self {
            time,
            position,
            v_n: unknown,
            rpy: unknown,
            nav_std: [f64::NAN; 9],
            gyro_error: unknown,
            accel_error: unknown,
            error_std: [f64::NAN; 6],
        }
    }

    /// The numbers of [`COLUMNS`].
    #[inline]
    pub(super) fn values(&self) -> [f64; COLUMNS.len()] {
        [
            self.time,
            self.position.lat.to_degrees(),
            self.position.lon.to_degrees(),
            self.position.height,
            self.v_n.x,
            self.v_n.y,
            self.v_n.z,
            self.rpy.x.to_degrees(),
            self.rpy.y.to_degrees(),
            self.rpy.z.to_degrees(),
            self.nav_std[0],
            self.nav_std[1],
            self.nav_std[2],
            self.nav_std[3],
            self.nav_std[4],
            self.nav_std[5],
            self.nav_std[6].to_degrees(),
            self.nav_std[7].to_degrees(),
            self.nav_std[8].to_degrees(),
            self.gyro_error.x.to_degrees(),
            self.gyro_error.y.to_degrees(),
            self.gyro_error.z.to_degrees(),
            self.accel_error.x,
            self.accel_error.y,
            self.accel_error.z,
            self.error_std[0].to_degrees(),
            self.error_std[1].to_degrees(),
            self.error_std[2].to_degrees(),
            self.error_std[3],
            self.error_std[4],
            self.error_std[5],
        ]
    }

    /// The numbers of the columns of a CSV file by their names.
    pub fn named(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let names = COLUMNS.into_iter().map(|(name, _)| name);
        names.zip(self.values())
    }

    /// Unix time \[s\].
    pub(super) fn unix_time(&self, epoch: Epoch) -> f64 {
        match self.time.is_finite() {
            true => epoch.unix(self.time),
            false => f64::NAN,
        }
    }

    /// Whether time and position are numbers.
    pub(super) fn has_position(&self) -> bool {
        let p = &self.position;
        [self.time, p.lat, p.lon, p.height]
            .iter()
            .all(|x| x.is_finite())
    }

    /// The same of velocity and attitude too.
    pub(super) fn is_whole(&self) -> bool {
        let mut rest = self.v_n.iter().chain(self.rpy.iter());
        self.has_position() && rest.all(|x| x.is_finite())
    }
}
