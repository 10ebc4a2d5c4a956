//! What the command shows on a terminal and what it keeps to itself elsewhere.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

const ESCAPE: char = '\u{1b}';

fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("terminal_{name}"));
    // Left by an earlier run, if it is there.
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// What an environment may say of colours and widths; `CI` makes even a dumb terminal one with colours.
const OF_THE_ENVIRONMENT: [&str; 6] = [
    "NO_COLOR",
    "CLICOLOR",
    "CLICOLOR_FORCE",
    "CI",
    "TERM",
    "COLUMNS",
];

/// The command in a plain environment.
fn undrift(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_undrift"));
    command.args(arguments).env("LC_ALL", "C.UTF-8");
    for name in OF_THE_ENVIRONMENT {
        command.env_remove(name);
    }
    command
}

struct Said {
    code: Option<i32>,
    stdout: String,
    stderr: String,
}

fn said(command: &mut Command) -> Said {
    let Output {
        status,
        stdout,
        stderr,
    } = command.output().unwrap();
    let said = Said {
        code: status.code(),
        stdout: String::from_utf8(stdout).unwrap(),
        stderr: String::from_utf8(stderr).unwrap(),
    };
    assert!(!said.stderr.contains("panicked"), "{}", said.stderr);
    said
}

/// The command on a terminal of its own; `None` where `script` of util-linux is missing.
fn on_terminal(command: &str) -> Option<String> {
    let mut script = Command::new("script");
    for name in OF_THE_ENVIRONMENT {
        script.env_remove(name);
    }
    let output = script
        .args(["-qec", command, "/dev/null"])
        .env("TERM", "xterm-256color")
        .env("UNDRIFT", env!("CARGO_BIN_EXE_undrift"))
        .stdin(Stdio::null())
        .output()
        .ok()?;
    Some(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// A record of two axes at 100 Hz, with an invalid row: white noise of a generator of the test's own.
fn record(folder: &Path, rows: usize) -> String {
    let mut text = String::from("gz_dps,az_g\nnot,numbers\n");
    let mut state = 1u64;
    let mut noise = || {
        let mut sum = -6.0;
        for _ in 0..12 {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            sum += (state >> 11) as f64 / (1u64 << 53) as f64;
        }
        sum
    };
    for _ in 0..rows {
        text += &format!("{:.6},{:.6}\n", 0.1 * noise(), -1.0 + 0.001 * noise());
    }
    let path = folder.join("record.csv");
    std::fs::write(&path, text).unwrap();
    path.display().to_string()
}

fn identify<'a>(record: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let arguments = ["identify", record, "--rate", "100"];
    let columns = ["--columns", "gz_dps", "--axis", "gyro_z"];
    [&arguments[..], &columns, &["--units", "deg/s"], more].concat()
}

#[test]
fn no_escape_codes_in_pipes() {
    let record = record(&folder("pipes"), 3000);
    let said_plain = said(&mut undrift(&identify(&record, &["--plot"])));
    assert_eq!(said_plain.code, Some(0), "{}", said_plain.stderr);
    assert!(
        said_plain.stderr.starts_with("warning: "),
        "{}",
        said_plain.stderr
    );
    for arguments in [
        identify(&record, &["--plot"]),
        vec!["identify", "nowhere.csv"],
        vec!["--help"],
        vec!["outages"],
    ] {
        let said = said(&mut undrift(&arguments));
        assert!(!said.stdout.contains(ESCAPE), "{}", said.stdout);
        assert!(!said.stderr.contains(ESCAPE), "{}", said.stderr);
    }
}

#[test]
fn colours_when_they_are_asked_for() {
    let record = record(&folder("colours"), 3000);
    let arguments = identify(&record, &["--plot", "--color", "always"]);
    let coloured = said(&mut undrift(&arguments));
    // The table has a heading, the curve blue, the warning yellow.
    assert!(coloured.stdout.contains("\u{1b}[1mturn-on\u{1b}[0m"));
    assert!(coloured.stdout.contains("\u{1b}[34m"));
    assert!(
        coloured
            .stderr
            .contains("\u{1b}[1m\u{1b}[33mwarning:\u{1b}[0m ")
    );
    // The option is stronger than the environment, in the messages of the command line too.
    for arguments in [
        vec!["--color=always", "identify", "nowhere.csv"],
        vec!["--color", "always", "outages"],
    ] {
        let said = said(undrift(&arguments).env("NO_COLOR", "1"));
        assert!(said.stderr.contains(ESCAPE), "{}", said.stderr);
        assert!(said.stderr.contains("error:"), "{}", said.stderr);
    }
    let forced = said(undrift(&["identify", "nowhere.csv"]).env("CLICOLOR_FORCE", "1"));
    assert!(forced.stderr.contains("\u{1b}[31m"), "{}", forced.stderr);
    let never = ["--color", "never", "identify", "nowhere.csv"];
    let never = said(undrift(&never).env("CLICOLOR_FORCE", "1"));
    assert_eq!(never.stderr, "error: nowhere.csv: no such file\n");
    // JSON is for programs.
    let json = said(&mut undrift(&identify(
        &record,
        &["--json", "-", "--color", "always"],
    )));
    assert!(!json.stdout.contains(ESCAPE));
}

#[test]
fn a_terminal_has_colours_unless_the_environment_says_no() {
    let Some(shown) = on_terminal("$UNDRIFT identify nowhere.csv") else {
        println!("skipped: script is missing");
        return;
    };
    assert!(shown.contains("\u{1b}[31m"), "{shown:?}");
    for no in ["NO_COLOR=1", "TERM=dumb"] {
        let shown = on_terminal(&format!("env {no} $UNDRIFT identify nowhere.csv")).unwrap();
        assert!(
            shown.contains("error: nowhere.csv: no such file"),
            "{shown:?}"
        );
        assert!(!shown.contains(ESCAPE), "{no}: {shown:?}");
    }
}

#[test]
fn quiet_is_quiet() {
    let folder = folder("quiet");
    let record = record(&folder, 3000);
    let quiet =
        said(undrift(&identify(&record, &["-q", "--plot", "-o", "imu.toml"])).current_dir(&folder));
    assert_eq!((quiet.stdout.as_str(), quiet.stderr.as_str()), ("", ""));
    assert_eq!(quiet.code, Some(0));
    assert!(folder.join("imu.toml").exists());
    // What was asked for comes, and nothing beside it.
    let json = said(
        undrift(&identify(
            &record,
            &["--quiet", "--json", "-", "-o", "imu.toml"],
        ))
        .current_dir(&folder),
    );
    let found: serde_json::Value = serde_json::from_str(&json.stdout).unwrap();
    assert!(found["axes"]["gyro_z"].is_object());
    assert_eq!(json.stderr, "");
    // Errors are printed.
    let error = said(&mut undrift(&["-q", "identify", "nowhere.csv"]));
    assert_eq!(error.stderr, "error: nowhere.csv: no such file\n");
    assert_eq!(error.code, Some(1));
    let both = said(&mut undrift(&["-q", "-v", "demo"]));
    assert_eq!(both.code, Some(2));
}

#[test]
fn json_on_standard_output_is_json_alone() {
    let folder = folder("json");
    let record = record(&folder, 3000);
    let arguments = identify(&record, &["--json", "-", "-o", "imu.toml", "--plot", "-v"]);
    let said = said(undrift(&arguments).current_dir(&folder));
    serde_json::from_str::<serde_json::Value>(&said.stdout).unwrap();
    assert!(said.stderr.contains("model: imu.toml"), "{}", said.stderr);
    // Every verb with a result prints it as JSON.
    for verb in [
        "demo",
        "fleet",
        "identify",
        "inspect",
        "montecarlo",
        "navigate",
        "outages",
    ] {
        let help = self::said(&mut undrift(&[verb, "-h"])).stdout;
        assert!(help.contains("--json <FILE|->"), "{verb}: {help}");
    }
}

/// `undrift … | head`: the files asked for come whole all the same.
#[test]
fn a_reader_that_went_away_costs_no_file() {
    let folder = folder("pipe");
    let record = record(&folder, 5000);
    let model = folder.join("imu.toml");
    for arguments in [
        vec!["inspect", &record, "--json", model.to_str().unwrap()],
        identify(&record, &["-o", model.to_str().unwrap()]),
        identify(&record, &["--json", "-", "-o", model.to_str().unwrap()]),
    ] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let done = undrift(&arguments).stdout(writer).output().unwrap();
        let complaint = String::from_utf8_lossy(&done.stderr);
        assert!(done.status.success(), "{arguments:?}: {complaint}");
        assert!(!complaint.contains("error"), "{arguments:?}: {complaint}");
        std::fs::remove_file(&model).unwrap_or_else(|e| panic!("{arguments:?}: {e}"));
    }
}

