//! The `identify` command on small records: what it writes, and how it refuses invalid ones.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use undrift::{
    nav::shaping::ShapingFilter,
    noise::{BiasModel, ImuModel, synthesis::NoiseGenerator},
};

fn folder(name: &str) -> PathBuf {
    let folder =
        std::env::temp_dir().join(format!("undrift-identify-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn identify(folder: &Path, record: &str, arguments: &[&str]) -> Output {
    std::fs::write(folder.join("record.csv"), record).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_undrift"))
        .current_dir(folder)
        .args(["identify", "record.csv"])
        .args(arguments)
        .output()
        .unwrap();
    assert!(
        !String::from_utf8_lossy(&output.stderr).contains("panicked"),
        "{output:?}"
    );
    output
}

/// A record of `samples` rows with white noise on every axis, z at −g.
fn record(header: &str, samples: usize) -> String {
    let white =
        |density, seed| NoiseGenerator::new(&ShapingFilter::white(density, 0.01).unwrap(), seed);
    let mut axes = [
        white(0.03, 1),
        white(0.03, 2),
        white(0.03, 3),
        white(1e-3, 4),
        white(1e-3, 5),
        white(1e-3, 6),
    ];
    let mut text = format!("{header}\n");
    for _ in 0..samples {
        let mut row: Vec<f64> = axes.iter_mut().map(NoiseGenerator::sample).collect();
        row[5] -= 1.0;
        let fields: Vec<String> = row.iter().map(|x| format!("{x:.6}")).collect();
        text += &fields.join(",");
        text.push('\n');
    }
    text
}

const HEADER: &str = "gx_dps,gy_dps,gz_dps,ax_g,ay_g,az_g";

#[test]
fn standard_input_and_pipes_are_read_like_the_file() {
    let folder = folder("pipe");
    let arguments = ["--rate", "100", "--json"];
    let text = record(HEADER, 3000);
    let file = identify(&folder, &text, &[&arguments[..], &["file.json"]].concat());
    assert!(file.status.success(), "{file:?}");
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    std::io::Write::write_all(&mut encoder, text.as_bytes()).unwrap();
    std::fs::write(folder.join("record.csv.gz"), encoder.finish().unwrap()).unwrap();
    let program = env!("CARGO_BIN_EXE_undrift");
    let json = |name: &str| -> serde_json::Value {
        let text = std::fs::read_to_string(folder.join(name)).unwrap();
        serde_json::from_str(&text).unwrap()
    };
    for (k, line) in [
        "cat record.csv | $0 identify - $@",
        "cat record.csv.gz | $0 identify - $@",
        "$0 identify <(cat record.csv) $@",
        "$0 identify /dev/stdin $@ < <(cat record.csv)",
    ]
    .iter()
    .enumerate()
    {
        let name = format!("{k}.json");
        let output = Command::new("bash")
            .current_dir(&folder)
            .args(["-c", line, program])
            .args(arguments)
            .arg(&name)
            .output()
            .unwrap();
        assert!(output.status.success(), "{line}: {output:?}");
        assert_eq!(json(&name)["axes"], json("file.json")["axes"], "{line}");
    }
}

#[test]
fn a_record_becomes_a_model_that_makes_filters() {
    let folder = folder("model");
    let arguments = ["--rate", "100", "-o", "imu.toml", "--json", "found.json"];
    let output = identify(&folder, &record(HEADER, 6000), &arguments);
    assert!(output.status.success(), "{output:?}");
    let model = ImuModel::load(&folder.join("imu.toml")).unwrap();
    assert_eq!(model.provenance.samples, Some(6000));
    assert_eq!(model.provenance.sha256.as_ref().map(String::len), Some(64));
    for (_, axis) in model.axes() {
        axis.shaping(BiasModel::Arma, 0.005).unwrap();
    }
    // 0.03 deg/s/√Hz; 6000 samples give it to 1 %, the fit over τ to some percent.
    let density = model.gyro[0].white_density().to_degrees();
    assert!((density / 0.03 - 1.0).abs() < 0.1, "{density}");
    let text = std::fs::read_to_string(folder.join("found.json")).unwrap();
    let found: serde_json::Value = serde_json::from_str(&text).unwrap();
    let axis = &found["axes"]["gyro_x"];
    for key in [
        "adf",
        "kpss",
        "phillips_perron",
        "jarque_bera",
        "ks",
        "lilliefors",
        "allan",
        "allan_terms",
        "pandit_wu",
        "box_jenkins",
        "scales",
        "candidates",
        "ranking",
        "chosen",
        "motion",
        "detrend",
    ] {
        assert!(!axis[key].is_null(), "{key}");
    }
    for test in ["adf", "kpss", "phillips_perron"] {
        for key in ["statistic", "p_value", "lags"] {
            assert!(axis[test][key].is_number(), "{test} {key}");
        }
        assert!(axis[test]["critical"]["5%"].is_number(), "{test}");
    }
    assert!(axis["adf"]["by_rule"]["aic"]["lags"].is_number());
    for test in ["jarque_bera", "ks", "lilliefors"] {
        for key in ["statistic", "critical_5", "p_value"] {
            assert!(axis[test][key].is_number(), "{test} {key}");
        }
    }
    assert_eq!(axis["samples"], 6000);
    let candidates = axis["candidates"].as_array().unwrap();
    for candidate in candidates {
        assert!(candidate["drift_score"]["1"].is_number(), "{candidate}");
        assert!(candidate["warnings"].is_array(), "{candidate}");
    }
    let arma = candidates
        .iter()
        .find(|c| c["name"] == "ARMA(1,1)")
        .unwrap();
    for key in [
        "p",
        "q",
        "sigma",
        "log_likelihood",
        "aic",
        "bic",
        "ljung_box_p",
    ] {
        assert!(arma[key].is_number(), "{key}");
    }
    let composite = candidates
        .iter()
        .find(|c| c["method"] == "maximum likelihood" && c["p"].is_null());
    if let Some(composite) = composite {
        assert!(composite["wavelet_moments"]["terms"]["white"].is_number());
    }
    // The choice is a whole candidate.
    let chosen = &axis["chosen"];
    let same = candidates
        .iter()
        .find(|c| c["name"] == chosen["name"])
        .unwrap();
    assert_eq!(same["drift_score"], chosen["drift_score"]);
    assert!(chosen["reason"].is_string() && chosen["white"] == same["white"]);
}

#[test]
fn a_record_becomes_a_kalibr_yaml_in_two_commands() {
    let folder = folder("kalibr");
    let record = record(HEADER, 6000);
    let output = identify(&folder, &record, &["--rate", "100", "-o", "imu.toml"]);
    assert!(output.status.success(), "{output:?}");
    let output = Command::new(env!("CARGO_BIN_EXE_undrift"))
        .current_dir(&folder)
        .args(["model", "imu.toml", "--to", "kalibr", "-o", "imu.yaml"])
        .output()
        .unwrap();
    assert!(output.status.success(), "{output:?}");
    let yaml = std::fs::read_to_string(folder.join("imu.yaml")).unwrap();
    let value = |key: &str| -> f64 {
        let line = yaml
            .lines()
            .find_map(|l| l.strip_prefix(&format!("{key}: ")));
        line.unwrap().split("  #").next().unwrap().parse().unwrap()
    };
    // White noise of 0.03 deg/s/√Hz and 1 mg/√Hz; three axes give it to some percent.
    let gyro = value("gyroscope_noise_density");
    assert!((gyro.to_degrees() / 0.03 - 1.0).abs() < 0.1, "{gyro}");
    let accel = value("accelerometer_noise_density");
    assert!((accel / 9.80665e-3 - 1.0).abs() < 0.1, "{accel}");
    assert_eq!(value("update_rate"), 100.0);
    // Sixty seconds of white noise show no bias: the bound is reported as such.
    assert!(yaml.contains("no slow bias was detected in 60 s"), "{yaml}");
    let bound = 3f64.sqrt() * gyro / 6.0;
    assert!((value("gyroscope_random_walk") / bound - 1.0).abs() < 1e-6);
}

#[test]
fn one_axis_becomes_a_model_of_one_axis_or_fills_a_base() {
    let folder = folder("one");
    let text = record(HEADER, 3000);
    let one = ["--rate", "100", "--columns", "gz_dps"];
    // It only reports…
    let output = identify(&folder, &text, &one);
    assert!(
        output.status.success() && output.stderr.is_empty(),
        "{output:?}"
    );
    assert!(!folder.join("imu.toml").exists());
    // … or writes that axis and says what a run lacks…
    let write = [&one[..], &["-o", "imu.toml"]].concat();
    let output = identify(&folder, &text, &write);
    assert!(output.status.success(), "{output:?}");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        said.contains("no gyro_x, gyro_y, accel_x, accel_y, accel_z") && said.contains("--base"),
        "{said}"
    );
    let model = ImuModel::load(&folder.join("imu.toml")).unwrap();
    assert!(model.gyro[2].is_known() && !model.accel[0].is_known());
    let error = model.shaping(BiasModel::Arma, 0.01).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("imu.toml: gyro_x: no noise model"),
        "{error}"
    );
    // … or fills a base.
    let output = identify(
        &folder,
        &text,
        &[&write[..], &["--base", "mpu6050"]].concat(),
    );
    assert!(
        output.status.success() && output.stderr.is_empty(),
        "{output:?}"
    );
    let model = ImuModel::load(&folder.join("imu.toml")).unwrap();
    assert!(
        model.gyro[2].identification.contains_key("drift_scores")
            && model.gyro[0].identification.is_empty()
    );
    model.shaping(BiasModel::Arma, 0.01).unwrap();
}

