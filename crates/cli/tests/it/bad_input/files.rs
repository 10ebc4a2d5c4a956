//! Files as they come out of other programs, broken transfers and full disks.

use super::drives::{good, is_sound};
use super::log::{Log, says, table};
use std::io::Write;
use std::path::Path;
use std::process::Command;

const HEADER: &str = "t,gx,gy,gz,fx,fy,fz";

fn imu_text() -> String {
    table(HEADER, &good().imu)
}

/// The town drive with other bytes as its inertial log; what it says as an error.
fn refusal(name: &str, imu: &[u8]) -> String {
    let case = good().write(name);
    case.put("imu.csv", imu);
    case.refusal()
}

/// The same where it is navigated, as well as without the damage; the warnings.
#[track_caller]
fn sound(name: &str, imu: &[u8]) -> String {
    let case = good().write(name);
    case.put("imu.csv", imu);
    let (outcome, _) = case.solution();
    is_sound(&outcome);
    outcome.stderr
}

#[test]
fn ends_of_lines_and_byte_order_marks() {
    let text = imu_text();
    assert_eq!(sound("crlf", text.replace('\n', "\r\n").as_bytes()), "");
    assert_eq!(sound("bom", format!("\u{feff}{text}").as_bytes()), "");
    assert_eq!(sound("no_end", text.trim_end().as_bytes()), "");
    assert_eq!(sound("cr", text.replace('\n', "\r").as_bytes()), "");
}

#[test]
fn utf_16() {
    let text = imu_text();
    let with_mark = format!("\u{feff}{text}");
    let little: Vec<u8> = with_mark
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    let big: Vec<u8> = with_mark
        .encode_utf16()
        .flat_map(u16::to_be_bytes)
        .collect();
    for (name, bytes) in [("utf16_le", little), ("utf16_be", big)] {
        assert_eq!(sound(name, &bytes), "");
    }
}

#[test]
fn decimal_commas() {
    let text = imu_text();
    for (name, separator) in [("semicolon", ";"), ("tab", "\t")] {
        let text = text.replace(',', separator).replace('.', ",");
        assert_eq!(sound(&format!("decimal_{name}"), text.as_bytes()), "");
    }
    says(
        &refusal("decimal_comma", text.replace('.', ",").as_bytes()),
        &["imu.csv line 2: 14 fields, twice the header's 7; commas are both"],
    );
}

#[test]
fn a_row_of_units_and_headers_in_between() {
    let text = imu_text();
    let mut lines: Vec<&str> = text.lines().collect();
    lines.insert(1, "s,rad/s,rad/s,rad/s,m/s2,m/s2,m/s2");
    lines.insert(7000, HEADER);
    let warnings = sound("headers", lines.join("\n").as_bytes());
    says(
        &warnings,
        &["IMU log: 2 rows with text where a number belongs, first at line 2: \"s\""],
    );
}

#[test]
fn a_header_that_is_missing() {
    let text = imu_text();
    let (_, rows) = text.split_once('\n').unwrap();
    says(
        &refusal("headless", rows.as_bytes()),
        &[
            "imu.csv line 1: no header, so there is no column \"t\" (key imu.time)",
            "by number",
        ],
    );
}

#[test]
fn columns_that_are_missing_or_too_many() {
    let text = imu_text();
    let cut = |from: usize| -> String {
        let lines = text.lines().enumerate();
        lines
            .map(|(k, line)| match k >= from {
                true => format!("{}\n", line.rsplit_once(',').unwrap().0),
                false => format!("{line}\n"),
            })
            .collect()
    };
    says(
        &refusal("column_lost", cut(0).as_bytes()),
        &["imu.csv line 1: no column \"fz\" (key imu.accel); the file has: t, gx, gy, gz, fx, fy"],
    );
    let case = good().write("column_lost_later");
    case.put("imu.csv", cut(7000).as_bytes());
    let (outcome, _) = case.solution();
    says(
        &outcome.stderr,
        &["IMU log: 7001 rows with a missing field, first at line 7001"],
    );
    // A number of the row that the header does not name, as statistics programs write it.
    let numbered: String = text
        .lines()
        .enumerate()
        .map(|(k, line)| {
            if k == 0 {
                format!("{line}\n")
            } else {
                format!("{k},{line}\n")
            }
        })
        .collect();
    says(
        &refusal("column_unnamed", numbered.as_bytes()),
        &[
            "imu.csv line 2: 8 fields, but the header has 7",
            "an unnamed column",
        ],
    );
}

