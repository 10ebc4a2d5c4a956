//! Tables as strangers write them: read as they are, and navigated as the same drive in the usual way.

use super::{NAMED, drive, folder, row, text, undrift};
use std::{fs, path::Path};

/// What a field of a line is made of.
type Rewritten<'a> = &'a dyn Fn(&[f64]) -> String;

/// The usual drive, its samples and fixes written in another way: the drive file that `inspect` makes of them, and the
/// end of the solution: latitude, longitude \[deg\].
fn solved(name: &str, [imu, gnss]: [Option<(&str, Rewritten)>; 2]) -> (String, [f64; 2]) {
    let dir = folder(name);
    drive(&dir, NAMED, row);
    for (file, rewritten) in [("imu.csv", imu), ("gnss.csv", gnss)] {
        if let Some((header, rewritten)) = rewritten {
            rewrite(&dir.join(file), header, rewritten);
        }
    }
    let solved = navigated(&dir, &["imu.csv", "gnss.csv"]);
    fs::remove_dir_all(&dir).unwrap();
    solved
}

/// The drive file that `inspect` makes of logs, and the end of the solution.
fn navigated(dir: &Path, logs: &[&str]) -> (String, [f64; 2]) {
    let inspect = [&["inspect"], logs, &["-o", "drive.toml"]].concat();
    text(&undrift(&inspect, dir));
    let file = fs::read_to_string(dir.join("drive.toml")).unwrap();
    let run = undrift(&["navigate", "drive.toml", "-o", "nav.csv"], dir);
    assert!(text(&run).contains("navigated"), "{file}");
    let nav = fs::read_to_string(dir.join("nav.csv")).unwrap();
    let names: Vec<&str> = nav.lines().next().unwrap().split(',').collect();
    let last: Vec<&str> = nav.lines().last().unwrap().split(',').collect();
    let end = ["lat_deg", "lon_deg"].map(|name| {
        let place = names.iter().position(|known| *known == name).unwrap();
        last[place].parse().unwrap()
    });
    (file, end)
}

/// Rewrites each row of a file.
fn rewrite(file: &Path, header: &str, rewritten: Rewritten) {
    let before = fs::read_to_string(file).unwrap();
    let mut rows = header.to_owned();
    for line in before.lines().skip(1) {
        let numbers: Vec<f64> = line
            .split(',')
            .map(|field| field.parse().unwrap())
            .collect();
        rows += &rewritten(&numbers);
        rows.push('\n');
    }
    fs::write(file, rows).unwrap();
}

fn joined(numbers: &[f64], between: &str) -> String {
    let numbers: Vec<String> = numbers.iter().map(f64::to_string).collect();
    numbers.join(between)
}

/// Where the drive ends, at 59.99 s, to what the fixes' standard deviations of 3 m leave open \[deg\].
fn ends_there(end: [f64; 2]) {
    let lat = 48.1 + (100.0 + 20.0 * (59.99 - 30.0)) / 111_195.0;
    assert!(
        (end[0] - lat).abs() < 3e-5 && (end[1] - 11.5).abs() < 3e-5,
        "{end:?}"
    );
}

#[test]
fn dates_with_decimal_commas() {
    let clock = |t: f64| {
        format!("2025-07-08T19:{:02}:{:06.3}", (t / 60.0) as u32, t % 60.0).replace('.', ",")
    };
    let imu = |numbers: &[f64]| format!("\"{}\",{}", clock(numbers[0]), joined(&numbers[1..], ","));
    let gnss = |numbers: &[f64]| format!("{};{}", clock(numbers[0]), joined(&numbers[1..], ";"));
    let header = "time;lat;lon;alt\n";
    let (_, end) = solved("commas", [Some((NAMED, &imu)), Some((header, &gnss))]);
    ends_there(end);
}

#[test]
fn days_of_a_spreadsheet() {
    for first in [45_846.5, 739_806.5, 0.25] {
        let day = |numbers: &[f64]| {
            format!(
                "{:.10},{}",
                first + numbers[0] / 86_400.0,
                joined(&numbers[1..], ",")
            )
        };
        let named = Some((NAMED, &day as Rewritten));
        let (file, end) = solved("days", [named, Some(("time,lat,lon,alt\n", &day))]);
        assert_eq!(file.matches("time_unit = \"d\"").count(), 2, "{file}");
        ends_there(end);
    }
}

