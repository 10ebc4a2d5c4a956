//! Which crate may depend on which: the walls of the house.

use std::{
    path::{Path, PathBuf},
    process::Command,
};

/// Every crate of the workspace with the crates of it that it may use.
const ALLOWED: [(&str, &[&str]); 23] = [
    ("undrift-base", &[]),
    ("undrift-nav", &[]),
    // Tables of TOML files, whatever their keys mean.
    ("undrift-config", &["undrift-base", "undrift-nav"]),
    (
        "undrift-noise",
        &["undrift-base", "undrift-config", "undrift-nav"],
    ),
    // Satellites and phases; nothing of a filter but the Earth.
    ("undrift-observables", &["undrift-nav"]),
    (
        "undrift-io",
        &["undrift-base", "undrift-nav", "undrift-observables"],
    ),
    // What a navigator says of a solution, as values: results and their words need no engine for them.
    ("undrift-events", &["undrift-nav"]),
    ("undrift-engine", &["undrift-nav", "undrift-events"]),
    (
        "undrift-simulate",
        &["undrift-base", "undrift-nav", "undrift-noise"],
    ),
    // Of those that compute it has the values that results hold: terms, tests, fits.
    (
        "undrift-results",
        &[
            "undrift-base",
            "undrift-nav",
            "undrift-events",
            "undrift-noise",
            "undrift-io",
        ],
    ),
    (
        "undrift-drive",
        &[
            "undrift-base",
            "undrift-config",
            "undrift-nav",
            "undrift-engine",
            "undrift-noise",
            "undrift-io",
            "undrift-results",
        ],
    ),
    (
        "undrift-tune",
        &[
            "undrift-base",
            "undrift-nav",
            "undrift-engine",
            "undrift-noise",
            "undrift-results",
            "undrift-drive",
        ],
    ),
    // Tuning is one of the things that are done with each log.
    (
        "undrift-fleet",
        &[
            "undrift-base",
            "undrift-nav",
            "undrift-noise",
            "undrift-io",
            "undrift-results",
            "undrift-drive",
            "undrift-tune",
        ],
    ),
    (
        "undrift-experiments",
        &[
            "undrift-base",
            "undrift-nav",
            "undrift-engine",
            "undrift-simulate",
            "undrift-noise",
            "undrift-io",
            "undrift-results",
            "undrift-drive",
        ],
    ),
    (
        "undrift",
        &[
            "undrift-base",
            "undrift-nav",
            "undrift-engine",
            "undrift-simulate",
            "undrift-noise",
            "undrift-io",
            "undrift-results",
            "undrift-drive",
            "undrift-tune",
            "undrift-fleet",
            "undrift-experiments",
        ],
    ),
    // Results in, and what they hold; nothing of what makes them.
    (
        "undrift-report",
        &[
            "undrift-base",
            "undrift-nav",
            "undrift-events",
            "undrift-noise",
            "undrift-io",
            "undrift-results",
        ],
    ),
    // The navigator of a drive, with sources in place of its files.
    (
        "undrift-live",
        &[
            "undrift-base",
            "undrift-nav",
            "undrift-engine",
            "undrift-noise",
            "undrift-io",
            "undrift-drive",
        ],
    ),
    // DDS: bytes of topics as a source, rows of the solution as topics.
    ("undrift-ros2", &["undrift-io", "undrift-live"]),
    (
        "undrift-cli",
        &["undrift", "undrift-live", "undrift-report", "undrift-ros2"],
    ),
    ("undrift-py", &["undrift", "undrift-report"]),
    ("undrift-capi", &["undrift-nav", "undrift-engine"]),
    // Benches and generators, which nothing else uses.
    (
        "undrift-lab",
        &[
            "undrift",
            "undrift-base",
            "undrift-io",
            "undrift-nav",
            "undrift-noise",
            "undrift-report",
        ],
    ),
    ("undrift-fuzz", &["undrift", "undrift-report"]),
];

