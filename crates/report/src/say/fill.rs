//! Results with their sentences.

use super::{alignment, all, found, mounting, say};
use undrift::{
    demo::{self, Demo},
    fleet::FleetOutcome,
    navigate::Report,
    noise::BiasModel,
    results,
};

/// A navigated drive as a result; `drive` is what was navigated.
pub fn navigated(report: &Report, kind: BiasModel, drive: results::Drive) -> results::Navigate {
    let mut result = report.result(kind, drive);
    result.warnings = all(&result.findings);
    let ahead = report.mounting.as_ref().map(mounting);
    result.mounting = found(&report.summary.mountings).or(ahead);
    let start = report.summary.alignment.as_ref();
    result.summary.alignment = start.map_or(String::new(), alignment);
    result
}

/// An experiment with outages.
pub fn cut(mut result: results::Outages) -> results::Outages {
    result.warnings = all(&result.findings);
    for errors in result.models.values_mut() {
        errors.warning = errors.finding.as_ref().map(say);
    }
    result
}

/// The demo as a result.
pub fn demo(demo: &Demo) -> results::Demo {
    let mut result = demo.result();
    result.identification.record = match result.recorded {
        true => demo.record.name.display().to_string(),
        false => format!("Simulated static recording of {}", demo::PRESET),
    };
    result.conclusion = crate::demo::conclusion(&result);
    result
}

/// The outcome of a log of a fleet.
pub fn outcome(outcome: &mut FleetOutcome) {
    outcome.warnings.splice(0..0, all(&outcome.findings));
    for row in &mut outcome.rows {
        row.note = row.finding.as_ref().map(say).or(row.note.take());
    }
}
