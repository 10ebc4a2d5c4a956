//! Bias models: the shaping filter that is made of what a model file knows of an axis.
//!
//! | name | states | what it is |
//! |---|---|---|
//! | `white` | 0 | white noise alone |
//! | `paper` | 1 | Wang, Lyu & Wu 2016, equations (3)-(9) to the letter |
//! | `gauss-markov` | 2 | white noise, Gauss-Markov process (or processes), turn-on constant |
//! | `random-walk` | 1 | white noise, random walk started at the turn-on constant |
//! | `ar` | 3 | AR([`AR_ORDER`]) predictor of the whole error, turn-on constant |
//! | `arma` | 1… | exact: innovations form of the ARMA, else the sum of all terms, turn-on constant |
//!
//! A turn-on constant takes a state of its own unless the filter has an integrator to start at it;
//! without `turn_on` there is none. Terms that the file does not give are derived from its ARMA
//! where that is an ARMA(1,1) with 1 ≥ φ > θ > 0, which is exactly a first-order process plus white
//! noise (docs/theory.md, section 1).
//!
//! ```
//! use undrift_noise::{BiasModel, ImuModel};
//! let imu = ImuModel::preset("adis16405").unwrap();
//! let [gyro_x, ..] = imu.shaping(BiasModel::GaussMarkov, 0.005)?;
//! assert_eq!(gyro_x.order, 2);
//! # Ok::<(), undrift_noise::ModelError>(())
//! ```

use crate::composite::GaussMarkov;
use crate::model_file::{AXES, Arma, AxisModel, ImuModel, ModelError};
use crate::prediction::Predictor;
use crate::terms;
use std::fmt;
use undrift_nav::shaping::{MAX_ORDER, ShapingError, ShapingFilter};

/// Order p of the `ar` model.
pub const AR_ORDER: usize = 2;

/// Correlation time \[s\] used for a unit root in the `ar` model: what an hour-long record
/// shows of a random walk.
pub const UNIT_ROOT_TAU: f64 = 3600.0;

/// Rates closer than this, relatively, count as one: time stamps do not give a rate better.
const SAME_RATE: f64 = 1e-3;

/// Model of the bias of a sensor axis. [`BiasModel::Arma`] carries all that the model file has but its spectral lines; the others leave more
/// out, for comparison or for fewer states (docs/choose-model.md).
///
/// ```
/// use undrift_noise::{BiasModel, ImuModel};
/// let imu = ImuModel::preset("adis16405").ok_or("no such preset")?;
/// let order = |model| Ok::<_, undrift_noise::ModelError>(imu.shaping(model, 0.01)?[0].order); // States of gyro x at 100 Hz.
/// assert_eq!((order(BiasModel::White)?, order(BiasModel::Paper)?, order(BiasModel::GaussMarkov)?), (0, 1, 2));
/// assert_eq!("random-walk".parse(), Ok(BiasModel::RandomWalk));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BiasModel {
    /// White noise alone, no bias state: the source paper's baseline.
    White,
    /// The source paper's model: `b_k = φ b_{k−1} + w`, `w ~ N(0, (1 + θ²)σ²)`, nothing white beside it.
    Paper,
    /// White noise, first-order Gauss-Markov process and turn-on constant.
    GaussMarkov,
    /// White noise and a random walk that starts at the turn-on constant.
    RandomWalk,
    /// Autoregressive predictor of the whole error, and turn-on constant.
    Ar,
    /// ARMA in innovations form, exact, and turn-on constant.
    Arma,
}

impl BiasModel {
    /// Every model, in the order of tables.
    pub const ALL: [Self; 6] = [
        Self::White,
        Self::Paper,
        Self::GaussMarkov,
        Self::RandomWalk,
        Self::Ar,
        Self::Arma,
    ];

    /// Its name in files, arguments and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::White => "white",
            Self::Paper => "paper",
            Self::GaussMarkov => "gauss-markov",
            Self::RandomWalk => "random-walk",
            Self::Ar => "ar",
            Self::Arma => "arma",
        }
    }
}

