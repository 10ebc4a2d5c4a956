//! All outcomes as one table: a row for each outage, bias model or axis of each log, or for what failed.

use super::{FleetOutcome, OutcomeRow, outcome::columns};
use std::{io, path::Path};
use undrift_drive::findings::Finding;
use undrift_io::write::parquet_table::{ParquetTableWriter, Value};

/// Columns of text.
const TEXTS: [&str; 10] = [
    "log",
    "unit",
    "sensor",
    "task",
    "part",
    "note",
    "failed",
    "fingerprint",
    "labels",
    "warnings",
];

/// The table while it is written.
pub struct Table {
    writer: ParquetTableWriter,
    /// Columns of numbers behind the temperature.
    numbers: Vec<String>,
}

impl Table {
    /// Starts a file that appears under its name at [`Table::finish`].
    pub fn create(path: &Path) -> io::Result<Self> {
        let mut numbers: Vec<String> = Vec::new();
        for name in ["outages", "navigate", "identify", "tune"]
            .into_iter()
            .flat_map(columns)
        {
            if !numbers.contains(&name) {
                numbers.push(name);
            }
        }
        let text = |name| (name, Value::Text(None));
        let number = |name| (name, Value::Number(None));
        let mut columns: Vec<(&str, Value)> = TEXTS.into_iter().map(text).collect();
        columns.push(("outage", Value::Whole(None)));
        columns.push(("skipped_rows", Value::Whole(None)));
        columns.push(number("temperature_c"));
        columns.extend(numbers.iter().map(String::as_str).map(number));
        Ok(Self {
            writer: ParquetTableWriter::create(path, columns)?,
            numbers,
        })
    }

    /// Writes the rows of an outcome; one that failed has a row too, as has each part that failed.
    pub fn write(&mut self, outcome: &FleetOutcome, fingerprint: &str) -> io::Result<()> {
        let places: Vec<Option<usize>> = self
            .numbers
            .iter()
            .map(|name| outcome.columns.iter().position(|column| column == name))
            .collect();
        let rows = outcome
            .rows
            .iter()
            .map(|row| (Some(row.part.as_str()), None, row));
        let labels = &outcome.labels;
        // Texts by texts can always be written.
        let labels =
            (!labels.is_empty()).then(|| serde_json::to_string(labels).unwrap_or_default());
        let warnings = &outcome.warnings;
        let warnings = (!warnings.is_empty()).then(|| warnings.join("; "));
        let skipped = outcome.findings.iter().map(|finding| match finding {
            Finding::Skipped { records, .. } => *records,
            _ => 0,
        });
        let skipped = i32::try_from(skipped.sum::<u64>()).unwrap_or(i32::MAX);
        let whole = outcome.failed.as_deref().map(|why| (None, why));
        let (failed, nothing) = (outcome.failed_parts.iter(), OutcomeRow::default());
        // What failed as a whole says why its parts did.
        let parts = failed.map(|(part, why)| (Some(part.as_str()), why.as_str()));
        let failed = whole
            .into_iter()
            .chain(parts)
            .map(|(part, why)| (part, Some(why), &nothing));
        for (part, failed, row) in rows.chain(failed) {
            let texts = [
                Some(outcome.log.as_str()),
                outcome.unit.as_deref(),
                outcome.sensor.as_deref(),
                Some(outcome.task.as_str()),
                part,
                row.note.as_deref(),
                failed,
                Some(fingerprint),
                labels.as_deref(),
                warnings.as_deref(),
            ];
            let value = |place: &Option<usize>| place.and_then(|place| *row.values.get(place)?);
            let numbers = [outcome.temperature_c].into_iter();
            let numbers = numbers.chain(places.iter().map(value)).map(Value::Number);
            let outage = row.outage.and_then(|n| i32::try_from(n).ok());
            let row = texts
                .into_iter()
                .map(Value::Text)
                .chain([Value::Whole(outage), Value::Whole(Some(skipped))])
                .chain(numbers);
            self.writer.write(row)?;
        }
        Ok(())
    }

    /// Gives the file its name.
    pub fn finish(self) -> io::Result<()> {
        self.writer.finish()
    }
}
