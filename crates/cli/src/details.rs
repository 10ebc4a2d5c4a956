//! What --verbose shows of the files that are read.

use crate::{drives::Source, terminal::detail};
use std::path::{Path, PathBuf};
use undrift::{
    drive::{Drive, ScalarLog},
    io::{
        Opened, gnss::GnssSource, imu::ImuSource, magnetic::MagneticSource, source::BytesRead,
        truth::TruthSource, visible,
    },
};

/// Size of a log [bytes]; 0 where it has none.
pub fn size(path: &Path) -> u64 {
    let size = |path: &PathBuf| std::fs::metadata(path).map_or(0, |about| about.len());
    Opened::files(path).iter().map(size).sum()
}

/// Shows a log that is open: its size, and the format detected.
pub fn opened(what: &str, log: &Opened) {
    let format = || format!("{} detected from its content", log.format().describe());
    described(what, log.name(), format);
}

fn described(what: &str, path: &Path, format: impl FnOnce() -> String) {
    detail(1, || {
        let megabytes = size(path) as f64 / 1e6;
        let name = path.display();
        format!("{what}: {name}, {megabytes:.3} MB, {}", format())
    });
}

/// Shows a drive: its files and settings.
pub fn drive(source: &Source) {
    let Source { file, drive, .. } = source;
    detail(1, || format!("drive: {}", file.display()));
    let is_table = matches!(drive.imu.1.source, ImuSource::Table { .. });
    log(drive, "IMU", Some(&drive.imu.0), is_table);
    let is_table = matches!(drive.gnss.1, GnssSource::Table(_));
    log(drive, "GNSS", Some(&drive.gnss.0), is_table);
    for sensor in ScalarLog::ALL {
        let path = drive.scalars[sensor].as_ref().map(|(path, _)| path);
        log(drive, sensor.name(), path, true);
    }
    let field = drive.magnetometer.as_ref();
    let is_table =
        field.is_some_and(|(_, field)| matches!(field.source, MagneticSource::Table { .. }));
    log(drive, "magnetometer", field.map(|(path, _)| path), is_table);
    let truth = drive.truth.as_ref();
    let is_table = truth.is_some_and(|(_, source)| matches!(source, TruthSource::Table(_)));
    log(drive, "truth", truth.map(|(path, _)| path), is_table);
    detail(1, || {
        let model = drive.model.as_ref().map_or("none", |model| &model.name);
        format!("noise model: {model}")
    });
    detail(1, || {
        let on = |switch| if switch { "on" } else { "off" };
        let arm = drive.lever_arm;
        let mounting = if drive.estimate_mounting {
            "to be estimated"
        } else {
            "as specified"
        };
        format!(
            "settings: lever arm {}, {}, {} m, gate {}, adapt {}, uses {}, mounting {mounting}",
            arm.x,
            arm.y,
            arm.z,
            on(drive.gating),
            on(drive.adapt),
            undrift::results::parts_used(drive.gnss_use),
        )
    });
    text_of(file, || source.text().unwrap_or_default());
}

/// Prints a file of settings unchanged.
#[cfg(not(target_family = "wasm"))]
pub fn text(file: &Path) {
    text_of(file, || std::fs::read_to_string(file).unwrap_or_default());
}

fn text_of(file: &Path, text: impl FnOnce() -> String) {
    detail(2, || {
        let text = text();
        let lines = text.lines().map(|line| format!("\n  {}", visible(line)));
        format!("{}:{}", file.display(), lines.collect::<String>())
    });
}

/// A table has its columns in the drive file; anything else describes itself.
fn log(drive: &Drive, what: &str, path: Option<&PathBuf>, is_table: bool) {
    let Some(path) = path else { return };
    if is_table {
        let by = "a table with the columns of the drive file";
        described(what, path, || by.into());
    } else if let Ok(log) = drive.logs.open(path, &BytesRead::default()) {
        opened(what, &log);
    }
}
