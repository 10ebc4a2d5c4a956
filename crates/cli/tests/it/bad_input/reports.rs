//! Reports: from a result's JSON the same file as from the verb, and nothing of a result is trusted.

use super::log::{Case, Log, says};
use crate::schema;
use serde_json::Value;
use std::path::Path;

const SPEC: &str = r#"model = "adis16465"
bias_model = "gauss-markov"
[filter]
bias_models = ["gauss-markov", "white"]
[drive]
kind = "car"
duration = "150 s"
rate = "50 Hz"
seed = 1
[gnss]
rate = "1 Hz"
position_std = "1, 1, 2 m"
velocity_std = "0.1, 0.1, 0.1 m/s"
"#;

fn text(case: &Case, name: &str) -> String {
    std::fs::read_to_string(case.path(name)).unwrap()
}

fn json(case: &Case, name: &str) -> Value {
    serde_json::from_str(&text(case, name)).unwrap()
}

/// Runs a verb with --report and --json, then `report` on what it wrote; the report.
fn same_report(case: &Case, verb: &[&str]) -> String {
    let outputs = ["--report", "verb.html", "--json", "result.json"];
    let outcome = case.run(&[verb, &outputs].concat());
    assert!(outcome.succeeded(), "{verb:?}: {}", outcome.stderr);
    let outcome = case.run(&["report", "result.json", "-o", "report.html"]);
    assert!(outcome.succeeded(), "{}", outcome.stderr);
    schema::conforms(&text(case, "result.json"));
    let report = text(case, "report.html");
    assert!(
        report == text(case, "verb.html"),
        "the reports of {verb:?} differ"
    );
    report
}

/// A short record of white noise, two axes.
fn record() -> String {
    let mut state = 1u64;
    let mut uniform = move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 33) as f64 / f64::from(1u32 << 31) - 0.5
    };
    let rows = (0..4000).map(|_| {
        // Twelve uniform numbers make a nearly normal one.
        let mut normal = || (0..12).map(|_| uniform()).sum::<f64>();
        format!("{:.6},{:.6}\n", normal(), 0.01 * normal())
    });
    format!("gz_dps,ax_g\n{}", rows.collect::<String>())
}

#[test]
fn the_report_of_a_verb_is_that_of_its_json() {
    let case = Log::good().write("report_same");
    case.put("spec.toml", SPEC.as_bytes());
    case.put("record.csv", record().as_bytes());
    for (kind, verb, words) in [
        (
            "navigate",
            &["navigate", "drive.toml"] as &[&str],
            "Errors against the truth",
        ),
        (
            "outages",
            &[
                "outages",
                "drive.toml",
                "--start",
                "40",
                "--count",
                "3",
                "--length",
                "5",
                "--bias-models",
                "white,arma",
            ],
            "Least horizontal drift: ",
        ),
        (
            "montecarlo",
            &["montecarlo", "spec.toml", "--runs", "3"],
            "Normalised estimation error squared",
        ),
        (
            "identify",
            &["identify", "record.csv", "--rate", "100"],
            "Gyro z",
        ),
    ] {
        let report = same_report(&case, verb);
        says(&report, &[words]);
        let result = json(&case, "result.json");
        assert_eq!(result["kind"], kind);
        assert_eq!(result["undrift"], env!("CARGO_PKG_VERSION"));
    }
}

#[test]
fn the_demo_has_a_report() {
    let case = Log::good().write("report_demo");
    let report = same_report(&case, &["demo", "--drives", "1"]);
    let parts = [
        "Without GNSS the recommended noise model drifts",
        "Not better than others",
        "No model to choose",
    ];
    says(&report, &parts);
}

