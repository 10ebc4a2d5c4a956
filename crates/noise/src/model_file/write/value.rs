//! Values of TOML in lines of a readable length.
//!
//! Strings and lists that are longer than 100 characters go over several lines, so that a model file can be
//! read and compared in an editor. What is read back is the same text: the breaks are TOML's own continuation
//! of lines.

use std::fmt::Write;

/// Characters of a line.
const WIDTH: usize = 100;

/// A text, over several lines where it is long: each ends in a backslash, which takes away the break and the
/// spaces that the next one begins with.
///
/// `key` counts for the length of the line only. Texts that begin with a space stay on one line:
/// continuation would eat it.
pub(super) fn text(key: &str, text: &str) -> String {
    let is_short = key.len() + text.chars().count() + 5 <= WIDTH;
    if is_short || text.starts_with(' ') {
        return toml::Value::String(text.to_owned()).to_string();
    }
    let mut lines = vec![String::new()];
    for word in text.split_inclusive(' ') {
        let last = lines.len() - 1;
        let is_full = lines[last].chars().count() + word.chars().count() + 3 > WIDTH;
        // A second space would be taken away with the break before it.
        if is_full && !lines[last].is_empty() && word != " " {
            lines.push(escaped(word));
        } else {
            lines[last] += &escaped(word);
        }
    }
    let lines: String = lines.iter().map(|line| format!("  {line}\\\n")).collect();
    format!("\"\"\"\\\n{lines}\"\"\"")
}

/// A list on one line, or filling several.
///
/// `items` are already in TOML's syntax; a trailing comma is allowed in arrays.
pub(super) fn filled(key: &str, items: impl Iterator<Item = String>) -> String {
    let items: Vec<String> = items.collect();
    let one = format!("[{}]", items.join(", "));
    if key.len() + one.chars().count() + 3 <= WIDTH {
        return one;
    }
    let (mut out, mut length) = (String::from("["), WIDTH);
    for item in items {
        length += item.chars().count() + 2;
        if length > WIDTH {
            length = item.chars().count() + 3;
            out += "\n ";
        }
        let _ = write!(out, " {item},");
    }
    out + "\n]"
}

/// A key, bare where it can be; a key in quotes is never of more than one line.
pub(super) fn as_key(key: &str) -> String {
    let is_bare = |b: u8| b.is_ascii_alphanumeric() || b == b'_' || b == b'-';
    if !key.is_empty() && key.bytes().all(is_bare) {
        return key.to_owned();
    }
    format!("\"{}\"", escaped(key))
}

/// The text between the quotes of a basic string.
fn escaped(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            c if c.is_control() => {
                let _ = write!(out, "\\u{:04X}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_values_read_back_from_lines_that_are_not() {
        let words = "a word \"quoted\", \\, \u{1} and  two spaces; ".repeat(12);
        for given in [
            words.clone(),
            words.trim_end().into(),
            format!(" {words}"),
            format!("\n{words}"),
            "x".repeat(500),
            format!("{words}   {words}"),
        ] {
            let written = format!("key = {}\n", text("key", &given));
            let read: toml::Table = toml::from_str(&written).unwrap();
            assert_eq!(read["key"].as_str(), Some(given.as_str()), "{written}");
            let longest = written.lines().map(|line| line.chars().count()).max();
            let is_wrapped = !given.starts_with([' ', 'x']);
            assert!(!is_wrapped || longest <= Some(WIDTH), "{written}");
        }
        let numbers: Vec<f64> = (0..60).map(|k| f64::from(k) / 8.0).collect();
        let written = filled("key", numbers.iter().map(ToString::to_string));
        assert!(written.lines().count() > 3 && written.lines().all(|line| line.len() <= WIDTH));
        let read: toml::Table = toml::from_str(&format!("key = {written}")).unwrap();
        assert_eq!(read["key"].as_array().map(Vec::len), Some(60));
    }
}
