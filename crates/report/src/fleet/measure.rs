//! One number of every log, compared.

use super::{NAMES, ROWS, answers, density::density, many, shortened};
use crate::{
    Block, Cell, Figure, Panel, PlotAxis, Section, Series, Table,
    numbers::{count, get, probability, short},
    parts::{axis_for, capital, first_few, model_colour, quartiles, text},
};
use undrift_base::order_statistics::quantile;
use undrift_results::{
    Fleet, FleetGroup as Group, FleetLog as Log, FleetMeasure as Measure, FleetOutlier as Outlier,
    FleetPart as Part, Level,
};

/// Units that have a name on the axis of a figure.
const NAMED: usize = 40;

/// Head of a column of a measure's values.
fn head(word: &str, measure: &Measure) -> String {
    match measure.unit.as_str() {
        "" => word.to_owned(),
        unit => format!("{word} [{unit}]"),
    }
}

/// The part with the least median.
fn least(measure: &Measure) -> Option<&Part> {
    let known = measure.parts.iter().filter(|p| p.median.0.is_finite());
    known.min_by(|a, b| a.median.0.total_cmp(&b.median.0))
}

/// Axes of a sensor are not rivals, bias models are.
fn are_models(measure: &Measure) -> bool {
    matches!(measure.name.as_str(), "drift" | "error")
}

/// On how many logs a part is the best.
fn wins(measure: &Measure, part: &Part) -> u64 {
    measure.best.get(&part.part).copied().unwrap_or(0)
}

/// What the numbers say, in sentences; the answers of the first measure are given already.
pub(super) fn findings(measure: &Measure, first: bool) -> Vec<String> {
    let medians = measure.parts.iter().map(|part| {
        let median = format!("{} {} {}", part.part, short(part.median.0), measure.unit);
        median.trim_end().to_owned()
    });
    let medians: Vec<String> = medians.collect();
    let what = measure.what.split(',').next().unwrap_or_default();
    let medians = format!(
        "{}, median over the logs: {}.",
        capital(what),
        medians.join(", ")
    );
    let best = least(measure).filter(|_| are_models(measure) && measure.parts.len() > 1);
    let best = best.map(|best| {
        format!(
            "{} has the least and is best on {} of the {} run with all models.",
            best.part,
            count(wins(measure, best)),
            many(measure.best.values().sum(), "log")
        )
    });
    let sentences = [Some(medians), best, of_outliers(measure)];
    let sentences = sentences.into_iter().flatten();
    if first {
        sentences.collect()
    } else {
        let answers = answers::sentences(measure).into_iter();
        answers.chain(sentences).collect()
    }
}

/// Which logs stand out.
pub(super) fn of_outliers(measure: &Measure) -> Option<String> {
    let name = |o: &Outlier| format!("{} ({})", o.log, answers::factor(&o.effect));
    let names: Vec<String> = measure.outliers.iter().map(name).collect();
    if names.is_empty() {
        return None;
    }
    let stand = if names.len() == 1 { "stands" } else { "stand" };
    Some(format!(
        "{} {stand} out of the rest: {}.",
        many(names.len() as u64, "log"),
        first_few(&names, NAMES)
    ))
}

/// The section of a measure.
pub(super) fn section(run: &Fleet, measure: &Measure) -> Option<Section> {
    let mut blocks = vec![Block::Table(overview(run, measure))];
    blocks.extend(spread(run, measure));
    blocks.extend(outliers(measure));
    blocks.extend(temperature(run, measure));
    blocks.extend(groups(measure, "unit", &measure.by_unit));
    if measure.by_sensor.len() > 1 {
        blocks.extend(groups(measure, "sensor", &measure.by_sensor));
    }
    for label in &measure.by_label {
        blocks.extend(groups(measure, &label.label, &label.by_value));
    }
    blocks.extend(text(answers::left_out(measure)));
    Section::new(&capital(&measure.name.replace('_', " ")), blocks)
}

/// The values of a part, log by log.
fn logs<'a>(run: &'a Fleet, measure: &'a Measure, part: &'a Part) -> Vec<(&'a Log, f64)> {
    let value = |log: &'a Log| {
        let value = get(log.values.get(&measure.name)?, &part.part);
        value.is_finite().then_some((log, value))
    };
    run.logs.iter().filter_map(value).collect()
}

