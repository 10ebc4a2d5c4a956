//! One number of every log, compared.

use super::{ROWS, TOLD, many, shortened};
use crate::{
    Axis, Block, Cell, Panel, Section, Series, Table,
    parts::{axis_for, cell, count, figure, get, mark_least, model_colour, short, table, text},
};
use undrift::noise::order_statistics::quantile;
use undrift::results::{
    Fleet, FleetGroup as Group, FleetLog as Log, FleetMeasure as Measure, FleetPart as Part,
};

/// Units that have a name on the axis of a figure.
const NAMED: usize = 40;

/// A value with its unit.
fn with_unit(value: f64, measure: &Measure) -> String {
    match measure.unit.as_str() {
        "" => short(value),
        unit => format!("{} {unit}", short(value)),
    }
}

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

/// What the numbers say, in sentences.
pub(super) fn findings(measure: &Measure) -> Vec<String> {
    let mut told = Vec::new();
    let medians: Vec<String> = measure
        .parts
        .iter()
        .map(|part| format!("{} {}", part.part, with_unit(part.median.0, measure)))
        .collect();
    let what = measure.what.split(',').next().unwrap_or_default();
    let (first, rest) = what.split_at(what.chars().next().map_or(0, char::len_utf8));
    told.push(format!(
        "{}{rest}, median over the logs: {}.",
        first.to_uppercase(),
        medians.join(", ")
    ));
    if let (Some(best), true, true) = (least(measure), are_models(measure), measure.parts.len() > 1)
    {
        let all: u64 = measure.best.values().sum();
        let wins = measure.best.get(&best.part).copied().unwrap_or(0);
        told.push(format!(
            "{} has the least, and is the best on {} of the {} that all models were run on.",
            best.part,
            count(wins),
            many(all, "log")
        ));
    }
    told.extend(of_temperature(measure));
    told.extend(of_outliers(measure));
    told
}

fn of_temperature(measure: &Measure) -> Option<String> {
    let parts: Vec<&Part> = measure
        .parts
        .iter()
        .filter(|part| part.temperature.correlation.0.is_finite())
        .collect();
    let bound = parts.first()?.temperature.bound.0;
    let of = |part: &&Part| part.temperature.correlation.0;
    let mut told = Vec::new();
    for (word, sign) in [("grows", 1.0), ("falls", -1.0)] {
        let mine = parts
            .iter()
            .filter(|p| sign * of(p) > p.temperature.bound.0);
        let mine: Vec<String> = mine.map(|p| format!("{} {:.2}", p.part, of(p))).collect();
        if !mine.is_empty() {
            told.push(format!(
                "It {word} with temperature for {}",
                mine.join(", ")
            ));
        }
    }
    Some(if told.is_empty() {
        format!(
            "It shows no trend with temperature: rank correlations are within ±{bound:.2}, as by chance."
        )
    } else {
        format!(
            "{} (rank correlation; by chance it stays within ±{bound:.2} nineteen times out of twenty).",
            told.join("; ")
        )
    })
}

fn of_outliers(measure: &Measure) -> Option<String> {
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
    let names: Vec<String> = worst
        .iter()
        .take(TOLD)
        .map(|(log, times)| format!("{log} ({} times the median)", short(*times)))
        .collect();
    let more = worst.len().saturating_sub(TOLD);
    let more = if more > 0 {
        format!(" and {more} more")
    } else {
        String::new()
    };
    let stand = if worst.len() == 1 { "stands" } else { "stand" };
    Some(format!(
        "{} {stand} out: {}{more}.",
        many(worst.len() as u64, "log"),
        names.join(", ")
    ))
}

/// The section of a measure.
pub(super) fn section(run: &Fleet, measure: &Measure) -> Section {
    let mut blocks = vec![Block::Table(overview(run, measure))];
    blocks.extend(spread(run, measure));
    blocks.extend(outliers(run, measure));
    blocks.extend(temperature(run, measure));
    blocks.extend(groups(measure, "unit", &measure.by_unit));
    if measure.by_sensor.len() > 1 {
        blocks.extend(groups(measure, "sensor", &measure.by_sensor));
    }
    let title = measure.name.replace('_', " ");
    let (first, rest) = title.split_at(title.chars().next().map_or(0, char::len_utf8));
    Section {
        title: format!("{}{rest}", first.to_uppercase()),
        blocks,
    }
}

