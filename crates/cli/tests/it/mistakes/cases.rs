//! The mistakes themselves.

use super::{Case, Log, Mistake, drive, logs::logs, mistake};
use crate::bad_input::log::Row;

/// The mistakes in groups.
pub fn cases() -> Vec<(&'static str, Vec<Mistake>)> {
    vec![
        ("Files", files()),
        ("Drive file", drive_file()),
        ("Units and axes", units()),
        ("Times", times()),
        ("GNSS", gnss()),
        ("Static recordings", recordings()),
        ("Models", models()),
        ("Outages, tuning and reports", verbs()),
        ("Command line and results", command_line()),
        ("Logs of other programs", logs()),
    ]
}

fn files() -> Vec<Mistake> {
    let log = |what, bytes: fn(&Case)| drive(what, |_| ()).files(bytes);
    vec![
        drive("the name of the log is misspelt", |log| {
            log.set("\"imu.csv\"", "\"imu.cvs\"");
        }),
        mistake(
            "the name of the drive file is misspelt",
            "navigate drve.toml",
        ),
        mistake("a folder instead of a drive file", "navigate ."),
        drive("a folder instead of a log", |log| {
            log.set("\"imu.csv\"", "\".\"");
        }),
        mistake("the log of the receiver is forgotten", "navigate imu.csv"),
        mistake(
            "a drive file made of one log",
            "inspect imu.csv -o one.toml",
        ),
        mistake("a drive file and a log", "navigate drive.toml gnss.csv"),
        log("the log is empty", |case| case.put("imu.csv", b"")),
        log("the log has a header alone", |case| {
            case.put("imu.csv", b"t,gx,gy,gz,fx,fy,fz\n")
        }),
        drive("the log has one row", |log| log.imu.truncate(1)),
        log("the download is a login page", |case| {
            case.put(
                "gnss.csv",
                b"<!DOCTYPE html>\n<html><body>Sign in</body></html>\n",
            );
        }),
        log("the repository was cloned without Git LFS", |case| {
            case.put(
                "imu.csv",
                b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 9\n",
            );
        }),
        log("a workbook instead of CSV", |case| {
            case.put("imu.csv", b"PK\x03\x04\x14\0\x06\0")
        }),
        log("raw GNSS observations instead of positions", |case| {
            let line = format!(
                "{:20}{:40}RINEX VERSION / TYPE\n",
                "     3.04", "OBSERVATION DATA"
            );
            case.put("gnss.csv", line.as_bytes());
        }),
        log("saved as Unicode by an editor on Windows", |case| {
            let text = case.read("imu.csv").unwrap();
            let bytes = format!("\u{feff}{text}")
                .encode_utf16()
                .flat_map(u16::to_le_bytes)
                .collect::<Vec<u8>>();
            case.put("imu.csv", &bytes);
        }),
        log("semicolons and decimal commas", |case| {
            let text = case.read("imu.csv").unwrap();
            case.put(
                "imu.csv",
                text.replace(',', ";").replace('.', ",").as_bytes(),
            );
        }),
        log("decimal commas between commas", |case| {
            let text = case.read("imu.csv").unwrap();
            case.put("imu.csv", text.replace('.', ",").as_bytes());
        }),
        log("no header", |case| {
            let text = case.read("imu.csv").unwrap();
            case.put("imu.csv", text.split_once('\n').unwrap().1.as_bytes());
        }),
        drive("a column is NaN from end to end", |log| {
            for row in &mut log.imu {
                row.fields[3] = "nan".into();
            }
        }),
    ]
}