#[test]
fn a_file_that_breaks_off() {
    let text = imu_text();
    // In the middle of a row.
    let at = text[..text.len() * 3 / 4].rfind(',').unwrap() + 1;
    let case = good().write("breaks_off");
    case.put("imu.csv", &text.as_bytes()[..at]);
    let (outcome, _) = case.solution();
    says(&outcome.stderr, &["IMU log: 1 row with a missing field"]);
}

#[test]
fn two_files_in_one() {
    let text = imu_text();
    let message = refusal("two_files_in_one", format!("{text}{text}").as_bytes());
    says(
        &message,
        &[
            "imu.csv line 14003: time jumps back by 139.990 s, from 140 s to 0.01 s",
            "split the file there",
        ],
    );
}

#[test]
fn a_block_of_zero_bytes() {
    // What a file system leaves after a crash: half a second of samples.
    let mut bytes = imu_text().into_bytes();
    bytes[800_000..805_000].fill(0);
    let case = good().write("zero_bytes");
    case.put("imu.csv", &bytes);
    let (outcome, _) = case.solution();
    says(
        &outcome.stderr,
        &[
            "1 row with text where a number belongs",
            "no samples for 0.4 s from 68.11 s",
        ],
    );
}

#[test]
fn numbers_of_other_languages() {
    let text = imu_text();
    // The exponent of a double in Fortran.
    assert_eq!(sound("fortran", text.replace('e', "D").as_bytes()), "");
}

#[test]
fn files_that_are_no_logs() {
    let page = b"<!DOCTYPE html>\n<html><body>Sign in with SECRET</body></html>\n";
    let noise: Vec<u8> = (0..60_000u32)
        .map(|k| (k.wrapping_mul(2_654_435_761) >> 13) as u8)
        .collect();
    let line = vec![b'7'; 1_000_000];
    let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    gzip.write_all(page).unwrap();
    for (name, bytes, parts) in [
        ("page", &page[..], "is an HTML page, not a log; download"),
        (
            "page_gz",
            &gzip.finish().unwrap(),
            "is an HTML page, not a log",
        ),
        ("pdf", b"%PDF-1.7\n%\xe2\xe3SECRET\n", "is a PDF document"),
        (
            "zip",
            b"PK\x03\x04\x14\0SECRET",
            "is a ZIP archive or a workbook",
        ),
        ("png", b"\x89PNG\r\n\x1a\n\0SECRET", "is an image"),
        (
            "lfs",
            b"version https://git-lfs.github.com/spec/v1\noid SECRET\n",
            "`git lfs pull`",
        ),
        ("json", b"{\"SECRET\": [1, 2]}\n", "is JSON, not a log"),
        ("noise", &noise, "is binary data of an unknown format"),
        (
            "line",
            &line,
            "line too long to be a row, at line 1: over 65536 bytes; end each row",
        ),
    ] {
        let message = refusal(name, bytes);
        says(&message, &["error: imu.csv: ", parts]);
        // A line, and nothing of the content.
        assert!(
            message.len() < 200 && message.lines().count() == 1,
            "{message}"
        );
        assert!(
            !message.contains("SECRET") && !message.contains("777"),
            "{message}"
        );
    }
    // One log in the other's place.
    let mut log = good();
    log.set("\"gnss.csv\"", "\"imu.csv\"");
    says(
        &log.write("imu_as_gnss").refusal(),
        &["imu.csv line 1: no column \"lat\" (key gnss.position)"],
    );
}