#[test]
fn degrees_minutes_and_seconds() {
    let parts = |degrees: f64| {
        let (minutes, whole) = (60.0 * degrees.fract(), degrees.trunc());
        (whole, minutes.trunc(), 60.0 * minutes.fract(), minutes)
    };
    let marks = |numbers: &[f64]| {
        let angle = |degrees: f64, letter: char| {
            let (d, m, s, _) = parts(degrees);
            format!("{d:.0}°{m:02.0}'{s:08.5}\"{letter}")
        };
        format!(
            "{},{},{},500",
            numbers[0],
            angle(numbers[1], 'N'),
            angle(numbers[2], 'E')
        )
    };
    let colons = |numbers: &[f64]| {
        let angle = |degrees: f64| {
            let (d, m, s, _) = parts(degrees);
            format!("{d:.0}:{m:02.0}:{s:08.5}")
        };
        format!(
            "{},{},{},500",
            numbers[0],
            angle(numbers[1]),
            angle(numbers[2])
        )
    };
    let nmea = |numbers: &[f64]| {
        let [(lat, _, _, lat_minutes), (lon, _, _, lon_minutes)] =
            [1, 2].map(|k| parts(numbers[k]));
        format!(
            "{},{lat:02.0}{lat_minutes:010.7},N,{lon:03.0}{lon_minutes:010.7},E,500",
            numbers[0]
        )
    };
    let plain = "time,latitude,longitude,height\n";
    for (header, gnss, unit) in [
        (plain, &marks as Rewritten, false),
        (plain, &colons, false),
        ("time,lat,ns,lon,ew,alt\n", &nmea, true),
    ] {
        let (file, end) = solved("dms", [None, Some((header, gnss))]);
        assert_eq!(
            file.contains("position_unit = \"ddmm.mmmm\""),
            unit,
            "{file}"
        );
        ends_there(end);
    }
}

#[test]
fn fixes_without_names() {
    // North, east, down as the car drives, with accuracies.
    let gnss = |numbers: &[f64]| {
        let speed = 2.0 * (numbers[0] - 20.0).clamp(0.0, 10.0);
        format!("{},{speed},0.001,-0.002,0.5,0.8,0.1", joined(numbers, ","))
    };
    let imu = |numbers: &[f64]| joined(numbers, ",");
    let (file, end) = solved("nameless", [Some(("", &imu)), Some(("", &gnss))]);
    for line in [
        "position = [2, 3, 4]",
        "position_std_columns = [8, 8, 9]",
        "velocity = [5, 6, 7]",
        "velocity_std_columns = [10, 10, 10]",
        "gyro = [2, 3, 4]",
        "accel = [5, 6, 7]",
    ] {
        assert!(file.contains(line), "{line}: {file}");
    }
    ends_there(end);
}

#[test]
fn stamps_that_are_shared() {
    // Bursts of five rows, stamped as they are read.
    let burst = |numbers: &[f64]| {
        let stamp = 0.0034 + 0.05 * (numbers[0] / 0.05 + 1e-6).floor();
        format!("{stamp:.4},{}", joined(&numbers[1..], ","))
    };
    let (file, end) = solved("bursts", [Some((NAMED, &burst)), None]);
    assert!(file.contains("shared_stamps = \"spread\""), "{file}");
    ends_there(end);
    // Whole seconds, by a drive file without that key.
    let dir = folder("whole");
    drive(&dir, NAMED, row);
    let whole =
        |numbers: &[f64]| format!("{:.0},{}", numbers[0].floor(), joined(&numbers[1..], ","));
    rewrite(&dir.join("imu.csv"), NAMED, &whole);
    text(&undrift(
        &["inspect", "imu.csv", "gnss.csv", "-o", "drive.toml"],
        &dir,
    ));
    let file = fs::read_to_string(dir.join("drive.toml")).unwrap();
    let by_hand: Vec<&str> = file
        .lines()
        .filter(|line| !line.starts_with("shared_stamps"))
        .collect();
    assert!(by_hand.len() + 1 == file.lines().count(), "{file}");
    fs::write(dir.join("hand.toml"), by_hand.join("\n")).unwrap();
    let run = undrift(&["navigate", "hand.toml"], &dir);
    let said = [run.stdout, run.stderr]
        .map(|text| String::from_utf8(text).unwrap())
        .concat();
    assert!(
        said.starts_with("not usable") || said.starts_with("error"),
        "{said}"
    );
    assert!(said.contains("imu.shared_stamps = \"spread\""), "{said}");
    fs::remove_dir_all(&dir).unwrap();
}

