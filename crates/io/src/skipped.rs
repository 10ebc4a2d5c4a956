//! Records that were left out while reading: how many of each kind, and where the first is.

use std::collections::BTreeMap;
use std::fmt;

/// Why a record was left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum SkipKind {
    /// Text where a number belongs.
    Text,
    /// Fewer fields than needed, or an empty one.
    MissingField,
    /// NaN or infinite.
    NotFinite,
    /// Time earlier than that of the record before.
    TimeBackwards,
    /// Time equal to that of the record before.
    DuplicateTime,
    /// A line longer than any row can be.
    TooLong,
    /// A number that is impossible, such as a latitude of 95° or the 0°, 0° of "no fix".
    OutOfRange,
    /// A standard deviation that is zero, negative or not a number.
    Uncertainty,
    /// A position or velocity whose uncertainty neither the file nor the user states.
    NoUncertainty,
    /// A message or a part of the file that is damaged: its checksum is wrong, its end is missing, or
    /// it cannot be decompressed; reading goes on after it.
    Damaged,
    /// An epoch for which the receiver has no fix, or none by satellites.
    NoFix,
    /// The file breaks off: an input error or damaged compression; what was before it has been read.
    EndsEarly,
}

impl SkipKind {
    fn describe(self, many: bool) -> &'static str {
        match (self, many) {
            (Self::Text, false) => "row with text where a number belongs",
            (Self::Text, true) => "rows with text where a number belongs",
            (Self::MissingField, false) => "row with a missing field",
            (Self::MissingField, true) => "rows with a missing field",
            (Self::NotFinite, false) => "row with NaN or infinity",
            (Self::NotFinite, true) => "rows with NaN or infinity",
            (Self::TimeBackwards, false) => "row with a time before the previous one",
            (Self::TimeBackwards, true) => "rows with a time before the previous one",
            (Self::DuplicateTime, false) => "row with a repeated time",
            (Self::DuplicateTime, true) => "rows with a repeated time",
            (Self::TooLong, false) => "line too long to be a row",
            (Self::TooLong, true) => "lines too long to be a row",
            (Self::OutOfRange, false) => "row with a value out of range",
            (Self::OutOfRange, true) => "rows with a value out of range",
            (Self::Uncertainty, false) => "value with an unusable standard deviation",
            (Self::Uncertainty, true) => "values with an unusable standard deviation",
            (Self::NoUncertainty, false) => "value of unknown uncertainty",
            (Self::NoUncertainty, true) => "values of unknown uncertainty",
            (Self::Damaged, false) => "damaged message or part",
            (Self::Damaged, true) => "damaged messages or parts",
            (Self::NoFix, false) => "epoch without a fix",
            (Self::NoFix, true) => "epochs without a fix",
            (Self::EndsEarly, false) => "file ends early",
            (Self::EndsEarly, true) => "files end early",
        }
    }
}

/// Why something cannot be used, and the text found there.
pub(crate) type Unfit = (SkipKind, String);

/// How often one kind of record was skipped, and the first of them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SkipEntry {
    /// Number of records.
    pub count: u64,
    /// Line or message of the first one in its file, counted from 1.
    pub first_line: u64,
    /// What stood there.
    pub first_detail: String,
}

/// A clock that was set back and went on from there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SetBack {
    /// Line or message, as of [`SkipEntry::first_line`].
    pub line: u64,
    /// By how much \[s\].
    pub step: f64,
}

/// A counter of limited bits in the column of times that started again and was counted on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Restarts {
    /// Line or message of the first time, as of [`SkipEntry::first_line`].
    pub line: u64,
    /// How often.
    pub count: u64,
    /// What is added after the first time, in the column's unit.
    pub length: f64,
}

/// Counter of skipped records by kind.
#[derive(Clone, Debug, PartialEq)]
pub struct Skipped {
    kinds: BTreeMap<SkipKind, SkipEntry>,
    set_back: Option<SetBack>,
    restarts: Option<Restarts>,
    /// What the positions count: lines of a text, messages of anything else.
    counted: &'static str,
}

impl Default for Skipped {
    fn default() -> Self {
        Self {
            kinds: BTreeMap::new(),
            set_back: None,
            restarts: None,
            counted: "line",
        }
    }
}

impl Skipped {
    /// For a log whose messages are counted rather than its lines.
    pub(crate) fn of_messages() -> Self {
        Self {
            counted: "message",
            ..Self::default()
        }
    }