#[test]
fn crates_only_depend_downwards() {
    let output = Command::new(env!("CARGO"))
        .args([
            "metadata",
            "--format-version",
            "1",
            "--no-deps",
            "--offline",
        ])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    let metadata: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let packages = metadata["packages"].as_array().unwrap();
    assert_eq!(
        packages.len(),
        ALLOWED.len(),
        "a crate is missing from the table"
    );
    for package in packages {
        let name = package["name"].as_str().unwrap();
        let (_, allowed) = ALLOWED
            .iter()
            .find(|(n, _)| *n == name)
            .unwrap_or_else(|| panic!("{name} is not in the table"));
        for dependency in package["dependencies"].as_array().unwrap() {
            let other = dependency["name"].as_str().unwrap();
            // Tests may reach for more than the product does.
            let for_tests = dependency["kind"] == "dev";
            assert!(
                (for_tests && other != "undrift-lab")
                    || !other.starts_with("undrift")
                    || allowed.contains(&other),
                "{name} must not depend on {other}"
            );
        }
    }
}

/// DDS takes a minute to compile: only who asks for feature `ros2` of the command has it, no build or test of the whole.
#[test]
fn only_a_feature_brings_dds() {
    let command = include_str!("../../../cli/Cargo.toml");
    for line in [
        "default = [\"parquet\", \"xlsx\"]",
        "ros2 = [\"dep:undrift-ros2\", \"undrift-ros2/dds\"]",
        "undrift-ros2 = { workspace = true, optional = true }",
    ] {
        assert!(command.contains(line), "{line}");
    }
    let ros2 = include_str!("../../../ros2/Cargo.toml");
    let dds = ros2.lines().find(|line| line.starts_with("rustdds"));
    assert!(dds.unwrap().contains("optional = true"));
    assert!(!ros2.contains("default ="));
    assert!(include_str!("../../../ros2/src/lib.rs").contains("#![cfg(feature = \"dds\")]"));
}

#[test]
fn the_filter_neither_allocates_nor_needs_std() {
    let source = include_str!("../../../nav/src/lib.rs");
    assert!(source.contains("#![no_std]"));
    assert!(!source.contains("extern crate alloc"));
}

