//! What an inspection finds: the parts of a file, and the keys of a drive file that read them.

use super::known::{Content, Known, Note, PoseFault};
use serde::{Serialize, Serializer};
use std::{
    fmt,
    path::{Path, PathBuf},
};
use toml::Value;
use undrift_io::Memory;

/// What a file is.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "Inspection"))]
pub struct Inspection<P = Part> {
    /// The file, as it was given.
    #[serde(serialize_with = "shown")]
    pub file: PathBuf,
    /// Name of its format in a drive file.
    pub format: &'static str,
    /// What the format is called.
    pub description: &'static str,
    /// The streams of a log: name, messages, and what they are.
    pub streams: Vec<(String, u64, String)>,
    /// What of it can be read.
    pub parts: Vec<P>,
    /// What is worth knowing.
    pub found: Vec<Note>,
    /// What a pipe had, which cannot be read again.
    #[serde(skip)]
    pub held: Option<Memory>,
}

/// A table of `DRIVE.toml` that reads something of the file.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "InspectedPart"))]
pub struct Part<L = Line, M = Measured> {
    /// `imu`, `gnss` or `truth`.
    pub table: &'static str,
    /// Its keys beside `file`.
    pub lines: Vec<L>,
    /// What was read with them.
    pub measured: Option<M>,
    /// Why nothing was.
    pub problem: Option<String>,
    /// The streams that a key may name, the first of each the likeliest.
    #[serde(skip)]
    pub choices: Vec<(&'static str, Vec<String>)>,
}

/// A key of a drive file.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "InspectedLine"))]
pub struct Line {
    /// The key.
    pub key: &'static str,
    /// Its value, as TOML writes it.
    #[serde(serialize_with = "written")]
    #[cfg_attr(feature = "schema", schemars(with = "String"))]
    pub value: Value,
    /// How it is known.
    pub known: Known,
}

/// What a part holds.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Measured {
    /// Samples, fixes or reference solutions.
    pub records: u64,
    /// When it starts, where the file has a date.
    pub start: Option<Start>,
    /// First time \[s\].
    pub first_s: f64,
    /// Last time \[s\].
    pub last_s: f64,
    /// 1 / the ordinary interval \[Hz\].
    pub rate_hz: f64,
    /// Intervals of more than 1.5 ordinary ones.
    pub gaps: u64,
    /// Start and length of the longest \[s\].
    pub longest_gap_s: Option<(f64, f64)>,
    /// What was left out, a line each.
    pub skipped: String,
    /// Velocities left out because the log does not tell how certain they are.
    pub untold_velocities: u64,
    /// Mean magnitude of the specific force \[m/s²\].
    #[serde(skip)]
    pub size_of_force: Option<f64>,
    /// Preset of the sensor whose values have such steps.
    pub steps_of: Option<&'static str>,
    /// The counter in the column of times, where it started again and was counted on.
    pub counter: Option<CounterRestarts>,
    /// What else it holds.
    pub content: Option<Content>,
}

/// A counter of limited bits in a column of times that started again.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "InspectedCounter"))]
pub struct CounterRestarts {
    /// Line of the first time.
    pub line: u64,
    /// How often.
    pub count: u64,
    /// Added each time, in the column's unit.
    pub length: f64,
}

/// When something starts.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "InspectedStart"))]
pub struct Start {
    /// UTC, `yyyy-mm-ddThh:mm:ss.sssZ`.
    pub utc: String,
    /// GPS time less UTC then \[s\].
    pub leap_seconds: f64,
    /// Source of the date, as in results.
    pub clock: &'static str,
}

/// The noise model of a drive file.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// The preset.
    pub preset: &'static str,
    /// How it is known.
    pub known: Known,
}

/// As TOML writes it; a guess has a name that says so.
impl fmt::Display for Model {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let preset = self.preset;
        match self.known {
            Known::NoSensor => write!(
                f,
                "{{ preset = \"{preset}\", name = \"{preset} (a guess)\" }}"
            ),
            _ => write!(f, "\"{preset}\""),
        }
    }
}

/// What a drive file that is written has a comment on.
#[derive(Clone, Copy, Debug)]
pub enum Comment<'a> {
    /// How the value of a key is known.
    Known(&'a Known),
    /// The file.
    Top,
    /// The noise model.
    Model,
    /// A table for which there is no file.
    Missing(&'a str),
    /// The heading, where changes of velocity give it.
    Heading,
    /// The part of the logs in which a marker does not move against the IMU.
    Piece,
    /// The profile of a wheeled vehicle, and what the motion says of it.
    Wheels(Wheels),
    /// The profile of what flies.
    Flight(Flight),
    /// The lever arm.
    LeverArm,
    /// The direction of the second antenna, where nothing shows it.
    Baseline,
}

/// What the motion says of wheels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wheels {
    /// It is not that of a wheeled vehicle, or shows nothing.
    #[default]
    No,
    /// The craft has a forward direction; the motion is too short, too straight or too slow to test more.
    Likely,
    /// It is that of a wheeled vehicle.
    Shown,
}

/// What flies, as the motion shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flight {
    /// A copter: withheld fixes are likelier with the drag of its rotors.
    Copter,
    /// An aircraft: they are likelier with the velocity through the air that it keeps.
    Aircraft,
}

/// What the motion shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Motion {
    /// Whether it is that of a wheeled vehicle.
    pub wheels: Wheels,
    /// What it flies as.
    pub flight: Option<Flight>,
    /// The changes of the receiver's velocity give the heading.
    pub heading: bool,
}

impl Line {
    /// A key and its value.
    pub fn new(key: &'static str, value: impl Into<Value>, known: Known) -> Self {
        let value = value.into();
        Self { key, value, known }
    }
}

/// A path as text, whatever its bytes.
fn shown<S: Serializer>(path: &Path, to: S) -> Result<S::Ok, S::Error> {
    to.collect_str(&path.display())
}

/// A value as TOML writes it.
fn written<S: Serializer>(value: &Value, to: S) -> Result<S::Ok, S::Error> {
    to.collect_str(value)
}

impl Part {
    /// A table with these keys of which nothing was read.
    pub fn new(table: &'static str, lines: Vec<Line>) -> Self {
        Self {
            table,
            lines,
            measured: None,
            problem: None,
            choices: Vec::new(),
        }
    }
}

/// What the notes say is wrong with poses.
pub fn pose_notes(inspections: &[Inspection]) -> impl Iterator<Item = &PoseFault> {
    let notes = inspections.iter().flat_map(|file| &file.found);
    notes.filter_map(|note| match note {
        Note::Poses(fault) => Some(fault),
        _ => None,
    })
}

/// The part of the logs in which marker and IMU move as one \[s\], where that is not all of them.
pub fn pose_piece(inspections: &[Inspection]) -> Option<[f64; 2]> {
    pose_notes(inspections).find_map(|fault| match fault {
        PoseFault::Piece { start, end } => Some([*start, *end]),
        _ => None,
    })
}
