//! Disturbances of known size, and noise without any.

use super::noise::{dot, normalised};
use super::search::Whitened;
use super::*;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::f64::consts::TAU;

struct Draw(Xoshiro256PlusPlus);

impl Draw {
    fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    /// A Gauss-Markov process of a standard deviation and a time in values; a walk of such steps where that is infinite.
    fn slow(&mut self, sigma: f64, tau: f64, count: usize) -> Vec<f64> {
        let left = (-1.0 / tau).exp();
        let (mut x, drive) = match left < 1.0 {
            true => (sigma * self.normal(), sigma * (1.0 - left * left).sqrt()),
            false => (0.0, sigma),
        };
        let mut next = || {
            x = left * x + drive * self.normal();
            x
        };
        (0..count).map(|_| next()).collect()
    }
}

/// White noise of standard deviation 1 with slow processes of these standard deviations and times, xoshiro256++ of a seed.
fn noise(processes: &[(f64, f64)], count: usize, seed: u64) -> Vec<f64> {
    let mut draw = Draw(Xoshiro256PlusPlus::seed_from_u64(seed));
    let mut sum: Vec<f64> = (0..count).map(|_| draw.normal()).collect();
    for (sigma, tau) in processes {
        let slow = draw.slow(*sigma, *tau, count);
        sum.iter_mut().zip(slow).for_each(|(sum, x)| *sum += x);
    }
    sum
}

const WALK: (f64, f64) = (0.02, f64::INFINITY);

fn found(add: impl Fn(f64) -> f64, count: usize) -> Vec<Disturbance> {
    let mut series = noise(&[WALK], count, 7);
    let times = (0..count).map(|k| k as f64);
    series.iter_mut().zip(times).for_each(|(x, t)| *x += add(t));
    disturbances(&series, &[])
}

#[test]
fn a_step_a_warm_up_and_a_cycle_are_found_beside_a_walk() {
    let near = |found: f64, truth: f64| (found / truth - 1.0).abs() < 0.25;
    let step = found(|t| if t < 810.0 { 0.0 } else { 5.0 }, 1800);
    let [one] = step[..] else { panic!("{step:?}") };
    let Shape::Step { from, to } = one.shape else {
        panic!("{one:?}")
    };
    assert!(from < 810 && 810 <= to && to - from == 10, "{one:?}");
    assert!(near(one.size(), 5.0), "{one:?}");
    assert_eq!(
        (one.value(to as f64), one.value(to as f64 + 0.5)),
        (0.0, one.size())
    );

    let warm = found(|t| 20.0 * (-t / 300.0).exp(), 1800);
    let [one] = warm[..] else { panic!("{warm:?}") };
    let Shape::WarmUp(tau) = one.shape else {
        panic!("{one:?}")
    };
    assert!(near(tau, 300.0) && near(one.size(), 20.0), "{one:?}");
    assert!((one.value(tau) / one.size() - (-1f64).exp()).abs() < 1e-12);

    let cycle = found(|t| 5.0 * (TAU * t / 620.0 + 1.0).sin(), 1800);
    let [one] = cycle[..] else {
        panic!("{cycle:?}")
    };
    let Shape::Cycle(period) = one.shape else {
        panic!("{one:?}")
    };
    assert!(
        (period / 620.0 - 1.0).abs() < 0.03 && near(one.size(), 5.0),
        "{one:?}"
    );
    assert!((one.value(0.0) - 5.0 * 1f64.sin()).abs() < 1.5, "{one:?}");
}

#[test]
fn five_steps_are_found_beside_each_other() {
    let heights = [0.0, 12.0, -5.0, 8.0, -9.0, 4.0];
    let mut steps = found(|t| heights[(t / 600.0) as usize], 3600);
    steps.sort_by(|a, b| format!("{:05?}", a.shape).cmp(&format!("{:05?}", b.shape)));
    let places = steps.iter().map(|one| match one.shape {
        Shape::Step { from, to } => (from + to) / 2,
        _ => 0,
    });
    let mut places: Vec<usize> = places.collect();
    places.sort_unstable();
    assert_eq!(places, [600, 1200, 1800, 2400, 3000]);
}

