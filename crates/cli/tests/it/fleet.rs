//! Many logs: whatever fails, is ended, divided or done again, the results are the same to the byte.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    process::{Command, Output, Stdio},
    time::{Duration, Instant},
};
use undrift::{
    noise::{BiasModel, ImuModel},
    simulate::{GnssNoise, SimulatedLog, Trajectory},
};

/// Logs of the fleet; one of them is broken.
const LOGS: usize = 12;
const BROKEN: usize = 5;

fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("fleet_{name}"));
    // Left by an earlier run, if it is there.
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// Twelve drives of 150 s at 50 Hz, three of each unit, and their manifest.
fn simulated(name: &str) -> PathBuf {
    let folder = folder(name);
    let model = ImuModel::preset("adis16405").unwrap();
    for k in 0..LOGS {
        let home = folder.join(format!("SN{}/{k:02}", k / 3));
        let log = SimulatedLog {
            trajectory: &Trajectory::car(150.0, k as u64),
            rate_hz: 50.0,
            filters: &model.shaping(BiasModel::GaussMarkov, 0.02).unwrap(),
            gnss: &GnssNoise::default(),
            seed: k as u64,
            model: "adis16405",
            temperature_c: (k % 3 != 2).then_some(20.0 + k as f64),
        };
        log.write(&home).unwrap();
        if k == BROKEN {
            std::fs::write(home.join("gnss.csv"), "t_s,lat_deg\n1,2\n").unwrap();
        }
    }
    let manifest = r#"
unit = "{parent}"
bias_models = ["white", "arma"]
[outages]
length = "5 s"
every = "15 s"
start = "75 s"
[[log]]
drive = "SN[012]/*/drive.toml"
[[log]]
drive = "SN3/*/drive.toml"
temperature = "-3.5 degC"
"#;
    std::fs::write(folder.join("fleet.toml"), manifest).unwrap();
    folder
}

fn command(logs: &Path, out: &Path, more: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_undrift"));
    command
        .arg("fleet")
        .arg(logs.join("fleet.toml"))
        .arg("-o")
        .arg(out)
        .args(more)
        .env_remove("RAYON_NUM_THREADS");
    command
}

fn run(logs: &Path, out: &Path, more: &[&str]) -> (Option<i32>, String, String) {
    let Output {
        status,
        stdout,
        stderr,
    } = command(logs, out, more).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    let (stdout, stderr) = (text(stdout), text(stderr));
    assert!(!stderr.contains("panicked"), "{stderr}");
    (status.code(), stdout, stderr)
}

/// A run that goes well but for the broken log; its first line.
fn done(logs: &Path, out: &Path, more: &[&str]) -> String {
    let (code, stdout, stderr) = run(logs, out, more);
    assert_eq!(code, Some(0), "{stderr}");
    stdout.lines().next().unwrap_or_default().to_owned()
}

/// Every file below a folder with its bytes.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut files = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in std::fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(folder).unwrap().to_owned();
                files.insert(name, std::fs::read(path).unwrap());
            }
        }
    }
    files
}

fn assert_same(a: &Path, b: &Path) {
    let (a, b) = (files(a), files(b));
    assert_eq!(a.keys().collect::<Vec<_>>(), b.keys().collect::<Vec<_>>());
    for (name, bytes) in &a {
        assert!(bytes == &b[name], "{} differs", name.display());
    }
}

fn summary(out: &Path) -> serde_json::Value {
    let text = std::fs::read_to_string(out.join("fleet.json")).unwrap();
    crate::schema::conforms(&text);
    serde_json::from_str(&text).unwrap()
}