/// `record` with time stamps of `interval` [s], every seventh moved by `shift` of it.
fn stamped(text: &str, interval: f64, shift: f64) -> String {
    text.lines()
        .enumerate()
        .map(|(k, line)| match k {
            0 => format!("t_s,{line}\n"),
            _ => {
                let moved = if k % 7 == 0 { shift } else { 0.0 };
                format!("{:.5},{line}\n", (k as f64 + moved) * interval)
            }
        })
        .collect()
}

#[test]
fn stamps_that_are_not_even_are_said_and_reported() {
    let folder = folder("uneven");
    let arguments = ["--columns", "gz_dps", "--json", "found.json"];
    let found = |text: &str| -> (String, serde_json::Value) {
        let output = identify(&folder, text, &arguments);
        assert!(output.status.success(), "{output:?}");
        let json = std::fs::read_to_string(folder.join("found.json")).unwrap();
        (
            String::from_utf8_lossy(&output.stderr).into_owned(),
            serde_json::from_str(&json).unwrap(),
        )
    };
    let text = record(HEADER, 3000);
    let (said, json) = found(&stamped(&text, 0.01, 0.4));
    assert!(said.contains("unevenly spaced"), "{said}");
    assert_eq!(json["timing"]["even"], false);
    // 0.4 of the interval, forth and back, in 2 of 7 of them: 0.4 √(2/7) of 10 ms.
    let jitter = json["timing"]["jitter_rms_s"].as_f64().unwrap();
    assert!(
        (jitter / (4e-3 * (2f64 / 7.0).sqrt()) - 1.0).abs() < 0.01,
        "{jitter}"
    );
    let (said, json) = found(&stamped(&text, 0.01, 0.0));
    assert!(said.is_empty(), "{said}");
    assert_eq!(json["timing"]["even"], true);
    assert!((json["rate_hz"].as_f64().unwrap() / 100.0 - 1.0).abs() < 1e-4);
    // Half a second is missing.
    let gap: String = stamped(&text, 0.01, 0.0)
        .lines()
        .enumerate()
        .filter(|(k, _)| !(1000..1050).contains(k))
        .map(|(_, line)| format!("{line}\n"))
        .collect();
    let (said, json) = found(&gap);
    assert!(said.contains("1 gap: 50 lost samples"), "{said}");
    assert_eq!(json["timing"]["gaps"][0]["missing"], 50);
}

