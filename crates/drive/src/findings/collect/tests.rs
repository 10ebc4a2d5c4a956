use super::*;

#[test]
fn rows_out_of_order_and_stamps_that_are_shared() {
    let mut skipped = Skipped::default();
    let none = |skipped: &Skipped| of_order(Log::Imu, skipped, 1.0, 10).is_empty();
    (0..10).for_each(|k| skipped.add(SkipKind::DuplicateTime, 3 + k, ""));
    assert!(none(&skipped));
    skipped.add(SkipKind::DuplicateTime, 20, "");
    assert_eq!(
        of_order(Log::Imu, &skipped, 1.0, 10),
        [Finding::SharedStamps {
            log: Log::Imu,
            rows: 11,
            interval: 1.0
        }]
    );
    let mut skipped = Skipped::default();
    (0..9).for_each(|k| skipped.add(SkipKind::TimeBackwards, 7 + 2 * k, ""));
    assert!(none(&skipped));
    skipped.add(SkipKind::TimeBackwards, 99, "");
    assert_eq!(
        of_order(Log::Gnss, &skipped, 1.0, 10),
        [Finding::OutOfOrder {
            log: Log::Gnss,
            rows: LEAST_UNSORTED,
            line: 7
        }]
    );
}

#[test]
fn axes_that_mend_a_turned_sensor() {
    // x forward, y left, z up.
    let present = Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0));
    let mend = |forward, right| mended_axes(&present, forward, right);
    assert_eq!(mend(Some(-1), Some(-2)).as_deref(), Some("-x,y,-z"));
    assert_eq!(mend(Some(-1), None).as_deref(), Some("-x,y,-z"));
    assert_eq!(mend(Some(2), Some(-1)).as_deref(), Some("-y,-x,-z"));
    assert_eq!(mend(Some(-2), None).as_deref(), Some("y,x,-z"));
    // Left-handed, not seen, or at an angle.
    assert_eq!(mend(Some(2), Some(1)), None);
    assert_eq!(mend(None, Some(1)), None);
    let (sin, cos) = 0.3_f64.sin_cos();
    let turned = Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0);
    assert_eq!(mended_axes(&turned, Some(-1), None), None);
}

#[test]
fn fix_errors_are_reported_beyond_their_thresholds() {
    let study = |repeated: u64| FixStudy {
        interval: 0.25,
        repeated,
        velocity_late: None,
        errors: FixErrors::default(),
    };
    let plain = FixErrors::default();
    assert_eq!(of_fixes(&study(0), &plain), []);
    let repeated = Finding::RepeatedFixes {
        fixes: 1,
        interval: 0.25,
    };
    assert_eq!(of_fixes(&study(1), &plain), [repeated]);
    let found_for = |errors: FixErrors| of_fixes(&study(0), &errors);
    // A twentieth of a standard deviation, more or less; of positions only more.
    for factor in [0.94, 1.06] {
        let modest = FixErrors {
            velocity_factor: undrift_nav::Vector3::repeat(factor),
            ..plain
        };
        assert_eq!(found_for(modest), [Finding::ModestVelocity { factor }]);
    }
    for factor in [0.96, 1.04] {
        let usual = FixErrors {
            velocity_factor: undrift_nav::Vector3::repeat(factor),
            position_factor: factor,
            ..plain
        };
        assert_eq!(found_for(usual), []);
    }
    let position = |factor: f64| FixErrors {
        position_factor: factor,
        ..plain
    };
    assert_eq!(found_for(position(0.5)), []);
    assert_eq!(
        found_for(position(1.06)),
        [Finding::NoisyFixes { factor: 1.06 }]
    );
    let all = FixErrors {
        velocity_bias: Vector3::new(0.0, -0.5, 0.0),
        step: Vector3::new(0.0, 1.0, 2.0),
        jitter: 0.01,
        correlated: Some(Correlated {
            share: 0.9,
            time: 30.0,
        }),
        ..plain
    };
    let expected = [
        Finding::VelocityBias {
            bias: [0.0, -0.5, 0.0],
        },
        Finding::RoundedFixes { step: 2.0 },
        Finding::FixJitter { std: 0.01 },
        Finding::CorrelatedFixes {
            share: 0.9,
            time: 30.0,
        },
    ];
    assert_eq!(found_for(all), expected);
}

/// Missing is more than a tenth of what the fixes span, and more than a short loss.
#[test]
fn a_log_ends_early_by_a_tenth_of_the_fixes() {
    let none = |end: f64, fixes| of_ends(end, fixes).is_none();
    assert!(none(990.0, [900.0, 1000.0]));
    let missing = of_ends(989.0, [900.0, 1000.0]);
    let expected = Finding::EndsEarly(LogEnd {
        end: 989.0,
        missing: 11.0,
    });
    assert_eq!(missing, Some(expected));
    assert!(none(1010.0, [900.0, 1000.0]));
    assert!(none(10.0, [0.0, 10.0 + WITHOUT_GNSS]));
    assert!(!none(10.0, [0.0, 10.5 + WITHOUT_GNSS]));
}

