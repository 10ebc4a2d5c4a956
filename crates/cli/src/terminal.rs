//! What goes to the terminal: how much, in which colours, and what a script is told at the end.
//!
//! Results go to standard output; warnings, details and progress to standard error.

use anyhow::Result;
use clap::{ArgAction, Args, ColorChoice};
use std::{
    ffi::OsString,
    fmt::Display,
    io::Write,
    sync::atomic::{AtomicBool, AtomicI16, Ordering::Relaxed},
    time::Instant,
};

use crate::style;

/// Options of every verb.
#[derive(Args)]
#[command(next_help_heading = "Terminal")]
pub struct Options {
    /// Print only errors, and results requested on standard output
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    quiet: bool,
    /// Show the files read, the settings and the time of each stage; twice: all settings
    #[arg(short, long, global = true, action = ArgAction::Count)]
    verbose: u8,
    /// When to use colours
    #[arg(long, global = true, value_name = "WHEN", value_enum, default_value_t = ColorChoice::Auto)]
    color: ColorChoice,
    /// Exit with code 3 if the result cannot be trusted
    #[arg(long, global = true)]
    pub strict: bool,
}

/// −1 is quiet, above 0 verbose.
static LEVEL: AtomicI16 = AtomicI16::new(0);
/// Whether a result cannot be trusted.
static DOUBT: AtomicBool = AtomicBool::new(false);
/// Whether standard output is for a result.
static TAKEN: AtomicBool = AtomicBool::new(false);

impl Options {
    /// Puts the options into force.
    pub fn apply(&self) {
        let level = if self.quiet {
            -1
        } else {
            i16::from(self.verbose)
        };
        LEVEL.store(level, Relaxed);
        set_colour(self.color);
    }
}

fn set_colour(choice: ColorChoice) {
    match choice {
        ColorChoice::Auto => anstream::ColorChoice::Auto,
        ColorChoice::Always => anstream::ColorChoice::Always,
        ColorChoice::Never => anstream::ColorChoice::Never,
    }
    .write_global();
}

/// Puts --color into force before the command line is understood: for help, and for mistakes in it.
pub fn colour_from(command_line: impl Iterator<Item = OsString>) {
    let words: Vec<String> = command_line
        .map(|word| word.to_string_lossy().into_owned())
        .collect();
    let following = words.iter().skip(1).map(Some).chain([None]);
    for (word, next) in words.iter().zip(following) {
        let value = match word.as_str() {
            "--" => return,
            "--color" => next.map(String::as_str),
            other => other.strip_prefix("--color="),
        };
        if let Some(Ok(choice)) = value.map(str::parse) {
            set_colour(choice);
        }
    }
}

/// Whether standard output has colours.
pub fn has_colours() -> bool {
    anstream::AutoStream::choice(&std::io::stdout()) != anstream::ColorChoice::Never
}

/// Whether only errors are shown.
pub fn is_quiet() -> bool {
    LEVEL.load(Relaxed) < 0
}

/// Whether details were asked for.
pub fn is_verbose() -> bool {
    LEVEL.load(Relaxed) > 0
}

/// From here on standard output is for a result; summaries go to standard error.
pub fn take_standard_output() {
    TAKEN.store(true, Relaxed);
}

/// Prints a summary, to standard output unless that is taken by a result; nothing if quiet.
pub fn say(text: impl Display) -> Result<()> {
    if TAKEN.load(Relaxed) {
        note(text);
        return Ok(());
    }
    if is_quiet() {
        return Ok(());
    }
    Ok(writeln!(anstream::stdout(), "{text}")?)
}

/// Prints a result that was asked for on standard output, as it is.
pub fn result(text: impl Display) -> Result<()> {
    Ok(writeln!(std::io::stdout(), "{text}")?)
}

/// Warns, unless quiet.
pub fn warn(text: impl Display) {
    if !is_quiet() {
        complain(format!("{} {text}", style::warning("warning:")));
    }
}

/// Notes something on standard error while standard output is for something else, unless quiet.
pub fn note(text: impl Display) {
    if !is_quiet() {
        complain(text.to_string());
    }
}

/// Notes that the result cannot be trusted: --strict makes an exit code of it.
pub fn doubt() {
    DOUBT.store(true, Relaxed);
}

/// Whether [`doubt`] was called.
pub fn doubted() -> bool {
    DOUBT.load(Relaxed)
}

/// Shows why there is no result, followed by the causes that the text does not contain. A reader of
/// standard output that went away (`undrift … | head`) ends the program quietly.
pub fn error(error: &anyhow::Error) {
    let broken = |cause: &(dyn std::error::Error + 'static)| {
        let io = cause.downcast_ref::<std::io::Error>();
        io.is_some_and(|io| io.kind() == std::io::ErrorKind::BrokenPipe)
    };
    if error.chain().any(broken) {
        std::process::exit(0);
    }
    let mut text = error.to_string();
    for cause in error.chain().skip(1).map(ToString::to_string) {
        if !text.contains(&cause) {
            text = format!("{text}: {cause}");
        }
    }
    complain(format!("{} {text}", style::error("error:")));
}

/// Shows a detail if --verbose was set at least `level` times.
pub fn detail(level: i16, text: impl FnOnce() -> String) {
    if LEVEL.load(Relaxed) >= level {
        complain(text());
    }
}

/// Does something and shows how long it took with --verbose.
pub fn stage<T>(name: &str, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let done = work();
    detail(1, || {
        format!("{name}: {:.2} s", start.elapsed().as_secs_f64())
    });
    done
}

/// One line on standard error; ignored where that is closed.
fn complain(line: String) {
    let _ = writeln!(anstream::stderr(), "{line}");
}
