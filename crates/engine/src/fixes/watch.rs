//! What fixes show of themselves, as they come: looked at after a minute, and each time when that time has doubled.

use super::{FixStudy, Seen, Track, study_track};
use crate::settings::FixStudySettings;
use alloc::{sync::Arc, vec::Vec};
use undrift_nav::sample::GnssFix;

/// Fixes of a block: a copy of the watch shares full ones.
const BLOCK: usize = 64;

/// The fixes so far, and when they are looked at next.
#[derive(Clone)]
pub(crate) struct FixWatch {
    set: FixStudySettings,
    full: Vec<Arc<[Seen]>>,
    last: Vec<Seen>,
    /// First stamp and the span after which they are looked at \[s\].
    first: Option<f64>,
    span: f64,
}

impl FixWatch {
    pub(crate) fn new(set: FixStudySettings) -> Self {
        Self {
            set,
            full: Vec::new(),
            last: Vec::new(),
            first: None,
            span: set.first_span,
        }
    }

    /// Takes in a fix that repeats none before; what all of them show, where it is time to look.
    pub(crate) fn next(&mut self, fix: &GnssFix) -> Option<FixStudy> {
        let count = BLOCK * self.full.len() + self.last.len();
        if count >= self.set.most {
            return None;
        }
        self.last.push(Seen::of(fix)?);
        if self.last.len() == BLOCK {
            self.full.push(self.last.drain(..).collect());
        }
        let first = *self.first.get_or_insert(fix.time);
        if fix.time - first < self.span || count < self.set.least {
            return None;
        }
        self.span = 2.0 * (fix.time - first);
        let full = self.full.iter().flat_map(|block| block.iter());
        let track = Track::of(full.chain(&self.last).copied());
        study_track(&track, &self.set)
    }
}
