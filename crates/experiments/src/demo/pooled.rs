//! The outages of one length, pooled over the drives, with intervals by bootstrap over the outages.

use super::models::Model;
use rand::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use undrift_base::order_statistics::quantile;
use undrift_drive::{
    outages::{ModelErrors, ModelOutcome, drift_curve},
    reference::{self, Errors, HORIZONTAL},
};
use undrift_results::demo::WHITE;

/// Draws of the bootstrap.
const DRAWS: usize = 2000;
/// Its seed.
const SEED: u64 = 1;
/// Probabilities of the intervals' ends.
const ENDS: [f64; 2] = [0.025, 0.975];

/// A number with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Of the outages as they are.
    pub value: f64,
    /// Over draws of as many outages, with replacement.
    pub interval: [f64; 2],
}

impl Estimate {
    /// Whether one lies in the interval.
    pub fn is_one(&self) -> bool {
        self.interval[0] <= 1.0 && 1.0 <= self.interval[1]
    }
}

/// What the outages of one length did to a model.
#[derive(Clone, Debug)]
pub struct Pooled {
    /// Largest magnitude over all outages.
    pub max: Errors,
    /// RMS over the outages of the largest error of each.
    pub rms: Errors,
    /// The same of the horizontal error alone \[m\].
    pub horizontal: Estimate,
    /// How many times less that is than of white noise; paired, the same outages in both.
    pub less_than_white: Estimate,
    /// How many times more it is than the least of all models to choose.
    pub over_least: Estimate,
    /// Largest horizontal error of each outage \[m\].
    pub largest: Vec<f64>,
    /// RMS over the outages of the horizontal error at each time since the cut: \[s\], \[m\].
    pub drift: Vec<(f64, f64)>,
    /// Why a drive has no solution, if so.
    pub failed: Option<String>,
}

/// Pools by model; `runs` are by model, then by drive.
pub(super) fn pooled(models: &[Model], runs: &[Vec<ModelOutcome>]) -> Vec<Pooled> {
    let rows: Vec<Pooled> = runs.iter().map(|drives| one(drives)).collect();
    let draws = draws(&rows);
    let ratio = |above: usize, below: usize| {
        let horizontal = |i: usize| rows[i].horizontal.value;
        let drawn: Vec<f64> = draws.iter().map(|d| d[above] / d[below]).collect();
        estimate(horizontal(above) / horizontal(below), &drawn)
    };
    let finite = |i: &usize| rows[*i].horizontal.value.is_finite() && !models[*i].is_bound();
    let by_drift = |a: &usize, b: &usize| {
        let horizontal = |i: usize| rows[i].horizontal.value;
        horizontal(*a).total_cmp(&horizontal(*b))
    };
    let least = (0..rows.len()).filter(finite).min_by(by_drift);
    let white = models.iter().position(|m| m.name == WHITE);
    let row = |i: usize| {
        let drawn: Vec<f64> = draws.iter().map(|d| d[i]).collect();
        Pooled {
            horizontal: estimate(rows[i].horizontal.value, &drawn),
            less_than_white: ratio(white.unwrap_or(i), i),
            over_least: ratio(i, least.unwrap_or(i)),
            ..rows[i].clone()
        }
    };
    (0..rows.len()).map(row).collect()
}

/// The outages of a model, without intervals.
fn one(drives: &[ModelOutcome]) -> Pooled {
    let ran = drives.iter().filter_map(|(_, run)| run.as_ref().ok());
    let errors: Vec<&ModelErrors> = ran.map(|run| &run.errors).collect();
    let failed = drives.iter().find_map(|(_, run)| run.as_ref().err());
    let outages = || errors.iter().flat_map(|e| &e.per_outage);
    let mut largest: Vec<Errors> = outages().map(|o| o.max).collect();
    if failed.is_some() {
        largest.push(Errors::UNKNOWN);
    }
    let rms = reference::rms(&largest);
    let unknown = Estimate {
        value: rms.0[HORIZONTAL],
        interval: [f64::NAN; 2],
    };
    Pooled {
        max: reference::max(&largest),
        rms,
        horizontal: unknown,
        less_than_white: unknown,
        over_least: unknown,
        largest: largest.iter().map(|e| e.0[HORIZONTAL]).collect(),
        drift: drift_curve(outages()),
        failed: failed.map(ToString::to_string),
    }
}

