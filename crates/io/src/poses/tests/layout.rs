//! Files whose columns are known.

use super::*;
use crate::skipped::SkipKind;

/// How a text is read, and what it gives.
fn detected(text: &str, stream: Option<&str>) -> Result<Option<PoseSource>, ReadError> {
    let stream_of = Cursor::new(text.as_bytes().to_vec());
    let mut opened = Opened::stream(Path::new("poses.txt"), stream_of)?;
    detect(&mut opened, stream)
}

fn format(text: &str) -> PoseFormat {
    match detected(text, None).unwrap() {
        Some(PoseSource::Table(format)) => *format,
        other => panic!("{other:?} of {text}"),
    }
}

fn order(text: &str) -> (bool, QuaternionOrder) {
    let format = format(text);
    match format.attitude {
        Some(AttitudeColumns::Quaternion { w_first, .. }) => (w_first, format.quaternion_order),
        other => panic!("{other:?}"),
    }
}

/// Rows of a turn about z: time, position, and the quaternion x, y, z, w or w, x, y, z; `from` and `to` are half of the
/// angle \[rad\].
fn turning(w_first: bool, from: f64, to: f64, positive: bool) -> String {
    let row = |k: u32| {
        let half = from + (to - from) * f64::from(k) / 50.0;
        let (sin, cos) = half.sin_cos();
        let sign = if positive { cos.signum() } else { 1.0 };
        let (z, w) = (sign * sin, sign * cos);
        let quaternion = match w_first {
            true => format!("{w:.6} 0.000000 0.000000 {z:.6}"),
            false => format!("0.000000 0.000000 {z:.6} {w:.6}"),
        };
        format!("{:.2} {}.5 2.0 -1.0 {quaternion}\n", 0.05 * f64::from(k), k)
    };
    (0..=50).map(row).collect()
}

#[test]
fn units_in_brackets_hold_for_a_known_layout_too() {
    let rows = turning(false, 0.5, 2.6, false).replace(' ', ",");
    let scales = |header: &str| {
        let format = format(&format!("{header}\n{rows}"));
        (format.time_scale, format.position_scale)
    };
    let ms = "timestamp [ms],p_x [mm],p_y [mm],p_z [mm],qx,qy,qz,qw";
    assert_eq!(scales(ms), (1e-3, 1e-3));
    assert_eq!(
        scales("timestamp (ns),p_x,p_y,p_z,qx,qy,qz,qw"),
        (1e-9, 1.0)
    );
    assert_eq!(scales("timestamp [#],p_x,p_y,p_z,qx,qy,qz,qw"), (1.0, 1.0));
}

#[test]
fn tum_with_the_quaternion_in_the_order_of_its_header_or_of_the_numbers() {
    let rows = turning(false, 0.5, 2.6, false);
    let header = "# ground truth trajectory\n# timestamp tx ty tz qx qy qz qw\n";
    assert_eq!(
        order(&format!("{header}{rows}")),
        (false, QuaternionOrder::Stated)
    );
    let first = turning(true, 0.5, 2.6, false);
    let header = "# time x y z qw qx qy qz\n";
    assert_eq!(
        order(&format!("{header}{first}")),
        (true, QuaternionOrder::Stated)
    );
    // As a table.
    let commas = format!(
        "timestamp,p_x,p_y,p_z,q_x,q_y,q_z,q_w\n{}",
        rows.replace(' ', ",")
    );
    assert_eq!(order(&commas), (false, QuaternionOrder::Stated));
    // A header that names the four without saying.
    let numbered = format!("# t x y z q1 q2 q3 q4\n{rows}");
    assert_eq!(order(&numbered), (false, QuaternionOrder::Guessed));
    for (w_first, from, to, positive, found) in [
        // A full turn, w not negative by choice of the sign.
        (true, 0.4, 3.5, true, true),
        (false, 0.4, 3.5, true, false),
        // Beginning at the frame's axes.
        (true, 0.0, 1.0, false, true),
        (false, 0.0, 1.0, false, false),
        // Nothing shows it: the order of TUM.
        (true, 0.5, 2.6, false, false),
        (false, 0.5, 2.6, false, false),
        // Beginning half a turn about x, which looks like w = 1 in front, but w is the one never negative.
    ] {
        let text = turning(w_first, from, to, positive);
        assert_eq!(order(&text), (found, QuaternionOrder::Guessed), "{text}");
    }
    let flipped =
        "0 0 0 0 1 0 0 0\n1 0 0 0 -0.8 0 0 0.6\n2 0 0 0 -0.8 0 0 0.6\n3 0 0 0 0.8 0 0 0.6\n";
    assert_eq!(order(flipped), (false, QuaternionOrder::Guessed));
    let (poses, skipped) = all(&rows, format(&rows));
    assert!(skipped.is_empty());
    assert_eq!((poses.len(), poses[50].time), (51, 2.5));
    assert_eq!(poses[50].position, Some(Vector3::new(50.5, 2.0, -1.0)));
    // Printed with six digits.
    let yaw = attitude::to_rpy(&poses[10].attitude.unwrap()).z;
    assert!((yaw - 2.0 * (0.5 + 2.1 / 5.0)).abs() < 3e-6, "{yaw}");
}

