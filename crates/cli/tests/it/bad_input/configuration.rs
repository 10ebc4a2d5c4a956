//! Mistakes in the drive file and the model file: each message names file, line, key and the mend.

use super::log::{Log, says};

#[test]
fn mistakes_in_the_drive_file() {
    // What is replaced, by what, and what is said of it.
    let cases: &[(&str, &str, &str, &[&str])] = &[
        (
            "unit_rate",
            "\"rad/s\"",
            "\"deg\"",
            &[
                "drive.toml line 6, imu.gyro_unit: \"deg\": that is the unit of an angle",
                "expected an angular rate such as \"deg/s\" or \"rad/s\"",
            ],
        ),
        (
            "unit_accel",
            "\"m/s^2\"",
            "\"m/s\"",
            &[
                "drive.toml line 8, imu.accel_unit: \"m/s\": that is the unit of a velocity",
                "expected an acceleration",
            ],
        ),
        (
            "unit_unknown",
            "\"rad/s\"",
            "\"rod/s\"",
            &["line 6, imu.gyro_unit", "unknown unit \"rod\""],
        ),
        (
            "unit_missing",
            "gyro_unit = \"rad/s\"\n",
            "",
            &[
                "drive.toml line 2, imu.gyro_unit: missing: the unit of the columns, \"deg/s\" or \"rad/s\"",
            ],
        ),
        (
            "unit_number",
            "\"0.05 m/s\"",
            "0.05",
            &["line 15, gnss.velocity_std", "needs a unit"],
        ),
        (
            "unit_none",
            "\"0.05 m/s\"",
            "\"0.05\"",
            &["line 15, gnss.velocity_std", "the unit is missing"],
        ),
        (
            "no_position",
            "position = [\"lat\", \"lon\", \"height\"]\nposition_std_columns = [\"sn\", \"se\", \"sd\"]\n",
            "",
            &["line 9, gnss.position: missing: set position (columns latitude, longitude, height)"],
        ),
        (
            "no_velocity",
            "velocity = [\"vn\", \"ve\", \"vd\"]\n",
            "use = \"velocity\"\n",
            &["line 14, gnss.use: \"velocity\" needs velocity columns"],
        ),
        (
            "std_zero",
            "\"0.05 m/s\"",
            "\"0.05, 0, 0.05 m/s\"",
            &["gnss.velocity_std", "must be positive"],
        ),
        (
            "two_of_three",
            "\"0.05 m/s\"",
            "\"0.05, 1 m/s\"",
            &["gnss.velocity_std", "one number, or three"],
        ),
        (
            "key",
            "gyro_unit",
            "axis = \"x,y,z\"\ngyro_unit",
            &[
                "drive.toml line 6, imu.axis: unknown key; did you mean axes? known here: ",
                "accel_unit",
                "axes",
                "mounting",
            ],
        ),
        (
            "key_top",
            "model =",
            "modell =",
            &[
                "drive.toml line 1, modell: unknown key; did you mean model? known here: barometer, epoch, gnss, heading, imu, initial, local, magnetometer, model, odometer, poses, span, states, truth, vehicle",
            ],
        ),
        (
            "table_top",
            "[gnss]",
            "[gps]",
            &["drive.toml line 9, gps: unknown key", "gnss"],
        ),
        (
            "preset",
            "adis16465",
            "adis99999",
            &[
                "drive.toml line 1, model: ",
                "adis99999",
                "a model is a file or a preset; `undrift model --list` shows the presets",
            ],
        ),
        (
            "model_number",
            "\"adis16465\"",
            "5",
            &["drive.toml line 1, model: must be a preset's name"],
        ),
        (
            "axes_left",
            "gyro_unit",
            "axes = \"x,y,-z\"\ngyro_unit",
            &[
                "drive.toml line 6, imu.axes: \"x,y,-z\" is left-handed: one sign is wrong or two axes are swapped",
            ],
        ),
        (
            "axes_twice",
            "gyro_unit",
            "axes = \"x,x,z\"\ngyro_unit",
            &["imu.axes", "contains an axis twice"],
        ),
        (
            "axes_two",
            "gyro_unit",
            "axes = \"x,y\"\ngyro_unit",
            &["imu.axes", "such as \"y,x,-z\""],
        ),
        (
            "axes_both",
            "gyro_unit",
            "axes = \"x,y,z\"\nmounting = \"0, 0, 9 deg\"\ngyro_unit",
            &["line 7, imu.mounting: set axes or mounting, not both"],
        ),
        (
            "column",
            "\"gx\"",
            "\"wx\"",
            &[
                "imu.csv line 1: no column \"wx\" (key imu.gyro); the file has: t, gx, gy, gz, fx, fy, fz",
            ],
        ),
        (
            "column_number",
            "[\"gx\", \"gy\", \"gz\"]",
            "[2, 3, 44]",
            &["imu.csv", "no column 44", "imu.gyro"],
        ),
        (
            "column_zero",
            "[\"gx\", \"gy\", \"gz\"]",
            "[0, 1, 2]",
            &["imu.gyro: columns are numbered from 1"],
        ),
        (
            "column_two",
            "[\"gx\", \"gy\", \"gz\"]",
            "[\"gx\", \"gy\"]",
            &["imu.gyro", "list of three columns"],
        ),
        (
            "column_gnss",
            "\"lat\"",
            "\"latitude\"",
            &[
                "gnss.csv line 1: no column \"latitude\" (key gnss.position); the file has: t, lat, lon",
            ],
        ),
        (
            "no_std",
            "position_std_columns = [\"sn\", \"se\", \"sd\"]\n",
            "",
            &[
                "line 9, gnss.position_std: missing",
                "\"north, east, down m\"",
            ],
        ),
        (
            "file",
            "\"imu.csv\"",
            "\"imv.csv\"",
            &["imv.csv: no such file; did you mean imu.csv?"],
        ),
        (
            "file_gnss",
            "\"gnss.csv\"",
            "\"gns.csv\"",
            &["gns.csv: no such file; did you mean gnss.csv?"],
        ),
        (
            "file_truth",
            "\"truth.csv\"",
            "\"truht.csv\"",
            &["truht.csv: no such file; did you mean truth.csv?"],
        ),
        (
            "file_none",
            "file = \"imu.csv\"\n",
            "",
            &["line 2, imu.file: missing: the file name"],
        ),
        (
            "time_none",
            "time = \"t\"\n",
            "",
            &["line 2, imu.time: missing", "rate"],
        ),
        (
            "rate_wrong",
            "time = \"t\"\n",
            "time = \"t\"\nrate = \"200 Hz\"\n",
            &[
                "imu.csv: the time column gives 50 Hz",
                "imu.rate is 200 Hz; correct imu.rate",
            ],
        ),
        (
            "rate_zero",
            "time = \"t\"\n",
            "time = \"t\"\nrate = \"0 Hz\"\n",
            &["imu.rate: must be above 0 Hz"],
        ),
        ("syntax", "[gnss]", "[gnss", &["drive.toml line 9: "]),
        (
            "span",
            "[gnss]",
            "[span]\nstart = \"9 s\"\nend = \"8 s\"\n[gnss]",
            &["line 11, span.end: must be later than span.start"],
        ),
        (
            "span_outside",
            "[gnss]",
            "[span]\nstart = \"900 s\"\n[gnss]",
            &[
                "imu.csv: ends at 80 s, before [span] begins at 900 s",
                "correct [span]",
            ],
        ),
        (
            "heading",
            "[truth]",
            "[initial]\nheading = \"curse\"\n[truth]",
            &["initial.heading: \"curse\" is neither \"course\" nor \"auto\" nor an angle"],
        ),
        (
            "mounting_twice",
            "time = \"t\"\n",
            "time = \"t\"\nmounting = \"auto\"\ngyro_offset = \"1 deg/s\"\n",
            &[
                "imu.gyro_offset: refers to body axes, which are unknown until the mounting is estimated",
            ],
        ),
    ];
    for (name, from, to, parts) in cases {
        let mut log = Log::good();
        // The files stay small: it is the drive file that is wrong.
        log.set(from, to);
        let message = log.write(&format!("drive_{name}")).refusal();
        says(&message, parts);
        assert_eq!(message.lines().count(), 1, "{name}: {message}");
    }
}

