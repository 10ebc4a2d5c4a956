//! Where results go.

use crate::{print, terminal};
use anyhow::{Result, bail};
use clap::Args;
use std::path::{Path, PathBuf};

/// Says before the work rather than after it that a file has no folder to be in; "-" is none.
pub fn ready(file: Option<&Path>) -> Result<()> {
    let folder = file.and_then(Path::parent);
    match (file, folder) {
        (Some(file), Some(folder)) if !folder.as_os_str().is_empty() && !folder.is_dir() => bail!(
            "cannot write {}: there is no folder {}",
            file.display(),
            folder.display()
        ),
        _ => Ok(()),
    }
}

/// Where a verb puts its result as JSON.
#[derive(Args)]
pub struct JsonOutput {
    /// Write the whole result as JSON; "-" for standard output instead of the text
    #[arg(long, value_name = "FILE|-", help_heading = "Output")]
    json: Option<PathBuf>,
}

impl JsonOutput {
    /// Whether it is wanted.
    pub fn is_wanted(&self) -> bool {
        self.json.is_some()
    }

    /// As [`ready`].
    pub fn ready(&self) -> Result<()> {
        ready(self.json.as_deref())
    }

    /// Writes the result if it is wanted; whether it went to standard output.
    pub fn write(&self, json: &str) -> Result<bool> {
        match &self.json {
            Some(path) if path.as_os_str() == "-" => terminal::result(json).map(|()| true),
            Some(path) => print::write_whole(path, json).map(|()| false),
            None => Ok(false),
        }
    }
}
