//! Text of a configuration file, and its tables.

use super::error::ConfigError;
use std::{
    io::{ErrorKind, Read},
    path::Path,
};
use toml::{Spanned, de::DeTable};
use undrift_io::foreign::{self, Foreign};

/// Line of the byte `offset` in `text`, from 1.
pub fn line_at(text: &str, offset: usize) -> usize {
    text.as_bytes()
        .iter()
        .take(offset)
        .filter(|&&b| b == b'\n')
        .count()
        + 1
}

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
        Err((ErrorKind::IsADirectory, _)) => return Err(format!("is a folder; {EXPECTED}")),
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
        Some(Foreign { what, .. }) if what != "a drive file" => {
            return Err(format!("is {what}; {EXPECTED}"));
        }
        _ if bytes.len() as u64 > MOST => {
            return Err(format!("is larger than {} MB; {EXPECTED}", MOST >> 20));
        }
        _ => {}
    }
    let text = String::from_utf8(bytes).map_err(|_| format!("is not UTF-8 text; {EXPECTED}"))?;
    if is_table(&text) {
        return Err(format!(
            "is a log, not a drive file; `undrift inspect {} -o drive.toml` writes one",
            path.display()
        ));
    }
    Ok(text)
}

/// Whether a text begins as a table of numbers does.
fn is_table(text: &str) -> bool {
    let is_number = |field: &str| field.trim().parse::<f64>().is_ok();
    let is_row = |line: &str| {
        let mut fields = line.split([',', ';', '\t']);
        let (first, second) = (fields.next(), fields.next());
        first.is_some_and(is_number) && second.is_some_and(is_number)
    };
    let mut lines = text.lines().filter(|line| !line.starts_with(['#', '%']));
    let first = lines.next().unwrap_or_default();
    !first.contains(['=', '[']) && (is_row(first) || lines.next().is_some_and(is_row))
}

/// Hint for a file that is not a configuration file.
const EXPECTED: &str =
    "expected TOML, such as the drive file that `undrift inspect LOG -o drive.toml` writes";

/// What the parser of TOML refuses, with the remedy of common mistakes.
fn not_toml(text: &str, error: &toml::de::Error) -> String {
    let start = error.span().map_or(0, |span| span.start);
    let line = text
        .lines()
        .nth(line_at(text, start) - 1)
        .unwrap_or_default();
    let value = line.split_once('=').map_or("", |(_, value)| value.trim());
    match error.message() {
        _ if !line.contains(['=', '[']) => format!("not TOML; {EXPECTED}"),
        _ if value.contains('\\') => {
            "a backslash starts an escape sequence; write paths with / or between single quotes"
                .into()
        }
        _ if value.starts_with(char::is_alphabetic) => {
            let text = value.split(" #").next().unwrap_or(value).trim();
            format!("text needs quotes: write \"{text}\"")
        }
        "duplicate key" => already(text, start),
        message => format!("not TOML: {message}"),
    }
}

/// Reports that the table or key at an offset is a duplicate.
fn already(text: &str, start: usize) -> String {
    let here = line_at(text, start);
    let lines = || text.lines().map(str::trim).zip(1..).take(here - 1);
    let line = text.lines().nth(here - 1).unwrap_or_default().trim();
    let name_of = |line: &str| {
        line.split(['=', '#'])
            .next()
            .unwrap_or_default()
            .trim()
            .to_owned()
    };
    let what = name_of(line);
    // A key is of the table above it.
    let table = lines().filter(|(line, _)| line.starts_with('[')).last();
    let from = match (what.starts_with('['), table) {
        (false, Some((_, at))) => at,
        _ => 0,
    };
    let before = lines().skip(from).find(|(line, _)| name_of(line) == what);
    match before {
        Some((_, at)) => format!("{what} is already defined at line {at}; merge the two"),
        None => format!("{what} is defined twice; merge the two"),
    }
}

/// Parses the tables of a configuration file's text; `file` is its name in messages. [`Section::top`](super::Section::top) reads them.
///
/// # Errors
/// Text that is not TOML, with its line.
pub fn parse<'a>(text: &'a str, file: &str) -> Result<Spanned<DeTable<'a>>, ConfigError> {
    DeTable::parse(text).map_err(|e| ConfigError {
        file: file.to_owned(),
        line: e.span().map(|s| line_at(text, s.start)),
        key: String::new(),
        message: not_toml(text, &e),
    })
}
