//! The solution in several formats, and where it had no GNSS.

use super::log::{Case, DURATION, Log, says};
use serde_json::Value;

/// The lines of a GeoJSON: whether with GNSS, from and to [s].
fn spans(case: &Case, name: &str) -> Vec<(bool, f64, f64)> {
    let json: Value = serde_json::from_str(&case.read(name).unwrap()).unwrap();
    let of = |feature: &Value| {
        let p = &feature["properties"];
        (
            p["gnss"].as_bool().unwrap(),
            p["start_s"].as_f64().unwrap(),
            p["end_s"].as_f64().unwrap(),
        )
    };
    json["features"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|feature| feature["geometry"]["type"] == "LineString")
        .map(of)
        .collect()
}

fn without_fixes() -> Log {
    let mut log = Log::good();
    log.gnss.retain(|row| !(50.1..59.9).contains(&row.time));
    log
}

#[test]
fn one_pass_writes_all_formats() {
    let mut log = without_fixes();
    log.drive = format!("epoch = \"week 2374\"\n{}", log.drive);
    let case = log.write("formats");
    let mut arguments = vec!["navigate", "drive.toml"];
    let names = ["nav.csv", "n.nav", "n.nmea", "n.kml", "n.geojson", "n.gpx"];
    for name in names {
        arguments.extend(["-o", name]);
    }
    let outcome = case.run(&arguments);
    assert!(outcome.succeeded(), "{}", outcome.stderr);
    for name in names {
        assert!(case.read(name).unwrap().len() > 10_000, "{name}");
        says(&outcome.stdout, &[&format!("solution: {name}")]);
    }
    let rows = |name| case.read(name).unwrap().lines().count();
    assert_eq!(rows("nav.csv"), rows("n.nav") + 1);
    // The log is at 50 Hz, the track at 10.
    let points = case.read("n.gpx").unwrap().matches("<trkpt").count();
    assert!((rows("n.nav") / 5).abs_diff(points) <= 1, "{points}");
    // A fix is too old two seconds after the last one, at 50.0 s.
    let spans = spans(&case, "n.geojson");
    let kinds: Vec<bool> = spans.iter().map(|span| span.0).collect();
    assert_eq!(kinds, [true, false, true]);
    assert!((spans[1].1 - 52.0).abs() < 0.05, "{spans:?}");
    assert!((spans[1].2 - 60.0).abs() < 0.05, "{spans:?}");
    assert!((spans[2].2 - DURATION).abs() < 0.05, "{spans:?}");
}

#[test]
fn a_smoothed_solution_knows_where_gnss_was_lost() {
    let case = without_fixes().write("smoothed_formats");
    let outcome = case.run(&["navigate", "drive.toml", "--smooth", "-o", "n.json"]);
    assert!(outcome.succeeded(), "{}", outcome.stderr);
    let spans = spans(&case, "n.json");
    assert_eq!(spans.len(), 3, "{spans:?}");
    assert!((spans[1].1 - 50.0).abs() < 0.05, "{spans:?}");
    assert!((spans[1].2 - 60.0).abs() < 0.05, "{spans:?}");
}

#[test]
fn outages_are_drawn() {
    let case = Log::good().write("outage_track");
    let cuts = ["--length", "5", "--at", "40,60", "--track"];
    let outcome = case.outages(&[&cuts[..], &["t.geojson"]].concat());
    assert!(outcome.succeeded(), "{}", outcome.stderr);
    let lost: Vec<_> = spans(&case, "t.geojson")
        .into_iter()
        .filter(|span| !span.0)
        .map(|(_, from, to)| (from.round(), to.round()))
        .collect();
    assert_eq!(lost, [(40.0, 45.0), (60.0, 65.0)]);
    let outcome = case.outages(&[&cuts[..], &["t.csv"]].concat());
    assert_eq!(outcome.code, Some(2));
    says(&outcome.stderr, &["must be .kml, .geojson or .gpx"]);
}

#[test]
fn files_that_cannot_be_meant() {
    let case = Log::good().write("no_formats");
    for (arguments, parts) in [
        (&["-o", "nav.txt"][..], &["nav.txt", "--format"][..]),
        (&["-o", "nav"], &["--format"]),
        (
            &["-o", "n.kml", "-o", "n.kml"],
            &["two results are to be written to n.kml"],
        ),
        (
            &["-o", "n.kml", "-o", "n.gpx", "--format", "csv"],
            &["single -o"],
        ),
        (&["-o", "n.kml", "--format", "kmz"], &["unknown format"]),
        (
            &["-o", "n.kml", "--every", "nan"],
            &["n.kml", "row interval: NaN s"],
        ),
        (&["-o", "none/n.gpx"], &["cannot write none/n.gpx"]),
    ] {
        let outcome = case.run(&[&["navigate", "drive.toml"], arguments].concat());
        assert!(!outcome.succeeded(), "{arguments:?}");
        says(&outcome.stderr, parts);
        assert!(case.read("n.kml").is_none() && case.read("n.gpx").is_none());
    }
    let named = [
        "navigate",
        "drive.toml",
        "-o",
        "nav.txt",
        "--format",
        "kf-gins",
        "--every",
        "1",
    ];
    assert!(case.run(&named).succeeded());
    let text = case.read("nav.txt").unwrap();
    assert!(text.lines().all(|line| line.starts_with("0 ")));
    assert!(text.lines().count() <= 82, "{}", text.lines().count());
}
