//! GPX 1.0 and 1.1: the points of tracks (`trkpt`) that have a time, as fixes or as reference
//! solutions.
//!
//! The format has no uncertainties and no velocities. `ele` is metres above sea level by its
//! definition; where a point has a `geoidheight`, that is added, else the height is the file's.
//! Waypoints and routes are passed over; segments follow each other, gaps between them are gaps in
//! time. Times are GPS seconds of the week in which the file starts; one without a zone is UTC, as
//! the format wants it.

mod text;

use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};
use undrift_nav::earth::Geodetic;
use undrift_nav::sample::{FixQuality, Position};

use super::receiver::{Ready, by_steps, check, one_stream};
use crate::entry::{Entries, Fix, Stream, StreamKind, Wanted};
use crate::epoch::ClockSource;
use crate::fix::on_earth;
use crate::skipped::SkipKind;
use crate::source::Source;
use crate::time::WeekClock;
use crate::{ReadError, number};
use text::Text;

const STREAM: &str = "track";
/// Elements inside of one another; more is no track.
const MAX_DEPTH: usize = 64;
/// Longest text of a number or a time that is believed \[bytes\].
const MAX_TEXT: usize = 64;

/// Whether the first bytes of a file are GPX: XML whose root is `gpx`.
pub(crate) fn detect(start: &[u8]) -> bool {
    if memchr::memchr(b'<', start).is_none() {
        return false;
    }
    let mut points = Points::new(Box::new(std::io::Cursor::new(start.to_vec())));
    loop {
        match points.next() {
            Ok(Next::Inside) if points.depth > 0 => return true,
            Ok(Next::Inside) => {}
            _ => return false,
        }
    }
}

pub(super) fn entries(source: Source, wanted: &Wanted) -> Result<Entries, ReadError> {
    check(wanted, "GPX", [&[], &[STREAM], &[]])?;
    let mut points = Points::new(source);
    let mut weeks = WeekClock::default();
    Ok(by_steps(wanted, move |ready| {
        let more = match points.next()? {
            Next::Inside => true,
            Next::Point(point) => {
                point.entry(&mut weeks, ready);
                true
            }
            Next::End => false,
            Next::EndsEarly(detail) => {
                ready.skip(points.line(), SkipKind::EndsEarly, detail);
                false
            }
        };
        Ok((more, weeks.epoch(ClockSource::Utc)))
    }))
}

pub(super) fn streams(source: Source) -> Result<Vec<Stream>, ReadError> {
    let mut points = Points::new(source);
    let (mut messages, mut timed) = (0, 0u64);
    loop {
        match points.next()? {
            Next::Inside => {}
            Next::Point(point) => {
                messages += 1;
                timed += u64::from(!point.time.is_empty());
            }
            Next::End | Next::EndsEarly(_) => break,
        }
    }
    Ok(one_stream(
        STREAM,
        StreamKind::Fixes,
        format!("points of tracks, {timed} with a time"),
        messages,
    ))
}

/// A point of a track as it is written.
#[derive(Default)]
struct Point {
    line: u64,
    lat: Option<f64>,
    lon: Option<f64>,
    elevation: String,
    geoid: String,
    time: String,
}

impl Point {
    fn entry(&self, weeks: &mut WeekClock, ready: &mut Ready) {
        let missing = [
            (self.time.is_empty(), "a point without a time"),
            (self.elevation.is_empty(), "a point without an elevation"),
        ];
        if let Some((_, detail)) = missing.into_iter().find(|(is, _)| *is) {
            return ready.skip(self.line, SkipKind::MissingField, detail);
        }
        let geoid = if self.geoid.is_empty() {
            Some(0.0)
        } else {
            number::parse_finite(self.geoid.as_bytes())
        };
        let elevation = number::parse_finite(self.elevation.as_bytes());
        let (Some(lat), Some(lon), Some(elevation), Some(geoid)) =
            (self.lat, self.lon, elevation, geoid)
        else {
            return ready.skip(self.line, SkipKind::Text, "a position that is not a number");
        };
        let position = Geodetic::from_degrees(lat, lon, elevation + geoid);
        let Some(position) = ready.usable(self.line, on_earth(position)) else {
            return;
        };
        let Some(time) = weeks.date_time(self.time.as_bytes()) else {
            return ready.skip(self.line, SkipKind::Text, format!("time {:?}", self.time));
        };
        let fix = Fix {
            mean_velocity: None,
            time,
            position: Some((Position::Geodetic(position), None)),
            velocity: None,
            quality: FixQuality::Unknown,
        };
        ready.fix(self.line, fix);
    }
}

