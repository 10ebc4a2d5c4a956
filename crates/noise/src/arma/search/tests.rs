use super::*;
use crate::arma::{likelihood::Mean, polynomial::from_search};

/// A pair of AR roots r e^(±iω) is φ = (2 r cos ω, −r²).
#[test]
fn a_search_for_a_line_begins_at_frequencies_all_over() {
    for (samples, count) in [(999, 20), (1000, 60)] {
        let lower = [Point::new(Vec::new(), 0.0)];
        let mut candidates = Vec::new();
        line_starts(samples, &lower, 2, &mut candidates);
        assert_eq!(candidates.len(), 5 * count);
        for (at, z) in candidates.iter().enumerate() {
            assert_eq!(z.len(), 4);
            let radius = |part: &[f64]| {
                let found = from_search(part);
                let r = (-found[1]).sqrt();
                (r, (found[0] / (2.0 * r)).acos())
            };
            let ((ar, omega), (ma, same)) = (radius(&z[..2]), radius(&z[2..]));
            let expected = core::f64::consts::PI * ((at / 5) as f64 + 0.5) / count as f64;
            assert!(
                (omega - expected).abs() < 1e-6 && (same - expected).abs() < 1e-6,
                "{at}: {omega}"
            );
            let (r_ar, r_ma) = [
                (0.9, 0.98),
                (0.98, 0.9),
                (0.94, 0.96),
                (0.96, 0.94),
                (0.7, 0.4),
            ][at % 5];
            assert!(
                (ar - r_ar).abs() < 1e-6 && (ma - r_ma).abs() < 1e-6,
                "{at}: {ar} {ma}"
            );
        }
    }
}

fn wave(samples: usize, seed: u64) -> Vec<f64> {
    let filter = undrift_nav::shaping::ShapingFilter::arma(&[0.8], &[0.3], 1.0, 1.0).unwrap();
    let mut record = vec![0.0; samples];
    crate::synthesis::NoiseGenerator::new(&filter, seed).fill(&mut record);
    record
}

fn problem<'a>(samples: &'a [f64], rest: &'a [Problem<'a>]) -> Problem<'a> {
    Problem {
        samples,
        mean: Mean::Estimated,
        centre: 0.0,
        gaps: false,
        bridged: None,
        unit_root: false,
        rest,
    }
}

#[test]
fn a_search_spends_less_on_long_records_and_at_least_some_for_each_coefficient() {
    let (short, long) = (vec![0.0; 1000], vec![0.0; 497_000]);
    let rest = [problem(&short, &[]), problem(&short, &[])];
    let near =
        |found: f64, exact: f64| assert!((found / exact - 1.0).abs() < 1e-12, "{found} {exact}");
    // 2·10⁹ over 497 000 samples times 1 + ½ of 4, and 3000.
    near(
        problem(&long, &[]).budget(4, 0.5),
        1e9 / (3.0 * 497_000.0 + 3_000.0),
    );
    near(
        problem(&long, &rest).budget(4, 0.5),
        1e9 / (3.0 * 499_000.0 + 3_000.0),
    );
    let gaps = Problem {
        gaps: true,
        ..problem(&long, &[])
    };
    near(gaps.budget(4, 0.5), 1e9 / (6.0 * 497_000.0 + 3_000.0));
    near(problem(&short, &[]).budget(4, 0.5), 50_000.0);
    near(problem(&long, &[]).budget(4, 0.01), 240.0);
    near(Problem::screening_budget(4, 0.5), 15_000.0);
    near(Problem::screening_budget(4, 1e-3), 240.0);
}

#[test]
fn optima_are_kept_best_first_and_one_of_each_value() {
    let point = |value: f64| Point::new(vec![value], value);
    let values = [
        3.0,
        f64::NAN,
        1.0,
        1.0 + 0.9 * SAME,
        f64::INFINITY,
        1.0 + 2.1 * SAME,
        2.0,
    ];
    let found = distinct(values.map(point).to_vec());
    let found: Vec<f64> = found.iter().map(|point| point.value).collect();
    assert_eq!(found, [1.0, 1.0 + 2.1 * SAME, 2.0, 3.0]);
    let ladder = Ladder {
        rungs: vec![
            ((1, 0), vec![point(4.0), point(5.0)]),
            ((2, 1), vec![point(3.0)]),
        ],
        whittle: None,
    };
    assert_eq!(ladder.below(2, 1), Some(4.0));
    assert_eq!(ladder.below(3, 2), Some(3.0));
    assert_eq!((ladder.below(1, 0), ladder.below(2, 2)), (None, None));
    assert_eq!(ladder.at(1, 0).map(<[Point]>::len), Some(2));
}