fn drive_file() -> Vec<Mistake> {
    vec![
        drive("wrong name of a column", |log| {
            log.set(
                "[\"gx\", \"gy\", \"gz\"]",
                "[\"gyro_x\", \"gyro_y\", \"gyro_z\"]",
            );
        }),
        drive("name of a column in the wrong case", |log| {
            log.set("[\"gx\", \"gy\", \"gz\"]", "[\"GX\", \"GY\", \"GZ\"]");
        }),
        drive("two columns for three axes", |log| {
            log.set("[\"gx\", \"gy\", \"gz\"]", "[\"gx\", \"gy\"]");
        }),
        drive("misspelt key", |log| {
            log.set("gyro_unit", "gyro_units");
        }),
        drive("misspelt table", |log| {
            log.set("[gnss]", "[gnns]");
        }),
        drive("no GNSS", |log| {
            log.drive.truncate(log.drive.find("[gnss]").unwrap());
        }),
        drive("no time column", |log| {
            log.set("time = \"t\"\ngyro", "gyro");
        }),
        drive("a unit is missing", |log| {
            log.set("gyro_unit = \"rad/s\"\n", "");
        }),
        drive("misspelt unit", |log| {
            log.set("\"rad/s\"", "\"degs\"");
        }),
        drive("a unit of another quantity", |log| {
            log.set("\"rad/s\"", "\"m/s\"");
        }),
        drive("a number without its unit", |log| {
            log.set("\"0.05 m/s\"", "0.05");
        }),
        drive("text without quotes", |log| {
            log.set("file = \"imu.csv\"", "file = imu.csv");
        }),
        drive("backslashes in a path", |log| {
            log.set("\"imu.csv\"", "\"C:\\logs\\imu.csv\"");
        }),
        drive("a table twice", |log| {
            log.drive += "[imu]\nrate = \"100 Hz\"\n"
        }),
        drive("a rate that is not the log's", |log| {
            log.set("gyro_unit", "rate = \"50 Hz\"\ngyro_unit");
        }),
        drive("lever arm in cm, called m", |log| {
            log.set("[truth]", "lever_arm = \"50, 0, -120 m\"\n[truth]");
        }),
        drive("left-handed axes", |log| {
            log.set("gyro_unit", "axes = \"x,y,-z\"\ngyro_unit");
        }),
    ]
}

fn scaled(log: &mut Log, columns: std::ops::Range<usize>, factor: f64) {
    for row in &mut log.imu {
        for column in columns.clone() {
            let value = row.number(column);
            row.put(column, &[value * factor]);
        }
    }
}

fn units() -> Vec<Mistake> {
    vec![
        drive("gyros in deg/s, called rad/s", |log| {
            scaled(log, 1..4, 57.295_779_5)
        }),
        drive("gyros in rad/s, called deg/s", |log| {
            log.set("\"rad/s\"", "\"deg/s\"");
        }),
        drive("accelerometers in g, called m/s²", |log| {
            scaled(log, 4..7, 1.0 / 9.806_65)
        }),
        drive("accelerometers in m/s², called g", |log| {
            log.set("\"m/s^2\"", "\"g\"");
        }),
        drive("the IMU faces backwards", |log| {
            scaled(log, 1..3, -1.0);
            scaled(log, 4..6, -1.0);
        }),
        drive("the IMU is upside down", |log| {
            scaled(log, 2..4, -1.0);
            scaled(log, 5..7, -1.0);
        }),
        drive("accelerometer x and y exchanged", |log| {
            log.set("[\"fx\", \"fy\", \"fz\"]", "[\"fy\", \"fx\", \"fz\"]");
        }),
        drive("a gyro that is constant", |log| {
            for row in &mut log.imu {
                row.put(3, &[0.0]);
            }
        }),
    ]
}

fn stamped(rows: &mut [Row], time: impl Fn(f64) -> f64) {
    for row in rows {
        *row = row.at(time(row.time));
    }
}

fn times() -> Vec<Mistake> {
    vec![
        drive("the IMU's ms, called s", |log| {
            stamped(&mut log.imu, |t| 1e3 * t)
        }),
        drive("the receiver's ms, called s", |log| {
            stamped(&mut log.gnss, |t| 1e3 * t)
        }),
        drive("days of a spreadsheet, called s", |log| {
            for row in log.imu.iter_mut().chain(&mut log.gnss) {
                row.fields[0] = format!("{:.10}", 45_846.5 + row.time / 86_400.0);
            }
        }),
        drive("IMU since boot, GNSS in Unix time", |log| {
            stamped(&mut log.gnss, |t| 1.7e9 + t);
        }),
        drive("the receiver an hour off", |log| {
            stamped(&mut log.gnss, |t| t + 3600.0)
        }),
        drive("GPS time and UTC mixed", |log| {
            stamped(&mut log.gnss, |t| t + 18.0)
        }),
        drive("rows in reverse", |log| log.imu.reverse()),
        drive("rows in disorder", |log| {
            for k in (1000..log.imu.len() - 200).step_by(200) {
                log.imu.swap(k, k + 1);
            }
        }),
        drive("stamps of whole seconds", |log| {
            stamped(&mut log.imu, f64::floor)
        }),
        drive("a gap of 10 s", |log| {
            log.imu.retain(|row| !(60.0..70.0).contains(&row.time));
        }),
        drive("[span] outside the log", |log| {
            log.drive += "[span]\nstart = \"500 s\"\nend = \"600 s\"\n"
        }),
    ]
}

