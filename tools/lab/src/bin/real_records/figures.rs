//! The figures.

use super::{Failure, RATE, Run, units};
use std::path::Path;
use undrift::noise::{
    BiasModel, ImuModel,
    allan::gauss_markov::gauss_markov_variance,
    drift_score,
    model_file::AxisModel,
    screening::{OutlierRule, outliers, remove_constant},
};
use undrift_report::{Panel, PlotAxis as Axis, Series, figure::draw::draw as draw_panels};

/// Colour of each run.
const COLOURS: [usize; 3] = [5, 7, 4];
const GREY: usize = 1;

const AXES: [&str; 6] = [
    "gyro x",
    "gyro y",
    "gyro z",
    "accelerometer x",
    "accelerometer y",
    "accelerometer z",
];

pub fn draw(runs: &[Run], sheet: &ImuModel, folder: &Path) -> Result<(), Failure> {
    let sheet_axes = sheet.axes();
    for (kind, axes) in [("gyro", 0..3), ("accel", 3..6)] {
        let each = |panel: &dyn Fn(usize) -> Panel| axes.clone().map(panel).collect::<Vec<_>>();
        let save = |name: &str, panels: &[Panel]| {
            let path = folder.join(format!("{name}-{kind}.svg"));
            draw_panels(&path, panels, 3, (420, 400))
        };
        save("allan", &each(&|i| allan(runs, i, sheet_axes[i].1)))?;
        save("psd", &each(&|i| density(runs, i)))?;
        save("drift", &each(&|i| drift(&runs[1], i, sheet_axes[i].1)))?;
    }
    let wander: Vec<Panel> = (0..6).map(|i| wander(runs, i)).collect();
    draw_panels(&folder.join("wander.svg"), &wander, 3, (420, 300))?;
    if let Some(run) = runs.last() {
        draw_panels(
            &folder.join("disturbances-run4.svg"),
            &disturbances(run),
            3,
            (420, 320),
        )?;
    }
    Ok(())
}

/// Allan deviation of the runs with the fitted terms of the second and the data sheet's model.
fn allan(runs: &[Run], index: usize, sheet: &AxisModel) -> Panel {
    let u = units(runs[0].record.axes[index]);
    let mut panel = Panel::new(
        AXES[index],
        Axis::logarithmic("averaging time [s]"),
        Axis::logarithmic(&format!("Allan deviation [{}]", u.rate)),
    );
    let found = |run: &'_ Run| run.axis(index).cloned();
    let mut taus = Vec::new();
    for (run, colour) in runs.iter().zip(COLOURS) {
        let Some(axis) = found(run) else { continue };
        let points = axis.allan.points.iter().zip(&axis.allan_intervals);
        let bounds: Vec<(f64, f64, f64)> = points
            .map(|(p, i)| (p.tau_s, i.lower / u.one_rate, i.upper / u.one_rate))
            .collect();
        panel.add(Series::band("", colour, &bounds));
        taus = axis.allan.points.iter().map(|p| p.tau_s).collect();
    }
    for (run, colour) in runs.iter().zip(COLOURS) {
        let Some(axis) = found(run) else { continue };
        let points = axis.allan.points.iter();
        let curve = points
            .map(|p| (p.tau_s, p.deviation / u.one_rate))
            .collect();
        panel.add(Series::line(run.name, colour, curve));
    }
    let model = |variance: &dyn Fn(f64) -> f64| -> Vec<(f64, f64)> {
        let points = taus
            .iter()
            .map(|&tau| (tau, variance(tau).sqrt() / u.one_rate));
        points.collect()
    };
    if let Some(axis) = found(&runs[1]) {
        let terms = axis.allan_terms;
        let mut fitted = model(&|tau| terms.variance(tau));
        fitted.retain(|point| point.0 >= terms.from_s);
        panel.add(Series::dashed("run2, fitted terms", 0, fitted));
    }
    let of_sheet = model(&|tau| {
        let white = sheet.white.unwrap_or(0.0).powi(2) / tau;
        let slow = sheet.instability.iter();
        white
            + slow
                .map(|p| gauss_markov_variance(tau, p.sigma, p.tau_s))
                .sum::<f64>()
    });
    panel.add(Series::dashed("data sheet", GREY, of_sheet));
    panel
}

/// Amplitude spectral density of the runs: bins of a hundredth of a decade.
fn density(runs: &[Run], index: usize) -> Panel {
    const BINS: f64 = 100.0;
    let u = units(runs[0].record.axes[index]);
    let mut panel = Panel::new(
        AXES[index],
        Axis::logarithmic("frequency [Hz]"),
        Axis::logarithmic(&format!("amplitude density [{}/√Hz]", u.rate)),
    );
    for (run, colour) in runs.iter().zip(COLOURS) {
        let Some(axis) = run.axis(index) else {
            continue;
        };
        // Position, sum of densities and their number of each bin.
        let mut bins: Vec<(i64, f64, f64, f64)> = Vec::new();
        for (f, density) in axis.psd.frequency_hz.iter().zip(&axis.psd.density).skip(1) {
            let place = (f.log10() * BINS).floor() as i64;
            match bins.last_mut() {
                Some(bin) if bin.0 == place => {
                    (bin.1, bin.2, bin.3) = (bin.1 + f, bin.2 + density, bin.3 + 1.0);
                }
                _ => bins.push((place, *f, *density, 1.0)),
            }
        }
        let points = bins
            .iter()
            .map(|(_, f, density, count)| (f / count, (density / count).sqrt() / u.one_rate));
        panel.add(Series::thin(run.name, colour, points.collect()));
    }
    panel
}

