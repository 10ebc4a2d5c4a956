//! Errors of the fixes that show while a drive goes on.

use crate::{
    Event, Navigator,
    settings::{
        Outage,
        fix_errors::{Correlation, FixErrors, FromFixes},
    },
    tests::{Scenario, receiver},
};
use alloc::vec::Vec;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use undrift_nav::{Vector3, parameters::Parameter, sample::Position};
use undrift_simulate::Trajectory;

/// Correlation time of the positions' errors \[s\], and their standard deviation \[m\].
const TIME: f64 = 20.0;
const STD: f64 = 2.0;

/// Two and a half minutes by car whose positions have lasting errors, as large as they state.
fn lasting(seed: u64) -> Scenario {
    let mut drive = Scenario::new(&Trajectory::car(150.0, 2), &receiver(), seed);
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut draw = || Vector3::from_fn(|_, _| StandardNormal.sample(&mut rng));
    let mut error: Vector3 = draw() * STD;
    let left = (-0.2f64 / TIME).exp();
    for fix in &mut drive.log.gnss {
        error = error * left + draw() * (STD * (1.0 - left * left).sqrt());
        if let Some((Position::Geodetic(at), covariance)) = &mut fix.position {
            *at = at.displaced(&error);
            *covariance += undrift_nav::Matrix3::identity() * (STD * STD);
        }
    }
    drive.settings.from_fixes = Some(FromFixes::default());
    drive
}

fn changes(drive: &Scenario) -> (Vec<(f64, FixErrors)>, Navigator) {
    let mut navigator = Navigator::new(drive.settings.clone());
    let mut fixes = drive.log.gnss.iter().peekable();
    for sample in &drive.log.imu {
        while let Some(fix) = fixes.next_if(|fix| fix.time <= sample.time) {
            navigator.fix(*fix).unwrap();
        }
        navigator.imu(*sample).unwrap();
    }
    let events = navigator.events().into_iter();
    let changes = events.filter_map(|event| match event {
        Event::FixErrors(time, errors) => Some((time, errors)),
        _ => None,
    });
    (changes.collect(), navigator)
}

#[test]
fn fixes_are_looked_at_after_one_minute_and_after_two_and_the_filter_follows() {
    let drive = lasting(3);
    let first = drive.log.gnss[0].time;
    let (changes, navigator) = changes(&drive);
    let times: Vec<f64> = changes.iter().map(|(time, _)| time - first).collect();
    assert_eq!(times.len(), 2, "{times:?}");
    assert!(
        (times[0] - 60.0).abs() < 0.21 && (times[1] - 120.0).abs() < 0.41,
        "{times:?}"
    );
    let correlated = changes[1].1.correlated.unwrap();
    assert!(correlated.share > 0.8, "{correlated:?}");
    assert!(
        correlated.time > 0.4 * TIME && correlated.time < 6.0 * TIME,
        "{correlated:?}"
    );
    let filter = navigator.filter().unwrap();
    let prior = filter.parameters().prior(Parameter::PositionError).unwrap();
    assert_eq!(prior.time, correlated.time);
    // The solution is as unsure as fixes that all err alike leave it.
    assert!(filter.nav_std()[0] > 0.3 * STD, "{}", filter.nav_std()[0]);
}

#[test]
fn what_is_stated_holds_from_the_start_and_fixes_that_are_withheld_show_nothing() {
    let mut drive = lasting(4);
    drive.settings.from_fixes = Some(FromFixes {
        correlation: Correlation::Off,
        ..FromFixes::default()
    });
    let (stated, _) = changes(&drive);
    assert!(
        stated.iter().all(|(_, errors)| errors.correlated.is_none()),
        "{stated:?}"
    );
    let mut drive = lasting(4);
    drive.settings.outages = [Outage {
        start: 30.0,
        end: 200.0,
    }]
    .into();
    let (withheld, navigator) = changes(&drive);
    assert!(withheld.is_empty());
    let summary = navigator.end(core::iter::empty(), &mut ()).unwrap();
    // Those of the first half minute, and none that was withheld.
    assert!(summary.study.is_some() && summary.withheld > 500);
}

#[test]
fn the_states_of_a_smoother_stay_the_same() {
    let mut drive = lasting(5);
    drive.settings.nodes = Some(1.0);
    let (changes, navigator) = changes(&drive);
    assert!(changes.is_empty());
    assert_eq!(navigator.filter().unwrap().parameters().states(), 0);
}

/// What shows first of two minutes by car whose positions, or their heights alone, scatter by twenty times what they state, and after
/// which time \[s\].
fn scattering(heights_alone: bool) -> (f64, FixErrors) {
    let mut drive = Scenario::new(&Trajectory::car(120.0, 2), &receiver(), 4);
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(4);
    for fix in &mut drive.log.gnss {
        if let Some((Position::Geodetic(at), covariance)) = &mut fix.position {
            let mut error = Vector3::from_fn(|_, _| StandardNormal.sample(&mut rng));
            if heights_alone {
                (error.x, error.y) = (0.0, 0.0);
            }
            let std = covariance.diagonal().map(f64::sqrt);
            *at = at.displaced(&(20.0 * error.component_mul(&std)));
        }
    }
    drive.settings.from_fixes = Some(FromFixes::default());
    let first = drive.log.gnss[0].time;
    let (changes, _) = changes(&drive);
    let (time, errors) = changes[0];
    (time - first, errors)
}

#[test]
fn scatter_beyond_what_is_stated_shows_with_eighty_fixes_height_by_itself() {
    // The median of eighty squares is good to a fifth.
    let twenty = 15.0..27.0;
    let (time, all) = scattering(false);
    assert!((10.0..20.0).contains(&time), "{time}");
    assert!(twenty.contains(&all.position_factor), "{all:?}");
    assert!(all.height_factor == 1.0 && !all.known, "{all:?}");
    let (time, heights) = scattering(true);
    assert!((10.0..20.0).contains(&time), "{time}");
    assert_eq!(heights.position_factor, 1.0, "{heights:?}");
    assert!(twenty.contains(&heights.height_factor), "{heights:?}");
}
