//! Where the forward pass is kept: a temporary file, or memory where there is no folder for one.

use std::{
    fs::File,
    io::{self, BufWriter, Read, Seek, SeekFrom, Write},
};

/// Where the forward pass is kept until it is smoothed.
pub(super) enum Store {
    File(BufWriter<File>),
    Memory(Vec<u8>),
}

impl Store {
    /// A temporary file without a name, or memory where no folder takes one.
    pub(super) fn new() -> io::Result<Self> {
        use io::ErrorKind::{NotFound, PermissionDenied, ReadOnlyFilesystem};
        // The standard library panics when WebAssembly asks it for the folder.
        if cfg!(target_family = "wasm") {
            return Ok(Self::Memory(Vec::new()));
        }
        match tempfile::tempfile() {
            Ok(file) => Ok(Self::File(BufWriter::with_capacity(1 << 16, file))),
            Err(error) => match error.kind() {
                NotFound | PermissionDenied | ReadOnlyFilesystem => Ok(Self::Memory(Vec::new())),
                _ => Err(error),
            },
        }
    }

    /// Appends. Nothing may be appended after the first read.
    pub(super) fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        match self {
            Self::File(file) => file.write_all(bytes),
            Self::Memory(kept) => kept.write_all(bytes),
        }
    }

    /// Fills `bytes` with what was appended from byte `offset` on.
    pub(super) fn read(&mut self, offset: usize, bytes: &mut [u8]) -> io::Result<()> {
        match self {
            Self::File(file) => {
                file.seek(SeekFrom::Start(offset as u64))?;
                file.get_mut().read_exact(bytes)
            }
            Self::Memory(kept) => kept.get(offset..).unwrap_or_default().read_exact(bytes),
        }
    }
}
