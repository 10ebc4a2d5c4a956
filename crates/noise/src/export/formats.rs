//! The texts of the formats.
//!
//! Each function documents the equations of the program that reads the file, with the place in its source, and
//! how a density N or a random walk K is turned into its numbers, of nine digits. Comments name the sensor, its
//! source and the remarks.
//!
//! What differs between the programs is only what a "noise" number is multiplied by. For white
//! noise of density N [rad/s/√Hz, m/s²/√Hz], a random walk K of the bias [rad/s²/√Hz, m/s³/√Hz] and
//! the sample interval T \[s\]:
//!
//! | program | white noise | bias |
//! |---|---|---|
//! | Kalibr, OpenVINS, Basalt | N | K |
//! | VINS-Mono, VINS-Fusion | N √(2/T) | K/√T |
//! | PX4 EKF2 | N/√T, T of its prediction (100 Hz) | K/√T |
//! | ArduPilot EKF3 | N/√T, T of its prediction (12 ms) | K/√T |
//! | GTSAM | N² | K² |
//! | Gazebo | N/√T | a Gauss-Markov process of σ √(2/τ) and τ, from the turn-on |
//! | ROS `sensor_msgs/Imu` | variance N²/T | – |
//! | KF-GINS | N in deg/√h, m/s/√h | Gauss-Markov of one τ, driven by 2σ²/τ |
//! | MATLAB `imuSensor` | N | K, and a Gauss-Markov process of one τ |
//!
//! Programs with one number for a sensor get the root mean square of its three axes, which
//! preserves the mean variance. The functions are pure: [`Equivalent`] in, text out; they do no
//! fitting. What a format cannot hold (quantisation, lines, several processes) is in the remarks of
//! [`Equivalent`], which every text has as comments at its head.

use super::equivalent::{Equivalent, EquivalentAxis, common_tau, driven, rms};
use super::text::{Text, number, row};
use undrift_nav::earth::STANDARD_GRAVITY;

/// EKF2's prediction, EKF2_PREDICT_US = 10000 unless changed \[Hz\].
pub(super) const PX4_RATE: f64 = 100.0;
/// EKF3's predictions, EKF_TARGET_DT = 12 ms \[Hz\].
pub(super) const ARDUPILOT_RATE: f64 = 1.0 / 0.012;
/// 1 mGal [m/s²].
const MILLIGAL: f64 = 1e-5;
/// One hour \[s\].
const HOUR: f64 = 3600.0;

/// Kalibr, "IMU Noise Model": continuous-time densities of white noise and of the bias's random walk.
///
/// `rate_hz` \[Hz\] is written as `update_rate` and scales nothing.
pub(super) fn kalibr(imu: &Equivalent, rate_hz: f64) -> String {
    let mut out = Text::about(imu, "#");
    out.comment("Each number is the root mean square of the three axes.");
    for line in densities(imu) {
        out.body += &format!("{line}\n");
    }
    out.finish() + &format!("rostopic: /imu0\nupdate_rate: {}\n", number(rate_hz))
}

/// Kalibr's four keys and values.
///
/// Accelerometer first; SI units, root mean square of the axes.
fn densities(imu: &Equivalent) -> impl Iterator<Item = String> {
    let of_sensor = |(sensor, axes, unit): (&str, _, &str)| {
        let white = number(rms(axes, |axis| axis.white));
        let walk = number(rms(axes, |axis| axis.walk));
        [
            format!("{sensor}_noise_density: {white}  # {unit}/√Hz"),
            format!("{sensor}_random_walk: {walk}  # {unit}/s/√Hz"),
        ]
    };
    let sensors = [
        ("accelerometer", &imu.accel, "m/s²"),
        ("gyroscope", &imu.gyro, "rad/s"),
    ];
    sensors.into_iter().flat_map(of_sensor)
}

