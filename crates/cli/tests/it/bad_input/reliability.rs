//! The table of docs/lab/reliability.md: every damage has its test.

use std::path::{Path, PathBuf};

const PAGE: &str = include_str!("../../../../../docs/lab/reliability.md");
/// Damages that the page promises at least.
const LEAST: usize = 60;

/// The cells of the numbered rows.
fn rows() -> Vec<Vec<&'static str>> {
    let cells = |line: &'static str| -> Vec<&str> {
        line.trim_matches('|').split(" | ").map(str::trim).collect()
    };
    PAGE.lines()
        .filter(|line| {
            line.starts_with("| ") && line[2..].starts_with(|c: char| c.is_ascii_digit())
        })
        .map(cells)
        .collect()
}

/// The source that a test's module is in: `undrift-cli::bad_input::files` or `undrift-io::table`.
fn source(crate_name: &str, module: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let folder = root.join(crate_name.strip_prefix("undrift-").unwrap_or(crate_name));
    let path = module.replace("::", "/");
    [
        folder.join("tests/it").join(format!("{path}.rs")),
        folder.join("src").join(&path).join("tests.rs"),
        folder.join("src").join(format!("{path}.rs")),
    ]
    .into_iter()
    .find(|path| path.is_file())
    .unwrap_or_else(|| panic!("no source of {crate_name}::{module}"))
}

#[test]
fn every_damage_has_a_test() {
    let rows = rows();
    assert!(rows.len() >= LEAST, "{} rows", rows.len());
    for (k, row) in rows.iter().enumerate() {
        let [number, damage, outcome, test] = row[..] else {
            panic!("row {} has {} cells", k + 1, row.len());
        };
        assert_eq!(number, (k + 1).to_string());
        assert!(!damage.is_empty() && !outcome.is_empty());
        let name = test.trim_matches('`');
        let (module, test) = name.rsplit_once("::").unwrap();
        let (crate_name, module) = module.split_once("::").unwrap();
        let path = source(crate_name, module);
        let text = std::fs::read_to_string(&path).unwrap();
        let at = text.find(&format!("fn {test}("));
        let at = at.unwrap_or_else(|| panic!("row {number}: no {test} in {}", path.display()));
        let before = text[..at].trim_end();
        assert!(
            before.ends_with("#[test]"),
            "row {number}: {test} is no test"
        );
    }
}
