use super::*;
use crate::{
    Measurement,
    settings::fix_errors::FromFixes,
    tests::{Scenario, receiver},
};
use undrift_nav::{Vector3, attitude::from_rpy, parameters::Prior, shaping::ShapingFilter};
use undrift_simulate::Trajectory;

fn state(navigator: &Navigator) -> Vec<u64> {
    let mut bits = Vec::new();
    let mut filter = navigator.filter().unwrap().boxed();
    filter.numbers(&mut |number| bits.push(number.to_bits()));
    bits
}

/// A drive by car of which the fixes are to show their errors after a minute.
fn drive() -> Scenario {
    let mut drive = Scenario::new(&Trajectory::car(100.0, 1), &receiver(), 7);
    drive.settings.from_fixes = Some(FromFixes::default());
    drive.settings.vibration = Some([1.0; AXES]);
    drive.settings.parameters = drive
        .settings
        .parameters
        .with(Parameter::TimeOffset, Prior::constant(0.02));
    drive
}

/// Pushes the samples after `from` up to `until` \[s\] with the fixes, each `late` \[s\] late.
fn push(drive: &Scenario, navigator: &mut Navigator, from: f64, until: f64, late: f64) {
    let within = |time: f64| from < time && time <= until;
    let mut fixes = drive.log.gnss.iter().peekable();
    while fixes.next_if(|fix| fix.time + late <= from).is_some() {}
    for sample in drive.log.imu.iter().filter(|sample| within(sample.time)) {
        while let Some(fix) = fixes.next_if(|fix| fix.time + late <= sample.time) {
            navigator.measure(Measurement::Gnss(*fix)).unwrap();
        }
        navigator.imu(*sample).unwrap();
    }
}

#[test]
fn a_navigator_that_is_restored_goes_on_to_the_last_bit() {
    let drive = drive();
    for (horizon, late) in [(0.0, 0.0), (1.5, 0.7)] {
        let mut whole = Navigator::new(drive.settings.clone()).with_horizon(horizon);
        push(&drive, &mut whole, 0.0, 100.0, late);
        // Before the alignment, soon after, before and after the fixes have shown their errors, at the end.
        for at in [0.15, 3.33, 40.0, 75.01, 99.9] {
            let mut first = Navigator::new(drive.settings.clone()).with_horizon(horizon);
            push(&drive, &mut first, 0.0, at, late);
            let events = first.events().len();
            let kept = first.checkpoint();
            drop(first);
            let mut second = Navigator::restore(drive.settings.clone(), &kept).unwrap();
            push(&drive, &mut second, at, 100.0, late);
            assert_eq!(state(&second), state(&whole), "{at} {horizon}");
            assert_eq!(second.summary(), whole.summary(), "{at} {horizon}");
            // What was handed out before is not handed out again.
            assert_eq!(
                events + second.events().len(),
                whole.summary().events().count()
            );
        }
    }
}

#[test]
fn nor_is_the_mounting_looked_for_again() {
    let mut drive = Scenario::new(&Trajectory::car(200.0, 1), &receiver(), 1);
    let back = from_rpy(&Vector3::new(0.4, -0.3, 2.0)).inverse();
    for sample in &mut drive.log.imu {
        sample.dtheta = back * sample.dtheta;
        sample.dvel = back * sample.dvel;
    }
    drive.settings.find_mounting = true;
    drive.settings.constraints.non_holonomic = Some(crate::vehicle::NonHolonomic::CAR);
    let prior = Prior::constant(0.05);
    drive.settings.parameters = drive.settings.parameters.with(Parameter::Mounting, prior);
    drive.settings.lever_arm = Vector3::new(0.1, 0.0, 0.0);
    let mut whole = Navigator::new(drive.settings.clone());
    push(&drive, &mut whole, 0.0, 200.0, 0.0);
    let (found, _) = whole.summary().mountings[0];
    for at in [20.0, found - 1.0, found + 0.1, found + 5.0] {
        let mut first = Navigator::new(drive.settings.clone());
        push(&drive, &mut first, 0.0, at, 0.0);
        let kept = first.checkpoint();
        let mut second = Navigator::restore(drive.settings.clone(), &kept).unwrap();
        push(&drive, &mut second, at, 200.0, 0.0);
        assert_eq!(state(&second), state(&whole), "{at}");
        assert_eq!(second.summary(), whole.summary(), "{at}");
        let stated = Settings {
            find_mounting: false,
            ..drive.settings.clone()
        };
        let other = Navigator::restore(stated, &kept).err();
        assert_eq!(other, Some(RestoreError::OtherSettings));
    }
}

#[test]
fn what_is_no_checkpoint_of_this_navigator_is_refused() {
    let drive = drive();
    let mut navigator = Navigator::new(drive.settings.clone());
    push(&drive, &mut navigator, 0.0, 20.0, 0.0);
    let kept = navigator.checkpoint();
    let refused =
        |settings: &Settings, kept: &[u8]| Navigator::restore(settings.clone(), kept).err();
    assert_eq!(refused(&drive.settings, &kept), None);
    assert_eq!(
        refused(&drive.settings, &[]),
        Some(RestoreError::NoCheckpoint)
    );
    for cut in [1, 20, kept.len() / 2, kept.len() - 1] {
        assert_eq!(
            refused(&drive.settings, &kept[..cut]),
            Some(RestoreError::NoCheckpoint)
        );
    }
    let mut later = kept.clone();
    later[0] += 1;
    let other = Some(RestoreError::OtherFormat(FORMAT + 1));
    assert_eq!(refused(&drive.settings, &later), other);
    let mut damaged = kept.clone();
    damaged[kept.len() / 3] ^= 4;
    assert_eq!(
        refused(&drive.settings, &damaged),
        Some(RestoreError::NoCheckpoint)
    );
    let mut fewer = drive.settings.clone();
    fewer.parameters = Parameters::none();
    assert_eq!(refused(&fewer, &kept), Some(RestoreError::OtherSettings));
    let mut white = drive.settings.clone();
    white.sensors = [ShapingFilter::white(1e-4, 0.02).unwrap(); AXES];
    assert_eq!(refused(&white, &kept), Some(RestoreError::OtherSettings));
}
