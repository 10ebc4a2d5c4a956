//! The demo as its result: what was identified, and what the outages did.

use super::{Demo, PRESET, RATE_HZ};
use crate::{
    outages,
    results::{self, Drive, SCHEMA, VERSION},
};

impl Demo {
    /// What the outages did.
    pub fn outages(&self) -> results::Outages {
        results::Outages {
            drive: Drive {
                imu: Some(PRESET.into()),
                rate_hz: RATE_HZ.into(),
                model: self.identified.is_none().then(|| PRESET.into()),
                ..Drive::default()
            },
            reference: "truth".into(),
            ..outages::result(&self.outages, &self.runs, &self.simulation.truth)
        }
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
