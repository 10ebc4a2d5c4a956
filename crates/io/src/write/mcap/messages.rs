//! The messages of a row, as ROS 2 serialises them.

use std::f64::consts::{FRAC_PI_2, PI, SQRT_2};
use std::io;

use undrift_nav::attitude;
use undrift_nav::earth::Geodetic;
use undrift_nav::{Matrix3, Quaternion, Vector3};

use super::cdr::Cdr;
use crate::epoch::{Epoch, nanoseconds};
use crate::write::solution::SolutionRow;

const MAP: &str = "map";
const BODY: &str = "base_link";
/// Variance of an angular rate that is not known [(rad/s)²].
const UNKNOWN: f64 = 1e6;

/// Seconds and nanoseconds of Unix time, or of the log's own where it has no date.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stamp {
    /// Whole seconds \[s\].
    pub seconds: i32,
    /// Of the second \[ns\].
    pub nanoseconds: u32,
}

impl Stamp {
    /// As one number \[ns\]; recordings know no time before 1970.
    pub fn nanoseconds(self) -> u64 {
        u64::try_from(self.seconds).map_or(0, |s| s * 1_000_000_000 + u64::from(self.nanoseconds))
    }

    /// # Errors
    /// If a stamp does not hold it: it holds 1901 to 2038.
    fn of_time(epoch: Option<Epoch>, time: f64) -> io::Result<Self> {
        let ns = match epoch {
            Some(epoch) => epoch.unix_ns(time),
            None => nanoseconds(time),
        };
        let seconds = ns.div_euclid(1_000_000_000);
        let whole = i32::try_from(seconds);
        let whole = whole.map_err(|_| invalid(format!("invalid time stamp: {seconds} s")))?;
        Ok(Self {
            seconds: whole,
            nanoseconds: ns.rem_euclid(1_000_000_000) as u32,
        })
    }
}

/// How well something does, as in diagnostic_msgs/DiagnosticStatus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// As it should.
    Ok = 0,
    /// Somebody should look.
    Warn = 1,
}

/// One diagnostic_msgs/DiagnosticStatus.
#[derive(Clone, Debug, PartialEq)]
pub struct Status<'a> {
    /// How well it does.
    pub level: Level,
    /// What is described.
    pub name: &'a str,
    /// In words.
    pub message: &'a str,
    /// Numbers by their names.
    pub values: Vec<(&'a str, f64)>,
}

/// A message that is made of a row.
pub type OfRow = for<'a> fn(&'a mut Messages, &SolutionRow, Stamp) -> &'a [u8];

/// Makes messages of rows, each serialised with its encapsulation. `map` has its origin at the first row.
#[derive(Debug)]
pub struct Messages {
    epoch: Option<Epoch>,
    origin: Option<Geodetic>,
    message: Cdr,
}

impl Messages {
    /// sensor_msgs/NavSatFix, nav_msgs/Odometry and sensor_msgs/Imu.
    pub const OF_A_ROW: [OfRow; 3] = [Self::fix, Self::odometry, Self::imu];

    /// `epoch` is what the rows' times count from; without it the stamps are the rows' own times.
    pub fn new(epoch: Option<Epoch>) -> Self {
        Self {
            epoch,
            origin: None,
            message: Cdr::default(),
        }
    }

    /// The stamp of a row, of which messages can be made.
    ///
    /// # Errors
    /// If a value but a standard deviation is not finite, or the time is outside of what a stamp holds, 1901 to 2038.
    pub fn stamp(&mut self, row: &SolutionRow) -> io::Result<Stamp> {
        let finite = |v: &Vector3| v.iter().all(|value| value.is_finite());
        if !row.position.is_valid() || !finite(&row.v_n) || !finite(&row.rpy) {
            return Err(invalid(format!("no solution at {} s", row.time)));
        }
        Stamp::of_time(self.epoch, row.time)
    }

    /// sensor_msgs/NavSatFix.
    pub fn fix(&mut self, row: &SolutionRow, stamp: Stamp) -> &[u8] {
        write_fix(self.begin(stamp, BODY), row);
        self.message.bytes()
    }

    /// nav_msgs/Odometry.
    pub fn odometry(&mut self, row: &SolutionRow, stamp: Stamp) -> &[u8] {
        let pose = self.pose(row);
        write_odometry(self.begin(stamp, MAP), row, &pose);
        self.message.bytes()
    }

    /// sensor_msgs/Imu.
    pub fn imu(&mut self, row: &SolutionRow, stamp: Stamp) -> &[u8] {
        write_imu(self.begin(stamp, BODY), row);
        self.message.bytes()
    }

    /// diagnostic_msgs/DiagnosticArray.
    pub fn diagnostics(&mut self, statuses: &[Status], stamp: Stamp) -> &[u8] {
        let out = self.begin(stamp, "").u32(statuses.len() as u32);
        for status in statuses {
            out.u8(status.level as u8)
                .text(status.name)
                .text(status.message)
                // No hardware in particular.
                .text("")
                .u32(status.values.len() as u32);
            for (name, value) in &status.values {
                out.text(name).text(&value.to_string());
            }
        }
        self.message.bytes()
    }

    /// The pose of `base_link` in `map`.
    pub fn pose(&mut self, row: &SolutionRow) -> Pose {
        let origin = *self.origin.get_or_insert(row.position);
        // Navigation axes here to those at the origin, which are then taken as east-north-up.
        let q_mn = enu_from_ned() * ecef_from_ned(&origin).inverse() * ecef_from_ned(&row.position);
        Pose {
            position: enu_from_ned() * origin.ned_to(&row.position),
            orientation: q_mn * attitude::from_rpy(&row.rpy) * flu_from_frd().inverse(),
            q_mn,
        }
    }

