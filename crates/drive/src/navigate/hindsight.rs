//! How much of a log a solution knows.

/// Part of a log that a solution knows at each instant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Hindsight {
    /// What has come so far, as while driving: what a real-time run would have given.
    #[default]
    Causal,
    /// What has come so far, and from the first sample on what all of the fixes show of their errors, and the mounting.
    LookAhead,
    /// All of it: smoothed, for the best solution after the drive.
    Smooth,
}

impl Hindsight {
    /// From two switches of a user; a smoothed solution looks ahead in any case.
    pub fn asked(look_ahead: bool, smooth: bool) -> Self {
        match (look_ahead, smooth) {
            (_, true) => Self::Smooth,
            (true, false) => Self::LookAhead,
            (false, false) => Self::Causal,
        }
    }
}
