//! Measurements on their way into the filter.

use super::geodetic;
use crate::{columns, error::error};
use pyo3::prelude::*;
use undrift::{
    estimator::Aiding,
    nav::{
        Matrix3, Vector3,
        sample::{FixQuality, GnssFix, Position},
    },
    settings::fix_errors::FixErrors,
};

/// A measurement as Python hands it over.
#[derive(FromPyObject)]
pub struct Measured {
    #[pyo3(item)]
    pub(super) kind: String,
    #[pyo3(item)]
    value: [f64; 3],
    #[pyo3(item)]
    std: f64,
    #[pyo3(item)]
    lever_arm: [f64; 3],
    #[pyo3(item)]
    covariance: Option<[[f64; 3]; 3]>,
}

/// Positions and velocities with what is known of a receiver's errors beyond what it states.
pub(super) fn stated(mut measurements: Vec<Measured>, errors: &FixErrors) -> Vec<Measured> {
    let of = |kind| {
        let found = measurements.iter().find(|measured| measured.kind == kind)?;
        Some((found.value, columns::matrix(found.covariance?)))
    };
    let fix = errors.apply(&GnssFix {
        attitude: None,
        mean_velocity: None,
        time: 0.0,
        position: of("position").map(|(at, r)| (Position::Geodetic(geodetic(at)), r)),
        velocity: of("velocity").map(|(v, r)| (Vector3::from(v), r)),
        quality: FixQuality::Unknown,
    });
    for measured in &mut measurements {
        let covariance = match measured.kind.as_str() {
            "position" => fix.position.map(|(_, r)| r),
            "velocity" => fix.velocity.map(|(_, r)| r),
            _ => None,
        };
        measured.covariance = covariance.map(columns::rows).or(measured.covariance);
    }
    measurements
}

impl Measured {
    /// For a filter at time `due` [s], with its covariance.
    pub(super) fn aiding(self, due: f64, errors: &FixErrors) -> PyResult<(Aiding, Matrix3)> {
        let Self {
            kind,
            value,
            std,
            lever_arm,
            covariance,
        } = self;
        let numbers = value.iter().chain(&lever_arm).chain([&std]);
        if numbers
            .chain(covariance.iter().flatten().flatten())
            .any(|x| !x.is_finite())
        {
            return Err(error(format!("{kind}: a number is not finite")));
        }
        let lever_arm = Vector3::from(lever_arm);
        let mut noise =
            covariance.map_or_else(|| Matrix3::identity() * (std * std), columns::matrix);
        let aiding = match kind.as_str() {
            "position" => {
                let (white, correlated) = errors.split(&noise);
                noise = white;
                Aiding::Position {
                    position: Position::Geodetic(geodetic(value)),
                    lever_arm,
                    correlated,
                    due,
                }
            }
            "velocity" => {
                let (white, correlated) = errors.split_velocity(&noise);
                noise = white;
                Aiding::Velocity {
                    v_n: Vector3::from(value),
                    lever_arm,
                    correlated,
                    due,
                }
            }
            "zero velocity" => Aiding::ZeroVelocity,
            "earth rate" => Aiding::EarthRate(Vector3::from(value)),
            "level" => Aiding::Level(Vector3::from(value)),
            "non-holonomic" => {
                let [right, down, _] = value;
                noise = Matrix3::from_diagonal(&Vector3::new(right * right, down * down, 0.0));
                Aiding::NonHolonomic(lever_arm)
            }
            "magnetometer" => Aiding::Magnetometer {
                measured: Vector3::from(value),
                field: lever_arm,
            },
            other => Aiding::scalar(other, value[0], lever_arm)
                .ok_or_else(|| error(format!("unknown measurement \"{other}\"")))?,
        };
        Ok((aiding, noise))
    }
}
