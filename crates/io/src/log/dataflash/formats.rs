//! The formats of messages: which bytes are which of the fields that are needed.

use crate::log::bytes::Number;
use crate::number;

/// Messages that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum MessageKind {
    Imu,
    Gyro,
    Accel,
    Gps,
    /// Accuracies of a fix.
    Accuracy,
    Mag,
}

/// The most fields of a kind.
pub(super) const MOST: usize = 14;

/// The fields of a message in the order of [`MessageKind::labels`]; NaN where it has none.
pub(super) type Values = [f64; MOST];

impl MessageKind {
    /// By the name of its messages, which in older logs end in the number of the instance.
    fn named(name: &str) -> Option<(Self, u8)> {
        let base = name.trim_end_matches(|letter: char| letter.is_ascii_digit());
        let kind = match base {
            "IMU" => Self::Imu,
            "GYR" => Self::Gyro,
            "ACC" => Self::Accel,
            "GPS" => Self::Gps,
            "GPA" => Self::Accuracy,
            "MAG" => Self::Mag,
            _ => return None,
        };
        // IMU, IMU2, IMU3; GYR1, GYR2, GYR3.
        let instance = match name.get(base.len()..)? {
            "" => 0,
            number => number.parse::<u8>().ok()?.checked_sub(1)?,
        };
        Some((kind, instance))
    }

    /// The fields that are read: the time in microseconds or, in older logs, milliseconds; the instance; others.
    fn labels(self) -> &'static [&'static str] {
        match self {
            Self::Imu => &[
                "TimeUS", "TimeMS", "I", "GyrX", "GyrY", "GyrZ", "AccX", "AccY", "AccZ", "T",
            ],
            Self::Gyro => &["TimeUS", "TimeMS", "I", "GyrX", "GyrY", "GyrZ", "SampleUS"],
            Self::Accel => &["TimeUS", "TimeMS", "I", "AccX", "AccY", "AccZ", "SampleUS"],
            // In older logs TimeMS is the receiver's time and T the autopilot's.
            Self::Gps => &[
                "TimeUS", "T", "I", "Status", "GMS", "GWk", "TimeMS", "Week", "Lat", "Lng", "Alt",
                "Spd", "GCrs", "VZ",
            ],
            Self::Accuracy => &["TimeUS", "T", "I", "HAcc", "VAcc", "SAcc", "VV", "Und"],
            Self::Mag => &["TimeUS", "TimeMS", "I", "MagX", "MagY", "MagZ"],
        }
    }
}

/// Where a field is.
#[derive(Clone, Copy, Debug)]
struct Column {
    /// Among the fields of the message, and in its bytes.
    place: usize,
    offset: usize,
    number: Number,
    scale: f64,
    /// Whether the letter of the format states the scale.
    scaled: bool,
}

/// What the log says of a message.
#[derive(Clone, Debug, Default)]
pub(super) struct Format {
    pub(super) name: String,
    /// With its head \[bytes\].
    pub(super) length: usize,
    /// What it holds, and the instance by its name.
    kind: Option<(MessageKind, u8)>,
    columns: Vec<Option<Column>>,
}

impl Format {
    /// By a name, letters of types and labels with commas between; `None` if the length cannot be.
    pub(super) fn new(name: &str, length: usize, letters: &str, labels: &str) -> Option<Self> {
        let sizes: Option<usize> = letters.bytes().map(|letter| Some(stored(letter)?.0)).sum();
        if length < 3 {
            return None;
        }
        let is_whole = sizes.is_some_and(|sizes| sizes + 3 == length);
        let kind = MessageKind::named(name).filter(|_| is_whole);
        let mut all = Vec::new();
        let mut offset = 0;
        for (place, (letter, label)) in letters.bytes().zip(labels.split(',')).enumerate() {
            let (size, number, scale) = stored(letter)?;
            let column = number.map(|number| Column {
                place,
                offset,
                number,
                scale: scale.unwrap_or(1.0),
                scaled: scale.is_some(),
            });
            all.push((label.trim(), column));
            offset += size;
        }
        let column = |label: &&str| all.iter().find(|(name, _)| name == label)?.1;
        let labels = kind.map_or(&[][..], |(kind, _)| kind.labels());
        Some(Self {
            name: name.to_owned(),
            length,
            kind,
            columns: labels.iter().map(column).collect(),
        })
    }

