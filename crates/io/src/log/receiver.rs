//! What the readers of receivers' logs have in common.

use std::collections::VecDeque;

use undrift_nav::sample::{Position, TruthSample};

use super::frames::{Frames, Layout, NextFrame};
use crate::ReadError;
use crate::entry::{Entries, Entry, Fix, Stream, StreamKind, Wanted, What};
use crate::epoch::Epoch;
use crate::skipped::{SkipKind, Unfit};
use crate::source::Source;
use crate::table::lines::{Lines, NextLine};

/// Entries that are ready to be given out.
#[derive(Default)]
pub(super) struct Ready {
    entries: VecDeque<Entry>,
    /// Whether reference solutions are wanted, not fixes.
    poses: bool,
}

impl Ready {
    pub(super) fn push(&mut self, at: u64, what: What) {
        self.entries.push_back(Entry { at, what });
    }

    /// Takes the first of them out.
    pub(super) fn next(&mut self) -> Option<Entry> {
        self.entries.pop_front()
    }

    /// Takes all of them out.
    pub(super) fn take(&mut self) -> VecDeque<Entry> {
        std::mem::take(&mut self.entries)
    }

    pub(super) fn skip(&mut self, at: u64, kind: SkipKind, detail: impl Into<String>) {
        self.push(at, What::Skipped(kind, detail.into()));
    }

    /// A fix, or the reference solution that it is.
    pub(super) fn fix(&mut self, at: u64, fix: Fix) {
        match fix.position {
            _ if !self.poses => self.push(at, What::Fix(fix)),
            Some((Position::Geodetic(position), _)) => {
                let pose = TruthSample {
                    time: fix.time,
                    position,
                    v_n: fix.velocity.map(|(v_n, _)| v_n),
                    rpy: None,
                };
                self.push(at, What::Pose(pose));
            }
            _ => {}
        }
    }

    /// What was read, if it can be used; counted where not.
    pub(super) fn usable<T>(&mut self, at: u64, read: Result<T, Unfit>) -> Option<T> {
        read.map_err(|(kind, detail)| self.skip(at, kind, detail))
            .ok()
    }

    /// Counts that the file breaks off, if it does.
    pub(super) fn ends_early(&mut self, at: u64, failure: Option<impl ToString>) {
        if let Some(failure) = failure {
            self.skip(at, SkipKind::EndsEarly, failure.to_string());
        }
    }
}

/// Entries of what is wanted by steps that make none, one or several of them, until one says that it was
/// the last. A step also says what the times count from, as soon as that is known.
pub(super) fn by_steps(
    wanted: &Wanted,
    mut step: impl FnMut(&mut Ready) -> Result<(bool, Option<Epoch>), ReadError> + Send + 'static,
) -> Entries {
    let mut ready = Ready {
        entries: VecDeque::new(),
        poses: matches!(wanted, Wanted::Poses(_)),
    };
    let (mut more, mut known) = (true, None);
    Entries::dated(std::iter::from_fn(move || {
        while more && ready.entries.is_empty() {
            match step(&mut ready) {
                Ok((goes_on, epoch)) => {
                    more = goes_on;
                    known = epoch;
                }
                Err(error) => {
                    more = false;
                    ready.entries.clear();
                    return Some(Err(error));
                }
            }
        }
        ready.entries.pop_front().map(|entry| Ok((entry, known)))
    }))
}

/// Takes a message: its number, its head and its body.
type TakeMessage<R, H> = fn(&mut R, u64, H, &[u8], &mut Ready) -> Result<(), ReadError>;

