//! NMEA 0183: fixes of GGA, GST, RMC and VTG, dates of RMC and ZDA, of any talker.
//!
//! The sentences with the same time of day make one fix. Its position is GGA's, the height above
//! the ellipsoid being altitude plus geoid separation. Where a separation is missing, the last one
//! known is taken; where there has been none, heights stay above sea level to the end of the file,
//! which is said once. The covariance is made of GST's standard deviations, or of its error ellipse
//! where only that is there.
//!
//! The velocity is that of RMC or VTG, speed and course over ground. NMEA has no vertical speed and
//! no accuracy of any: the third component is 0, and the standard deviations that the user has to
//! give, or else the velocity is not used, must say so (such as 0.2, 0.2, 20 m/s).
//!
//! Times are GPS seconds of the week in which the file starts; without any date, UTC seconds of the
//! day in which it starts. A date may come late: up to an hour of epochs waits for it.

mod epoch;
mod sentence;

use super::receiver::{Ready, by_lines, check, one_stream};
use crate::ReadError;
use crate::entry::{Entries, Stream, StreamKind, Wanted};
use crate::skipped::SkipKind;
use crate::source::Source;
use crate::table::lines::Lines;
use epoch::{Epoch, Heights, Times};
use sentence::{Sentence, sentences};

const STREAM: &str = "NMEA";

/// Whether the first bytes of a file hold two whole sentences of NMEA; UBX messages with positions or
/// inertial samples between them have more to say: ask for these too.
pub(crate) fn detect(start: &[u8]) -> bool {
    let lines = start.split(|&byte| byte == b'\n');
    let whole = lines.flat_map(sentences).filter(Result::is_ok);
    whole.take(2).count() == 2
}

pub(super) fn entries(source: Source, wanted: &Wanted) -> Result<Entries, ReadError> {
    check(wanted, "NMEA", [&[], &[STREAM], &[]])?;
    let reader = Reader {
        epoch: None,
        heights: Heights::default(),
        times: Times::new(matches!(wanted, Wanted::Poses(_))),
    };
    // Lines that are too long for a sentence are something else.
    Ok(by_lines(
        wanted,
        Lines::new(source),
        None,
        reader,
        Reader::line,
        Reader::end,
        |reader| reader.times.epoch(),
    ))
}

pub(super) fn streams(source: Source) -> Result<Vec<Stream>, ReadError> {
    const KINDS: [&[u8]; 5] = [b"GGA", b"GST", b"RMC", b"VTG", b"ZDA"];
    let mut lines = Lines::new(source);
    let (mut counts, mut messages) = ([0u64; KINDS.len()], 0);
    while let Some(line) = lines.next_line() {
        for sentence in sentences(line).flatten() {
            messages += 1;
            for (count, kind) in counts.iter_mut().zip(KINDS) {
                *count += u64::from(sentence.kind() == kind);
            }
        }
    }
    let said = |(count, kind): (&u64, &[u8])| {
        (*count > 0).then(|| format!("{} {count}", String::from_utf8_lossy(kind)))
    };
    let about: Vec<String> = counts.iter().zip(KINDS).filter_map(said).collect();
    Ok(one_stream(
        STREAM,
        StreamKind::Fixes,
        about.join(", "),
        messages,
    ))
}

struct Reader {
    epoch: Option<Epoch>,
    heights: Heights,
    times: Times,
}

impl Reader {
    fn line(&mut self, at: u64, line: &[u8], ready: &mut Ready) -> Result<(), ReadError> {
        for found in sentences(line) {
            match found {
                Ok(sentence) => {
                    let ended = take(&mut self.epoch, at, &sentence, ready);
                    if let Some(ended) = ended {
                        ended.end(&mut self.heights, &mut self.times, ready);
                    }
                }
                Err(detail) => ready.skip(at, SkipKind::Damaged, detail),
            }
        }
        Ok(())
    }

    fn end(&mut self, ready: &mut Ready) -> Result<(), ReadError> {
        if let Some(last) = self.epoch.take() {
            last.end(&mut self.heights, &mut self.times, ready);
        }
        self.times.end(ready);
        Ok(())
    }
}

/// Adds a sentence to the epoch that it belongs to; the epoch before, if it is a later one.
fn take(
    epoch: &mut Option<Epoch>,
    at: u64,
    sentence: &Sentence,
    ready: &mut Ready,
) -> Option<Epoch> {
    let mut ended = None;
    match sentence.kind() {
        // It has no time: it belongs to the sentences before it.
        b"VTG" => {}
        // Without a time, the receiver has none yet.
        b"GGA" | b"GST" | b"RMC" | b"ZDA" if !sentence.field(1).is_empty() => {
            let Some(time_of_day) = sentence::time_of_day(sentence.field(1)) else {
                ready.skip(at, SkipKind::Text, sentence.shown());
                return None;
            };
            if epoch.as_ref().map(|epoch| epoch.time_of_day) != Some(time_of_day) {
                ended = epoch.replace(Epoch::new(at, time_of_day));
            }
        }
        _ => return None,
    }
    if let Some(current) = epoch
        && let Err(kind) = current.add(sentence)
    {
        ready.skip(at, kind, sentence.shown());
    }
    ended
}

#[cfg(test)]
mod tests;
