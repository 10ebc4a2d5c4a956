//! Models in other programs' formats, against closed forms; `testdata/golden/formats/written/check.py`
//! reads the same texts with PyYAML.

use std::path::PathBuf;
use undrift_noise::{GaussMarkov, ImuModel, ModelFormat};

/// Round numbers in the units of the formats, other ones on one axis.
const MODEL: &str = r#"
format = "undrift-imu"
version = 1
name = "Test: \"IMU\" # 1"
source = """two
lines"""
[gyro]
white_noise = "0.3 deg/sqrt(h)"
bias_instability = "9 deg/h"
correlation_time = "200 s"
[gyro_z]
white_noise = "0.6 deg/sqrt(h)"
turn_on = "12 deg/h"
[accel]
white_noise = "0.06 m/s/sqrt(h)"
random_walk = "1e-4 m/s^2/sqrt(s)"
"#;

fn model() -> ImuModel {
    ImuModel::from_toml(MODEL, "test").unwrap()
}

/// The numbers after a key or name, up to the end of the line or the comment.
fn numbers(text: &str, key: &str) -> Vec<f64> {
    let line = text
        .lines()
        .map(str::trim_start)
        .find(|line| !line.starts_with(['#', '%']) && line.contains(key))
        .unwrap_or_else(|| panic!("no {key} in\n{text}"));
    let (_, after) = line.split_once(key).unwrap();
    let after = after.split(['#', '%']).next().unwrap();
    after
        .split(|c: char| c.is_whitespace() || "[](),:'".contains(c))
        .filter_map(|word| word.parse().ok())
        .collect()
}

/// Nine digits are written.
fn close(ours: &[f64], expected: &[f64]) {
    assert_eq!(ours.len(), expected.len(), "{ours:?} {expected:?}");
    for (a, b) in ours.iter().zip(expected) {
        assert!((a - b).abs() <= 6e-9 * b.abs(), "{ours:?} {expected:?}");
    }
}

const DEG: f64 = std::f64::consts::PI / 180.0;

/// Root mean square of the gyros' white noise, 0.3, 0.3, 0.6 deg/√h [rad/√s].
fn gyro_white() -> f64 {
    0.3 * DEG / 60.0 * 2f64.sqrt()
}

/// σ √(2/τ) = 9 deg/h √(2/200 s) = 0.9 deg/h/√s.
const GYRO_DRIVE: f64 = 0.9 * DEG / 3600.0;

#[test]
fn kalibr_has_the_walk_that_a_record_could_not_show() {
    let mut model = model();
    for axis in model.gyro.iter_mut() {
        (axis.instability, axis.random_walk) = (Vec::new(), None);
    }
    let missing = model.export(ModelFormat::Kalibr, Some(200.0)).unwrap_err();
    assert!(
        missing.to_string().contains("bias_instability"),
        "{missing}"
    );
    // An hour at 200 Hz: at a tenth of it, K²τ/3 of the walk is N²/τ of the white noise.
    (model.provenance.samples, model.provenance.rate_hz) = (Some(720_000), Some(200.0));
    let text = model.export(ModelFormat::Kalibr, Some(200.0)).unwrap();
    let tau = 360.0;
    let walk = (3.0 * gyro_white().powi(2) / tau).sqrt() / tau.sqrt();
    close(&numbers(&text, "gyroscope_random_walk"), &[walk]);
    close(&numbers(&text, "accelerometer_random_walk"), &[1e-4]);
    assert!(text.contains("an upper bound"), "{text}");
}

