use super::*;
use crate::tests::{Scenario, receiver};
use alloc::vec::Vec;
use nalgebra::DMatrix;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use undrift_events::Aid;
use undrift_nav::{Vector3, parameters::Prior};
use undrift_simulate::Trajectory;

/// Every number of the filter, to the bit.
#[derive(Debug, PartialEq)]
struct State(Vec<u64>);

fn state(navigator: &Navigator) -> Option<State> {
    let mut bits = Vec::new();
    let mut filter = navigator.filter()?.boxed();
    filter.numbers(&mut |number| bits.push(number.to_bits()));
    Some(State(bits))
}

/// A drive whose receiver stamps fixes late, with wheel speeds.
fn drive() -> (Scenario, Vec<Measurement>) {
    let mut drive = Scenario::new(&Trajectory::constant_turn(10.0, 0.1, 30.0), &receiver(), 5);
    drive.settings.parameters = drive
        .settings
        .parameters
        .with(Parameter::TimeOffset, Prior::constant(0.05));
    drive.settings.constraints.odometer_lever = Vector3::zeros();
    let fixes = drive.log.gnss.iter().copied().map(Measurement::Gnss);
    let speeds = (1..300).map(|k| {
        Measurement::Odometer(Scalar {
            time: 0.1 * f64::from(k),
            value: 10.0,
            std: 0.1,
        })
    });
    let mut all: Vec<_> = fixes.chain(speeds).collect();
    all.sort_by(|a, b| a.time().total_cmp(&b.time()));
    (drive, all)
}

/// The states at the ends of whole seconds, by when each measurement arrives, and how many came too late.
fn navigate(
    drive: &Scenario,
    measurements: &[(f64, Measurement)],
    horizon: f64,
) -> (Vec<Option<State>>, u64) {
    let mut navigator = Navigator::new(drive.settings.clone()).with_horizon(horizon);
    let mut arriving = measurements.iter().peekable();
    let mut states = Vec::new();
    for sample in &drive.log.imu {
        let until = sample.time + navigator.ahead();
        while let Some((_, measurement)) = arriving.next_if(|(arrival, _)| *arrival <= until) {
            navigator.measure(*measurement).unwrap();
        }
        navigator.imu(*sample).unwrap();
        if sample.time == sample.time.round() {
            states.push(state(&navigator));
        }
    }
    // What came after the last sample.
    for (_, measurement) in arriving {
        navigator.measure(*measurement).unwrap();
    }
    states.push(state(&navigator));
    (states, navigator.too_late())
}

fn shuffled(all: &[Measurement], most: f64, seed: u64) -> Vec<(f64, Measurement)> {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut late: Vec<_> = all
        .iter()
        .map(|m| (m.time() + most * rng.random::<f64>(), *m))
        .collect();
    late.sort_by(|a, b| a.0.total_cmp(&b.0));
    late
}

#[test]
fn arrivals_in_any_order_within_the_horizon_give_the_same_state_to_the_last_bit() {
    let (drive, all) = drive();
    let (in_order, _) = navigate(&drive, &shuffled(&all, 0.0, 1), 0.0);
    let expected = in_order.last().unwrap();
    assert!(expected.is_some(), "navigated");
    for seed in 1..=3 {
        let (late, too_late) = navigate(&drive, &shuffled(&all, 2.0, seed), 2.5);
        assert_eq!(too_late, 0);
        assert_eq!(late.last().unwrap(), expected, "seed {seed}");
        // Not by chance: on the way the late ones were missing.
        assert_ne!(late[20], in_order[20], "seed {seed}");
    }
}

