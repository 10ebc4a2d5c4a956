//! Opening a file for reading, compressed or not.

use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::path::Path;

use flate2::bufread::MultiGzDecoder;

use crate::ReadError;

/// A byte stream to read from.
pub type Source = Box<dyn BufRead + Send>;

/// Size of the read buffers [bytes].
const BUFFER: usize = 256 * 1024;
const GZIP_MAGIC: [u8; 2] = [0x1f, 0x8b];

/// Opens a file; one that starts with the gzip magic is decompressed (all its members), whatever
/// its name.
///
/// # Errors
/// If the file is missing, is a directory or cannot be read.
pub fn open(path: &Path) -> Result<Source, ReadError> {
    let file = File::open(path).map_err(|e| cannot_open(path, e))?;
    let mut reader = BufReader::with_capacity(BUFFER, file);
    let start = reader.fill_buf().map_err(|e| cannot_open(path, e))?;
    if start.starts_with(&GZIP_MAGIC) {
        let inflated = MultiGzDecoder::new(reader);
        Ok(Box::new(BufReader::with_capacity(BUFFER, inflated)))
    } else {
        Ok(Box::new(reader))
    }
}

fn cannot_open(path: &Path, error: io::Error) -> ReadError {
    let problem = match error.kind() {
        io::ErrorKind::NotFound => "no such file".to_owned(),
        io::ErrorKind::PermissionDenied => "no permission to read".to_owned(),
        io::ErrorKind::IsADirectory => "is a directory, not a file".to_owned(),
        _ => format!("cannot be read: {error}"),
    };
    ReadError::new(path, problem).caused_by(error)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{Read, Write};

    fn gzip(text: &str) -> Vec<u8> {
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        encoder.write_all(text.as_bytes()).unwrap();
        encoder.finish().unwrap()
    }

    fn read_back(name: &str, bytes: &[u8]) -> String {
        let path = std::env::temp_dir().join(format!("undrift-io-{}-{name}", std::process::id()));
        std::fs::write(&path, bytes).unwrap();
        let mut text = String::new();
        open(&path).unwrap().read_to_string(&mut text).unwrap();
        std::fs::remove_file(&path).unwrap();
        text
    }

    #[test]
    fn gzip_is_known_by_content_and_all_members_are_read() {
        assert_eq!(read_back("plain.gz", b"not compressed"), "not compressed");
        let members = [gzip("one "), gzip("two")].concat();
        assert_eq!(read_back("two-members.csv", &members), "one two");
        assert_eq!(read_back("empty", b""), "");
    }

    #[test]
    fn a_missing_file_is_named() {
        let error = open(Path::new("nowhere/imu.csv")).err().unwrap();
        assert_eq!(error.to_string(), "nowhere/imu.csv: no such file");
        let error = open(&std::env::temp_dir()).err().unwrap();
        assert!(error.to_string().contains("directory"), "{error}");
    }
}