/// The values of a part.
fn values(run: &Fleet, measure: &Measure, part: &Part) -> Vec<f64> {
    let logs = logs(run, measure, part).into_iter();
    logs.map(|(_, value)| value).collect()
}

/// The parts side by side.
pub(super) fn overview(run: &Fleet, measure: &Measure) -> Table {
    let models = are_models(measure);
    let medians: Vec<f64> = measure.parts.iter().map(|p| p.median.0).collect();
    let mut rows = Table::from_rows(
        &measure.name,
        &format!(
            "The {}. Level: geometric mean over units with its 95 % interval.",
            measure.what
        ),
        &measure.parts,
        &[
            (if models { "model" } else { "of" }, &|p| (&p.part).into()),
            ("logs", &|p| p.logs.into()),
            (&head("median", measure), &|p| p.median.into()),
            (&head("90 %", measure), &|p| {
                short(quantile(&values(run, measure, p), 0.9)).into()
            }),
            (&head("largest", measure), &|p| {
                short(quantile(&values(run, measure, p), 1.0)).into()
            }),
            (&head("level", measure), &|p| level(p.level).into()),
        ],
    );
    if models {
        let wins = measure.parts.iter().map(|p| wins(measure, p).into());
        rows.add("best on".into(), wins);
        rows.mark_least(2, &medians);
    }
    rows
}

/// A level with its interval.
fn level(level: Option<Level>) -> String {
    level.map_or("–".into(), |level| {
        let [value, low, high] = [level.value, level.low, level.high].map(|v| short(v.0));
        format!("{value} ({low} to {high})")
    })
}

/// An empty plot of a measure's values.
fn panel(measure: &Measure, x: PlotAxis, values: &[f64]) -> Panel {
    let label = head(&measure.name.replace('_', " "), measure);
    Panel::new("", x, axis_for(values, &label))
}

/// The logs of each part as a box.
fn spread(run: &Fleet, measure: &Measure) -> Option<Block> {
    let all = measure.parts.iter().map(|part| values(run, measure, part));
    let all: Vec<Vec<f64>> = all.collect();
    let names = measure.parts.iter().map(|part| part.part.as_str());
    let mut panel = panel(measure, PlotAxis::categories(names), &all.concat());
    for (place, (part, values)) in measure.parts.iter().zip(&all).enumerate() {
        if let Some(quartiles) = quartiles(values) {
            let colour = model_colour(&part.part, place);
            panel.add(Series::boxes("", colour, vec![(place as f64, quartiles)]));
        }
    }
    Figure::block(
        &format!("{}-spread", measure.name),
        "The logs: box from the first to the third quartile with the median, whiskers to the extremes.",
        1,
        [panel],
    )
}

fn outliers(measure: &Measure) -> Option<Block> {
    let own = match measure.task.as_str() {
        "" => String::new(),
        verb => format!(" A log's own report: undrift {verb} LOG --report FILE.html."),
    };
    let rows = Table::from_rows(
        &format!("{}-outliers", measure.name),
        &shortened(
            &format!(
                "Logs that differ from the rest of their unit, or from all if no log has a unit.{own}"
            ),
            measure.outliers.len(),
        ),
        measure.outliers.iter().take(ROWS),
        &[
            ("log", &|o| Cell::from(&o.log).linked(o.report.as_deref())),
            ("unit", &|o| (&o.unit).into()),
            ("temperature [°C]", &|o| Cell::number(o.temperature_c.0, 1)),
            ("times the rest (95 %)", &|o| {
                answers::factor(&o.effect).into()
            }),
            ("p", &|o| probability(o.effect.p.0).into()),
        ],
    );
    rows.block()
}

/// Logs that are drawn one by one.
const DOTS: usize = 1000;

