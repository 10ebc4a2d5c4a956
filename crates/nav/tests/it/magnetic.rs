//! The Earth's field against an independent program, `testdata/golden/magnetic_field.py`.

use undrift_nav::{earth::Geodetic, magnetic};

const GOLDEN: &str = include_str!("../../../../testdata/golden/magnetic_field.csv");

#[test]
fn the_field_is_that_of_the_model() {
    let mut rows = 0;
    for row in GOLDEN.lines().skip(1) {
        let numbers: Vec<f64> = row.split(',').map(|n| n.parse().unwrap()).collect();
        let [lat, lon, height, year, north, east, down] = numbers[..] else {
            panic!("{row}")
        };
        let place = Geodetic::from_degrees(lat, lon, 1e3 * height);
        let field = magnetic::field(&place, year) * 1e9;
        // The program rounds its coefficients' years as the model's report does; 0.1 nT is their own resolution.
        for (found, golden) in field.iter().zip([north, east, down]) {
            assert!((found - golden).abs() < 0.05, "{row}: {field}");
        }
        rows += 1;
    }
    assert_eq!(rows, 12);
}

/// At a pole east is a matter of the longitude, and there is a field.
#[test]
fn poles_and_years_far_away_have_a_field() {
    let pole = Geodetic::from_degrees(90.0, 30.0, 0.0);
    let near = Geodetic::from_degrees(89.999, 30.0, 0.0);
    let apart = magnetic::field(&pole, 2025.0) - magnetic::field(&near, 2025.0);
    assert!(apart.norm() < 5e-9);
    assert_eq!(magnetic::uncertainty(2027.0), magnetic::UNMODELLED);
    assert!(magnetic::uncertainty(2015.0) > 0.3e-6 && magnetic::uncertainty(2040.0) > 0.3e-6);
}
