//! Hand and eye on simulated rooms with a known marker, frame and clock, and on what is wrong with poses.

use super::*;
use undrift_nav::{
    attitude::{from_rotation_vector, from_rpy},
    shaping::ShapingFilter,
};
use undrift_simulate::{GnssNoise, Pose, PoseNoise, Trajectory, simulate};

const SECONDS: f64 = 40.0;

/// What is true of the poses of [`room`].
fn truth() -> PoseNoise {
    PoseNoise {
        marker: from_rpy(&Vector3::new(0.4, -0.3, 2.0)),
        lever_arm: Vector3::new(0.1, -0.05, 0.2),
        // z up, another heading.
        frame: from_rpy(&Vector3::new(std::f64::consts::PI, 0.0, 1.0)),
        clock: 0.037,
        ..PoseNoise::default()
    }
}

/// Samples of a cheap IMU in a hand at 100 Hz, and poses at 50 Hz.
fn room(hand: &Trajectory, of: &PoseNoise) -> (Vec<ImuSample>, Vec<LocalPose>) {
    let white = |density: f64, bias: f64| {
        let constant = ShapingFilter::constant(bias, 0.01).unwrap();
        ShapingFilter::white(density, 0.01)
            .unwrap()
            .plus(&constant)
            .unwrap()
    };
    let (gyro, accel) = (white(3e-4, 0.01), white(5e-3, 0.2));
    let sensors = [gyro, gyro, gyro, accel, accel, accel];
    let log = simulate(hand, 100.0, Some(&sensors), &GnssNoise::default(), 4).unwrap();
    let seen = of.measure(log.truth.into_iter().step_by(2), &hand.start, 4);
    let pose = |Pose {
                    time,
                    position,
                    attitude,
                }| LocalPose {
        time,
        position: Some(position),
        attitude: Some(attitude),
        position_covariance: None,
        attitude_covariance: None,
    };
    (log.imu, seen.into_iter().map(pose).collect())
}

fn hand() -> Trajectory {
    Trajectory::handheld(SECONDS, 0.6, 4)
}

#[test]
fn marker_lever_arm_gravity_clock_and_noise_are_those_of_the_room() {
    let (samples, poses) = room(&hand(), &truth());
    let found = hand_eye(&samples, &poses).unwrap();
    assert_eq!(found.faults, []);
    let turned = (found.marker.inverse() * truth().marker).angle();
    assert!(
        turned < 4.0 * found.marker_std && found.marker_std < 2e-3,
        "{turned} {found:?}"
    );
    // A stamp of the samples is the end of their interval, and they hold in its middle: to a tenth of it.
    assert!((found.clock - 0.037).abs() < 1e-3, "{}", found.clock);
    let off = (found.lever_arm - truth().lever_arm).norm();
    assert!(
        off < 5.0 * found.lever_arm_std && found.lever_arm_std < 5e-3,
        "{off} {found:?}"
    );
    let down = truth().frame * Vector3::z();
    assert!(found.gravity.angle(&down) < 2e-3 && (found.gravity.norm() - 9.79).abs() < 0.02);
    // From 400 turns and positions: a tenth.
    let truth = truth();
    assert!(
        (found.position_std / truth.position_std - 1.0).abs() < 0.15,
        "{found:?}"
    );
    assert!(
        (found.attitude_std / truth.attitude_std - 1.0).abs() < 0.15,
        "{found:?}"
    );
}

#[test]
fn another_reading_of_the_same_numbers_is_found_and_said() {
    let (samples, poses) = room(&hand(), &truth());
    let right = hand_eye(&samples, &poses).unwrap();
    let w_first =
        |q: &Quaternion| Quaternion::from_quaternion(nalgebra::Quaternion::new(q.k, q.w, q.i, q.j));
    let millimetres = poses.iter().map(|pose| LocalPose {
        position: pose.position.map(|position| position * 1e3),
        ..*pose
    });
    for (fault, wrong) in [
        (PoseFault::ScalarFirst, of_each(&poses, w_first)),
        (PoseFault::Inverse, of_each(&poses, inverse)),
        (PoseFault::Unit("mm".into()), millimetres.collect()),
    ] {
        let found = hand_eye(&samples, &wrong).unwrap();
        assert_eq!(found.faults, std::slice::from_ref(&fault));
        assert!(
            (found.marker.inverse() * right.marker).angle() < 1e-3,
            "{fault:?}"
        );
        assert!(
            (found.lever_arm - right.lever_arm).norm() < 2e-3,
            "{fault:?}"
        );
        assert!(
            (found.position_std / right.position_std - 1.0).abs() < 0.05,
            "{fault:?}"
        );
    }
}