fn gnss() -> Vec<Mistake> {
    vec![
        drive("latitude and longitude exchanged", |log| {
            log.set(
                "[\"lat\", \"lon\", \"height\"]",
                "[\"lon\", \"lat\", \"height\"]",
            );
        }),
        drive("latitude and longitude in rad", |log| {
            for row in &mut log.gnss {
                let place = [row.number(1).to_radians(), row.number(2).to_radians()];
                row.put(1, &place);
            }
        }),
        drive("latitude and longitude in 1e-7 deg", |log| {
            for row in &mut log.gnss {
                let place = [row.number(1) * 1e7, row.number(2) * 1e7];
                row.put(1, &place);
            }
        }),
        drive("velocity east, north, up", |log| {
            log.set(
                "[\"vn\", \"ve\", \"vd\"]\nvelocity_std",
                "[\"ve\", \"vn\", \"vd\"]\nvelocity_std",
            );
        }),
        drive("velocity in km/h, called m/s", |log| {
            for row in &mut log.gnss {
                let velocity = [4, 5, 6].map(|column| 3.6 * row.number(column));
                row.put(4, &velocity);
            }
        }),
        drive("the receiver never had a fix", |log| {
            for row in &mut log.gnss {
                row.put(1, &[0.0; 3]);
            }
        }),
        drive("the vehicle never moved", |log| {
            log.imu.retain(|row| row.time < 14.0);
            log.gnss.retain(|row| row.time < 14.0);
        }),
    ]
}

/// Rows of a static recording at 100 Hz, in deg/s and g, each changed by `of` its time and values.
pub fn record(rows: u32, header: &str, of: impl Fn(f64, &mut [f64; 6])) -> String {
    let mut text = format!("{header}\n");
    let mut state = 1u64;
    let mut noise = || {
        let mut sum = -6.0;
        for _ in 0..12 {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            sum += (state >> 11) as f64 / (1u64 << 53) as f64;
        }
        sum
    };
    for k in 0..rows {
        let time = f64::from(k) / 100.0;
        let mut row = [0.1, 0.1, 0.1, 0.001, 0.001, 0.001].map(|scale| scale * noise());
        row[5] -= 1.0;
        of(time, &mut row);
        let row = row.map(|value| format!("{value:.6}")).join(",");
        text += &format!("{time:.2},{row}\n");
    }
    text
}

pub const HEADER: &str = "t_s,gx_dps,gy_dps,gz_dps,ax_g,ay_g,az_g";
const BARE: &str = "a,b,c,d,e,f,g";

fn recordings() -> Vec<Mistake> {
    let of = |what, command, files: fn(&Case)| mistake(what, command).files(files);
    vec![
        of(
            "a recording that moves",
            "identify record.csv -o imu.toml",
            |case| {
                let text = record(6000, HEADER, |t, row| {
                    if t > 40.0 {
                        row[2] += 15.0 * (t / 2.0).sin();
                        row[3] += 0.2 * (t / 3.0).cos();
                    }
                });
                case.put("record.csv", text.as_bytes());
            },
        ),
        of(
            "a recording of half a second",
            "identify record.csv -o imu.toml",
            |case| {
                case.put("record.csv", record(50, HEADER, |_, _| ()).as_bytes());
            },
        ),
        of(
            "accelerations without gravity",
            "identify record.csv -o imu.toml",
            |case| {
                let text = record(3000, HEADER, |_, row| row[5] += 1.0);
                case.put("record.csv", text.as_bytes());
            },
        ),
        of(
            "raw counts, called g",
            "identify record.csv -o imu.toml",
            |case| {
                let text = record(3000, HEADER, |_, row| {
                    for value in &mut row[3..] {
                        *value = (*value * 16384.0).round();
                    }
                });
                case.put("record.csv", text.as_bytes());
            },
        ),
        of(
            "a constant column",
            "identify record.csv -o imu.toml",
            |case| {
                let text = record(3000, HEADER, |_, row| row[1] = 0.0);
                case.put("record.csv", text.as_bytes());
            },
        ),
        of(
            "names that tell nothing",
            "identify record.csv -o imu.toml",
            |case| {
                case.put(
                    "record.csv",
                    record(3000, BARE, |_, row| row[0] = 9.0).as_bytes(),
                );
            },
        ),
        of(
            "no time column and no rate",
            "identify record.csv --columns b,c,d,e,f,g --units deg/s,g -o imu.toml",
            |case| case.put("record.csv", record(3000, BARE, |_, _| ()).as_bytes()),
        ),
        of(
            "a misspelt unit",
            "identify record.csv --units dgs/s,g -o imu.toml",
            |case| case.put("record.csv", record(3000, BARE, |_, _| ()).as_bytes()),
        ),
        of(
            "one unit for two sensors",
            "identify record.csv --units deg/s -o imu.toml",
            |case| case.put("record.csv", record(3000, HEADER, |_, _| ()).as_bytes()),
        ),
        of(
            "a span outside the recording",
            "identify record.csv --span 100,200 -o imu.toml",
            |case| case.put("record.csv", record(3000, HEADER, |_, _| ()).as_bytes()),
        ),
    ]
}

