//! A static record of six axes, or one, into a model file and the reasoning behind it.

mod allan;
mod part;
mod pieces;
mod pool;
mod rest;
mod result;
mod series;
mod settings;
mod slow;
mod steps;
mod windows;

pub use allan::allan_deviations;
pub use pool::{Determined, Pool};
pub use rest::{Likely, NotStatic, not_static};
pub use result::{order_rows, order_tests};
pub use series::{RecordSeries, residuals};
pub use settings::{Prepared, RecordingError, Settings, prepare, provenance};
pub use undrift_noise::screening::Trend;

use crate::record::{Record, own_values};
use undrift_base::parallel;
use undrift_noise::{
    ImuModel, Provenance,
    identify::{Axis, IdentifyError, Options, Sampled, identify},
    model_file::AXES,
    screening::Timing,
    temperature::Temperature,
};
use undrift_results::Used;

/// The axes of a record, or of several of one sensor, identified.
pub struct Identified {
    /// Sample rate \[Hz\].
    pub rate_hz: f64,
    /// Rate, jitter and gaps of the time stamps, where there are any.
    pub timing: Option<Timing>,
    /// Number of rows of the record that were skipped.
    pub skipped_rows: u64,
    /// Parts of the recordings that were used, of those that were not used whole.
    pub used: Vec<Used>,
    /// Units of raw counts whose range is a guess.
    pub guessed_units: Option<String>,
    /// Each axis by its name, with what was found or why nothing was.
    pub axes: Vec<(&'static str, Result<Axis, AxisError>)>,
    /// Whether the axes are those of a body in which the sensor's are turned.
    pub body_axes: bool,
    /// Data for plots of each axis's samples, in the order of the axes; of several records those of the longest.
    pub series: Vec<RecordSeries>,
    /// What several records show beyond a common model: the spread of their constants, and records that differ.
    pub pool: Option<Pool>,
}

/// Why an axis has no model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}{error}", record.iter().map(|record| format!("{record}: ")).collect::<String>())]
pub struct AxisError {
    /// Name of the record, where there are several.
    pub record: Option<String>,
    /// Reason why it has no model.
    pub error: IdentifyError,
}

/// Identifies a recording, or several of one sensor or type together. `done` is called after each axis.
///
/// # Errors
/// Several of different sample rates or axes.
///
/// ```
/// # use undrift_drive as undrift;
/// use undrift::{Record, identify::{Settings, prepare, recordings}};
/// # use undrift::{BiasModel, ImuModel, noise::synthesis::NoiseGenerator};
/// # let preset = ImuModel::preset("adis16465").ok_or("no such preset")?;
/// # let sensors = preset.shaping(BiasModel::White, 0.1)?;
/// # let mut noise: Vec<_> = (0..6).map(|axis| NoiseGenerator::new(&sensors[axis], axis as u64)).collect();
/// # let mut rows: Vec<[f64; 6]> = (0..4000).map(|_| std::array::from_fn(|axis| noise[axis].sample())).collect();
/// # rows.iter_mut().for_each(|row| row[5] -= 9.81);
/// // `rows`: gyro x, y, z [rad/s] and accelerometer x, y, z [m/s²] of a sensor at rest, ten a second.
/// let settings = Settings { rate_hz: Some(10.0), ..Settings::default() };
/// let prepared = prepare(Record::from_samples(&rows), &settings)?;
/// let found = recordings(&[prepared], &settings, || ())?;
/// let model = found.model(None, "my IMU", Default::default())?;
/// assert!((model.gyro[0].white_density() / preset.gyro[0].white_density() - 1.0).abs() < 0.1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn recordings(
    prepared: &[Prepared],
    settings: &Settings,
    done: impl Fn() + Sync,
) -> Result<Identified, RecordingError> {
    match prepared {
        [one] => {
            let options = settings.options(&one.record, one.rate_hz);
            Ok(Identified {
                used: one.used.iter().cloned().collect(),
                ..run(&one.record, &options, done)
            })
        }
        several => pool::run_pool(several, settings, done),
    }
}

