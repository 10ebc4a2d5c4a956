//! The figures of a report as files.

use super::Document;
use std::path::{Path, PathBuf};

/// Which files are written of each figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Formats {
    /// NAME.svg.
    pub svg: bool,
    /// NAME.png.
    pub png: bool,
}

impl Default for Formats {
    fn default() -> Self {
        Self {
            svg: true,
            png: true,
        }
    }
}

/// Writes every figure of the document into a directory, which is made where it is missing;
/// returns what was written.
///
/// # Errors
/// A sentence for the user when a file cannot be written.
pub fn write(_document: &Document, _dir: &Path, _formats: Formats) -> Result<Vec<PathBuf>, String> {
    Ok(Vec::new())
}
