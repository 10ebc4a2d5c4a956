//! Which columns of a table are the axes of a record, in which units.

use super::{RecordFormat, guess::Guess};
use crate::{
    columns::{IMU_STEP, Meaning, is_of_unknown_ticks, meaning, meanings, time_unit_of},
    inspect::{are_exchanged, three_of},
    temperature,
};
use undrift_io::table::{Column, Preview, Stamp, TableOptions};
use undrift_nav::units::{Quantity, unit_factor};
use undrift_noise::model_file::AXES;

/// The axis, of [`AXES`], that the meaning of a column is, and its unit.
pub(super) fn as_axis(
    meaning: Option<(Meaning, Option<String>)>,
) -> Option<(usize, Option<String>)> {
    match meaning? {
        (Meaning::Gyro(axis), unit) => Some((axis, unit)),
        (Meaning::Accel(axis), unit) => Some((3 + axis, unit)),
        _ => None,
    }
}

/// A column of a record.
pub(super) struct AxisColumn {
    /// Index in [`AXES`].
    pub(super) index: usize,
    pub(super) column: Column,
    /// Unit: stated, by the column's name, or guessed.
    pub(super) unit: Option<String>,
    /// Factor from that unit to SI.
    pub(super) scale: f64,
}

/// Where a table has what of a record.
pub(super) struct RecordColumns {
    pub(super) axes: Vec<AxisColumn>,
    /// Factor from the time column, the last that is wanted, to seconds.
    pub(super) time: Option<f64>,
    /// What the column of temperatures has at 0 °C, if there is one.
    pub(super) zero: Option<f64>,
    /// The axes, the temperature, the time.
    pub(super) wanted: TableOptions,
    pub(super) guessed: Vec<(&'static str, String)>,
}

/// Finds the columns; `Err` says what is missing. What neither the format nor the header says is guessed of six
/// axes.
pub(super) fn find(beginning: &Preview, format: &RecordFormat) -> Result<RecordColumns, String> {
    let header = &beginning.header;
    let mut guessed = Vec::new();
    let mut guess = None;
    let named = find_axes(header, format).and_then(|axes| {
        match format.columns.is_empty() && exchanged(&axes, beginning) {
            true => Err("the columns named as gyros measure gravity".to_owned()),
            false => Ok(axes),
        }
    });
    let mut axes = match named {
        Err(problem) if format.columns.is_empty() => {
            guess = Guess::from_preview(beginning);
            let of_guess = guess.as_ref().ok_or(problem)?.columns().enumerate();
            let found = of_guess.map(|(index, column)| AxisColumn {
                index,
                column: column.clone(),
                unit: None,
                scale: 1.0,
            });
            let found: Vec<AxisColumn> = found.collect();
            let columns: Vec<String> = found.iter().map(|axis| bare(&axis.column)).collect();
            guessed.push(("--columns", columns.join(",")));
            found
        }
        found => found?,
    };
    let unknown = axes.iter().any(|axis| axis.unit.is_none()) && format.units.is_none();
    if unknown && axes.len() == AXES.len() && format.columns.is_empty() {
        guess = guess.or_else(|| Guess::from_preview(beginning));
        if let Some(guess) = &guess {
            let units = guess.units()?;
            for axis in axes.iter_mut().filter(|axis| axis.unit.is_none()) {
                axis.unit = Some(units[usize::from(axis.index > 2)].clone());
            }
            guessed.push(("--units", units.join(",")));
        }
    }
    for axis in &mut axes {
        axis.scale = scale(axis, format)?;
    }
    let named =
        header.iter().zip(meanings(header)).enumerate().find_map(
            |(k, (_, meaning))| match meaning {
                Some((Meaning::Time, unit)) => Some((Column::Number(k + 1), unit)),
                _ => None,
            },
        );
    let named = named.or_else(|| Some((guess?.time?, None)));
    if let Some((column, None)) = &format.time
        && is_of_unknown_ticks(name(header, column), &values(beginning, column), IMU_STEP)
    {
        return Err(format!(
            "the unit of the times is unknown; state it, for instance --time \"{},LSB/32768 s\"",
            bare(column)
        ));
    }
    let time = format.time.clone().or(named).filter(|(column, unit)| {
        unit.is_some()
            || !is_of_unknown_ticks(name(header, column), &values(beginning, column), IMU_STEP)
    });
    let temperature = temperature::of_beginning(beginning);
    let zero = temperature.as_ref().map(|column| column.zero);
    let keyed = axes
        .iter()
        .map(|axis| (AXES[axis.index].to_owned(), axis.column.clone()));
    let optional = temperature.as_ref().map(|_| axes.len());
    let temperature = temperature.map(|temperature| temperature.column);
    let columns: Vec<_> = keyed
        .chain(temperature.map(|column| ("temperature".to_owned(), column)))
        .chain(
            time.iter()
                .map(|(column, _)| ("time".to_owned(), column.clone())),
        )
        .collect();
    let time: Option<f64> = time.map(|(column, unit)| match unit {
        Some(unit) => unit_factor(&unit, Quantity::Time).unwrap_or(1.0),
        None => {
            let stamps = values(beginning, &column);
            let name = name(header, &column);
            time_unit_of(name, &stamps, IMU_STEP).map_or(1.0, |(_, factor)| factor)
        }
    });
    let stamp = time.map(|scale| Stamp {
        place: columns.len() - 1,
        column: String::new(),
        scale,
        date: None,
    });
    let wanted = TableOptions {
        columns,
        stamp,
        optional,
        ..TableOptions::default()
    };
    Ok(RecordColumns {
        axes,
        time,
        zero,
        wanted,
        guessed,
    })
}

/// Whether the columns of gyros and accelerometers are exchanged, by their first numbers.
fn exchanged(axes: &[AxisColumn], beginning: &Preview) -> bool {
    let place = |index| {
        let axis = axes.iter().find(|axis| axis.index == index)?;
        beginning.place(&axis.column)
    };
    let samples = |from: usize| match [from, from + 1, from + 2].map(place) {
        [Some(x), Some(y), Some(z)] => three_of(&beginning.rows, [x, y, z]),
        _ => Vec::new(),
    };
    are_exchanged(&samples(0), &samples(3))
}

/// The name of a column; empty of one without.
fn name<'a>(header: &'a [String], column: &'a Column) -> &'a str {
    let name = match column {
        Column::Number(number) => header.get(number.wrapping_sub(1)),
        Column::Name(name) => Some(name),
    };
    name.map_or("", String::as_str)
}

/// The first numbers of a column.
fn values(beginning: &Preview, column: &Column) -> Vec<f64> {
    let place = beginning.place(column);
    let rows = beginning.rows.iter();
    rows.filter_map(|row| row.get(place?).copied()).collect()
}

/// A column as an option takes it.
fn bare(column: &Column) -> String {
    match column {
        Column::Name(name) => name.clone(),
        Column::Number(number) => number.to_string(),
    }
}

/// The columns of the axes: as stated, else by the names in the header.
fn find_axes(header: &[String], format: &RecordFormat) -> Result<Vec<AxisColumn>, String> {
    let known = meanings(header);
    let named = |column: &Column| match column {
        Column::Name(name) => match header.iter().position(|known| known == name) {
            Some(place) => as_axis(known.get(place)?.clone()),
            None => as_axis(meaning(name)),
        },
        Column::Number(n) => as_axis(known.get(n.wrapping_sub(1))?.clone()),
    };
    let axis = |index, column: &Column, unit| AxisColumn {
        index,
        column: column.clone(),
        unit,
        scale: 1.0,
    };
    match format.columns.as_slice() {
        [] => {
            let columns = (1..=header.len()).map(Column::Number);
            let found: Vec<AxisColumn> = columns
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
                "the header does not identify the columns of the six axes ({there}); specify them with --columns gx,gy,gz,ax,ay,az"
            ))
        }
        [one] => {
            let known = named(one);
            let index = match &format.axis {
                Some(name) => AXES.iter().position(|a| a == name).ok_or_else(|| {
                    format!("unknown axis \"{name}\"; available: {}", AXES.join(", "))
                })?,
                None => known.as_ref().map(|n| n.0).ok_or_else(|| {
                    let axes = AXES.join(", ");
                    format!("specify the axis of column {one} with --axis, one of {axes}")
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
            "{} columns specified; expected six (gyro x, y, z, accelerometer x, y, z) or one",
            other.len()
        )),
    }
}

/// The factor from an axis's unit, stated, by its name or guessed, to SI.
fn scale(axis: &mut AxisColumn, format: &RecordFormat) -> Result<f64, String> {
    let (quantity, stated) = match (axis.index < 3, &format.units) {
        (true, units) => (Quantity::AngularRate, units.as_ref().map(|(gyro, _)| gyro)),
        (false, units) => (
            Quantity::Acceleration,
            units.as_ref().map(|(_, accel)| accel),
        ),
    };
    axis.unit = stated.or(axis.unit.as_ref()).cloned();
    let unit = axis.unit.as_ref().ok_or_else(|| {
        let column = &axis.column;
        format!("the unit of column {column} is unknown; set --units, for instance \"deg/s,g\"")
    })?;
    unit_factor(unit, quantity).map_err(|e| format!("--units \"{unit}\": {e}"))
}
