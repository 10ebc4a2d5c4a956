//! Monte Carlo: one simulated drive, many draws of its noise, and whether the filter's errors are as
//! large as its covariance says.
//!
//! The motion is the same in every run; the sensors' errors with their turn-on constants, the GNSS
//! noise and, where asked for, the error of the first attitude are drawn for each run. What is measured is in
//! [`undrift_drive::consistency`]. Runs go over all cores; the result does not depend on how many there are.
//!
//! The true bias is what can be predicted of the sensor's next error by the model that the errors
//! are drawn from, `h·x`. Another form of the same noise predicts another thing (the innovations
//! form of a Gauss-Markov process in white noise predicts the error, not the process), so the NEES
//! of biases means something where simulation and filter have the same form; that of position,
//! velocity and attitude always does.

mod report;
mod spec;

use report::RunOutcome;
pub use spec::{MAX_RUN_EPOCHS, Spec};

use rand::{Rng, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::cell::Cell;
use undrift_base::parallel;
use undrift_drive::{
    consistency::{ErrorState, GROUPS},
    drive::DriveError,
    replay::{Measurement, Observer, ReplayError, STAMP_ROUNDING, Settings, replay},
};
use undrift_engine::estimator::Estimator;
use undrift_nav::{
    Matrix3, Quaternion, Vector3,
    attitude::{from_rotation_vector, to_rpy},
    covariance::AXES,
    filter::Update,
    sample::{GnssFix, ImuSample, Position, TruthSample},
};
use undrift_noise::ModelError;
use undrift_results::{MonteCarlo, MonteCarloDrive, SCHEMA, VERSION, numbers};
use undrift_simulate::{
    GnssFixes, GnssNoise, IdealImu, SensorErrors, SimulationError, Stepper, stream_seed,
};

/// Why there is no Monte Carlo.
#[derive(Debug, thiserror::Error)]
pub enum MonteCarloError {
    /// The specification says something it cannot.
    #[error(transparent)]
    Drive(#[from] DriveError),
    /// Nothing can be simulated.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// The model makes no filter.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// Too few or too many runs.
    #[error("{runs} runs of this drive: must be {FEWEST_RUNS} to {most}")]
    Runs {
        /// How many were asked for.
        runs: usize,
        /// How many there may be.
        most: usize,
    },
    /// A run ended without a solution.
    #[error("{model}, run {run}: {error}")]
    Replay {
        /// Bias model of the filter.
        model: String,
        /// Run, from 1.
        run: usize,
        /// Why.
        error: Box<ReplayError>,
    },
}

/// Fewest runs: an average over fewer has no spread to speak of.
const FEWEST_RUNS: usize = 2;

/// Runs carried out before their results are added up and forgotten.
const BATCH: usize = 64;

/// What all runs share.
struct Shared<'a> {
    spec: &'a Spec,
    ideal: Vec<ImuSample>,
    /// Truth at every `stride`-th sample.
    truth: Vec<TruthSample>,
    stride: usize,
    fix_times: Vec<f64>,
    /// Attitude at the first fix.
    first_attitude: Quaternion,
    models: Vec<(String, Settings)>,
}

/// Carries out `runs` runs of `spec`; `done` is called after each.
///
/// # Errors
/// For a specification that cannot be simulated or filtered, and for a run without alignment. A run
/// that diverges is no error: it is counted.
pub fn run(
    spec: &Spec,
    runs: usize,
    seed: u64,
    done: impl Fn() + Sync,
) -> Result<MonteCarlo, MonteCarloError> {
    let stage = Shared::new(spec)?;
    let most = MAX_RUN_EPOCHS / stage.truth.len().max(1);
    if !(FEWEST_RUNS..=most).contains(&runs) {
        return Err(MonteCarloError::Runs { runs, most });
    }
    // Two draws a run, whatever is asked of it: sensors and receiver, first attitude.
    let mut master = Xoshiro256PlusPlus::seed_from_u64(seed);
    let seeds: Vec<[u64; 2]> = (0..runs)
        .map(|_| [master.next_u64(), master.next_u64()])
        .collect();
    let mut sums: Vec<report::RunSums> = stage
        .models
        .iter()
        .map(|_| report::RunSums::new(stage.truth.len(), stage.fix_times.len()))
        .collect();
    for (batch, seeds) in seeds.chunks(BATCH).enumerate() {
        let outcomes = parallel::map(seeds.len(), |run| {
            let outcome = stage.one_run(seeds[run]);
            done();
            outcome
        });
        // In the order of the runs, so that sums round alike on any number of cores.
        for (at, outcome) in outcomes.into_iter().enumerate() {
            let outcomes = outcome.map_err(|error| error.at_run(batch * BATCH + at + 1))?;
            for (sums, outcome) in sums.iter_mut().zip(&outcomes) {
                sums.add(outcome);
            }
        }
    }
    let names = stage.models.iter().map(|(name, _)| name.clone());
    Ok(MonteCarlo {
        undrift: VERSION.into(),
        schema: SCHEMA,
        runs: runs as u64,
        seed,
        settle_s: spec.settle.into(),
        drive: MonteCarloDrive {
            duration_s: spec.trajectory.duration.into(),
            rate_hz: spec.rate_hz.into(),
            drawn_as: spec.bias_model.name().into(),
            model: spec.model.name.clone(),
            filter_model: spec.filter_model.name.clone(),
            every_s: spec.every.into(),
        },
        time_s: numbers(stage.truth.iter().map(|t| t.time)),
        fix_time_s: numbers(stage.fix_times.iter().copied()),
        models: names
            .zip(&sums)
            .map(|(name, sums)| sums.report(name, &stage.truth, &stage.fix_times, spec.settle))
            .collect(),
    })
}

impl MonteCarloError {
    fn at_run(self, number: usize) -> Self {
        match self {
            Self::Replay { model, error, .. } => Self::Replay {
                model,
                run: number,
                error,
            },
            other => other,
        }
    }
}

impl<'a> Shared<'a> {
    fn new(spec: &'a Spec) -> Result<Self, MonteCarloError> {
        let stride = (spec.every * spec.rate_hz).round().max(1.0) as usize;
        let mut ideal = Vec::new();
        let mut truth = Vec::new();
        for (k, (sample, state)) in IdealImu::new(&spec.trajectory, spec.rate_hz).enumerate() {
            ideal.push(sample);
            if (k + 1) % stride == 0 {
                truth.push(state);
            }
        }
        let fix_times: Vec<f64> = GnssFixes::new(&spec.trajectory, &spec.gnss, 0)?
            .map(|fix| fix.time)
            .collect();
        let mut stepper = Stepper::new(&spec.trajectory);
        stepper.advance_to(fix_times.first().copied().unwrap_or(0.0));
        // Reports errors before the first run.
        SensorErrors::new(&spec.sensors()?, spec.rate_hz, 0)?;
        Ok(Self {
            spec,
            ideal,
            truth,
            stride,
            fix_times,
            first_attitude: stepper.state().motion.q_nb,
            models: spec.settings()?,
        })
    }

    /// Every model over one draw.
    fn one_run(&self, [seed, start_seed]: [u64; 2]) -> Result<Vec<RunOutcome>, MonteCarloError> {
        let spec = self.spec;
        let sensors = spec.sensors()?;
        let drawn = Drawn::new(spec, seed);
        let gnss = drawn.fixes(spec, seed)?;
        let start = spec.truth_std.map(|std| {
            let mut generator = Xoshiro256PlusPlus::seed_from_u64(start_seed);
            let psi = std.map(|s| {
                let w: f64 = StandardNormal.sample(&mut generator);
                s * w
            });
            // The truth is the estimate turned by +ψ.
            let estimate = from_rotation_vector(&-psi) * self.first_attitude;
            (to_rpy(&estimate), std)
        });
        let one_model = |(name, settings): &(String, Settings)| {
            let mut settings = settings.clone();
            if start.is_some() {
                settings.align.attitude = start;
            }
            // The true bias is where the samples come from, and is looked at where they go.
            let now = Cell::new([(0, [0.0; AXES]); 2]);
            let mut errors = SensorErrors::new(&sensors, spec.rate_hz, seed)?;
            let mut samples = self.ideal.iter().enumerate().map(|(k, ideal)| {
                let sample = errors.apply(&drawn.scaled(ideal));
                let bias = if (k + 1) % self.stride == 0 {
                    drawn.bias(errors.bias())
                } else {
                    [f64::NAN; AXES]
                };
                now.set([now.get()[1], (k + 1, bias)]);
                Ok(sample)
            });
            let mut watch = RunWatch {
                stage: self,
                settings: &settings,
                now: &now,
                outcome: RunOutcome {
                    nees: vec![[f64::NAN; GROUPS]; self.truth.len()],
                    nis: vec![[f64::NAN; 2]; self.fix_times.len()],
                    ..RunOutcome::default()
                },
            };
            let mut fixes = gnss.iter().copied().map(Measurement::Gnss).map(Ok);
            let summary =
                replay(&mut samples, &mut fixes, &settings, &mut watch).map_err(|error| {
                    MonteCarloError::Replay {
                        model: name.clone(),
                        run: 0,
                        error: Box::new(error),
                    }
                })?;
            let mut outcome = watch.outcome;
            outcome.diverged = summary.diverged.is_some();
            Ok(outcome)
        };
        self.models.iter().map(one_model).collect()
    }
}

/// What a run draws beside noise: constants, and the state of what lasts of the position's error.
struct Drawn {
    generator: Xoshiro256PlusPlus,
    gyro_scale: [f64; 3],
    /// How much later than stamped position and velocity are \[s\].
    late: [f64; 2],
}

impl Drawn {
    /// With the last stream of `seed` ([`undrift_simulate::stream_seed`]), which no other sensor needs here.
    fn new(spec: &Spec, seed: u64) -> Self {
        let mut generator = Xoshiro256PlusPlus::seed_from_u64(stream_seed(seed, usize::MAX));
        let mut draw = |std: f64| -> f64 {
            let w: f64 = StandardNormal.sample(&mut generator);
            std * w
        };
        Self {
            gyro_scale: std::array::from_fn(|_| draw(spec.scale_factor)),
            late: std::array::from_fn(|_| draw(spec.time_offset)),
            generator,
        }
    }

    /// The sample with the scale factors of the gyros.
    fn scaled(&self, ideal: &ImuSample) -> ImuSample {
        let mut sample = *ideal;
        for (turn, scale) in sample.dtheta.iter_mut().zip(self.gyro_scale) {
            *turn *= 1.0 + scale;
        }
        sample
    }

    /// The biases as a filter has them that takes the scale factors off what is read: of (1 + s) ω + b the rate is
    /// the reading less s/(1 + s) of it, less b/(1 + s).
    fn bias(&self, mut bias: [f64; AXES]) -> [f64; AXES] {
        for (bias, scale) in bias.iter_mut().zip(self.gyro_scale) {
            *bias /= 1.0 + scale;
        }
        bias
    }

    /// The fixes with the offsets of their stamps and what lasts of their error.
    fn fixes(&self, spec: &Spec, seed: u64) -> Result<Vec<GnssFix>, SimulationError> {
        let mut generator = self.generator.clone();
        let (share, time) = spec.correlated.map_or((0.0, 1.0), |c| (c.share, c.time));
        let phi = (-1.0 / (spec.gnss.rate_hz * time)).exp();
        let white = GnssNoise {
            position_std: spec.gnss.position_std.map(|std| std * (1.0 - share).sqrt()),
            ..spec.gnss
        };
        let late = |time_offset: f64| {
            let noise = GnssNoise {
                time_offset,
                ..white
            };
            GnssFixes::new(&spec.trajectory, &noise, seed)
        };
        let [position, velocity] = self.late;
        let stated = Matrix3::from_diagonal(&Vector3::from(spec.gnss.position_std).map(|s| s * s));
        let mut lasting: Option<Vector3> = None;
        let fixes = late(position)?.zip(late(velocity)?).zip(late(0.0)?);
        Ok(fixes
            .map(|((first, second), exact)| {
                let mut draw = || Vector3::from_fn(|_, _| StandardNormal.sample(&mut generator));
                let state = match lasting {
                    Some(before) => before * phi + draw() * (1.0 - phi * phi).sqrt(),
                    None => draw(),
                };
                lasting = Some(state);
                let error = Vector3::from(spec.gnss.position_std).component_mul(&state);
                let error = error * (share.sqrt() * spec.gnss.noise_scale);
                let moved = |(position, _)| match position {
                    Position::Geodetic(at) => (Position::Geodetic(at.displaced(&error)), stated),
                    baseline => (baseline, stated),
                };
                GnssFix {
                    position: first.position.map(moved),
                    velocity: second.velocity,
                    ..exact
                }
            })
            .collect())
    }
}

/// Looks at a run.
struct RunWatch<'a> {
    stage: &'a Shared<'a>,
    settings: &'a Settings,
    /// The last two samples by their number from 1 and, at epochs, the true bias after them: the replay holds one back.
    now: &'a Cell<[(usize, [f64; AXES]); 2]>,
    outcome: RunOutcome,
}

