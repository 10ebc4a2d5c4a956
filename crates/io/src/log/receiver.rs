//! What the readers of receivers' logs have in common.

use std::collections::VecDeque;

use undrift_nav::earth::Geodetic;
use undrift_nav::sample::{Position, TruthSample};

use crate::ReadError;
use crate::entry::{Entries, Entry, Fix, Wanted, What};
use crate::fix::{is_a_fix, shown};
use crate::skipped::SkipKind;

/// Entries that are ready to be given out.
#[derive(Default)]
pub(super) struct Ready(VecDeque<Entry>);

impl Ready {
    pub(super) fn push(&mut self, at: u64, what: What) {
        self.0.push_back(Entry { at, what });
    }

    pub(super) fn skip(&mut self, at: u64, kind: SkipKind, detail: impl Into<String>) {
        self.push(at, What::Skipped(kind, detail.into()));
    }

    /// A fix, or the reference solution that it is.
    pub(super) fn fix(&mut self, at: u64, fix: Fix, poses: bool) {
        match fix.position {
            _ if !poses => self.push(at, What::Fix(fix)),
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

    /// Whether a place can be one; counted where not.
    pub(super) fn is_a_place(&mut self, at: u64, place: &Geodetic) -> bool {
        let is_one = is_a_fix(place);
        if !is_one {
            self.skip(at, SkipKind::OutOfRange, shown(place));
        }
        is_one
    }
}

/// Entries by steps that make none, one or several of them, until one says that it was the last.
pub(super) fn by_steps(
    mut step: impl FnMut(&mut Ready) -> Result<bool, ReadError> + Send + 'static,
) -> Entries {
    let mut ready = Ready::default();
    let mut more = true;
    Box::new(std::iter::from_fn(move || {
        while more && ready.0.is_empty() {
            match step(&mut ready) {
                Ok(goes_on) => more = goes_on,
                Err(error) => {
                    more = false;
                    ready.0.clear();
                    return Some(Err(error));
                }
            }
        }
        ready.0.pop_front().map(Ok)
    }))
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
                format!("it has no {what} at all")
            } else {
                format!("read are: {}", known.join(", "))
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
