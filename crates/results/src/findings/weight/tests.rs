use super::*;

use crate::findings::{FarParameter, WrappedAxis};
use Severity::{Note, Unusable, Warning};
use undrift_events::{FixMend, Mismatch, SensorChange};

fn velocities(delay: f64, beyond: Option<f64>) -> Mismatch {
    Mismatch::LateVelocities { delay, beyond }
}

fn late(delay: f64) -> Finding {
    Finding::Late { delay }
}

fn rejected(height: bool, accepted_in_the_end: bool) -> Finding {
    Finding::Rejected(Contradiction {
        part: Part::Position,
        height,
        start: 1.0,
        end: 2.0,
        fixes: 5,
        first: 1.0,
        last: 1.0,
        growth: 0.0,
        largest: 1.0,
        frozen: false,
        accepted_in_the_end,
    })
}

fn accuracy(factor: f64) -> Finding {
    Finding::WrongAccuracy {
        part: Part::Position,
        factor,
        adapted: false,
        correlated: false,
    }
}

fn held(length: f64) -> Finding {
    Finding::Held {
        axis: 1,
        value: 0.0,
        start: 0.0,
        length,
        samples: 100,
        saturated: false,
    }
}

fn constant(vertical: bool) -> Finding {
    Finding::Constant {
        axis: 1,
        value: 0.0,
        samples: 100,
        vertical,
    }
}

fn far(sigmas: f64) -> Finding {
    Finding::FarParameter(FarParameter {
        parameter: "lever_arm".to_owned(),
        value: 1.0,
        sigmas,
    })
}

fn gaps(longest: f64) -> Finding {
    Finding::LongGaps {
        gaps: 1,
        first: 0.0,
        longest,
    }
}

fn disagreement(overall: f64) -> Finding {
    Finding::Disagreement {
        part: undrift_events::WindowPart::Position,
        start: 60.0,
        end: 90.0,
        inside: 0.5,
        rms: 4.0,
        overall,
        more: 0,
    }
}

fn not_run(all: bool) -> Finding {
    Finding::NotRun {
        models: vec!["white".to_owned()],
        all,
        why: None,
    }
}

fn drift(outside: u64, outages: u64) -> Finding {
    Finding::OptimisticDrift {
        model: "arma".to_owned(),
        inside: 0.8,
        outside,
        outages,
        tuned: false,
    }
}

fn of_model(what: Finding) -> Finding {
    Finding::OfModel {
        model: "white".to_owned(),
        what: Box::new(what),
    }
}

