//! Which size of filter holds how many states: one list for all who build filters.

use undrift_nav::covariance::NAV;

/// What can be done with a filter of any size.
pub trait AnySize {
    /// What comes of it.
    type Output;
    /// Does it with filters of up to `N` states.
    fn with<const N: usize>(self) -> Self::Output;
}

/// Does something with the smallest size of filter that holds `behind` states behind the nine of
/// navigation, or with the largest there is.
pub fn sized<T: AnySize>(behind: usize, task: T) -> T::Output {
    match NAV + behind {
        ..=9 => task.with::<9>(),
        10..=15 => task.with::<15>(),
        16..=21 => task.with::<21>(),
        22..=27 => task.with::<27>(),
        28..=33 => task.with::<33>(),
        34..=45 => task.with::<45>(),
        _ => task.with::<73>(),
    }
}