/// The values of a part, log by log.
fn values<'a>(run: &'a Fleet, measure: &'a Measure, part: &'a str) -> Vec<(&'a Log, f64)> {
    let value = |log: &'a Log| {
        let value = get(log.values.get(&measure.name)?, part);
        value.is_finite().then_some((log, value))
    };
    run.logs.iter().filter_map(value).collect()
}

fn overview(run: &Fleet, measure: &Measure) -> Table {
    let models = are_models(measure);
    let rule = &run.outlier_rule;
    let mut rows = table(
        &measure.name,
        &format!(
            "The {}. A log stands out above the limit: {} robust standard deviations of the logarithm (1.4826 times its median absolute deviation) above its median, and {:.0} % or more above the median; of fewer than {} logs none does.",
            measure.what,
            short(rule.deviations.0),
            100.0 * rule.share.0,
            rule.least
        ),
        &[],
    );
    rows.head = vec![
        if models { "model" } else { "of" }.into(),
        "logs".into(),
        head("median", measure),
        head("90 %", measure),
        head("largest", measure),
        head("limit", measure),
        "above".into(),
        "correlation with temperature".into(),
    ];
    if models {
        rows.head.push("best on".into());
    }
    for part in &measure.parts {
        let known: Vec<f64> = values(run, measure, &part.part)
            .iter()
            .map(|v| v.1)
            .collect();
        let temperature = &part.temperature;
        let mut row: Vec<Cell> = vec![
            part.part.clone().into(),
            count(part.logs).into(),
            cell(part.median.0),
            cell(quantile(&known, 0.9)),
            cell(quantile(&known, 1.0)),
            cell(part.limit.0),
            count(part.outliers.len() as u64).into(),
            if temperature.correlation.0.is_finite() {
                format!(
                    "{:.2} (±{:.2})",
                    temperature.correlation.0, temperature.bound.0
                )
                .into()
            } else {
                "–".into()
            },
        ];
        if models {
            row.push(count(measure.best.get(&part.part).copied().unwrap_or(0)).into());
        }
        rows.rows.push(row);
    }
    if models {
        let medians: Vec<f64> = measure.parts.iter().map(|p| p.median.0).collect();
        mark_least(&mut rows, 2, &medians);
    }
    rows
}

fn label(measure: &Measure) -> String {
    head(&measure.name.replace('_', " "), measure)
}

/// The logs of each part as a box.
fn spread(run: &Fleet, measure: &Measure) -> Option<Block> {
    let all: Vec<Vec<f64>> = measure
        .parts
        .iter()
        .map(|part| {
            values(run, measure, &part.part)
                .iter()
                .map(|v| v.1)
                .collect()
        })
        .collect();
    let names = measure.parts.iter().map(|part| part.part.as_str());
    let y = axis_for(&all.concat(), &label(measure));
    let mut panel = Panel::new("", Axis::categories(names), y);
    for (place, (part, values)) in measure.parts.iter().zip(&all).enumerate() {
        let quartiles = [0.0, 0.25, 0.5, 0.75, 1.0].map(|share| quantile(values, share));
        if quartiles.iter().all(|q| q.is_finite()) {
            let colour = model_colour(&part.part, place);
            panel.add(Series::boxes("", colour, vec![(place as f64, quartiles)]));
        }
    }
    figure(
        &format!("{}-spread", measure.name),
        "The logs: box from the first to the third quartile with the median in it, whiskers to the least and the largest.",
        1,
        vec![panel],
    )
}

