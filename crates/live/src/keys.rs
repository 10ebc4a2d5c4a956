//! A drive file's text without keys that do not hold while the vehicle drives.

use toml::{
    Spanned,
    de::{DeTable, DeValue},
};

/// The text of a drive file with these `tables` without some of the keys and tables at its top, in whose lines nothing is left: messages
/// count lines as in the file.
pub(crate) fn without(text: &str, tables: &DeTable, names: &[&str]) -> String {
    let mut spans = Vec::new();
    let is_named = |key: &str| names.contains(&key);
    for (key, value) in tables.iter().filter(|(key, _)| is_named(key.get_ref())) {
        spans.push(key.span());
        collect(value, &mut spans);
    }
    let mut start = 0;
    let lines = text.split_inclusive('\n').map(|line| {
        let (first, end) = (start, start + line.len());
        start = end;
        let is_blank = spans
            .iter()
            .any(|span| span.start < end && first < span.end);
        match (is_blank, line.ends_with('\n')) {
            (true, true) => "\n",
            (true, false) => "",
            (false, _) => line,
        }
    });
    lines.collect()
}

/// Where a value is in the text, and all keys and values in it \[bytes\].
fn collect(value: &Spanned<DeValue>, spans: &mut Vec<std::ops::Range<usize>>) {
    spans.push(value.span());
    match value.get_ref() {
        DeValue::Table(table) => {
            for (key, value) in table {
                spans.push(key.span());
                collect(value, spans);
            }
        }
        DeValue::Array(items) => items.iter().for_each(|item| collect(item, spans)),
        _ => {}
    }
}
