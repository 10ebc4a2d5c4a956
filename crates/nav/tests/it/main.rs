//! The filter from outside: Jacobians, measurements, smoother, properties.

mod aiding;
mod doubts;
mod jacobians;
mod lasting;
mod magnetic;
mod properties;
mod refused;
mod smoother;
mod start;
mod turned;
mod update;
mod values;
mod weakened;