#[test]
fn the_series_hold_the_extremes_of_the_solution() {
    let case = Log::good().write("report_series");
    let arguments = [
        "navigate",
        "drive.toml",
        "-o",
        "nav.csv",
        "--json",
        "result.json",
    ];
    assert!(case.run(&arguments).succeeded());
    let series = json(&case, "result.json")["series"]["motion"]["vn_mps"]["value"].clone();
    let values: Vec<f64> = serde_json::from_value(series).unwrap();
    let nav = text(&case, "nav.csv");
    let mut lines = nav.lines();
    let column = lines
        .next()
        .unwrap()
        .split(',')
        .position(|c| c == "vn_mps")
        .unwrap();
    let solution: Vec<f64> = lines
        .map(|line| line.split(',').nth(column).unwrap().parse().unwrap())
        .collect();
    let largest = |v: &[f64]| v.iter().copied().fold(f64::MIN, f64::max);
    // The series has six digits, the solution four decimals.
    assert!((largest(&values) - largest(&solution)).abs() < 2e-4);
    assert!(solution.len() > values.len());
}

/// Numbers of a column of a track.
fn column(track: &Value, name: &str) -> Vec<f64> {
    serde_json::from_value(track[name].clone()).unwrap()
}

/// Metres east and north of a place of the track nearby, in radians.
fn metres(track: &Value, at: usize, [lat_0, lon_0]: [f64; 2]) -> [f64; 2] {
    const RADIUS: f64 = 6_378_137.0;
    let [lat, lon] = place(track, at);
    // Groves eq. 2.105 and 2.106.
    let w = 1.0 - 0.006_694_38 * lat_0.sin().powi(2);
    let north = RADIUS * (1.0 - 0.006_694_38) / w.powf(1.5);
    let east = RADIUS / w.sqrt() * lat_0.cos();
    [east * (lon - lon_0), north * (lat - lat_0)]
}

/// Latitude and longitude \[rad\].
fn place(track: &Value, at: usize) -> [f64; 2] {
    ["lat_deg", "lon_deg"].map(|name| column(track, name)[at].to_radians())
}

#[test]
fn ways_through_outages_end_as_far_off_as_the_errors_say() {
    let case = Log::good().write("report_ways");
    let outages = ["outages", "drive.toml", "--start", "40", "--count", "3"];
    let more = ["--length", "5", "--bias-models", "white,arma"];
    let json_out = ["--json", "result.json"];
    assert!(
        case.run(&[&outages as &[&str], &more, &json_out].concat())
            .succeeded()
    );
    let result = json(&case, "result.json");
    let track = &result["series"]["track"];
    let times = column(track, "time_s");
    for model in ["white", "arma"] {
        let way = &result["series"]["ways"][model];
        let on_way = column(way, "time_s");
        assert!(on_way.len() <= 1003, "{}", on_way.len());
        for (k, cut) in result["outages"].as_array().unwrap().iter().enumerate() {
            let end = cut["start_s"].as_f64().unwrap() + cut["length_s"].as_f64().unwrap();
            let last = on_way.iter().rposition(|t| *t <= end + 0.01).unwrap();
            assert!(
                end - on_way[last] < 0.11,
                "{model}: {} of {end}",
                on_way[last]
            );
            // Where the truth was then, between two of its places.
            let after = times.iter().position(|t| *t >= on_way[last]).unwrap();
            let share = (on_way[last] - times[after - 1]) / (times[after] - times[after - 1]);
            let near = place(track, after);
            let (from, to) = (metres(track, after - 1, near), metres(track, after, near));
            let truth = [0, 1].map(|i| from[i] + share * (to[i] - from[i]));
            let here = metres(way, last, near);
            let off = (here[0] - truth[0]).hypot(here[1] - truth[1]);
            let error = &result["models"][model]["per_outage"][k]["end"]["horizontal_m"];
            let error = error.as_f64().unwrap();
            // A tenth of a second before the end, and millimetres in the degrees.
            assert!(
                (off - error).abs() < 0.05 + 0.1 * error,
                "{model}: {off} m, {error} m"
            );
        }
    }
}

