//! Whether the filter knows its own errors, on a short drive.

use std::path::Path;
use undrift::{
    montecarlo::{self, Spec},
    results::{MonteCarlo, Verdict},
};

const RUNS: usize = 10;

/// The car of the example for four minutes at half its rate; `more` is appended.
fn spec(bias_models: &str, more: &str) -> Spec {
    let text = include_str!("../../../../examples/montecarlo-car.toml")
        .replace("[\"arma\", \"paper\", \"white\"]", bias_models)
        .replace("\"600 s\"", "\"240 s\"")
        .replace("rate = \"200 Hz\"\nseed", "rate = \"100 Hz\"\nseed");
    Spec::from_toml(&(text + more), "spec.toml", Path::new("")).unwrap()
}

fn run(spec: &Spec, seed: u64) -> MonteCarlo {
    montecarlo::run(spec, RUNS, seed, || {}).unwrap()
}

#[test]
#[ignore = "slow: Monte Carlo"]
fn the_true_model_is_consistent() {
    let report = run(&spec("[\"arma\"]", ""), 1);
    let model = &report.models[0];
    assert_eq!((model.name.as_str(), model.diverged), ("arma", 0));
    assert_eq!(model.nees.len(), 6);
    for group in &model.nees {
        // Ten runs' own averages are independent draws, their mean over its estimated standard
        // error a Student t of nine degrees of freedom: beyond 4.8 once in a thousand. Six groups,
        // one seed: once in two hundred seeds a group would fail.
        let off = (group.mean_per_freedom.0 - 1.0) / group.mean_standard_error.0;
        assert!(off.abs() < 4.8, "{} {off}", group.name);
        // And within a quarter of 1 whatever the scatter: it would hide a wrong model otherwise.
        assert!((group.mean_per_freedom.0 - 1.0).abs() < 0.25, "{group:?}");
        // The share's own standard deviation is an estimate of ten runs: three of those.
        let least = 0.95 - 3.0 * group.share_standard_error.0;
        assert!(
            group.share_inside.0 > least,
            "{} {}",
            group.name,
            group.share_inside.0
        );
        assert!(group.epochs > 100);
    }
    for kind in &model.nis {
        // 3 × 1170 degrees of freedom: standard error √(2/3510) = 2.4 %; 4 of those.
        assert!((kind.nis_per_freedom.0 - 1.0).abs() < 0.095, "{kind:?}");
        let beyond = kind.autocorrelation.iter().flatten();
        let beyond = beyond.filter(|r| r.0.abs() > kind.autocorrelation_bound.0);
        // Of thirty; more than six once in a thousand.
        assert!(beyond.count() <= 6, "{kind:?}");
    }
    for (component, shares) in &model.coverage {
        // 1170 instants worth 30 at least, as correlated as they are: 2 σ, 95.4 ± 3.8 %.
        assert!(shares[1].0 > 0.80, "{component} {shares:?}");
    }
}

#[test]
#[ignore = "slow: Monte Carlo"]
fn scale_factors_late_fixes_and_errors_that_last_are_covered() {
    let text = include_str!("../../../../examples/montecarlo-car.toml")
        .replace("[\"arma\", \"paper\", \"white\"]", "[\"arma\"]")
        .replace("\"600 s\"", "\"400 s\"")
        .replace("rate = \"200 Hz\"\nseed", "rate = \"100 Hz\"\nseed")
        .replace("\"0.02, 0.02, 0.04 m\"", "\"2, 2, 4 m\"")
        .replace(
            "[gnss]",
            "[states]\nscale_factor = \"2 %\"\ntime_offset = \"0.1 s\"\n\n[gnss]\ncorrelation_time = \"60 s\"",
        );
    let spec = Spec::from_toml(&text, "spec.toml", Path::new("")).unwrap();
    let report = montecarlo::run(&spec, 2 * RUNS, 3, || {}).unwrap();
    let model = &report.models[0];
    assert_eq!(model.diverged, 0);
    for group in &model.nees {
        // The scale factors of the gyros that hardly turn are regressed on their own noise, and their biases with them.
        if group.name.contains("gyro") || group.name == "all" {
            continue;
        }
        // As above, twenty runs: a Student t of nineteen degrees of freedom, beyond 3.9 once in a thousand.
        let off = (group.mean_per_freedom.0 - 1.0) / group.mean_standard_error.0;
        assert!(off.abs() < 3.9, "{} {off}", group.name);
        assert!(group.mean_per_freedom.0 < 1.5, "{group:?}");
    }
    for kind in &model.nis {
        // 3 × 20 × 280 degrees of freedom: standard error 1.1 %; 4 of those.
        assert!((kind.nis_per_freedom.0 - 1.0).abs() < 0.045, "{kind:?}");
    }
}

#[test]
#[ignore = "slow: Monte Carlo"]
fn a_model_that_promises_too_much_is_found_out() {
    let three_times_too_small = "\n[filter.model]\npreset = \"adis16405\"\naccel.turn_on = \"10 mg\"\n\
        gyro.arma = { rate = \"200 Hz\", ar = [1.0], ma = [0.9994], sigma = \"0.157134 deg/s\" }\n\
        accel.arma = { rate = \"200 Hz\", ar = [1.0], ma = [0.9994], sigma = \"0.0157134 m/s^2\" }\n";
    let report = run(&spec("[\"arma\"]", three_times_too_small), 1);
    for group in &report.models[0].nees {
        if group.name != "position" {
            assert_eq!(group.verdict, Some(Verdict::Optimistic), "{}", group.name);
        }
    }
    assert_eq!(report.models[0].nis[1].verdict, Some(Verdict::Optimistic));
}

#[test]
#[ignore = "slow: Monte Carlo"]
fn paper_and_white_are_not_consistent() {
    let report = run(&spec("[\"paper\", \"white\"]", ""), 1);
    for model in &report.models {
        for group in &model.nees {
            // The paper's bias wanders so much that its covariance may hide anything.
            let bias = group.name.contains("bias");
            assert!(
                bias || group.verdict != Some(Verdict::Consistent),
                "{} {group:?}",
                model.name
            );
        }
    }
    let names: Vec<_> = report.models[1]
        .nees
        .iter()
        .map(|g| g.name.as_str())
        .collect();
    assert_eq!(
        names,
        ["position", "velocity", "attitude", "all"],
        "white has no bias"
    );
}

#[test]
fn the_result_does_not_depend_on_the_number_of_cores() {
    let short = Spec {
        settle: 10.0,
        ..spec("[\"arma\"]", "")
    };
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let report = pool
            .unwrap()
            .install(|| montecarlo::run(&short, 3, 5, || {}).unwrap());
        serde_json::to_string(&report).unwrap()
    };
    let one = with(1);
    assert_eq!(one, with(3));
    assert!(!one.contains("null") || one.contains("\"average\":[null"));
}

#[test]
fn a_drawn_attitude_starts_the_filter_at_the_first_fix() {
    let small = spec(
        "[\"arma\"]",
        "\n[initial]\ntruth_std = \"0.1, 0.1, 0.5 deg\"\n",
    );
    let small = Spec {
        settle: 0.0,
        ..small
    };
    let report = montecarlo::run(&small, RUNS, 1, || {}).unwrap();
    let attitude = &report.models[0].nees[2];
    // The first epoch is at the first fix: three draws in each of ten runs, nothing else yet.
    let (first, low, high) = (attitude.average[0], attitude.lower[0], attitude.upper[0]);
    let (first, low, high) = (first.0, low.0, high.0);
    assert_eq!(report.models[0].started_s.0, 1.0);
    assert!((low..high).contains(&first), "{low} {first} {high}");
}