#[test]
fn kalibr_has_densities() {
    let text = model().export(ModelFormat::Kalibr, Some(200.0)).unwrap();
    close(&numbers(&text, "gyroscope_noise_density"), &[gyro_white()]);
    // For 30 s a little less than the driving noise, which would be right for times far below 200 s.
    let walk = |text: &str| numbers(text, "gyroscope_random_walk")[0] / GYRO_DRIVE;
    assert!((0.7..0.95).contains(&walk(&text)), "{text}");
    let of_outage = |outage| {
        let format = ModelFormat::Kalibr;
        let text = model().export_for(format, Some(200.0), outage);
        walk(&text.unwrap())
    };
    assert_eq!(of_outage(30.0), walk(&text));
    assert!(of_outage(30.0) > of_outage(300.0));
    let error = model().export_for(ModelFormat::Kalibr, Some(200.0), 0.0);
    assert_eq!(error.unwrap_err().to_string(), "invalid outage: 0 s");
    close(&numbers(&text, "accelerometer_noise_density"), &[1e-3]);
    close(&numbers(&text, "accelerometer_random_walk"), &[1e-4]);
    close(&numbers(&text, "update_rate"), &[200.0]);
    assert!(text.contains("root mean square") && text.contains("for an outage of 30 s"));
    assert!(text.starts_with("# Test: \"IMU\" # 1\n# Source: two lines\n"));
}

#[test]
fn kf_gins_has_the_units_of_data_sheets() {
    let text = model().export(ModelFormat::KfGins, None).unwrap();
    close(&numbers(&text, "arw:"), &[0.3, 0.3, 0.6]);
    close(&numbers(&text, "vrw:"), &[0.06; 3]);
    // One correlation time: the hour of the random walk. The driving noise is kept: σ grows by
    // √(3600/200).
    close(&numbers(&text, "corrtime:"), &[1.0]);
    let gbstd = 9.0 * 18f64.sqrt();
    close(&numbers(&text, "gbstd:"), &[gbstd; 3]);
    // K √(τ/2) in units of 1e-5 m/s².
    close(&numbers(&text, "abstd:"), &[10.0 * 1800f64.sqrt(); 3]);
    close(
        &numbers(&text, "initbgstd:"),
        &[gbstd, gbstd, gbstd.hypot(12.0)],
    );
    assert!(!text.contains("initbastd"));
    // One Gauss-Markov process for all is itself.
    let preset = ImuModel::preset("adis16488").unwrap();
    let text = preset.export(ModelFormat::KfGins, None).unwrap();
    close(&numbers(&text, "gbstd:"), &[6.25; 3]);
    close(&numbers(&text, "corrtime:"), &[100.0 / 3600.0]);
}

#[test]
fn ros_has_variances_of_samples() {
    let text = model().export(ModelFormat::Ros, Some(100.0)).unwrap();
    let x = (0.3 * DEG / 60.0).powi(2) * 100.0;
    let gyro = [x, 0.0, 0.0, 0.0, x, 0.0, 0.0, 0.0, 4.0 * x];
    close(&numbers(&text, "angular_velocity_covariance"), &gyro);
    close(&numbers(&text, "linear_acceleration_stdev"), &[0.01]);
    assert_eq!(numbers(&text, "orientation_covariance")[0], -1.0);
}

#[test]
fn px4_has_standard_deviations_of_a_prediction() {
    let text = model().export(ModelFormat::Px4, None).unwrap();
    // After name and value comes the type, 9.
    let value = |name: &str| numbers(&text, &format!("{name}\t"))[..1].to_vec();
    close(&value("EKF2_GYR_NOISE"), &[gyro_white() * 10.0]);
    close(&value("EKF2_ACC_NOISE"), &[0.01]);
    // The random walk that Kalibr has.
    let kalibr = model().export(ModelFormat::Kalibr, Some(100.0)).unwrap();
    let walk = numbers(&kalibr, "gyroscope_random_walk")[0];
    let ratio = value("EKF2_GYR_B_NOISE")[0] / (10.0 * walk);
    assert!((ratio - 1.0).abs() < 1e-8, "{ratio}");
    close(&value("EKF2_ACC_B_NOISE"), &[1e-3]);
    let turn_on = 12.0 * DEG / 3600.0 / 3f64.sqrt();
    close(&value("EKF2_GBIAS_INIT"), &[turn_on]);
    assert!(!text.contains("ABIAS"));
    let fast = model().export(ModelFormat::Px4, Some(400.0)).unwrap();
    close(&numbers(&fast, "EKF2_ACC_NOISE\t")[..1], &[0.02]);
    // 0.012 m/s/√h is 2e-4 m/s²/√Hz, 2e-3 m/s² a prediction: less than PX4 takes.
    let quiet = ImuModel::preset("adis16465").unwrap();
    let text = quiet.export(ModelFormat::Px4, None).unwrap();
    assert!(text.contains("EKF2_ACC_NOISE [m/s²]: outside of PX4's range, 0.01 to 1.0"));
}

