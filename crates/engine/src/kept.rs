//! How what has no form of its own is kept in a checkpoint.
//!
//! Numbers are kept, types are built again: a filter is its models, its priors and the numbers that change while
//! it runs. Bytes with too few or too many numbers are refused.
//!
//! Used by `checkpoint` only, and compiled with that feature. Three helpers: [`no_settings`] fills
//! in for the settings, which the caller gives again; [`filter`] keeps a `Box<dyn Estimator>`;
//! [`array`] keeps arrays of any length.
//!
//! The bytes are positional: a change of the order in which a filter gives its numbers is a new
//! format and has to raise `checkpoint::FORMAT`. Nothing here checks that the numbers make sense:
//! the checksum of the checkpoint does.

use crate::{
    estimator::{Estimator, build},
    settings::Settings,
};
use alloc::{boxed::Box, sync::Arc, vec::Vec};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};
use undrift_nav::{
    Vector3,
    attitude::from_rpy,
    covariance::AXES,
    earth::Geodetic,
    filter::InitialStd,
    mechanisation::NavState,
    parameters::{Parameter, Parameters, Prior},
    shaping::{MAX_ORDER, ShapingFilter},
};

/// The bytes are of something else.
///
/// Too few or too many numbers, or an order beyond [`MAX_ORDER`].
#[derive(Debug, thiserror::Error)]
#[error("not what was kept")]
struct NotKept;

/// In place of the settings, which are not kept.
///
/// Filters without noise and states; they are replaced before the [`Run`](crate::run::Run) is used.
pub(crate) fn no_settings() -> Arc<Settings> {
    let none = ShapingFilter {
        order: 0,
        interval: 1.0,
        f: [[0.0; MAX_ORDER]; MAX_ORDER],
        q: [[0.0; MAX_ORDER]; MAX_ORDER],
        p0: [[0.0; MAX_ORDER]; MAX_ORDER],
        h: [0.0; MAX_ORDER],
        s: [0.0; MAX_ORDER],
        r: 0.0,
    };
    Arc::new(Settings::new([none; AXES]))
}

/// A filter as its numbers.
///
/// In three parts, in this order: the six shaping filters, the priors of the parameters by
/// [`Parameter::ALL`], then every number that changes while the filter runs.
pub(crate) mod filter {
    use super::*;

    /// Models as numbers, priors of the parameters, and the filter's own numbers.
    type Made = (
        [Vec<f64>; AXES],
        [Option<Prior>; Parameter::ALL.len()],
        Vec<f64>,
    );

    /// # Errors
    /// Those of the serializer.
    #[expect(clippy::borrowed_box, reason = "what the derived code calls it with")]
    pub(crate) fn serialize<S: Serializer>(
        filter: &Box<dyn Estimator>,
        to: S,
    ) -> Result<S::Ok, S::Error> {
        let sensors = core::array::from_fn(|k| {
            let (mut axis, mut numbers) = (*filter.sensors().axis(k), Vec::new());
            axis.numbers(&mut |number| numbers.push(*number));
            numbers
        });
        let priors = Parameter::ALL.map(|kind| filter.parameters().prior(kind));
        let mut numbers = Vec::new();
        filter.boxed().numbers(&mut |number| numbers.push(*number));
        let made: Made = (sensors, priors, numbers);
        made.serialize(to)
    }

    /// The filter is built at latitude and longitude 0 and then overwritten number by number:
    /// state, covariance and estimates.
    ///
    /// # Errors
    /// [`NotKept`]; models and parameters for which no filter can be built.
    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(
        from: D,
    ) -> Result<Box<dyn Estimator>, D::Error> {
        let (kept, priors, numbers) = Made::deserialize(from)?;
        let mut sensors = no_settings().sensors;
        for (axis, kept) in sensors.iter_mut().zip(&kept) {
            let mut kept = kept.iter();
            axis.numbers(&mut |number| *number = kept.next().copied().unwrap_or(f64::NAN));
            if axis.order > MAX_ORDER {
                return Err(D::Error::custom(NotKept));
            }
        }
        let mut parameters = Parameters::none();
        for (kind, prior) in Parameter::ALL.into_iter().zip(priors) {
            if let Some(prior) = prior {
                parameters = parameters.with(kind, prior);
            }
        }
        // Anywhere: its numbers follow.
        let nav = NavState {
            time: 0.0,
            position: Geodetic::from_degrees(0.0, 0.0, 0.0),
            v_n: Vector3::zeros(),
            q_nb: from_rpy(&Vector3::zeros()),
        };
        let one = Vector3::repeat(1.0);
        let std = InitialStd {
            position: one,
            velocity: one,
            attitude: one,
        };
        let mut filter = build(nav, &std, &sensors, parameters).map_err(D::Error::custom)?;
        let (mut kept, mut missing) = (numbers.into_iter(), false);
        filter.numbers(&mut |number| match kept.next() {
            Some(kept) => *number = kept,
            None => missing = true,
        });
        match missing || kept.next().is_some() {
            true => Err(D::Error::custom(NotKept)),
            false => Ok(filter),
        }
    }
}

/// An array of any length, which serde has to 32.
///
/// Written as a sequence with its length.
pub(crate) mod array {
    use super::*;

    /// # Errors
    /// Those of the serializer.
    pub(crate) fn serialize<T: Serialize, S: Serializer, const N: usize>(
        array: &[T; N],
        to: S,
    ) -> Result<S::Ok, S::Error> {
        array.as_slice().serialize(to)
    }

    /// # Errors
    /// Another number of elements than N.
    pub(crate) fn deserialize<'de, T: Deserialize<'de>, D: Deserializer<'de>, const N: usize>(
        from: D,
    ) -> Result<[T; N], D::Error> {
        let all = Vec::<T>::deserialize(from)?;
        all.try_into().map_err(|_| D::Error::custom(NotKept))
    }
}