#[test]
fn what_a_known_series_explains_is_no_disturbance() {
    let count = 1200;
    let temperature: Vec<f64> = (0..count)
        .map(|k| 5.0 * (-f64::from(k) / 250.0).exp())
        .collect();
    let mut series = noise(&[WALK], count as usize, 3);
    series
        .iter_mut()
        .zip(&temperature)
        .for_each(|(x, t)| *x += 3.0 * t);
    assert!(matches!(
        disturbances(&series, &[])[0].shape,
        Shape::WarmUp(_)
    ));
    assert_eq!(disturbances(&series, &[temperature]), []);
}

#[test]
fn noise_has_no_disturbance_nor_has_what_is_too_short_or_constant() {
    // Seeds of their own; white, walks, Gauss-Markov.
    for (k, process) in [(0.0, 1.0), WALK, (0.3, f64::INFINITY), (1.0, 100.0)]
        .into_iter()
        .enumerate()
    {
        for seed in 0..4 {
            let series = noise(&[process], 900, 500 + 10 * k as u64 + seed);
            assert_eq!(disturbances(&series, &[]), [], "{process:?} {seed}");
        }
    }
    let step = |count: usize| {
        Vec::from_iter(
            (0..count)
                .map(|k| if 2 * k < count { 0.0 } else { 50.0 } + (k * 7919 % 101) as f64 / 50.0),
        )
    };
    assert_eq!(disturbances(&step(FEWEST - 1), &[]), []);
    assert_eq!(disturbances(&step(FEWEST), &[]).len(), 1);
    assert_eq!(disturbances(&[3.0; 500], &[]), []);
}

/// False alarms of honest noise: seeds 2000 … 2099 each, at most two in a hundred of any kind.
#[test]
#[ignore = "slow"]
fn false_alarms_are_at_most_two_in_a_hundred() {
    let flicker =
        |sigma: f64| Vec::from_iter((0..7).map(|k| (sigma, 10f64.powf(0.5 * f64::from(k)))));
    let kinds = [
        vec![],
        vec![(0.005, f64::INFINITY)],
        vec![WALK],
        vec![(0.1, f64::INFINITY)],
        vec![(0.5, f64::INFINITY)],
        vec![(0.7, 10.0)],
        vec![(0.4, 100.0)],
        vec![(2.0, 100.0)],
        vec![(0.5, 1000.0)],
        flicker(0.15),
        flicker(0.6),
    ];
    for count in [300, 1800, 3600] {
        for kind in &kinds {
            let alarm = |seed: &u64| !disturbances(&noise(kind, count, *seed), &[]).is_empty();
            let alarms = (2000..2100).filter(alarm).count();
            println!("{count} {kind:?}: {alarms}");
            assert!(alarms <= 2, "{count} {kind:?}: {alarms} of 100");
        }
    }
}

#[test]
fn steps_are_whitened_as_any_column() {
    let count = 30;
    let mut present = vec![true; count];
    present[11] = false;
    present[12] = false;
    for memory in [f64::INFINITY, 9.0] {
        let noise = Noise::new(0.4, memory, &present);
        let series: Vec<f64> = (0..count).map(|k| (k * 37 % 19) as f64 - 9.0).collect();
        let series = noise.whitened(&series);
        let (products, squares) = (noise.with_steps(&series), noise.squares_of_steps());
        for at in 0..count {
            let step = Shape::Step { from: at, to: at };
            let step = noise.whitened(&step.columns(count)[0]);
            assert!((products[at] - dot(&step, &series)).abs() < 1e-9, "{at}");
            assert!((squares[at] - dot(&step, &step)).abs() < 1e-9, "{at}");
        }
    }
}

#[test]
fn averages_of_a_walk_are_whitened() {
    // Their changes: variance 2q/3, covariance with the next q/6, so innovations of (3 + √3)/6·… q: F (1 + θ²) = 2/3, F θ = 1/6.
    let q: f64 = 1e9;
    let noise = Noise::new(q, f64::INFINITY, &[true; 200]);
    let theta = 2.0 - 3f64.sqrt();
    let innovation = noise.weights[199].0.powi(-2);
    assert!(
        (innovation / (q / (6.0 * theta)) - 1.0).abs() < 1e-6,
        "{}",
        innovation / q
    );
    // A Gauss-Markov process starts at its own variance, beside white noise of 1.
    let noise = Noise::new(0.1, 10.0, &[true; 3]);
    let variance = 0.1 / (1.0 - (-0.2f64).exp());
    assert!((noise.weights[0].0.powi(-2) - (variance + 1.0 - 0.1 / 6.0)).abs() < 1e-12);
}