fn outliers(run: &Fleet, measure: &Measure) -> Option<Block> {
    let of = measure.parts.iter();
    let all: Vec<_> = of
        .flat_map(|p| p.outliers.iter().map(move |o| (p, o)))
        .collect();
    let mut rows = table(
        &format!("{}-outliers", measure.name),
        &shortened("Logs that stand out of the others.", all.len()),
        &[],
    );
    rows.head = vec![
        "of".into(),
        "log".into(),
        "unit".into(),
        "temperature [°C]".into(),
        head("value", measure),
        "times the median".into(),
    ];
    rows.rows = all
        .iter()
        .take(ROWS)
        .map(|(part, outlier)| {
            vec![
                part.part.clone().into(),
                outlier.log.clone().into(),
                outlier.unit.clone().unwrap_or_else(|| "–".into()).into(),
                Cell::number(outlier.temperature_c.0, 1),
                cell(outlier.value.0),
                cell(outlier.times_median.0),
            ]
        })
        .collect();
    let none = "No log stands out of the others.";
    if rows.rows.is_empty() {
        let enough = measure.parts.iter().any(|p| p.limit.0.is_finite());
        let few = format!(
            "With fewer than {} logs none is said to stand out.",
            run.outlier_rule.least
        );
        return text(&[if enough { none.to_owned() } else { few }]);
    }
    Some(Block::Table(rows))
}

/// The logs against their temperatures, with the medians of the bins.
fn temperature(run: &Fleet, measure: &Measure) -> Option<Block> {
    let mut all = Vec::new();
    let mut series = Vec::new();
    for (place, part) in measure.parts.iter().enumerate() {
        let points: Vec<(f64, f64)> = values(run, measure, &part.part)
            .into_iter()
            .map(|(log, value)| (log.temperature_c.0, value))
            .filter(|(temperature, _)| temperature.is_finite())
            .collect();
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
    if series.is_empty() {
        return None;
    }
    let y = axis_for(&all, &label(measure));
    let mut panel = Panel::new("", Axis::new("temperature [°C]"), y);
    series.into_iter().for_each(|one| panel.add(one));
    figure(
        &format!("{}-temperature", measure.name),
        "Each log at its temperature (dots), and the medians of bins of 10 K (lines).",
        1,
        vec![panel],
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
    let mut rows = table(
        &format!("{}-by-{what}", measure.name),
        &shortened(
            &format!(
                "Median over the logs of each {what}, the largest of {by} first; bold stands out among the {what}s."
            ),
            sorted.len(),
        ),
        &[what, "logs"],
    );
    rows.head
        .extend(measure.parts.iter().map(|part| head(&part.part, measure)));
    for group in sorted.iter().take(ROWS) {
        let mut row: Vec<Cell> = vec![group.name.clone().into(), count(group.logs).into()];
        row.extend(measure.parts.iter().map(|part| {
            let cell = cell(get(&group.median, &part.part));
            match group.outlying.contains(&part.part) {
                true => cell.strong(),
                false => cell,
            }
        }));
        rows.rows.push(row);
    }
    let mut all = Vec::new();
    let mut series = Vec::new();
    for (place, part) in measure.parts.iter().enumerate() {
        let points: Vec<(f64, f64)> = sorted
            .iter()
            .enumerate()
            .map(|(x, group)| (x as f64, get(&group.median, &part.part)))
            .filter(|(_, value)| value.is_finite())
            .collect();
        all.extend(points.iter().map(|p| p.1));
        series.push(Series::dots(
            &part.part,
            model_colour(&part.part, place),
            points,
        ));
    }
    let x = if sorted.len() <= NAMED {
        Axis::categories(sorted.iter().map(|group| group.name.as_str()))
    } else {
        Axis::new(&format!("{what}s, the largest of {by} first"))
    };
    let mut panel = Panel::new("", x, axis_for(&all, &label(measure)));
    series.into_iter().for_each(|one| panel.add(one));
    let caption = format!("Median over the logs of each {what}.");
    let name = format!("{}-by-{what}s", measure.name);
    figure(&name, &caption, 1, vec![panel])
        .into_iter()
        .chain([Block::Table(rows)])
        .collect()
}
