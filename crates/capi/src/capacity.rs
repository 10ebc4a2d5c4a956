//! How many states there are.

use undrift_nav::{
    covariance::{AXES, NAV},
    filter::Filter,
    shaping::MAX_ORDER,
};

/// States of the filter: 9 for navigation, the rest for sensors and parameters.
pub(crate) const STATES: usize = match option_env!("UNDRIFT_MAX_STATES") {
    None => 33,
    Some(text) => match usize::from_str_radix(text, 10) {
        Ok(number) => number,
        Err(_) => panic!("UNDRIFT_MAX_STATES is not a number"),
    },
};
/// More than all axes at their highest order and all parameters need.
const MOST: usize = NAV + AXES * MAX_ORDER + 27;
const _: () = assert!(
    STATES >= NAV && STATES <= MOST,
    "UNDRIFT_MAX_STATES is 9 to 72"
);

/// The filter that this crate is built for.
pub(crate) type Inner = Filter<STATES>;
