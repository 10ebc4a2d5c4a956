//! What must hold for whatever the readers give out, and the inputs as files.

pub mod logs;

use std::path::Path;

use undrift::io::ReadError;
use undrift::io::imu::{GapSummary, ImuReader};
use undrift::io::poses::LocalPose;
use undrift::io::skipped::Skipped;
use undrift::nav::earth::Geodetic;
use undrift::nav::sample::{GnssFix, ImuSample, MagneticField, Position, Scalar, TruthSample};
use undrift::nav::{Matrix3, Quaternion, Vector3};

/// Runs `read` with a file that holds `data`, in the folder for temporary files: `tools/fuzz` takes one
/// in memory. It is the same file for every input.
pub fn with_file(data: &[u8], read: impl FnOnce(&Path)) {
    let path = std::env::temp_dir().join(format!("undrift-fuzz-{}", std::process::id()));
    std::fs::write(&path, data).expect("a place for the input");
    read(&path);
}

/// Takes all records of a reader: their times are finite and go forward, `sound` holds for each, and
/// nothing follows an error.
pub fn exhaust<T: std::fmt::Debug>(
    reader: &mut impl Iterator<Item = Result<T, ReadError>>,
    time: impl Fn(&T) -> f64,
    sound: impl Fn(&T) -> bool,
) {
    let mut last = f64::NEG_INFINITY;
    while let Some(record) = reader.next() {
        match record {
            Ok(record) => {
                let time = time(&record);
                assert!(time.is_finite() && time > last, "{record:?} after {last} s");
                assert!(sound(&record), "{record:?}");
                last = time;
            }
            Err(error) => {
                assert!(!error.to_string().is_empty());
                assert!(reader.next().is_none(), "a record after the error {error}");
                return;
            }
        }
    }
    assert!(reader.next().is_none(), "a record after the end");
}

/// All samples of an inertial log, if it can be opened.
pub fn imu(reader: Result<ImuReader, ReadError>) {
    if let Ok(mut reader) = opened(reader) {
        exhaust(&mut reader, |sample| sample.time, imu_sample);
        check_counts(reader.skipped(), Some(reader.gaps()));
    }
}

/// What was opened; an error can be shown.
pub fn opened<T>(reader: Result<T, ReadError>) -> Result<T, ReadError> {
    reader.inspect_err(|error| assert!(!error.to_string().is_empty()))
}

/// Checks a reader's counts of skipped records and gaps.
pub fn check_counts(skipped: &Skipped, gaps: Option<GapSummary>) {
    let _ = skipped.to_string();
    if let Some(gaps) = gaps {
        assert!(gaps.nominal_interval.is_finite() && gaps.nominal_interval >= 0.0);
        assert!(
            gaps.longest
                .is_none_or(|gap| gap.start.is_finite() && gap.length > 0.0)
        );
    }
}

fn imu_sample(sample: &ImuSample) -> bool {
    sample.dt.is_finite() && sample.dt > 0.0 && finite(&sample.dtheta) && finite(&sample.dvel)
}

/// Whether a fix has finite numbers, a place on Earth, and covariances that are some.
pub fn fix(fix: &GnssFix) -> bool {
    let position = fix.position.is_none_or(|(position, covariance)| {
        let place = match position {
            Position::Geodetic(position) => place(&position),
            Position::Baseline { base, ned } => place(&base) && finite(&ned),
        };
        place && positive(&covariance)
    });
    let velocity = fix.velocity.is_none_or(|(v, p)| finite(&v) && positive(&p));
    let something = fix.position.is_some() || fix.velocity.is_some();
    position && velocity && something
}

/// Whether a reference sample has finite numbers and a place on Earth.
pub fn truth_sample(sample: &TruthSample) -> bool {
    place(&sample.position)
        && sample.v_n.is_none_or(|v| finite(&v))
        && sample.rpy.is_none_or(|rpy| finite(&rpy))
}

/// Whether a pose has finite numbers, something that can be used, a rotation, and covariances that are some.
pub fn local_pose(pose: &LocalPose) -> bool {
    let covariances = [pose.position_covariance, pose.attitude_covariance];
    // Some roundings of a root of a sum of squares.
    let unit = |q: &Quaternion| (q.norm() - 1.0).abs() < 1e-12;
    (pose.position.is_some() || pose.attitude.is_some())
        && pose.position.is_none_or(|position| finite(&position))
        && pose.attitude.iter().all(unit)
        && covariances.iter().flatten().all(positive)
}

/// Whether a number is finite and has a standard deviation.
pub fn scalar(scalar: &Scalar) -> bool {
    scalar.value.is_finite() && scalar.std.is_finite() && scalar.std > 0.0
}

/// Whether a magnetic field is finite and has a standard deviation.
pub fn field(reading: &MagneticField) -> bool {
    reading.is_finite() && reading.std > 0.0
}

fn finite(v: &Vector3) -> bool {
    v.iter().all(|x| x.is_finite())
}

fn place(place: &Geodetic) -> bool {
    let on_earth =
        place.lat.abs() <= std::f64::consts::FRAC_PI_2 && place.lon.abs() <= std::f64::consts::TAU;
    on_earth && place.height.is_finite()
}

fn positive(covariance: &Matrix3) -> bool {
    covariance.iter().all(|x| x.is_finite()) && covariance.cholesky().is_some()
}
