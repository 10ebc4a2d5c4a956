use super::*;
use crate::replay;
use std::fmt::Write;
use undrift_drive::replay::Measurement;
use undrift_simulate::{GnssNoise, Trajectory, simulate};

const DRIVE: &str = r#"
model = "mpu6050"
[imu]
file = "imu.csv"
time = "t"
gyro = ["gx", "gy", "gz"]
gyro_unit = "rad/s"
accel = ["fx", "fy", "fz"]
accel_unit = "m/s2"
[gnss]
file = "gnss.csv"
time = "t"
position = ["lat", "lon", "h"]
position_std = "1.5, 1.5, 3 m"
lever_arm = "0, 0, 0 m"
"#;

mod faults;
mod poses;
mod ros;

/// A drive at 50 Hz with fixes each second.
fn simulated(seed: u64, length: f64) -> undrift_simulate::Simulation {
    let model = undrift_noise::ImuModel::preset("mpu6050").unwrap();
    let filters = model.shaping(BiasModel::GaussMarkov, 0.02).unwrap();
    let noise = GnssNoise::default();
    let path = Trajectory::car(length, seed);
    simulate(&path, 50.0, Some(&filters), &noise, seed).unwrap()
}

/// A drive of 150 s as files in a folder.
fn folder(seed: u64) -> tempfile::TempDir {
    folder_of(seed, 150.0)
}

/// A drive of any length \[s\].
fn folder_of(seed: u64, length: f64) -> tempfile::TempDir {
    let log = simulated(seed, length);
    let mut gnss = "t,lat,lon,h\n".to_owned();
    for fix in &log.gnss {
        let Some((undrift_nav::sample::Position::Geodetic(place), _)) = fix.position else {
            continue;
        };
        writeln!(
            gnss,
            "{},{},{},{}",
            fix.time,
            place.lat.to_degrees(),
            place.lon.to_degrees(),
            place.height
        )
        .unwrap();
    }
    written([
        ("imu.csv", &imu_rows(&log.imu)),
        ("gnss.csv", &gnss),
        ("drive.toml", DRIVE),
    ])
}

/// Samples as a table.
fn imu_rows(samples: &[ImuSample]) -> String {
    let mut rows = "t,gx,gy,gz,fx,fy,fz\n".to_owned();
    for sample in samples {
        let (gyro, accel) = (sample.dtheta / sample.dt, sample.dvel / sample.dt);
        writeln!(
            rows,
            "{},{},{},{},{},{},{}",
            sample.time, gyro.x, gyro.y, gyro.z, accel.x, accel.y, accel.z
        )
        .unwrap();
    }
    rows
}

