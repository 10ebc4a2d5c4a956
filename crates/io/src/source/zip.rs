//! ZIP archives of one file, as mail programs, telephones and sharing services make them of a log.
//!
//! Format: PKWARE's APPNOTE.TXT 6.3.10, sections 4.3.7 (local header), 4.3.12 (central directory), 4.3.16 (its end).

use std::io::{BufReader, Cursor, Read};

use super::{Failing, LONGEST_HELD, Source};
use flate2::read::DeflateDecoder;

/// What a local header begins with.
pub(super) const MAGIC: [u8; 4] = *b"PK\x03\x04";
const ENTRY: [u8; 4] = *b"PK\x01\x02";
const END: [u8; 4] = *b"PK\x05\x06";
/// Lengths of the headers without names and comments \[bytes\].
const LOCAL_LENGTH: usize = 30;
const ENTRY_LENGTH: usize = 46;
/// Methods of compression.
const STORED: u16 = 0;
const DEFLATED: u16 = 8;

/// The only file of an archive, decompressed, and true; an archive of several (a workbook is one), or of a kind that is not
/// read here, as it is.
pub(super) fn only_file(source: Source) -> (Source, bool) {
    let mut held = Vec::new();
    let mut source = source.take(LONGEST_HELD);
    let failure = source.read_to_end(&mut held).err();
    let Some((method, data)) = only_entry(&held) else {
        let rest = BufReader::new(Failing(failure)).chain(source.into_inner());
        return (Box::new(Cursor::new(held).chain(rest)), false);
    };
    let data = Cursor::new(data.to_vec());
    match method {
        STORED => (Box::new(data), true),
        _ => (Box::new(BufReader::new(DeflateDecoder::new(data))), true),
    }
}

/// Method and bytes of the only file, by the central directory.
fn only_entry(archive: &[u8]) -> Option<(u16, &[u8])> {
    let end = archive.windows(END.len()).rposition(|bytes| bytes == END)?;
    let end = archive.get(end..)?;
    let entries = number::<2>(end, 10)?;
    let mut at = number::<4>(end, 16)?;
    let mut found = None;
    for _ in 0..entries {
        let entry = archive
            .get(at..)
            .filter(|bytes| bytes.starts_with(&ENTRY))?;
        let name = number::<2>(entry, 28)?;
        let more = number::<2>(entry, 30)? + number::<2>(entry, 32)?;
        let is_file = is_log(entry.get(ENTRY_LENGTH..ENTRY_LENGTH + name)?);
        at += ENTRY_LENGTH + name + more;
        if is_file && found.replace(entry).is_some() {
            return None;
        }
    }
    let entry = found?;
    let is_encrypted = number::<2>(entry, 8)? & 1 == 1;
    let method = u16::try_from(number::<2>(entry, 10)?).ok()?;
    let local = archive.get(number::<4>(entry, 42)?..)?;
    let start = LOCAL_LENGTH + number::<2>(local, 26)? + number::<2>(local, 28)?;
    let data = local.get(start..)?.get(..number::<4>(entry, 20)?)?;
    let is_read = local.starts_with(&MAGIC) && matches!(method, STORED | DEFLATED);
    (is_read && !is_encrypted).then_some((method, data))
}

/// Whether a name is that of a file, and not of a folder or of what macOS writes beside each file.
fn is_log(name: &[u8]) -> bool {
    !name.ends_with(b"/") && !name.starts_with(b"__MACOSX/")
}

/// A number of so many bytes, the lowest first.
fn number<const N: usize>(bytes: &[u8], at: usize) -> Option<usize> {
    let bytes = bytes.get(at..)?.get(..N)?;
    let number = bytes.iter().rev();
    Some(number.fold(0, |number, byte| number << 8 | usize::from(*byte)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Archives by Python's zipfile (`testdata/golden/formats/zip/make.py`): deflated with what macOS adds, stored, of two files.
    const ARCHIVES: [&[u8]; 3] = [
        include_bytes!("../../../../testdata/golden/formats/zip/deflated.zip"),
        include_bytes!("../../../../testdata/golden/formats/zip/stored.zip"),
        include_bytes!("../../../../testdata/golden/formats/zip/two.zip"),
    ];

    fn read(archive: &[u8]) -> (Vec<u8>, bool) {
        let (mut source, is_one) = only_file(Box::new(Cursor::new(archive.to_vec())));
        let mut read = Vec::new();
        source.read_to_end(&mut read).unwrap();
        (read, is_one)
    }

    #[test]
    fn the_only_file_is_read_and_what_is_several_stays() {
        let log: String = (0..50).map(|k| format!("{k},0.5,-9.8\n")).collect();
        let [deflated, stored, two] = ARCHIVES;
        assert_eq!(read(deflated), (log.clone().into_bytes(), true));
        assert_eq!(read(stored), (log.into_bytes(), true));
        assert_eq!(read(two), (two.to_vec(), false));
    }

    #[test]
    fn damage_of_any_kind_ends() {
        for archive in ARCHIVES {
            for end in 0..archive.len() {
                let _ = only_entry(&archive[..end]);
            }
            for at in 0..archive.len() {
                for bits in [0x01, 0x80, 0xff] {
                    let mut damaged = archive.to_vec();
                    damaged[at] ^= bits;
                    let (mut source, _) = only_file(Box::new(Cursor::new(damaged)));
                    let _ = source.read_to_end(&mut Vec::new());
                }
            }
            // Encrypted, or of another method: as it is.
            let entry = archive
                .windows(4)
                .rposition(|bytes| bytes == ENTRY)
                .unwrap();
            for (at, byte) in [(8, 1), (10, 99)] {
                let mut other = archive.to_vec();
                other[entry + at] = byte;
                assert!(only_entry(&other).is_none());
            }
        }
    }
}
