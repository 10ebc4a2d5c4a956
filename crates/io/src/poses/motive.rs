//! Rigid bodies that OptiTrack Motive exports as CSV: a block of lines names for each column its type, body, quantity and axis.
//! The quaternion is x, y, z, w; a body that was not seen has empty fields.

use super::columns::{AttitudeColumns, PoseFormat};
use crate::ReadError;
use crate::error::{Key, NAMES_SHOWN, the_file_has};
use crate::source::without_byte_order_mark;
use crate::table::Column;

/// Lines that the block has at most.
const LINES: usize = 20;

/// One line of the block.
type Line<'a> = Vec<&'a str>;

/// How a rigid body is read, that of a name or the only one; `None` of a text that is no such export.
pub(super) fn format(start: &[u8], body: Option<&str>) -> Option<Result<PoseFormat, ReadError>> {
    let start = without_byte_order_mark(start);
    if !start.starts_with(b"Format Version,") {
        return None;
    }
    let lines = start.split(|byte| *byte == b'\n').take(LINES);
    let mut block: Vec<Line> = Vec::new();
    for line in lines {
        let fields = std::str::from_utf8(line).ok()?.split(',');
        let fields = fields.map(|field| field.trim().trim_matches('"'));
        block.push(fields.collect());
        let is_last = block
            .last()
            .is_some_and(|line| line.first() == Some(&"Frame"));
        if is_last {
            return Some(of_block(&block, body));
        }
    }
    None
}

/// The body of a name, or the only one; `kind` is what an export calls them.
///
/// # Errors
/// Without bodies, without that of the name, and of several without a name.
pub(super) fn the_body<'a>(
    mut known: Vec<&'a str>,
    body: Option<&'a str>,
    kind: &str,
) -> Result<&'a str, ReadError> {
    known.dedup();
    let refused = |problem: String| {
        let error = ReadError::nameless(problem).key(Key::Topic("poses"));
        Err(error.mend(the_file_has(&known, NAMES_SHOWN)))
    };
    match (body, &known[..]) {
        (Some(body), known) if known.contains(&body) => Ok(body),
        (Some(body), _) => refused(format!("no {kind} \"{body}\"")),
        (None, [only]) => Ok(only),
        (None, []) => {
            let problem = "an export of motion capture without rigid bodies and markers";
            Err(ReadError::nameless(problem).mend("export with rigid bodies"))
        }
        (None, _) => refused(format!("more than one {kind}")),
    }
}

fn of_block(block: &[Line], body: Option<&str>) -> Result<PoseFormat, ReadError> {
    let header = block.first().map_or(&[][..], Vec::as_slice);
    let stated = |name: &str| {
        let at = header.iter().position(|field| *field == name)?;
        header.get(at + 1).copied()
    };
    // The names of lines are before the first column of a body.
    let labelled = |label: &str| {
        let line = block
            .iter()
            .find(|line| line.iter().take(3).any(|field| *field == label));
        line.map_or(&[][..], Vec::as_slice)
    };
    let (types, names) = (labelled("Type"), labelled("Name"));
    let [.., quantities, axes] = block else {
        return Err(ReadError::nameless("no header of Motive"));
    };
    // Markers of no body have a position alone.
    let kind = match types.contains(&"Rigid Body") {
        true => "Rigid Body",
        false => "Marker",
    };
    let bodies: Vec<(usize, &str)> = (types.iter().zip(names).enumerate())
        .filter(|(_, (of, _))| **of == kind)
        .map(|(column, (_, name))| (column, *name))
        .collect();
    let known = bodies.iter().map(|(_, name)| *name).collect();
    let name = the_body(known, body, &kind.to_lowercase())?;
    let column = |quantity: &str, axis: &str| {
        let is = |column: usize| {
            quantities.get(column) == Some(&quantity) && axes.get(column) == Some(&axis)
        };
        let own = bodies.iter().filter(|(_, other)| *other == name);
        let found = own.map(|(column, _)| *column).find(|column| is(*column));
        found.map(|column| Column::Number(column + 1))
    };
    let all = |quantity: &str, axes: &[&str]| -> Option<Vec<Column>> {
        axes.iter().map(|axis| column(quantity, axis)).collect()
    };
    let position = all("Position", &["X", "Y", "Z"]).and_then(|columns| columns.try_into().ok());
    let turned = all("Rotation", &["X", "Y", "Z", "W"]).and_then(|columns| columns.try_into().ok());
    if turned.is_none() && column("Rotation", "X").is_some() {
        let problem = "rotations as angles";
        return Err(ReadError::nameless(problem).mend("export with Rotation Type Quaternion"));
    }
    let attitude = turned.map(|columns| AttitudeColumns::Quaternion {
        columns,
        w_first: false,
    });
    let position_scale = match stated("Length Units") {
        None | Some("Meters") => 1.0,
        Some("Centimeters") => 1e-2,
        Some("Millimeters") => 1e-3,
        Some(other) => {
            let error = ReadError::nameless(format!("unknown Length Units: {other}"));
            return Err(error.at(1).mend("export in Meters"));
        }
    };
    Ok(PoseFormat {
        position_scale,
        header_lines: block.len() as u64,
        delimiter: Some(b','),
        ..PoseFormat::new(Column::Number(2), position, attitude)
    })
}
