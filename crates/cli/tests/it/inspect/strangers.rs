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
    let logs = ["imu.csv", "gnss.csv"];
    text(&undrift(
        &[&["inspect"], &logs[..], &["-o", "drive.toml"]].concat(),
        &dir,
    ));
    let file = fs::read_to_string(dir.join("drive.toml")).unwrap();
    let run = undrift(&["navigate", "drive.toml", "-o", "nav.csv"], &dir);
    assert!(text(&run).contains("navigated"), "{file}");
    let nav = fs::read_to_string(dir.join("nav.csv")).unwrap();
    let names: Vec<&str> = nav.lines().next().unwrap().split(',').collect();
    let last: Vec<&str> = nav.lines().last().unwrap().split(',').collect();
    let end = ["lat_deg", "lon_deg"].map(|name| {
        let place = names.iter().position(|known| *known == name).unwrap();
        last[place].parse().unwrap()
    });
    fs::remove_dir_all(&dir).unwrap();
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