#[test]
fn the_clock_of_another_machine_is_found_wherever_it_is() {
    let (samples, poses) = room(&hand(), &truth());
    for off in [-1.7e9, -300.0, 12.0] {
        // Only the middle of it was recorded.
        let late = poses[300..1500].iter().map(|pose| LocalPose {
            time: pose.time + off,
            ..*pose
        });
        let found = hand_eye(&samples, &Vec::from_iter(late)).unwrap();
        // Of a time of 1.7e9 s a microsecond is left.
        assert!(
            (found.clock + off - 0.037).abs() < 1e-3,
            "{off}: {}",
            found.clock
        );
    }
}

#[test]
fn what_poses_lack_or_contradict_is_named() {
    let (samples, poses) = room(&hand(), &truth());
    let fault = |poses: &[LocalPose]| hand_eye(&samples, poses).unwrap_err();
    let short = fault(&poses[..100]);
    assert!(
        matches!(short, PoseFault::TooShort { duration_s } if duration_s < 3.0),
        "{short:?}"
    );
    // One axis of the positions and of the turns reversed.
    let mirrored = poses.iter().map(|pose| {
        let turn = pose.attitude.unwrap().scaled_axis();
        LocalPose {
            position: pose.position.map(|p| Vector3::new(p.x, -p.y, p.z)),
            attitude: Some(from_rotation_vector(&Vector3::new(
                -turn.x, turn.y, -turn.z,
            ))),
            ..*pose
        }
    });
    assert_eq!(fault(&Vec::from_iter(mirrored)), PoseFault::Mirrored);
    // Of another recording.
    let (_, other) = room(&Trajectory::handheld(SECONDS, 0.6, 5), &truth());
    let other = fault(&other);
    assert!(matches!(other, PoseFault::NoFit { .. }), "{other:?}");
    let wrong_unit: Vec<ImuSample> = samples
        .iter()
        .map(|sample| ImuSample {
            dtheta: sample.dtheta * 1f64.to_radians(),
            ..*sample
        })
        .collect();
    match hand_eye(&wrong_unit, &poses) {
        Err(PoseFault::GyroUnit { ratio }) => assert!((ratio / 57.3 - 1.0).abs() < 0.05, "{ratio}"),
        other => panic!("{other:?}"),
    }
    // On a turntable, and lying still.
    let table = Trajectory::constant_turn(0.0, 1.0, SECONDS);
    let (turned, seen) = room(&table, &truth());
    assert_eq!(hand_eye(&turned, &seen).unwrap_err(), PoseFault::OneAxis);
    let exact = PoseNoise {
        attitude_std: 1e-5,
        ..truth()
    };
    let (still, seen) = room(&Trajectory::rest(SECONDS), &exact);
    let still = hand_eye(&still, &seen).unwrap_err();
    assert!(matches!(still, PoseFault::Still { .. }), "{still:?}");
}
/// Over twenty hands, half of them two minutes long: errors over the standard deviations stated. The noise of a pose is in two turns with
/// opposite signs, so that the marker is known better than from turns that err by themselves.
#[test]
fn marker_and_lever_arm_are_as_good_as_stated() {
    let mut squares = [0.0; 2];
    for seed in 1..=20 {
        let seconds = if seed % 2 == 0 { 40.0 } else { 120.0 };
        let swing = 0.3 + 0.05 * (seed % 8) as f64;
        let (samples, poses) = room(&Trajectory::handheld(seconds, swing, seed), &truth());
        let found = hand_eye(&samples, &poses).unwrap();
        let turned = (found.marker.inverse() * truth().marker).angle() / found.marker_std;
        let off = (found.lever_arm - truth().lever_arm).norm() / found.lever_arm_std;
        // Of three numbers each.
        squares[0] += turned * turned / 60.0;
        squares[1] += off * off / 60.0;
    }
    let [marker, lever] = squares;
    assert!((0.1..1.3).contains(&marker), "{marker}");
    assert!((0.5..1.5).contains(&lever), "{lever}");
}

/// The room with the marker turned by `degrees` and moved by `metres` from `from` on, within `during` \[s\].
fn slipped(
    poses: &[LocalPose],
    from: f64,
    degrees: f64,
    metres: f64,
    during: f64,
) -> Vec<LocalPose> {
    let (axis, way) = (
        Vector3::new(0.3, 0.5, 0.8).normalize(),
        Vector3::new(0.6, -0.5, 0.6).normalize(),
    );
    let slipped = |pose: &LocalPose| {
        let part = match during > 0.0 {
            true => ((pose.time - from) / during).clamp(0.0, 1.0),
            false => f64::from(u8::from(pose.time >= from)),
        };
        let attitude = pose.attitude.unwrap();
        LocalPose {
            position: pose.position.map(|p| p + attitude * (way * metres * part)),
            attitude: Some(attitude * from_rotation_vector(&(axis * degrees.to_radians() * part))),
            ..*pose
        }
    };
    poses.iter().map(slipped).collect()
}