#[test]
fn fixes_are_kept_with_their_standard_deviations() {
    let case = Log::good().write("report_fixes");
    assert!(
        case.run(&["navigate", "drive.toml", "--json", "result.json"])
            .succeeded()
    );
    let result = json(&case, "result.json");
    let fixes = &result["series"]["fixes"];
    let times = column(fixes, "time_s");
    let used = &result["summary"]["position"]["updates"];
    assert_eq!(times.len() as u64, used.as_u64().unwrap().min(1000));
    // As the log has them.
    let log = text(&case, "gnss.csv");
    for (i, time) in times.iter().enumerate().step_by(7) {
        let row = log.lines().skip(1).map(|line| {
            let cells = line
                .split(',')
                .map(|cell| cell.parse::<f64>().unwrap_or(f64::NAN));
            cells.collect::<Vec<f64>>()
        });
        let row = row.min_by(|a, b| (a[0] - time).abs().total_cmp(&(b[0] - time).abs()));
        let row = row.unwrap();
        assert!((row[1] - column(fixes, "lat_deg")[i]).abs() < 1e-8);
        assert!((row[2] - column(fixes, "lon_deg")[i]).abs() < 1e-8);
    }
    assert!(column(fixes, "std_north_m").iter().all(|std| *std > 0.0));
    assert!(column(fixes, "std_east_m").iter().all(|std| *std > 0.0));
}

/// Two model files of one stem, compared in the same outages: each has the drift that it has alone.
#[test]
fn noise_models_are_compared_side_by_side() {
    let case = Log::good().write("report_models");
    let outages = |more: &[&str]| {
        let plan = "outages drive.toml --start 40 --count 3 --length 5";
        case.run(&[&plan.split(' ').collect::<Vec<_>>(), more].concat())
    };
    for (preset, file) in [("mpu6050", "imu.toml"), ("adis16405", "b.toml")] {
        let model = case.run(&["model", preset, "--to", "undrift"]).stdout;
        case.put(file, model.as_bytes());
    }
    let models = [
        "--model", "imu.toml", "--model", "b.toml", "--model", "imu.toml",
    ];
    let done = outages(&[&models as &[&str], &["--json", "both.json"]].concat());
    assert!(done.succeeded(), "{}", done.stderr);
    says(&done.stdout, &["noise models run as arma", "\nimu-2 "]);
    let both = json(&case, "both.json");
    let names = ["imu", "b", "imu-2"];
    assert_eq!(both["order"], serde_json::json!(names));
    assert_eq!(both["models"]["imu"], both["models"]["imu-2"]);
    for (name, file) in [("imu", "imu.toml"), ("b", "b.toml")] {
        assert_eq!(both["noise_models"][name]["bias_model"], "arma");
        let alone = [
            "--model",
            file,
            "--bias-models",
            "arma",
            "--json",
            "one.json",
        ];
        assert!(outages(&alone).succeeded());
        let one = json(&case, "one.json");
        assert_eq!(one["models"]["arma"], both["models"][name], "{name}");
        assert!(one.get("noise_models").is_none());
    }
    // One bias model for all, or several of one noise model.
    let white = [
        &models as &[&str],
        &["--bias-models", "white", "--json", "white.json"],
    ]
    .concat();
    assert!(outages(&white).succeeded());
    assert_eq!(
        json(&case, "white.json")["noise_models"]["b"]["bias_model"],
        "white"
    );
    let several = outages(&[&models as &[&str], &["--bias-models", "white,arma"]].concat());
    assert_eq!(several.code, Some(2));
    let said = "3 --model are compared as one bias model, but --bias-models has 2";
    says(&several.stderr, &[said]);
}

