//! The logs of a table: a row each, over what the manifest states of all.

use super::{
    Pattern,
    choice::{Choice, TEMPERATURE, times},
    rows,
};
use crate::Job;
use undrift_drive::drive::ConfigError;
use undrift_noise::temperature::celsius;

/// The jobs of a table by its text; `file` is what messages call it. A column that is no key of a log is a label.
pub(super) fn jobs(
    log: &Pattern,
    folder: &str,
    file: &str,
    text: &str,
) -> Result<Vec<Job>, ConfigError> {
    let error = |line, key: &str, message| ConfigError {
        file: file.to_owned(),
        line: Some(line),
        key: key.to_owned(),
        message,
    };
    let table = rows::read(text).map_err(|(line, why)| error(line, "", why))?;
    let mut jobs = Vec::with_capacity(table.rows.len());
    for (line, row) in table.rows {
        let mut log = log.clone();
        for (column, cell) in table.header.iter().zip(row) {
            if !cell.is_empty() {
                take(&mut log, column, cell).map_err(|why| error(line, column, why))?;
            }
        }
        let name = std::mem::take(&mut log.pattern);
        if name.is_empty() {
            let why = "missing: a column drive or record, or drive beside table in the manifest";
            return Err(error(line, "drive", why.into()));
        }
        jobs.push(log.job(folder, &name));
    }
    Ok(jobs)
}

/// Takes a cell that is not empty.
fn take(log: &mut Pattern, column: &str, cell: String) -> Result<(), String> {
    let Choice {
        data,
        unit,
        sensor,
        name,
        model,
        labels,
        plan,
        temperature_c,
        ..
    } = &mut log.choice;
    let slot = match column {
        "drive" | "record" => {
            (log.pattern, log.records) = (cell, column == "record");
            return Ok(());
        }
        "temperature" => {
            *temperature_c = Some(celsius(&cell).ok_or(TEMPERATURE)?);
            return Ok(());
        }
        "temperature_c" => {
            let value = cell.parse().ok().filter(|t: &f64| t.is_finite());
            *temperature_c = Some(value.ok_or("must be a number of degrees Celsius")?);
            return Ok(());
        }
        "at" => {
            plan.at_s = Some(times(&cell)?);
            return Ok(());
        }
        "data" => data,
        "unit" => unit,
        "type" => sensor,
        "name" => name,
        "model" => model,
        label => {
            labels.insert(label.to_owned(), cell);
            return Ok(());
        }
    };
    *slot = Some(cell);
    Ok(())
}