impl fmt::Display for BiasModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A name that is not that of a bias model; its message lists the names.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown bias model {0:?}; available: white, paper, gauss-markov, random-walk, ar, arma")]
pub struct UnknownBiasModel(pub String);

impl std::str::FromStr for BiasModel {
    type Err = UnknownBiasModel;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        Self::ALL
            .into_iter()
            .find(|model| model.name() == name)
            .ok_or_else(|| UnknownBiasModel(name.to_owned()))
    }
}

/// Why a filter cannot be made, before the axis and model are known.
enum Failure {
    Shaping(ShapingError),
    Missing(&'static str),
}

impl From<ShapingError> for Failure {
    fn from(error: ShapingError) -> Self {
        Self::Shaping(error)
    }
}

impl ImuModel {
    /// The shaping filters of the six axes, gyro x, y, z [rad/s] and accelerometer x, y, z [m/s²],
    /// at the sample interval \[s\]: what a filter or navigator is made with.
    ///
    /// # Errors
    /// An axis of which nothing is known, or of which the bias model cannot be made.
    pub fn shaping(
        &self,
        model: BiasModel,
        interval: f64,
    ) -> Result<[ShapingFilter; 6], ModelError> {
        let mut filters = [ShapingFilter::none(1.0)
            .map_err(|error| named(Failure::Shaping(error), model, None))?;
            6];
        for ((name, axis), slot) in self.known_axes()?.into_iter().zip(&mut filters) {
            *slot = axis
                .make(model, interval)
                .map_err(|failure| named(failure, model, Some(name)))?;
        }
        Ok(filters)
    }
}

fn named(failure: Failure, model: BiasModel, axis: Option<&'static str>) -> ModelError {
    let model = model.name();
    debug_assert!(axis.is_none_or(|axis| AXES.contains(&axis)));
    match failure {
        Failure::Shaping(error) => ModelError::Shaping { axis, model, error },
        Failure::Missing(needs) => ModelError::Missing { axis, model, needs },
    }
}

/// Correlation time from which on a process is a bias \[s\]; a faster one is gone between two fixes.
pub(crate) const SLOW: f64 = 1.0;
/// Length without fixes for which a random walk has to stand for processes \[s\].
pub(crate) const HORIZON: f64 = 30.0;

/// The slow part of an error as independent terms.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Slow {
    pub(crate) processes: Vec<GaussMarkov>,
    pub(crate) walk: Option<f64>,
}

impl Slow {
    /// The process of the longest correlation time.
    pub(crate) fn slowest(&self) -> Option<&GaussMarkov> {
        self.processes
            .iter()
            .max_by(|a, b| a.tau_s.total_cmp(&b.tau_s))
    }

    /// Density [unit/√s] of the random walk equivalent to all of it: 2σ²/τ of the slowest Gauss-Markov process, which is
    /// such a random walk over times short against τ, and what is beside it.
    pub(crate) fn drive(&self) -> f64 {
        self.beside_slowest()
            .hypot(self.slowest().map_or(0.0, GaussMarkov::drive))
    }

    /// Density [unit/√s] of the random walk equivalent to all but the slowest Gauss-Markov process: K², and 2σ²/τ of
    /// each other process, over [`HORIZON`] where that is longer than τ: by then its variance has grown by 2σ² and
    /// grows no more.
    pub(crate) fn beside_slowest(&self) -> f64 {
        let k = self.walk.unwrap_or(0.0);
        let slowest = self.slowest();
        let is_other = |of: &&GaussMarkov| slowest.is_some_and(|one| !std::ptr::eq(one, *of));
        let others = self.processes.iter().filter(is_other);
        let others = others.filter(|of| of.tau_s >= SLOW);
        let density = |of: &GaussMarkov| 2.0 * of.sigma * of.sigma / of.tau_s.max(HORIZON);
        others.map(density).fold(k * k, |sum, of| sum + of).sqrt()
    }
}

