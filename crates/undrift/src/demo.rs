//! The source paper's experiment on a simulated drive: nothing but a seed goes in.

mod result;

use crate::record::Record;
use crate::{
    identify::{self, Identified},
    outages::{self, ModelRun, Schedule},
    replay::{Measurement, Outage, ReplayError, Settings},
    simulate::{GnssNoise, Simulation, SimulationError, Trajectory, simulate},
};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use undrift_nav::{Vector3, covariance, sample::ImuSample, shaping::ShapingFilter};
use undrift_noise::{
    BiasModel, ImuModel, ModelError, Provenance, identify::Options, model_file::AXES,
    synthesis::NoiseGenerator,
};

/// IMU of the demo.
pub const PRESET: &str = "adis16405";
/// Sample rate of the simulated IMU \[Hz\].
pub const RATE_HZ: f64 = 200.0;
/// Length of the simulated drive \[s\].
pub const DURATION: f64 = 600.0;
/// Outages: number, length and spacing \[s\], the first this long after the first fix \[s\]: by then the turns
/// of the drive have separated the accelerometers' constants from tilt in every model.
pub const OUTAGES: (usize, f64, f64, f64) = (15, 10.0, 29.0, 180.0);
/// IMU → antenna, body axes \[m\].
const LEVER_ARM: [f64; 3] = [0.3, 0.1, -1.2];

/// Length of the simulated static record \[s\].
pub const STATIC_DURATION: f64 = 1000.0;

/// Where the models of the demo come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Models {
    /// A simulated static record of the same sensors, identified.
    Identified,
    /// The simulation's own parameters.
    Truth,
}

/// The drive and what each model made of it.
pub struct Demo {
    /// Seed of the drive, the sensors and the receiver.
    pub seed: u64,
    /// The static record and what was identified from it, if the models come from there.
    pub identified: Option<(Record, Identified)>,
    /// Samples, fixes and truth.
    pub simulation: Simulation,
    /// Where GNSS was cut.
    pub outages: Vec<Outage>,
    /// Model by model; the last, [`WHITE_CALIBRATED`], is a bound.
    pub runs: Vec<(String, Result<ModelRun, ReplayError>)>,
}