/// VINS-Mono and VINS-Fusion, `IntegrationBase::midPointIntegration` of
/// `vins_estimator/src/factor/integration_base.h`: V·Q·Vᵀ has dt/2 for the noise of each end of a step, as if both
/// were independent, so that a step adds (noise dt)²/2 to angle and velocity, and (bias noise dt)² to the bias.
/// A sample is the end of one step and the start of the next: it adds (σ dt)², with σ = N/√dt. A density N is
/// therefore N √(2/dt), a random walk K is K/√dt. Read by `readParameters` of `parameters.cpp`.
///
/// `g_norm` \[m/s²\] is required by the reader and is standard gravity here: replace it by the
/// local one.
pub(super) fn vins(imu: &Equivalent, rate_hz: f64) -> String {
    let mut out = Text::about(imu, "#");
    let rate = number(rate_hz);
    out.comment(&format!(
        "Each number is the root mean square of the three axes, for samples at {rate} Hz, dt = 1/{rate} s. The midpoint step of VINS adds (noise dt)²/2 to angle and velocity and (bias noise dt)² to the bias, so a density N is N √(2/dt) and a random walk K is K/√dt."
    ));
    let root = rate_hz.sqrt();
    let twice = (2.0 * rate_hz).sqrt();
    let white = |axes| number(rms(axes, |axis| axis.white * twice));
    let walk = |axes| number(rms(axes, |axis| axis.walk * root));
    let (gyro, accel) = (&imu.gyro, &imu.accel);
    out.body += &format!("acc_n: {}  # m/s²\n", white(accel));
    out.body += &format!("gyr_n: {}  # rad/s\n", white(gyro));
    out.body += &format!("acc_w: {}  # m/s³\n", walk(accel));
    out.body += &format!("gyr_w: {}  # rad/s²\n", walk(gyro));
    let gravity = number(STANDARD_GRAVITY);
    out.finish()
        + &format!("g_norm: {gravity}  # m/s²; not part of a noise model: standard gravity\n")
}

/// OpenVINS, `Propagator::predict_and_compute` of `ov_msckf/src/state/Propagator.cpp`: σ²/dt of a sample's noise and,
/// by dt in `G`, σ² dt of a step of the bias, so that all are the continuous-time densities of Kalibr. Its
/// `YamlParser` reads with OpenCV, which wants the first line, and `print_and_load_state` of
/// `VioManagerOptions.h` requires the model of the axes; `T_i_b`, `time_offset` and `update_rate` it does not read.
pub(super) fn openvins(imu: &Equivalent, rate_hz: f64) -> String {
    let mut out = Text::about(imu, "#");
    out.comment("Each number is the root mean square of the three axes.");
    out.comment("Matrices are those of ideal axes: keep yours if the axes were calibrated.");
    let matrix = |name: &str, size: usize, diagonal: f64| {
        let at = |i, j| if i == j { diagonal } else { 0.0 };
        let rows = (0..size).map(|i| format!("    - {}\n", row((0..size).map(|j| at(i, j)))));
        format!("  {name}:\n{}", String::from_iter(rows))
    };
    out.body += "imu0:\n";
    out.body += &matrix("T_i_b", 4, 1.0);
    for line in densities(imu) {
        out.body += &format!("  {line}\n");
    }
    let rate = number(rate_hz);
    out.body += &format!("  rostopic: /imu0\n  time_offset: 0.0\n  update_rate: {rate}\n");
    out.body += "  model: \"kalibr\"\n";
    for (name, diagonal) in [
        ("Tw", 1.0),
        ("R_IMUtoGYRO", 1.0),
        ("Ta", 1.0),
        ("R_IMUtoACC", 1.0),
        ("Tg", 0.0),
    ] {
        out.body += &matrix(name, 3, diagonal);
    }
    format!("%YAML:1.0\n\n{}", out.finish())
}

/// Basalt, `Calibration` of `include/basalt/calibration/calibration.hpp`: continuous-time densities of each axis,
/// times √`imu_update_rate` a sample (`dicrete_time_gyro_noise_std`); a step of the bias over dt weighs
/// 1/(std √dt) (`ImuBlock::linearizeImu` of `include/basalt/linearization/imu_block.hpp`). The first member of the file is the
/// calibration; in it cereal's `JSONInputArchive` finds names and skips others, unless they begin with one of its own.
///
/// One number for each axis x, y, z. `rate_hz` \[Hz\] is written as `imu_update_rate` and scales
/// nothing.
pub(super) fn basalt(imu: &Equivalent, rate_hz: f64) -> String {
    let mut out = Text::about(imu, "");
    out.comment("Noise alone: put these keys into the calibration of cameras and IMU.");
    out.comment(
        "Continuous-time densities of the axes x, y, z: rad/s/√Hz, m/s²/√Hz; of the biases rad/s²/√Hz, m/s³/√Hz.",
    );
    let quoted = |text: &String| format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""));
    let comments: Vec<String> = out.comments.iter().map(quoted).collect();
    let comments = comments.join(",\n      ");
    let white = |axes: &[EquivalentAxis; 3]| row(axes.iter().map(|axis| axis.white));
    let walk = |axes: &[EquivalentAxis; 3]| row(axes.iter().map(|axis| axis.walk));
    let members = [
        ("comments", format!("[\n      {comments}\n    ]")),
        ("imu_update_rate", number(rate_hz)),
        ("accel_noise_std", white(&imu.accel)),
        ("gyro_noise_std", white(&imu.gyro)),
        ("accel_bias_std", walk(&imu.accel)),
        ("gyro_bias_std", walk(&imu.gyro)),
    ];
    let members = members.map(|(name, value)| format!("    \"{name}\": {value}"));
    format!("{{\n  \"value0\": {{\n{}\n  }}\n}}\n", members.join(",\n"))
}