impl AxisModel {
    /// The shaping filter of this axis [rad/s or m/s²] at the sample interval \[s\]. Densities, correlation times and random walks
    /// hold at every interval; an ARMA holds at the rate that it was identified at, and is carried over to another where such an
    /// ARMA exists.
    ///
    /// # Errors
    /// [`ModelError::Missing`] where the axis lacks what `model` is made of, [`ModelError::Shaping`] where
    /// that makes no filter: an invalid interval or term, more states than fit, an ARMA that does not
    /// exist at this interval.
    pub fn shaping(&self, model: BiasModel, interval: f64) -> Result<ShapingFilter, ModelError> {
        self.make(model, interval)
            .map_err(|failure| named(failure, model, None))
    }

    /// Density N of the white noise [unit·√s]: as given, else the white part of an ARMA(1,1), else
    /// all of the ARMA's innovations; zero for an axis without either.
    pub fn white_density(&self) -> f64 {
        match (&self.white, &self.arma) {
            (Some(density), _) => *density,
            (None, Some(arma)) => arma
                .split()
                .map_or(arma.sigma / arma.rate_hz.sqrt(), |(white, _)| white),
            (None, None) => 0.0,
        }
    }

    fn make(&self, model: BiasModel, interval: f64) -> Result<ShapingFilter, Failure> {
        let white = ShapingFilter::white(self.white_density(), interval)?;
        match model {
            BiasModel::White => Ok(white),
            BiasModel::Paper => self.paper(interval),
            BiasModel::GaussMarkov => {
                let slow = self.slow()?;
                let bias = match slow.walk {
                    // A random walk has no finite correlation time: it is taken as it is.
                    Some(k) if slow.processes.is_empty() => {
                        white.plus(&ShapingFilter::random_walk(k, interval)?)?
                    }
                    _ => with_processes(white, &slow.processes)?,
                };
                self.with_turn_on(bias)
            }
            BiasModel::RandomWalk => {
                let walk = ShapingFilter::random_walk(self.slow()?.drive(), interval)?;
                self.with_turn_on(white.plus(&walk)?)
            }
            BiasModel::Ar => {
                let autocovariance = self.record_autocovariance(interval)?;
                let (phi, variance) = yule_walker(&autocovariance);
                self.with_turn_on(ShapingFilter::ar(&phi, variance.sqrt(), interval)?)
            }
            BiasModel::Arma => self.with_turn_on(self.innovations(interval)?),
        }
    }

    fn with_turn_on(&self, filter: ShapingFilter) -> Result<ShapingFilter, Failure> {
        if self.turn_on == 0.0 {
            return Ok(filter);
        }
        Ok(filter.plus(&ShapingFilter::constant(self.turn_on, filter.interval)?)?)
    }

    /// The slow terms as given, else those of the ARMA.
    fn slow(&self) -> Result<Slow, Failure> {
        if !self.instability.is_empty() || self.random_walk.is_some() {
            return Ok(Slow {
                processes: self.instability.clone(),
                walk: self.random_walk,
            });
        }
        match &self.arma {
            Some(arma) if !arma.is_white() => arma.split().map(|(_, slow)| slow).ok_or(Failure::Missing(
                "bias_instability with correlation_time, or random_walk: the axis has only an ARMA that is not a first-order process plus white noise",
            )),
            _ => Ok(Slow::default()),
        }
    }

    /// The ARMA at this interval, or that of the terms: white noise plus a Gauss-Markov process or
    /// random walk is an ARMA(1,1) exactly. More terms stay a sum of independent ones, which is as
    /// exact.
    fn innovations(&self, interval: f64) -> Result<ShapingFilter, Failure> {
        if let Some(arma) = &self.arma {
            return Ok(arma.at(interval)?);
        }
        let white = ShapingFilter::white(self.white_density(), interval)?;
        match (&self.instability[..], self.random_walk, self.quantisation) {
            ([of], None, None) => {
                let process = ShapingFilter::gauss_markov(of.sigma, of.tau_s, interval)?;
                Ok(first_order_innovations(&process, white.r))
            }
            ([], Some(k), None) => {
                let process = ShapingFilter::random_walk(k, interval)?;
                Ok(first_order_innovations(&process, white.r))
            }
            (processes, walk, rounding) => {
                let mut sum = with_processes(white, processes)?;
                if let Some(k) = walk {
                    sum = sum.plus(&ShapingFilter::random_walk(k, interval)?)?;
                }
                if let Some(q) = rounding {
                    sum = sum.plus(&terms::quantisation(q, interval)?)?;
                }
                Ok(sum)
            }
        }
    }

