//! A hundred thousand samples through the 15-state filter, for counting instructions:
//! `valgrind --tool=callgrind target/release/examples/predict`.

use undrift_nav::{
    Quaternion, Vector3,
    earth::Geodetic,
    filter::{Filter, InitialStd},
    mechanisation::NavState,
    parameters::Parameters,
    sample::ImuSample,
    shaping::ShapingFilter,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let dt = 0.005;
    let sensor = ShapingFilter::arma(&[0.9999], &[0.999], 5e-3, dt)?;
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
    let mut filter = Filter::<15>::new(nav, &std, [sensor; 6], Parameters::none())?;
    let samples = 100_000;
    for k in 0..samples {
        filter.predict(&ImuSample {
            time: dt * f64::from(k),
            dt,
            dtheta: Vector3::new(1e-5, -2e-5, 5e-5),
            dvel: Vector3::new(1e-4, -2e-4, -9.806 * dt),
        });
    }
    println!("{samples} samples, north std {:.3} m", filter.nav_std()[0]);
    Ok(())
}
