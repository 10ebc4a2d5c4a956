//! The outcomes in a folder into one table and one summary.

use super::{FleetError, FleetOutcome, job_path, summary::Tally};
use std::{
    io,
    path::{Path, PathBuf},
};
use undrift_io::write::write_whole;
use undrift_results::{self as results, Fleet};

/// Makes `results.parquet` and `fleet.json` in a folder of the outcomes that are kept there
/// under these fingerprints, in their order. One outcome is in memory at a time.
///
/// # Errors
/// An outcome that is missing or damaged; a file that cannot be written.
pub fn gather(fingerprints: &[String], folder: &Path) -> Result<Fleet, FleetError> {
    let mut gathering = Gathering::start(folder)?;
    for fingerprint in fingerprints {
        let kept = job_path(folder, fingerprint);
        let text = std::fs::read_to_string(&kept).map_err(FleetError::file(&kept))?;
        gathering.add(fingerprint, &text)?;
    }
    gathering.finish()
}

/// Table and summary while outcomes are added, wherever they are kept.
pub struct Gathering {
    folder: PathBuf,
    path: PathBuf,
    #[cfg(feature = "parquet")]
    table: super::table::Table,
    summary: Tally,
}

impl Gathering {
    /// Begins `results.parquet` and `fleet.json` in a folder; they appear at [`Gathering::finish`].
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn start(folder: &Path) -> Result<Self, FleetError> {
        let path = folder.join("results.parquet");
        Ok(Self {
            folder: folder.to_owned(),
            #[cfg(feature = "parquet")]
            table: super::table::Table::create(&path).map_err(FleetError::file(&path))?,
            path,
            summary: Tally::default(),
        })
    }

    /// Adds the outcome kept under a fingerprint by its text.
    ///
    /// # Errors
    /// A text that is no outcome, which leaves all as it was; a file that cannot be written.
    pub fn add(&mut self, fingerprint: &str, text: &str) -> Result<(), FleetError> {
        let kept = job_path(&self.folder, fingerprint);
        let outcome = FleetOutcome::from_json(text, &kept.display().to_string())?;
        #[cfg(feature = "parquet")]
        self.table
            .write(&outcome, fingerprint)
            .map_err(FleetError::file(&self.path))?;
        self.summary.add(&outcome);
        Ok(())
    }

    /// Writes the files.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn finish(self) -> Result<Fleet, FleetError> {
        #[cfg(feature = "parquet")]
        self.table.finish().map_err(FleetError::file(&self.path))?;
        #[cfg(not(feature = "parquet"))]
        drop(self.path);
        let fleet = self.summary.result();
        let path = self.folder.join("fleet.json");
        write_whole(&path, results::text(&fleet) + "\n").map_err(FleetError::file(&path))?;
        tidy(&self.folder).map_err(FleetError::file(&self.folder))?;
        Ok(fleet)
    }
}

/// Removes what a killed process left of outcomes that are whole by now.
fn tidy(folder: &Path) -> io::Result<()> {
    let jobs = folder.join("jobs");
    if !jobs.is_dir() {
        return Ok(());
    }
    for entry in std::fs::read_dir(jobs)? {
        let path = entry?.path();
        let name = path
            .file_name()
            .map(|name| name.to_string_lossy().into_owned());
        let whole = name.as_deref().and_then(|name| {
            let (hidden, _) = name.rsplit_once(".part")?;
            Some(path.with_file_name(hidden.strip_prefix('.')?))
        });
        if whole.is_some_and(|whole| whole.is_file()) {
            std::fs::remove_file(&path)?;
        }
    }
    Ok(())
}
