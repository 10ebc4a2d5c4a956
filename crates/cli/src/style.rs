//! The few colours there are. Escape codes are in the text always: the stream takes them out where
//! they are not wanted.

use clap::builder::styling::{AnsiColor, Style};
use std::ops::Range;

fn styled(style: Style, text: &str) -> String {
    format!("{style}{text}{style:#}")
}

/// Bold.
pub fn heading(text: &str) -> String {
    styled(Style::new().bold(), text)
}

/// Bold yellow.
pub fn warning(text: &str) -> String {
    styled(AnsiColor::Yellow.on_default().bold(), text)
}

/// Bold red.
pub fn error(text: &str) -> String {
    styled(AnsiColor::Red.on_default().bold(), text)
}

/// A colour for a curve.
pub fn coloured(colour: AnsiColor, text: &str) -> String {
    styled(colour.on_default(), text)
}

/// The first line of a text as a heading.
pub fn headed(text: &str) -> String {
    match text.split_once('\n') {
        Some((first, rest)) => format!("{}\n{rest}", heading(first)),
        None => heading(text),
    }
}

/// Tables apart by blank lines, headings bold, and the least number of each of the last `columns`
/// columns too: in errors the least is the best.
pub fn tables(text: &str, columns: usize) -> String {
    let blocks: Vec<String> = text
        .split("\n\n")
        .map(|t| headed(&best(t, columns)))
        .collect();
    blocks.join("\n\n")
}

/// The least number of each of the last `columns` columns bold, in the lines that have numbers there;
/// no number is where a single line has some.
pub fn best(text: &str, columns: usize) -> String {
    let lines: Vec<&str> = text.lines().collect();
    let rows: Vec<Vec<(Range<usize>, f64)>> =
        lines.iter().map(|line| numbers(line, columns)).collect();
    if rows.iter().filter(|row| !row.is_empty()).count() < 2 {
        return text.to_owned();
    }
    let least: Vec<f64> = (0..columns)
        .map(|column| {
            let values = rows.iter().filter_map(|row| Some(row.get(column)?.1));
            values.fold(f64::INFINITY, f64::min)
        })
        .collect();
    let mut out = String::new();
    for (line, row) in lines.iter().zip(&rows) {
        let mut from = 0;
        for ((range, value), least) in row.iter().zip(&least) {
            if value.is_finite() && value <= least {
                out += line.get(from..range.start).unwrap_or_default();
                out += &heading(line.get(range.clone()).unwrap_or_default());
                from = range.end;
            }
        }
        out += line.get(from..).unwrap_or_default();
        out.push('\n');
    }
    if !text.ends_with('\n') {
        out.pop();
    }
    out
}

/// The last words of a line with their places, if all are numbers; a dash is no number but stands for one.
fn numbers(line: &str, columns: usize) -> Vec<(Range<usize>, f64)> {
    let mut words = Vec::new();
    let mut end = line.len();
    while words.len() < columns {
        let Some(rest) = line.get(..end).map(str::trim_end).filter(|r| !r.is_empty()) else {
            return Vec::new();
        };
        let start = rest.rfind(' ').map_or(0, |blank| blank + 1);
        let word = rest.get(start..).unwrap_or_default();
        let value = match word {
            "–" => f64::INFINITY,
            number => match number.replace('\u{202f}', "").parse() {
                Ok(value) => value,
                Err(_) => return Vec::new(),
            },
        };
        words.push((start..rest.len(), value));
        end = start;
    }
    words.reverse();
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_of_each_column_is_bold() {
        let table = "maximum      N m   E m   y\nwhite, none  3.1   0.5   –\nour 2       2e-3   0.5   –\nlost           –     –   –\n\nnext\n";
        let bold = tables(table, 3);
        let plain = anstream::adapter::strip_str(&bold).to_string();
        assert_eq!(plain, table);
        for wanted in [
            heading("maximum      N m   E m   y"),
            format!("white, none  3.1   {}   –\n", heading("0.5")),
            format!("our 2       {}   {}   –\n", heading("2e-3"), heading("0.5")),
        ] {
            assert!(bold.contains(&wanted), "{wanted:?} in {bold:?}");
        }
        assert!(bold.contains("lost           –     –   –"), "{bold:?}");
        // Nothing is best of one.
        assert_eq!(best("a 1 2", 2), "a 1 2");
    }
}