/// KF-GINS, `dataset/kf-gins.yaml` and `loadConfig` of `src/kf_gins.cpp`: biases are Gauss-Markov
/// processes of one correlation time, driven by 2σ²/τ.
///
/// Units are the file's: deg/√h, m/s/√h, deg/h, mGal, h. Since 2σ²/τ is what drives the process,
/// one common τ with σ² scaled by it gives the same drift over times that are short against τ; the
/// longest τ is taken ([`common_tau`], a random walk counting as 1 h), 1 h where no axis has a bias
/// that moves. `initbgstd` and `initbastd` are written only with a turn-on constant.
pub(super) fn kf_gins(imu: &Equivalent) -> String {
    let mut out = Text::about(imu, "#");
    out.comment(
        "One correlation time for all axes: the longest. The standard deviations of the biases preserve the driving noise 2σ²/τ of each axis.",
    );
    let tau = common_tau(imu.gyro.iter().chain(&imu.accel)).unwrap_or(HOUR);
    let degree = 1f64.to_radians();
    let std = |axis: &EquivalentAxis| driven(axis.slow.drive(), tau);
    let list = |axes: &[EquivalentAxis; 3], unit: f64, of: &dyn Fn(&EquivalentAxis) -> f64| {
        row(axes.iter().map(|axis| of(axis) / unit))
    };
    let white = |axis: &EquivalentAxis| axis.white;
    // To the root hour: the unit over 60 √s.
    let arw = list(&imu.gyro, degree / 60.0, &white);
    let vrw = list(&imu.accel, 1.0 / 60.0, &white);
    let gbstd = list(&imu.gyro, degree / HOUR, &std);
    let abstd = list(&imu.accel, MILLIGAL, &std);
    out.body += &format!("imunoise:\n  arw: {arw}  # deg/√h\n  vrw: {vrw}  # m/s/√h\n");
    out.body += &format!("  gbstd: {gbstd}  # deg/h\n  abstd: {abstd}  # mGal\n");
    out.body += "  gsstd: [0.0, 0.0, 0.0]  # ppm; not part of a noise model\n";
    out.body += "  asstd: [0.0, 0.0, 0.0]  # ppm\n";
    out.body += &format!("  corrtime: {}  # h\n", number(tau / HOUR));
    for (key, axes, unit, unit_name) in [
        ("initbgstd", &imu.gyro, degree / HOUR, "deg/h"),
        ("initbastd", &imu.accel, MILLIGAL, "mGal"),
    ] {
        if axes.iter().any(|axis| axis.turn_on > 0.0) {
            let list = list(axes, unit, &|axis| axis.turn_on.hypot(std(axis)));
            out.body += &format!("{key}: {list}  # {unit_name}, with the turn-on constant\n");
        }
    }
    out.finish()
}

