//! Samples and fixes in memory to a solution: `cargo run --release -p undrift --example navigate_slices`.
use undrift::{BiasModel, ImuModel, Setup, Trajectory, navigate, simulate, simulate::GnssNoise};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let model = ImuModel::preset("adis16465").ok_or("no such preset")?;
    let noise = model.shaping(BiasModel::GaussMarkov, 0.01)?;
    let car = Trajectory::car(300.0, 1);
    let log = simulate(&car, 100.0, Some(&noise), &GnssNoise::default(), 1)?;
    let done = navigate(&log.imu, &log.gnss, &model, &Setup::default())?;
    println!("{}; findings: {:?}", done.verdict, done.findings);
    for row in done.solution.iter().step_by(1000) {
        let (lat, lon) = (row.position.lat.to_degrees(), row.position.lon.to_degrees());
        let (yaw, std) = (row.rpy.z.to_degrees(), row.nav_std[0]);
        println!(
            "{:5.1} s {lat:.7}° {lon:.7}° ± {std:.2} m, heading {yaw:.1}°",
            row.time
        );
    }
    Ok(())
}