#[test]
fn times_from_1970_have_the_unit_of_their_size() {
    for (time, scale) in [
        ("1403636580.83", 1.0),
        ("1403636580838", 1e-3),
        ("1403636580838555", 1e-6),
        ("1403636580838555648", 1e-9),
        ("12.5", 1.0),
    ] {
        let text = format!("{time} 1 2 3 0 0 0 1\n9{time} 1 2 3 0 0 0 1\n");
        assert_eq!(format(&text).time_scale, scale, "{time}");
    }
}

#[test]
fn what_is_no_file_of_poses_has_no_layout() {
    let tum = "1 0 0 0 0 0 0 1\n";
    for text in [
        // One row, times that go back, rows that are no quaternions.
        tum.to_owned(),
        "3 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n".to_owned(),
        "1 0 0 0 0 0 0 1\n2 0 0 0 0.5 0 0 0.5\n3 0 0 0 0 0 0 1\n".to_owned(),
        // An IMU that has an attitude.
        "t,gx,gy,gz,qw,qx,qy,qz\n1,0,0,0,1,0,0,0\n2,0,0,0,1,0,0,0\n".to_owned(),
        "1 1 0 0 9 0 1 0 9 0 0 2 9\n2 1 0 0 9 0 1 0 9 0 0 2 9\n".to_owned(),
        "t,x,y,z\n1,2,3,4\n2,2,3,4\n".to_owned(),
    ] {
        let found = detected(&text, None);
        assert!(matches!(found, Ok(None)), "{found:?} of {text}");
    }
    // A tracker that loses its marker one time of ten.
    let lost: String = (0..20)
        .map(|k| format!("{k} 0 0 1 0 0 0 {}\n", u32::from(k % 10 != 5)))
        .collect();
    let (poses, skipped) = all(&lost, format(&lost));
    assert_eq!((poses.len(), skipped.count(SkipKind::OutOfRange)), (20, 2));
}

#[test]
fn rows_of_kitti_behind_a_time() {
    // Turned by 90° about z.
    let text = "0.0 0 -1 0 10 1 0 0 20 0 0 1 30\n0.1 0 -1 0 11 1 0 0 21 0 0 1 31\n";
    let (poses, skipped) = all(text, format(text));
    assert!(skipped.is_empty());
    assert_eq!(poses[1].position, Some(Vector3::new(11.0, 21.0, 31.0)));
    let forward = poses[1].attitude.unwrap() * Vector3::x();
    assert!((forward - Vector3::y()).amax() < 1e-15, "{forward}");
    // Numbers that could be latitude, longitude, height and their deviations.
    let rpy = Vector3::new(0.3, -0.5, 3.0);
    let turn = attitude::from_rpy(&rpy).to_rotation_matrix();
    let row = |k: u32| {
        let rows = [0, 1, 2].map(|axis| {
            let [a, b, c] = [0, 1, 2].map(|column| turn[(axis, column)]);
            format!("{a} {b} {c} {}.5", k + axis as u32)
        });
        format!("{}.25 {}\n", k, rows.join(" "))
    };
    let text: String = (0..20).map(row).collect();
    let opened = Opened::stream(Path::new("poses.txt"), Cursor::new(text.clone())).unwrap();
    assert_eq!(opened.format(), Format::KfGins);
    let (poses, _) = all(&text, format(&text));
    assert_eq!(poses[3].position, Some(Vector3::new(3.5, 4.5, 5.5)));
    let found = attitude::to_rpy(&poses[3].attitude.unwrap());
    assert!((found - rpy).amax() < 1e-15 * 4.0, "{found}");
}

