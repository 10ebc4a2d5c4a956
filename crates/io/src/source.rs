//! Opening a file for reading, compressed or not.

mod utf16;
mod zip;

use std::fs::File;
use std::io::{self, BufRead, BufReader, Cursor, Read};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use flate2::bufread::MultiGzDecoder;

use crate::{ReadError, nearby, zstandard};

/// A text without the byte order mark of UTF-8 before it.
pub(crate) fn without_byte_order_mark(text: &[u8]) -> &[u8] {
    text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text)
}

/// A byte stream to read from.
pub type Source = Box<dyn BufRead + Send>;

/// Opens a log once more, from its start: for formats that tell only at their end what they hold.
pub(crate) type Again<'a> = &'a dyn Fn() -> Result<Source, ReadError>;

/// Size of the read buffers \[bytes\].
const BUFFER: usize = 256 * 1024;
const GZIP_MAGIC: [u8; 2] = [0x1f, 0x8b];
const ZSTD_MAGIC: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];

/// Bytes read of a log, as it is stored, for progress bars: clones count together.
#[derive(Clone, Debug, Default)]
pub struct BytesRead(Arc<AtomicU64>);

impl BytesRead {
    /// The number itself.
    pub fn bytes(&self) -> Arc<AtomicU64> {
        self.0.clone()
    }

    /// Counts from 0 again.
    pub(crate) fn restart(&self) {
        self.0.store(0, Relaxed);
    }
}

struct Counted<R> {
    inner: R,
    read: Arc<AtomicU64>,
}

impl<R: Read> Read for Counted<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let length = self.inner.read(buffer)?;
        self.read.fetch_add(length as u64, Relaxed);
        Ok(length)
    }
}

/// Fails once, where the beginning of a stream could not be read on.
pub(crate) struct Failing(pub(crate) Option<io::Error>);

impl Read for Failing {
    fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
        self.0.take().map_or(Ok(0), Err)
    }
}

/// The longest stream that is held to be converted \[bytes\].
pub(crate) const LONGEST_HELD: u64 = 256 << 20;

/// A stream as the text that `convert` makes of what is held of it, and as it is where it makes none.
pub(crate) fn converted(source: Source, convert: impl FnOnce(&[u8]) -> Option<String>) -> Source {
    let mut start = Vec::new();
    let mut source = source.take(LONGEST_HELD);
    let failure = source.read_to_end(&mut start).err();
    let text = convert(&start);
    let read = Cursor::new(text.map_or(start, String::into_bytes));
    let rest = BufReader::new(Failing(failure)).chain(source.into_inner());
    Box::new(read.chain(rest))
}

/// Opens a file.
///
/// # Errors
/// If it is missing or may not be read.
pub(crate) fn file(path: &Path) -> Result<File, ReadError> {
    File::open(path).map_err(|error| cannot_open(path, error))
}

/// Reads a stream; one that starts with the magic of gzip or zstd is decompressed (all its members), and so is a ZIP archive of one file, which the
/// second value says; UTF-16 becomes UTF-8. `read` counts on.
///
/// # Errors
/// If it cannot be read.
pub(crate) fn decompressed(
    name: &Path,
    stream: impl Read + Send + 'static,
    read: &BytesRead,
) -> Result<(Source, bool), ReadError> {
    let counted = Counted {
        inner: stream,
        read: read.bytes(),
    };
    let mut reader = BufReader::with_capacity(BUFFER, counted);
    let start = reader.fill_buf().map_err(|e| cannot_open(name, e))?;
    let (source, compressed): (Source, bool) = if start.starts_with(&GZIP_MAGIC) {
        let inflated = MultiGzDecoder::new(reader);
        (Box::new(BufReader::with_capacity(BUFFER, inflated)), true)
    } else if start.starts_with(&ZSTD_MAGIC) {
        let inflated = zstandard::decoder(reader).map_err(|e| cannot_open(name, e))?;
        (Box::new(BufReader::with_capacity(BUFFER, inflated)), true)
    } else if start.starts_with(&zip::MAGIC) {
        zip::only_file(Box::new(reader))
    } else {
        (Box::new(reader), false)
    };
    Ok((utf16::decoded(source), compressed))
}