#[test]
fn a_shape_of_averages_is_that_of_the_values() {
    // The level changes amid the values that the averages before and after the step hold.
    let step = Shape::Step { from: 7, to: 7 };
    assert_eq!(step.in_values(5), Shape::Step { from: 30, to: 40 });
    assert_eq!(Shape::WarmUp(3.0).in_values(5), Shape::WarmUp(15.0));
    assert_eq!(Shape::Cycle(8.0).in_values(5), Shape::Cycle(40.0));
    assert_eq!(step.enough(), 19.0);
    assert_eq!(Shape::WarmUp(3.0).enough(), 17.0);
    assert_eq!(Shape::Cycle(3.0).enough(), 21.0);
    assert_eq!(step.nearby(0.1), [step]);
    let near = |found: f64, exact: f64| assert!((found / exact - 1.0).abs() < 1e-12, "{found}");
    let (warm_ups, cycles) = (
        Shape::WarmUp(3.0).nearby(0.1),
        Shape::Cycle(3.0).nearby(0.1),
    );
    assert_eq!((warm_ups.len(), cycles.len()), (11, 11));
    for (k, pair) in (-5..=5).zip(warm_ups.into_iter().zip(cycles)) {
        let (Shape::WarmUp(tau), Shape::Cycle(period)) = pair else {
            panic!("{pair:?}")
        };
        near(tau, 3.0 * 2f64.powf(0.1 * f64::from(k)));
        near(period, 3.0 * 2f64.powf(0.025 * f64::from(k)));
    }
}

#[test]
fn a_disturbance_has_its_size_and_its_value_at_any_time() {
    let disturbance = |shape, coefficients| Disturbance {
        shape,
        coefficients,
        fall: 0.0,
    };
    let cycle = disturbance(Shape::Cycle(8.0), [3.0, -4.0]);
    assert_eq!(cycle.size(), 5.0);
    for (time, exact) in [(0.0, -4.0), (2.0, 3.0), (4.0, 4.0), (6.0, -3.0)] {
        assert!((cycle.value(time) - exact).abs() < 1e-12, "{time}");
    }
    let warm_up = disturbance(Shape::WarmUp(2.0), [-3.0, 0.0]);
    assert_eq!(warm_up.size(), -3.0);
    assert!((warm_up.value(2.0) + 3.0 * (-1f64).exp()).abs() < 1e-12);
    let columns = Shape::Cycle(8.0).columns(3);
    assert_eq!(columns.len(), 2);
    for (k, (sine, cosine)) in columns[0].iter().zip(&columns[1]).enumerate() {
        let turn = TAU * (k as f64 + 0.5) / 8.0;
        assert!((sine - turn.sin()).abs() < 1e-12 && (cosine - turn.cos()).abs() < 1e-12);
    }
}

#[test]
fn an_average_needs_more_than_half_of_its_values() {
    let nan = f64::NAN;
    let found = averages(&[1.0, 2.0, nan, 6.0, nan, nan, 5.0, 7.0, 4.0], 4);
    assert_eq!(found.len(), 2);
    assert!(found[0] == 3.0 && found[1].is_nan());
    let found = averages(&[nan, 2.0, 4.0, nan, nan, 9.0, 1.0], 3);
    assert!(found[0] == 3.0 && found[1].is_nan() && found.len() == 2);
}

