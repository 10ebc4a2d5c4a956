use super::*;
use undrift_io::Memory;

/// Reads a text as a part of a drive with some keys.
fn measured(table: &'static str, keys: &[(&'static str, &str)], text: &str) -> Part {
    let mut logs = Logs::default();
    let held = Memory::Bytes(text.as_bytes().into());
    logs.memory.insert("log".into(), held);
    let values: toml::Table = keys
        .iter()
        .map(|(k, v)| format!("{k} = {v}\n"))
        .collect::<String>()
        .parse()
        .unwrap();
    let line =
        |(key, _): &(&'static str, &str)| Line::new(key, values[*key].clone(), Known::Certain);
    let mut part = Part::new(table, keys.iter().map(line).collect());
    measure(Path::new("log"), &mut logs, Format::Csv, &mut part);
    part
}

const IMU: [(&str, &str); 5] = [
    ("time", "1"),
    ("gyro", "[2, 3, 4]"),
    ("gyro_unit", "\"deg/s\""),
    ("accel", "[5, 6, 7]"),
    ("accel_unit", "\"g\""),
];

/// Two seconds at 100 Hz of this specific force \[g\] and of gyros that stand.
fn forces(force: [f64; 3]) -> Part {
    let [x, y, z] = force;
    let row = |k: i32| format!("{:.2},0,0,0,{x},{y},{z}\n", 0.01 * f64::from(k));
    measured("imu", &IMU, &(0..200).map(row).collect::<String>())
}

#[test]
fn reading_asks_for_a_line_once() {
    let mut part = Part::new("gnss", Vec::new());
    let streams = ["/first", "/second", "/third"].map(str::to_owned);
    part.choices.push(("topic", streams.into()));
    let asks = |key: Key, format, part: &Part| {
        let error = ReadError {
            key: Some(key),
            ..ReadError::new(Path::new("log"), "")
        };
        missing(&Err(error.into()), format, part)
    };
    let position = Line::new("position_std", POSITION_STD, Known::NotInLog);
    let velocity = Line::new("velocity_std", VELOCITY_STD, Known::NotInLog);
    let of_nmea = Line::new("velocity_std", LEVEL_VELOCITY_STD, Known::NotInNmea);
    let others = ["/second", "/third"].map(str::to_owned);
    let first = Line::new("topic", "/first", Known::FirstOf(others.into()));
    let csv = Format::Csv;
    assert_eq!(asks(Key::PositionStd, csv, &part), Some(position));
    assert_eq!(asks(Key::VelocityStd, csv, &part), Some(velocity.clone()));
    assert_eq!(asks(Key::VelocityStd, Format::Nmea, &part), Some(of_nmea));
    assert_eq!(asks(Key::Topic("gnss"), csv, &part), Some(first));
    assert_eq!(asks(Key::VelocityTopic, csv, &part), None);
    assert_eq!(asks("gnss.rate".into(), csv, &part), None);
    let plain = ReadError::new(Path::new("log"), "");
    assert_eq!(missing(&Err(plain.into()), csv, &part), None);
    // Fixes are read all the same where only their velocities have no standard deviation.
    let read = |without_std: u64| {
        let mut of = Span::default().measured(&Skipped::default(), None);
        of.untold_velocities = without_std;
        Ok((of, None))
    };
    assert_eq!(missing(&read(1), csv, &part), Some(velocity.clone()));
    assert_eq!(missing(&read(0), csv, &part), None);
    part.lines.push(velocity);
    assert_eq!(missing(&read(1), csv, &part), None);
    assert_eq!(asks(Key::VelocityStd, csv, &part), None);
}

/// Specific force at rest points up: of axes that point down its z is negative.
#[test]
fn gravity_shows_how_the_sensor_sits() {
    let axes = |up: f64| {
        let part = forces([(1.0 - up * up).sqrt(), 0.0, up]);
        let line = part.lines.last().unwrap();
        (line.key, line.value.clone(), line.known.clone())
    };
    let down = ("axes", "x,y,z".into(), Known::PointsDown);
    let up = ("axes", "x,-y,-z".into(), Known::PointsUp);
    let tilted = ("mounting", "auto".into(), Known::Tilted);
    // 0.8 is a lean of 37 deg.
    for z in [-1.0, -0.81] {
        assert_eq!(axes(z), down);
        assert_eq!(axes(-z), up);
    }
    for z in [-0.79, 0.0, 0.79] {
        assert_eq!(axes(z), tilted);
    }
    // What is no gravity shows nothing.
    let part = forces([0.0, 0.0, -0.5]);
    assert_eq!(part.lines.len(), IMU.len());
    assert!(!is_gravity(&part));
    assert!(is_gravity(&forces([0.6, 0.0, 0.8])));
}

#[test]
fn gravity_is_known_to_fifteen_hundredths() {
    let of = |size: f64| about_gravity([0.0, size * STANDARD_GRAVITY, 0.0]);
    assert!(of(1.149) && of(0.851) && of(-1.0));
    assert!(!of(1.151) && !of(0.849) && !of(0.0));
    // A part without a force cannot contradict, one that was not read has none.
    let mut part = Part::new("gnss", Vec::new());
    assert!(!is_gravity(&part));
    let mut of = Span::default().measured(&Skipped::default(), None);
    of.content = Some(Content::Poses {
        velocities: 0,
        attitudes: 0,
    });
    part.measured = Some(of);
    assert!(is_gravity(&part));
}

/// On the steps of an ADIS16470, a second missing from the third on.
#[test]
fn samples_are_counted_and_timed() {
    let mut text = String::new();
    for k in 0..600 {
        let time = 10.0 + 0.01 * f64::from(k) + f64::from(u8::from(k >= 300));
        let steps = f64::from(k * 7919 % 101 - 50);
        let (rate, force) = (0.1 * steps, -1.0 + 1.25e-3 * steps);
        text += &format!("{time:.2},{rate:.6},{rate:.6},{rate:.6},0,{force:.6},0\n");
    }
    let part = measured("imu", &IMU, &text);
    let of = part.measured.unwrap();
    assert_eq!((of.records, of.gaps), (600, 1));
    assert!((of.first_s - 10.0).abs() < 1e-9 && (of.last_s - 16.99).abs() < 1e-9);
    // Stamps of a hundredth are 1e-15 s off.
    assert!((of.rate_hz - 100.0).abs() < 1e-6, "{}", of.rate_hz);
    let (start, length) = of.longest_gap_s.unwrap();
    assert!((start - 12.99).abs() < 1e-9 && (length - 1.01).abs() < 1e-9);
    assert_eq!(of.steps_of, Some("adis16470"));
    let Some(Content::Force(force)) = of.content else {
        panic!("{:?}", of.content);
    };
    // 600 of steps that take all of −50 … 50 in turn: their mean is a tenth of a step.
    let mean = force.map(|x| x / STANDARD_GRAVITY);
    assert!((mean[1] + 1.0).abs() < 0.5 * 1.25e-3, "{mean:?}");
    assert_eq!((mean[0], mean[2]), (0.0, 0.0));
    // Of a single record there is no interval.
    let keys = [
        ("time", "1"),
        ("position", "[2, 3, 4]"),
        ("position_std", "\"1 m\""),
    ];
    let one = measured("gnss", &keys, "1,45,7,300\n").measured.unwrap();
    assert_eq!((one.records, one.rate_hz, one.gaps), (1, 0.0, 0));
    assert_eq!((one.first_s, one.last_s), (1.0, 1.0));
}

#[test]
fn fixes_are_counted_by_their_kind() {
    let keys = [
        ("time", "1"),
        ("position", "[2, 3, 4]"),
        ("velocity", "[5, 6, 7]"),
        ("velocity_std", "\"0.1 m/s\""),
        ("position_std", "\"1 m\""),
        ("quality", "8"),
    ];
    // As RTKLIB numbers them: fixed, float, differential, single; 0 is of no kind.
    let kinds = [(1, 1), (2, 2), (4, 3), (5, 4), (0, 5)];
    let kinds = kinds.map(|(kind, count)| vec![kind; count]).concat();
    let rows = kinds.iter().enumerate().map(|(k, kind)| {
        let velocity = if k < 7 { "1,0,0" } else { ",," };
        format!("{k},45,7,300,{velocity},{kind}\n")
    });
    let part = measured("gnss", &keys, &rows.collect::<String>());
    let of = part.measured.unwrap();
    assert_eq!((of.records, of.rate_hz, of.untold_velocities), (15, 1.0, 0));
    let expected = Content::Fixes {
        kinds: [1, 2, 3, 4, 5],
        velocities: 7,
    };
    assert_eq!(of.content, Some(expected));
}

#[test]
fn reference_solutions_are_counted() {
    let rows = (0..5).map(|k| format!("{k},45,7,300,1,0,0,1,2,3\n"));
    let text: String = rows.collect();
    let place = [("time", "1"), ("position", "[2, 3, 4]")];
    let velocity = [("velocity", "[5, 6, 7]")];
    let attitude = [("attitude", "[8, 9, 10]")];
    for (with_velocity, with_attitude) in
        [(false, false), (true, false), (false, true), (true, true)]
    {
        let mut keys = place.to_vec();
        keys.extend(velocity.iter().filter(|_| with_velocity));
        keys.extend(attitude.iter().filter(|_| with_attitude));
        let of = measured("truth", &keys, &text).measured.unwrap();
        assert_eq!((of.records, of.first_s, of.last_s), (5, 0.0, 4.0));
        let expected = Content::Poses {
            velocities: 5 * u64::from(with_velocity),
            attitudes: 5 * u64::from(with_attitude),
        };
        assert_eq!(of.content, Some(expected));
    }
}

#[test]
fn what_cannot_be_read_says_why() {
    let part = measured(
        "gnss",
        &[("time", "1"), ("position", "[2, 3, 9]")],
        "1,2,3\n",
    );
    assert!(part.measured.is_none() && part.problem.is_some());
}
