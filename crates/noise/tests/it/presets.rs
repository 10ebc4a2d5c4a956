//! The presets: their numbers, and where each is from.

use undrift_nav::{
    earth::STANDARD_GRAVITY as G,
    units::{Quantity, unit_factor},
};
use undrift_noise::{AxisModel, ImuModel, presets};

#[test]
fn names_are_sorted_and_unique_and_those_of_the_files() {
    assert!(presets::NAMES.is_sorted_by(|a, b| a < b));
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/presets");
    let mut files: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned())
        .collect();
    files.sort();
    assert_eq!(files, presets::NAMES);
    assert_eq!(ImuModel::preset_names(), presets::NAMES);
    assert!(presets::text("adis").is_none() && ImuModel::preset("adis").is_none());
}

#[test]
fn each_number_is_in_the_source() {
    for name in presets::NAMES {
        let model = ImuModel::preset(name).unwrap_or_else(|| panic!("{name} cannot be read"));
        assert!(
            model.source.contains("assumed"),
            "{name}: no data sheet has correlation times"
        );
        let file: toml::Table = toml::from_str(presets::text(name).unwrap()).unwrap();
        let mut numbers = 0;
        for (axes, terms) in file
            .iter()
            .filter_map(|(key, of)| Some((key, of.as_table()?)))
        {
            for (key, number) in terms {
                let number = number.as_str().unwrap();
                // As a number of its own, not the end of a longer one.
                let stated = model.source.match_indices(number).any(|(at, _)| {
                    !model.source[..at].ends_with(|c: char| c.is_ascii_digit() || c == '.')
                });
                // An assumed or rounded number, too, is stated with its unit.
                assert!(
                    stated,
                    "{name}: {axes}.{key} = {number} is not in its source"
                );
                numbers += 1;
            }
        }
        assert!(numbers >= 8, "{name}: {numbers} numbers");
    }
}

/// Least and largest of a term, in the unit.
type Range = (f64, f64);

/// What sensors of a class have, gyro and accelerometer: white noise [deg/√h, µg/√Hz], bias instability [deg/h, mg] and
/// turn-on [deg/s, mg]. Wide enough for all parts of the class that data sheets were seen of, narrow enough that a
/// mistaken unit (60 between √h and √s, 1000 between mg and µg) falls out.
struct Class {
    gyro: [Range; 3],
    accel: [Range; 3],
}

/// Single chips of phones, drones and cars.
const CHIP: Class = Class {
    gyro: [(0.15, 1.0), (1.0, 30.0), (0.3, 20.0)],
    accel: [(50.0, 500.0), (0.02, 0.2), (5.0, 100.0)],
};
/// Modules calibrated in the factory.
const MODULE: Class = Class {
    gyro: [(0.1, 2.1), (1.0, 30.0), (0.1, 3.1)],
    accel: [(15.0, 400.0), (0.003, 0.25), (1.0, 60.0)],
};

#[test]
fn numbers_are_those_of_their_class() {
    let units = [
        [
            ("deg/√h", Quantity::AngleRandomWalk),
            ("µg/√Hz", Quantity::VelocityRandomWalk),
        ],
        [
            ("deg/h", Quantity::AngularRate),
            ("mg", Quantity::Acceleration),
        ],
        [
            ("deg/s", Quantity::AngularRate),
            ("mg", Quantity::Acceleration),
        ],
    ];
    let terms: [fn(&AxisModel) -> f64; 3] = [
        |axis| axis.white.unwrap(),
        |axis| axis.instability[0].sigma,
        |axis| axis.turn_on,
    ];
    for name in presets::NAMES {
        let model = ImuModel::preset(name).unwrap();
        let is_module = ["adis", "imx", "mti", "vn"]
            .iter()
            .any(|start| name.starts_with(start));
        let class = if is_module { MODULE } else { CHIP };
        for (axis, of) in model.axes() {
            let accel = usize::from(axis.starts_with("accel"));
            let ranges = [class.gyro, class.accel][accel];
            for ((term, (least, largest)), units) in terms.iter().zip(ranges).zip(units) {
                let (unit, quantity) = units[accel];
                let value = term(of) / unit_factor(unit, quantity).unwrap();
                assert!(
                    (least..=largest).contains(&value),
                    "{name}: {axis}: {value} {unit}"
                );
            }
            assert!(
                (30.0..=3600.0).contains(&of.instability[0].tau_s),
                "{name}: {axis}"
            );
        }
    }
}

#[test]
fn the_adis16405_has_the_table_of_the_source_paper() {
    let degree = 1f64.to_radians();
    let model = ImuModel::preset("adis16405").unwrap();
    for (gyro, accel) in model.gyro.iter().zip(&model.accel) {
        for (ours, table) in [
            (gyro.turn_on, 3.0 * degree),
            (gyro.instability[0].sigma, 0.007 * degree),
            (gyro.white.unwrap(), 2.0 * degree / 60.0),
            (accel.turn_on, 0.05 * G),
            (accel.instability[0].sigma, 2e-4 * G),
            (accel.white.unwrap(), 0.2 / 60.0),
        ] {
            assert!((ours / table - 1.0).abs() < 1e-14, "{ours} {table}");
        }
    }
}

#[test]
fn the_page_has_every_preset() {
    let page = include_str!("../../../../docs/imu-file.md");
    let (_, after) = page.split_once("\n## Presets\n").unwrap();
    let section = after.split("\n## ").next().unwrap();
    let rows: Vec<_> = section
        .lines()
        .filter_map(|line| line.strip_prefix("| `")?.split('`').next())
        .collect();
    assert_eq!(rows, presets::NAMES);
}
