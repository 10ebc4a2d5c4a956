#![no_main]

use undrift::nav::units::{Quantity, parse, unit_factor};

const QUANTITIES: [Quantity; 13] = [
    Quantity::AngularRate,
    Quantity::Acceleration,
    Quantity::Angle,
    Quantity::Length,
    Quantity::Time,
    Quantity::Frequency,
    Quantity::Velocity,
    Quantity::AngleRandomWalk,
    Quantity::VelocityRandomWalk,
    Quantity::RateRandomWalk,
    Quantity::AccelerationRandomWalk,
    Quantity::LengthRandomWalk,
    Quantity::Dimensionless,
];

libfuzzer_sys::fuzz_target!(|text: &str| {
    let mut kinds = 0;
    for quantity in QUANTITIES {
        match parse(text, quantity) {
            Ok(value) => {
                assert!(value.is_finite(), "{text} is {value}");
                kinds += 1;
            }
            Err(error) => assert!(!error.to_string().is_empty()),
        }
        match unit_factor(text, quantity) {
            Ok(factor) => assert!(factor.is_finite() && factor > 0.0, "{text} is {factor}"),
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    }
    assert!(kinds <= 1, "{text} measures {kinds} kinds of quantity");
});
