//! Formats of topics: where in a message which field is.

use std::collections::HashMap;

use undrift_nav::Vector3;

/// Formats that are kept at most: some hundred topics are usual.
const MAX_FORMATS: usize = 4096;
/// Formats within formats at most.
const MAX_DEPTH: usize = 16;
/// No message is longer \[bytes\].
const MAX_SIZE: usize = 65_535;

/// A number of the format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Scalar {
    fn of(name: &str) -> Option<Self> {
        Some(match name {
            "int8_t" => Self::I8,
            "uint8_t" | "bool" | "char" => Self::U8,
            "int16_t" => Self::I16,
            "uint16_t" => Self::U16,
            "int32_t" => Self::I32,
            "uint32_t" => Self::U32,
            "int64_t" => Self::I64,
            "uint64_t" => Self::U64,
            "float" => Self::F32,
            "double" => Self::F64,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    fn read(self, bytes: &[u8]) -> Option<f64> {
        Some(match self {
            Self::I8 => f64::from(i8::from_le_bytes(*bytes.first_chunk()?)),
            Self::U8 => f64::from(*bytes.first()?),
            Self::I16 => f64::from(i16::from_le_bytes(*bytes.first_chunk()?)),
            Self::U16 => f64::from(u16::from_le_bytes(*bytes.first_chunk()?)),
            Self::I32 => f64::from(i32::from_le_bytes(*bytes.first_chunk()?)),
            Self::U32 => f64::from(u32::from_le_bytes(*bytes.first_chunk()?)),
            // Microseconds of a time stay below 2⁵³.
            Self::I64 => i64::from_le_bytes(*bytes.first_chunk()?) as f64,
            Self::U64 => u64::from_le_bytes(*bytes.first_chunk()?) as f64,
            Self::F32 => f64::from(f32::from_le_bytes(*bytes.first_chunk()?)),
            Self::F64 => f64::from_le_bytes(*bytes.first_chunk()?),
        })
    }
}

/// A field as the format declares it.
struct Declared {
    kind: Kind,
    count: usize,
    name: String,
}

enum Kind {
    Number(Scalar),
    /// A format of this name.
    Nested(String),
}

/// The formats that the file has defined, by name.
#[derive(Default)]
pub(super) struct Formats(HashMap<String, Vec<Declared>>);

impl Formats {
    /// Takes in a definition, such as `gyro:uint64_t timestamp;float[3] rate;`; false if it is none.
    pub(super) fn define(&mut self, text: &[u8]) -> bool {
        let parsed = std::str::from_utf8(text).ok().and_then(parse);
        match parsed {
            Some((name, fields)) if self.0.len() < MAX_FORMATS => {
                self.0.insert(name, fields);
                true
            }
            _ => false,
        }
    }

    /// Where the fields of a topic are; `None` if it or a format in it is not defined.
    pub(super) fn layout(&self, topic: &str) -> Option<Layout> {
        let mut sizes = HashMap::new();
        let mut layout = Layout::default();
        for field in self.0.get(topic)? {
            if let Kind::Number(scalar) = field.kind {
                let place = Place {
                    scalar,
                    count: field.count,
                    offset: layout.size,
                };
                layout.fields.insert(field.name.clone(), place);
            }
            layout.size = self.end(field, layout.size, 0, &mut sizes)?;
            // Padding at the end is not logged.
            if !field.name.starts_with("_padding") {
                layout.least = layout.size;
            }
        }
        Some(layout)
    }

    /// Where a field ends that starts at `from`.
    fn end<'a>(
        &'a self,
        field: &'a Declared,
        from: usize,
        depth: usize,
        sizes: &mut HashMap<&'a str, usize>,
    ) -> Option<usize> {
        let size = match &field.kind {
            Kind::Number(scalar) => scalar.size(),
            Kind::Nested(name) => match sizes.get(name.as_str()) {
                Some(size) => *size,
                None if depth >= MAX_DEPTH => return None,
                None => {
                    let mut size = 0;
                    for inner in self.0.get(name)? {
                        size = self.end(inner, size, depth + 1, sizes)?;
                    }
                    sizes.insert(name, size);
                    size
                }
            },
        };
        let end = from.checked_add(size.checked_mul(field.count)?)?;
        (end <= MAX_SIZE).then_some(end)
    }
}

fn parse(text: &str) -> Option<(String, Vec<Declared>)> {
    let (name, fields) = text.split_once(':')?;
    let declared = |field: &str| {
        let (kind, name) = field.trim().split_once(' ')?;
        let (kind, count) = match kind.split_once('[') {
            Some((kind, count)) => (kind, count.strip_suffix(']')?.parse().ok()?),
            None => (kind, 1),
        };
        let kind = match Scalar::of(kind) {
            Some(scalar) => Kind::Number(scalar),
            None => Kind::Nested(kind.to_owned()),
        };
        Some(Declared {
            kind,
            count,
            name: name.to_owned(),
        })
    };
    let fields = fields
        .split(';')
        .filter(|field| !field.trim().is_empty())
        .map(declared)
        .collect::<Option<Vec<_>>>()?;
    Some((name.to_owned(), fields))
}

/// Where the numbers of a topic are in a message of it, after the two bytes that tell the topic.
#[derive(Debug, Default)]
pub(super) struct Layout {
    fields: HashMap<String, Place>,
    size: usize,
    /// Size without the padding at the end.
    least: usize,
}

impl Layout {
    /// Whether a message can have this length \[bytes\].
    pub(super) fn fits(&self, length: usize) -> bool {
        (self.least..=self.size).contains(&length)
    }

    /// A field of one number.
    pub(super) fn number(&self, name: &str) -> Option<Place> {
        self.fields.get(name).copied().filter(|f| f.count == 1)
    }

    /// A field of three numbers or more.
    pub(super) fn three(&self, name: &str) -> Option<Place> {
        self.fields.get(name).copied().filter(|f| f.count >= 3)
    }
}

/// Where a field is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    scalar: Scalar,
    count: usize,
    offset: usize,
}