#[test]
fn one_broken_log_stops_none_and_a_second_run_does_nothing() {
    let logs = simulated("resumes");
    let out = logs.join("out");
    let (code, stdout, stderr) = run(&logs, &out, &[]);
    assert_eq!(code, Some(0), "{stderr}");
    assert!(
        stdout.starts_with("12 logs processed, 0 up to date\n"),
        "{stdout}"
    );
    let broken = "SN1/05/drive.toml: gnss.csv line 1: no column \"lon_deg\"";
    assert!(stderr.contains(broken), "{stderr}");

    let json = summary(&out);
    assert_eq!(json["failed"].as_array().unwrap().len(), 1);
    assert_eq!(json["logs"].as_array().unwrap().len(), LOGS - 1);
    let drift = &json["measures"][0];
    assert_eq!(drift["name"], "drift");
    let units = drift["by_unit"].as_array().unwrap();
    let of = |unit: &serde_json::Value| (unit["name"].clone(), unit["logs"].clone());
    let expected = [("SN0", 3), ("SN1", 2), ("SN2", 3), ("SN3", 3)];
    let expected = expected.map(|(name, n)| (name.into(), n.into()));
    assert_eq!(units.iter().map(of).collect::<Vec<_>>(), expected);
    // The manifest's word, else the column's mean, else none.
    let temperatures: Vec<Option<f64>> = json["logs"]
        .as_array()
        .unwrap()
        .iter()
        .map(|log| log["temperature_c"].as_f64())
        .collect();
    let (t, stated) = (|k: u8| Some(20.0 + f64::from(k)), Some(-3.5));
    let expected = [
        t(0),
        t(1),
        None,
        t(3),
        t(4),
        t(6),
        t(7),
        None,
        stated,
        stated,
        stated,
    ];
    assert_eq!(temperatures, expected);

    let before = files(&out);
    assert_eq!(done(&logs, &out, &[]), "0 logs processed, 12 up to date");
    assert_eq!(files(&out), before);
    assert_eq!(
        done(&logs, &out, &["--retry-failed"]),
        "1 logs processed, 11 up to date"
    );
    assert_eq!(files(&out), before);
    assert_eq!(run(&logs, &out, &["--strict"]).0, Some(3));
    // A damaged outcome is worked out again, to the same bytes.
    let kept = files(&out.join("jobs"));
    let mut names = kept.keys();
    for damage in [&b""[..], b"{\"log\": \"SN0", b"\0\0\0\0"] {
        std::fs::write(out.join("jobs").join(names.next().unwrap()), damage).unwrap();
    }
    let (code, _, stderr) = run(&logs, &out, &["--gather"]);
    assert_eq!(code, Some(1));
    assert!(
        stderr.contains("3 of 12 logs are not processed yet"),
        "{stderr}"
    );
    let (code, stdout, stderr) = run(&logs, &out, &[]);
    assert_eq!(code, Some(0), "{stderr}");
    assert!(stdout.starts_with("3 logs processed, 9 up to date\n"));
    assert!(stderr.contains("3 damaged results in"), "{stderr}");
    assert_eq!(files(&out), before);
    // Nor is a number that was changed taken for a result.
    let (name, whole) = kept.first_key_value().unwrap();
    let text = String::from_utf8(whole.clone()).unwrap();
    let changed = text.replacen("\"outage\": 1", "\"outage\": 2", 1);
    assert_ne!(text, changed);
    std::fs::write(out.join("jobs").join(name), changed).unwrap();
    assert_eq!(done(&logs, &out, &[]), "1 logs processed, 11 up to date");
    assert_eq!(files(&out), before);

    // One changed, one mended, and nothing else.
    let imu = logs.join("SN0/01/imu.csv");
    let text = std::fs::read_to_string(&imu).unwrap();
    std::fs::write(&imu, text.trim_end().rsplit_once('\n').unwrap().0).unwrap();
    let sound = std::fs::read(logs.join("SN1/04/gnss.csv")).unwrap();
    std::fs::write(logs.join("SN1/05/gnss.csv"), sound).unwrap();
    assert_eq!(done(&logs, &out, &[]), "2 logs processed, 10 up to date");
    assert_eq!(summary(&out)["failed"].as_array().unwrap().len(), 0);
    // Other settings are other results.
    assert_eq!(
        done(&logs, &out, &["--bias-models", "white"]),
        "12 logs processed, 0 up to date"
    );
}