#[test]
fn matlab_has_the_process_itself() {
    let text = model().export(ModelFormat::Matlab, Some(100.0)).unwrap();
    let x = 0.3 * DEG / 60.0;
    close(&numbers(&text, "'NoiseDensity',"), &[x, x, 2.0 * x]);
    close(
        &numbers(&text, "'BiasInstability',"),
        &[9.0 * DEG / 3600.0; 3],
    );
    // τ = 200 s at 100 Hz: φ = exp(−1/20000), gain √(1 − φ²).
    let phi = (-5e-5f64).exp();
    let filter = numbers(&text, "'BiasInstabilityCoefficients',");
    assert_eq!(filter[1..], [1.0, -phi]);
    // 1 − φ² loses four digits of sixteen here, not where it is written.
    assert!((filter[0] / (1.0 - phi * phi).sqrt() - 1.0).abs() < 1e-11);
    assert_eq!(text.matches("'BiasInstability',").count(), 1);
    assert!(text.contains("'RandomWalk', [0.0001, 0.0001, 0.0001]);"));
    assert!(text.contains("'single-sided'"));
    assert!(text.contains("'SampleRate', 100.0,"));
}

/// Kalibr's random walks at this rate: accelerometers [m/s²/√s], gyros [rad/s/√s].
fn kalibr_walks(rate_hz: f64) -> [f64; 2] {
    let text = model().export(ModelFormat::Kalibr, Some(rate_hz)).unwrap();
    ["accelerometer_random_walk", "gyroscope_random_walk"].map(|key| numbers(&text, key)[0])
}

/// Two roundings to nine digits.
fn near(ours: f64, expected: f64) {
    assert!(
        (ours / expected - 1.0).abs() < 1.2e-8,
        "{ours:e} {expected:e}"
    );
}

#[test]
fn vins_has_what_its_midpoint_step_takes() {
    let text = model().export(ModelFormat::Vins, Some(200.0)).unwrap();
    let value = |key: &str| numbers(&text, key);
    // N √(2/dt) with √(2 · 200) = 20, and K/√dt with √200.
    close(&value("acc_n:"), &[0.02]);
    close(&value("gyr_n:"), &[gyro_white() * 20.0]);
    close(&value("acc_w:"), &[1e-4 * 200f64.sqrt()]);
    near(value("gyr_w:")[0], kalibr_walks(200.0)[1] * 200f64.sqrt());
    assert_eq!(value("g_norm:"), [9.80665]);
    let slow = model().export(ModelFormat::Vins, Some(50.0)).unwrap();
    close(&numbers(&slow, "acc_n:"), &[0.01]);
    close(&numbers(&slow, "acc_w:"), &[1e-4 * 50f64.sqrt()]);
    let of_outage = |outage_s| {
        let text = model().export_for(ModelFormat::Vins, Some(200.0), outage_s);
        numbers(&text.unwrap(), "gyr_w:")[0]
    };
    assert!(of_outage(30.0) > of_outage(300.0));
    assert!(text.contains("gyro_x: its bias is not a random walk"));
}

