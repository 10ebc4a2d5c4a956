//! Whether innovations stay as large as their covariance says, and without a lean to one side.

use super::{
    events::{Lean, Part},
    summary::{MOST_EVENTS, Summary},
};
use crate::median::upper_median;
use crate::settings::WatchSettings;
use undrift_nav::{Vector3, filter::Update};

/// Updates, their NIS and degrees of freedom since the count began, and when that was \[s\].
#[derive(Clone, Default)]
pub(super) struct Streak {
    set: WatchSettings,
    updates: u32,
    nis: f64,
    dof: u32,
    start: f64,
    /// Whether the solution was ever sound, and since when it is not \[s\].
    sound: bool,
    sick_since: Option<f64>,
}

impl Streak {
    pub(super) fn new(set: WatchSettings) -> Self {
        Self {
            set,
            ..Self::default()
        }
    }

    /// Watches for innovations far beyond their covariance, block by block.
    pub(super) fn watch(&mut self, update: Update, time: f64, summary: &mut Summary) {
        if self.updates == 0 {
            self.start = time;
        }
        self.updates += 1;
        self.nis += update.nis;
        self.dof += update.dof as u32;
        if self.updates == self.set.suspect_updates {
            self.judge(summary);
        }
    }

    /// Whether a solution that was sound has been beyond its size for long [`WatchSettings::sick`].
    pub(super) fn is_sick(&self, time: f64) -> bool {
        self.sick_since
            .is_some_and(|since| time - since > self.set.sick)
    }

    pub(super) fn judge(&mut self, summary: &mut Summary) {
        if self.dof == 0 {
            return;
        }
        let nis = self.nis / f64::from(self.dof);
        if nis > self.set.suspect_nis {
            if summary.suspect.is_none() {
                summary.suspect = Some(self.start);
            }
            if self.sound {
                self.sick_since.get_or_insert(self.start);
            }
        } else {
            self.sick_since = None;
            self.sound |= nis < self.set.sound_nis;
        }
        (self.updates, self.nis, self.dof) = (0, 0.0, 0);
    }
}

/// Blocks that the usual size is taken from, and how many there must be.
const BLOCKS: usize = 20;

/// Watches the means of whitened innovations for a slow drift of fixes that each pass the gate.
#[derive(Clone)]
pub(super) struct LeanWatch {
    part: Part,
    set: WatchSettings,
    start: f64,
    updates: usize,
    white: Vector3,
    innovation: Vector3,
    usual: [f64; BLOCKS],
    count: usize,
    open: Option<Lean>,
}

impl LeanWatch {
    pub(super) fn new(part: Part, set: WatchSettings) -> Self {
        Self {
            part,
            set,
            start: 0.0,
            updates: 0,
            white: Vector3::zeros(),
            innovation: Vector3::zeros(),
            usual: [0.0; BLOCKS],
            count: 0,
            open: None,
        }
    }

    pub(super) fn add(
        &mut self,
        time: f64,
        innovation: &Vector3,
        update: &Update,
        summary: &mut Summary,
    ) {
        if self.updates == 0 {
            self.start = time;
        }
        self.updates += 1;
        self.white +=
            Vector3::from(update.whitened).map(|w| w.clamp(-self.set.clip, self.set.clip));
        self.innovation += innovation;
        if self.updates < self.set.lean_block {
            return;
        }
        // χ²(3)/3 for white innovations.
        let size = self.white.norm_squared() / (3.0 * self.set.lean_block as f64);
        let mean: [f64; 3] = (self.innovation / self.set.lean_block as f64).into();
        (self.updates, self.white, self.innovation) = (0, Vector3::zeros(), Vector3::zeros());
        let mut known = self.usual;
        let usual = upper_median(&mut known[..self.count.min(BLOCKS)]);
        if self.count >= self.set.least_blocks && size > self.set.leans * usual.max(1.0) {
            let length = |m: &[f64; 3]| Vector3::from(*m).norm();
            let open = self.open.get_or_insert(Lean {
                part: self.part,
                start: self.start,
                end: time,
                mean,
            });
            open.end = time;
            if length(&mean) > length(&open.mean) {
                open.mean = mean;
            }
        } else {
            self.usual[self.count % BLOCKS] = size;
            self.count += 1;
            self.close(summary);
        }
    }

    pub(super) fn close(&mut self, summary: &mut Summary) {
        if let Some(lean) = self.open.take()
            && summary.leans.len() < MOST_EVENTS
        {
            summary.leans.push(lean);
        }
    }
}

#[cfg(test)]
mod tests;
