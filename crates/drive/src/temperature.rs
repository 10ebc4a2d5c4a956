//! The temperature of an inertial log: the column that holds it, and how a model uses it.

use crate::columns::{Meaning, meaning};
use std::path::Path;
use undrift_io::{
    Opened, ReadError,
    imu::{ImuFormat, ImuReader, ImuSource, TemperatureColumn, Thermal, ThermalAxis},
    table::{Column, Preview, TableOptions},
};
use undrift_noise::{ImuModel, temperature::ZERO_CELSIUS};

/// Rows that tell kelvins from degrees Celsius where the header does not.
const ROWS: usize = 100;
/// A temperature above this is in kelvins.
const LOWEST_KELVIN: f64 = 200.0;

/// The column of a table's beginning that has the temperature, by its name.
pub(crate) fn of_beginning(beginning: &Preview) -> Option<TemperatureColumn> {
    let mut names = beginning.header.iter().enumerate();
    let (place, unit) = names.find_map(|(place, name)| match meaning(name)? {
        (Meaning::Temperature, unit) => Some((place, unit)),
        _ => None,
    })?;
    let in_kelvin = match unit.as_deref() {
        Some(unit) => unit == "K",
        None => {
            let mut rows = beginning.rows.iter().filter_map(|row| row.get(place));
            rows.find(|t| t.is_finite())
                .is_some_and(|t| *t > LOWEST_KELVIN)
        }
    };
    Some(TemperatureColumn {
        column: Column::Number(place + 1),
        zero: if in_kelvin { ZERO_CELSIUS } else { 0.0 },
    })
}

/// The column of a log, if it is a table and has one.
pub(crate) fn column(
    opened: &mut Opened,
    format: &ImuFormat,
) -> Result<Option<TemperatureColumn>, ReadError> {
    match format.source {
        ImuSource::Table { .. } => of_table(opened),
        ImuSource::Log(..) | ImuSource::Samples => Ok(None),
    }
}

/// The column of a table.
fn of_table(opened: &mut Opened) -> Result<Option<TemperatureColumn>, ReadError> {
    Ok(of_beginning(&opened.preview(ROWS)?))
}

/// Mean of a table's column of temperatures [°C], if its header names one.
///
/// # Errors
/// If the table cannot be read, or none of its rows has a temperature.
pub fn mean(path: &Path) -> Result<Option<f64>, ReadError> {
    let mut opened = Opened::open(path)?;
    let Some(column) = of_table(&mut opened)? else {
        return Ok(None);
    };
    let options = TableOptions {
        columns: vec![("temperature".into(), column.column)],
        ..TableOptions::default()
    };
    let mut table = opened.table(&options)?;
    let (mut sum, mut count, mut row) = (0.0, 0u64, [0.0]);
    while table.next_row(&mut row)?.is_some() {
        sum += row[0];
        count += 1;
    }
    Ok(Some(sum / count as f64 - column.zero))
}

/// A reader that subtracts the model's bias over temperature, where the log has a temperature.
pub(crate) fn corrected(
    mut opened: Opened,
    format: &ImuFormat,
    model: Option<&ImuModel>,
) -> Result<ImuReader, ReadError> {
    let Some(thermal) = model.and_then(of_model) else {
        return ImuReader::new(opened, format);
    };
    let temperature = column(&mut opened, format)?;
    let format = ImuFormat {
        temperature,
        thermal: Some(thermal),
        ..format.clone()
    };
    ImuReader::new(opened, &format)
}

/// The bias over temperature of a model, if it has one of any axis.
pub(crate) fn of_model(model: &ImuModel) -> Option<Thermal> {
    let axes = model.axes().map(|(_, axis)| {
        axis.temperature.map(|of| ThermalAxis {
            reference_c: of.reference_c,
            range_c: of.range_c,
            slope: of.slope,
            quadratic: of.quadratic,
            body: of.body_axes,
        })
    });
    axes.iter().any(Option::is_some).then_some(axes)
}
