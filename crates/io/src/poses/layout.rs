//! Files of poses whose columns are known: what others' programs write, always the same.
//!
//! * TUM: eight numbers a row with the time first and a quaternion of norm 1 last, x, y, z, w. Some programs write w
//!   first; without a header only the numbers can show it.
//! * Rows of KITTI with a time before them: the three by four matrix of rotation and position, row by row.
//! * EuRoC: `data.csv` of `state_groundtruth_estimate0`, `vicon0` and `leica0`, by its header.
//! * OptiTrack Motive, Vicon and Qualisys: see [`super::motive`], [`super::vicon`] and [`super::qualisys`].

use undrift_nav::{
    Matrix3, Vector3,
    units::{Quantity, unit_factor},
};

use super::columns::{AttitudeColumns, PoseFormat, QuaternionOrder};
use super::{PoseLog, PoseSource, motive, qualisys, vicon};
use crate::ReadError;
use crate::format::Format;
use crate::opened::Opened;
use crate::rotation::{of_matrix, of_quaternion};
use crate::table::{Column, Preview, three};

/// Rows that are looked at.
const ROWS: usize = 4000;
/// Rows out of ten that have to fit: a tracker loses its marker now and then.
const FIT: usize = 9;

/// How poses are read from a log whose layout is known: `None` where its columns have to be named.
/// `stream` is a topic, or a rigid body of Motive; without it the only one is meant.
///
/// # Errors
/// If the log cannot be read, or several rigid bodies could be meant.
pub fn detect(opened: &mut Opened, stream: Option<&str>) -> Result<Option<PoseSource>, ReadError> {
    let format = opened.format();
    if matches!(format, Format::RosBag | Format::Mcap | Format::RosBag2) {
        let log = PoseLog {
            stream: stream.map(str::to_owned),
            ..PoseLog::new(format)
        };
        return Ok(Some(log.into()));
    }
    // Rows of KITTI may have the signs of a text of KF-GINS.
    if !matches!(format, Format::Csv | Format::KfGins | Format::Parquet) {
        return Ok(None);
    }
    if format == Format::Csv
        && let Some(format) = motive::format(opened.start(), stream)
            .or_else(|| vicon::format(opened.start(), stream))
            .or_else(|| qualisys::format(opened.start(), stream))
    {
        let format = format.map_err(|error| error.in_log(opened.name()))?;
        return Ok(Some(format.into()));
    }
    Ok(of_table(&opened.preview(ROWS)?).map(PoseSource::from))
}

/// The same of the beginning of a table.
pub(super) fn of_table(table: &Preview) -> Option<PoseFormat> {
    let names: Vec<String> = table.names.iter().map(|name| stem(name)).collect();
    if let Some(format) = euroc(&names) {
        return Some(format);
    }
    let width = table.rows.first()?.len();
    let mut rows = table.rows.clone();
    // The last may be cut, and a log may have been cut at its first.
    rows.retain(|row| row.len() == width);
    let times = rows.iter().filter_map(|row| row.first().copied());
    let times: Vec<f64> = times.filter(|time| time.is_finite()).collect();
    let forward = times.windows(2).filter(|pair| pair[1] > pair[0]).count();
    if times.len() < 2 || 10 * forward < FIT * (times.len() - 1) {
        return None;
    }
    let unit =
        |place: usize, quantity| unit_factor(unit_in(table.names.get(place)?)?, quantity).ok();
    let time_scale = unit(0, Quantity::Time).unwrap_or(unix_scale(*times.first()?));
    let format = match width {
        8 => tum(&names, &rows)?,
        13 if names.is_empty() => kitti(&rows)?,
        _ => return None,
    };
    Some(PoseFormat {
        time_scale,
        position_scale: unit(1, Quantity::Length).unwrap_or(format.position_scale),
        ..format
    })
}

/// What a name has in brackets.
fn unit_in(name: &str) -> Option<&str> {
    let (_, unit) = name.split_once(['[', '('])?;
    Some(unit.trim_end_matches([']', ')']).trim())
}

/// The letters and digits of a name before its unit in brackets, small.
fn stem(name: &str) -> String {
    let name = name.split(['[', '(']).next().unwrap_or_default();
    let letters = name.chars().filter(char::is_ascii_alphanumeric);
    letters.map(|letter| letter.to_ascii_lowercase()).collect()
}

/// Factor from times that count from 1970 to seconds, by their size: of a time after 1973 in each unit.
fn unix_scale(time: f64) -> f64 {
    match time {
        ns if ns > 1e17 => 1e-9,
        us if us > 1e14 => 1e-6,
        ms if ms > 1e11 => 1e-3,
        _ => 1.0,
    }
}

