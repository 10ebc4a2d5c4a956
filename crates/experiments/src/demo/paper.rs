//! The source paper's tables and figures: its orders, its equation 2, its outages on one drive.

use super::{
    DURATION, DemoError, Experiment, Model, PAPER, RATE_HZ, WHITE,
    models::{self},
    ridden,
    sensor::{Ride, Samples},
    settings,
};
use undrift_drive::{
    identify::Identified,
    outages::ModelOutcome,
    record::Record,
    reference::{self, Errors, HORIZONTAL, TruthCursor},
    replay::{Observer, ReplayError, Settings, replay},
};
use undrift_engine::estimator::Estimator;
use undrift_nav::sample::TruthSample;
use undrift_noise::{
    BiasModel,
    arma::{ArmaFit, FitOptions},
    identify::{Axis, Residuals, SEARCH_SAMPLES},
    pandit_wu::{PanditWu, PanditWuOptions, pandit_wu},
};
use undrift_results::demo::PAPER_EXACT;
use undrift_results::series::{ROWS, Thinned};

/// Factors on the white noise of a sample that are tried for the σ of equation (9).
pub const SCALES: [f64; 8] = [1.0, 0.3, 0.1, 0.03, 0.01, 0.003, 0.001, 0.0003];
/// The paper's axis among the six.
const AXIS: usize = 2;
/// n of the last row of its Table 3, (8,7).
const TABLE: usize = 4;
/// Effort of the search over orders.
const EFFORT: f64 = 0.2;
/// Shortest span between two rows of a track \[s\].
const ROW: f64 = 0.25;

/// What the paper prints.
pub struct Paper {
    /// Its Table 3 and tests of adequacy, of the z gyro.
    pub orders: Option<PanditWu>,
    /// Its equation 2, free and with φ = 1.
    pub one_one: [Option<ArmaFit>; 2],
    /// What its model leaves of the record.
    pub residuals: Option<Residuals>,
    /// Its Table 4: largest errors in the 10 s outages of the first drive, by model.
    pub largest: Vec<(String, Errors)>,
    /// Its Figures 4 and 5: the first drive as estimated by each filter.
    pub tracks: Vec<Track>,
    /// RMS over all 10 s outages of the largest horizontal error \[m\] of equations (3)-(9), by the factor on σ.
    pub scan: Vec<(f64, f64)>,
}

/// A solution against the truth: time \[s\], latitude and longitude \[deg\], errors north, east, down \[m\].
pub struct Track {
    /// Name of the model.
    pub name: &'static str,
    pub(super) rows: Thinned<6>,
}

/// Replays that the paper's page takes beside those of the demo.
pub(super) fn replays(experiment: &Experiment) -> usize {
    match experiment.paper {
        true => 2 + SCALES.len() * experiment.drives,
        false => 0,
    }
}

pub(super) fn paper(
    rides: &[Ride],
    models: &[Model],
    runs: &[Vec<ModelOutcome>],
    identified: &Identified,
    record: &Record,
    done: &(dyn Fn(u64) + Sync),
) -> Result<Paper, DemoError> {
    let axes = models::axes(identified)?;
    let (_, axis) = axes[AXIS];
    let centred: Vec<f64> = record.samples[AXIS].iter().map(|x| x - axis.mean).collect();
    let searched = &centred[..centred.len().min(SEARCH_SAMPLES)];
    let options = PanditWuOptions {
        n_max: 2,
        table: TABLE,
        fit: FitOptions {
            effort: EFFORT,
            ..FitOptions::default()
        },
        ..PanditWuOptions::default()
    };
    let fit = |name: &str| {
        let named = axis.candidates.iter().find(|c| c.name == name)?;
        named.arma().cloned()
    };
    let one_one = [fit("ARMA(1,1)"), fit(models::UNIT_ROOT)];
    let first = &rides[0];
    let of_first = runs.iter().filter_map(|drives| {
        let (name, run) = drives.first()?;
        let outages = &run.as_ref().ok()?.errors.per_outage;
        let largest: Vec<Errors> = outages.iter().map(|o| o.max).collect();
        Some((name.clone(), reference::max(&largest)))
    });
    let shown = models
        .iter()
        .filter(|m| [WHITE, PAPER_EXACT].contains(&m.name));
    let tracks = shown.map(|model| track(first, model, done));
    Ok(Paper {
        orders: pandit_wu(searched, &options).ok(),
        residuals: residuals(&one_one, searched),
        one_one,
        largest: of_first.collect(),
        tracks: tracks.filter_map(Result::ok).collect(),
        scan: scan(rides, &axes, done)?,
    })
}