    /// Autocovariance of the error without its constant at lags 0…[`AR_ORDER`], a random walk
    /// taken as a Gauss-Markov process of [`UNIT_ROOT_TAU`].
    fn record_autocovariance(&self, interval: f64) -> Result<[f64; AR_ORDER + 1], Failure> {
        let mut lags = [0.0; AR_ORDER + 1];
        let (white, slow) = match &self.arma {
            None => (self.white_density(), self.slow()?),
            Some(arma) => match arma.split() {
                Some(split) => split,
                None => {
                    arma.with_stationary_root()
                        .at(interval)?
                        .autocovariance(&mut lags);
                    return Ok(lags);
                }
            },
        };
        let walk = slow.walk.map(|k| GaussMarkov {
            sigma: k * (0.5 * UNIT_ROOT_TAU).sqrt(),
            tau_s: UNIT_ROOT_TAU,
        });
        let mut sum = with_processes(ShapingFilter::white(white, interval)?, &slow.processes)?;
        sum = with_processes(sum, walk.as_slice())?;
        if let (None, Some(q)) = (&self.arma, self.quantisation) {
            sum = sum.plus(&terms::quantisation(q, interval)?)?;
        }
        sum.autocovariance(&mut lags);
        Ok(lags)
    }

    /// Equations (3)-(9) of the source paper: `b_k = φ b_{k−1} + w_k` with `Q2 = (1 + θ²)σ²`, the
    /// moving-average part counted as if it were white, and no white part beside the bias. φ and θ
    /// are those of the `arma` model at this interval. Of a higher order it keeps all φ as a
    /// companion matrix, driven on its first state with `Q2 = (1 + Σθ²)σ²`.
    fn paper(&self, interval: f64) -> Result<ShapingFilter, Failure> {
        let same_rate = self.arma.as_ref().filter(|arma| arma.is_at(interval));
        let (phi, theta) = match same_rate {
            Some(arma) => (arma.ar.clone(), arma.ma.clone()),
            None => {
                let arma = self.innovations(interval)?.arma_coefficients()?;
                (
                    arma.phi[..arma.order].to_vec(),
                    arma.theta[..arma.order].to_vec(),
                )
            }
        };
        let sigma = self
            .paper_sigma
            .unwrap_or(self.white_density() / interval.sqrt());
        let mut filter = ShapingFilter::none(interval)?;
        filter.order = phi.len().max(1);
        if filter.order > MAX_ORDER {
            return Err(ShapingError::TooManyStates {
                order: filter.order,
            }
            .into());
        }
        for (i, phi) in phi.iter().enumerate() {
            filter.f[i][0] = *phi;
            if i + 1 < filter.order {
                filter.f[i][i + 1] = 1.0;
            }
        }
        filter.h[0] = 1.0;
        filter.q[0][0] = (1.0 + theta.iter().map(|t| t * t).sum::<f64>()) * sigma * sigma;
        filter.p0[0][0] = self.turn_on * self.turn_on;
        Ok(filter)
    }
}

/// `filter` and independent Gauss-Markov processes beside it.
fn with_processes(
    filter: ShapingFilter,
    processes: &[GaussMarkov],
) -> Result<ShapingFilter, ShapingError> {
    processes.iter().try_fold(filter, |sum, of| {
        sum.plus(&ShapingFilter::gauss_markov(
            of.sigma,
            of.tau_s,
            filter.interval,
        )?)
    })
}

impl Arma {
    pub(crate) fn is_white(&self) -> bool {
        self.ar.iter().chain(&self.ma).all(|c| *c == 0.0)
    }

    fn is_at(&self, interval: f64) -> bool {
        (interval * self.rate_hz - 1.0).abs() < SAME_RATE
    }

