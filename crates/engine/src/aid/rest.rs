//! Rest of a vehicle whose heading is hardly known.

use undrift_nav::{Vector3, aiding::Observation, filter::Filter};

/// The gyros read the Earth's rate and their errors, of which no attitude is learnt: a bias that wanders by more than modelled would
/// turn it.
pub(super) fn observe_no_turn<const N: usize>(
    filter: &Filter<N>,
    rate: &Vector3,
) -> Observation<3, N> {
    let mut observed = filter.observe_earth_rate(rate);
    observed.h.fixed_view_mut::<3, 3>(0, 6).fill(0.0);
    observed
}