/// Gyros at rest with a bias of about 1 deg/s look like gravity in g.
#[test]
fn recordings_without_names() {
    let dir = folder("recording");
    let noise = |k: u32| f64::from(k * 7919 % 1009) / 504.5 - 1.0;
    let rows = (0..3000).map(|k| {
        let gyro =
            [0, 1, 2].map(|axis| [0.6, -0.6, -0.5][axis] + 0.1 * noise(k + 331 * axis as u32));
        let accel = [0, 1, 2]
            .map(|axis| [0.0, 0.003, -1.017][axis] + 0.003 * noise(k * 3 + 97 * axis as u32));
        format!("{},{}\n", joined(&gyro, ","), joined(&accel, ","))
    });
    fs::write(dir.join("n.csv"), rows.collect::<String>()).unwrap();
    let identify = ["identify", "n.csv", "--rate", "100", "--allan"];
    let guessed = undrift(&identify, &dir);
    let said = String::from_utf8_lossy(&guessed.stderr).into_owned();
    assert!(
        said.contains("--columns \"1,2,3,4,5,6\" --units \"deg/s,g\""),
        "{said}"
    );
    let stated = ["--columns", "1,2,3,4,5,6", "--units", "deg/s,g"];
    let typed = undrift(&[&identify[..], &stated].concat(), &dir);
    assert_eq!(text(&guessed), text(&typed));
    fs::remove_dir_all(&dir).unwrap();
}

/// The app SensorLog writes the last fix in each row, as a table or as an array of objects whose numbers are texts.
#[test]
fn rows_of_a_telephone() {
    let names = [
        "loggingTime(txt)",
        "loggingSample(N)",
        "locationTimestamp_since1970(s)",
        "locationLatitude(WGS84)",
        "locationLongitude(WGS84)",
        "locationAltitude(m)",
        "locationSpeed(m/s)",
        "locationCourse(°)",
        "locationVerticalAccuracy(m)",
        "locationHorizontalAccuracy(m)",
        "accelerometerTimestamp_sinceReboot(s)",
        "accelerometerAccelerationX(G)",
        "accelerometerAccelerationY(G)",
        "accelerometerAccelerationZ(G)",
        "gyroTimestamp_sinceReboot(s)",
        "gyroRotationX(rad/s)",
        "gyroRotationY(rad/s)",
        "gyroRotationZ(rad/s)",
        "motionAttitudeReferenceFrame(txt)",
    ];
    let dir = folder("telephone");
    drive(&dir, NAMED, row);
    let numbers = |name: &str| -> Vec<Vec<f64>> {
        let text = fs::read_to_string(dir.join(name)).unwrap();
        let rows = text.lines().skip(1).map(|line| line.split(','));
        rows.map(|row| row.map(|field| field.parse().unwrap()).collect())
            .collect()
    };
    let (samples, fixes) = (numbers("imu.csv"), numbers("gnss.csv"));
    let rows = samples.iter().enumerate().map(|(k, sample)| {
        let (t, fix) = (sample[0], &fixes[k / 20]);
        let mut fields = vec![
            format!(
                "2024-05-06 10:{:02}:{:06.3} +0000",
                (t / 60.0) as u32,
                t % 60.0
            ),
            k.to_string(),
            format!("{:.3}", 1_714_989_600.0 + fix[0]),
        ];
        fields.extend(fix[1..].iter().map(f64::to_string));
        // −1 where they are not known.
        fields.extend(["-1", "-1", "6", "3"].map(str::to_owned));
        fields.push(format!("{:.3}", 62_608.0 + t));
        fields.extend(sample[4..].iter().map(f64::to_string));
        fields.push(format!("{:.3}", 62_608.0 + t));
        fields.extend(
            sample[1..4]
                .iter()
                .map(|rate| rate.to_radians().to_string()),
        );
        fields.push("XArbitraryZVertical".to_owned());
        fields
    });
    let rows: Vec<Vec<String>> = rows.collect();
    let mut table = names.join(",") + "\n";
    let mut objects = Vec::new();
    for row in &rows {
        table += &(row.join(",") + "\n");
        let members = names.iter().zip(row).map(|(name, value)| {
            let name = name.split('(').next().unwrap_or_default();
            format!("\"{name}\":\"{value}\"")
        });
        objects.push(format!("{{{}}}", members.collect::<Vec<_>>().join(",")));
    }
    for (name, text) in [
        ("phone.csv", table),
        ("phone.json", format!("[{}]", objects.join(","))),
    ] {
        fs::write(dir.join(name), text).unwrap();
        let (file, end) = navigated(&dir, &[name]);
        for line in ["position = [\"locationLatitude", "gyro = [\"gyroRotationX"] {
            assert!(file.contains(line), "{line}: {file}");
        }
        ends_there(end);
    }
    fs::remove_dir_all(&dir).unwrap();
}

