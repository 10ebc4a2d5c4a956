//! The undrift command: one file per verb; in the page of the browser without those that it does not run.

mod demo;
mod details;
mod drives;
#[cfg(not(target_family = "wasm"))]
mod fleet;
mod identify;
mod inspect;
#[cfg(not(target_family = "wasm"))]
mod live;
mod model;
#[cfg(not(target_family = "wasm"))]
mod montecarlo;
mod navigate;
mod outages;
mod output;
mod plot;
mod presets;
mod print;
mod progress;
mod report;
mod sample;
#[cfg(not(target_family = "wasm"))]
mod setup;
mod signals;
mod style;
mod tables;
mod terminal;
mod tune;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{CommandFactory, Parser, Subcommand};
use std::process::ExitCode;

const EXAMPLES: &str = "\
Setup:
  completions  Print the completions of bash, zsh, fish, elvish or powershell
  man          Print the manual page, or write those of all verbs

Examples:
  undrift demo --out out
  undrift help outages";

/// Exit codes and their meaning; docs/terminal.md has the same table, and when each verb ends with 3.
const EXIT_CODES: [(u8, &str); 5] = [
    (0, "done"),
    (
        1,
        "failed: the message states file, line, key and what to do",
    ),
    (
        INVALID,
        "invalid command line, or a value that an option cannot have",
    ),
    (
        UNTRUSTED,
        "done, but the result is not usable as it is; only with --strict, otherwise 0",
    ),
    (130, "ended by Ctrl-C, as a shell reports it"),
];

const ENVIRONMENT: &str = "\
Environment:
  NO_COLOR        if set, no colours
  CLICOLOR_FORCE  if set and not 0, colours even if standard output is not a terminal";

/// Exit code of an invalid command line.
const INVALID: u8 = 2;
/// Exit code of a result that cannot be trusted.
const UNTRUSTED: u8 = 3;

/// Make cheap inertial sensors trustworthy: navigate a log with any noise model of its IMU, and
/// measure how far the solution drifts when GNSS is cut.
#[derive(Parser)]
#[command(name = "undrift", version, arg_required_else_help = true)]
#[command(subcommand_value_name = "VERB", subcommand_help_heading = "Verbs", after_help = after_help())]
struct Arguments {
    #[command(subcommand)]
    verb: Verb,
    #[command(flatten)]
    terminal: terminal::Options,
}

#[derive(Subcommand)]
enum Verb {
    Demo(demo::Arguments),
    #[cfg(not(target_family = "wasm"))]
    Fleet(fleet::Arguments),
    Identify(identify::Arguments),
    Inspect(inspect::Arguments),
    #[cfg(not(target_family = "wasm"))]
    Live(live::Arguments),
    Model(model::Arguments),
    #[cfg(not(target_family = "wasm"))]
    Montecarlo(montecarlo::Arguments),
    Navigate(navigate::Arguments),
    Outages(outages::Arguments),
    Report(report::Arguments),
    Sample(sample::Arguments),
    Tune(tune::Arguments),
    #[cfg(not(target_family = "wasm"))]
    #[command(hide = true)]
    Completions(setup::Completions),
    #[cfg(not(target_family = "wasm"))]
    #[command(hide = true)]
    Man(setup::Man),
}

fn after_help() -> String {
    let codes = EXIT_CODES.map(|(code, meaning)| format!("\n  {code:<3}  {meaning}"));
    let codes = codes.concat();
    format!("{EXAMPLES}\n\nExit codes:{codes}\n\n{ENVIRONMENT}")
}

