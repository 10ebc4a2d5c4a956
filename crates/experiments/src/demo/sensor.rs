//! The sensor and its drives.
//!
//! Random errors as the three records of a real ADIS16405 show them (docs/lab/real-records.md): white noise N the mean of
//! the records, random walk K of the gyros their root mean square to half a percent. The accelerometers' K is between their
//! least and median, since part of it there is the table's tilt: 1 mg in a quarter of an hour.

use super::{
    CUTS, DURATION, DemoError, Experiment, PRESET, RATE_HZ, REST, STATIC_DURATION, Source, cuts,
};
use rand::{Rng, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use undrift_base::parallel;
use undrift_drive::{
    record::Record,
    replay::{Measurement, Outage},
};
use undrift_nav::{
    Vector3, covariance,
    earth::STANDARD_GRAVITY,
    sample::{GnssFix, ImuSample},
    shaping::ShapingFilter,
};
use undrift_noise::{AxisModel, BiasModel, ImuModel, model_file::AXES};
use undrift_simulate::{GnssNoise, SensorErrors, Simulation, Trajectory, simulate};

/// White noise of the gyros [deg/√h].
const GYRO_WHITE: [f64; 3] = [2.44, 2.54, 2.32];
/// Random walk of the gyros [deg/h/√h].
const GYRO_WALK: [f64; 3] = [137.0, 127.0, 215.0];
/// White noise of the accelerometers [m/s/√h].
const ACCEL_WHITE: [f64; 3] = [0.29, 0.20, 0.27];
/// Random walk of the accelerometers [mg/√h].
const ACCEL_WALK: f64 = 2.0;

/// IMU → antenna, body axes \[m\].
pub(super) const LEVER_ARM: [f64; 3] = [0.3, 0.1, -1.2];

type Errors = [f64; covariance::AXES];

/// The simulated sensor's noise; turn-on constants of the data sheet.
pub(super) fn truth() -> ImuModel {
    let mut model = ImuModel::preset(PRESET).unwrap_or_default();
    let hour = 60.0; // √s in √h
    let axis = |turn_on: f64, white: f64, walk: f64| AxisModel {
        turn_on,
        white: Some(white / hour),
        random_walk: Some(walk / hour),
        ..AxisModel::default()
    };
    for (i, gyro) in model.gyro.iter_mut().enumerate() {
        let walk = GYRO_WALK[i].to_radians() / 3600.0;
        *gyro = axis(gyro.turn_on, GYRO_WHITE[i].to_radians(), walk);
    }
    for (i, accel) in model.accel.iter_mut().enumerate() {
        let walk = ACCEL_WALK * 1e-3 * STANDARD_GRAVITY;
        *accel = axis(accel.turn_on, ACCEL_WHITE[i], walk);
    }
    model
}

/// Which samples a model navigates with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Samples {
    /// Less the means over the rest before the drive.
    Rested,
    /// With the turn-on constants.
    Raw,
    /// Without them, as nobody knows them.
    Exact,
}

/// One drive.
pub(super) struct Ride {
    pub(super) simulation: Simulation,
    pub(super) fixes: Vec<Measurement>,
    /// Outages of each of [`CUTS`].
    pub(super) cuts: Vec<Vec<Outage>>,
    rested: Vec<ImuSample>,
    raw: Vec<ImuSample>,
    exact: Vec<ImuSample>,
}

impl Ride {
    pub(super) fn samples(&self, which: Samples) -> &[ImuSample] {
        match which {
            Samples::Rested => &self.rested,
            Samples::Raw => &self.raw,
            Samples::Exact => &self.exact,
        }
    }