/// Two minutes, over five hands: what slips is found within its uncertainty, at its time, and what did not is not.
#[test]
fn a_marker_that_slips_is_found_with_its_time_and_amount() {
    for seed in 11..16 {
        let hand = Trajectory::handheld(120.0, 0.4 + 0.1 * (seed % 4) as f64, seed);
        let (samples, poses) = room(&hand, &truth());
        let found = |poses: &[LocalPose]| hand_eye(&samples, poses).unwrap().faults;
        assert_eq!(found(&poses), [], "{seed}");
        for (at, degrees, metres) in [
            (50.0, 5.0, 0.0),
            (50.0, 15.0, 0.01),
            (70.0, 45.0, 0.03),
            (50.0, 0.0, 0.03),
            (8.0, 15.0, 0.0),
            (112.0, 15.0, 0.0),
        ] {
            let faults = found(&slipped(&poses, at, degrees, metres, 0.0));
            let [
                PoseFault::Slipped {
                    time,
                    angle_deg,
                    distance_m,
                },
                PoseFault::Piece { start, end },
            ] = faults[..]
            else {
                panic!("{seed} {at} {degrees} {metres}: {faults:?}");
            };
            // The lever arm shows it within a second or so, the marker at once.
            let late = if degrees > 0.0 { 0.3 } else { 3.0 };
            assert!(
                (time - truth().clock - at).abs() < late,
                "{seed} {at}: {time}"
            );
            assert!(
                (angle_deg - degrees).abs() < 0.5,
                "{seed} {at}: {angle_deg}"
            );
            assert!(
                (distance_m - metres).abs() < 0.008,
                "{seed} {at}: {distance_m}"
            );
            // The longer part, without the slip.
            assert!(
                end - start > 50.0 && (end < at + late + 0.2 || start > at - late),
                "{start} {end}"
            );
        }
    }
}

/// A frame that moves is found with its time and amount, over five hands; a pose that is off alone, and a body that returns, move no frame.
#[test]
fn a_frame_that_moves_is_named() {
    for seed in 11..16 {
        let hand = Trajectory::handheld(120.0, 0.4 + 0.1 * (seed % 4) as f64, seed);
        let (samples, poses) = room(&hand, &truth());
        let moved = |by: f64, of: &dyn Fn(f64) -> bool| {
            let way = Vector3::new(0.6, -0.5, 0.6).normalize();
            let poses = poses.iter().map(|pose| LocalPose {
                position: pose
                    .position
                    .map(|p| if of(pose.time) { p + way * by } else { p }),
                ..*pose
            });
            hand_eye(&samples, &Vec::from_iter(poses)).unwrap().faults
        };
        for by in [0.05, 0.23, 2.0] {
            let faults = moved(by, &|time| time >= 50.0);
            let [
                PoseFault::Shifted { time, distance_m },
                PoseFault::Piece { start, end },
            ] = faults[..]
            else {
                panic!("{seed} {by}: {faults:?}");
            };
            assert!((time - truth().clock - 50.0).abs() < 0.2, "{seed}: {time}");
            assert!(
                (distance_m - by).abs() < 0.1 * by + 0.01,
                "{seed}: {distance_m}"
            );
            assert!(end > 110.0 && start > 49.8, "{start} {end}");
        }
        let first = poses.iter().find(|pose| pose.time >= 50.0).unwrap().time;
        assert_eq!(moved(0.23, &|time| time == first), [], "{seed}");
    }
}

#[test]
fn two_slips_and_a_slide_are_told_apart() {
    let (samples, poses) = room(&Trajectory::handheld(180.0, 0.6, 4), &truth());
    let twice = slipped(
        &slipped(&poses, 60.0, 5.0, 0.01, 0.0),
        120.0,
        10.0,
        0.02,
        0.0,
    );
    let found = hand_eye(&samples, &twice).unwrap().faults;
    let [
        PoseFault::Slipped { time: one, .. },
        PoseFault::Slipped { time: two, .. },
        PoseFault::Piece { .. },
    ] = found[..]
    else {
        panic!("{found:?}");
    };
    assert!(
        (one - 60.0).abs() < 0.3 && (two - 120.0).abs() < 0.3,
        "{one} {two}"
    );
    let slow = slipped(&poses, 40.0, 15.0, 0.03, 100.0);
    let found = hand_eye(&samples, &slow).unwrap().faults;
    let PoseFault::Slid {
        start,
        end,
        angle_deg,
    } = found[0]
    else {
        panic!("{found:?}");
    };
    assert!(
        start > 30.0 && end < 150.0 && (8.0..16.0).contains(&angle_deg),
        "{found:?}"
    );
}

