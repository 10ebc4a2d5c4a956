//! Lines of JSON, an object each: members are columns, those of inner objects by both names, numbers of arrays by their
//! place.

use serde_json::Value;

/// Objects that are looked at.
const OBJECTS: usize = 1000;
/// Of ten lines, so many are objects.
const MOST: usize = 8;

/// The columns of lines of JSON.
pub(super) struct JsonLines {
    names: Vec<String>,
}

impl JsonLines {
    /// What the beginning of a text shows; `None` of any other text.
    pub(super) fn detect<'a>(lines: impl Iterator<Item = &'a [u8]>) -> Option<Self> {
        let lines = lines
            .map(<[u8]>::trim_ascii)
            .filter(|line| !line.is_empty());
        let (mut names, mut all, mut objects) = (Vec::new(), 0, 0);
        for line in lines.take(OBJECTS) {
            all += 1;
            if !line.starts_with(b"{") && all == 1 {
                return None;
            }
            let Some(cells) = cells(line) else { continue };
            objects += 1;
            for (name, _) in cells {
                if !names.contains(&name) {
                    names.push(name);
                }
            }
        }
        (objects > 1 && 10 * objects >= MOST * all).then_some(Self { names })
    }

    /// The names as a line.
    pub(super) fn header(&self) -> Vec<u8> {
        let plain = |name: &String| name.replace([',', '"'], " ");
        Vec::from_iter(self.names.iter().map(plain))
            .join(",")
            .into_bytes()
    }

    /// A line as a row; one that is no object as it is.
    pub(super) fn row(&self, line: &[u8]) -> Vec<u8> {
        let Some(cells) = cells(line) else {
            return line.to_vec();
        };
        let value = |name: &String| {
            let found = cells.iter().find(|(other, _)| other == name);
            found.map_or("", |(_, value)| value.as_str())
        };
        Vec::from_iter(self.names.iter().map(value))
            .join(",")
            .into_bytes()
    }
}

/// The members of an object, each with its value as a cell.
fn cells(line: &[u8]) -> Option<Vec<(String, String)>> {
    let line = line.trim_ascii();
    // As Python prints it, between apostrophes.
    let quoted = || serde_json::from_str(&std::str::from_utf8(line).ok()?.replace('\'', "\"")).ok();
    let value: Value = serde_json::from_slice(line).ok().or_else(quoted)?;
    let mut cells = Vec::new();
    if !value.is_object() {
        return None;
    }
    put(&value, "", &mut cells);
    // Objects of one sensor each: its name is before those of the axes.
    let text = |key: &str| value.get(key).and_then(Value::as_str);
    let (sensor, name) = (text("sensor"), text("name"));
    for (member, _) in &mut cells {
        let (of, axis) = member.rsplit_once('.').unwrap_or(("", member.as_str()));
        let sensor = match of {
            "" => sensor,
            "values" | "data" => sensor.or(name),
            _ => None,
        };
        if let (Some(sensor), "x" | "y" | "z") = (sensor, axis) {
            *member = format!("{sensor}_{axis}");
        }
    }
    Some(cells)
}

/// The name of a member behind that of its object.
pub(super) fn inner(name: &str, key: &str) -> String {
    match name.is_empty() {
        true => key.to_owned(),
        false => format!("{name}.{key}"),
    }
}

/// The cells of a value, by the names around each.
pub(super) fn put(value: &Value, name: &str, cells: &mut Vec<(String, String)>) {
    let inner = |key: &str| inner(name, key);
    match value {
        Value::Object(members) => {
            for (key, value) in members {
                put(value, &inner(key), cells);
            }
        }
        Value::Array(values) if values.len() == 3 => {
            for (axis, value) in ["x", "y", "z"].iter().zip(values) {
                put(value, &inner(axis), cells);
            }
        }
        Value::Array(values) => {
            for (place, value) in values.iter().enumerate() {
                put(value, &inner(&place.to_string()), cells);
            }
        }
        Value::Number(number) => cells.push((name.to_owned(), number.to_string())),
        Value::String(text) if text.contains([',', '"']) => {
            cells.push((name.to_owned(), format!("\"{}\"", text.replace('"', "'"))));
        }
        Value::String(text) => cells.push((name.to_owned(), text.clone())),
        Value::Bool(yes) => cells.push((name.to_owned(), u8::from(*yes).to_string())),
        Value::Null => cells.push((name.to_owned(), String::new())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn objects_are_rows() {
        let text = "{\"t\": 1.5, \"gyro\": {\"x\": 1e-3, \"y\": null}, \"acc\": [1, 2, -3], \"q\": [1, 0]}\n\
                    {\"t\": 2, \"note\": \"a, b\", \"gyro\": {\"y\": 4}}\nbroken\n{\"t\": 3}\n{\"t\": 4}\n";
        let lines = || text.lines().map(str::as_bytes);
        let json = JsonLines::detect(lines()).unwrap();
        let rows = Vec::from_iter(lines().map(|line| String::from_utf8(json.row(line)).unwrap()));
        // Members in alphabetic order, as the reader of JSON gives them.
        let header = String::from_utf8(json.header()).unwrap();
        let mut names = Vec::from_iter(header.split(','));
        names.sort_unstable();
        let expected = [
            "acc.x", "acc.y", "acc.z", "gyro.x", "gyro.y", "note", "q.0", "q.1", "t",
        ];
        assert_eq!(names, expected);
        let at = |row: &str, name: &str| {
            let place = header.split(',').position(|other| other == name).unwrap();
            row.split(',').nth(place).unwrap().to_owned()
        };
        assert_eq!(at(&rows[0], "t"), "1.5");
        assert_eq!(at(&rows[0], "gyro.x"), "0.001");
        assert_eq!(
            (at(&rows[0], "gyro.y"), at(&rows[0], "acc.z")),
            ("".into(), "-3".into())
        );
        assert!(rows[1].contains("\"a, b\""));
        assert_eq!(rows[2], "broken");
        assert_eq!(at(&rows[4], "t"), "4");
    }

    #[test]
    fn objects_of_one_sensor_each() {
        let text = "{\"t\": 1, \"sensor\": \"gyro\", \"x\": 1}\n\
                    {\"t\": 2, \"name\": \"acc\", \"values\": [2, 3, 4]}\n\
                    {\"t\": 3, \"name\": \"imu\", \"a\": {\"x\": 5}, \"g\": {\"x\": 6}}\n";
        let lines = || text.lines().map(str::as_bytes);
        let header = String::from_utf8(JsonLines::detect(lines()).unwrap().header()).unwrap();
        for name in ["gyro_x", "acc_x", "acc_z", "a.x", "g.x"] {
            assert!(header.split(',').any(|other| other == name), "{header}");
        }
    }

    #[test]
    fn other_texts_stay_as_they_are() {
        for text in [
            "",
            "t,a\n1,2\n",
            "{\"t\": [1, 2]}\n",
            "[1, 2]\n[3, 4]\n",
            "{a\n{b\n",
        ] {
            assert!(
                JsonLines::detect(text.lines().map(str::as_bytes)).is_none(),
                "{text}"
            );
        }
    }
}