/// The tables of a report as files: the same numbers in each format.
#[test]
fn tables_are_written_by_the_extension_of_the_report() {
    let case = Log::good().write("report_tables");
    let plan = "outages drive.toml --start 40 --count 3 --length 5 --bias-models white,arma";
    let plan: Vec<&str> = plan.split(' ').collect();
    let done = case.run(&[&plan as &[&str], &["--report", "t.csv", "--json", "r.json"]].concat());
    assert!(done.succeeded(), "{}", done.stderr);
    for name in ["t.md", "t.TEX"] {
        let done = case.run(&["report", "r.json", "-o", name]);
        assert!(done.succeeded(), "{}", done.stderr);
    }
    let rms = &json(&case, "r.json")["models"]["arma"]["rms"]["horizontal_m"];
    let csv = text(&case, "t.csv");
    let mut rows = csv.lines().map(|row| row.split(',').collect::<Vec<_>>());
    let head = rows.next().unwrap();
    let row = rows.find(|row| row[..2] == ["errors-rms", "arma"]).unwrap();
    let cell = row[head
        .iter()
        .position(|name| *name == "horizontal [m]")
        .unwrap()];
    let difference = cell.parse::<f64>().unwrap() / rms.as_f64().unwrap() - 1.0;
    // Three digits of it.
    assert!(difference.abs() < 0.005, "{cell} {rms}");
    says(&text(&case, "t.md"), &["\n| model | N [m] |", cell]);
    says(
        &text(&case, "t.TEX"),
        &["\\toprule", "\\label{tab:errors-rms}", cell],
    );
    let done = case.run(&["report", "r.json", "-o", "t.pdf"]);
    assert_eq!(done.code, Some(2));
    says(&done.stderr, &[".md, .tex or .csv", "t.html"]);
}

#[test]
fn results_of_a_kind_are_compared_and_of_several_follow_each_other() {
    let case = Log::good().write("report_compare");
    let outages = [
        "outages",
        "drive.toml",
        "--start",
        "40",
        "--count",
        "3",
        "--length",
        "5",
    ];
    for (name, models) in [("a.json", "white,arma"), ("b.json", "arma")] {
        let more = ["--bias-models", models, "--json", name];
        assert!(case.run(&[&outages as &[&str], &more].concat()).succeeded());
    }
    for model in ["arma", "white"] {
        let name = format!("{model}.json");
        let arguments = [
            "navigate",
            "drive.toml",
            "--bias-model",
            model,
            "--json",
            &name,
        ];
        assert!(case.run(&arguments).succeeded());
    }
    let report = |files: &[&str]| {
        let arguments = [&["report"], files, &["-o", "out.html"]].concat();
        let outcome = case.run(&arguments);
        assert!(outcome.succeeded(), "{}", outcome.stderr);
        text(&case, "out.html")
    };
    let compared = report(&["a.json", "b.json"]);
    says(
        &compared,
        &["2 results compared", "a: white", "a: arma", "b: arma"],
    );
    let compared = report(&["arma.json", "white.json"]);
    says(
        &compared,
        &[
            "2 results compared",
            "white: position",
            "Errors against the truth",
        ],
    );
    let both = report(&["a.json", "arma.json"]);
    says(
        &both,
        &["Navigation: Solution", "Outages: Drift without GNSS"],
    );
}

#[test]
fn figures_become_files() {
    let case = Log::good().write("report_figures");
    let outcome = case.run(&["navigate", "drive.toml", "--figures", "figures"]);
    assert!(outcome.succeeded(), "{}", outcome.stderr);
    let figures = case.path("figures");
    let count = |end: &str| {
        let files = std::fs::read_dir(&figures).unwrap().flatten();
        files
            .filter(|f| f.path().extension().is_some_and(|e| e == end))
            .count()
    };
    // PNG comes from the page.
    assert!(count("svg") >= 8 && count("png") == 0);
    // A result that is called like one of its figures stays.
    let outcome = case.run(&["navigate", "drive.toml", "--json", "nav.json"]);
    assert!(outcome.succeeded(), "{}", outcome.stderr);
    let mut files = std::fs::read_dir(&figures).unwrap().flatten();
    let figure = format!("figures/{}", files.next().unwrap().file_name().display());
    std::fs::copy(case.path("nav.json"), case.path(&figure)).unwrap();
    let outcome = case.run(&["report", &figure, "--figures", "figures"]);
    assert_eq!(outcome.code, Some(1), "{}", outcome.stderr);
    says(&outcome.stderr, &["this run reads it"]);
    assert!(case.read(&figure) == case.read("nav.json"));
}

