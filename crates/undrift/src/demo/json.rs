//! The demo as JSON: what was identified, and what the outages did.

use super::{DURATION, Demo, PRESET, RATE_HZ, WHITE_CALIBRATED_NOTE};
use crate::{
    outages::Experiment,
    results::{Drive, Kind, with_head},
};
use serde_json::{Value, json};

impl Demo {
    /// The outages.
    pub fn experiment(&self) -> Experiment<'_> {
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
    }

    /// Everything as JSON.
    pub fn json(&self) -> Value {
        let identification = self
            .identified
            .as_ref()
            .map(|(_, found)| found.json(&format!("Simulated static record of {PRESET}")));
        with_head(
            Kind::Demo,
            json!({
                "seed": self.seed,
                "identification": identification,
                "outages": self.experiment().result(),
                "note": WHITE_CALIBRATED_NOTE,
            }),
        )
    }
}
