//! What is compared: models that one static record gives, each as its authors make it.

use super::{DemoError, PRESET, RATE_HZ, REST, Source, sensor};
use sensor::Samples;
use undrift_drive::identify::Identified;
use undrift_nav::{covariance, shaping::ShapingFilter};
use undrift_noise::{
    AxisModel, BiasModel, ImuModel, compared::Method, identify::Axis, model_file::AXES,
};
use undrift_results::demo::{BOUND, PAPER, PAPER_EXACT, RECOMMENDED, UNCALIBRATED, WHITE};

/// Its candidate: the paper prints φ = 1.0000.
pub(super) const UNIT_ROOT: &str = "ARMA(1,1), unit root";

/// One row of the tables.
pub(super) struct Model {
    pub(super) name: &'static str,
    pub(super) filters: [ShapingFilter; covariance::AXES],
    pub(super) samples: Samples,
    /// Axes of which the method has no model.
    pub(super) without: Vec<&'static str>,
}

impl Model {
    /// Whether it is no model to choose.
    pub(super) fn is_bound(&self) -> bool {
        self.name == BOUND
    }
}

/// Which candidate of an axis a row takes, by the start of its name, and how it runs.
const ROWS: [(&str, &str, BiasModel); 8] = [
    (PAPER, UNIT_ROOT, BiasModel::Paper),
    (PAPER_EXACT, UNIT_ROOT, BiasModel::Arma),
    (
        "power spectrum",
        Method::PowerSpectrum.candidate(),
        BiasModel::Arma,
    ),
    (
        "autocorrelation",
        Method::Autocorrelation.candidate(),
        BiasModel::Arma,
    ),
    (
        "Allan",
        "white + random walk (Allan)",
        BiasModel::RandomWalk,
    ),
    (
        "Gauss-Markov",
        Method::AllanMinimum.candidate(),
        BiasModel::GaussMarkov,
    ),
    (
        "composite",
        Method::AllanBound.candidate(),
        BiasModel::GaussMarkov,
    ),
    ("AR", "AR(", BiasModel::Arma),
];

/// The axes of what was identified.
pub(super) fn axes(identified: &Identified) -> Result<Vec<(&'static str, &Axis)>, DemoError> {
    let axis = |name: &'static str| {
        let found = identified.axes.iter().find(|(of, _)| *of == name);
        match found {
            Some((_, Ok(axis))) => Ok((name, axis)),
            Some((_, Err(error))) => Err(DemoError::Axis {
                axis: name,
                error: error.to_string(),
            }),
            None => Err(DemoError::Axis {
                axis: name,
                error: "not in the recording".into(),
            }),
        }
    };
    AXES.into_iter().map(axis).collect()
}

/// σ of what is left of a constant after the rest is averaged: that of the mean of white noise and of a random walk
/// about its end, as the record's Allan deviation has them.
fn left_after_rest(axis: &Axis) -> f64 {
    let terms = &axis.allan_terms;
    let (n, k) = (terms.white.value, terms.random_walk.value);
    (n * n / REST + k * k * REST / 3.0).sqrt()
}

