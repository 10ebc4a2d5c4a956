//! Samples pushed as they come, fixes 0.15 s late: `cargo run --release -p undrift --example real_time`.
use undrift::{BiasModel, ImuModel, Setup, Trajectory, simulate, simulate::GnssNoise};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (dt, model) = (0.01, ImuModel::preset("adis16465").ok_or("no such preset")?);
    let noise = model.shaping(BiasModel::GaussMarkov, dt)?;
    let (car, receiver) = (Trajectory::car(300.0, 1), GnssNoise::default());
    let log = simulate(&car, 1.0 / dt, Some(&noise), &receiver, 1)?;
    let mut navigator = (Setup::default().navigator(&model, dt)?).with_horizon(0.5);
    let mut fixes = log.gnss.iter().peekable();
    for sample in log.imu {
        navigator.imu(sample)?;
        if let Some(fix) = fixes.next_if(|fix| fix.time + 0.15 <= sample.time) {
            navigator.fix(*fix)?;
            let (time, speed) = (sample.time, navigator.filter().map(|f| f.nav().v_n.norm()));
            println!("{time:.2} s: [m/s] {speed:.2?} {:?}", navigator.events());
        }
    }
    Ok(())
}
