use super::*;

/// Rows of a time, values that the closure makes of the row's number, and what stays.
fn table(names: &[&str], row: impl Fn(f64) -> Vec<f64>) -> Preview {
    Preview {
        names: names.iter().map(|name| (*name).to_owned()).collect(),
        rows: (0..200).map(|k| row(f64::from(k))).collect(),
        ..Preview::default()
    }
}

fn rate(k: f64) -> [f64; 3] {
    [
        0.3 * (0.11 * k).sin(),
        0.2 * (0.07 * k).cos(),
        0.4 * (0.05 * k).sin(),
    ]
}

fn force(k: f64) -> [f64; 3] {
    [
        0.2 * (0.3 * k).sin(),
        0.1 * (0.2 * k).cos(),
        9.8 + 0.1 * (0.5 * k).sin(),
    ]
}

fn found(table: &Preview) -> [Option<usize>; 2] {
    let found = by_numbers(table);
    [found.gyro[0], found.accel[0]]
}

#[test]
fn a_quaternion_is_no_force() {
    let row = |k: f64| {
        let half = 0.002 * k;
        let q = [0.0, 0.0, half.sin(), half.cos()];
        [&[0.01 * k][..], &q, &[0.0, 1.0, 40.0], &rate(k), &force(k)].concat()
    };
    assert_eq!(found(&table(&[], row)), [Some(8), Some(11)]);
}

#[test]
fn a_magnetometer_before_the_force_is_no_gyro() {
    let field = |k: f64| [-0.18 + 1e-4 * k, -0.28, 0.31];
    let row = |k: f64| [&[0.01 * k][..], &field(k), &force(k), &rate(k)].concat();
    assert_eq!(found(&table(&[], row)), [Some(7), Some(4)]);
}

#[test]
fn the_number_of_a_sensor_is_no_value() {
    let row = |k: f64| [&[0.01 * k, 3.0][..], &force(k), &[4.0], &rate(k)].concat();
    assert_eq!(found(&table(&[], row)), [Some(6), Some(2)]);
}

#[test]
fn increments_have_gravity_over_the_interval() {
    let row = |k: f64| {
        let all = [rate(k), force(k)].concat();
        let of = all.iter().map(|x| 0.01 * x);
        Vec::from_iter(of.chain([0.01 * k]))
    };
    assert_eq!(found(&table(&[], row)), [Some(0), Some(3)]);
}

#[test]
fn what_states_an_angle_is_no_rate() {
    let names = [
        "t",
        "Heading (deg)",
        "Pitch (deg)",
        "Roll (deg)",
        "a",
        "b",
        "c",
        "d",
        "e",
        "f",
    ];
    let row = |k: f64| {
        let angles = [40.0 + 0.3 * k, 2.0 * (0.1 * k).sin(), (0.2 * k).sin()];
        [&[0.01 * k][..], &angles, &force(k), &rate(k)].concat()
    };
    assert_eq!(found(&table(&names, row)), [Some(7), Some(4)]);
}

#[test]
fn latitudes_in_radians_follow_a_path() {
    let row = |k: f64| {
        let lat = 0.84 + 2e-6 * k;
        vec![0.2 * k, lat, 0.2 + 3e-6 * (0.1 * k).sin(), 500.0 + 0.01 * k]
    };
    assert_eq!(
        by_numbers(&table(&[], row)).place,
        [Some(1), Some(2), Some(3)]
    );
}