/// The logs against their temperatures, with the medians of the bins: a panel for each part where they are many.
fn temperature(run: &Fleet, measure: &Measure) -> Option<Block> {
    let mut all = Vec::new();
    let mut parts = Vec::new();
    for (place, part) in measure.parts.iter().enumerate() {
        let logs = logs(run, measure, part).into_iter();
        let points = logs.map(|(log, value)| (log.temperature_c.0, value));
        let points: Vec<(f64, f64)> = points.filter(|p| p.0.is_finite()).collect();
        if points.is_empty() {
            continue;
        }
        all.extend(points.iter().map(|p| p.1));
        let bins = part.temperature.iter();
        let medians = bins.map(|b| (f64::midpoint(b.from_c.0, b.to_c.0), b.median.0));
        let medians: Vec<(f64, f64)> = medians.collect();
        parts.push((part, model_colour(&part.part, place), points, medians));
    }
    let many = all.len() > DOTS;
    let empty = || panel(measure, PlotAxis::new("temperature [°C]"), &all);
    let mut panels = Vec::new();
    if many {
        for (part, colour, points, medians) in parts {
            let mut panel = empty().titled(&part.part);
            for cells in density(&points, &panel) {
                panel.add(cells);
            }
            panel.add(Series::thick("median", colour, medians));
            panels.push(panel);
        }
    } else if !parts.is_empty() {
        let mut panel = empty();
        for (part, colour, points, medians) in parts {
            panel.add(Series::dots("", colour, points));
            panel.add(Series::line(&part.part, colour, medians));
        }
        panels.push(panel);
    }
    let each = if many {
        "The logs at their temperatures: the darker a cell, the more logs"
    } else {
        "Each log at its temperature (dots)"
    };
    Figure::block(
        &format!("{}-temperature", measure.name),
        &format!("{each}; the medians of bins of 10 K (lines)."),
        panels.len().min(2),
        panels,
    )
}

/// Units, sensors or values of a label: their medians as a figure and a table.
fn groups(measure: &Measure, what: &str, groups: &[Group]) -> Vec<Block> {
    // Those that stand out first, then by the part that is best over all the largest.
    let by = least(measure).map_or("", |part| part.part.as_str());
    let mut sorted: Vec<&Group> = groups.iter().collect();
    let found = |group: &Group| group.effect.is_some_and(|effect| effect.found);
    sorted.sort_by(|a, b| {
        let values = get(&b.median, by).total_cmp(&get(&a.median, by));
        found(b).cmp(&found(a)).then(values)
    });
    if sorted.is_empty() {
        return Vec::new();
    }
    let caption = format!(
        "Median over the logs of each {what}, sorted by {by}, largest first, and the ratio of its geometric mean to the others' (95 % interval; p adjusted for all that is compared); bold, on top: significant."
    );
    let shown = || sorted.iter().copied().take(ROWS);
    let mut rows = Table::from_rows(
        &format!("{}-by-{what}", measure.name),
        &shortened(&caption, sorted.len()),
        shown(),
        &[
            (what, &|group| (&group.name).into()),
            ("logs", &|group| group.logs.into()),
            ("times the others (95 %)", &|group| {
                let effect = group.effect.as_ref();
                let text = effect.map_or("–".into(), answers::factor);
                Cell::from(text).strong_if(found(group))
            }),
            ("p", &|group| {
                let p = group.effect.map(|effect| probability(effect.p.0));
                p.unwrap_or_else(|| "–".into()).into()
            }),
        ],
    );
    // Of many every few are drawn, of which the largest have names.
    let step = sorted.len().div_ceil(DOTS);
    let drawn = || sorted.iter().copied().step_by(step);
    let mut all = Vec::new();
    let mut series = Vec::new();
    for (place, part) in measure.parts.iter().enumerate() {
        let cells = shown().map(|group| Cell::from(short(get(&group.median, &part.part))));
        rows.add(head(&part.part, measure), cells);
        let medians = drawn().map(|group| get(&group.median, &part.part));
        let points = (0..).map(|k| f64::from(k) * step as f64).zip(medians);
        let points: Vec<(f64, f64)> = points.filter(|p| p.1.is_finite()).collect();
        all.extend(points.iter().map(|p| p.1));
        let colour = model_colour(&part.part, place);
        series.push(Series::dots(&part.part, colour, points));
    }
    let x = if sorted.len() <= NAMED {
        PlotAxis::categories(sorted.iter().map(|group| group.name.as_str()))
    } else {
        PlotAxis::new(&format!("{what}s, the largest of {by} first"))
    };
    let mut panel = panel(measure, x, &all);
    panel.series = series;
    let caption = format!("Median over the logs of each {what}.");
    let name = format!("{}-by-{what}s", measure.name);
    let figure = Figure::block(&name, &caption, 1, [panel]);
    figure.into_iter().chain([Block::Table(rows)]).collect()
}

#[cfg(test)]
mod tests;
