//! How an inspection knows what it says, and what it noticed.

use serde::{Deserialize, Serialize};
use undrift_nav::{Vector3, earth::STANDARD_GRAVITY};

/// How the value of a key is known.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Known {
    /// It follows from the file.
    #[default]
    Certain,
    /// By the name of its column, or of its columns.
    Name {
        /// Several columns.
        several: bool,
    },
    /// Guessed by the numbers of its column, or of its columns.
    Numbers {
        /// Several columns.
        several: bool,
    },
    /// Guessed.
    Guessed,
    /// Guessed by the step of the time stamps.
    StampStep,
    /// Guessed, as there is no column of times.
    NoTimes,
    /// Guessed, as there is no column of times: as many rows as the fixes last.
    RowsOfFixes,
    /// There is no number in the first rows.
    NoNumbers,
    /// Guessed by the median magnitude, which gravity makes.
    Gravity(f64),
    /// Not known: the median magnitude is gravity in no unit.
    NotGravity(f64),
    /// Guessed: the magnitude is gravity times the interval.
    Increments,
    /// Guessed by the largest rate.
    LargestRate(f64),
    /// Guessed: in rad/s the scatter of the quietest stretch would be too much.
    LargeScatter(f64),
    /// Guessed: in deg/s it would be too low for such a sensor.
    SmallScatter(f64),
    /// By the turns that the gyros and the course have in common.
    Clocks {
        /// Their correlation.
        correlation: f64,
        /// Whole hours of the offset, where it is whole ones.
        hours: f64,
        /// Whether leap seconds are part of it.
        leap: bool,
    },
    /// By the turns of the course: in the other unit the gyros would turn this many times as fast as it does.
    Turns(f64),
    /// Not known: there are too few samples.
    TooFew,
    /// Guessed: latitudes and longitudes are integers of 1e-7 degrees, as receivers count them.
    Integers,
    /// Guessed: standard deviations are whole numbers, too large for m or m/s: mm or mm/s.
    Thousandths,
    /// Guessed: no latitude is beyond π/2 and no longitude beyond π.
    SmallPlaces,
    /// Guessed: no angle is beyond 2π.
    SmallAngles,
    /// Guessed, as no column says it: to be set as fits the receiver.
    NoColumns,
    /// Estimated: what the positions are likeliest with where they were withheld for 10 s.
    Withheld {
        /// How often.
        spans: usize,
    },
    /// Estimated: the receiver filters its positions.
    Smooths {
        /// Half the variance of the times that it takes the mean over \[s²\], and its standard deviation.
        variance_s2: [f64; 2],
    },
    /// One log counts GPS seconds since 1980, the other Unix time.
    GpsSeconds,
    /// The fixes have times of day without a date, the IMU another clock.
    TimesOfDay {
        /// Whether leap seconds are part of the offset.
        leap: bool,
    },
    /// Assumed: the log has no heights.
    NoHeights,
    /// Guessed, as the log does not say it: to be set as fits the receiver.
    NotInLog,
    /// Guessed, as NMEA does not say it and has no vertical speed.
    NotInNmea,
    /// The first of several streams; the others.
    FirstOf(Vec<String>),
    /// The first of several streams that measures gravity and turns; the others.
    Measures(Vec<String>),
    /// Gyroscopes and accelerometers are streams of their own, which are joined.
    Apart,
    /// Most rows have the stamp of the row before, and other values.
    SharedStamps {
        /// Share of the rows.
        share: f64,
    },
    /// By their numbers against their names: the gyroscopes' columns measure gravity.
    Exchanged,
    /// Guessed: the accelerometers' numbers are counts, of the most usual range.
    Counts,
    /// Guessed by the turns of the course: with gravity as it is, the gyros turn against it.
    Reversed,
    /// By the motion: the columns of one sensor in another order.
    ExchangedAxes,
    /// By the motion: only with these axes reversed do gyros, accelerometers and fixes fit together.
    ReversedAxes,
    /// Guessed by the magnitude \[m/s²\] of the specific force, of a telephone whose accelerometers have the opposite sign.
    Telephone(f64),
    /// The z axis points down; x forward and y right are assumed.
    PointsDown,
    /// The z axis points up; x forward and y left are assumed.
    PointsUp,
    /// The z axis is not vertical.
    Tilted,
    /// Estimated from how a wheeled vehicle moved.
    Motion {
        /// Roll, pitch, yaw of the sensor in the vehicle \[deg\].
        rpy_deg: [f64; 3],
        /// Standard deviations of the error angles about forward, right and down \[deg\].
        std_deg: [f64; 3],
        /// Driving that it rests on \[s\].
        duration_s: f64,
    },
    /// What the estimated mounting is known to, by which attitudes of the vehicle are less certain.
    LessCertain,
    /// Of accelerometers that nobody calibrated, by which velocities are less certain.
    Uncalibrated,
    /// By the sensor's name in the log, or in its file's or folder's.
    SensorName,
    /// By the steps of the values.
    Steps,
    /// Guessed, as nothing in the log shows the kind of sensor.
    NoSensor,
    /// By the turns that samples and poses have in common.
    HandEye {
        /// Their correlation.
        correlation: f64,
        /// Standard deviation of the marker's axes \[deg\].
        std_deg: f64,
    },
    /// By the size of the turns of poses.
    TurnsOfPoses,
    /// By the accelerations that samples and poses have in common.
    Accelerations,
    /// The same of the lever arm.
    LeverArm {
        /// Its standard deviation \[m\].
        std_m: f64,
    },
    /// By what the turns of poses differ by from those of the gyros.
    Scatter,
    /// Poses are thinned, since those that follow at once err alike.
    Thinned,
    /// Poses err alike for a while, as a rule by so much.
    Lasting,
    /// Assumed, as the message is defined so: the heading is the vehicle's.
    VehicleHeading,
    /// Estimated in motion: the direction of the second antenna.
    Antennas {
        /// Its standard deviation \[deg\].
        std_deg: f64,
    },
    /// By the strength of the field, this many µT.
    Field(f64),
    /// The field turns so against the gyros.
    FieldTurns,
    /// Estimated from forces, speeds and turns.
    Forces {
        /// Standard deviation of the yaw \[deg\].
        std_deg: f64,
    },
}

