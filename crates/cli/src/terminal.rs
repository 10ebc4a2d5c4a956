//! What goes to the terminal: how much, in which colours, and the exit status for scripts.
//!
//! Results go to standard output; warnings, details and progress to standard error.
//!
//! Text may quote names from files. Characters that act on a terminal are escaped here: all of them in warnings and
//! errors, which are lines of their own; in other text all but line ends and the styles of [`crate::style`].

use anyhow::Result;
use clap::{ArgAction, Args, ColorChoice};
use std::{
    ffi::OsString,
    fmt::Display,
    io::{ErrorKind, Write},
    sync::atomic::{AtomicBool, AtomicI16, Ordering::Relaxed},
    time::Instant,
};

use crate::style;
use undrift::io::visible;

/// A value of an option that cannot be, beyond what the parser of the command line sees: exit code 2.
#[derive(Debug)]
pub struct Invalid(pub String);

impl Display for Invalid {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Invalid {}

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
    /// Exit with code 3 if the result is not usable as it is
    #[arg(long, global = true)]
    pub strict: bool,
}

/// −1 is quiet, above 0 verbose.
static LEVEL: AtomicI16 = AtomicI16::new(0);
/// Whether a result cannot be trusted.
static DOUBT: AtomicBool = AtomicBool::new(false);
/// Whether a result that cannot be trusted is an error.
static STRICT: AtomicBool = AtomicBool::new(false);
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
        STRICT.store(self.strict, Relaxed);
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
    let text = styled(&text.to_string());
    let text = fitted(&text, width_of(&console::Term::stdout()), 0);
    printed(writeln!(anstream::stdout(), "{text}"))
}

/// Prints a result that was asked for on standard output, as it is.
pub fn result(text: impl Display) -> Result<()> {
    printed(writeln!(std::io::stdout(), "{text}"))
}

/// A reader of standard output that went away (`undrift … | head`) is no error: the files asked for are still written.
fn printed(done: std::io::Result<()>) -> Result<()> {
    match done {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}

/// Warns, unless quiet.
pub fn warn(text: impl Display) {
    if !is_quiet() {
        let text = visible(&text.to_string()).into_owned();
        complain(&format!("{} {text}", style::warning("warning:")), 2);
    }
}

/// Notes something on standard error while standard output is for something else, unless quiet.
pub fn note(text: impl Display) {
    if !is_quiet() {
        complain(&styled(&text.to_string()), 0);
    }
}

/// Notes that the result cannot be trusted: --strict makes an exit code of it.
pub fn doubt() {
    DOUBT.store(true, Relaxed);
}

/// Whether --strict is given.
pub fn is_strict() -> bool {
    STRICT.load(Relaxed)
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
    complain(&format!("{} {}", style::error("error:"), visible(&text)), 2);
}

/// Shows a detail if --verbose was set at least `level` times.
pub fn detail(level: i16, text: impl FnOnce() -> String) {
    if LEVEL.load(Relaxed) >= level {
        // Details are lines of their own; all settings are several.
        let text = text();
        match level {
            1 => complain(&visible(&text), 2),
            _ => complain(&styled(&text), 2),
        }
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

/// Text on standard error, wrapped on a terminal; ignored where that is closed.
fn complain(text: &str, indent: usize) {
    let text = fitted(text, width_of(&console::Term::stderr()), indent);
    let _ = writeln!(anstream::stderr(), "{text}");
}

/// Columns of a terminal; `None` of anything else, whose lines stay whole.
fn width_of(terminal: &console::Term) -> Option<usize> {
    let (_, columns) = terminal.size_checked()?;
    (columns > 0 && terminal.features().is_attended())
        .then_some(usize::from(columns).max(NARROWEST))
}

/// Narrower terminals wrap by themselves.
const NARROWEST: usize = 40;

/// Text without the characters that act on a terminal, but with its lines and with our styles.
fn styled(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for (at, line) in text.split('\n').enumerate() {
        if at > 0 {
            out.push('\n');
        }
        for (at, part) in line.split(ESCAPE).enumerate() {
            if at > 0 {
                let style = style_at(part);
                out.push_str(if style { "\x1b" } else { "\\u{1b}" });
            }
            out.push_str(&visible(part));
        }
    }
    out
}

const ESCAPE: char = '\x1b';

/// Whether a text behind an escape character is one of our styles: bold, a colour, or their end.
fn style_at(text: &str) -> bool {
    let code = text.strip_prefix('[').and_then(|rest| rest.split_once('m'));
    code.is_some_and(|(code, _)| {
        matches!(
            code,
            "0" | "1" | "30" | "31" | "32" | "33" | "34" | "35" | "36" | "37"
        )
    })
}

/// Prose broken between words at a width, the lines that follow indented; rows of tables, which have two blanks on
/// end between their columns, stay whole.
fn fitted(text: &str, width: Option<usize>, indent: usize) -> String {
    let Some(width) = width else {
        return text.to_owned();
    };
    let lines = text.split('\n').map(|line| {
        let shown = console::measure_text_width(line);
        match shown <= width || line.trim_start().contains("  ") {
            true => line.to_owned(),
            false => broken(line, width, indent),
        }
    });
    Vec::from_iter(lines).join("\n")
}

fn broken(line: &str, width: usize, indent: usize) -> String {
    let own = line.len() - line.trim_start().len();
    let indent = " ".repeat(own + indent);
    let (mut out, mut column) = (String::new(), 0);
    for word in line.trim_start().split(' ') {
        let length = console::measure_text_width(word);
        if column == 0 {
            out.push_str(&indent[..own]);
            column = own;
        } else if column + 1 + length > width {
            out.push('\n');
            out.push_str(&indent);
            column = indent.len();
        } else {
            out.push(' ');
            column += 1;
        }
        out.push_str(word);
        column += length;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_our_styles_and_lines_reach_the_terminal() {
        let own = style::heading("head") + "\n" + &style::warning("warning:");
        assert_eq!(styled(&own), own);
        for (text, shown) in [
            ("a\x1b[2Jb", "a\\u{1b}[2Jb"),
            ("a\x1b]0;title\x07", "a\\u{1b}]0;title\\u{7}"),
            ("a\x1b[8mb\rc", "a\\u{1b}[8mb\\rc"),
            ("a\u{202e}\n\x1b", "a\\u{202e}\n\\u{1b}"),
        ] {
            assert_eq!(styled(text), shown);
        }
    }

    #[test]
    fn prose_is_wrapped_between_words_and_tables_stay_whole() {
        let prose = style::error("error:") + " one two three four five";
        let wrapped = fitted(&prose, Some(15), 2);
        let lines: Vec<String> = wrapped
            .lines()
            .map(|line| console::strip_ansi_codes(line).into_owned())
            .collect();
        assert_eq!(lines, ["error: one two", "  three four", "  five"]);
        let table = "name      value     unit";
        assert_eq!(fitted(table, Some(10), 2), table);
        assert_eq!(fitted("    a bb ccc", Some(8), 2), "    a bb\n      ccc");
        // A word longer than the line is not cut: names of files are to be copied.
        assert_eq!(
            fitted("a /very/long/name b", Some(8), 0),
            "a\n/very/long/name\nb"
        );
        assert_eq!(fitted(&prose, None, 2), prose);
    }
}
