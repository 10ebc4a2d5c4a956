//! The text of TOML files: its lines, and the remedy of what the parser refuses.

use crate::ConfigError;
use toml::{Spanned, de::DeTable};

/// Parses the tables of a file's `text`; `file` is its name in messages, and `expected` what they say of a text that is no TOML at all.
/// [`Section::top`](crate::Section::top) reads them.
///
/// # Errors
/// Text that is not TOML, with its line and the remedy where the mistake is a common one.
///
/// ```
/// let error = undrift_config::parse("file = C:\\logs\\imu.csv", "car.toml", "expected a drive file").unwrap_err();
/// assert!(error.to_string().starts_with("car.toml line 1: ") && error.message.contains("write paths with /"));
/// ```
pub fn parse<'a>(
    text: &'a str,
    file: &str,
    expected: &str,
) -> Result<Spanned<DeTable<'a>>, ConfigError> {
    DeTable::parse(text).map_err(|error| {
        let start = error.span().map_or(0, |span| span.start);
        ConfigError {
            file: file.to_owned(),
            line: Some(line_at(text, start)),
            key: String::new(),
            message: syntax_error(text, start, error.message(), expected),
        }
    })
}

/// Line of the byte `offset` in `text`, from 1.
pub(super) fn line_at(text: &str, offset: usize) -> usize {
    let before = text.as_bytes().iter().take(offset);
    before.filter(|byte| **byte == b'\n').count() + 1
}

/// Whether `text` begins as a table of numbers does: a log that was given in place of a TOML file.
///
/// ```
/// use undrift_config::is_log;
/// assert!(is_log("time,gx,gy\n0.00,0.1,-0.2\n"));
/// assert!(!is_log("name = \"my IMU\"\n[gyro]\n"));
/// ```
pub fn is_log(text: &str) -> bool {
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

/// What is wrong where the parser stopped, at the byte `start` of `text` with `message`: with the remedy where the mistake is a
/// common one, and `expected` where the line is no TOML at all.
fn syntax_error(text: &str, start: usize, message: &str, expected: &str) -> String {
    let line = text.lines().nth(line_at(text, start) - 1);
    let line = line.unwrap_or_default();
    let value = line.split_once('=').map_or("", |(_, value)| value);
    let value = value.split(" #").next().unwrap_or(value).trim();
    let is_number = value.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '-' | '+' | '.'));
    // Not an exponent, the mark of another base, or a date.
    let is_of_unit = |c: char| c.is_alphabetic() && !"eExobTZ".contains(c);
    match message {
        _ if !line.contains(['=', '[']) => format!("not TOML; {expected}"),
        "duplicate key" => already(text, start),
        _ if value.contains('\\') => {
            "a backslash starts an escape sequence; write paths with / or between single quotes"
                .into()
        }
        _ if value.starts_with(char::is_alphabetic) => {
            format!("text needs quotes: write \"{value}\"")
        }
        _ if is_number && value.contains(is_of_unit) && !value.contains('"') => {
            format!("a number with its unit needs quotes: write \"{value}\"")
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn common_mistakes_have_their_remedy() {
        let duplicate = "[gyro]\nturn_on = 1\n[accel]\nturn_on = 2\nturn_on = 3\n";
        for (text, at, message, expected) in [
            ("hello", 0, "", "not TOML; expected a model"),
            (
                "a = imu.csv # the log",
                4,
                "",
                "text needs quotes: write \"imu.csv\"",
            ),
            (
                "rate = 100 Hz # nominal",
                11,
                "",
                "a number with its unit needs quotes: write \"100 Hz\"",
            ),
            ("a = 1.2e3.4", 9, "bad number", "not TOML: bad number"),
            (
                "gate = true\ngate = true",
                12,
                "duplicate key",
                "gate is already defined at line 1; merge the two",
            ),
            // The key of the same name in another table is not meant.
            (
                duplicate,
                duplicate.rfind("turn_on").unwrap_or_default(),
                "duplicate key",
                "turn_on is already defined at line 4; merge the two",
            ),
        ] {
            assert_eq!(
                syntax_error(text, at, message, "expected a model"),
                expected
            );
        }
    }

    #[test]
    fn a_log_begins_with_numbers_below_a_header_or_without() {
        for text in ["# by us\n1;2\n", "1.5\t2\t3", "t, x\n0, 1\n"] {
            assert!(is_log(text), "{text}");
        }
        for text in ["a = 1, 2", "[a]\n1,2", "t, x\nu, v", "1"] {
            assert!(!is_log(text), "{text}");
        }
    }
}
