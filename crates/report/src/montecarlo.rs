//! The report of a Monte Carlo: whether the filter knows its own errors.

use super::{
    Axis, Block, Cell, Figure, Panel, Section, Series,
    parts::{count, error, model_colour, percent, short, span, table, text, warnings},
};
use undrift::results::{Group, MonteCarlo, MonteCarloModel, Number, Verdict};
use undrift::{
    consistency::{COMPONENT_NAMES, GROUP},
    series::Envelope,
};

/// A Monte Carlo with its name; the name of a single one is empty.
pub type Run<'a> = (String, &'a MonteCarlo);

/// NEES per degree of freedom that the plots reach over.
const RANGE: (f64, f64) = (0.1, 1e7);

/// One model of one run.
struct Model<'a> {
    name: String,
    /// Whether it is of the first run.
    first: bool,
    run: &'a MonteCarlo,
    model: &'a MonteCarloModel,
}

/// The sections.
pub fn sections(runs: &[Run<'_>]) -> Vec<Section> {
    let mut models = Vec::new();
    for (at, (name, run)) in runs.iter().enumerate() {
        for model in &run.models {
            let name = if name.is_empty() {
                model.name.clone()
            } else {
                format!("{name}: {}", model.name)
            };
            models.push(Model {
                name,
                first: at == 0,
                run,
                model,
            });
        }
    }
    let mut sections = vec![summary(runs, &models)];
    sections.extend(over_time(&models));
    sections.push(Section {
        title: "Shares and innovations".into(),
        blocks: [coverage(&models), innovations(&models)]
            .into_iter()
            .flatten()
            .collect(),
    });
    sections.retain(|section| !section.blocks.is_empty());
    sections
}

fn summary(runs: &[Run<'_>], models: &[Model<'_>]) -> Section {
    let diverged: Vec<String> = models
        .iter()
        .filter(|m| m.model.diverged > 0)
        .map(|m| {
            format!(
                "{}: {} of {} runs diverged",
                m.name, m.model.diverged, m.run.runs
            )
        })
        .collect();
    let mut blocks = Vec::from_iter(warnings(&diverged));
    for (name, run) in runs {
        let drive = &run.drive;
        let prefix = if name.is_empty() {
            String::new()
        } else {
            format!("{name}: ")
        };
        let what = if drive.duration_s.0.is_finite() {
            format!(
                "a simulated drive of {}, IMU at {} Hz, sensor errors of {} drawn as {}",
                span(drive.duration_s.0),
                short(drive.rate_hz.0),
                drive.model,
                drive.drawn_as
            )
        } else {
            "a simulated drive".into()
        };
        blocks.extend(text(&[format!(
            "{prefix}{} runs of {what}, seed {}. The first {} of navigation are left out of averages and shares.",
            run.runs,
            run.seed,
            span(run.settle_s.0)
        )]));
    }
    let verdicts: Vec<String> = models.iter().map(verdict).collect();
    blocks.extend(text(&verdicts));
    let mut nees = table(
        "nees",
        "Normalised estimation error squared: 1 per degree of freedom when the filter is right, more when it is optimistic; and the share of the epochs whose average over the runs is within its 95 % bounds.",
        &[
            "model",
            "states",
            "dof",
            "mean / dof",
            "inside",
            "above",
            "below",
            "verdict",
        ],
    );
    for model in models {
        for group in &model.model.nees {
            nees.rows.push(vec![
                model.name.clone().into(),
                group.name.clone().into(),
                count(group.freedom).into(),
                format!(
                    "{} ± {}",
                    short(group.mean_per_freedom.0),
                    error(group.mean_standard_error.0)
                )
                .into(),
                format!(
                    "{} ± {}",
                    percent(group.share_inside.0).trim_end_matches(" %"),
                    percent(group.share_standard_error.0)
                )
                .into(),
                percent(group.share_above.0).into(),
                percent(group.share_below.0).into(),
                marked(group.verdict),
            ]);
        }
    }
    if !nees.rows.is_empty() {
        blocks.push(Block::Table(nees));
    }
    Section {
        title: "Does the filter know its own errors?".into(),
        blocks,
    }
}

/// A verdict, standing out where it is a bad one.
fn marked(verdict: Option<Verdict>) -> Cell {
    let cell = Cell::from(verdict.map_or(String::new(), |v| v.to_string()));
    if verdict == Some(Verdict::Consistent) {
        cell
    } else {
        cell.strong()
    }
}

/// A model in a sentence.
fn verdict(model: &Model<'_>) -> String {
    let nees = &model.model.nees;
    let all = nees
        .iter()
        .find(|g| g.name == "all")
        .and_then(|g| g.verdict);
    if let Some(verdict) = all.filter(|_| nees.iter().all(|g| g.verdict == all)) {
        return format!("{} is {verdict} in every group of states.", model.name);
    }
    let parts: Vec<String> = Verdict::ALL
        .into_iter()
        .filter_map(|verdict| {
            let groups = nees.iter().filter(|g| g.verdict == Some(verdict));
            let names: Vec<&str> = groups.map(|g| g.name.as_str()).collect();
            (!names.is_empty()).then(|| format!("{verdict} in {}", names.join(", ")))
        })
        .collect();
    if parts.is_empty() {
        String::new()
    } else {
        format!("{} is {}.", model.name, parts.join("; "))
    }
}

/// NEES over time, a panel for each group of states.
fn over_time(models: &[Model<'_>]) -> Option<Section> {
    let panels: Vec<Panel> = GROUP
        .iter()
        .filter_map(|(name, ..)| {
            let with: Vec<(&Model<'_>, &Group)> = models
                .iter()
                .filter_map(|m| Some((m, m.model.nees.iter().find(|g| g.name == *name)?)))
                .filter(|(_, group)| !group.average.is_empty())
                .collect();
            let (first, group) = with.first()?;
            let curves: Vec<(&Model<'_>, Vec<(f64, f64)>)> = with
                .iter()
                .map(|(m, g)| (*m, per_freedom(m.run, &g.average, g.freedom)))
                .collect();
            let largest = curves
                .iter()
                .flat_map(|(_, c)| c)
                .map(|p| p.1)
                .fold(3.0, f64::max);
            let y = Axis::logarithmic("average NEES / dof")
                .within(RANGE.0..(1.3 * largest).min(RANGE.1));
            let mut panel = Panel::new(name, Axis::new("time [s]"), y);
            let started = first.run.time_s.first().map_or(0.0, |t| t.0);
            panel.shade(started, first.model.started_s.0 + first.run.settle_s.0);
            for (at, (m, points)) in curves.into_iter().enumerate().rev() {
                let colour = model_colour(&m.model.name, at);
                panel.add(if m.first {
                    Series::thin(&m.name, colour, points)
                } else {
                    Series::dashed(&m.name, colour, points)
                });
            }
            for bound in [&group.lower, &group.upper] {
                let points = per_freedom(first.run, bound, group.freedom);
                panel.add(Series::dashed("", 0, points));
            }
            Some(panel)
        })
        .collect();
    (!panels.is_empty()).then(|| Section {
        title: "Errors over time".into(),
        blocks: vec![Block::Figure(Figure {
            name: "nees".into(),
            caption: "Average over the runs of the normalised estimation error squared per degree of freedom, with its 95 % bounds (dashed); the settling is shaded.".into(),
            columns: 2,
            panels,
        })],
    })
}

fn per_freedom(run: &MonteCarlo, values: &[Number], freedom: u64) -> Vec<(f64, f64)> {
    let mut envelope = Envelope::default();
    for (time, value) in run.time_s.iter().zip(values) {
        if value.0.is_finite() && freedom > 0 {
            envelope.add(time.0, (value.0 / freedom as f64).clamp(RANGE.0, RANGE.1));
        }
    }
    envelope.points().collect()
}

/// Shares of the errors within their standard deviations.
fn coverage(models: &[Model<'_>]) -> Option<Block> {
    let mut shares = table(
        "coverage",
        "Share of the errors within one, two and three of the standard deviations that the filter states: 68.3, 95.4 and 99.7 % when it is right.",
        &["model", "component", "within 1σ", "within 2σ", "within 3σ"],
    );
    for model in models {
        for name in COMPONENT_NAMES {
            let Some(of) = model.model.coverage.get(name) else {
                continue;
            };
            let mut row: Vec<Cell> = vec![model.name.clone().into(), spoken(name).into()];
            row.extend((0..3).map(|i| Cell::from(percent(of.get(i).map_or(f64::NAN, |n| n.0)))));
            shares.rows.push(row);
        }
    }
    (!shares.rows.is_empty()).then_some(Block::Table(shares))
}

/// A component's name without its unit, which a share has not.
fn spoken(name: &str) -> String {
    let stem = name.rsplit_once('_').map_or(name, |(stem, _)| stem);
    match stem {
        "vn" => "velocity north".into(),
        "ve" => "velocity east".into(),
        "vd" => "velocity down".into(),
        other => other.replace("psi_", "misalignment ").replace('_', " "),
    }
}

fn innovations(models: &[Model<'_>]) -> Option<Block> {
    let mut rows = table(
        "nis",
        "Innovations of all runs: NIS per degree of freedom with the 95 % bounds of its average, the share above the 95 % point, and the largest autocorrelation at lags 1 to 10.",
        &[
            "model",
            "measurement",
            "updates",
            "NIS / dof",
            "95 % bounds",
            "above 95 %",
            "autocorrelation",
            "verdict",
        ],
    );
    for model in models {
        for kind in &model.model.nis {
            let all = kind.autocorrelation.iter().flatten();
            let largest = all.map(|r| r.0.abs()).fold(0.0, f64::max);
            rows.rows.push(vec![
                model.name.clone().into(),
                kind.name.clone().into(),
                count(kind.updates).into(),
                Cell::number(kind.nis_per_freedom.0, 4),
                format!("{:.4} … {:.4}", kind.bounds.0.0, kind.bounds.1.0).into(),
                percent(kind.share_above_95.0).into(),
                format!("{largest:.3} (±{:.3})", kind.autocorrelation_bound.0).into(),
                marked(kind.verdict),
            ]);
        }
    }
    (!rows.rows.is_empty()).then_some(Block::Table(rows))
}
