//! The solution as MAVLink 2: ODOMETRY and GPS_INPUT of every row, HEARTBEAT each second.
//!
//! ODOMETRY is local, north-east-down from the first row, its velocity forward-right-down, with covariances. GPS_INPUT has the position,
//! its height above the ellipsoid, for autopilots that take the solution in place of a receiver's. Stamps are Unix time, or that of the rows where
//! there is no date.

use std::io::{self, BufWriter, Write};

use super::solution::SolutionRow;
use crate::epoch::Epoch;
use crate::log::mavlink::frames::crc;
use undrift_nav::{Matrix3, Vector3, attitude::from_rpy, earth::Geodetic};

/// The vehicle's system, and the component of visual-inertial odometry.
const SENDER: [u8; 2] = [1, 197];
/// HEARTBEAT, ODOMETRY, GPS_INPUT: number, the byte of the definition in the CRC.
const HEARTBEAT: (u32, u8) = (0, 50);
const ODOMETRY: (u32, u8) = (331, 91);
const GPS_INPUT: (u32, u8) = (232, 151);
/// Frames of ODOMETRY: local north-east-down, body forward-right-down.
const LOCAL_NED: u8 = 1;
const BODY_FRD: u8 = 12;
/// The estimator is one of GNSS and inertial sensors.
const GPS_INS: u8 = 5;
/// GPS_INPUT lacks the dilutions of precision.
const IGNORED: u16 = 2 | 4;
/// A fix in three dimensions.
const FIX_3D: u8 = 3;
/// From one HEARTBEAT to the next \[s\].
const BEAT: f64 = 1.0;

/// Writes messages as rows come.
pub(super) struct MavlinkWriter<W: Write> {
    out: BufWriter<W>,
    epoch: Option<Epoch>,
    origin: Option<Geodetic>,
    sequence: u8,
    beat: f64,
}

/// A message's body, by its fields.
struct Body(Vec<u8>);

impl Body {
    fn f32(&mut self, values: impl IntoIterator<Item = f64>) {
        for value in values {
            self.0.extend((value as f32).to_le_bytes());
        }
    }
}

impl<W: Write> MavlinkWriter<W> {
    pub(super) fn new(out: W, epoch: Option<Epoch>) -> Self {
        Self {
            out: BufWriter::new(out),
            epoch,
            origin: None,
            sequence: 0,
            beat: f64::NEG_INFINITY,
        }
    }

