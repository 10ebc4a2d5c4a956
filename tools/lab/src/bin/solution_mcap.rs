//! Writes a solution of three rows as MCAP, counts its messages with crate `mcap`, for testdata/golden/formats/mcap/check.py:
//! `cargo run -p undrift-lab --bin solution_mcap -- FILE`.

use std::path::Path;

use undrift_io::epoch::{ClockSource, Epoch};
use undrift_io::write::PendingFile;
use undrift_io::write::mcap::McapWriter;
use undrift_io::write::solution::SolutionRow;
use undrift_nav::Vector3;
use undrift_nav::earth::Geodetic;

fn main() -> std::io::Result<()> {
    let path = std::env::args()
        .nth(1)
        .unwrap_or("solution.mcap".to_owned());
    let mut writer = McapWriter::new(
        PendingFile::create(Path::new(&path))?,
        Epoch::of_unix(1_752_003_240.25, 0.0, ClockSource::Gnss),
    )?;
    for k in 0..3 {
        let t = f64::from(k);
        writer.write(&SolutionRow {
            time: 0.5 * t,
            position: Geodetic::from_degrees(48.0 + 0.25 * t, 11.5 - 0.5 * t, 560.25 + t),
            v_n: Vector3::new(3.0, 4.0 * t, 0.5),
            rpy: Vector3::new(0.1, -0.2 * t, 2.5 + t),
            nav_std: [1.0, 2.0, 3.0, 0.1, 0.2, 0.3, 0.01, 0.02, 0.03],
            gyro_error: Vector3::zeros(),
            accel_error: Vector3::zeros(),
            error_std: [0.0; 6],
        })?;
    }
    writer.into_inner()?.finish()?;
    let file = std::fs::read(&path)?;
    let messages = mcap::MessageStream::new(&file).map_err(std::io::Error::other)?;
    println!("{path}: {} messages", messages.count());
    Ok(())
}