/// A model file made from a preset, with a piece replaced.
fn model(case: &Case, from: &str, to: &str) {
    let done = case.run(&["model", "adis16465", "--to", "undrift"]);
    assert!(done.stdout.contains(from), "no {from} in {}", done.stdout);
    case.put("imu.toml", done.stdout.replacen(from, to, 1).as_bytes());
}

fn models() -> Vec<Mistake> {
    let by = "navigate drive.toml --model imu.toml";
    vec![
        mistake("unknown preset", "navigate drive.toml --model adis16456"),
        mistake(
            "a drive file as the model",
            "navigate drive.toml --model drive.toml",
        ),
        mistake("a log as the model", "navigate drive.toml --model imu.csv"),
        mistake(
            "Kalibr's imu.yaml lacks a number",
            "navigate drive.toml --model imu.yaml",
        )
        .files(|case| {
            let yaml = "accelerometer_noise_density: 2e-3\ngyroscope_noise_density: 2e-4\ngyroscope_random_walk: 3e-5\n";
            case.put("imu.yaml", yaml.as_bytes());
        }),
        mistake("a model file as the drive file", "navigate imu.toml")
            .files(|case| model(case, "format", "format")),
        mistake("a negative σ", by).files(|case| {
            let done = case.run(&["model", "adis16465", "--to", "undrift"]);
            let at = done.stdout.find("white_noise = \"").unwrap() + "white_noise = \"".len();
            let (head, tail) = done.stdout.split_at(at);
            case.put("imu.toml", format!("{head}-{tail}").as_bytes());
        }),
        mistake("misspelt key of a model", by)
            .files(|case| model(case, "white_noise", "white_nois")),
        drive("no model", |log| {
            log.set("model = \"adis16465\"\n", "");
        }),
        mistake(
            "unknown bias model",
            "navigate drive.toml --bias-model gaussmarkov",
        ),
        mistake("unknown format of a model", "model adis16465 --to kalibre"),
    ]
}

fn verbs() -> Vec<Mistake> {
    vec![
        mistake(
            "--length longer than the drive",
            "outages drive.toml --length 600 --count 2",
        ),
        mistake(
            "--start after the end",
            "outages drive.toml --start 500 --count 2",
        ),
        mistake("--at before the first fix", "outages drive.toml --at -20"),
        mistake(
            "too many outages",
            "outages drive.toml --start 30 --length 10 --count 50",
        ),
        Mistake {
            log: |log| {
                log.imu.retain(|row| row.time < 30.0);
                log.gnss.retain(|row| row.time < 30.0);
            },
            ..mistake(
                "a drive too short to tune with",
                "tune drive.toml -o tuned.toml",
            )
        },
        mistake("--hold-out in percent", "tune drive.toml --hold-out 30"),
        mistake("a drive file as a specification", "montecarlo drive.toml"),
        mistake("a solution as a result", "report gnss.csv -o report.html"),
        mistake("a pattern that matches nothing", "fleet *.tml -o out"),
        mistake("a drive file to be inspected", "inspect drive.toml"),
    ]
}

fn command_line() -> Vec<Mistake> {
    vec![
        mistake("misspelt verb", "navigat drive.toml"),
        mistake("misspelt option", "navigate drive.toml --ouput nav.csv"),
        mistake(
            "an option of another verb",
            "navigate drive.toml --length 10",
        ),
        mistake("no drive file", "navigate"),
        mistake(
            "unknown format of a solution",
            "navigate drive.toml -o nav.xlsx",
        ),
        mistake(
            "unknown name of a format",
            "navigate drive.toml -o nav.txt --format txt",
        ),
        mistake(
            "the folder of the result is missing",
            "navigate drive.toml -o results/nav.csv",
        ),
        mistake("the result is an input", "navigate drive.toml -o imu.csv"),
        mistake("--json into a folder", "navigate drive.toml --json logs")
            .files(|case| std::fs::create_dir(case.path("logs")).unwrap()),
        mistake("the result is read-only", "navigate drive.toml -o nav.csv").files(|case| {
            case.put("nav.csv", b"mine");
            let path = case.path("nav.csv");
            let mut permissions = std::fs::metadata(&path).unwrap().permissions();
            permissions.set_readonly(true);
            std::fs::set_permissions(&path, permissions).unwrap();
        }),
        mistake(
            "two results in one file",
            "navigate drive.toml -o a.csv --json a.csv",
        ),
        mistake(
            "a report that is no HTML",
            "navigate drive.toml --report report.pdf",
        ),
    ]
}
