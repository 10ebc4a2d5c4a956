//! Static records: six axes, or one, from a table, or six from a log that says itself what it holds.

use std::path::Path;
use undrift_io::{
    ReadError,
    format::{self, Format},
    imu::{ImuFormat, ImuReader},
    layouts,
    skipped::Skipped,
    table::{self, Column, Table, TableOptions},
};
use undrift_nav::units::{Quantity, unit_factor};
use undrift_noise::{
    model_file::AXES,
    screening::{Timing, timing},
};

/// Which columns of a record are which axes, and their units.
#[derive(Clone, Debug, Default)]
pub struct RecordFormat {
    /// Columns in the order of [`AXES`], or one; empty to go by the header's names.
    pub columns: Vec<Column>,
    /// The axis of a single column, such as "gyro_z".
    pub axis: Option<String>,
    /// Units of gyro and accelerometer columns, such as "deg/s" and "g"; `None` to go by the
    /// header's names.
    pub units: Option<(String, String)>,
    /// Read the temperature too, which the header must then name.
    pub temperature: bool,
    /// The stream of a log that has several of inertial samples.
    pub topic: Option<String>,
}

/// A record in SI units.
#[derive(Clone, Debug)]
pub struct Record {
    /// Names of the axes, of [`AXES`].
    pub axes: Vec<&'static str>,
    /// Samples of each axis [rad/s] or [m/s²].
    pub samples: Vec<Vec<f64>>,
    /// Temperature of each sample [°C or K], where it was asked for.
    pub temperature: Option<Vec<f64>>,
    /// What the time stamps say, where the header names a time column.
    pub timing: Option<Timing>,
    /// Rows left out.
    pub skipped: Skipped,
}

/// Names that a header may give an axis, without unit suffix.
const NAMES: [&[&str]; 6] = [
    &["gx", "gyro_x", "gyr_x", "wx", "omega_x", "p", "gyrox"],
    &["gy", "gyro_y", "gyr_y", "wy", "omega_y", "q", "gyroy"],
    &["gz", "gyro_z", "gyr_z", "wz", "omega_z", "r", "gyroz"],
    &["ax", "accel_x", "acc_x", "fx", "accelx"],
    &["ay", "accel_y", "acc_y", "fy", "accely"],
    &["az", "accel_z", "acc_z", "fz", "accelz"],
];

/// Names that a header may give the time [s].
const TIMES: [&str; 5] = ["t_s", "time_s", "time", "t", "timestamp_s"];

/// Names that a header may give the temperature, beside any that ends in one of the suffixes.
const TEMPERATURES: [&str; 2] = ["temp", "temperature"];
const DEGREES: [&str; 4] = ["_c", "_degc", "_celsius", "_kelvin"];

fn is_temperature(column: &str) -> bool {
    let name = column.trim().to_ascii_lowercase();
    TEMPERATURES.contains(&name.as_str()) || DEGREES.iter().any(|suffix| name.ends_with(suffix))
}

/// Unit suffixes of column names and what they mean.
const SUFFIXES: [(&str, &str); 9] = [
    ("_radps", "rad/s"),
    ("_rad_s", "rad/s"),
    ("_degps", "deg/s"),
    ("_deg_s", "deg/s"),
    ("_dps", "deg/s"),
    ("_mps2", "m/s^2"),
    ("_m_s2", "m/s^2"),
    ("_mg", "mg"),
    ("_g", "g"),
];

/// Splits `gx_dps` into the axis it names and its unit.
fn named_axis(column: &str) -> Option<(usize, Option<&'static str>)> {
    let lower = column.trim().to_ascii_lowercase();
    let (stem, unit) = SUFFIXES
        .iter()
        .find_map(|(suffix, unit)| {
            lower
                .strip_suffix(suffix)
                .map(|stem| (stem.to_owned(), Some(*unit)))
        })
        .unwrap_or((lower, None));
    NAMES
        .iter()
        .position(|names| names.contains(&stem.as_str()))
        .map(|axis| (axis, unit))
}

/// Reads a record.
///
/// # Errors
/// A file that cannot be read; columns or units that neither the format nor the header tells.
pub fn read(path: &Path, format: &RecordFormat) -> Result<Record, ReadError> {
    let known = match format::detect(path)? {
        _ if !format.columns.is_empty() => None,
        Format::KfGins => Some(layouts::kf_gins_imu()),
        Format::Euroc => Some(layouts::euroc_imu()),
        log if log.is_log() => Some(ImuFormat::log(log, format.topic.clone())),
        _ => None,
    };
    match known {
        Some(_) if format.temperature => Err(ReadError::new(
            path,
            "the temperature is read of tables only: name the columns",
        )),
        Some(imu) => read_known(path, &imu),
        None => read_table(path, format),
    }
}

/// Reads a record whose columns and units are known.
fn read_known(path: &Path, format: &ImuFormat) -> Result<Record, ReadError> {
    let mut reader = ImuReader::open(path, format)?;
    let mut samples = vec![Vec::new(); AXES.len()];
    let mut stamps = Vec::new();
    for sample in reader.by_ref() {
        let sample = sample?;
        let (gyro, accel) = (sample.dtheta / sample.dt, sample.dvel / sample.dt);
        for (axis, value) in samples.iter_mut().zip(gyro.iter().chain(&accel)) {
            axis.push(*value);
        }
        stamps.push(sample.time);
    }
    Ok(Record {
        axes: AXES.to_vec(),
        samples,
        temperature: None,
        timing: timing(&stamps).ok(),
        skipped: reader.skipped().clone(),
    })
}