/// White noise alone: the costs and coefficients are those of plain least squares.
#[test]
fn under_white_noise_a_shape_explains_what_least_squares_do() {
    let count = 80;
    let series: Vec<f64> = (0..count)
        .map(|k| (k * 37 % 19) as f64 + if k < 30 { 0.0 } else { 20.0 })
        .collect();
    let search = |known| Search {
        averages: &series,
        present: count as f64,
        known,
        noises: vec![Noise::new(0.0, f64::INFINITY, &vec![true; count])],
        tried: vec![Shape::WarmUp(9.0)],
    };
    let level = [vec![1.0; count]];
    let of = |from: usize, to: usize| {
        let part = &series[from..to];
        let mean = part.iter().sum::<f64>() / part.len() as f64;
        (mean, part.iter().map(|x| (x - mean).powi(2)).sum::<f64>())
    };
    let ((_, all), (before, a), (after, b)) = (of(0, count), of(0, 30), of(30, count));
    let beside_level = search(&level);
    let noise = &beside_level.noises[0];
    let whitened = Whitened::new(noise, &series, &level);
    assert!((whitened.squares / all - 1.0).abs() < 1e-12);
    let (at, explained) = whitened.likeliest_step(noise);
    assert_eq!(at, 30);
    assert!(
        (explained / (all - a - b) - 1.0).abs() < 1e-9,
        "{explained}"
    );
    let cost = beside_level.cost(noise, all - explained);
    assert!((cost - 80.0 * ((a + b) / 80.0).ln()).abs() < 1e-9);
    // The fall of −2 ln likelihood, and the height of the step beside the level.
    let [(shape, fall)] = beside_level.shapes()[..] else {
        panic!()
    };
    assert_eq!(shape, Shape::Step { from: 30, to: 30 });
    assert!((fall - 80.0 * (all / (a + b)).ln()).abs() < 1e-9, "{fall}");
    let found = beside_level.coefficients(&[shape]);
    assert!(found.len() == 1 && (found[0] - (after - before)).abs() < 1e-9);
    // What is known explains it all: no shape is enough.
    let columns = [level[0].clone(), shape.columns(count)[0].clone()];
    assert_eq!(search(&columns).shapes(), []);
    // A column of what is known already is no column.
    assert!(normalised(level[0].clone(), &[whitened.basis[0].clone()]).is_none());
    let free = normalised(columns[1].clone(), &whitened.basis).unwrap();
    assert!((dot(&free, &free) - 1.0).abs() < 1e-12 && dot(&free, &level[0]).abs() < 1e-9);
}

#[test]
fn a_step_is_not_looked_for_where_it_is_an_outlier() {
    let count = 80;
    let noise = Noise::new(0.0, f64::INFINITY, &vec![true; count]);
    let step_at = |place: usize| {
        let series: Vec<f64> = (0..count)
            .map(|k| (k * 37 % 19) as f64 + if k < place { 0.0 } else { 2000.0 })
            .collect();
        Whitened::new(&noise, &series, &[]).likeliest_step(&noise).0
    };
    assert_eq!((step_at(1), step_at(2), step_at(3)), (2, 2, 3));
    assert_eq!((step_at(78), step_at(79)), (78, 78));
}

/// A gyro that re-zeroes itself three times: beside one of the steps alone the others are a walk.
#[test]
fn steps_up_and_down_are_found_together() {
    let levels = [0.0, 1.5, -0.6, 0.75];
    let all_found = (700..720).filter(|seed| {
        let mut series = noise(&[], 1200, *seed);
        for (k, value) in series.iter_mut().enumerate() {
            *value += levels[k / 324];
        }
        let found = disturbances(&series, &[]);
        let steps = found.iter().filter_map(|one| match one.shape {
            Shape::Step { from, to } => Some((from + to) / 2),
            _ => None,
        });
        let mut places = Vec::from_iter(steps);
        places.sort_unstable();
        let near = |(place, exact): (&usize, usize)| place.abs_diff(exact) <= 40;
        places.len() == 3 && places.iter().zip([324, 648, 972]).all(near)
    });
    // 48 of 50 had all three with the thresholds as they are, 2 of 10 by one step at a time.
    assert!(all_found.count() >= 17);
}

#[test]
fn averages_of_long_records_have_their_steps_at_the_values() {
    // 720 values in pairs.
    let step = |k: usize| if k < 300 { 0.0 } else { 50.0 };
    let series: Vec<f64> = (0..720)
        .map(|k| step(k) + (k * 7919 % 101) as f64 / 50.0)
        .collect();
    let [one] = disturbances(&series, &[])[..] else {
        panic!()
    };
    assert_eq!(one.shape, Shape::Step { from: 298, to: 302 });
    assert!(
        (one.size() - 50.0).abs() < 0.5 && one.fall > 100.0,
        "{one:?}"
    );
}