/// A model of six axes.
fn model_of_axes(
    axes: &[(&'static str, &Axis)],
    mut of: impl FnMut(usize, &'static str, &Axis) -> AxisModel,
) -> ImuModel {
    let mut model = ImuModel::default();
    let slots = model.gyro.iter_mut().chain(&mut model.accel);
    for ((i, (name, axis)), slot) in axes.iter().enumerate().zip(slots) {
        *slot = of(i, name, axis);
    }
    model
}

/// The candidate of each axis whose name starts so, white noise without one.
pub(super) fn candidate(
    axes: &[(&'static str, &Axis)],
    start: &str,
    without: &mut Vec<&'static str>,
) -> ImuModel {
    model_of_axes(axes, |_, name, axis| {
        let named = |start: &str| axis.candidates.iter().find(|c| c.name.starts_with(start));
        let chosen = named(start).or_else(|| {
            without.push(name);
            named("white")
        });
        AxisModel {
            turn_on: left_after_rest(axis),
            ..chosen.map_or_else(|| axis.model(), |c| c.model.clone())
        }
    })
}

/// The rows; the recommended model comes before the last ones, which are to be set apart.
pub(super) fn models(source: &Source, identified: &Identified) -> Result<Vec<Model>, DemoError> {
    let axes = axes(identified)?;
    let interval = 1.0 / RATE_HZ;
    let sheet = ImuModel::preset(PRESET).unwrap_or_default();
    let recommended = model_of_axes(&axes, |_, _, axis| AxisModel {
        turn_on: left_after_rest(axis),
        ..axis.model()
    });
    let uncalibrated = model_of_axes(&axes, |i, _, axis| AxisModel {
        turn_on: sheet.axes()[i].1.turn_on,
        ..axis.model()
    });
    let of_sheet = model_of_axes(&axes, |i, _, axis| AxisModel {
        turn_on: left_after_rest(axis),
        ..sheet.axes()[i].1.clone()
    });
    let row = |name, model: &ImuModel, kind, samples| -> Result<Model, DemoError> {
        Ok(Model {
            name,
            filters: model.shaping(kind, interval)?,
            samples,
            without: Vec::new(),
        })
    };
    let arma = BiasModel::Arma;
    let mut rows = vec![row(WHITE, &recommended, BiasModel::White, Samples::Rested)?];
    for (name, start, kind) in ROWS {
        let mut without = Vec::new();
        let model = candidate(&axes, start, &mut without);
        rows.push(Model {
            without,
            ..row(name, &model, kind, Samples::Rested)?
        });
    }
    rows.push(row(
        "data sheet",
        &of_sheet,
        BiasModel::GaussMarkov,
        Samples::Rested,
    )?);
    rows.push(row(RECOMMENDED, &recommended, arma, Samples::Rested)?);
    rows.push(row(UNCALIBRATED, &uncalibrated, arma, Samples::Raw)?);
    if matches!(source, Source::Simulated) {
        let mut exact = sensor::truth();
        for axis in exact.gyro.iter_mut().chain(&mut exact.accel) {
            axis.turn_on = 0.0;
        }
        rows.push(row(BOUND, &exact, BiasModel::RandomWalk, Samples::Exact)?);
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_drive::{identify::run, record::Record};
    use undrift_noise::identify::Options;

    /// The mean of white noise, and of a walk about its end: of n steps the one k steps before the end is in k/n of it.
    #[test]
    fn a_mean_over_the_rest_is_off_by_white_noise_and_the_walk_since() {
        let record = Record {
            axes: vec!["gyro_x"],
            samples: vec![(0..2000).map(|k| f64::from(k * 7919 % 1009)).collect()],
            ..Record::default()
        };
        let options = Options {
            n_max: 1,
            ..Options::at(RATE_HZ)
        };
        let (_, axis) = run(&record, &options, || ()).axes.remove(0);
        let mut axis = axis.unwrap();
        let steps = (REST * RATE_HZ) as u32;
        for (white, walk) in [(0.3, 0.0), (0.0, 0.02), (0.3, 0.02)] {
            axis.allan_terms.white.value = white;
            axis.allan_terms.random_walk.value = walk;
            let of_white = white * white * RATE_HZ / f64::from(steps);
            let share = |k: u32| (f64::from(k) / f64::from(steps)).powi(2);
            let of_walk = walk * walk / RATE_HZ * (0..steps).map(share).sum::<f64>();
            let left = left_after_rest(&axis);
            // A sum of 6000 terms for an integral.
            let exact = (of_white + of_walk).sqrt();
            assert!((left / exact - 1.0).abs() < 2e-4, "{left} {exact}");
        }
    }
}
