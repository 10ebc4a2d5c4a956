//! Fixes without names.

use super::*;

/// A drive along an S, climbing: 20 m/s, at 2 Hz, from a start; at 30 s it is at rest.
fn drive(start: [f64; 2], row: impl Fn(f64, [f64; 3], [f64; 3]) -> Vec<f64>) -> Vec<Vec<f64>> {
    let (mut north, mut east, mut height) = (0.0, 0.0, 400.0);
    let rows = (0..200).map(|k| {
        let t = 0.5 * f64::from(k);
        let course = (0.05 * t).sin() + 0.4;
        let speed = if (30.0..40.0).contains(&t) {
            0.0
        } else {
            15.0 + 5.0 * (0.1 * t).cos()
        };
        let v = [speed * course.cos(), speed * course.sin(), -0.02 * speed];
        north += 0.5 * v[0];
        east += 0.5 * v[1];
        height -= 0.5 * v[2];
        let lat = start[0] + (north / SEMI_MAJOR).to_degrees();
        let lon = start[1] + (east / SEMI_MAJOR / start[0].to_radians().cos()).to_degrees();
        row(t, [lat, lon, height], v)
    });
    let rows: Vec<Vec<f64>> = rows.collect();
    (0..rows[0].len())
        .map(|k| rows.iter().map(|row| row[k]).collect())
        .collect()
}

fn found(columns: &[Vec<f64>]) -> Found {
    let mut found = Found {
        time: Some(0),
        ..Found::default()
    };
    find(columns, &mut found);
    found
}

#[test]
fn a_path_is_found_with_velocities_and_accuracies_behind_it() {
    for start in [[48.1, 11.5], [-33.9, 151.2], [51.5, -0.12]] {
        let columns = drive(start, |t, [lat, lon, height], [n, e, d]| {
            vec![t, lat, lon, height, n, e, d, 0.5, 0.8, 0.1]
        });
        let found = found(&columns);
        assert_eq!(found.place, [1, 2, 3].map(Some), "{start:?}");
        assert_eq!((found.velocity, found.up), ([4, 5, 6].map(Some), false));
        assert_eq!(found.accuracy, [7, 8, 9].map(Some));
    }
    let columns = drive([48.1, 11.5], |t, [lat, lon, height], [n, e, d]| {
        vec![
            t, lat, lon, height, e, n, -d, 7.0, 0.5, 0.4, 0.8, 0.05, 0.04, 0.1,
        ]
    });
    let found = found(&columns);
    assert_eq!((found.velocity, found.up), ([5, 4, 6].map(Some), true));
    assert_eq!(found.position_std, [8, 9, 10].map(Some));
    assert_eq!(found.velocity_std, [11, 12, 13].map(Some));
}

#[test]
fn a_speed_and_a_course_are_found_in_any_unit_and_order() {
    for unit in [1.0, 3.6, 1.944] {
        let columns = drive([48.1, 11.5], |t, [lat, lon, height], [n, e, _]| {
            let course = e.atan2(n).to_degrees().rem_euclid(360.0);
            vec![t, lat, lon, height, course, unit * n.hypot(e), 1.5, 2.5]
        });
        let found = found(&columns);
        assert_eq!(
            (found.polar, found.velocity),
            ([Some(5), Some(4)], [None; 3]),
            "{unit}"
        );
        assert_eq!(found.accuracy, [Some(6), Some(7), None]);
    }
    // A speed over which the positions do not go.
    let columns = drive([48.1, 11.5], |t, [lat, lon, height], [n, e, _]| {
        vec![
            t,
            lat,
            lon,
            height,
            2.5 * n.hypot(e),
            e.atan2(n).to_degrees(),
        ]
    });
    assert_eq!(found(&columns).polar, [None; 2]);
}

#[test]
fn a_speed_fits_the_positions_in_nine_rows_of_ten() {
    for (off, polar) in [(1, [Some(4), Some(5)]), (3, [None; 2])] {
        let columns = drive([48.1, 11.5], |t, [lat, lon, height], [n, e, _]| {
            let course = e.atan2(n).to_degrees();
            // Rows of 0.5 s, of which so many of twenty have half or twice the speed.
            let row = (2.0 * t) as usize;
            let factor = match row % 20 < off {
                true => [0.5, 2.0][row % 2],
                false => 1.0,
            };
            vec![t, lat, lon, height, factor * n.hypot(e), course]
        });
        assert_eq!(found(&columns).polar, polar, "{off} of 20");
    }
}

#[test]
fn what_is_no_path() {
    let noise = |k: usize| ((k * 7919 % 101) as f64 - 50.0) / 50.0;
    let table = |of: &dyn Fn(usize) -> [f64; 3]| -> Vec<Vec<f64>> {
        let rows: Vec<[f64; 3]> = (0..400).map(of).collect();
        let time = (0..400).map(|k| 0.01 * f64::from(k)).collect();
        let column = |axis: usize| rows.iter().map(|row| row[axis]).collect();
        vec![time, column(0), column(1), column(2)]
    };
    // Accelerometers of a tilted sensor at rest [m/s²], in a vehicle, and a path in degrees of four digits.
    for columns in [
        table(&|k| [5.1, 6.9, 4.0].map(|x| x + 3e-4 * noise(k))),
        table(&|k| [5.1, 6.9, 4.0].map(|x| x + (0.05 * k as f64).sin() + 0.05 * noise(k))),
        table(&|k| [(1e-5 * k as f64 + 48.1) * 1e4, 115_000.0, 0.0].map(|x| x.round() / 1e4)),
        table(&|k| [91.0 + 1.00001e-5 * k as f64, 181.5, 400.0]),
        table(&|k| [48.0 + 1.00001e-5 * k as f64, 11.5, -4000.0]),
    ] {
        assert_eq!(found(&columns).place, [None; 3]);
    }
    // Beyond 90 degrees the first is the longitude.
    let longitude_first = table(&|k| [91.0 + 1.00001e-5 * k as f64, 11.5, 400.0]);
    assert_eq!(found(&longitude_first).place, [2, 1, 3].map(Some));
    let still = table(&|k| [48.123_456_7 + 1e-7 * noise(k), 11.5, 400.0]);
    assert_eq!(found(&still).place, [1, 2, 3].map(Some));
}
