use super::*;

fn moments(values: &[f64]) -> Moments {
    let mut moments = Moments::default();
    values.iter().for_each(|value| moments.add(*value));
    moments
}

#[test]
fn moments_are_of_the_finite_values() {
    let finite = moments(&[1.0, f64::NAN, 2.0, f64::INFINITY, 6.0]);
    assert_eq!(finite.count, 3);
    assert_eq!(finite.mean(), Some(3.0));
    // (4 + 1 + 9)/2.
    assert!((finite.variance() - 7.0).abs() < 1e-12);
    assert_eq!(moments(&[5.0]).variance(), 0.0);
    assert_eq!(moments(&[5.0, 7.0]).variance(), 2.0);
    assert_eq!(moments(&[]).mean(), None);
}

/// Sums over two runs of four epochs, the first group of three degrees of freedom.
fn sums(nees: [[f64; 4]; 2]) -> RunSums {
    let mut sums = RunSums::new(4, 0);
    for (k, values) in nees.into_iter().enumerate() {
        let mut run = RunOutcome {
            started: Some(10.0 + k as f64),
            diverged: k == 1,
            ..RunOutcome::default()
        };
        run.freedom[0] = 3;
        for value in values {
            let mut epoch = [f64::NAN; GROUPS];
            epoch[0] = value;
            run.nees.push(epoch);
        }
        run.settled.nees[0].count = 2;
        run.settled.nees[0].sum = values[2] + values[3];
        sums.add(&run);
    }
    sums
}

#[test]
fn shares_of_epochs_are_of_averages_over_the_runs_within_their_bounds() {
    // Averages of two χ² of three: 95 % between 0.62 and 7.22.
    let (lower, upper) = average_bounds(3, 2);
    assert!((lower - 0.62).abs() < 0.01 && (upper - 7.22).abs() < 0.01);
    let sums = sums([[3.0, 0.2, 8.0, 2.0], [5.0, 0.4, 9.0, 4.0]]);
    let group = sums.group(0, 0);
    assert_eq!((group.freedom, group.epochs), (3, 4));
    let number = |number: Number| number.0;
    assert_eq!(number(group.share_inside), 0.5);
    assert_eq!(
        (number(group.share_above), number(group.share_below)),
        (0.25, 0.25)
    );
    let averages: Vec<f64> = group.average.iter().map(|n| n.0).collect();
    assert!(
        averages
            .iter()
            .zip([4.0, 0.3, 8.5, 3.0])
            .all(|(a, b)| (a - b).abs() < 1e-12)
    );
    assert!(group.lower.iter().all(|n| n.0 == lower) && group.upper.iter().all(|n| n.0 == upper));
    // The runs' own averages are 5 and 6.5, their variance 1.125 and the mean's error √(1.125/2), over three.
    assert!((number(group.mean_per_freedom) - 5.75 / 3.0).abs() < 1e-12);
    assert!((number(group.mean_standard_error) - 0.75 / 3.0).abs() < 1e-12);
    // Variances between the runs 2, 0.02, 0.5 and 2, on average 1.13: as many epochs as that holds 1.125.
    let effective = 1.13 / 1.125;
    assert!((number(group.effective_epochs) - effective).abs() < 1e-9);
    let error = (0.0475f64 / effective).sqrt();
    assert!((number(group.share_standard_error) - error).abs() < 1e-9);
    // 0.95 less twice 0.217 is 0.515: half of the epochs is too few, and the mean too large.
    assert_eq!(group.verdict, Some(Verdict::Optimistic));
    // From the third epoch on one of two is inside.
    let late = sums.group(0, 2);
    assert_eq!(
        (
            late.epochs,
            number(late.share_inside),
            number(late.share_above)
        ),
        (2, 0.5, 0.5)
    );
    assert_eq!(number(late.share_below), 0.0);
}

#[test]
fn a_verdict_is_by_the_share_inside_and_then_by_the_mean() {
    let verdict = |nees| sums(nees).group(0, 0).verdict;
    assert_eq!(
        verdict([[3.0, 2.0, 4.0, 2.0], [5.0, 1.0, 3.0, 4.0]]),
        Some(Verdict::Consistent)
    );
    assert_eq!(
        verdict([[9.0, 9.0, 9.0, 9.0], [8.0, 9.0, 9.0, 8.0]]),
        Some(Verdict::Optimistic)
    );
    assert_eq!(
        verdict([[0.1, 0.2, 0.1, 0.3], [0.2, 0.1, 0.2, 0.1]]),
        Some(Verdict::Pessimistic)
    );
}

#[test]
fn epochs_count_from_the_last_start_and_the_settling_on() {
    let sums = sums([[3.0, 0.2, 8.0, 2.0], [5.0, 0.4, 9.0, 4.0]]);
    let truth: Vec<TruthSample> = (0..4)
        .map(|k| TruthSample {
            time: 10.0 + f64::from(k),
            position: undrift_nav::earth::Geodetic::from_degrees(48.0, 11.0, 500.0),
            v_n: None,
            rpy: None,
        })
        .collect();
    let report = |settle| sums.report("model".into(), &truth, &[], settle);
    let found = report(1.0);
    assert_eq!(
        (found.diverged, found.started_s.0, &found.name[..]),
        (1, 11.0, "model")
    );
    // Started by 11 s: from 12 s on.
    assert_eq!(found.nees.len(), 1);
    assert_eq!(found.nees[0].epochs, 2);
    assert_eq!(report(0.0).nees[0].epochs, 3);
    assert_eq!(report(1.5).nees[0].epochs, 1);
    assert!(found.nis.is_empty());
}