fn main() -> ExitCode {
    terminal::colour_from(std::env::args_os());
    let parsed = Arguments::try_parse().map_err(with_verbs);
    let Arguments { verb, terminal } = parsed.unwrap_or_else(|error| refused(&error));
    terminal.apply();
    signals::watch();
    let result = match verb {
        Verb::Demo(arguments) => demo::run(&arguments),
        #[cfg(not(target_family = "wasm"))]
        Verb::Fleet(arguments) => fleet::run(&arguments),
        Verb::Identify(arguments) => identify::run(&arguments),
        Verb::Inspect(arguments) => inspect::run(&arguments),
        #[cfg(not(target_family = "wasm"))]
        Verb::Live(arguments) => live::run(&arguments),
        Verb::Model(arguments) => model::run(&arguments),
        #[cfg(not(target_family = "wasm"))]
        Verb::Montecarlo(arguments) => montecarlo::run(&arguments),
        Verb::Navigate(arguments) => navigate::run(&arguments),
        Verb::Outages(arguments) => outages::run(&arguments),
        Verb::Report(arguments) => report::run(&arguments),
        Verb::Sample(arguments) => sample::run(&arguments),
        Verb::Tune(arguments) => tune::run(&arguments),
        #[cfg(not(target_family = "wasm"))]
        Verb::Completions(arguments) => setup::completions(&arguments, Arguments::command()),
        #[cfg(not(target_family = "wasm"))]
        Verb::Man(arguments) => setup::man(&arguments, Arguments::command()),
    };
    match result {
        Ok(()) if terminal.strict && terminal::doubted() => {
            terminal::error(&anyhow::anyhow!(
                "the result is not usable as it is; see its verdict and the warnings"
            ));
            ExitCode::from(UNTRUSTED)
        }
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            terminal::error(&error);
            match error.is::<terminal::Invalid>() {
                true => ExitCode::from(INVALID),
                false => ExitCode::FAILURE,
            }
        }
    }
}

/// What the help calls a drive file.
const DRIVE: &str = "DRIVE.toml|LOGS";

/// Keys of a drive file that are looked for as options, by their last word.
const KEYS: [&str; 9] = [
    "initial.heading",
    "imu.axes",
    "imu.mounting",
    "imu.rate",
    "imu.gyro_unit",
    "imu.accel_unit",
    "gnss.lever_arm",
    "gnss.time_offset",
    "gnss.position_std",
];

/// Verbs and options that other programs have, and the command that does the same.
const COMMANDS: [(&[&str], &str); 8] = [
    (
        &["allan"],
        "`undrift identify RECORD --allan` has the Allan deviations",
    ),
    (
        &["kalibr", "export", "to"],
        "`undrift identify RECORD -o imu.toml`, then `undrift model imu.toml --to kalibr`",
    ),
    (
        &["calibrate"],
        "`undrift identify RECORD -o imu.toml` of a static recording",
    ),
    (&["smooth"], "`undrift navigate LOGS --smooth -o nav.csv`"),
    (
        &["convert"],
        "logs are read as they are; `undrift navigate LOGS -o nav.csv` writes the solution, in the format of the extension",
    ),
    (
        &["plot"],
        "`undrift navigate LOGS --report report.html` draws the solution, `undrift identify RECORD --plot` Allan deviations",
    ),
    (
        &["compare"],
        "`undrift report A.json B.json -o report.html` compares results that --json wrote",
    ),
    (
        &["imu", "gnss", "gps"],
        "logs need no option: `undrift navigate IMU_LOG GNSS_LOG`",
    ),
];

/// Ends with the error of a wrong command line; that of a wrong number in other words than its parser's.
fn refused(error: &clap::Error) -> ! {
    let text = error.to_string();
    let words = text
        .replace("invalid float literal", "expected a number")
        .replace("invalid digit found in string", "expected a whole number");
    if words == text {
        error.exit();
    }
    eprint!("{words}");
    std::process::exit(INVALID.into());
}

/// What is meant by a verb or an option that is not there.
fn meant(name: &str) -> Option<String> {
    if let Some((_, command)) = COMMANDS.iter().find(|(names, _)| names.contains(&name)) {
        return Some((*command).to_owned());
    }
    let word = name.replace('-', "_");
    let key = KEYS
        .iter()
        .find(|key| key.split('.').next_back() == Some(&word))?;
    Some(format!(
        "set {key} in the drive file, which --save-drive or `undrift inspect LOGS -o drive.toml` writes"
    ))
}

