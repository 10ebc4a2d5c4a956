//! Drift since the cut, model beside model.

use super::Model;
use crate::{
    Block, Figure, Panel, PlotAxis, Section, Series,
    numbers::short,
    parts::{Clock, axis_for, coinciding, model_pattern, quartiles, run_colour},
};
use undrift_base::order_statistics::quantile;

/// What a caption says of lines with several names.
const ONE: &str = "; models that differ by less than 1 % throughout are one line";

const LARGEST: &str = "largest horizontal error [m]";

/// Drift since the cut, and how it scatters over the outages.
pub(super) fn drift(models: &[Model<'_>]) -> Option<Section> {
    let known = |m: &&Model<'_>| !m.errors.per_outage.is_empty();
    let models: Vec<&Model<'_>> = models.iter().filter(known).collect();
    if models.is_empty() {
        return None;
    }
    let blocks = [curves(&models), spread(&models), outage_by_outage(&models)];
    let section = Section::new("Drift without GNSS", blocks.into_iter().flatten())?;
    let finite = models.iter().filter(|m| m.usable && m.rms().is_finite());
    let best = finite.min_by(|a, b| a.rms().total_cmp(&b.rms()));
    let note = best.map_or(String::new(), |m| {
        format!("least {} m, {}", short(m.rms()), m.name)
    });
    Some(section.noted(note))
}

/// Models whose curves lie on each other, as one line: of the last of them, under all their names. A model's line has its
/// colour and its pattern, that of another run than the first is thin.
pub(super) fn lines(models: &[(&Model<'_>, Vec<(f64, f64)>)]) -> Vec<Series> {
    let curves: Vec<&[(f64, f64)]> = models.iter().map(|m| m.1.as_slice()).collect();
    let groups = coinciding(&curves).into_iter();
    let line = |group: Vec<usize>| {
        let names: Vec<&str> = group.iter().map(|at| models[*at].0.name.as_str()).collect();
        let (model, points) = &models[group[group.len() - 1]];
        let kind = if model.run == 0 {
            Series::line
        } else {
            Series::thin
        };
        let line = kind(&names.join(" = "), model.colour, points.clone());
        line.pattern(model_pattern(model.key))
    };
    groups.map(line).collect()
}

fn positive(errors: impl Iterator<Item = f64>) -> Vec<f64> {
    errors.filter(|e| *e > 0.0).collect()
}

/// The largest horizontal errors of all outages and models \[m\].
fn largest(models: &[&Model<'_>]) -> Vec<f64> {
    positive(models.iter().flat_map(|m| m.largest()))
}

/// The horizontal error over the time since the cut.
fn curves(models: &[&Model<'_>]) -> Option<Block> {
    let last = models.iter().filter_map(|m| Some(m.drift.last()?.1));
    let drifts = positive(last);
    if drifts.is_empty() {
        return None;
    }
    let y = axis_for(&drifts, "horizontal error, RMS [m]");
    let mut panel = Panel::new("", PlotAxis::new("time since the cut [s]"), y);
    let drawn = models.iter().filter(|m| !m.drift.is_empty());
    for line in lines(&Vec::from_iter(drawn.map(|m| (*m, m.drift.clone())))) {
        panel.add(line);
    }
    let caption = format!("Horizontal error since the cut, RMS over the outages{ONE}.");
    Figure::block("drift", &caption, 1, [panel])
}

/// The largest horizontal errors of each model as a box, with their root mean square.
fn spread(models: &[&Model<'_>]) -> Option<Block> {
    let mut keys: Vec<&str> = Vec::new();
    for model in models {
        if !keys.contains(&model.key) {
            keys.push(model.key);
        }
    }
    let several = models.iter().any(|m| m.run > 0);
    let y = axis_for(&largest(models), LARGEST);
    let mut panel = Panel::new("", PlotAxis::categories(keys.iter().copied()), y);
    let runs = models.iter().map(|m| m.run).max().unwrap_or(0) + 1;
    let mut squares: Vec<(f64, f64)> = Vec::new();
    for run in 0..runs {
        let mut boxes = Vec::new();
        for model in models.iter().filter(|m| m.run == run) {
            let x = keys.iter().position(|k| *k == model.key).unwrap_or(0) as f64;
            boxes.extend(quartiles(&model.largest()).map(|box_| (model, (x, box_))));
            // Position of the box: those of several runs share 0.8 side by side.
            let beside = if keys.len() < models.len() {
                0.8 * ((run as f64 + 0.5) / runs as f64 - 0.5)
            } else {
                0.0
            };
            squares.push((x + beside, model.rms()));
        }
        if several {
            let name = boxes.first().map_or("", |(m, _)| {
                m.name.strip_suffix(&format!(": {}", m.key)).unwrap_or("")
            });
            let boxes = boxes.iter().map(|b| b.1).collect();
            panel.add(Series::boxes(name, run_colour(run), boxes));
        } else {
            for (model, one) in boxes {
                panel.add(Series::boxes("", model.colour, vec![one]));
            }
        }
    }
    panel.add(Series::dots("root mean square", 0, squares));
    let caption = "Largest horizontal error of each outage, by model: box from the first to the third quartile with the median, whiskers to the extremes; dots: RMS.";
    Figure::block("models", caption, 1, [panel])
}

/// The largest horizontal error of each outage against its start.
fn outage_by_outage(models: &[&Model<'_>]) -> Option<Block> {
    let outages = models.iter().flat_map(|m| &m.errors.per_outage);
    let starts: Vec<f64> = outages.map(|o| o.start_s.0).collect();
    let clock = Clock::starting(quantile(&starts, 0.0));
    let all = largest(models);
    if all.is_empty() {
        return None;
    }
    let panel = Panel::new("", PlotAxis::new(&clock.label()), axis_for(&all, LARGEST));
    let mut panel = panel.over_time(clock.zero());
    let drawn = models.iter().map(|model| {
        let outages = model.errors.per_outage.iter().zip(model.largest());
        let points = outages.map(|(o, e)| (clock.at(o.start_s.0), e));
        (*model, points.collect::<Vec<_>>())
    });
    for line in lines(&Vec::from_iter(drawn)) {
        let points = line.points().collect();
        let dots = Series::dots("", line.colour, points);
        panel.add(line);
        panel.add(dots);
    }
    let caption = format!("Largest horizontal error of each outage, plotted at its start{ONE}.");
    Figure::block("outage-by-outage", &caption, 1, [panel])
}

#[cfg(test)]
mod tests;
