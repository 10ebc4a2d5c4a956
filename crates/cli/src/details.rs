//! What --verbose tells of what is read.

use crate::terminal::detail;
use std::path::Path;
use undrift::{
    drive::Drive,
    io::{Opened, gnss::GnssSource, imu::ImuSource, source::BytesRead, truth::TruthSource},
};

/// Size of a file [bytes]; 0 where it has none.
pub fn size(path: &Path) -> u64 {
    std::fs::metadata(path).map_or(0, |about| about.len())
}

/// Tells of a log that is open: its size, and the format by its content.
pub fn opened(what: &str, log: &Opened) {
    detail(1, || {
        let format = format!("{} by its content", log.format().describe());
        described(what, log.name(), &format)
    });
}

fn described(what: &str, path: &Path, format: &str) -> String {
    let megabytes = size(path) as f64 / 1e6;
    format!("{what}: {}, {megabytes:.3} MB, {format}", path.display())
}

/// Tells of a drive: its files, and what is made of them.
pub fn drive(file: &Path, drive: &Drive) {
    detail(1, || format!("drive: {}", file.display()));
    log(
        drive,
        "IMU",
        &drive.imu.0,
        matches!(drive.imu.1.source, ImuSource::Table { .. }),
    );
    log(
        drive,
        "GNSS",
        &drive.gnss.0,
        matches!(drive.gnss.1, GnssSource::Table(_)),
    );
    for (what, scalar) in [
        ("odometer", &drive.odometer),
        ("barometer", &drive.barometer),
    ] {
        if let Some((path, _)) = scalar {
            log(drive, what, path, true);
        }
    }
    if let Some((path, source)) = &drive.truth {
        log(
            drive,
            "truth",
            path,
            matches!(source, TruthSource::Table(_)),
        );
    }
    detail(1, || {
        let model = drive.model.as_ref().map_or("none", |model| &model.name);
        format!("noise model: {model}")
    });
    detail(1, || {
        let on = |switch| if switch { "on" } else { "off" };
        let arm = drive.lever_arm;
        format!(
            "settings: lever arm {}, {}, {} m, gate {}, adapt {}, uses {:?}, mounting {}",
            arm.x,
            arm.y,
            arm.z,
            on(drive.gating),
            on(drive.adapt),
            drive.gnss_use,
            if drive.estimate_mounting {
                "to be estimated"
            } else {
                "as stated"
            }
        )
    });
    detail(2, || format!("{drive:#?}"));
}

/// A table is one because its columns are named; anything else tells itself what it is.
fn log(drive: &Drive, what: &str, path: &Path, is_table: bool) {
    if is_table {
        detail(1, || {
            described(
                what,
                path,
                "a table by the columns that the drive file names",
            )
        });
    } else if let Ok(log) = drive.logs.open(path, &BytesRead::default()) {
        opened(what, &log);
    }
}
