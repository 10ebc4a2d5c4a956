//! The few colours there are. Escape codes are in the text always: the stream takes them out where
//! they are not wanted.

use clap::builder::styling::{AnsiColor, Style};

fn styled(style: Style, text: &str) -> String {
    format!("{style}{text}{style:#}")
}

/// Bold.
pub fn heading(text: &str) -> String {
    styled(Style::new().bold(), text)
}

/// Bold yellow.
pub fn warning(text: &str) -> String {
    styled(AnsiColor::Yellow.on_default().bold(), text)
}

/// Bold red.
pub fn error(text: &str) -> String {
    styled(AnsiColor::Red.on_default().bold(), text)
}

/// A colour for a curve.
pub fn coloured(colour: AnsiColor, text: &str) -> String {
    styled(colour.on_default(), text)
}