#[test]
fn a_trend_is_removed_and_reported() {
    let folder = folder("trend");
    let temperature = |k: usize| 25.0 + (k as f64 / 500.0).sin();
    // 0.5 deg/s a kelvin on the z gyro.
    let text: String = record(HEADER, 6000)
        .lines()
        .enumerate()
        .map(|(k, line)| match k {
            0 => format!("{line},board_C\n"),
            _ => {
                let mut fields: Vec<f64> = line.split(',').map(|f| f.parse().unwrap()).collect();
                fields[2] += 0.5 * (temperature(k) - 25.0);
                fields.push(temperature(k));
                let fields: Vec<String> = fields.iter().map(|f| format!("{f:.6}")).collect();
                fields.join(",") + "\n"
            }
        })
        .collect();
    let arguments = ["--rate", "100", "--columns", "gz_dps", "--json", "-"];
    let axis = |options: &[&str]| {
        let output = identify(&folder, &text, &[&arguments[..], options].concat());
        assert!(output.status.success(), "{output:?}");
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        json["axes"]["gyro_z"].clone()
    };
    let model = folder.join("imu.toml");
    let found = axis(&["--axis", "gyro_z", "-o", model.to_str().unwrap()]);
    assert_eq!(found["detrend"]["kind"], "constant");
    let found = &found["temperature"];
    let degrees = |value: &serde_json::Value| value.as_f64().unwrap().to_degrees();
    let slope = degrees(&found["slope"]);
    // Noise of 0.3 deg/s a sample on a temperature of 0.7 K RMS: 0.0055 deg/s/K.
    assert!(
        (slope - 0.5).abs() < 0.03 && found["determined"] == true,
        "{slope}"
    );
    let interval = &found["slope_interval"];
    assert!(degrees(&interval[0]) < 0.5 && degrees(&interval[1]) > 0.5);
    let stored = ImuModel::load(&model).unwrap().gyro[2].temperature.unwrap();
    assert!((stored.slope.to_degrees() / slope - 1.0).abs() < 1e-5);
    assert!(!stored.body_axes && stored.range_c[0] < 24.1 && stored.range_c[1] > 25.9);
    let linear = axis(&["--detrend", "linear"]);
    assert!(linear["detrend"]["slope_per_hour"].is_number() && linear["temperature"].is_null());
    assert!(axis(&["--detrend", "constant"])["temperature"].is_null());
    let output = identify(
        &folder,
        &record(HEADER, 2000),
        &["--rate", "100", "--detrend", "temperature"],
    );
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        !output.status.success() && said.contains("no temperature column"),
        "{said}"
    );
}

