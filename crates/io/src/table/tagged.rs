//! A text whose rows begin with the name of their sensor, or have it behind the time: `IMU,12.01,…` and `GPS,12.2,…`. Each sensor's rows
//! are a table, and these together one, see [`parts`](super::parts).
//!
//! The names of columns are in a line of their own for each sensor or for all, or in comments; without any they are made.

use super::fields::{Delimiter, Fields};
use super::parts::{Part, joined};
use super::wanted::starts_a_row;
use crate::number;
use crate::source::{Source, converted, without_byte_order_mark};

/// Places of the names in rows.
const PLACES: usize = 3;
/// Sensors in a file, and the letters of their names.
const MOST: usize = 24;
const LETTERS: usize = 40;
/// Of ten rows, so many begin with a sensor's name.
const USUAL: usize = 7;
/// Columns of a time and a sensor of three axes, with one more.
const VALUES: usize = 5;
/// Parts of the names of inertial sensors, of which one is to be there.
const INERTIAL: [&str; 4] = ["imu", "acc", "gyr", "inertial"];

/// What is before the names of a sensor's columns in the files of FlySight.
const COLUMNS: &[u8] = b"$COL,";
/// And what these begin with.
const FLYSIGHT: &[u8] = b"$FLYS,";

/// Whether a text begins with rows of at least one sensor.
pub(crate) fn may_be(start: &[u8]) -> bool {
    let end = start.iter().rposition(|byte| *byte == b'\n');
    place_of_tags(start.get(..end.unwrap_or_default()).unwrap_or_default()).is_some()
}

/// The table as text; the text itself where it is not of several sensors.
pub(crate) fn table(source: Source, _: &[u8]) -> Source {
    table_of(source, 2)
}

/// The same of the rows of a sensor or several between sentences of NMEA.
pub(crate) fn between_sentences(source: Source, _: &[u8]) -> Source {
    table_of(source, 1)
}

/// The table of so many sensors at least.
fn table_of(source: Source, least: usize) -> Source {
    converted(source, |text| {
        let parts = parts(text, place_of_tags(text)?);
        let least = if text.starts_with(FLYSIGHT) { 1 } else { least };
        (parts.len() >= least).then(|| joined(parts, true))?
    })
}

/// Where the names of sensors are in the rows, and the delimiter.
fn place_of_tags(text: &[u8]) -> Option<(usize, Delimiter)> {
    let text = without_byte_order_mark(text);
    let rows = text.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii);
    let rows = rows.filter(|line| starts_a_row(line)).take(5000);
    let rows = Vec::from_iter(rows);
    let delimiter = Delimiter::detect(rows.get(rows.len() / 2)?);
    (0..PLACES).find_map(|place| {
        let mut tags: Vec<&str> = Vec::new();
        let mut count = 0;
        for row in &rows {
            let Some(tag) = tag(row, place, delimiter).filter(|_| is_of_numbers(row, delimiter))
            else {
                continue;
            };
            count += 1;
            if !tags.contains(&tag) {
                tags.push(tag);
            }
        }
        let stated = text.starts_with(FLYSIGHT);
        let inertial = |tag: &&str| {
            let tag = tag.to_lowercase();
            stated || INERTIAL.iter().any(|word| tag.contains(word))
        };
        let usual = count > 2 && 10 * count >= USUAL * rows.len();
        (usual && tags.len() <= MOST && tags.iter().any(inertial)).then_some((place, delimiter))
    })
}

/// The name of the sensor of a row.
fn tag(row: &[u8], place: usize, delimiter: Delimiter) -> Option<&str> {
    let tag = std::str::from_utf8(Fields::new(row, delimiter).nth(place)?).ok()?;
    let tag = tag.trim_matches(['"', ':', '[', ']', '$', ' ']);
    let is_name = tag.starts_with(char::is_alphabetic)
        && tag.len() <= LETTERS
        && tag
            .chars()
            .all(|c| c.is_alphanumeric() || matches!(c, '_' | '-' | '.' | ' ' | '/'));
    is_name.then_some(tag)
}

/// Whether a name is that of a sentence of NMEA by its talker.
fn is_sentence(tag: &str) -> bool {
    let talkers = ["GP", "GN", "GL", "GA", "GB", "GQ"];
    let of_talker = talkers.iter().any(|talker| tag.starts_with(talker));
    of_talker && tag.len() == 5 && tag.chars().all(|c| c.is_ascii_uppercase())
}

/// Whether a row has numbers, and not the names of columns.
fn is_of_numbers(row: &[u8], delimiter: Delimiter) -> bool {
    let numbers =
        Fields::new(row, delimiter).filter(|field| number::parse_with_comma(field).is_some());
    numbers.count() >= 2
}

