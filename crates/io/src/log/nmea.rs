//! NMEA 0183: fixes of GGA or GNS, GST, RMC and VTG, dates of RMC and ZDA, headings of HDT, THS, PASHR and PTNL,AVR, of any talker.
//!
//! The sentences with the same time of day make one fix. Its position is GGA's, the height above
//! the ellipsoid being altitude plus geoid separation. Where a separation is missing, the last one
//! known is taken; where there has been none, heights stay above sea level to the end of the file,
//! which is said once. Where neither GGA nor GNS comes, positions are RMC's, without a height. The covariance is made of GST's standard deviations, or of its error ellipse
//! where only that is there.
//!
//! The velocity is that of RMC or VTG, speed and course over ground. NMEA has no vertical speed and
//! no accuracy of any: the third component is 0, and the standard deviations that the user has to
//! give, or else the velocity is not used, must say so (such as 0.2, 0.2, 20 m/s).
//!
//! HDT and THS have no time: theirs is that of the sentences before them. A course over ground (RMC, VTG) is no heading.
//!
//! Times are GPS seconds of the week in which the file starts; without any date, UTC seconds of the
//! day in which it starts. A date may come late: up to an hour of epochs waits for it.

mod epoch;
mod sentence;

use super::receiver::{Ready, by_lines, check, check_name, one_stream};
use crate::ReadError;
use crate::entry::{Entries, Stream, StreamKind, Wanted};
use crate::skipped::SkipKind;
use crate::source::Source;
use crate::table::lines::Lines;
use epoch::{Epoch, Heights, Times};
use sentence::{HEADINGS, Sentence, sentences};

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
    let headings = match wanted {
        Wanted::Headings(name) => {
            check_name(name, "NMEA", &HEADINGS, "stream of headings")?;
            Some(
                name.as_ref()
                    .and_then(|name| HEADINGS.into_iter().find(|known| known == name)),
            )
        }
        _ => None,
    };
    let reader = Reader {
        headings,
        epoch: None,
        heights: Heights::default(),
        times: Times::new(wanted),
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
    const KINDS: [&[u8]; 6] = [b"GGA", b"GNS", b"GST", b"RMC", b"VTG", b"ZDA"];
    let mut lines = Lines::new(source);
    let (mut counts, mut messages) = ([0u64; KINDS.len()], 0);
    let mut headings = [0u64; HEADINGS.len()];
    while let Some(line) = lines.next_line() {
        for sentence in sentences(line).flatten() {
            messages += 1;
            let name = sentence.with_heading().map(|(name, _)| name);
            for (count, known) in headings.iter_mut().zip(HEADINGS) {
                *count += u64::from(name == Some(known));
            }
            for (count, kind) in counts.iter_mut().zip(KINDS) {
                *count += u64::from(sentence.kind() == kind);
            }
        }
    }
    let said = |(count, kind): (&u64, &[u8])| {
        (*count > 0).then(|| format!("{} {count}", String::from_utf8_lossy(kind)))
    };
    let about: Vec<String> = counts.iter().zip(KINDS).filter_map(said).collect();
    let (kind, about) = (StreamKind::Fixes, about.join(", "));
    let mut streams = one_stream(STREAM, kind, about, messages);
    for (count, name) in headings.into_iter().zip(HEADINGS) {
        let about = "heading of the vehicle or of its antennas";
        streams.extend(one_stream(name, StreamKind::Headings, about, count));
    }
    Ok(streams)
}

struct Reader {
    /// Where headings are wanted, the sentences that have them, as soon as that is known.
    headings: Option<Option<&'static str>>,
    epoch: Option<Epoch>,
    heights: Heights,
    times: Times,
}

impl Reader {
    fn line(&mut self, at: u64, line: &[u8], ready: &mut Ready) -> Result<(), ReadError> {
        for found in sentences(line) {
            match found {
                Ok(sentence) => {
                    let of_heading = self.heading(&sentence);
                    let ended = take(&mut self.epoch, at, &sentence, of_heading, ready);
                    if let Some(ended) = ended {
                        ended.end(&mut self.heights, &mut self.times, ready);
                    }
                }
                Err(detail) => ready.skip(at, SkipKind::Damaged, detail),
            }
        }
        Ok(())
    }

    /// Where the time of a sentence is from which the heading is to be taken, `None` inside of one without a time; the sentences that come
    /// first are those of the whole log.
    fn heading(&mut self, sentence: &Sentence) -> Option<Option<usize>> {
        let (name, time) = sentence.with_heading()?;
        let chosen = *self.headings.as_mut()?.get_or_insert(name);
        (chosen == name).then_some(time)
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
    of_heading: Option<Option<usize>>,
    ready: &mut Ready,
) -> Option<Epoch> {
    let mut ended = None;
    let time = match (of_heading, sentence.kind()) {
        (Some(time), _) => time,
        // It has no time: it belongs to the sentences before it.
        (None, b"VTG") => None,
        (None, b"GGA" | b"GNS" | b"GST" | b"RMC" | b"ZDA") => Some(1),
        _ => return None,
    };
    match time.map(|time| sentence.field(time)) {
        None => {}
        // The receiver has none yet.
        Some(b"") => return None,
        Some(time) => {
            let Some(time_of_day) = sentence::time_of_day(time) else {
                ready.skip(at, SkipKind::Text, sentence.shown());
                return None;
            };
            if epoch.as_ref().map(|epoch| epoch.time_of_day) != Some(time_of_day) {
                ended = epoch.replace(Epoch::new(at, time_of_day));
            }
        }
    }
    if let Some(current) = epoch
        && let Err(kind) = current.add(sentence, of_heading.is_some())
    {
        ready.skip(at, kind, sentence.shown());
    }
    ended
}

#[cfg(test)]
mod tests;