/// The same of messages: `message` takes each, `end` comes after the last, and `epoch` is
/// what the times count from so far.
pub(super) fn by_messages<H, R: Send + 'static>(
    wanted: &Wanted,
    source: Source,
    layout: &'static Layout<H>,
    mut reader: R,
    message: TakeMessage<R, H>,
    end: fn(&mut R, &mut Ready) -> Result<(), ReadError>,
    epoch: fn(&R) -> Option<Epoch>,
) -> Entries {
    let mut frames = Frames::new(source, layout);
    by_steps(wanted, move |ready| {
        let step = frames.step();
        let at = frames.number();
        match step {
            NextFrame::Message(head, body) => {
                message(&mut reader, at, head, frames.body(body), ready)?;
            }
            NextFrame::Damaged => ready.skip(at, SkipKind::Damaged, layout.damaged),
            NextFrame::End => {
                end(&mut reader, ready)?;
                ready.ends_early(at, frames.failure());
                return Ok((false, epoch(&reader)));
            }
        }
        Ok((true, epoch(&reader)))
    })
}

/// The same of lines; `too_long` is what a line longer than any row is, where that is counted.
pub(super) fn by_lines<R: Send + 'static>(
    wanted: &Wanted,
    mut lines: Lines,
    too_long: Option<String>,
    mut reader: R,
    line: fn(&mut R, u64, &[u8], &mut Ready) -> Result<(), ReadError>,
    end: fn(&mut R, &mut Ready) -> Result<(), ReadError>,
    epoch: fn(&R) -> Option<Epoch>,
) -> Entries {
    by_steps(wanted, move |ready| {
        let step = lines.step();
        let at = lines.number();
        match step {
            NextLine::Line(range) => line(&mut reader, at, lines.bytes(range), ready)?,
            NextLine::TooLong => {
                if let Some(detail) = &too_long {
                    ready.skip(at, SkipKind::TooLong, detail);
                }
            }
            NextLine::End => {
                end(&mut reader, ready)?;
                ready.ends_early(at, lines.failure());
                return Ok((false, epoch(&reader)));
            }
        }
        Ok((true, epoch(&reader)))
    })
}

/// The only stream of a format, if it has any message.
pub(super) fn one_stream(
    name: &str,
    kind: StreamKind,
    about: impl Into<String>,
    messages: u64,
) -> Vec<Stream> {
    let stream = Stream {
        name: name.to_owned(),
        kind,
        about: about.into(),
        messages,
    };
    Vec::from_iter((messages > 0).then_some(stream))
}

/// Refuses names of streams that a format does not have; `imu`, `position` and `velocity` are those
/// that it has.
pub(super) fn check(
    wanted: &Wanted,
    format: &str,
    [imu, position, velocity]: [&[&str]; 3],
) -> Result<(), ReadError> {
    let one = |asked: &_, known: &[&str], what: &str| check_name(asked, format, known, what);
    match wanted {
        Wanted::Imu(None) if imu.is_empty() => Err(ReadError::nameless(format!(
            "{format} has no inertial samples"
        ))),
        Wanted::Imu(name) => one(name, imu, "stream of inertial samples"),
        Wanted::Fixes {
            position: asked,
            velocity: apart,
            ..
        } => {
            one(asked, position, "stream of positions")?;
            one(apart, velocity, "stream of velocities")
        }
        Wanted::Poses(name) | Wanted::LocalPoses(name) => {
            one(name, position, "stream of positions")
        }
        // By the formats that have some.
        Wanted::Headings(_) | Wanted::Fields(_) => Ok(()),
    }
}

/// Refuses a name of a stream that a format does not have; `known` are those that it has.
pub(super) fn check_name(
    asked: &Option<String>,
    format: &str,
    known: &[&str],
    what: &str,
) -> Result<(), ReadError> {
    match asked {
        Some(name) if !known.contains(&name.as_str()) => {
            let problem = format!("no {what} \"{name}\" in {format}");
            let offer = if known.is_empty() {
                format!("it has no {what}")
            } else {
                format!("available: {}", known.join(", "))
            };
            Err(ReadError::nameless(problem).mend(offer))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
pub(super) mod testing;
#[cfg(test)]
mod tests;