#[test]
fn a_directory_in_place_of_a_file() {
    let case = good().write("directory");
    std::fs::remove_file(case.path("imu.csv")).unwrap();
    std::fs::create_dir(case.path("imu.csv")).unwrap();
    says(
        &case.refusal(),
        &["error: imu.csv: is a folder, not a log, and has no ROS 2 bag"],
    );
}

/// A bag as its recorder leaves it when it is killed, and what it is made from is never replaced.
#[test]
fn bags_without_messages_and_results_into_bags() {
    let golden =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata/golden/formats/rosbag2");
    let case = good().write("bag");
    case.put(
        "drive.toml",
        b"model = \"adis16405\"\n[imu]\nfile = \"bag\"\n[gnss]\nfile = \"bag\"\n",
    );
    std::fs::create_dir(case.path("bag")).unwrap();
    let put = |from: &str, to: &str| {
        case.put(to, &std::fs::read(golden.join(from)).unwrap());
    };
    put("no-messages.db3", "bag/bag_0.db3");
    says(
        &case.refusal(),
        &["error: bag: a ROS 2 bag without messages"],
    );
    put("unwritten/running.db3-wal", "bag/bag_0.db3-wal");
    says(
        &case.refusal(),
        &["bag/bag_0.db3-wal back: open the bag once with ROS 2 or sqlite3"],
    );
    put("plain.db3", "bag/bag_0.db3");
    let outcome = case.run(&["inspect", "bag", "-o", "bag/bag_0.db3"]);
    assert_eq!(outcome.code, Some(1), "{}", outcome.stderr);
    says(&outcome.stderr, &["bag_0.db3: this run reads it"]);
}

#[cfg(unix)]
#[test]
fn a_file_without_permission() {
    use std::os::unix::fs::PermissionsExt;
    let case = good().write("permission");
    let path = case.path("gnss.csv");
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o000)).unwrap();
    if std::fs::File::open(&path).is_ok() {
        println!("skipped: this user reads every file");
        return;
    }
    says(&case.refusal(), &["gnss.csv: no permission to read"]);
}

#[test]
fn names_that_promise_another_content() {
    // Plain text called gzip, and gzip called text: the content decides.
    let mut log = good();
    log.set("\"imu.csv\"", "\"imu.csv.gz\"");
    let case = log.write("plain_gz");
    std::fs::rename(case.path("imu.csv"), case.path("imu.csv.gz")).unwrap();
    is_sound(&case.solution().0);
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(imu_text().as_bytes()).unwrap();
    assert_eq!(sound("gz_plain", &encoder.finish().unwrap()), "");
}

#[test]
fn samples_are_not_written_in_part() {
    let case = good().write("samples_refused");
    std::fs::create_dir_all(case.path("logs/drive/truth.csv")).unwrap();
    let outcome = case.run(&["sample", "logs"]);
    assert_eq!(outcome.code, Some(1), "{}", outcome.stderr);
    says(
        &outcome.stderr,
        &["cannot write logs/drive/truth.csv: it is a folder"],
    );
    assert!(case.read("logs/static.csv").is_none());
    assert!(case.read("logs/drive/imu.csv").is_none());
}

#[test]
fn a_result_never_replaces_what_it_is_made_from() {
    let case = good().write("replaces");
    let (imu, gnss, drive) = (
        case.read("imu.csv"),
        case.read("gnss.csv"),
        case.read("drive.toml"),
    );
    let dotted = format!("{}/../replaces/imu.csv", case.path("").display());
    std::fs::create_dir(case.path("rest")).unwrap();
    for record in ["rest/run1.csv.gz", "rest/run2.csv.gz"] {
        case.put(record, imu_text().as_bytes());
    }
    for arguments in [
        &["navigate", "drive.toml", "-o", "imu.csv"][..],
        &["navigate", "drive.toml", "-o", &dotted],
        &["navigate", "drive.toml", "-o", "nav.csv", "-o", "truth.csv"],
        &["navigate", "drive.toml", "--json", "gnss.csv"],
        &[
            "outages",
            "drive.toml",
            "--at",
            "60",
            "--length",
            "5",
            "--bias-models",
            "arma",
            "--json",
            "drive.toml",
        ],
        &["inspect", "imu.csv", "-o", "imu.csv"],
        &["identify", "imu.csv", "-o", "imu.csv"],
        &["identify", "imu.csv", "--json", "imu.csv"],
        &["demo", "--data", "rest", "--json", "rest/run1.csv.gz"],
    ] {
        let outcome = case.run(arguments);
        assert_eq!(outcome.code, Some(1), "{arguments:?} {}", outcome.stderr);
        says(
            &outcome.stderr,
            &[
                "cannot write",
                "this run reads it; choose another name for the result",
            ],
        );
        assert!(case.read("nav.csv").is_none());
    }
    assert_eq!(
        (imu, gnss, drive),
        (
            case.read("imu.csv"),
            case.read("gnss.csv"),
            case.read("drive.toml")
        )
    );
}