#[test]
fn times_of_day_beside_a_date() {
    // The fixes have times of day of UTC alone.
    let clock = |t: f64| format!("10:{:02}:{:05.2}", (t / 60.0) as u32, t % 60.0);
    let gnss = |numbers: &[f64]| format!("{},{}", clock(numbers[0]), joined(&numbers[1..], ","));
    let header = "UTC,lat,lon,alt\n";
    // Unix time, and the seconds of the GPS week, of a Monday.
    for (first, offset) in [(1_714_989_600.0, "1714953600 s"), (122_418.0, "86418 s")] {
        let imu =
            |numbers: &[f64]| format!("{:.2},{}", first + numbers[0], joined(&numbers[1..], ","));
        let logs = [Some((NAMED, &imu as Rewritten)), Some((header, &gnss))];
        let (file, end) = solved("of_day", logs);
        assert!(
            file.contains(&format!("time_offset = \"{offset}\"")),
            "{file}"
        );
        ends_there(end);
    }
}

/// Eastings and northings in zone 32 of 48.1° and 48.11° north, 11.5° east, by PROJ; the line between is straight to 1 mm.
const GRID: [[f64; 2]; 2] = [
    [686_121.755_8, 5_330_438.130_2],
    [686_085.636_5, 5_331_549.495_5],
];

#[test]
fn eastings_and_northings() {
    let grid = |lat: f64| {
        let along = (lat - 48.1) / 0.01;
        [0, 1].map(|k| GRID[0][k] + along * (GRID[1][k] - GRID[0][k]))
    };
    let row = |numbers: &[f64], zone: &str| {
        let [east, north] = grid(numbers[1]);
        format!("{},{east:.4},{north:.4},{}{zone}", numbers[0], numbers[3])
    };
    for (header, zone) in [
        ("time,easting,northing,height,zone\n", ",32N"),
        ("time,utm_x,utm_y,utm_z,zone_number,zone_letter\n", ",32,U"),
    ] {
        let gnss = |numbers: &[f64]| row(numbers, zone);
        let (file, end) = solved("utm", [None, Some((header, &gnss))]);
        assert!(file.contains("position_unit = \"UTM 32N\""), "{file}");
        ends_there(end);
    }
    // Without a zone.
    let dir = folder("no-zone");
    drive(&dir, NAMED, super::row);
    let gnss = |numbers: &[f64]| row(numbers, "");
    rewrite(&dir.join("gnss.csv"), "time,utm_e,utm_n,alt\n", &gnss);
    let run = undrift(&["navigate", "imu.csv", "gnss.csv"], &dir);
    let said = String::from_utf8_lossy(&run.stderr).into_owned();
    assert!(said.contains("UTM needs its zone and hemisphere"), "{said}");
    fs::remove_dir_all(&dir).unwrap();
}