#[test]
fn verbose_tells_what_is_read_and_how_long_it_took() {
    let record = record(&folder("verbose"), 3000);
    let verbose = said(&mut undrift(&identify(&record, &["-v"])));
    for part in [
        "delimited text detected from its content",
        "reading: ",
        "1 axes of 3000 samples at 100 Hz (as stated), gyro_z",
        "identification: ",
    ] {
        assert!(verbose.stderr.contains(part), "{part}: {}", verbose.stderr);
    }
    let plain = said(&mut undrift(&identify(&record, &[])));
    // The result is the same, with the tables of each axis in its middle.
    let (verdict, table) = plain.stdout.split_once('\n').unwrap();
    assert!(verbose.stdout.starts_with(verdict) && verbose.stdout.ends_with(table));
    assert!(verbose.stdout.contains("drift [°]") && !table.contains("drift"));
}

#[test]
fn exit_codes() {
    let folder = folder("codes");
    let record = record(&folder, 3000);
    let code = |arguments: &[&str]| said(&mut undrift(arguments)).code;
    assert_eq!(code(&identify(&record, &["--strict"])), Some(0));
    assert_eq!(code(&["identify", "nowhere.csv"]), Some(1));
    assert_eq!(code(&["identfy", "nowhere.csv"]), Some(2));
    assert_eq!(code(&["--help"]), Some(0));
    // One of two axes hangs: the other is a result, but not what was asked for.
    let text = std::fs::read_to_string(&record).unwrap();
    let rows: Vec<&str> = text
        .lines()
        .skip(2)
        .map(|l| l.split(',').next().unwrap())
        .collect();
    let mut six = String::from("gx_dps,gy_dps,gz_dps,ax_g,ay_g,az_g\n");
    for row in rows {
        let down = 1.0 + row.parse::<f64>().unwrap();
        six += &format!("{row},0.5,{row},{row},{row},{down}\n");
    }
    let half = folder.join("half.csv").display().to_string();
    std::fs::write(&half, six).unwrap();
    let arguments = ["identify", &half, "--rate", "100", "-q"];
    assert_eq!(code(&arguments), Some(0));
    let strict = said(&mut undrift(&[&arguments[..], &["--strict"]].concat()));
    assert_eq!(strict.code, Some(3), "{}", strict.stderr);
    assert!(
        strict
            .stderr
            .starts_with("error: the result is not usable as it is")
    );
}

