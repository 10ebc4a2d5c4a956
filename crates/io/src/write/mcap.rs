//! The navigation solution as MCAP with messages of ROS 2, for Foxglove, rviz and whatever else
//! reads recordings of robots:
//!
//! * `/undrift/fix`, sensor_msgs/msg/NavSatFix: position with its covariance east-north-up.
//! * `/undrift/odom`, nav_msgs/msg/Odometry: the pose of `base_link` in `map`, and the velocity in
//!   `base_link`.
//! * `/undrift/imu`, sensor_msgs/msg/Imu: the attitude of `base_link` in east-north-up where it is;
//!   angular rate and specific force are marked as not given.
//!
//! Frames are those of REP-103 and REP-105: `base_link` is forward-left-up, `map` east-north-up with
//! its origin at the first row. Over long distances `map`'s up is no longer up where the vehicle is;
//! the poses allow for that. Covariances are of standard deviations alone, all zero (unknown) where
//! one of them is not finite.

mod cdr;
pub(super) mod container;

use std::f64::consts::{FRAC_PI_2, PI, SQRT_2};
use std::io::{self, Write};

use undrift_nav::attitude;
use undrift_nav::earth::Geodetic;
use undrift_nav::{Matrix3, Quaternion, Vector3};

use super::solution::SolutionRow;
use crate::epoch::{Epoch, nanoseconds};
use cdr::Cdr;
use container::Container;

/// Topics: name, type and definition, which is followed by those of the types that it needs.
const TOPICS: [[&str; 3]; 3] = [
    [
        "/undrift/fix",
        "sensor_msgs/msg/NavSatFix",
        include_str!("mcap/NavSatFix.msg"),
    ],
    [
        "/undrift/odom",
        "nav_msgs/msg/Odometry",
        include_str!("mcap/Odometry.msg"),
    ],
    [
        "/undrift/imu",
        "sensor_msgs/msg/Imu",
        include_str!("mcap/Imu.msg"),
    ],
];

const MAP: &str = "map";
const BODY: &str = "base_link";
/// Variance of an angular rate that is not known [(rad/s)²].
const UNKNOWN: f64 = 1e6;

/// Writes solution rows as MCAP.
pub struct McapWriter<W: Write> {
    out: Container<W>,
    topics: [u16; 3],
    epoch: Option<Epoch>,
    /// Position of the first row.
    origin: Option<Geodetic>,
    rows: u32,
    message: Cdr,
}

impl<W: Write> McapWriter<W> {
    /// Starts with the definitions. Messages are collected here; `out` needs no buffer. `epoch` is what the
    /// rows' times count from; without it the stamps are the rows' own times, and the metadata say so.
    ///
    /// # Errors
    /// If `out` does not take them.
    pub fn new(out: W, epoch: Option<Epoch>) -> io::Result<Self> {
        let library = concat!("undrift ", env!("CARGO_PKG_VERSION"));
        let mut out = Container::new(out, "ros2", library)?;
        let stamps = match epoch {
            Some(_) => "Unix time (UTC)",
            None => "seconds of the log's own clock: its date is unknown",
        };
        let mut about = vec![("stamps", stamps)];
        about.extend(epoch.map(|epoch| ("clock", epoch.clock.name())));
        out.metadata("undrift", &about)?;
        let topics = TOPICS.map(|[topic, name, definition]| out.channel(topic, name, definition));
        Ok(Self {
            out,
            topics,
            epoch,
            origin: None,
            rows: 0,
            message: Cdr::default(),
        })
    }

    /// Writes one row as three messages.
    ///
    /// # Errors
    /// If `out` does not take them, a value but a standard deviation is not finite, or the time is
    /// outside of what a stamp holds, 1901 to 2038.
    pub fn write(&mut self, row: &SolutionRow) -> io::Result<()> {
        let finite = |v: &Vector3| v.iter().all(|value| value.is_finite());
        if !row.position.is_valid() || !finite(&row.v_n) || !finite(&row.rpy) {
            return Err(invalid(format!("no solution at {} s", row.time)));
        }
        let stamp = stamp(self.epoch, row.time)?;
        let origin = *self.origin.get_or_insert(row.position);
        let [fix, odometry, imu] = self.topics;
        self.rows = self.rows.wrapping_add(1);
        write_fix(self.begin(stamp, BODY), row);
        self.end(fix, stamp)?;
        write_odometry(self.begin(stamp, MAP), row, &origin);
        self.end(odometry, stamp)?;
        write_imu(self.begin(stamp, BODY), row);
        self.end(imu, stamp)
    }

    /// Begins a message with its header.
    fn begin(&mut self, (seconds, nanoseconds): (i32, u32), frame: &str) -> &mut Cdr {
        self.message
            .begin()
            .i32(seconds)
            .u32(nanoseconds)
            .text(frame)
    }

    fn end(&mut self, topic: u16, (seconds, nanoseconds): (i32, u32)) -> io::Result<()> {
        // Recordings know no time before 1970.
        let time = u64::try_from(seconds).map_or(0, |s| s * 1_000_000_000 + u64::from(nanoseconds));
        let content = self.message.bytes();
        self.out.message(topic, self.rows, time, content)
    }

    /// Writes what is left and gives `out` back.
    ///
    /// # Errors
    /// If `out` does not take it.
    pub fn into_inner(self) -> io::Result<W> {
        self.out.finish()
    }
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

fn write_odometry(out: &mut Cdr, row: &SolutionRow, origin: &Geodetic) {
    let q_nb = attitude::from_rpy(&row.rpy);
    // Navigation axes here to those at the origin, which are then taken as east-north-up.
    let q_mn = enu_from_ned() * ecef_from_ned(origin).inverse() * ecef_from_ned(&row.position);
    let q_flu_n = flu_from_frd() * q_nb.inverse();
    let [n, e, d, vn, ve, vd, ..] = row.nav_std;
    let position = covariance(&q_mn, variances([n, e, d]));
    let velocity = covariance(&q_flu_n, variances([vn, ve, vd]));
    let turn = q_mn.to_rotation_matrix();
    let angles = turn * attitude_covariance(row) * turn.inverse();
    out.text(BODY)
        .f64s(&(enu_from_ned() * origin.ned_to(&row.position)));
    write_quaternion(out, &(q_mn * q_nb * flu_from_frd().inverse()));
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
fn ecef_from_ned(place: &Geodetic) -> Quaternion {
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

/// Seconds and nanoseconds of Unix time, or of the log's own where it has no date.
fn stamp(epoch: Option<Epoch>, time: f64) -> io::Result<(i32, u32)> {
    let ns = match epoch {
        Some(epoch) => epoch.unix_ns(time),
        None => nanoseconds(time),
    };
    let seconds = ns.div_euclid(1_000_000_000);
    let whole = i32::try_from(seconds);
    let whole = whole.map_err(|_| invalid(format!("invalid time stamp: {seconds} s")))?;
    Ok((whole, ns.rem_euclid(1_000_000_000) as u32))
}

fn invalid(problem: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, problem)
}

#[cfg(test)]
mod tests;
