//! `undrift live` through sockets: what it gives is what `undrift navigate` gives, a recording gives it again, and after a kill
//! it goes on.

use std::{
    fs,
    io::{BufRead, BufReader, Write},
    net::{TcpListener, TcpStream},
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    thread,
    time::{Duration, Instant},
};

/// Length of the drive [s], how much faster than it it is sent, and how late fixes come at most [s].
const LENGTH: f64 = 160.0;
const PACE: f64 = 40.0;
const LATE: f64 = 1.5;

fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("live_{name}"));
    // Left by an earlier run, if it is there.
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn undrift(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_undrift"));
    command.args(arguments).current_dir(folder);
    command
}

/// The rows of a table with their times [s], and its header.
fn rows(file: &Path) -> (String, Vec<(f64, String)>) {
    let text = fs::read_to_string(file).unwrap();
    let mut lines = text.lines();
    let header = format!("{}\n", lines.next().unwrap());
    let rows = lines.map(|line| {
        (
            line.split(',').next().unwrap().parse().unwrap(),
            format!("{line}\n"),
        )
    });
    (header, rows.filter(|(time, _)| *time <= LENGTH).collect())
}

/// The drive of `undrift sample`, cut to [`LENGTH`].
fn sample(name: &str) -> PathBuf {
    let folder = folder(name);
    assert!(
        undrift(&folder, &["sample", "logs", "-q"])
            .status()
            .unwrap()
            .success()
    );
    let drive = folder.join("logs/drive");
    for file in ["imu.csv", "gnss.csv"] {
        let (header, rows) = rows(&drive.join(file));
        let rows: String = rows.into_iter().map(|(_, row)| row).collect();
        fs::write(drive.join(file), header + &rows).unwrap();
    }
    drive
}

/// A server that sends what comes when, by the time of the log, to its first client.
fn serve(
    rows: Vec<(f64, String)>,
    header: String,
    pace: f64,
) -> (String, thread::JoinHandle<TcpStream>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = format!("tcp://{}", listener.local_addr().unwrap());
    let server = thread::spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        let begin = Instant::now();
        stream.write_all(header.as_bytes()).unwrap();
        for (time, row) in rows {
            thread::sleep(Duration::from_secs_f64(time / pace).saturating_sub(begin.elapsed()));
            // In two pieces.
            let (one, two) = row.split_at(row.len() / 3);
            if stream
                .write_all(one.as_bytes())
                .and_then(|()| stream.write_all(two.as_bytes()))
                .is_err()
            {
                break;
            }
        }
        stream
    });
    (address, server)
}

/// Ends a run as Ctrl-C does, by a signal that is not ignored in the background, and waits for it.
pub(crate) fn interrupt(mut run: Child) {
    let id = run.id().to_string();
    assert!(
        Command::new("kill")
            .args(["-TERM", &id])
            .status()
            .unwrap()
            .success()
    );
    assert!(run.wait().unwrap().success());
}

/// A run of a drive with sources of samples and fixes, and what it says.
fn start(
    drive: &Path,
    [imu, gnss]: [&str; 2],
    kept: [&str; 2],
) -> (Child, thread::JoinHandle<String>) {
    let sources = ["live", "drive.toml", "--imu", imu, "--gnss", gnss];
    let mut command = undrift(drive, &sources);
    command
        .args(["-o", "live.csv"])
        .args(kept)
        .stderr(Stdio::piped());
    let mut run = command.spawn().unwrap();
    let said = BufReader::new(run.stderr.take().unwrap());
    let said = thread::spawn(move || Vec::from_iter(said.lines().map_while(Result::ok)).join("\n"));
    (run, said)
}

pub(crate) fn last_line(file: &Path) -> String {
    fs::read_to_string(file)
        .unwrap()
        .lines()
        .last()
        .unwrap_or_default()
        .to_owned()
}

