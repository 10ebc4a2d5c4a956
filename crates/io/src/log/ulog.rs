//! ulog

use std::path::Path;

use super::{Entries, Stream, Wanted};
use crate::ReadError;
use crate::source::Source;

pub(super) fn entries(
    path: &Path,
    _source: Source,
    _wanted: &Wanted,
) -> Result<Entries, ReadError> {
    Err(ReadError::new(path, "not read yet"))
}

pub(super) fn streams(path: &Path, _source: Source) -> Result<Vec<Stream>, ReadError> {
    Err(ReadError::new(path, "not read yet"))
}

pub(crate) fn detect(_start: &[u8]) -> bool {
    false
}