/// Each with its severity and its place between cause and symptom.
#[test]
fn a_finding_weighs_as_much_as_it_spoils_and_ranks_by_what_it_explains() {
    let axes = Finding::WrongAxes {
        forward: None,
        right: None,
        axes: None,
    };
    let out_of_order = Finding::OutOfOrder {
        log: Log::Imu,
        rows: 3,
        line: 9,
    };
    let set_back = Finding::SetBack {
        log: Log::Imu,
        line: 9,
        step: 1.0,
    };
    let left_out = |outages, of| {
        Finding::OutagesLeftOut(crate::findings::LeftOut {
            why: crate::findings::WhyLeftOut::InGap,
            outages,
            of,
            first: 0.0,
        })
    };
    let reference = |fixes, of| Finding::RejectedReference { fixes, of };
    let down = |z| Finding::NotDown {
        down: [0.0, 0.0, z],
    };
    let velocity = |mend| Finding::WrongVelocity { mend };
    let gravity = |ratio| Finding::WrongGravity {
        ratio,
        exchanged: false,
    };
    let turns = |ratio| Finding::WrongTurnRate { ratio };
    let noisy = |factor| Finding::NoisyFixes { factor };
    let wrapped = |jumps| {
        Finding::Wrapped(WrappedAxis {
            axis: 2,
            limit: 30.0,
            start: 1.0,
            jumps,
        })
    };
    let changed = |what| {
        Finding::SensorChanged(SensorChange {
            between: [1.0, 2.0],
            what,
        })
    };
    let apart = |delay| Finding::Mismatch {
        what: Mismatch::LateAccelerometers(delay),
    };
    let turned = |end, angle| Finding::HeadingOff {
        start: 0.0,
        end,
        angle,
        more: 0,
    };
    let slow = |factor| Finding::SlowSamples { rate: 1.0, factor };
    for (k, (finding, severity, rank)) in [
        (Finding::Diverged { time: 1.0 }, Unusable, 0),
        (Finding::NoOutage, Unusable, 0),
        (not_run(true), Unusable, 0),
        (not_run(false), Warning, 7),
        (axes, Unusable, 1),
        (Finding::WrongTurnAxis { axis: 0 }, Unusable, 1),
        (velocity(Some(FixMend::VelocityEastNorth)), Unusable, 1),
        (velocity(None), Warning, 1),
        (constant(true), Unusable, 1),
        (constant(false), Warning, 1),
        (late(0.7), Unusable, 1),
        (late(-0.7), Unusable, 1),
        (late(0.4), Warning, 1),
        (gravity(0.49), Unusable, 1),
        (gravity(2.01), Unusable, 1),
        (gravity(0.5), Warning, 1),
        (turns(2.0), Warning, 1),
        (turns(2.01), Unusable, 1),
        (down(-0.51), Warning, 1),
        (down(-0.49), Note, 1),
        (out_of_order, Warning, 1),
        (Finding::NoTurns, Warning, 1),
        (Finding::WrongSign { axis: 2 }, Warning, 1),
        (noisy(20.1), Warning, 1),
        (noisy(20.0), Note, 2),
        (noisy(3.0), Note, 7),
        (Finding::NoisyHeights { factor: 20.1 }, Warning, 2),
        (Finding::NoisyHeights { factor: 3.1 }, Note, 2),
        (Finding::Copied { axes: [0, 1] }, Unusable, 1),
        (wrapped(11), Unusable, 1),
        (wrapped(10), Warning, 1),
        (apart(0.16), Unusable, 2),
        (apart(0.14), Warning, 2),
        (
            Finding::Mismatch {
                what: Mismatch::MovesAside(3.0),
            },
            Warning,
            2,
        ),
        (
            Finding::Mismatch {
                what: velocities(0.19, None),
            },
            Note,
            2,
        ),
        (
            Finding::Mismatch {
                what: velocities(0.21, None),
            },
            Warning,
            2,
        ),
        (
            Finding::Mismatch {
                what: velocities(0.1, Some(2.0)),
            },
            Unusable,
            2,
        ),
        (
            Finding::Mismatch {
                what: Mismatch::HeldPositions(3.0),
            },
            Note,
            2,
        ),
        (
            Finding::Mismatch {
                what: Mismatch::Nods(0.034),
            },
            Warning,
            2,
        ),
        (
            Finding::Mismatch {
                what: Mismatch::Nods(0.036),
            },
            Unusable,
            2,
        ),
        (turned(61.0, 0.11), Unusable, 5),
        (turned(61.0, -0.09), Warning, 5),
        (turned(59.0, 0.11), Warning, 5),
        (changed(ChangeOf::Turned(1.0)), Unusable, 1),
        (changed(ChangeOf::NoTurn), Warning, 1),
        (Finding::VelocityScale { ratio: [1.2, 0.01] }, Unusable, 1),
        (Finding::VelocityScale { ratio: [0.9, 0.01] }, Warning, 1),
        (gaps(1.1), Note, 2),
        (gaps(1.0), Note, 7),
        (held(1.1), Warning, 2),
        (held(1.0), Note, 2),
        (set_back, Warning, 2),
        (Finding::VelocityBias { bias: [0.0; 3] }, Warning, 2),
        (rejected(true, true), Warning, 2),
        (rejected(true, false), Note, 6),
        (rejected(false, true), Note, 6),
        (far(7.1), Warning, 3),
        (far(7.0), Note, 3),
        (
            Finding::OptimisticModel {
                factor: 2.0,
                tuned: false,
            },
            Warning,
            3,
        ),
        (drift(0, 20), Warning, 4),
        (drift(20, 20), Unusable, 4),
        (Finding::LargeInnovations { start: 0.0 }, Warning, 5),
        (Finding::GuessedRate { rate: 50.0 }, Warning, 5),
        (Finding::MovingAverageSign { axes: Vec::new() }, Warning, 1),
        (disagreement(0.8), Warning, 5),
        (disagreement(0.79), Unusable, 5),
        (Finding::FixJitter { std: 0.02 }, Note, 2),
        (Finding::RoundedFixes { step: 1.0 }, Note, 2),
        (Finding::NoVerticalVelocity { start: 1.0 }, Note, 7),
        (
            Finding::SideSlip {
                start: 1.0,
                speed: 0.5,
            },
            Warning,
            2,
        ),
        (of_model(late(9.0)), Warning, 5),
        (of_model(late(0.4)), Note, 5),
        (accuracy(1.5), Note, 4),
        (accuracy(1.0), Note, 4),
        (accuracy(0.9), Note, 8),
        (reference(11, 100), Warning, 7),
        (reference(10, 100), Note, 7),
        (left_out(6, 11), Warning, 7),
        (left_out(5, 10), Note, 7),
        (left_out(10, 10), Unusable, 0),
        (slow(None), Warning, 1),
        (slow(Some(10.0)), Warning, 1),
        (slow(Some(10.1)), Unusable, 1),
        (Finding::Bridged { gaps: 1 }, Note, 7),
        (Finding::StartedLate { time: 1.0 }, Warning, 7),
    ]
    .into_iter()
    .enumerate()
    {
        assert_eq!(finding.severity(), severity, "{k}: {finding:?}");
        assert_eq!(finding.rank(), rank, "{k}: {finding:?}");
    }
}

