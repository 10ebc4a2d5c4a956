//! Static figures as SVG.

pub(crate) mod draw;
pub mod panel;
mod shapes;

use panel::{Axis, Panel, Series};
use plotters::prelude::*;
use std::path::Path;
use undrift::{
    consistency::GROUP,
    nav::{earth::Geodetic, sample::TruthSample},
    outages::DriftCurve,
    replay::Outage,
    results::{MonteCarlo, Number},
};

/// Colours that stay apart in grey and for the colour-blind (Okabe & Ito 2008).
pub(crate) const COLOURS: [RGBColor; 8] = [
    RGBColor(0, 0, 0),
    RGBColor(120, 120, 120),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(0, 158, 115),
    RGBColor(230, 159, 0),
    RGBColor(213, 94, 0),
    RGBColor(0, 114, 178),
];

/// Draws the trajectory to scale with its outages, and the drift of each model since the cut.
///
/// # Errors
/// A sentence for the user when the file cannot be written.
pub fn experiment(
    path: &Path,
    truth: &[TruthSample],
    outages: &[Outage],
    curves: &[DriftCurve],
) -> Result<(), String> {
    draw(path, truth, outages, curves).map_err(|e| format!("cannot draw {}: {e}", path.display()))
}

fn draw(
    path: &Path,
    truth: &[TruthSample],
    outages: &[Outage],
    curves: &[DriftCurve],
) -> Result<(), Box<dyn std::error::Error>> {
    let root = SVGBackend::new(path, (1160, 520)).into_drawing_area();
    root.fill(&WHITE)?;
    let (left, right) = root.split_horizontally(540);
    draw_trajectory(&left, truth, outages)?;
    draw_drift(&right, curves)?;
    root.present()?;
    Ok(())
}

type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

fn draw_trajectory(
    area: &Area,
    truth: &[TruthSample],
    outages: &[Outage],
) -> Result<(), Box<dyn std::error::Error>> {
    let origin = truth.first().map_or(Geodetic::default(), |t| t.position);
    // Ten points a second are plenty on paper.
    let every = (truth.len() / 6000).max(1);
    let track: Vec<(f64, (f64, f64))> = truth
        .iter()
        .step_by(every)
        .map(|t| {
            let ned = origin.ned_to(&t.position);
            (t.time, (ned.y, ned.x))
        })
        .collect();
    let (mut east, mut north) = ((0.0f64, 0.0f64), (0.0f64, 0.0f64));
    for (_, (e, n)) in &track {
        east = (east.0.min(*e), east.1.max(*e));
        north = (north.0.min(*n), north.1.max(*n));
    }
    // One metre east is as long as one metre north.
    let half = 0.53 * (east.1 - east.0).max(north.1 - north.0).max(1.0);
    let (ce, cn) = ((east.0 + east.1) / 2.0, (north.0 + north.1) / 2.0);
    let mut chart = ChartBuilder::on(area)
        .margin(14)
        .caption("Drive, GNSS outages in orange", ("sans-serif", 18))
        .x_label_area_size(38)
        .y_label_area_size(58)
        .build_cartesian_2d(ce - half..ce + half, cn - half..cn + half)?;
    chart
        .configure_mesh()
        .x_desc("east [m]")
        .y_desc("north [m]")
        .light_line_style(WHITE)
        .label_style(("sans-serif", 13))
        .draw()?;
    chart.draw_series(LineSeries::new(
        track.iter().map(|p| p.1),
        RGBColor(90, 90, 90).stroke_width(1),
    ))?;
    for outage in outages {
        let inside = track
            .iter()
            .filter(|(t, _)| outage.contains(*t))
            .map(|p| p.1);
        chart.draw_series(LineSeries::new(inside, COLOURS[6].stroke_width(4)))?;
    }
    Ok(())
}