/// `midPointIntegration` of VINS at rest without gravity, for one axis: position, velocity and the bias, with its F
/// and V. What comes out after a second is the variance that white noise and a random walk have.
#[test]
fn the_covariance_that_vins_integrates_is_that_of_the_model() {
    let rate = 200.0;
    let text = model().export(ModelFormat::Vins, Some(rate)).unwrap();
    let (noise, walk) = (numbers(&text, "acc_n:")[0], numbers(&text, "acc_w:")[0]);
    let dt = 1.0 / rate;
    let f = [[1.0, dt, -0.5 * dt * dt], [0.0, 1.0, -dt], [0.0, 0.0, 1.0]];
    // Columns: the noise of both ends, the bias's.
    let v = [
        [0.25 * dt * dt, 0.25 * dt * dt, 0.0],
        [0.5 * dt, 0.5 * dt, 0.0],
        [0.0, 0.0, dt],
    ];
    let q = [noise * noise, noise * noise, walk * walk];
    let mut p = [[0.0; 3]; 3];
    for _ in 0..200 {
        let mut next = [[0.0; 3]; 3];
        for (i, j) in (0..9).map(|at| (at / 3, at % 3)) {
            for (k, l) in (0..9).map(|at| (at / 3, at % 3)) {
                next[i][j] += f[i][k] * p[k][l] * f[j][l];
            }
            next[i][j] += (0..3).map(|k| v[i][k] * q[k] * v[j][k]).sum::<f64>();
        }
        p = next;
    }
    let (white, walk) = (1e-3f64, 1e-4f64);
    near(p[2][2], walk * walk);
    // N² t + K² t³/3 of the velocity; a bias that is constant within a step makes the second a percent less.
    let velocity = white * white + walk * walk / 3.0;
    assert!((p[1][1] / velocity - 1.0).abs() < 1e-4, "{}", p[1][1]);
}

#[test]
fn openvins_has_the_densities_of_kalibr_in_its_chain() {
    let text = model().export(ModelFormat::OpenVins, Some(200.0)).unwrap();
    let kalibr = model().export(ModelFormat::Kalibr, Some(200.0)).unwrap();
    assert!(text.starts_with("%YAML:1.0\n"));
    close(&numbers(&text, "gyroscope_noise_density"), &[gyro_white()]);
    close(&numbers(&text, "accelerometer_noise_density"), &[1e-3]);
    close(&numbers(&text, "accelerometer_random_walk"), &[1e-4]);
    for line in kalibr
        .lines()
        .filter(|line| line.contains("_density:") || line.contains("_walk:"))
    {
        assert!(text.contains(&format!("\n  {line}\n")), "{line}");
    }
    close(&numbers(&text, "update_rate"), &[200.0]);
    // What OpenVINS requires besides.
    for key in [
        "rostopic: /imu0",
        "model: \"kalibr\"",
        "Tw:",
        "Ta:",
        "R_IMUtoGYRO:",
        "R_IMUtoACC:",
        "Tg:",
    ] {
        assert!(text.contains(&format!("\n  {key}\n")), "{key}");
    }
    assert_eq!(text.matches("- [0.0, 0.0, 0.0]\n").count(), 3);
    assert_eq!(text.matches("- [0.0, 1.0, 0.0]\n").count(), 4);
}

#[test]
fn basalt_has_densities_of_each_axis() {
    let text = model().export(ModelFormat::Basalt, Some(200.0)).unwrap();
    let file: serde_json::Value = serde_json::from_str(&text).unwrap();
    let keys = |of: &serde_json::Value| Vec::from_iter(of.as_object().unwrap().keys().cloned());
    // Basalt reads the first member whatever its name.
    assert_eq!(keys(&file), ["value0"]);
    let of = &file["value0"];
    let vector = |key: &str| {
        let of = of[key].as_array().unwrap().iter();
        Vec::from_iter(of.map(|value| value.as_f64().unwrap()))
    };
    let x = 0.3 * DEG / 60.0;
    close(&vector("gyro_noise_std"), &[x, x, 2.0 * x]);
    close(&vector("accel_noise_std"), &[1e-3; 3]);
    close(&vector("accel_bias_std"), &[1e-4; 3]);
    // The root mean square of the three is Kalibr's.
    let walks = vector("gyro_bias_std");
    let rms = (walks.iter().map(|walk| walk * walk).sum::<f64>() / 3.0).sqrt();
    near(rms, kalibr_walks(200.0)[1]);
    assert_eq!(walks[0], walks[1]);
    assert_eq!(of["imu_update_rate"], 200.0);
    assert_eq!(of["comments"][0], "Test: \"IMU\" # 1");
    // cereal takes a key that begins with one it looks for.
    let names = keys(of);
    for (name, other) in names
        .iter()
        .flat_map(|name| names.iter().map(move |other| (name, other)))
    {
        assert!(name == other || !name.starts_with(other.as_str()), "{name}");
    }
}

