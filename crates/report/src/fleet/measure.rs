//! One number of every log, compared.

use super::{NAMES, ROWS, many, shortened};
use crate::{
    Axis, Block, Cell, Figure, Panel, Section, Series, Table,
    numbers::{bounded, count, get, short},
    parts::{axis_for, capital, first_few, model_colour, quartiles, text},
};
use undrift::noise::order_statistics::quantile;
use undrift::results::{
    Fleet, FleetGroup as Group, FleetLog as Log, FleetMeasure as Measure, FleetPart as Part,
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

/// What the numbers say, in sentences.
pub(super) fn findings(measure: &Measure) -> Vec<String> {
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
    let sentences = [
        Some(medians),
        best,
        of_temperature(measure),
        of_outliers(measure),
    ];
    sentences.into_iter().flatten().collect()
}

fn of_temperature(measure: &Measure) -> Option<String> {
    let of = |part: &Part| part.temperature.correlation.0;
    let known = || measure.parts.iter().filter(|part| of(part).is_finite());
    let bound = known().next()?.temperature.bound.0;
    let trends = [("grows", 1.0), ("falls", -1.0)]
        .into_iter()
        .filter_map(|(word, sign)| {
            let mine = known().filter(|p| sign * of(p) > p.temperature.bound.0);
            let mine: Vec<String> = mine.map(|p| format!("{} {:.2}", p.part, of(p))).collect();
            (!mine.is_empty())
                .then(|| format!("It {word} with temperature for {}", mine.join(", ")))
        });
    let trends: Vec<String> = trends.collect();
    Some(if trends.is_empty() {
        format!(
            "It shows no trend with temperature: rank correlations are within ±{bound:.2}, as expected by chance."
        )
    } else {
        format!(
            "{} (rank correlation; 95 % bound by chance: ±{bound:.2}).",
            trends.join("; ")
        )
    })
}

/// Which logs stand out.
pub(super) fn of_outliers(measure: &Measure) -> Option<String> {
    // A log that stands out under several models is named once, with the largest factor.
    let mut worst: Vec<(&str, f64)> = Vec::new();
    for outlier in measure.parts.iter().flat_map(|part| &part.outliers) {
        let times = outlier.times_median.0;
        match worst.iter_mut().find(|(log, _)| *log == outlier.log) {
            Some((_, most)) => *most = most.max(times),
            None => worst.push((&outlier.log, times)),
        }
    }
    worst.sort_by(|a, b| b.1.total_cmp(&a.1));
    if worst.is_empty() {
        return None;
    }
    let name = |(log, times): &(&str, f64)| format!("{log} ({} times the median)", short(*times));
    let names: Vec<String> = worst.iter().map(name).collect();
    let stand = if worst.len() == 1 { "stands" } else { "stand" };
    Some(format!(
        "{} {stand} out: {}.",
        many(worst.len() as u64, "log"),
        first_few(&names, NAMES)
    ))
}

/// The section of a measure.
pub(super) fn section(run: &Fleet, measure: &Measure) -> Option<Section> {
    let mut blocks = vec![Block::Table(overview(run, measure))];
    blocks.extend(spread(run, measure));
    blocks.extend(outliers(run, measure));
    blocks.extend(temperature(run, measure));
    blocks.extend(groups(measure, "unit", &measure.by_unit));
    if measure.by_sensor.len() > 1 {
        blocks.extend(groups(measure, "sensor", &measure.by_sensor));
    }
    Section::of(&capital(&measure.name.replace('_', " ")), blocks)
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
    let rule = &run.outlier_rule;
    let medians: Vec<f64> = measure.parts.iter().map(|p| p.median.0).collect();
    let mut rows = Table::of(
        &measure.name,
        &format!(
            "The {}. A log stands out above the limit: {} robust standard deviations of the logarithm (1.4826 times its median absolute deviation) above its median, and {:.0} % or more above the median; with fewer than {} logs, outliers are not reported.",
            measure.what,
            short(rule.deviations.0),
            100.0 * rule.share.0,
            rule.least
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
            (&head("limit", measure), &|p| p.limit.into()),
            ("above", &|p| (p.outliers.len() as u64).into()),
            ("correlation with temperature", &|p| {
                bounded(p.temperature.correlation, p.temperature.bound).into()
            }),
        ],
    );
    if models {
        let wins = measure.parts.iter().map(|p| wins(measure, p).into());
        rows.add("best on".into(), wins);
        rows.mark_least(2, &medians);
    }
    rows
}

/// An empty plot of a measure's values.
fn panel(measure: &Measure, x: Axis, values: &[f64]) -> Panel {
    let label = head(&measure.name.replace('_', " "), measure);
    Panel::new("", x, axis_for(values, &label))
}

/// The logs of each part as a box.
fn spread(run: &Fleet, measure: &Measure) -> Option<Block> {
    let all = measure.parts.iter().map(|part| values(run, measure, part));
    let all: Vec<Vec<f64>> = all.collect();
    let names = measure.parts.iter().map(|part| part.part.as_str());
    let mut panel = panel(measure, Axis::categories(names), &all.concat());
    for (place, (part, values)) in measure.parts.iter().zip(&all).enumerate() {
        if let Some(quartiles) = quartiles(values) {
            let colour = model_colour(&part.part, place);
            panel.add(Series::boxes("", colour, vec![(place as f64, quartiles)]));
        }
    }
    Figure::of(
        &format!("{}-spread", measure.name),
        "The logs: box from the first to the third quartile with the median, whiskers to the extremes.",
        1,
        [panel],
    )
}

fn outliers(run: &Fleet, measure: &Measure) -> Option<Block> {
    let parts = measure.parts.iter();
    let all = parts.flat_map(|p| p.outliers.iter().map(move |o| (p, o)));
    let all: Vec<_> = all.collect();
    if all.is_empty() {
        let enough = measure.parts.iter().any(|p| p.limit.0.is_finite());
        let least = run.outlier_rule.least;
        return text([if enough {
            "No log stands out.".to_owned()
        } else {
            format!("With fewer than {least} logs, outliers are not reported.")
        }]);
    }
    let rows = Table::of(
        &format!("{}-outliers", measure.name),
        &shortened("Logs that stand out.", all.len()),
        all.iter().take(ROWS),
        &[
            ("of", &|(part, _)| (&part.part).into()),
            ("log", &|(_, o)| (&o.log).into()),
            ("unit", &|(_, o)| (&o.unit).into()),
            ("temperature [°C]", &|(_, o)| {
                Cell::number(o.temperature_c.0, 1)
            }),
            (&head("value", measure), &|(_, o)| o.value.into()),
            ("times the median", &|(_, o)| o.times_median.into()),
        ],
    );
    rows.block()
}

/// The logs against their temperatures, with the medians of the bins.
fn temperature(run: &Fleet, measure: &Measure) -> Option<Block> {
    let mut all = Vec::new();
    let mut series = Vec::new();
    for (place, part) in measure.parts.iter().enumerate() {
        let logs = logs(run, measure, part).into_iter();
        let points = logs.map(|(log, value)| (log.temperature_c.0, value));
        let points: Vec<(f64, f64)> = points.filter(|p| p.0.is_finite()).collect();
        if points.is_empty() {
            continue;
        }
        all.extend(points.iter().map(|p| p.1));
        let colour = model_colour(&part.part, place);
        let bins = part.temperature.bins.iter();
        let medians = bins.map(|b| (f64::midpoint(b.from_c.0, b.to_c.0), b.median.0));
        series.push(Series::dots("", colour, points));
        series.push(Series::line(&part.part, colour, medians.collect()));
    }
    let mut panel = panel(measure, Axis::new("temperature [°C]"), &all);
    panel.series = series;
    Figure::of(
        &format!("{}-temperature", measure.name),
        "Each log at its temperature (dots), and the medians of bins of 10 K (lines).",
        1,
        (!panel.series.is_empty()).then_some(panel),
    )
}

/// Units or sensors: their medians as a figure and a table.
fn groups(measure: &Measure, what: &str, groups: &[Group]) -> Vec<Block> {
    // By the part that is best over all: of it the largest first.
    let by = least(measure).map_or("", |part| part.part.as_str());
    let mut sorted: Vec<&Group> = groups.iter().collect();
    sorted.sort_by(|a, b| get(&b.median, by).total_cmp(&get(&a.median, by)));
    if sorted.is_empty() {
        return Vec::new();
    }
    let caption = format!(
        "Median over the logs of each {what}, sorted by {by}, largest first; bold: stands out among the {what}s."
    );
    let shown = || sorted.iter().copied().take(ROWS);
    let mut rows = Table::of(
        &format!("{}-by-{what}", measure.name),
        &shortened(&caption, sorted.len()),
        shown(),
        &[
            (what, &|group| (&group.name).into()),
            ("logs", &|group| group.logs.into()),
        ],
    );
    let mut all = Vec::new();
    let mut series = Vec::new();
    for (place, part) in measure.parts.iter().enumerate() {
        let cells = shown().map(|group| {
            let median = short(get(&group.median, &part.part));
            Cell::from(median).strong_if(group.outlying.contains(&part.part))
        });
        rows.add(head(&part.part, measure), cells);
        let medians = sorted.iter().map(|group| get(&group.median, &part.part));
        let points = (0..).map(f64::from).zip(medians);
        let points: Vec<(f64, f64)> = points.filter(|p| p.1.is_finite()).collect();
        all.extend(points.iter().map(|p| p.1));
        let colour = model_colour(&part.part, place);
        series.push(Series::dots(&part.part, colour, points));
    }
    let x = if sorted.len() <= NAMED {
        Axis::categories(sorted.iter().map(|group| group.name.as_str()))
    } else {
        Axis::new(&format!("{what}s, the largest of {by} first"))
    };
    let mut panel = panel(measure, x, &all);
    panel.series = series;
    let caption = format!("Median over the logs of each {what}.");
    let name = format!("{}-by-{what}s", measure.name);
    let figure = Figure::of(&name, &caption, 1, [panel]);
    figure.into_iter().chain([Block::Table(rows)]).collect()
}