/// An axis and what it is identified with: of a sensor slower than its record its `own` samples, with this temperature.
fn at_own_rate<'a>(
    samples: &'a [f64],
    own: &'a Option<(Vec<f64>, Vec<usize>, f64)>,
    options: &Options<'a>,
    temperature: Option<&'a [f64]>,
) -> Sampled<'a> {
    match own {
        Some((values, _, every)) => Sampled {
            samples: values,
            options: Options {
                rate_hz: options.rate_hz / every,
                temperature,
                ..*options
            },
        },
        None => Sampled {
            samples,
            options: *options,
        },
    }
}

/// Identifies every axis of a record, on all cores. `done` is called after each axis. An axis that makes no model has its reason in
/// [`Identified::axes`]; the others are identified all the same.
pub fn run(record: &Record, options: &Options<'_>, done: impl Fn() + Sync) -> Identified {
    let axes = parallel::map(record.axes.len(), |axis| {
        let (name, samples) = (record.axes[axis], &record.samples[axis]);
        let own = own_values(samples);
        let warmth = own.as_ref().zip(options.temperature);
        let warmth = warmth.map(|((_, places, _), all)| -> Vec<f64> {
            places
                .iter()
                .map(|place| all.get(*place).copied().unwrap_or(f64::NAN))
                .collect()
        });
        let Sampled { samples, options } = at_own_rate(samples, &own, options, warmth.as_deref());
        let found = identify(samples, name.starts_with("accel"), &options);
        let step = found
            .as_ref()
            .ok()
            .and_then(|axis| axis.normality.quantisation);
        let series = RecordSeries::new(samples, options.rate_hz, step.map(|q| q.step));
        done();
        let found = found.map_err(|error| AxisError {
            record: None,
            error,
        });
        ((name, found), series)
    });
    let (axes, series) = axes.into_iter().unzip();
    Identified {
        rate_hz: options.rate_hz,
        timing: record.timing.clone(),
        skipped_rows: record.skipped.total(),
        used: Vec::new(),
        guessed_units: record.guessed_range(),
        axes,
        body_axes: record.body_axes,
        series,
        pool: None,
    }
}

impl Identified {
    /// The noise model: identified axes over those of `base`; an axis that neither has is
    /// absent. The standard deviation of the turn-on constant is that of the base, a preset or data sheet, but
    /// at least the constant seen in the record; for [`Identified::without_turn_on`] the largest that the
    /// record's constants do not contradict. Several records give it themselves, see [`Pool::turn_on`].
    ///
    /// # Errors
    /// When no axis is identified.
    pub fn model(
        &self,
        base: Option<&ImuModel>,
        name: &str,
        provenance: Provenance,
    ) -> Result<ImuModel, RecordingError> {
        let mut model = base.cloned().unwrap_or_default();
        model.name = name.to_owned();
        model.source = match &self.pool {
            Some(pool) => format!("identified from {} static recordings", pool.records.len()),
            None => "identified from a static recording".into(),
        };
        model.provenance = provenance;
        let bounded = self.without_turn_on(base);
        if !bounded.is_empty() {
            let axes = bounded.join(", ");
            model.source += &format!(
                "; no data sheet: turn_on of {axes} is the largest consistent with the recording's means (95 %)"
            );
        }
        let mut any = false;
        for (name, found) in &self.axes {
            let Ok(found) = found else { continue };
            let Some(slot) = axis_of(&mut model, name) else {
                continue;
            };
            let (known, temperature) = (slot.turn_on, slot.temperature);
            *slot = found.model();
            let found = slot.temperature.map(|found| Temperature {
                body_axes: self.body_axes,
                ..found
            });
            slot.temperature = found.or(temperature);
            let pooled = self.pool.as_ref().and_then(|pool| pool.turn_on(name));
            slot.turn_on = match pooled {
                Some(pooled) => pooled.with(known),
                None if bounded.contains(name) => self.turn_on_bound(name),
                None => slot.turn_on.max(known),
            };
            if let Some(pool) = &self.pool {
                slot.identification.extend(pool.note(name));
            }
            any = true;
        }
        if let Some(pool) = &self.pool {
            model.source += &pool.source();
        }
        any.then_some(model).ok_or(RecordingError::NoAxis)
    }

