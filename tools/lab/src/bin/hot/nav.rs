//! The filter.

use nalgebra::SMatrix;
use std::hint::black_box;
use undrift::nav::{
    Matrix3, Quaternion, Vector3,
    earth::Geodetic,
    filter::{Filter, Gate, InitialStd},
    mechanisation::NavState,
    parameters::Parameters,
    sample::{ImuSample, Position},
    shaping::{ShapingError, ShapingFilter},
};

const DT: f64 = 0.005;

pub fn run(task: &str, count: u32) -> Result<(), Box<dyn std::error::Error>> {
    match task {
        "predict-9" => predict::<9>(count)?,
        // As `estimator::build` holds 15 states.
        "predict-15" => predict::<16>(count)?,
        "predict-21" => predict::<21>(count)?,
        "predict-33" => predict::<33>(count)?,
        "dense-9" => dense::<9>(count),
        "dense-15" => dense::<15>(count),
        "dense-21" => dense::<21>(count),
        "dense-33" => dense::<33>(count),
        "update-15" => update::<16>(count)?,
        "update-33" => update::<33>(count)?,
        "shaping" => shaping(count)?,
        _ => return Err(format!("no task {task}").into()),
    }
    Ok(())
}

/// A model of so many states.
fn model(order: usize, dt: f64) -> Result<ShapingFilter, ShapingError> {
    let phi = [0.999, -0.1, 0.05, 0.01];
    match phi.get(..order) {
        Some(phi) if order > 0 => ShapingFilter::arma(phi, &[0.9], 5e-3, dt),
        _ => ShapingFilter::white(5e-4, dt),
    }
}

fn filter<const N: usize>() -> Result<Filter<N>, Box<dyn std::error::Error>> {
    let nav = NavState {
        time: 0.0,
        position: Geodetic::from_degrees(45.0, 7.0, 300.0),
        v_n: Vector3::new(15.0, 1.0, 0.0),
        q_nb: Quaternion::identity(),
    };
    let std = InitialStd {
        position: Vector3::repeat(1.0),
        velocity: Vector3::repeat(0.1),
        attitude: Vector3::repeat(0.02),
    };
    let sensors = [model((N - 9) / 6, DT)?; 6];
    Ok(Filter::new(nav, &std, sensors, Parameters::none())?)
}

/// Samples through the filter.
fn predict<const N: usize>(count: u32) -> Result<(), Box<dyn std::error::Error>> {
    let mut filter = filter::<N>()?;
    for k in 0..count {
        filter.predict(black_box(&ImuSample {
            time: DT * f64::from(k),
            dt: DT,
            dtheta: Vector3::new(1e-5, -2e-5, 5e-5),
            dvel: Vector3::new(1e-4, -2e-4, -9.806 * DT),
        }));
    }
    black_box(filter.nav_std());
    Ok(())
}

/// The dense product F P Fᵀ + Q, which the filter's step is held against.
fn dense<const N: usize>(count: u32) {
    let f = SMatrix::<f64, N, N>::from_fn(|i, j| if i == j { 1.0 } else { 1e-4 * (i + j) as f64 });
    let q = SMatrix::<f64, N, N>::identity() * 1e-12;
    let mut p = SMatrix::<f64, N, N>::identity();
    for _ in 0..count {
        // Less than 1, so that the numbers do not grow.
        p = (black_box(&f) * p * f.transpose() + q) * 0.99;
    }
    black_box(p);
}

/// Positions into the filter.
fn update<const N: usize>(count: u32) -> Result<(), Box<dyn std::error::Error>> {
    let mut filter = filter::<N>()?;
    let fix = Position::Geodetic(filter.nav().position);
    for _ in 0..count {
        let observed = filter.observe_position(black_box(&fix), &Vector3::new(0.3, 0.1, -1.0));
        filter.update(&observed, &Matrix3::identity(), &Gate::OPEN)?;
    }
    black_box(filter.nav_std());
    Ok(())
}

/// Shaping filters of ARMA(4,1) made for a sample interval, their stationary covariance included.
fn shaping(count: u32) -> Result<(), Box<dyn std::error::Error>> {
    for _ in 0..count {
        black_box(model(4, black_box(DT))?);
    }
    Ok(())
}
