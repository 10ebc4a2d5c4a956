//! Which crate may depend on which: the walls of the house.

use std::process::Command;

/// Every crate of the workspace with the crates of it that it may use.
const ALLOWED: [(&str, &[&str]); 9] = [
    ("undrift-nav", &[]),
    ("undrift-noise", &["undrift-nav"]),
    ("undrift-io", &["undrift-nav"]),
    ("undrift", &["undrift-nav", "undrift-noise", "undrift-io"]),
    ("undrift-report", &["undrift"]),
    ("undrift-cli", &["undrift", "undrift-report"]),
    ("undrift-py", &["undrift", "undrift-report"]),
    ("undrift-capi", &["undrift-nav"]),
    // Benches and generators, which nothing else uses.
    (
        "undrift-lab",
        &[
            "undrift",
            "undrift-io",
            "undrift-nav",
            "undrift-noise",
            "undrift-report",
        ],
    ),
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

#[test]
fn the_filter_neither_allocates_nor_needs_std() {
    let source = include_str!("../../../nav/src/lib.rs");
    assert!(source.contains("#![no_std]"));
    assert!(!source.contains("extern crate alloc"));
}
