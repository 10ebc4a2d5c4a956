//! The published schema of `DRIVE.toml` is what its reader takes.

use super::{Drive, Logs};
use page::{Asked, Tables, publish, rows};
use serde_json::json;
use std::{collections::BTreeSet, path::Path};
use undrift_config::{Section, parse};

#[path = "../../../../tools/schema/page.rs"]
mod page;

/// Files that lead the reader past every key.
const FILES: [&str; 6] = [
    r#"
model = "adis16405"
[imu]
file = "imu.csv"
time = 1
gyro = [2, 3, 4]
gyro_unit = "deg/s"
accel = [5, 6, 7]
accel_unit = "g"
[gnss]
file = "gnss.csv"
time = 1
position = [2, 3, 4]
position_std = "1 m"
quality_std_factors = { float = 10 }
[odometer]
file = "wheel.csv"
time = 1
speed = 2
speed_unit = "m/s"
[barometer]
file = "baro.csv"
time = 1
height = 2
[heading]
file = "heading.csv"
time = 1
heading = 2
[magnetometer]
file = "mag.csv"
time = 1
field = [2, 3, 4]
field_unit = "uT"
[truth]
file = "truth.csv"
time = 1
position = [2, 3, 4]
[initial]
[span]
[vehicle]
[states]
"#,
    "[imu]\nfile = \"imu.csv\"\ntime = 1\ngyro = [2, 3, 4]\naccel = [5, 6, 7]\ndata = \"increments\"\n\
     gyro_unit = \"rad\"\naccel_unit = \"m/s\"\n[gnss]\nfile = \"fixes.pos\"\nformat = \"rtklib\"\n",
    "[imu]\nfile = \"log.ubx\"\nformat = \"ubx\"\n[gnss]\nfile = \"log.ubx\"\nformat = \"ubx\"\n\
     [heading]\nfile = \"log.ubx\"\nformat = \"ubx\"\n\
     [magnetometer]\nfile = \"log.bin\"\nformat = \"dataflash\"\n[truth]\nfile = \"log.ubx\"\nformat = \"ubx\"\n",
    "[imu]\nfile = \"imu.csv\"\ntime = 1\ngyro = [2, 3, 4]\naccel = [5, 6, 7]\n\
     gyro_unit = \"deg/s\"\naccel_unit = \"g\"\n[gnss]\nfile = \"g.csv\"\ntime = 1\nbaseline = [2, 3, 4]\n\
     base = \"40 deg, -105 deg, 1600 m\"\nposition_std = \"1 m\"\n",
    "[imu]\nfile = \"imu.csv\"\ntime = 1\ngyro = [2, 3, 4]\naccel = [5, 6, 7]\n\
     gyro_unit = \"deg/s\"\naccel_unit = \"g\"\n[gnss]\nfile = \"g.csv\"\ntime = 1\nposition = [2, 3, 4]\n\
     position_std = \"1 m\"\nvelocity = [5, 6, 7]\nvelocity_std = \"0.1 m/s\"\n",
    "[imu]\nfile = \"imu.csv\"\ntime = 1\ngyro = [2, 3, 4]\naccel = [5, 6, 7]\n\
     gyro_unit = \"deg/s\"\naccel_unit = \"g\"\n[poses]\nfile = \"p.csv\"\ntime = 1\nposition = [2, 3, 4]\n\
     position_std = \"1 mm\"\neuler = [5, 6, 7]\nattitude_std = \"1 deg\"\n[local]\n[states]\n",
];

/// The tables at the top, in the order of the page.
const TABLES: [&str; 13] = [
    "imu",
    "gnss",
    "poses",
    "local",
    "odometer",
    "barometer",
    "heading",
    "magnetometer",
    "truth",
    "initial",
    "span",
    "vehicle",
    "states",
];

#[test]
fn the_schema_of_a_drive_file_is_what_its_reader_takes() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let asked = Asked::default();
    // A table of the same name has the same keys wherever it is.
    let note = |path: &str, key: &str, takes| {
        let table = path.rsplit('.').next().unwrap_or_default();
        asked.note(table, key, takes);
    };
    for text in FILES {
        let table = parse(text, "drive.toml", "").unwrap();
        let top = Section::top(table.get_ref(), text, "drive.toml").watched(&note);
        let folder = "none".into();
        let logs = Logs {
            folder,
            ..Logs::default()
        };
        Drive::from_tables(&top, Path::new("none"), logs).unwrap();
    }
    let asked = asked.all();
    let page = std::fs::read_to_string(root.join("docs/drive-file.md")).unwrap();
    let mut rows = rows(&page);
    // The page's first table is of the top.
    let top: Vec<_> = rows
        .keys()
        .filter(|(table, _)| table == "Top level")
        .cloned()
        .collect();
    for (table, key) in top {
        let row = rows.remove(&(table, key.clone())).unwrap();
        rows.insert((String::new(), key), row);
    }
    let documented: BTreeSet<_> = rows.keys().cloned().collect();
    let read: BTreeSet<_> = asked
        .keys()
        .filter(|(table, _)| !table.ends_with("_factors"))
        .cloned()
        .collect();
    let differ: Vec<_> = documented.symmetric_difference(&read).collect();
    assert!(
        differ.is_empty(),
        "documented or read, not both: {differ:?}"
    );

    let tables = Tables {
        asked: &asked,
        rows: &rows,
        page: &str::to_owned,
        inside: &|_, key| key.to_owned(),
    };
    let mut schema = tables.table("");
    assert!(
        TABLES
            .iter()
            .all(|table| schema["properties"][table]["type"] == "object")
    );
    schema["$schema"] = json!("https://json-schema.org/draft/2020-12/schema");
    schema["title"] = json!("DRIVE.toml of undrift");
    schema["description"] = json!(
        "Which files make up a drive, what their columns mean, how the IMU sits and how the solution starts."
    );
    schema["required"] = json!(["imu"]);
    schema["anyOf"] = json!([{ "required": ["gnss"] }, { "required": ["poses"] }]);
    publish(&root.join("docs/schema/drive.schema.json"), &schema);
}

/// `time_offset` of a log is added to its times, in seconds whatever its unit.
#[test]
fn the_offset_of_a_log_is_added_to_its_times() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    file("truth.csv", "10,45,7,300\n11,45,7,300\n");
    file("gnss.csv", "10,45,7,300\n11,45,7,300\n");
    let text = r#"
[imu]
file = "imu.csv"
time = 1
gyro = [2, 3, 4]
gyro_unit = "deg/s"
accel = [5, 6, 7]
accel_unit = "g"
[gnss]
file = "gnss.csv"
time = 1
time_offset = "-500 ms"
position = [2, 3, 4]
position_std = "1 m"
[truth]
file = "truth.csv"
time = 1
time_offset = "2 s"
position = [2, 3, 4]
"#;
    let drive = Drive::from_toml(text, "drive.toml", folder.path(), folder.path()).unwrap();
    let truth = drive.open_truth().unwrap().unwrap();
    let times: Vec<f64> = truth.map(|sample| sample.unwrap().time).collect();
    assert_eq!(times, [12.0, 13.0]);
    let gnss = drive.open_gnss().unwrap();
    let times: Vec<f64> = gnss.map(|fix| fix.unwrap().time).collect();
    assert_eq!(times, [9.5, 10.5]);
}