/// `sensor_msgs/Imu`: row-major 3×3 covariances of one sample, N² rate on the diagonal; −1 in the
/// first place where there is no such measurement.
///
/// A message has no field for biases: a filter that uses these covariances alone underestimates its
/// drift. robot_localization is such a one: `RosFilter::imuCallback` takes the covariances of the message, none of its fifteen
/// states (`filter_common.hpp`) is a bias.
pub(super) fn ros(imu: &Equivalent, rate_hz: f64) -> String {
    let mut out = Text::about(imu, "#");
    let rate = number(rate_hz);
    out.comment(&format!(
        "Covariances of one sample at {rate} Hz, N² rate on the diagonal, without biases; robot_localization takes them from the message and has no states for biases. They are the same in forward-left-up (REP 103) and forward-right-down axes."
    ));
    out.body += "imu:\n  ros__parameters:\n";
    for (quantity, axes, unit) in [
        ("angular_velocity", &imu.gyro, "rad/s"),
        ("linear_acceleration", &imu.accel, "m/s²"),
    ] {
        let [x, y, z] = [0, 1, 2].map(|i| {
            axes.get(i)
                .map_or(0.0, |axis| axis.white * axis.white * rate_hz)
        });
        let covariance = row([x, 0.0, 0.0, 0.0, y, 0.0, 0.0, 0.0, z].into_iter());
        let std = number(rms(axes, |axis| axis.white * rate_hz.sqrt()));
        out.body += &format!("    {quantity}_covariance: {covariance}  # ({unit})²\n");
        out.body +=
            &format!("    {quantity}_stdev: {std}  # {unit}, root mean square of the axes\n");
    }
    out.finish()
        + "    orientation_covariance: [-1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]  # not measured\n"
}

/// PX4's EKF2, `covariance.cpp`: a prediction over dt adds (noise dt)² to angle and velocity and
/// (bias noise dt)² to the bias, so that a density N is the parameter N/√dt. Ranges and units:
/// PX4 parameter reference. The file: "Parameter file format" of QGroundControl.
///
/// Values outside of PX4's range are written as they are, with a comment. Zero initial biases are
/// not written, so that PX4's defaults apply.
pub(super) fn px4(imu: &Equivalent, rate_hz: f64) -> String {
    let mut out = Text::about(imu, "#");
    let rate = number(rate_hz);
    out.comment(&format!(
        "Each number is the root mean square of the three axes, as a standard deviation per prediction at {rate} Hz, N/√dt (EKF2_PREDICT_US). A noise model does not include vibration, which PX4's defaults allow for."
    ));
    let root = rate_hz.sqrt();
    let white = |axis: &EquivalentAxis| axis.white * root;
    let drive = |axis: &EquivalentAxis| axis.walk * root;
    let turn_on = |axis: &EquivalentAxis| axis.turn_on;
    let (gyro, accel) = (&imu.gyro, &imu.accel);
    /// Name, axes, what of an axis, PX4's range and unit.
    type Parameter<'a> = (
        &'a str,
        &'a [EquivalentAxis; 3],
        OfAxis<'a>,
        f64,
        f64,
        &'a str,
    );
    type OfAxis<'a> = &'a dyn Fn(&EquivalentAxis) -> f64;
    let parameters: [Parameter; 6] = [
        ("EKF2_GYR_NOISE", gyro, &white, 1e-4, 0.1, "rad/s"),
        ("EKF2_ACC_NOISE", accel, &white, 0.01, 1.0, "m/s²"),
        ("EKF2_GYR_B_NOISE", gyro, &drive, 0.0, 0.01, "rad/s²"),
        ("EKF2_ACC_B_NOISE", accel, &drive, 0.0, 0.01, "m/s³"),
        ("EKF2_GBIAS_INIT", gyro, &turn_on, 0.0, 0.2, "rad/s"),
        ("EKF2_ABIAS_INIT", accel, &turn_on, 0.0, 0.5, "m/s²"),
    ];
    out.body += "#\n# Vehicle-Id\tComponent-Id\tName\tValue\tType\n";
    for (name, axes, of, least, most, unit) in parameters {
        let value = rms(axes, of);
        if name.ends_with("INIT") && value == 0.0 {
            continue;
        }
        out.comment(&ranged(name, unit, value, [least, most], "PX4"));
        out.body += &format!("1\t1\t{name}\t{}\t9\n", number(value));
    }
    out.finish()
}

