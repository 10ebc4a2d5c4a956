//! Fixes that are wrong: columns, units, signs, standard deviations, time bases, and too few of them.

use super::drives::{TOWN_RATE, good, is_sound};
use super::log::{Log, Row, says};

/// The town drive with every fix changed.
fn changed(change: impl Fn(&mut Row)) -> Log {
    let mut log = good();
    log.gnss.iter_mut().for_each(change);
    log
}

/// The town drive with every velocity changed: north, east, down.
fn velocities(change: impl Fn([f64; 3]) -> [f64; 3]) -> Log {
    changed(|row| row.put(4, &change(std::array::from_fn(|k| row.number(4 + k)))))
}

/// The town drive with the stamps of the fixes moved [s].
fn late(by: f64) -> Log {
    changed(|row| *row = row.at(row.time + by))
}

const COLUMNS: &str = "check that the columns are latitude, longitude, height in gnss.position_unit, not ECEF or degrees and minutes";

#[test]
fn latitude_and_longitude_swapped() {
    let message = changed(|row| row.fields.swap(1, 2))
        .write("lat_lon")
        .refusal();
    says(
        &message,
        &[
            "gnss.csv: latitude and longitude are exchanged (line 2: 114.47, 30.44)",
            "list the latitude first in gnss.position",
        ],
    );
    // Where both are latitudes, the velocities tell.
    let log = changed(|row| {
        let longitude = row.number(2) - 60.0;
        row.put(2, &[longitude]);
        row.fields.swap(1, 2);
    });
    log.write("lat_lon_valid")
        .doubted(&["latitude and longitude are exchanged"]);
}

#[test]
fn cartesian_positions() {
    let log = changed(|row| {
        let place = undrift::nav::earth::Geodetic::from_degrees(
            row.number(1),
            row.number(2),
            row.number(3),
        );
        let xyz = place.to_ecef();
        row.put(1, &[xyz.x, xyz.y, xyz.z]);
    });
    says(
        &log.write("ecef").refusal(),
        &["gnss.csv: no usable fix (key gnss.position)", COLUMNS],
    );
}

#[test]
fn degrees_and_minutes() {
    let log = changed(|row| {
        let packed = |x: f64| 100.0 * x.trunc() + 60.0 * x.fract();
        row.put(1, &[packed(row.number(1)), packed(row.number(2))]);
    });
    says(
        &log.write("ddmm").refusal(),
        &[
            "latitude and longitude are degrees and minutes, ddmm.mmmm",
            "set gnss.position_unit = \"ddmm.mmmm\"",
        ],
    );
}

#[test]
fn degrees_times_ten_million() {
    let log = changed(|row| row.put(1, &[row.number(1) * 1e7, row.number(2) * 1e7]));
    says(
        &log.write("e7").refusal(),
        &[
            "latitude and longitude are in 1e-7 deg",
            "set gnss.position_unit = \"LSB/1e7 deg\"",
        ],
    );
}

/// Within 9 deg of the equator and 18 of Greenwich they may be of 1e-7, too.
#[test]
fn degrees_times_a_million() {
    let log = changed(|row| row.put(1, &[row.number(1) * 1e6, row.number(2) * 1e6]));
    says(
        &log.write("e6").refusal(),
        &["latitude and longitude are in 1e-6 or 1e-7 deg"],
    );
}

#[test]
fn radians_called_degrees() {
    changed(|row| row.put(1, &[row.number(1).to_radians(), row.number(2).to_radians()]))
        .write("radians")
        .doubted(&["latitude and longitude are in rad, not deg"]);
}

#[test]
fn longitudes_from_0_to_360() {
    // 244.47° east is 115.53° west.
    let moved =
        |by: f64| changed(|row| row.put(2, &[row.number(2) + by])).write(&format!("lon_{by}"));
    let (_, nav) = moved(130.0).solution();
    assert!(
        (nav.at(100.0, "lon_deg") + 115.53).abs() < 0.01,
        "{}",
        nav.at(100.0, "lon_deg")
    );
    // Beyond a full turn it is invalid.
    says(
        &moved(360.0).refusal(),
        &["gnss.csv: no usable fix", "474.46"],
    );
}

#[test]
fn height_with_the_wrong_sign() {
    // On level ground it is a height like another, and only its value is wrong.
    let (outcome, nav) = changed(|row| row.put(3, &[-row.number(3)]))
        .write("depth")
        .solution();
    assert!(outcome.rms("horizontal_m") < 0.5);
    assert!((nav.at(100.0, "height_m") + 20.0).abs() < 3.0);
    // On a slope it contradicts the velocity: five metres a second up, said to go down.
    let mut log = good();
    for row in log.gnss.iter_mut().chain(&mut log.truth) {
        let up = (0.5 * (row.time - 60.0)).clamp(0.0, 20.0);
        row.put(3, &[-(row.number(3) + up)]);
        row.put(
            6,
            &[row.number(6) - if up > 0.0 && up < 20.0 { 0.5 } else { 0.0 }],
        );
    }
    let (outcome, _) = log.write("depth_on_a_slope").solution();
    assert!(!outcome.stderr.is_empty());
}

