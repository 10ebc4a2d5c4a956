//! Static records: six axes, or one, from a table, or six from a log that says itself what it holds.

use crate::columns::{IMU_STEP, Meaning, meaning, time_unit};
use std::path::{Path, PathBuf};
use undrift_io::{
    Opened, ReadError,
    format::Format,
    imu::{ImuFormat, ImuReader},
    layouts,
    skipped::Skipped,
    table::{Column, Preview, Stamp, TableOptions},
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
#[derive(Clone, Debug, Default)]
pub struct Record {
    /// What messages call it.
    pub name: PathBuf,
    /// The regular file that it is read from; `None` of pipes and columns in memory.
    pub file: Option<PathBuf>,
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

/// Reads a record in one pass.
///
/// # Errors
/// A file that cannot be read; columns or units that neither the format nor the header tells.
pub fn read(opened: Opened, format: &RecordFormat) -> Result<Record, ReadError> {
    let record = Record {
        name: opened.name().to_path_buf(),
        file: opened.file().map(Path::to_path_buf),
        ..Record::default()
    };
    let known = match opened.format() {
        _ if !format.columns.is_empty() => None,
        Format::KfGins => Some(layouts::kf_gins_imu()),
        Format::Euroc => Some(layouts::euroc_imu()),
        log if log.is_log() => Some(ImuFormat::log(log, format.topic.clone())),
        _ => None,
    };
    match known {
        Some(_) if format.temperature => Err(ReadError::new(
            &record.name,
            "the temperature is read of tables only: name the columns",
        )),
        Some(imu) => read_samples(opened, &imu, record),
        None => read_table(opened, format, record),
    }
}

/// Reads a record whose columns and units are known.
fn read_samples(
    opened: Opened,
    format: &ImuFormat,
    mut record: Record,
) -> Result<Record, ReadError> {
    let mut reader = ImuReader::new(opened, format)?;
    record.axes = AXES.to_vec();
    record.samples = vec![Vec::new(); AXES.len()];
    let mut stamps = Vec::new();
    for sample in reader.by_ref() {
        let sample = sample?;
        let (gyro, accel) = (sample.dtheta / sample.dt, sample.dvel / sample.dt);
        for (axis, value) in record.samples.iter_mut().zip(gyro.iter().chain(&accel)) {
            axis.push(*value);
        }
        stamps.push(sample.time);
    }
    record.timing = timing(&stamps).ok();
    record.skipped = reader.skipped().clone();
    Ok(record)
}

/// Reads a record from a table's columns.
fn read_table(
    mut opened: Opened,
    format: &RecordFormat,
    mut record: Record,
) -> Result<Record, ReadError> {
    let beginning = opened.preview(BEGINNING)?;
    let found = find(&beginning, format);
    let Found { axes, time, wanted } =
        found.map_err(|problem| ReadError::new(&record.name, problem))?;
    let mut row = vec![0.0; wanted.columns.len()];
    let mut table = opened.table(&wanted)?;
    let mut temperature = format.temperature.then(Vec::new);
    let mut stamps = Vec::new();
    record.samples = vec![Vec::new(); axes.len()];
    while table.next_row(&mut row)?.is_some() {
        for ((column, value), axis) in record.samples.iter_mut().zip(&row).zip(&axes) {
            column.push(value * axis.scale);
        }
        if let Some(column) = &mut temperature {
            column.push(row[axes.len()]);
        }
        if let (Some(scale), Some(time)) = (time, row.last()) {
            stamps.push(*time * scale);
        }
    }
    record.axes = axes.iter().map(|axis| AXES[axis.index]).collect();
    record.temperature = temperature;
    record.timing = timing(&stamps).ok();
    record.skipped = table.skipped().clone();
    Ok(record)
}

/// A column of a record.
struct Axis {
    /// Its place in [`AXES`].
    index: usize,
    column: Column,
    /// The unit that its name tells.
    unit: Option<String>,
    /// From its unit to SI.
    scale: f64,
}

/// Where a table has what of a record.
struct Found {
    axes: Vec<Axis>,
    /// Factor from the time column, the last that is wanted, to seconds.
    time: Option<f64>,
    /// The axes, the temperature, the time.
    wanted: TableOptions,
}

/// Finds the columns; `Err` says what is missing.
fn find(beginning: &Preview, format: &RecordFormat) -> Result<Found, String> {
    let header = &beginning.header;
    let mut axes = find_axes(header, format)?;
    for axis in &mut axes {
        axis.scale = scale(axis, format)?;
    }
    let time = header
        .iter()
        .enumerate()
        .find_map(|(k, name)| match meaning(name) {
            Some((Meaning::Time, unit)) => Some((k, unit)),
            _ => None,
        });
    let temperature = match header.iter().position(|name| is_temperature(name)) {
        _ if !format.temperature => None,
        None => return Err("no column is the temperature: the header must name one \"temp\", \"temperature\" or with the ending \"_C\"".into()),
        found => found,
    };
    let numbered = |name: &str, place: usize| (name.to_owned(), Column::Number(place + 1));
    let keyed = axes
        .iter()
        .map(|axis| (AXES[axis.index].to_owned(), axis.column.clone()));
    let columns: Vec<_> = keyed
        .chain(temperature.map(|place| numbered("temperature", place)))
        .chain(time.as_ref().map(|(place, _)| numbered("time", *place)))
        .collect();
    let time: Option<f64> = time.map(|(place, unit)| match unit {
        Some(unit) => unit_factor(&unit, Quantity::Time).unwrap_or(1.0),
        None => {
            let stamps = beginning
                .rows
                .iter()
                .filter_map(|row| row.get(place).copied());
            let stamps: Vec<f64> = stamps.collect();
            time_unit(&stamps, IMU_STEP).map_or(1.0, |(_, factor)| factor)
        }
    });
    let stamp = time.map(|scale| Stamp {
        place: columns.len() - 1,
        scale,
        date: None,
    });
    let wanted = TableOptions {
        columns,
        stamp,
        ..TableOptions::default()
    };
    Ok(Found { axes, time, wanted })
}

/// The columns of the axes: as stated, else by the names in the header.
fn find_axes(header: &[String], format: &RecordFormat) -> Result<Vec<Axis>, String> {
    let named = |column: &Column| match column {
        Column::Name(name) => named_axis(name),
        Column::Number(n) => named_axis(header.get(n.wrapping_sub(1))?),
    };
    let axis = |index, column: &Column, unit| Axis {
        index,
        column: column.clone(),
        unit,
        scale: 1.0,
    };
    match format.columns.as_slice() {
        [] => {
            let columns = (1..=header.len()).map(Column::Number);
            let found: Vec<Axis> = columns
                .filter_map(|column| named(&column).map(|(index, unit)| axis(index, &column, unit)))
                .collect();
            let twice = (0..AXES.len()).any(|k| found.iter().filter(|a| a.index == k).count() > 1);
            if !found.is_empty() && !twice {
                return Ok(found);
            }
            let there = match header {
                [] => "it has no header".to_owned(),
                names => format!("it has: {}", names.join(", ")),
            };
            Err(format!(
                "the columns of the six axes cannot be told from the header ({there}); name them with --columns gx,gy,gz,ax,ay,az"
            ))
        }
        [one] => {
            let known = named(one);
            let index = match &format.axis {
                Some(name) => AXES.iter().position(|a| a == name).ok_or_else(|| {
                    format!("\"{name}\" is no axis; axes are {}", AXES.join(", "))
                })?,
                None => known.as_ref().map(|n| n.0).ok_or_else(|| {
                    let axes = AXES.join(", ");
                    format!("say which axis column {one} is with --axis, one of {axes}")
                })?,
            };
            Ok(vec![axis(index, one, known.and_then(|n| n.1))])
        }
        six if six.len() == AXES.len() => {
            let axes = six.iter().enumerate();
            let axes = axes.map(|(k, column)| axis(k, column, named(column).and_then(|n| n.1)));
            Ok(axes.collect())
        }
        other => Err(format!(
            "{} columns named where six (gyro x, y, z, accelerometer x, y, z) or one are expected",
            other.len()
        )),
    }
}

/// The factor from an axis's unit, stated or told by its name, to SI.
fn scale(axis: &Axis, format: &RecordFormat) -> Result<f64, String> {
    let (quantity, stated) = match (axis.index < 3, &format.units) {
        (true, units) => (Quantity::AngularRate, units.as_ref().map(|(gyro, _)| gyro)),
        (false, units) => (
            Quantity::Acceleration,
            units.as_ref().map(|(_, accel)| accel),
        ),
    };
    let unit = stated.or(axis.unit.as_ref()).ok_or_else(|| {
        let column = &axis.column;
        format!(
            "the unit of column {column} is not known; give --units, for instance \"deg/s,g\" (undrift inspect guesses it by the numbers)"
        )
    })?;
    unit_factor(unit, quantity).map_err(|e| format!("--units \"{unit}\": {e}"))
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
