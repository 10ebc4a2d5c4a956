//! The drive of a verb: a drive file, or logs that are described as `undrift inspect` does.

use crate::{
    inspect,
    output::{Files, shown},
    terminal::{Invalid, note},
};
use anyhow::{Context, Result, bail};
use clap::Args;
use std::path::{Path, PathBuf};
use undrift::{
    drive::Drive,
    inspect::{Inspection, drive_file, with_model},
};
use undrift_report::inspect as report;

/// Name of a drive file that is kept in memory only.
const UNSAVED: &str = "drive.toml";

/// Options of a verb that takes logs in place of a drive file.
#[derive(Args)]
pub struct Kept {
    /// Write the drive file that is made of the logs; without it, it is not kept
    #[arg(long, value_name = "DRIVE.toml", help_heading = "Output")]
    save_drive: Option<PathBuf>,
}

impl Kept {
    /// Where to write the drive file.
    pub fn file(&self) -> Option<&Path> {
        self.save_drive.as_deref()
    }
}

/// A drive, and what it was made from.
pub struct Source {
    /// The drive file, or the name of the one that logs make.
    pub file: PathBuf,
    pub drive: Drive,
    /// The text of the drive file where it was made of logs.
    pub made: Option<String>,
}

impl Source {
    /// The drive of a drive file, or of logs; `model`: the one that the command line gives.
    pub fn open(
        files: &[PathBuf],
        data: Option<&Path>,
        kept: &Kept,
        model: Option<&str>,
    ) -> Result<Self> {
        let [file] = files else {
            return Self::of_logs(files, inspect::read, data, kept, model);
        };
        match log(file) {
            Some(found) => Self::of_logs(files, |_| Ok(vec![found]), data, kept, model),
            None if kept.save_drive.is_some() => {
                let mistake = "--save-drive needs logs in place of a drive file";
                bail!(Invalid(mistake.into()));
            }
            None => Self::load(file, data),
        }
    }

    /// The drives of drive files, with the folder of the logs for all or for each in order; or the drive of logs.
    pub fn of_each(
        files: &[PathBuf],
        data: &[PathBuf],
        kept: &Kept,
        model: Option<&str>,
    ) -> Result<Vec<Self>> {
        let folder = |k: usize| data.get(k).or(data.first()).map(PathBuf::as_path);
        if files.len() == 1 || !files.iter().any(|file| is_toml(file)) {
            return Ok(vec![Self::open(files, folder(0), kept, model)?]);
        }
        let drives = files.iter().enumerate();
        drives
            .map(|(k, file)| Self::open(std::slice::from_ref(file), folder(k), kept, model))
            .collect()
    }

    /// Writes the drive file that was made of logs, where that is asked for.
    pub fn save(&self, files: &Files, kept: &Kept) -> Result<()> {
        match kept.file().zip(self.made.as_deref()) {
            Some((file, text)) => files.write(file, text),
            None => Ok(()),
        }
    }

    /// The text of the drive file.
    pub fn text(&self) -> Result<String> {
        match &self.made {
            Some(text) => Ok(text.clone()),
            None => std::fs::read_to_string(&self.file)
                .with_context(|| format!("cannot read {}", self.file.display())),
        }
    }

    /// The drive of a drive file.
    fn load(file: &Path, data: Option<&Path>) -> Result<Self> {
        Ok(Self {
            file: file.to_path_buf(),
            drive: Drive::load(file, data)?,
            made: None,
        })
    }

    /// The drive of logs, as `read` finds them.
    fn of_logs(
        files: &[PathBuf],
        read: impl FnOnce(&[PathBuf]) -> Result<Vec<Inspection>>,
        data: Option<&Path>,
        kept: &Kept,
        model: Option<&str>,
    ) -> Result<Self> {
        if let Some(drive) = files.iter().find(|file| is_toml(file)) {
            let drive = drive.display();
            let mistake = format!("specify {drive} alone, which names its logs, or logs alone");
            bail!(Invalid(mistake));
        }
        if data.is_some() {
            let mistake = "--data needs a drive file; specify the logs with their folder";
            bail!(Invalid(mistake.into()));
        }
        let inspections = read(files)?;
        if inspections.len() < files.len() {
            bail!("not every file could be read");
        }
        let (inspections, motion) = inspect::described(inspections);
        inspect::complete(&inspections, None)?;
        let file = kept.file().unwrap_or(Path::new(UNSAVED));
        let folder = file.parent().unwrap_or(Path::new(""));
        let guess = undrift::inspect::model(&inspections);
        let text = drive_file(&guess, &inspections, folder, None, motion, &report::comment);
        let logs = undrift::inspect::logs(&inspections, folder);
        let mut drive = Drive::with_logs(&text, &file.display().to_string(), folder, logs)?;
        drive.guessed_rate = undrift::inspect::guessed_rate(&inspections);
        drive.pose_faults = undrift::inspect::pose_faults(&inspections);
        let keep = match kept.file() {
            Some(file) => format!("drive file: {}", shown(file)),
            None => format!("--save-drive {UNSAVED} keeps the drive file"),
        };
        let names: Vec<_> = files.iter().map(|file| shown(file)).collect();
        note(format!("drive of {}; {keep}", names.join(" and ")));
        let guesses = report::guesses(&guess, motion, &inspections);
        let guesses = guesses.iter();
        // A model that the command line gives is no guess.
        guesses.skip(usize::from(model.is_some())).for_each(note);
        Ok(Self {
            file: file.to_path_buf(),
            drive,
            made: Some(match model {
                Some(name) => with_model(&text, name, folder),
                None => text,
            }),
        })
    }
}

fn is_toml(file: &Path) -> bool {
    file.extension()
        .is_some_and(|name| name.eq_ignore_ascii_case("toml"))
}

/// What a file is, if it is a log; what can be read once alone is not looked into.
fn log(file: &Path) -> Option<Inspection> {
    let again = std::fs::metadata(file).is_ok_and(|about| about.is_file() || about.is_dir());
    let found = (again && !is_toml(file)).then(|| undrift::inspect::inspect(file).ok());
    found.flatten().filter(|log| !log.parts.is_empty())
}
