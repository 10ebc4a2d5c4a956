//! The sensor turned in every way that takes axes to axes.

use super::{
    drives::{Shared, WITHIN_DEG, angle_deg, compared, drift, inspect, scratch},
    log::Log,
    tables::degrees_and_g,
};
use std::fs;
use undrift::nav::Matrix3;

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

/// Inspects a drive in every `each`th turn; the drift of every 8th is that of the drive file written by hand.
fn turned(name: &'static str, each: usize) {
    let Some(shared) = Shared::find(name) else {
        return;
    };
    let work = scratch(&format!("turns-{name}"));
    let (log, truth) = (shared.log(), shared.mounting());
    let (by_hand, model) = shared.drift_by_hand(&work);
    for (k, turn) in turns().iter().enumerate().step_by(each) {
        let raw = Log {
            samples: log.turned(turn),
            fixes: Vec::new(),
        };
        let imu = degrees_and_g(&raw, &work).remove(0);
        let drive = work.join(format!("{k}.toml"));
        let [_, gnss] = shared.files();
        let found = inspect(&[imu, gnss], shared.car, &drive);
        let off = angle_deg(&found.mounting, &(truth * turn.transpose()));
        println!("{name}, turn {k}: {off:.2} deg off, by {:?}", found.how);
        assert!(off < WITHIN_DEG, "{name}, turn {k}: {off:.2} deg off");
        if k % 8 == 0 {
            let (got, wanted, n) = compared(&drift(&drive, &model, &[]), &by_hand);
            println!("drift {got:.2} m, by hand {wanted:.2} m, of {n} outages");
            assert!(got < 1.1 * wanted, "{name}, turn {k}: {got} m, by hand {wanted} m");
        }
    }
    fs::remove_dir_all(&work).unwrap();
}

#[test]
#[ignore = "slow: 24 logs"]
fn every_turn_of_the_sensor_in_a_car() {
    turned("rtk-drive", 1);
}
