use super::*;
use crate::{
    Event, Measurement, Navigator, Observer, Scalar, Summary,
    tests::{Scenario, receiver},
    vehicle::NonHolonomic,
};
use alloc::vec::Vec;
use undrift_events::{Aid, ScalarLog};
use undrift_nav::{
    attitude::from_rpy,
    covariance::{AXES, NAV},
    parameters::{Parameters, Prior},
};
use undrift_simulate::{GnssNoise, Trajectory};

fn q_vb() -> Quaternion {
    from_rpy(&Vector3::new(2.8, -0.5, 1.3))
}

/// Five minutes of a car whose sensor sits at an angle that is to be found.
fn drive(gnss: &GnssNoise, seed: u64) -> Scenario {
    let mut drive = Scenario::new(&Trajectory::car(300.0, seed), gnss, seed);
    let q_bv = q_vb().inverse();
    for sample in &mut drive.log.imu {
        sample.dtheta = q_bv * sample.dtheta;
        sample.dvel = q_bv * sample.dvel;
    }
    drive.settings.find_mounting = true;
    drive
}

/// With what is known of a car.
fn car(seed: u64) -> Scenario {
    let mut drive = drive(&receiver(), seed);
    drive.settings.constraints.non_holonomic = Some(NonHolonomic::CAR);
    drive.settings.constraints.zero_velocity = Some(0.02);
    let prior = Prior::constant(0.05);
    drive.settings.parameters = Parameters::none().with(Parameter::Mounting, prior);
    drive
}

/// Keeps the last filter that was shown.
#[derive(Default)]
struct Last(Option<Box<dyn Estimator>>);

impl Observer for Last {
    fn sample(&mut self, filter: &dyn Estimator) {
        self.0 = Some(filter.boxed());
    }
}

/// Pushes a drive; `each` sees the navigator after every sample and the filter as it was at the end of the one before.
fn push(drive: &Scenario, mut each: impl FnMut(&Navigator, &Last)) -> Navigator {
    let mut navigator = Navigator::new(drive.settings.clone());
    let mut fixes = drive.log.gnss.iter().copied().peekable();
    let mut last = Last::default();
    for (k, sample) in drive.log.imu.iter().enumerate() {
        while let Some(fix) = fixes.next_if(|fix| fix.time <= sample.time + 1e-6) {
            navigator.measure(Measurement::Gnss(fix)).unwrap();
        }
        if k % 10 == 0 {
            let truth = &drive.log.truth[k];
            let speed = truth.v_n.map_or(0.0, |v| v.norm());
            let speed = Scalar {
                time: truth.time,
                value: speed,
                std: 0.1,
            };
            // Of a time that the samples have not reached.
            if truth.time > sample.time - sample.dt {
                navigator.scalar(ScalarLog::Odometer, speed).unwrap();
            }
        }
        navigator.imu_watched(*sample, &mut last).unwrap();
        each(&navigator, &last);
    }
    navigator
}

fn end(navigator: Navigator) -> Summary {
    navigator.end(core::iter::empty(), &mut ()).unwrap()
}

#[test]
fn it_is_found_and_found_better_within_what_is_stated_of_it() {
    for seed in 1..=3 {
        let drive = drive(&receiver(), seed);
        let seen = drive.navigate();
        let mountings = &seen.summary.mountings;
        assert!(mountings.len() > 1, "seed {seed}: {mountings:?}");
        assert_eq!(seen.summary.no_mounting, None);
        for (time, found) in mountings {
            let error = (found.q_vb * q_vb().inverse()).scaled_axis();
            for axis in 0..3 {
                let std = found.std[axis];
                assert!(
                    error[axis].abs() < 3.0 * std,
                    "seed {seed}, {time} s: {error} ± {std}"
                );
            }
        }
        let (first, found) = mountings[0];
        assert!(found.std.yz().max() < USEFUL && found.duration >= 30.0);
        for pair in mountings.windows(2) {
            let [before, after] = [pair[0].1, pair[1].1];
            let doubled = after.duration >= 2.0 * before.duration;
            assert!(doubled || after.straight && !before.straight);
        }
        // The sensor's attitude before, the vehicle's from then on: to what is known of both, at 3.5 σ of three axes.
        let before = seen.at(first).error;
        assert!(Vector3::new(before[6], before[7], before[8]).norm() > 1.0);
        let (_, last) = mountings[mountings.len() - 1];
        let end = seen.last();
        for axis in 6..9 {
            let std = end.std[axis].hypot(last.std.max());
            assert!(end.error[axis].abs() < 3.5 * std, "seed {seed}: {end:?}");
        }
        let events = seen.summary.events().filter_map(|event| match event {
            Event::Mounting(time, mounting) => Some((time, mounting)),
            _ => None,
        });
        assert_eq!(&events.collect::<Vec<_>>(), mountings);
        assert!(seen.summary.contradictions.is_empty() && seen.summary.restarts.is_empty());
    }
}

