//! What fixes show of themselves, as they come: looked at after a minute, each time when that time has doubled, and
//! at the end. Whether they scatter far more than they state shows sooner, before a solution has learned from them.
//!
//! A study of all fixes each time costs as much as there are: doubling the span between two studies keeps the
//! sum of it linear in the log. Fixes are kept in blocks that copies of the navigator share.

use super::{FixStudy, LEAST, LEAST_POSITIONS, MOST, Seen, Track, study_track};
use alloc::{sync::Arc, vec::Vec};
use undrift_nav::sample::GnssFix;

/// They are looked at after this time \[s\], and whenever it has doubled.
const FIRST_SPAN: f64 = 60.0;
/// Scatter beside a velocity is looked at after this time, once \[s\].
const EARLY_SPAN: f64 = 10.0;
/// Positions alone, whose scatter shows soon, after this time \[s\].
const FIRST_SPAN_OF_POSITIONS: f64 = 10.0;
/// Fixes of a block: a copy of the watch shares full ones.
const BLOCK: usize = 64;

/// The fixes so far, and when they are looked at next.
#[derive(Clone, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct FixWatch {
    full: Vec<Arc<[Seen]>>,
    last: Vec<Seen>,
    /// First stamp \[s\].
    first: Option<f64>,
    /// Whether one had a velocity.
    by_velocity: bool,
    /// After which span they were looked at last \[s\].
    looked: f64,
    /// Whether their scatter was looked at.
    looked_early: bool,
}

impl FixWatch {
    /// Takes in a fix that repeats none before; what all of them show, where it is time to look.
    ///
    /// `None` between looks, after 20 000 fixes, and of a fix without usable variances.
    pub(crate) fn next(&mut self, fix: &GnssFix) -> Option<FixStudy> {
        let count = BLOCK * self.full.len() + self.last.len();
        if count >= MOST {
            return None;
        }
        let seen = Seen::from_fix(fix)?;
        self.by_velocity |= seen.velocity.is_some();
        self.last.push(seen);
        if self.last.len() == BLOCK {
            self.full.push(self.last.drain(..).collect());
        }
        let first = *self.first.get_or_insert(fix.time);
        let span = fix.time - first;
        let (first, least) = match self.by_velocity {
            true => (FIRST_SPAN, LEAST),
            false => (FIRST_SPAN_OF_POSITIONS, LEAST_POSITIONS),
        };
        if span < first.max(2.0 * self.looked) || count < least {
            let early = self.by_velocity && !self.looked_early;
            if !early || span < EARLY_SPAN || count < least {
                return None;
            }
            self.looked_early = true;
            return self.study().and_then(FixStudy::of_scatter);
        }
        self.looked = span;
        self.study()
    }

    /// What all of them show.
    pub(crate) fn study(&self) -> Option<FixStudy> {
        let full = self.full.iter().flat_map(|block| block.iter());
        study_track(&Track::from_fixes(full.chain(&self.last)))
    }
}

#[cfg(test)]
mod tests;
