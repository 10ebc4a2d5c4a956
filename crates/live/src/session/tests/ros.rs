//! Topics of ROS 2 as they come.

use super::*;
use undrift_io::write::mcap::Stream;

const TOPICS: &str = r#"
model = "mpu6050"
[imu]
file = "ros2:/imu"
format = "mcap"
[gnss]
file = "ros2:/fix"
format = "mcap"
lever_arm = "0, 0, 0 m"
"#;
/// Unix time of the drive's time 0 \[s\].
const ZERO: f64 = 1_764_400_000.0;

/// A message with its encapsulation and header: what follows begins after 13 bytes.
pub(super) fn begun(time: f64) -> Vec<u8> {
    let (seconds, part) = ((ZERO + time).div_euclid(1.0), (ZERO + time).rem_euclid(1.0));
    let mut bytes = vec![0, 1, 0, 0];
    bytes.extend((seconds as i32).to_le_bytes());
    bytes.extend(((part * 1e3).round() as u32 * 1_000_000).to_le_bytes());
    bytes.extend([1, 0, 0, 0, 0]);
    bytes
}

pub(super) fn numbers(bytes: &mut Vec<u8>, values: &[f64]) {
    bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
}

/// What comes of a drive, the stamps of the samples as `stamp` makes them.
fn topics(log: &undrift_simulate::Simulation, stamp: impl Fn(f64) -> f64) -> Vec<Arrival> {
    let declared = |topic, type_name| [Stream::head(), Stream::default().topic(topic, type_name).1];
    let mut parts = vec![
        (0.0, 0, declared("/imu", "sensor_msgs/msg/Imu").concat()),
        (
            0.0,
            1,
            declared("/fix", "sensor_msgs/msg/NavSatFix").concat(),
        ),
    ];
    for sample in &log.imu {
        let mut bytes = begun(stamp(sample.time));
        bytes.extend([0; 3]);
        numbers(&mut bytes, &[0.0; 13]);
        for vector in [sample.dtheta / sample.dt, sample.dvel / sample.dt] {
            numbers(&mut bytes, vector.as_slice());
            numbers(&mut bytes, &[0.0; 9]);
        }
        parts.push((sample.time, 0, Stream::message(0, 1, &bytes)));
    }
    for fix in &log.gnss {
        let Some((undrift_nav::sample::Position::Geodetic(place), _)) = fix.position else {
            continue;
        };
        let mut bytes = begun(fix.time);
        // Status 0, service 1.
        bytes.extend([0, 1, 0]);
        let [lat, lon] = [place.lat, place.lon].map(f64::to_degrees);
        numbers(&mut bytes, &[lat, lon, place.height]);
        numbers(&mut bytes, &[2.25, 0.0, 0.0, 0.0, 2.25, 0.0, 0.0, 0.0, 9.0]);
        bytes.push(2);
        parts.push((fix.time + 0.1, 1, Stream::message(0, 1, &bytes)));
    }
    parts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let arrival = |(at, source, bytes): (f64, usize, Vec<u8>)| Arrival {
        source,
        at: ((1.0 + at) * 1e9) as u64,
        bytes,
    };
    parts.into_iter().map(arrival).collect()
}

/// What a session gives, and the horizontal error over its σ at some of its rows, by the drive's time \[s\].
fn errors(log: &undrift_simulate::Simulation, arrivals: &[Arrival]) -> (Seen, Vec<(f64, f64)>) {
    let mut session = Session::new(
        TOPICS,
        "drive.toml",
        Path::new(""),
        logs(),
        Options::default(),
    )
    .unwrap();
    let seen = run(&mut session, arrivals);
    let epoch = session.drive().unwrap().epoch.unwrap();
    let error = |row: &SolutionRow| {
        let time = epoch.unix(row.time) - ZERO;
        let truth = log
            .truth
            .iter()
            .find(|truth| (truth.time - time).abs() < 5e-3)?;
        let apart = truth.position.ned_to(&row.position);
        let std = row.nav_std[0].hypot(row.nav_std[1]);
        Some((time, apart.x.hypot(apart.y) / std))
    };
    let errors = seen.rows.iter().step_by(50).filter_map(error).collect();
    (seen, errors)
}

fn inside(errors: &[(f64, f64)], from: f64) -> f64 {
    let after = errors.iter().filter(|(time, _)| *time >= from);
    let inside = after.clone().filter(|(_, error)| *error < 3.0).count();
    inside as f64 / after.count().max(1) as f64
}

/// A fix must not wait for the next ones: with 2 s of horizon none is too late.
#[test]
fn topics_are_navigated_as_they_come() {
    let log = simulated(9, 150.0);
    let arrivals = topics(&log, |time| time);
    let (seen, errors) = errors(&log, &arrivals);
    let last = errors.last().unwrap().0;
    assert!(last > 148.0, "{last}");
    assert!(inside(&errors, 0.0) > 0.95, "{errors:?}");
    // The newest fix is never older than its interval, a tenth, and the sample before the newest.
    assert!(seen.without < 60, "{} rows without GNSS", seen.without);
}

/// The reader begins again, and has what its stream began with.
#[test]
fn a_clock_that_is_set_back_is_followed() {
    let log = simulated(9, 200.0);
    let arrivals = topics(&log, |time| if time < 100.0 { time } else { time - 30.0 });
    let (seen, errors) = errors(&log, &arrivals);
    let again = |notice: &&Notice| matches!(notice, Notice::ReadAgain(..));
    let again = seen.notices.iter().filter(again).count();
    assert_eq!(again, 1, "{:?}", seen.notices);
    let last = errors.last().unwrap().0;
    assert!(last > 198.0, "{last}, {:?}", seen.notices);
    assert!(inside(&errors, 110.0) > 0.9, "{errors:?}");
}
