//! MATLAB files of level 5, as `save -v6` and `-v7` write them: their variables that are structures of
//! numbers. After "MAT-File Format", The MathWorks, chapter 1.

use std::io::Read;

use flate2::read::ZlibDecoder;

use crate::ReadError;
use crate::source::Source;

/// Start of a file of level 5.
pub(super) const LEVEL_5: &[u8] = b"MATLAB 5.0 MAT-file";
/// Start of a file of version 7.3, which is HDF5.
pub(super) const HDF5: &[u8] = b"MATLAB 7.3 MAT-file";
const HEADER: usize = 128;
/// Largest variable that is read, uncompressed \[bytes\].
const MAX_VARIABLE: u64 = 1 << 29;
/// Fields of a structure at most.
const MAX_FIELDS: usize = 1000;

// Types of elements.
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
// Classes of arrays.
const STRUCT: u8 = 2;
const COMPLEX: u8 = 0x08;

/// A matrix of numbers, column by column as MATLAB has it, in the bytes of the file.
#[derive(Clone, Debug)]
pub(super) struct Numbers {
    pub(super) rows: usize,
    pub(super) columns: usize,
    /// Type of the numbers, which may be smaller than the class of the array.
    kind: u32,
    big_endian: bool,
    bytes: Vec<u8>,
}

impl Numbers {
    /// The number at a place counted from 0; NaN outside.
    pub(super) fn at(&self, row: usize, column: usize) -> f64 {
        let inside = row < self.rows && column < self.columns;
        let index = column * self.rows + row;
        inside
            .then(|| self.nth(index))
            .flatten()
            .unwrap_or(f64::NAN)
    }

    fn nth(&self, index: usize) -> Option<f64> {
        Some(match self.kind {
            1 => f64::from(i8::from_le_bytes(self.bytes_of(index)?)),
            2 => f64::from(u8::from_le_bytes(self.bytes_of(index)?)),
            3 => f64::from(i16::from_le_bytes(self.bytes_of(index)?)),
            4 => f64::from(u16::from_le_bytes(self.bytes_of(index)?)),
            5 => f64::from(i32::from_le_bytes(self.bytes_of(index)?)),
            6 => f64::from(u32::from_le_bytes(self.bytes_of(index)?)),
            7 => f64::from(f32::from_le_bytes(self.bytes_of(index)?)),
            9 => f64::from_le_bytes(self.bytes_of(index)?),
            12 => i64::from_le_bytes(self.bytes_of(index)?) as f64,
            13 => u64::from_le_bytes(self.bytes_of(index)?) as f64,
            _ => return None,
        })
    }

    /// The bytes of a number, the lowest first.
    fn bytes_of<const N: usize>(&self, index: usize) -> Option<[u8; N]> {
        let mut bytes: [u8; N] = *self.bytes.get(index * N..)?.first_chunk()?;
        if self.big_endian {
            bytes.reverse();
        }
        Some(bytes)
    }
}

/// Size of a number by its type \[bytes\].
fn size_of(kind: u32) -> Option<usize> {
    match kind {
        1 | 2 => Some(1),
        3 | 4 => Some(2),
        5..=7 => Some(4),
        9 | 12 | 13 => Some(8),
        _ => None,
    }
}

/// A variable: a name and, if it is one structure, those of its fields that are real matrices.
pub(super) struct Variable {
    pub(super) name: String,
    /// What it is, in a few words.
    pub(super) about: String,
    pub(super) fields: Option<Vec<(String, Numbers)>>,
}

impl Variable {
    /// A field by its name.
    pub(super) fn field(&self, name: &str) -> Option<&Numbers> {
        let mut fields = self.fields.iter().flatten();
        fields.find(|(field, _)| field == name).map(|(_, n)| n)
    }

    /// Takes a field out.
    pub(super) fn take(&mut self, name: &str) -> Option<Numbers> {
        let fields = self.fields.as_mut()?;
        let index = fields.iter().position(|(field, _)| field == name)?;
        Some(fields.swap_remove(index).1)
    }
}