#[test]
fn euroc_by_its_header() {
    // The first lines of state_groundtruth_estimate0/data.csv of V1_01_easy, rounded.
    let state = "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], \
         v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], b_w_RS_S_x [rad s^-1], b_w_RS_S_y [rad s^-1], \
         b_w_RS_S_z [rad s^-1], b_a_RS_S_x [m s^-2], b_a_RS_S_y [m s^-2], b_a_RS_S_z [m s^-2]\n\
         1403715274302142976,0.878612,2.142470,0.947262,0.060514,-0.828459,-0.058956,-0.553641,0.009474,-0.014009,-0.002145,-0.002199,0.024911,0.081667,-0.025266,0.136696,0.075593\n\
         1403715274307142912,0.878662,2.142392,0.947258,0.060487,-0.828456,-0.059087,-0.553636,0.009700,-0.014400,-0.002000,-0.002199,0.024911,0.081667,-0.025266,0.136696,0.075593\n";
    let (poses, skipped) = all(state, format(state));
    assert_eq!((poses.len(), skipped.total()), (2, 0));
    assert!((poses[1].time - poses[0].time - 0.005).abs() < 1e-6);
    assert_eq!(
        poses[0].position,
        Some(Vector3::new(0.878612, 2.14247, 0.947262))
    );
    let q = poses[0].attitude.unwrap();
    // Rounded to six digits.
    assert!(
        (q.w - 0.060_514).abs() < 1e-6 && (q.i + 0.828_459).abs() < 1e-6,
        "{q}"
    );
    assert_eq!(format(state).quaternion_order, QuaternionOrder::Stated);
    let leica = "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m]\n\
         1403636578922881280,4.78,-1.81,0.84\n1403636578968881408,4.78,-1.81,0.86\n";
    let (poses, _) = all(leica, format(leica));
    assert_eq!((poses.len(), poses[0].attitude), (2, None));
    assert_eq!(poses[1].position, Some(Vector3::new(4.78, -1.81, 0.86)));
    let vicon = "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []\n\
         1403715272400000000,0.9,2.1,0.9,0.5,-0.5,0.5,0.5\n1403715272410000000,0.9,2.1,0.9,0.5,-0.5,0.5,0.5\n";
    let q = all(vicon, format(vicon)).0[0].attitude.unwrap();
    assert_eq!([q.w, q.i, q.j, q.k], [0.5, -0.5, 0.5, 0.5]);
}

/// Two rigid bodies, a marker of one of them, and a frame without the first.
const MOTIVE: &str = "Format Version,1.23,Take Name,a take,Capture Frame Rate,120.000000,Rotation Type,Quaternion,Length Units,Millimeters,Coordinate Space,Global\n\
    \n\
    ,Type,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body Marker,Rigid Body Marker,Rigid Body Marker,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body\n\
    ,Name,\"box\",\"box\",\"box\",\"box\",\"box\",\"box\",\"box\",\"box\",\"box:Marker1\",\"box:Marker1\",\"box:Marker1\",wand,wand,wand,wand,wand,wand,wand\n\
    ,ID,1,1,1,1,1,1,1,1,2,2,2,3,3,3,3,3,3,3\n\
    ,,Rotation,Rotation,Rotation,Rotation,Position,Position,Position,Mean Marker Error,Position,Position,Position,Rotation,Rotation,Rotation,Rotation,Position,Position,Position\n\
    Frame,Time (Seconds),X,Y,Z,W,X,Y,Z,,X,Y,Z,X,Y,Z,W,X,Y,Z\n\
    0,0.000000,0,0,0.6,0.8,1000,2000,3000,0.1,7,8,9,0,0,0,1,1,2,3\n\
    1,0.008333,,,,,,,,,7,8,9,0,0,0,1,1,2,3\n\
    2,0.016667,0,0,0.6,0.8,1100,2000,3000,0.1,7,8,9,0,0,0,1,4,5,6\n";