/// Whether a text begins with lines that end in CR alone.
pub(crate) fn has_returns_alone(start: &[u8]) -> bool {
    let is_text = |byte: &u8| *byte >= b' ' || matches!(byte, b'\t' | b'\r');
    start.iter().filter(|byte| **byte == b'\r').count() > 1 && start.iter().all(is_text)
}

/// The same text with lines that end in LF.
pub(crate) fn with_newlines(source: Source, _: &[u8]) -> Source {
    struct Newlines(Source);
    impl Read for Newlines {
        fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
            let length = self.0.read(into)?;
            let returns = into.iter_mut().take(length).filter(|byte| **byte == b'\r');
            returns.for_each(|byte| *byte = b'\n');
            Ok(length)
        }
    }
    Box::new(BufReader::with_capacity(BUFFER, Newlines(source)))
}

/// Opens a file, plain or compressed.
///
/// # Errors
/// If it is missing, is a directory or cannot be read.
pub(crate) fn open(path: &Path) -> Result<Source, ReadError> {
    Ok(decompressed(path, file(path)?, &BytesRead::default())?.0)
}

/// All bytes of a file, decompressed.
///
/// # Errors
/// If it is missing, is a directory or cannot be read.
pub fn bytes(path: &Path) -> Result<Vec<u8>, ReadError> {
    let mut bytes = Vec::new();
    let read = open(path)?.read_to_end(&mut bytes);
    read.map_err(|error| cannot_open(path, error))?;
    Ok(bytes)
}

pub(crate) fn cannot_open(path: &Path, error: io::Error) -> ReadError {
    // What is said in full needs no cause after it.
    let problem = match error.kind() {
        io::ErrorKind::NotFound => return missing(path),
        io::ErrorKind::PermissionDenied => "no permission to read",
        io::ErrorKind::IsADirectory => "is a directory, not a file",
        io::ErrorKind::OutOfMemory => {
            return ReadError::new(
                path,
                "does not fit into memory, where what comes by a pipe is held",
            )
            .mend("write it into a file");
        }
        _ => {
            let problem = format!("cannot be read: {error}");
            return ReadError::new(path, problem).caused_by(error);
        }
    };
    ReadError::new(path, problem)
}

/// A file that is not there, and those of its folder whose names are near.
fn missing(path: &Path) -> ReadError {
    let error = ReadError::new(path, "no such file");
    match nearby::names(path) {
        Some(names) => error.mend(names),
        None => error,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

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
    fn what_is_read_is_counted() {
        let path = std::env::temp_dir().join(format!("undrift-io-{}-counted", std::process::id()));
        let bytes = gzip(&"a line of text\n".repeat(1000));
        std::fs::write(&path, &bytes).unwrap();
        let read = BytesRead::default();
        // The second time from 0 again.
        for _ in 0..2 {
            read.restart();
            let mut text = String::new();
            let (mut source, compressed) =
                decompressed(&path, file(&path).unwrap(), &read).unwrap();
            assert!(compressed);
            source.read_to_string(&mut text).unwrap();
            assert_eq!(text.len(), 15_000);
            assert_eq!(read.bytes().load(Relaxed), bytes.len() as u64);
        }
        std::fs::remove_file(&path).unwrap();
    }

    #[test]
    fn a_missing_file_is_named() {
        let error = open(Path::new("nowhere/imu.csv")).err().unwrap();
        assert_eq!(error.to_string(), "nowhere/imu.csv: no such file");
        let error = open(&std::env::temp_dir()).err().unwrap();
        assert!(error.to_string().contains("directory"), "{error}");
    }
}
