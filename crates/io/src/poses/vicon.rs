//! Objects, segments and markers that Vicon Nexus and Tracker export as CSV: below `Objects`, `Segments` or `Trajectories` the rate, a line of
//! names before the first column of each, one of quantities and one of units. Times are the frames over the rate.
//!
//! `RX`, `RY`, `RZ` are a rotation vector, along the axis and as long as the angle, and with `RW` a quaternion; both turn vectors of the
//! segment into those of the room. Vicon calls the vector helical; Tracker 3.5 writes it unless its export is set to other angles, by the
//! README of github.com/AG6GR/Vicon_CSV, which turns it into quaternions, as a client of the DataStream SDK gets it from
//! `GetSegmentGlobalRotationHelical`. Angles about x, y, z have the same names and
//! are not read: the turns of poses and gyros then do not fit, which `inspect` finds.

use super::columns::{AttitudeColumns, PoseFormat};
use super::motive::the_body;
use crate::ReadError;
use crate::number;
use crate::source::without_byte_order_mark;
use crate::table::Column;

/// Lines above the rows.
const LINES: usize = 5;

/// How an object, segment or marker is read, that of a name or the only one; `None` of a text that is no such export.
pub(super) fn format(start: &[u8], body: Option<&str>) -> Option<Result<PoseFormat, ReadError>> {
    let start = without_byte_order_mark(start);
    let lines = start.split(|byte| *byte == b'\n').take(LINES);
    let lines = lines.map(|line| std::str::from_utf8(line).ok());
    let lines: Vec<Vec<&str>> = lines
        .map(|line| {
            Some(
                line?
                    .split(',')
                    .map(|field| field.trim().trim_matches('"'))
                    .collect(),
            )
        })
        .collect::<Option<_>>()?;
    let [title, rate, names, quantities, units] = &lines[..] else {
        return None;
    };
    let kind = match *title.first()? {
        "Objects" => "object",
        "Segments" => "segment",
        "Trajectories" => "marker",
        _ => return None,
    };
    let rate = number::parse_finite(rate.first()?.as_bytes()).filter(|rate| *rate > 0.0)?;
    (quantities.first() == Some(&"Frame"))
        .then(|| of_lines(names, quantities, units, (kind, rate), body))
}

fn of_lines(
    names: &[&str],
    quantities: &[&str],
    units: &[&str],
    (kind, rate): (&str, f64),
    body: Option<&str>,
) -> Result<PoseFormat, ReadError> {
    let known = names.iter().copied().filter(|name| !name.is_empty());
    let name = the_body(known.collect(), body, kind)?;
    let first = names
        .iter()
        .position(|other| *other == name)
        .unwrap_or_default();
    let behind = names.iter().skip(first + 1);
    let width = 1 + behind.take_while(|name| name.is_empty()).count();
    let place = |quantity: &str| {
        let own = quantities.iter().skip(first).take(width);
        own.clone()
            .position(|of| *of == quantity)
            .map(|k| first + k)
    };
    let three = |names: [&str; 3]| {
        let places: Option<Vec<usize>> = names.iter().map(|name| place(name)).collect();
        <[usize; 3]>::try_from(places?).ok()
    };
    let unit = |place: usize| units.get(place).copied().unwrap_or_default();
    let columns = |places: [usize; 3]| places.map(|place| Column::Number(place + 1));
    let Some(position) = three(["TX", "TY", "TZ"]).or_else(|| three(["X", "Y", "Z"])) else {
        let problem = format!("no TX, TY, TZ of {name}");
        return Err(ReadError::nameless(problem).mend("export global translations"));
    };
    let position_scale = match unit(position[0]) {
        "mm" => 1e-3,
        "cm" => 1e-2,
        "m" => 1.0,
        other => {
            let problem = format!("unknown unit of translations: \"{other}\"");
            return Err(ReadError::nameless(problem).mend("export in mm"));
        }
    };
    let turned = three(["RX", "RY", "RZ"]);
    let attitude = turned.map(|places| match place("RW") {
        Some(w) => {
            let [x, y, z] = columns(places);
            AttitudeColumns::Quaternion {
                columns: [x, y, z, Column::Number(w + 1)],
                w_first: false,
            }
        }
        None => AttitudeColumns::RotationVector {
            columns: columns(places),
            scale: match unit(places[0]) {
                "rad" => 1.0,
                _ => 1f64.to_radians(),
            },
        },
    });
    Ok(PoseFormat {
        time_scale: 1.0 / rate,
        position_scale,
        header_lines: LINES as u64,
        delimiter: Some(b','),
        ..PoseFormat::new(Column::Number(1), Some(columns(position)), attitude)
    })
}
