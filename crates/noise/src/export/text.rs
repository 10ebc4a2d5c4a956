//! The text of a format: comments, what follows, and numbers as YAML, MATLAB and Python take them.

use super::comments::comment;
use super::equivalent::Equivalent;

/// A text under comments.
///
/// `mark` begins a comment line: `#`, `%`, or nothing where comments are strings of JSON.
pub(super) struct Text {
    mark: &'static str,
    pub(super) comments: Vec<String>,
    pub(super) body: String,
}

impl Text {
    /// Begins with what the numbers are of.
    pub(super) fn about(imu: &Equivalent, mark: &'static str) -> Self {
        let mut text = Self {
            mark,
            comments: Vec::new(),
            body: String::new(),
        };
        text.comment(match imu.name.as_str() {
            "" => "Inertial sensor",
            name => name,
        });
        if !imu.source.is_empty() {
            text.comment(&format!("Source: {}", imu.source));
        }
        let remarks = imu.remarks.iter();
        remarks.for_each(|remark| text.comment(&comment(remark)));
        text
    }

    /// One comment of one line, whatever the text.
    pub(super) fn comment(&mut self, text: &str) {
        let is_break =
            |c: char| c.is_control() || matches!(c, '\u{2028}' | '\u{2029}' | '\u{feff}');
        let words: Vec<&str> = text
            .split(|c: char| c.is_whitespace() || is_break(c))
            .filter(|word| !word.is_empty())
            .collect();
        self.comments.push(words.join(" "));
    }

    /// The whole text, comments first.
    pub(super) fn finish(self) -> String {
        let lines = self.comments.iter();
        let comments = lines.map(|line| format!("{} {line}\n", self.mark));
        String::from_iter(comments) + &self.body
    }
}

/// Numbers between brackets, as YAML and MATLAB take them.
///
/// Comma-separated, each by [`number`].
pub(super) fn row(values: impl Iterator<Item = f64>) -> String {
    let items: Vec<String> = values.map(number).collect();
    format!("[{}]", items.join(", "))
}

/// Nine digits, with the point and the sign of the exponent that YAML 1.1 asks of a number.
///
/// `1e-5` becomes `1.0e-5` and `1e16` `1.0e+16`: YAML 1.1 takes the short forms for text.
pub(super) fn number(value: f64) -> String {
    let rounded: f64 = format!("{value:.8e}").parse().unwrap_or(value);
    let text = format!("{rounded:?}");
    match text.split_once('e') {
        None => text,
        Some((mantissa, exponent)) => {
            let point = if mantissa.contains('.') { "" } else { ".0" };
            let sign = if exponent.starts_with('-') { "" } else { "+" };
            format!("{mantissa}{point}e{sign}{exponent}")
        }
    }
}
