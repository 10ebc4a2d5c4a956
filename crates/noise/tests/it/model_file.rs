//! The model file: what is read, what is refused and how, and that it survives writing.

use std::path::Path;
use undrift_config::Section;
use undrift_nav::earth::STANDARD_GRAVITY as G;
use undrift_noise::composite::{CompositeTerms, GaussMarkov};
use undrift_noise::{AxisModel, BiasModel, ImuModel, ModelError};

const FULL: &str = r#"
format = "undrift-imu"
version = 1
name = "Test \"IMU\""
source = """two
lines"""
[provenance]
record = "run2.csv.gz"
rate = "100 Hz"
samples = 1234567
sha256 = "00ff"
program = "undrift 0.1.0"
[gyro]
turn_on = "3 deg/s"
white_noise = "2.0 deg/√h"
bias_instability = "25 deg/h"
correlation_time = "100 s"
random_walk = "6 deg/h/sqrt(h)"
paper_sigma = "0.007 deg/s"
[gyro.arma]
rate = "200 Hz"
ar = [1]
ma = [0.9994]
sigma = "0.4714 deg/s"
[gyro_z]
turn_on = "1 deg/s"
[gyro_z.identification]
chosen = "ARMA(1,1)"
"runner up" = "ARMA(2,1)"
drift_score = { "1" = 0.5, "10" = 2.5 }
[accel]
white_noise = "100 ug/sqrt(Hz)"
[[gyro.line]]
frequency = "7.3 Hz"
amplitude = "0.2 deg/s"
[[gyro.line]]
frequency = "30 Hz"
amplitude = "18 deg/s"
width = "0.5 Hz"
"#;

/// Everything that a composite identification finds.
const COMPOSITE: &str = r#"
format = "undrift-imu"
version = 1
name = "composite"
source = "test"
[gyro]
white_noise = "2 deg/sqrt(h)"
quantisation = "1e-3 deg"
bias_instability = ["25 deg/h", "8 deg/h"]
correlation_time = ["10 s", "1000 s"]
random_walk = "6 deg/h/sqrt(h)"
turn_on = "3 deg/s"
[accel]
white_noise = "0.2 m/s/sqrt(h)"
quantisation = "1 mm/s"
"#;

#[test]
fn a_composite_model_is_the_sum_of_its_terms() {
    let model = ImuModel::from_toml(COMPOSITE, "imu.toml").unwrap();
    let gyro = &model.gyro[0];
    let degree = 1f64.to_radians();
    assert!((gyro.quantisation.unwrap() / (1e-3 * degree) - 1.0).abs() < 1e-14);
    assert_eq!(
        gyro.instability.iter().map(|p| p.tau_s).collect::<Vec<_>>(),
        [10.0, 1000.0]
    );
    let t = 0.01;
    let filter = gyro.shaping(BiasModel::Arma, t).unwrap();
    // Two processes, the random walk with the turn-on constant in it, quantisation.
    assert_eq!(filter.order, 4);
    let terms = CompositeTerms {
        white: gyro.white.unwrap(),
        quantisation: gyro.quantisation.unwrap(),
        random_walk: gyro.random_walk.unwrap(),
        gauss_markov: [0, 1].map(|i| GaussMarkov {
            sigma: gyro.instability[i].sigma,
            tau_s: gyro.instability[i].tau_s,
        }),
        ..CompositeTerms::default()
    };
    let (mut found, mut expected) = ([0.0; 50], [0.0; 50]);
    let mut still = filter;
    still.p0[2][2] = 0.0; // without the turn-on constant
    still.autocovariance(&mut found);
    terms.to_shaping(t).unwrap().autocovariance(&mut expected);
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() < 1e-12 * expected[0].abs(), "{a} {b}");
    }
    // The simpler models still exist: both processes and the constant; the slowest as a walk.
    assert_eq!(gyro.shaping(BiasModel::GaussMarkov, t).unwrap().order, 3);
    assert_eq!(gyro.shaping(BiasModel::RandomWalk, t).unwrap().order, 1);
    for kind in BiasModel::ALL {
        model.shaping(kind, t).unwrap();
    }
}

#[test]
fn a_model_of_some_axes_names_the_one_that_a_run_lacks() {
    let text = "format = \"undrift-imu\"\nversion = 1\n[gyro_z]\nwhite_noise = \"2 deg/sqrt(h)\"\n";
    let model = ImuModel::from_toml(text, "imu.toml").unwrap();
    assert!(model.gyro[2].is_known() && !model.gyro[0].is_known());
    let error = model
        .shaping(BiasModel::Arma, 0.01)
        .unwrap_err()
        .to_string();
    assert_eq!(
        error,
        "imu.toml: gyro_x: no noise model; give [gyro] for all three axes, or [gyro_x]"
    );
    let again = ImuModel::from_toml(&model.to_toml(), "imu.toml").unwrap();
    assert_eq!(again, model);
}

