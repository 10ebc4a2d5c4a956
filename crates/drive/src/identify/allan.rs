//! The Allan deviations of a record alone: what takes a second, before tests and models.

use super::{
    Prepared, Settings,
    result::{deviation, unit},
};
use undrift_base::parallel;
use undrift_noise::identify::{AllanDeviation, allan_deviation};
use undrift_results::{self as results, Identify, SCHEMA, VERSION};

/// The Allan deviation of every axis of a recording and its terms, on all cores, as a result without tests and models.
#[must_use]
pub fn allan_deviations(prepared: &Prepared, settings: &Settings) -> Identify {
    let record = &prepared.record;
    let options = &settings.options(record, prepared.rate_hz);
    let axes = parallel::map(record.axes.len(), |k| {
        let (axis, samples) = (record.axes[k], &record.samples[k]);
        let found = match allan_deviation(samples, options) {
            Ok(AllanDeviation {
                curve,
                intervals,
                terms,
            }) => results::Axis {
                samples: samples.len() as u64,
                unit: unit(axis).into(),
                allan: deviation(&curve.points, &intervals, &terms),
                allan_terms: terms,
                ..results::Axis::default()
            },
            Err(error) => results::Axis {
                error: Some(error.to_string()),
                ..results::Axis::default()
            },
        };
        (axis, found)
    });
    Identify {
        undrift: VERSION.into(),
        schema: SCHEMA,
        record: prepared.name.clone(),
        rate_hz: prepared.rate_hz.into(),
        timing: record.timing.clone(),
        skipped_rows: record.skipped.total(),
        used: prepared.used.iter().cloned().collect(),
        guessed_units: record.guessed_range(),
        axes: results::by_name(axes),
        pool: None,
    }
}

#[cfg(test)]
mod tests {
    use super::super::run;
    use super::*;
    use crate::record::Record;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn the_deviations_alone_are_those_of_the_identification() {
        let mut random = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(1);
        let mut noise = |mean: f64| -> Vec<f64> {
            let unit = std::iter::repeat_with(|| StandardNormal.sample(&mut random));
            unit.take(2000).map(|x: f64| mean + 1e-3 * x).collect()
        };
        let prepared = Prepared {
            name: "one".into(),
            record: Record {
                axes: vec!["gyro_x", "accel_z", "gyro_y"],
                samples: vec![noise(0.001), noise(-9.8), vec![f64::NAN; 2000]],
                ..Record::default()
            },
            rate_hz: 100.0,
            not_static: None,
            used: None,
        };
        let settings = Settings {
            n_max: 1,
            ..Settings::default()
        };
        let alone = allan_deviations(&prepared, &settings);
        let options = settings.options(&prepared.record, prepared.rate_hz);
        let all = run(&prepared.record, &options, || ());
        let all = all.result("one", &|of| format!("{of:?}"));
        assert_eq!((alone.rate_hz, &alone.record), (all.rate_hz, &all.record));
        for (name, unit) in [("gyro_x", "rad/s"), ("accel_z", "m/s^2")] {
            let (alone, all) = (&alone.axes[name], &all.axes[name]);
            assert_eq!(alone.unit, unit);
            assert_eq!((&alone.unit, alone.samples), (&all.unit, all.samples));
            assert_eq!(alone.allan, all.allan);
            let terms = |axis: &results::Axis| {
                let of = &axis.allan_terms;
                [of.white.value, of.random_walk.value, of.white_variance]
            };
            assert_eq!(terms(alone), terms(all));
            assert_eq!(alone.error, None);
        }
        assert!(alone.axes["gyro_y"].error.is_some());
    }
}
