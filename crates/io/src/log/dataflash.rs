//! ArduPilot DataFlash, binary (`.BIN`) and text (`.log`): messages whose formats the log itself defines.
//! Their fields are those of ArduPilot's log messages; AP_Logger's documentation says how formats are written.
//!
//! * Inertial samples: `IMU` with gyro and accelerometer, by instance (`IMU0`; in older logs the messages IMU,
//!   IMU2, IMU3 are the instances 0, 1, 2); `RAW0` is GYR and ACC of one instance, the samples as the sensor
//!   gives them, the accelerometer at the gyro's times. All are forward-right-down.
//! * Fixes: `GPS0` is GPS with the accuracies of the GPA beside it. Status 3 (single), 4 (differential), 5
//!   (float) and 6 (fixed) are read. `HAcc` is taken for the standard deviation of north and of east each, `SAcc`
//!   for that of each component of the velocity. Heights are above mean sea level, above the ellipsoid where GPA has
//!   the undulation.
//!
//! * Magnetic fields: `MAG0` is MAG, in milligauss, with the offsets of the autopilot's calibration.
//!
//! Without a name, the first of these is taken: raw samples if none are lost, then IMU; lower instances first, but
//! none that has less than half as many messages as another.
//!
//! Times are GPS seconds of the week of the first fix: [`link`] ties the autopilot's clock to it. To find these
//! things, the file is read once more before. Without a fix, times are those of the autopilot's clock.

mod formats;
mod link;
mod messages;
mod reader;
mod survey;
#[cfg(test)]
mod tests;

use super::receiver::by_steps;
use crate::ReadError;
use crate::entry::{Entries, Stream, StreamKind, Wanted};
use crate::error::{NAMES_SHOWN, the_file_has};
use crate::source::{Again, Source};

use formats::MessageKind;
use messages::Messages;
use reader::Reader;
use survey::Survey;

/// Whether a file that starts so is a DataFlash log.
pub(crate) fn detect(start: &[u8]) -> bool {
    messages::is_binary(start) || messages::is_text(start)
}

pub(super) fn entries(source: Source, again: Again, wanted: &Wanted) -> Result<Entries, ReadError> {
    if let Wanted::Poses(_) = wanted {
        return Err(
            ReadError::nameless("DataFlash logs have no reference solution").key("truth.file"),
        );
    }
    let (name, kind, key) = wanted.one_stream()?;
    let survey = Survey::new(Messages::open(again()?)?);
    let found = match name {
        Some(name) => survey.named(name, kind),
        None => survey.usual(kind),
    };
    let (kind, instance) = found.ok_or_else(|| {
        let problem = match (name, kind) {
            (Some(name), _) => format!("no stream {name} of this kind"),
            (None, StreamKind::Imu) => "no IMU, nor GYR and ACC".to_owned(),
            (None, StreamKind::Fields) => "no MAG".to_owned(),
            (None, _) => "no GPS".to_owned(),
        };
        let streams = survey.streams();
        let names: Vec<&str> = streams.iter().map(|stream| stream.name.as_str()).collect();
        let error = ReadError::nameless(problem).key(key);
        error.mend(the_file_has(&names, NAMES_SHOWN))
    })?;
    let mut reader = Reader::new(Messages::open(source)?, kind, instance, survey.clock());
    Ok(by_steps(wanted, move |ready| {
        let more = reader.step(ready);
        Ok((more, reader.epoch()))
    }))
}

pub(super) fn streams(source: Source) -> Result<Vec<Stream>, ReadError> {
    Ok(Survey::new(Messages::open(source)?).streams())
}

/// A stream: the kind of its messages, the gyro's where there are two, and the instance.
type Which = (MessageKind, u8);