/// The tables of the sensors, in the order in which they come first.
fn parts(text: &[u8], (place, delimiter): (usize, Delimiter)) -> Vec<Part> {
    let mut parts: Vec<Part> = Vec::new();
    let mut headers: Vec<(String, Vec<String>)> = Vec::new();
    let text = without_byte_order_mark(text);
    for (number, line) in text.split(|byte| *byte == b'\n').enumerate() {
        let line = without_comment(line);
        // FlySight names the columns of a sensor in a line of its own kind.
        let line = line.strip_prefix(COLUMNS).unwrap_or(line);
        if line.is_empty() {
            continue;
        }
        let cells = |plain: fn(&str) -> String| {
            // Without the checksum of a sentence.
            let sum = line.len().saturating_sub(3);
            let line = line
                .get(..sum)
                .filter(|_| line.get(sum) == Some(&b'*'))
                .unwrap_or(line);
            let fields = Fields::new(line, delimiter).map(String::from_utf8_lossy);
            let mut cells = Vec::from_iter(fields.map(|cell| plain(&cell)));
            if place < cells.len() {
                cells.remove(place);
            }
            cells
        };
        if !is_of_numbers(line, delimiter) {
            let names = cells(|name| name.trim_matches('"').to_owned());
            if names.len() > 1 {
                let tag = tag(line, place, delimiter).unwrap_or_default();
                headers.push((tag.to_owned(), names));
            }
            continue;
        }
        let Some(tag) = tag(line, place, delimiter).filter(|tag| !is_sentence(tag)) else {
            continue;
        };
        let row = cells(|cell| cell.replace(',', ".")).join(",");
        let known = parts.iter().position(|part| part.name == tag);
        match known.and_then(|place| parts.get_mut(place)) {
            Some(part) => part.rows.push((number, row)),
            None => parts.push(Part {
                name: tag.to_owned(),
                names: Vec::new(),
                rows: vec![(number, row)],
            }),
        }
    }
    // Of no sensor: for all.
    let all = Vec::from_iter(parts.iter().map(|part| part.name.clone()));
    // Where one has names of its own, each has: others are those of sensors without rows.
    let own = headers.iter().any(|(tag, _)| all.contains(tag));
    let is_common = |_: &&(String, Vec<String>)| !own;
    for part in &mut parts {
        let own = headers.iter().find(|(tag, _)| *tag == part.name);
        let width = part
            .rows
            .first()
            .map_or(0, |(_, row)| row.split(',').count());
        // Names for all are those of values that differ from sensor to sensor, unless there are many.
        let mut common = headers.iter().filter(is_common);
        let common = common.find(|(_, names)| names.len() == width && width > VALUES);
        part.names = own
            .or(common)
            .map_or(Vec::new(), |(_, names)| names.clone());
    }
    parts
}

