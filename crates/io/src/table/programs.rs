//! Texts that programs write in a layout of their own, made tables with names before they are read as such: `.vbo` of Racelogic, IGC
//! flights, tracks of KML, `.gcsv` of Gyroflow, `.lvm` of LabVIEW, the stream of the app Sensorstream, what `ros2 topic echo` prints,
//! GTIMU, GPFPD and GPCHC sentences, and arrays of numpy.

mod echo;
mod fixes;
mod integrated;
mod numpy;
mod sensors;

use crate::source::{Source, converted};

/// A text as a table; `None` where it is not in that layout.
type Table = fn(&[u8]) -> Option<String>;

/// Whether the beginning of a file is in a layout.
type Shows = fn(&[u8]) -> bool;

/// What shows a layout, and how it becomes a table.
const LAYOUTS: [(Shows, Table); 9] = [
    (fixes::is_vbo, fixes::of_vbo),
    (fixes::is_igc, fixes::of_igc),
    (fixes::is_kml, fixes::of_kml),
    (sensors::is_gcsv, sensors::of_gcsv),
    (sensors::is_lvm, sensors::of_lvm),
    (sensors::is_stream, sensors::of_stream),
    (echo::is_there, echo::table),
    (integrated::is_there, integrated::table),
    (numpy::is_there, numpy::table),
];

/// Whether a file begins in one of the layouts.
pub(crate) fn may_be(start: &[u8]) -> bool {
    LAYOUTS.iter().any(|(is_there, _)| is_there(start))
}

/// The table as text; the text itself where it is in none of the layouts after all.
pub(crate) fn table(source: Source, start: &[u8]) -> Source {
    let known = LAYOUTS.iter().find(|(is_there, _)| is_there(start));
    let Some((_, table)) = known else {
        return source;
    };
    converted(source, table)
}

/// The lines of a text without blanks at their ends.
fn lines(text: &[u8]) -> impl Iterator<Item = &str> {
    let lines = text.split(|byte| *byte == b'\n');
    lines.filter_map(|line| Some(std::str::from_utf8(line).ok()?.trim()))
}

/// The rows below a header; `None` without one.
fn below(header: &str, rows: impl Iterator<Item = String>) -> Option<String> {
    let rows = Vec::from_iter(rows);
    (!rows.is_empty()).then(|| format!("{header}\n{}\n", rows.join("\n")))
}
