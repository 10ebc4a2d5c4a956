//! The same as JSON, as the app exports and sends it: an object for each value of a sensor, `{"sensor": "Gyroscope", "time": "…", "x": …}`
//! or `{"name": "gyroscope", "time": …, "values": {"x": …}}`.

use std::io::{BufRead, BufReader, Cursor, Read};

use serde_json::Value;

use super::{ACCELS, AXES, FIELDS, GRAVITY, GYROS, LINEAR, MARK, PLACE, PLACES, chosen};
use crate::source::{Failing, Source};

/// Objects that are looked at.
const OBJECTS: usize = 20;

/// A value of a sensor.
struct Record {
    sensor: &'static str,
    /// Unix time \[ns\].
    time: i64,
    row: String,
}

/// Whether lines of JSON are such objects.
pub(crate) fn are_objects(start: &[u8]) -> bool {
    let lines = start.split(|byte| *byte == b'\n').take(OBJECTS);
    start.starts_with(b"{") && lines.filter(|line| record(line).is_some()).count() > 1
}

/// The text that a folder with the same values makes. They are held, since their order may be that of the sensors.
pub(crate) fn of_objects(source: Source, _: &[u8]) -> Source {
    let (mut records, mut failure) = (Vec::new(), None);
    for line in source.split(b'\n') {
        match line {
            Ok(line) => records.extend(record(&line)),
            Err(error) => {
                failure = Some(error);
                break;
            }
        }
    }
    records.sort_by_key(|record| record.time);
    let sensors = chosen(|name| records.iter().any(|record| record.sensor == name));
    let mut text = format!("{MARK}\n");
    for name in &sensors.names {
        let columns = columns(name).join(",");
        text += &format!("# {name},{columns}\n");
    }
    if sensors.linear {
        text += &format!("# {LINEAR}\n");
    }
    for record in records {
        if sensors.names.contains(&record.sensor) {
            text += &format!("{},{},{}\n", record.sensor, record.time, record.row);
        }
    }
    let text = Cursor::new(text.into_bytes());
    Box::new(text.chain(BufReader::new(Failing(failure))))
}

/// The columns of a sensor's rows.
fn columns(sensor: &str) -> &'static [&'static str] {
    match PLACES.contains(&sensor) {
        true => &PLACE,
        false => &AXES,
    }
}

/// The value of an object, if it is one of a sensor that is read.
fn record(line: &[u8]) -> Option<Record> {
    let object: Value = serde_json::from_slice(line).ok()?;
    let name = object.get("sensor").or(object.get("name"))?.as_str()?;
    let known = [GYROS, ACCELS, FIELDS, [LINEAR, GRAVITY], PLACES];
    let known = known.as_flattened();
    let sensor = known
        .iter()
        .find(|known| known.eq_ignore_ascii_case(name))?;
    let values = match object.get("values") {
        Some(values) => values,
        None => object.get("seconds_elapsed").map(|_| &object)?,
    };
    let text = |value: &Value| match value {
        Value::String(text) => text.clone(),
        Value::Number(number) => number.to_string(),
        _ => String::new(),
    };
    let time = object.get("time").map(text)?.parse().ok()?;
    let of = |column: &&str| values.get(column).map(text).unwrap_or_default();
    let row = Vec::from_iter(columns(sensor).iter().skip(1).map(of));
    Some(Record {
        sensor,
        time,
        row: row.join(","),
    })
}
