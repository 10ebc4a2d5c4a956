//! An inertial log whose times are wrong, unusual or too few: gaps, jumps, rates, units.

use super::drives::{TOWN_DURATION, good, is_sound, simulated};
use super::log::{Log, says};
use undrift::simulate::Trajectory;

#[test]
fn dropped_packets() {
    let mut log = good();
    let mut state = 1u32;
    // Three of ten, by a linear congruential generator.
    log.imu.retain(|_| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        state >> 16 > 19_660
    });
    let lost = TOWN_DURATION * 100.0 - log.imu.len() as f64;
    assert!((3900.0..4500.0).contains(&lost), "{lost}");
    let (outcome, _) = log.write("dropped").solution();
    says(
        &outcome.stderr,
        &["bridged 2620 short gaps between samples"],
    );
    is_sound(&outcome);
}

#[test]
fn a_gap_of_ten_seconds() {
    let mut log = good();
    log.imu.retain(|row| !(43.0..53.0).contains(&row.time));
    let (outcome, nav) = log.write("gap_10").solution();
    says(
        &outcome.stderr,
        &[
            "no samples for 10.0 s from 42.99 s",
            "do not trust the solution there",
        ],
    );
    assert!(nav.at(53.0, "yaw_std_deg") > 20.0);
    assert!(outcome.rms("horizontal_m") < 2.0, "{}", outcome.stdout);
}

#[test]
fn a_gap_of_an_hour_begins_anew() {
    let mut log = good();
    let later = |time: f64| if time < 43.0 { time } else { time + 3600.0 };
    for rows in [&mut log.imu, &mut log.gnss, &mut log.truth] {
        for row in rows {
            *row = row.at(later(row.time));
        }
    }
    // A fix in between, far from both ends, is of no use.
    let lost = log.gnss.iter().position(|row| row.time > 43.0).unwrap();
    let between = log.gnss[lost].at(1800.0);
    log.gnss.insert(lost, between);
    let (outcome, nav) = log.write("gap_hour").solution();
    says(
        &outcome.stderr,
        &[
            "no samples for 3600.0 s from 42.99 s",
            "for more than a minute",
        ],
    );
    // Nothing is given out for the hour, and what comes after is as good as after the first start.
    assert!(outcome.rms("horizontal_m") < 2.0, "{}", outcome.stdout);
    assert!(nav.len() < (TOWN_DURATION * 100.0) as usize + 2);
    assert!(nav.at(3600.0 + TOWN_DURATION - 1.0, "yaw_std_deg") < 3.0);
}

#[test]
fn stamps_that_jitter() {
    let mut log = good();
    for (k, row) in log.imu.iter_mut().enumerate() {
        let late = [0.0, 0.003, -0.002, 0.004][k % 4];
        *row = row.at(row.time + late);
    }
    let (outcome, _) = log.write("jitter").solution();
    is_sound(&outcome);
}

#[test]
fn stamps_of_whole_seconds() {
    let mut log = good();
    for row in &mut log.imu {
        *row = row.at(row.time.floor());
    }
    let case = log.write("whole_seconds");
    case.doubted(&["rows with a repeated time"]);
}

#[test]
fn milliseconds_called_seconds() {
    let mut log = good();
    for row in &mut log.imu {
        *row = row.at(1000.0 * row.time);
    }
    let message = log.write("ms_imu").refusal();
    says(
        &message,
        &[
            "imu.csv: 0.1 Hz is too slow for an IMU",
            "set imu.time_unit = \"ms\"",
        ],
    );
    // And the right unit mends it.
    log.set("time = \"t\"", "time = \"t\"\ntime_unit = \"ms\"");
    is_sound(&log.write("ms_imu_stated").solution().0);
    // Seconds called nanoseconds are the other way round.
    let mut log = good();
    log.set("time = \"t\"", "time = \"t\"\ntime_unit = \"ns\"");
    says(
        &log.write("s_imu").refusal(),
        &["is too fast for an IMU; correct imu.time_unit"],
    );
}

#[test]
fn slow_and_fast_imus() {
    for (rate, duration) in [(10.0, 140.0), (1000.0, 140.0)] {
        let log = Log::of(&simulated(Trajectory::rest(0.0).start, rate, 2.0));
        assert_eq!(log.imu.len() as f64, rate * duration);
        let (outcome, _) = log.write(&format!("imu_{rate}_hz")).solution();
        assert_eq!(outcome.stderr, "");
        is_sound(&outcome);
    }
}

#[test]
fn a_rate_that_changes_within_the_log() {
    let mut log = good();
    let mut k = 0;
    // Every fifth sample from the middle on: mean rates are not what is sampled, so a gap each.
    log.imu.retain(|row| {
        k += 1;
        row.time < 70.0 || k % 5 == 0
    });
    let (outcome, _) = log.write("rate_changes").solution();
    says(
        &outcome.stderr,
        &["bridged 1400 short gaps between samples"],
    );
    assert!(outcome.rms("horizontal_m") < 1.0, "{}", outcome.stdout);
}

#[test]
fn a_clock_of_the_imu_that_jumps() {
    // Five seconds ahead: a gap, and the fixes no longer fit.
    let mut log = good();
    for row in log.imu.iter_mut().filter(|row| row.time > 60.0) {
        *row = row.at(row.time + 5.0);
    }
    let warnings = log
        .write("imu_ahead")
        .doubted(&["no samples for 5.0 s from 60 s"]);
    says(&warnings.join("\n"), &["rejected "]);
    // A leap second back: the second that is there twice is left out.
    let mut log = good();
    for row in log.imu.iter_mut().filter(|row| row.time > 60.0) {
        *row = row.at(row.time - 1.0);
    }
    log.write("imu_leap")
        .doubted(&["99 rows with a time before the previous one"]);
}

#[test]
fn the_end_of_the_week_and_midnight() {
    for (name, length) in [("week_end", 604_800.0), ("midnight", 86_400.0)] {
        let mut log = good();
        for row in log
            .imu
            .iter_mut()
            .chain(&mut log.gnss)
            .chain(&mut log.truth)
        {
            *row = row.at((row.time + length - 70.0) % length);
        }
        let (outcome, nav) = log.write(name).solution();
        is_sound(&outcome);
        // Counted on past the end.
        assert!(nav.at(length + 60.0, "lat_deg").is_finite(), "{name}");
    }
}

#[test]
fn no_motion_to_align_with() {
    let mut log = good();
    log.imu.retain(|row| row.time < 15.0);
    log.gnss.retain(|row| row.time < 15.0);
    let message = log.write("no_motion").refusal();
    says(
        &message,
        &["the vehicle never moved (at most 0.1 m/s)", "set initial."],
    );
}

#[test]
fn one_and_two_samples() {
    for (count, words) in [(1, "only one row of data"), (2, "do not overlap")] {
        let mut log = good();
        log.imu.truncate(count);
        says(&log.write(&format!("samples_{count}")).refusal(), &[words]);
    }
}

#[test]
fn samples_in_disorder() {
    let mut log = good();
    log.imu.reverse();
    let message = log.write("reversed").refusal();
    says(
        &message,
        &[
            "imu.csv: the rows are in reverse order (140 s in line 2, then 139.99 s)",
            "sort them by time",
        ],
    );
}
