//! Which stream of inertial samples a log is read from, where it has several.

use crate::drive::Logs;
use std::path::Path;
use undrift_io::{format::Format, imu::ImuFormat, imu::ImuReader, log::AND};
use undrift_nav::Vector3;
use undrift_results::inspect::{Known, Line, about_gravity};

/// Samples of each that are looked at.
const LOOKED_AT: usize = 2000;

/// What the beginning of a stream shows.
#[derive(Clone, Copy, Default)]
struct Beginning {
    /// Whether a gyro measures anything.
    turns: bool,
    /// Magnitude of the mean specific force [m/s²].
    force: f64,
}

/// The stream, of several: the first that measures gravity and turns; else the gyroscopes of one with the accelerometers
/// of another, where a log has them apart. `None` where neither is there.
pub(crate) fn choose(path: &Path, logs: &Logs, format: Format, names: &[String]) -> Option<Line> {
    let beginning = |name: &String| {
        let of_stream = ImuFormat::log(format, Some(name.clone()));
        let reader = logs.read(path, &of_stream).ok()?;
        Some((name.clone(), look(reader)))
    };
    let seen: Vec<_> = names.iter().filter_map(beginning).collect();
    let whole = |of: &Beginning| of.turns && about_gravity([0.0, 0.0, of.force]);
    let first = |fits: &dyn Fn(&Beginning) -> bool| {
        let found = seen.iter().find(|(_, beginning)| fits(beginning));
        found.map(|(name, _)| name.clone())
    };
    if let Some(name) = first(&whole) {
        let others = names.iter().filter(|other| **other != name);
        let known = Known::Measures(others.cloned().collect());
        return Some(Line::new("topic", name, known));
    }
    let gyro = first(&|of| of.turns && of.force == 0.0)?;
    let accel = first(&|of| !of.turns && of.force > 0.0)?;
    Some(Line::new("topic", gyro + AND + &accel, Known::Apart))
}

fn look(reader: ImuReader) -> Beginning {
    let mut beginning = Beginning::default();
    let (mut sum, mut count) = (Vector3::zeros(), 0.0);
    for sample in reader.take(LOOKED_AT).map_while(Result::ok) {
        beginning.turns |= sample.dtheta != Vector3::zeros();
        sum += sample.dvel / sample.dt;
        count += 1.0;
    }
    if count > 0.0 {
        beginning.force = sum.norm() / count;
    }
    beginning
}
