//! Names of files.

/// A name that can be a file's on every system, whatever stood in it.
pub(crate) fn file_stem(name: &str) -> String {
    let plain = |c: char| {
        if c.is_alphanumeric() || "-_".contains(c) {
            c
        } else {
            '-'
        }
    };
    let stem: String = name.chars().take(100).map(plain).collect();
    let stem = stem.trim_matches('-');
    if stem.is_empty() {
        "unnamed".to_owned()
    } else {
        stem.to_owned()
    }
}