#[test]
fn a_bad_axis_does_not_spoil_the_others() {
    let folder = folder("axes");
    // x hangs from end to end, y is against its stops, z is turned about.
    let text: String = record(HEADER, 6000)
        .lines()
        .enumerate()
        .map(|(k, line)| match k {
            0 => format!("{line}\n"),
            _ => {
                let mut fields: Vec<f64> = line.split(',').map(|f| f.parse().unwrap()).collect();
                fields[0] = 1.0;
                fields[1] = fields[1].clamp(-0.2, 0.2);
                fields[2] += 20.0 * (k as f64 / 300.0).sin();
                let fields: Vec<String> = fields.iter().map(|f| format!("{f:.6}")).collect();
                fields.join(",") + "\n"
            }
        })
        .collect();
    let arguments = ["--rate", "100", "-v", "--force", "-o", "imu.toml"];
    let output = identify(&folder, &text, &arguments);
    assert!(output.status.success(), "{output:?}");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        said.contains("gyro_x: the recording is constant") && said.contains("has no gyro_x:"),
        "{said}"
    );
    let report = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        report.contains("the axis is saturated") && report.contains("the recording is not static"),
        "{report}"
    );
    let file = std::fs::read_to_string(folder.join("imu.toml")).unwrap();
    let values = file.replace("provenance", "").to_ascii_lowercase();
    assert!(!values.contains("nan"), "{file}");
    let model = ImuModel::load(&folder.join("imu.toml")).unwrap();
    assert!(!model.gyro[0].is_known());
    for (name, axis) in model.axes().into_iter().skip(1) {
        axis.shaping(BiasModel::Arma, 0.01)
            .unwrap_or_else(|e| panic!("{name}: {e}"));
    }
}

#[test]
fn what_is_no_record_is_said() {
    let folder = folder("bad");
    let says = |text: &str, arguments: &[&str], expected: &str| {
        let output = identify(&folder, text, arguments);
        assert!(!output.status.success(), "{expected}: {output:?}");
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(error.contains(expected), "{expected}: {error}");
    };
    says(&record(HEADER, 2), &["--rate", "100"], "too short");
    let constant = format!("{HEADER}\n{}", "1,1,1,0,0,-1\n".repeat(2000));
    says(&constant, &["--rate", "100"], "constant");
    let nothing = format!("{HEADER}\n{}", "nan,nan,nan,nan,nan,nan\n".repeat(2000));
    says(&nothing, &[], "NaN");
    let one = format!("a,b\n{}", "1,2\n3,5\n".repeat(1000));
    says(&one, &[], "--columns");
    // Of one axis nothing is guessed.
    says(
        &record("gx,gy,gz,ax,ay,az", 2000),
        &["--columns", "gx"],
        "--units",
    );
    for record in [
        record("a,b,c,d,e,f", 2000),
        record("gx,gy,gz,ax,ay,az", 2000),
    ] {
        says(&record, &[], "--rate");
    }
    says(&record(HEADER, 2000), &["--units", "deg,g"], "angular rate");
    says(
        &record(HEADER, 2000),
        &["--columns", "gx_dps,gy_dps"],
        "2 columns",
    );
    says(
        &record(HEADER, 2000),
        &[
            "--columns",
            "nothing",
            "--axis",
            "gyro_x",
            "--units",
            "deg/s",
        ],
        "nothing",
    );
    says(&record(HEADER, 2000), &["--rate", "0"], "0 Hz");
    says(&record(HEADER, 2000), &[], "--rate");
    let text = stamped(&record(HEADER, 2000), 0.02, 0.0);
    says(&text, &["--rate", "100"], "time stamps give 50");
    // Nothing is written of a record that gives nothing.
    says(
        &constant,
        &["--rate", "100", "-o", "none.toml"],
        "the recording is constant",
    );
    assert!(!folder.join("none.toml").exists());
}