#[test]
fn a_drive_file_that_is_not_there() {
    let outcome = Log::good()
        .write("no_drive")
        .run(&["navigate", "drvie.toml"]);
    assert_eq!(outcome.code, Some(1));
    says(
        &outcome.stderr,
        &["error: drvie.toml: no such file; did you mean drive.toml?"],
    );
}

#[test]
fn models_and_bias_models_on_the_command_line() {
    let case = Log::good().write("models");
    let run = |arguments: &[&str]| case.run(&[&["navigate", "drive.toml"], arguments].concat());
    let outcome = run(&["--bias-model", "markov"]);
    assert_eq!(outcome.code, Some(2));
    says(
        &outcome.stderr,
        &[
            "unknown bias model \"markov\"; available: white, paper, gauss-markov, random-walk, ar, arma",
        ],
    );
    let outcome = run(&["--model", "adis1"]);
    assert_eq!(outcome.code, Some(1));
    says(
        &outcome.stderr,
        &[
            "adis1",
            "a model is a file or a preset; did you mean adis16405 or adis16465 or adis16470?",
            "`undrift model --list` shows the presets",
        ],
    );
    assert!(run(&["--model", "mpu6050"]).succeeded());

    let head = "format = \"undrift-imu\"\nversion = 1\n";
    let whole =
        "[gyro]\nwhite_noise = \"0.1 deg/sqrt(h)\"\n[accel]\nwhite_noise = \"0.02 m/s/sqrt(h)\"\n";
    for (text, parts) in [
        (format!("{head}[gyro\n{whole}"), &["imu.toml line 3: "][..]),
        (
            whole.to_owned(),
            &["imu.toml, format: missing; a model file starts with format = \"undrift-imu\""],
        ),
        (
            format!("{head}{}", whole.replace("deg/sqrt(h)", "deg/s")),
            &[
                "imu.toml line 4, gyro.white_noise: \"0.1 deg/s\": that is the unit of an angular rate",
                "expected an angle random walk",
            ],
        ),
        (
            format!("{head}{}", whole.replace("\"0.1 deg/sqrt(h)\"", "0.1")),
            &["imu.toml line 4, gyro.white_noise: the number needs a unit"],
        ),
        (
            format!("{head}{whole}noise = \"1 mg\"\n"),
            &[
                "imu.toml line 7, accel.noise: unknown key; known here: arma, bias_instability, correlation_time",
            ],
        ),
        (
            format!("{head}{whole}bias_instability = \"1 mg\"\n"),
            &[
                "imu.toml line 7, accel.bias_instability: ",
                "needs a correlation_time",
            ],
        ),
        (
            format!("{head}[gyro]\nwhite_noise = \"1 deg/sqrt(h)\"\n"),
            &["imu.toml: accel_x: no noise model; give [accel] for all three axes, or [accel_x]"],
        ),
        (
            format!("{}{whole}", head.replace('1', "2")),
            &["imu.toml line 2, version: this program reads version 1"],
        ),
    ] {
        case.put("imu.toml", text.as_bytes());
        let outcome = run(&["--model", "imu.toml"]);
        assert_eq!(outcome.code, Some(1), "{text}");
        says(&outcome.stderr, parts);
    }
    case.put("imu.toml", format!("{head}{whole}").as_bytes());
    assert!(run(&["--model", "imu.toml"]).succeeded());
}