/// The root mean square of each row over each draw of outages: the same outages for all rows.
fn draws(rows: &[Pooled]) -> Vec<Vec<f64>> {
    let outages = rows.iter().map(|row| row.largest.len()).max().unwrap_or(0);
    let mut random = Xoshiro256PlusPlus::seed_from_u64(SEED);
    let mut draw = || -> Vec<f64> {
        let picked: Vec<usize> = (0..outages)
            .map(|_| (random.next_u64() % outages as u64) as usize)
            .collect();
        let rms = |row: &Pooled| {
            let square = |i: &usize| row.largest.get(*i).map_or(f64::NAN, |e| e * e);
            (picked.iter().map(square).sum::<f64>() / outages as f64).sqrt()
        };
        rows.iter().map(rms).collect()
    };
    (0..DRAWS).map(|_| draw()).collect()
}

fn estimate(value: f64, drawn: &[f64]) -> Estimate {
    let interval = match value.is_finite() {
        true => ENDS.map(|p| quantile(drawn, p)),
        false => [f64::NAN; 2],
    };
    Estimate { value, interval }
}

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_drive::{
        outages::{ModelRun, OutageErrors},
        reference::Coverage,
        replay::Summary,
    };

    fn row(largest: &[f64]) -> Pooled {
        let unknown = Estimate {
            value: f64::NAN,
            interval: [f64::NAN; 2],
        };
        Pooled {
            max: Errors::UNKNOWN,
            rms: Errors::UNKNOWN,
            horizontal: unknown,
            less_than_white: unknown,
            over_least: unknown,
            largest: largest.to_vec(),
            drift: Vec::new(),
            failed: None,
        }
    }

    /// Two drives: the statistics are of the largest error of each outage, whatever is left at its end.
    #[test]
    fn what_is_pooled_are_the_largest_errors_of_all_drives() {
        let outage = |largest: f64| OutageErrors {
            start_s: 0.0,
            max: Errors([largest; 10]),
            end: Errors([0.1 * largest; 10]),
            sigma: Errors::UNKNOWN,
            nees: [f64::NAN; 3],
            covered: Default::default(),
            drift: Vec::new(),
            way: Vec::new(),
        };
        let drive = |largest: &[f64]| {
            let errors = ModelErrors {
                max: Errors::UNKNOWN,
                rms: Errors::UNKNOWN,
                median: Errors::UNKNOWN,
                end_rms: Errors::UNKNOWN,
                nees: [f64::NAN; 3],
                coverage: Coverage::default(),
                left_out: 0,
                per_outage: largest.iter().map(|largest| outage(*largest)).collect(),
                finding: None,
            };
            let run = ModelRun {
                name: "one".into(),
                errors,
                summary: Summary::default(),
            };
            ("one".to_owned(), Ok(run))
        };
        let pooled = one(&[drive(&[6.0, 10.0]), drive(&[8.0])]);
        assert_eq!(pooled.largest, [6.0, 10.0, 8.0]);
        assert_eq!(pooled.max, Errors([10.0; 10]));
        let rms = (200f64 / 3.0).sqrt();
        assert!((pooled.rms.0[0] - rms).abs() < 1e-12, "{:?}", pooled.rms);
        assert_eq!(pooled.horizontal.value, pooled.rms.0[HORIZONTAL]);
    }

    #[test]
    fn draws_are_paired() {
        // Twice the errors in every outage are twice the root mean square of every draw, however the outages differ.
        let a: Vec<f64> = (1..40).map(f64::from).collect();
        let b: Vec<f64> = a.iter().map(|e| 2.0 * e).collect();
        for draw in draws(&[row(&a), row(&b)]) {
            assert!((draw[1] / draw[0] - 2.0).abs() < 1e-12);
        }
    }

    #[test]
    fn the_interval_of_a_mean_square_is_that_of_its_standard_error() {
        // 400 outages of errors 0 and √2 in turn: mean square 1, standard deviation of a square 1, of the mean 0.05. The root has
        // half of that: ±1.96·0.025, to a tenth with 2000 draws.
        let largest: Vec<f64> = (0..400).map(|i| f64::from(i % 2) * 2f64.sqrt()).collect();
        let drawn: Vec<f64> = draws(&[row(&largest)]).iter().map(|d| d[0]).collect();
        let estimate = estimate(1.0, &drawn);
        assert!((estimate.interval[0] - 0.951).abs() < 0.005, "{estimate:?}");
        assert!((estimate.interval[1] - 1.049).abs() < 0.005, "{estimate:?}");
        assert!(estimate.is_one());
    }
}