#[test]
fn rejected_spans_are_listed_up_to_three() {
    use crate::replay::Contradiction;
    let summary = |count: usize, more: u64| {
        let mut summary = Summary::default();
        summary.more_contradictions = more;
        summary.contradictions = (0..count)
            .map(|k| Contradiction {
                part: Part::Position,
                height: false,
                start: 1.0,
                end: 2.0,
                fixes: 3,
                first: 4.0,
                last: 5.0,
                growth: 6.0,
                largest: 7.0,
                frozen: false,
                accepted_in_the_end: k % 2 == 0,
            })
            .collect();
        summary
    };
    let more = |count, more| {
        let found = of_disagreement(&summary(count, more));
        let listed = found.iter().filter(|of| matches!(of, Finding::Rejected(_)));
        assert_eq!(listed.count(), count.min(3));
        found.into_iter().find_map(|of| match of {
            Finding::MoreRejected { spans, accepted } => Some((spans, accepted)),
            _ => None,
        })
    };
    assert_eq!(more(3, 0), None);
    // Of runs four to seven, the solution was reset to the fixes after five and seven.
    assert_eq!(more(4, 0), Some((1, 0)));
    assert_eq!(more(7, 10), Some((14, 2)));
}

/// Thirty positions of which a part is four standard deviations off, north; ten minutes of good ones before.
#[test]
fn the_worst_span_is_found_with_the_share_of_the_whole_log() {
    let of = |off: usize| {
        let mut summary = Summary::default();
        for k in 0..630 {
            let north = if k >= 600 && k < 600 + off { 4.0 } else { 0.0 };
            let update = undrift_nav::filter::Update {
                nis: north * north,
                dof: 2,
                whitened: [north, 0.0, 0.0],
                score: 0.0,
                information: 1.0,
                outcome: undrift_nav::filter::Outcome::Used,
            };
            summary.windows.add(Part::Position, k as f64, &update);
        }
        of_disagreement(&summary)
    };
    assert!(of(6).is_empty());
    let expected = Finding::Disagreement {
        part: WindowPart::Position,
        start: 600.0,
        end: 629.0,
        inside: 20.0 / 30.0,
        rms: (8.0f64 * 10.0 / 30.0).sqrt(),
        overall: 620.0 / 630.0,
        more: 0,
    };
    assert_eq!(of(10), [expected]);
}

#[test]
fn few_samples_are_why_solution_and_fixes_do_not_go_together() {
    let far = |sigmas| {
        Finding::FarParameter(FarParameter {
            parameter: "GyroScale".into(),
            value: 0.2,
            sigmas,
        })
    };
    let slow = |factor| Finding::SlowSamples { rate: 20.0, factor };
    assert_eq!(too_slow(20.0), Some(slow(None)));
    assert_eq!(too_slow(25.0), None);
    let doubtful = vec![far(9.0)];
    assert_eq!(with_rate(doubtful.clone(), 20.0), [slow(None), far(9.0)]);
    assert_eq!(with_rate(doubtful.clone(), 25.0), doubtful);
    assert_eq!(with_rate(vec![far(5.0)], 20.0), [far(5.0)]);
    let said = vec![slow(Some(2.0)), far(9.0)];
    assert_eq!(with_rate(said.clone(), 20.0), said);
}

/// Two updates whose whitened innovations are 1 and x have the autocorrelation 2x/(1 + x²): a half at 2 − √3.
fn correlated(x: f64) -> Summary {
    let mut summary = Summary::default();
    for value in [1.0, x] {
        summary.innovations[Aid::Velocity].add(undrift_nav::filter::Update {
            nis: value * value,
            dof: 1,
            whitened: [value, 0.0, 0.0],
            score: 0.0,
            information: 1.0,
            outcome: undrift_nav::filter::Outcome::Used,
        });
    }
    summary
}

#[test]
fn innovations_are_correlated_from_a_half_on() {
    let half = 2.0 - 3f64.sqrt();
    for (x, expected) in [
        (0.99 * half, false),
        (1.01 * half, true),
        (-1.01 * half, false),
    ] {
        let found = of_accuracy(Part::Position, 2.0, &correlated(x), false);
        let Finding::WrongAccuracy {
            part,
            factor,
            adapted,
            correlated,
        } = found
        else {
            panic!("{found:?}");
        };
        assert_eq!(
            (part, factor, adapted, correlated),
            (Part::Position, 2.0, false, expected),
            "{x}"
        );
    }
    let mut adapted = correlated(0.0);
    adapted.adapted = [None, Some(1.0)];
    assert!(matches!(
        of_accuracy(Part::Velocity, 0.5, &adapted, true),
        Finding::WrongAccuracy {
            adapted: true,
            correlated: false,
            ..
        }
    ));
    // Of fixes that are as good as they state the model is to blame, if they seem worse; or a log too slow.
    let found = of_accuracy(Part::Velocity, 1.5, &adapted, true);
    let (rate, factor) = (24.0, 1.5);
    assert_eq!(
        of_rate(found.clone(), rate),
        Finding::SlowSamples {
            rate,
            factor: Some(factor)
        }
    );
    assert_eq!(of_rate(found.clone(), 25.0), found);
    assert_eq!(
        of_accuracy(Part::Velocity, 1.5, &adapted, true),
        Finding::OptimisticModel {
            factor: 1.5,
            tuned: false
        }
    );
}
