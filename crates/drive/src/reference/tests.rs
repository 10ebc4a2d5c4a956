use super::*;
use undrift_nav::sample::FixQuality;

fn sample(time: f64, north: f64, v: f64, yaw_deg: f64) -> TruthSample {
    TruthSample {
        time,
        position: Geodetic::from_degrees(45.0, 7.0, 0.0).displaced(&Vector3::new(north, 0.0, 0.0)),
        v_n: Some(Vector3::new(v, 0.0, 0.0)),
        rpy: Some(Vector3::new(0.0, 0.0, f64::to_radians(yaw_deg))),
    }
}

#[test]
fn truth_is_interpolated_through_acceleration_and_north() {
    // 2 m/s²: north = t², v = 2 t. The cubic is exact for it.
    let truth = [
        sample(0.0, 0.0, 0.0, 350.0),
        sample(1.0, 1.0, 2.0, 10.0),
        sample(2.0, 4.0, 4.0, 30.0),
    ];
    let mut cursor = TruthCursor::new(truth.iter().copied());
    assert!(cursor.at(-0.1).is_none());
    let back = cursor.at(0.5).unwrap();
    assert!(
        back.rpy.unwrap().z.abs() < 1e-12,
        "through north, not round by south"
    );
    let at = cursor.at(1.5).unwrap();
    let origin = Geodetic::from_degrees(45.0, 7.0, 0.0);
    // Curvature over metres and rounding of a latitude, 1.5e-9 m.
    assert!((origin.offset_to(&at.position).x - 2.25).abs() < 1e-6);
    assert!((at.v_n.unwrap().x - 3.0).abs() < 1e-12);
    assert!(cursor.at(2.1).is_none());
}

#[test]
fn coverage_counts_errors_up_to_one_two_and_three_sigma() {
    let std = Errors(std::array::from_fn(|i| 0.5 * (1.0 + i as f64)));
    // Ten errors on either side of each bound, in every component.
    let mut coverage = Coverage::default();
    let sigmas = [0.2, 0.99, -1.01, 1.14, -1.99, 2.01, 2.2, 2.99, 3.01, -3.4];
    for sigmas in sigmas {
        coverage.add(&Errors(std.0.map(|std| sigmas * std)), &std);
    }
    coverage.add(&Errors::UNKNOWN, &std);
    for group in 0..GROUPS.len() {
        assert_eq!(coverage.shares(group), Some([0.2, 0.5, 0.8]));
    }
    assert_eq!(Coverage::default().shares(0), None);
}

#[test]
fn predicted_standard_deviations_are_the_roots_of_the_covariance() {
    let variances = [[4.0, 9.0, 16.0], [0.25, 0.36, 0.49], [1e-4, 4e-4, 9e-4]];
    let diagonal = |v: [f64; 3]| Matrix3::from_diagonal(&Vector3::from(v));
    let predicted = Predicted(variances.map(diagonal));
    // Level and facing north the angles are those about north, east and down.
    let std = predicted.std(&Quaternion::identity());
    let degrees = |rad: f64| rad.to_degrees();
    let expected = [
        2.0,
        3.0,
        4.0,
        13f64.sqrt(),
        0.5,
        0.6,
        0.7,
        degrees(0.01),
        degrees(0.02),
        degrees(0.03),
    ];
    for (i, (found, expected)) in std.0.into_iter().zip(expected).enumerate() {
        assert!((found / expected - 1.0).abs() < 1e-12, "{i}: {found}");
    }
    // Facing east, roll is about east and pitch about south.
    let east = from_rpy(&Vector3::new(0.0, 0.0, std::f64::consts::FRAC_PI_2));
    let turned = predicted.std(&east);
    assert!(
        (turned.0[7] - degrees(0.02)).abs() < 1e-9 && (turned.0[8] - degrees(0.01)).abs() < 1e-9
    );
    // Errors of one, two and three standard deviations: (1 + 4 + 9)/3.
    let errors = Errors(std::array::from_fn(|i| {
        let place = GROUPS
            .iter()
            .rev()
            .find(|(_, at)| i >= *at)
            .map_or(0, |(_, at)| i - at);
        (1.0 + place as f64) * std.0[i]
    }));
    for nees in predicted.nees(&Quaternion::identity(), &errors) {
        assert!((nees - 14.0 / 3.0).abs() < 1e-9, "{nees}");
    }
    // A fix adds its own covariance to position and velocity, not to the attitude.
    let place = Position::Geodetic(Geodetic::from_degrees(45.0, 7.0, 0.0));
    let fix = GnssFix {
        attitude: None,
        mean_velocity: None,
        time: 0.0,
        position: Some((place, diagonal([12.0, 16.0, 9.0]))),
        velocity: Some((Vector3::zeros(), diagonal([0.75, 0.64, 0.51]))),
        quality: FixQuality::Unknown,
    };
    let against = predicted.against_fix(&fix).std(&Quaternion::identity());
    for (i, expected) in [4.0, 5.0, 5.0, 41f64.sqrt(), 1.0, 1.0, 1.0]
        .into_iter()
        .enumerate()
    {
        assert!(
            (against.0[i] - expected).abs() < 1e-12,
            "{i}: {}",
            against.0[i]
        );
    }
    assert_eq!(against.0[7..], std.0[7..]);
}

#[test]
fn statistics_of_known_values() {
    let row = |x: f64| Errors([x; 10]);
    let values = [row(-3.0), row(1.0), row(2.0)];
    assert_eq!(max(&values).0[0], 3.0);
    assert_eq!(median(&values).0[0], 2.0);
    assert!((rms(&values).0[0] - (14.0f64 / 3.0).sqrt()).abs() < 1e-15);
    assert!(max(&[row(1.0), Errors::UNKNOWN]).0[0].is_nan());
    let mut north = Errors::UNKNOWN;
    north.0[0] = -4.0;
    let known = where_known(&[row(1.0), north, Errors::UNKNOWN], max);
    assert_eq!((known.0[0], known.0[1]), (4.0, 1.0));
    assert!(where_known(&[Errors::UNKNOWN], rms).0[0].is_nan());
    assert!(median(&[]).0[0].is_nan());
}

/// A vertical velocity of 20 m/s beside 0.2 m/s is no reference; what is left has two degrees of freedom.
#[test]
fn what_a_fix_leaves_open_is_unknown() {
    let at = Geodetic::from_degrees(48.0, 11.0, 400.0);
    let fix = |vertical: f64| {
        let std = [0.2, 0.2, vertical];
        GnssFix::at(0.0, at, [3.0, 3.0, 6.0]).with_velocity(Vector3::zeros(), std)
    };
    let velocity = Vector3::new(0.4, -0.6, 5.0);
    let against = |fix: &GnssFix| Errors::of_antenna(&at, &velocity, fix);
    let [open, whole] = [fix(20.0), fix(0.4)].map(|fix| against(&fix));
    assert_eq!(whole.0[4..7], [0.4, -0.6, 5.0]);
    assert!(open.0[4..6] == [0.4, -0.6] && open.0[6].is_nan());
    assert_eq!(open.0[..3], [0.0; 3]);
    let own = Predicted([Matrix3::zeros(); 3]).against_fix(&fix(20.0));
    let level = Quaternion::identity();
    let [_, nees, attitude] = own.nees(&level, &open);
    // (2² + 3²)/2, and not with a third that is (5/20)².
    assert!((nees - 6.5).abs() < 1e-9 && attitude.is_nan(), "{nees}");
}