/// Reads a file variable by variable; one is held at a time.
pub(super) struct Variables {
    source: Source,
    big_endian: bool,
    number: u64,
}

impl Variables {
    pub(super) fn open(mut source: Source) -> Result<Self, ReadError> {
        let mut header = Vec::new();
        let read = source.by_ref().take(HEADER as u64).read_to_end(&mut header);
        read.map_err(|error| ReadError::nameless(format!("cannot be read: {error}")))?;
        let resave = |problem| Err(ReadError::nameless(problem).mend("save it with -v7"));
        if header.is_empty() {
            return Err(ReadError::nameless("is empty"));
        }
        if header.starts_with(HDF5) {
            return resave("is a MATLAB file of version 7.3");
        }
        let big_endian = match header.get(126..128) {
            Some(b"IM") => false,
            Some(b"MI") => true,
            _ => return resave("is no MATLAB file of version 5 to 7"),
        };
        let version = header.get(124..126).unwrap_or_default();
        if version != [u8::from(big_endian), u8::from(!big_endian)] {
            return resave("is a MATLAB file of an unknown version");
        }
        Ok(Self {
            source,
            big_endian,
            number: 0,
        })
    }

    /// The next variable; `Err` says how the file is damaged, after which there is no more.
    pub(super) fn next(&mut self) -> Result<Option<Variable>, String> {
        loop {
            let mut tag = Vec::new();
            self.read(8, &mut tag)?;
            if tag.is_empty() {
                return Ok(None);
            }
            self.number += 1;
            let Some((kind, length)) = Words::new(&tag, self.big_endian).two() else {
                return Err("ends in the middle of a variable".into());
            };
            let mut bytes = Vec::new();
            if u64::from(length) > MAX_VARIABLE {
                return Err(too_large());
            }
            self.read(length, &mut bytes)?;
            if bytes.len() < length as usize {
                return Err("ends in the middle of a variable".into());
            }
            let mut words = Words::new(&bytes, self.big_endian);
            let inflated;
            match kind {
                MATRIX => {}
                COMPRESSED => {
                    inflated = inflate(&bytes)?;
                    match Words::new(&inflated, self.big_endian).element() {
                        Some((MATRIX, content)) => words.bytes = content,
                        Some(_) => continue,
                        None => return Err("a compressed variable is damaged".into()),
                    }
                }
                _ => continue,
            }
            let damaged = || format!("variable {} is damaged", self.number);
            return variable(&mut words).map(Some).ok_or_else(damaged);
        }
    }

    fn read(&mut self, length: u32, into: &mut Vec<u8>) -> Result<(), String> {
        let part = self.source.by_ref().take(u64::from(length));
        let read = { part }.read_to_end(into);
        read.map(|_| ()).map_err(|error| error.to_string())
    }
}

fn too_large() -> String {
    format!("holds a variable of more than {} MiB", MAX_VARIABLE >> 20)
}

fn inflate(bytes: &[u8]) -> Result<Vec<u8>, String> {
    let mut inflated = Vec::new();
    let read = ZlibDecoder::new(bytes)
        .take(MAX_VARIABLE + 1)
        .read_to_end(&mut inflated)
        .map_err(|error| format!("a compressed variable is damaged: {error}"))?;
    if read as u64 > MAX_VARIABLE {
        return Err(too_large());
    }
    Ok(inflated)
}

/// The header of an array: its class, its size and its name.
struct Head<'a> {
    class: u8,
    complex: bool,
    dimensions: Vec<u32>,
    name: &'a [u8],
}

fn head<'a>(words: &mut Words<'a>) -> Option<Head<'a>> {
    let (_, flags) = words.element()?;
    let (flags, _) = Words::new(flags, words.big_endian).two()?;
    let [class, bits, ..] = flags.to_le_bytes();
    let (_, sizes) = words.element()?;
    let dimensions = sizes.chunks_exact(4).map(|size| words.number(size));
    let dimensions = dimensions.collect();
    let (_, name) = words.element()?;
    Some(Head {
        class,
        complex: bits & COMPLEX != 0,
        dimensions,
        name,
    })
}