/// The numbers are those that `undrift outages` reports.
#[test]
fn a_log_of_many_is_the_log_alone() {
    let logs = simulated("alone");
    let out = logs.join("out");
    done(&logs, &out, &[]);
    let alone = Command::new(env!("CARGO_BIN_EXE_undrift"))
        .arg("outages")
        .arg(logs.join("SN3/10/drive.toml"))
        .args(["--length", "5", "--every", "15", "--start", "75"])
        .args(["--bias-models", "white,arma", "--json", "-"])
        .output()
        .unwrap();
    let alone: serde_json::Value = serde_json::from_slice(&alone.stdout).unwrap();
    let kept = files(&out.join("jobs"))
        .into_values()
        .map(|bytes| serde_json::from_slice::<serde_json::Value>(&bytes).unwrap())
        .find(|outcome| outcome["log"] == "SN3/10/drive.toml")
        .unwrap();
    let columns = kept["columns"].as_array().unwrap();
    let rows = kept["rows"].as_array().unwrap();
    let outages = alone["outages"].as_array().unwrap().len();
    assert_eq!(rows.len(), 2 * outages);
    for (k, row) in rows.iter().enumerate() {
        let outage = &alone["models"][row["part"].as_str().unwrap()]["per_outage"][k % outages];
        assert_eq!(row["outage"], k % outages + 1);
        for (column, value) in columns.iter().zip(row["values"].as_array().unwrap()) {
            let expected = match column.as_str().unwrap().split_once('_').unwrap() {
                ("start", _) => &outage["start_s"],
                ("length", _) => &alone["outages"][k % outages]["length_s"],
                (of, component) => &outage[of][component],
            };
            assert_eq!(value, expected, "{column}");
        }
    }
}

#[test]
fn threads_and_shards_do_not_show() {
    let logs = simulated("shards");
    let [one, two, shards] = ["one", "two", "shards"].map(|name| logs.join(name));
    done(&logs, &one, &["--threads", "1"]);
    done(&logs, &two, &["--threads", "2"]);
    assert_same(&one, &two);

    assert_eq!(
        done(&logs, &shards, &["--shard", "1/2"]),
        "shard 1 of 2: 6 logs processed, 0 up to date"
    );
    assert!(!shards.join("fleet.json").exists());
    let (code, _, stderr) = run(&logs, &shards, &["--gather"]);
    assert_eq!(code, Some(1));
    assert!(
        stderr.contains("6 of 12 logs are not processed yet, first SN0/01/drive.toml"),
        "{stderr}"
    );
    done(&logs, &shards, &["--shard", "2/2"]);
    assert_eq!(
        done(&logs, &shards, &["--gather"]),
        "0 logs processed, 12 up to date"
    );
    assert_same(&one, &shards);
}

