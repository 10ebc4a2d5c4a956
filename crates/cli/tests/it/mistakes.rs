//! Mistakes that users make, and the first line of what the command answers: docs/mistakes.md.
//!
//! `UNDRIFT_BLESS=1` writes the page; read its difference before it is committed. The drive is that of
//! `bad_input`, simulated by a fixed seed.

mod cases;
mod logs;

use super::bad_input::{
    drives::good,
    log::{Case, Log},
};
use cases::cases;
use std::path::Path;

/// A mistake and how to make it.
struct Mistake {
    what: &'static str,
    /// The command line after `undrift`, words with blanks between.
    command: &'static str,
    log: fn(&mut Log),
    files: fn(&Case),
}

/// A mistake in the command line alone.
fn mistake(what: &'static str, command: &'static str) -> Mistake {
    Mistake {
        what,
        command,
        log: |_| (),
        files: |_| (),
    }
}

/// `undrift navigate` of a drive that is changed so.
fn drive(what: &'static str, log: fn(&mut Log)) -> Mistake {
    let navigate = mistake(what, "navigate drive.toml");
    Mistake { log, ..navigate }
}

impl Mistake {
    /// With files that are changed after the drive was written.
    fn files(self, files: fn(&Case)) -> Self {
        Self { files, ..self }
    }

    /// The row of the page.
    fn row(&self, number: usize) -> String {
        let mut log = good();
        (self.log)(&mut log);
        let case = log.write(&format!("mistake_{number}"));
        (self.files)(&case);
        let words: Vec<&str> = self.command.split_whitespace().collect();
        let done = case.run(&words);
        let code = done.code.unwrap_or(-1);
        let message = first(code, &done.stdout, &done.stderr);
        assert!(!message.is_empty(), "{}: no message", self.what);
        format!(
            "| {number} | {} | `{}` | {code} | `{}` |",
            self.what,
            self.command,
            message.replace('|', "\\|")
        )
    }
}

/// The error with what explains a wrong command line; else the verdict unless it is good, else the first warning.
fn first(code: i32, stdout: &str, stderr: &str) -> String {
    let lines = || stderr.lines().map(str::trim);
    let verdict = stdout.lines().next().unwrap_or_default();
    if code == 0 {
        // What a drive was made of is no warning.
        let is_note = |line: &&str| line.starts_with("drive of ") || line.starts_with("  ");
        return match stderr.lines().find(|line| !is_note(line)) {
            Some(warning) if verdict == "usable" => warning.to_owned(),
            _ => verdict.to_owned(),
        };
    }
    let mut error = lines().skip_while(|line| !line.starts_with("error:"));
    let mut shown = error.next().unwrap_or_default().to_owned();
    if shown.ends_with(':') {
        shown = format!("{shown} {}", error.next().unwrap_or_default());
    }
    let tip = lines().find(|line| line.starts_with("tip:"));
    tip.map_or(shown.clone(), |tip| format!("{shown}; {tip}"))
}

const HEAD: &str = "\
# Mistakes and their messages

What goes wrong when a log is used for the first time, and the first line of the answer: the cause, and what to do. A test makes each mistake and compares this page.
A result begins with its verdict: `usable`; `usable with care`, where the warning must be looked at first; or `not usable`, where a setting or a log is certainly wrong.
The exit codes are those [without `--strict`](terminal.md#exit-codes). The last table has the kinds of logs that other programs write. In general: [faults.md](faults.md).
";

#[test]
fn each_mistake_has_its_message() {
    let groups = cases();
    let all: Vec<&Mistake> = groups.iter().flat_map(|(_, mistakes)| mistakes).collect();
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let share = all.len().div_ceil(cores);
    let rows_of = |(part, of): (usize, &[&Mistake])| -> Vec<String> {
        let numbers = part * share + 1..;
        let rows = of.iter().zip(numbers);
        rows.map(|(mistake, number)| mistake.row(number)).collect()
    };
    let rows = std::thread::scope(|scope| {
        let start = |part| scope.spawn(move || rows_of(part));
        let threads = Vec::from_iter(all.chunks(share).enumerate().map(start));
        let ended = threads.into_iter().map(|thread| thread.join().unwrap());
        Vec::from_iter(ended.flatten())
    });
    let mut page = HEAD.to_owned();
    let mut rows = rows.into_iter();
    for (name, mistakes) in &groups {
        page += &format!(
            "\n## {name}\n\n| | mistake | command | exit | first line |\n|---|---|---|---|---|\n"
        );
        for row in rows.by_ref().take(mistakes.len()) {
            page += &(row + "\n");
        }
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/mistakes.md");
    if std::env::var_os("UNDRIFT_BLESS").is_some() {
        std::fs::write(&path, &page).unwrap();
    }
    let kept = std::fs::read_to_string(&path).unwrap();
    for (now, kept) in page.lines().zip(kept.lines()) {
        assert_eq!(now, kept);
    }
    assert_eq!(page, kept, "docs/mistakes.md is not up to date");
}
