//! A static recording to a model file:
//! `cargo run --release -p undrift --example identify -- RECORD RATE_HZ [DATA_SHEET] > imu.toml`
//!
//! Columns and units are those of the header (`gx_dps`, `ax_g`, …); a column named `t_s` gives the rate too,
//! and contradicts a wrong one. DATA_SHEET is a preset or a model file.

use std::error::Error;
use std::path::Path;
use undrift::identify::{self, Settings};
use undrift::io::Opened;
use undrift::noise::model_file;
use undrift::record::{self, RecordFormat};
use undrift::{Identified, ImuModel};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, rate_hz, data_sheet @ ..] = &arguments[..] else {
        return Err("usage: identify RECORD RATE_HZ [DATA_SHEET]".into());
    };

    // SI units from here on: rad/s and m/s².
    let record = record::read(Opened::open(Path::new(file))?, &RecordFormat::default())?;
    let settings = Settings {
        rate_hz: Some(rate_hz.parse()?),
        ..Settings::default()
    };
    let recordings = [identify::prepare(record, &settings)?];

    // Each axis is tested for rest, outliers, stationarity and whiteness; candidates are fitted on its first half.
    let found: Identified = identify::recordings(&recordings, &settings, || ())?;

    for (name, axis) in &found.axes {
        match axis {
            // The drift that each candidate leaves on the second half decides, not a likelihood.
            Ok(axis) => {
                let reason = model_file::reason(&axis.reason);
                eprintln!("{name}: {}. {reason}", axis.recommended().name);
                for score in &axis.recommended().score {
                    eprintln!("  after {} s: {:.3e}", score.horizon_s, score.rms);
                }
            }
            Err(why) => eprintln!("{name}: {why}"),
        }
    }

    // One record shows one turn-on constant; how it scatters is the data sheet's to say.
    let base = match data_sheet {
        [name, ..] => Some(ImuModel::resolve(name, Path::new(""))?),
        [] => None,
    };
    for axis in found.without_turn_on(base.as_ref()) {
        eprintln!(
            "{axis}: no data sheet for the turn-on constant, taken as large as the record allows"
        );
    }
    let provenance = identify::provenance(&recordings, "example", found.rate_hz)?;
    let model = found.model(base.as_ref(), "example", provenance)?;
    print!("{}", model.to_toml());
    Ok(())
}