    pub(super) fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }

    pub(super) fn into_inner(self) -> io::Result<W> {
        self.out
            .into_inner()
            .map_err(io::IntoInnerError::into_error)
    }

    /// Not inlined: its sines and roundings would be computed for every format, before it is known which one a file has.
    #[inline(never)]
    pub(super) fn write(&mut self, row: &SolutionRow) -> io::Result<()> {
        if !row.is_whole() {
            return Ok(());
        }
        if row.time >= self.beat {
            self.beat = row.time + BEAT;
            // An onboard controller that is no autopilot, active; the last byte is the version.
            self.send(HEARTBEAT, Body(vec![0, 0, 0, 0, 18, 8, 0, 4, 3]))?;
        }
        let micro = match self.epoch {
            Some(epoch) => epoch.unix_ns(row.time) / 1000,
            None => (row.time * 1e6).round() as i64,
        };
        let micro = micro.unsigned_abs();
        let odometry = self.odometry(row, micro);
        self.send(ODOMETRY, odometry)?;
        let gps = self.gps_input(row, micro);
        self.send(GPS_INPUT, gps)
    }

    fn odometry(&mut self, row: &SolutionRow, micro: u64) -> Body {
        let origin = *self.origin.get_or_insert(row.position);
        let place = origin.ned_to(&row.position);
        let q = from_rpy(&row.rpy);
        let to_body = q.inverse().to_rotation_matrix();
        let velocity = to_body * row.v_n;
        let std = |k: usize| Vector3::new(row.nav_std[k], row.nav_std[k + 1], row.nav_std[k + 2]);
        let variances = |k: usize| Matrix3::from_diagonal(&std(k).component_mul(&std(k)));
        let of_velocity = to_body * variances(3) * to_body.transpose();
        let unknown = Matrix3::repeat(f64::NAN);
        let mut body = Body(micro.to_le_bytes().to_vec());
        body.f32(place.iter().copied());
        body.f32([q.w, q.i, q.j, q.k]);
        body.f32(velocity.iter().copied());
        // The rates are not in a row.
        body.f32([f64::NAN; 3]);
        body.f32(upper(&variances(0), &variances(6)));
        body.f32(upper(&of_velocity, &unknown));
        body.0.extend([LOCAL_NED, BODY_FRD, 0, GPS_INS, 0]);
        body
    }

    fn gps_input(&self, row: &SolutionRow, micro: u64) -> Body {
        let (week, second) = self
            .epoch
            .map_or((0, 0.0), |epoch| epoch.week_second(row.time));
        let degrees = |angle: f64| (angle.to_degrees() * 1e7).round() as i32;
        let [north, east, down, v_north, v_east, v_down, ..] = row.nav_std;
        let speed = (v_north * v_north + v_east * v_east + v_down * v_down).sqrt();
        let mut body = Body(micro.to_le_bytes().to_vec());
        body.0.extend(((second * 1e3).round() as u32).to_le_bytes());
        for angle in [row.position.lat, row.position.lon] {
            body.0.extend(degrees(angle).to_le_bytes());
        }
        body.f32([row.position.height, 0.0, 0.0]);
        body.f32(row.v_n.iter().copied());
        body.f32([speed, north.hypot(east), down]);
        body.0.extend(IGNORED.to_le_bytes());
        body.0
            .extend(u16::try_from(week).unwrap_or(0).to_le_bytes());
        // How many satellites there are is not known: a fix takes four.
        body.0.extend([0, FIX_3D, 4]);
        // 36000 is north: 0 is for what is not known.
        let yaw = (row.rpy.z.to_degrees().rem_euclid(360.0) * 100.0).round() as u16;
        body.0
            .extend(if yaw == 0 { 36_000 } else { yaw }.to_le_bytes());
        body
    }

    fn send(&mut self, (number, extra): (u32, u8), Body(mut body): Body) -> io::Result<()> {
        // Payload truncation: trailing zero bytes are not sent, but the first byte is.
        while body.len() > 1 && body.last() == Some(&0) {
            body.pop();
        }
        let [low, middle, high, _] = number.to_le_bytes();
        let [system, component] = SENDER;
        let length = body.len() as u8;
        let head = [
            length,
            0,
            0,
            self.sequence,
            system,
            component,
            low,
            middle,
            high,
        ];
        self.sequence = self.sequence.wrapping_add(1);
        let mut covered = head.to_vec();
        covered.append(&mut body);
        self.out.write_all(&[0xfd])?;
        self.out.write_all(&covered)?;
        self.out.write_all(&crc(&covered, extra).to_le_bytes())
    }
}

/// The upper triangle of a matrix of six rows by rows, which consists of two blocks.
fn upper(first: &Matrix3, second: &Matrix3) -> [f64; 21] {
    let mut triangle = [0.0; 21];
    let places = (0..6).flat_map(|i| (i..6).map(move |j| (i, j)));
    for (slot, (i, j)) in triangle.iter_mut().zip(places) {
        *slot = match (i < 3, j < 3) {
            (true, true) => first[(i, j)],
            (false, false) => second[(i - 3, j - 3)],
            _ => 0.0,
        };
    }
    triangle
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::write::{SolutionFile, SolutionFormat, SolutionOptions};

    /// The bytes of two rows are those that pymavlink reads in testdata/golden/formats/mavlink/make.py, which compares them.
    #[test]
    fn rows_are_messages() {
        let mut row = SolutionRow::at(100.5, Geodetic::from_degrees(47.5, 8.25, 432.1));
        row.v_n = Vector3::new(3.0, 4.0, -0.5);
        row.rpy = Vector3::new(0.01, -0.02, 0.5);
        row.nav_std = [0.3, 0.4, 0.5, 0.03, 0.04, 0.05, 0.001, 0.002, 0.003];
        let options = SolutionOptions {
            epoch: Some(Epoch::of_week(2400, crate::epoch::ClockSource::Gnss)),
            ..SolutionOptions::default()
        };
        let mut file = SolutionFile::new(Vec::new(), SolutionFormat::Mavlink, &options).unwrap();
        file.write(&row, false).unwrap();
        row.time += 0.5;
        row.position = row.position.displaced(&Vector3::new(1.5, 2.0, -0.25));
        file.write(&row, true).unwrap();
        let bytes = file.into_inner().unwrap();
        let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../../testdata/golden/formats");
        let path = std::path::Path::new(root).join("mavlink/solution.mavlink");
        if std::env::var_os("UNDRIFT_BLESS").is_some() {
            std::fs::write(&path, &bytes).unwrap();
        }
        assert!(bytes == std::fs::read(path).unwrap());
    }
}