/// A line without the mark of a comment; of one with a part in quotes, as the app GetSensorData writes its formats, that part.
fn without_comment(line: &[u8]) -> &[u8] {
    let mut line = line.trim_ascii();
    let whole = line;
    while let [b'#' | b'%', rest @ ..] = line {
        line = rest.trim_ascii();
    }
    let mut quoted = line.split(|byte| *byte == b'\'').skip(1);
    match quoted.next().filter(|_| line.len() < whole.len()) {
        Some(inside) if quoted.next().is_some() => inside,
        _ => line,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{Cursor, Read};

    fn read(text: &str) -> Option<Vec<String>> {
        if !may_be(text.as_bytes()) {
            return None;
        }
        let mut read = String::new();
        let source = Cursor::new(text.as_bytes().to_vec());
        table(Box::new(source), b"")
            .read_to_string(&mut read)
            .unwrap();
        let lines = read.lines().filter(|line| !line.is_empty());
        (read != text).then(|| lines.map(str::to_owned).collect())
    }

    /// A header, words that are passed over, positions in between: what is said of a row has the line that it is in.
    #[test]
    fn rows_stay_in_their_lines() {
        let row = |k: i32| format!("IMU,0.{k},0.1,0.2,0.3,0.1,0.2,9.8\n");
        let text = "NAME,t,a,b,c,d,e,f\nstarted at last\n".to_owned()
            + &(2..6).map(row).collect::<String>()
            + "GPS,0.5,48.5,11.25,520\nGPS,0.6,48.5,11.25,520\n"
            + &row(7);
        let mut read = String::new();
        let source = Box::new(Cursor::new(text.clone().into_bytes()));
        table(source, b"").read_to_string(&mut read).unwrap();
        for stamp in ["0.2,", "0.4,", "0.7,"] {
            let in_file = text.lines().position(|line| line[4..].starts_with(stamp));
            let in_table = read.lines().position(|line| line.starts_with(stamp));
            assert_eq!(in_table, in_file, "{read}");
        }
    }

    /// Without names: the sensor that has gravity is the one of steady size.
    #[test]
    fn rows_of_two_sensors_are_one_table_by_their_times() {
        let imu = |t: &str, turn: f64| format!("IMU,{t},{turn},0.2,0.3,0.1,0.2,9.8\n");
        // The second position comes late.
        let text = imu("0.1", 0.1)
            + &imu("0.2", -0.7)
            + "GPS,0.2,48.5,11.25,520\n"
            + &imu("0.3", 0.4)
            + &imu("0.4", 0.2)
            + "GPS,0.35,48.75,11.25,519\n"
            + "cut\n";
        assert_eq!(
            read(&text).unwrap(),
            [
                "time,gx,gy,gz,ax,ay,az,lat,lon,alt",
                "0.1,0.1,0.2,0.3,0.1,0.2,9.8,,,",
                "0.2,-0.7,0.2,0.3,0.1,0.2,9.8,48.5,11.25,520",
                "0.3,0.4,0.2,0.3,0.1,0.2,9.8,,,",
                "0.35,,,,,,,48.75,11.25,519",
                "0.4,0.2,0.2,0.3,0.1,0.2,9.8,,,",
            ]
        );
    }

    /// Of a sensor with two times the first is common.
    #[test]
    fn sensors_without_names_and_with_more_columns() {
        let row =
            |name: &str, t: f64, x: f64| format!("{name};{t:.2};{:.3};{x};2;3;1\n", t + 5.001);
        let times = (0..9).map(|k| 0.1 * f64::from(k));
        let rows: String = times
            .map(|t| row("ACCE", t, 9.5) + &row("GYRO", t, 0.1))
            .collect();
        let lines = read(&rows).unwrap();
        assert_eq!(
            lines[0],
            "time,ACCE_2,ACCE.x,ACCE.y,ACCE.z,ACCE_6,GYRO_2,GYRO.x,GYRO.y,GYRO.z,GYRO_6"
        );
        assert_eq!(lines[2], "0.10,5.101,9.5,2,3,1,5.101,0.1,2,3,1");
    }

    #[test]
    fn rows_between_sentences_are_a_table() {
        let text =
            "$GPRMC,1,A*00\nIMU,1,1,2,3,0,0,9.8\nIMU,2.5,1,2,4,0,0,9.8\nIMU,3,1,2,3,0,0,9.8\n";
        let source = Cursor::new(text.as_bytes().to_vec());
        let mut read = String::new();
        let mut table = between_sentences(Box::new(source), b"");
        table.read_to_string(&mut read).unwrap();
        assert_eq!(
            read,
            "time,gx,gy,gz,ax,ay,az\n1,1,2,3,0,0,9.8\n2.5,1,2,4,0,0,9.8\n3,1,2,3,0,0,9.8\n"
        );
    }

    #[test]
    fn names_are_in_lines_of_their_own() {
        let rows = "ACCE;0.1;1;2;3\nGYRO;0.1;4;5;6\nACCE;0.2;1;2;3\nGYRO;0.25;4;5;6\nACCE;0.3;1;2;3\nGYRO;0.3;4;5;6\n";
        let head = "% by an app\n% Accelerometer: 'ACCE;Time(s);Acc_X;Acc_Y;Acc_Z'\n% Gyroscope: 'GYRO;Time(s);Gyr_X;Gyr_Y;Gyr_Z'\n";
        let lines = read(&format!("{head}{rows}")).unwrap();
        assert_eq!(
            lines[..3],
            [
                "Time(s),Acc_X,Acc_Y,Acc_Z,Gyr_X,Gyr_Y,Gyr_Z",
                "0.1,1,2,3,4,5,6",
                "0.2,1,2,3,,,",
            ]
        );
        // Names for all are those of no sensor.
        let long = "time,sensor,x,y,z\n1,gyroscope,4,5,6\n1,accelerometer,1,2,3\n2,gyroscope,4,5,6\n2.5,accelerometer,1,2,3\n4,gyroscope,4,5,6\n4.5,accelerometer,1,2,3\n";
        assert_eq!(
            read(long).unwrap()[0],
            "time,gyroscope.x,gyroscope.y,gyroscope.z,accelerometer.x,accelerometer.y,accelerometer.z"
        );
    }

    #[test]
    fn another_clock_has_a_column_of_its_own() {
        let text = "$IMU,1000,1,2,3,4,5,6*0A\n$IMU,1500,1,2,3,4,5,6*0A\n$GPS,200001,48.5,11.5,520*1B\n$IMU,2500,1,2,3,4,5,6*0A\n$GPS,200002,48.5,11.5,520*1B\n$IMU,3500,1,2,3,4,5,6*0A\n$IMU,4000,1,2,3,4,5,6*0A\n";
        let lines = read(text).unwrap();
        assert!(
            lines[0].starts_with("IMU.time,") && lines[0].ends_with(",GPS.time,lat,lon,alt"),
            "{}",
            lines[0]
        );
        assert_eq!(lines[3], ",,,,,,,200001,48.5,11.5,520");
    }

    #[test]
    fn other_texts_stay_as_they_are() {
        for text in [
            "",
            "t,a,b\n1,2,3\n4,5,6\n",
            // One sensor.
            "IMU,1,2,3\nIMU,2,2,3\nIMU,3,2,3\n",
            // States of a receiver.
            "t,FIX,48.1,11.5\n1,FIX,48.1,11.5\n2,FLOAT,48.1,11.5\n3,FIX,48.1,11.5\n",
        ] {
            assert_eq!(read(text), None, "{text}");
        }
    }
}
