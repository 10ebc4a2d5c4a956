//! What passes between C and the filter.

/// Most states of one sensor axis.
pub const UNDRIFT_MAX_ORDER: usize = 6;
/// Sensor axes: gyro x, y, z, then accelerometer x, y, z.
pub const UNDRIFT_AXES: usize = 6;
/// Kinds of parameters.
pub const UNDRIFT_PARAMETERS: usize = 15;

/// The noise model of one sensor axis, a shaping filter that steps once a sample:
/// x' = F x + G w, error = H x + D w. The functions undrift_sensor_... make the usual ones.
/// Only the first `order` rows and columns count. "unit" is rad/s for a gyro, m/s^2 for an accelerometer.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Sensor {
    /// Number of states, 0 to UNDRIFT_MAX_ORDER.
    pub order: u32,
    /// Sample interval \[s\].
    pub interval: f64,
    /// Transition F.
    pub f: [[f64; UNDRIFT_MAX_ORDER]; UNDRIFT_MAX_ORDER],
    /// Output row H.
    pub h: [f64; UNDRIFT_MAX_ORDER],
    /// Driving covariance G G'.
    pub q: [[f64; UNDRIFT_MAX_ORDER]; UNDRIFT_MAX_ORDER],
    /// Cross-covariance G D'.
    pub s: [f64; UNDRIFT_MAX_ORDER],
    /// Variance D D' of one sample [unit^2].
    pub r: f64,
    /// Covariance of the states before the first sample.
    pub p0: [[f64; UNDRIFT_MAX_ORDER]; UNDRIFT_MAX_ORDER],
}

/// Position, velocity and attitude of the IMU before the first sample, and how well they are known.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// Time \[s\], where the first sample begins.
    pub time: f64,
    /// Latitude \[rad\].
    pub latitude: f64,
    /// Longitude \[rad\].
    pub longitude: f64,
    /// Height above the ellipsoid \[m\].
    pub height: f64,
    /// Velocity over ground north, east, down [m/s].
    pub velocity: [f64; 3],
    /// Roll, pitch, yaw \[rad\].
    pub roll_pitch_yaw: [f64; 3],
    /// Standard deviation of the position north, east, down \[m\].
    pub position_std: [f64; 3],
    /// Standard deviation of the velocity north, east, down [m/s].
    pub velocity_std: [f64; 3],
    /// Standard deviation of the attitude about north, east, down \[rad\].
    pub attitude_std: [f64; 3],
}

/// Measurements of one number that a navigator takes.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScalarKind {
    /// Speed of a wheel, forward positive [m/s].
    Odometer = 0,
    /// Height, up positive \[m\].
    Barometer = 1,
    /// Azimuth of a second antenna as seen from the first, from north to east \[rad\].
    Heading = 2,
}

/// Constants that can be estimated beside the sensors' errors: places in the array given to
/// undrift_filter_init().
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    /// Scale factor errors of gyro x, y, z.
    GyroScale = 0,
    /// Scale factor errors of accelerometer x, y, z.
    AccelScale = 1,
    /// Misalignment of the gyro axes xy, xz, yx, yz, zx, zy \[rad\].
    GyroMisalignment = 2,
    /// Misalignment of the accelerometer axes, in the same order \[rad\].
    AccelMisalignment = 3,
    /// Lever arm from IMU to antenna, body axes \[m\]; three states.
    LeverArm = 4,
    /// By how much a fix is later than its time says \[s\].
    TimeOffset = 5,
    /// Turn of the vehicle's axes against the body axes, about pitch and yaw \[rad\].
    Mounting = 6,
    /// Distance from IMU to the axle that does not steer, beyond the one given \[m\].
    Axle = 7,
    /// Scale factor error of the odometer.
    OdometerScale = 8,
    /// Error of the barometric height \[m\].
    BarometerBias = 9,
    /// By how much the velocity of a fix is later than its time says \[s\]; where it is estimated, the time offset
    /// is that of the position alone.
    VelocityTimeOffset = 10,
    /// By how much both time offsets grow, from the filter's start on [s/s].
    ClockRate = 11,
    /// By how much the accelerometers are later than the gyros \[s\].
    AccelDelay = 12,
    /// Direction of the second antenna in the body, from forward to right, beyond the one given \[rad\].
    HeadingOffset = 13,
    /// Hard iron of a magnetometer, body axes \[T\]; three states.
    HardIron = 14,
}