#[test]
fn the_likelihood_of_records_is_the_sum_and_its_slope_is_the_gradient() {
    let records = [wave(300, 1), wave(200, 2), wave(150, 3)];
    let rest = [problem(&records[1], &[]), problem(&records[2], &[])];
    let all = problem(&records[0], &rest);
    let z = vec![0.7, -0.2, 0.4];
    let (phi, theta) = all.coefficients(&z, 2);
    let joint = all.likelihood(&phi, &theta).unwrap();
    assert_eq!(joint.observations, 650);
    let parts = records
        .each_ref()
        .map(|x| problem(x, &[]).likelihood(&phi, &theta).unwrap());
    let squares: f64 = parts.iter().map(|one| one.sum_of_squares).sum();
    assert!((joint.sum_of_squares / squares - 1.0).abs() < 1e-12);
    assert!((all.objective(std::slice::from_ref(&z), 2)[0] + joint.log_likelihood).abs() < 1e-9);
    let gradient = all.gradient(&z, 2).unwrap();
    for (i, slope) in gradient.iter().enumerate() {
        let moved = |by: f64| {
            let mut z = z.clone();
            z[i] += by;
            all.objective(&[z], 2)[0]
        };
        let exact = (moved(1e-5) - moved(-1e-5)) / 2e-5;
        assert!(
            (slope - exact).abs() < 1e-4 * (1.0 + exact.abs()),
            "{i}: {slope} {exact}"
        );
    }
    // Of one root differences cost as little; with gaps only the bridged record has one.
    assert_eq!(all.gradient(&[0.7, 0.4], 1), None);
    let gaps = Problem {
        gaps: true,
        bridged: Some(&records[0]),
        ..problem(&records[0], &[])
    };
    assert_eq!(gaps.gradient(&z, 2), None);
    assert_eq!(
        gaps.gradient_bridged(&z, 2),
        problem(&records[0], &[]).gradient(&z, 2)
    );
    let unbridged = Problem {
        bridged: None,
        ..gaps
    };
    assert_eq!(unbridged.gradient_bridged(&z, 2), None);
    // Of a single root the filter is run to its steady state: the same likelihood.
    let (phi, theta) = all.coefficients(&[0.7, 0.4], 1);
    let one = all.objective(&[vec![0.7, 0.4]], 1)[0];
    assert!((one + all.likelihood(&phi, &theta).unwrap().log_likelihood).abs() < 1e-8);
    assert!(all.is_confirmed(&z, 2));
    assert_eq!(Problem::by_search(&[0.7, 0.4], &[f64::NAN], &[1.0]), None);
}

#[test]
fn a_unit_root_is_laid_over_the_others() {
    let record = wave(100, 4);
    let walk = Problem {
        unit_root: true,
        gaps: true,
        ..problem(&record, &[])
    };
    let z = [0.7, 0.4];
    let ((phi, theta), (plain, same)) = (walk.coefficients(&z, 1), Problem::plain(&z, 1));
    let root = plain[0];
    assert!((root - 0.7f64.tanh()).abs() < 1e-12 && theta == same);
    // (1 − c B)(1 − B).
    assert_eq!(phi.len(), 2);
    assert!((phi[0] - 1.0 - root).abs() < 1e-12 && (phi[1] + root).abs() < 1e-12);
    assert_eq!(problem(&record, &[]).coefficients(&z, 1), (plain, same));
}

#[test]
fn pairs_are_laid_over_the_best_lower_optima_on_grids_that_grow_coarser() {
    let record = wave(400, 5);
    let whole = problem(&record, &[]);
    let lower = |count: usize, z: &[f64]| vec![Point::new(z.to_vec(), 0.0); count];
    let slow = starts::slow_bias(&record, 0.0).len();
    assert!(slow > 0);
    let grid = |per_decade: f64| starts::real_pairs(400, per_decade).len() + slow;
    let found = |lower: &[Point], order| {
        let mut candidates = Vec::new();
        real_starts(&whole, lower, order, &mut candidates);
        assert!(candidates.iter().all(|z| z.len() == order.0 + order.1));
        candidates.len()
    };
    assert_eq!(found(&[], (1, 1)), 0);
    assert_eq!(found(&lower(1, &[]), (1, 1)), grid(2.0));
    assert_eq!(found(&lower(1, &[0.3]), (2, 1)), grid(1.0));
    assert_eq!(found(&lower(1, &[0.3]), (1, 2)), grid(1.0));
    assert_eq!(
        found(&lower(3, &[0.3, 0.1]), (2, 2)),
        grid(1.0) + 2 * grid(0.7)
    );
    assert_eq!(
        found(&lower(9, &[0.3, 0.1]), (2, 2)),
        grid(1.0) + 3 * grid(0.7)
    );
}