/// A limit on the size of files simulates a full disk: 64 blocks of 512 bytes or 1 kB.
#[cfg(unix)]
#[test]
fn a_full_disk_leaves_the_old_file() {
    let case = good().write("full_disk");
    case.put("nav.csv", b"the solution of yesterday\n");
    let output = Command::new("sh")
        .args([
            "-c",
            "trap '' XFSZ; ulimit -f 64; exec \"$0\" navigate drive.toml -o nav.csv",
        ])
        .arg(env!("CARGO_BIN_EXE_undrift"))
        .current_dir(case.path(""))
        .output()
        .unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    says(&stderr, &["error: cannot write the result: "]);
    assert_eq!(
        case.read("nav.csv").as_deref(),
        Some("the solution of yesterday\n")
    );
    // Nor is a part of it left.
    let files = std::fs::read_dir(case.path("")).unwrap().flatten();
    let names: Vec<_> = files
        .map(|f| f.file_name().to_string_lossy().into_owned())
        .collect();
    assert!(!names.iter().any(|name| name.contains("part")), "{names:?}");
}

/// The nodes are kept in memory then, as in a browser.
#[cfg(unix)]
#[test]
fn smoothing_without_a_temporary_folder_gives_the_same() {
    let case = good().write("no_temporary_folder");
    let smoothed = |temporary: &Path, solution: &str| {
        let done = Command::new(env!("CARGO_BIN_EXE_undrift"))
            .args(["navigate", "drive.toml", "--smooth", "-o", solution])
            .current_dir(case.path(""))
            .env("TMPDIR", temporary)
            .output()
            .unwrap();
        let stderr = String::from_utf8_lossy(&done.stderr);
        assert!(done.status.success(), "{stderr}");
        case.read(solution).unwrap()
    };
    let with = smoothed(&case.path(""), "with.csv");
    assert_eq!(smoothed(&case.path("nowhere"), "without.csv"), with);
}

#[test]
fn a_folder_that_cannot_hold_the_result() {
    let case = good().write("no_folder");
    for target in ["none/nav.csv", "imu.csv/nav.csv"] {
        let outcome = case.run(&["navigate", "drive.toml", "-o", target]);
        assert_eq!(outcome.code, Some(1));
        says(
            &outcome.stderr,
            &[&format!("cannot write {target}: the folder")],
        );
        // Reported before the work: nothing was navigated.
        assert_eq!(outcome.stdout, "");
    }
    std::fs::create_dir(case.path("nav.csv")).unwrap();
    let outcome = case.run(&["navigate", "drive.toml", "-o", "nav.csv"]);
    assert_eq!(outcome.code, Some(1));
    says(&outcome.stderr, &["cannot write"]);
}

