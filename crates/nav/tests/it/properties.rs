//! What must hold for any numbers: shaping filters of every order, places, attitudes, units.

use core::f64::consts::PI;

use nalgebra::{SMatrix, SVector, Vector3};
use proptest::prelude::*;
use undrift_nav::{
    Quaternion,
    attitude::{from_rotation_vector, from_rpy, skew, to_rpy},
    covariance::{AXES, NAV},
    earth::{Geodetic, wrap_pi},
    filter::{Filter, InitialStd},
    mechanisation::NavState,
    parameters::Parameters,
    sample::Position,
    shaping::{AxisMatrix, MAX_ORDER, ShapingFilter},
    units::{self, Quantity},
};

const T: f64 = 0.01;

/// The same cases at every run; PROPTEST_CASES asks for more of them.
fn seeded() -> ProptestConfig {
    ProptestConfig {
        rng_seed: prop::test_runner::RngSeed::Fixed(1),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

const LAGS: usize = 25;

/// Coefficients `1 − c1 B − …` with all roots outside the unit circle, of order 0 … `orders`: any set of
/// partial autocorrelations within (−1, 1) makes one (Durbin's recursion).
fn stable(orders: usize) -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(-0.95..0.95f64, 0..=orders).prop_map(|partials| {
        let mut c: Vec<f64> = Vec::new();
        for kappa in partials {
            let turned: Vec<f64> = c.iter().rev().copied().collect();
            c.iter_mut().zip(turned).for_each(|(c, t)| *c -= kappa * t);
            c.push(kappa);
        }
        c
    })
}

prop_compose! {
    /// White noise and up to three Gauss-Markov processes, as (σ, τ) with τ by its logarithm.
    fn processes()(
        white in 0.0..0.1f64,
        parts in prop::collection::vec((0.01..1.0f64, -2.0..4.0f64), 0..=3),
    ) -> (f64, Vec<(f64, f64)>) {
        (white, parts.into_iter().map(|(sigma, tau)| (sigma, 10f64.powf(tau))).collect())
    }
}

fn composed((white, parts): &(f64, Vec<(f64, f64)>), interval: f64) -> ShapingFilter {
    let mut sum = ShapingFilter::white(*white, interval).unwrap();
    for (sigma, tau) in parts {
        let part = ShapingFilter::gauss_markov(*sigma, *tau, interval).unwrap();
        sum = sum.plus(&part).unwrap();
    }
    sum
}

fn lags(filter: &ShapingFilter) -> [f64; LAGS] {
    let mut out = [0.0; LAGS];
    filter.autocovariance(&mut out);
    out
}

/// Autocovariances of an ARMA from its difference equation alone: Brockwell & Davis 1991, equations
/// 3.3.8 and 3.3.9.
fn by_difference_equation(phi: &[f64], theta: &[f64], sigma: f64) -> [f64; LAGS] {
    const M: usize = MAX_ORDER + 1;
    let at = |c: &[f64], k: usize| {
        if k == 0 {
            1.0
        } else {
            -c.get(k - 1).copied().unwrap_or(0.0)
        }
    };
    let mut psi = [0.0; M];
    for j in 0..M {
        psi[j] = at(theta, j) - (1..=j).map(|i| at(phi, i) * psi[j - i]).sum::<f64>();
    }
    let mut system = SMatrix::<f64, M, M>::zeros();
    let mut right = SVector::<f64, M>::zeros();
    for k in 0..M {
        for i in 0..M {
            system[(k, k.abs_diff(i))] += at(phi, i);
        }
        right[k] = (k..M).map(|j| at(theta, j) * psi[j - k]).sum::<f64>() * sigma * sigma;
    }
    let first = system.lu().solve(&right).unwrap();
    let mut out = [0.0; LAGS];
    for k in 0..LAGS {
        out[k] = match first.get(k) {
            Some(value) => *value,
            None => -(1..M).map(|i| at(phi, i) * out[k - i]).sum::<f64>(),
        };
    }
    out
}

/// Largest miss of `P = F P Fᵀ + q`, relative to the variances.
fn equation_miss(filter: &ShapingFilter) -> f64 {
    type Square = SMatrix<f64, MAX_ORDER, MAX_ORDER>;
    let dense = |m: &AxisMatrix| Square::from_fn(|i, j| m[i][j]);
    let (p, f, q) = (dense(&filter.p0), dense(&filter.f), dense(&filter.q));
    let miss = p - f * p * f.transpose() - q;
    let size = p.diagonal().max().max(f64::MIN_POSITIVE);
    miss.amax() / size
}

proptest! {
    #![proptest_config(seeded())]

    #[test]
    fn an_arma_of_any_order_has_the_autocovariance_of_its_difference_equation(
        phi in stable(MAX_ORDER), theta in stable(MAX_ORDER), sigma in 0.01..10.0f64,
    ) {
        let filter = ShapingFilter::arma(&phi, &theta, sigma, T).unwrap();
        prop_assert_eq!(filter.order, phi.len().max(theta.len()));
        let (ours, exact) = (lags(&filter), by_difference_equation(&phi, &theta, sigma));
        for (k, (a, b)) in ours.iter().zip(exact).enumerate() {
            // The condition of the system: (1 − 0.95²)⁻¹ for each of six poles at the worst, met by few.
            prop_assert!((a - b).abs() < 1e-9 * exact[0], "lag {k}: {a} {b}");
        }
        // The products' own rounding, by the squared size of F: up to some tens.
        prop_assert!(equation_miss(&filter) < 1e-11, "{}", equation_miss(&filter));
    }

    #[test]
    fn a_sum_has_the_sum_of_the_autocovariances(
        phi in stable(2), theta in stable(2), parts in processes(),
    ) {
        let arma = ShapingFilter::arma(&phi, &theta, 0.3, T).unwrap();
        let other = composed(&parts, T);
        let sum = arma.plus(&other).unwrap();
        let (a, b, both) = (lags(&arma), lags(&other), lags(&sum));
        for k in 0..LAGS {
            prop_assert!((a[k] + b[k] - both[k]).abs() <= 1e-14 * both[0], "lag {k}");
        }
        prop_assert!(equation_miss(&sum) < 1e-12);
    }

    #[test]
    fn composed_processes_are_the_same_at_any_interval(parts in processes(), ratio in -1.0..1.0f64) {
        let other = T * 10f64.powf(ratio);
        let (here, there) = (composed(&parts, T), composed(&parts, other));
        // Two processes of nearly one pole are fine too: their modes stay apart. One that is gone
        // within an interval has no digits of its logarithm left.
        prop_assume!(parts.1.iter().all(|(_, tau)| *tau > T / 2.0));
        let carried = here.at_interval(other).unwrap();
        let (exact, found) = (lags(&there), lags(&carried));
        for k in 0..LAGS {
            // 1 − φ = T/τ keeps 1e-16 τ/T: 1e-10 of a process of 10⁴ s.
            prop_assert!((exact[k] - found[k]).abs() < 1e-9 * exact[0], "lag {k}: {} {}", exact[k], found[k]);
        }
        prop_assert!(equation_miss(&carried) < 1e-12, "{}", equation_miss(&carried));
        let back = lags(&carried.at_interval(T).unwrap());
        for (a, b) in lags(&here).iter().zip(back) {
            prop_assert!((a - b).abs() < 1e-9 * lags(&here)[0], "{a} {b}");
        }
    }

    #[test]
    fn the_innovations_form_and_its_coefficients_keep_the_autocovariance(
        parts in processes(), phi in stable(2), theta in stable(2),
    ) {
        let arma = ShapingFilter::arma(&phi, &theta, 0.3, T).unwrap();
        let sum = composed(&parts, T).plus(&arma).unwrap();
        let form = sum.innovations_form().unwrap();
        let (before, after) = (lags(&sum), lags(&form));
        for k in 0..LAGS {
            // The recursion's zeros are found to the root of rounding where two of them meet.
            prop_assert!((before[k] - after[k]).abs() < 1e-8 * before[0], "lag {k}: {} {}", before[k], after[k]);
        }
        let n = sum.order;
        let found = sum.arma_coefficients().unwrap();
        prop_assert!(found.order <= n);
        // One noise only: the joint covariance has rank one.
        for i in 0..n {
            for j in 0..n {
                let rank_one = form.s[i] * form.s[j] / form.r;
                let size = (form.q[i][i] * form.q[j][j]).sqrt();
                prop_assert!((form.q[i][j] - rank_one).abs() <= 1e-12 * size);
            }
        }
    }

    #[test]
    fn the_noise_factor_squares_to_the_covariance(phi in stable(MAX_ORDER), theta in stable(MAX_ORDER)) {
        let filter = ShapingFilter::arma(&phi, &theta, 0.7, T).unwrap();
        let (noise, initial) = (filter.noise_factor(), filter.initial_factor());
        for i in 0..filter.order {
            for j in 0..filter.order {
                let made: f64 = (0..=filter.order).map(|k| noise[i + 1][k] * noise[j + 1][k]).sum();
                let size = (filter.q[i][i] * filter.q[j][j]).sqrt();
                prop_assert!((made - filter.q[i][j]).abs() <= 1e-12 * size, "q {i} {j}");
                let made: f64 = (0..filter.order).map(|k| initial[i][k] * initial[j][k]).sum();
                let size = (filter.p0[i][i] * filter.p0[j][j]).sqrt();
                // Directions of the state below rounding are left out of a semi-definite factor.
                prop_assert!((made - filter.p0[i][j]).abs() <= 1e-9 * size, "p0 {i} {j}");
            }
        }
    }

    #[test]
    fn a_place_survives_earth_centred_coordinates(
        lat in -90.0..90.0f64, lon in -180.0..180.0f64, height in -10_000.0..100_000.0f64,
    ) {
        let there = Geodetic::from_degrees(lat, lon, height);
        let back = Geodetic::from_ecef(&there.to_ecef());
        // A few roundings of 6.5e6 m, 9e-10 m each; a longitude is worth less towards the poles.
        prop_assert!((back.lat - there.lat).abs() * 6.4e6 < 8e-9);
        prop_assert!(wrap_pi(back.lon - there.lon).abs() * there.lat.cos() * 6.4e6 < 8e-9);
        prop_assert!((back.height - height).abs() < 8e-9);
        let turn = there.ned_from_ecef();
        prop_assert!((turn * turn.transpose() - nalgebra::Matrix3::identity()).amax() < 1e-15);
    }

    #[test]
    fn a_small_offset_is_what_displaces(
        lat in -85.0..85.0f64, lon in -180.0..180.0f64, height in -400.0..20_000.0f64,
        ned in prop::array::uniform3(-100.0..100.0f64),
    ) {
        let (here, ned) = (Geodetic::from_degrees(lat, lon, height), Vector3::from(ned));
        let there = here.displaced(&ned);
        // Rounding of a longitude of up to π.
        prop_assert!((here.offset_to(&there) - ned).norm() < 8e-9);
        // The exact vector differs by the curvature: d²/2R, times the tangent of the latitude (11.4).
        let exact = here.ned_to(&there);
        prop_assert!((exact - ned).norm() < 12.5 * ned.norm_squared() / 6.3e6 + 1e-8, "{exact} {ned}");
    }

    #[test]
    fn angles_wrap_to_one_turn(angle in -1e6..1e6f64) {
        let wrapped = wrap_pi(angle);
        prop_assert!(wrapped > -PI && wrapped <= PI);
        // Rounding of the angle itself.
        prop_assert!((wrapped.sin() - angle.sin()).abs() < 1e-9 && (wrapped.cos() - angle.cos()).abs() < 1e-9);
        prop_assert_eq!(wrap_pi(wrapped), wrapped);
    }

    #[test]
    fn euler_angles_survive_the_quaternion(
        roll in -PI..PI, pitch in -1.5..1.5f64, yaw in -PI..PI,
    ) {
        let rpy = Vector3::new(roll, pitch, yaw);
        // The arcsine at 1.5 rad loses 1/cos.
        prop_assert!((to_rpy(&from_rpy(&rpy)) - rpy).norm() < 1e-13);
        let q = from_rpy(&rpy);
        let minus = Quaternion::new_unchecked(-q.into_inner());
        prop_assert_eq!(to_rpy(&minus), to_rpy(&q));
    }

    #[test]
    fn attitudes_compose_as_matrices_and_rotation_vectors_invert(
        a in prop::array::uniform3(-4.0..4.0f64), b in prop::array::uniform3(-4.0..4.0f64),
        v in prop::array::uniform3(-10.0..10.0f64), small in -12.0..-3.0f64,
    ) {
        let (a, b, v) = (Vector3::from(a), Vector3::from(b), Vector3::from(v));
        let (qa, qb) = (from_rotation_vector(&a), from_rotation_vector(&b));
        let matrix = |q: &Quaternion| q.to_rotation_matrix().into_inner();
        prop_assert!((matrix(&(qa * qb)) - matrix(&qa) * matrix(&qb)).amax() < 1e-14);
        prop_assert!((qa * (qb * v) - (qa * qb) * v).norm() < 1e-13);
        prop_assert!(((qa * qb).norm() - 1.0).abs() < 1e-15);
        prop_assert!((qa * from_rotation_vector(&-a)).angle() < 1e-7);
        // The matrix exponential of a small turn, to its second order.
        let turn = a.normalize() * 10f64.powf(small);
        let series = nalgebra::Matrix3::identity() + skew(&turn) + skew(&turn) * skew(&turn) / 2.0;
        prop_assert!((matrix(&from_rotation_vector(&turn)) - series).amax() < turn.norm().powi(3) / 5.0 + 1e-15);
    }
}

proptest! {
    #![proptest_config(seeded())]

    #[test]
    fn a_lever_arm_turns_with_the_body(
        lat in -80.0..80.0f64, lon in -180.0..180.0f64, height in -100.0..10_000.0f64,
        turn in prop::array::uniform3(-3.0..3.0f64), lever in prop::array::uniform3(-30.0..30.0f64),
    ) {
        let lever = Vector3::from(lever);
        let nav = NavState {
            time: 0.0,
            position: Geodetic::from_degrees(lat, lon, height),
            v_n: Vector3::zeros(),
            q_nb: from_rotation_vector(&Vector3::from(turn)),
        };
        let std = InitialStd {
            position: Vector3::repeat(1.0),
            velocity: Vector3::repeat(1.0),
            attitude: Vector3::repeat(0.1),
        };
        let white = ShapingFilter::white(1e-3, T).unwrap();
        let filter = Filter::<NAV>::new(nav, &std, [white; AXES], Parameters::none()).unwrap();
        let antenna = filter.antenna_position(&lever);
        // Rounding of a longitude of up to π, 3e-9 m.
        let offset = nav.position.offset_to(&antenna);
        prop_assert!((offset - nav.q_nb * lever).norm() < 8e-9, "{offset} {lever}");
        let fix = Position::Geodetic(antenna);
        let innovation = filter.observe_position(&fix, &lever).innovation;
        prop_assert!(innovation.norm() < 8e-9, "{innovation}");
        // The same fix without the lever arm is off by all of it.
        let innovation = filter.observe_position(&fix, &Vector3::zeros()).innovation;
        prop_assert!((innovation.norm() / lever.norm() - 1.0).abs() < 1e-3);
    }
}

/// Every quantity with units of it, and their factor to SI.
const UNITS: [(Quantity, &[(&str, f64)]); 8] = {
    const DEG: f64 = PI / 180.0;
    const G: f64 = 9.80665;
    [
        (
            Quantity::AngularRate,
            &[
                ("deg/s", DEG),
                ("mdps", 1e-3 * DEG),
                ("rad/h", 1.0 / 3600.0),
            ],
        ),
        (
            Quantity::Acceleration,
            &[("m/s^2", 1.0), ("mg", 1e-3 * G), ("cm/s²", 1e-2)],
        ),
        (
            Quantity::Angle,
            &[("deg", DEG), ("arcsec", DEG / 3600.0), ("rad", 1.0)],
        ),
        (
            Quantity::Length,
            &[("m", 1.0), ("mm", 1e-3), ("ft", 0.3048)],
        ),
        (Quantity::Time, &[("s", 1.0), ("h", 3600.0), ("us", 1e-6)]),
        (
            Quantity::AngleRandomWalk,
            &[
                ("deg/sqrt(h)", DEG / 60.0),
                ("mdps/√Hz", 1e-3 * DEG),
                ("rad/s^(1/2)", 1.0),
            ],
        ),
        (
            Quantity::VelocityRandomWalk,
            &[("m/s/sqrt(h)", 1.0 / 60.0), ("ug/sqrt(Hz)", 1e-6 * G)],
        ),
        (
            Quantity::AccelerationRandomWalk,
            &[("mg/sqrt(h)", 1e-3 * G / 60.0), ("m/s^2/sqrt(s)", 1.0)],
        ),
    ]
};

proptest! {
    #![proptest_config(seeded())]

    #[test]
    fn a_value_with_a_unit_is_value_times_factor_and_any_other_quantity_an_error(
        row in 0..UNITS.len(), other in 0..UNITS.len(), pick in any::<prop::sample::Index>(),
        value in -1e9..1e9f64, exponent in any::<bool>(), space in any::<bool>(),
    ) {
        let (quantity, spellings) = UNITS[row];
        let (unit, factor) = spellings[pick.index(spellings.len())];
        let gap = if space { " " } else { "" };
        let text = if exponent { format!("{value:e}{gap}{unit}") } else { format!("{value}{gap}{unit}") };
        let parsed = units::parse(&text, quantity).unwrap();
        // A factor is a product of at most four roundings.
        prop_assert!((parsed - value * factor).abs() <= 1e-15 * (value * factor).abs(), "{text}: {parsed:e}");
        prop_assert_eq!(parsed, value * units::unit_factor(unit, quantity).unwrap());
        if other != row {
            prop_assert!(units::parse(&text, UNITS[other].0).is_err());
        }
        prop_assert!(units::parse(&text, Quantity::Dimensionless).is_err());
        prop_assert!(units::parse(&format!("{value}"), quantity).is_err(), "a number without its unit");
    }
}
