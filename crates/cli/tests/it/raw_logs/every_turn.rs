//! The sensor turned in every way that takes axes to axes. In the gate one car is in eight of the 24, the others in two each and
//! what flies in three; each week all are in all of them.

use super::{
    drives::{Found, How, Shared, WITHIN_DEG, angle_deg, compared, doubt, drift, inspect, scratch},
    log::Log,
    tables::degrees_and_g,
};
use std::{fs, path::PathBuf};
use undrift::nav::{Matrix3, Vector3};

/// The 24 turns that take axes to axes.
fn turns() -> Vec<Matrix3> {
    let mut turns = Vec::new();
    for order in [
        [0, 1, 2],
        [0, 2, 1],
        [1, 0, 2],
        [1, 2, 0],
        [2, 0, 1],
        [2, 1, 0],
    ] {
        for signs in 0..8 {
            let mut turn = Matrix3::zeros();
            for (row, column) in order.into_iter().enumerate() {
                turn[(row, column)] = if signs >> row & 1 == 0 { 1.0 } else { -1.0 };
            }
            if turn.determinant() > 0.0 {
                turns.push(turn);
            }
        }
    }
    turns
}

/// Inspects a drive in every `each`th turn from the `first` one on; `check` has the number of the turn, the turn, what was found and the drive file.
fn turned(
    shared: &Shared,
    (first, each): (usize, usize),
    mut check: impl FnMut(usize, &Matrix3, Found, PathBuf),
) {
    let work = scratch(&format!("turns-{}", shared.name));
    let log = shared.log();
    for (k, turn) in turns().iter().enumerate().skip(first).step_by(each) {
        let raw = Log {
            samples: log.turned(turn),
            fixes: Vec::new(),
        };
        let imu = degrees_and_g(&raw, &work).remove(0);
        let drive = work.join("drive.toml");
        let [_, gnss] = shared.files();
        let found = inspect(&[imu, gnss], shared.car, &drive);
        check(k, turn, found, drive);
    }
    fs::remove_dir_all(&work).unwrap();
}

/// The mounting of a car is found in every `each`th turn from the `first` one on, and the drift in the first of them, and in every
/// 8th after it, is that of the drive file written by hand.
fn car(name: &'static str, (first, each): (usize, usize)) {
    let Some(shared) = Shared::find(name) else {
        return;
    };
    let work = scratch(&format!("by-hand-{name}"));
    let (by_hand, model) = shared.drift_by_hand(&work);
    let truth = shared.mounting();
    turned(&shared, (first, each), |k, turn, found, drive| {
        let off = angle_deg(&found.mounting, &(truth * turn.transpose()));
        println!("{name}, turn {k}: {off:.2} deg off, by {:?}", found.how);
        assert!(off < WITHIN_DEG, "{name}, turn {k}: {off:.2} deg off");
        if (k - first) % 8 == 0 {
            let (got, wanted, n) = compared(&drift(&drive, &model, &[]), &by_hand);
            println!("drift {got:.2} m, by hand {wanted:.2} m, of {n} outages");
            assert!(
                got < 1.1 * wanted,
                "{name}, turn {k}: {got} m, by hand {wanted} m"
            );
        }
    });
    fs::remove_dir_all(&work).unwrap();
}

/// No motion shows the forward axis of what flies. Where gravity is along z that is shown and x taken as forward; else
/// the drive is refused or doubted until the axes are given.
fn aircraft(name: &'static str, which: (usize, usize)) {
    let Some(shared) = Shared::find(name) else {
        return;
    };
    turned(&shared, which, |k, turn, found, drive| {
        assert_eq!(found.how, How::Gravity, "{name}, turn {k}");
        assert!(
            found.notes.contains("assumes x forward"),
            "{name}, turn {k}: {}",
            found.notes
        );
        let down = turn * Vector3::z();
        if down.z.abs() > 0.5 {
            let off = (found.mounting * down).angle(&Vector3::z()).to_degrees();
            assert!(off < WITHIN_DEG, "{name}, turn {k}: down {off:.1} deg off");
        } else {
            let doubt = doubt(&["outages", drive.to_str().unwrap(), "--count", "5"]);
            assert!(
                doubt.contains("set imu.mounting or imu.axes"),
                "{name}, turn {k}: {doubt}"
            );
        }
    });
}

macro_rules! turns {
    ($kind:ident: $($test:ident: $name:literal, every $each:literal from $first:literal;)*) => {
        $(
            #[test]
            #[ignore = "slow: several logs"]
            fn $test() {
                $kind($name, ($first, $each));
            }
        )*
        /// Every drive in all turns.
        mod $kind {
            mod weekly {
                $(
                    #[test]
                    #[ignore = "slow: 24 logs"]
                    fn $test() {
                        super::super::$kind($name, (0, 1));
                    }
                )*
            }
        }
    };
}

turns! { car:
    rtk_drive: "rtk-drive", every 3 from 0;
    simulated: "simulated", every 12 from 0;
    long_drive: "ublox-drives/mixed-road-long-drive-nominal-001", every 12 from 1;
    parking_lot: "ublox-drives/parkinglot-maneuvers", every 12 from 2;
    stop_and_go: "ublox-drives/urban-stop-go-tight-turns-nominal-001", every 12 from 3;
    figure_of_eight: "ublox-drives-more/parking-lot-figure8-nominal-001", every 12 from 4;
    long_loop: "ublox-drives-more/urban-long-turn-loop-nominal-001", every 12 from 5;
    low_speed: "ublox-drives-more/urban-low-speed-low-signal-001", every 12 from 6;
    medium_loop: "ublox-drives-more/urban-medium-turn-loop-nominal-001", every 12 from 7;
    short_loop: "ublox-drives-more/urban-short-turn-loop-nominal-001", every 12 from 8;
    car_02: "wid-car/trial02", every 12 from 9;
    car_03: "wid-car/trial03", every 12 from 10;
    car_04: "wid-car/trial04", every 12 from 11;
    car_07: "wid-car/trial07", every 12 from 0;
    car_09: "wid-car/trial09", every 12 from 1;
    car_10: "wid-car/trial10", every 12 from 2;
}

turns! { aircraft:
    aeroplane: "uav-flight", every 8 from 0;
    quadcopter: "apm-quad/quad106", every 8 from 3;
    quadcopter_with_a_glitch: "apm-quad/f450_glitch_log", every 8 from 6;
}
