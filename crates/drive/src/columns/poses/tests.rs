use super::*;
use std::path::Path;
use undrift_io::Opened;
use undrift_io::poses::{LocalPose, PoseReader};

fn table(names: &str, row: &[f64]) -> Preview {
    let later = |k: u32| {
        let time = row.first().copied().unwrap_or(0.0) + 0.01 * f64::from(k);
        [&[time], row.get(1..).unwrap_or_default()].concat()
    };
    Preview {
        names: names
            .split(',')
            .map(|name| name.trim().to_owned())
            .collect(),
        rows: (0..10).map(later).collect(),
        ..Preview::default()
    }
}

fn named<const N: usize>(names: [&str; N]) -> [Column; N] {
    names.map(|name| Column::Name(name.to_owned()))
}

#[test]
fn names_of_many_programs() {
    use Part::*;
    let parts: [(&str, Option<Part>, Option<&str>); 58] = [
        ("x", Some(Position(0)), None),
        ("Z", Some(Position(2)), None),
        ("py", Some(Position(1)), None),
        ("tx", Some(Position(0)), None),
        ("p_x", Some(Position(0)), None),
        ("pos_x", Some(Position(0)), None),
        ("PosX", Some(Position(0)), None),
        ("posZ_mm", Some(Position(2)), Some("mm")),
        ("x_m", Some(Position(0)), Some("m")),
        ("y (mm)", Some(Position(1)), Some("mm")),
        ("X Position (m)", Some(Position(0)), Some("m")),
        ("position.x", Some(Position(0)), None),
        ("position[1]", Some(Position(1)), None),
        ("pose.position.x", Some(Position(0)), None),
        ("pose.pose.position.z", Some(Position(2)), None),
        ("field.pose.pose.position.x", Some(Position(0)), None),
        ("field.transform.translation.y", Some(Position(1)), None),
        ("/vicon/box1/pose/position/x", None, None),
        ("body1.x", Some(Position(0)), None),
        ("marker_2_z", Some(Position(2)), None),
        ("p_RS_R_x [m]", Some(Position(0)), Some("m")),
        ("qx", Some(Quaternion(0)), None),
        ("q_w", Some(Quaternion(3)), None),
        ("QuatW", Some(Quaternion(3)), None),
        ("orientation.y", Some(Quaternion(1)), None),
        ("field.pose.orientation.w", Some(Quaternion(3)), None),
        ("transform.rotation.z", Some(Quaternion(2)), None),
        ("rot_x", Some(Quaternion(0)), None),
        ("q_RS_w []", Some(Quaternion(3)), None),
        ("q0", Some(Numbered(0)), None),
        ("quat_4", Some(Numbered(4)), None),
        ("orientation[3]", Some(Numbered(3)), None),
        ("roll", Some(Angle(0)), None),
        ("yaw_deg", Some(Angle(2)), Some("deg")),
        ("pose.pitch [rad]", Some(Angle(1)), Some("rad")),
        ("std_x", Some(PositionStd(0)), None),
        ("x_std", Some(PositionStd(0)), None),
        ("pos_y_std", Some(PositionStd(1)), None),
        ("sigma_pz_mm", Some(PositionStd(2)), Some("mm")),
        ("stdy", Some(PositionStd(1)), None),
        // Other quantities, and attitudes that are those of an IMU.
        ("t", None, None),
        ("w", None, None),
        ("rx", None, None),
        ("gx", None, None),
        ("w_x", None, None),
        ("v_RS_R_x [m s^-1]", None, None),
        ("b_w_RS_S_x [rad s^-1]", None, None),
        ("field.twist.twist.linear.x", None, None),
        ("field.pose.covariance0", None, None),
        ("pose.covariance[0]", None, None),
        ("imu.orientation.x", None, None),
        ("x (deg/s)", None, None),
        ("x_g", None, None),
        ("yaw_std", None, None),
        ("quat_std_x", None, None),
        ("heading", None, None),
        ("qx (deg)", None, None),
        ("", None, None),
    ];
    for (name, expected, unit) in parts {
        let found = part(name);
        assert_eq!(found.as_ref().map(|of| of.0), expected, "{name}");
        assert_eq!(found.and_then(|of| of.1).as_deref(), unit, "{name}");
    }
}

#[test]
fn a_table_by_its_names() {
    let names = "%time,field.header.seq,field.header.stamp,field.header.frame_id,\
        field.pose.position.x,field.pose.position.y,field.pose.position.z,\
        field.pose.orientation.x,field.pose.orientation.y,field.pose.orientation.z,field.pose.orientation.w";
    let mut preview = table(
        names,
        &[
            1.4e18,
            7.0,
            1.4e18,
            f64::NAN,
            1.0,
            2.0,
            3.0,
            0.0,
            0.0,
            0.0,
            1.0,
        ],
    );
    for (k, row) in preview.rows.iter_mut().enumerate() {
        row[2] += 1e7 * k as f64;
    }
    let format = poses(&preview).unwrap();
    assert_eq!(format.time, Column::Name("field.header.stamp".to_owned()));
    assert_eq!((format.time_scale, format.position_scale), (1e-9, 1.0));
    let [x, y, z, w] = ["x", "y", "z", "w"].map(|axis| format!("field.pose.orientation.{axis}"));
    let attitude = AttitudeColumns::Quaternion {
        columns: named([&x, &y, &z, &w]),
        w_first: false,
    };
    assert_eq!(format.attitude, Some(attitude));
    assert_eq!(format.quaternion_order, QuaternionOrder::Stated);
    // In whatever order, in millimetres, with what they are good for.
    let names = "t,qw,qx,qy,qz,z_mm,y_mm,x_mm,std_x_mm,std_y_mm,std_z_mm";
    let format = poses(&table(names, &[0.0; 11])).unwrap();
    assert_eq!(format.position, Some(named(["x_mm", "y_mm", "z_mm"])));
    assert_eq!(format.position_scale, 1e-3);
    assert_eq!(
        format.position_std,
        Some(named(["std_x_mm", "std_y_mm", "std_z_mm"]))
    );
    let attitude = AttitudeColumns::Quaternion {
        columns: named(["qx", "qy", "qz", "qw"]),
        w_first: false,
    };
    assert_eq!(format.attitude, Some(attitude));
    // Uncertainties of another unit have no place.
    let format = poses(&table("t,x,y,z,std_x_mm,std_y_mm,std_z_mm", &[0.0; 7])).unwrap();
    assert_eq!((format.position_std, format.position_scale), (None, 1.0));
}

