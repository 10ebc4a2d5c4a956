//! `docs/settings.md` lists every setting of the engine as it is in the source.

use std::{fmt::Write, fs, path::Path};
use undrift::settings::ALL;

/// The page as the source has it.
fn page() -> String {
    let mut page = String::from(
        "# Settings of the engine\n\n\
         The limits and time constants of alignment and replay, with their defaults. Everything in these pages was measured\n\
         with the defaults. They are reachable from the library, `undrift::replay::Settings::engine`; what is set for a drive\n\
         is in [drive-file.md](drive-file.md). \"…\" joins fields that are read together.\n",
    );
    let mut group = "";
    for [structure, field, value, about] in ALL.iter().filter(|row| row[0] != "EngineSettings") {
        if *structure != group {
            group = structure;
            let of_engine = |row: &&[&str; 4]| row[2].starts_with(&format!("{structure}::"));
            let [_, name, _, about] = ALL.iter().find(of_engine).unwrap();
            writeln!(page, "\n## `engine.{name}`\n\n{}\n", about.trim()).unwrap();
            writeln!(page, "| field | default | what it is |\n|---|---|---|").unwrap();
        }
        let about = about.trim().replace("\\[", "[").replace("\\]", "]");
        writeln!(page, "| `{field}` | {value} | {about} |").unwrap();
    }
    page
}

/// With `UNDRIFT_WRITE_SETTINGS` set, the page is written instead.
#[test]
fn the_page_of_settings_is_that_of_the_source() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/settings.md");
    if std::env::var_os("UNDRIFT_WRITE_SETTINGS").is_some() {
        fs::write(&path, page()).unwrap();
    }
    let written = fs::read_to_string(&path).unwrap_or_default();
    assert!(
        written == page(),
        "docs/settings.md is not as the source: UNDRIFT_WRITE_SETTINGS=1 cargo test -p undrift settings"
    );
}