fn draw_drift(area: &Area, curves: &[DriftCurve]) -> Result<(), Box<dyn std::error::Error>> {
    const LEAST: f64 = 0.01;
    let mut panel = Panel::new(
        "Horizontal drift since the cut, RMS over the outages",
        Axis::new("time since the cut [s]"),
        Axis::logarithmic("horizontal error [m]"),
    );
    for (i, curve) in curves.iter().enumerate() {
        let points = curve.points.iter().map(|(t, e)| (*t, e.max(LEAST)));
        panel.add(Series::line(curve.name, i, points.collect()));
    }
    panel.draw(area, 1)
}

/// Draws the average NEES over time with its 95 % bounds: a panel per group of states, a line per model.
///
/// # Errors
/// A sentence for the user when the file cannot be written.
pub fn consistency(path: &Path, report: &MonteCarlo) -> Result<(), String> {
    draw_consistency(path, report).map_err(|e| format!("cannot draw {}: {e}", path.display()))
}

fn draw_consistency(path: &Path, report: &MonteCarlo) -> Result<(), Box<dyn std::error::Error>> {
    let root = SVGBackend::new(path, (1160, 980)).into_drawing_area();
    root.fill(&WHITE)?;
    for (group, area) in root.split_evenly((3, 2)).iter().enumerate() {
        draw_nees(area, report, GROUP[group].0, group == 1)?;
    }
    root.present()?;
    Ok(())
}

/// Panel of one group: NEES per degree of freedom, so that 1 is right in each.
fn draw_nees(
    area: &Area,
    report: &MonteCarlo,
    name: &str,
    legend: bool,
) -> Result<(), Box<dyn std::error::Error>> {
    const RANGE: (f64, f64) = (0.1, 1000.0);
    let end = report.time_s.last().map_or(1.0, |t| t.0);
    let mut chart = ChartBuilder::on(area)
        .margin(10)
        .margin_right(26)
        .caption(
            format!("{name}: average NEES / degrees of freedom"),
            ("sans-serif", 16),
        )
        .x_label_area_size(36)
        .y_label_area_size(52)
        .build_cartesian_2d(0.0..end, (RANGE.0..RANGE.1).log_scale())?;
    chart
        .configure_mesh()
        .x_desc("time [s]")
        .light_line_style(WHITE)
        .label_style(("sans-serif", 12))
        .x_label_formatter(&|t| format!("{t:.0}"))
        .y_label_formatter(&|v| format!("{v}"))
        .draw()?;
    let groups: Vec<_> = report
        .models
        .iter()
        .filter_map(|m| Some((m, m.nees.iter().find(|g| g.name == name)?)))
        .collect();
    let line = |series: &[Number], freedom: u64| -> Vec<(f64, f64)> {
        let scaled = series.iter().map(|v| v.get().map(|v| v / freedom as f64));
        report
            .time_s
            .iter()
            .zip(scaled)
            .filter_map(|(t, v)| Some((t.0, v?.clamp(RANGE.0, RANGE.1))))
            .collect()
    };
    if let Some((model, group)) = groups.first() {
        let settled = model.started_s.0 + report.settle_s.0;
        chart.draw_series([Rectangle::new(
            [(0.0, RANGE.0), (settled.min(end), RANGE.1)],
            RGBColor(244, 244, 244).filled(),
        )])?;
        for bound in [&group.lower, &group.upper] {
            let points = line(bound, group.freedom);
            chart.draw_series(LineSeries::new(
                points,
                RGBColor(90, 90, 90).stroke_width(1),
            ))?;
        }
    }
    // The first model on top.
    for (i, (model, group)) in groups.iter().enumerate().rev() {
        let colour = [
            COLOURS[7], COLOURS[6], COLOURS[5], COLOURS[2], COLOURS[3], COLOURS[4],
        ][i % 6];
        chart
            .draw_series(LineSeries::new(
                line(&group.average, group.freedom),
                colour.stroke_width(2),
            ))?
            .label(&model.name)
            .legend(move |(x, y)| {
                PathElement::new(vec![(x, y), (x + 18, y)], colour.stroke_width(2))
            });
    }
    if legend {
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::MiddleRight)
            .background_style(WHITE.mix(0.85))
            .border_style(RGBColor(200, 200, 200))
            .label_font(("sans-serif", 12))
            .draw()?;
    }
    Ok(())
}
