//! The numbers of each format in its own units.

use super::{DEG, close, gyro_white, model, numbers};
use undrift_noise::{ImuModel, ModelFormat};

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
fn gtsam_has_squares_of_densities_of_each_axis() {
    let text = model().export(ModelFormat::Gtsam, None).unwrap();
    let value = |key: &str| numbers(&text, key);
    let x = (0.3 * DEG / 60.0).powi(2);
    close(&value("setGyroscopeCovariance"), &[x, x, 4.0 * x]);
    close(&value("setAccelerometerCovariance"), &[1e-6; 3]);
    close(&value("setBiasAccCovariance"), &[1e-8; 3]);
    // The mean of the three is the square of Kalibr's.
    let walks = value("setBiasOmegaCovariance");
    let mean = walks.iter().sum::<f64>() / 3.0;
    assert!((mean.sqrt() / kalibr_walks(200.0)[1] - 1.0).abs() < 2e-8);
    assert!(text.contains("MakeSharedU(9.80665)") && text.contains("Init(np.zeros((6, 6)))"));
    // It inverts the covariance of the biases.
    let mut model = model();
    (model.accel[2].instability, model.accel[2].random_walk) = (Vec::new(), None);
    let error = model.export(ModelFormat::Gtsam, None).unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("accel_z: the gtsam model needs a bias that moves"),
        "{error}"
    );
}

#[test]
fn ardupilot_has_standard_deviations_of_a_prediction() {
    let text = model().export(ModelFormat::ArduPilot, None).unwrap();
    let value = |name: &str| numbers(&text, name);
    let root = (1f64 / 0.012).sqrt();
    close(&value("EK3_GYRO_P_NSE,"), &[gyro_white() * root]);
    close(&value("EK3_ACC_P_NSE,"), &[1e-3 * root]);
    near(value("EK3_GBIAS_P_NSE,")[0], kalibr_walks(100.0)[1] * root);
    close(&value("EK3_ABIAS_P_NSE,"), &[1e-4 * root]);
    let fast = model().export(ModelFormat::ArduPilot, Some(400.0)).unwrap();
    close(&numbers(&fast, "EK3_ACC_P_NSE,"), &[0.02]);
    // 1e-3 √83.3 is 0.0091 m/s², below the range; 0.02 is in it.
    let outside = "EK3_ACC_P_NSE [m/s²]: outside of ArduPilot's range, 0.01 to 1.0";
    assert!(text.contains(outside) && !fast.contains(outside));
}

#[test]
fn gazebo_has_the_process_of_each_axis() {
    let text = model().export(ModelFormat::Gazebo, Some(100.0)).unwrap();
    let of = |key: &str| {
        let mark = format!("<{key}>");
        let values = text.split(&mark).skip(1);
        Vec::from_iter(values.map(|rest| rest.split('<').next().unwrap().parse::<f64>().unwrap()))
    };
    let x = 0.3 * DEG / 60.0 * 10.0;
    close(&of("stddev"), &[x, x, 2.0 * x, 0.01, 0.01, 0.01]);
    let turn_on = 12.0 * DEG / 3600.0;
    close(&of("bias_stddev"), &[0.0, 0.0, turn_on, 0.0, 0.0, 0.0]);
    // The process itself, and a walk of an hour.
    let (gyro, accel) = (GYRO_DRIVE, 1e-4);
    let drives = [gyro, gyro, gyro, accel, accel, accel];
    close(&of("dynamic_bias_stddev"), &drives);
    let taus = [200.0, 200.0, 200.0, 3600.0, 3600.0, 3600.0];
    close(&of("dynamic_bias_correlation_time"), &taus);
    assert!(!text.contains("for an outage"), "{text}");
    // A process beside a walk is the process that is nearest to both.
    let mut model = model();
    model.gyro[0].random_walk = Some(1e-6);
    model.source = "a -- b ---".to_owned();
    let text = model.export(ModelFormat::Gazebo, Some(100.0)).unwrap();
    assert!(text.contains("gyro_x: its bias is not what the program draws"));
    assert!(!text.contains("gyro_y: its bias"));
    assert!(text.contains("<!-- Source: a - - b -  -->\n"), "{text}");
}