#[test]
fn a_mistyped_name_is_answered_with_the_near_one() {
    let folder = folder("near");
    record(&folder, 10);
    let run = |arguments: &[&str]| said(undrift(arguments).current_dir(&folder)).stderr;
    assert_eq!(
        run(&["identify", "recrod.csv"]),
        "error: recrod.csv: no such file; did you mean record.csv?\n"
    );
    assert!(run(&["identfy", "record.csv"]).contains("'identify'"));
}

#[test]
fn completions_and_manual_pages() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = said(&mut undrift(&["completions", shell])).stdout;
        for word in ["montecarlo", "bias-models", "color"] {
            assert!(script.contains(word), "{shell}: {word}");
        }
        let Ok(mut check) = Command::new(shell)
            .args(["-n", "/dev/stdin"])
            .stdin(Stdio::piped())
            .spawn()
        else {
            println!("skipped: {shell} is missing");
            continue;
        };
        use std::io::Write;
        check
            .stdin
            .take()
            .unwrap()
            .write_all(script.as_bytes())
            .unwrap();
        assert!(check.wait().unwrap().success(), "{shell}");
    }
    let folder = folder("man");
    let pages = folder.join("man1");
    let made = said(undrift(&["man", "-o"]).arg(&pages));
    assert_eq!(made.code, Some(0), "{}", made.stderr);
    let names = [
        "",
        "-demo",
        "-identify",
        "-montecarlo",
        "-navigate",
        "-outages",
    ];
    for name in names {
        let page = pages.join(format!("undrift{name}.1"));
        let text = std::fs::read_to_string(&page).unwrap();
        assert!(
            text.contains(".SH OPTIONS") && text.contains("undrift"),
            "{text}"
        );
        let Ok(output) = Command::new("groff")
            .args(["-man", "-Tutf8", "-ww", "-Kutf8", "-P-cbou"])
            .arg(&page)
            .output()
        else {
            println!("skipped: groff is missing");
            continue;
        };
        assert!(output.status.success());
        let complaints = String::from_utf8_lossy(&output.stderr);
        assert_eq!(complaints, "", "{}", page.display());
        assert!(String::from_utf8_lossy(&output.stdout).contains("SYNOPSIS"));
    }
    let page = said(&mut undrift(&["man"])).stdout;
    assert_eq!(
        page.trim_end(),
        std::fs::read_to_string(pages.join("undrift.1"))
            .unwrap()
            .trim_end()
    );
}

