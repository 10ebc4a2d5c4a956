//! A drive file's text without keys that do not hold while the vehicle drives.

use toml_edit::DocumentMut;

/// The text of a drive file without some of its keys and tables at the top, in whose lines nothing is left: messages count lines as in
/// the file. Where that would change more than these, they are taken out.
pub(crate) fn without(text: &str, names: &[&str]) -> String {
    let mut document: DocumentMut = text.parse().unwrap_or_default();
    for name in names {
        document.remove(name);
    }
    let (mut in_table, mut skips, mut depth) = (false, false, 0_i32);
    let mut blanked = String::with_capacity(text.len());
    for line in text.split_inclusive('\n') {
        let start = line.trim_start();
        let name = start.trim_start_matches('[').trim_start();
        let name = name
            .split(|c: char| !(c.is_alphanumeric() || c == '_'))
            .next();
        let is_named = name.is_some_and(|name| names.contains(&name));
        if start.starts_with('[') && depth == 0 {
            (in_table, skips) = (true, is_named);
        } else if !in_table && depth == 0 {
            skips = is_named;
        }
        // An array or inline table may go over lines.
        let count = |of: &[char]| start.matches(of).count() as i32;
        depth = (depth + count(&['[', '{']) - count(&[']', '}'])).max(0);
        match skips {
            true => blanked.extend(line.ends_with('\n').then_some('\n')),
            false => blanked.push_str(line),
        }
    }
    let values = |text: &str| text.parse::<toml::Table>().ok();
    match values(&blanked) {
        Some(same) if Some(&same) == values(&document.to_string()).as_ref() => blanked,
        _ => document.to_string(),
    }
}