#[test]
fn names_are_text_and_never_markup() {
    let hostile = "<img src=x onerror=alert(1)>&\"'";
    let mut log = Log::good();
    log.set(
        "model = \"adis16465\"",
        "model = { preset = \"adis16465\", name = \"<script>alert(2)</script>\" }",
    );
    log.set("file = \"imu.csv\"", "file = '<b>imu.csv'");
    let case = log.write("report_hostile");
    std::fs::rename(case.path("imu.csv"), case.path("<b>imu.csv")).unwrap();
    let report = same_report(&case, &["navigate", "drive.toml"]);
    assert!(report.contains("&lt;b&gt;imu.csv") && !report.contains("<b>imu.csv"));
    assert!(!report.contains("<script>alert"));
    // Names in the result itself.
    let mut result = json(&case, "result.json");
    result["bias_model"] = hostile.into();
    result["warnings"] = serde_json::json!([hostile, "</script><script>alert(3)"]);
    case.put("changed.json", result.to_string().as_bytes());
    let outcome = case.run(&[
        "report",
        "changed.json",
        "changed.json",
        "result.json",
        "-o",
        "out.html",
    ]);
    assert!(outcome.succeeded(), "{}", outcome.stderr);
    let report = text(&case, "out.html");
    assert!(!report.contains("<img src=x") && !report.contains("<script>alert"));
}

#[test]
fn a_file_that_is_no_result_is_refused() {
    let case = Log::good().write("report_damaged");
    assert!(
        case.run(&["navigate", "drive.toml", "--json", "good.json"])
            .succeeded()
    );
    let good = text(&case, "good.json");
    let mut wrong = json(&case, "good.json");
    wrong["summary"]["samples"] = "many".into();
    let mut unknown = json(&case, "good.json");
    unknown["kind"] = "dance".into();
    let pretty = |value: &Value| format!("{value:#}");
    for (name, damaged, words) in [
        (
            "empty.json",
            String::new(),
            "not JSON; give a file that --json wrote",
        ),
        (
            "half.json",
            good[..good.len() / 2].to_owned(),
            "half.json line",
        ),
        ("list.json", "[1, 2]".into(), "not a result of undrift"),
        ("other.json", "{\"a\": 1}".into(), "missing field `undrift`"),
        (
            "table.csv",
            text(&case, "imu.csv"),
            "not a result of undrift",
        ),
        ("wrong.json", pretty(&wrong), "(key summary.samples)"),
        (
            "unknown.json",
            pretty(&unknown),
            "unknown kind \"dance\"; known: identify, navigate",
        ),
    ] {
        case.put(name, damaged.as_bytes());
        let outcome = case.run(&["report", "good.json", name, "-o", "out.html"]);
        assert_eq!(outcome.code, Some(1), "{name}: {}", outcome.stderr);
        says(&outcome.stderr, &[name, "not a result of undrift", words]);
        assert!(!Path::new(&case.path("out.html")).exists());
    }
    // Parts that are missing or of no size are left out.
    for sparse in [
        "{\"undrift\": \"9\", \"kind\": \"navigate\"}",
        "{\"undrift\": \"9\", \"kind\": \"outages\", \"models\": {\"a\": {}}, \"order\": [\"a\", \"b\"]}",
        "{\"undrift\": \"9\", \"kind\": \"identify\", \"axes\": {\"gyro_x\": {}, \"sideways\": {}}}",
        "{\"undrift\": \"9\", \"kind\": \"montecarlo\", \"models\": [{\"nees\": [{}], \"nis\": [{}]}]}",
        "{\"undrift\": \"9\", \"kind\": \"demo\"}",
    ] {
        case.put("sparse.json", sparse.as_bytes());
        for files in [
            &["sparse.json"] as &[&str],
            &["sparse.json", "sparse.json", "good.json"],
        ] {
            let outcome = case.run(&[&["report"], files, &["-o", "out.html"]].concat());
            assert!(outcome.succeeded(), "{sparse}: {}", outcome.stderr);
        }
    }
}
