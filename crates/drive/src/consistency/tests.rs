use super::*;
use crate::estimator::Aiding;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use undrift_nav::{
    Quaternion,
    attitude::{from_rotation_vector, from_rpy, to_rpy},
    earth::Geodetic,
    filter::{FilterError, Gate, InitialStd},
    mechanisation::NavState,
    sample::Position,
    shaping::ShapingFilter,
};

fn normal(generator: &mut Xoshiro256PlusPlus) -> f64 {
    StandardNormal.sample(generator)
}

#[test]
fn bounds_are_the_quantiles_of_chi_squared() {
    // Two degrees of freedom: an exponential law, quantile −2 ln(1 − p).
    let (low, high) = average_bounds(2, 1);
    assert!((low + 2.0 * 0.975f64.ln()).abs() < 1e-9);
    assert!((high + 2.0 * 0.025f64.ln()).abs() < 1e-9);
    // Three hundred, from a table: 253.912 and 349.874.
    let (low, high) = average_bounds(3, 100);
    assert!((100.0 * low - 253.912).abs() < 5e-4 && (100.0 * high - 349.874).abs() < 5e-4);
    // Many: Wilson and Hilferty's cube, whose error is far below 1e-6 of the quantile here.
    let n = 3e6;
    for (bound, z) in [average_bounds(3, 1_000_000)]
        .iter()
        .flat_map(|b| [(b.0, -1.0), (b.1, 1.0)])
    {
        let spread = 2.0 / (9.0 * n);
        let cube = 1.0 - spread + z * 1.959_963_984_540_054 * f64::sqrt(spread);
        assert!((bound / 3.0 - cube.powi(3)).abs() < 1e-6, "{bound}");
    }
    assert!(average_bounds(3, 0).0.is_nan());
}

/// A covariance of components of very different size, correlated, and its root.
fn covariance(generator: &mut Xoshiro256PlusPlus) -> (Matrix, Matrix) {
    let scale = |i: usize| [1.0, 0.1, 1e-3, 1e-5, 1e-2][i / 3];
    let root = Matrix::from_fn(|i, j| {
        let mixed = if i == j { 2.0 } else { normal(generator) };
        if j <= i { scale(i) * mixed } else { 0.0 }
    });
    (root * root.transpose(), root)
}

#[test]
fn nees_of_right_errors_is_chi_squared() {
    let mut generator = Xoshiro256PlusPlus::seed_from_u64(1);
    let (p, root) = covariance(&mut generator);
    let n = 4000;
    let (mut right, mut wrong) = (Consistency::default(), Consistency::default());
    for _ in 0..n {
        let e = root * Vector::from_fn(|_, _| normal(&mut generator));
        right.add(&ErrorState::from_parts(e, p, [true; COMPONENTS]));
        // Standard deviations three times too small.
        wrong.add(&ErrorState::from_parts(e, p / 9.0, [true; COMPONENTS]));
    }
    for group in 0..GROUPS {
        let freedom = GROUP[group].2 as f64;
        // The mean of n values of variance 2·freedom; 4 of its standard deviations.
        let tolerance = 4.0 * (2.0 / freedom / f64::from(n)).sqrt();
        let mean = right.nees[group].per_freedom().unwrap();
        assert!((mean - 1.0).abs() < tolerance, "{group} {mean}");
        let mean = wrong.nees[group].per_freedom().unwrap();
        assert!((mean / 9.0 - 1.0).abs() < tolerance, "{group} {mean}");
    }
    for component in 0..COMPONENTS {
        let shares = right.coverage(component).unwrap();
        for (share, expected) in shares.iter().zip([0.6827f64, 0.9545, 0.9973]) {
            let std = (expected * (1.0 - expected) / f64::from(n)).sqrt();
            assert!((share - expected).abs() < 4.0 * std, "{component} {share}");
        }
    }
    let mut twice = right.clone();
    twice.merge(&right);
    assert_eq!(twice.coverage(3), right.coverage(3));
    assert_eq!(twice.nees[5].per_freedom(), right.nees[5].per_freedom());
}

