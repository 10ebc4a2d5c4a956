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
//! | ROS `sensor_msgs/Imu` | variance N²/T | – |
//! | KF-GINS | N in deg/√h, m/s/√h | Gauss-Markov of one τ, driven by 2σ²/τ |
//! | MATLAB `imuSensor` | N | K, and a Gauss-Markov process |
//!
//! Programs with one number for a sensor get the root mean square of its three axes, which
//! preserves the mean variance. The functions are pure: [`Equivalent`] in, text out; they do no
//! fitting. What a format cannot hold (quantisation, lines, several processes) is in the remarks of
//! [`Equivalent`], which every text has as comments at its head.

use super::comments::comment;
use super::equivalent::{Equivalent, EquivalentAxis, common_tau, driven, rms};
use undrift_nav::earth::STANDARD_GRAVITY;

/// EKF2's prediction, EKF2_PREDICT_US = 10000 unless changed \[Hz\].
pub(super) const PX4_RATE: f64 = 100.0;
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
/// drift.
pub(super) fn ros(imu: &Equivalent, rate_hz: f64) -> String {
    let mut out = Text::about(imu, "#");
    let rate = number(rate_hz);
    out.comment(&format!(
        "Covariances of one sample at {rate} Hz, N² rate on the diagonal, without biases. They are the same in forward-left-up (REP 103) and forward-right-down axes."
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
        let mut note = format!("{name} [{unit}]");
        if !(least..=most).contains(&value) {
            note += &format!(
                ": outside of PX4's range, {} to {}",
                number(least),
                number(most)
            );
        }
        out.comment(&note);
        out.body += &format!("1\t1\t{name}\t{}\t9\n", number(value));
    }
    out.finish()
}

/// MATLAB's `imuSensor` with single-sided noise, at which a sample's white noise has the standard
/// deviation NoiseDensity √rate and a step of the random walk RandomWalk/√rate. Its bias instability
/// is white noise through a filter of one's own: of φ = exp(−1/(rate τ)), √(1 − φ²)/(1 − φ z⁻¹), the
/// Gauss-Markov process itself.
///
/// With several Gauss-Markov processes the slowest becomes `BiasInstability`; the others are joined
/// with the random walk ([`crate::bias_model`]).
pub(super) fn matlab(imu: &Equivalent, rate_hz: f64) -> String {
    let mut out = Text::about(imu, "%");
    for (name, constructor, axes) in [
        ("gyro", "gyroparams", &imu.gyro),
        ("accel", "accelparams", &imu.accel),
    ] {
        let list = |of: &dyn Fn(&EquivalentAxis) -> f64| row(axes.iter().map(of));
        let white = list(&|axis| axis.white);
        let walk = list(&|axis| axis.slow.beside_slowest());
        out.body += &format!("{name} = {constructor}('NoiseType', 'single-sided', ...\n");
        out.body += &format!("    'NoiseDensity', {white}, ...\n    'RandomWalk', {walk}");
        let taus = axes.iter().filter_map(|axis| axis.slow.slowest());
        let taus: Vec<f64> = taus.map(|of| of.tau_s.ln()).collect();
        if !taus.is_empty() {
            let tau = (taus.iter().sum::<f64>() / taus.len() as f64).exp();
            let sigma = list(&|axis| axis.slow.slowest().map_or(0.0, |of| of.sigma));
            // 1 − φ² by exp_m1: φ is 1 to ten digits for a slow process.
            let step = -1.0 / (rate_hz * tau);
            let (phi, gain) = (step.exp(), (-(2.0 * step).exp_m1()).sqrt());
            let time = number(tau);
            out.comment(&format!(
                "BiasInstability of {name} is a Gauss-Markov process of correlation time {time} s, the geometric mean of its axes, with the standard deviation of each kept; its filter is that of the sample rate."
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

/// A text under comments.
///
/// `mark` begins a comment line: `#`, `%`, or nothing where comments are strings of JSON.
struct Text {
    mark: &'static str,
    comments: Vec<String>,
    body: String,
}

impl Text {
    /// Begins with what the numbers are of.
    fn about(imu: &Equivalent, mark: &'static str) -> Self {
        let mut text = Self {
            mark,
            comments: Vec::new(),
            body: String::new(),
        };
        text.comment(match imu.name.as_str() {
            "" => "Inertial sensor",
            name => name,
        });
        if !imu.source.is_empty() {
            text.comment(&format!("Source: {}", imu.source));
        }
        let remarks = imu.remarks.iter();
        remarks.for_each(|remark| text.comment(&comment(remark)));
        text
    }

    /// One comment of one line, whatever the text.
    fn comment(&mut self, text: &str) {
        let is_break =
            |c: char| c.is_control() || matches!(c, '\u{2028}' | '\u{2029}' | '\u{feff}');
        let words: Vec<&str> = text
            .split(|c: char| c.is_whitespace() || is_break(c))
            .filter(|word| !word.is_empty())
            .collect();
        self.comments.push(words.join(" "));
    }

    /// The whole text, comments first.
    fn finish(self) -> String {
        let lines = self.comments.iter();
        let comments = lines.map(|line| format!("{} {line}\n", self.mark));
        String::from_iter(comments) + &self.body
    }
}

/// Numbers between brackets, as YAML and MATLAB take them.
///
/// Comma-separated, each by [`number`].
fn row(values: impl Iterator<Item = f64>) -> String {
    let items: Vec<String> = values.map(number).collect();
    format!("[{}]", items.join(", "))
}

/// Nine digits, with the point and the sign of the exponent that YAML 1.1 asks of a number.
///
/// `1e-5` becomes `1.0e-5` and `1e16` `1.0e+16`: YAML 1.1 takes the short forms for text.
fn number(value: f64) -> String {
    let rounded: f64 = format!("{value:.8e}").parse().unwrap_or(value);
    let text = format!("{rounded:?}");
    match text.split_once('e') {
        None => text,
        Some((mantissa, exponent)) => {
            let point = if mantissa.contains('.') { "" } else { ".0" };
            let sign = if exponent.starts_with('-') { "" } else { "+" };
            format!("{mantissa}{point}e{sign}{exponent}")
        }
    }
}
