//! What a run is made of, so that it can be recorded and done again.

use crate::{Session, SessionError, keys::without, session::Options, state::State};
use serde::{Deserialize, Serialize};
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};
use toml_edit::{DocumentMut, Item};
use undrift_drive::{
    drive::{DriveError, parse},
    navigate::Clock,
};
use undrift_io::{ReadError, recording::Recording};
use undrift_noise::{ImuModel, ModelError};

/// All that a session needs beside the arrivals.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The text of the drive file, with its model in it.
    pub text: String,
    /// What messages call it.
    pub name: String,
    /// Where a model file lies that cannot be taken into the text.
    pub home: PathBuf,
    /// Names of the sources, in the order of their numbers.
    pub sources: Vec<String>,
    /// Tables of the drive file with the numbers of their sources.
    pub logs: Vec<(String, usize)>,
    /// How it navigates.
    pub options: Options,
    /// Where it goes on from.
    pub state: Option<State>,
}

/// The part of a plan that is numbers.
#[derive(Serialize, Deserialize)]
struct Numbers {
    name: String,
    logs: Vec<(String, usize)>,
    horizon: f64,
    bias_model: String,
    clock: String,
    interval: Option<f64>,
}

impl Plan {
    /// The session.
    ///
    /// # Errors
    /// As [`Session::new`].
    pub fn session(&self) -> Result<Session, SessionError> {
        let logs = self.logs.clone();
        let session = Session::new(
            &self.text,
            &self.name,
            &self.home,
            logs,
            self.options.clone(),
        )?;
        Ok(session.resume(self.state.clone()))
    }

    /// The texts of a recording that hold it.
    pub fn texts(&self) -> Vec<(&'static str, String)> {
        let numbers = Numbers {
            name: self.name.clone(),
            logs: self.logs.clone(),
            horizon: self.options.horizon,
            bias_model: self.options.bias_model.name().to_owned(),
            clock: self.options.clock.name().to_owned(),
            interval: self.options.interval,
        };
        let mut texts = vec![
            (DRIVE, self.text.clone()),
            (NUMBERS, serde_json::to_string(&numbers).unwrap_or_default()),
        ];
        texts.extend(self.state.as_ref().map(|state| {
            let digits = state
                .to_bytes()
                .iter()
                .map(|byte| format!("{byte:02x}"))
                .collect();
            (STATE, digits)
        }));
        texts
    }

    /// The plan of a recording; `None` where it holds none.
    pub fn of_recording(recording: &Recording) -> Option<Self> {
        let texts: &BTreeMap<String, String> = &recording.texts;
        let numbers: Numbers = serde_json::from_str(texts.get(NUMBERS)?).ok()?;
        let state = texts.get(STATE).map(|digits| {
            let pairs = digits.as_bytes().chunks_exact(2);
            let bytes = pairs
                .filter_map(|pair| u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok());
            State::from_bytes(&Vec::from_iter(bytes))
        });
        Some(Self {
            text: texts.get(DRIVE)?.clone(),
            name: numbers.name,
            home: PathBuf::new(),
            sources: recording.sources.clone(),
            logs: numbers.logs,
            options: Options {
                horizon: numbers.horizon,
                bias_model: numbers.bias_model.parse().ok()?,
                clock: numbers.clock.parse().unwrap_or(Clock::Unstated),
                interval: numbers.interval,
            },
            state: state.and_then(Result::ok),
        })
    }
}

/// Names of the texts.
const DRIVE: &str = "drive.toml";
const NUMBERS: &str = "run.json";
const STATE: &str = "state";

