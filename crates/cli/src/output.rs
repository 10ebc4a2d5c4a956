//! Where results go.

use crate::terminal;
use anyhow::{Context, Result, bail};
use clap::Args;
use std::path::{Path, PathBuf};
use undrift::io::write;

/// The files of a run, claimed before its work: what is read, and what is written.
pub struct Files {
    /// Regular files that are read, as the system calls them.
    inputs: Vec<PathBuf>,
}

impl Files {
    /// # Errors
    /// If a result has no folder to be in, or would replace a file that it is made from.
    pub fn claim<'a, 'b>(
        inputs: impl IntoIterator<Item = &'a Path>,
        outputs: impl IntoIterator<Item = &'b Path>,
    ) -> Result<Self> {
        let inputs = inputs.into_iter().filter_map(real).collect();
        let files = Self { inputs };
        for file in outputs {
            match file.parent() {
                Some(folder) if folder != Path::new("") && !folder.is_dir() => bail!(
                    "cannot write {}: there is no folder {}",
                    file.display(),
                    folder.display()
                ),
                _ => files.spare_inputs(file)?,
            }
        }
        Ok(files)
    }

    /// With a file more that turned out to be read.
    pub fn and_read(mut self, file: Option<&Path>) -> Self {
        self.inputs.extend(file.and_then(real));
        self
    }

    fn spare_inputs(&self, file: &Path) -> Result<()> {
        if real(file).is_some_and(|real| self.inputs.contains(&real)) {
            bail!(
                "cannot write {}: it is read in this run; give the result another name",
                file.display()
            );
        }
        Ok(())
    }

    /// Writes a file whole or not at all.
    pub fn write(&self, file: &Path, text: &str) -> Result<()> {
        self.spare_inputs(file)?;
        write::write_whole(file, text).with_context(|| format!("cannot write {}", file.display()))
    }
}

/// A regular file as the system calls it; devices and pipes may be read and written.
fn real(file: &Path) -> Option<PathBuf> {
    file.canonicalize().ok().filter(|real| real.is_file())
}

/// Makes a folder for results.
pub fn make_folder(folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))
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

    /// The file, if it is one.
    pub fn file(&self) -> Option<&Path> {
        self.json.as_deref().filter(|path| path.as_os_str() != "-")
    }

    /// Writes the result if it is wanted; whether it went to standard output.
    pub fn write(&self, files: &Files, json: &str) -> Result<bool> {
        match self.file() {
            Some(path) => files.write(path, json).map(|()| false),
            None if self.is_wanted() => terminal::result(json).map(|()| true),
            None => Ok(false),
        }
    }
}
