//! Sentences: `$`, talker and kind, fields between commas, `*` and the exclusive or of what is
//! between.

use crate::angle::of_degrees_minutes;
use crate::number;
use crate::skipped::{SkipKind, shown};
use crate::time::{self, whole};

/// Longest sentence that is believed \[bytes\]: the standard has 82, receivers go beyond it.
const LONGEST: usize = 256;

/// Sentences with a heading.
pub(super) const HEADINGS: [&str; 4] = ["HDT", "THS", "PASHR", "AVR"];

/// A sentence whose checksum is right: the text between `$` and `*`.
pub(super) struct Sentence<'a>(&'a [u8]);

/// The sentences of a line, `Err` with what begins like one that is read here, but is damaged; anything else in it
/// is passed over.
pub(super) fn sentences(line: &[u8]) -> impl Iterator<Item = Result<Sentence<'_>, String>> {
    // A `$` inside of a sentence is a new beginning: the one before lost its end.
    line.split(|&byte| byte == b'$')
        .skip(1)
        .filter_map(|piece| {
            let piece = piece.get(..LONGEST).unwrap_or(piece);
            let sentence = whole_sentence(piece);
            let damaged = || looks_like_one(piece).then(|| Err(shown(piece)));
            sentence.map(Ok).or_else(damaged)
        })
}

fn whole_sentence(piece: &[u8]) -> Option<Sentence<'_>> {
    let star = piece.iter().position(|&byte| byte == b'*')?;
    let (body, sum) = (piece.get(..star)?, piece.get(star + 1..star + 3)?);
    let said = std::str::from_utf8(sum).ok()?;
    let said = u8::from_str_radix(said, 16).ok()?;
    let made = body.iter().fold(0, |sum, byte| sum ^ byte);
    (said == made).then_some(Sentence(body))
}

fn looks_like_one(piece: &[u8]) -> bool {
    let kinds = [&b"GGA,"[..], b"GNS,", b"GST,", b"RMC,", b"ZDA,"];
    piece.get(2..6).is_some_and(|kind| kinds.contains(&kind))
}

impl Sentence<'_> {
    /// Its kind, without the talker; empty for one of a maker's own.
    pub(super) fn kind(&self) -> &[u8] {
        let name = self.field(0);
        let own = name.len() != 5 || name.starts_with(b"P");
        name.get(2..).filter(|_| !own).unwrap_or_default()
    }

    /// The name of a sentence with a heading, and which field is its time.
    pub(super) fn with_heading(&self) -> Option<(&'static str, Option<usize>)> {
        let [hdt, ths, ashr, avr] = HEADINGS;
        match (self.field(0), self.kind()) {
            (_, b"HDT") => Some((hdt, None)),
            (_, b"THS") => Some((ths, None)),
            // Others of that maker have a name in the place of the time.
            (b"PASHR", _) if self.field(3) == b"T" => Some((ashr, Some(1))),
            (b"PTNL", _) if self.field(1) == b"AVR" => Some((avr, Some(2))),
            _ => None,
        }
    }

    /// The heading of one with a heading \[rad\], and its standard deviation where it is stated.
    ///
    /// # Errors
    /// What is not a number, or what the receiver does not vouch for.
    pub(super) fn heading(&self) -> Result<(f64, Option<f64>), SkipKind> {
        let name = self.with_heading().map(|(name, _)| name);
        let (field, vouched) = match name.unwrap_or_default() {
            // Of THS: not by dead reckoning, by hand, simulated, invalid.
            "THS" => (1, self.field(2) == b"A"),
            "PASHR" => (2, matches!(self.field(10), b"1" | b"2")),
            // By whole wavelengths.
            "AVR" => (3, self.field(10) == b"3"),
            _ => (1, true),
        };
        if !vouched || self.field(field).is_empty() {
            return Err(SkipKind::NoFix);
        }
        let heading = self.number(field).ok_or(SkipKind::Text)?.to_radians();
        let std = (name == Some("PASHR")).then(|| self.number(9)).flatten();
        Ok((heading, std.filter(|std| *std > 0.0).map(f64::to_radians)))
    }

    /// A field, the name being number 0; empty where there is none.
    pub(super) fn field(&self, number: usize) -> &[u8] {
        self.0
            .split(|&byte| byte == b',')
            .nth(number)
            .unwrap_or_default()
    }

    /// A finite number; `None` for an empty field and for text.
    pub(super) fn number(&self, number: usize) -> Option<f64> {
        number::parse_finite(self.field(number))
    }

    /// The angle [°] of two fields: `dddmm.mmm`, and a letter of which the second is negative.
    pub(super) fn angle(&self, number: usize, letters: [&[u8]; 2]) -> Option<f64> {
        let value = self.number(number).filter(|value| *value >= 0.0)?;
        let size = of_degrees_minutes(value);
        match self.field(number + 1) {
            _ if value % 100.0 >= 60.0 => None,
            letter if letter == letters[0] => Some(size),
            letter if letter == letters[1] => Some(-size),
            _ => None,
        }
    }

    pub(super) fn shown(&self) -> String {
        shown(self.0)
    }
}

/// Seconds of day of `hhmmss.sss`; the second may be 60.
pub(super) fn time_of_day(field: &[u8]) -> Option<f64> {
    time::of_day(field.get(..2)?, field.get(2..4)?, field.get(4..)?)
}

/// Year, month and day of `ddmmyy`.
pub(super) fn date(field: &[u8]) -> Option<(i64, i64, i64)> {
    let part = |from: usize| whole(field.get(from..from + 2)?);
    let (day, month, year) = (part(0)?, part(2)?, part(4)?);
    (field.len() == 6).then_some((time::full_year(year), month, day))
}
