//! Where results go.

use crate::{print, terminal};
use anyhow::{Result, bail};
use clap::Args;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// The files that this run reads, as the system calls them.
static READ: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Notes a file that this run reads: nothing is written over it.
pub fn reads(file: &Path) {
    if let (Ok(file), Ok(mut read)) = (file.canonicalize(), READ.lock()) {
        read.push(file);
    }
}

/// That a result would not replace a file that it is made from.
///
/// # Errors
/// If it would.
pub fn spares_input(file: &Path) -> Result<()> {
    let Ok(real) = file.canonicalize() else {
        return Ok(());
    };
    if READ.lock().is_ok_and(|read| read.contains(&real)) {
        bail!(
            "cannot write {}: it is read in this run; give the result another name",
            file.display()
        );
    }
    Ok(())
}

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

    /// That the file is none that this run reads.
    ///
    /// # Errors
    /// As [`spares_input`].
    pub fn spares_input(&self) -> Result<()> {
        self.json.as_deref().map_or(Ok(()), spares_input)
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
