//! MATLAB files of level 5, as `save -v6` and `-v7` write them: their variables that are structures of
//! numbers. After "MAT-File Format", The MathWorks, chapter 1.

use std::io::Read;

use flate2::read::ZlibDecoder;

use crate::ReadError;
use crate::log::bytes::{ByteFields, Number};
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

/// A matrix of numbers, column by column as MATLAB stores it, in the bytes of the file.
#[derive(Clone, Debug)]
pub(super) struct Numbers {
    pub(super) rows: usize,
    pub(super) columns: usize,
    /// How they are stored: it may be smaller than the class of the array.
    number: Number,
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
        let bytes = self.bytes.get(index * self.number.size()..)?;
        self.number.read(bytes, self.big_endian)
    }
}

/// A number by the type of its element.
fn number_of(kind: u32) -> Option<Number> {
    Some(match kind {
        1 => Number::I8,
        2 => Number::U8,
        3 => Number::I16,
        4 => Number::U16,
        5 => Number::I32,
        6 => Number::U32,
        7 => Number::F32,
        9 => Number::F64,
        12 => Number::I64,
        13 => Number::U64,
        _ => return None,
    })
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
            _ => return resave("is not a MATLAB file of version 5 to 7"),
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
            let mut numbers = ByteFields::ordered(&tag, self.big_endian);
            let Some((kind, length)) = numbers.u32().zip(numbers.u32()) else {
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
            let inflated;
            let content = match kind {
                MATRIX => bytes.as_slice(),
                COMPRESSED => {
                    inflated = inflate(&bytes)?;
                    match element(&mut ByteFields::ordered(&inflated, self.big_endian)) {
                        Some((MATRIX, content)) => content,
                        Some(_) => continue,
                        None => return Err("a compressed variable is damaged".into()),
                    }
                }
                _ => continue,
            };
            let mut content = ByteFields::ordered(content, self.big_endian);
            let damaged = || format!("variable {} is damaged", self.number);
            return variable(&mut content).map(Some).ok_or_else(damaged);
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

fn head<'a>(content: &mut ByteFields<'a>) -> Option<Head<'a>> {
    let (_, flags) = element(content)?;
    let [class, bits, ..] = content.within(flags).u32()?.to_le_bytes();
    let (_, sizes) = element(content)?;
    let mut sizes = content.within(sizes);
    let dimensions = std::iter::from_fn(|| sizes.u32()).collect();
    let (_, name) = element(content)?;
    Some(Head {
        class,
        complex: bits & COMPLEX != 0,
        dimensions,
        name,
    })
}

fn variable(content: &mut ByteFields) -> Option<Variable> {
    let head = head(content)?;
    let sizes: Vec<String> = head.dimensions.iter().map(u32::to_string).collect();
    let one = head.dimensions.iter().all(|size| *size == 1);
    Some(Variable {
        name: String::from_utf8_lossy(head.name).into_owned(),
        about: format!("{} {}", class_name(head.class), sizes.join("×")),
        fields: match (head.class, one) {
            (STRUCT, true) => Some(fields(content)?),
            _ => None,
        },
    })
}

/// The fields of one structure; those that are no real matrices of numbers are left out.
fn fields(content: &mut ByteFields) -> Option<Vec<(String, Numbers)>> {
    let (_, width) = element(content)?;
    let width = content.within(width).u32()? as usize;
    let (_, names) = element(content)?;
    if width == 0 || names.len() / width > MAX_FIELDS {
        return None;
    }
    let mut fields = Vec::new();
    for name in names.chunks_exact(width) {
        let name = name.split(|byte| *byte == 0).next().unwrap_or_default();
        let (kind, bytes) = element(content)?;
        if kind != MATRIX {
            return None;
        }
        // An empty field has no content at all.
        if bytes.is_empty() {
            continue;
        }
        let mut inner = content.within(bytes);
        let head = head(&mut inner)?;
        if let (6..=15, false, [rows, columns]) = (head.class, head.complex, &head.dimensions[..]) {
            let (rows, columns) = (*rows as usize, *columns as usize);
            let (kind, bytes) = element(&mut inner)?;
            let number = number_of(kind)?;
            let size = rows.checked_mul(columns)?.checked_mul(number.size())?;
            if size != bytes.len() {
                return None;
            }
            let numbers = Numbers {
                rows,
                columns,
                number,
                big_endian: inner.is_big_endian(),
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

/// The next element: its type and content. Up to four bytes may stand in the tag itself, whose upper half
/// is their number then; others are padded to eight.
fn element<'a>(fields: &mut ByteFields<'a>) -> Option<(u32, &'a [u8])> {
    let kind = fields.u32()?;
    if kind >> 16 != 0 {
        let four = fields.take(4)?;
        return Some((kind & 0xffff, four.get(..(kind >> 16) as usize)?));
    }
    let length = fields.u32()? as usize;
    let content = fields.take(length)?;
    if kind != COMPRESSED {
        // The last one may be without.
        let _ = fields.take(length.next_multiple_of(8) - length);
    }
    Some((kind, content))
}