    /// For records in memory.
    pub(crate) fn of_samples() -> Self {
        Self {
            counted: "sample",
            ..Self::default()
        }
    }

    /// Counts one more record; `detail` is rendered only for the first of its kind.
    pub fn add(&mut self, kind: SkipKind, line: u64, detail: impl fmt::Display) {
        self.kinds
            .entry(kind)
            .and_modify(|entry| entry.count += 1)
            .or_insert_with(|| SkipEntry {
                count: 1,
                first_line: line,
                first_detail: detail.to_string(),
            });
    }

    /// Adds what another reader of the same file has skipped, later in it.
    pub fn merge(&mut self, other: &Self) {
        for (kind, entry) in other.iter() {
            let own = self.kinds.entry(kind).or_insert(SkipEntry {
                count: 0,
                ..entry.clone()
            });
            own.count += entry.count;
        }
    }

    /// Notes that the clock was set back; the largest step is kept.
    pub(crate) fn set_back(&mut self, line: u64, step: f64) {
        if self.set_back.is_none_or(|before| before.step < step) {
            self.set_back = Some(SetBack { line, step });
        }
    }

    /// The largest step by which the clock was set back, if it was.
    pub fn largest_set_back(&self) -> Option<SetBack> {
        self.set_back
    }

    /// Notes that the counter in the column of times started again; `added` is added to its numbers from here on.
    pub(crate) fn counter_started(&mut self, line: u64, added: f64) {
        let restarts = self.restarts.get_or_insert(Restarts {
            line,
            count: 0,
            length: added,
        });
        restarts.count += 1;
    }

    /// How often the counter in the column of times started again, if it did.
    pub fn restarts(&self) -> Option<Restarts> {
        self.restarts
    }

    /// Whether nothing was skipped.
    pub fn is_empty(&self) -> bool {
        self.kinds.is_empty()
    }

    /// All kinds in one line.
    pub(crate) fn in_one_line(&self) -> String {
        self.to_string().replace('\n', "; ")
    }

    /// The records of one kind, if there are any.
    pub fn entry(&self, kind: SkipKind) -> Option<&SkipEntry> {
        self.kinds.get(&kind)
    }

    /// Number of skipped records of all kinds.
    pub fn total(&self) -> u64 {
        self.kinds.values().map(|entry| entry.count).sum()
    }

    /// Number of skipped records of one kind.
    pub fn count(&self, kind: SkipKind) -> u64 {
        self.kinds.get(&kind).map_or(0, |entry| entry.count)
    }

    /// The kinds that occurred, in a fixed order.
    pub fn iter(&self) -> impl Iterator<Item = (SkipKind, &SkipEntry)> {
        self.kinds.iter().map(|(&kind, entry)| (kind, entry))
    }
}

/// One line per kind, without a trailing newline.
impl fmt::Display for Skipped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, (kind, entry)) in self.iter().enumerate() {
            if i > 0 {
                f.write_str("\n")?;
            }
            let what = kind.describe(entry.count > 1);
            let (at, line, detail) = (self.counted, entry.first_line, &entry.first_detail);
            match (kind, entry.count) {
                (SkipKind::EndsEarly, 1) => write!(f, "{what}, after {at} {line}: {detail}")?,
                (_, 1) => write!(f, "1 {what}, at {at} {line}: {detail}")?,
                (_, n) => write!(f, "{n} {what}, first at {at} {line}: {detail}")?,
            }
        }
        Ok(())
    }
}

/// A field as messages show it: quoted, control characters escaped, cut at 40 bytes.
pub(crate) fn shown(field: &[u8]) -> String {
    let cut = &field[..field.len().min(40)];
    let text = String::from_utf8_lossy(cut);
    let more = if cut.len() < field.len() { "…" } else { "" };
    format!("\"{}{more}\"", text.escape_debug())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_first_positions_and_wording() {
        let mut skipped = Skipped::default();
        assert!(skipped.is_empty());
        skipped.add(SkipKind::NotFinite, 20, "nan");
        for line in [17, 30, 31] {
            skipped.add(SkipKind::Text, line, "\"abc\"");
        }
        assert_eq!((skipped.total(), skipped.count(SkipKind::Text)), (4, 3));
        assert_eq!(
            skipped.to_string(),
            "3 rows with text where a number belongs, first at line 17: \"abc\"\n\
             1 row with NaN or infinity, at line 20: nan"
        );
    }
}