/// A second record beside the first: the same backwards, with gyros twice as loud on request.
fn two(folder: &Path, loud: bool) {
    let quiet = record(HEADER, 3000);
    let louder = |line: &str| {
        let fields = line.split(',').map(|field| field.parse::<f64>().unwrap());
        let fields = fields
            .enumerate()
            .map(|(axis, x)| if axis < 3 { 2.0 * x } else { x });
        Vec::from_iter(fields.map(|x| format!("{x:.6}"))).join(",")
    };
    let mut lines: Vec<String> = quiet.lines().skip(1).map(str::to_owned).collect();
    lines.reverse();
    if loud {
        lines = lines.iter().map(|line| louder(line)).collect();
    }
    std::fs::write(
        folder.join("other.csv"),
        format!("{HEADER}\n{}\n", lines.join("\n")),
    )
    .unwrap();
}

/// With the record itself, of these.
const WITH_OTHER: [&str; 5] = ["other.csv", "--rate", "100", "-o", "imu.toml"];

/// What is shown of both records.
fn of_two(folder: &Path) -> String {
    let output = identify(folder, &record(HEADER, 3000), &WITH_OTHER);
    assert!(output.status.success(), "{output:?}");
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn several_records_make_one_model() {
    let folder = folder("several");
    two(&folder, false);
    let (text, shown) = (record(HEADER, 3000), of_two(&folder));
    assert!(shown.starts_with("Usable: 6 axes, "), "{shown}");
    assert!(shown.contains("in 2 recordings at 100 Hz"), "{shown}");
    assert!(
        shown.contains("Turn-on constants of 2 switch-ons:"),
        "{shown}"
    );
    let model = ImuModel::load(&folder.join("imu.toml")).unwrap();
    assert_eq!(
        model.provenance.record.as_deref(),
        Some("record.csv, other.csv")
    );
    assert_eq!(model.provenance.samples, Some(6000));
    let recordings = &model.provenance.recordings;
    assert_eq!(
        (recordings.len(), recordings[1].record.as_str()),
        (2, "other.csv")
    );
    assert!(
        recordings
            .iter()
            .all(|recording| recording.sha256.is_some())
    );
    let white = model.gyro[0].white.unwrap().to_degrees();
    assert!((white / 0.03 - 1.0).abs() < 0.05, "{white}");

    let twice = identify(&folder, &text, &["record.csv", "--rate", "100"]);
    assert!(String::from_utf8_lossy(&twice.stderr).contains("record.csv is given twice"));
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn records_that_differ_are_the_first_line_and_no_model_with_strict() {
    let folder = folder("differ");
    two(&folder, true);
    let (text, shown) = (record(HEADER, 3000), of_two(&folder));
    assert!(shown.starts_with("Not one sensor: "), "{shown}");
    assert!(shown.contains("white noise"), "{shown}");
    let model = ImuModel::load(&folder.join("imu.toml")).unwrap();
    assert!(
        model.source.contains("differing recordings"),
        "{}",
        model.source
    );

    std::fs::remove_file(folder.join("imu.toml")).unwrap();
    let strict = identify(&folder, &text, &[&WITH_OTHER[..], &["--strict"]].concat());
    assert_eq!(strict.status.code(), Some(3));
    assert!(!folder.join("imu.toml").exists());
    std::fs::remove_dir_all(&folder).unwrap();
}