/// All four divide by the random walk; Basalt by that of each axis.
#[test]
fn a_walk_of_zero_is_refused_by_each_axis_that_has_a_number() {
    let mut model = model();
    (model.accel[1].instability, model.accel[1].random_walk) = (Vec::new(), None);
    let error = model.export(ModelFormat::Basalt, Some(200.0)).unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("accel_y: the basalt model needs a bias that moves"),
        "{error}"
    );
    let kalibr = model.export(ModelFormat::Kalibr, Some(200.0)).unwrap();
    let walk = 1e-4 * (2f64 / 3.0).sqrt();
    close(&numbers(&kalibr, "accelerometer_random_walk"), &[walk]);
    // 10 √3 N/T.
    (model.provenance.samples, model.provenance.rate_hz) = (Some(720_000), Some(200.0));
    let text = model.export(ModelFormat::Basalt, None).unwrap();
    let file: serde_json::Value = serde_json::from_str(&text).unwrap();
    let walks = &file["value0"]["accel_bias_std"];
    near(walks[1].as_f64().unwrap(), 3f64.sqrt() * 1e-3 / 360.0);
    assert_eq!(walks[0], 1e-4);
    assert!(text.contains("accel_y: no slow bias was detected in 3600 s"));
    for axis in &mut model.gyro {
        (axis.instability, axis.random_walk) = (Vec::new(), None);
    }
    model.provenance.samples = None;
    for (format, name) in [
        (ModelFormat::Vins, "vins"),
        (ModelFormat::OpenVins, "openvins"),
    ] {
        let error = model.export(format, Some(200.0)).unwrap_err().to_string();
        assert!(
            error.starts_with(&format!("gyro_x: the {name} model needs")),
            "{error}"
        );
        model.provenance.samples = Some(720_000);
        let text = model.export(format, Some(200.0)).unwrap();
        assert!(
            text.contains("# gyros: no slow bias was detected"),
            "{text}"
        );
        model.provenance.samples = None;
    }
}

#[test]
fn undrift_reads_back() {
    let text = model().export(ModelFormat::Undrift, None).unwrap();
    let back = ImuModel::from_toml(&text, "back").unwrap();
    assert_eq!(back.gyro[0], model().gyro[0]);
    // deg/h goes out as deg/s, in six digits.
    let (ours, theirs) = (back.gyro[2].turn_on, model().gyro[2].turn_on);
    assert!((ours - theirs).abs() < 5.1e-6 * theirs);
}

fn with_arma(ar: &str, ma: &str) -> ImuModel {
    with_sigma(ar, ma, 0.02)
}

fn with_sigma(ar: &str, ma: &str, sigma: f64) -> ImuModel {
    let text = format!(
        "format = \"undrift-imu\"\nversion = 1\n[gyro]\narma = {{ rate = \"100 Hz\", ar = {ar}, ma = {ma}, sigma = \"{sigma} rad/s\" }}\n[accel]\nwhite_noise = \"0.06 m/s/sqrt(h)\"\nrandom_walk = \"1e-4 m/s^2/sqrt(s)\"\n"
    );
    ImuModel::from_toml(&text, "arma").unwrap()
}

/// White noise and random walk of the gyros in SI by each format that has them, and the text of the first.
fn in_every_format(model: &ImuModel) -> ([(f64, f64); 3], String) {
    let export = |format| model.export(format, Some(100.0)).unwrap();
    let kalibr = export(ModelFormat::Kalibr);
    let one = |text: &str, key: &str| numbers(text, key)[0];
    let of_kalibr = (
        one(&kalibr, "gyroscope_noise_density"),
        one(&kalibr, "gyroscope_random_walk"),
    );
    let text = export(ModelFormat::KfGins);
    let tau = one(&text, "corrtime:") * 3600.0;
    let of_kf_gins = (
        one(&text, "arw:") * DEG / 60.0,
        one(&text, "gbstd:") * DEG / 3600.0 * (2.0 / tau).sqrt(),
    );
    let text = export(ModelFormat::Matlab);
    let of_matlab = match text.contains("'BiasInstability',") {
        // σ √(2/τ), τ from the filter's pole.
        true => {
            let pole = -numbers(&text, "'BiasInstabilityCoefficients',")[2];
            let drive = one(&text, "'BiasInstability',") * (-200.0 * pole.ln()).sqrt();
            (one(&text, "'NoiseDensity',"), drive)
        }
        false => (one(&text, "'NoiseDensity',"), one(&text, "'RandomWalk',")),
    };
    ([of_kalibr, of_kf_gins, of_matlab], kalibr)
}

