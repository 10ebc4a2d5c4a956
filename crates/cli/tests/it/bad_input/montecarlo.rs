//! Mistakes in the specification of a Monte Carlo.

use super::log::{Log, says};

const SPEC: &str = r#"model = "adis16465"
[filter]
bias_models = ["arma", "white"]
[drive]
kind = "car"
duration = "150 s"
rate = "50 Hz"
[gnss]
rate = "1 Hz"
[epochs]
settle = "30 s"
"#;

#[test]
fn a_monte_carlo_is_carried_out() {
    let case = Log::good().write("montecarlo");
    case.put("spec.toml", SPEC.as_bytes());
    let outcome = case.run(&[
        "montecarlo",
        "spec.toml",
        "--runs",
        "3",
        "--figure",
        "nees.svg",
    ]);
    assert!(outcome.succeeded(), "{}", outcome.stderr);
    assert_eq!(outcome.stderr, "");
    says(
        &outcome.stdout,
        &["3 runs of a simulated drive of 150 s", "arma: ", "white: "],
    );
    // One panel for each group of states, each in its bounds.
    let drawn = std::fs::read_to_string(case.path("nees.svg")).unwrap();
    assert!(drawn.matches("average NEES / dof").count() >= 4 && !drawn.contains("NaN"));
    let outcome = case.run(&[
        "montecarlo",
        "spec.toml",
        "--runs",
        "2",
        "--figure",
        "nees.png",
    ]);
    assert!(!outcome.succeeded());
    says(
        &outcome.stderr,
        &["figures are written as SVG", "nees.svg", "from the page"],
    );
    let outcome = case.run(&[
        "montecarlo",
        "spec.toml",
        "--runs",
        "2",
        "--bias-models",
        "random-walk",
        "--json",
        "-",
    ]);
    assert!(outcome.succeeded(), "{}", outcome.stderr);
    let result: serde_json::Value = serde_json::from_str(&outcome.stdout).unwrap();
    let models = result["models"].as_array().unwrap();
    assert_eq!(models.len(), 1);
    assert_eq!(models[0]["name"], "random-walk");
    assert!(models[0]["nees"][0]["share_inside"].is_number());
}

