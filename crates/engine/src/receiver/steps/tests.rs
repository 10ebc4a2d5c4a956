use super::*;
use alloc::vec::Vec;

/// Jumps that are found of 200 fixes at 4 Hz of 2 cm, whose innovations differ from what the ones before left by `change(k)` \[m\]
/// north and by noise, while the solution drifts by as much a second \[m/s\]: time and size.
fn jumps(change: impl Fn(u32) -> f64, drift: f64) -> Vec<(f64, f64)> {
    let (mut steps, mut summary) = (Steps::default(), Summary::default());
    let (stated, east) = (Matrix3::identity() * 4e-4, Vector3::y() * 10.0);
    for k in 0..200u32 {
        let noise = 0.02 * f64::from(k * 7 % 5) - 0.04;
        let before = Vector3::new(change(k), noise, -noise);
        steps.used(
            0.25 * f64::from(k),
            [&before, &Vector3::zeros()],
            &stated,
            (drift, &east),
            &mut summary,
        );
    }
    let found = summary.contradictions.iter();
    found.map(|jump| (jump.start, jump.largest)).collect()
}

#[test]
fn a_step_that_stays_is_a_jump_of_its_size() {
    // Of the covariances of two fixes: five times 4.9 cm.
    for size in [0.45, -2.0] {
        let found = jumps(|k| if k == 80 { size } else { 0.0 }, 0.0);
        assert_eq!(found.len(), 1);
        assert!(
            found[0].0 == 20.0 && (found[0].1 / size.abs() - 1.0).abs() < 0.02,
            "{found:?}"
        );
    }
    assert_eq!(jumps(|k| if k == 80 { 0.2 } else { 0.0 }, 0.0), []);
    // What the solution drifts by in a quarter of a second is no step of the fixes.
    assert_eq!(jumps(|k| if k == 80 { 0.45 } else { 0.0 }, 1.2), []);
}

#[test]
fn one_fix_that_is_wrong_by_itself_and_a_scatter_are_none() {
    let there_and_back = |k| match k {
        80 => 1.0,
        81 => -1.0,
        _ => 0.0,
    };
    assert_eq!(jumps(there_and_back, 0.0), []);
    // Of fixes that scatter by half a metre a step of a metre is a usual one.
    let scatter = |k: u32| if k.is_multiple_of(2) { 0.5 } else { -0.5 };
    assert_eq!(
        jumps(|k| scatter(k) + f64::from(u8::from(k == 80)), 0.0),
        []
    );
    // It needs a few to know what is usual.
    assert_eq!(jumps(|k| if k == 5 { 2.0 } else { 0.0 }, 0.0), []);
}

#[test]
fn what_is_rejected_or_behind_a_gap_is_left_to_the_gate() {
    let mut summary = Summary::default();
    let mut steps = Steps::default();
    let stated = Matrix3::identity() * 4e-4;
    let mut at = |steps: &mut Steps, time: f64, north: f64| {
        let before = Vector3::new(north, 0.01, 0.0);
        steps.used(
            time,
            [&before, &Vector3::zeros()],
            &stated,
            (0.0, &Vector3::zeros()),
            &mut summary,
        );
    };
    for k in 0..40 {
        at(&mut steps, f64::from(k), 0.0);
    }
    steps.rejected();
    at(&mut steps, 40.0, 5.0);
    at(&mut steps, 43.0, 5.0);
    for k in 44..60 {
        at(&mut steps, f64::from(k), 0.0);
    }
    assert!(summary.contradictions.is_empty());
}

#[test]
fn a_step_along_the_track_may_be_a_stamp() {
    let along = |v_n: Vector3| {
        let (mut steps, mut summary) = (Steps::default(), Summary::default());
        for k in 0..100u32 {
            let noise = 0.01 * f64::from(k % 3);
            let step = if k == 50 { 1.0 } else { 0.0 };
            let before = Vector3::new(step, noise, 0.0);
            let stated = Matrix3::identity() * 4e-4;
            let changes = [&before, &Vector3::zeros()];
            steps.used(
                0.25 * f64::from(k),
                changes,
                &stated,
                (0.0, &v_n),
                &mut summary,
            );
        }
        summary.contradictions.len()
    };
    assert_eq!(along(Vector3::x() * 10.0), 0);
    assert_eq!(along(Vector3::new(10.0, 10.0, 0.0)), 1);
    // Of a vehicle that stands there is no track.
    assert_eq!(along(Vector3::x() * 0.4), 1);
}