fn read_table(path: &Path, format: &RecordFormat) -> Result<Record, ReadError> {
    let header = table::header_names(path)?;
    let wrong = |message: String| ReadError::new(path, message);
    let mut units: [Option<&str>; 6] = [None; 6];
    let columns: Vec<(usize, Column)> = match (format.columns.as_slice(), &format.axis) {
        ([], _) => {
            let found: Vec<(usize, Column)> = header
                .iter()
                .enumerate()
                .filter_map(|(place, name)| {
                    let (axis, unit) = named_axis(name)?;
                    units[axis] = unit;
                    Some((axis, Column::Number(place + 1)))
                })
                .collect();
            let mut seen: Vec<usize> = found.iter().map(|f| f.0).collect();
            seen.sort_unstable();
            seen.dedup();
            if found.is_empty() || seen.len() != found.len() {
                let there = if header.is_empty() {
                    "it has no header".to_owned()
                } else {
                    format!("it has: {}", header.join(", "))
                };
                return Err(wrong(format!(
                    "the columns of the six axes cannot be told from the header ({there}); name them with --columns gx,gy,gz,ax,ay,az"
                )));
            }
            found
        }
        ([one], axis) => {
            let named = match one {
                Column::Name(name) => named_axis(name),
                Column::Number(n) => header.get(n - 1).and_then(|name| named_axis(name)),
            };
            let axis = match axis {
                Some(name) => AXES.iter().position(|a| a == name).ok_or_else(|| {
                    wrong(format!(
                        "\"{name}\" is no axis; axes are {}",
                        AXES.join(", ")
                    ))
                })?,
                None => named.map(|n| n.0).ok_or_else(|| {
                    wrong(format!(
                        "say which axis column {one} is with --axis, one of {}",
                        AXES.join(", ")
                    ))
                })?,
            };
            units[axis] = named.and_then(|n| n.1);
            vec![(axis, one.clone())]
        }
        (six, _) if six.len() == 6 => six
            .iter()
            .enumerate()
            .map(|(axis, column)| {
                let name = match column {
                    Column::Name(name) => Some(name),
                    Column::Number(n) => header.get(n.wrapping_sub(1)),
                };
                units[axis] = name.and_then(|n| named_axis(n)).and_then(|n| n.1);
                (axis, column.clone())
            })
            .collect(),
        (other, _) => {
            return Err(wrong(format!(
                "{} columns named where six (gyro x, y, z, accelerometer x, y, z) or one are expected",
                other.len()
            )));
        }
    };
    let mut scales = Vec::new();
    for (axis, column) in &columns {
        let quantity = if *axis < 3 {
            Quantity::AngularRate
        } else {
            Quantity::Acceleration
        };
        let stated = format.units.as_ref().map(|(gyro, accel)| {
            if *axis < 3 {
                gyro.as_str()
            } else {
                accel.as_str()
            }
        });
        let unit = stated.or(units[*axis]).ok_or_else(|| {
            wrong(format!(
                "the unit of column {column} is not known; give --units, for instance \"deg/s,g\""
            ))
        })?;
        scales.push(
            unit_factor(unit, quantity).map_err(|e| wrong(format!("--units \"{unit}\": {e}")))?,
        );
    }
    let time = header
        .iter()
        .position(|name| TIMES.contains(&name.trim().to_ascii_lowercase().as_str()))
        .map(|place| ("time".to_owned(), Column::Number(place + 1)));
    let stamped = time.is_some();
    let temperature = match header.iter().position(|name| is_temperature(name)) {
        _ if !format.temperature => None,
        Some(place) => Some(("temperature".to_owned(), Column::Number(place + 1))),
        None => {
            return Err(wrong(
                "no column is the temperature: the header must name one \"temp\", \"temperature\" or with the ending \"_C\"".into(),
            ));
        }
    };
    let options = TableOptions {
        columns: columns
            .iter()
            .map(|(axis, column)| (AXES[*axis].to_owned(), column.clone()))
            .chain(temperature)
            .chain(time)
            .collect(),
        ..TableOptions::default()
    };
    let mut table = Table::open(path, &options)?;
    let mut row = vec![0.0; options.columns.len()];
    let mut temperature = format.temperature.then(Vec::new);
    let mut stamps = Vec::new();
    let mut samples = vec![Vec::new(); columns.len()];
    while table.next_row(&mut row)?.is_some() {
        for ((column, value), scale) in samples.iter_mut().zip(&row).zip(&scales) {
            column.push(value * scale);
        }
        if let Some(column) = &mut temperature {
            column.push(row[columns.len()]);
        }
        if stamped && let Some(time) = row.last() {
            stamps.push(*time);
        }
    }
    Ok(Record {
        axes: columns.iter().map(|(axis, _)| AXES[*axis]).collect(),
        samples,
        temperature,
        timing: timing(&stamps).ok(),
        skipped: table.skipped().clone(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_units_of_columns() {
        assert_eq!(named_axis("gx_dps"), Some((0, Some("deg/s"))));
        assert_eq!(named_axis("AZ_g"), Some((5, Some("g"))));
        assert_eq!(named_axis("gyro_y"), Some((1, None)));
        assert_eq!(named_axis("t_s"), None);
        for name in ["temp", "Temperature", "board_C", "T_degC"] {
            assert!(is_temperature(name), "{name}");
        }
        assert!(!is_temperature("t_s") && !is_temperature("gx_dps"));
    }
}