fn message(text: &str) -> String {
    match ImuModel::from_toml(text, "imu.toml") {
        Ok(model) => panic!("accepted: {model:?}"),
        Err(error) => error.to_string(),
    }
}

/// `FULL` with one line replaced.
fn with(line: &str, replacement: &str) -> String {
    assert!(FULL.contains(line), "{line}");
    FULL.replacen(line, replacement, 1)
}

#[test]
fn every_term_in_si() {
    let model = ImuModel::from_toml(FULL, "imu.toml").unwrap();
    let degree = 1f64.to_radians();
    let gyro = &model.gyro[0];
    let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-14, "{a} {b}");
    near(gyro.turn_on, 3.0 * degree);
    near(gyro.white.unwrap(), 2.0 * degree / 60.0);
    near(gyro.instability[0].sigma, 25.0 * degree / 3600.0);
    near(gyro.instability[0].tau_s, 100.0);
    near(gyro.random_walk.unwrap(), 6.0 * degree / 3600.0 / 60.0);
    near(gyro.paper_sigma.unwrap(), 0.007 * degree);
    let arma = gyro.arma.as_ref().unwrap();
    assert_eq!(
        (&arma.ar[..], &arma.ma[..], arma.rate_hz),
        (&[1.0][..], &[0.9994][..], 200.0)
    );
    near(arma.sigma, 0.4714 * degree);
    let [line, resonance] = gyro.lines[..] else {
        panic!("{:?}", gyro.lines);
    };
    assert_eq!((line.frequency_hz, line.width_hz), (7.3, 0.0));
    near(line.amplitude, 0.2 * degree);
    assert_eq!((resonance.frequency_hz, resonance.width_hz), (30.0, 0.5));
    assert_eq!(model.gyro[2].lines, gyro.lines);
    // The third axis overrides one key and keeps the others.
    near(model.gyro[2].turn_on, degree);
    assert_eq!(model.gyro[2].white, gyro.white);
    assert_eq!(model.gyro[2].arma, gyro.arma);
    assert_eq!(
        model.gyro[2].identification["chosen"].as_str(),
        Some("ARMA(1,1)")
    );
    near(model.accel[1].white.unwrap(), 1e-4 * G);
    assert_eq!(
        model.accel[1],
        AxisModel {
            white: model.accel[1].white,
            ..AxisModel::default()
        }
    );
    assert_eq!(model.provenance.rate_hz, Some(100.0));
    assert_eq!(model.provenance.samples, Some(1_234_567));
    assert_eq!(model.name, "Test \"IMU\"");
}

#[test]
fn writing_and_reading_gives_the_same_model() {
    let full = ImuModel::from_toml(FULL, "imu.toml").unwrap();
    let presets = ImuModel::preset_names()
        .iter()
        .map(|name| ImuModel::preset(name).unwrap());
    let composite = ImuModel::from_toml(COMPOSITE, "imu.toml").unwrap();
    for model in presets.chain([full, composite]) {
        let text = model.to_toml();
        let back = ImuModel::from_toml(&text, "again").unwrap();
        assert_eq!(back.to_toml(), text);
        assert_eq!((&back.name, &back.source), (&model.name, &model.source));
        assert_eq!(back.provenance, model.provenance);
        for ((_, back), (axis, model)) in back.axes().into_iter().zip(model.axes()) {
            // Six digits are written: half of the last of 1.00000.
            let near = |a: Option<f64>, b: Option<f64>| match (a, b) {
                (Some(a), Some(b)) => (a - b).abs() <= 5.1e-6 * b.abs(),
                (a, b) => a == b,
            };
            let parts = |m: &AxisModel| {
                [
                    Some(m.turn_on),
                    m.white,
                    m.instability.first().map(|of| of.sigma),
                    m.instability.last().map(|of| of.tau_s),
                    m.quantisation,
                    m.random_walk,
                    m.paper_sigma,
                    m.arma.as_ref().map(|arma| arma.sigma),
                ]
            };
            assert!(
                parts(back)
                    .into_iter()
                    .zip(parts(model))
                    .all(|(a, b)| near(a, b)),
                "{axis}"
            );
            let shape = |m: &AxisModel| m.arma.clone().map(|arma| (arma.ar, arma.ma, arma.rate_hz));
            assert_eq!(shape(back), shape(model));
            assert_eq!(back.identification, model.identification);
        }
    }
    // Numbers come back as a person wrote them.
    let text = ImuModel::preset("adis16405").unwrap().to_toml();
    for line in [
        "turn_on = \"3 deg/s\"",
        "white_noise = \"2 deg/sqrt(h)\"",
        "bias_instability = \"0.2 mg\"",
        "correlation_time = \"100 s\"",
    ] {
        assert!(text.contains(line), "{text}");
    }
}