#[test]
fn what_a_tracker_does_without_the_marker_is_no_slip() {
    let (samples, poses) = room(&Trajectory::handheld(120.0, 0.6, 4), &truth());
    let changed = |change: &dyn Fn(&LocalPose) -> Option<LocalPose>| {
        let changed = poses.iter().map(|pose| change(pose).unwrap_or(*pose));
        Vec::from_iter(changed)
    };
    let right = hand_eye(&samples, &poses).unwrap();
    let turn = from_rpy(&Vector3::new(0.0, 0.0, 0.7));
    // Another body for six seconds.
    let other = changed(&|pose| {
        (50.0..56.0).contains(&pose.time).then(|| LocalPose {
            position: pose.position.map(|p| p + Vector3::new(1.0, 0.5, 0.3)),
            attitude: pose
                .attitude
                .map(|q| turn * q * from_rpy(&Vector3::new(1.0, 0.0, 1.3))),
            ..*pose
        })
    });
    let found = hand_eye(&samples, &other).unwrap();
    let [
        PoseFault::Jumped {
            time,
            end,
            lasting: false,
            ..
        },
    ] = found.faults[..]
    else {
        panic!("{:?}", found.faults);
    };
    assert!(
        (time - 50.0).abs() < 0.2 && (end - 56.0).abs() < 0.2,
        "{time} {end}"
    );
    // The frame turns and stays so.
    let frame = changed(&|pose| {
        (pose.time > 50.0).then(|| LocalPose {
            position: pose
                .position
                .map(|p| turn * p + Vector3::new(0.5, 0.0, 0.0)),
            attitude: pose.attitude.map(|q| turn * q),
            ..*pose
        })
    });
    let found = hand_eye(&samples, &frame).unwrap();
    let [
        PoseFault::Jumped {
            time,
            angle_deg,
            lasting: true,
            ..
        },
        PoseFault::Piece { .. },
    ] = found.faults[..]
    else {
        panic!("{:?}", found.faults);
    };
    assert!(
        (time - 50.0).abs() < 0.2 && (angle_deg - 40.1).abs() < 1.0,
        "{time} {angle_deg}"
    );
    // Each seventeen seconds lost for one and a half.
    let mut last = poses[0];
    let frozen = poses.iter().map(|pose| {
        let lost = pose.time % 17.0 < 1.5;
        last = if lost { last } else { *pose };
        LocalPose {
            time: pose.time,
            ..last
        }
    });
    let found = hand_eye(&samples, &Vec::from_iter(frozen)).unwrap();
    assert!(
        matches!(
            found.faults[..],
            [PoseFault::Frozen {
                poses: 400..=600,
                ..
            }]
        ),
        "{:?}",
        found.faults
    );
    assert!((found.marker.inverse() * right.marker).angle() < 1e-3);
    assert!((found.lever_arm - right.lever_arm).norm() < 3e-3);
}

#[test]
fn another_rate_and_other_axes_of_the_positions_are_named() {
    let (samples, poses) = room(&Trajectory::handheld(120.0, 0.6, 4), &truth());
    let fault = |poses: Vec<LocalPose>| hand_eye(&samples, &poses).unwrap_err();
    for ratio in [0.97, 1.02] {
        let of = poses.iter().map(|pose| LocalPose {
            time: ratio * pose.time,
            ..*pose
        });
        match fault(of.collect()) {
            PoseFault::Rate { ratio: found } => {
                assert!((found / ratio - 1.0).abs() < 1e-3, "{found}")
            }
            other => panic!("{other:?}"),
        }
    }
    let axes = |of: [i8; 3]| {
        let axis =
            |p: Vector3, of: i8| f64::from(of.signum()) * p[usize::from(of.unsigned_abs()) - 1];
        let turned = poses.iter().map(move |pose| LocalPose {
            position: pose
                .position
                .map(|p| Vector3::from(of.map(|of| axis(p, of)))),
            ..*pose
        });
        Vec::from_iter(turned)
    };
    // What has to be done to them, which is the inverse.
    assert_eq!(fault(axes([1, -2, 3])), PoseFault::PositionAxes([1, -2, 3]));
    assert_eq!(fault(axes([1, 3, -2])), PoseFault::PositionAxes([1, -3, 2]));
    let still = poses.iter().map(|pose| LocalPose {
        position: Some(Vector3::zeros()),
        ..*pose
    });
    assert_eq!(fault(still.collect()), PoseFault::NoPositions);
    // By turns alone they would be quaternions with w first in other axes.
    let begun = from_rpy(&Vector3::new(2.8, 0.4, -0.6));
    let turned = |pose: &LocalPose| LocalPose {
        position: pose.position.map(|p| begun * p),
        attitude: pose.attitude.map(|q| (begun * q).inverse()),
        ..*pose
    };
    let found = hand_eye(&samples, &Vec::from_iter(poses.iter().map(turned))).unwrap();
    assert_eq!(found.faults, [PoseFault::Inverse]);
}
