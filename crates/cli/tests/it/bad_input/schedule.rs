//! Outages that cannot be cut.

use super::log::{Log, says};

#[test]
fn outages_that_fit_are_cut() {
    let case = Log::good().write("outages");
    let outcome = case.outages(&["--count", "3", "--start", "40", "--length", "5"]);
    assert!(outcome.succeeded(), "{}", outcome.stderr);
    assert_eq!(outcome.stderr, "");
    says(&outcome.stdout, &["3 outages of 5 s, reference: the truth"]);
    let outcome = case.outages(&["--at", "41,70.5", "--length", "5", "--json", "-"]);
    assert!(outcome.succeeded(), "{}", outcome.stderr);
    says(&outcome.stdout, &["\"start_s\": 41.0", "\"start_s\": 70.5"]);
    let result: serde_json::Value = serde_json::from_str(&outcome.stdout).unwrap();
    let errors = result["models"].to_string();
    assert!(!errors.contains("null"), "{errors}");
}

#[test]
fn outages_that_cannot_be_are_refused() {
    let case = Log::good().write("no_outages");
    let count = ["--count", "2", "--start", "40"];
    let refused = |arguments: &[&str], code: i32, parts: &[&str]| {
        let arguments: Vec<String> = arguments
            .chunks(2)
            .map(|pair| format!("{}={}", pair[0], pair[1]))
            .collect();
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let outcome = case.outages(&arguments);
        assert_eq!(outcome.code, Some(code), "{arguments:?} {}", outcome.stderr);
        assert_eq!(outcome.stdout, "", "{arguments:?}");
        says(&outcome.stderr, parts);
    };
    for (arguments, parts) in [
        (
            &["--at", "40,42", "--length", "5"][..],
            &["the outages overlap", "2 of 5 s"][..],
        ),
        (
            &["--every", "3", "--start", "40", "--length", "5"],
            &["the outages overlap"],
        ),
        (
            &["--every", "1e-300", "--length", "5"],
            &["the outages overlap"],
        ),
        (
            &["--count", "20", "--start", "40", "--length", "5"],
            &["the outages overlap"],
        ),
        (
            &["--count", "999999999999", "--length", "1e-9"],
            &["more than 100000 outages"],
        ),
        (
            &[
                "--every", "10", "--count", "9", "--start", "40", "--length", "5",
            ],
            &["only 4 of the 9 outages fit"],
        ),
        (
            &["--count", "1", "--start", "78", "--length", "5"],
            &["--length 5: only 1 s lie between --start 78 and the last fix"],
        ),
        (
            &["--every", "10", "--start", "78", "--length", "5"],
            &["--length 5: only 1 s lie between --start 78 and the last fix"],
        ),
        (
            &["--at", "500", "--length", "5"],
            &["--at 500: a 5 s outage must begin between 1 s and 75 s"],
        ),
        (
            &["--at", "0.5", "--length", "5"],
            &["a 5 s outage must begin between 1 s and 75 s"],
        ),
        (
            &["--at", "inf", "--length", "5"],
            &["a 5 s outage must begin between 1 s and 75 s"],
        ),
    ] {
        refused(arguments, 1, parts);
    }
    // Which no drive could be cut by.
    for (arguments, parts) in [
        (
            &["--count", "0", "--length", "5"][..],
            &["number of outages must be above 0"][..],
        ),
        (
            &["--every", "10", "--count", "0", "--length", "5"],
            &["number of outages must be above 0"],
        ),
        (
            &["--every", "-1", "--length", "5"],
            &["must be more than 0 s apart"],
        ),
        (
            &["--count", "1", "--start", "nan", "--length", "5"],
            &["0 s or more after the first fix"],
        ),
        (
            &["--every", "10", "--start", "-60", "--length", "5"],
            &["0 s or more after the first fix"],
        ),
        (
            &[&count[..], &["--length", "0"]].concat(),
            &["longer than 0 s, not 0 s"],
        ),
        (
            &[&count[..], &["--length", "-5"]].concat(),
            &["longer than 0 s, not -5 s"],
        ),
        (
            &[&count[..], &["--length", "nan"]].concat(),
            &["longer than 0 s, not NaN s"],
        ),
    ] {
        refused(arguments, 2, parts);
    }
}

#[test]
fn arguments_that_are_none_are_refused() {
    let case = Log::good().write("arguments");
    for (arguments, parts) in [
        (
            &["--count", "x"][..],
            &["--count", "expected a whole number"][..],
        ),
        (&["--at", "1,two"], &["--at", "two", "expected a number"]),
        (
            &["--at", "50", "--every", "10"],
            &["--at", "cannot be used with"],
        ),
        (
            &["--bias-models", "gauss"],
            &["unknown bias model \"gauss\"", "gauss-markov"],
        ),
    ] {
        let outcome = case.run(&[&["outages", "drive.toml"], arguments].concat());
        assert_eq!(outcome.code, Some(2), "{}", outcome.stderr);
        says(&outcome.stderr, parts);
    }
}

#[test]
fn outages_before_the_solution_starts_are_said() {
    let case = Log::good().write("early_outages");
    let outcome = case.outages(&["--at", "5,50", "--length", "5"]);
    says(
        &outcome.stderr,
        &[
            "1 of 2 outages was excluded (at 5 s): begins before the solution does",
            "start the outages later",
        ],
    );
}

#[test]
fn without_a_truth_the_withheld_fixes_are_the_reference() {
    let mut log = Log::good();
    let (drive, _) = log.drive.split_once("[truth]").unwrap();
    log.drive = drive.to_owned();
    let outcome = log
        .write("no_truth")
        .outages(&["--at", "50", "--length", "5", "--json", "-"]);
    assert!(outcome.succeeded(), "{}", outcome.stderr);
    says(
        &outcome.stdout,
        &["\"reference\": \"gnss\"", "\"yaw_deg\": null"],
    );
}