impl RunWatch<'_> {
    /// Whether the navigation has settled at `time` \[s\]; the first time asked is its beginning.
    fn settled(&mut self, time: f64) -> bool {
        let started = *self.outcome.started.get_or_insert(time);
        time >= started + self.stage.spec.settle - STAMP_ROUNDING
    }
}

impl Observer for RunWatch<'_> {
    fn sample(&mut self, filter: &dyn Estimator) -> Result<(), ReplayError> {
        let settled = self.settled(filter.nav().time);
        let interval = self.settings.sensors[0].interval;
        let number = (filter.nav().time / interval).round() as usize;
        let now = self.now.get();
        let Some((samples, bias)) = now.into_iter().find(|(samples, _)| *samples == number) else {
            return Ok(());
        };
        if samples % self.stage.stride != 0 {
            return Ok(());
        }
        let epoch = samples / self.stage.stride - 1;
        let (Some(truth), Some(nees)) = (
            self.stage.truth.get(epoch),
            self.outcome.nees.get_mut(epoch),
        ) else {
            return Ok(());
        };
        let state = ErrorState::new(filter, truth, Some(&bias));
        for group in 0..GROUPS {
            if let Some((value, freedom)) = state.nees(group) {
                nees[group] = value;
                self.outcome.freedom[group] = freedom;
            }
        }
        if settled {
            self.outcome.settled.add(&state);
        }
        Ok(())
    }

    fn updated(&mut self, time: f64, updates: [Option<Update>; 2]) {
        let settled = self.settled(time);
        let times = &self.stage.fix_times;
        let fix = times.partition_point(|at| *at < time - STAMP_ROUNDING);
        for (kind, update) in updates.into_iter().enumerate() {
            if let Some(update) = update
                && let Some(nis) = self.outcome.nis.get_mut(fix)
            {
                nis[kind] = update.nis;
                if settled {
                    self.outcome.innovations[kind].add(time, &update.whitened);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
