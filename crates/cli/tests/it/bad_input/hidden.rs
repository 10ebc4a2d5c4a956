//! Characters that act on a terminal, in names of files, columns and keys: escaped wherever they are shown.

use super::drives::good;
use super::log::{Case, Outcome, says};
use crate::bad_input::log::table;

/// A red colour, a bell, a line of its own, a carriage return and an override of the direction.
const HOSTILE: &str = "a\u{1b}[31m\u{7}\nerror: b\r\u{202e}c";
const SHOWN: &str = "a\\u{1b}[31m\\u{7}\\nerror: b\\r\\u{202e}c";

/// Nothing but our own styles and ends of lines acts on the terminal.
#[track_caller]
fn plain(done: &Outcome) {
    for text in [&done.stdout, &done.stderr] {
        let own = |text: &str| {
            ["[0m", "[1m", "[31m", "[33m"]
                .iter()
                .any(|style| text.starts_with(style))
        };
        for (at, part) in text.split('\u{1b}').enumerate() {
            assert!(at == 0 || own(part), "{text:?}");
            let acts = |c: char| c.is_control() && c != '\n' || c == '\u{202e}';
            assert!(!part.contains(acts), "{text:?}");
        }
        assert!(
            !text.lines().any(|line| line.starts_with("error: b")),
            "{text:?}"
        );
    }
}

/// With colours, as on a terminal: without them the stream removes escape codes by itself.
fn run(case: &Case, arguments: &[&str]) -> Outcome {
    let done = case.run(&[arguments, &["--color", "always"]].concat());
    plain(&done);
    done
}

/// A key's value in a drive file.
fn quoted(text: &str) -> String {
    text.escape_default()
        .to_string()
        .replace("\\u{1b}", "\\u001b")
        .replace("\\u{7}", "\\u0007")
        .replace("\\u{202e}", "\\u202e")
}

#[cfg(unix)]
#[test]
fn in_names_of_files() {
    let case = good().write("hidden_files");
    let toml = format!("{HOSTILE}.toml");
    let (csv, nav, imu) = (
        format!("{HOSTILE}.csv"),
        format!("{HOSTILE}.nav"),
        format!("{HOSTILE}-imu.toml"),
    );
    for name in [&toml, &csv] {
        says(
            &run(&case, &["navigate", name]).stderr,
            &[SHOWN, "no such file"],
        );
    }
    case.put(&toml, case.read("drive.toml").unwrap().as_bytes());
    says(
        &run(&case, &["navigate", &toml, "-o", &nav]).stdout,
        &[&format!("solution: {SHOWN}.nav")],
    );
    says(
        &run(&case, &["navigate", &toml, "-v"]).stderr,
        &[&format!("drive: {SHOWN}.toml")],
    );
    case.put(&csv, case.read("imu.csv").unwrap().as_bytes());
    says(
        &run(&case, &["inspect", &csv, "gnss.csv", "-o", &imu]).stdout,
        &[SHOWN, "drive file: "],
    );
    says(
        &run(&case, &["identify", &csv]).stderr,
        &[&format!("{SHOWN}.csv")],
    );
    run(&case, &["model", &csv, "--to", "kalibr"]);
    run(&case, &["report", &csv, "-o", "report.html"]);
    run(&case, &["fleet", &csv, "-o", "out"]);
}

#[test]
fn in_columns_keys_and_values() {
    let mut log = good();
    let case = log.write("hidden_columns");
    // A line cannot end within a column's name.
    let (column, shown) = (
        HOSTILE.replace(['\n', '\r'], ""),
        SHOWN.replace("\\n", "").replace("\\r", ""),
    );
    let header = format!("{column},gx,gy,gz,fx,fy,fz");
    case.put("imu.csv", table(&header, &log.imu).as_bytes());
    says(&run(&case, &["navigate", "drive.toml"]).stderr, &[&shown]);
    run(&case, &["inspect", "imu.csv"]);
    run(&case, &["identify", "imu.csv"]);
    for (from, to) in [
        ("\"imu.csv\"", format!("\"{}\"", quoted(HOSTILE))),
        ("time = ", format!("\"{}\" = ", quoted(HOSTILE))),
        ("\"rad/s\"", format!("\"{}\"", quoted(HOSTILE))),
        ("\"adis16465\"", format!("\"{}\"", quoted(HOSTILE))),
        ("[gnss]", format!("[gnss]\n\"{}\" = 1", quoted(HOSTILE))),
    ] {
        let mut log = log.clone();
        log.set(from, &to);
        let done = run(&log.write("hidden_keys"), &["navigate", "drive.toml"]);
        assert_eq!(done.code, Some(1), "{}", done.stderr);
    }
    // The name of a sensor, down to the report.
    let model = case.run(&["model", "adis16465", "--to", "undrift"]).stdout;
    let named = format!("\nname = \"{}\"", quoted(HOSTILE));
    let line = model
        .lines()
        .find(|line| line.starts_with("name = "))
        .unwrap()
        .to_owned();
    log.set("\"adis16465\"", "\"sensor.toml\"");
    let case = log.write("hidden_sensor");
    case.put(
        "sensor.toml",
        model.replacen(&format!("\n{line}"), &named, 1).as_bytes(),
    );
    let done = run(
        &case,
        &[
            "navigate",
            "drive.toml",
            "-v",
            "--report",
            "r.html",
            "--figures",
            "figures",
        ],
    );
    assert_eq!(done.code, Some(0), "{}", done.stderr);
    let page = case.read("r.html").unwrap();
    let (page, _) = page
        .split_once("<script type=\"application/json\"")
        .unwrap();
    let acts = |c: char| c.is_control() && c != '\n' && c != '\t' || c == '\u{202e}';
    assert!(page.contains("error: b") && !page.contains(acts));
}
