//! `undrift completions` and `undrift man`: what a shell and a reader of manuals get of the command.

use crate::{
    output::{self, Files},
    terminal,
};
use anyhow::{Context, Result};
use clap::{Args, Command};
use clap_complete::Shell;
use std::path::PathBuf;

/// Print the completions of a shell.
#[derive(Args)]
#[command(after_help = "Examples:
  undrift completions bash > ~/.local/share/bash-completion/completions/undrift
  undrift completions zsh > ~/.zfunc/_undrift")]
pub struct Completions {
    /// The shell
    #[arg(value_name = "SHELL")]
    shell: Shell,
}

/// Print the manual page, or write those of all verbs.
#[derive(Args)]
#[command(after_help = "Examples:
  undrift man | man -l -
  undrift man -o ~/.local/share/man/man1")]
pub struct Man {
    /// Write undrift.1 and a page for every verb into this folder
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// `undrift completions`.
pub fn completions(arguments: &Completions, mut command: Command) -> Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut command, "undrift", &mut script);
    terminal::result(String::from_utf8_lossy(&script).trim_end())
}

/// `undrift man`.
pub fn man(arguments: &Man, mut command: Command) -> Result<()> {
    command = command.disable_help_subcommand(true);
    command.build();
    let Some(folder) = &arguments.output else {
        return terminal::result(page(&command)?.trim_end());
    };
    output::make_folder(folder)?;
    let verbs = command.get_subcommands().filter(|verb| !verb.is_hide_set());
    let pages = [&command].into_iter().chain(verbs).map(|command| {
        let name = command.get_display_name().unwrap_or(command.get_name());
        (folder.join(format!("{name}.1")), command)
    });
    let pages = Vec::from_iter(pages);
    let files = Files::claim([], pages.iter().map(|(file, _)| file.as_path()))?;
    for (file, command) in &pages {
        files.write(file, &page(command)?)?;
    }
    Ok(())
}

/// A manual page.
fn page(command: &Command) -> Result<String> {
    let mut text = Vec::new();
    clap_mangen::Man::new(command.clone())
        .manual("undrift")
        .render(&mut text)
        .context("cannot create the manual page")?;
    Ok(String::from_utf8_lossy(&text).into_owned())
}
