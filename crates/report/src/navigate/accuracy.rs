//! Errors of a solution against the truth, in the bounds that the filter states.

use super::{
    ATTITUDE, POSITION, VELOCITY,
    panels::{Shown, component_panel},
};
use crate::{
    Block, Figure, Section, Table,
    numbers::{count, get, short},
    parts::{COMPONENTS, Run, named, text},
};
use undrift_results::{Navigate, Numbers};

/// NEES per degree of freedom along a run, whose samples are correlated, from which the filter is said to
/// be optimistic, or slightly so.
const OPTIMISTIC: f64 = 2.0;
const SLIGHTLY: f64 = 1.2;

/// Errors against the truth: root mean squares, NEES, and the errors over time in their bounds.
pub(super) fn accuracy(runs: &[Run<'_, Navigate>], shown: &Shown<'_>) -> Option<Section> {
    let compared: Vec<(&str, &Navigate, &Numbers)> = runs
        .iter()
        .filter_map(|(name, run)| Some((name.as_str(), *run, run.rms_error.as_ref()?)))
        .collect();
    if compared.is_empty() {
        return None;
    }
    let sentences = compared.iter().map(|(name, run, rms)| {
        let sentence = format!(
            "The RMS horizontal position error is {} m over {} samples.",
            short(get(rms, "horizontal_m")),
            count(run.compared_samples.unwrap_or(0))
        );
        text([named(name, &sentence), nees(run)])
    });
    let mut errors = Table::from_rows(
        "rms-errors",
        "RMS error against the truth over all samples with a truth.",
        &compared,
        &[(if runs.len() == 1 { "" } else { "run" }, &|(name, ..)| {
            let name = Some(*name).filter(|name| !name.is_empty());
            name.unwrap_or("RMS").into()
        })],
    );
    for (component, head) in COMPONENTS {
        let values = compared.iter().map(|(.., rms)| get(rms, component));
        errors.add_ranked(head.into(), &values.collect::<Vec<f64>>());
    }
    let figure = |(part, components): (&str, _)| {
        let components: [super::Component; 3] = components;
        let mut caption = format!("{part} error against the truth");
        let mut bounds = None;
        if let [(_, single)] = shown.series.as_slice() {
            caption += ", with the ±3σ reported by the filter (band); the scale fits the values after settling";
            bounds = Some(&single.std);
        }
        let panels = components.iter().filter_map(|c| {
            let bounds = bounds.and_then(|bounds| bounds.get(c.0));
            component_panel(c, "error", shown, |s| &s.error, bounds)
        });
        let name = format!("error-{}", part.to_lowercase());
        Figure::block(&name, &shown.caption(&caption), 3, panels)
    };
    let figures = [
        ("Position", POSITION),
        ("Velocity", VELOCITY),
        ("Attitude", ATTITUDE),
    ];
    let blocks = sentences.chain([Some(Block::Table(errors))]);
    let blocks = blocks.chain(figures.into_iter().map(figure));
    let rms = compared.iter().map(|(.., rms)| get(rms, "horizontal_m"));
    let rms = Vec::from_iter(rms.map(short)).join(", ");
    let section = Section::new("Errors against the truth", blocks.flatten())?;
    Some(section.noted(format!("{rms} m horizontal, RMS")))
}

/// What the NEES says, group by group.
fn nees(run: &Navigate) -> String {
    let groups = ["position", "velocity", "attitude"].map(|g| (g, get(&run.nees_per_dof, g)));
    let known = groups.iter().filter(|(_, nees)| nees.is_finite());
    let known = known.map(|(group, nees)| format!("{group} {}", short(*nees)));
    let known: Vec<String> = known.collect();
    if known.is_empty() {
        return String::new();
    }
    let beyond = |limit: f64| {
        let beyond = groups.iter().filter(|(_, nees)| *nees > limit);
        Vec::from_iter(beyond.map(|(group, _)| *group)).join(", ")
    };
    let verdict = match (beyond(OPTIMISTIC), beyond(SLIGHTLY)) {
        (over, _) if !over.is_empty() => format!("the filter is optimistic in {over}"),
        (_, over) if !over.is_empty() => {
            format!("the errors in {over} are slightly larger than the filter reports")
        }
        _ => "the errors are no larger than the filter reports".into(),
    };
    format!(
        "NEES per degree of freedom (1 if the covariance is correct): {}; {verdict}.",
        known.join(", ")
    )
}
