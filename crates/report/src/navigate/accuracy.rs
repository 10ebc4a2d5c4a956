//! Errors of a solution against the truth, in the bounds that the filter states.

use super::{
    ATTITUDE, POSITION, Run, VELOCITY, figure, panels::component_panel, section, with_gaps,
};
use crate::{
    Block, Cell, Section,
    parts::{Clock, cell, count, get, mark_least, named, short, table, text},
};
use undrift::reference::COMPONENTS;
use undrift::results::{Navigate, NavigateSeries};

/// NEES per degree of freedom along a run, whose samples are correlated, from which the filter is said to
/// be optimistic, or slightly so.
const OPTIMISTIC: f64 = 2.0;
const SLIGHTLY: f64 = 1.2;

/// Errors against the truth: root mean squares, NEES, and the errors over time in their bounds.
pub(super) fn accuracy(
    runs: &[Run<'_>],
    series: &[(&str, &NavigateSeries)],
    clock: Clock,
) -> Option<Section> {
    let compared: Vec<&Run<'_>> = runs.iter().filter(|(_, r)| r.rms_error.is_some()).collect();
    if compared.is_empty() {
        return None;
    }
    let mut blocks = Vec::new();
    let mut head = vec![
        "run",
        "N [m]",
        "E [m]",
        "D [m]",
        "horizontal [m]",
        "vN [m/s]",
        "vE [m/s]",
        "vD [m/s]",
        "roll [°]",
        "pitch [°]",
        "yaw [°]",
    ];
    if runs.len() == 1 {
        head[0] = "";
    }
    let mut errors = table(
        "rms-errors",
        "Root mean square error against the truth over all samples that have one.",
        &head,
    );
    for (name, run) in compared.iter().copied() {
        let Some(rms) = &run.rms_error else { continue };
        let first = if name.is_empty() {
            "RMS"
        } else {
            name.as_str()
        };
        let mut row: Vec<Cell> = vec![first.into()];
        row.extend(COMPONENTS.iter().map(|c| cell(get(rms, c))));
        errors.rows.push(row);
        let said = format!(
            "The horizontal position is {} m off the truth in the root mean square over {} samples.",
            short(get(rms, "horizontal_m")),
            count(run.compared_samples.unwrap_or(0))
        );
        blocks.extend(text(&[named(name, &said), nees(run)]));
    }
    if compared.len() > 1 {
        for (at, component) in COMPONENTS.iter().enumerate() {
            let values = compared
                .iter()
                .filter_map(|(_, run)| run.rms_error.as_ref());
            let values: Vec<f64> = values.map(|rms| get(rms, component)).collect();
            mark_least(&mut errors, at + 1, &values);
        }
    }
    blocks.push(Block::Table(errors));
    for (name, caption, components) in [
        (
            "error-position",
            "Position error against the truth",
            POSITION,
        ),
        (
            "error-velocity",
            "Velocity error against the truth",
            VELOCITY,
        ),
        (
            "error-attitude",
            "Attitude error against the truth",
            ATTITUDE,
        ),
    ] {
        let single = series.len() == 1;
        let caption = if single {
            format!(
                "{caption}, and three standard deviations to either side as the filter states them (band); the scale is that after settling"
            )
        } else {
            caption.to_owned()
        };
        let caption = with_gaps(&caption, series);
        let panels = components
            .iter()
            .filter_map(|c| {
                let bounds = single.then(|| series.first().and_then(|(_, s)| s.std.get(c.0)));
                component_panel(c, "error", series, clock, |s| &s.error, bounds.flatten())
            })
            .collect();
        blocks.extend(figure(name, &caption, 3, panels));
    }
    section("Errors against the truth", blocks)
}

/// What the NEES says, group by group.
fn nees(run: &Navigate) -> String {
    let groups: Vec<String> = ["position", "velocity", "attitude"]
        .iter()
        .filter_map(|group| {
            let value = get(&run.nees_per_dof, group);
            value
                .is_finite()
                .then(|| format!("{group} {}", short(value)))
        })
        .collect();
    if groups.is_empty() {
        return String::new();
    }
    let beyond = |limit: f64| -> Vec<&str> {
        let all = ["position", "velocity", "attitude"].into_iter();
        all.filter(|group| get(&run.nees_per_dof, group) > limit)
            .collect()
    };
    let (over, slightly) = (beyond(OPTIMISTIC), beyond(SLIGHTLY));
    let verdict = if !over.is_empty() {
        format!("the filter is optimistic in {}", over.join(", "))
    } else if !slightly.is_empty() {
        format!(
            "the errors are a little larger than the filter says in {}",
            slightly.join(", ")
        )
    } else {
        "the errors are no larger than the filter says".to_owned()
    };
    format!(
        "NEES per degree of freedom, 1 when the covariance is right: {}; {verdict}.",
        groups.join(", ")
    )
}
