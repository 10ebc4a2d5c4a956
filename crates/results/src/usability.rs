//! How far a result can be trusted: the first words of what is printed.

use crate::findings::Severity;
use std::fmt;

/// Whether a result can be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Usability {
    /// No fault was found.
    Usable,
    /// Look at the findings first.
    WithCare,
    /// There is no result, or none from some time on, or it is of another vehicle or sensor.
    NotUsable,
}

impl Usability {
    /// "usable", "usable with care" or "not usable".
    pub fn name(self) -> &'static str {
        match self {
            Self::Usable => "usable",
            Self::WithCare => "usable with care",
            Self::NotUsable => "not usable",
        }
    }
}

impl fmt::Display for Usability {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl From<Severity> for Usability {
    fn from(severity: Severity) -> Self {
        match severity {
            Severity::Note => Self::Usable,
            Severity::Warning => Self::WithCare,
            Severity::Unusable => Self::NotUsable,
        }
    }
}
