//! Drift since the cut, model beside model.

use super::Model;
use crate::report::{
    Axis, Block, Corner, Figure, Panel, Section, Series,
    parts::{Clock, quantile},
};

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
        curves.add(Series::line(&model.name, model.colour, model.drift.clone()));
    }
    if !drifts.is_empty() {
        blocks.push(Block::Figure(Figure {
            name: "drift".into(),
            caption: "Horizontal error since the cut, root mean square over the outages.".into(),
            columns: 1,
            panels: vec![curves],
        }));
    }
    let names = || models.iter().map(|m| m.name.clone());
    let all: Vec<f64> = models
        .iter()
        .flat_map(|m| m.largest())
        .filter(|e| *e > 0.0)
        .collect();
    let rms: Vec<f64> = models.iter().map(|m| m.rms()).collect();
    let mut bars = Panel::new(
        "Root mean square",
        Axis::categories(names()),
        axis_for(&rms, "largest horizontal error [m]"),
    );
    let mut boxes = Panel::new(
        "Spread over the outages",
        Axis::categories(names()),
        axis_for(&all, "largest horizontal error [m]"),
    );
    for (at, model) in models.iter().enumerate() {
        let x = at as f64;
        if model.rms().is_finite() {
            bars.add(Series::bars("", model.colour, vec![(x, model.rms())]));
        }
        let largest = model.largest();
        let quartiles = [0.0, 0.25, 0.5, 0.75, 1.0].map(|share| quantile(&largest, share));
        if quartiles.iter().all(|q| q.is_finite()) {
            boxes.add(Series::boxes("", model.colour, vec![(x, quartiles)]));
        }
    }
    blocks.push(Block::Figure(Figure {
        name: "models".into(),
        caption: "The models compared: largest horizontal error of each outage, its root mean square, and its least, quartiles, median and largest over the outages.".into(),
        columns: 2,
        panels: vec![bars, boxes],
    }));
    blocks.extend(outage_by_outage(&models));
    Some(Section {
        title: "Drift without GNSS".into(),
        blocks,
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
    let mut panel = Panel::new("", Axis::new(&clock.label()), y).legend(Corner::UpperRight);
    for model in models {
        let outages = model.errors.per_outage.iter().zip(model.largest());
        let points: Vec<(f64, f64)> = outages.map(|(o, e)| (clock.at(o.start_s.0), e)).collect();
        panel.add(Series::line(&model.name, model.colour, points.clone()));
        panel.add(Series::dots("", model.colour, points));
    }
    Some(Block::Figure(Figure {
        name: "outage-by-outage".into(),
        caption: "Largest horizontal error of each outage, at the time of its start.".into(),
        columns: 1,
        panels: vec![panel],
    }))
}

/// Logarithmic where the values reach over more than a decade and a half.
fn axis_for(values: &[f64], label: &str) -> Axis {
    let (least, most) = (quantile(values, 0.0), quantile(values, 1.0));
    if least > 0.0 && most / least > 30.0 {
        Axis::logarithmic(label)
    } else {
        Axis::new(label)
    }
}