#[test]
fn nor_does_the_order_matter_where_the_mounting_is_found_on_the_way() {
    let mut drive = Scenario::new(&Trajectory::car(200.0, 1), &receiver(), 1);
    let back = undrift_nav::attitude::from_rpy(&Vector3::new(0.4, -0.3, 2.0)).inverse();
    for sample in &mut drive.log.imu {
        sample.dtheta = back * sample.dtheta;
        sample.dvel = back * sample.dvel;
    }
    drive.settings.find_mounting = true;
    drive.settings.constraints.non_holonomic = Some(crate::vehicle::NonHolonomic::CAR);
    let prior = Prior::constant(0.05);
    drive.settings.parameters = drive.settings.parameters.with(Parameter::Mounting, prior);
    let all = Measurement::from_fixes(&drive.log.gnss);
    let found = |horizon: f64, arrivals: &[(f64, Measurement)]| {
        let mut navigator = Navigator::new(drive.settings.clone()).with_horizon(horizon);
        let mut arriving = arrivals.iter().peekable();
        let mut handed_out = 0;
        for sample in &drive.log.imu {
            while let Some((_, m)) = arriving.next_if(|(at, _)| *at <= sample.time) {
                navigator.measure(*m).unwrap();
            }
            navigator.imu(*sample).unwrap();
            let events = navigator.events();
            handed_out += events
                .iter()
                .filter(|event| matches!(event, Event::Mounting(..)))
                .count();
        }
        arriving.for_each(|(_, m)| assert!(navigator.measure(*m).unwrap()));
        let mountings = navigator.summary().mountings.clone();
        (state(&navigator), mountings, handed_out)
    };
    let expected = found(0.0, &shuffled(&all, 0.0, 1));
    assert_eq!((expected.1.len(), expected.2), (1, 1), "found, and once");
    for seed in 1..=2 {
        let late = found(2.5, &shuffled(&all, 2.0, seed));
        assert_eq!((&late.0, &late.1), (&expected.0, &expected.1), "{seed}");
    }
}

#[test]
fn what_is_later_than_the_horizon_is_counted_and_does_no_harm() {
    let (drive, all) = drive();
    let mut late = shuffled(&all, 0.0, 1);
    // One fix of the middle comes three seconds late.
    let at = late
        .iter()
        .position(|(time, m)| *time > 15.0 && matches!(m, Measurement::Gnss(_)));
    let mut one = late.remove(at.unwrap());
    let (without, _) = navigate(&drive, &late, 0.0);
    one.0 += 3.0;
    let place = late.iter().position(|(time, _)| *time > one.0).unwrap();
    late.insert(place, one);
    for horizon in [0.0, 2.0] {
        let (states, too_late) = navigate(&drive, &late, horizon);
        assert_eq!((too_late, states.last()), (1, without.last()), "{horizon}");
    }
    // Reported once.
    let mut navigator = Navigator::new(drive.settings.clone());
    navigator.imu(drive.log.imu[20]).unwrap();
    navigator.imu(drive.log.imu[21]).unwrap();
    let early = drive.log.gnss[0];
    assert!(!navigator.fix(early).unwrap());
    assert_eq!(navigator.events(), [Event::TooLate(early.time)]);
    assert!(navigator.events().is_empty());
    let (states, too_late) = navigate(&drive, &late, 4.0);
    assert_eq!(too_late, 0);
    assert_ne!(states.last(), without.last());
}

#[test]
fn memory_does_not_grow_with_the_drive() {
    let (drive, all) = drive();
    let mut navigator = Navigator::new(drive.settings.clone()).with_horizon(1.0);
    let mut arriving = all.iter().peekable();
    for sample in &drive.log.imu {
        while let Some(measurement) = arriving.next_if(|m| m.time() <= sample.time) {
            navigator.measure(*measurement).unwrap();
        }
        navigator.imu(*sample).unwrap();
        // A second, a snapshot before it, and one sample more each.
        assert!(navigator.past.len() <= 8 && navigator.samples.len() <= 80);
        assert!(navigator.measured.len() <= 40);
    }
}