    /// Begins a message with its header.
    fn begin(&mut self, stamp: Stamp, frame: &str) -> &mut Cdr {
        self.message
            .begin()
            .i32(stamp.seconds)
            .u32(stamp.nanoseconds)
            .text(frame)
    }
}

/// Where `base_link` is in `map`, and how it is turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// East, north, up \[m\].
    pub position: Vector3,
    /// From `base_link` to `map`.
    pub orientation: Quaternion,
    /// From north-east-down at the row to `map`.
    q_mn: Quaternion,
}

fn write_fix(out: &mut Cdr, row: &SolutionRow) {
    let [n, e, d, ..] = row.nav_std;
    let (covariance, known) = match variances([e, n, d]) {
        Some(variances) => (Matrix3::from_diagonal(&variances), 2),
        None => (Matrix3::zeros(), 0),
    };
    let place = &row.position;
    // Status 0, a fix; service 0, none in particular.
    out.u8(0)
        .u16(0)
        .f64s(&[place.lat.to_degrees(), place.lon.to_degrees(), place.height])
        .f64s(&covariance)
        .u8(known);
}

fn write_odometry(out: &mut Cdr, row: &SolutionRow, pose: &Pose) {
    let q_flu_n = flu_from_frd() * attitude::from_rpy(&row.rpy).inverse();
    let [n, e, d, vn, ve, vd, ..] = row.nav_std;
    let position = covariance(&pose.q_mn, variances([n, e, d]));
    let velocity = covariance(&q_flu_n, variances([vn, ve, vd]));
    let turn = pose.q_mn.to_rotation_matrix();
    let angles = turn * attitude_covariance(row) * turn.inverse();
    out.text(BODY).f64s(&pose.position);
    write_quaternion(out, &pose.orientation);
    out.f64s(&blocks(&position, &angles))
        .f64s(&(q_flu_n * row.v_n))
        .f64s(&Vector3::zeros())
        .f64s(&blocks(&velocity, &Matrix3::from_diagonal_element(UNKNOWN)));
}

fn write_imu(out: &mut Cdr, row: &SolutionRow) {
    let q_nb = attitude::from_rpy(&row.rpy);
    write_quaternion(out, &(enu_from_ned() * q_nb * flu_from_frd().inverse()));
    let turn = enu_from_ned().to_rotation_matrix();
    let not_given = [-1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    out.f64s(&(turn * attitude_covariance(row) * turn.inverse()))
        .f64s(&Vector3::zeros())
        .f64s(&not_given)
        .f64s(&Vector3::zeros())
        .f64s(&not_given);
}

fn write_quaternion(out: &mut Cdr, q: &Quaternion) {
    out.f64s(&[q.i, q.j, q.k, q.w]);
}

/// East-north-up from north-east-down: half a turn about the line between north and east.
fn enu_from_ned() -> Quaternion {
    Quaternion::from_scaled_axis(Vector3::new(PI / SQRT_2, PI / SQRT_2, 0.0))
}

/// Forward-left-up from forward-right-down: half a turn about forward.
fn flu_from_frd() -> Quaternion {
    Quaternion::from_scaled_axis(Vector3::new(PI, 0.0, 0.0))
}

/// The inverse of [`Geodetic::ned_from_ecef`] as a quaternion.
pub(super) fn ecef_from_ned(place: &Geodetic) -> Quaternion {
    Quaternion::from_euler_angles(0.0, -FRAC_PI_2 - place.lat, place.lon)
}

fn variances(std: [f64; 3]) -> Option<Vector3> {
    let variances = Vector3::from(std.map(|s| s * s));
    variances.iter().all(|v| v.is_finite()).then_some(variances)
}

/// Independent variances in other axes; zero where they are not known.
fn covariance(turn: &Quaternion, variances: Option<Vector3>) -> Matrix3 {
    let turn = turn.to_rotation_matrix();
    let variances = variances.unwrap_or_else(Vector3::zeros);
    turn * Matrix3::from_diagonal(&variances) * turn.inverse()
}

/// Covariance of the attitude as small turns about north, east, down \[rad²\] from the standard
/// deviations of roll, pitch and yaw, by the axes about which these turn.
fn attitude_covariance(row: &SolutionRow) -> Matrix3 {
    let [.., roll, pitch, yaw] = row.nav_std;
    let Some(variances) = variances([roll, pitch, yaw]) else {
        return Matrix3::zeros();
    };
    let (sp, cp) = row.rpy.y.sin_cos();
    let (sy, cy) = row.rpy.z.sin_cos();
    let axes = Matrix3::new(cy * cp, -sy, 0.0, sy * cp, cy, 0.0, -sp, 0.0, 1.0);
    axes * Matrix3::from_diagonal(&variances) * axes.transpose()
}

/// Two symmetric blocks of three as rows of six.
fn blocks(first: &Matrix3, second: &Matrix3) -> [f64; 36] {
    let mut all = [0.0; 36];
    for row in 0..3 {
        for column in 0..3 {
            all[6 * row + column] = first[(row, column)];
            all[6 * (row + 3) + column + 3] = second[(row, column)];
        }
    }
    all
}

fn invalid(problem: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, problem)
}