/// Columns by their numbers from one on.
fn from<const N: usize>(first: usize) -> [Column; N] {
    std::array::from_fn(|k| Column::Number(first + k))
}

/// EuRoC: positions `p_RS_R_x`, and where it has them quaternions `q_RS_w`, w first.
fn euroc(names: &[String]) -> Option<PoseFormat> {
    let at = |name: &str| names.iter().position(|known| known == name);
    let is_time = names.first()? == "timestamp";
    let position = at("prsrx").filter(|_| is_time)? + 1;
    let attitude = at("qrsw").map(|first| AttitudeColumns::Quaternion {
        columns: from(first + 1),
        w_first: true,
    });
    Some(PoseFormat {
        time_scale: 1e-9,
        ..PoseFormat::new(Column::Number(1), Some(from(position)), attitude)
    })
}

/// TUM, where the rows can be such: names, if there are any, that are those of a position, and quaternions of norm 1.
fn tum(names: &[String], rows: &[Vec<f64>]) -> Option<PoseFormat> {
    let axes = |range: std::ops::Range<usize>| -> Option<String> {
        let names = names.get(range)?.iter();
        names.map(|name| name.chars().last()).collect()
    };
    if !names.is_empty() {
        let first = names.get(1)?.strip_suffix('x')?;
        let known = ["", "t", "p", "pos", "position", "trans", "translation"];
        if axes(1..4)? != "xyz" || !known.contains(&first) {
            return None;
        }
    }
    let quaternions: Vec<[f64; 4]> = rows
        .iter()
        .filter_map(|row| <[f64; 4]>::try_from(row.get(4..8)?).ok())
        .collect();
    let is_unit = |&&[a, b, c, d]: &&[f64; 4]| matches!(of_quaternion(a, [b, c, d]), Ok(Some(_)));
    let units: Vec<[f64; 4]> = quaternions.iter().filter(is_unit).copied().collect();
    if units.is_empty() || 10 * units.len() < FIT * rows.len() {
        return None;
    }
    let (w_first, quaternion_order) = match axes(4..8).as_deref() {
        Some("wxyz") => (true, QuaternionOrder::Stated),
        Some("xyzw") => (false, QuaternionOrder::Stated),
        _ => (is_w_first(&units), QuaternionOrder::Guessed),
    };
    let attitude = AttitudeColumns::Quaternion {
        columns: from(5),
        w_first,
    };
    Some(PoseFormat {
        quaternion_order,
        ..PoseFormat::new(Column::Number(1), Some(from(2)), Some(attitude))
    })
}

/// Whether the scalar part of quaternions is the first number, by the numbers alone; in TUM it is the last. Most programs choose the
/// sign by which it is never negative, and many begin where the marker's axes are those of the frame, w = 1. How a
/// quaternion changes from row to row is the same in both orders.
fn is_w_first(quaternions: &[[f64; 4]]) -> bool {
    let of = |k: usize| quaternions.iter().map(move |q| q[k]);
    // More than the noise of a turn about one axis.
    let never = |k: usize| of(k).all(|x| x >= 0.0) && of(k).any(|x| x > 0.5);
    // A tenth: one that only crosses zero shows nothing.
    let often = |k: usize| 10 * of(k).filter(|x| *x < 0.0).count() > quaternions.len();
    if never(0) && often(3) {
        return true;
    }
    if never(3) && often(0) {
        return false;
    }
    let begins = quaternions.first().map_or(0.0, |q| q[0]);
    begins > 1.0 - 1e-6
}

/// Rows of KITTI behind a time, where the rows can be such: the rotation is one.
fn kitti(rows: &[Vec<f64>]) -> Option<PoseFormat> {
    let is_pose = |row: &&Vec<f64>| {
        let rows = [1, 5, 9].map(|from| Vector3::transpose(&three(row, from)));
        of_matrix(&Matrix3::from_rows(&rows)).is_ok()
    };
    if 10 * rows.iter().filter(is_pose).count() < FIT * rows.len() {
        return None;
    }
    let numbers = [2, 3, 4, 6, 7, 8, 10, 11, 12].map(Column::Number);
    let position = [5, 9, 13].map(Column::Number);
    let attitude = AttitudeColumns::Matrix(numbers);
    Some(PoseFormat::new(
        Column::Number(1),
        Some(position),
        Some(attitude),
    ))
}
