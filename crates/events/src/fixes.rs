//! Which fixes are withheld, and which of their parts are used.

/// Stamps closer than this \[s\] are the same instant.
pub const STAMP_ROUNDING: f64 = 1e-6;

/// Half-open span of time without GNSS: fixes after `start` up to and including `end` are withheld.
///
/// ```
/// use undrift_events::Outage;
/// let outage = Outage { start: 100.0, end: 130.0 };
/// assert_eq!([100.0, 100.1, 130.0, 130.1].map(|time| outage.contains(time)), [false, true, true, false]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct Outage {
    /// Last instant with GNSS \[s\], in the log's time base.
    pub start: f64,
    /// Last instant without GNSS \[s\].
    pub end: f64,
}

impl Outage {
    /// Whether `time` \[s\] lies in `(start, end]`. A microsecond of slack absorbs the rounding of stamps.
    pub fn contains(&self, time: f64) -> bool {
        time > self.start + STAMP_ROUNDING && time <= self.end + STAMP_ROUNDING
    }
}

/// Parts of a fix that update the solution.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub enum GnssUse {
    /// Position and velocity, whichever it has.
    #[default]
    Both,
    /// Position alone; a velocity of the fix is not used.
    Position,
    /// Velocity alone, once aligned: for receivers whose positions are not to be trusted.
    Velocity,
}