pub(crate) fn wait_for(what: &str, mut done: impl FnMut() -> bool) {
    let begin = Instant::now();
    while !done() {
        assert!(begin.elapsed() < Duration::from_secs(60), "{what}");
        thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn through_sockets_with_late_fixes_it_is_navigate_and_a_recording_gives_it_again() {
    let drive = sample("sockets");
    assert!(
        undrift(&drive, &["navigate", "drive.toml", "-o", "nav.csv", "-q"])
            .status()
            .unwrap()
            .success()
    );
    let (imu_header, imu) = rows(&drive.join("imu.csv"));
    let (gnss_header, gnss) = rows(&drive.join("gnss.csv"));
    // Fixes come late by 0.05 s to LATE; the last two samples come after all of them.
    let late = gnss.into_iter().enumerate();
    let gnss = late.map(|(k, (time, row))| {
        (
            time + 0.05 + (k * 7919 % 1000) as f64 * 1e-3 * (LATE - 0.05),
            row,
        )
    });
    let mut gnss: Vec<_> = gnss.collect();
    let mut latest = 0.0_f64;
    for (time, _) in &mut gnss {
        latest = latest.max(*time);
        *time = latest;
    }
    let mut imu = imu;
    let from = imu.len() - 2;
    for (time, _) in &mut imu[from..] {
        *time = LENGTH + 2.0 * LATE;
    }
    let (from_imu, imu_server) = serve(imu, imu_header, PACE);
    let (from_gnss, gnss_server) = serve(gnss, gnss_header, PACE);
    let (run, said) = start(&drive, [&from_imu, &from_gnss], ["--record", "run.mcap"]);
    let streams = [imu_server.join().unwrap(), gnss_server.join().unwrap()];
    let newest = |file: &str| {
        last_line(&drive.join(file))
            .split(',')
            .next()
            .unwrap_or_default()
            .to_owned()
    };
    // The solution goes to the last sample but one.
    wait_for("the last row", || newest("live.csv").starts_with("159.98"));
    interrupt(run);
    drop(streams);
    let said = said.join().unwrap();
    assert!(
        said.contains("navigation begins: levelled during"),
        "{said}"
    );
    assert!(said.contains("; 0 measurements too late"), "{said}");
    let (_, navigated) = rows(&drive.join("nav.csv"));
    let last = last_line(&drive.join("live.csv"));
    let (_, same) = navigated
        .iter()
        .find(|(time, _)| format!("{time:.4}") == last.split(',').next().unwrap())
        .unwrap();
    assert_eq!(last, same.trim_end(), "{said}");

    let again = ["live", "replay:run.mcap?pace=0", "-o", "again.csv", "-q"];
    assert!(undrift(&drive, &again).status().unwrap().success());
    let navigate = ["navigate", "run.mcap", "-o", "navigated.csv", "-q"];
    assert!(undrift(&drive, &navigate).status().unwrap().success());
    for other in ["again.csv", "navigated.csv"] {
        assert!(
            fs::read(drive.join("live.csv")).unwrap() == fs::read(drive.join(other)).unwrap(),
            "{other}"
        );
    }
    let smooth = ["navigate", "run.mcap", "--smooth"];
    let said = undrift(&drive, &smooth).output().unwrap().stderr;
    let said = String::from_utf8(said).unwrap();
    assert!(said.contains("which --smooth cannot change"), "{said}");
}

#[test]
fn after_a_kill_it_goes_on_from_its_checkpoint() {
    let drive = sample("kill");
    let (header, imu) = rows(&drive.join("imu.csv"));
    let (gnss_header, gnss) = rows(&drive.join("gnss.csv"));
    let cut = 120.0;
    let part = |rows: &[(f64, String)], first: bool| -> Vec<(f64, String)> {
        let rows = rows.iter().filter(|(time, _)| (*time < cut) == first);
        rows.map(|(time, row)| (if first { *time } else { *time - cut }, row.clone()))
            .collect()
    };
    for first in [true, false] {
        // The second part at the pace of the vehicle.
        let pace = if first { PACE } else { 4.0 };
        let (from_imu, imu_server) = serve(part(&imu, first), header.clone(), pace);
        let (from_gnss, gnss_server) = serve(part(&gnss, first), gnss_header.clone(), pace);
        let kept = ["--state", "run.state"];
        let (mut run, said) = start(&drive, [&from_imu, &from_gnss], kept);
        if first {
            let _streams = [imu_server.join().unwrap(), gnss_server.join().unwrap()];
            wait_for("a checkpoint", || drive.join("run.state").exists());
            wait_for("the last row", || {
                last_line(&drive.join("live.csv")).starts_with("119.9")
            });
            run.kill().unwrap();
            run.wait().unwrap();
        } else {
            let time = || {
                last_line(&drive.join("live.csv"))
                    .split(',')
                    .next()
                    .unwrap_or_default()
                    .parse::<f64>()
            };
            wait_for("a row", || time().is_ok_and(|time| time >= 125.0));
            interrupt(run);
            let said = said.join().unwrap();
            assert!(said.contains("goes on from the checkpoint of "), "{said}");
            // From the first samples on, though what the logs are is understood half a second later.
            let (_, solution) = self::rows(&drive.join("live.csv"));
            assert!(solution[0].0 < cut + 0.1, "{:?}", solution[0]);
            // The truth has a row each fifth of a second.
            let numbers = |row: &str| -> Vec<f64> {
                let fields = row.trim_end().split(',');
                fields.map(|field| field.parse().unwrap()).collect()
            };
            let (_, truth) = self::rows(&drive.join("truth.csv"));
            let both = solution.iter().rev().find_map(|(time, row)| {
                let same = truth.iter().find(|(at, _)| (at - time).abs() < 1e-3)?;
                Some((numbers(row), numbers(&same.1)))
            });
            let (row, truth) = both.unwrap();
            assert!(row[10].hypot(row[11]) < 0.5, "σ [m]: {row:?}");
            let north = (truth[1] - row[1]).to_radians() * 6.371e6;
            let east = (truth[2] - row[2]).to_radians() * 6.371e6 * row[1].to_radians().cos();
            assert!(
                north.hypot(east) < 3.0 * row[10].hypot(row[11]) + 0.1,
                "{north} {east} {row:?}"
            );
            drop((imu_server.join(), gnss_server.join()));
        }
    }
}

#[test]
fn a_mistake_is_said_before_anything_runs() {
    let drive = sample("mistakes");
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let taken = format!("tcp://{}", taken.local_addr().unwrap());
    let text = fs::read_to_string(drive.join("drive.toml")).unwrap();
    let line = 1 + text
        .lines()
        .position(|line| line.starts_with("accel_unit"))
        .unwrap();
    let wrong = text.replace("accel_unit", "acel_unit");
    fs::write(drive.join("wrong.toml"), wrong).unwrap();
    let line = format!("wrong.toml line {line}, imu.acel_unit");
    fs::write(drive.join("poses.toml"), text.replace("[gnss]", "[poses]")).unwrap();
    let poses = "the drive file has no [gnss]";
    for (arguments, words) in [
        (
            &["live", "poses.toml", "--imu", "-", "--gnss", "-"] as &[&str],
            poses,
        ),
        (
            &["live", "drive.toml", "--imu", "-", "--poses", "-"],
            "the drive file has no [poses]",
        ),
        (&["live", "wrong.toml", "--replay", "0"], line.as_str()),
        (
            &[
                "live",
                "drive.toml",
                "--imu",
                "-",
                "--gnss",
                "-",
                "-o",
                &taken,
            ],
            "cannot open the output tcp://127",
        ),
        (
            &["live", "drive.toml"],
            "no source of [imu]: specify --imu SOURCE, or --replay 1",
        ),
        (
            &["live", "drive.toml", "--imu", "-", "--gnss", "tcp://pi"],
            "host:port is expected",
        ),
        (
            &["live", "drive.toml", "--replay", "0", "-o", "nav.kml"],
            "complete only at its end",
        ),
        (
            &["live", "drive.toml", "--replay", "0", "--horizon", "x"],
            "must be 0 to 60 s",
        ),
        (
            &["live", "replay:imu.csv"],
            "not a recording of undrift live",
        ),
        (
            &[
                "live",
                "drive.toml",
                "--imu",
                "-",
                "--gnss",
                "-",
                "--sensor",
                "odometer=-",
            ],
            "has no [odometer]",
        ),
    ] {
        let said = undrift(&drive, arguments).output().unwrap();
        let stderr = String::from_utf8(said.stderr).unwrap();
        assert!(
            !said.status.success() && stderr.contains(words),
            "{arguments:?}: {stderr}"
        );
    }
}

/// A file may not become larger than 100 kB, as on a disk that is full: the recording ends, the solution goes on.
#[cfg(unix)]
#[test]
fn a_full_disk_ends_the_recording_alone() {
    let drive = sample("full");
    let live = "live drive.toml --replay 0 --record run.mcap --every 1 -o live.csv";
    let limited = format!(
        "trap '' XFSZ; ulimit -f 200; exec '{}' {live}",
        env!("CARGO_BIN_EXE_undrift")
    );
    let run = Command::new("sh")
        .args(["-c", &limited])
        .current_dir(&drive)
        .output()
        .unwrap();
    let said = String::from_utf8(run.stderr).unwrap();
    assert!(run.status.success(), "{said}");
    assert!(
        said.contains("run.mcap: ")
            && said.contains("the recording ends here, the solution goes on"),
        "{said}"
    );
    assert!(
        last_line(&drive.join("live.csv")).starts_with("159."),
        "{said}"
    );
    // What was recorded before can be read: an IMU at rest, whose alignment had not come.
    let again = undrift(&drive, &["navigate", "run.mcap"]).output().unwrap();
    let said = String::from_utf8(again.stderr).unwrap();
    assert!(said.contains("no solution: "), "{said}");
}
