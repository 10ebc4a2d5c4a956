//! Files that are too large for memory or for what they are called: a message, not an abort.

use super::drives::good;
use super::log::{Case, says};
use std::io::{BufWriter, Write};

/// Runs a script with the command as `$0`; the code and what it wrote to standard error.
#[cfg(target_os = "linux")]
fn shell(case: &Case, script: &str) -> (Option<i32>, String) {
    let output = std::process::Command::new("sh")
        .args(["-c", script])
        .arg(env!("CARGO_BIN_EXE_undrift"))
        .current_dir(case.path(""))
        .output()
        .unwrap();
    (
        output.status.code(),
        String::from_utf8(output.stderr).unwrap(),
    )
}

/// A hundred million rows by a pipe, as many as are read, and 400 MB of address space.
#[cfg(target_os = "linux")]
#[ignore = "slow: reads some million rows"]
#[test]
fn tables_larger_than_the_memory() {
    let case = good().write("sizes_table");
    let rows = "(echo t,gx,gy,gz,ax,ay,az; seq -f %.0f,0.1,0.2,0.3,0.01,0.02,-1 100000000)";
    let limited = "(ulimit -v 400000; \"$0\"";
    let (code, stderr) = shell(
        &case,
        &format!("{rows} | {limited} identify - --units deg/s,g --rate 100)"),
    );
    assert_eq!(code, Some(1), "{stderr}");
    says(
        &stderr,
        &[
            "standard input: does not fit into memory",
            "average it to a lower rate",
        ],
    );
    // A drive is read more than once, so that a pipe is held.
    let mut log = good();
    log.set("\"imu.csv\"", "\"-\"");
    let case = log.write("sizes_pipe");
    let (code, stderr) = shell(&case, &format!("{rows} | {limited} navigate drive.toml)"));
    assert_eq!(code, Some(1), "{stderr}");
    says(
        &stderr,
        &["does not fit into memory", "write it into a file"],
    );
}

#[test]
fn configuration_files_of_forty_megabytes() {
    let case = good().write("sizes_toml");
    let drive = case.read("drive.toml").unwrap();
    let mut file = BufWriter::new(std::fs::File::create(case.path("large.toml")).unwrap());
    file.write_all(drive.as_bytes()).unwrap();
    for k in 0..2_000_000 {
        writeln!(file, "# comment {k:09}").unwrap();
    }
    file.into_inner().unwrap();
    for (arguments, expected) in [
        (
            &["navigate", "large.toml"][..],
            "large.toml: is larger than 16 MB",
        ),
        (
            &["montecarlo", "large.toml"],
            "large.toml: is larger than 16 MB",
        ),
        (
            &["navigate", "drive.toml", "--model", "large.toml"],
            "large.toml: larger than 4 MB",
        ),
        (
            &["model", "large.toml", "--to", "kalibr"],
            "large.toml: larger than 4 MB",
        ),
    ] {
        let done = case.run(arguments);
        assert_eq!(done.code, Some(1), "{}", done.stderr);
        says(&done.stderr, &[expected]);
    }
}
