//! Magnetic fields: to an alignment that goes on, and to the solution.

use super::Run;
use undrift_nav::sample::{ImuSample, MagneticField};

impl Run {
    /// A reading within the present sample. The filter is not moved: what the body turns by until then is taken back.
    pub(super) fn magnetometer(&mut self, reading: &MagneticField, sample: &ImuSample) {
        let field = match &self.search {
            Some(search) => search.turned(&reading.field),
            None => reading.field,
        };
        let reading = &MagneticField { field, ..*reading };
        if self.solution.is_none() || self.alignment.again {
            self.alignment.aligner.magnetometer(reading, sample);
        }
        if let Some(solution) = &mut self.solution
            && !solution.in_long_gap()
        {
            let filter = &mut *solution.filter;
            self.compass
                .update(filter, reading, &self.settings, &mut self.summary);
        }
    }
}
