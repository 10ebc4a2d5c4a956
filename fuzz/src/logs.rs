//! Logs that say themselves what they hold: all that can be read of one.

use std::path::Path;

use undrift::io::Opened;
use undrift::io::format::Format;
use undrift::io::gnss::{FixOptions, GnssLog, GnssReader};
use undrift::io::imu::{ImuFormat, ImuReader};
use undrift::io::log::StreamKind;
use undrift::io::magnetic::{MagneticFormat, MagneticReader, MagneticSource};
use undrift::io::poses::{PoseLog, PoseReader};
use undrift::io::scalar::{Reading, ScalarFormat, ScalarReader};
use undrift::io::truth::{TruthLog, TruthReader};

use crate::{
    check_counts, exhaust, field, fix, imu, local_pose, opened, scalar, truth_sample, with_file,
};

/// Streams that are read by their names: a file can list thousands.
const STREAMS: usize = 4;

/// Reads everything of a log of the format.
pub fn log(format: Format, data: &[u8]) {
    with_file(data, |path| {
        let streams =
            opened(Opened::open(path).and_then(|log| log.streams(format))).unwrap_or_default();
        imu(ImuReader::open(path, &ImuFormat::log(format, None)));
        fixes(path, &GnssLog::new(format));
        fixes(path, &with_stds(GnssLog::new(format)));
        truth(path, format, None);
        local(path, format, None);
        headings(path, format, None);
        fields(path, format, None);
        for stream in streams.into_iter().take(STREAMS) {
            let name = Some(stream.name);
            match stream.kind {
                StreamKind::Imu => imu(ImuReader::open(path, &ImuFormat::log(format, name))),
                StreamKind::Poses => truth(path, format, name),
                StreamKind::LocalPoses => local(path, format, name),
                StreamKind::Fixes => fixes(
                    path,
                    &with_stds(GnssLog {
                        position: name,
                        ..GnssLog::new(format)
                    }),
                ),
                StreamKind::Velocity | StreamKind::Observations => fixes(
                    path,
                    &with_stds(GnssLog {
                        velocity: name,
                        ..GnssLog::new(format)
                    }),
                ),
                StreamKind::Headings => headings(path, format, name),
                StreamKind::Fields => fields(path, format, name),
                StreamKind::Other => {}
            }
        }
    });
}

fn with_stds(log: GnssLog) -> GnssLog {
    GnssLog {
        fixes: FixOptions {
            position_std: Some([1.0, 1.0, 2.0]),
            velocity_std: Some([0.1, 0.1, 0.2]),
            ..log.fixes
        },
        ..log
    }
}

fn fixes(path: &Path, log: &GnssLog) {
    gnss(GnssReader::open(path, &log.clone().into()));
}

fn fields(path: &Path, log: Format, name: Option<String>) {
    let options = MagneticFormat::new(MagneticSource::Log(log, name), 1e-6);
    if let Ok(mut reader) = opened(MagneticReader::open(path, &options)) {
        exhaust(&mut reader, |reading| reading.time, field);
        check_counts(reader.skipped(), None);
    }
}

fn headings(path: &Path, log: Format, name: Option<String>) {
    let turn = std::f64::consts::TAU;
    let options = ScalarFormat {
        reading: Reading::Log(log, name),
        ..ScalarFormat::headings(log, 0.01, (-turn, turn))
    };
    if let Ok(mut reader) = opened(ScalarReader::open(path, &options)) {
        exhaust(&mut reader, |heading| heading.time, scalar);
        check_counts(reader.skipped(), None);
    }
}

/// All fixes of a log, if it can be opened.
pub fn gnss(reader: Result<GnssReader, undrift::io::ReadError>) {
    if let Ok(mut reader) = opened(reader) {
        exhaust(&mut reader, |fix| fix.time, fix);
        check_counts(reader.skipped(), None);
    }
}

fn truth(path: &Path, format: Format, stream: Option<String>) {
    let log = TruthLog {
        format,
        stream,
        time_offset: 0.0,
        span: None,
    };
    poses(TruthReader::open(path, &log.into()));
}

/// All samples of a reference, if it can be opened.
pub fn poses(reader: Result<TruthReader, undrift::io::ReadError>) {
    if let Ok(mut reader) = opened(reader) {
        exhaust(&mut reader, |sample| sample.time, truth_sample);
        check_counts(reader.skipped(), None);
    }
}

fn local(path: &Path, format: Format, stream: Option<String>) {
    let log = PoseLog {
        stream,
        ..PoseLog::new(format)
    };
    local_poses(PoseReader::open(path, &log.into()));
}

/// All poses of a log in a local frame, if it can be opened.
pub fn local_poses(reader: Result<PoseReader, undrift::io::ReadError>) {
    if let Ok(mut reader) = opened(reader) {
        exhaust(&mut reader, |pose| pose.time, local_pose);
        check_counts(reader.skipped(), None);
    }
}