/// What one event of the XML led to.
enum Next {
    Inside,
    Point(Point),
    End,
    /// What comes is not XML any more, or nothing.
    EndsEarly(String),
}

struct Points {
    xml: Reader<Text>,
    buffer: Vec<u8>,
    depth: usize,
    seen_root: bool,
    /// The point that is being read, and how deep it is.
    point: Option<(Point, usize)>,
    /// The text of the innermost element of a point.
    text: String,
}

impl Points {
    fn new(source: Source) -> Self {
        Self {
            xml: Reader::from_reader(Text::new(source)),
            buffer: Vec::new(),
            depth: 0,
            seen_root: false,
            point: None,
            text: String::new(),
        }
    }

    /// Line up to which the file has been read.
    fn line(&self) -> u64 {
        self.xml.get_ref().line()
    }

    fn next(&mut self) -> Result<Next, ReadError> {
        self.buffer.clear();
        self.xml.get_mut().next_event();
        let event = match self.xml.read_event_into(&mut self.buffer) {
            Ok(event) => event,
            Err(error) if self.seen_root => return Ok(Next::EndsEarly(error.to_string())),
            Err(_) => return Err(Self::not_gpx()),
        };
        match event {
            Event::Start(start) => {
                let name = start.local_name();
                let name: &str = name.as_ref();
                if !self.seen_root && name != "gpx" {
                    return Err(Self::not_gpx());
                }
                self.seen_root = true;
                self.depth += 1;
                self.text.clear();
                if self.depth > MAX_DEPTH {
                    let detail = format!("over {MAX_DEPTH} elements inside of one another");
                    return Ok(Next::EndsEarly(detail));
                }
                if name == "trkpt" {
                    let point = point(&start, self.xml.get_ref().line());
                    self.point = Some((point, self.depth));
                }
            }
            Event::Empty(start) if self.seen_root && start.local_name().as_ref() == "trkpt" => {
                return Ok(Next::Point(point(&start, self.xml.get_ref().line())));
            }
            Event::Text(text) => self.text.push_str(&text),
            Event::CData(text) => self.text.push_str(&text),
            Event::GeneralRef(reference) => {
                // Anything but a character by its number stays unknown, and so will not be a
                // number.
                let character = reference.resolve_char_ref().ok().flatten();
                self.text.push(character.unwrap_or('&'));
            }
            Event::End(end) => {
                let depth = self.depth;
                self.depth = depth.saturating_sub(1);
                let Some((point, at)) = &mut self.point else {
                    return Ok(Next::Inside);
                };
                if depth == *at {
                    let done = self.point.take();
                    return Ok(done.map_or(Next::Inside, |(point, _)| Next::Point(point)));
                }
                let place = match end.local_name().as_ref() {
                    "ele" => &mut point.elevation,
                    "geoidheight" => &mut point.geoid,
                    "time" => &mut point.time,
                    _ => return Ok(Next::Inside),
                };
                // Extensions may have elements of the same names further in.
                if depth == *at + 1 {
                    self.text.trim().clone_into(place);
                }
            }
            Event::Eof if !self.seen_root => return Err(Self::not_gpx()),
            Event::Eof if self.depth > 0 => {
                return Ok(Next::EndsEarly("inside of an element".to_owned()));
            }
            Event::Eof => return Ok(Next::End),
            _ => {}
        }
        if self.text.len() > MAX_TEXT || self.point.is_none() {
            self.text.clear();
        }
        Ok(Next::Inside)
    }

    fn not_gpx() -> ReadError {
        ReadError::nameless("is not GPX: no XML with the root <gpx>")
    }
}

fn point(start: &BytesStart, line: u64) -> Point {
    let degrees = |name: &str| {
        let attribute = start.try_get_attribute(name).ok().flatten()?;
        let text = attribute.normalized_value(XmlVersion::Implicit1_0).ok()?;
        number::parse_finite(text.trim().as_bytes())
    };
    Point {
        line,
        lat: degrees("lat"),
        lon: degrees("lon"),
        ..Point::default()
    }
}

#[cfg(test)]
mod tests;
