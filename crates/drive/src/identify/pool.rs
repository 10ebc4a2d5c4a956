//! Several records of one sensor or type: one model, the spread of the turn-on constants, the record that differs.

use super::{
    AxisError, Identified, RecordSeries, RecordingError, at_own_rate,
    settings::{Prepared, Settings, common_rate},
};
use crate::record::own_values;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};
use undrift_base::{number::rounded, parallel};
use undrift_noise::identify::{
    self as noise, Between, IdentifyError, RecordRemark, Sampled, Share,
};
use undrift_results::{
    self as results, AxisPool, Differing, Number, PooledRecord, RecordShare, by_name,
};

/// Probability that records of one process are taken for different ones, of all records and axes together.
pub const FALSE_ALARM: f64 = 0.01;
/// Angle between the specific forces of two records beyond any turn-on constant [rad]: 5 degrees, 85 mg.
const LAID_DOWN: f64 = 0.087;
/// Probability of taking a sensor that was not moved for one that was.
const MOVED: f64 = 0.05;

/// What several records of one sensor show beyond their common model.
pub struct Pool {
    /// Names and numbers of samples of the records.
    pub records: Vec<(String, usize)>,
    /// The axes that were identified, by name.
    pub axes: Vec<(&'static str, noise::Pool)>,
    /// Whether the sensor was laid down differently between the records; `None` where that cannot be seen.
    pub moved: Option<bool>,
    /// Largest angle between the specific forces of two records \[rad\]; 0 without three accelerometers.
    pub tilt: f64,
}

/// Standard deviation of a turn-on constant that several records determine.
#[derive(Clone, Copy, Debug)]
pub struct Determined {
    /// Standard deviation for a filter \[unit\].
    pub sigma: f64,
    /// Whether it is a bound of two or three records, whose scatter bounds it from above alone.
    is_bound: bool,
}

impl Determined {
    /// What the model file gets beside a data sheet's σ \[unit\]: of few records the larger of the two.
    pub fn with(self, known: f64) -> f64 {
        match self.is_bound {
            true => self.sigma.max(known),
            false => self.sigma,
        }
    }
}

/// The probability of a false alarm of one of so many axes.
fn level(axes: usize) -> f64 {
    FALSE_ALARM / axes.max(1) as f64
}

/// Identifies every axis of several records together, on all cores. `done` is called after each axis.
///
/// # Errors
/// Records of different sample rates or axes.
pub(super) fn run_pool(
    records: &[Prepared],
    settings: &Settings,
    done: impl Fn() + Sync,
) -> Result<Identified, RecordingError> {
    let rate_hz = common_rate(records)?;
    let first = records.first().ok_or(RecordingError::NoAxis)?;
    let names = &first.record.axes;
    let level = level(names.len());
    let longest =
        (0..records.len()).max_by_key(|k| (records[*k].record.length(), records.len() - k));
    let longest = longest.unwrap_or(0);
    let found = parallel::map(names.len(), |axis| {
        let own = records
            .iter()
            .map(|pooled| own_values(&pooled.record.samples[axis]));
        let own: Vec<_> = own.collect();
        let sampled = records.iter().zip(&own).map(|(pooled, own)| {
            let options = settings.options(&pooled.record, rate_hz);
            at_own_rate(&pooled.record.samples[axis], own, &options, None)
        });
        let sampled: Vec<Sampled<'_>> = sampled.collect();
        let found = noise::identify_pool(&sampled, names[axis].starts_with("accel"), level);
        let grid = found
            .as_ref()
            .ok()
            .and_then(|(axis, _)| axis.normality.quantisation);
        let Sampled { samples, options } = &sampled[longest];
        let series = RecordSeries::new(samples, options.rate_hz, grid.map(|grid| grid.step));
        done();
        (names[axis], found, series)
    });
    let mut identified = Identified {
        rate_hz,
        timing: records[longest].record.timing.clone(),
        skipped_rows: records
            .iter()
            .map(|pooled| pooled.record.skipped.total())
            .sum(),
        used: records.iter().filter_map(|one| one.used.clone()).collect(),
        guessed_units: records.iter().find_map(|one| one.record.guessed_range()),
        axes: Vec::new(),
        body_axes: first.record.body_axes,
        series: Vec::new(),
        pool: None,
    };
    let mut axes = Vec::new();
    for (name, found, series) in found {
        identified.series.push(series);
        match found {
            Ok((axis, pool)) => {
                identified.axes.push((name, Ok(axis)));
                axes.push((name, pool));
            }
            Err(problem) => {
                let record = problem.record.map(|k| records[k].name.clone());
                let error: IdentifyError = problem.error;
                identified
                    .axes
                    .push((name, Err(AxisError { record, error })));
            }
        }
    }
    let (moved, tilt) = laid_down(&axes);
    let names = records
        .iter()
        .map(|pooled| (pooled.name.clone(), pooled.record.length()));
    identified.pool = Some(Pool {
        records: names.collect(),
        axes,
        moved,
        tilt,
    });
    Ok(identified)
}

/// Whether gravity shows that the sensor was laid down differently, and the largest angle between two records [rad].
///
/// A tilt moves the specific force across its direction and not along it; constants of the sensor do both alike. So
/// where the scatter across is larger than that of the force's size, by an F test of 2(n − 1) and n − 1 degrees of
/// freedom, the sensor was moved.
fn laid_down(axes: &[(&'static str, noise::Pool)]) -> (Option<bool>, f64) {
    let accels = axes.iter().filter(|(name, _)| name.starts_with("accel"));
    let accels: Vec<&noise::Pool> = accels.map(|(_, axis)| axis).collect();
    let [x, y, z] = accels[..] else {
        return (None, 0.0);
    };
    let levels = x.records.iter().zip(&y.records).zip(&z.records);
    let forces = levels.map(|((x, y), z)| [x.level, y.level, z.level]);
    let forces: Vec<[f64; 3]> = forces.collect();
    let dot = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let size = |a: &[f64; 3]| dot(a, a).sqrt();
    let angle =
        |a: &[f64; 3], b: &[f64; 3]| (dot(a, b) / (size(a) * size(b))).clamp(-1.0, 1.0).acos();
    let others = |k: usize| forces[k + 1..].iter();
    let pairs = forces
        .iter()
        .enumerate()
        .flat_map(|(k, a)| others(k).map(move |b| (a, b)));
    let tilt = pairs.map(|(a, b)| angle(a, b)).fold(0.0, f64::max);
    let n = forces.len() as f64;
    let mean: [f64; 3] =
        std::array::from_fn(|i| forces.iter().map(|force| force[i]).sum::<f64>() / n);
    let mean_size = forces.iter().map(size).sum::<f64>() / n;
    let (mut across, mut along) = (0.0, 0.0);
    for force in &forces {
        let off: [f64; 3] = std::array::from_fn(|i| force[i] - mean[i]);
        across += dot(&off, &off) - (dot(&off, &mean) / size(&mean)).powi(2);
        along += (size(force) - mean_size).powi(2);
    }
    let ratio = 0.5 * across / along;
    let test = FisherSnedecor::new(2.0 * (n - 1.0), n - 1.0);
    let scatters = test.is_ok_and(|test| ratio.is_finite() && test.sf(ratio) < MOVED);
    (Some(tilt > LAID_DOWN || scatters), tilt)
}

impl Pool {
    fn axis(&self, name: &str) -> Option<&noise::Pool> {
        self.axes
            .iter()
            .find(|(axis, _)| *axis == name)
            .map(|(_, axis)| axis)
    }

    /// Remarks on the records of an axis but the longest, each with the name of its record.
    pub(super) fn remarks(&self, name: &str) -> impl Iterator<Item = (&str, &RecordRemark)> {
        let shares = self.axis(name).into_iter().flat_map(|axis| &axis.records);
        let named = self.records.iter().zip(shares);
        named.flat_map(|((record, _), share)| {
            let remarks = share.remarks.iter();
            remarks.map(move |remark| (record.as_str(), remark))
        })
    }

    /// Whether no record differs from the others.
    pub fn is_homogeneous(&self) -> bool {
        self.axes.iter().all(|(_, axis)| axis.differing.is_empty())
    }

    /// The standard deviation of an axis' turn-on constant for a filter, where the records determine it: not of an
    /// accelerometer that was laid down differently, or may have been.
    pub fn turn_on(&self, name: &str) -> Option<Determined> {
        let axis = self.axis(name)?;
        if name.starts_with("accel") && self.moved != Some(false) || axis.between.records < 2 {
            return None;
        }
        let sensor = |name: &str| name.split('_').next().map(str::to_owned);
        let alike = self
            .axes
            .iter()
            .filter(|(other, _)| sensor(other) == sensor(name));
        let alike: Vec<Between> = alike.map(|(_, axis)| axis.between).collect();
        Some(Determined {
            sigma: axis.between.for_filter(&alike, axis.common),
            is_bound: axis.between.degrees_of_freedom() < 3,
        })
    }

    /// What the model file says of an axis \[unit\].
    pub(super) fn note(&self, name: &str) -> toml::Table {
        const DIGITS: usize = 4;
        let mut note = toml::Table::new();
        let (Some(axis), Some(_)) = (self.axis(name), self.turn_on(name)) else {
            return note;
        };
        let between = &axis.between;
        let values = [
            ("switch_on_sigma", between.sigma),
            ("switch_on_low", between.low),
            ("switch_on_high", between.high),
            ("switch_on_common", between.mean),
        ];
        let values = values.into_iter().filter(|(_, value)| value.is_finite());
        note.extend(values.map(|(key, value)| (key.to_owned(), rounded(value, DIGITS).into())));
        let count = i64::try_from(between.records).unwrap_or(i64::MAX);
        note.insert("switch_ons".to_owned(), count.into());
        note
    }

    /// What the model file's source adds.
    pub(super) fn source(&self) -> String {
        let mut text = String::new();
        let determined = self
            .axes
            .iter()
            .filter(|(name, _)| self.turn_on(name).is_some());
        let determined: Vec<&str> = determined.map(|(name, _)| *name).collect();
        if !determined.is_empty() {
            let (axes, n) = (determined.join(", "), self.records.len());
            text += &format!("; turn_on of {axes} from {n} switch-ons");
        }
        let differing: Vec<String> = self
            .axes
            .iter()
            .flat_map(|(name, axis)| {
                let records = axis.differing.iter();
                records.map(move |d| format!("{} ({name})", self.records[d.record].0))
            })
            .collect();
        if !differing.is_empty() {
            text += &format!("; differing recordings: {}", differing.join(", "));
        }
        text
    }

    /// The pool as a result.
    pub(super) fn result(&self) -> results::Pool {
        let axes = self
            .axes
            .iter()
            .map(|(name, axis)| (*name, self.axis_result(name, axis)));
        let records = self.records.iter().map(|(record, samples)| PooledRecord {
            record: record.clone(),
            samples: *samples as u64,
        });
        results::Pool {
            records: records.collect(),
            false_alarm: FALSE_ALARM.into(),
            homogeneous: self.is_homogeneous(),
            moved: self.moved,
            tilt: self.tilt.into(),
            axes: by_name(axes),
        }
    }

    fn axis_result(&self, name: &str, axis: &noise::Pool) -> AxisPool {
        let between = &axis.between;
        let turn_on = self.turn_on(name).map(|found| results::TurnOn {
            records: between.records as u64,
            degrees_of_freedom: between.degrees_of_freedom() as u64,
            sigma: between.sigma.into(),
            low: between.low.into(),
            high: between.high.into(),
            common: axis.common.into(),
            within: between.within.into(),
            for_filter: found.sigma.into(),
        });
        let share = |share: &Share| RecordShare {
            mean: share.mean.into(),
            constant: share.level.into(),
            constant_error: share.level_standard_error.into(),
            white: share.white.factor.into(),
            slow: share.slow.map(|slow| slow.factor).into(),
            p_value: share.p_value.into(),
            outliers: share.outliers as u64,
            outlier_events: share.outlier_events as u64,
        };
        let outliers = |factor: f64| if factor.is_finite() { factor } else { -1.0 };
        let differing = axis.differing.iter().map(|found| Differing {
            record: self.records[found.record].0.clone(),
            other: found.other.map(|other| self.records[other].0.clone()),
            white: found.white.into(),
            slow: found.slow.into(),
            outliers: Number::from(found.outliers.map(outliers)),
            p_value: found.p_value.into(),
        });
        AxisPool {
            turn_on,
            likelihood_ratio: axis.likelihood_ratio.into(),
            degrees_of_freedom: axis.degrees_of_freedom.into(),
            inflation: axis.inflation.into(),
            p_value: axis.p_value.into(),
            records: axis.records.iter().map(share).collect(),
            differing: differing.collect(),
        }
    }
}

#[cfg(test)]
mod tests;