#[test]
fn without_a_model_the_message_says_where_the_presets_are() {
    let mut log = Log::good();
    log.set("model = \"adis16465\"\n", "");
    let message = log.write("no_model").refusal();
    says(
        &message,
        &[
            "no noise model: specify one with --model",
            "`undrift model --list` shows the presets",
        ],
    );
}

#[test]
fn a_mistake_in_an_inline_model_has_its_line_in_the_drive_file() {
    let mut log = Log::good();
    log.set(
        "model = \"adis16465\"\n",
        "[model]\npreset = \"adis16465\"\ngyro.turn_on = \"1 m\"\n",
    );
    let message = log.write("inline_model").refusal();
    says(
        &message,
        &["drive.toml line 3, model.gyro.turn_on: \"1 m\": that is the unit of a length"],
    );
}

#[test]
fn a_unit_that_each_number_carries_itself_is_understood() {
    let mut log = Log::good();
    log.set("\"0.05 m/s\"", "\"5 cm/s, 0.05, 0.05 m/s\"");
    let (outcome, _) = log.write("own_units").solution();
    assert_eq!(outcome.stderr, "");
}

const DRIVE_DOC: &str = include_str!("../../../../../docs/drive-file.md");
const IMU_DOC: &str = include_str!("../../../../../docs/imu-file.md");