#[test]
fn what_is_not_known_counts_nowhere() {
    let mut generator = Xoshiro256PlusPlus::seed_from_u64(2);
    let (p, root) = covariance(&mut generator);
    let e = root * Vector::repeat(1.0);
    let mut known = [true; COMPONENTS];
    known[9..12].fill(false);
    known[4] = false;
    let state = ErrorState::from_parts(e, p, known);
    assert_eq!(state.nees(1).unwrap().1, 2);
    assert_eq!(state.nees(3), None);
    assert_eq!(state.nees(5).unwrap().1, 11);
    assert_eq!(state.normalised(10), None);
    // The same group from what is left alone: components 3 and 5 by hand.
    let (a, b, c) = (p[(3, 3)], p[(3, 5)], p[(5, 5)]);
    let by_hand = (c * e[3] * e[3] - 2.0 * b * e[3] * e[5] + a * e[5] * e[5]) / (a * c - b * b);
    assert!((state.nees(1).unwrap().0 / by_hand - 1.0).abs() < 1e-9);
    // No covariance at all.
    let mut broken = p;
    broken[(0, 1)] = 1e6;
    broken[(1, 0)] = 1e6;
    let state = ErrorState::from_parts(e, broken, [true; COMPONENTS]);
    assert_eq!((state.nees(0), state.nees(5)), (None, None));
    assert!(state.nees(1).is_some());
}

/// A filter with two states in each gyro, one in each accelerometer but the last, which has none.
fn filter() -> Box<dyn Estimator> {
    let nav = NavState {
        time: 10.0,
        position: Geodetic::from_degrees(47.0, 8.0, 400.0),
        v_n: Vector3::new(3.0, -4.0, 0.5),
        q_nb: from_rpy(&Vector3::new(0.02, -0.03, 2.0)),
    };
    let std = InitialStd {
        position: Vector3::new(1.0, 2.0, 4.0),
        velocity: Vector3::new(0.1, 0.2, 0.4),
        attitude: Vector3::new(0.01, 0.02, 0.04),
    };
    let white = ShapingFilter::white(1e-4, 0.01).unwrap();
    let constant = ShapingFilter::constant(0.3, 0.01).unwrap();
    let gyro = ShapingFilter::gauss_markov(0.4, 100.0, 0.01)
        .and_then(|f| f.plus(&constant))
        .unwrap();
    let sensors = [gyro, gyro, gyro, constant, constant, white];
    let none = undrift_nav::parameters::Parameters::none();
    crate::estimator::build(nav, &std, &sensors, none).unwrap()
}

#[test]
fn errors_of_a_filter_have_the_signs_of_the_conventions() {
    let filter = filter();
    let nav = filter.nav();
    // The truth lies where the error, estimate less truth, says; turned by +ψ.
    let psi = Vector3::new(0.01, -0.04, 0.12);
    let truth = TruthSample {
        time: nav.time,
        position: nav.position.displaced(&Vector3::new(-2.0, -2.0, 4.0)),
        v_n: Some(nav.v_n - Vector3::new(0.1, -0.2, 0.8)),
        rpy: Some(to_rpy(&(from_rotation_vector(&psi) * nav.q_nb))),
    };
    let bias = [0.5, -0.5, 1.0, 0.3, -0.6, 7.0];
    let state = ErrorState::new(&*filter, &truth, Some(&bias));
    let expected = [
        2.0, 1.0, -1.0, 1.0, -1.0, 2.0, 1.0, -2.0, 3.0, 1.0, -1.0, 2.0, 1.0, -2.0,
    ];
    for (component, expected) in expected.into_iter().enumerate() {
        let z = state.normalised(component).unwrap();
        // Radii of curvature over metres: 1e-6.
        assert!((z - expected).abs() < 1e-5, "{component} {z}");
    }
    assert_eq!(state.normalised(14), None, "no state in that axis");
    for (group, (expected, freedom)) in [
        (6.0, 3),
        (6.0, 3),
        (14.0, 3),
        (6.0, 3),
        (5.0, 2),
        (37.0, 14),
    ]
    .into_iter()
    .enumerate()
    {
        let (value, counted) = state.nees(group).unwrap();
        assert!((value - expected).abs() < 1e-4, "{group} {value}");
        assert_eq!(counted, freedom);
    }
    // A log's truth: no biases, maybe no attitude.
    let poorer = TruthSample { rpy: None, ..truth };
    let state = ErrorState::new(&*filter, &poorer, None);
    assert_eq!(state.nees(2), None);
    assert_eq!(state.nees(5).unwrap().1, 6);
}

