//! Why there is no alignment.

use crate::{
    align::{AlignmentFailure, ClockFault, Stamps},
    events::Implausible,
};
use alloc::vec::Vec;

/// No alignment before the samples ended, and what is known of why.
#[derive(Clone, Debug)]
pub struct NotAligned {
    /// What was missing.
    pub failure: AlignmentFailure,
    /// The stamps of samples and fixes, where there were both, and how their clocks differ if they do not overlap.
    pub times: Option<([Stamps; 2], ClockFault)>,
    /// Units, axes, signs or times that cannot be right.
    pub implausible: Vec<Implausible>,
}
