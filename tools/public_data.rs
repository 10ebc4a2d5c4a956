//! The folder of the public data (docs/lab/public-data.md), for tests: each crate's integration tests include this file.

// Each of them uses a part of this.
#![allow(dead_code)]

use std::{
    env,
    fs::OpenOptions,
    io::Write,
    path::{Path, PathBuf},
    thread,
};

/// `UNDRIFT_DATA`, by default `../shared/data` beside the project. A relative path starts at the project's root.
pub(crate) fn folder() -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let given = env::var_os("UNDRIFT_DATA").filter(|given| !given.is_empty());
    root.join(given.unwrap_or_else(|| "../shared/data".into()))
}

/// A file or a folder of the public data. Without it, the test that asks is reported as skipped.
pub(crate) fn find(name: &str) -> Option<PathBuf> {
    let path = folder().join(name);
    if path.exists() {
        return Some(path);
    }
    skipped(&format!("DATA/{name}"));
    None
}

/// Reports that the running test was skipped: as a line that test runners do not capture, and in the file
/// `UNDRIFT_SKIPPED`, which the gate collects.
pub(crate) fn skipped(without: &str) {
    let package = env!("CARGO_PKG_NAME");
    let line = format!("skipped: {package}::{} without {without}\n", test());
    let _ = std::io::stderr().write_all(line.as_bytes());
    if let Some(path) = env::var_os("UNDRIFT_SKIPPED") {
        let file = OpenOptions::new().create(true).append(true).open(&path);
        file.and_then(|mut file| file.write_all(line.as_bytes()))
            .unwrap_or_else(|error| panic!("UNDRIFT_SKIPPED, {}: {error}", path.display()));
    }
}

/// Name of the running test: that of its thread, or what nextest runs in this process.
fn test() -> String {
    match thread::current().name() {
        Some(name) if name != "main" => name.to_owned(),
        _ => env::args()
            .skip_while(|word| word != "--exact")
            .nth(1)
            .unwrap_or_default(),
    }
}
