//! The table of headings by two antennas: a start at rest, the direction of the antennas, wrong keys, and what inspection proposes.

use super::log::{Case, Log, Row, says};

const HEADING: &str = "[heading]\nfile = \"antennas.csv\"\ntime = \"t\"\nheading = \"dual_heading_deg\"\nstd = \"0.3 deg\"\nbaseline = \"90 deg\"\n";

/// A drive with this table at its end, and the log of an antenna on the right and one on the left; every twentieth heading
/// is wrong.
fn drive(name: &str, table: &str) -> Case {
    let mut log = Log::good();
    log.drive += table;
    let noise = [0.2, -0.4, 0.1, 0.5, -0.3, -0.1, 0.3, 0.0, -0.5, 0.2];
    let heading = |(k, row): (usize, &Row)| {
        let wrong = if k % 20 == 13 { 147.0 } else { 0.0 };
        let heading = row.number(9) + 90.0 + noise[k % 10] + wrong;
        format!("{:.2},{:.3}\n", row.time, heading.rem_euclid(360.0))
    };
    let rows: String = log
        .truth
        .iter()
        .step_by(25)
        .enumerate()
        .map(heading)
        .collect();
    let case = log.write(&format!("headings_{name}"));
    case.put(
        "antennas.csv",
        format!("t,dual_heading_deg\n{rows}").as_bytes(),
    );
    case
}

#[test]
fn they_give_the_first_heading_and_are_used() {
    let (outcome, nav) = drive("given", HEADING).solution();
    says(&outcome.stderr, &["heading: rejected 8 measurements"]);
    says(&outcome.stdout, &["heading: "]);
    assert!(nav.at(4.9, "yaw_deg").is_finite(), "at rest, within 5 s");
    let open = HEADING.replace("baseline = \"90 deg\"\n", "");
    let (outcome, _) = drive("open", &open).solution();
    says(
        &outcome.stdout,
        &["direction of the second antenna", ": 90."],
    );
}

#[test]
fn wrong_keys_are_refused() {
    for (from, to, parts) in [
        (
            "time = \"t\"\n",
            "",
            &["heading.time: missing: the time column"][..],
        ),
        (
            "\"dual_heading_deg\"",
            "\"h\"",
            &["antennas.csv line 1: no column \"h\" (key heading.heading)"],
        ),
        (
            "heading = \"dual_heading_deg\"\n",
            "",
            &["heading.heading: missing: the column of the heading"],
        ),
        (
            "0.3 deg",
            "0 deg",
            &["heading.std: must be a positive standard deviation"],
        ),
        (
            "90 deg",
            "1 m",
            &["heading.baseline: \"1 m\": that is the unit of a length"],
        ),
        (
            "baseline = \"90 deg\"",
            "baseline_std = \"off\"",
            &["heading.baseline_std: \"off\" needs the direction: set baseline"],
        ),
        (
            "baseline",
            "base_line",
            &["heading.base_line: unknown key; did you mean baseline?"],
        ),
    ] {
        let name = format!("wrong_{}", from.len() + 100 * to.len());
        says(
            &drive(&name, &HEADING.replacen(from, to, 1)).refusal(),
            parts,
        );
    }
}

#[test]
fn a_format_without_headings_is_refused() {
    let table = "[heading]\nfile = \"antennas.csv\"\nformat = \"gpx\"\n";
    let parts = ["heading.file", "has no headings by two antennas"];
    says(&drive("gpx", table).refusal(), &parts);
}

#[test]
fn inspection_proposes_them_with_their_direction() {
    let case = drive("inspect", "");
    let outcome = case.run(&[
        "inspect",
        "imu.csv",
        "gnss.csv",
        "antennas.csv",
        "-o",
        "found.toml",
    ]);
    assert!(outcome.succeeded(), "{}", outcome.stderr);
    let found = case.read("found.toml").unwrap();
    says(
        &found,
        &[
            "[heading]\nfile = \"antennas.csv\"",
            "heading = \"dual_heading_deg\" # from its name",
            "baseline = \"9",
            "baseline_std = \"",
            "# from the motion, to",
        ],
    );
}