/// What is known of a parameter before: its correction is zero with this standard deviation.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Prior {
    /// Standard deviation of each state [the parameter's unit]; 0: not estimated.
    pub std: f64,
    /// Random walk [unit/sqrt(s)]; 0 for a constant.
    pub walk: f64,
    /// Correlation time of a Gauss-Markov process in place of the random walk \[s\]; 0 for a random walk.
    pub time: f64,
}

/// One inertial sample as increments over the interval that ends at `time`, body axes.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// End of the interval \[s\].
    pub time: f64,
    /// Length of the interval \[s\].
    pub dt: f64,
    /// Integrated angular rate \[rad\]: rate times dt for a sensor that gives rates.
    pub dtheta: [f64; 3],
    /// Integrated specific force [m/s].
    pub dvel: [f64; 3],
}

/// Position of the antenna.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Position {
    /// Latitude \[rad\].
    pub latitude: f64,
    /// Longitude \[rad\].
    pub longitude: f64,
    /// Height above the ellipsoid \[m\].
    pub height: f64,
    /// Covariance, north-east-down [m^2].
    pub covariance: [[f64; 3]; 3],
}

/// Velocity of the antenna over ground.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Velocity {
    /// North, east, down [m/s].
    pub velocity: [f64; 3],
    /// Covariance, north-east-down [(m/s)^2].
    pub covariance: [[f64; 3]; 3],
}

/// Limits of the normalised innovation squared, chi-squared with as many degrees of freedom as the
/// measurement has numbers; reject is at least weaken. INFINITY is no limit.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Gate {
    /// Above it the measurement's covariance is enlarged in proportion.
    pub weaken: f64,
    /// Above it the measurement is not used.
    pub reject: f64,
}

/// Whether a measurement was used.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Used as it was.
    Used = 0,
    /// Used with its covariance enlarged.
    Weakened = 1,
    /// Not used.
    Rejected = 2,
}

/// What an update did.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Update {
    /// Normalised innovation squared of the measurement at its stated covariance.
    pub nis: f64,
    /// Number of scalar measurements.
    pub dof: i32,
    /// Whether it was used.
    pub outcome: Outcome,
    /// Factor on its covariance: 1 if it was used as it was, above 1 if weakened, INFINITY if rejected.
    pub factor: f64,
}

/// The solution and its standard deviations.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct State {
    /// Time \[s\].
    pub time: f64,
    /// Latitude of the IMU \[rad\].
    pub latitude: f64,
    /// Longitude \[rad\].
    pub longitude: f64,
    /// Height above the ellipsoid \[m\].
    pub height: f64,
    /// Velocity over ground north, east, down [m/s].
    pub velocity: [f64; 3],
    /// Attitude, body to north-east-down: w, x, y, z.
    pub quaternion: [f64; 4],
    /// The same as roll, pitch, yaw \[rad\].
    pub roll_pitch_yaw: [f64; 3],
    /// Estimated errors of the gyros [rad/s]: what is taken off the next sample.
    pub gyro_error: [f64; 3],
    /// Estimated errors of the accelerometers [m/s^2].
    pub accel_error: [f64; 3],
    /// Angular rate of the body against the navigation frame, body axes, from the last sample [rad/s].
    pub angular_rate: [f64; 3],
    /// Standard deviation of the position north, east, down \[m\].
    pub position_std: [f64; 3],
    /// Standard deviation of the velocity north, east, down [m/s].
    pub velocity_std: [f64; 3],
    /// Standard deviation of the attitude about north, east, down \[rad\].
    pub attitude_std: [f64; 3],
    /// Standard deviation of the gyros' errors [rad/s].
    pub gyro_error_std: [f64; 3],
    /// Standard deviation of the accelerometers' errors [m/s^2].
    pub accel_error_std: [f64; 3],
}