/// A Monte Carlo of some seconds: the drive is long and has many runs.
fn long(folder: &Path) -> String {
    let spec = r#"[model]
preset = "adis16465"
[filter]
bias_models = ["white"]
[drive]
kind = "car"
duration = "180 s"
rate = "100 Hz"
seed = 1
[gnss]
rate = "1 Hz"
position_std = "0.5, 0.5, 1 m"
velocity_std = "0.05 m/s"
"#;
    let path = folder.join("spec.toml");
    std::fs::write(&path, spec).unwrap();
    path.display().to_string()
}

#[test]
fn a_bar_after_two_seconds_on_a_terminal_only() {
    let spec = long(&folder("bar"));
    let run = |runs: usize, more: &str| {
        let command = format!("$UNDRIFT montecarlo {spec} --runs {runs} {more}");
        let start = std::time::Instant::now();
        let shown = on_terminal(&command)?;
        Some((shown, start.elapsed().as_secs_f64()))
    };
    // As many runs as take three seconds here.
    let Some((short, took)) = run(2, "") else {
        println!("skipped: script is missing");
        return;
    };
    // On a busy machine even two runs take so long.
    assert!(took > 2.0 || !short.contains(" of 2 runs"), "{short:?}");
    let (_, of_40) = run(40, "").unwrap();
    let mut runs = (40.0 * 3.5 / of_40).ceil() as usize;
    let (mut shown, mut took) = run(runs, "").unwrap();
    // Others who kept the machine busy while forty were timed may be gone.
    while took < 3.0 {
        runs *= 2;
        (shown, took) = run(runs, "").unwrap();
    }
    let wanted = format!(" of {runs} runs, ");
    assert!(
        shown.contains(&wanted) && shown.contains(" left"),
        "{shown:?}"
    );
    let (quiet, _) = run(runs, "-q").unwrap();
    assert_eq!(quiet, "");
    let piped = said(&mut undrift(&[
        "montecarlo",
        &spec,
        "--runs",
        &runs.to_string(),
    ]));
    assert_eq!(piped.stderr, "");
}
