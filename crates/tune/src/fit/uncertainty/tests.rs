use super::*;

/// Half of a quadratic form about a place, two parameters of which depend on each other.
fn quadratic(about: f64, off: f64) -> (DMatrix<f64>, impl Fn(&Vector) -> (f64, DVector<f64>)) {
    let mut a = DMatrix::from_diagonal_element(COUNT, COUNT, 4.0);
    (a[(1, 2)], a[(2, 1)]) = (off, off);
    let form = a.clone();
    let cost = move |z: &Vector| {
        let from = DVector::from_fn(COUNT, |k, _| z[k] - about);
        let slope = &form * &from;
        (7.0 + 0.5 * from.dot(&slope), slope)
    };
    (a, cost)
}

/// σ of the diagonal of the inverse, whether the others have to move or not, times the square root of the worth; no further than asked for.
#[test]
fn the_ends_of_what_is_quadratic_are_those_of_its_curvature() {
    let (a, cost) = quadratic(-3.0, 3.0);
    let inverse = a.try_inverse().unwrap();
    let profile = Profile {
        cost: &cost,
        z: &[-3.0; COUNT],
        inverse: &inverse,
    };
    for (i, variance) in [(0, 0.25), (1, 4.0 / 7.0), (2, 4.0 / 7.0)] {
        for (side, worth) in [(-1.0, 1.0), (1.0, 1.0), (1.0, 3.0)] {
            let step = side * INTERVAL * f64::sqrt(variance * worth);
            // Begun there, and too near and too far away: then within the tolerance, of which half is that of the distance.
            for (share, error) in [(1.0, 1e-9), (0.4, 0.06), (2.5, 0.06)] {
                let end = profile.end(i, share * step, 10.0, worth) + 3.0;
                assert!((end / step - 1.0).abs() < error, "{i} {share} {end} {step}");
            }
            let end = profile.end(i, 0.2 * side, 0.3, worth) + 3.0;
            assert!((end - 0.3 * side).abs() < 1e-9, "{end}");
        }
    }
}

/// Two noises of which the sum of the squares alone is seen, by 30 numbers: the larger may be much smaller, as the other
/// may be what is seen, but little larger. Its least cost for each value is found on a grid.
#[test]
fn ends_are_where_the_least_cost_has_risen_though_it_is_not_quadratic() {
    let cost = |z: &Vector| {
        let sum = (2.0 * z[0]).exp() + (2.0 * z[1]).exp();
        let by_sum = 15.0 * (1.0 / sum - 1.25 / (sum * sum));
        // The second is known to a third; the others do nothing.
        let off = 3.0 * (z[1] - 0.5f64.ln());
        let others = z[2..].iter().map(|z| 0.5 * z * z).sum::<f64>();
        let slope = DVector::from_fn(COUNT, |k, _| match k {
            0 => 2.0 * by_sum * (2.0 * z[0]).exp(),
            1 => 2.0 * by_sum * (2.0 * z[1]).exp() + 3.0 * off,
            k => z[k],
        });
        (
            15.0 * (sum.ln() + 1.25 / sum) + 0.5 * off * off + others,
            slope,
        )
    };
    let mut z = [0.0; COUNT];
    z[1] = 0.5f64.ln();
    let a = DMatrix::from_fn(COUNT, COUNT, |i, j| {
        let mut moved = z;
        moved[j] += 1e-5;
        (cost(&moved).1[i] - cost(&z).1[i]) / 1e-5
    });
    let inverse = a.try_inverse().unwrap();
    let profile = Profile {
        cost: &cost,
        z: &z,
        inverse: &inverse,
    };
    let std = inverse[(0, 0)].sqrt();
    let least_at = |x: f64| {
        let at = |k: i32| {
            cost(&std::array::from_fn(|i| {
                [x, f64::from(k) * 1e-3].get(i).copied().unwrap_or(0.0)
            }))
            .0
        };
        (-3000..1000).map(at).fold(f64::INFINITY, f64::min)
    };
    let (least, rise) = (cost(&z).0, 0.5 * INTERVAL * INTERVAL);
    let ends = [-1.0, 1.0].map(|side| profile.end(0, side * INTERVAL * std, 5.0, 1.0));
    for end in ends {
        let risen = least_at(end) - least;
        assert!((risen / rise - 1.0).abs() < 1.5 * NEAR, "{end} {risen}");
    }
    assert!(-ends[0] > 1.3 * ends[1], "{ends:?}");
}

/// Σ off offᵀ, and of neighbours both ways.
#[test]
fn the_scatter_of_parts_has_the_products_of_neighbours() {
    let part = |x: f64, y: f64| {
        let mut part = [0.0; COUNT];
        (part[0], part[3]) = (x, y);
        part
    };
    let parts = [part(3.0, 1.0), part(1.0, -1.0), part(5.0, 3.0)];
    let mut mean = DVector::zeros(COUNT);
    (mean[0], mean[3]) = (9.0, 3.0);
    // Off by (0, 0), (−2, −2), (2, 2).
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
    let alone = scatter(&parts, &mean, 0.0);
    near(alone[(0, 0)], 8.0);
    near(alone[(0, 3)], 8.0);
    let both = scatter(&parts, &mean, 0.5);
    near(both[(0, 0)], 8.0 - 4.0);
    near(both[(3, 0)], 8.0 - 4.0);
    near(both[(1, 1)], 0.0);
}
