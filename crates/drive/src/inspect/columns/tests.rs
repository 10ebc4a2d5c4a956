//! What columns are by their numbers, and the keys that follow.

use super::*;
use crate::inspect::numbers::{means, steady};

fn preview(names: &[&str], rows: Vec<Vec<f64>>) -> Preview {
    let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
    Preview {
        header: names.clone(),
        names,
        rows,
        ..Preview::default()
    }
}

/// Keys and values of the only part of a table.
fn lines(names: &[&str], rows: Vec<Vec<f64>>) -> (&'static str, Vec<(&'static str, String)>) {
    let parts = parts_of(preview(names, rows), &mut Vec::new());
    assert_eq!(parts.len(), 1, "{names:?}");
    let lines = parts[0].lines.iter();
    let lines = lines.map(|line| (line.key, line.value.to_string().replace('"', "")));
    (parts[0].table, lines.collect())
}

fn value(lines: &[(&'static str, String)], key: &str) -> Option<String> {
    let mut found = lines.iter().filter(|line| line.0 == key);
    let value = found.next().map(|line| line.1.clone());
    assert!(found.next().is_none(), "{key} twice");
    value
}

#[test]
fn rows_have_as_many_fields_as_most_have() {
    let row = |n: usize| vec![1.0; n];
    assert_eq!(usual_width(&[row(3), row(5), row(5), row(2)]), 5);
    assert_eq!(usual_width(&[]), 0);
    assert_eq!(
        (
            all(&[Some(4), Some(2), Some(7)]),
            all(&[Some(4), None, Some(7)])
        ),
        (Some([4, 2, 7]), None)
    );
    let rows = [vec![1.0, 2.0, 3.0, 4.0], vec![5.0, f64::NAN, 6.0, 7.0]];
    assert_eq!(
        three_of(&rows, [3, 0, 2]),
        [[4.0, 1.0, 3.0], [7.0, 5.0, 6.0]]
    );
    assert_eq!(three_of(&rows, [0, 1, 2]), [[1.0, 2.0, 3.0]]);
    assert!(three_of(&rows, [0, 1, 9]).is_empty());
}

#[test]
fn a_magnitude_is_steady_that_varies_by_less_than_a_third() {
    // Of ten sizes the second is at ten percent, the last at ninety, the sixth in the middle.
    let of = |most: f64| -> Vec<[f64; 3]> {
        (0..10)
            .map(|k| {
                if k < 9 {
                    [0.0, 3.0, 4.0]
                } else {
                    [0.0, 0.0, most]
                }
            })
            .collect()
    };
    assert!(steady(&of(6.6)) && !steady(&of(6.7)));
    assert!(!steady(&of(5.0)[..2]) && steady(&of(5.0)[..3]));
    let samples: Vec<[f64; 3]> = (0..60)
        .map(|k| [f64::from(k), 1.0, -f64::from(k % 2)])
        .collect();
    let found = means(&samples);
    assert_eq!(found.len(), 2);
    assert_eq!(found[0], [12.0, 1.0, -12.0 / 25.0]);
    assert_eq!(found[1], [37.0, 1.0, -13.0 / 25.0]);
}

#[test]
fn sensors_are_apart_where_a_fifth_of_the_rows_have_one_alone() {
    let nan = f64::NAN;
    let (both, gyro, accel) = (
        vec![1.0; 6],
        vec![1.0, 1.0, 1.0, nan, nan, nan],
        vec![nan, nan, nan, 1.0, 1.0, 1.0],
    );
    let of = |counts: [usize; 3]| {
        let rows = [&both, &gyro, &accel].into_iter().zip(counts);
        let rows: Vec<Vec<f64>> = rows.flat_map(|(row, n)| vec![row.clone(); n]).collect();
        apart(&rows, [0, 1, 2], [3, 4, 5])
    };
    assert!(of([8, 1, 1]) && of([8, 2, 0]) && of([8, 0, 2]) && of([0, 5, 5]));
    assert!(!of([9, 1, 0]) && !of([9, 0, 1]) && !of([10, 0, 0]));
    // All of one and none of the other.
    assert!(!of([0, 5, 0]) && !of([0, 0, 5]));
}

#[test]
fn a_time_grows_and_is_no_counter() {
    let rows = |step: f64| -> Vec<Vec<f64>> {
        (0..20)
            .map(|k| vec![f64::from(k), 5.0, step * f64::from(k), -f64::from(k)])
            .collect()
    };
    let of = |names: &[&str], step| time_by_numbers(&preview(names, rows(step)));
    assert_eq!(of(&["n", "q", "clk", "z"], 0.1), Some(2));
    assert_eq!(of(&["n", "q", "clk", "z"], 1.0), None);
    // One that is known is something else.
    assert_eq!(of(&["n", "q", "alt", "z"], 0.1), None);
    assert_eq!(
        time_by_numbers(&preview(&["t"], vec![vec![0.0], vec![0.5]])),
        None
    );
}

#[test]
fn columns_without_names_are_found_by_their_numbers() {
    let imu = |time: usize, accel: usize, gyro: usize| {
        let row = |k: i32| {
            let mut row = vec![0.0; 7];
            row[time] = 0.01 * f64::from(k);
            for axis in 0..3 {
                row[gyro + axis] = 0.001 * f64::from(k * 37 % 7 - 3);
                row[accel + axis] = [0.1, -0.2, 9.8][axis];
            }
            row
        };
        by_numbers(&preview(&[], (0..100).map(row).collect()))
    };
    for (time, accel, gyro) in [(0, 4, 1), (0, 1, 4), (6, 3, 0), (6, 0, 3)] {
        let found = imu(time, accel, gyro);
        assert_eq!(found.time, Some(time));
        assert_eq!(
            all(&found.accel),
            Some([accel, accel + 1, accel + 2]),
            "{accel}"
        );
        assert_eq!(all(&found.gyro), Some([gyro, gyro + 1, gyro + 2]), "{gyro}");
    }
    // Neither the time nor a column beyond the table becomes a gyro.
    let row = |k: i32| {
        let rate = |axis: i32| 0.001 * f64::from(k * 37 % 7 - axis);
        let (before, behind) = ([1.0, 25.0, 0.01 * f64::from(k)], [2, 3, 4].map(rate));
        [before, [0.1, -0.2, 9.8], behind].concat()
    };
    let rows: Vec<Vec<f64>> = (0..100).map(row).collect();
    let found = by_numbers(&preview(&[], rows.clone()));
    assert_eq!(
        (found.time, all(&found.accel), all(&found.gyro)),
        (Some(2), Some([3, 4, 5]), Some([6, 7, 8]))
    );
    let narrow = rows.iter().map(|row| row[2..8].to_vec());
    let found = by_numbers(&preview(&[], narrow.collect()));
    assert_eq!((found.accel, found.gyro), ([None; 3], [None; 3]));
    let gnss = |lat: f64, lon: f64| {
        let row = |k: i32| vec![f64::from(k) * 0.5, lat + 1e-5 * f64::from(k), lon, 300.0];
        by_numbers(&preview(&[], (0..50).map(row).collect())).place
    };
    assert_eq!(all(&gnss(47.1, 8.5)), Some([1, 2, 3]));
    assert_eq!(all(&gnss(-33.1, 151.5)), Some([1, 2, 3]));
    // Beyond the range, about zero, or whole.
    for (lat, lon) in [(91.1, 8.5), (47.1, 181.5), (0.5, 8.5), (47.1, 8.0)] {
        assert!(all(&gnss(lat, lon)) != Some([1, 2, 3]), "{lat} {lon}");
    }
}

#[test]
fn a_receiver_that_counts_has_places_heights_and_deviations_in_thousandths() {
    let names = ["time", "lat", "lon", "height", "hacc", "vacc"];
    let row = |k: i32| {
        let k = f64::from(k);
        vec![
            k,
            471_000_000.0 + 900.0 * k,
            85_000_000.0,
            412_000.0,
            1500.0,
            2500.0,
        ]
    };
    let (table, found) = lines(&names, (0..30).map(row).collect());
    assert_eq!(table, "gnss");
    assert_eq!(
        value(&found, "position").as_deref(),
        Some("[lat, lon, height]")
    );
    assert_eq!(
        value(&found, "position_unit").as_deref(),
        Some("LSB/1e7 deg")
    );
    assert_eq!(value(&found, "height_unit").as_deref(), Some("mm"));
    assert_eq!(
        value(&found, "position_std_columns").as_deref(),
        Some("[hacc, hacc, vacc]")
    );
    assert_eq!(
        value(&found, "position_std_factor").as_deref(),
        Some("0.001")
    );
    assert_eq!(value(&found, "velocity"), None);
    // Degrees as they are, and angles small enough for radians.
    let of = |lat: f64, lon: f64| {
        let row = |k: i32| vec![f64::from(k), lat + 1e-5 * f64::from(k), lon, 412.3];
        let (_, found) = lines(&names[..4], (0..30).map(row).collect());
        assert_eq!(value(&found, "height_unit"), None);
        assert_eq!(value(&found, "position_std").as_deref(), Some("3, 3, 6 m"));
        value(&found, "position_unit")
    };
    assert_eq!(of(47.1, 8.5), None);
    assert_eq!(of(0.8, 0.1).as_deref(), Some("rad"));
    assert_eq!(of(0.8, 3.15), None);
    assert_eq!(of(1.58, 0.1), None);
}

#[test]
fn a_speed_is_in_the_unit_in_which_it_fits_the_positions() {
    let names = ["time", "lat", "lon", "height", "speed", "course"];
    // 20 m/s to the north: 1.8e-4 degrees a second.
    let of = |speed: f64, scale: f64| {
        let row = |k: i32| {
            let t = f64::from(k);
            vec![
                scale * t,
                47.1 + 20.0 / 111_177.0 * t,
                8.5,
                412.3,
                speed + 0.001 * t,
                0.0,
            ]
        };
        let (_, found) = lines(&names, (0..60).map(row).collect());
        assert_eq!(value(&found, "speed").as_deref(), Some("speed"));
        assert_eq!(value(&found, "course").as_deref(), Some("course"));
        assert_eq!(
            value(&found, "velocity_std").as_deref(),
            Some("0.2, 0.2, 20 m/s")
        );
        value(&found, "velocity_unit")
    };
    assert_eq!(of(20.0, 1.0), None);
    assert_eq!(of(72.0, 1.0).as_deref(), Some("km/h"));
    assert_eq!(of(38.9, 1.0).as_deref(), Some("kn"));
    assert_eq!(of(2000.0, 1.0).as_deref(), Some("cm/s"));
    assert_eq!(of(20_000.0, 1.0).as_deref(), Some("mm/s"));
    // Of stamps in milliseconds too.
    assert_eq!(of(72.0, 1000.0).as_deref(), Some("km/h"));
    // In none.
    assert_eq!(of(7.0, 1.0), None);
}

#[test]
fn velocities_up_and_stated_deviations_have_their_keys() {
    let names = ["time", "lat", "lon", "alt", "vn", "ve", "vu", "sacc"];
    let row = |k: i32| {
        vec![
            f64::from(k),
            47.1 + 1e-5 * f64::from(k),
            8.5,
            412.3,
            1.1,
            2.2,
            0.1,
            0.3,
        ]
    };
    let (_, found) = lines(&names, (0..30).map(row).collect());
    assert_eq!(value(&found, "velocity").as_deref(), Some("[vn, ve, vu]"));
    assert_eq!(
        value(&found, "velocity_axes").as_deref(),
        Some("north,east,up")
    );
    assert_eq!(
        value(&found, "velocity_std_columns").as_deref(),
        Some("[sacc, sacc, sacc]")
    );
    assert_eq!(value(&found, "velocity_std_factor"), None);
}

/// Gyros at rest with a bias of about 1 deg/s before accelerometers in g.
#[test]
fn gyros_at_rest_whose_rates_look_like_gravity_are_no_accelerometers() {
    let noise = |k: i32| f64::from(k * 7919 % 101 - 50) / 50.0;
    for [gyro, accel] in [[0, 3], [3, 0]] {
        let row = |k: i32| {
            let mut row = vec![0.0; 6];
            for axis in 0..3 {
                row[gyro + axis] = [0.6, -0.6, -0.5][axis] + 0.1 * noise(k + axis as i32);
                row[accel + axis] = [0.0, 0.003, -1.017][axis] + 0.003 * noise(k * 3 + axis as i32);
            }
            row
        };
        let (table, found) = lines(&[], (0..200).map(row).collect());
        assert_eq!(table, "imu");
        let columns = |from: usize| Some(format!("[{}, {}, {}]", from + 1, from + 2, from + 3));
        assert_eq!(value(&found, "gyro"), columns(gyro));
        assert_eq!(value(&found, "accel"), columns(accel));
        assert_eq!(value(&found, "gyro_unit").as_deref(), Some("deg/s"));
        assert_eq!(value(&found, "accel_unit").as_deref(), Some("g"));
    }
}

#[test]
fn degrees_and_minutes_are_known_by_their_size() {
    let names = ["time", "lat", "ns", "lon", "ew", "alt"];
    let of = |lat: f64, lon: f64| {
        let row = |k: i32| {
            vec![
                f64::from(k),
                lat + 0.01 * f64::from(k),
                f64::NAN,
                lon,
                f64::NAN,
                412.3,
            ]
        };
        let (_, found) = lines(&names, (0..30).map(row).collect());
        value(&found, "position_unit")
    };
    assert_eq!(of(4808.225, 1131.0).as_deref(), Some("ddmm.mmmm"));
    assert_eq!(of(45.225, 17_931.5).as_deref(), Some("ddmm.mmmm"));
    assert_eq!(of(48.1, 11.5), None);
}

#[test]
fn days_of_a_spreadsheet_have_their_unit() {
    let names = ["Time", "gx", "gy", "gz", "ax", "ay", "az"];
    let row = |k: i32| {
        let day = 45_846.815 + 0.01 / 86_400.0 * f64::from(k);
        vec![day, 0.001, 0.002, 0.003, 0.1, 0.2, 9.8]
    };
    let (_, found) = lines(&names, (0..50).map(row).collect());
    assert_eq!(value(&found, "time_unit").as_deref(), Some("d"));
}

#[test]
fn a_speed_and_a_course_are_taken_where_nothing_else_is_a_velocity_and_rows_show_the_unit() {
    let row = |k: i32| vec![f64::from(k), 47.1, 8.5, 412.3, 1.1, 2.2, 0.1, 2.5, 63.0];
    let names = [
        "time", "lat", "lon", "alt", "vn", "ve", "vd", "speed", "course",
    ];
    let (_, found) = lines(&names, (0..30).map(row).collect());
    assert_eq!(value(&found, "velocity").as_deref(), Some("[vn, ve, vd]"));
    assert_eq!(
        [value(&found, "speed"), value(&found, "course")],
        [None, None]
    );
    // A header without rows.
    let names = ["time", "lat", "lon", "alt", "speed", "course"];
    let (_, found) = lines(&names, Vec::new());
    let keys = ["velocity", "speed", "course", "velocity_std"];
    assert_eq!(keys.map(|key| value(&found, key)), [const { None }; 4]);
    assert_eq!(
        value(&found, "position").as_deref(),
        Some("[lat, lon, alt]")
    );
}

/// Beside speed and course, where it is of the same unit: else it is not read, and the vertical velocity stays open.
#[test]
fn a_vertical_velocity_is_taken_beside_speed_and_course() {
    let of = |speed: &str, vertical: &str| {
        let names = ["time", "lat", "lon", "alt", speed, "course", vertical];
        let row = |k: i32| {
            let t = f64::from(k);
            vec![t, 47.1 + 1e-5 * t, 8.5, 412.3 + 0.5 * t, 1.112, 0.0, 0.5]
        };
        let (_, found) = lines(&names, (0..40).map(row).collect());
        let keys = ["vertical_velocity", "velocity_axes", "velocity_std"];
        keys.map(|key| value(&found, key).unwrap_or_default())
    };
    let known = "0.2, 0.2, 0.4 m/s";
    assert_eq!(of("speed_mps", "vel_down_mps"), ["vel_down_mps", "", known]);
    assert_eq!(of("speed", "climb"), ["climb", "north,east,up", known]);
    let open = ["", "", "0.2, 0.2, 20 m/s"];
    assert_eq!(of("speed_kmh", "vel_down_mps"), open);
}

#[test]
fn the_time_of_arrival_is_the_time_where_the_sensor_has_none() {
    let time = |names: &[&str]| by_names(&preview(names, Vec::new())).time;
    assert_eq!(time(&["received", "gx", "time"]), Some(2));
    assert_eq!(time(&["time", "gx", "received"]), Some(0));
    assert_eq!(time(&["gx", "received"]), Some(1));
    assert_eq!(time(&["gx", "timestamp", "time"]), Some(1));
}

#[test]
fn a_counter_of_rows_is_no_time_beside_one_and_counts_are_forces() {
    let row = |k: u32| {
        let noise = f64::from(k * 7919 % 13) - 6.0;
        let t = f64::from(k);
        vec![
            t,
            20.0 * t + 5.0,
            noise,
            100.0,
            8192.0 + noise,
            3.0 * noise,
            -noise,
            2.0,
        ]
    };
    let (_, of_row) = lines(&[], (0..400).map(row).collect());
    assert_eq!(value(&of_row, "time").as_deref(), Some("2"));
    assert_eq!(value(&of_row, "accel").as_deref(), Some("[3, 4, 5]"));
    assert_eq!(value(&of_row, "accel_unit").as_deref(), Some("LSB/8192 g"));
    assert_eq!(value(&of_row, "gyro").as_deref(), Some("[6, 7, 8]"));
    // Nothing else grows.
    let (_, of_row) = lines(
        &[],
        (0..400)
            .map(|k| [vec![f64::from(k)], row(k)[2..].to_vec()].concat())
            .collect(),
    );
    assert_eq!(value(&of_row, "time").as_deref(), Some("1"));
}

#[test]
fn places_about_the_centre_of_the_earth_and_with_the_longitude_first() {
    let moving = |k: u32| 1.7 * f64::from(k) + 0.01 * f64::from(k * k % 7);
    let row = |k: u32| {
        vec![
            f64::from(k) * 0.5,
            4_177_000.5 + moving(k),
            855_000.25,
            4_728_000.125,
        ]
    };
    let (table, found) = lines(&["t", "X", "Y", "Z"], (0..60).map(row).collect());
    assert_eq!(
        (table, value(&found, "ecef").as_deref()),
        ("gnss", Some("[X, Y, Z]"))
    );
    let row = |k: u32| {
        vec![
            f64::from(k) * 0.5,
            114.47 + 1e-5 * moving(k),
            30.44 + 1e-5 * moving(k),
            20.25,
        ]
    };
    let (table, found) = lines(&[], (0..60).map(row).collect());
    assert_eq!(
        (table, value(&found, "position").as_deref()),
        ("gnss", Some("[3, 2, 4]"))
    );
}

#[test]
fn dates_are_times_whatever_their_column_is_called() {
    let rows = || {
        (0..50)
            .map(|k| vec![f64::from(k), 48.1 + 1e-5 * f64::from(k), 11.5, 500.0])
            .collect()
    };
    for name in ["Datum", "wann"] {
        let mut table = preview(&[name, "lat", "lon", "height"], rows());
        table.times = vec![0];
        let parts = parts_of(table, &mut Vec::new());
        assert_eq!(
            (parts[0].lines[0].key, parts[0].lines[0].value.as_str()),
            ("time", Some(name))
        );
    }
    // Steps of one are a counter's.
    let parts = parts_of(
        preview(&["wann", "lat", "lon", "height"], rows()),
        &mut Vec::new(),
    );
    assert!(parts[0].lines.iter().all(|line| line.key != "time"));
}

#[test]
fn ticks_of_unknown_length_are_no_times() {
    let row = |k: u32| {
        let noise = f64::from(k * 7919 % 13) - 6.0;
        vec![
            100.0 * f64::from(k),
            noise,
            noise,
            1.0,
            0.1,
            0.1 * noise,
            9.81,
        ]
    };
    let names = ["ticks", "gx_dps", "gy_dps", "gz_dps", "ax", "ay", "az"];
    let (_, found) = lines(&names, (0..400).map(row).collect());
    assert_eq!(
        (value(&found, "time"), value(&found, "rate").as_deref()),
        (None, Some("100 Hz"))
    );
}

#[test]
fn places_without_a_height_have_that_of_the_ellipsoid_and_say_so() {
    let row = |k: u32| vec![f64::from(k), 48.1 + 1e-5 * f64::from(k), 11.5];
    let rows: Vec<_> = (0..50).map(row).collect();
    let (table, found) = lines(&["time", "latitude", "longitude"], rows.clone());
    let of = |key| value(&found, key);
    assert_eq!(
        (table, of("position").as_deref()),
        ("gnss", Some("[latitude, longitude]"))
    );
    assert_eq!(of("height").as_deref(), Some("0 m"));
    assert_eq!(of("position_std").as_deref(), Some("3, 3, 50 m"));
    let text = |key: &str, position: &str| {
        let mut csv = String::from("time,latitude,longitude,other\n");
        for row in &rows {
            csv += &format!("{},{},{},1\n", row[0], row[1], row[2]);
        }
        let memory = undrift_io::Memory::Bytes(csv.into_bytes().into());
        let name = std::path::PathBuf::from("gnss.csv");
        let mut logs = crate::drive::Logs::default();
        logs.memory.insert(name.clone(), memory.clone());
        logs.memory.insert(
            "imu.csv".into(),
            undrift_io::Memory::Bytes(
                b"t,gx,gy,gz,ax,ay,az\n0,0,0,0,0,0,-9.8\n0.1,0,0,0,0,0,-9.8\n"
                    .to_vec()
                    .into(),
            ),
        );
        let text = format!(
            "model = \"mpu6050\"\n[imu]\nfile = \"imu.csv\"\ntime = \"t\"\ngyro = [\"gx\", \"gy\", \"gz\"]\ngyro_unit = \"rad/s\"\naccel = [\"ax\", \"ay\", \"az\"]\naccel_unit = \"m/s^2\"\n[gnss]\nfile = \"gnss.csv\"\ntime = \"time\"\n{key}position = {position}\nposition_std = \"3, 3, 50 m\"\n"
        );
        crate::drive::Drive::with_logs(&text, "drive.toml", std::path::Path::new(""), logs)
    };
    let drive = text("height = \"120 m\"\n", "[\"latitude\", \"longitude\"]").unwrap();
    let fix = drive.open_gnss().unwrap().next().unwrap().unwrap();
    let Some((undrift_nav::sample::Position::Geodetic(place), _)) = fix.position else {
        panic!("{fix:?}");
    };
    assert_eq!(place.height, 120.0);
    let three = "[\"latitude\", \"longitude\", \"other\"]";
    let error = text("height = \"120 m\"\n", three).unwrap_err().to_string();
    assert!(error.contains("remove the third, or height"), "{error}");
    assert!(text("", "[\"latitude\", \"longitude\"]").is_err());
}

#[test]
fn semicircles_are_known_by_the_names_of_fit() {
    let row = |k: i32| {
        vec![
            f64::from(k),
            363_156_700.0 + 900.0 * f64::from(k),
            1_365_000_000.0,
            20.5,
        ]
    };
    let unit = |lat: &str, lon: &str| {
        let (_, found) = lines(&["time", lat, lon, "altitude"], (0..30).map(row).collect());
        value(&found, "position_unit")
    };
    assert_eq!(
        unit("position_lat", "position_long").as_deref(),
        Some("LSB/11930464.7111 deg")
    );
    assert_eq!(unit("lat", "lon").as_deref(), Some("LSB/1e7 deg"));
    assert_eq!(unit("lat_e6", "lon_e6").as_deref(), Some("LSB/1e6 deg"));
}

#[test]
fn increments_are_known_by_name_and_size() {
    let row = |k: i32| {
        let noise = f64::from(k * 7919 % 101 - 50) * 1e-6;
        vec![
            0.02 * f64::from(k),
            noise,
            -noise,
            noise,
            0.004,
            noise,
            -0.196,
        ]
    };
    let names = [
        "time", "dtheta_x", "dtheta_y", "dtheta_z", "dv_x", "dv_y", "dv_z",
    ];
    let (table, found) = lines(&names, (0..200).map(row).collect());
    assert_eq!(table, "imu");
    assert_eq!(value(&found, "data").as_deref(), Some("increments"));
    assert_eq!(value(&found, "accel_unit").as_deref(), Some("m/s"));
}

/// Accuracies across and up are those of latitude and longitude, and along no axis of the Earth.
#[test]
fn accuracies_across_and_up_are_not_those_of_earth_fixed_places() {
    let columns = |names: [&str; 3]| {
        let names = [&["t"][..], &names, &["hAcc", "vAcc"]].concat();
        let row = |k: u32| {
            let k = f64::from(k);
            vec![k, 47.0 + 1e-5 * k, 8.0, 400.0, 1.5, 2.5]
        };
        let (_, found) = lines(&names, (0..50).map(row).collect());
        value(&found, "position_std_columns")
    };
    assert_eq!(
        columns(["lla[0]", "lla[1]", "lla[2]"]).as_deref(),
        Some("[hAcc, hAcc, vAcc]")
    );
    assert_eq!(columns(["ecef[0]", "ecef[1]", "ecef[2]"]), None);
}
