//! The outcomes in a folder into one table and one summary.

use super::{FleetError, FleetOutcome, job_path, summary::Summary};
use crate::results::{self, Fleet};
use std::{io, path::Path};
use undrift_io::write::write_whole;

/// Makes `results.parquet` and `fleet.json` in a folder of the outcomes that are kept there
/// under these fingerprints, in their order. One outcome is in memory at a time.
///
/// # Errors
/// An outcome that is missing or is none; a file that cannot be written.
pub fn gather(fingerprints: &[String], folder: &Path) -> Result<Fleet, FleetError> {
    let path = folder.join("results.parquet");
    let mut summary = Summary::default();
    #[cfg(feature = "parquet")]
    let mut table = super::table::Table::create(&path).map_err(FleetError::file(&path))?;
    for fingerprint in fingerprints {
        let kept = job_path(folder, fingerprint);
        let text = std::fs::read_to_string(&kept).map_err(FleetError::file(&kept))?;
        let outcome = FleetOutcome::from_json(&text, &kept.display().to_string())?;
        #[cfg(feature = "parquet")]
        table
            .write(&outcome, fingerprint)
            .map_err(FleetError::file(&path))?;
        summary.add(&outcome);
    }
    #[cfg(feature = "parquet")]
    table.finish().map_err(FleetError::file(&path))?;
    #[cfg(not(feature = "parquet"))]
    drop(path);
    let fleet = summary.result();
    let text = results::text(&fleet) + "\n";
    write(&folder.join("fleet.json"), &text)?;
    tidy(folder).map_err(FleetError::file(folder))?;
    Ok(fleet)
}

fn write(path: &Path, text: &str) -> Result<(), FleetError> {
    write_whole(path, text).map_err(FleetError::file(path))
}

/// Removes what a killed process left of outcomes that are whole by now.
fn tidy(folder: &Path) -> io::Result<()> {
    for entry in std::fs::read_dir(folder.join("jobs"))? {
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
