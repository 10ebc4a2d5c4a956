//! The date of a drive, from its logs into what is written of it.

use super::log::{Case, Log, Row, says};
use serde_json::Value;

/// A Tuesday, 10 s before midnight, by `date -u -d 2025-07-08T23:59:50Z +%s`.
const UNIX: f64 = 1_752_019_190.0;
/// GPS week and second of it: 3 days less 10 s, and 18 leap seconds.
const WEEK: (u32, f64) = (2374, 3.0 * 86_400.0 - 10.0 + 18.0);

/// Rows whose times count from another zero.
fn later(rows: &mut [Row], by: f64) {
    for row in rows {
        *row = row.at(row.time + by);
    }
}

fn result(case: &Case) -> Value {
    serde_json::from_str(&case.read("r.json").unwrap()).unwrap()
}

/// `undrift navigate` into all formats with dates.
fn navigated(case: &Case) {
    let mut arguments = vec!["navigate", "drive.toml", "--json", "r.json"];
    for file in [
        "nav.csv", "nav.gpx", "nav.nmea", "nav.kml", "nav.mcap", "nav.nav", "nav.sbet",
    ] {
        arguments.extend(["-o", file]);
    }
    let outcome = case.run(&arguments);
    assert!(outcome.succeeded(), "{}", outcome.stderr);
}

/// The UTC of the start of the first part of a file, by `inspect`.
fn start_of(case: &Case, file: &str) -> Value {
    let outcome = case.run(&["inspect", file, "--json", "i.json"]);
    assert!(outcome.succeeded(), "{}", outcome.stderr);
    let found: Value = serde_json::from_str(&case.read("i.json").unwrap()).unwrap();
    let parts = found[0]["parts"].as_array().unwrap();
    let fixes = parts.iter().find(|part| part["table"] == "gnss").unwrap();
    fixes["measured"]["start"]["utc"].clone()
}

#[test]
fn unix_times_of_the_imu_and_gps_weeks_of_the_receiver_are_one_date_to_the_end() {
    let mut log = Log::good();
    later(&mut log.imu, UNIX);
    later(&mut log.truth, UNIX);
    later(&mut log.gnss, WEEK.1);
    log.set(
        "file = \"gnss.csv\"\ntime = \"t\"",
        "file = \"gnss.csv\"\ntime = \"t\"\ndate = 11",
    );
    for row in &mut log.gnss {
        row.fields.push(WEEK.0.to_string());
    }
    let case = log.write("dates_join");
    let gnss = case.read("gnss.csv").unwrap();
    let gnss = gnss.replacen("sn,se,sd", "sn,se,sd,week", 1);
    case.put("gnss.csv", gnss.as_bytes());
    navigated(&case);
    let result = result(&case);
    let start = &result["drive"]["start"];
    assert_eq!(start["clock"], "utc");
    assert_eq!(start["utc"], "2025-07-08T23:59:50.020Z");
    assert_eq!(start["time_s"], start["unix_s"]);
    assert!(result["summary"]["fixes"].as_u64().unwrap() > 100);

    // The first row of each, against that of the CSV: its Unix time is its time here.
    let csv = case.read("nav.csv").unwrap();
    let mut lines = csv.lines();
    assert!(lines.next().unwrap().ends_with(",unix_time_s"));
    let row = lines.next().unwrap().split(',');
    let row: Vec<f64> = row.map(|field| field.parse().unwrap()).collect();
    let first = row[0];
    assert!((row[31] - first).abs() < 1e-4, "{row:?}");
    let of_day = first - UNIX - 10.0;
    let clock = format!("00:{:02}:{:06.3}", (of_day / 60.0) as u32, of_day % 60.0);
    let utc = format!("2025-07-09T{clock}Z");
    says(
        &case.read("nav.gpx").unwrap(),
        &[&format!("<time>{utc}</time>")],
    );
    says(
        &case.read("nav.kml").unwrap(),
        &[&format!("<when>{utc}</when>")],
    );
    let nmea = case.read("nav.nmea").unwrap();
    let rmc: Vec<&str> = nmea.lines().next().unwrap().split(',').collect();
    let digits = clock.replace(':', "");
    assert_eq!((rmc[1], rmc[9]), (digits.as_str(), "090725"));
    let nav = case.read("nav.nav").unwrap();
    let of_week = nav.split_whitespace().take(2);
    let of_week: Vec<f64> = of_week.map(|field| field.parse().unwrap()).collect();
    assert_eq!(of_week[0], f64::from(WEEK.0));
    let second = first - UNIX + WEEK.1;
    assert!((of_week[1] - second).abs() < 1e-4, "{of_week:?}");
    let sbet = std::fs::read(case.path("nav.sbet")).unwrap();
    let of_sbet = f64::from_le_bytes(*sbet.first_chunk().unwrap());
    assert!((of_sbet - second).abs() < 1e-4, "{of_sbet}");
    // Read back by this program.
    for file in ["nav.gpx", "nav.nmea", "nav.mcap"] {
        assert_eq!(start_of(&case, file), utc, "{file}");
    }

    let html = case.run(&["report", "r.json", "-o", "r.html"]);
    assert!(html.succeeded(), "{}", html.stderr);
    let day = utc.replace('T', " ").replace('Z', " UTC");
    says(&case.read("r.html").unwrap(), &[&day]);
    let at = (UNIX + 50.0).to_string();
    let outages = case.outages(&["--length", "10", "--at", &at, "--track", "cuts.gpx"]);
    assert!(outages.succeeded(), "{}", outages.stderr);
    says(
        &case.read("cuts.gpx").unwrap(),
        &["<time>2025-07-08T23:59:50"],
    );
}

#[test]
fn without_a_date_nothing_claims_one_and_the_drive_file_can_state_it() {
    let mut log = Log::good();
    let case = log.write("dates_none");
    navigated(&case);
    assert!(result(&case)["drive"].get("start").is_none());
    for file in ["nav.gpx", "nav.kml", "nav.csv"] {
        let text = case.read(file).unwrap();
        for date in ["<time>", "<when>", "1970-", "1980-", "unix_time_s"] {
            assert!(!text.contains(date), "{date} in {file}");
        }
    }
    assert_eq!(start_of(&case, "nav.mcap"), Value::Null);
    let printed = case.run(&["navigate", "drive.toml"]).stdout;
    says(&printed, &["no date in the logs"]);

    log.drive = format!("epoch = \"2025-07-08T23:59:50Z\"\n{}", log.drive);
    let case = log.write("dates_stated");
    navigated(&case);
    let stated = result(&case);
    assert_eq!(stated["drive"]["start"]["utc"], "2025-07-08T23:59:50.020Z");
    says(&case.read("nav.gpx").unwrap(), &["<time>2025-07-09T00:"]);
    log.set("2025-07-08T23:59:50Z", "yesterday");
    let message = log.write("dates_wrong").refusal();
    says(
        &message,
        &["drive.toml line 1", "epoch", "yesterday", "week 2374"],
    );
}

#[test]
fn dates_of_imu_and_receiver_that_are_a_day_apart_are_refused() {
    let mut log = Log::good();
    later(&mut log.imu, UNIX);
    later(&mut log.truth, UNIX);
    later(&mut log.gnss, UNIX + 86_400.0);
    let message = log.write("dates_apart").refusal();
    says(
        &message,
        &[
            "GNSS begins at",
            "about 24 h apart",
            "add -86400 s to gnss.time_offset",
        ],
    );
}
