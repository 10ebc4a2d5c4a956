//! What lies beside the crates and is not compiled: fuzz targets, toolchain, workflows.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn text(file: &str) -> String {
    fs::read_to_string(root().join(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
}

fn toml(file: &str) -> toml::Table {
    toml::from_str(&text(file)).unwrap()
}

/// Names between backticks in the cells of a page's tables that `of` picks of each row.
fn in_tables(page: &str, header: &str, of: fn(usize) -> bool) -> BTreeSet<String> {
    let (_, below) = page.split_once(header).unwrap();
    let rows = below
        .lines()
        .skip(1)
        .take_while(|line| line.starts_with('|'));
    let cells = rows.flat_map(|row| row.split('|').enumerate().filter(move |(k, _)| of(*k)));
    let names = cells.flat_map(|(_, cell)| cell.split('`').skip(1).step_by(2));
    names.map(str::to_owned).collect()
}

/// `tools/fuzz` runs the files of fuzz/targets. What a plain build leaves alone is linked by cargo-fuzz only.
#[test]
fn every_fuzz_target_is_built_by_cargo_fuzz_alone_and_is_on_its_page() {
    let files = fs::read_dir(root().join("fuzz/targets")).unwrap();
    let files = files.map(|file| file.unwrap().path());
    let names = files.map(|file| file.file_stem().unwrap().to_string_lossy().into_owned());
    let targets: BTreeSet<String> = names.collect();
    assert!(targets.len() >= 25, "{targets:?}");
    let manifest = toml("fuzz/Cargo.toml");
    let programs = manifest["bin"].as_array().unwrap();
    let built: BTreeSet<String> = programs
        .iter()
        .map(|program| {
            let name = program["name"].as_str().unwrap();
            let required = program["required-features"].as_array().unwrap();
            assert!(required.contains(&"targets".into()), "{name}");
            name.to_owned()
        })
        .collect();
    assert_eq!(built, targets, "fuzz/Cargo.toml");
    let page = text("docs/lab/fuzzing.md");
    assert_eq!(in_tables(&page, "| target | reads |", |k| k == 1), targets);
}

#[test]
fn the_toolchain_is_of_the_oldest_version_supported() {
    let toolchain = toml("rust-toolchain.toml");
    let channel = toolchain["toolchain"]["channel"].as_str().unwrap();
    let workspace = toml("Cargo.toml");
    let oldest = workspace["workspace"]["package"]["rust-version"]
        .as_str()
        .unwrap();
    assert!(
        channel.starts_with(&format!("{oldest}.")),
        "{channel}, {oldest}"
    );
}

/// The jobs of a workflow by their lines.
fn jobs(workflow: &str) -> Vec<String> {
    let (_, jobs) = workflow.split_once("\njobs:\n").unwrap();
    let mut found: Vec<String> = Vec::new();
    for line in jobs.lines() {
        let begins = line.starts_with("  ") && !line.starts_with("   ") && line.ends_with(':');
        match found.last_mut() {
            Some(job) if !begins => *job += &format!("{line}\n"),
            _ => found.push(format!("{line}\n")),
        }
    }
    found
}

/// A tag of an action can be moved to other code, a digest cannot; and who can write to the repository runs none of it.
#[test]
fn actions_are_pinned_and_only_the_job_that_uploads_may_write() {
    let mut used = 0;
    for entry in fs::read_dir(root().join(".github/workflows")).unwrap() {
        let path = entry.unwrap().path();
        let workflow = fs::read_to_string(&path).unwrap();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        for line in workflow.lines() {
            let Some((_, action)) = line.split_once("uses: ") else {
                continue;
            };
            used += 1;
            let (action, version) = action.split_once(" # v").unwrap_or((action, ""));
            let (_, digest) = action.split_once('@').unwrap();
            let hexadecimal = |c: char| c.is_ascii_digit() || ('a'..='f').contains(&c);
            assert!(
                digest.len() == 40 && digest.chars().all(hexadecimal),
                "{name}: {line}"
            );
            assert!(
                version.split('.').count() == 3,
                "{name}: no version in {line}"
            );
        }
        let (head, _) = workflow.split_once("\njobs:\n").unwrap();
        assert!(head.contains("\npermissions:\n  contents: read"), "{name}");
        assert!(!head.contains(": write"), "{name}");
        for job in jobs(&workflow).iter().filter(|job| job.contains(": write")) {
            assert!(job.contains("action-gh-release@"), "{name}: {job}");
            assert!(
                !job.contains("run:") && !job.contains("checkout@"),
                "{name}: {job}"
            );
        }
    }
    assert!(used > 10, "{used}");
}
