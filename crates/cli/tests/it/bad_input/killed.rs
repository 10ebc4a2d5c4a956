//! The command killed while it works: under the name asked for there is the whole file or what was there.

use super::log::{Case, Log};
use super::repeated::static_record;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Kills of a verb.
const KILLS: u32 = 18;
const OLD: &str = "what was there before";

/// Random numbers in [0, 1), the same at every run (Knuth's linear congruential generator).
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Names in a folder of files on their way to `name`: `.NAME.partPID`.
fn parts(case: &Case, name: &str) -> Vec<String> {
    let (folder, name) = match name.rsplit_once('/') {
        Some((folder, name)) => (case.path(folder), name),
        None => (case.path(""), name),
    };
    let Ok(entries) = std::fs::read_dir(folder) else {
        return Vec::new();
    };
    let start = format!(".{name}.part");
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    names.filter(|name| name.starts_with(&start)).collect()
}

/// Names of all files of a case, folders gone into, without those on their way.
fn settled(case: &Case) -> Vec<String> {
    let mut names = Vec::new();
    let mut folders = vec![case.path("")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let entry = entry.unwrap();
            let name = entry.file_name().into_string().unwrap();
            if entry.file_type().unwrap().is_dir() {
                folders.push(entry.path());
            } else if !(name.starts_with('.') && name.contains(".part")) {
                names.push(name);
            }
        }
    }
    names.sort();
    names
}

/// Kills the command at moments spread over its run, and as soon as a file is on its way.
fn kill(case: &Case, arguments: &[&str], files: &[&str], seed: u64) {
    let start = Instant::now();
    let whole = case.run(arguments);
    assert!(whole.succeeded(), "{}", whole.stderr);
    let usual = start.elapsed();
    let read = |name: &str| std::fs::read(case.path(name)).ok();
    let new: Vec<_> = files.iter().map(|name| read(name)).collect();
    assert!(new.iter().all(Option::is_some));
    let all = settled(case);

    let mut dice = Dice(seed);
    let (mut killed, mut on_the_way) = (0, 0);
    for k in 0..KILLS {
        // Every other time there is a file already.
        let old = (k % 2 == 0).then(|| OLD.as_bytes().to_vec());
        for name in files {
            let _ = std::fs::remove_file(case.path(name));
            if let Some(old) = &old {
                case.put(name, old);
            }
        }
        let mut child = Command::new(env!("CARGO_BIN_EXE_undrift"))
            .args(arguments)
            .current_dir(case.path(""))
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        if k % 3 == 0 {
            let name = files[k as usize / 3 % files.len()];
            while parts(case, name).is_empty() && child.try_wait().unwrap().is_none() {
                std::thread::yield_now();
            }
        } else {
            std::thread::sleep(usual.mul_f64(1.1 * dice.roll()));
        }
        child.kill().unwrap();
        killed += u32::from(child.wait().unwrap().code().is_none());
        std::thread::sleep(Duration::from_millis(1));

        for (name, new) in files.iter().zip(&new) {
            let found = read(name);
            assert!(
                found == old || found == *new,
                "kill {k} of {arguments:?} left half of {name}: {} bytes of {:?}",
                found.map_or(0, |bytes| bytes.len()),
                new.as_ref().map(Vec::len)
            );
            for part in parts(case, name) {
                on_the_way += 1;
                let folder = case.path(name);
                std::fs::remove_file(folder.with_file_name(part)).unwrap();
            }
        }
        // Nothing else is left but files that say by their name what they are.
        assert!(settled(case).iter().all(|name| all.contains(name)));
    }
    // Most of the kills must have come in time for the test to mean something.
    assert!(killed >= KILLS / 3, "{killed} of {arguments:?}");
    assert!(
        on_the_way > 0,
        "no kill of {arguments:?} met a file half written"
    );
}

#[test]
#[ignore = "slow: 18 killed runs"]
fn a_killed_navigate_leaves_no_half_solution() {
    let case = Log::good().write("killed_navigate");
    let arguments = ["navigate", "drive.toml", "-o", "nav.csv", "-o", "nav.kml"];
    kill(&case, &arguments, &["nav.csv", "nav.kml"], 1);
}

#[test]
#[ignore = "slow: 18 killed runs"]
fn a_killed_outages_leaves_no_half_result() {
    let case = Log::good().write("killed_outages");
    let cuts = [
        "--length",
        "5",
        "--at",
        "40,60",
        "--json",
        "outages.json",
        "--report",
        "outages.html",
    ];
    let arguments = [
        &["outages", "drive.toml", "--bias-models", "white"],
        &cuts[..],
    ]
    .concat();
    kill(&case, &arguments, &["outages.json", "outages.html"], 2);
}

#[test]
#[ignore = "slow: 18 killed runs"]
fn a_killed_identify_leaves_no_half_model() {
    let case = Log::good().write("killed_identify");
    case.put("record.csv", static_record(1000).as_bytes());
    // One axis of the shortest record that is taken: it is run many times.
    let arguments = "identify record.csv --rate 50 --columns 1 --axis gyro_x --units rad/s \
        -o imu.toml --json found.json";
    let arguments: Vec<&str> = arguments.split_whitespace().collect();
    kill(&case, &arguments, &["imu.toml", "found.json"], 3);
}

/// Interrupted, ended or hung up, the command takes its unfinished files with it and ends by the signal.
#[cfg(unix)]
#[test]
fn signals_leave_nothing_behind() {
    use std::os::unix::process::ExitStatusExt;

    let case = Log::good().write("signals");
    for (signal, number) in [("INT", 2), ("TERM", 15), ("HUP", 1)] {
        case.put("nav.csv", OLD.as_bytes());
        let met = (0..10 * KILLS).any(|_| {
            let mut child = Command::new(env!("CARGO_BIN_EXE_undrift"))
                .args(["navigate", "drive.toml", "-o", "nav.csv"])
                .current_dir(case.path(""))
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .spawn()
                .unwrap();
            while parts(&case, "nav.csv").is_empty() {
                // Done before it was seen: nothing is left to be killed.
                if child.try_wait().unwrap().is_some() {
                    return false;
                }
                std::thread::yield_now();
            }
            let id = child.id().to_string();
            let kill = Command::new("kill").args(["-s", signal, &id]).status();
            assert!(kill.is_ok_and(|status| status.success()));
            let ended = child.wait().unwrap().signal();
            assert!(ended.is_none() || ended == Some(number), "{ended:?}");
            assert!(parts(&case, "nav.csv").is_empty());
            let found = std::fs::read(case.path("nav.csv")).unwrap();
            ended.is_some() && found == OLD.as_bytes()
        });
        assert!(met, "no {signal} met a file half written");
    }
}
