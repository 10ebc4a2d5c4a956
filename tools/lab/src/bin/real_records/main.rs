//! What static records say about a sensor: every axis of run1, run2 and run4 identified, tables on
//! the standard output, figures beside.
//!
//! `cargo run --release -p undrift-lab --bin real_records -- DATA/adis16405-static docs/figures [SAMPLES]`
//!
//! SAMPLES takes that many from the start of each record, for a quick look.

mod figures;
mod tables;

use std::path::Path;
use undrift::{
    identify::{self, Identified},
    io::Opened,
    noise::{
        ImuModel,
        allan::{self, DeviationKind, Grid},
        identify::{Axis, Options},
        spectrum::{self, Density},
    },
    record::{self, Record, RecordFormat},
};

const RATE: f64 = 100.0;
/// Outliers closer than this belong to one disturbance [s].
const APART: f64 = 20.0;

type Failure = Box<dyn std::error::Error>;

/// One record and what was found.
struct Run {
    name: &'static str,
    record: Record,
    found: Identified,
}

/// Units in which an axis is shown: of the rate, of its integral and of noise densities.
struct Units {
    rate: &'static str,
    /// Of one unit [SI].
    one_rate: f64,
    walk: &'static str,
    /// Of one unit [SI/√Hz].
    one_walk: f64,
    integral: &'static str,
    /// Of one unit [SI·s].
    one_integral: f64,
    /// Of a rate per √hour.
    rate_walk: &'static str,
}

const GYRO: Units = Units {
    rate: "deg/h",
    one_rate: std::f64::consts::PI / 180.0 / 3600.0,
    walk: "deg/√h",
    one_walk: std::f64::consts::PI / 180.0 / 60.0,
    integral: "deg",
    one_integral: std::f64::consts::PI / 180.0,
    rate_walk: "deg/h/√h",
};

const ACCELEROMETER: Units = Units {
    rate: "mg",
    one_rate: 9.80665e-3,
    walk: "m/s/√h",
    one_walk: 1.0 / 60.0,
    integral: "m/s",
    one_integral: 1.0,
    rate_walk: "mg/√h",
};

fn units(axis: &str) -> &'static Units {
    if axis.starts_with("accel") {
        &ACCELEROMETER
    } else {
        &GYRO
    }
}

/// Outliers of all axes that belong together.
struct Disturbance {
    from_s: f64,
    to_s: f64,
    /// Axis with its outliers' positions.
    samples: Vec<(usize, usize)>,
    /// Largest distance in robust standard deviations.
    largest: f64,
}

impl Run {
    /// Axes that were identified, by their index.
    fn axes(&self) -> impl Iterator<Item = (usize, &'static str, &Axis)> {
        let axes = self.found.axes.iter().enumerate();
        axes.filter_map(|(i, (name, axis))| Some((i, *name, axis.as_ref().ok()?)))
    }

    fn axis(&self, index: usize) -> Option<&Axis> {
        self.found.axes[index].1.as_ref().ok()
    }

    /// Outliers of all axes, those less than [`APART`] from each other taken together.
    fn disturbances(&self) -> Vec<Disturbance> {
        let mut all: Vec<(usize, usize, f64)> = self
            .axes()
            .flat_map(|(i, _, axis)| axis.outliers.iter().map(move |o| (o.index, i, o.sigmas)))
            .collect();
        all.sort_by_key(|o| (o.0, o.1));
        let mut found: Vec<Disturbance> = Vec::new();
        for (index, axis, sigmas) in all {
            let time = index as f64 / RATE;
            match found.last_mut() {
                Some(last) if time < last.to_s + APART => {
                    last.to_s = time;
                    last.samples.push((axis, index));
                    last.largest = last.largest.max(sigmas.abs());
                }
                _ => found.push(Disturbance {
                    from_s: time,
                    to_s: time,
                    samples: vec![(axis, index)],
                    largest: sigmas.abs(),
                }),
            }
        }
        found
    }

    /// Frequency of the sharpest line of the first accelerometer below 2 Hz, to a part in 10⁴ of the
    /// rate [Hz].
    fn line_hz(&self) -> Option<f64> {
        let samples = self.record.samples.get(3)?;
        let psd = spectrum::welch(samples, RATE, samples.len().min(1 << 17)).ok()?;
        let bins = psd.frequency_hz.iter().zip(&psd.density);
        let slow = bins.filter(|(f, _)| (0.3..2.0).contains(*f));
        slow.max_by(|a, b| a.1.total_cmp(b.1)).map(|(f, _)| *f)
    }

    /// Spectrum of an axis over the longest time without a disturbance, two seconds from either end.
    fn quiet_density(&self, index: usize) -> Option<Density> {
        let samples = &self.record.samples[index];
        let at = |time: f64| ((time * RATE) as usize).min(samples.len());
        let mut from = 0;
        let mut longest = 0..0;
        let ends = self.disturbances().into_iter();
        for (first, last) in ends
            .map(|d| (d.from_s, d.to_s))
            .chain([(f64::INFINITY, f64::INFINITY)])
        {
            let quiet = from..at(first - 2.0);
            if quiet.len() > longest.len() {
                longest = quiet;
            }
            from = at(last + 2.0);
        }
        spectrum::welch(&samples[longest], RATE, 8192).ok()
    }

    /// Standard deviation of an axis without its outliers [SI].
    fn deviation(&self, index: usize) -> f64 {
        let Some(axis) = self.axis(index) else {
            return f64::NAN;
        };
        let outliers: Vec<usize> = axis.outliers.iter().map(|o| o.index).collect();
        let samples = self.record.samples[index].iter().enumerate();
        let kept = samples.filter(|(k, _)| outliers.binary_search(k).is_err());
        root_mean_square(kept.map(|(_, x)| x - axis.mean))
    }

    /// White noise [SI/√Hz] and standard deviation [SI] of an axis with the disturbances left in,
    /// fitted over the same averaging times.
    fn as_recorded(&self, index: usize) -> Option<(f64, f64)> {
        let (samples, axis) = (&self.record.samples[index], self.axis(index)?);
        let curve =
            allan::deviations(samples, RATE, DeviationKind::Overlapping, Grid::Octave).ok()?;
        let terms = allan::fit_terms_from(&curve, axis.allan_terms.from_s).ok()?;
        let deviation = root_mean_square(samples.iter().map(|x| x - axis.mean));
        Some((terms.white.value, deviation))
    }
}

fn root_mean_square(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), x| (sum + x * x, count + 1.0));
    f64::sqrt(sum / count)
}

fn main() -> Result<(), Failure> {
    let mut arguments = std::env::args().skip(1);
    let (Some(folder), Some(figures)) = (arguments.next(), arguments.next()) else {
        return Err("usage: real_records FOLDER FIGURES [SAMPLES]".into());
    };
    let most: usize = arguments.next().map_or(Ok(usize::MAX), |n| n.parse())?;
    let sheet = ImuModel::preset("adis16405").ok_or("no preset")?;
    let mut runs = Vec::new();
    for name in ["run1", "run2", "run4"] {
        let path = Path::new(&folder).join(format!("{name}.csv.gz"));
        let mut record = record::read(Opened::open(&path)?, &RecordFormat::default())?;
        record
            .samples
            .iter_mut()
            .for_each(|axis| axis.truncate(most));
        let found = identify::run(&record, &Options::at(RATE), || {});
        runs.push(Run {
            name,
            record,
            found,
        });
    }
    tables::print(&runs, &sheet);
    std::fs::create_dir_all(&figures)?;
    figures::draw(&runs, &sheet, Path::new(&figures))?;
    Ok(())
}
