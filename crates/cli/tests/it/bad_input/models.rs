//! Noise models that cannot be, or are of another rate.

use super::drives::{good, is_sound};
use super::log::{Case, Outcome, says};

const HEAD: &str = "format = \"undrift-imu\"\nversion = 1\n";
const GYRO: &str = "[gyro]\nwhite_noise = \"0.1 deg/sqrt(h)\"\n";
const ACCEL: &str = "[accel]\nwhite_noise = \"0.02 m/s/sqrt(h)\"\n";

fn run(case: &Case, model: &str) -> Outcome {
    case.put("imu.toml", model.as_bytes());
    case.run(&[
        "navigate",
        "drive.toml",
        "--model",
        "imu.toml",
        "-o",
        "nav.csv",
    ])
}

/// What is said of a model that is refused.
#[track_caller]
fn refused(case: &Case, model: &str, parts: &[&str]) {
    let outcome = run(case, model);
    assert_eq!(outcome.code, Some(1), "{model} {}", outcome.stderr);
    says(&outcome.stderr, parts);
}

/// A model of these coefficients for the gyros, on line 4, that is right otherwise.
fn arma(ar: &str, ma: &str) -> String {
    format!(
        "{HEAD}preset = \"adis16465\"\n[gyro.arma]\nsigma = \"0.01 deg/s\"\nrate = \"100 Hz\"\nar = [{ar}]\nma = [{ma}]\n"
    )
}

#[test]
fn unstable_autoregression() {
    let case = good().write("model_unstable");
    refused(
        &case,
        &arma("1.1", "0.5"),
        &["imu.toml line 4, gyro.arma:", "unstable"],
    );
    refused(&case, &arma("0.5, 0.6", "0.5"), &["gyro.arma:", "unstable"]);
}

#[test]
fn a_moving_average_that_is_not_invertible() {
    let case = good().write("model_noninvertible");
    // The same noise has an invertible form, in which it is run.
    let outcome = run(&case, &arma("0.99", "1.5"));
    assert!(outcome.succeeded(), "{}", outcome.stderr);
    is_sound(&outcome);
}

#[test]
fn numbers_that_are_none() {
    let case = good().write("model_numbers");
    refused(
        &case,
        &arma("nan", "0.5"),
        &["imu.toml line 7, gyro.arma.ar:", "finite"],
    );
    refused(&case, &arma("0.9", "inf"), &["gyro.arma.ma:", "finite"]);
    let negative = format!("{HEAD}{}{ACCEL}", GYRO.replace("0.1", "-0.1"));
    refused(
        &case,
        &negative,
        &["imu.toml line 4, gyro.white_noise:", "negative"],
    );
    let nan = format!("{HEAD}{}{ACCEL}", GYRO.replace("0.1", "nan"));
    refused(&case, &nan, &["imu.toml line 4, gyro.white_noise:"]);
}

#[test]
fn an_axis_that_is_none() {
    let case = good().write("model_axis");
    let model = format!("{HEAD}{GYRO}{ACCEL}[gyro_w]\nwhite_noise = \"0.1 deg/sqrt(h)\"\n");
    refused(
        &case,
        &model,
        &["imu.toml line 7, gyro_w: unknown key", "gyro_x"],
    );
}

#[test]
fn a_model_of_another_rate() {
    let case = good().write("model_rate");
    // Slower and faster than the log: made one of the log's rate.
    for rate in ["10 Hz", "1000 Hz"] {
        let outcome = run(&case, &arma("0.99", "0.5").replace("100 Hz", rate));
        assert!(outcome.succeeded(), "{rate} {}", outcome.stderr);
        is_sound(&outcome);
    }
    for (rate, words) in [
        ("0 Hz", "must be greater than zero"),
        ("-5 Hz", "must not be negative"),
    ] {
        let model = arma("0.99", "0.5").replace("100 Hz", rate);
        refused(&case, &model, &["imu.toml line 6, gyro.arma.rate: ", words]);
    }
}

#[test]
fn noise_of_none_or_of_everything() {
    let case = good().write("model_size");
    let model = |value: &str| format!("{HEAD}{}{ACCEL}", GYRO.replace("0.1", value));
    let strict = ["navigate", "drive.toml", "--model", "imu.toml", "--strict"];
    for value in ["0", "1e-30"] {
        case.put("imu.toml", model(value).as_bytes());
        let outcome = case.run(&strict);
        assert_eq!(outcome.code, Some(3), "{value} {}", outcome.stderr);
        says(
            &outcome.stderr,
            &["gyro scale factors", "prior standard deviations from zero"],
        );
    }
    case.put("imu.toml", model("1e6").as_bytes());
    let outcome = case.run(&strict);
    // Nothing is predicted: a solution of which that is said, or none.
    assert!(matches!(outcome.code, Some(1 | 3)), "{}", outcome.stderr);
    assert!(
        !outcome.stdout.starts_with("usable\n"),
        "{}",
        outcome.stdout
    );
}