/// Each within 1e-6: the coefficients' digits over the distance of the poles.
fn all_are(found: [(f64, f64); 3], white: f64, drive: f64) {
    for (n, k) in found {
        assert!((n / white - 1.0).abs() < 1e-6, "{n:e} {white:e}");
        assert!((k / drive - 1.0).abs() < 1e-6, "{k:e} {drive:e}");
    }
}

/// The same of a process, which Kalibr has as another random walk.
fn are_driven(found: [(f64, f64); 3], white: f64, drive: f64) {
    let [(kalibr, _), kf_gins, _] = found;
    let of_kalibr = (kalibr, drive);
    all_are([of_kalibr, kf_gins, found[2]], white, drive);
}

#[test]
fn an_arma_becomes_the_terms_of_its_spectrum() {
    let exported = |ar, ma| in_every_format(&with_arma(ar, ma));
    // IMA(1,1) is a random walk of (1 − θ)σ a step and white noise of √θ σ, exactly.
    let (found, text) = exported("[1.0]", "[0.81]");
    all_are(found, 0.02 * 0.9 / 10.0, 0.02 * 0.19 * 10.0);
    assert!(text.contains("gyro_x: the terms whose sum is exactly its ARMA(1,1)."));
    // The source paper's, φ = 1 and θ = 0.9994.
    let (found, _) = exported("[1.0]", "[0.9994]");
    all_are(found, 0.02 * 0.9994f64.sqrt() / 10.0, 0.02 * 6e-4 * 10.0);
    // (1 − B)(1 − 0.5 B) x = (1 − 0.9 B) a: a random walk of σ 0.1/0.5 a step. Of its spectrum
    // (0.01 + 0.9 u)/(0.25 + 0.5 u)/u, u = 2 − 2 cos ω, that leaves 90 · 0.04 − 2 · 0.04 at u = 0.
    let (found, text) = exported("[1.5, -0.5]", "[0.9]");
    all_are(found, 0.02 * 3.52f64.sqrt() / 10.0, 0.02 * 0.2 * 10.0);
    assert!(
        text.contains("poles of its ARMA with less than 1 s"),
        "{text}"
    );
    // AR(1) with φ = 0.999 is a bias alone, of the driving noise σ a step.
    let (found, _) = exported("[0.999]", "[]");
    let tau = -0.01 / 0.999f64.ln();
    let drive = 0.02 / (1.0 - 0.999f64.powi(2)).sqrt() * (2.0 / tau).sqrt();
    are_driven(found, 0.02 / 10.0, drive);
}