/// JSON that has its values by columns, in groups.
#[test]
fn columns_of_json() {
    let dir = folder("json-columns");
    drive(&dir, NAMED, super::row);
    let text = fs::read_to_string(dir.join("imu.csv")).unwrap();
    let rows = Vec::from_iter(
        text.lines()
            .skip(1)
            .map(|line| Vec::from_iter(line.split(','))),
    );
    let column = |k: usize| {
        format!(
            "[{}]",
            Vec::from_iter(rows.iter().map(|row| row[k])).join(",")
        )
    };
    let group = |from: usize| {
        let [x, y, z] = [0, 1, 2].map(|axis| column(from + axis));
        format!("{{\"x\":{x},\"y\":{y},\"z\":{z}}}")
    };
    let json = format!(
        "{{\"fs\":100,\"time\":{},\"gyro\":{},\"accel\":{}}}",
        column(0),
        group(1),
        group(4)
    );
    fs::write(dir.join("imu.json"), json).unwrap();
    let (file, end) = navigated(&dir, &["imu.json", "gnss.csv"]);
    assert!(
        file.contains("gyro = [\"gyro.x\", \"gyro.y\", \"gyro.z\"]"),
        "{file}"
    );
    ends_there(end);
    fs::remove_dir_all(&dir).unwrap();
}

/// A label for three numbers, units as words behind them.
#[test]
fn labels_of_groups_with_units() {
    let imu = |numbers: &[f64]| {
        let [gyro, accel] = [1..4, 4..7].map(|of| joined(&numbers[of], ", "));
        format!(
            "T: {} ms | Gyro: {gyro} rad/s | Accel: {accel} m/s^2",
            numbers[0] * 1e3
        )
    };
    let (file, end) = solved("labels", [Some(("ready\n", &imu)), None]);
    assert!(file.contains("gyro = [\"Gyro_x [rad/s]\""), "{file}");
    ends_there(end);
}

/// Gyroscopes and accelerometers in files of their own, with times of their own.
#[test]
fn an_imu_in_two_files() {
    let dir = folder("halves");
    drive(&dir, NAMED, super::row);
    for (file, columns, late) in [("gyro.csv", 1..4, 0.0), ("accel.csv", 4..7, 0.004)] {
        fs::copy(dir.join("imu.csv"), dir.join(file)).unwrap();
        let half = |numbers: &[f64]| {
            format!(
                "{:.3},{}",
                numbers[0] + late,
                joined(&numbers[columns.clone()], ",")
            )
        };
        rewrite(&dir.join(file), "time,x,y,z\n", &half);
    }
    let (file, end) = navigated(&dir, &["accel.csv", "gnss.csv", "gyro.csv"]);
    assert!(file.contains("file = \"accel.csv + gyro.csv\""), "{file}");
    assert!(file.contains("blanks = \"interpolate\""), "{file}");
    ends_there(end);
    let identify = [
        "identify",
        "accel.csv + gyro.csv",
        "--span",
        "0,18",
        "--allan",
    ];
    assert!(text(&undrift(&identify, &dir)).contains("6 axes"));
    fs::remove_dir_all(&dir).unwrap();
}

/// Columns of gyroscopes that have the accelerometers' numbers, and an acceleration without gravity before that with it.
#[test]
fn sensors_under_each_others_names() {
    let exchanged = |numbers: &[f64]| {
        let (t, force) = (numbers[0], joined(&numbers[4..], ","));
        let turns = [1, 2, 3].map(|k| numbers[k] + 0.02 * (t * k as f64).sin());
        format!("{t},{force},{}", joined(&turns, ","))
    };
    let (file, end) = solved("exchanged", [Some((NAMED, &exchanged)), None]);
    assert!(
        file.contains("gyro = [\"acc_x\", \"acc_y\", \"acc_z\"]"),
        "{file}"
    );
    assert!(
        file.contains("the columns named as gyroscopes measure gravity"),
        "{file}"
    );
    ends_there(end);
    let header = "time,lin_acc_x,lin_acc_y,lin_acc_z,gyro_x,gyro_y,gyro_z,acc_x,acc_y,acc_z\n";
    let linear = |numbers: &[f64]| {
        format!(
            "{},{},0.01,0.02,{}",
            numbers[0],
            numbers[4],
            joined(&numbers[1..], ",")
        )
    };
    let (file, end) = solved("linear", [Some((header, &linear)), None]);
    assert!(
        file.contains("accel = [\"acc_x\", \"acc_y\", \"acc_z\"]"),
        "{file}"
    );
    ends_there(end);
}

