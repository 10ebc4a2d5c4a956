//! Which files of a folder are the bag's.

use std::ffi::OsStr;
use std::io::Read;
use std::path::{Path, PathBuf};

use super::BagFile;
use crate::{ReadError, source};

/// The list of the files, which the recorder writes when it ends.
const METADATA: &str = "metadata.yaml";
/// More is not read of it \[bytes\].
const LONGEST: u64 = 16 << 20;
/// Files that are looked at, and parts that are taken, at most.
const MOST: usize = 60_000;

/// The files of a bag's folder in their order: as its list has them, else all by their names.
///
/// # Errors
/// If it holds no bag, or the folder cannot be read.
pub(crate) fn parts(folder: &Path) -> Result<Vec<BagFile>, ReadError> {
    let mut files = listed(folder);
    if !files.iter().any(|file| file.exists()) {
        files = found(folder)?;
    }
    if files.is_empty() {
        let problem =
            "is a folder, not a log, and has no ROS 2 bag (metadata.yaml, *.db3, *.mcap) in it";
        let mend = "give a log file, or the bag's own folder";
        return Err(ReadError::new(folder, problem).mend(mend));
    }
    Ok(files.into_iter().map(BagFile::File).collect())
}

/// The files that the folder's list names.
fn listed(folder: &Path) -> Vec<PathBuf> {
    let mut text = Vec::new();
    if let Ok(file) = source::file(&folder.join(METADATA)) {
        let _ = file.take(LONGEST).read_to_end(&mut text);
    }
    let names = relative_file_paths(&String::from_utf8_lossy(&text));
    let path = |name: String| {
        let path = folder.join(&name);
        // The first versions put the folder's own name before.
        match Path::new(&name).file_name() {
            Some(bare) if !path.exists() => folder.join(bare),
            _ => path,
        }
    };
    names.into_iter().take(MOST).map(path).collect()
}

/// The items of the list `relative_file_paths` of a YAML text.
fn relative_file_paths(text: &str) -> Vec<String> {
    let key = "relative_file_paths:";
    let mut lines = text.lines().map(str::trim);
    let Some(rest) = lines.find_map(|line| line.strip_prefix(key)) else {
        return Vec::new();
    };
    let rest = rest.trim();
    if let Some(items) = rest.strip_prefix('[') {
        let items = items.split(']').next().unwrap_or_default();
        return items.split(',').filter_map(item).collect();
    }
    lines
        .filter(|line| !line.is_empty() && !line.starts_with('#'))
        .map_while(|line| line.strip_prefix('-'))
        .filter_map(item)
        .collect()
}

/// A text of YAML, in quotes or not.
fn item(text: &str) -> Option<String> {
    let text = text.trim();
    let bare = match text.chars().next()? {
        quote @ ('"' | '\'') => text[1..].split(quote).next()?,
        _ => text.split(" #").next()?.trim_end(),
    };
    (!bare.is_empty()).then(|| bare.to_owned())
}

/// The files of a folder that are named as those of bags are.
fn found(folder: &Path) -> Result<Vec<PathBuf>, ReadError> {
    let entries = std::fs::read_dir(folder).map_err(|error| source::cannot_open(folder, error))?;
    let paths = entries.take(MOST).flatten().map(|entry| entry.path());
    let mut files: Vec<PathBuf> = paths.filter(|path| is_part(path)).collect();
    files.sort_by_cached_key(|path| by_number(path));
    Ok(files)
}

fn is_part(path: &Path) -> bool {
    let ends = |path: &Path, with: &[&str]| {
        let extension = path.extension().and_then(OsStr::to_str);
        extension.is_some_and(|extension| with.contains(&extension))
    };
    let bare = if ends(path, &["zstd", "zst", "gz"]) {
        path.with_extension("")
    } else {
        path.to_path_buf()
    };
    ends(&bare, &["db3", "mcap"]) && path.is_file()
}

/// What a file is sorted by: its name with its last number apart, since `_10` comes after `_9`.
fn by_number(path: &Path) -> (String, u64, String) {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let stem = name.split('.').next().unwrap_or_default();
    let base = stem.trim_end_matches(|letter: char| letter.is_ascii_digit());
    let number = stem[base.len()..].parse().unwrap_or_default();
    (base.to_owned(), number, name.into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_of_files() {
        let list = |text: &str| relative_file_paths(text).join(" ");
        let usual = "rosbag2_bagfile_information:\n  version: 5\n  relative_file_paths:\n    - bag_0.db3\n    - \"bag 1.db3\"\n\n    - 'bag_2.db3'  # last\n  duration:\n    - 3\n";
        assert_eq!(list(usual), "bag_0.db3 bag 1.db3 bag_2.db3");
        let flow = "a:\r\n  relative_file_paths: [a.mcap, 'b.mcap']\r\n";
        assert_eq!(list(flow), "a.mcap b.mcap");
        for none in [
            "",
            "relative_file_paths:",
            "files:\n  - a.db3",
            "relative_file_paths: ~\n  - \"\n",
        ] {
            assert_eq!(list(none), "", "{none}");
        }
    }

    #[test]
    fn names_are_sorted_by_their_numbers() {
        let mut names = ["b_10.db3", "b_9.db3", "b_0.mcap", "a_11.db3", "b.db3"];
        names.sort_by_cached_key(|name| by_number(Path::new(name)));
        assert_eq!(
            names,
            ["a_11.db3", "b.db3", "b_0.mcap", "b_9.db3", "b_10.db3"]
        );
    }
}