#[test]
fn before_it_is_found_no_constraint_acts() {
    let drive = car(1);
    let mut found_at = None;
    let navigator = push(&drive, |navigator, _| {
        let summary = navigator.summary();
        if summary.mountings.is_empty() {
            assert_eq!(summary.innovations[Aid::NonHolonomic].updates, 0);
            assert_eq!(summary.innovations[Aid::Odometer].updates, 0);
            if let Some(filter) = navigator.filter() {
                let (value, std) = filter.parameter(Parameter::Mounting).unwrap();
                assert_eq!((value[..2].to_vec(), std[0]), ([0.0; 2].to_vec(), 0.05));
            }
        } else {
            found_at.get_or_insert(summary.ended);
        }
    });
    let summary = end(navigator);
    assert!(found_at.is_some_and(|time| time < 200.0), "{found_at:?}");
    assert!(
        summary.innovations[Aid::NonHolonomic].updates > 100
            && summary.innovations[Aid::Odometer].updates > 100
    );
    // The filter estimates the rest of it.
    assert_eq!(summary.mountings.len(), 1);
    assert!(summary.innovations[Aid::NonHolonomic].per_dof().unwrap() < 1.0);
}

#[test]
fn where_constraints_take_it_for_right_it_is_to_be_better() {
    let mut drive = car(1);
    let (found, mounting) = end(push(&drive, |_, _| ())).mountings[0];
    assert!(mounting.std.yz().max() < USEFUL);
    drive.settings.parameters = Parameters::none();
    let summary = end(push(&drive, |_, _| ()));
    let (later, better) = summary.mountings[0];
    assert!(
        later >= found && better.std.yz().max() < TRUSTED,
        "{better:?}"
    );
}

#[test]
fn what_turns_is_the_axes_and_not_the_solution() {
    let mut drive = drive(&receiver(), 2);
    drive.settings.vibration = Some([1.0; AXES]);
    let (mut turns, mut q_before) = (0, Quaternion::identity());
    push(&drive, |navigator, last| {
        let mountings = &navigator.summary().mountings;
        if mountings.len() == turns {
            return;
        }
        turns = mountings.len();
        let now = mountings[turns - 1].1.q_vb;
        let turn = now * q_before.inverse();
        q_before = now;
        let (before, after) = (last.0.as_deref().unwrap(), navigator.filter().unwrap());
        let (a, b) = (before.nav(), after.nav());
        assert_eq!((a.time, a.position, a.v_n), (b.time, b.position, b.v_n));
        assert!((a.q_nb * turn.inverse()).angle_to(&b.q_nb) < 1e-12);
        for (i, j) in (0..NAV).flat_map(|i| (0..NAV).map(move |j| (i, j))) {
            assert_eq!(before.covariance()[(i, j)], after.covariance()[(i, j)]);
        }
        for triad in [0, 3] {
            let of = |filter: &dyn Estimator| {
                Vector3::from_column_slice(&filter.sensor_error()[triad..triad + 3])
            };
            assert!((turn * of(before) - of(after)).norm() < 1e-12);
        }
    });
    assert!(turns > 1, "{turns}");
}

#[test]
fn an_antenna_away_from_the_sensor_is_taken_for_it_until_then() {
    let lever_arm = Vector3::new(1.5, -0.6, -1.2);
    let gnss = GnssNoise {
        lever_arm,
        ..receiver()
    };
    let mut drive = drive(&gnss, 3);
    drive.settings.lever_arm = lever_arm;
    let seen = drive.navigate();
    let (first, _) = seen.summary.mountings[0];
    // The antenna's position is in the sensor's place, two metres off; then the sensor's own.
    let off = |time: f64| Vector3::from_column_slice(&seen.at(time).error[..3]).norm();
    assert!(
        (off(first) - lever_arm.norm()).abs() < 0.7,
        "{}",
        off(first)
    );
    assert!(off(first + 0.1) < 0.7, "{}", off(first + 0.1));
    assert!(seen.summary.contradictions.is_empty(), "no fix is rejected");
    let (_, last) = *seen.summary.mountings.last().unwrap();
    let error = (last.q_vb * q_vb().inverse()).scaled_axis();
    assert!(
        (0..3).all(|i| error[i].abs() < 3.0 * last.std[i]),
        "{error}"
    );
}

#[test]
fn a_drive_that_ends_before_says_why() {
    let mut drive = car(1);
    let (found, _) = end(push(&drive, |_, _| ())).mountings[0];
    drive.log.imu.retain(|sample| sample.time < found - 1.0);
    let summary = end(push(&drive, |_, _| ()));
    assert!(summary.samples > 0 && summary.mountings.is_empty());
    assert_eq!(summary.innovations[Aid::NonHolonomic].updates, 0);
    assert!(
        matches!(
            summary.no_mounting,
            Some(MountingError::TooLittle { .. } | MountingError::Unsure { .. })
        ),
        "{:?}",
        summary.no_mounting
    );
}