#[test]
fn of_a_long_record_the_starts_best_on_its_first_part_are_kept() {
    let record = wave(50_001, 6);
    let candidates: Vec<Vec<f64>> = (-8..8).map(|k| vec![0.2 * f64::from(k), 0.309]).collect();
    let found = glance(&problem(&record, &[]), candidates.clone(), 1, 100.0);
    // A twentieth of the budget, best first: φ = 0.8 is 1.0986 in the search, of which 1.0 and 1.2 are nearest.
    assert_eq!(found.len(), 5);
    assert!(
        found[0][0] == 1.0 || (found[0][0] - 1.2).abs() < 1e-9,
        "{found:?}"
    );
    assert_eq!(
        glance(
            &problem(&record[..50_000], &[]),
            candidates.clone(),
            1,
            100.0
        ),
        candidates
    );
}

/// Two wells: a broad one at 0, and a deeper narrow one at (3, 3).
fn wells(points: &[Vec<f64>]) -> Vec<f64> {
    let one = |z: &Vec<f64>| {
        let from = |x: f64| (z[0] - x).powi(2) + (z[1] - x).powi(2);
        (0.1 * from(0.0)).min(50.0 * from(3.0) - 1.0)
    };
    points.iter().map(one).collect()
}

#[test]
fn a_privileged_start_is_searched_whatever_its_value() {
    // It is in the narrow well, but higher than all others.
    let mut starts = vec![vec![3.2, 3.2]];
    starts.extend((0..400).map(|k| vec![0.01 * f64::from(k % 20), 0.002 * f64::from(k)]));
    let run = |privileged| {
        let mut objective = Objective::new(&wells, SCALES);
        rounds(&mut objective, starts.clone(), privileged, 500.0, 2)
    };
    let best = &run(1)[0];
    assert!(
        (best.value + 1.0).abs() < 1e-4 && (best.z[0] - 3.0).abs() < 0.01,
        "{best:?}"
    );
    assert!(run(1).windows(2).all(|pair| pair[0].value <= pair[1].value));
}

#[test]
fn what_has_stuck_is_polished_and_what_has_converged_is_left() {
    let bowl = |points: &[Vec<f64>]| -> Vec<f64> {
        points
            .iter()
            .map(|z| z[0] * z[0] + 4.0 * z[1] * z[1])
            .collect()
    };
    let mut objective = Objective::new(&bowl, SCALES);
    let mut point = Point::new(vec![1.0, 1.0], 5.0);
    polish(&mut objective, &mut point, 2);
    assert!(point.converged && point.value < 1e-4, "{point:?}");
    let mut done = Point::new(vec![1.0, 1.0], 5.0);
    done.converged = true;
    let before = objective.evaluations;
    polish(&mut objective, &mut done, 2);
    assert_eq!((done.value, objective.evaluations), (5.0, before));
}

#[test]
fn a_polish_that_gains_nothing_is_the_last() {
    // A kink: the slope at the bottom is not zero, so that a search of slopes never believes to be done.
    let kink = |z: &[Vec<f64>]| z.iter().map(|z| (3.0 * z[0]).max(-z[0])).collect();
    let polished = |z: f64| {
        let mut objective = Objective::new(&kink, SCALES);
        let value = objective.at(&[z]);
        let mut best = Point::new(vec![z], value);
        assert!(!bfgs(&mut objective, &best, TOLERANCE, 100).converged);
        objective.evaluations = 0;
        polish(&mut objective, &mut best, 1);
        (best.value, best.converged, objective.evaluations)
    };
    let (value, converged, once) = polished(0.0);
    assert_eq!((value, converged), (0.0, true));
    // From elsewhere there is something to gain, and a further round that gains nothing.
    let (value, _, more) = polished(-1.0);
    assert!(value < 1e-3 && more > once, "{value} {more} {once}");
}
