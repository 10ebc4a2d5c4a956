//! The report of a Monte Carlo: whether the filter knows its own errors.

use super::{
    Block, Cell, Figure, Panel, PlotAxis, Section, Series, Table,
    numbers::{error, percent, short, span},
    parts::{Run, model_colour, prefixed, text, warnings},
    plain::{self, Mark},
};
use undrift_results::{Group, MonteCarlo, MonteCarloModel, Number, Verdict};
use undrift_results::{
    Usability,
    error_state::{COMPONENT_NAMES, GROUP},
    series::Envelope,
};

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

fn models<'a>(runs: &[Run<'a, MonteCarlo>]) -> Vec<Model<'a>> {
    let of_run = |(at, (name, run)): (usize, &Run<'a, MonteCarlo>)| {
        let run = *run;
        let model = |model: &'a MonteCarloModel| Model {
            name: prefixed(name, &model.name),
            first: at == 0,
            run,
            model,
        };
        run.models.iter().map(model).collect::<Vec<_>>()
    };
    runs.iter().enumerate().flat_map(of_run).collect()
}

/// The sections.
pub fn sections(runs: &[Run<'_, MonteCarlo>]) -> Vec<Section> {
    let models = models(runs);
    let tables = [coverage(&models), innovations(&models)];
    let shares = tables.into_iter().filter_map(Table::block);
    let sections = [
        summary(runs, &models),
        over_time(&models),
        Section::new("Shares and innovations", shares),
    ];
    sections.into_iter().flatten().collect()
}

/// The same for a terminal.
pub fn plain(run: &MonteCarlo, mark: Mark) -> String {
    let models = models(&[(String::new(), run)]);
    let verdicts = models.iter().map(|model| {
        let diverged = diverged(model).map(|diverged| format!("; {diverged}"));
        let (name, diverged) = (&model.name, diverged.unwrap_or_default());
        format!("{name}: {}{diverged}.", verdict(model))
    });
    let blocks = [
        text([what_was_done(run)]),
        nees(&models).captioned(""),
        innovations(&models).captioned(""),
        coverage(&models).captioned(""),
        text([Vec::from_iter(verdicts).join("\n")]),
    ];
    plain::plain(blocks, mark)
}

fn diverged(model: &Model<'_>) -> Option<String> {
    let (n, of) = (model.model.diverged, model.run.runs);
    (n > 0).then(|| format!("{n} of {of} runs diverged"))
}

fn what_was_done(run: &MonteCarlo) -> String {
    let drive = &run.drive;
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
    format!(
        "{} runs of {what}, seed {}. Averages and shares exclude the first {} of navigation.",
        run.runs,
        run.seed,
        span(run.settle_s.0)
    )
}

fn summary(runs: &[Run<'_, MonteCarlo>], models: &[Model<'_>]) -> Option<Section> {
    let diverged = models
        .iter()
        .filter_map(|m| Some(prefixed(&m.name, &diverged(m)?)));
    let diverged: Vec<String> = diverged.collect();
    let done = runs
        .iter()
        .map(|(name, run)| text([prefixed(name, &what_was_done(run))]));
    let verdicts = models.iter().map(|model| match verdict(model).as_str() {
        "" => None,
        verdict => Some(Block::Verdict(
            usability(model),
            format!("{} is {verdict}.", model.name),
        )),
    });
    let blocks = verdicts.chain([warnings(&diverged)]).chain(done);
    let blocks = blocks.chain([nees(models).block()]);
    Section::new("Normalised estimation errors (NEES)", blocks.flatten())
}

fn nees(models: &[Model<'_>]) -> Table {
    let groups = models
        .iter()
        .flat_map(|m| m.model.nees.iter().map(move |g| (m, g)));
    Table::from_rows(
        "nees",
        "Normalised estimation error squared per degree of freedom: 1 if the filter is consistent, more if it is optimistic; and the share of epochs whose average over the runs is within its 95 % bounds.",
        groups,
        &[
            ("model", &|(m, _)| (&m.name).into()),
            ("states", &|(_, g)| (&g.name).into()),
            ("dof", &|(_, g)| g.freedom.into()),
            ("mean / dof", &|(_, g)| {
                let (mean, std) = (g.mean_per_freedom.0, g.mean_standard_error.0);
                format!("{} ± {}", short(mean), error(std)).into()
            }),
            ("inside", &|(_, g)| {
                let (share, std) = (percent(g.share_inside), percent(g.share_standard_error));
                format!("{} ± {std}", share.trim_end_matches(" %")).into()
            }),
            ("above", &|(_, g)| percent(g.share_above).into()),
            ("below", &|(_, g)| percent(g.share_below).into()),
            ("verdict", &|(_, g)| marked(g.verdict)),
        ],
    )
}

/// A verdict, standing out where it is a bad one.
fn marked(verdict: Option<Verdict>) -> Cell {
    let cell = Cell::from(verdict.map_or(String::new(), |v| v.to_string()));
    cell.strong_if(verdict != Some(Verdict::Consistent))
}

/// A model that is not consistent in every group of states is one to look at.
fn usability(model: &Model<'_>) -> Usability {
    let consistent = |of: &Group| of.verdict == Some(Verdict::Consistent);
    match model.model.nees.iter().all(consistent) {
        true => Usability::Usable,
        false => Usability::WithCare,
    }
}

/// What a model is, in words that go on after its name.
fn verdict(model: &Model<'_>) -> String {
    let nees = &model.model.nees;
    let all = nees.iter().find(|g| g.name == "all");
    let all = all.and_then(|g| g.verdict);
    if let Some(verdict) = all.filter(|_| nees.iter().all(|g| g.verdict == all)) {
        return format!("{verdict} in every group of states");
    }
    let parts = Verdict::ALL.into_iter().filter_map(|verdict| {
        let groups = nees.iter().filter(|g| g.verdict == Some(verdict));
        let names: Vec<&str> = groups.map(|g| g.name.as_str()).collect();
        (!names.is_empty()).then(|| format!("{verdict} in {}", names.join(", ")))
    });
    Vec::from_iter(parts).join("; ")
}

/// NEES over time, a panel for each group of states.
fn over_time(models: &[Model<'_>]) -> Option<Section> {
    let panels = GROUP.iter().filter_map(|(name, ..)| group(models, name));
    let caption = "Average NEES per degree of freedom over the runs, with its 95 % bounds (dashed); settling shaded.";
    let figure = Figure::block("nees", caption, 2, panels);
    Section::new("Errors over time", figure)
}

fn group(models: &[Model<'_>], name: &str) -> Option<Panel> {
    let with: Vec<(&Model<'_>, &Group)> = models
        .iter()
        .filter_map(|m| Some((m, m.model.nees.iter().find(|g| g.name == name)?)))
        .filter(|(_, group)| !group.average.is_empty())
        .collect();
    let (first, group) = with.first()?;
    let curves = with
        .iter()
        .map(|(m, g)| per_freedom(m.run, &g.average, g.freedom));
    let curves: Vec<Vec<(f64, f64)>> = curves.collect();
    let largest = curves.iter().flatten().map(|p| p.1).fold(3.0, f64::max);
    let y =
        PlotAxis::logarithmic("average NEES / dof").within(RANGE.0..(1.3 * largest).min(RANGE.1));
    let mut panel = Panel::new(name, PlotAxis::new("time [s]"), y);
    let started = first.run.time_s.first().map_or(0.0, |t| t.0);
    panel.shade(started, first.model.started_s.0 + first.run.settle_s.0);
    for (at, ((m, _), points)) in with.iter().zip(curves).enumerate().rev() {
        let colour = model_colour(&m.model.name, at);
        let drawn = if m.first {
            Series::thin
        } else {
            Series::dashed
        };
        panel.add(drawn(&m.name, colour, points));
    }
    for bound in [&group.lower, &group.upper] {
        let points = per_freedom(first.run, bound, group.freedom);
        panel.add(Series::dashed("", 0, points));
    }
    Some(panel)
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
fn coverage(models: &[Model<'_>]) -> Table {
    let components = models.iter().flat_map(|m| {
        let of = move |name| Some((m, name, m.model.coverage.get(name)?));
        COMPONENT_NAMES.into_iter().filter_map(of)
    });
    let share = |of: &[Number], i: usize| percent(of.get(i).copied().unwrap_or_default()).into();
    Table::from_rows(
        "coverage",
        "Share of errors within one, two and three standard deviations reported by the filter: 68.3, 95.4 and 99.7 % if it is consistent.",
        components,
        &[
            ("model", &|(m, ..)| (&m.name).into()),
            ("component", &|(_, name, _)| spoken(name).into()),
            ("within 1σ", &|(.., of)| share(of, 0)),
            ("within 2σ", &|(.., of)| share(of, 1)),
            ("within 3σ", &|(.., of)| share(of, 2)),
        ],
    )
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

fn innovations(models: &[Model<'_>]) -> Table {
    let kinds = models
        .iter()
        .flat_map(|m| m.model.nis.iter().map(move |k| (m, k)));
    Table::from_rows(
        "nis",
        "Innovations of all runs: NIS per degree of freedom with the 95 % bounds of its average, the share above the 95 % point, and the largest autocorrelation at lags 1 to 10.",
        kinds,
        &[
            ("model", &|(m, _)| (&m.name).into()),
            ("measurement", &|(_, k)| (&k.name).into()),
            ("updates", &|(_, k)| k.updates.into()),
            ("NIS / dof", &|(_, k)| Cell::number(k.nis_per_freedom.0, 4)),
            ("95 % bounds", &|(_, k)| {
                format!("{:.4} … {:.4}", k.bounds.0.0, k.bounds.1.0).into()
            }),
            ("above 95 %", &|(_, k)| percent(k.share_above_95).into()),
            ("autocorrelation", &|(_, k)| {
                let all = k.autocorrelation.iter().flatten();
                let largest = all.map(|r| r.0.abs()).fold(0.0, f64::max);
                format!("{largest:.3} (±{:.3})", k.autocorrelation_bound.0).into()
            }),
            ("verdict", &|(_, k)| marked(k.verdict)),
        ],
    )
}

#[cfg(test)]
mod tests;
