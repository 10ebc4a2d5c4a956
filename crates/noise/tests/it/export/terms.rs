//! What a format's white noise and random walk stand for: ARMA models, several processes, fast ones.

use super::{DEG, MODEL, close, gyro_white, numbers};
use undrift_noise::{ImuModel, ModelFormat};

pub(super) fn with_arma(ar: &str, ma: &str) -> ImuModel {
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
