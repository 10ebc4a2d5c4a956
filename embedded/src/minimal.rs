//! The filter and nothing else: what its share of a firmware's flash is measured on.

use crate::run::{self, Failure};
use core::hint::black_box;
use undrift_nav::{
    Vector3,
    earth::Geodetic,
    filter::{Filter, InitialStd},
    mechanisation::NavState,
    parameters::Parameters,
    sample::ImuSample,
    shaping::{ShapingError, ShapingFilter},
};

/// Initialises, then predicts and updates with position and velocity, on numbers that nothing is known of.
///
/// # Errors
/// Whatever the numbers make of it.
pub fn minimal<const N: usize>(
    sensors: fn(f64) -> Result<[ShapingFilter; 6], ShapingError>,
) -> Result<(), Failure> {
    let number = || black_box(1.0);
    let vector = || Vector3::new(number(), number(), number());
    let place = || Geodetic {
        lat: number(),
        lon: number(),
        height: number(),
    };
    let start = NavState {
        time: number(),
        position: place(),
        v_n: vector(),
        q_nb: undrift_nav::attitude::from_rpy(&vector()),
    };
    let std = InitialStd {
        position: vector(),
        velocity: vector(),
        attitude: vector(),
    };
    let sensors = sensors(number()).map_err(Failure::Model)?;
    let mut filter =
        Filter::<N>::new(start, &std, sensors, Parameters::none()).map_err(Failure::Filter)?;
    loop {
        filter.begin(&ImuSample {
            time: number(),
            dt: number(),
            dtheta: vector(),
            dvel: vector(),
        });
        filter.advance_to(number(), run::ROUNDING);
        let fix = crate::record::Fix {
            time: number(),
            position: place(),
            v_n: vector(),
            position_std: vector(),
            velocity_std: vector(),
        };
        run::position(&mut filter, &fix, &vector())?;
        run::velocity(&mut filter, &fix, &vector())?;
        filter.advance(1.0);
        filter.check().map_err(Failure::Filter)?;
        black_box(run::states(&filter));
    }
}