#[test]
fn rigid_bodies_of_motive() {
    let body = |name: &str| match detected(MOTIVE, Some(name)).unwrap() {
        Some(PoseSource::Table(format)) => all(MOTIVE, *format),
        other => panic!("{other:?}"),
    };
    let (poses, skipped) = body("box");
    assert_eq!(
        (poses.len(), skipped.to_string().as_str()),
        (
            2,
            "1 row with a missing field, at line 9: column 3 is empty"
        )
    );
    assert_eq!(poses[1].position, Some(Vector3::new(1.1, 2.0, 3.0)));
    let q = poses[1].attitude.unwrap();
    assert_eq!([q.i, q.j, q.k, q.w], [0.0, 0.0, 0.6, 0.8]);
    let (poses, skipped) = body("wand");
    assert_eq!((poses.len(), skipped.total()), (3, 0));
    assert_eq!(
        (poses[2].time, poses[2].position.unwrap().z),
        (0.016667, 0.006)
    );
    let message = |text: &str, name| detected(text, name).unwrap_err().to_string();
    assert_eq!(
        message(MOTIVE, None),
        "poses.txt: more than one rigid body (key poses.topic); the file has: box, wand"
    );
    assert_eq!(
        message(MOTIVE, Some("hat")),
        "poses.txt: no rigid body \"hat\" (key poses.topic); the file has: box, wand"
    );
    let angles = MOTIVE
        .replace("X,Y,Z,W,", "X,Y,Z,,")
        .replace("Quaternion", "XYZ");
    assert!(message(&angles, Some("box")).contains("rotations as angles"));
    let feet = MOTIVE.replace("Millimeters", "Feet");
    assert!(message(&feet, Some("box")).contains("unknown Length Units: Feet"));
    // Markers alone.
    let marker = "Format Version,1.24,Length Units,Centimeters\n\n,Type,,Marker,Marker,Marker\n,Name,,tip,tip,tip\n,ID,,1,1,1\n\
         ,,,Position,Position,Position\nFrame,Time (Seconds),TimeCode,X,Y,Z\n0,0.0,15:26:46:12.02,100,200,300\n1,0.1,15:26:46:13.02,100,200,350\n";
    let (poses, skipped) = all(marker, format(marker));
    assert_eq!((poses.len(), skipped.total()), (2, 0));
    assert_eq!(
        (poses[1].position, poses[1].attitude),
        (Some(Vector3::new(1.0, 2.0, 3.5)), None)
    );
}

#[test]
fn so_many_lines_are_no_rows_even_if_they_are_numbers() {
    let text = "0,0,0,0\n1,10,20,30\n2,11,21,31\n";
    let columns = [2, 3, 4].map(Column::Number);
    let format = PoseFormat {
        header_lines: 1,
        ..PoseFormat::new(Column::Number(1), Some(columns), None)
    };
    let (poses, skipped) = all(text, format);
    assert!(skipped.is_empty());
    assert_eq!((poses.len(), poses[0].time), (2, 1.0));
}

/// The poses that a text gives, of the body of a name.
fn poses_of(text: &str, body: Option<&str>) -> Vec<LocalPose> {
    let source = detected(text, body).unwrap().unwrap();
    let stream = Cursor::new(text.as_bytes().to_vec());
    let opened = Opened::stream(Path::new("poses.txt"), stream).unwrap();
    let reader = PoseReader::new(opened, &source).unwrap();
    reader.map(Result::unwrap).collect()
}

