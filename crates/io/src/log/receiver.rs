//! What the readers of receivers' logs have in common.

use std::collections::VecDeque;

use undrift_nav::sample::{Position, TruthSample};

use crate::ReadError;
use crate::entry::{Entries, Entry, Fix, Stream, StreamKind, Wanted, What};
use crate::epoch::Epoch;
use crate::skipped::{SkipKind, Unfit};

/// Entries that are ready to be given out.
pub(super) struct Ready {
    entries: VecDeque<Entry>,
    /// Whether reference solutions are wanted, not fixes.
    poses: bool,
}

impl Ready {
    pub(super) fn push(&mut self, at: u64, what: What) {
        self.entries.push_back(Entry { at, what });
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
/// the last. A step also tells what the times count from, as soon as that is known.
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

/// The only stream of a format, if it has any message.
pub(super) fn one_stream(name: &str, about: String, messages: u64) -> Vec<Stream> {
    let stream = Stream {
        name: name.to_owned(),
        kind: StreamKind::Fixes,
        about,
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
    let one = |asked: &Option<String>, known: &[&str], what: &str| match asked {
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
    };
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
        Wanted::Poses(name) => one(name, position, "stream of positions"),
    }
}

#[cfg(test)]
pub(super) mod testing;