/// ArduPilot's EKF3, `NavEKF3_core::CovariancePrediction` of `AP_NavEKF3_core.cpp`: a prediction over dt adds (noise dt)² to angle
/// and velocity and (bias noise dt²)² to biases that are angles and velocities of a step, so (bias noise dt)² to those of
/// rates: a density N is N/√dt, a random walk K is K/√dt. Ranges: the comments beside `AP_GROUPINFO` of `AP_NavEKF3.cpp`.
///
/// One number for three axes, as `NAME,VALUE`. Values outside of ArduPilot's range are written as they are, with a comment.
pub(super) fn ardupilot(imu: &Equivalent, rate_hz: f64) -> String {
    let mut out = Text::about(imu, "#");
    let rate = number(rate_hz);
    out.comment(&format!(
        "Each number is the root mean square of the three axes, as a standard deviation per prediction of EKF3 at {rate} Hz, N/√dt (EKF_TARGET_DT, 12 ms). A noise model does not include vibration, which ArduPilot's defaults allow for."
    ));
    let root = rate_hz.sqrt();
    let white = |axes| rms(axes, |axis| axis.white * root);
    let walk = |axes| rms(axes, |axis| axis.walk * root);
    let (gyro, accel) = (&imu.gyro, &imu.accel);
    for (name, value, range, unit) in [
        ("EK3_GYRO_P_NSE", white(gyro), [1e-4, 0.1], "rad/s"),
        ("EK3_ACC_P_NSE", white(accel), [0.01, 1.0], "m/s²"),
        ("EK3_GBIAS_P_NSE", walk(gyro), [1e-5, 1e-3], "rad/s²"),
        ("EK3_ABIAS_P_NSE", walk(accel), [1e-5, 0.02], "m/s³"),
    ] {
        out.comment(&ranged(name, unit, value, range, "ArduPilot"));
        out.body += &format!("{name},{}\n", number(value));
    }
    out.finish()
}

/// A parameter's name and unit, and the range of a program that its value is outside of.
fn ranged(name: &str, unit: &str, value: f64, [least, most]: [f64; 2], program: &str) -> String {
    let note = format!("{name} [{unit}]");
    match (least..=most).contains(&value) {
        true => note,
        false => format!(
            "{note}: outside of {program}'s range, {} to {}",
            number(least),
            number(most)
        ),
    }
}

/// GTSAM, `PreintegratedCombinedMeasurements::integrateMeasurement` of `gtsam/navigation/CombinedImuFactor.cpp`: a sample over dt adds
/// covariance/dt to its rate and force and covariance × dt to the biases, so that covariances are the squares of densities.
/// The factor inverts what comes out: a walk must not be 0. Up to 4.2 `biasAccOmegaInit` is divided by dt, too, and so
/// is more white noise of each sample; it is 0 here, since the identity that it has otherwise hides a sensor's noise. Later versions have none.
///
/// Python, one number an axis.
pub(super) fn gtsam(imu: &Equivalent) -> String {
    let mut out = Text::about(imu, "#");
    out.comment(
        "Squares of continuous-time densities of the axes x, y, z, in the axes of the samples.",
    );
    out.comment(
        "biasAccOmegaInit counts as white noise of each sample; the uncertainty of the first bias belongs to its prior.",
    );
    let squares = |axes: &[EquivalentAxis; 3], of: &dyn Fn(&EquivalentAxis) -> f64| {
        row(axes.iter().map(|axis| of(axis).powi(2)))
    };
    let gravity = number(STANDARD_GRAVITY);
    out.body += &format!(
        "import gtsam\nimport numpy as np\n\nparams = gtsam.PreintegrationCombinedParams.MakeSharedU({gravity})  # z up; MakeSharedD: down\n"
    );
    let white = |axis: &EquivalentAxis| axis.white;
    let walk = |axis: &EquivalentAxis| axis.walk;
    type OfAxis<'a> = &'a dyn Fn(&EquivalentAxis) -> f64;
    let covariances: [(_, _, OfAxis, _); 4] = [
        ("Accelerometer", &imu.accel, &white, "(m/s²)²/Hz"),
        ("Gyroscope", &imu.gyro, &white, "(rad/s)²/Hz"),
        ("BiasAcc", &imu.accel, &walk, "(m/s³)²/Hz"),
        ("BiasOmega", &imu.gyro, &walk, "(rad/s²)²/Hz"),
    ];
    for (name, axes, of, unit) in covariances {
        let squares = squares(axes, of);
        out.body += &format!("params.set{name}Covariance(np.diag({squares}))  # {unit}\n");
    }
    out.finish()
        + "if hasattr(params, \"setBiasAccOmegaInit\"):  # up to GTSAM 4.2\n    params.setBiasAccOmegaInit(np.zeros((6, 6)))\nparams.setIntegrationCovariance(1e-8 * np.eye(3))  # not of the sensor\n"
}

