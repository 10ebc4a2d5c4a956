//! The most likely noise of some drives, and how sure that is.

mod uncertainty;

use super::{
    filter::Fixed,
    noise::{COUNT, Noise, Vector},
    objective::{Layout, Objective, Score},
    prior::Prior,
    rest_noise::RestNoise,
    search::minimise,
    steps::{Followed, condense},
};
use nalgebra::{DMatrix, DVector};
use undrift_drive::replay::{Measurement, ReplayError, replay};
use undrift_engine::{
    estimator::{LogTo, Logged},
    settings::Settings,
    vehicle::NonHolonomic,
};
use undrift_nav::{
    covariance::{AXES, NAV},
    filter::FilterError,
    parameters::Parameter,
    sample::ImuSample,
    shaping::ShapingFilter,
};
use undrift_noise::synthesis::NoiseGenerator;

/// A drive in memory.
pub struct FitLog<'a> {
    /// Inertial samples.
    pub imu: &'a [ImuSample],
    /// Fixes and what else there is.
    pub aiding: &'a [Measurement],
    /// How it is navigated, whatever the noise.
    pub settings: Settings,
    /// Nothing later than this is looked at \[s\].
    pub until: f64,
}

/// What the drives say.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The most likely noise.
    pub noise: Noise,
    /// 95 % intervals of its logarithms; as wide as the prior's where the drives say little.
    pub interval: [(f64, f64); COUNT],
    /// Log-likelihood of what it has seen, with the prior's density.
    pub likelihood: f64,
    /// Windows that were scored.
    pub windows: usize,
    /// Evaluations of the objective.
    pub evaluations: usize,
    /// Whether nothing more was to be gained.
    pub converged: bool,
}

/// An interval that has shrunk to less than this share of the prior's is the drives' doing …
const DETERMINED: f64 = 0.5;
/// … where it does not reach down to this share of what was found, either: of one that is too small to matter the drives say no more than that it is
/// small, and where it passes by chance it is found several times too large.
const SEEN: f64 = 1.0 / 3.0;

impl Fit {
    /// Whether the drives determine a parameter.
    pub fn determines(&self, prior: &Prior, i: usize) -> bool {
        let ((low, high), known) = (self.interval[i], prior.interval(i));
        let z = self.noise.ln()[i];
        high - low < DETERMINED * (known.1 - known.0) && low - z > SEEN.ln()
    }
}

/// Most replays about a better solution each, of drives by fixes and by poses.
const REPLAYS: [usize; 2] = [3, 6];
/// Fixes are so coarse that what is found about one solution serves the next. With poses of millimetres it may be less likely under the
/// solution of its own than what was before, since gates and what is not linear make that another one: then half as far, up to so many times.
const HALVINGS: i32 = 5;
/// Most evaluations of the objective about one.
const EVALUATIONS: usize = 60;
/// A logarithm that changes by less from one replay to the next has come to rest.
const SETTLED: f64 = 0.1;
/// Length of the spans of which only neighbours depend on each other \[s\].
const BLOCK: f64 = 45.0;
/// The inverse of the first curvature.
const FIRST: f64 = 0.05;

/// Whether logarithms have come to rest from one replay to the next.
fn is_at_rest(before: &Vector, now: &Vector) -> bool {
    let moved = before.iter().zip(now).map(|(a, b)| (a - b).abs());
    moved.fold(0.0, f64::max) < SETTLED
}

/// The first that there is at `found`, half as far from `z`, a quarter …, the way halved up to so many times.
fn first_towards<T>(
    z: &Vector,
    found: &Vector,
    halvings: i32,
    of: impl Fn(&Vector) -> Option<T>,
) -> Option<T> {
    (0..=halvings).find_map(|halved| {
        let share = 0.5f64.powi(halved);
        of(&std::array::from_fn(|i| z[i] + share * (found[i] - z[i])))
    })
}

/// The settings of a replay under a noise.
///
/// # Errors
/// [`FilterError::BadMeasurement`] for a density that is negative or not finite.
pub fn under(
    settings: &Settings,
    noise: &Noise,
    start: &RestNoise,
) -> Result<Settings, FilterError> {
    let mut settings = settings.clone();
    let bad = |_| FilterError::BadMeasurement;
    let white = match &mut settings.vibration {
        Some(factors) => {
            *factors = noise.white;
            start.white
        }
        None => noise.white,
    };
    for (axis, sensor) in settings.sensors.iter_mut().enumerate() {
        let interval = sensor.interval;
        let white = ShapingFilter::white(white[axis], interval).map_err(bad)?;
        let walk = ShapingFilter::random_walk(noise.walk[axis], interval).map_err(bad)?;
        *sensor = white.plus(&walk).map_err(bad)?;
        sensor.p0[0][0] = start.turn_on[axis] * start.turn_on[axis];
    }
    settings.fix_errors = settings.fix_errors.scaled(&noise.factors);
    if let Some(rule) = &mut settings.constraints.non_holonomic {
        [rule.right, rule.down, rule.slip] = noise.rule;
    }
    Ok(settings)
}

