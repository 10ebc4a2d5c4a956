//! Damaged and unusual logs.

use super::log::{Case, DURATION, Log, says, table};
use std::io::Write;

/// Horizontal RMS error that a sound solution of the drive stays below [m]: the fixes have 0.5 m an
/// axis, the filter 0.2 m.
const SOUND: f64 = 0.5;
/// The same where only positions show how late they are: a tenth of a second is expected, at 10 m/s.
const LATE: f64 = 0.7;

#[test]
fn a_good_log_is_navigated_without_complaint() {
    let (outcome, nav) = Log::good().write("good").solution();
    assert_eq!(outcome.stderr, "");
    assert!(outcome.rms("horizontal_m") < SOUND, "{}", outcome.stdout);
    assert!(nav.len() > 2500, "{}", nav.len());
}

#[test]
fn position_only_and_velocity_only() {
    for (part, most) in [("position", LATE), ("velocity", 3.0)] {
        let mut log = Log::good();
        log.set("[truth]", &format!("use = \"{part}\"\n[truth]"));
        let (outcome, _) = log.write(&format!("use_{part}")).solution();
        assert_eq!(outcome.stderr, "");
        says(
            &outcome.stdout,
            &[&format!("\n{part}: NIS per degree of freedom")],
        );
        let error = outcome.rms("horizontal_m");
        assert!(error < most, "{part} {error}");
    }
}

#[test]
fn rows_with_nan_infinity_and_text_are_skipped_and_counted() {
    let mut log = Log::good();
    log.imu[1400].fields[2] = "NaN".into();
    log.imu[1500].fields[5] = "inf".into();
    log.imu[2000].fields[6] = "-Infinity".into();
    log.imu[2500].fields[1] = "oops".into();
    log.imu[2600].fields[3] = String::new();
    log.gnss[100].fields[2] = "nan".into();
    log.gnss[110].fields[4] = "fast".into();
    let (outcome, _) = log.write("not_finite").solution();
    says(
        &outcome.stderr,
        &[
            "IMU log: 1 row with text where a number belongs, at line 2502: \"oops\"",
            "3 rows with NaN or infinity, first at line 1402",
            "1 row with a missing field, at line 2602",
            "GNSS log: 1 row with text where a number belongs, at line 112",
            "1 row with NaN or infinity, at line 102",
            "bridged 5 short gaps between samples",
        ],
    );
    assert!(outcome.rms("horizontal_m") < SOUND, "{}", outcome.stdout);
}

#[test]
fn one_row_back_in_time_and_duplicates_are_skipped() {
    let mut log = Log::good();
    log.imu[1400] = log.imu[1400].at(3.0);
    let row = log.imu[2000].clone();
    log.imu.insert(2000, row);
    let fix = log.gnss[60].clone();
    log.gnss.insert(60, fix);
    let (outcome, _) = log.write("disorder").solution();
    says(
        &outcome.stderr,
        &[
            "1 row with a time before the previous one, at line 1402: 3 s after 28 s",
            "1 row with a repeated time, at line 2003: 40.02 s",
            "GNSS log: 1 row with a repeated time, at line 63",
            "bridged 1 short gap between samples",
        ],
    );
    assert!(outcome.rms("horizontal_m") < SOUND, "{}", outcome.stdout);
}

#[test]
fn a_clock_set_back_for_good_is_refused() {
    let mut log = Log::good();
    let from = log.imu_at(50.0);
    for row in &mut log.imu[from..] {
        *row = row.at(row.time - 40.0);
    }
    let message = log.write("set_back").refusal();
    says(
        &message,
        &[
            "imu.csv line 2501: time jumps back by 39.980 s, from 49.98 s to 10 s",
            "split the file",
        ],
    );

    let mut log = Log::good();
    for row in &mut log.gnss[100..] {
        *row = row.at(row.time - 40.0);
    }
    let message = log.write("gnss_set_back").refusal();
    says(
        &message,
        &["gnss.csv line 102: time jumps back by 39.500 s"],
    );

    // One stamp far ahead: all rows after it are behind.
    let mut log = Log::good();
    log.imu[1000] = log.imu[1000].at(9e8);
    let message = log.write("ahead").refusal();
    says(
        &message,
        &[
            "imu.csv line 1003: time jumps back",
            "remove the earlier rows with wrong times",
        ],
    );
}