    /// A drive of a seed; `errors` are those of the sensor, sample by sample, without turn-on constants.
    fn new(seed: u64, errors: &[Errors]) -> Result<Self, DemoError> {
        let gnss = GnssNoise {
            position_std: [0.02, 0.02, 0.04],
            velocity_std: [0.03, 0.03, 0.05],
            rate_hz: 5.0,
            lever_arm: LEVER_ARM.into(),
            ..GnssNoise::default()
        };
        let trajectory = Trajectory::car(DURATION, seed);
        let simulation = simulate(&trajectory, RATE_HZ, None, &gnss, seed)?;
        let constants = constants(seed);
        let at_rest = (REST * RATE_HZ) as usize;
        let mean = mean(&errors[..at_rest.min(errors.len())]);
        let with = |constant: &Errors| -> Vec<ImuSample> {
            let samples = simulation.imu.iter().zip(errors);
            let sensed = samples.map(|(ideal, error)| {
                let sum: Errors = std::array::from_fn(|i| error[i] + constant[i]);
                sensed(ideal, &sum)
            });
            sensed.collect()
        };
        let ends = simulation.gnss.first().zip(simulation.gnss.last());
        let (first, last) =
            ends.map_or((0.0, 0.0), |(a, b): (&GnssFix, &GnssFix)| (a.time, b.time));
        let of_lengths = CUTS.iter().map(|of| cuts(of, first, last));
        let of_lengths = of_lengths.collect::<Result<_, _>>()?;
        Ok(Self {
            fixes: Measurement::from_fixes(&simulation.gnss),
            cuts: of_lengths,
            // The mean of what is sensed at rest less what is known there: constant and noise.
            rested: with(&mean.map(|m| -m)),
            raw: with(&constants),
            exact: with(&[0.0; covariance::AXES]),
            simulation,
        })
    }
}

fn sensed(ideal: &ImuSample, error: &Errors) -> ImuSample {
    let [gx, gy, gz, ax, ay, az] = *error;
    ImuSample {
        dtheta: ideal.dtheta + Vector3::new(gx, gy, gz) * ideal.dt,
        dvel: ideal.dvel + Vector3::new(ax, ay, az) * ideal.dt,
        ..*ideal
    }
}

fn mean(errors: &[Errors]) -> Errors {
    let sum = |axis: usize| errors.iter().map(|e| e[axis]).sum::<f64>();
    std::array::from_fn(|axis| sum(axis) / errors.len() as f64)
}

/// Turn-on constants of one switch-on, by the data sheet [rad/s], [m/s²].
fn constants(seed: u64) -> Errors {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed ^ 0x7075_6f6e);
    let model = truth();
    let axes = model.axes();
    std::array::from_fn(|i| {
        let unit: f64 = StandardNormal.sample(&mut random);
        axes[i].1.turn_on * unit
    })
}

/// Seeds of the static record and of each drive.
fn seeds(experiment: &Experiment) -> (u64, Vec<u64>) {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(experiment.seed);
    let record = random.next_u64();
    let drives = (0..experiment.drives).map(|_| random.next_u64());
    (record, drives.collect())
}

/// The drives; `done` is called after each.
pub(super) fn rides(
    experiment: &Experiment,
    done: &(dyn Fn() + Sync),
) -> Result<Vec<Ride>, DemoError> {
    let samples = (DURATION * RATE_HZ) as usize;
    let played = match &experiment.source {
        Source::Simulated => None,
        Source::Recorded { played, .. } => Some(centred(played, experiment.drives)?),
    };
    let (_, seeds) = seeds(experiment);
    let ride = |drive: usize| {
        let seed = seeds[drive];
        let errors = match &played {
            Some(played) => played[drive * samples..][..samples].to_vec(),
            None => drawn(seed, samples)?,
        };
        let ride = Ride::new(seed, &errors);
        done();
        ride
    };
    let rides = parallel::map(seeds.len(), ride);
    rides.into_iter().collect()
}

/// Errors of the simulated sensor.
fn drawn(seed: u64, samples: usize) -> Result<Vec<Errors>, DemoError> {
    let mut errors = SensorErrors::new(&filters()?, RATE_HZ, seed)?;
    Ok((0..samples).map(|_| errors.draw()).collect())
}

/// The simulated sensor but for its turn-on constants.
fn filters() -> Result<[ShapingFilter; covariance::AXES], DemoError> {
    let mut model = truth();
    for axis in model.gyro.iter_mut().chain(&mut model.accel) {
        axis.turn_on = 0.0;
    }
    Ok(model.shaping(BiasModel::RandomWalk, 1.0 / RATE_HZ)?)
}

