use crate::visible;
use std::io;
use std::path::{Path, PathBuf};

/// Why a file cannot be read: where, what is wrong, and what would mend it.
///
/// Displayed as `imu.csv.gz line 1: no column "gx" (key imu.gyro); the file has: t_s, gx_radps`.
#[derive(Debug, thiserror::Error)]
#[error("{}{}: {problem}{}{}", visible(&.path.to_string_lossy()), on_line(.line), of_key(.key), with_mend(.mend))]
pub struct ReadError {
    /// The file, as it was given.
    pub path: PathBuf,
    /// Line in the file, the first is 1.
    pub line: Option<u64>,
    /// The configuration key that asked for what is missing.
    pub key: Option<Key>,
    /// What was expected and found.
    pub problem: String,
    /// What to do about it, or what the file offers instead; may be empty.
    pub mend: String,
    /// The error of the operating system or the decompressor below, if there was one.
    pub source: Option<io::Error>,
}

impl ReadError {
    /// A problem of the file as a whole; the other fields are filled in by the builders.
    pub fn new(path: &Path, problem: impl Into<String>) -> Self {
        Self {
            path: path.to_path_buf(),
            line: None,
            key: None,
            problem: problem.into(),
            mend: String::new(),
            source: None,
        }
    }

    /// A problem of a log whose name the caller knows and gives by [`ReadError::of`].
    pub(crate) fn nameless(problem: impl Into<String>) -> Self {
        Self::new(Path::new(""), problem)
    }

    /// Of the log with this name, where it has none yet.
    pub fn in_log(mut self, name: &Path) -> Self {
        if self.path.as_os_str().is_empty() {
            self.path = name.to_path_buf();
        }
        self
    }

    /// At a line of the file, the first is 1.
    pub fn at(mut self, line: u64) -> Self {
        self.line = Some(line);
        self
    }

    /// Asked for by a key.
    pub fn key(mut self, key: impl Into<Key>) -> Self {
        self.key = Some(key.into());
        self
    }

    /// With what would mend it.
    pub fn mend(mut self, mend: impl Into<String>) -> Self {
        self.mend = mend.into();
        self
    }

    pub(crate) fn caused_by(mut self, source: io::Error) -> Self {
        self.source = Some(source);
        self
    }
}

/// What asked for something that is missing or wrong.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Key {
    /// The stream of a table of the drive file, by the table.
    #[error("{0}.topic")]
    Topic(&'static str),
    /// The stream of the velocities.
    #[error("gnss.velocity_topic")]
    VelocityTopic,
    /// The standard deviations of the positions.
    #[error("gnss.position_std")]
    PositionStd,
    /// The standard deviations of the velocities.
    #[error("gnss.velocity_std")]
    VelocityStd,
    /// Any other, as messages show it.
    #[error("{0}")]
    Other(String),
}

impl From<&str> for Key {
    fn from(key: &str) -> Self {
        Self::Other(key.to_owned())
    }
}

/// Names that a message lists at most.
pub(crate) const NAMES_SHOWN: usize = 60;

/// What a file offers instead of what is missing: at most so many names.
pub(crate) fn the_file_has(names: &[impl AsRef<str>], most: usize) -> String {
    let shown = names.iter().take(most).map(|name| name.as_ref());
    let shown: Vec<&str> = shown.collect();
    let more = match names.len().saturating_sub(most) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    format!("the file has: {}{more}", shown.join(", "))
}

fn on_line(line: &Option<u64>) -> String {
    line.map_or(String::new(), |n| format!(" line {n}"))
}

fn of_key(key: &Option<Key>) -> String {
    key.as_ref()
        .map_or(String::new(), |k| format!(" (key {k})"))
}

fn with_mend(mend: &str) -> String {
    if mend.is_empty() {
        String::new()
    } else {
        format!("; {mend}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn display_names_file_line_key_and_mend() {
        let error = ReadError::new(Path::new("imu.csv.gz"), "no column \"gx\"")
            .at(1)
            .key("imu.gyro")
            .mend("the file has: t_s, gx_radps");
        assert_eq!(
            error.to_string(),
            "imu.csv.gz line 1: no column \"gx\" (key imu.gyro); the file has: t_s, gx_radps"
        );
        assert_eq!(
            ReadError::new(Path::new("a"), "empty").to_string(),
            "a: empty"
        );
    }
}