/// The first TOML example of a page.
fn example(page: &str) -> &str {
    let (_, after) = page.split_once("```toml\n").unwrap();
    after.split_once("```").unwrap().0
}

#[test]
fn every_key_of_the_drive_file_is_in_its_page() {
    for (table, from) in [
        ("imu", "[imu]\n"),
        ("gnss", "[gnss]\n"),
        ("truth", "[truth]\n"),
        ("initial", "[gnss]\n"),
        ("span", "[gnss]\n"),
        ("vehicle", "[gnss]\n"),
        ("states", "[gnss]\n"),
        ("odometer", "[gnss]\n"),
        ("barometer", "[gnss]\n"),
        ("heading", "[gnss]\n"),
        ("magnetometer", "[gnss]\n"),
    ] {
        let mut log = Log::good();
        let to = if from == format!("[{table}]\n") {
            format!("{from}bogus = 1\n")
        } else {
            // What these two cannot do without comes first.
            let needed = match table {
                "odometer" => "file = \"w\"\ntime = 1\nspeed = 2\nspeed_unit = \"m/s\"\n",
                "barometer" => "file = \"w\"\ntime = 1\nheight = 2\n",
                "heading" => "file = \"w\"\ntime = 1\nheading = 2\n",
                "magnetometer" => {
                    "file = \"w\"\ntime = 1\nfield = [2, 3, 4]\nfield_unit = \"uT\"\n"
                }
                _ => "",
            };
            format!("[{table}]\n{needed}bogus = 1\n{from}")
        };
        log.set(from, &to);
        let message = log.write(&format!("keys_{table}")).refusal();
        let (_, keys) = message.split_once("known here: ").unwrap();
        let (_, section) = DRIVE_DOC
            .split_once(&format!("\n## `[{table}]`\n"))
            .unwrap();
        let section = section.split("\n## ").next().unwrap();
        let keys: Vec<&str> = keys.trim().split(", ").collect();
        assert!(keys.len() >= 2, "{table}: {keys:?}");
        for key in keys {
            assert!(section.contains(&format!("`{key}`")), "{table}.{key}");
        }
    }
}

#[test]
fn the_examples_of_the_pages_are_understood() {
    let mut log = Log::good();
    log.drive = example(DRIVE_DOC).to_owned();
    says(
        &log.write("doc_drive").refusal(),
        &["error: imu.csv.gz: no such file; did you mean imu.csv?"],
    );
    let case = Log::good().write("doc_imu");
    case.put("imu.toml", example(IMU_DOC).as_bytes());
    let outcome = case.run(&["navigate", "drive.toml", "--model", "imu.toml"]);
    assert!(outcome.succeeded(), "{}", outcome.stderr);
}