#[test]
fn normalised_innovation_squared_is_the_nis() {
    let mut filter = filter();
    let lever = Vector3::new(0.3, 0.1, -1.2);
    let measured = filter
        .nav()
        .position
        .displaced(&Vector3::new(1.0, -3.0, 5.0));
    let aiding = Aiding::Position {
        position: Position::Geodetic(measured),
        lever_arm: lever,
        correlated: Vector3::zeros(),
        due: filter.nav().time,
    };
    let impossible = undrift_nav::Matrix3::from_diagonal_element(-1e9);
    let refused = filter.update(&aiding, &impossible, &Gate::OPEN);
    assert_eq!(refused, Err(FilterError::BadMeasurement));
    let r = undrift_nav::Matrix3::from_diagonal(&Vector3::new(1.0, 4.0, 9.0));
    let update = filter.update(&aiding, &r, &Gate::OPEN).unwrap().unwrap();
    let normalised = Vector3::from(update.whitened);
    assert!((normalised.norm_squared() / update.nis - 1.0).abs() < 1e-12);
    assert_eq!(
        filter.nav().q_nb.inverse() * filter.nav().q_nb,
        Quaternion::identity()
    );
}

#[test]
fn white_innovations_pass_and_coloured_ones_do_not() {
    let mut generator = Xoshiro256PlusPlus::seed_from_u64(3);
    let n = 20_000;
    let (mut white, mut coloured) = (InnovationStatistics::new(), InnovationStatistics::new());
    let mut last = [0.0; 3];
    for k in 0..n {
        let w: [f64; 3] = std::array::from_fn(|_| normal(&mut generator));
        white.add(k as f64, &w);
        // AR(1) of variance one.
        last = std::array::from_fn(|i| 0.6 * last[i] + 0.8 * w[i]);
        coloured.add(k as f64, &last);
    }
    assert_eq!((white.updates(), white.freedom()), (n, 3 * n));
    assert_eq!(white.span(), Some((0.0, (n - 1) as f64)));
    let (low, high) = white.bounds();
    let nis = white.per_freedom().unwrap();
    assert!((low..high).contains(&nis), "{low} {nis} {high}");
    // 0.05 of n, binomial: 4 standard deviations.
    let above = white.share_above_95().unwrap();
    assert!(
        (above - 0.05).abs() < 4.0 * (0.05 * 0.95 / n as f64).sqrt(),
        "{above}"
    );
    let bound = white.white_bound(0).unwrap();
    assert!((bound - 1.959_964 / (n as f64).sqrt()).abs() < 1e-8);
    let outside = (0..3)
        .flat_map(|c| (1..=LAGS).map(move |lag| (c, lag)))
        .filter(|(c, lag)| white.autocorrelation(*c, *lag).unwrap().abs() > bound)
        .count();
    // Of thirty, one and a half on average; more than six has a probability of 0.1 %.
    assert!(outside <= 6, "{outside}");
    for lag in 1..=LAGS {
        let expected = 0.6f64.powi(lag as i32);
        let rho = coloured.autocorrelation(1, lag).unwrap();
        // Bartlett: standard deviation below √((1+φ²)/(1−φ²)/n) = 0.01.
        assert!((rho - expected).abs() < 0.04, "{lag} {rho}");
    }
    assert_eq!(white.autocorrelation(3, 1), None);
    assert_eq!(white.autocorrelation(0, LAGS + 1), None);

    // Two runs are no continuation of each other.
    let mut merged = white.clone();
    merged.merge(&white);
    assert_eq!(merged.updates(), 2 * n);
    assert_eq!(merged.autocorrelation(2, 5), white.autocorrelation(2, 5));
    let mut from_nothing = InnovationStatistics::new();
    from_nothing.merge(&white);
    assert_eq!(from_nothing.nis(), white.nis());
    assert_eq!(InnovationStatistics::new().per_freedom(), None);
}
