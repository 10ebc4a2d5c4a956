//! The demo as its result: what was identified, and what the outages did.

use super::{DURATION, Demo, PRESET, RATE_HZ, WHITE_CALIBRATED_NOTE};
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
                simulated: Some(format!("a car drive of {:.0} min", DURATION / 60.0)),
                imu: Some(PRESET.into()),
                gnss: Some("RTK-like receiver, 5 Hz".into()),
                rate_hz: RATE_HZ.into(),
                model: Some(
                    if identified {
                        "the identified one"
                    } else {
                        PRESET
                    }
                    .into(),
                ),
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

    /// Everything as a result.
    pub fn result(&self) -> results::Demo {
        let record = format!("Simulated static record of {PRESET}");
        let identified = self.identified.as_ref();
        results::Demo {
            undrift: VERSION.into(),
            schema: SCHEMA,
            seed: self.seed,
            identification: identified.map(|(_, found)| found.result(&record)),
            outages: self.outages(),
            note: WHITE_CALIBRATED_NOTE.into(),
        }
    }
}