/// Rows of an IMU and of a receiver in one file behind their names, without those of columns; and raw sentences in the place of
/// the receiver's rows, with a clock of the board's own.
#[test]
fn rows_behind_the_names_of_their_sensors() {
    let dir = folder("tagged");
    drive(&dir, NAMED, super::row);
    let lines = |file: &str| {
        let text = fs::read_to_string(dir.join(file)).unwrap();
        let rows = text.lines().skip(1).map(str::to_owned);
        Vec::from_iter(rows.map(|row| {
            let time: f64 = row.split(',').next().unwrap().parse().unwrap();
            (time, row)
        }))
    };
    let (imu, gnss) = (lines("imu.csv"), lines("gnss.csv"));
    let tagged = |imu: &[(f64, String)], name: &str| {
        let rows = imu
            .iter()
            .map(|(time, row)| (*time, format!("IMU,{row}\n")));
        let fixes = gnss
            .iter()
            .map(|(time, row)| (*time, format!("{name},{row}\n")));
        let mut all = Vec::from_iter(rows.chain(fixes));
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all.into_iter().map(|(_, row)| row).collect::<String>()
    };
    fs::write(dir.join("log.csv"), tagged(&imu, "GPS")).unwrap();
    let (file, end) = navigated(&dir, &["log.csv"]);
    assert_eq!(file.matches("file = \"log.csv\"").count(), 2, "{file}");
    assert!(
        file.contains("position = [\"lat\", \"lon\", \"alt\"]"),
        "{file}"
    );
    ends_there(end);
    fs::remove_dir_all(&dir).unwrap();
}

/// The speed beside them shows that integers are millionths of a degree: by their size they could be tenths of them.
#[test]
fn millionths_of_a_degree() {
    let counts = |numbers: &[f64]| {
        let [t, lat, lon, height] = [0, 1, 2, 3].map(|k| numbers[k]);
        let speed = 2.0 * (t - 20.0).clamp(0.0, 10.0);
        let count = |angle: f64| (angle * 1e6).round();
        format!("{t},{},{},{height},{speed},0", count(lat), count(lon))
    };
    let header = "time,lat,lon,alt,speed,course\n";
    let (file, end) = solved("millionths", [None, Some((header, &counts))]);
    assert!(file.contains("position_unit = \"LSB/1e6 deg\""), "{file}");
    ends_there(end);
}

/// An accuracy, a speed and a course in rows of their own are those of another sensor, a compass here; beside positions they are
/// the receiver's.
#[test]
fn an_accuracy_of_another_sensor() {
    let header = "time,lat,lon,alt,accuracy\n";
    let apart = |numbers: &[f64]| {
        let blank = numbers[0] + 0.05;
        format!("{},\n{blank:.2},,,,30", joined(numbers, ","))
    };
    let (file, end) = solved("compass", [None, Some((header, &apart))]);
    assert!(file.contains("position_std = \"3, 3, 6 m\""), "{file}");
    ends_there(end);
    let beside = |numbers: &[f64]| format!("{},4", joined(numbers, ","));
    let (file, end) = solved("accuracy", [None, Some((header, &beside))]);
    assert!(file.contains("\"accuracy\", \"accuracy\""), "{file}");
    ends_there(end);
}

/// Rows of an IMU between the sentences of a receiver, by the time of day, without names of columns.
#[test]
fn rows_between_sentences() {
    let dir = folder("sentences");
    drive(&dir, NAMED, super::row);
    let rows = |file: &str| {
        let text = fs::read_to_string(dir.join(file)).unwrap();
        let numbers = |line: &str| -> Vec<f64> {
            line.split(',')
                .map(|field| field.parse().unwrap())
                .collect()
        };
        text.lines().skip(1).map(numbers).collect::<Vec<_>>()
    };
    let day = 36_000.0;
    let imu = rows("imu.csv").into_iter().enumerate().map(|(k, row)| {
        let noise = (k * 7919 % 101) as f64 * 1e-3 - 0.05;
        let gyro = [noise, -1.3 * noise, 0.7 * noise * noise];
        let force = [row[4] + 1e-2 * noise, 0.02 * noise, row[6] - 1e-2 * noise];
        let line = format!(
            "IMU,{:.2},{},{}\n",
            day + row[0],
            joined(&gyro, ","),
            joined(&force, ",")
        );
        (row[0], line)
    });
    let fixes = rows("gnss.csv").into_iter().map(|row| {
        let minutes = 60.0 * row[1].fract();
        let body = format!(
            "GNGGA,1000{:05.2},48{minutes:010.7},N,01130.0,E,1,10,0.8,500.0,M,47.0,M,,",
            row[0]
        );
        let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
        (row[0], format!("${body}*{sum:02X}\n"))
    });
    let mut all = Vec::from_iter(imu.chain(fixes));
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let text: String = all.into_iter().map(|(_, line)| line).collect();
    fs::write(dir.join("log.txt"), text).unwrap();
    let (file, end) = navigated(&dir, &["log.txt"]);
    assert_eq!(file.matches("file = \"log.txt\"").count(), 2, "{file}");
    ends_there(end);
    fs::remove_dir_all(&dir).unwrap();
}

