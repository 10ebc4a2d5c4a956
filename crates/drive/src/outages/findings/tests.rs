use super::*;
use crate::{
    findings::{LeftOut, Severity, verdict},
    navigate::Hindsight,
    outages::{ModelRun, OutageErrors},
    reference::{Coverage, Errors},
    replay::{Outage, ReplayError, Summary},
};

/// Of twenty errors as many inside three standard deviations.
fn coverage(inside: usize) -> Coverage {
    let mut coverage = Coverage::default();
    for k in 0..20 {
        let sigmas = if k < inside { 2.9 } else { 3.1 };
        coverage.add(&Errors([sigmas; 10]), &Errors([1.0; 10]));
    }
    coverage
}

/// A model with outages of which so many of twenty errors lie inside.
fn model(inside: &[usize]) -> ModelErrors {
    let unknown = Errors::UNKNOWN;
    let outage = |inside: &usize| OutageErrors {
        start_s: 0.0,
        max: unknown,
        end: unknown,
        sigma: unknown,
        nees: [f64::NAN; 3],
        covered: coverage(*inside),
        drift: Vec::new(),
        way: Vec::new(),
    };
    let mut all = Coverage::default();
    for inside in inside {
        for k in 0..20 {
            let sigmas = if k < *inside { 2.9 } else { 3.1 };
            all.add(&Errors([sigmas; 10]), &Errors([1.0; 10]));
        }
    }
    ModelErrors {
        max: unknown,
        rms: unknown,
        median: unknown,
        end_rms: unknown,
        nees: [f64::NAN; 3],
        coverage: all,
        left_out: 0,
        per_outage: inside.iter().map(outage).collect(),
        finding: None,
    }
}

fn severity(inside: &[usize]) -> Severity {
    let model = model(inside);
    let found = of_drift(&[("arma", &model)]);
    found.map_or(Severity::Note, |found| found.severity())
}

/// However few they are, outages outside of what is predicted are no "usable"; that they are more than a fifth of all
/// beyond chance is "not usable".
#[test]
fn the_share_inside_means_something_for_few_outages_as_for_many() {
    use Severity::{Note, Unusable, Warning};
    for (outside, of, expected) in [
        (0, 1, Note),
        (1, 1, Warning),
        (1, 2, Warning),
        (2, 2, Unusable),
        (1, 4, Warning),
        (2, 4, Warning),
        (3, 4, Unusable),
        (1, 5, Warning),
        // Nine in ten inside are enough.
        (1, 10, Note),
        (2, 10, Warning),
        (4, 10, Warning),
        (5, 10, Unusable),
    ] {
        let inside: Vec<usize> = (0..of).map(|k| if k < outside { 0 } else { 20 }).collect();
        assert_eq!(severity(&inside), expected, "{outside} of {of}");
    }
    // A little outside in each.
    assert_eq!(severity(&[18, 18]), Note);
    assert_eq!(severity(&[17, 18]), Warning);
}

#[test]
fn the_model_that_covers_most_decides() {
    let (a, b) = (model(&[10; 9]), model(&[16; 9]));
    let found = of_drift(&[("first", &a), ("second", &b)]);
    let expected = Finding::OptimisticDrift {
        model: "second".into(),
        inside: 0.8,
        outside: 9,
        outages: 9,
        tuned: false,
    };
    assert_eq!(found, Some(expected));
    let sound = model(&[20; 9]);
    assert_eq!(of_drift(&[("a", &a), ("b", &sound)]), None);
    assert_eq!(of_drift(&[]), None);
}

fn experiment(runs: Vec<(&str, Option<Finding>)>, left_out: usize) -> Experiment {
    let cut = |k: usize| Outage {
        start: k as f64,
        end: k as f64 + 1.0,
    };
    let run = |(name, finding): (&str, Option<Finding>)| {
        let errors = ModelErrors {
            finding,
            ..model(&[20; 3])
        };
        let run = ModelRun {
            name: name.to_owned(),
            errors,
            summary: Summary::default(),
        };
        (name.to_owned(), Ok(run))
    };
    Experiment {
        hindsight: Hindsight::Causal,
        compared: Vec::new(),
        cuts: if runs.is_empty() {
            Vec::new()
        } else {
            (0..3).map(cut).collect()
        },
        left_out: (0..left_out).map(|k| (cut(k), WhyLeftOut::InGap)).collect(),
        uncut: Err(ReplayError::Write(std::io::Error::other("none"))),
        withheld: [0; 2],
        runs: runs.into_iter().map(run).collect(),
        without: Vec::new(),
    }
}

/// The word of the verdict and what makes `--strict` fail are one: nothing of a model is doubtful beside a "usable".
#[test]
fn what_is_wrong_with_a_model_is_in_the_verdict() {
    let diverged = || Some(Finding::Diverged { time: 7.0 });
    let word = |of: &Experiment| {
        let found = of_outages(of, &[]);
        (verdict(&found).0, found)
    };
    let sound = experiment(vec![("white", None), ("arma", None)], 0);
    assert_eq!(word(&sound), (Severity::Note, Vec::new()));
    // One of two, all of two, the only one.
    let (severity, found) = word(&experiment(vec![("white", diverged()), ("arma", None)], 0));
    assert_eq!(severity, Severity::Warning);
    assert!(matches!(&found[..], [Finding::OfModel { model, .. }] if model == "white"));
    let both = experiment(vec![("white", diverged()), ("arma", diverged())], 0);
    assert_eq!(
        word(&both),
        (Severity::Unusable, vec![Finding::Diverged { time: 7.0 }])
    );
    let large = || Some(Finding::LargeInnovations { start: 7.0 });
    let worse = experiment(vec![("white", large()), ("arma", None)], 0);
    assert_eq!(word(&worse).0, Severity::Note);
    assert_eq!(
        word(&experiment(vec![("arma", large())], 0)).0,
        Severity::Warning
    );
    // What the run without outages says already is not said again.
    assert_eq!(of_outages(&both, &[Finding::Diverged { time: 6.0 }]), []);
    let mut failed = experiment(vec![("white", None), ("arma", None)], 0);
    failed.runs[0].1 = Err(ReplayError::Write(std::io::Error::other("none")));
    assert_eq!(word(&failed).0, Severity::Warning);
    failed.runs[1].1 = Err(ReplayError::Write(std::io::Error::other("none")));
    assert_eq!(word(&failed).0, Severity::Unusable);
}

#[test]
fn outages_that_are_left_out_are_counted_and_none_left_is_no_result() {
    let (few, most) = (
        experiment(vec![("arma", None)], 3),
        experiment(vec![("arma", None)], 4),
    );
    let of = |experiment: &Experiment| verdict(&of_outages(experiment, &[])).0;
    assert_eq!((of(&few), of(&most)), (Severity::Note, Severity::Warning));
    let expected = Finding::OutagesLeftOut(LeftOut {
        why: WhyLeftOut::InGap,
        outages: 3,
        of: 6,
        first: 0.0,
    });
    assert_eq!(of_outages(&few, &[]), [expected]);
    assert_eq!(of(&experiment(Vec::new(), 2)), Severity::Unusable);
}

/// Errors measured against few of the fixes say little.
#[test]
fn a_tenth_of_the_references_may_be_rejected() {
    let mut with = experiment(vec![("arma", None)], 0);
    let mut of = |rejected: u64| {
        with.withheld = [100, rejected];
        verdict(&of_outages(&with, &[])).0
    };
    assert_eq!((of(10), of(11)), (Severity::Note, Severity::Warning));
}