/// Drift of candidate models over the horizon, on the half of the record that was not fitted.
fn drift(run: &Run, index: usize, sheet: &AxisModel) -> Panel {
    const HORIZONS: [f64; 9] = [0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 60.0, 120.0];
    let u = units(run.record.axes[index]);
    let mut panel = Panel::new(
        AXES[index],
        Axis::logarithmic("horizon [s]"),
        Axis::logarithmic(&format!("RMS error of the prediction [{}]", u.integral)),
    );
    let Some(axis) = run.axis(index) else {
        return panel;
    };
    let record = &run.record.samples[index];
    let Some(cleaned) = remove_constant(record)
        .and_then(|plain| outliers(&plain.residuals, OutlierRule::default()))
        .ok()
    else {
        return panel;
    };
    let curve = |model: &AxisModel, kind: BiasModel| -> Option<Vec<(f64, f64)>> {
        let filter = model.shaping(kind, 1.0 / RATE).ok()?;
        let half = record.len() / 2;
        let scores = drift_score::score(&cleaned.cleaned, half, &filter, &HORIZONS).ok()?;
        let points = scores.iter().map(|s| (s.horizon_s, s.rms / u.one_integral));
        Some(points.collect())
    };
    let of_sheet = AxisModel {
        turn_on: axis.recommended().model.turn_on,
        ..sheet.clone()
    };
    if let Some(points) = curve(&of_sheet, BiasModel::GaussMarkov) {
        panel.add(Series::dashed("data sheet", GREY, points));
    }
    let wanted: [(&str, usize); 4] = [
        ("white", 0),
        ("ARMA(1,1)", 5),
        ("white + Gauss-Markov", 3),
        ("white + random walk", 4),
    ];
    let chosen = axis.recommended();
    for (name, colour) in wanted {
        let named = axis.candidates.iter().find(|c| c.name == name);
        if let Some(candidate) = named.filter(|c| c.name != chosen.name)
            && let Some(points) = curve(&candidate.model, BiasModel::Arma)
        {
            // In dashes, for it may lie on the white one.
            panel.add(if name == "ARMA(1,1)" {
                Series::dashed(name, colour, points)
            } else {
                Series::line(name, colour, points)
            });
        }
    }
    if let Some(points) = curve(&chosen.model, BiasModel::Arma) {
        panel.add(Series::thick(&chosen.name, 7, points));
    }
    panel
}

/// Means of a minute over the hours of each run, about the run's own mean.
fn wander(runs: &[Run], index: usize) -> Panel {
    const BLOCK: usize = 6000;
    let u = units(runs[0].record.axes[index]);
    let mut panel = Panel::new(
        AXES[index],
        Axis::new("time [h]"),
        Axis::new(&format!("mean of a minute [{}]", u.rate)),
    );
    for (run, colour) in runs.iter().zip(COLOURS) {
        let mean = run.axis(index).map_or(0.0, |a| a.mean);
        let points = run.record.samples[index].chunks_exact(BLOCK).enumerate();
        let points = points.map(|(k, block)| {
            let time = (k as f64 + 0.5) * BLOCK as f64 / RATE / 3600.0;
            let level = block.iter().sum::<f64>() / BLOCK as f64;
            (time, (level - mean) / u.one_rate)
        });
        panel.add(Series::line(run.name, colour, points.collect()));
    }
    panel
}

/// The record around each disturbance, axes with outliers only, in standard deviations.
fn disturbances(run: &Run) -> Vec<Panel> {
    // On paper a few hundred points show a curve: the largest of each stretch.
    const POINTS: usize = 150;
    let around = |d: &super::Disturbance| {
        let (from, to) = (d.from_s - 2.0, d.to_s + 2.0);
        let mut panel = Panel::new(
            &if d.to_s > d.from_s {
                format!("{:.1} s to {:.1} s", d.from_s, d.to_s)
            } else {
                format!("{:.1} s", d.from_s)
            },
            Axis::new("time [s]").within(from.max(0.0)..to),
            Axis::new("standard deviations"),
        );
        for (index, name, axis) in run.axes() {
            let hits: Vec<usize> = d
                .samples
                .iter()
                .filter(|s| s.0 == index)
                .map(|s| s.1)
                .collect();
            if hits.is_empty() {
                continue;
            }
            let deviation = axis.allan.points[0].deviation;
            let samples = &run.record.samples[index];
            let at = |k: usize| (k as f64 / RATE, (samples[k] - axis.mean) / deviation);
            let first = (from.max(0.0) * RATE) as usize;
            let last = ((to * RATE) as usize).min(samples.len());
            let stretch = ((last - first) / POINTS).max(1);
            let starts = (first..last).step_by(stretch);
            let largest = starts.filter_map(|start| {
                let stretch = start..(start + stretch).min(last);
                stretch
                    .map(at)
                    .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
            });
            panel.add(Series::thin(
                &name.replace('_', " "),
                index + 2,
                largest.collect(),
            ));
            panel.add(Series::dots(
                "",
                index + 2,
                hits.into_iter().map(at).collect(),
            ));
        }
        panel
    };
    run.disturbances().iter().map(around).collect()
}