#[test]
fn short_gaps_are_bridged_and_counted() {
    let mut log = Log::good();
    for time in [60.0, 40.0] {
        let from = log.imu_at(time);
        log.imu.drain(from..from + 5);
    }
    let (outcome, _) = log.write("short_gaps").solution();
    assert_eq!(
        outcome.stderr,
        "warning: bridged 2 short gaps between samples\n"
    );
    assert!(outcome.rms("horizontal_m") < SOUND, "{}", outcome.stdout);
    assert!(outcome.rms("yaw_deg") < 1.0, "{}", outcome.stdout);
}

#[test]
fn short_gaps_of_increments_are_bridged_as_those_of_rates() {
    let mut log = Log::good();
    log.set("\"rad/s\"", "\"rad\"").set("\"m/s^2\"", "\"m/s\"");
    log.set("time = \"t\"", "time = \"t\"\ndata = \"increments\"");
    for row in &mut log.imu {
        for field in &mut row.fields[1..] {
            let value: f64 = field.parse().unwrap();
            *field = format!("{:.12e}", value * 0.02);
        }
    }
    // Ten gaps of 0.1 s: a lost tenth of gravity each would be 4 m/s down by the end.
    for k in (0..10).rev() {
        let from = log.imu_at(40.0 + 3.0 * f64::from(k));
        log.imu.drain(from..from + 5);
    }
    let (outcome, _) = log.write("increments").solution();
    assert_eq!(
        outcome.stderr,
        "warning: bridged 10 short gaps between samples\n"
    );
    assert!(outcome.rms("horizontal_m") < SOUND, "{}", outcome.stdout);
    assert!(outcome.rms("vd_mps") < 0.05, "{}", outcome.stdout);

    let text = log.drive.clone();
    log.set(
        "data = \"increments\"",
        "data = \"increments\"\nrate = \"100 Hz\"",
    );
    let message = log.write("increments_rate").refusal();
    says(
        &message,
        &[
            "imu.csv line 102: 100 consecutive increments 0.0200 s apart at a rate of 100.00 Hz",
            "(key imu.rate); correct the rate",
        ],
    );
    log.drive = text;
    for row in log.imu.iter_mut().skip(2000) {
        *row = row.at(3.0 * row.time - 80.0);
    }
    let message = log.write("increments_slower").refusal();
    says(
        &message,
        &[
            "imu.csv line 21",
            "imu.rate",
            "split the file where the rate changes",
        ],
    );
}

#[test]
fn a_long_gap_is_reported_and_grows_the_covariance() {
    let mut log = Log::good();
    let (from, to) = (log.imu_at(50.0), log.imu_at(55.0));
    log.imu.drain(from..to);
    log.gnss.retain(|row| row.time <= 49.9 || row.time >= 56.9);
    let (outcome, nav) = log.write("long_gap").solution();
    says(
        &outcome.stderr,
        &["no samples for 5.0 s from 49.98 s; do not trust the solution there"],
    );
    for (column, least) in [
        ("north_std_m", 10.0),
        ("vn_std_mps", 5.0),
        ("yaw_std_deg", 10.0),
    ] {
        let (before, after) = (nav.at(49.98, column), nav.at(55.0, column));
        assert!(
            after > least && after > 5.0 * before,
            "{column} {before} {after}"
        );
    }
    assert!(nav.at(70.0, "north_std_m") < 1.0);
}

#[test]
fn fixes_inside_a_long_gap_count_at_their_own_time() {
    let mut log = Log::good();
    let (from, to) = (log.imu_at(50.0), log.imu_at(55.1));
    log.imu.drain(from..to);
    let (outcome, nav) = log.write("gap_with_fixes").solution();
    says(&outcome.stderr, &["no samples for 5.1 s from 49.98 s"]);
    // At 15 m/s a fix taken at the gap's end would be wrong by up to 75 m.
    assert!(outcome.rms("horizontal_m") < SOUND, "{}", outcome.stdout);
    assert!(
        !outcome.stderr.contains("innovations"),
        "{}",
        outcome.stderr
    );
    assert!(nav.at(55.1, "vn_std_mps") > 0.1);
}

#[test]
fn gnss_that_ends_early_is_reported() {
    let mut log = Log::good();
    log.gnss.retain(|row| row.time < 50.2);
    let (outcome, nav) = log.write("gnss_ends").solution();
    says(
        &outcome.stderr,
        &["longest span without a usable fix: 30.0 s from 50 s"],
    );
    assert!(nav.at(DURATION, "north_std_m") > 3.0 * nav.at(50.0, "north_std_m"));
}

