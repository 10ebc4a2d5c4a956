//! Tables with an entry for each kind of measurement.

use core::ops::{Index, IndexMut};
use undrift_events::Aid;

/// A value for each [`Aid`], read and written as `table[aid]`.
///
/// ```
/// use undrift_engine::{Aid, ByAid};
/// let mut updates = ByAid::<u32>::default();
/// updates[Aid::Odometer] += 1;
/// assert_eq!(Aid::ALL.map(|aid| updates[aid]).iter().sum::<u32>(), 1);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct ByAid<T>(pub [T; Aid::COUNT]);

impl<T> Index<Aid> for ByAid<T> {
    type Output = T;

    fn index(&self, aid: Aid) -> &T {
        &self.0[aid as usize]
    }
}

impl<T> IndexMut<Aid> for ByAid<T> {
    fn index_mut(&mut self, aid: Aid) -> &mut T {
        &mut self.0[aid as usize]
    }
}