#[test]
fn quaternions_with_numbers_are_of_a_guessed_order() {
    for (names, w_first) in [("t,q0,q1,q2,q3", true), ("t,q1,q2,q3,q4", false)] {
        let format = poses(&table(names, &[0.0; 5])).unwrap();
        let columns: Vec<&str> = names.split(',').skip(1).collect();
        let columns: [&str; 4] = columns.try_into().unwrap();
        let attitude = AttitudeColumns::Quaternion {
            columns: named(columns),
            w_first,
        };
        assert_eq!(format.attitude, Some(attitude), "{names}");
        assert_eq!(format.quaternion_order, QuaternionOrder::Guessed);
    }
}

#[test]
fn units_of_angles_and_times() {
    let scale = |names: &str, yaw: f64| {
        let format = poses(&table(names, &[5.0, 0.1, 0.2, yaw])).unwrap();
        match format.attitude {
            Some(AttitudeColumns::Euler { scale, .. }) => scale,
            other => panic!("{other:?}"),
        }
    };
    let degree = 1f64.to_radians();
    assert_eq!(scale("t,roll_deg,pitch_deg,yaw_deg", 1.0), degree);
    assert_eq!(scale("t,roll_rad,pitch_rad,yaw_rad", 170.0), 1.0);
    assert_eq!(scale("t,roll,pitch,yaw", 170.0), degree);
    assert_eq!(scale("t,roll,pitch,yaw", -3.1), 1.0);
    let time = |names: &str, first: f64, step: f64| {
        let mut preview = table(names, &[first, 1.0, 2.0, 3.0]);
        for (k, row) in preview.rows.iter_mut().enumerate() {
            row[0] = first + step * k as f64;
        }
        let format = poses(&preview).unwrap();
        (format.time, format.time_scale)
    };
    let name = |name: &str| Column::Name(name.to_owned());
    assert_eq!(time("time,x,y,z", 0.0, 0.01), (name("time"), 1.0));
    assert_eq!(time("time,x,y,z", 0.0, 1.0), (name("time"), 1.0));
    assert_eq!(time("time,x,y,z", 0.0, 10.0), (name("time"), 1e-3));
    assert_eq!(time("time_ms,x,y,z", 0.0, 0.5), (name("time_ms"), 1e-3));
}

#[test]
fn what_is_not_one_pose_with_a_time_is_not_read() {
    for names in [
        "x,y,z,qx,qy,qz,qw",
        "t,x,y",
        "t,qx,qy,qz",
        "t,body1.x,body1.y,body1.z,body2.x,body2.y,body2.z",
        "t,gx,gy,gz,ax,ay,az",
    ] {
        let width = names.split(',').count();
        assert!(poses(&table(names, &vec![0.0; width])).is_none(), "{names}");
    }
    // A part that is not clear leaves the other.
    let names = "t,x,y,z,q_x,q_y,q_z,q_w,rot_x,rot_y,rot_z,rot_w";
    let format = poses(&table(names, &[0.0; 12])).unwrap();
    assert!(format.position.is_some() && format.attitude.is_none());
}

/// As `rostopic echo -p` writes it: names behind a per cent sign, and text among the numbers.
#[test]
fn a_text_of_a_topic_is_read() {
    let text = "%time,field.header.seq,field.header.stamp,field.header.frame_id,field.pose.pose.position.x,field.pose.pose.position.y,field.pose.pose.position.z,\
        field.pose.pose.orientation.x,field.pose.pose.orientation.y,field.pose.pose.orientation.z,field.pose.pose.orientation.w,field.pose.covariance0\n\
        1500000000010000000,1,1500000000000000000,odom,1.5,2.5,-0.5,0.0,0.0,0.6,0.8,0.1\n\
        1500000000110000000,2,1500000000100000000,odom,1.6,2.5,-0.5,0.0,0.0,0.6,0.8,0.1\n";
    let open = || Opened::stream(Path::new("odom.csv"), std::io::Cursor::new(text)).unwrap();
    let format = poses(&open().preview(100).unwrap()).unwrap();
    let mut reader = PoseReader::new(open(), &format.into()).unwrap();
    let read: Vec<LocalPose> = reader.by_ref().map(Result::unwrap).collect();
    assert!(reader.skipped().is_empty(), "{}", reader.skipped());
    assert_eq!(read.len(), 2);
    // The rounding of a time of 1.5e9 s is 2e-7 s.
    assert!((read[1].time - read[0].time - 0.1).abs() < 1e-6);
    assert_eq!(
        read[1].position.map(|p| [p.x, p.y, p.z]),
        Some([1.6, 2.5, -0.5])
    );
    let attitude = read[0].attitude.unwrap();
    assert_eq!([attitude.k, attitude.w], [0.6, 0.8]);
}