#[test]
fn velocity_east_north_up() {
    velocities(|[n, e, d]| [e, n, -d])
        .write("enu")
        .doubted(&["the GNSS velocity is east, north, not north, east"]);
}

#[test]
fn velocity_with_the_wrong_sign() {
    velocities(|[n, e, d]| [n, -e, d])
        .write("west")
        .doubted(&["the GNSS velocity east (or the longitude) has the wrong sign"]);
    velocities(|[n, e, d]| [-n, -e, d])
        .write("backward")
        .doubted(&["the GNSS velocity has the wrong signs"]);
}

#[test]
fn velocity_in_another_unit() {
    for (name, factor, unit) in [
        ("kmh", 3.6, "km/h"),
        ("knots", 1.943_844, "knots"),
        ("cms", 100.0, "cm/s"),
    ] {
        let log = velocities(|v| v.map(|v| v * factor));
        let outcome = log.write(name).run(&["navigate", "drive.toml", "--strict"]);
        assert!(
            matches!(outcome.code, Some(1 | 3)),
            "{unit} {}",
            outcome.stderr
        );
        says(
            &outcome.stderr,
            &[&format!("the GNSS velocity is in {unit}")],
        );
    }
}

#[test]
fn a_velocity_that_is_always_zero() {
    let message = velocities(|_| [0.0; 3]).write("still").refusal();
    says(
        &message,
        &[
            "could not be aligned: by the GNSS velocity the vehicle never moved",
            "GNSS positions and velocities disagree",
        ],
    );
}

#[test]
fn standard_deviations_in_another_unit() {
    // In km, called m.
    changed(|row| row.put(7, &[0.0005, 0.0005, 0.001]))
        .write("std_km")
        .doubted(&["positions scatter 99"]);
    // In mm: the positions hardly count, and that is said.
    let (outcome, _) = changed(|row| row.put(7, &[500.0, 500.0, 1000.0]))
        .write("std_mm")
        .solution();
    says(
        &outcome.stderr,
        &[
            "stated position standard deviations",
            "times too large",
            "position_std_factor",
        ],
    );
}

#[test]
fn standard_deviations_that_are_none() {
    for value in ["0", "nan", "-1", "inf", "1e-200"] {
        let log = changed(|row| row.fields[7..10].fill(value.into()));
        let message = log.write(&format!("std_{value}")).refusal();
        says(
            &message,
            &[
                "no fix within the inertial log has a usable position",
                "279 values with an unusable standard deviation, first at line 2",
            ],
        );
    }
}

#[test]
fn standard_deviations_beyond_all_measure() {
    for (value, said) in [("1e30", "diverge"), ("1e-9", "positions scatter ")] {
        let log = changed(|row| row.fields[7..10].fill(value.into()));
        let case = log.write(&format!("std_{value}"));
        let (outcome, _) = case.navigate();
        assert!(
            outcome.code == Some(1) || !outcome.stderr.is_empty(),
            "{value}"
        );
        says(&outcome.stderr, &[said]);
    }
}

#[test]
fn utc_and_gps_time_mixed() {
    for by in [18.0, -18.0] {
        let warnings = late(by).write(&format!("leap_{by}")).doubted(&[
            "GNSS is stamped 18.",
            &format!("add {:.2} s to gnss.time_offset", -by),
            "GPS time and UTC are mixed",
        ]);
        assert!(
            !warnings.iter().any(|w| w.contains("std_factor")),
            "{warnings:?}"
        );
    }
    // What is proposed mends it.
    let mut log = late(18.0);
    log.set("[truth]", "time_offset = \"-18.00 s\"\n[truth]");
    is_sound(&log.write("leap_mended").solution().0);
}

#[test]
fn a_second_late() {
    late(1.0)
        .write("second_late")
        .doubted(&["GNSS is stamped 1.00 s too late"]);
}

#[test]
fn a_tenth_of_a_second_late() {
    // Below what turns show from second to second: it is estimated.
    let (outcome, _) = late(0.1).write("tenth_late").solution();
    assert_eq!(outcome.stderr, "");
    says(
        &outcome.stdout,
        &[
            "time offset of the positions (true less stamped): -",
            "time offset of the velocities (true less stamped): -",
        ],
    );
    assert!(outcome.rms("horizontal_m") < 1.0);
}

#[test]
fn another_week_or_day() {
    for (by, apart) in [
        (604_800.0, "do not overlap: check both time columns"),
        (-86_400.0, "about 24 h apart (time zone?); add 86400 s"),
    ] {
        let message = late(by).write(&format!("week_{by}")).refusal();
        says(&message, &[apart, "gnss.time_offset"]);
    }
}