/// Objectives of the drives about their solutions under a noise.
struct Linear<const N: usize> {
    drives: Vec<Objective<N>>,
    about: Noise,
}

impl<const N: usize> Linear<N> {
    fn new(logs: &[FitLog], about: Noise, start: &RestNoise) -> Result<Self, ReplayError> {
        let drive = |log: &FitLog| {
            let (sender, receiver) = std::sync::mpsc::channel::<Logged>();
            let settings = Settings {
                log: Some(LogTo::new(move |logged| drop(sender.send(logged)))),
                restart: false,
                ..under(&log.settings, &about, start)?
            };
            let behind = NAV + settings.sensors.iter().map(|s| s.order).sum::<usize>();
            let parameters = settings.parameters;
            let at = |kind| parameters.start(kind).map(|at| behind + at);
            let fixed = Fixed {
                lasting: [at(Parameter::PositionError), at(Parameter::VelocityError)],
                scale: parameters
                    .prior(Parameter::GyroScale)
                    .and_then(|prior| Some((at(Parameter::GyroScale)?, prior.walk * prior.walk))),
                rule: settings
                    .constraints
                    .non_holonomic
                    .unwrap_or(NonHolonomic::CAR),
                white: match settings.vibration {
                    Some(_) => start.white.map(|white| white * white),
                    None => [0.0; AXES],
                },
            };
            let followed = settings.vibration.map(|factors| Followed {
                white: settings.sensors.map(|sensor| sensor.r),
                interval: settings.sensors[0].interval,
                factors,
            });
            let within = |sample: &&ImuSample| sample.time <= log.until;
            let samples = &mut log.imu.iter().take_while(within).copied().map(Ok);
            let aiding = &mut log.aiding.iter().copied().map(Ok);
            replay(samples, aiding, &settings, &mut ())?;
            drop(settings);
            Ok(Objective::new(
                condense(receiver, followed.as_ref()),
                fixed,
                match log.settings.marker {
                    Some(_) => Layout::OF_POSES,
                    None => Layout::default(),
                },
            ))
        };
        let drives = logs.iter().map(drive).collect::<Result<_, ReplayError>>()?;
        Ok(Self { drives, about })
    }

    fn score(&self, z: &Vector) -> Score {
        let noise = Noise::new(z).against(&self.about);
        self.drives.iter().map(|drive| drive.score(&noise)).sum()
    }

    /// Those of [`Linear::by_block`] if the drives' errors were draws under the noise.
    fn drawn(&mut self, z: &Vector, one: &mut NoiseGenerator) -> Vec<Vector> {
        let noise = Noise::new(z).against(&self.about);
        let drawn = self.drives.iter().map(|drive| drive.drawn(&noise, one));
        let mut innovations = Vec::from_iter(drawn);
        let mut exchange = |drives: &mut [Objective<N>]| {
            for (drive, other) in drives.iter_mut().zip(&mut innovations) {
                drive.exchange(other);
            }
        };
        exchange(&mut self.drives);
        let blocks = self.by_block(z);
        exchange(&mut self.drives);
        blocks
    }

    /// Gradients of spans of the drives that are taken as independent.
    fn by_block(&self, z: &Vector) -> Vec<Vector> {
        let noise = Noise::new(z).against(&self.about);
        let mut blocks = Vec::new();
        for drive in &self.drives {
            let Some((first, last)) = drive.span() else {
                continue;
            };
            let count = ((last - first) / BLOCK).ceil().max(1.0) as usize;
            let length = (last - first) / count as f64;
            for k in 0..count {
                let from = first + k as f64 * length;
                let to = if k + 1 == count {
                    f64::INFINITY
                } else {
                    from + length
                };
                blocks.push(drive.score_between(&noise, from, to).gradient);
            }
        }
        blocks
    }
}

/// What the search makes small: minus the logarithm of the drives' likelihood times the prior's density, each with its
/// full weight, and the derivatives.
fn cost(score: &Score, prior: &Prior, z: &Vector) -> (f64, DVector<f64>) {
    let (penalty, slope) = prior.penalty(z);
    let by = |i: usize, _| slope[i] - score.gradient[i];
    (penalty - score.value, DVector::from_fn(COUNT, by))
}

