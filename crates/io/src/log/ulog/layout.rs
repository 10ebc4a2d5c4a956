//! Formats of topics: where in a message which field is.

use std::collections::HashMap;

use undrift_nav::Vector3;

use crate::log::bytes::Number;

/// Formats that are kept at most: some hundred topics are usual.
const MAX_FORMATS: usize = 4096;
/// Formats within formats at most.
const MAX_DEPTH: usize = 16;
/// No message is longer \[bytes\].
const MAX_SIZE: usize = 65_535;

/// A field as the format declares it.
struct Declared {
    kind: Declares,
    count: usize,
    name: String,
}

/// What a field is made of.
enum Declares {
    Number(Number),
    /// A format of this name.
    Nested(String),
}

/// The formats that the file has defined, by name.
#[derive(Default)]
pub(super) struct Formats(HashMap<String, Vec<Declared>>);

impl Formats {
    /// Takes in a definition, such as `gyro:uint64_t timestamp;float[3] rate;`; false if it is invalid.
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
    pub(super) fn layout(&self, topic: &str) -> Option<TopicLayout> {
        let mut sizes = HashMap::new();
        let mut layout = TopicLayout::default();
        for field in self.0.get(topic)? {
            if let Declares::Number(number) = field.kind {
                let found = Field {
                    number,
                    count: field.count,
                    offset: layout.size,
                };
                layout.fields.insert(field.name.clone(), found);
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
            Declares::Number(number) => number.size(),
            Declares::Nested(name) => match sizes.get(name.as_str()) {
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

/// A number by its name in a format.
fn number_named(name: &str) -> Option<Number> {
    Some(match name {
        "int8_t" => Number::I8,
        "uint8_t" | "bool" | "char" => Number::U8,
        "int16_t" => Number::I16,
        "uint16_t" => Number::U16,
        "int32_t" => Number::I32,
        "uint32_t" => Number::U32,
        "int64_t" => Number::I64,
        "uint64_t" => Number::U64,
        "float" => Number::F32,
        "double" => Number::F64,
        _ => return None,
    })
}

fn parse(text: &str) -> Option<(String, Vec<Declared>)> {
    let (name, fields) = text.split_once(':')?;
    let declared = |field: &str| {
        let (kind, name) = field.trim().split_once(' ')?;
        let (kind, count) = match kind.split_once('[') {
            Some((kind, count)) => (kind, count.strip_suffix(']')?.parse().ok()?),
            None => (kind, 1),
        };
        let kind = match number_named(kind) {
            Some(number) => Declares::Number(number),
            None => Declares::Nested(kind.to_owned()),
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
pub(super) struct TopicLayout {
    fields: HashMap<String, Field>,
    size: usize,
    /// Size without the padding at the end.
    least: usize,
}

impl TopicLayout {
    /// Whether a message can have this length \[bytes\].
    pub(super) fn fits(&self, length: usize) -> bool {
        (self.least..=self.size).contains(&length)
    }

    /// A field of one number.
    pub(super) fn number(&self, name: &str) -> Option<Field> {
        self.fields.get(name).copied().filter(|f| f.count == 1)
    }

    /// A field of three numbers or more.
    pub(super) fn three(&self, name: &str) -> Option<Field> {
        self.fields.get(name).copied().filter(|f| f.count >= 3)
    }
}

/// Where a field is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Field {
    number: Number,
    count: usize,
    offset: usize,
}

impl Field {
    /// The number; NaN if the message is too short for it.
    pub(super) fn read(self, message: &[u8]) -> f64 {
        self.nth(message, 0)
    }

    /// The first three numbers.
    pub(super) fn vector(self, message: &[u8]) -> Vector3 {
        Vector3::from_fn(|i, _| self.nth(message, i))
    }

    /// The number; an integer is scaled, floats are in their unit.
    pub(super) fn scaled(self, message: &[u8], scale: impl Fn(f64) -> f64) -> f64 {
        match self.number {
            Number::F32 | Number::F64 => self.read(message),
            _ => scale(self.read(message)),
        }
    }

    fn nth(self, message: &[u8], index: usize) -> f64 {
        message
            .get(self.offset + index * self.number.size()..)
            .and_then(|bytes| self.number.read(bytes, false))
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