#[test]
fn milliseconds_called_seconds() {
    let message = changed(|row| *row = row.at(1000.0 * row.time))
        .write("ms_gnss")
        .refusal();
    says(
        &message,
        &["GNSS (1000 to 140000 s)", "set gnss.time_unit = \"ms\""],
    );
}

#[test]
fn a_leap_second_within_the_log() {
    let log = changed(|row| {
        if row.time > 60.0 {
            *row = row.at(row.time - 1.0);
        }
    });
    let warnings = log.write("gnss_leap").doubted(&["rejected "]);
    says(
        &warnings.join("\n"),
        &["GNSS log: 1 row with a time before the previous one"],
    );
}

#[test]
fn a_receiver_that_repeats_itself() {
    let mut log = good();
    let frozen = log.gnss[119].clone();
    for row in log.gnss.iter_mut().filter(|row| row.time > 60.0) {
        *row = frozen.at(row.time);
    }
    log.write("repeats")
        .doubted(&["the receiver repeated its fix while the solution moved"]);
}

#[test]
fn too_few_fixes() {
    for (count, words) in [(1, "could not be aligned"), (2, "could not be aligned")] {
        let mut log = good();
        log.gnss = log.gnss[60..60 + count].to_vec();
        let message = log.write(&format!("fixes_{count}")).refusal();
        says(
            &message,
            &[
                words,
                "alignment in motion needs more consecutive fixes",
                "initial.attitude",
            ],
        );
        assert!(!message.contains("the speed never reached"), "{message}");
    }
    let mut log = good();
    log.gnss.clear();
    says(
        &log.write("fixes_0").refusal(),
        &["gnss.csv: no data, only a header"],
    );
}

#[test]
fn a_receiver_without_a_fix() {
    let message = changed(|row| row.put(1, &[0.0, 0.0]))
        .write("no_fix")
        .refusal();
    says(
        &message,
        &[
            "gnss.csv: the receiver never had a fix",
            "279 rows such as line 2: 0, 0",
        ],
    );
}

#[test]
fn gnss_before_and_after_the_imu() {
    let mut log = good();
    log.imu.retain(|row| (5.0..120.0).contains(&row.time));
    let (outcome, nav) = log.write("gnss_around").solution();
    assert_eq!(outcome.stderr, "");
    is_sound(&outcome);
    assert!(nav.len() as f64 > 100.0 * TOWN_RATE);
}

#[test]
fn the_imu_starts_in_motion() {
    let mut log = good();
    log.imu.retain(|row| row.time > 40.0);
    let (outcome, _) = log.write("imu_late").solution();
    is_sound(&outcome);
}

#[test]
fn fixes_far_apart() {
    let mut log = good();
    log.gnss = log.gnss.into_iter().step_by(60).collect();
    let (outcome, nav) = log.write("sparse").solution();
    says(
        &outcome.stderr,
        &["longest span without a usable fix: 30.0 s"],
    );
    assert!(nav.at(60.5, "north_std_m") > 1.0);
    assert!(outcome.rms("horizontal_m") < 10.0);
}

#[test]
fn fixes_twenty_times_a_second() {
    let start = undrift::simulate::Trajectory::rest(0.0).start;
    let log = Log::of(&super::drives::simulated(start, TOWN_RATE, 20.0));
    let (outcome, _) = log.write("gnss_20_hz").solution();
    assert_eq!(outcome.stderr, "");
    is_sound(&outcome);
}

/// RINEX files beside the fixes: absent, no list, without one of the two kinds, of another time.
#[test]
fn observations_beside_the_fixes() {
    let golden = concat!(env!("CARGO_MANIFEST_DIR"), "/../../testdata/golden/rinex/");
    let refused = |name: &str, list: &str| {
        let mut log = good();
        let table = format!("[gnss]\nobservations = {list}\n");
        log.drive = log.drive.replacen("[gnss]\n", &table, 1);
        let case = log.write(name);
        for file in ["three.obs", "three.nav"] {
            case.put(file, &std::fs::read(format!("{golden}{file}")).unwrap());
        }
        case.refusal()
    };
    let gone = refused("rinex_gone", "[\"gone.obs\", \"three.nav\"]");
    says(&gone, &["gone.obs"]);
    let text = refused("rinex_text", "\"three.obs\"");
    says(&text, &["observations", "must be a list of strings"]);
    let alone = refused("rinex_alone", "[\"three.obs\"]");
    says(
        &alone,
        &["no navigation file", "[\"rover.obs\", \"rover.nav\"]"],
    );
    let log = refused("rinex_log", "[\"gnss.csv\", \"three.nav\"]");
    says(&log, &["gnss.csv: is no RINEX file"]);
    let other = refused("rinex_other", "[\"three.obs\", \"three.nav\"]");
    says(&other, &["no observations at the times of the fixes"]);
}