/// Of an option that is unknown here, the verbs that have it, or the key of a drive file; where the drive file is missing, what
/// writes one.
fn with_verbs(mut error: clap::Error) -> clap::Error {
    let of_missing = |missing: &[String]| missing.iter().any(|name| name.contains(DRIVE));
    match error.get(ContextKind::InvalidArg) {
        Some(ContextValue::Strings(missing)) if of_missing(missing) => {
            let tip = "`undrift inspect LOGS -o drive.toml` writes a drive file".to_owned();
            let tips = ContextValue::StyledStrs(vec![tip.into()]);
            error.insert(ContextKind::Suggested, tips);
        }
        _ => {}
    }
    if let Some(ContextValue::String(verb)) = error.get(ContextKind::InvalidSubcommand)
        && let Some(tip) = meant(verb)
    {
        let tips = ContextValue::StyledStrs(vec![tip.into()]);
        error.insert(ContextKind::Suggested, tips);
    }
    let Some(ContextValue::String(option)) = error.get(ContextKind::InvalidArg) else {
        return error;
    };
    let long = option.trim_start_matches('-').to_owned();
    let command = Arguments::command();
    let has = |verb: &&clap::Command| verb.get_arguments().any(|it| it.get_long() == Some(&long));
    let verbs = command.get_subcommands().filter(has);
    let verbs = Vec::from_iter(verbs.map(clap::Command::get_name)).join(", ");
    let own = COMMANDS.iter().any(|(names, _)| names.contains(&&*long));
    let tip = match (verbs.is_empty() || own, meant(&long)) {
        (true, meant) => meant,
        (false, Some(key)) if KEYS.iter().any(|of| key.contains(of)) => {
            Some(format!("{key}; '--{long}' is an option of {verbs}"))
        }
        (false, _) => Some(format!("'--{long}' is an option of {verbs}")),
    };
    if let (ErrorKind::UnknownArgument, Some(tip)) = (error.kind(), tip) {
        error.remove(ContextKind::SuggestedArg);
        let tips = ContextValue::StyledStrs(vec![tip.into()]);
        error.insert(ContextKind::Suggested, tips);
    }
    error
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_other_programs_call_it_has_the_command() {
        let tip = |words: &[&str]| {
            let parsed = Arguments::try_parse_from([&["undrift"], words].concat());
            parsed.err().map(|error| with_verbs(error).to_string())
        };
        for (words, command) in [
            (&["smooth", "a.csv"][..], "undrift navigate LOGS --smooth"),
            (&["kalibr"], "undrift model imu.toml --to kalibr"),
            (
                &["navigate", "--imu", "a.csv", "--gnss", "b.csv"],
                "undrift navigate IMU_LOG GNSS_LOG",
            ),
            (&["identify", "a.csv", "--to", "kalibr"], "--to kalibr"),
            (&["navigate", "a.csv", "--rate", "50"], "set imu.rate"),
            (
                &["navigate", "a.csv", "--length", "9"],
                "an option of outages",
            ),
        ] {
            let said = tip(words);
            assert!(said.iter().any(|said| said.contains(command)), "{said:?}");
        }
    }

    #[test]
    fn the_command_is_sound() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn every_example_of_the_help_can_be_parsed() {
        let command = Arguments::command();
        for verb in command.get_subcommands().chain([&command]) {
            let help = verb
                .get_after_help()
                .map_or(String::new(), ToString::to_string);
            let (_, examples) = help.split_once("Examples:\n").unwrap_or_default();
            let lines: Vec<&str> = examples
                .lines()
                .take_while(|line| line.starts_with("  "))
                .collect();
            assert!(!lines.is_empty(), "{} has no example", verb.get_name());
            for line in lines {
                let words: Vec<&str> = line
                    .split_whitespace()
                    .take_while(|word| !matches!(*word, "|" | ">"))
                    .map(|word| word.trim_matches('"'))
                    .collect();
                match Arguments::try_parse_from(&words) {
                    Err(error) if error.use_stderr() => panic!("{line}: {error}"),
                    _ => assert!(words.starts_with(&["undrift"]), "{line}"),
                }
            }
        }
    }

    #[test]
    fn every_verb_says_what_it_does_in_one_line() {
        for verb in Arguments::command().get_subcommands() {
            let about = verb.get_about().map_or(String::new(), ToString::to_string);
            assert!(
                (20..100).contains(&about.len()),
                "{}: {about}",
                verb.get_name()
            );
        }
    }
}
