//! The tables of exit codes in docs/terminal.md: `--help` has the first, and every verb ends with each code of it.

use super::bad_input::{drives::good, log::Case};
use std::process::Command;

const PAGE: &str = include_str!("../../../../docs/terminal.md");

/// The first two cells of the rows of the page's table with this header, without backticks.
fn table(header: &str) -> Vec<(String, String)> {
    let (_, below) = PAGE.split_once(&format!("{header}\n|---|---|\n")).unwrap();
    let rows = below.lines().take_while(|line| line.starts_with('|'));
    let cells = rows.map(|row| {
        let row = row.trim_matches('|').replace('`', "");
        let (first, second) = row.split_once('|').unwrap();
        (first.trim().to_owned(), second.trim().to_owned())
    });
    cells.collect()
}

/// The verbs that never end with 3.
fn never() -> Vec<String> {
    let rows = table("| verb | its result |");
    let (verbs, _) = rows.iter().find(|(_, when)| when == "never").unwrap();
    verbs.split(", ").map(str::to_owned).collect()
}

/// Command lines with the code that each ends with, in the folder that [`folder`] makes.
const ENDS: [(&str, i32, &str); 45] = [
    ("navigate", 0, "drive.toml --strict"),
    ("navigate", 1, "nowhere.toml"),
    ("navigate", 2, "--strict"),
    ("navigate", 3, "wrong.toml --strict"),
    (
        "outages",
        0,
        "drive.toml --at 60,110 --bias-models arma --strict",
    ),
    ("outages", 1, "drive.toml --start 500 --count 2"),
    ("outages", 0, "drive.toml"),
    ("outages", 2, "drive.toml --count 2 --length 0"),
    ("outages", 2, "drive.toml --count 2 --track track.csv"),
    (
        "outages",
        3,
        "wrong.toml --at 60,110 --bias-models arma --strict",
    ),
    ("tune", 1, "nowhere.toml"),
    ("tune", 2, "drive.toml --hold-out 30"),
    (
        "tune",
        2,
        "drive.toml drive.toml wrong.toml --data . --data .",
    ),
    // Not tested, so usable with care.
    ("tune", 3, "short.toml --strict"),
    ("identify", 0, "record.csv --strict"),
    ("identify", 1, "nowhere.csv"),
    ("identify", 2, "record.csv --units dgs/s,g"),
    ("identify", 2, "record.csv record.csv"),
    // An axis without a result, and one that is saturated.
    ("identify", 3, "constant.csv --strict"),
    ("identify", 3, "saturated.csv --strict"),
    ("montecarlo", 0, "spec.toml --runs 2 --strict"),
    ("montecarlo", 1, "drive.toml"),
    ("montecarlo", 2, "spec.toml --figure nees.png"),
    ("montecarlo", 3, "lost.toml --runs 2 --strict"),
    (
        "fleet",
        0,
        "drive.toml -o fleet0 --task navigate --bias-models arma --strict",
    ),
    (
        "fleet",
        1,
        "broken.toml -o fleet1 --task navigate --bias-models arma",
    ),
    ("fleet", 2, "drive.toml -o s3://bucket/out"),
    (
        "fleet",
        3,
        "drive.toml broken.toml -o fleet2 --task navigate --bias-models arma --strict",
    ),
    (
        "fleet",
        3,
        "drive.toml wrong.toml -o fleet3 --task navigate --bias-models arma --strict",
    ),
    ("demo", 1, "--data nowhere"),
    ("demo", 2, "--drives 0"),
    ("inspect", 0, "imu.csv gnss.csv --strict"),
    ("inspect", 1, "imu.csv nowhere.csv"),
    ("inspect", 2, ""),
    ("model", 0, "adis16465 --to kalibr --rate 100 --strict"),
    ("model", 1, "adis16456 --to kalibr"),
    ("model", 2, "adis16465 --to kalibr --rate 0"),
    // A report of what is not usable is a report.
    ("report", 0, "wrong.json -o report.html --strict"),
    ("report", 1, "gnss.csv -o report.html"),
    ("report", 2, "wrong.json"),
    ("sample", 1, "imu.csv/below"),
    ("sample", 2, ""),
    ("completions", 2, "csh"),
    ("man", 1, "-o imu.csv/below"),
    ("man", 2, "--nothing"),
];

/// The same where it takes seconds.
const SLOW: [(&str, i32, &str); 5] = [
    ("sample", 0, "logs --strict"),
    ("tune", 0, "logs/drive/part.toml --strict"),
    ("demo", 0, "--drives 1 --strict"),
    ("completions", 0, "bash --strict"),
    ("man", 0, "--strict"),
];

/// What a verb has no way to end with: it reads and writes no file.
const IMPOSSIBLE: [(&str, i32); 1] = [("completions", 1)];

