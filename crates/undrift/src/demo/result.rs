//! The demo as its result: what was identified, and what the outages did.

use super::{Demo, PRESET, RATE_HZ};
use crate::{
    outages::Experiment,
    results::{self, Drive, SCHEMA, VERSION},
};

impl Demo {
    /// What the outages did.
    pub fn outages(&self) -> results::Outages {
        let identified = self.identified.is_some();
        Experiment {
            drive: Drive {
                imu: Some(PRESET.into()),
                rate_hz: RATE_HZ.into(),
                model: (!identified).then(|| PRESET.into()),
                ..Drive::default()
            },
            outages: &self.outages,
            results: &self.runs,
            reference: "truth",
            track: &self.simulation.truth,
            smooth: false,
            findings: Vec::new(),
        }
        .result()
    }

    /// Everything as a result but for its sentences.
    pub fn result(&self) -> results::Demo {
        let identified = self.identified.as_ref();
        results::Demo {
            undrift: VERSION.into(),
            schema: SCHEMA,
            seed: self.seed,
            identification: identified.map(|(_, found)| found.result(PRESET)),
            outages: self.outages(),
            note: String::new(),
        }
    }
}