#[test]
fn segments_of_vicon() {
    let text = "Segments\n200\n,,Rig:Box,,,,,,Rig:Wand,,,,,\n\
        Frame,Sub Frame,RX,RY,RZ,TX,TY,TZ,RX,RY,RZ,TX,TY,TZ\n\
        ,,deg,deg,deg,mm,mm,mm,deg,deg,deg,mm,mm,mm\n\
        11,0,0,0,90,100,200,300,1,2,3,4,5,6\n\
        12,0,,,,,,,1,2,3,4,5,6\n\
        13,0,0,0,91,101,200,300,1,2,3,4,5,6\n";
    let poses = poses_of(text, Some("Rig:Box"));
    assert_eq!(poses.len(), 2);
    // Frame 11 of 200 a second.
    assert!((poses[0].time - 0.055).abs() < 1e-12 && (poses[1].time - 0.065).abs() < 1e-12);
    assert!((poses[0].position.unwrap() - Vector3::new(0.1, 0.2, 0.3)).norm() < 1e-12);
    let turned = poses[0].attitude.unwrap() * Vector3::x();
    assert!((turned - Vector3::y()).norm() < 1e-12, "{turned}");
    let error = detected(text, None).unwrap_err().to_string();
    assert!(error.contains("more than one segment"), "{error}");
    assert!(error.contains("Rig:Wand"), "{error}");
    // An object of Tracker in rad, and markers.
    let text = "Objects\n100\n,,Box:Box,,,,,\nFrame,Sub Frame,RX,RY,RZ,TX,TY,TZ\n,,rad,rad,rad,mm,mm,mm\n\
        1,0,0,0,1.5707963267948966,0,0,0\n2,0,0,0,0,1,0,0\n";
    let turned = poses_of(text, None)[0].attitude.unwrap() * Vector3::x();
    assert!((turned - Vector3::y()).norm() < 1e-12, "{turned}");
    let text = "Trajectories\n100\n,,Box:LeftTop,,\nFrame,Sub Frame,X,Y,Z\n,,mm,mm,mm\n1,0,1,2,3\n2,0,2,3,4\n";
    let poses = poses_of(text, None);
    assert_eq!(poses[1].position, Some(Vector3::new(0.002, 0.003, 0.004)));
    assert_eq!(poses[1].attitude, None);
}

/// The second body turns by 30° about z: its matrix is stated column by column.
#[test]
fn bodies_of_qualisys() {
    let body = |name: &str| {
        let rotation: Vec<String> = (0..9).map(|k| format!("Rot[{k}]")).collect();
        format!(
            "{name} X\tY\tZ\tRoll\tPitch\tYaw\tResidual\t{}",
            rotation.join("\t")
        )
    };
    let still = "1\t0\t0\t0\t1\t0\t0\t0\t1";
    let turned = "0.86603\t0.50000\t0.00000\t-0.50000\t0.86603\t0.00000\t0.00000\t0.00000\t1.00000";
    let lost = ["0.00000"; 16].join("\t");
    let head = "NO_OF_FRAMES\t2\nNO_OF_CAMERAS\t4\nNO_OF_BODIES\t2\nFREQUENCY\t100\nDESCRIPTION\t--\n\
        TIME_STAMP\t2020-01-22, 17:47:17\t22107.99\nDATA_INCLUDED\t6D\nBODY_NAMES\tShip\tBuoy\n";
    let ship = format!("1000.0\t0.0\t0.0\t0\t0\t0\t0.5\t{still}");
    let buoy = format!("-194.9\t2.2\t1.0\t0\t0\t30\t0.5\t{turned}");
    let names = [body("Ship"), body("Buoy")].join("\t");
    let rows = |first: [&str; 2]| {
        let [a, b] = first;
        format!("{a}\t{ship}\t{buoy}\t\n{b}\t{ship}\t{lost}\t\n")
    };
    let with_time = format!(
        "{head}Frame\tTime\t{names}\n{}",
        rows(["1\t0.00000", "2\t0.01000"])
    );
    let by_frames = format!("{head}Frame\t{names}\n{}", rows(["1", "2"]));
    for (text, first) in [(&with_time, 0.0), (&by_frames, 0.01)] {
        let poses = poses_of(text, Some("Buoy"));
        assert_eq!(poses.len(), 1);
        assert!((poses[0].time - first).abs() < 1e-12);
        let place = Vector3::new(-0.1949, 0.0022, 0.001);
        assert!((poses[0].position.unwrap() - place).norm() < 1e-12);
        let (sin, cos) = 30f64.to_radians().sin_cos();
        let axis = poses[0].attitude.unwrap() * Vector3::x();
        // The matrix has five decimals.
        assert!((axis - Vector3::new(cos, sin, 0.0)).norm() < 1e-5, "{axis}");
        assert_eq!(poses_of(text, Some("Ship")).len(), 2);
    }
    let error = detected(&with_time, None).unwrap_err().to_string();
    assert!(
        error.contains("Ship") && error.contains("more than one body"),
        "{error}"
    );
}