/// The town drive; the same with rad/s called deg/s, without a column and of half a minute; recordings and
/// specifications.
fn folder(name: &str) -> Case {
    let case = good().write(name);
    let drive = |file: &str, from: &str, to: &str| {
        let mut log = good();
        case.put(file, log.set(from, to).drive.as_bytes());
    };
    drive("wrong.toml", "\"rad/s\"", "\"deg/s\"");
    drive("broken.toml", "\"lon\"", "\"longitude\"");
    drive("short.toml", "[truth]", "[span]\nend = \"30 s\"\n[truth]");
    for (file, of) in [
        ("record.csv", (|x| x) as fn(f64) -> f64),
        ("constant.csv", |_| 0.1),
        ("saturated.csv", |x| x.clamp(-0.05, 0.05)),
    ] {
        case.put(file, record(of).as_bytes());
    }
    case.put("spec.toml", SPEC.as_bytes());
    // Fixes a thousand times as far off as they state.
    let lost = SPEC.replace("[initial]", "noise_scale = 1000\n[initial]");
    case.put("lost.toml", lost.as_bytes());
    case.run(&["navigate", "wrong.toml", "--json", "wrong.json"]);
    case
}

const SPEC: &str = r#"model = "adis16465"
[filter]
bias_models = ["white"]
[drive]
kind = "car"
duration = "120 s"
rate = "20 Hz"
[gnss]
rate = "1 Hz"
[initial]
truth_std = "1 deg"
[epochs]
settle = "10 s"
"#;

/// Half a minute at rest at 100 Hz, the first gyro changed.
fn record(of: fn(f64) -> f64) -> String {
    let mut text = String::from("t_s,gx_dps,gy_dps,gz_dps,ax_g,ay_g,az_g\n");
    let mut state = 1u64;
    let mut noise = || {
        let mut sum = -6.0;
        for _ in 0..12 {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            sum += (state >> 11) as f64 / (1u64 << 53) as f64;
        }
        sum
    };
    for k in 0..3000 {
        let [x, y, z] = [0.1, 0.1, 0.1].map(|scale| scale * noise());
        let [fx, fy, fz] = [0.001; 3].map(|scale| scale * noise());
        let (x, fz) = (of(x), fz - 1.0);
        text += &format!(
            "{:.2},{x:.6},{y:.6},{z:.6},{fx:.6},{fy:.6},{fz:.6}\n",
            f64::from(k) / 100.0
        );
    }
    text
}

#[track_caller]
fn ends(case: &Case, (verb, code, arguments): (&str, i32, &str)) {
    let words = |strict: &str| {
        let all = format!("{verb} {arguments}");
        let words = all.split_whitespace().filter(|word| *word != strict);
        case.run(&Vec::from_iter(words))
    };
    let outcome = words("");
    let said = format!("{verb} {arguments}: {}", outcome.stderr);
    assert_eq!(outcome.code, Some(code), "{said}");
    if code == 3 {
        assert_eq!(words("--strict").code, Some(0), "without --strict: {said}");
    }
}

#[test]
fn every_verb_ends_with_the_codes_of_the_page() {
    let case = folder("exit_codes");
    for end in ENDS {
        ends(&case, end);
    }
}

#[test]
#[ignore = "slow: a demo and a tuning"]
fn every_verb_ends_with_0_where_it_takes_seconds() {
    let case = folder("exit_codes_slow");
    ends(&case, SLOW[0]);
    let drive = std::fs::read_to_string(case.path("logs/drive/drive.toml")).unwrap();
    case.put(
        "logs/drive/part.toml",
        format!("{drive}\n[span]\nend = \"500 s\"\n").as_bytes(),
    );
    for end in &SLOW[1..] {
        ends(&case, *end);
    }
}

/// A verb or code that is not tried above would be of the tables by word alone.
#[test]
fn every_verb_and_code_of_the_page_is_tried() {
    let verbs = table("| verb | what it does |");
    let verbs = verbs.iter().flat_map(|(names, _)| names.split(", "));
    let verbs: Vec<&str> = verbs.collect();
    let listed = table("| verb | its result |");
    let mut listed: Vec<&str> = listed
        .iter()
        .flat_map(|(names, _)| names.split(", "))
        .collect();
    listed.sort_unstable();
    let mut all = verbs.clone();
    all.sort_unstable();
    assert_eq!(listed, all, "verbs of the two tables");
    let never = never();
    for verb in verbs {
        for code in 0..=3 {
            let tried = ENDS
                .iter()
                .chain(&SLOW)
                .any(|(v, c, _)| (*v, *c) == (verb, code));
            let impossible = IMPOSSIBLE.contains(&(verb, code))
                || (code == 3 && never.iter().any(|of| of == verb));
            assert!(tried != impossible, "{verb} with {code}");
        }
    }
}

#[test]
fn the_help_has_the_codes_of_the_page() {
    let help = Command::new(env!("CARGO_BIN_EXE_undrift"))
        .arg("--help")
        .output()
        .unwrap();
    let help = String::from_utf8(help.stdout).unwrap();
    let (_, codes) = help.split_once("Exit codes:\n").unwrap();
    let codes = codes.lines().take_while(|line| !line.is_empty());
    let codes = codes.map(|line| line.trim().split_once("  ").unwrap());
    let codes: Vec<_> = codes
        .map(|(code, means)| (code.to_owned(), means.trim().to_owned()))
        .collect();
    assert_eq!(codes, table("| code | meaning |"));
}
