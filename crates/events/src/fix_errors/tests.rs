use super::*;

fn parts(share: f64) -> FixErrors {
    FixErrors {
        correlated: Some(Correlated { share, time: 60.0 }),
        ..FixErrors::default()
    }
}

#[test]
fn a_covariance_is_split_by_the_share_of_its_correlated_part() {
    let covariance = Matrix3::new(4.0, 0.5, 0.0, 0.5, 9.0, 0.0, 0.0, 0.0, 16.0);
    let (white, std) = parts(0.75).split(&covariance);
    assert_eq!(white, covariance * 0.25);
    assert!((std - Vector3::new(2.0, 3.0, 4.0) * 0.75f64.sqrt()).amax() < 1e-12);
    let (white, std) = parts(0.75).split_velocity(&covariance);
    assert_eq!((white, std), (covariance, Vector3::zeros()));
    let both = parts(0.75).correlated_std(&covariance, &covariance);
    assert_eq!(both, [parts(0.75).split(&covariance).1, Vector3::zeros()]);
}

#[test]
fn each_part_of_the_variance_is_multiplied_by_the_square_of_its_factor() {
    let factors = StdFactors {
        white: [2.0, 3.0],
        correlated: [4.0, 5.0],
    };
    let found = parts(0.75).scaled(&factors);
    // 0.25 · 4 and 0.75 · 16.
    assert!((found.position_factor - 13f64.sqrt()).abs() < 1e-12);
    let part = found.correlated.unwrap();
    assert!((part.share - 12.0 / 13.0).abs() < 1e-12 && part.time == 60.0);
    // All of the velocity's is white.
    assert!((found.velocity_factor.x - 3.0).abs() < 1e-12 && found.velocity_correlated.is_none());
    assert_eq!(parts(0.75).scaled(&StdFactors::ONE), parts(0.75));
}