    /// The shaping filter at an interval \[s\]; rates closer than 0.1 % are taken as the same.
    fn at(&self, interval: f64) -> Result<ShapingFilter, ShapingError> {
        if self.is_at(interval) {
            return ShapingFilter::arma(&self.ar, &self.ma, self.sigma, interval);
        }
        ShapingFilter::arma(&self.ar, &self.ma, self.sigma, 1.0 / self.rate_hz)?
            .at_interval(interval)
    }

    /// White density [unit·√s] and slow part of an ARMA(1,1) with 1 ≥ φ > θ > 0: driving variance
    /// (1 − φθ)(φ − θ)/φ σ², white variance θ/φ σ².
    pub(crate) fn split(&self) -> Option<(f64, Slow)> {
        let (&[phi], &[theta]) = (&self.ar[..], &self.ma[..]) else {
            return None;
        };
        if !(phi <= 1.0 && phi > theta && theta > 0.0) {
            return None;
        }
        let variance = self.sigma * self.sigma;
        let white = (theta / phi * variance / self.rate_hz).sqrt();
        let driving = (1.0 - phi * theta) * (phi - theta) / phi * variance;
        let slow = if phi == 1.0 {
            Slow {
                walk: Some((driving * self.rate_hz).sqrt()),
                ..Slow::default()
            }
        } else {
            let sigma = (driving / ((1.0 - phi) * (1.0 + phi))).sqrt();
            let tau_s = -1.0 / (self.rate_hz * phi.ln());
            Slow {
                processes: vec![GaussMarkov { sigma, tau_s }],
                ..Slow::default()
            }
        };
        Some((white, slow))
    }

    /// This ARMA with a root of φ at 1 moved to the correlation time [`UNIT_ROOT_TAU`].
    fn with_stationary_root(&self) -> Self {
        let mut stationary = self.clone();
        let sum: f64 = self.ar.iter().sum();
        if (sum - 1.0).abs() < 1e-13 {
            // φ(B) = (1 − B) c(B); then (1 − ρB) c(B).
            let rho = (-1.0 / (self.rate_hz * UNIT_ROOT_TAU)).exp();
            let mut quotient = 1.0;
            for phi in &mut stationary.ar {
                let next = quotient - *phi;
                *phi = rho * quotient - next;
                quotient = next;
            }
        }
        stationary
    }
}

/// Innovations form of a one-state process of variance `q` a step in white noise of variance `r`:
/// φ as it is, `θ = φ r/(p + r)`, `σ² = p + r`, with p the steady prediction variance,
/// `p² + p (r(1 − φ²) − q) − q r = 0`. Nothing is subtracted that could cancel.
fn first_order_innovations(process: &ShapingFilter, r: f64) -> ShapingFilter {
    let (phi, q) = (process.f[0][0], process.q[0][0]);
    let mut form = *process;
    if q == 0.0 {
        form.r = r;
        return form;
    }
    // 1 − φ² = q/Σ for the stationary process, where φ itself has lost the digits.
    let forgetting = if phi == 1.0 {
        0.0
    } else {
        q / process.p0[0][0]
    };
    let b = 0.5 * (r * forgetting - q);
    let root = (b * b + q * r).sqrt();
    let p = if b > 0.0 {
        q * r / (b + root)
    } else {
        root - b
    };
    let gain = phi * p / (p + r);
    form.r = p + r;
    form.s[0] = gain * form.r;
    form.q[0][0] = gain * gain * form.r;
    form.p0[0][0] = if forgetting > 0.0 {
        form.q[0][0] / forgetting
    } else {
        0.0
    };
    form
}

/// AR coefficients and innovation variance of the best linear predictor from autocovariances at
/// lags 0…p.
fn yule_walker(lags: &[f64; AR_ORDER + 1]) -> (Vec<f64>, f64) {
    let mut predictor = Predictor::new(lags[0]);
    // Up to where all is predicted already.
    while predictor.phi.len() < AR_ORDER && predictor.variance > 1e-14 * lags[0] {
        predictor.extend(predictor.reflection(lags));
    }
    predictor.phi.resize(AR_ORDER, 0.0);
    (predictor.phi, predictor.variance.max(0.0))
}
