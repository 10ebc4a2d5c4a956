//! Drift since the cut, model beside model.

use super::Model;
use crate::{
    Axis, Block, Figure, Panel, Section, Series,
    parts::{Clock, axis_for},
};
use undrift::noise::order_statistics::quantile;

/// Colours of several runs.
const RUNS: [usize; 6] = [7, 6, 4, 5, 2, 0];

/// Drift since the cut, and how it scatters over the outages.
pub(super) fn drift(models: &[Model<'_>]) -> Option<Section> {
    let models: Vec<&Model<'_>> = models
        .iter()
        .filter(|m| !m.errors.per_outage.is_empty())
        .collect();
    if models.is_empty() {
        return None;
    }
    let mut blocks = Vec::new();
    let drifts: Vec<f64> = models
        .iter()
        .filter_map(|m| m.drift.last().map(|p| p.1))
        .filter(|e| *e > 0.0)
        .collect();
    let y = axis_for(&drifts, "horizontal error, RMS [m]");
    let mut curves = Panel::new("", Axis::new("time since the cut [s]"), y);
    for model in models.iter().filter(|m| !m.drift.is_empty()) {
        curves.add(model.line(model.drift.clone()));
    }
    if !drifts.is_empty() {
        blocks.push(Block::Figure(Figure {
            name: "drift".into(),
            caption: "Horizontal error since the cut, root mean square over the outages.".into(),
            columns: 1,
            panels: vec![curves],
        }));
    }
    blocks.push(spread(&models));
    blocks.extend(outage_by_outage(&models));
    Some(Section {
        title: "Drift without GNSS".into(),
        blocks,
    })
}

impl Model<'_> {
    /// A curve of the model: dashed where it is of another run than the first, or a bound.
    fn line(&self, points: Vec<(f64, f64)>) -> Series {
        if self.run == 0 && !self.is_bound() {
            Series::line(&self.name, self.colour, points)
        } else {
            Series::dashed(&self.name, self.colour, points)
        }
    }
}

/// The largest horizontal errors of each model as a box, with their root mean square.
fn spread(models: &[&Model<'_>]) -> Block {
    let mut keys: Vec<&str> = Vec::new();
    for model in models {
        if !keys.contains(&model.key) {
            keys.push(model.key);
        }
    }
    let several = models.iter().any(|m| m.run > 0);
    let all: Vec<f64> = models
        .iter()
        .flat_map(|m| m.largest())
        .filter(|e| *e > 0.0)
        .collect();
    let y = axis_for(&all, "largest horizontal error [m]");
    let mut panel = Panel::new("", Axis::categories(keys.iter().copied()), y);
    let runs = models.iter().map(|m| m.run).max().unwrap_or(0) + 1;
    let mut squares: Vec<(f64, f64)> = Vec::new();
    for run in 0..runs {
        let mut boxes = Vec::new();
        for model in models.iter().filter(|m| m.run == run) {
            let x = keys.iter().position(|k| *k == model.key).unwrap_or(0) as f64;
            let largest = model.largest();
            let quartiles = [0.0, 0.25, 0.5, 0.75, 1.0].map(|share| quantile(&largest, share));
            if quartiles.iter().all(|q| q.is_finite()) {
                boxes.push((model, (x, quartiles)));
            }
            // Where the box stands: those of several runs share 0.8 side by side.
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
            panel.add(Series::boxes(name, RUNS[run % RUNS.len()], boxes));
        } else {
            for (model, one) in boxes {
                panel.add(Series::boxes("", model.colour, vec![one]));
            }
        }
    }
    panel.add(Series::dots("root mean square", 0, squares));
    Block::Figure(Figure {
        name: "models".into(),
        caption: "The models compared by the largest horizontal error of each outage: box from the first to the third quartile with the median in it, whiskers to the least and the largest; dots: root mean square.".into(),
        columns: 1,
        panels: vec![panel],
    })
}

/// The largest horizontal error of each outage against its start.
fn outage_by_outage(models: &[&Model<'_>]) -> Option<Block> {
    let starts: Vec<f64> = models
        .iter()
        .flat_map(|m| &m.errors.per_outage)
        .map(|o| o.start_s.0)
        .collect();
    let clock = Clock::starting(quantile(&starts, 0.0));
    let all: Vec<f64> = models
        .iter()
        .flat_map(|m| m.largest())
        .filter(|e| *e > 0.0)
        .collect();
    if all.is_empty() {
        return None;
    }
    let y = axis_for(&all, "largest horizontal error [m]");
    let mut panel = Panel::new("", Axis::new(&clock.label()), y);
    for model in models {
        let outages = model.errors.per_outage.iter().zip(model.largest());
        let points: Vec<(f64, f64)> = outages.map(|(o, e)| (clock.at(o.start_s.0), e)).collect();
        panel.add(model.line(points.clone()));
        panel.add(Series::dots("", model.colour, points));
    }
    Some(Block::Figure(Figure {
        name: "outage-by-outage".into(),
        caption: "Largest horizontal error of each outage, at the time of its start.".into(),
        columns: 1,
        panels: vec![panel],
    }))
}