impl Place {
    /// The number; NaN if the message is too short for it.
    pub(super) fn read(self, message: &[u8]) -> f64 {
        self.nth(message, 0)
    }

    /// The first three numbers.
    pub(super) fn vector(self, message: &[u8]) -> Vector3 {
        Vector3::from_fn(|i, _| self.nth(message, i))
    }

    /// Whether it holds an integer.
    pub(super) fn is_integer(self) -> bool {
        !matches!(self.scalar, Scalar::F32 | Scalar::F64)
    }

    fn nth(self, message: &[u8], index: usize) -> f64 {
        message
            .get(self.offset + index * self.scalar.size()..)
            .and_then(|bytes| self.scalar.read(bytes))
            .unwrap_or(f64::NAN)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn formats(texts: &[&str]) -> Formats {
        let mut formats = Formats::default();
        for text in texts {
            assert!(formats.define(text.as_bytes()), "{text}");
        }
        formats
    }

    #[test]
    fn fields_follow_each_other_and_padding_at_the_end_may_be_absent() {
        let formats = formats(&[
            "inner:uint16_t a;uint8_t[3] _padding0;",
            "outer:uint64_t timestamp;inner[2] pair;float[3] rate;bool ok;uint8_t[3] _padding0;",
        ]);
        let layout = formats.layout("outer").unwrap();
        // 8 + 2·5 + 12 + 1, then 3 of padding.
        assert_eq!((layout.least, layout.size), (31, 34));
        assert!(layout.fits(31) && layout.fits(34) && !layout.fits(30) && !layout.fits(35));
        let mut message = vec![0; 31];
        message[22..26].copy_from_slice(&2.5f32.to_le_bytes());
        message[30] = 1;
        let rate = layout.three("rate").unwrap();
        assert_eq!(rate.vector(&message), Vector3::new(0.0, 2.5, 0.0));
        assert_eq!(layout.number("ok").unwrap().read(&message), 1.0);
        assert!(layout.number("rate").is_none() && layout.number("pair").is_none());
        assert!(layout.number("ok").unwrap().read(&message[..30]).is_nan());
    }

    #[test]
    fn definitions_that_cannot_be_are_refused() {
        let mut formats = Formats::default();
        for text in ["", "name", "a:float", "a:float[ x;", "a:float[-1] x;"] {
            assert!(!formats.define(text.as_bytes()), "{text}");
        }
        assert!(!formats.define(b"a:\xff x;"));
        assert!(formats.define(b"self:self a;"));
        assert!(formats.define(b"big:double[9999] a;"));
        assert!(formats.define(b"huge:big[18446744073709551615] a;"));
        assert!(formats.define(b"lost:missing a;"));
        for topic in ["self", "big", "huge", "lost", "none"] {
            assert!(formats.layout(topic).is_none(), "{topic}");
        }
    }
}