#[test]
fn gnss_beside_the_samples_is_refused() {
    for (name, shift) in [("gnss_before", -1000.0), ("gnss_after", 1000.0)] {
        let mut log = Log::good();
        for row in &mut log.gnss {
            *row = row.at(row.time + shift);
        }
        let case = log.write(name);
        let from = format!("GNSS ({} to", 1.0 + shift);
        let message = case.refusal();
        says(
            &message,
            &[
                "the IMU (0.02 to 80 s) and GNSS (",
                "do not overlap: check both time columns",
                &from,
            ],
        );
        let outcome = case.outages(&["--count", "2", "--start", "40", "--length", "5"]);
        assert_eq!(outcome.code, Some(1));
    }
}

#[test]
fn a_truth_beside_the_solution_is_said() {
    for (name, shift) in [("truth_before", -1000.0), ("truth_after", 1000.0)] {
        let mut log = Log::good();
        for row in &mut log.truth {
            *row = row.at(row.time + shift);
        }
        let case = log.write(name);
        let (outcome, _) = case.solution();
        says(
            &outcome.stderr,
            &[
                "the truth does not overlap the solution",
                "truth.time_offset",
            ],
        );
        assert!(!outcome.stdout.contains("RMS error"), "{}", outcome.stdout);
        let outcome = case.outages(&["--count", "2", "--start", "40", "--length", "5"]);
        assert_eq!(outcome.code, Some(1));
        says(
            &outcome.stderr,
            &["the truth covers", "not the outage from", "omit the truth"],
        );
    }
}

#[test]
fn empty_files_and_headers_without_rows_are_refused() {
    for (file, name) in [
        ("imu.csv", "empty_imu"),
        ("gnss.csv", "empty_gnss"),
        ("truth.csv", "empty_truth"),
    ] {
        let case = Log::good().write(name);
        case.put(file, b"");
        says(&case.refusal(), &[file, "is empty (0 bytes)"]);
        let header = if file == "imu.csv" {
            "t,gx,gy,gz,fx,fy,fz\n"
        } else {
            "t,lat,lon,height,vn,ve,vd,sn,se,sd,roll,pitch,yaw\n"
        };
        case.put(file, header.as_bytes());
        let message = case.refusal();
        says(&message, &[&format!("error: {file}"), "no "]);
    }
    let mut log = Log::good();
    log.imu.truncate(1);
    says(
        &log.write("one_sample").refusal(),
        &["imu.csv: only one row of data"],
    );
}

#[test]
fn a_truncated_gzip_file_is_read_up_to_its_end_and_said_to_break_off() {
    let mut log = Log::good();
    log.set("imu.csv", "imu.csv.gz");
    let text = table("t,gx,gy,gz,fx,fy,fz", &log.imu);
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(text.as_bytes()).unwrap();
    let whole = encoder.finish().unwrap();
    let case = log.write("gzip");
    case.put("imu.csv.gz", &whole);
    let (outcome, full) = case.solution();
    assert_eq!(outcome.stderr, "");
    case.put("imu.csv.gz", &whole[..whole.len() * 3 / 4]);
    let (outcome, part) = case.solution();
    says(&outcome.stderr, &["IMU log: file ends early, after line"]);
    assert!(part.len() < full.len() && part.len() > full.len() / 2);
    // Nothing but the first bytes.
    case.put("imu.csv.gz", &whole[..8]);
    let (outcome, _) = case.navigate();
    assert_eq!(outcome.code, Some(1));
    says(&outcome.stderr, &["imu.csv.gz"]);
}

#[test]
fn unusable_standard_deviations_leave_their_position_out() {
    let mut log = Log::good();
    log.gnss[80].fields[7] = "0".into();
    log.gnss[90].fields[8] = "-1".into();
    let (outcome, _) = log.write("std").solution();
    says(
        &outcome.stderr,
        &["GNSS log: 2 values with an unusable standard deviation, first at line 82: 0, 0.5, 1"],
    );
    for row in &mut log.gnss {
        row.fields[7] = "0".into();
    }
    let message = log.write("std_all").refusal();
    says(
        &message,
        &[
            "no fix within the inertial log has a usable position",
            "159 values with an unusable standard deviation",
        ],
    );
}

