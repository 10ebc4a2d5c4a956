//! Results as JSON under one head: `{"undrift": version, "kind": "navigate", …}`.

use crate::{
    drive::Drive,
    replay::{GnssUse, Outage},
};
use serde_json::{Map, Value, json};
use std::path::Path;

/// What made a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A static record into noise models.
    Identify,
    /// A drive into a solution.
    Navigate,
    /// A drive with its GNSS cut.
    Outages,
    /// Many simulated drives.
    MonteCarlo,
    /// The simulated experiment: identification and outages.
    Demo,
    /// Many logs.
    Fleet,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Identify,
        Self::Navigate,
        Self::Outages,
        Self::MonteCarlo,
        Self::Demo,
        Self::Fleet,
    ];

    /// The verb's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Identify => "identify",
            Self::Navigate => "navigate",
            Self::Outages => "outages",
            Self::MonteCarlo => "montecarlo",
            Self::Demo => "demo",
            Self::Fleet => "fleet",
        }
    }
}

/// A result with its head.
pub fn with_head(kind: Kind, body: Value) -> Value {
    let mut result = match body {
        Value::Object(map) => map,
        other => Map::from_iter([("result".to_owned(), other)]),
    };
    result.insert("undrift".into(), env!("CARGO_PKG_VERSION").into());
    result.insert("kind".into(), kind.name().into());
    result.into()
}

/// What a drive consists of; `file` is the drive file. Files go by their names without folders.
pub fn drive(file: &Path, drive: &Drive) -> Value {
    let truth = drive.truth.as_ref().map(|(path, _)| name(path));
    json!({
        "file": name(file),
        "imu": name(&drive.imu.0),
        "gnss": name(&drive.gnss.0),
        "truth": truth,
        "odometer": drive.odometer.as_ref().map(|(path, _)| name(path)),
        "barometer": drive.barometer.as_ref().map(|(path, _)| name(path)),
        "rate_hz": drive.sample_interval().ok().map(|interval| crate::series::to_digits(1.0 / interval)),
        "model": drive.model.as_ref().map(|model| model.name.as_str()),
        "lever_arm_m": [drive.lever_arm.x, drive.lever_arm.y, drive.lever_arm.z],
        "gnss_use": match drive.gnss_use {
            GnssUse::Both => "position and velocity",
            GnssUse::Position => "position",
            GnssUse::Velocity => "velocity",
        },
        "gating": drive.gating,
        "adapt": drive.adapt,
    })
}

/// Spans without GNSS.
pub fn outages(outages: &[Outage]) -> Value {
    outages
        .iter()
        .map(|o| json!({"start_s": o.start, "length_s": o.end - o.start}))
        .collect()
}

/// A file's name without its folders.
pub fn name(path: &Path) -> String {
    path.file_name()
        .map_or(String::new(), |name| name.to_string_lossy().into_owned())
}

/// A result as text: objects over several lines, lists of numbers and words on one.
pub fn text(result: &Value) -> String {
    let mut text = String::new();
    write(result, 0, &mut text);
    text
}

fn write(value: &Value, depth: usize, text: &mut String) {
    let line = |text: &mut String, depth: usize| {
        text.push('\n');
        (0..depth).for_each(|_| text.push_str("  "));
    };
    let nested = |value: &Value| value.is_object() || value.is_array();
    match value {
        Value::Object(map) if !map.is_empty() => {
            text.push('{');
            for (k, (key, value)) in map.iter().enumerate() {
                if k > 0 {
                    text.push(',');
                }
                line(text, depth + 1);
                text.push_str(&Value::from(key.as_str()).to_string());
                text.push_str(": ");
                write(value, depth + 1, text);
            }
            line(text, depth);
            text.push('}');
        }
        Value::Array(list) if list.iter().any(nested) => {
            text.push('[');
            for (k, value) in list.iter().enumerate() {
                if k > 0 {
                    text.push(',');
                }
                line(text, depth + 1);
                write(value, depth + 1, text);
            }
            line(text, depth);
            text.push(']');
        }
        flat => text.push_str(&flat.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_read_back_as_it_was() {
        let value = json!({
            "a": [1.5, null, 1e-300, "two\n\"words\""], "b": {}, "c": [{"d": []}, [0.1, -2]],
            "e\"f": {"g": true},
        });
        let text = text(&value);
        assert_eq!(serde_json::from_str::<Value>(&text).unwrap(), value);
        assert!(text.contains("\n  \"a\": [1.5,null,"), "{text}");
    }
}