fn residuals(one_one: &[Option<ArmaFit>; 2], searched: &[f64]) -> Option<Residuals> {
    Residuals::new(one_one[1].as_ref().or(one_one[0].as_ref())?, searched)
}

/// The literal equations at several σ.
fn scan(
    rides: &[Ride],
    axes: &[(&'static str, &Axis)],
    done: &(dyn Fn(u64) + Sync),
) -> Result<Vec<(f64, f64)>, DemoError> {
    let of_scale = |scale: f64| {
        let mut model = models::candidate(axes, models::UNIT_ROOT, &mut Vec::new());
        for axis in model.gyro.iter_mut().chain(&mut model.accel) {
            axis.paper_sigma = Some(scale * axis.white_density() * RATE_HZ.sqrt());
        }
        Ok(Model {
            name: PAPER,
            filters: model.shaping(BiasModel::Paper, 1.0 / RATE_HZ)?,
            samples: Samples::Rested,
            without: Vec::new(),
        })
    };
    let models: Vec<Model> = SCALES
        .into_iter()
        .map(of_scale)
        .collect::<Result<_, DemoError>>()?;
    let runs = ridden(rides, 0, &models, done);
    let rms = |drives: &Vec<ModelOutcome>| {
        let ran = drives.iter().filter_map(|(_, run)| run.as_ref().ok());
        let largest = ran.flat_map(|run| run.errors.per_outage.iter().map(|o| o.max));
        reference::rms(&Vec::from_iter(largest)).0[HORIZONTAL]
    };
    Ok(SCALES.into_iter().zip(runs.iter().map(rms)).collect())
}

/// The first drive by a model, with its outages of 10 s.
fn track(ride: &Ride, model: &Model, done: &(dyn Fn(u64) + Sync)) -> Result<Track, ReplayError> {
    let settings = Settings {
        restart: false,
        ..settings(ride, 0, model)
    };
    let mut watch = Watch {
        truth: TruthCursor::new(ride.simulation.truth.iter().copied()),
        rows: Thinned::new(ROWS),
        last: f64::NEG_INFINITY,
    };
    let mut samples = ride.samples(model.samples).iter().copied().map(Ok);
    let mut fixes = ride.fixes.iter().copied().map(Ok);
    replay(&mut samples, &mut fixes, &settings, &mut watch)?;
    done((DURATION * RATE_HZ) as u64);
    Ok(Track {
        name: model.name,
        rows: watch.rows,
    })
}

struct Watch<'a> {
    truth: TruthCursor<std::iter::Copied<std::slice::Iter<'a, TruthSample>>>,
    rows: Thinned<6>,
    last: f64,
}

impl Observer for Watch<'_> {
    fn sample(&mut self, filter: &dyn Estimator) -> Result<(), ReplayError> {
        let nav = filter.nav();
        if nav.time - self.last >= ROW - 1e-6
            && let Some(truth) = self.truth.at(nav.time)
        {
            self.last = nav.time;
            let Errors([north, east, down, ..]) = Errors::against_truth(nav, &truth);
            let (lat, lon) = (nav.position.lat, nav.position.lon);
            let row = [
                nav.time,
                lat.to_degrees(),
                lon.to_degrees(),
                north,
                east,
                down,
            ];
            self.rows.add(row);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::{
        super::{Source, sensor},
        *,
    };
    use std::sync::atomic::{AtomicU64, Ordering};

    #[test]
    fn a_track_has_four_rows_a_second() {
        let experiment = Experiment {
            seed: 3,
            drives: 1,
            source: Source::Simulated,
            paper: true,
        };
        let rides = sensor::rides(&experiment, &|| ()).unwrap();
        let truth = sensor::truth();
        let model = Model {
            name: WHITE,
            filters: truth.shaping(BiasModel::White, 1.0 / RATE_HZ).unwrap(),
            samples: Samples::Exact,
            without: Vec::new(),
        };
        let done = AtomicU64::new(0);
        let track = track(&rides[0], &model, &|more| {
            done.fetch_add(more, Ordering::Relaxed);
        });
        let track = track.unwrap();
        assert_eq!(done.into_inner(), rides[0].simulation.imu.len() as u64);
        let rows = track.rows.rows();
        let (first, last) = (rows[0][0], rows[rows.len() - 1][0]);
        assert!(last > DURATION - 2.0 * ROW, "{first} to {last}");
        for pair in rows.windows(2) {
            let apart = pair[1][0] - pair[0][0];
            assert!((apart - ROW).abs() < 1e-9, "{apart}");
        }
    }
}