/// The gate builds it for a microcontroller, too.
#[test]
fn the_navigator_knows_no_file_no_clock_and_no_thread() {
    let source = include_str!("../../../engine/src/lib.rs");
    assert!(source.contains("#![no_std]"));
    let mut files = Vec::new();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../engine/src");
    sources(&folder, &mut files);
    for path in files {
        let code = product(&std::fs::read_to_string(&path).unwrap());
        let code = code.replace("#[cfg(test)]\nextern crate std;", "");
        for barred in ["std::", "extern crate std", "undrift_io", "undrift_noise"] {
            let inside = code
                .match_indices(barred)
                .any(|(at, _)| !code[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_'));
            assert!(!inside, "{barred} in {}", path.display());
        }
    }
}

/// Text of a source file without its tests and comments.
pub fn product(source: &str) -> String {
    let without_tests = source.split("#[cfg(test)]\nmod tests {").next();
    let lines = without_tests.unwrap_or_default().lines();
    let code = lines.filter(|line| !line.trim_start().starts_with("//"));
    code.collect::<Vec<_>>().join("\n")
}

/// The source files of a folder, those of tests aside.
pub fn sources(folder: &Path, all: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() && !path.ends_with("tests") {
            sources(&path, all);
        } else if path.extension().is_some_and(|ending| ending == "rs")
            && !path.ends_with("tests.rs")
            && !path.ends_with("testing.rs")
        {
            all.push(path);
        }
    }
}

/// A result is a struct of `undrift-results`: what is assembled as a tree of JSON, or taken apart by keys, is another
/// shape of it that nothing keeps in step.
#[test]
fn no_result_is_serialised_by_hand() {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut files = Vec::new();
    for name in [
        "results",
        "undrift",
        "drive",
        "tune",
        "fleet",
        "experiments",
        "report",
        "cli",
        "py",
    ] {
        sources(&crates.join(name).join("src"), &mut files);
    }
    // The one place where text is made of a result.
    // And what a page draws with, which is no result.
    files.retain(|path| {
        !path.ends_with("results/src/text.rs") && !path.ends_with("report/src/data.rs")
    });
    for path in files {
        // What is read before it is known whether it can be.
        let reads_values = path.ends_with("results/src/known.rs");
        let source = std::fs::read_to_string(&path).unwrap();
        let code = product(&source);
        for by_hand in [
            "json!",
            "serde_json::Value",
            "serde_json::Map",
            "serde_json::{",
            "serde_json::to_string_pretty",
            "serde_json::to_value",
            "serde_json::to_vec",
            "serde_json::to_writer",
        ] {
            let allowed = reads_values && by_hand == "serde_json::Value";
            assert!(
                allowed || !code.contains(by_hand),
                "{}: {by_hand}",
                path.display()
            );
        }
    }
}

/// Source files of the crates that mention a word, tests and what only tests use aside.
fn files_with(word: &str) -> Vec<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut files = Vec::new();
    for entry in std::fs::read_dir(root.join("crates")).unwrap() {
        sources(&entry.unwrap().path().join("src"), &mut files);
    }
    let mentions = |path: &PathBuf| {
        let source = std::fs::read_to_string(path).unwrap();
        let product = source.split("#[cfg(test)]\nmod tests {").next();
        product.unwrap_or_default().to_lowercase().contains(word)
    };
    let name = |path: PathBuf| {
        let from_root = path.strip_prefix(&root).unwrap();
        from_root.to_string_lossy().replace('\\', "/")
    };
    let mut found: Vec<_> = files.into_iter().filter(mentions).map(name).collect();
    found.sort();
    found
}

/// The files in the tables of a chapter of docs/lab/add-a-measurement.md, those of its parts of their own behind.
fn files_of_page(chapter: &str) -> Vec<Vec<String>> {
    let page = include_str!("../../../../docs/lab/add-a-measurement.md");
    let chapters = page.split("\n## ").find(|of| of.starts_with(chapter));
    let parts = chapters.unwrap().split("\n### ");
    parts
        .map(|part| {
            let rows = part.lines().filter(|line| line.starts_with("| "));
            let files = rows.filter_map(|row| Some(row.split('`').nth(1)?.to_owned()));
            files.filter(|file| file.ends_with(".rs")).collect()
        })
        .collect()
}

/// A new measurement, format or noise model touches few files, and the page names them all.
#[test]
fn what_is_added_has_few_places_and_the_page_names_them() {
    for (chapter, word, most) in [
        ("Add a measurement", "barometer", &[8, 2][..]),
        ("Add a format of logs", "gnsslogger", &[4]),
        ("Add a noise model", "random-walk", &[4]),
    ] {
        let parts = files_of_page(chapter);
        let counts: Vec<usize> = parts.iter().map(Vec::len).collect();
        assert!(
            counts.len() == most.len() && counts.iter().zip(most).all(|(n, most)| n <= most),
            "{chapter}: {counts:?} files, at most {most:?}"
        );
        let mut named = parts.concat();
        named.sort();
        assert_eq!(files_with(word), named, "{chapter}: {word}");
    }
}

/// A file that has outgrown its name is divided by meaning, its tests put beside it.
#[test]
fn no_file_is_longer_than_500_lines() {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut files = Vec::new();
    for entry in std::fs::read_dir(crates).unwrap() {
        let folder = entry.unwrap().path().join("src");
        if folder.is_dir() {
            sources(&folder, &mut files);
        }
    }
    assert!(files.len() > 500, "{} files", files.len());
    for path in files {
        let lines = std::fs::read_to_string(&path).unwrap().lines().count();
        assert!(lines <= 500, "{}: {lines} lines", path.display());
    }
}
