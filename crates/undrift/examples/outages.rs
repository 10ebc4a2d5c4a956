//! How far does the solution drift without GNSS, and which noise model holds it best?
//! `cargo run --release -p undrift --example outages -- DRIVE.toml [LENGTH [COUNT]]`
//!
//! The fixes of a drive are withheld for LENGTH seconds (10), COUNT times (10), and every model is compared
//! with the drive's truth or, without one, with the fixes withheld from it.

use std::error::Error;
use std::path::Path;
use undrift::navigate::Hindsight;
use undrift::reference::HORIZONTAL;
use undrift::{BiasModel, Drive, Logs, Schedule};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let file = arguments
        .get(1)
        .ok_or("usage: outages DRIVE.toml [LENGTH [COUNT]]")?;
    let length: f64 = arguments.get(2).map_or(Ok(10.0), |text| text.parse())?;
    let count: usize = arguments.get(3).map_or(Ok(10), |text| text.parse())?;

    // All of the logs is read once; every model runs on the same samples.
    let drive = Drive::load(Path::new(file), None)?;
    let logs = Logs::load(&drive, Hindsight::Causal)?;

    // The first cut comes when turns have separated the constants of the accelerometers from tilt.
    let start = 180.0;
    let cuts = logs.plan(&Schedule::Count { start, count }, length)?;

    let models = [
        BiasModel::White,       // no bias state at all
        BiasModel::GaussMarkov, // what a data sheet describes
        BiasModel::Arma,        // what was identified, in innovations form
    ];
    println!("largest horizontal error in each of {count} outages of {length} s [m]");
    println!(
        "{:14} {:>8} {:>8} {:>8}",
        "model", "median", "RMS", "maximum"
    );
    // As while driving: what has come so far is all that is known.
    let hindsight = Hindsight::Causal;
    for (name, outcome) in logs.run(&models, &cuts, hindsight, &|_samples| ())?.runs {
        // One model that fails stops none of the others.
        let errors = match outcome {
            Ok(run) => run.errors,
            Err(why) => {
                println!("{name:14} {why}");
                continue;
            }
        };
        let [median, rms, max] =
            [&errors.median, &errors.rms, &errors.max].map(|errors| errors.0[HORIZONTAL]);
        println!("{name:14} {median:8.2} {rms:8.2} {max:8.2}");
    }
    Ok(())
}
