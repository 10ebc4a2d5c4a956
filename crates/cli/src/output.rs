//! Where results go.

use crate::terminal::{self, Invalid};
use anyhow::{Context, Result, bail};
use clap::Args;
use std::path::{Path, PathBuf};
use undrift::io::{Opened, visible, write};

/// The files of a run, claimed before its work: what is read, and what is written.
pub struct Files {
    /// Regular files that are read, as the system calls them.
    inputs: Vec<PathBuf>,
}

impl Files {
    /// # Errors
    /// If a result has no folder to be in, or would replace a file that it is made from or another result.
    pub fn claim<'a, 'b>(
        inputs: impl IntoIterator<Item = &'a Path>,
        outputs: impl IntoIterator<Item = &'b Path>,
    ) -> Result<Self> {
        let inputs = inputs.into_iter().flat_map(Opened::files);
        let inputs = inputs.filter_map(|file| real(&file)).collect();
        let files = Self { inputs };
        let mut places: Vec<(PathBuf, &Path)> = Vec::new();
        for file in outputs {
            if let Some(place) = place(file) {
                if let Some((_, other)) = places.iter().find(|(there, _)| *there == place) {
                    bail!(Invalid(format!(
                        "two results are to be written to {}: give each its own file",
                        if is_standard(file) {
                            "standard output (-)".into()
                        } else {
                            other.display().to_string()
                        }
                    )));
                }
                places.push((place, file));
            }
            if is_standard(file) {
                terminal::take_standard_output();
                continue;
            }
            if file.is_dir() {
                bail!(
                    "cannot write {}: it is a folder; add the name of a file",
                    file.display()
                );
            }
            match file.parent() {
                Some(folder) if folder != Path::new("") && !folder.is_dir() => bail!(
                    "cannot write {}: the folder {} does not exist; create it first",
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
                "cannot write {}: this run reads it; choose another name for the result",
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

/// A regular file by its canonical name; devices and pipes may be read and written.
fn real(file: &Path) -> Option<PathBuf> {
    file.canonicalize().ok().filter(|real| real.is_file())
}

/// Whether a path means standard output.
fn is_standard(file: &Path) -> bool {
    file == Path::new("-")
}

/// Where a result will be, by which two with different spelling are known for the same; devices and pipes take several.
fn place(file: &Path) -> Option<PathBuf> {
    if is_standard(file) {
        return Some(file.to_path_buf());
    }
    if let Ok(there) = file.canonicalize() {
        return there.is_file().then_some(there);
    }
    let folder = file.parent().filter(|folder| *folder != Path::new(""));
    let folder = folder.unwrap_or(Path::new(".")).canonicalize().ok()?;
    Some(folder.join(file.file_name()?))
}

/// A path as a summary shows it, in one line.
pub fn shown(path: &Path) -> String {
    visible(&path.to_string_lossy()).into_owned()
}

/// Makes a folder for results.
pub fn make_folder(folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder).with_context(|| format!("cannot create {}", folder.display()))
}

/// Where a verb puts its result as JSON.
#[derive(Args)]
pub struct JsonOutput {
    /// Write the whole result as JSON; "-": to standard output instead of the text
    #[arg(long, value_name = "FILE|-", help_heading = "Output")]
    json: Option<PathBuf>,
}

impl JsonOutput {
    /// Whether it is wanted.
    pub fn is_wanted(&self) -> bool {
        self.json.is_some()
    }

    /// Where to, to be claimed.
    pub fn file(&self) -> Option<&Path> {
        self.json.as_deref()
    }

    /// Writes the result if it is wanted; whether it went to standard output.
    pub fn write(&self, files: &Files, json: &str) -> Result<bool> {
        match self.file() {
            Some(path) if is_standard(path) => terminal::result(json).map(|()| true),
            Some(path) => files.write(path, json).map(|()| false),
            None => Ok(false),
        }
    }
}
