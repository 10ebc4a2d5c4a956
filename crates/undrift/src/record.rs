//! Static records: six axes, or one, from a table, or six from a log that says itself what it holds.

use crate::columns::{IMU_STEP, Meaning, meaning, time_unit};
use std::path::Path;
use undrift_io::{
    ReadError,
    format::{self, Format},
    imu::{ImuFormat, ImuReader},
    layouts,
    skipped::Skipped,
    table::{self, Column, Columns, Table, TableOptions},
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

fn is_temperature(column: &str) -> bool {
    matches!(meaning(column), Some((Meaning::Temperature, _)))
}

/// The axis, of [`AXES`], that a column's name means, and its unit.
fn named_axis(column: &str) -> Option<(usize, Option<String>)> {
    match meaning(column)? {
        (Meaning::Gyro(axis), unit) => Some((axis, unit)),
        (Meaning::Accel(axis), unit) => Some((3 + axis, unit)),
        _ => None,
    }
}

/// Rows that the unit of the time is guessed from.
const BEGINNING: usize = 200;

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
        None => read_table(path, None, format),
    }
}

/// Reads a record of columns in memory; `name` is what messages call it.
///
/// # Errors
/// Columns or units that neither the format nor the names tell.
pub fn read_columns(
    name: &Path,
    columns: &Columns,
    format: &RecordFormat,
) -> Result<Record, ReadError> {
    read_table(name, Some(columns), format)
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

/// Reads the columns in `memory`, or else the file.
fn read_table(
    path: &Path,
    memory: Option<&Columns>,
    format: &RecordFormat,
) -> Result<Record, ReadError> {
    let header = match memory {
        Some(columns) => columns.names().to_vec(),
        None => table::header_names(path)?,
    };
    let wrong = |message: String| ReadError::new(path, message);
    let mut units: [Option<String>; 6] = Default::default();
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
                Column::Number(n) => header
                    .get(n.wrapping_sub(1))
                    .and_then(|name| named_axis(name)),
            };
            let axis = match axis {
                Some(name) => AXES.iter().position(|a| a == name).ok_or_else(|| {
                    wrong(format!(
                        "\"{name}\" is no axis; axes are {}",
                        AXES.join(", ")
                    ))
                })?,
                None => named.as_ref().map(|n| n.0).ok_or_else(|| {
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
        let unit = stated.or(units[*axis].as_deref()).ok_or_else(|| {
            wrong(format!(
                "the unit of column {column} is not known; give --units, for instance \"deg/s,g\" (undrift inspect guesses it by the numbers)"
            ))
        })?;
        scales.push(
            unit_factor(unit, quantity).map_err(|e| wrong(format!("--units \"{unit}\": {e}")))?,
        );
    }
    let found = header
        .iter()
        .enumerate()
        .find_map(|(place, name)| match meaning(name) {
            Some((Meaning::Time, unit)) => Some((place, unit)),
            _ => None,
        });
    let stamped = found.is_some();
    let time_scale = match &found {
        Some((_, Some(unit))) => unit_factor(unit, Quantity::Time).unwrap_or(1.0),
        Some((place, None)) => {
            let beginning = match memory {
                Some(columns) => columns.preview(BEGINNING),
                None => table::preview(path, BEGINNING)?,
            };
            let stamps: Vec<f64> = beginning
                .rows
                .iter()
                .filter_map(|row| row.get(*place).copied())
                .collect();
            time_unit(&stamps, IMU_STEP).map_or(1.0, |(_, factor)| factor)
        }
        None => 1.0,
    };
    let time = found.map(|(place, _)| ("time".to_owned(), Column::Number(place + 1)));
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
    let mut table = match memory {
        Some(columns) => Table::from_source(path, columns.clone(), &options)?,
        None => Table::open(path, &options)?,
    };
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
            stamps.push(*time * time_scale);
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
        assert_eq!(named_axis("gx_dps"), Some((0, Some("deg/s".into()))));
        assert_eq!(named_axis("AZ_g"), Some((5, Some("g".into()))));
        assert_eq!(named_axis("gyro_y"), Some((1, None)));
        assert_eq!(named_axis("t_s"), None);
        for name in ["temp", "Temperature", "board_C", "T_degC"] {
            assert!(is_temperature(name), "{name}");
        }
        assert!(!is_temperature("t_s") && !is_temperature("gx_dps"));
    }
}
