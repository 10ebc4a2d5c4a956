//! Groups of measurements in the record of a filter's run.

use super::Aiding;

/// Group of measurements that noise is fitted for by itself, from the updates that [`LogTo`](crate::estimator::LogTo) receives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// GNSS position.
    Position,
    /// GNSS velocity.
    Velocity,
    /// Non-holonomic constraint.
    NonHolonomic,
    /// Attitude of a marker.
    Attitude,
    /// Any other kind.
    Other,
}

impl Aiding {
    pub(crate) fn channel(&self) -> Channel {
        match self {
            Self::Position { .. } => Channel::Position,
            Self::Velocity { .. } => Channel::Velocity,
            Self::NonHolonomic(_) => Channel::NonHolonomic,
            Self::Attitude { .. } => Channel::Attitude,
            _ => Channel::Other,
        }
    }
}