/// P(X ≥ k) of a binomial of 20 and 0.2, tables: 0.0867 for 7, 0.0321 for 8.
#[test]
fn more_than_a_fifth_outside_is_beyond_chance_below_a_twentieth() {
    assert!(!is_beyond_chance(7, 20) && is_beyond_chance(8, 20));
    assert!(!is_beyond_chance(0, 20) && !is_beyond_chance(0, 0));
    // Of two both: 0.04.
    assert!(is_beyond_chance(2, 2) && !is_beyond_chance(1, 2));
}

#[test]
fn a_verdict_is_the_worst_severity_and_names_what_explains_it() {
    let cause = |found: &[Finding]| {
        let (severity, cause) = verdict(found);
        let cause = cause.map(|cause| found.iter().position(|of| std::ptr::eq(of, cause)).unwrap());
        (severity, cause)
    };
    assert_eq!(cause(&[]), (Note, None));
    assert_eq!(cause(&[gaps(5.0), accuracy(2.0)]), (Note, None));
    // A fault of the sensors explains what the solution shows, whatever it weighs itself.
    let large = Finding::LargeInnovations { start: 0.0 };
    assert_eq!(cause(&[gaps(5.0), large.clone()]), (Warning, Some(0)));
    assert_eq!(cause(&[far(9.0), large.clone()]), (Warning, Some(0)));
    assert_eq!(cause(&[far(5.0), large.clone()]), (Warning, Some(1)));
    assert_eq!(
        cause(&[gaps(5.0), held(5.0), large.clone()]),
        (Warning, Some(1))
    );
    // Late samples make innovations large; they turn no heading and move no antenna.
    let late_samples = Finding::LateSamples {
        delay: [0.1, 0.01],
        most: 1.0,
    };
    let off = Finding::HeadingOff {
        start: 1.0,
        end: 2.0,
        angle: 0.2,
        more: 0,
    };
    assert_eq!(
        cause(&[late_samples.clone(), large.clone()]),
        (Warning, Some(0))
    );
    assert_eq!(
        cause(&[late_samples.clone(), far(9.0), off.clone()]),
        (Warning, Some(1))
    );
    assert_eq!(cause(&[late_samples.clone(), off]), (Warning, Some(1)));
    // A solution that disagrees with the fixes for most of the log has a cause, too: what is doubtful itself, of the sensors or
    // the fixes.
    let ends = disagreement(0.5);
    assert_eq!(cause(std::slice::from_ref(&ends)), (Unusable, Some(0)));
    assert_eq!(
        cause(&[far(5.0), accuracy(2.0), ends.clone()]),
        (Unusable, Some(2))
    );
    assert_eq!(cause(&[far(9.0), ends.clone()]), (Unusable, Some(0)));
    assert_eq!(
        cause(&[Finding::FixJitter { std: 0.1 }, far(9.0), ends]),
        (Unusable, Some(0))
    );
    // What ends a solution is explained by a wrong setting: surely one that spoils all, else any.
    let end = Finding::Diverged { time: 1.0 };
    assert_eq!(cause(&[end.clone(), large.clone()]), (Unusable, Some(0)));
    assert_eq!(
        cause(&[end.clone(), late(0.4), large.clone()]),
        (Unusable, Some(1))
    );
    assert_eq!(
        cause(&[end.clone(), late(0.4), constant(true)]),
        (Unusable, Some(2))
    );
    let sorted = ranked(vec![
        accuracy(0.5),
        large.clone(),
        late(0.4),
        end.clone(),
        held(2.0),
    ]);
    assert_eq!(sorted, [end, late(0.4), held(2.0), large, accuracy(0.5)]);
    assert!(is_doubtful(&[gaps(5.0), late(0.4)]) && !is_doubtful(&[gaps(5.0)]));
}

