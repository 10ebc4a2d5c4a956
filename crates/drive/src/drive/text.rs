//! Text of a configuration file, and its tables.

use super::error::ConfigError;
use std::{
    io::{ErrorKind, Read},
    path::Path,
};
use toml::{Spanned, de::DeTable};
use undrift_config::is_log;
use undrift_io::foreign::{self, Foreign};

/// Reads a configuration file: its text, and its name in messages.
///
/// # Errors
/// A file that cannot be read, is too large or no text.
pub fn read_text(path: &Path) -> Result<(String, String), ConfigError> {
    let file = path.display().to_string();
    text_of(path)
        .map(|text| (text, file.clone()))
        .map_err(|message| ConfigError {
            file,
            line: None,
            key: String::new(),
            message,
        })
}

/// Size of a configuration file at most \[bytes\]: a manifest of 100 000 logs has some 10 MB.
const MOST: u64 = 16 << 20;

fn text_of(path: &Path) -> Result<String, String> {
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path);
    let read = file.and_then(|file| file.take(MOST + 1).read_to_end(&mut bytes));
    match read.map_err(|error| (error.kind(), error)) {
        Err((ErrorKind::NotFound, _)) => {
            let names = undrift_io::nearby::names(path).map(|names| format!("; {names}"));
            return Err(format!("no such file{}", names.unwrap_or_default()));
        }
        Err((ErrorKind::IsADirectory, _)) => {
            return Err(format!(
                "is a folder without a log that is known; {EXPECTED}, or logs"
            ));
        }
        Err((_, error)) => return Err(format!("cannot be read: {error}")),
        Ok(_) => {}
    }
    match foreign::known(&bytes) {
        Some(Foreign {
            what: "a model file",
            ..
        }) => {
            return Err(format!(
                "is a model file, not a drive file; give the drive file here, and the model with --model {}",
                path.display()
            ));
        }
        Some(Foreign { what, mend }) if what != "a drive file" => {
            return Err(format!("is {what}, not a drive file or a log; {mend}"));
        }
        _ if bytes.len() as u64 > MOST => {
            return Err(format!("is larger than {} MB; {EXPECTED}", MOST >> 20));
        }
        _ => {}
    }
    let text = String::from_utf8(bytes).map_err(|_| format!("is not UTF-8 text; {EXPECTED}"))?;
    if is_log(&text) {
        return Err(format!(
            "is a log, not a drive file; `undrift inspect {} -o drive.toml` writes one",
            path.display()
        ));
    }
    Ok(text)
}

/// Hint for a file that is not a configuration file.
const EXPECTED: &str =
    "expected TOML, such as the drive file that `undrift inspect LOG -o drive.toml` writes";

/// Parses the tables of a configuration file's text; `file` is its name in messages. [`Section::top`](undrift_config::Section::top) reads them.
///
/// # Errors
/// Text that is not TOML, with its line.
pub fn parse<'a>(text: &'a str, file: &str) -> Result<Spanned<DeTable<'a>>, ConfigError> {
    undrift_config::parse(text, file, EXPECTED)
}