/// Refuses a record that has not the six axes in their order.
fn with_six_axes(record: &Record) -> Result<&Record, DemoError> {
    let axes = record.axes.len();
    match record.axes == AXES {
        true => Ok(record),
        false => Err(DemoError::Axes {
            record: record.name.clone(),
            axes,
        }),
    }
}

/// A record about its means, sample by sample, as long as so many drives.
fn centred(record: &Record, drives: usize) -> Result<Vec<Errors>, DemoError> {
    let record = with_six_axes(record)?;
    let needed = drives * (DURATION * RATE_HZ) as usize;
    let length = record.samples.iter().map(Vec::len).min().unwrap_or(0);
    if length < needed {
        return Err(DemoError::TooShort {
            record: record.name.clone(),
            seconds: length as f64 / RATE_HZ,
            drives,
        });
    }
    let means: Vec<f64> = record
        .samples
        .iter()
        .map(|axis| axis.iter().sum::<f64>() / axis.len() as f64)
        .collect();
    let sample = |k: usize| std::array::from_fn(|i| record.samples[i][k] - means[i]);
    Ok((0..needed).map(sample).collect())
}

/// The static record: a simulated one has another switch-on than the drives.
pub(super) fn static_record(experiment: &Experiment) -> Result<Record, DemoError> {
    if let Source::Recorded { identified, .. } = &experiment.source {
        return with_six_axes(identified).cloned();
    }
    let (seed, _) = seeds(experiment);
    let errors = drawn(seed, (STATIC_DURATION * RATE_HZ) as usize)?;
    let constants = constants(seed);
    let axis = |i: usize| {
        // At rest, level: the accelerometers' z reads the reaction to gravity.
        let level = if i == 5 { -STANDARD_GRAVITY } else { 0.0 };
        let samples = errors.iter().map(|e| e[i] + constants[i] + level);
        samples.collect()
    };
    Ok(Record {
        axes: AXES.to_vec(),
        samples: (0..AXES.len()).map(axis).collect(),
        ..Record::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rest_takes_the_mean_error_out() {
        let samples = (DURATION * RATE_HZ) as usize;
        let errors = drawn(3, samples).unwrap();
        let ride = Ride::new(3, &errors).unwrap();
        let at_rest = (REST * RATE_HZ) as usize;
        let ideal = &ride.simulation.imu;
        let mean = |samples: &[ImuSample]| -> Vector3 {
            let pairs = samples.iter().zip(ideal).take(at_rest);
            pairs.map(|(s, i)| s.dvel - i.dvel).sum::<Vector3>() / REST
        };
        // Rounding of 6000 sums of increments of 0.1 m/s.
        assert!(mean(ride.samples(Samples::Rested)).norm() < 1e-11);
        let constants = constants(3);
        let left = mean(ride.samples(Samples::Raw)) - mean(ride.samples(Samples::Exact));
        assert!((left - Vector3::from_column_slice(&constants[3..])).norm() < 1e-11);
        assert_eq!(
            ride.cuts.iter().map(Vec::len).collect::<Vec<_>>(),
            [15, 9, 6]
        );
    }

    #[test]
    fn every_drive_has_its_stretch_of_the_record_that_is_played() {
        use std::sync::atomic::{AtomicUsize, Ordering};
        let samples = (DURATION * RATE_HZ) as usize;
        let size = |axis: usize| 1e-3 * (axis + 1) as f64;
        // About a mean of 2, one way in the first stretch, the other in the second.
        let axis = |i: usize| {
            let samples_of = |sign: f64| vec![2.0 + sign * size(i); samples];
            [samples_of(1.0), samples_of(-1.0)].concat()
        };
        let record = Record {
            axes: AXES.to_vec(),
            samples: (0..AXES.len()).map(axis).collect(),
            ..Record::default()
        };
        let experiment = Experiment {
            seed: 5,
            drives: 2,
            source: Source::Recorded {
                identified: Box::default(),
                played: Box::new(record),
            },
            paper: false,
        };
        let done = AtomicUsize::new(0);
        let rides = rides(&experiment, &|| {
            done.fetch_add(1, Ordering::Relaxed);
        });
        let rides = rides.unwrap();
        assert_eq!((rides.len(), done.into_inner()), (2, 2));
        for (ride, sign) in rides.iter().zip([1.0, -1.0]) {
            let ideal = &ride.simulation.imu;
            let sensed = ride.samples(Samples::Exact);
            assert_eq!((sensed.len(), ideal.len()), (samples, samples));
            for (sensed, ideal) in sensed.iter().zip(ideal) {
                let gyro = (sensed.dtheta - ideal.dtheta) / ideal.dt;
                let accel = (sensed.dvel - ideal.dvel) / ideal.dt;
                for i in 0..3 {
                    // The mean of 180 000 samples about 2.
                    assert!((gyro[i] - sign * size(i)).abs() < 1e-9, "{gyro}");
                    assert!((accel[i] - sign * size(3 + i)).abs() < 1e-9, "{accel}");
                }
            }
        }
        let [first, second] = [0, 1].map(|drive: usize| &rides[drive].simulation.imu);
        assert!(first.iter().zip(second).any(|(a, b)| a.dtheta != b.dtheta));
    }

    #[test]
    fn the_biases_wander_as_real_records_do() {
        // A walk of K is K √t off: 2 mg/√h in the quarter of an hour of a drive is 1 mg, 137 deg/h/√h is 68.5 deg/h.
        let model = truth();
        let after = |axis: &AxisModel| axis.random_walk.unwrap() * DURATION.sqrt();
        let mg = after(&model.accel[0]) / STANDARD_GRAVITY * 1e3;
        assert!((mg - 1.0).abs() < 1e-12, "{mg}");
        let deg_h = after(&model.gyro[0]).to_degrees() * 3600.0;
        assert!((deg_h - 68.5).abs() < 1e-9, "{deg_h}");
        assert_eq!(filters().unwrap()[0].order, 1);
    }

    #[test]
    fn a_record_too_short_for_the_drives_is_refused() {
        let short = Record {
            axes: AXES.to_vec(),
            samples: vec![vec![0.0; 1000]; 6],
            ..Record::default()
        };
        let error = centred(&short, 1).unwrap_err().to_string();
        assert!(
            error.contains("10 s, where 1 x 900 s are needed"),
            "{error}"
        );
        let axes = vec!["gyro_z"];
        let one = centred(&Record { axes, ..short }, 1)
            .unwrap_err()
            .to_string();
        assert!(one.contains("1 axes, where gyro_x to accel_z"), "{one}");
    }
    #[test]
    fn each_drive_and_the_recording_have_a_seed_of_their_own() {
        let of = |seed: u64, drives: usize| {
            super::seeds(&Experiment {
                seed,
                drives,
                source: Source::Simulated,
                paper: false,
            })
        };
        let (record, drives) = of(7, 5);
        let mut all = [vec![record], drives.clone()].concat();
        all.sort_unstable();
        all.dedup();
        assert_eq!((drives.len(), all.len()), (5, 6));
        // The same again, the first ones of more drives, and others of another seed.
        assert_eq!(of(7, 5), (record, drives.clone()));
        assert_eq!(of(7, 8).1[..5], drives);
        let (other, others) = of(8, 5);
        assert!(other != record && others.iter().all(|seed| !all.contains(seed)));
    }

    #[test]
    fn every_seed_is_a_switch_on_of_its_own() {
        let of = |seed: u64| constants(seed).map(f64::to_bits);
        // Seeds that differ in one bit.
        let mut all: Vec<_> = (0..64).map(|bit| of(1 << bit)).collect();
        all.push(of(0));
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), 65);
        assert_eq!(of(7), of(7));
        // 6000 draws of the data sheet's σ: their variance is known to 1.8 %.
        let model = truth();
        let sigma = model.axes().map(|(_, axis)| axis.turn_on);
        let squares = (0..1000).flat_map(|seed| {
            let drawn = constants(seed);
            (0..covariance::AXES).map(move |i| (drawn[i] / sigma[i]).powi(2))
        });
        let variance = squares.sum::<f64>() / 6000.0;
        assert!((variance - 1.0).abs() < 0.06, "{variance}");
    }
}
