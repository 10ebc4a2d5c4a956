//! Poses as a stranger has them: what is wrong with them is in the first line of every verb.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};
use undrift::nav::{Quaternion, Vector3, attitude::from_rpy};

/// The room of `undrift sample`, in a folder of this name.
fn room(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    // Left by an earlier run, if it is there.
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    let (sampled, ..) = run(&folder, &["sample", "logs", "-q"]);
    assert!(sampled);
    folder.join("logs/room")
}

/// Whether it ended well, the first line, and all that was said.
fn run(folder: &Path, arguments: &[&str]) -> (bool, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_undrift"));
    let done = command
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap();
    let [out, said] = [done.stdout, done.stderr].map(|text| String::from_utf8(text).unwrap());
    let first = out.lines().chain(said.lines()).next().unwrap_or_default();
    (
        done.status.success(),
        first.to_owned(),
        format!("{out}{said}"),
    )
}

/// A row: time, position, x, y, z, w.
type Pose = (f64, Vector3, Quaternion);

fn poses(text: &str) -> Vec<Pose> {
    let pose = |line: &str| {
        let of = Vec::from_iter(line.split(' ').map(|x| x.parse::<f64>().unwrap()));
        let (axis, position) = (
            Vector3::new(of[4], of[5], of[6]),
            Vector3::new(of[1], of[2], of[3]),
        );
        let turn = axis * (2.0 * axis.norm().atan2(of[7]) / axis.norm().max(1e-12));
        (of[0], position, Quaternion::from_scaled_axis(turn))
    };
    text.lines().map(pose).collect()
}

fn row((t, p, q): &Pose) -> String {
    format!(
        "{t:.4} {:.5} {:.5} {:.5} {:.7} {:.7} {:.7} {:.7}\n",
        p.x, p.y, p.z, q.i, q.j, q.k, q.w
    )
}

/// Seconds of the room that are tuned: enough for outages in the half that the fit has not seen.
const TUNED: f64 = 100.0;

/// A rate or a specific force of which each axis reads so much of the next one \[rad\].
fn crossed([x, y, z]: [f64; 3], part: f64) -> [f64; 3] {
    [x + part * y, y + part * z, z - part * x]
}

/// Misaligned axes are not found as noise: what `tune` writes drifts as if they were not, and a sensor without them gets no such states.
#[test]
#[ignore = "slow: two tunings"]
fn misaligned_axes_are_estimated_beside_the_noise() {
    let room = room("poses-tuned");
    let right = fs::read_to_string(room.join("imu.csv")).unwrap();
    let (head, rows) = right.split_once('\n').unwrap();
    let tuned = |part: f64| {
        let mut text = format!("{head}\n");
        for row in rows.lines() {
            let of = Vec::from_iter(row.split(',').map(|x| x.parse::<f64>().unwrap()));
            if of[0] > TUNED {
                break;
            }
            let (w, f) = (
                crossed([of[1], of[2], of[3]], part),
                crossed([of[4], of[5], of[6]], part),
            );
            let row = [w, f]
                .concat()
                .iter()
                .map(|x| format!(",{x:.9}"))
                .collect::<String>();
            text += &format!("{:.4}{row}\n", of[0]);
        }
        fs::write(room.join("part.csv"), text).unwrap();
        let arguments = [
            "tune",
            "part.csv",
            "poses.txt",
            "-o",
            "tuned.toml",
            "--json",
            "tuned.json",
        ];
        let (ended, _, said) = run(&room, &arguments);
        assert!(ended, "{said}");
        let file = fs::read_to_string(room.join("tuned.toml")).unwrap();
        let result = fs::read(room.join("tuned.json")).unwrap();
        let result: serde_json::Value = serde_json::from_slice(&result).unwrap();
        let rows = result["drift"].as_array().unwrap();
        let row = rows.iter().find(|row| row["length_s"] == 3.0).unwrap();
        let drift = row["after_m"].as_f64().unwrap();
        (file.contains("misalignment"), drift, said)
    };
    let (without, drift, said) = tuned(0.0);
    assert!(
        !without && said.contains("tried beside the noise and rejected"),
        "{said}"
    );
    let (with, misaligned, said) = tuned(0.008);
    assert!(
        with && said.contains("estimated beside the noise"),
        "{said}"
    );
    // As noise they would be 10 times the drift; so it is the same but for chance.
    assert!(misaligned < 1.5 * drift, "{misaligned} {drift}");
}

/// What is done to the poses, and what the first line of `inspect` and that of `navigate` begin with.
type Wrong = (fn(Pose) -> Pose, &'static str, &'static str);