/// Files in a folder of their own.
fn written(files: [(&str, &str); 3]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

fn logs() -> Vec<(String, usize)> {
    vec![("imu".into(), 0), ("gnss".into(), 1)]
}

fn arrivals(folder: &Path) -> (Drive, Vec<Arrival>) {
    let drive = Drive::load(&folder.join("drive.toml"), None).unwrap();
    let bytes =
        ["imu.csv", "gnss.csv"].map(|name| std::fs::read(folder.join(name)).unwrap().into());
    let arrivals = replay::arrivals(&drive, &bytes, &logs()).unwrap();
    (drive, arrivals)
}

#[derive(Default)]
struct Seen {
    rows: Vec<SolutionRow>,
    without: usize,
    notices: Vec<Notice>,
}

impl Sink for Seen {
    fn ready(&mut self, _: &Drive) {
        assert!(self.rows.is_empty(), "outputs are ready before rows");
    }

    fn row(&mut self, row: &SolutionRow, since_fix: Option<f64>) {
        self.rows.push(*row);
        self.without += usize::from(is_without_gnss(since_fix));
    }

    fn notice(&mut self, _: Option<f64>, notice: Notice) {
        self.notices.push(notice);
    }
}

fn session(folder: &Path, interval: Option<f64>) -> Session {
    let options = Options {
        interval,
        ..Options::default()
    };
    Session::new(DRIVE, "drive.toml", folder, logs(), options).unwrap()
}

fn run(session: &mut Session, arrivals: &[Arrival]) -> Seen {
    let mut seen = Seen::default();
    arrivals
        .iter()
        .try_for_each(|arrival| session.take(arrival, &mut seen))
        .unwrap();
    seen
}

/// The state at the end of the last sample but one.
fn end(session: &Session) -> undrift_nav::mechanisation::NavState {
    *session.navigator().unwrap().filter().unwrap().nav()
}

/// What the replay of the files has at the same instant.
fn replayed(drive: &Drive) -> undrift_nav::mechanisation::NavState {
    let settings = settings(drive, BiasModel::Arma).unwrap();
    let mut navigator = Navigator::new(settings);
    let mut fixes = drive.open_gnss().unwrap().map(Result::unwrap).peekable();
    for sample in drive.open_imu().unwrap() {
        let sample = sample.unwrap();
        while let Some(fix) = fixes.next_if(|fix| fix.time <= sample.time + navigator.ahead()) {
            navigator.measure(Measurement::Gnss(fix)).unwrap();
        }
        navigator.imu(sample).unwrap();
    }
    *navigator.filter().unwrap().nav()
}

fn assert_near(a: &undrift_nav::mechanisation::NavState, b: &undrift_nav::mechanisation::NavState) {
    assert_eq!(a.time, b.time);
    assert!((a.v_n - b.v_n).norm() < 1e-9, "{} {}", a.v_n, b.v_n);
    assert!(a.q_nb.angle_to(&b.q_nb) < 1e-9);
    let (a, b) = (a.position, b.position);
    assert!((a.lat - b.lat).abs() < 1e-15 && (a.lon - b.lon).abs() < 1e-15);
    assert!((a.height - b.height).abs() < 1e-9);
}

/// A line that carries both and was held up gives ten seconds at once, more than the horizon: the solution is the replay's.
#[test]
fn samples_and_fixes_of_one_line_are_taken_in_their_order() {
    let folder = folder(3);
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    let (imu, gnss) = (read("imu.csv"), read("gnss.csv"));
    let mut fixes = gnss.lines().peekable();
    let mut table = String::new();
    let stamp = |row: &str| row.split(',').next().unwrap().parse::<f64>().ok();
    for row in imu.lines() {
        let fix = fixes.next_if(|fix| match (stamp(fix), stamp(row)) {
            (Some(fix), Some(row)) => fix < row + 0.01,
            _ => true,
        });
        let place = fix.map_or(",,", |fix| fix.split_once(',').unwrap().1);
        writeln!(table, "{row},{place}").unwrap();
    }
    assert_eq!(fixes.next(), None);
    let text = DRIVE
        .replace("imu.csv", "log.csv")
        .replace("gnss.csv", "log.csv");
    std::fs::write(folder.path().join("log.csv"), &table).unwrap();
    std::fs::write(folder.path().join("drive.toml"), &text).unwrap();
    let drive = Drive::load(&folder.path().join("drive.toml"), None).unwrap();
    let expected = replayed(&drive);

    let logs = vec![("imu".to_owned(), 0), ("gnss".to_owned(), 0)];
    let mut live =
        Session::new(&text, "drive.toml", folder.path(), logs, Options::default()).unwrap();
    let held_up = table.len() / 15;
    let arrivals = (0_u64..).zip(table.as_bytes().chunks(held_up));
    let arrivals: Vec<Arrival> = arrivals
        .map(|(k, bytes)| Arrival {
            source: 0,
            at: 10_000_000_000 * (k + 1),
            bytes: bytes.to_vec(),
        })
        .collect();
    run(&mut live, &arrivals);
    assert_near(&end(&live), &expected);
    assert_eq!(live.navigator().unwrap().too_late(), 0);
}

/// Pieces of any size, arrivals that jitter and fixes that come up to 1.5 s late: the solution is the replay's.
#[test]
fn late_and_in_pieces_the_solution_is_that_of_the_replay() {
    let folder = folder(1);
    let (drive, whole) = arrivals(folder.path());
    let expected = replayed(&drive);
    let mut live = session(folder.path(), None);
    let seen = run(&mut live, &whole);
    assert_near(&end(&live), &expected);
    assert!(seen.rows.len() > 4000, "{}", seen.rows.len());
    assert!(seen.without < 300, "{}", seen.without);
    assert!(
        seen.notices
            .iter()
            .any(|notice| matches!(notice, Notice::Ready(rate) if (rate - 50.0).abs() < 1e-6))
    );

    let mut jittered: Vec<Arrival> = Vec::new();
    for (k, arrival) in whole.iter().enumerate() {
        let late = match arrival.source {
            0 => (k * 7919 % 20) as u64 * 1_000_000,
            _ => 50_000_000 + (k * 7919 % 1450) as u64 * 1_000_000,
        };
        jittered.push(Arrival {
            at: arrival.at + late,
            ..arrival.clone()
        });
    }
    // The order of a source's bytes stays.
    let mut latest = [0; 2];
    for arrival in &mut jittered {
        let latest = &mut latest[arrival.source];
        *latest = (*latest).max(arrival.at);
        arrival.at = *latest;
    }
    jittered.sort_by_key(|arrival| arrival.at);
    let mut live = session(folder.path(), None);
    let seen = run(&mut live, &jittered);
    assert_near(&end(&live), &expected);
    assert_eq!(live.navigator().unwrap().too_late(), 0);
    assert!(
        !seen
            .notices
            .iter()
            .any(|notice| matches!(notice, Notice::ClockApart(..) | Notice::ClockSet(..))),
        "{:?}",
        seen.notices
    );
    // What it gave, it gives again.
    let again = run(&mut session(folder.path(), None), &jittered);
    assert_eq!(seen.rows, again.rows);
}

#[test]
fn a_solution_goes_on_from_its_state_in_another_process() {
    let folder = folder(2);
    let (_, whole) = arrivals(folder.path());
    let (first, second) = whole.split_at(whole.len() * 3 / 5);
    let mut one = session(folder.path(), Some(0.02));
    run(&mut one, first);
    let state = State::from_bytes(&one.state().unwrap().to_bytes()).unwrap();
    // Whoever comes later sees the header of the table again, as from a port that is opened again.
    let header = b"t,gx,gy,gz,fx,fy,fz\n".to_vec();
    let at = second[0].at;
    let mut later = vec![
        Arrival {
            source: 0,
            at,
            bytes: header,
        },
        Arrival {
            source: 1,
            at,
            bytes: b"t,lat,lon,h\n".to_vec(),
        },
    ];
    later.extend_from_slice(second);
    let mut two = session(folder.path(), None).resume(Some(state.clone()));
    let seen = run(&mut two, &later);
    assert!(
        seen.notices
            .iter()
            .any(|notice| matches!(notice, Notice::Resumed(_))),
        "{:?}",
        seen.notices
    );
    run(&mut one, second);
    let (one, two) = (end(&one), end(&two));
    assert!((one.v_n - two.v_n).norm() < 0.05 && one.time == two.time);
    // Minutes later it aligns again.
    for arrival in &mut later {
        arrival.at += 600_000_000_000;
    }
    let seen = run(
        &mut session(folder.path(), None).resume(Some(state)),
        &later,
    );
    let old = |notice: &Notice| matches!(notice, Notice::NotResumed(StateError::Old(age)) if *age > 590.0);
    assert!(seen.notices.iter().any(old), "{:?}", seen.notices);
}

/// The IMU counts milliseconds since it was switched on, begins again at 0, and its line is cut.
#[test]
fn a_sensor_that_begins_again_goes_on() {
    let folder = folder(3);
    let (_, whole) = arrivals(folder.path());
    // Rows whole, so that their times can be changed.
    let imu = std::fs::read_to_string(folder.path().join("imu.csv")).unwrap();
    let mut lines = imu.lines();
    let header = lines.next().unwrap();
    let mut arrivals: Vec<Arrival> = whole
        .into_iter()
        .filter(|arrival| arrival.source == 1)
        .collect();
    let first = arrivals[0].at as f64 / 1e9;
    arrivals.push(Arrival {
        source: 0,
        at: 0,
        bytes: format!("{header}\n").into_bytes(),
    });
    for line in lines {
        let (time, rest) = line.split_once(',').unwrap();
        let time: f64 = time.parse().unwrap();
        let stamped = if time < 90.0 { time } else { time - 90.0 };
        let at = ((time + first) * 1e9) as u64;
        arrivals.push(Arrival {
            source: 0,
            at,
            bytes: format!("{stamped},{rest}\n").into_bytes(),
        });
    }
    arrivals.sort_by_key(|arrival| arrival.at);
    let seen = run(&mut session(folder.path(), None), &arrivals);
    let set = seen.notices.iter().find_map(|notice| match notice {
        Notice::ClockSet(table, by) if table == "imu" => Some(*by),
        _ => None,
    });
    assert!((set.unwrap() - 90.0).abs() < 0.1, "{:?}", seen.notices);
    let last = seen.rows.last().unwrap();
    assert!(last.time > 149.0, "{}", last.time);
    assert!(last.nav_std[0] < 3.0, "{:?}", last.nav_std);
}

#[test]
fn what_cannot_be_is_said() {
    let folder = folder(4);
    let none = Session::new(
        DRIVE,
        "drive.toml",
        folder.path(),
        vec![("imu".into(), 0)],
        Options::default(),
    );
    assert_eq!(none.err().unwrap().to_string(), "no source of [gnss]");
    // Fixes are no poses.
    let posed = Session::new(
        &DRIVE.replace("[gnss]", "[poses]"),
        "drive.toml",
        folder.path(),
        logs(),
        Options::default(),
    );
    assert_eq!(posed.err().unwrap().to_string(), "no source of [poses]");
    let mut wrong = Session::new(
        &DRIVE.replace("accel_unit", "acel_unit"),
        "drive.toml",
        folder.path(),
        logs(),
        Options::default(),
    )
    .unwrap();
    let (_, whole) = arrivals(folder.path());
    let error = whole
        .iter()
        .find_map(|arrival| wrong.take(arrival, &mut Seen::default()).err());
    assert!(error.unwrap().to_string().contains("acel_unit"));
}
