//! The published schema of `IMU.toml` is what its reader takes.

use super::{AXES, FORMAT, ImuModel, VERSION};
use crate::presets;
use page::{Asked, Tables, publish, rows};
use serde_json::json;
use std::{collections::BTreeSet, path::Path};
use undrift_config::{Section, parse};

#[path = "../../../../tools/schema/page.rs"]
mod page;

const ARMA: &str = "arma = { rate = \"200 Hz\", ar = [0.9], ma = [0.5], sigma = ";

#[test]
fn the_schema_of_a_model_file_is_what_its_reader_takes() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let asked = Asked::default();
    let note = |table: &str, key: &str, takes| asked.note(table, key, takes);
    let head = format!("format = \"{FORMAT}\"\nversion = {VERSION}\n[provenance]\n");
    let axis = |name: &str| {
        let sigma = if name.starts_with("gyro") {
            "1 deg/s"
        } else {
            "1 mg"
        };
        let line = format!("line = [{{ frequency = \"7 Hz\", amplitude = \"{sigma}\" }}]");
        let temperature = format!(
            "temperature = {{ reference = \"25 degC\", lowest = \"9 degC\", highest = \"300 K\", slope = \"{sigma}/K\" }}"
        );
        format!("[{name}]\n{ARMA}\"{sigma}\" }}\n{line}\n{temperature}\nidentification = {{}}\n")
    };
    for names in [&["gyro", "accel"][..], &AXES] {
        let axes: String = names.iter().map(|name| axis(name)).collect();
        let text = head.clone() + &axes;
        let table = parse(&text, "imu.toml", "").unwrap();
        let top = Section::top(table.get_ref(), &text, "imu.toml").watched(&note);
        ImuModel::from_section(&top).unwrap();
    }
    let asked = asked.all();
    let page = std::fs::read_to_string(root.join("docs/imu-file.md")).unwrap();
    let mut rows = rows(&page);
    rows.retain(|(table, _), _| {
        [
            "",
            "provenance",
            "Keys of an axis",
            "arma",
            "line",
            "temperature",
        ]
        .contains(&table.as_str())
    });
    let described = |table: &str| match table.split_once('.') {
        Some((_, inside)) => inside.to_owned(),
        None if table.is_empty() || table == "provenance" => table.to_owned(),
        None => "Keys of an axis".to_owned(),
    };
    let documented: BTreeSet<_> = rows.keys().cloned().collect();
    let read = asked
        .keys()
        .filter(|(table, key)| !(table.is_empty() && AXES.contains(&key.as_str())));
    let mut read: BTreeSet<_> = read
        .map(|(table, key)| (described(table), key.clone()))
        .collect();
    // Of the reader alone: it looks at the number itself.
    read.insert((String::new(), "version".into()));
    let differ: Vec<_> = documented.symmetric_difference(&read).collect();
    assert!(
        differ.is_empty(),
        "documented or read, not both: {differ:?}"
    );

    let tables = Tables {
        asked: &asked,
        rows: &rows,
        page: &described,
        inside: &|table, key| match table {
            "" => key.to_owned(),
            _ => format!("{table}.{key}"),
        },
    };
    let mut model = tables.table("");
    let properties = &mut model["properties"];
    properties["format"] = json!({"const": FORMAT, "description": "marks the file as a model"});
    properties["version"] = json!({"const": VERSION, "description": "of the format"});
    properties["preset"]["enum"] = json!(presets::NAMES);
    for name in AXES {
        let group = super::group(name);
        properties[name]["description"] =
            json!(format!("adds to [{group}] or overrides it, key by key"));
    }
    publish(
        &root.join("docs/schema/imu.schema.json"),
        &json!({
            "$schema": "https://json-schema.org/draft/2020-12/schema",
            "title": "IMU.toml of undrift",
            "description": "What is known of an IMU's random errors, axis by axis.",
            "$ref": "#/$defs/model",
            "required": ["format", "version"],
            "$defs": { "model": model },
        }),
    );
}
