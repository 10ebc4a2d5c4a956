use super::*;
use alloc::{string::String, vec::Vec};

const SIGMA: f64 = 0.1;

fn update(nis: f64, gate: &Gate) -> Update {
    Update {
        nis,
        dof: 3,
        whitened: [0.0; 3],
        score: 0.0,
        information: 1.5,
        outcome: if nis > gate.reject {
            Outcome::Rejected
        } else {
            Outcome::Used
        },
    }
}

/// Shows fixes with these innovations north at 4 Hz from `start` on; the verdict on each.
fn show(gate: &mut FixGate, start: f64, innovations: &[f64], summary: &mut Summary) -> String {
    let r = Matrix3::identity() * (SIGMA * SIGMA);
    let mut time = start;
    let mut seen = String::new();
    for x in innovations {
        let innovation = Vector3::new(*x, 0.0, 0.0);
        match gate.judge(time, &innovation, &r, 15.0) {
            Verdict::ResetToFixes(_) => {
                gate.reset_to_fix(time, &innovation, summary);
                seen.push('g');
            }
            Verdict::Limits(limits) => {
                let update = update((x / SIGMA).powi(2), &limits);
                gate.note(time, &innovation, &update, false, summary);
                seen.push(if update.outcome == Outcome::Rejected {
                    'r'
                } else {
                    '.'
                });
            }
        }
        time += 0.25;
    }
    seen
}

fn settled(summary: &mut Summary) -> FixGate {
    let mut gate = FixGate::new(Part::Position, 0.0);
    assert_eq!(show(&mut gate, 0.0, &[0.15; 40], summary), ".".repeat(40));
    gate
}

#[test]
fn a_jump_is_left_out_and_written_down() {
    let mut summary = Summary::default();
    let mut gate = settled(&mut summary);
    assert_eq!(
        show(&mut gate, 10.0, &[0.1, 50.0, 0.1], &mut summary),
        ".r."
    );
    let jump = summary.contradictions[0];
    assert_eq!((jump.start, jump.end, jump.fixes), (10.25, 10.25, 1));
    assert_eq!(jump.largest, 50.0);
}

#[test]
fn jumps_that_do_not_agree_never_win_but_noise_of_a_new_size_does() {
    let mut summary = Summary::default();
    let mut gate = settled(&mut summary);
    let wild: Vec<f64> = (0..12)
        .map(|i| if i % 2 == 0 { 30.0 } else { -50.0 })
        .collect();
    assert_eq!(show(&mut gate, 10.0, &wild, &mut summary), "r".repeat(12));
    let noisier: Vec<f64> = (0..60)
        .map(|i| if i % 2 == 0 { 1.5 } else { -1.5 })
        .collect();
    let seen = show(&mut gate, 13.0, &noisier, &mut summary);
    assert!(seen.starts_with('r') && seen.ends_with('.'), "{seen}");
}

#[test]
fn a_lasting_jump_wins_after_the_patience() {
    let mut summary = Summary::default();
    let mut gate = settled(&mut summary);
    let seen = show(&mut gate, 10.0, &[20.0; 61], &mut summary);
    assert_eq!(seen, "r".repeat(60) + "g");
    assert!(summary.contradictions[0].accepted_in_the_end);
}

#[test]
fn after_an_outage_two_that_agree_win_and_one_alone_does_not() {
    let mut summary = Summary::default();
    let mut gate = settled(&mut summary);
    assert_eq!(show(&mut gate, 40.0, &[9.0, 0.1, 0.1], &mut summary), "r..");
    let mut gate = settled(&mut summary);
    assert_eq!(show(&mut gate, 40.0, &[9.0, 9.1], &mut summary), "rg");
}