#[test]
fn errors_name_line_key_and_mend() {
    for (text, parts) in [
        (
            with("turn_on = \"3 deg/s\"", "turn_on = \"3 m/s\""),
            &[
                "imu.toml line 14, gyro.turn_on: \"3 m/s\"",
                "velocity",
                "\"deg/s\" or \"rad/s\"",
            ][..],
        ),
        (
            with("turn_on = \"3 deg/s\"", "turn_on = 3"),
            &[
                "imu.toml line 14, gyro.turn_on:",
                "needs a unit: write \"3 deg/s\"",
            ],
        ),
        (
            with("turn_on = \"3 deg/s\"", "turn_on = \"-3 deg/s\""),
            &["gyro.turn_on: ", "negative"],
        ),
        (
            with("turn_on = \"3 deg/s\"", "turnon = \"3 deg/s\""),
            &["imu.toml line 14, gyro.turnon: unknown key", "turn_on, "],
        ),
        (
            with("turn_on = \"1 deg/s\"", "white = \"1 deg/s\""),
            &["imu.toml line 26, gyro_z.white: unknown key", "white_noise"],
        ),
        (
            with("amplitude = \"0.2 deg/s\"\n", ""),
            &["imu.toml line 33, gyro.line.amplitude: missing; a line needs"],
        ),
        (
            with("amplitude = \"0.2 deg/s\"", "amplitude = \"0 deg/s\""),
            &["imu.toml line 35, gyro.line.amplitude: must be greater than zero"],
        ),
        (
            with("frequency = \"7.3 Hz\"", "hertz = 7.3"),
            &[
                "gyro.line.hertz: unknown key",
                "amplitude, frequency, width",
            ],
        ),
        (
            with("[accel]", "[gyro_x]\nline = 7.3\n[accel]"),
            &["gyro_x.line: must be tables: write [[line]], not a number"],
        ),
        (
            with("correlation_time = \"100 s\"\n", ""),
            &[
                "imu.toml line 16, gyro.bias_instability:",
                "correlation_time",
                "random_walk",
            ],
        ),
        (
            with("bias_instability = \"25 deg/h\"\n", ""),
            &[
                "imu.toml line 16, gyro.correlation_time:",
                "bias_instability, which is missing",
            ],
        ),
        (
            with("correlation_time = \"100 s\"", "correlation_time = \"0 s\""),
            &[
                "imu.toml line 17, gyro.correlation_time:",
                "greater than zero",
            ],
        ),
        (
            with("sigma = \"0.4714 deg/s\"\n", ""),
            &["imu.toml line 20, gyro.arma.sigma: missing", "\"deg/s\""],
        ),
        (
            with("rate = \"200 Hz\"\n", ""),
            &["gyro.arma.rate: missing", "\"Hz\""],
        ),
        (
            with("ar = [1]", "ar = [1.1]"),
            &["imu.toml line 20, gyro.arma:", "unstable"],
        ),
        (
            with("ar = [1]", "ar = \"1\""),
            &["imu.toml line 22, gyro.arma.ar:", "list"],
        ),
        (
            with("ar = [1]", "ar = [nan]"),
            &["imu.toml line 22, gyro.arma.ar:", "finite"],
        ),
        (
            with("white_noise = \"100 ug/sqrt(Hz)\"", "turn_on = \"1 mg\""),
            &["accel.white_noise: missing", "arma"],
        ),
        (
            with(
                "bias_instability = \"25 deg/h\"",
                "bias_instability = [\"25 deg/h\", \"3 deg/h\"]",
            ),
            &[
                "imu.toml line 17, gyro.correlation_time: ",
                "one correlation time for each process",
            ],
        ),
        (
            with(
                "bias_instability = \"25 deg/h\"",
                "bias_instability = [\"25 deg/h\", 3]",
            ),
            &["imu.toml line 16, gyro.bias_instability: ", "needs a unit"],
        ),
        (
            with(
                "bias_instability = \"25 deg/h\"\ncorrelation_time = \"100 s\"",
                "bias_instability = [\"1 deg/h\", \"1 deg/h\", \"1 deg/h\", \"1 deg/h\", \"1 deg/h\"]\ncorrelation_time = [\"1 s\", \"2 s\", \"3 s\", \"4 s\", \"5 s\"]",
            ),
            &[
                "imu.toml line 16, gyro.bias_instability: ",
                "5 processes, at most 4",
            ],
        ),
        (
            with("paper_sigma", "quantisation = \"1 deg/s\"\npaper_sigma"),
            &["imu.toml line 19, gyro.quantisation: ", "an angle"],
        ),
        (
            "format = \"undrift-imu\"\nversion = 1\n".into(),
            &["no axis has a noise model"],
        ),
        (
            with("format = \"undrift-imu\"", ""),
            &["imu.toml, format: missing"],
        ),
        (
            with("format = \"undrift-imu\"", "format = \"other\""),
            &["imu.toml line 2, format:", "\"undrift-imu\""],
        ),
        (
            with("version = 1", "version = 2"),
            &["imu.toml line 3, version:", "version 1"],
        ),
        (
            with("samples = 1234567", "samples = -1"),
            &["provenance.samples", "whole number"],
        ),
        (with("[gyro.arma]", "[gyro.arma"), &["imu.toml line 20: "]),
        (
            with("[gyro]", "[gyro]\nturn_on = \"1 deg/s\""),
            &[
                "imu.toml line 15: turn_on is already defined at line",
                "merge the two",
            ],
        ),
        (
            with("name = ", "preset = \"adis\"\nname = "),
            &[
                "imu.toml line 4, preset: no preset \"adis\"; did you mean adis16405 or adis16465 or adis16470?",
                "undrift model --list",
            ],
        ),
    ] {
        let message = message(&text);
        for part in parts {
            assert!(message.contains(part), "{message}\nlacks {part}");
        }
    }
    assert!(
        message("gyro = 3\nformat = \"undrift-imu\"\nversion = 1")
            .contains("imu.toml line 1, gyro: must be a table")
    );
}