/// Sums of independent processes as ARMA, by `testdata/golden/arma_sum.py`.
#[test]
fn complex_and_fast_poles_are_no_bias() {
    // 1/|φ(1)|² of the pair at 7.3 Hz, radius 0.999.
    let turn = std::f64::consts::TAU * 0.073;
    let pair = (1.0 - 2.0 * 0.999 * turn.cos() + 0.999 * 0.999f64).powi(-2);
    let short = 1e-4 / 0.49 + 1e-6 * pair;
    let walk = with_sigma(
        "[3.0914887914969014, -3.6269364289459713, 1.8348479374490703, -0.2994003]",
        "[2.639569766684097, -2.48236078842952, 0.8414636595295751]",
        0.010890663017610868,
    );
    let (found, text) = in_every_format(&walk);
    all_are(found, (0.01 * short).sqrt(), 1e-3);
    assert!(text.contains("complex poles of its ARMA are no bias") && text.contains("7.3 Hz"));
    let bias = with_sigma(
        "[3.091288811495568, -3.6265181730146594, 1.8345408786284865, -0.29934042592760685]",
        "[2.6435056254125966, -2.4888369096317766, 0.8447977708567818]",
        0.010867927222022995,
    );
    // 0.002 √(2/50 s).
    are_driven(in_every_format(&bias).0, (0.01 * short).sqrt(), 4e-4);
    let negative = with_sigma(
        "[0.5, 0.5]",
        "[0.7572766685615939, 0.232494809345425]",
        0.014664875202622255,
    );
    let white = 1e-4 + 1e-4 / 2.25;
    all_are(in_every_format(&negative).0, (0.01f64 * white).sqrt(), 1e-3);
    // A bias that swings, period 300 s and decay 100 s, under white noise: over short times a random walk.
    let swing = with_sigma(
        "[1.9997999661391446, -0.9998000199986667]",
        "[1.9898550741037186, -0.989857064436698]",
        0.010050098704609826,
    );
    let (found, text) = in_every_format(&swing);
    for (n, k) in found {
        // The poles are 1e-4 from each other and from 1: half of sixteen digits are left.
        assert!((n / 1e-3 - 1.0).abs() < 1e-4, "{n:e}");
        assert!((k / 1.000000026938099e-3 - 1.0).abs() < 1e-3, "{k:e}");
    }
    assert!(
        text.contains("over short times they are the random walk used"),
        "{text}"
    );
    // More zeros than poles.
    let zeros = with_sigma(
        "[1.0]",
        "[0.49431830242027297, 0.497122754768833, -0.24997414225175552, 0.24856188876991975]",
        0.01002888691229586,
    );
    all_are(in_every_format(&zeros).0, 0.1 * 0.01 * 1.75, 1e-3);
}

#[test]
fn a_fast_process_counts_as_white_noise_and_lines_are_listed() {
    let text = MODEL.replace(
        "correlation_time = \"200 s\"",
        "correlation_time = \"0.2 s\"\nrandom_walk = \"6 deg/h/sqrt(h)\"\n[[gyro.line]]\nfrequency = \"7.3 Hz\"\namplitude = \"1 deg/s\"\n[gyro.temperature]\nreference = \"25 degC\"\nlowest = \"20 degC\"\nhighest = \"40 degC\"\nslope = \"1 deg/h/K\"",
    );
    let (found, text) = in_every_format(&ImuModel::from_toml(&text, "test").unwrap());
    // N² + 2σ²τ; the first format has the root mean square of the three axes, the others the x axis.
    let fast = 2.0 * (9.0 * DEG / 3600.0).powi(2) * 0.2;
    let white = [gyro_white(), 0.3 * DEG / 60.0, 0.3 * DEG / 60.0];
    for ((n, k), white) in found.into_iter().zip(white) {
        close(&[n], &[white.mul_add(white, fast).sqrt()]);
        close(&[k], &[6.0 * DEG / 3600.0 / 60.0]);
    }
    assert!(
        text.contains("lines and narrow resonances are omitted: 7.3 Hz"),
        "{text}"
    );
    assert!(text.contains("counts as white noise"), "{text}");
    assert!(text.contains("bias over temperature is omitted"), "{text}");
}

#[test]
fn the_random_walk_for_several_processes_covers_their_growth() {
    // A decade apart, of one variance, as flicker is: the slowest alone grows 6 times less within 30 s.
    let processes = [(1.0, 10.0), (1.0, 100.0), (1.0, 1000.0)];
    let text = MODEL.replace(
        "correlation_time = \"200 s\"",
        "correlation_time = [\"10 s\", \"100 s\", \"1000 s\"]",
    );
    let text = text.replace(
        "bias_instability = \"9 deg/h\"",
        "bias_instability = [\"1 deg/h\", \"1 deg/h\", \"1 deg/h\"]",
    );
    let model = ImuModel::from_toml(&text, "test").unwrap();
    let (found, text) = in_every_format(&model);
    assert!(text.contains("for an outage of 30 s"), "{text}");
    let kf_gins = model.export(ModelFormat::KfGins, None).unwrap();
    assert!(kf_gins.contains("count as a random walk"), "{kf_gins}");
    let k = found[1].1 / (DEG / 3600.0);
    let growth = |time: f64| -> f64 {
        let of = |(sigma, tau): &(f64, f64)| 2.0 * sigma * sigma * -(-time / tau).exp_m1();
        processes.iter().map(of).sum()
    };
    let ratio = |time: f64| (k * k * time / growth(time)).sqrt();
    assert!((1.0..1.1).contains(&ratio(30.0)), "{}", ratio(30.0));
    assert!(ratio(60.0) > 1.0 && ratio(60.0) < 1.4, "{}", ratio(60.0));
    // Over shorter times it falls short, by no more than the processes of 10 s that it takes for slower.
    assert!(ratio(5.0) > 0.6, "{}", ratio(5.0));
}