/// Whole seconds in a column without a unit are no milliseconds: the log would be over in no time.
#[test]
fn samples_of_a_second() {
    let dir = folder("seconds");
    let row = |k: i32| {
        let noise = f64::from(k * 7919 % 101 - 50) * 1e-5;
        format!("{k},{noise},{},{noise},0.1,0.2,{}\n", -noise, 9.81 + noise)
    };
    let rows: String = (0..600).map(row).collect();
    fs::write(dir.join("imu.csv"), format!("t,gx,gy,gz,ax,ay,az\n{rows}")).unwrap();
    let report = text(&undrift(&["inspect", "imu.csv"], &dir));
    assert!(
        report.contains("600 records at 1 Hz, 0.000 s to 599.000 s"),
        "{report}"
    );
    // A hundred a second for as many rows stay milliseconds.
    let rows: String = rows
        .lines()
        .map(|row| row.replacen(',', "0,", 1) + "\n")
        .collect();
    fs::write(dir.join("imu.csv"), format!("t,gx,gy,gz,ax,ay,az\n{rows}")).unwrap();
    let report = text(&undrift(&["inspect", "imu.csv"], &dir));
    assert!(
        report.contains("600 records at 100 Hz, 0.000 s to 5.990 s"),
        "{report}"
    );
    fs::remove_dir_all(&dir).unwrap();
}

/// An archive of one file is that file; of several, the message says what to do.
#[test]
fn archives_of_a_log() {
    let dir = folder("archives");
    drive(&dir, NAMED, super::row);
    fs::write(
        dir.join("imu.zip"),
        stored(&[&fs::read(dir.join("imu.csv")).unwrap()]),
    )
    .unwrap();
    let (file, end) = navigated(&dir, &["imu.zip", "gnss.csv"]);
    assert!(file.contains("file = \"imu.zip\""), "{file}");
    ends_there(end);
    fs::write(
        dir.join("both.zip"),
        stored(&[b"t,x\n0,1\n", b"t,y\n0,1\n"]),
    )
    .unwrap();
    let run = undrift(&["navigate", "both.zip"], &dir);
    let said = String::from_utf8_lossy(&run.stderr).into_owned();
    assert!(
        run.status.code() == Some(1) && said.contains("not a drive file or a log; extract it"),
        "{said}"
    );
    fs::remove_dir_all(&dir).unwrap();
}

/// An archive of files as they are, called a, b and so on; nobody reads the sums.
fn stored(files: &[&[u8]]) -> Vec<u8> {
    let (mut archive, mut entries) = (Vec::new(), Vec::new());
    for (name, file) in (b'a'..).zip(files) {
        let (at, size) = (archive.len() as u32, file.len() as u32);
        let about = [[0; 4], size.to_le_bytes(), size.to_le_bytes(), [1, 0, 0, 0]].concat();
        archive.extend(
            [
                &b"PK\x03\x04\x14\0\0\0\0\0\0\0\0\0"[..],
                &about,
                &[name],
                file,
            ]
            .concat(),
        );
        let place = [&[0; 10][..], &at.to_le_bytes(), &[name]].concat();
        entries.extend(
            [
                &b"PK\x01\x02\x14\0\x14\0\0\0\0\0\0\0\0\0"[..],
                &about,
                &place,
            ]
            .concat(),
        );
    }
    let count = (files.len() as u16).to_le_bytes();
    let (at, size) = (archive.len() as u32, entries.len() as u32);
    let end = [
        &b"PK\x05\x06\0\0\0\0"[..],
        &count,
        &count,
        &size.to_le_bytes(),
        &at.to_le_bytes(),
        &[0, 0],
    ];
    [archive, entries, end.concat()].concat()
}