#[test]
fn positions_that_are_none_are_left_out() {
    let mut log = Log::good();
    log.gnss[80].fields[1] = "95.0".into();
    log.gnss[90].fields[1] = "0".into();
    log.gnss[90].fields[2] = "0".into();
    let (outcome, _) = log.write("latitude").solution();
    says(
        &outcome.stderr,
        &["GNSS log: 2 rows with a value out of range, first at line 82: 95,"],
    );
    assert!(outcome.rms("horizontal_m") < SOUND, "{}", outcome.stdout);
    for row in &mut log.gnss {
        row.fields[1] = "95.0".into();
    }
    let message = log.write("latitude_all").refusal();
    says(
        &message,
        &[
            "gnss.csv: no usable fix",
            "159 rows with a value out of range",
        ],
    );
}

#[test]
fn a_log_that_cannot_be_aligned_says_why_and_what_to_set() {
    let mut log = Log::good();
    let (imu, gnss) = (log.imu_at(19.0), 30);
    log.imu.truncate(imu);
    log.gnss.truncate(gnss);
    let message = log.write("never_moves").refusal();
    says(
        &message,
        &[
            "the vehicle never moved (at most 0.1 m/s)",
            "so its heading is unknown",
            "set initial.heading",
        ],
    );
    // Already moving, and shaken so that no span is level.
    let mut log = Log::good();
    let from = log.imu_at(30.0);
    log.imu.drain(..from);
    for (k, row) in log.imu.iter_mut().enumerate() {
        row.fields[4] = format!("{}", 5.0 * (k as f64 / 40.0).sin());
    }
    let message = log.write("no_rest").refusal();
    says(
        &message,
        &["the log could not be aligned", "set initial.attitude"],
    );
}

#[test]
fn fixes_of_another_place_are_said_to_disagree() {
    // Half a kilometre north, from 60 s on or in the last three seconds only.
    let jump = (
        "warning: the positions of the fixes jump by 55",
        " at ",
        ' ',
    );
    let rejected = ("warning: rejected ", " positions, ", '-');
    for (name, from, (start, before, behind)) in [
        ("street", 60.0, jump),
        ("street_at_the_end", 77.2, rejected),
    ] {
        let mut log = Log::good();
        for row in log.gnss.iter_mut().filter(|row| row.time > from) {
            let latitude: f64 = row.fields[1].parse().unwrap();
            row.fields[1] = format!("{:.9}", latitude + 0.005);
        }
        let (outcome, _) = log.write(name).solution();
        let line = outcome.stderr.lines().find(|l| l.starts_with(start));
        let line = line.unwrap_or_else(|| panic!("{name}: {}", outcome.stderr));
        let times = line.split_once(before).unwrap().1;
        let time: f64 = times.split(behind).next().unwrap().parse().unwrap();
        assert!(time > from && time <= from + 0.5, "{name}: {time}");
    }
    // Shanghai instead of Wuhan.
    for (name, from, said) in [
        ("city", 60.0, "the positions of the fixes jump by 675"),
        ("city_at_the_end", 77.2, "(error "),
    ] {
        let mut log = Log::good();
        for row in log.gnss.iter_mut().filter(|row| row.time > from) {
            row.fields[1] = "31.2".into();
            row.fields[2] = "121.5".into();
        }
        let (outcome, _) = log.write(name).solution();
        says(&outcome.stderr, &[said]);
    }
}

/// Writes 1 s of absurd samples into a log.
fn absurd(name: &str, value: &str) -> Case {
    let mut log = Log::good();
    for row in &mut log.imu[2500..2600] {
        row.fields[1] = value.into();
        row.fields[4] = value.into();
    }
    log.write(name)
}

#[test]
fn absurd_samples_are_replaced_and_said() {
    let (outcome, nav) = absurd("large", "1e9").navigate();
    assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
    says(
        &outcome.stderr,
        &[
            "gyro x stays at 1000000000 (as logged) for 1.98 s from 50.02 s",
            "saturated",
        ],
    );
    let nav = nav.unwrap();
    assert!(nav.at(49.9, "north_std_m") < 1.0);
    // What the axes may have missed is in the covariance.
    assert!(nav.at(51.9, "roll_std_deg") > 5.0 * nav.at(49.9, "roll_std_deg"));
    assert!(outcome.rms("horizontal_m") < 1.0);
}

#[test]
fn samples_that_no_sensor_can_have_are_left_out() {
    let (outcome, nav) = absurd("huge", "1e300").navigate();
    assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
    says(
        &outcome.stderr,
        &[
            "100 rows with a value out of range",
            "no samples for 2.0 s from 50 s",
        ],
    );
    assert!(nav.unwrap().at(60.0, "north_std_m") < 1.0);
}