/// Something worth knowing about a file.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Note {
    /// No header names the columns, and their numbers do not show what they are.
    UnknownColumns,
    /// The header names other columns.
    Columns(Vec<String>),
    /// There is no column of times.
    NoTimes,
    /// A solution of RTKLIB has no header: its columns and time system are taken to be RTKLIB's own.
    NoHeader,
    /// How the magnetometer's axes lie in the IMU's does not show: the gyros turned by this much in all \[deg\], too little, or no axes fit.
    NoMagnetometer {
        /// Turn of the gyros \[deg\].
        turned_deg: f64,
    },
    /// The names state another unit of accelerations than their size.
    UnitBySize {
        /// By the names.
        named: String,
        /// By the size.
        size: &'static str,
        /// Median magnitude.
        median: f64,
    },
    /// Streams that are declared and have no message.
    Empty {
        /// The table of a drive file that would read them.
        table: String,
        /// Their names.
        streams: Vec<String>,
    },
    /// Neither inertial samples nor positions.
    Nothing,
    /// The IMU moves along no one direction of its own: it is on no wheeled vehicle, or not fixed to it.
    NoWheels,
    /// It leans into its accelerations, as what flies does, but no profile of what flies predicts withheld fixes better.
    Flies,
    /// It has a forward direction, but moves across it more than wheels do.
    Slips {
        /// Velocity to the right beyond the solution's own error, RMS [m/s].
        right_ms: f64,
        /// Velocity down beyond it, RMS [m/s].
        down_ms: f64,
    },
    /// The logs have no time in common, and their turns do not show by how much the clocks differ.
    Apart {
        /// What is to be added to the times of the fixes if both begin at the same moment \[s\].
        offset_s: f64,
    },
    /// The accelerometers measure no gravity.
    NoGravity {
        /// Times gravity that they measure on average.
        ratio: f64,
    },
    /// What is wrong with poses, or why they could not be compared with the samples.
    Poses(PoseFault),
    /// How the IMU sits could not be estimated from the motion, and why.
    NoMounting(String),
}