#[test]
fn what_is_no_sample_or_measurement_is_refused_and_changes_nothing() {
    let (drive, all) = drive();
    let mut navigator = Navigator::new(drive.settings.clone());
    let sample = drive.log.imu[0];
    navigator.imu(sample).unwrap();
    let not_in_order = PushError::NotInOrder {
        time: sample.time,
        before: sample.time,
    };
    assert_eq!(navigator.imu(sample), Err(not_in_order));
    for change in [
        |s: &mut ImuSample| s.dt = 0.0,
        |s: &mut ImuSample| s.dtheta.x = f64::NAN,
        |s: &mut ImuSample| s.dvel.z = f64::INFINITY,
        |s: &mut ImuSample| s.time = f64::NAN,
    ] {
        let mut broken = drive.log.imu[1];
        change(&mut broken);
        let refused = navigator.imu(broken);
        assert!(
            matches!(refused, Err(PushError::NotFinite { .. })),
            "{refused:?}"
        );
    }
    let Some(Measurement::Gnss(fix)) = all.iter().find(|m| matches!(m, Measurement::Gnss(_)))
    else {
        panic!("no fix");
    };
    let mut broken = *fix;
    broken.velocity.as_mut().unwrap().1 = DMatrix::from_element(3, 3, f64::NAN)
        .fixed_view::<3, 3>(0, 0)
        .into();
    assert!(navigator.fix(broken).is_err());
    let height = Scalar {
        time: 1.0,
        value: f64::NAN,
        std: 1.0,
    };
    let mut refused = |sensor| navigator.scalar(sensor, height).is_err();
    assert!(ScalarLog::ALL.into_iter().all(&mut refused));
    assert_eq!(navigator.measured.len(), 0);
    navigator.imu(drive.log.imu[1]).unwrap();
}

#[test]
fn events_are_handed_out_once_in_order_of_time() {
    let (mut drive, all) = drive();
    // Positions half a kilometre off for two seconds.
    drive = drive.alter(20.0, 22.0, |fix| {
        if let Some((undrift_nav::sample::Position::Geodetic(place), _)) = &mut fix.position {
            place.height += 500.0;
        }
    });
    let speeds = all.iter().filter(|m| !matches!(m, Measurement::Gnss(_)));
    let fixes = drive.log.gnss.iter().copied().map(Measurement::Gnss);
    let mut all: Vec<_> = fixes.chain(speeds.copied()).collect();
    all.sort_by(|a, b| a.time().total_cmp(&b.time()));
    for (late, horizon) in [(0.0, 0.0), (1.0, 1.5)] {
        let mut navigator = Navigator::new(drive.settings.clone()).with_horizon(horizon);
        let arrivals = shuffled(&all, late, 3);
        let mut arriving = arrivals.iter().peekable();
        let mut events = Vec::new();
        for sample in &drive.log.imu {
            while let Some((_, m)) = arriving.next_if(|(at, _)| *at <= sample.time) {
                navigator.measure(*m).unwrap();
            }
            navigator.imu(*sample).unwrap();
            events.extend(navigator.events());
        }
        let kinds: Vec<_> = events
            .iter()
            .map(|event| match event {
                Event::Started(..) => "started",
                Event::Rejected(fixes) => {
                    assert!((fixes.largest - 500.0).abs() < 20.0, "{fixes:?}");
                    "rejected"
                }
                _ => "other",
            })
            .collect();
        assert_eq!(kinds, ["started", "rejected"], "{events:?}");
        assert!(navigator.events().is_empty());
    }
}

#[test]
fn the_summary_counts_what_was_pushed() {
    let (drive, all) = drive();
    let mut navigator = Navigator::new(drive.settings.clone());
    let mut arriving = all.iter().peekable();
    let (mut fixes, mut speeds) = (0, 0);
    for sample in &drive.log.imu {
        let until = sample.time + navigator.ahead();
        while let Some(measurement) = arriving.next_if(|m| m.time() <= until) {
            navigator.measure(*measurement).unwrap();
            match measurement {
                Measurement::Gnss(_) => fixes += 1,
                _ => speeds += 1,
            }
        }
        navigator.imu(*sample).unwrap();
    }
    let summary = navigator.summary();
    let samples = drive.log.imu.len() as u64;
    // The last one waits for the next.
    assert_eq!(summary.samples + summary.align_samples + 1, samples);
    // All but the first few, from which it starts, and those still to come.
    assert!(
        summary.fixes + 3 > fixes && summary.fixes <= fixes,
        "{fixes}: {summary:?}"
    );
    let updates = summary.innovations[Aid::Odometer].updates;
    assert!(
        updates + 5 > speeds && updates <= speeds,
        "{speeds}: {updates}"
    );
}