    /// Identified axes of which neither several records nor `base` give the standard deviation of the turn-on constant.
    pub fn without_turn_on(&self, base: Option<&ImuModel>) -> Vec<&'static str> {
        let known = |name: &str| {
            let mut axes = base.into_iter().flat_map(ImuModel::axes);
            let pool = self.pool.as_ref();
            pool.is_some_and(|pool| pool.turn_on(name).is_some())
                || axes.any(|(axis, model)| axis == name && model.turn_on > 0.0)
        };
        let identified = self.axes.iter().filter(|(_, found)| found.is_ok());
        let names = identified.map(|(name, _)| *name);
        names.filter(|name| !known(name)).collect()
    }

    /// The largest standard deviation of the turn-on constants that the record does not contradict (with
    /// 95 %) [rad/s], [m/s²]. The axes of a sensor are taken as draws of one distribution: one record bounds
    /// its σ well from below and hardly from above. Too large a σ costs a filter little, too small
    /// a one holds it to a wrong constant.
    fn turn_on_bound(&self, axis: &str) -> f64 {
        /// √(n / q), q the 5 % quantile of χ² with n degrees of freedom, for n = 1, 2, 3.
        const FACTORS: [f64; 3] = [15.95, 4.415, 2.920];
        let gyro = axis.starts_with("gyro");
        let alike = self
            .axes
            .iter()
            .filter(|(name, _)| name.starts_with("gyro") == gyro);
        let constants = alike.filter_map(|(_, found)| Some(found.as_ref().ok()?.model().turn_on));
        let (count, squares) = constants.fold((0, 0.0), |(n, sum), c| (n + 1, sum + c * c));
        if count == 0 {
            return 0.0;
        }
        FACTORS[count.min(3) - 1] * (squares / count as f64).sqrt()
    }
}

fn axis_of<'a>(model: &'a mut ImuModel, name: &str) -> Option<&'a mut undrift_noise::AxisModel> {
    let index = AXES.iter().position(|axis| *axis == name)?;
    model.gyro.iter_mut().chain(&mut model.accel).nth(index)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, Normal};

    #[test]
    fn the_turn_on_constant_is_the_data_sheets_or_a_bound_above_the_records() {
        let mut random = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(1);
        let means = [0.001, -0.002, 0.002, 0.05];
        let record = Record {
            axes: vec!["gyro_x", "gyro_y", "gyro_z", "accel_x"],
            samples: means
                .iter()
                .map(|mean| {
                    let noise = Normal::new(*mean, 1e-3).unwrap();
                    (0..2000).map(|_| noise.sample(&mut random)).collect()
                })
                .collect(),
            ..Record::default()
        };
        let found = run(
            &record,
            &Options {
                n_max: 1,
                ..Options::at(100.0)
            },
            || (),
        );

        // Without one: √(n / χ²) of the root mean square of the three gyros, and of one accelerometer.
        let model = found.model(None, "test", Provenance::default()).unwrap();
        for gyro in &model.gyro {
            assert!(
                (gyro.turn_on / (2.920 * 1.732e-3) - 1.0).abs() < 0.05,
                "{}",
                gyro.turn_on
            );
        }
        assert!((model.accel[0].turn_on / (15.95 * 0.05) - 1.0).abs() < 0.01);
        assert!(
            model
                .source
                .contains("no data sheet: turn_on of gyro_x, gyro_y, gyro_z, accel_x")
        );

        let mut sheet = ImuModel::default();
        sheet.gyro[0].turn_on = 0.02;
        sheet.gyro[1].turn_on = 1e-4;
        let model = found
            .model(Some(&sheet), "test", Provenance::default())
            .unwrap();
        assert_eq!(model.gyro[0].turn_on, 0.02);
        // A data sheet below what is seen is contradicted by it.
        assert!((model.gyro[1].turn_on / 0.002 - 1.0).abs() < 0.05);
        assert!(model.gyro[2].turn_on > 0.004);
        assert_eq!(found.without_turn_on(Some(&sheet)), ["gyro_z", "accel_x"]);
    }
}