    /// Takes in the multipliers of its fields. Times are read in the unit of their label.
    pub(super) fn scale(&mut self, multipliers: &str) {
        let labels = self.kind.map_or(&[][..], |(kind, _)| kind.labels());
        for (column, label) in self.columns.iter_mut().zip(labels) {
            let is_time = matches!(*label, "TimeUS" | "TimeMS" | "T" | "GMS" | "SampleUS");
            let Some(column) = column.as_mut().filter(|c| !c.scaled && !is_time) else {
                continue;
            };
            column.scale = match multipliers.as_bytes().get(column.place) {
                Some(b'1') => 1e1,
                Some(b'2') => 1e2,
                Some(letter @ b'A'..=b'G') => 0.1f64.powi(i32::from(letter - b'A') + 1),
                _ => 1.0,
            };
        }
    }

    /// What a message of these bytes is: its kind, instance and fields.
    pub(super) fn read(&self, body: &[u8]) -> Option<(MessageKind, u8, Values)> {
        self.values(|column| {
            let bytes = body.get(column.offset..)?;
            Some(column.number.read(bytes, false)? * column.scale)
        })
    }

    /// The same of the fields of a text, where letters of types have scaled the numbers already.
    pub(super) fn read_text(&self, fields: &[&[u8]]) -> Option<(MessageKind, u8, Values)> {
        self.values(|column| {
            let scale = if column.scaled { 1.0 } else { column.scale };
            Some(number::parse(fields.get(column.place)?)? * scale)
        })
    }

    fn values(&self, read: impl Fn(&Column) -> Option<f64>) -> Option<(MessageKind, u8, Values)> {
        let (kind, instance) = self.kind?;
        let mut values = [f64::NAN; MOST];
        for (value, column) in values.iter_mut().zip(&self.columns) {
            *value = column.as_ref().and_then(&read).unwrap_or(f64::NAN);
        }
        let [_, _, stated, ..] = values;
        let instance = if (0.0..=255.0).contains(&stated) {
            stated as u8
        } else {
            instance
        };
        Some((kind, instance, values))
    }
}

/// The size of a field by the letter of its type \[bytes\], its number, and the scale that the letter states.
fn stored(letter: u8) -> Option<(usize, Option<Number>, Option<f64>)> {
    let (number, scale) = match letter {
        b'b' => (Number::I8, None),
        b'B' | b'M' => (Number::U8, None),
        b'h' => (Number::I16, None),
        b'H' => (Number::U16, None),
        b'i' => (Number::I32, None),
        b'I' => (Number::U32, None),
        b'q' => (Number::I64, None),
        b'Q' => (Number::U64, None),
        b'f' => (Number::F32, None),
        b'd' => (Number::F64, None),
        b'c' => (Number::I16, Some(0.01)),
        b'C' => (Number::U16, Some(0.01)),
        b'e' => (Number::I32, Some(0.01)),
        b'E' => (Number::U32, Some(0.01)),
        b'L' => (Number::I32, Some(1e-7)),
        // Texts, lists and half-precision numbers, of which none is read.
        b'n' => return Some((4, None, None)),
        b'N' => return Some((16, None, None)),
        b'Z' | b'a' => return Some((64, None, None)),
        b'g' => return Some((2, None, None)),
        _ => return None,
    };
    Some((number.size(), Some(number), scale))
}

/// Time of a message on the autopilot's clock \[s\].
pub(super) fn time(values: &Values) -> f64 {
    let [micros, millis, ..] = *values;
    if micros.is_nan() {
        millis / 1e3
    } else {
        micros / 1e6
    }
}