#[test]
#[cfg(target_os = "linux")]
fn results_into_devices_pipes_and_links() {
    use std::os::unix::fs::{FileTypeExt, PermissionsExt, symlink};

    let case = good().write("devices");
    let shell = |script: &str| {
        let output = Command::new("sh")
            .args(["-c", script])
            .arg(env!("CARGO_BIN_EXE_undrift"))
            .current_dir(case.path(""))
            .output()
            .unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{script}: {stderr}");
        String::from_utf8(output.stdout).unwrap()
    };
    shell("\"$0\" navigate drive.toml -q -o nav.csv");
    let nav = case.read("nav.csv").unwrap();
    assert!(nav.lines().count() > 100);

    // As root this replaced the device by a file.
    shell(
        "\"$0\" navigate drive.toml -q --format csv -o /dev/null --json /dev/null --report /dev/null",
    );
    let null = std::fs::metadata("/dev/null").unwrap();
    assert!(null.file_type().is_char_device());

    shell(
        "mkfifo fifo; cat fifo > from-fifo.csv & \"$0\" navigate drive.toml -q --format csv -o fifo; wait",
    );
    assert_eq!(case.read("from-fifo.csv").as_deref(), Some(&*nav));
    let csv = shell("\"$0\" navigate drive.toml -q --format csv -o /dev/fd/3 3>&1 >/dev/null");
    assert_eq!(csv, nav);
    shell("\"$0\" navigate drive.toml -q --format csv -o /dev/stdout > out.csv");
    assert!(case.read("out.csv").unwrap().starts_with(&*nav));
    // MCAP into a pipe, where the lengths at the heads cannot be written afterwards.
    shell(
        "\"$0\" navigate drive.toml -q --format mcap -o /dev/fd/3 3>&1 >/dev/null | cat > piped.mcap",
    );
    let written = shell("\"$0\" inspect piped.mcap");
    assert!(written.contains("/undrift/imu"), "{written}");

    std::fs::create_dir(case.path("kept")).unwrap();
    case.put("kept/nav.csv", b"old");
    let mode = |mode| std::fs::Permissions::from_mode(mode);
    std::fs::set_permissions(case.path("kept/nav.csv"), mode(0o640)).unwrap();
    symlink("kept/nav.csv", case.path("link.csv")).unwrap();
    shell("\"$0\" navigate drive.toml -q -o link.csv");
    assert!(case.path("link.csv").is_symlink());
    assert_eq!(case.read("kept/nav.csv").as_deref(), Some(&*nav));
    let kept = std::fs::metadata(case.path("kept/nav.csv")).unwrap();
    assert_eq!(kept.permissions().mode() & 0o777, 0o640);
}

/// A pipe gives what it has once, however often the verb goes over a log.
#[test]
#[cfg(unix)]
fn logs_in_pipes_are_read_like_the_files() {
    let case = good().write("logs_in_pipes");
    let drive = case.read("drive.toml").unwrap();
    let piped = drive.replace(".csv\"", ".pipe\"");
    case.put("piped.toml", piped.as_bytes());
    // What a verb leaves unread ends its writer with it.
    let through_pipes = |line: &str| {
        let script = format!(
            "rm -f *.pipe; writers=
            for log in imu gnss truth; do
                mkfifo $log.pipe; cat $log.csv > $log.pipe & writers=\"$writers $!\"
            done
            timeout 120 \"$0\" {line}; status=$?
            kill $writers 2>/dev/null; exit $status"
        );
        let output = Command::new("sh")
            .args(["-c", &script, env!("CARGO_BIN_EXE_undrift")])
            .current_dir(case.path(""))
            .output()
            .unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{line}: {stderr}");
        String::from_utf8(output.stdout).unwrap()
    };
    let (_, nav) = case.solution();
    assert!(nav.len() > 100);
    let expected = case.read("nav.csv");
    through_pipes("navigate piped.toml -q -o piped.csv");
    assert_eq!(case.read("piped.csv"), expected);

    let schedule = ["--at", "41,70.5", "--length", "5", "--json"];
    let outcome = case.outages(&[&schedule[..], &["file.json"]].concat());
    assert!(outcome.succeeded(), "{}", outcome.stderr);
    let line = format!(
        "outages piped.toml --bias-models arma {} piped.json",
        schedule.join(" ")
    );
    through_pipes(&line);
    let json = |name: &str| -> serde_json::Value {
        serde_json::from_str(&case.read(name).unwrap()).unwrap()
    };
    for key in ["models", "outages", "nis_per_dof"] {
        assert_eq!(json("piped.json")[key], json("file.json")[key], "{key}");
    }

    let file = case.run(&["inspect", "imu.csv", "gnss.csv"]);
    assert!(file.succeeded(), "{}", file.stderr);
    let found = through_pipes("inspect imu.pipe gnss.pipe");
    assert_eq!(found.replace(".pipe", ".csv"), file.stdout);
}

