//! Lines that are made rows of a table before they are read as such: those of JSON, of a serial monitor, and those with
//! cells that are no plain decimal numbers.

use super::cells::Cells;
use super::json::JsonLines;
use super::monitor::Monitor;
use super::unnamed;
use crate::source::without_byte_order_mark;

/// Lines that are looked at for cells.
const LINES: usize = 300;

/// What is to be done with each line.
pub(crate) struct Rewritten {
    json: Option<JsonLines>,
    monitor: Option<Monitor>,
    /// The header of rows that have none.
    names: Option<Vec<u8>>,
    cells: Option<Cells>,
}

impl Rewritten {
    /// What the beginning of a text shows; `None` of a table as usual.
    pub(super) fn detect(start: &[u8]) -> Option<Self> {
        let end = start.iter().rposition(|byte| *byte == b'\n');
        let whole = start.get(..end.map_or(start.len(), |end| end + 1))?;
        let whole = without_byte_order_mark(whole);
        let lines = || whole.split(|byte| *byte == b'\n');
        let mut found = Self {
            json: JsonLines::detect(lines()),
            monitor: None,
            names: None,
            cells: None,
        };
        if found.json.is_none() {
            found.monitor = Monitor::detect(start);
        }
        if found.json.is_none() && found.monitor.is_none() {
            let first = lines().take(LINES).map(<[u8]>::trim_ascii_end);
            found.names = unnamed::header(&Vec::from_iter(first.map(<[u8]>::to_vec)));
        }
        let header = found.header();
        let rows = lines().take(LINES).map(|line| found.row(line));
        let rows = Vec::from_iter(header.into_iter().chain(rows));
        found.cells = Cells::detect(&rows);
        let named = found.json.is_some() || found.monitor.is_some() || found.names.is_some();
        let any = named || found.cells.is_some();
        any.then_some(found)
    }

    /// The header that is no line of the text.
    pub(super) fn header(&self) -> Option<Vec<u8>> {
        let of_json = self.json.as_ref().map(JsonLines::header);
        let of_labels = || self.monitor.as_ref().and_then(Monitor::header);
        let header = of_json.or_else(of_labels).or_else(|| self.names.clone())?;
        let rewritten = self.cells.as_ref().and_then(|cells| cells.row(&header));
        Some(rewritten.unwrap_or(header))
    }

    /// A line as a row; one that is unlike the others as it is.
    pub(super) fn row(&self, line: &[u8]) -> Vec<u8> {
        let line = line.strip_suffix(b"\r").unwrap_or(line);
        let row = match (&self.json, &self.monitor) {
            (Some(json), _) => json.row(line),
            (None, Some(monitor)) => monitor.row(line),
            (None, None) => line.to_vec(),
        };
        let rewritten = self.cells.as_ref().and_then(|cells| cells.row(&row));
        rewritten.unwrap_or(row)
    }
}