#[cfg(unix)]
#[test]
fn what_was_killed_goes_on_where_it_was() {
    let logs = simulated("killed");
    let [whole, killed] = ["whole", "killed"].map(|name| logs.join(name));
    done(&logs, &whole, &[]);
    let mut child = command(&logs, &killed, &["--threads", "1"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let jobs = killed.join("jobs");
    let kept = || {
        let entries = std::fs::read_dir(&jobs).into_iter().flatten().flatten();
        let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
        names.filter(|name| !name.starts_with('.')).count()
    };
    let start = Instant::now();
    while kept() < 3 {
        assert!(start.elapsed() < Duration::from_secs(120));
        std::thread::sleep(Duration::from_millis(1));
    }
    // SIGKILL: nothing can be tidied up.
    child.kill().unwrap();
    child.wait().unwrap();
    let left = kept();
    assert!((3..LOGS).contains(&left), "{left}");
    // As if it had been killed while it wrote.
    let name = files(&whole.join("jobs")).into_keys().next_back().unwrap();
    let half = jobs.join(format!(".{}.part1", name.display()));
    std::fs::write(&half, "{\"log\": \"SN").unwrap();

    let line = done(&logs, &killed, &[]);
    let expected = format!("{} logs processed, {left} up to date", LOGS - left);
    assert_eq!(line, expected);
    assert_same(&whole, &killed);
}

/// One drive file for three folders of logs: three logs by name, with the numbers of the drives themselves. One that was
/// cut in the middle of its inertial log is reported so.
#[test]
fn one_drive_file_for_many_folders() {
    let logs = simulated("template");
    std::fs::copy(logs.join("SN0/00/drive.toml"), logs.join("car.toml")).unwrap();
    let imu = logs.join("SN0/02/imu.csv");
    let text = std::fs::read_to_string(&imu).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    std::fs::write(&imu, lines[..lines.len() * 3 / 4].join("\n") + "\n").unwrap();
    let plan = "outages = { length = \"5 s\", at = \"75, 90 s\" }\nbias_models = [\"arma\"]\n";
    let out = logs.join("out");
    let outcomes = |manifest: &str| {
        std::fs::write(logs.join("fleet.toml"), plan.to_owned() + manifest).unwrap();
        let _ = std::fs::remove_dir_all(&out);
        done(&logs, &out, &[]);
        let kept = files(&out.join("jobs")).into_values();
        kept.map(|text| serde_json::from_slice::<serde_json::Value>(&text).unwrap())
            .map(|outcome| (outcome["log"].as_str().unwrap().to_owned(), outcome))
            .collect::<BTreeMap<_, _>>()
    };
    let alone = outcomes("[[log]]\ndrive = \"SN0/*/drive.toml\"\n");
    let template = outcomes("[[log]]\ndrive = \"car.toml\"\ndata = \"SN0/*\"\ntype = \"cheap\"\n");
    std::fs::write(
        logs.join("logs.csv"),
        "data;name;vehicle\nSN0/00;one;van\nSN0/01;two;van\nSN0/02;three;\n",
    )
    .unwrap();
    let table = outcomes("[[log]]\ndrive = \"car.toml\"\ntable = \"logs.csv\"\n");
    for (k, name) in ["one", "two", "three"].into_iter().enumerate() {
        let own = &alone[&format!("SN0/{k:02}/drive.toml")];
        let by_folder = &template[&format!("SN0/{k:02}/car.toml")];
        assert_eq!(own["rows"].as_array().unwrap().len(), 2);
        assert_eq!(own["rows"][1]["values"][0], 90.0);
        assert_eq!(by_folder["rows"], own["rows"]);
        assert_eq!(by_folder["sensor"], "cheap");
        assert_eq!(table[name]["rows"], own["rows"]);
        let cut = own["findings"].as_array().unwrap().iter();
        let cut: Vec<_> = cut.filter(|f| f["finding"] == "ends_early").collect();
        assert_eq!(cut.len(), usize::from(k == 2), "{own}");
    }
    assert_eq!(table["one"]["labels"]["vehicle"], "van");
    assert_eq!(table["three"]["labels"], serde_json::json!({}));
    let label = serde_json::json!({"label": "vehicle", "left_out": "constant", "by_value": []});
    assert_eq!(
        summary(&out)["measures"][0]["by_label"],
        serde_json::json!([label])
    );
}

#[test]
fn drives_without_a_manifest() {
    let logs = simulated("glob");
    let out = logs.join("out");
    let (code, stdout, stderr) = {
        let output = Command::new(env!("CARGO_BIN_EXE_undrift"))
            .current_dir(&logs)
            .args(["fleet", "SN0/*/drive.toml", "SN1/03/drive.toml"])
            .args(["-o", "out", "--unit", "{parent}", "--bias-models", "arma"])
            .args(["--json", "-"])
            .output()
            .unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        (
            output.status.code(),
            text(output.stdout),
            text(output.stderr),
        )
    };
    assert_eq!(code, Some(0), "{stderr}");
    let json: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!(json, summary(&out));
    assert_eq!(json["tasks"]["outages"], 4);
    assert_eq!(json["measures"][0]["by_unit"][0]["name"], "SN0");

    // The report is what `undrift report` makes of the summary.
    let report = Command::new(env!("CARGO_BIN_EXE_undrift"))
        .arg("report")
        .arg(out.join("fleet.json"))
        .arg("-o")
        .arg(logs.join("again.html"))
        .status()
        .unwrap();
    assert!(report.success());
    let bytes = |path| std::fs::read(path).unwrap();
    assert!(bytes(logs.join("again.html")) == bytes(out.join("fleet.html")));
}

/// Nine records of white noise, one ten times as loud, and a drive that is navigated beside them.
#[test]
fn records_and_navigation() {
    let logs = folder("records");
    let mut state = 1u64;
    for k in 0..9 {
        let mut text = String::from("gz_dps,temp_C\n");
        let std = if k == 4 { 1.0 } else { 0.1 };
        for _ in 0..3000 {
            // The sum of twelve uniform numbers is close to normal, of variance 1.
            let mut sum = -6.0;
            for _ in 0..12 {
                state = state
                    .wrapping_mul(6364136223846793005)
                    .wrapping_add(1442695040888963407);
                sum += (state >> 11) as f64 / (1u64 << 53) as f64;
            }
            text += &format!("{:.6},{k}.5\n", std * sum);
        }
        std::fs::write(logs.join(format!("SN{k}.csv")), text).unwrap();
    }
    let model = ImuModel::preset("adis16405").unwrap();
    let log = SimulatedLog {
        trajectory: &Trajectory::car(150.0, 1),
        rate_hz: 50.0,
        filters: &model.shaping(BiasModel::GaussMarkov, 0.02).unwrap(),
        gnss: &GnssNoise::default(),
        seed: 1,
        model: "adis16405",
        temperature_c: None,
    };
    log.write(&logs.join("drive")).unwrap();
    let manifest = r#"
unit = "{stem}"
identify = { rate = "100 Hz", n_max = 1 }
[[log]]
record = "SN*.csv"
[[log]]
drive = "drive/drive.toml"
task = "navigate"
bias_models = ["arma"]
"#;
    std::fs::write(logs.join("fleet.toml"), manifest).unwrap();
    let out = logs.join("out");
    done(&logs, &out, &[]);
    let json = summary(&out);
    assert_eq!(
        json["tasks"],
        serde_json::json!({"identify": 9, "navigate": 1})
    );
    assert_eq!(json["failed"], serde_json::json!([]));
    assert_eq!(json["logs"][3]["temperature_c"], 3.5);
    let measures = json["measures"].as_array().unwrap();
    let measure = |name: &str| measures.iter().find(|m| m["name"] == name).unwrap();
    let white = &measure("gyro_white_noise")["parts"][0];
    assert_eq!(white["part"], "gyro_z");
    // 0.1 deg/s at 100 Hz is 0.01 deg/√s, 0.6 deg/√h; 3000 samples tell it to some percent.
    let median = white["median"].as_f64().unwrap();
    assert!((0.55..0.65).contains(&median), "{median}");
    // Each record is a unit of its own: the unit is an outlier.
    let units = measure("gyro_white_noise")["by_unit"].as_array().unwrap();
    let found = units.iter().filter(|unit| unit["effect"]["found"] == true);
    let found: Vec<_> = found.map(|unit| &unit["name"]).collect();
    assert_eq!(found, ["SN4"]);
    // What navigate reports of the drive alone.
    let alone = Command::new(env!("CARGO_BIN_EXE_undrift"))
        .arg("navigate")
        .arg(logs.join("drive/drive.toml"))
        .args(["--json", "-"])
        .output()
        .unwrap();
    let alone: serde_json::Value = serde_json::from_slice(&alone.stdout).unwrap();
    for (name, expected) in [
        ("error", &alone["rms_error"]["horizontal_m"]),
        ("nis_position", &alone["position"]["nis_per_dof"]),
    ] {
        let (ours, expected) = (&measure(name)["parts"][0]["median"], expected.as_f64());
        // The summary has six digits.
        let difference = ours.as_f64().unwrap() / expected.unwrap() - 1.0;
        assert!(difference.abs() < 1e-5, "{name}: {difference:e}");
    }
}

#[test]
fn impossible_requests_are_reported() {
    let folder = folder("impossible");
    let logs = folder.join("fleet.toml");
    for (text, wanted) in [
        ("unit = 3\n", "line 1, unit: must be a string"),
        (
            "[[log]]\ndrive = \"*.toml\"\nunits = \"a\"\n",
            "line 3, log.units: unknown key",
        ),
        (
            "[[log]]\ndrive = \"none/*\"\n",
            "line 2, log.drive: \"none/*\" matches no file",
        ),
        (
            "[[log]]\ndrive = \"gone.toml\"\n",
            "gone.toml: no such file\nerror: no log could be processed",
        ),
        (
            "[[log]]\nrecord = \"fleet.toml\"\n",
            "error: no log could be processed",
        ),
    ] {
        std::fs::write(&logs, text).unwrap();
        let (code, _, stderr) = run(&folder, &folder.join("out"), &[]);
        assert_eq!(code, Some(1), "{stderr}");
        assert!(stderr.contains(wanted), "{stderr}");
    }
    let (code, _, stderr) = run(&folder, Path::new("s3://bucket/out"), &[]);
    assert_eq!(code, Some(2));
    assert!(stderr.contains("s3://bucket/out: the command reads and writes"));
    for wrong in [["--shard", "0/2"], ["--shard", "3/2"], ["--shard", "one"]] {
        assert_eq!(run(&folder, &folder.join("out"), &wrong).0, Some(2));
    }
}

#[test]
fn a_fleet_is_tuned_drive_by_drive() {
    let logs = simulated("tuned");
    let out = logs.join("out");
    let drives = logs.join("SN3/*/drive.toml");
    let Output { status, stderr, .. } = Command::new(env!("CARGO_BIN_EXE_undrift"))
        .arg("fleet")
        .arg(drives)
        .args(["--task", "tune", "--unit", "{parent}", "-o"])
        .arg(&out)
        .output()
        .unwrap();
    assert!(status.success(), "{}", String::from_utf8_lossy(&stderr));
    let json = summary(&out);
    assert_eq!(json["tasks"]["tune"], 3);
    let drift = json["measures"].as_array().unwrap();
    let drift = drift.iter().find(|m| m["name"] == "tuned_drift").unwrap();
    assert_eq!(drift["parts"][0]["part"], "10 s");
    assert_eq!(drift["parts"][0]["logs"], 3);
    assert_eq!(drift["by_unit"][0]["name"], "SN3");
    for log in json["logs"].as_array().unwrap() {
        // What a filter with the true noise has is 0.5 m; with any at all, some metres.
        let drift = log["values"]["tuned_drift"]["10 s"].as_f64().unwrap();
        assert!(drift < 3.0, "{log}");
    }
}

/// Tuned drive files of several drives go into a folder, each ready for a run.
#[test]
fn drives_are_tuned_into_a_folder() {
    let logs = simulated("tuned-folder");
    let undrift = |arguments: &[&str]| {
        let done = Command::new(env!("CARGO_BIN_EXE_undrift"))
            .args(arguments)
            .current_dir(&logs)
            .output()
            .unwrap();
        (done.status, String::from_utf8(done.stderr).unwrap())
    };
    let drives = std::fs::read_dir(logs.join("SN3")).unwrap();
    let mut names: Vec<String> = drives
        .map(|drive| drive.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    let files: Vec<String> = names[..2]
        .iter()
        .map(|name| {
            let file = format!("SN3/{name}/{name}.toml");
            std::fs::rename(
                logs.join(format!("SN3/{name}/drive.toml")),
                logs.join(&file),
            )
            .unwrap();
            file
        })
        .collect();
    std::fs::create_dir(logs.join("tuned")).unwrap();
    let (status, stderr) = undrift(&["tune", &files[0], &files[1], "-o", "tuned"]);
    assert!(status.success(), "{stderr}");
    for name in &names[..2] {
        let (status, stderr) = undrift(&["navigate", &format!("tuned/{name}.toml"), "--quiet"]);
        assert!(status.success(), "{stderr}");
    }
    let (status, stderr) = undrift(&["tune", &files[0], &files[0], "-o", "tuned"]);
    assert!(
        !status.success() && stderr.contains("same file name"),
        "{stderr}"
    );
}
