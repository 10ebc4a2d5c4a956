//! A recording at rest, as rows in memory, to a noise model: `cargo run --release -p undrift --example identify_record`.
use undrift::{
    BiasModel, ImuModel, Trajectory, identify, noise::model_file, simulate, simulate::GnssNoise,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (rate_hz, sensor) = (50.0, ImuModel::preset("mpu6050").ok_or("no such preset")?);
    let noise = sensor.shaping(BiasModel::GaussMarkov, 1.0 / rate_hz)?;
    let rest = Trajectory::rest(600.0);
    let log = simulate(&rest, rate_hz, Some(&noise), &GnssNoise::default(), 1)?;
    // Gyro [rad/s] and accelerometer [m/s²], x, y, z each.
    let rates = log.imu.iter().map(|s| (s.dtheta / s.dt, s.dvel / s.dt));
    let rows: Vec<[f64; 6]> = rates.map(|(w, f)| [w.x, w.y, w.z, f.x, f.y, f.z]).collect();
    let found = identify(&rows, rate_hz)?;
    println!("# {}", found.verdict);
    for (name, axis) in found.identified.axes {
        println!("# {name}: {}", model_file::reason(&axis?.reason));
    }
    print!("{}", found.model.to_toml());
    Ok(())
}