/// A drive file with its model in it: that of `model` or else the one it names, which lies in `home` if it is a file.
///
/// # Errors
/// If the text is no TOML, or the model cannot be read.
pub fn with_model(
    text: &str,
    name: &str,
    home: &Path,
    model: Option<&ImuModel>,
) -> Result<String, DriveError> {
    let tables = parse(text, name)?;
    let named = tables.get_ref().get("model");
    let named = named.and_then(|named| named.get_ref().as_str());
    let read = match (model, named) {
        (Some(model), _) => Some(model.clone()),
        (None, Some(name)) => match ImuModel::resolve(name, home) {
            Ok(model) => Some(model),
            // Said with its line where the drive file is read.
            Err(ModelError::Read { .. }) => None,
            Err(other) => return Err(other.into()),
        },
        (None, None) => None,
    };
    let Some(read) = read else {
        return Ok(text.to_owned());
    };
    let mut table: DocumentMut = read.to_toml().parse().unwrap_or_default();
    let mut whole = DocumentMut::new();
    whole.insert("model", Item::Table(std::mem::take(table.as_table_mut())));
    let text = without(text, tables.get_ref(), &["model"]);
    let end = if text.ends_with('\n') { "" } else { "\n" };
    Ok(format!("{text}{end}{whole}"))
}

/// A recording and its plan; `None` of any other file.
///
/// # Errors
/// If the file cannot be read.
pub fn recorded(path: &Path) -> Result<Option<(Plan, Recording)>, ReadError> {
    let recording = Recording::open(path)?;
    Ok(recording.and_then(|recording| Some((Plan::of_recording(&recording)?, recording))))
}

/// The paths of the tables of a drive file, or what stands in their place.
pub fn files(text: &str) -> Vec<(&'static str, PathBuf)> {
    let named = undrift_drive::drive::files_named(text).into_iter();
    named
        .filter(|(table, _)| !matches!(*table, "model" | "truth"))
        .map(|(table, name)| (table, name.into()))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::keys;

    #[test]
    fn a_drive_file_takes_its_model_in() {
        let text = "model = \"mpu6050\"\n[imu]\nfile = \"imu.csv\"\n";
        let whole = with_model(text, "drive.toml", Path::new(""), None).unwrap();
        let section: toml_edit::DocumentMut = whole.parse().unwrap();
        assert!(section["model"].is_table_like(), "{whole}");
        assert_eq!(section["imu"]["file"].as_str(), Some("imu.csv"));
        let again = with_model(&whole, "drive.toml", Path::new(""), None).unwrap();
        assert_eq!(again, whole);
        assert_eq!(files(&whole), [("imu", PathBuf::from("imu.csv"))]);
    }

    #[test]
    fn lines_stay_where_they_are() {
        let text = "# Mine.\nmodel = \"mpu6050\" # Or so.\nspan = { start = 1 }\n[imu]\nfile = \"imu.csv\"\n[truth]\nfile = \"t.csv\"\nposition = [\n \"lat\",\n[\"x\"]]\n[gnss]\nfile = \"g.csv\"";
        let whole = with_model(text, "drive.toml", Path::new(""), None).unwrap();
        let without = |text: &str, names: &[&str]| {
            keys::without(text, parse(text, "").unwrap().get_ref(), names)
        };
        let kept = without(&whole, &["truth", "span"]);
        let lines: Vec<&str> = kept.lines().take(12).collect();
        let expected = [
            "# Mine.",
            "",
            "",
            "[imu]",
            "file = \"imu.csv\"",
            "",
            "",
            "",
            "",
            "",
            "[gnss]",
            "file = \"g.csv\"",
        ];
        assert_eq!(lines, expected);
        let document: DocumentMut = kept.parse().unwrap();
        assert!(document["model"].is_table_like() && document.get("truth").is_none());
        // A text over lines that look like tables is taken out as a whole.
        let text = "[imu]\nfile = \"\"\"\n[truth]\n\"\"\"\n[truth]\nfile = \"t\"\n";
        let kept: DocumentMut = without(text, &["truth"]).parse().unwrap();
        assert_eq!(kept["imu"]["file"].as_str(), Some("[truth]\n"));
        assert!(kept.get("truth").is_none());
    }
}
