//! Rigid bodies that Qualisys Track Manager exports as TSV (6DOF): lines of a key and its value, then one that names the columns, in which the
//! name of a body is before its `X`. Lengths are mm; `Rot[0]` to `Rot[8]` are the rotation matrix column by column. A body that was not
//! seen has zeros.

use super::columns::{AttitudeColumns, PoseFormat};
use super::motive::the_body;
use crate::ReadError;
use crate::number;
use crate::source::without_byte_order_mark;
use crate::table::Column;

/// Lines above the rows, at most.
const LINES: usize = 60;
/// From X to `Rot[0]`.
const ROTATION: usize = 7;

/// How a body is read, that of a name or the only one; `None` of a text that is no such export.
pub(super) fn format(start: &[u8], body: Option<&str>) -> Option<Result<PoseFormat, ReadError>> {
    let start = without_byte_order_mark(start);
    let lines = start.split(|byte| *byte == b'\n').take(LINES);
    let (mut frequency, mut of_bodies) = (None, false);
    for (line, above) in lines.zip(1..) {
        let line = std::str::from_utf8(line).ok()?;
        let fields: Vec<&str> = line.split('\t').map(str::trim).collect();
        match fields[..] {
            ["FREQUENCY", value, ..] => frequency = number::parse_finite(value.as_bytes()),
            ["NO_OF_BODIES" | "BODY_NAMES", ..] => of_bodies = true,
            _ if of_bodies && fields.contains(&"Rot[0]") => {
                return Some(of_names(&fields, frequency, body, above));
            }
            _ => {}
        }
    }
    None
}

fn of_names(
    names: &[&str],
    frequency: Option<f64>,
    body: Option<&str>,
    above: u64,
) -> Result<PoseFormat, ReadError> {
    let of_body = |(x, name): (usize, &&'_ str)| {
        let is = names.get(x + ROTATION) == Some(&"Rot[0]");
        is.then_some((x, name.strip_suffix('X')?.trim_end().to_owned()))
    };
    let bodies: Vec<(usize, String)> = names.iter().enumerate().filter_map(of_body).collect();
    let known = bodies.iter().map(|(_, name)| name.as_str()).collect();
    let name = the_body(known, body, "body")?;
    let first = bodies.iter().find(|(_, other)| other == name);
    let x = first.map_or(0, |(x, _)| x + 1);
    let column = |name: &str| names.iter().position(|other| *other == name);
    let (time, time_scale) = match (column("Time"), column("Frame"), frequency) {
        (Some(time), ..) => (time, 1.0),
        (None, Some(frame), Some(frequency)) if frequency > 0.0 => (frame, 1.0 / frequency),
        _ => {
            let problem = "neither times nor frames and their frequency";
            return Err(ReadError::nameless(problem).mend("export with the time"));
        }
    };
    let rows = [0, 3, 6, 1, 4, 7, 2, 5, 8];
    let attitude = rows.map(|k| Column::Number(x + ROTATION + k));
    Ok(PoseFormat {
        time_scale,
        position_scale: 1e-3,
        header_lines: above,
        delimiter: Some(b'\t'),
        ..PoseFormat::new(
            Column::Number(time + 1),
            Some([0, 1, 2].map(|k| Column::Number(x + k))),
            Some(AttitudeColumns::Matrix(attitude)),
        )
    })
}