/// What is wrong with poses, or why they and the samples show too little of each other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum PoseFault {
    /// The scalar part of the quaternions is the first of the four numbers.
    ScalarFirst,
    /// The quaternions turn local axes into the marker's.
    Inverse,
    /// The gyros are in another unit.
    GyroUnit {
        /// Size of the turns of the poses over those of the gyros.
        ratio: f64,
    },
    /// The positions are in this unit.
    Unit(String),
    /// The positions fit the attitudes and the accelerations in other axes of theirs: 1 to 3 for x to z, negative if reversed.
    PositionAxes([i8; 3]),
    /// One of the frames is left-handed.
    Mirrored,
    /// Turns of samples and poses have nothing in common.
    NoFit {
        /// Correlation of the turns.
        correlation: f64,
    },
    /// The marker hardly turned.
    Still {
        /// Root mean square of its rate [deg/s].
        rate_deg: f64,
    },
    /// The marker turned about one axis only.
    OneAxis,
    /// There are too few poses with an attitude.
    TooShort {
        /// Time that they cover \[s\].
        duration_s: f64,
    },
    /// There are too few positions beside attitudes.
    NoPositions,
    /// What the accelerometers measure beyond the motion is not gravity.
    NoGravity {
        /// What it is [m/s²].
        found: f64,
    },
    /// The marker moved against the IMU and stayed so.
    Slipped {
        /// When, on the clock of the samples \[s\].
        time: f64,
        /// By which angle \[deg\].
        angle_deg: f64,
        /// By how much \[m\], beyond what is uncertain of it.
        distance_m: f64,
    },
    /// The marker moved against the IMU for a long time.
    Slid {
        /// First time at which it shows \[s\].
        start: f64,
        /// Last one \[s\].
        end: f64,
        /// From before it to after it \[deg\].
        angle_deg: f64,
    },
    /// The attitudes jump while the gyros measure no turn.
    Jumped {
        /// First time \[s\].
        time: f64,
        /// Last one \[s\].
        end: f64,
        /// The largest \[deg\].
        angle_deg: f64,
        /// Whether the frame stays turned.
        lasting: bool,
    },
    /// The positions jump while the accelerometers measure nothing of it: their frame stays moved.
    Shifted {
        /// When, on the clock of the samples \[s\].
        time: f64,
        /// By how much \[m\].
        distance_m: f64,
    },
    /// Poses repeat the one before, as trackers write that have lost their marker.
    Frozen {
        /// How many.
        poses: u64,
        /// The first \[s\].
        time: f64,
    },
    /// Their clock is another one than that of the samples.
    Clock {
        /// What is to be added to their times \[s\].
        offset: f64,
    },
    /// There are no attitudes.
    NoAttitudes,
    /// Their clock runs at another rate.
    Rate {
        /// Seconds of theirs in one of the samples'.
        ratio: f64,
    },
    /// The longest part of the logs without such a break, which is described.
    Piece {
        /// From when on \[s\].
        start: f64,
        /// To when \[s\].
        end: f64,
    },
}

impl PoseFault {
    /// Whether the drive file that is made of the logs takes it into account: by a key, or where `cut` by reading a part of them.
    pub fn is_mended(&self, cut: bool) -> bool {
        match self {
            Self::ScalarFirst | Self::Unit(_) | Self::Frozen { .. } | Self::Clock { .. } => true,
            Self::Slipped { .. } | Self::Slid { .. } | Self::Shifted { .. } => cut,
            Self::Jumped { lasting, .. } => cut && *lasting,
            _ => false,
        }
    }
}

/// What a part of a file holds.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Content {
    /// The mean specific force \[m/s²\].
    Force([f64; 3]),
    /// Fixes.
    Fixes {
        /// Fixed, float, differential, single, of unknown kind.
        kinds: [u64; 5],
        /// Those with a velocity.
        velocities: u64,
    },
    /// Reference solutions, or poses in a local frame.
    Poses {
        /// Those with a velocity.
        velocities: u64,
        /// Those with an attitude.
        attitudes: u64,
    },
}

/// Whether a mean specific force \[m/s²\] is about gravity, as it is of an ordinary drive.
pub fn about_gravity(force: [f64; 3]) -> bool {
    (Vector3::from(force).norm() / STANDARD_GRAVITY - 1.0).abs() <= 0.15
}
