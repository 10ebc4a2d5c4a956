//! SHA-256 as text.

use sha2::{Digest, Sha256};
use std::{fs::File, io, path::Path};

/// SHA-256 of a file's bytes, hexadecimal.
///
/// # Errors
/// If the file cannot be read.
pub fn of_file(path: &Path) -> io::Result<String> {
    let mut sum = Sha256::new();
    io::copy(&mut File::open(path)?, &mut sum)?;
    Ok(hexadecimal(sum))
}

/// What a sum has come to.
pub fn hexadecimal(sum: Sha256) -> String {
    let bytes = sum.finalize();
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