#[test]
fn a_preset_can_be_overridden_key_by_key() {
    let text = "preset = \"mpu6050\"\n[gyro]\nturn_on = \"0 deg/s\"\n[accel]\nturn_on = \"1 mg\"";
    let table = toml::de::DeTable::parse(text).unwrap();
    let model =
        ImuModel::from_section(&Section::top(table.get_ref(), text, "drive.toml").under("model"))
            .unwrap();
    let preset = ImuModel::preset("mpu6050").unwrap();
    assert_eq!(
        model.gyro[1],
        AxisModel {
            turn_on: 0.0,
            ..preset.gyro[1].clone()
        }
    );
    // Also over the preset's own [accel_z].
    assert!(
        model
            .accel
            .iter()
            .all(|axis| (axis.turn_on - 1e-3 * G).abs() < 1e-18)
    );
    assert_eq!(model.name, preset.name);
}

#[test]
fn inline_tables_are_named_with_their_path() {
    let text = "a = 1\n[model.gyro]\nwhite = \"2 deg/sqrt(h)\"\n";
    let document = toml::de::DeTable::parse(text).unwrap();
    let top = Section::top(document.get_ref(), text, "drive.toml");
    let error = ImuModel::from_section(&top.section("model").unwrap()).unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("drive.toml line 3, model.gyro.white: unknown key"),
        "{error}"
    );
}

#[test]
fn resolve_takes_a_preset_or_a_file() {
    let folder = std::env::temp_dir().join(format!("undrift-model-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("imu.toml"), FULL).unwrap();
    assert_eq!(
        ImuModel::resolve("imu.toml", &folder).unwrap(),
        ImuModel::from_toml(FULL, &folder.join("imu.toml").display().to_string()).unwrap()
    );
    assert_eq!(
        ImuModel::resolve("icm20602", Path::new(".")).unwrap(),
        ImuModel::preset("icm20602").unwrap()
    );
    let error = ImuModel::resolve("none.toml", &folder).unwrap_err();
    assert!(matches!(error, ModelError::Read { .. }));
    assert!(
        error
            .to_string()
            .ends_with("; a model is a file or a preset; `undrift model --list` shows the presets"),
        "{error}"
    );
    let error = ImuModel::resolve("MPU-6500", &folder).unwrap_err();
    assert!(
        error.to_string().contains("; did you mean mpu6050? "),
        "{error}"
    );
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn hostile_text_is_refused_without_panic() {
    let deep = format!("format = {}", "[".repeat(50_000));
    let nested = format!(
        "{FULL}\n[gyro_x.identification]\nx = {}{}",
        "[".repeat(60),
        "]".repeat(60)
    );
    for text in ["", "\0", "[", "=", "a.b.c.d = 1", "[gyro]\ngyro = 1", &deep] {
        assert!(ImuModel::from_toml(text, "x").is_err(), "{text:.20}");
    }
    let model = ImuModel::from_toml(&nested, "x").unwrap();
    assert_eq!(ImuModel::from_toml(&model.to_toml(), "x").unwrap(), model);
    for end in (0..FULL.len()).filter(|end| FULL.is_char_boundary(*end)) {
        let _ = ImuModel::from_toml(&FULL[..end], "x");
    }
}
