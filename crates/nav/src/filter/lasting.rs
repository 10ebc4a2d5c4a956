//! Time-correlated errors of the fixes, estimated from some time on: they are behind all other states, which keep their places.
//!
//! How often fixes err alike is known only after some minutes of a drive, so these states come and go while a filter runs, and
//! with them its size: [`Filter::carried`] and [`Filter::with_lasting`] move a filter to another one.

use super::{Filter, FilterError};
use crate::{
    Matrix3, Vector3,
    covariance::Sensors,
    mechanisation::{Increments, NavState, RawIncrements},
    parameters::{Coupling, Parameter, Parameters, Prior},
};
use nalgebra::SMatrix;

/// The time-correlated part of the errors of a fix's position or velocity: a state for each of north, east, down, in units of the
/// part's standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lasting {
    /// Prior of the state in units of its standard deviation [–]: usually `std` 1 and the correlation time of the errors \[s\].
    pub prior: Prior,
    /// Ratio of the part's standard deviations, north, east, down, to those that it was estimated with before [–]; not used for a
    /// part that was not estimated before.
    pub grown: Vector3,
    /// Standard deviation of that part in the solution's own error, north, east, down [m or m/s]: what its fixes were
    /// wrong by, the solution is too. Used only for a part that was not estimated before.
    pub shared: Vector3,
}

/// Everything of a filter that does not depend on its size `N`: navigation state, models, the sample in progress. Its estimates and
/// covariance are passed along with it, see [`Filter::with_lasting`].
#[derive(Clone, Debug)]
pub struct Carried {
    nav: NavState,
    sensors: Sensors,
    parameters: Parameters,
    c_nb: Matrix3,
    previous: Option<RawIncrements>,
    current: Option<(Increments, f64)>,
    end: f64,
    omega_ib_b: Vector3,
    force_b: Vector3,
    slow_force: Vector3,
    slow: [Vector3; 2],
    coupling: Coupling,
    start: f64,
    turns: bool,
}

const KINDS: [Parameter; 2] = [Parameter::PositionError, Parameter::VelocityError];

impl Carried {
    /// The parameters of the filter that [`Filter::with_lasting`] makes: those of this one, with position and velocity errors
    /// (in this order) as `lasting` has them; `None` ends their estimation.
    pub fn parameters(&self, lasting: &[Option<Lasting>; 2]) -> Parameters {
        let both = KINDS.into_iter().zip(lasting);
        both.fold(
            self.parameters,
            |parameters, (kind, lasting)| match lasting {
                Some(lasting) => parameters.with(kind, lasting.prior),
                None => parameters.without(kind),
            },
        )
    }
}

impl<const N: usize> Filter<N> {
    /// A copy of everything but estimates and covariance, to go on in a filter of another size.
    pub fn carried(&self) -> Carried {
        Carried {
            nav: self.nav,
            sensors: self.sensors,
            parameters: self.parameters,
            c_nb: self.c_nb,
            previous: self.previous,
            current: self.current,
            end: self.end,
            omega_ib_b: self.omega_ib_b,
            force_b: self.force_b,
            slow_force: self.slow_force,
            slow: self.slow,
            coupling: self.coupling,
            start: self.start,
            turns: self.turns,
        }
    }

    /// A filter that goes on from another one, with its estimates `x` and covariance `p(row, column)`, and from now on estimates
    /// [`Parameter::PositionError`] and [`Parameter::VelocityError`] as given, or not. What of them was estimated before
    /// keeps its value in metres.
    ///
    /// # Errors
    /// [`FilterError::TooManyStates`] where `N` does not hold the states.
    ///
    /// ```
    /// # use undrift_nav::{Quaternion, Vector3, earth::Geodetic, mechanisation::NavState};
    /// # use undrift_nav::{filter::{Filter, InitialStd}, shaping::ShapingFilter};
    /// use undrift_nav::{filter::Lasting, parameters::{Parameter, Parameters, Prior}};
    /// # let place = Geodetic::from_degrees(47.0, 8.0, 400.0);
    /// # let nav = NavState { time: 0.0, position: place, v_n: Vector3::zeros(), q_nb: Quaternion::identity() };
    /// # let std = InitialStd { position: Vector3::repeat(1.0), velocity: Vector3::repeat(0.1), attitude: Vector3::repeat(0.01) };
    /// # let filter = Filter::<9>::new(nav, &std, [ShapingFilter::white(1e-3, 0.01)?; 6], Parameters::none())?;
    /// // The positions have turned out to err alike for a minute, by 1.5 m, which the solution has followed.
    /// let positions = Lasting {
    ///     prior: Prior { std: 1.0, time: 60.0, ..Prior::default() },
    ///     grown: Vector3::repeat(1.0),
    ///     shared: Vector3::repeat(1.5),
    /// };
    /// let (x, p) = (*filter.estimates(), *filter.covariance());
    /// let filter = Filter::<12>::with_lasting(filter.carried(), &x, &|i, j| p[(i, j)], &[Some(positions), None])?;
    /// assert_eq!(filter.parameter_start(Parameter::PositionError), Some(9));
    /// assert!((filter.nav_std()[0] - (1.0_f64 + 1.5 * 1.5).sqrt()).abs() < 1e-12); // [m]
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_lasting(
        carried: Carried,
        x: &[f64],
        p: &dyn Fn(usize, usize) -> f64,
        lasting: &[Option<Lasting>; 2],
    ) -> Result<Self, FilterError> {
        let parameters = carried.parameters(lasting);
        let behind = carried.sensors.states();
        let needed = behind + parameters.states();
        if needed > N {
            return Err(FilterError::TooManyStates {
                needed,
                capacity: N,
            });
        }
        // Where each state was before, and its unit then in that of now.
        let mut before: [Option<(usize, f64)>; N] =
            core::array::from_fn(|i| (i < needed).then_some((i, 1.0)));
        let mut filter = Self {
            nav: carried.nav,
            sensors: carried.sensors,
            parameters,
            x: [0.0; N],
            p: SMatrix::zeros(),
            c_nb: carried.c_nb,
            previous: carried.previous,
            current: carried.current,
            end: carried.end,
            omega_ib_b: carried.omega_ib_b,
            force_b: carried.force_b,
            slow_force: carried.slow_force,
            slow: carried.slow,
            coupling: carried.coupling,
            start: carried.start,
            turns: carried.turns,
        };
        for (k, (kind, lasting)) in KINDS.into_iter().zip(lasting).enumerate() {
            let (Some(at), Some(lasting)) = (filter.parameter_start(kind), lasting) else {
                continue;
            };
            let was = carried.parameters.start(kind).map(|was| behind + was);
            for i in 0..kind.width() {
                before[at + i] = was.map(|was| (was + i, 1.0 / lasting.grown[i]));
                if was.is_none() {
                    let variance = lasting.prior.std * lasting.prior.std;
                    let (own, across) = (3 * k + i, lasting.shared[i] * variance);
                    filter.p[(at + i, at + i)] = variance;
                    filter.p[(own, own)] = lasting.shared[i] * across;
                    filter.p[(own, at + i)] = across;
                    filter.p[(at + i, own)] = across;
                }
            }
        }
        for i in 0..needed {
            let Some((a, unit)) = before[i] else { continue };
            filter.x[i] = x[a] * unit;
            for j in 0..needed {
                if let Some((b, other)) = before[j] {
                    filter.p[(i, j)] += p(a, b) * unit * other;
                }
            }
        }
        Ok(filter)
    }
}