/// Why there is no demo.
#[derive(Debug, thiserror::Error)]
pub enum DemoError {
    /// The preset made no shaping filter.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// Nothing was simulated.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// The outages do not fit the drive.
    #[error(transparent)]
    Outages(#[from] outages::ScheduleError),
    /// No axis could be identified.
    #[error(transparent)]
    Recording(#[from] identify::RecordingError),
}

/// What takes time in a demo.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Identification, axis by axis.
    Identification,
    /// The noise models over the drive, sample by sample.
    Navigation,
}

/// Simulates the drive and runs all bias models through its outages; `done` is called with the stage,
/// how much more of it is done, and how much it is in all.
///
/// # Errors
/// [`DemoError`]: the sensors' model makes no filter, nothing could be simulated, or an axis could not be
/// identified.
pub fn run(
    seed: u64,
    models: Models,
    done: impl Fn(Stage, u64, u64) + Sync,
) -> Result<Demo, DemoError> {
    let preset = ImuModel::preset(PRESET).unwrap_or_default();
    let interval = 1.0 / RATE_HZ;
    let Drive {
        sensors,
        simulation,
        calibrated,
    } = drive(&preset, seed)?;

    let (model, identified) = match models {
        Models::Truth => (preset, None),
        Models::Identified => {
            let record = static_record(&sensors, &preset, seed);
            let told = |more| done(Stage::Identification, more, AXES.len() as u64);
            told(0);
            let found = identify::run(&record, &Options::at(RATE_HZ), || told(1));
            let model = found.model(Some(&preset), PRESET, Provenance::default())?;
            (model, Some((record, found)))
        }
    };

    let ends = simulation.gnss.first().zip(simulation.gnss.last());
    let (first, last) = ends.map_or((0.0, 0.0), |(a, b)| (a.time, b.time));
    let (count, length, every, start) = OUTAGES;
    let plan = Schedule::Every {
        start,
        every,
        count: Some(count),
    };
    let outages = outages::schedule(&plan, length, first, last)?;
    let settings = |kind: BiasModel| -> Result<(String, Settings), ModelError> {
        let settings = Settings {
            lever_arm: LEVER_ARM.into(),
            outages: outages.clone(),
            ..Settings::new(model.shaping(kind, interval)?)
        };
        Ok((kind.name().to_owned(), settings))
    };
    let models = BiasModel::ALL
        .into_iter()
        .map(settings)
        .collect::<Result<Vec<_>, _>>()?;
    // One more, on the calibrated samples.
    let total = ((models.len() + 1) * simulation.imu.len()) as u64;
    let told = |more| done(Stage::Navigation, more, total);
    let fixes = Measurement::of_fixes(&simulation.gnss);
    told(0);
    let mut runs = outages::run(&simulation.imu, &fixes, &simulation.truth, &models, &told);
    let (_, white) = settings(BiasModel::White)?;
    let white = [(WHITE_CALIBRATED.to_owned(), white)];
    runs.extend(outages::run(
        &calibrated,
        &fixes,
        &simulation.truth,
        &white,
        &told,
    ));
    Ok(Demo {
        seed,
        identified,
        simulation,
        outages,
        runs,
    })
}

/// The simulated drive.
struct Drive {
    /// The truth of the sensors but for their turn-on constants.
    sensors: [ShapingFilter; covariance::AXES],
    simulation: Simulation,
    /// The samples without turn-on constants.
    calibrated: Vec<ImuSample>,
}

/// The drive of a seed by a sensor of this model.
fn drive(preset: &ImuModel, seed: u64) -> Result<Drive, DemoError> {
    let gnss = GnssNoise {
        position_std: [0.02, 0.02, 0.04],
        velocity_std: [0.03, 0.03, 0.05],
        rate_hz: 5.0,
        lever_arm: LEVER_ARM.into(),
        ..GnssNoise::default()
    };
    // The sensors' truth: white noise and Gauss-Markov bias here, the turn-on constants below, so
    // that they can also be left out.
    let mut without_turn_on = preset.clone();
    for axis in without_turn_on
        .gyro
        .iter_mut()
        .chain(&mut without_turn_on.accel)
    {
        axis.turn_on = 0.0;
    }
    let sensors = without_turn_on.shaping(BiasModel::GaussMarkov, 1.0 / RATE_HZ)?;
    let mut simulation = simulate(
        &Trajectory::car(DURATION, seed),
        RATE_HZ,
        Some(&sensors),
        &gnss,
        seed,
    )?;
    let calibrated = simulation.imu.clone();
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut constant = |axes: &[undrift_noise::AxisModel; 3]| {
        Vector3::from_iterator(axes.iter().map(|axis| {
            let unit: f64 = StandardNormal.sample(&mut random);
            axis.turn_on * unit
        }))
    };
    let (gyro, accel) = (constant(&preset.gyro), constant(&preset.accel));
    for sample in &mut simulation.imu {
        *sample = ImuSample {
            dtheta: sample.dtheta + gyro * sample.dt,
            dvel: sample.dvel + accel * sample.dt,
            ..*sample
        };
    }
    Ok(Drive {
        sensors,
        simulation,
        calibrated,
    })
}

/// A static record of the sensors, with other draws of everything than the drive's.
fn static_record(
    sensors: &[undrift_nav::shaping::ShapingFilter; 6],
    preset: &ImuModel,
    seed: u64,
) -> Record {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed ^ 0x57a7_1c00);
    let samples = (STATIC_DURATION * RATE_HZ) as usize;
    let series = |axis: usize| {
        let constant: f64 = StandardNormal.sample(&mut random);
        let mut generator = NoiseGenerator::with_rng(&sensors[axis], random.clone());
        random.jump();
        // At rest, level: the accelerometers' z reads the reaction to gravity.
        let at_rest = if axis == 5 {
            -undrift_nav::earth::STANDARD_GRAVITY
        } else {
            0.0
        };
        let turn_on = preset.axes()[axis].1.turn_on * constant;
        (0..samples)
            .map(|_| at_rest + turn_on + generator.sample())
            .collect()
    };
    Record {
        axes: AXES.to_vec(),
        samples: (0..6).map(series).collect(),
        ..Record::default()
    }
}

/// Name of the row for `white` on samples without their turn-on constants, as a laboratory
/// calibration of this very run would leave them.
pub const WHITE_CALIBRATED: &str = "white, no constants";
