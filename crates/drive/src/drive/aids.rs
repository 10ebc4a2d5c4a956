//! The logs that aid a drive, in order of time.

use super::ScalarLog;
use crate::replay::{Measurement, merge};
use undrift_io::{
    ReadError, gnss::GnssReader, imu::GapSummary, scalar::ScalarReader, skipped::Skipped,
};

/// The logs that aid a drive, opened by [`Drive::open_aids`](super::Drive::open_aids).
pub struct Aids {
    /// Reader of the fixes.
    pub gnss: GnssReader,
    /// Readers of the logs of one number, those that there are.
    pub scalars: Vec<(ScalarLog, ScalarReader)>,
}

impl Aids {
    /// Fixes and all other measurements in order of time.
    pub fn measurements(&mut self) -> impl Iterator<Item = Result<Measurement, ReadError>> {
        merge(
            self.gnss.by_ref().map(|fix| fix.map(Measurement::Gnss)),
            scalars(&mut self.scalars),
        )
    }

    /// Skipped records and gaps of each log of one number, as far as it was read.
    pub fn scalars_read(&self) -> Vec<(ScalarLog, Skipped, GapSummary)> {
        let logs = self.scalars.iter();
        logs.map(|(log, reader)| (*log, reader.skipped().clone(), reader.gaps()))
            .collect()
    }
}

/// Measurements of these logs merged in order of time; of one time in the order of the logs.
pub fn scalars(
    logs: &mut [(ScalarLog, ScalarReader)],
) -> Box<dyn Iterator<Item = Result<Measurement, ReadError>> + '_> {
    let mut merged: Box<dyn Iterator<Item = _> + '_> = Box::new(std::iter::empty());
    for (log, reader) in logs.iter_mut().rev() {
        let of_one = reader.map(|scalar| scalar.map(|scalar| Measurement::of(*log, scalar)));
        merged = Box::new(merge(of_one, merged));
    }
    merged
}