/// Half a metre for six seconds, then accepted.
fn jump() -> Contradiction {
    Contradiction {
        part: Part::Position,
        height: false,
        start: 100.0,
        end: 106.0,
        fixes: 7,
        first: 0.5,
        last: 0.6,
        growth: 0.017,
        largest: 0.6,
        frozen: false,
        accepted_in_the_end: true,
    }
}

#[test]
fn a_jump_lasts_stays_and_is_of_the_positions_alone() {
    let with = |change: fn(&mut Contradiction)| {
        let mut found = jump();
        change(&mut found);
        is_jump(&found)
    };
    assert!(with(|_| {}));
    // It came back, or the solution followed as where more than the positions contradicts it.
    assert!(!with(|of| of.accepted_in_the_end = false));
    assert!(!with(|of| of.end = 105.0));
    // Too far for a solution that drifts, however soon it followed.
    assert!(with(
        |of| (of.first, of.last, of.largest, of.end) = (31.0, 31.0, 31.0, 105.0)
    ));
    assert!(!with(
        |of| (of.first, of.last, of.largest, of.end) = (30.0, 30.0, 30.0, 105.0)
    ));
    // A solution that drifts away.
    assert!(!with(|of| of.last = 0.9));
    assert!(!with(|of| of.frozen = true));
    assert!(!with(|of| of.part = Part::Velocity));
    // Of a height the gate itself sees to that.
    assert!(with(|of| (of.height, of.end) = (true, 100.0)));
}

#[test]
fn poses_weigh_by_what_they_leave() {
    use crate::{findings::PosesApart, inspect::PoseFault};
    let of = |fault, mended| Finding::Poses(PosesApart { fault, mended });
    let slipped = |angle_deg, distance_m| PoseFault::Slipped {
        time: 80.0,
        angle_deg,
        distance_m,
    };
    let jumped = |end, lasting| PoseFault::Jumped {
        time: 80.0,
        end,
        angle_deg: 40.0,
        lasting,
    };
    let shifted = |distance_m| PoseFault::Shifted {
        time: 80.0,
        distance_m,
    };
    for (fault, mended, severity) in [
        (slipped(15.0, 0.0), false, Unusable),
        (slipped(0.0, 0.03), false, Unusable),
        (slipped(1.0, 0.01), false, Warning),
        (slipped(15.0, 0.03), true, Warning),
        (jumped(80.0, true), false, Unusable),
        (jumped(80.0, true), true, Warning),
        (shifted(0.23), false, Unusable),
        (shifted(0.23), true, Warning),
        (jumped(86.0, false), false, Warning),
        (jumped(80.2, false), false, Note),
        (PoseFault::ScalarFirst, false, Unusable),
        (PoseFault::ScalarFirst, true, Note),
        (PoseFault::Mirrored, false, Unusable),
        (PoseFault::OneAxis, false, Warning),
        (PoseFault::NoAttitudes, false, Note),
    ] {
        let found = of(fault, mended);
        assert_eq!(found.severity(), severity, "{found:?}");
        // A cause, where it is more than a note: before what the solution shows of it.
        let all = ranked(vec![accuracy(3.0), found.clone()]);
        assert_eq!(all[0] == found, severity > Note, "{found:?}");
    }
}