#[test]
fn an_outage_longer_than_the_log() {
    let outcome = good()
        .write("long_outage")
        .outages(&["--count", "1", "--length", "500"]);
    assert_eq!(outcome.code, Some(1));
    says(
        &outcome.stderr,
        &["--length 500: only 79 s lie between --start 60"],
    );
}

#[test]
fn keys_that_contradict_each_other() {
    for (name, line, words) in [
        (
            "two_stds",
            "position_std = \"1 m\"\n",
            "line 13, gnss.position_std_columns: set position_std or position_std_columns, not both",
        ),
        (
            "std_column",
            "velocity_std_columns = [\"vn\", \"ve\", \"vd\"]\n",
            "line 16, gnss.velocity_std_columns: set velocity_std or velocity_std_columns, not both",
        ),
        (
            "two_places",
            "baseline = [\"vn\", \"ve\", \"vd\"]\n",
            "line 16, gnss.baseline: set position or baseline, not both",
        ),
        (
            "two_times",
            "time = \"t\"\n",
            "line 16: time is already defined at line",
        ),
        ("word", "use = 3\n", "line 16, gnss.use: must be a"),
    ] {
        let mut log: Log = good();
        log.set("[truth]", &format!("{line}[truth]"));
        let message = log.write(&format!("contradict_{name}")).refusal();
        says(&message, &["drive.toml ", words]);
    }
}

#[test]
fn two_results_for_one_file_are_refused() {
    let case = good().write("twice");
    for arguments in [
        &["navigate", "drive.toml", "-o", "a.csv", "-o", "./a.csv"][..],
        &["navigate", "drive.toml", "-o", "a.csv", "--json", "a.csv"],
    ] {
        let done = case.run(arguments);
        assert!(!done.succeeded());
        says(
            &done.stderr,
            &["two results are to be written to a.csv: give each its own file"],
        );
    }
    let done = case.run(&["navigate", "drive.toml", "-o", "-", "--json", "-"]);
    assert!(!done.succeeded() && done.stdout.is_empty());
    says(
        &done.stderr,
        &["two results are to be written to standard output (-)"],
    );
}

#[test]
fn a_read_only_file_is_not_replaced() {
    let case = good().write("read_only");
    case.put("a.csv", b"mine");
    let path = case.path("a.csv");
    let mut permissions = std::fs::metadata(&path).unwrap().permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(&path, permissions).unwrap();
    let done = case.run(&["navigate", "drive.toml", "-o", "a.csv"]);
    assert!(!done.succeeded());
    says(&done.stderr, &["cannot write a.csv", "read-only"]);
    assert_eq!(std::fs::read(&path).unwrap(), b"mine");
}

#[test]
fn a_dash_is_standard_output() {
    let case = good().write("dash");
    let to_file = case.run(&["navigate", "drive.toml", "-o", "a.csv"]);
    assert!(to_file.succeeded(), "{}", to_file.stderr);
    let piped = case.run(&["navigate", "drive.toml", "-o", "-"]);
    assert!(piped.succeeded(), "{}", piped.stderr);
    assert_eq!(
        piped.stdout,
        std::fs::read_to_string(case.path("a.csv")).unwrap()
    );
    let drive = case.run(&["inspect", "imu.csv", "gnss.csv", "-o", "-"]);
    assert!(drive.succeeded(), "{}", drive.stderr);
    assert!(
        drive.stdout.contains("\n[imu]\n") && !drive.stdout.contains("drive file:"),
        "{}",
        drive.stdout
    );
}