/// Gazebo, `GaussianNoiseModel::ApplyImpl` of gz-sensors' `src/GaussianNoiseModel.cc`: white noise of `stddev` a sample, and a bias that
/// starts at `bias_stddev` and is a Gauss-Markov process driven by `dynamic_bias_stddev` [unit/√s]: σ √(2/τ).
///
/// The `imu` element of a sensor in SDF. A random walk has a correlation time of an hour.
pub(super) fn gazebo(imu: &Equivalent, rate_hz: f64) -> String {
    let mut out = Text::about(imu, "");
    let rate = number(rate_hz);
    out.comment(&format!(
        "For samples at {rate} Hz, the update_rate of the sensor: stddev is N √rate, dynamic_bias_stddev σ √(2/τ)."
    ));
    let mut body = String::from("<imu>\n");
    for (quantity, axes) in [
        ("angular_velocity", &imu.gyro),
        ("linear_acceleration", &imu.accel),
    ] {
        body += &format!("  <{quantity}>\n");
        for (name, axis) in ["x", "y", "z"].into_iter().zip(axes) {
            let process = axis.slow.slowest().map(|of| (of.drive(), of.tau_s));
            let (drive, tau) = process.unwrap_or((axis.slow.drive(), HOUR));
            body += &format!("    <{name}>\n      <noise type=\"gaussian\">\n");
            for (key, value) in [
                ("mean", 0.0),
                ("stddev", axis.white * rate_hz.sqrt()),
                ("bias_mean", 0.0),
                ("bias_stddev", axis.turn_on),
                ("dynamic_bias_stddev", drive),
                ("dynamic_bias_correlation_time", tau),
            ] {
                body += &format!("        <{key}>{}</{key}>\n", number(value));
            }
            body += &format!("      </noise>\n    </{name}>\n");
        }
        body += &format!("  </{quantity}>\n");
    }
    // Two hyphens would end a comment.
    let comments = out.comments.iter().map(|line| {
        let line = line.replace("--", "- -");
        format!("<!-- {} -->\n", line.trim_end_matches('-'))
    });
    String::from_iter(comments) + &body + "</imu>\n"
}

/// MATLAB's `imuSensor` with single-sided noise, at which a sample's white noise has the standard
/// deviation NoiseDensity √rate and a step of the random walk RandomWalk/√rate. Its bias instability
/// is white noise through a filter of one's own: of φ = exp(−1/(rate τ)), √(1 − φ²)/(1 − φ z⁻¹), the
/// Gauss-Markov process itself.
///
/// The axes of a sensor have one filter, so one correlation time ([`super::equivalent`]).
pub(super) fn matlab(imu: &Equivalent, rate_hz: f64) -> String {
    let mut out = Text::about(imu, "%");
    for (name, constructor, axes) in [
        ("gyro", "gyroparams", &imu.gyro),
        ("accel", "accelparams", &imu.accel),
    ] {
        let list = |of: &dyn Fn(&EquivalentAxis) -> f64| row(axes.iter().map(of));
        let white = list(&|axis| axis.white);
        let walk = list(&|axis| axis.slow.walk.unwrap_or(0.0));
        out.body += &format!("{name} = {constructor}('NoiseType', 'single-sided', ...\n");
        out.body += &format!("    'NoiseDensity', {white}, ...\n    'RandomWalk', {walk}");
        if let Some(process) = axes.iter().find_map(|axis| axis.slow.slowest()) {
            let tau = process.tau_s;
            let sigma = list(&|axis| axis.slow.slowest().map_or(0.0, |of| of.sigma));
            // 1 − φ² by exp_m1: φ is 1 to ten digits for a slow process.
            let step = -1.0 / (rate_hz * tau);
            let (phi, gain) = (step.exp(), (-(2.0 * step).exp_m1()).sqrt());
            let time = number(tau);
            out.comment(&format!(
                "BiasInstability of {name} is a Gauss-Markov process of correlation time {time} s; its filter is that of the sample rate."
            ));
            out.body += &format!(", ...\n    'BiasInstability', {sigma}, ...\n");
            out.body += &format!(
                "    'BiasInstabilityCoefficients', struct('Numerator', {gain:?}, 'Denominator', [1.0, {:?}])",
                -phi
            );
        }
        out.body += ");\n";
        if axes.iter().any(|axis| axis.turn_on > 0.0) {
            let turn_on = list(&|axis| axis.turn_on);
            out.body +=
                &format!("{name}.ConstantBias = randn(1, 3) .* {turn_on};  % a new turn-on\n");
        }
    }
    out.finish()
        + &format!(
            "imu = imuSensor('accel-gyro', 'SampleRate', {}, 'Gyroscope', gyro, 'Accelerometer', accel);\n",
            number(rate_hz)
        )
}