/// The function of the least size that has room for the drives' states.
macro_rules! by_size {
    ($logs:expr, $of:ident) => {
        match $logs.iter().map(states).max().unwrap_or(0) {
            ..=24 => $of::<24>,
            25..=32 => $of::<32>,
            33..=40 => $of::<40>,
            _ => $of::<56>,
        }
    };
}

/// Number of states of a drive's filter.
fn states(log: &FitLog) -> usize {
    NAV + 6 + log.settings.parameters.states()
}

/// Finds the most likely noise, beginning with `from`; `goes_on` gets the objective before each iteration and says
/// whether to make it: the fit ends with the best so far.
///
/// # Errors
/// A drive that cannot be navigated.
pub fn fit(
    logs: &[FitLog],
    start: &RestNoise,
    prior: &Prior,
    from: Noise,
    sure: bool,
    goes_on: &dyn Fn(f64) -> bool,
) -> Result<Fit, ReplayError> {
    let fit = by_size!(logs, fit_sized);
    fit(logs, start, prior, from, sure, goes_on)
}

fn fit_sized<const N: usize>(
    logs: &[FitLog],
    start: &RestNoise,
    prior: &Prior,
    from: Noise,
    sure: bool,
    goes_on: &dyn Fn(f64) -> bool,
) -> Result<Fit, ReplayError> {
    let mut fit = Fit {
        noise: from,
        interval: std::array::from_fn(|i| prior.interval(i)),
        likelihood: f64::NEG_INFINITY,
        windows: 0,
        evaluations: 0,
        converged: false,
    };
    let mut before: Option<Noise> = None;
    let mut inverse = DMatrix::from_diagonal_element(COUNT, COUNT, FIRST);
    let posed = logs.iter().any(|log| log.settings.marker.is_some());
    let mut linear = Linear::<N>::new(logs, fit.noise, start)?;
    for replays in 1.. {
        fit.windows = linear.drives.iter().map(Objective::windows).sum();
        let z = fit.noise.ln();
        let rest = before.is_some_and(|before| is_at_rest(&before.ln(), &z));
        fit.converged |= rest;
        if rest || fit.windows == 0 || replays > REPLAYS[usize::from(posed)] {
            break;
        }
        let least = minimise(
            |z| {
                let z = std::array::from_fn(|i| z[i]);
                cost(&linear.score(&z), prior, &z)
            },
            DVector::from_row_slice(&z),
            &inverse,
            EVALUATIONS,
            goes_on,
        );
        inverse = least.inverse;
        before = Some(fit.noise);
        fit.evaluations += least.evaluations;
        fit.converged = least.converged;
        let about = |linear: &Linear<N>, z: &Vector| cost(&linear.score(z), prior, z).0;
        let most = posed.then(|| about(&linear, &z));
        let halvings = if posed { HALVINGS } else { 0 };
        let found: Vector = std::array::from_fn(|i| least.z[i]);
        let next = first_towards(&z, &found, halvings, |there| {
            let next = Linear::<N>::new(logs, Noise::new(there), start).ok()?;
            let better = most.is_none_or(|most| about(&next, there) <= most);
            better.then_some(next)
        });
        match next {
            Some(next) => (fit.noise, linear) = (next.about, next),
            None if posed => break,
            // Under the noise found the drive may be too short to align: then it is judged about what there is.
            None => {
                fit.noise = Noise::new(&found);
                fit.converged = false;
                break;
            }
        }
    }
    let z = fit.noise.ln();
    fit.likelihood = -cost(&linear.score(&z), prior, &z).0;
    if sure {
        fit.interval = uncertainty::intervals(&mut linear, prior, &z);
    }
    Ok(fit)
}

/// Log-likelihood of what the fit of a noise has not seen, from the first of these times of each drive on \[s\].
///
/// # Errors
/// A drive that cannot be navigated.
pub fn unseen_likelihood(
    logs: &[FitLog],
    start: &RestNoise,
    noise: &Noise,
    spans: &[(f64, f64)],
) -> Result<f64, ReplayError> {
    let whole = logs.iter().map(|log| FitLog {
        until: f64::INFINITY,
        settings: log.settings.clone(),
        ..*log
    });
    let whole: Vec<FitLog> = whole.collect();
    let likelihood = by_size!(logs, unseen_sized);
    likelihood(&whole, start, noise, spans)
}

fn unseen_sized<const N: usize>(
    logs: &[FitLog],
    start: &RestNoise,
    noise: &Noise,
    spans: &[(f64, f64)],
) -> Result<f64, ReplayError> {
    let linear = Linear::<N>::new(logs, *noise, start)?;
    let own = noise.against(noise);
    let each = linear.drives.iter().zip(spans);
    Ok(each
        .map(|(drive, span)| drive.score_between(&own, span.0, f64::INFINITY).value)
        .sum())
}

#[cfg(test)]
mod tests;