#[test]
fn mistakes_in_the_specification() {
    let case = Log::good().write("montecarlo_mistakes");
    // What is replaced, by what, and what is said of it.
    let cases: &[(&str, &str, &[&str])] = &[
        (
            "model =",
            "modell =",
            &[
                "spec.toml line 1, modell: unknown key; did you mean model? known here: bias_model, drive",
            ],
        ),
        (
            "model = \"adis16465\"\n",
            "",
            &[
                "spec.toml, model: missing: the sensors' noise model",
                "`undrift model --list`",
            ],
        ),
        (
            "adis16465",
            "adis99999",
            &[
                "spec.toml line 1, model: ",
                "a model is a file or a preset; `undrift model --list`",
            ],
        ),
        (
            "[\"arma\", \"white\"]",
            "[\"arma\", \"wight\"]",
            &["spec.toml line 3, filter.bias_models: \"wight\" is not one of \"white\", \"paper\""],
        ),
        (
            "[\"arma\", \"white\"]",
            "[]",
            &["line 3, filter.bias_models: must be a list of words such as [\"white\"]"],
        ),
        (
            "[\"arma\", \"white\"]",
            "\"arma\"",
            &["line 3, filter.bias_models: must be a list of words"],
        ),
        (
            "kind = \"car\"\n",
            "",
            &["spec.toml line 4, drive.kind: missing: \"car\" or \"flight\""],
        ),
        (
            "\"car\"",
            "\"boat\"",
            &["line 5, drive.kind: \"boat\" is not one of \"car\", \"flight\""],
        ),
        (
            "\"150 s\"",
            "\"60 s\"",
            &["line 6, drive.duration: must be 120 s, of which 60 s are at rest"],
        ),
        (
            "\"150 s\"",
            "150",
            &["line 6, drive.duration: the number needs a unit"],
        ),
        (
            "\"50 Hz\"",
            "\"1e9 Hz\"",
            &["line 7, drive.rate: must be above 0 Hz and make at most 20000000 samples"],
        ),
        (
            "\"50 Hz\"",
            "\"50 Hz\"\nseed = -1",
            &["line 8, drive.seed: must be a whole number, 0 or more"],
        ),
        (
            "\"1 Hz\"",
            "\"0 Hz\"",
            &["line 9, gnss.rate: must be above 0 Hz"],
        ),
        (
            "\"1 Hz\"",
            "\"1 Hz\"\nposition_std = \"1, 0, 1 m\"",
            &["line 10, gnss.position_std: standard deviations must be positive"],
        ),
        (
            "\"1 Hz\"",
            "\"1 Hz\"\nstart = \"200 s\"",
            &["line 10, gnss.start: must lie within the drive"],
        ),
        (
            "settle = \"30 s\"",
            "settle = \"150 s\"",
            &["line 11, epochs.settle: must be shorter than the drive of 150 s"],
        ),
        (
            "settle = \"30 s\"",
            "every = \"0.03 s\"",
            &["line 11, epochs.every: must be a whole number of samples, which are 0.02 s apart"],
        ),
        (
            "[epochs]",
            "[initial]\ntruth_std = \"1 deg\"\nattitude = \"0 deg\"\n[epochs]",
            &["line 12, initial.attitude: set truth_std or attitude, not both"],
        ),
        (
            "[epochs]",
            "[initial]\ntruth_std = \"0 deg\"\n[epochs]",
            &["line 11, initial.truth_std: standard deviations must be positive"],
        ),
        ("[epochs]", "[epoch]", &["line 10, epoch: unknown key"]),
        ("[drive]", "[drive", &["spec.toml line 4"]),
    ];
    for (from, to, parts) in cases {
        assert!(SPEC.contains(from), "{from}");
        case.put("spec.toml", SPEC.replacen(from, to, 1).as_bytes());
        let outcome = case.run(&["montecarlo", "spec.toml", "--runs", "2"]);
        assert_eq!(outcome.code, Some(1), "{to}: {}", outcome.stdout);
        says(&outcome.stderr, parts);
        assert_eq!(outcome.stderr.lines().count(), 1, "{}", outcome.stderr);
    }
}

#[test]
fn runs_that_cannot_be() {
    let case = Log::good().write("montecarlo_runs");
    case.put("spec.toml", SPEC.as_bytes());
    for runs in ["0", "1", "99999999999"] {
        let outcome = case.run(&["montecarlo", "spec.toml", "--runs", runs]);
        assert_eq!(outcome.code, Some(1));
        says(&outcome.stderr, &["runs of this drive: must be 2 to"]);
    }
    let outcome = case.run(&["montecarlo", "sepc.toml"]);
    assert_eq!(outcome.code, Some(1));
    says(
        &outcome.stderr,
        &["sepc.toml: no such file; did you mean spec.toml?"],
    );
    // A drive so short does not move.
    case.put("spec.toml", SPEC.replace("150 s", "100 s").as_bytes());
    let outcome = case.run(&["montecarlo", "spec.toml", "--runs", "2"]);
    assert_eq!(outcome.code, Some(1));
    says(
        &outcome.stderr,
        &["spec.toml line 6, drive.duration: must be 120 s"],
    );
}

#[test]
fn every_key_of_the_specification_is_in_its_page() {
    let page = include_str!("../../../../../docs/lab/montecarlo-command.md");
    for key in [
        "model",
        "bias_model",
        "bias_models",
        "kind",
        "duration",
        "rate",
        "seed",
        "position_std",
        "velocity_std",
        "lever_arm",
        "start",
        "noise_scale",
        "truth_std",
        "every",
        "settle",
    ] {
        assert!(page.contains(&format!("`{key}`")), "{key}");
    }
}