/// Axes of other correlation times have one in MATLAB, and the standard deviations that they have.
#[test]
fn a_simulated_process_has_the_standard_deviation_of_the_model() {
    let mut model = model();
    let process = |sigma: f64, tau_s| vec![GaussMarkov { sigma, tau_s }];
    model.gyro[0].instability = process(1e-4, 50.0);
    model.gyro[1].instability = process(2e-4, 800.0);
    model.gyro[2].instability = process(3e-4, 200.0);
    let text = model.export(ModelFormat::Matlab, Some(100.0)).unwrap();
    close(&numbers(&text, "'BiasInstability',"), &[1e-4, 2e-4, 3e-4]);
    let pole = -numbers(&text, "'BiasInstabilityCoefficients',")[2];
    // The geometric mean of the three.
    assert!((-0.01 / pole.ln() / 200.0 - 1.0).abs() < 1e-6, "{text}");
}

#[test]
fn what_is_missing_is_named() {
    let error = |text: &str, format, rate| {
        let head = "format = \"undrift-imu\"\nversion = 1\n";
        let model = ImuModel::from_toml(&format!("{head}{text}"), "some.toml").unwrap();
        model.export(format, rate).unwrap_err().to_string()
    };
    let white =
        "[gyro]\nwhite_noise = \"1 deg/sqrt(h)\"\n[accel]\nwhite_noise = \"1 m/s/sqrt(h)\"\n";
    let one = "[gyro_x]\nwhite_noise = \"1 deg/sqrt(h)\"\n";
    let lacking = error(white, ModelFormat::Kalibr, Some(100.0));
    assert!(
        lacking.starts_with("gyro_x: the kalibr model needs"),
        "{lacking}"
    );
    assert!(error(one, ModelFormat::KfGins, None).contains("gyro_y"));
    assert!(error(white, ModelFormat::Ros, None).contains("--rate HZ"));
    for rate in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(error(white, ModelFormat::Ros, Some(rate)).contains("invalid sample rate"));
    }
    // Anti-persistent noise has no bias that moves.
    let error = with_arma("[]", "[0.5]")
        .export(ModelFormat::Kalibr, None)
        .unwrap_err();
    assert!(error.to_string().contains("gyro_x"));
    for format in ModelFormat::ALL {
        assert_eq!(format.name().parse(), Ok(format));
    }
    assert!("kalibre".parse::<ModelFormat>().is_err());
}

fn golden(format: ModelFormat) -> PathBuf {
    let name = match format {
        ModelFormat::Kalibr => "imu.kalibr.yaml",
        ModelFormat::KfGins => "imu.kf-gins.yaml",
        ModelFormat::Ros => "imu.ros.yaml",
        ModelFormat::Px4 => "imu.px4.params",
        ModelFormat::Matlab => "imu.m",
        ModelFormat::Vins => "imu.vins.yaml",
        ModelFormat::OpenVins => "imu.openvins.yaml",
        ModelFormat::Basalt => "imu.basalt.json",
        ModelFormat::Undrift => "imu.toml",
    };
    let folder = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../testdata/golden/formats/written"
    );
    PathBuf::from(folder).join(name)
}

/// The texts that `check.py` has read. `UNDRIFT_BLESS=1` writes them; then run `check.py`.
#[test]
fn equal_to_what_was_checked() {
    for format in ModelFormat::ALL {
        let text = model().export(format, Some(100.0)).unwrap();
        if std::env::var_os("UNDRIFT_BLESS").is_some() {
            std::fs::write(golden(format), &text).unwrap();
        }
        let checked = std::fs::read_to_string(golden(format)).unwrap();
        assert_eq!(text, checked, "{}", format.name());
    }
}