const CASES: [Wrong; 9] = [
    (
        |(t, p, q)| (t, p, q.inverse()),
        "not usable: the quaternions are inverse",
        "not usable: the quaternions are inverse",
    ),
    (
        |(t, p, q)| (t, 1e3 * p, q),
        "usable: the positions are in mm",
        "usable",
    ),
    (
        |(t, p, q)| (t, Vector3::new(p.x, -p.y, p.z), q),
        "not usable: positions and attitudes are of different frames: with the axes x, -y, z",
        "not usable: positions and attitudes are of different frames: with the axes x, -y, z",
    ),
    (
        |(t, p, q)| {
            let turn = q.scaled_axis();
            let turn = Vector3::new(-turn.x, turn.y, -turn.z);
            (
                t,
                Vector3::new(p.x, -p.y, p.z),
                Quaternion::from_scaled_axis(turn),
            )
        },
        "not usable: poses and IMU are mirror images",
        "not usable: poses and IMU are mirror images",
    ),
    (
        |(t, p, q)| (t + 7200.0, p, q),
        "usable: the poses have another clock: -7199.98 s are to be added",
        "usable",
    ),
    (
        |(t, p, q)| (1.02 * t, p, q),
        "not usable: the clock of the poses runs 2.00 % fast: multiply their times by 0.98",
        "not usable: the clock of the poses runs 2.00 % fast",
    ),
    (
        |(t, p, q)| match t > 70.0 {
            true => (
                t,
                p + q * Vector3::new(0.02, 0.0, -0.02),
                q * from_rpy(&Vector3::new(0.0, 0.26, 0.0)),
            ),
            false => (t, p, q),
        },
        "usable with care: the marker slipped by 14.9° and 2.",
        "usable with care: the marker slipped by 14.9° and 2.",
    ),
    (
        |(t, p, q)| match t > 70.0 {
            true => (t, p + Vector3::new(0.13, -0.17, 0.09), q),
            false => (t, p, q),
        },
        "usable with care: the frame of the poses moves by 22.8 cm",
        "usable with care: the frame of the poses moves by 22.8 cm",
    ),
    (|(t, p, q)| (t, p, q), "imu.csv: delimited text", "usable"),
];

#[test]
fn what_is_wrong_with_poses_is_in_the_first_line() {
    let room = room("poses");
    let right = fs::read_to_string(room.join("poses.txt")).unwrap();
    let right = poses(&right);
    let write = |wrong: fn(Pose) -> Pose| {
        let rows: String = right.iter().map(|pose| row(&wrong(*pose))).collect();
        fs::write(room.join("wrong.txt"), rows).unwrap();
    };
    for (wrong, described, navigated) in CASES {
        write(wrong);
        for (verb, expected) in [("inspect", described), ("navigate", navigated)] {
            let (_, first, said) = run(&room, &[verb, "imu.csv", "wrong.txt"]);
            assert!(first.starts_with(expected), "{verb}: {first}\n{said}");
        }
    }
    // A drive file of the whole log, in which nothing is cut.
    let slip = CASES[6].0;
    write(slip);
    run(
        &room,
        &["inspect", "imu.csv", "wrong.txt", "-o", "cut.toml", "-q"],
    );
    let cut = fs::read_to_string(room.join("cut.toml")).unwrap();
    let at = cut.find("\n[span]").unwrap();
    let start = cut[at..]
        .lines()
        .find(|line| line.starts_with("start"))
        .unwrap();
    assert!(start.starts_with("start = \"70."), "{start}");
    fs::write(room.join("whole.toml"), &cut[..at]).unwrap();
    for (verb, file, expected) in [
        (
            "navigate",
            "whole.toml",
            "not usable: the marker slipped by 14.9° and 2.",
        ),
        (
            "outages",
            "whole.toml",
            "not usable: the marker slipped by 14.9° and 2.",
        ),
        ("navigate", "cut.toml", "usable"),
    ] {
        let (_, first, said) = run(&room, &[verb, file]);
        assert!(
            first.starts_with(expected),
            "{verb} {file}: {first}\n{said}"
        );
    }
    let (_, _, said) = run(&room, &["navigate", "cut.toml"]);
    assert!(
        said.contains(" poses used") && !said.contains("fixes") && !said.contains("GNSS"),
        "{said}"
    );
    let attitudes: String = right
        .iter()
        .fold("t,qx,qy,qz,qw\n".into(), |text, (t, _, q)| {
            format!("{text}{t},{},{},{},{}\n", q.i, q.j, q.k, q.w)
        });
    fs::write(room.join("attitudes.csv"), attitudes).unwrap();
    let (done, first, _) = run(&room, &["navigate", "imu.csv", "attitudes.csv"]);
    assert!(
        !done && first.contains("too few positions that differ beside the attitudes"),
        "{first}"
    );
}