#[test]
fn the_scale_finds_the_variance() {
    // Scalar innovations of variance 1 + 4·R, R stated 1.
    let mut scale = Scale::new();
    for i in 0..2000 {
        // Quantiles of the uniform distribution with the right variance, out of order.
        let u = f64::from((i * 617) % 2000) / 1999.0 * 2.0 - 1.0;
        let nu = u * (3.0f64 * 5.0).sqrt();
        let r = scale.factor();
        let s = 1.0 + r;
        let share = r / s;
        scale.learn(&Update {
            nis: nu * nu / s,
            dof: 1,
            whitened: [0.0; 3],
            score: 0.5 * share * (nu * nu / s - 1.0),
            information: 0.5 * share * share,
            outcome: Outcome::Used,
        });
    }
    assert!(
        (scale.factor() / 4.0 - 1.0).abs() < 0.2,
        "{}",
        scale.factor()
    );
}

#[test]
fn a_fix_is_weakened_where_right_ones_are_rare_and_rejected_where_there_are_no_right_ones() {
    let limits = |size: f64| {
        let mut summary = Summary::default();
        let mut gate = FixGate::new(Part::Position, 0.0);
        let usual = [size * SIGMA; 40];
        assert_eq!(show(&mut gate, 0.0, &usual, &mut summary), ".".repeat(40));
        let r = Matrix3::identity() * (SIGMA * SIGMA);
        gate.judge(10.0, &Vector3::zeros(), &r, 15.0)
    };
    // χ² of three components is beyond 15 once in 540 right fixes, beyond 90 never.
    let (weaken, reject) = (15.0, 90.0);
    assert_eq!(limits(1.0), Verdict::Limits(Gate { weaken, reject }));
    // Where innovations are usually larger, the limits are as many times the usual: here a squared size of 9 in place
    // of the median of χ², 2.366 (Abramowitz & Stegun, table 26.8; MEDIAN has three digits).
    let Verdict::Limits(larger) = limits(3.0) else {
        panic!("nothing was rejected");
    };
    let times = 9.0 / 2.366;
    assert!((larger.weaken / (weaken * times) - 1.0).abs() < 1e-3);
    assert!((larger.reject / (reject * times) - 1.0).abs() < 1e-3);
}
#[test]
fn after_a_gap_the_solution_is_to_be_confirmed_again() {
    let mut summary = Summary::default();
    let r = Matrix3::identity() * (SIGMA * SIGMA);
    for (pause, doubted) in [(0.99 * GAP, false), (1.01 * GAP, true)] {
        let mut gate = settled(&mut summary);
        assert!(!gate.is_in_doubt());
        // The last of the forty came at 9.75 s.
        gate.judge(9.75 + pause, &Vector3::zeros(), &r, 15.0);
        assert_eq!(gate.is_in_doubt(), doubted, "{pause}");
    }
}

#[test]
fn a_solution_that_takes_in_what_it_rejected_has_given_way_to_it() {
    let accepted_in_the_end = |rejected: f64, then: f64| {
        let mut summary = Summary::default();
        let mut gate = settled(&mut summary);
        let note = |gate: &mut FixGate, time, x, outcome, summary: &mut Summary| {
            let limits = Gate {
                weaken: 1e9,
                reject: 1e9,
            };
            let update = Update {
                outcome,
                ..update(1e6, &limits)
            };
            gate.note(time, &Vector3::new(x, 0.0, 0.0), &update, false, summary);
        };
        note(&mut gate, 10.0, rejected, Outcome::Rejected, &mut summary);
        note(&mut gate, 10.25, then, Outcome::Used, &mut summary);
        assert_eq!(summary.contradictions.len(), 1);
        summary.contradictions[0].accepted_in_the_end
    };
    // As large to three tenths, whatever its size.
    for size in [0.1, 1.0, 20.0] {
        assert!(accepted_in_the_end(1.29 * size, size) && accepted_in_the_end(0.71 * size, size));
        assert!(!accepted_in_the_end(1.31 * size, size) && !accepted_in_the_end(0.69 * size, size));
        assert!(!accepted_in_the_end(-size, size));
    }
}