fn variable(words: &mut Words) -> Option<Variable> {
    let head = head(words)?;
    let name = String::from_utf8_lossy(head.name).into_owned();
    let sizes: Vec<String> = head.dimensions.iter().map(u32::to_string).collect();
    let about = format!("{} {}", class_name(head.class), sizes.join("×"));
    let one = head.dimensions.iter().all(|size| *size == 1);
    let fields = match (head.class, one) {
        (STRUCT, true) => Some(fields(words)?),
        _ => None,
    };
    Some(Variable {
        name,
        about,
        fields,
    })
}

/// The fields of one structure; those that are no real matrices of numbers are left out.
fn fields(words: &mut Words) -> Option<Vec<(String, Numbers)>> {
    let (_, width) = words.element()?;
    let width = words.number(width.get(..4)?) as usize;
    let (_, names) = words.element()?;
    if width == 0 || names.len() / width > MAX_FIELDS {
        return None;
    }
    let mut fields = Vec::new();
    for name in names.chunks_exact(width) {
        let name = name.split(|byte| *byte == 0).next().unwrap_or_default();
        let (kind, content) = words.element()?;
        if kind != MATRIX {
            return None;
        }
        // An empty field has no content at all.
        if content.is_empty() {
            continue;
        }
        let mut inner = Words::new(content, words.big_endian);
        let head = head(&mut inner)?;
        if let (6..=15, false, [rows, columns]) = (head.class, head.complex, &head.dimensions[..]) {
            let (rows, columns) = (*rows as usize, *columns as usize);
            let (kind, bytes) = inner.element()?;
            let size = rows.checked_mul(columns)?.checked_mul(size_of(kind)?)?;
            if size != bytes.len() {
                return None;
            }
            let numbers = Numbers {
                rows,
                columns,
                kind,
                big_endian: words.big_endian,
                bytes: bytes.to_vec(),
            };
            fields.push((String::from_utf8_lossy(name).into_owned(), numbers));
        }
    }
    Some(fields)
}

fn class_name(class: u8) -> &'static str {
    match class {
        1 => "cell",
        STRUCT => "struct",
        3 => "object",
        4 => "char",
        5 => "sparse",
        6 => "double",
        7 => "single",
        8..=15 => "integer",
        _ => "array",
    }
}

/// Walks along the elements in some bytes.
struct Words<'a> {
    bytes: &'a [u8],
    big_endian: bool,
}

impl<'a> Words<'a> {
    fn new(bytes: &'a [u8], big_endian: bool) -> Self {
        Self { bytes, big_endian }
    }

    /// An unsigned number of four bytes; 0 if there are fewer.
    fn number(&self, bytes: &[u8]) -> u32 {
        let bytes = bytes.first_chunk().copied().unwrap_or_default();
        if self.big_endian {
            u32::from_be_bytes(bytes)
        } else {
            u32::from_le_bytes(bytes)
        }
    }

    /// The next two numbers.
    fn two(&mut self) -> Option<(u32, u32)> {
        let (tag, rest) = self.bytes.split_at_checked(8)?;
        self.bytes = rest;
        Some((self.number(tag), self.number(tag.get(4..)?)))
    }

    /// The next element: its type and content. Up to four bytes may stand in the tag itself, whose
    /// upper half is their number then; others are padded to eight.
    fn element(&mut self) -> Option<(u32, &'a [u8])> {
        let (tag, _) = self.bytes.split_at_checked(8)?;
        let (kind, length) = self.two()?;
        if kind >> 16 != 0 {
            return Some((kind & 0xffff, tag.get(4..)?.get(..(kind >> 16) as usize)?));
        }
        let (content, rest) = self.bytes.split_at_checked(length as usize)?;
        let padding = if kind == COMPRESSED {
            0
        } else {
            length.next_multiple_of(8) - length
        };
        self.bytes = rest.get(padding as usize..).unwrap_or_default();
        Some((kind, content))
    }
}
