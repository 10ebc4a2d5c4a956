//! Poses in the place of fixes: rows of TUM, and messages of ROS 2.

use super::*;
use undrift_io::write::mcap::Stream;
use undrift_simulate::PoseNoise;

const ROOM: &str = r#"
model = "mpu6050"
[imu]
file = "imu.csv"
time = "t"
gyro = ["gx", "gy", "gz"]
gyro_unit = "rad/s"
accel = ["fx", "fy", "fz"]
accel_unit = "m/s2"
[poses]
file = "poses.txt"
position_std = "1 mm"
attitude_std = "0.1 deg"
time_offset = "0.02 s"
marker = "11.5, -5.7, 86 deg"
lever_arm = "0.05, 0.02, -0.1 m"
"#;

fn logs() -> Vec<(String, usize)> {
    vec![("imu".into(), 0), ("poses".into(), 1)]
}

/// A minute in a hand at 50 Hz, poses ten times a second as TUM writes them.
fn room() -> (tempfile::TempDir, Vec<undrift_simulate::Pose>) {
    let model = undrift_noise::ImuModel::preset("mpu6050").unwrap();
    let filters = model.shaping(BiasModel::GaussMarkov, 0.02).unwrap();
    let hand = Trajectory::handheld(60.0, 0.6, 5);
    let log = simulate(&hand, 50.0, Some(&filters), &GnssNoise::default(), 5).unwrap();
    let seen = PoseNoise {
        marker: undrift_nav::attitude::from_rpy(&undrift_nav::Vector3::new(0.2, -0.1, 1.5)),
        lever_arm: undrift_nav::Vector3::new(0.05, 0.02, -0.1),
        clock: 0.02,
        ..PoseNoise::default()
    };
    let poses = seen.measure(log.truth.iter().copied().step_by(5), &hand.start, 5);
    let mut tum = String::new();
    for pose in &poses {
        let (p, q) = (pose.position, pose.attitude);
        writeln!(
            tum,
            "{} {} {} {} {} {} {} {}",
            pose.time, p.x, p.y, p.z, q.i, q.j, q.k, q.w
        )
        .unwrap();
    }
    let folder = written([
        ("imu.csv", &imu_rows(&log.imu)),
        ("poses.txt", &tum),
        ("drive.toml", ROOM),
    ]);
    (folder, poses)
}

#[test]
fn the_solution_of_poses_is_that_of_the_replay_whatever_carries_them() {
    let (folder, poses) = room();
    let drive = Drive::load(&folder.path().join("drive.toml"), None).unwrap();
    let expected = replayed(&drive);
    let bytes = ["imu.csv", "poses.txt"]
        .map(|name| std::fs::read(folder.path().join(name)).unwrap().into());
    let lines = replay::arrivals(&drive, &bytes, &logs()).unwrap();
    let new = |text: &str| {
        let home = folder.path();
        Session::new(text, "drive.toml", home, logs(), Options::default()).unwrap()
    };
    let mut live = new(ROOM);
    let seen = run(&mut live, &lines);
    assert_near(&end(&live), &expected);
    assert!(seen.rows.len() > 2900, "{}", seen.rows.len());
    // Before the first pose and in the second that it takes to see how late they are.
    assert!(seen.without < 100, "{}", seen.without);
    assert_eq!(live.navigator().unwrap().too_late(), 0);

    // The same as a topic of PoseStamped.
    let declared = Stream::default().topic("/pose", "geometry_msgs/msg/PoseStamped");
    let mut at = 0;
    let mut seen = poses.iter();
    let mut topic = vec![Arrival {
        source: 1,
        at: lines[0].at,
        bytes: [Stream::head(), declared.1].concat(),
    }];
    for line in lines {
        if line.source == 0 {
            topic.push(line);
            continue;
        }
        // A line each, as its bytes say.
        at += line.bytes.iter().filter(|byte| **byte == b'\n').count();
        while seen.len() > poses.len() - at {
            let pose = seen.next().unwrap();
            let mut bytes = ros::begun(pose.time);
            bytes.extend([0; 3]);
            ros::numbers(&mut bytes, pose.position.as_slice());
            ros::numbers(&mut bytes, pose.attitude.coords.as_slice());
            topic.push(Arrival {
                bytes: Stream::message(0, 1, &bytes),
                ..line.clone()
            });
        }
    }
    let text = ROOM.replace(
        "file = \"poses.txt\"",
        "file = \"ros2:/pose\"\nformat = \"mcap\"",
    );
    let mut live = new(&text);
    run(&mut live, &topic);
    let (topic, lines) = (end(&live), expected);
    // Stamps of messages count from 1970, in milliseconds here, and those of the samples from 0: the clocks are compared.
    assert_eq!(topic.time, lines.time);
    assert!(topic.q_nb.angle_to(&lines.q_nb) < 0.02);
    assert!((topic.position.height - lines.position.height).abs() < 0.1);
}
