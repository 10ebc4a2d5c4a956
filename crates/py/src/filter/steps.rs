//! A filter of any size behind one set of calls.

use undrift::{
    io::write::solution::SolutionRow,
    nav::{
        Matrix3, Vector3,
        aiding::Observation,
        filter::{self, FilterError, Gate, InitialStd, Update},
        mechanisation::NavState,
        parameters::{Parameter, Parameters},
        sample::{ImuSample, Position},
        shaping::ShapingFilter,
    },
    navigate::solution_row,
    replay::STAMP_ROUNDING,
    size::AnySize,
};

/// A measurement that the filter takes.
pub(super) enum Measured {
    Position(Position, Vector3, Matrix3),
    Velocity(Vector3, Vector3, Matrix3),
    ZeroVelocity(f64),
    EarthRate(Vector3, f64),
    Level(Vector3, f64),
    NonHolonomic(Vector3, f64, f64),
    Odometer(f64, Vector3, f64),
    Barometer(f64, f64),
    Course(f64, f64),
}

/// What an update did, with the innovation, predicted less measured.
pub(super) struct Done {
    pub(super) innovation: Vec<f64>,
    pub(super) update: Update,
}

/// A filter of any size.
pub(super) trait Steps: Send + Sync {
    fn begin(&mut self, sample: &ImuSample);
    fn advance(&mut self, to: Option<f64>);
    /// `None` where the measurement says nothing: a course of a vehicle that points up or down.
    fn update(&mut self, measured: &Measured, gate: &Gate) -> Result<Option<Done>, FilterError>;
    fn check(&self) -> Result<(), FilterError>;
    fn row(&self) -> SolutionRow;
    fn covariance(&self) -> (usize, Vec<f64>);
    fn parameter(&self, kind: Parameter) -> Option<(Vec<f64>, Vec<f64>)>;
}

impl<const N: usize> Steps for filter::Filter<N> {
    fn begin(&mut self, sample: &ImuSample) {
        filter::Filter::begin(self, sample);
    }

    fn advance(&mut self, to: Option<f64>) {
        match to {
            None => filter::Filter::advance(self, 1.0),
            Some(time) => self.advance_to(time, STAMP_ROUNDING),
        }
    }

    fn update(&mut self, measured: &Measured, gate: &Gate) -> Result<Option<Done>, FilterError> {
        let of = |std: f64| nalgebra::Matrix1::new(std * std);
        let three = |std: f64| Matrix3::identity() * (std * std);
        let done = match measured {
            Measured::Position(place, lever, r) => {
                update(self, &self.observe_position(place, lever), r, gate)
            }
            Measured::Velocity(v_n, lever, r) => {
                update(self, &self.observe_velocity(v_n, lever), r, gate)
            }
            Measured::ZeroVelocity(std) => {
                update(self, &self.observe_zero_velocity(), &three(*std), gate)
            }
            Measured::EarthRate(rate, std) => {
                update(self, &self.observe_earth_rate(rate), &three(*std), gate)
            }
            Measured::Level(force, std) => {
                let r = nalgebra::Matrix2::identity() * (std * std);
                update(self, &self.observe_level(force), &r, gate)
            }
            Measured::NonHolonomic(axle, right, down) => {
                let r = nalgebra::Matrix2::new(right * right, 0.0, 0.0, down * down);
                update(self, &self.observe_non_holonomic(axle), &r, gate)
            }
            Measured::Odometer(speed, lever, std) => {
                update(self, &self.observe_odometer(*speed, lever), &of(*std), gate)
            }
            Measured::Barometer(height, std) => {
                update(self, &self.observe_barometer(*height), &of(*std), gate)
            }
            Measured::Course(course, std) => match self.observe_course(*course) {
                Some(observed) => update(self, &observed, &of(*std), gate),
                None => return Ok(None),
            },
        };
        done.map(Some)
    }

    fn check(&self) -> Result<(), FilterError> {
        filter::Filter::check(self)
    }

    fn row(&self) -> SolutionRow {
        let (error, std) = (self.sensor_error(), self.sensor_error_std());
        solution_row(self.nav(), self.nav_std(), error, std)
    }

    fn covariance(&self) -> (usize, Vec<f64>) {
        let n = self.states();
        let p = filter::Filter::covariance(self);
        let row = |i: usize| (0..n).map(move |j| p[(i, j)]);
        (n, (0..n).flat_map(row).collect())
    }

    fn parameter(&self, kind: Parameter) -> Option<(Vec<f64>, Vec<f64>)> {
        let (value, std) = filter::Filter::parameter(self, kind)?;
        let n = kind.width();
        Some((value[..n].to_vec(), std[..n].to_vec()))
    }
}

fn update<const M: usize, const N: usize>(
    filter: &mut filter::Filter<N>,
    observed: &Observation<M, N>,
    r: &nalgebra::SMatrix<f64, M, M>,
    gate: &Gate,
) -> Result<Done, FilterError> {
    Ok(Done {
        innovation: observed.innovation.iter().copied().collect(),
        update: filter.update_recorded(observed, r, gate, None)?,
    })
}

/// Builds a filter of the size that the models need.
pub(super) struct Build {
    pub(super) nav: NavState,
    pub(super) std: InitialStd,
    pub(super) covariances: Option<(Matrix3, Matrix3)>,
    pub(super) sensors: [ShapingFilter; 6],
    pub(super) parameters: Parameters,
}

impl AnySize for Build {
    type Output = Result<Box<dyn Steps>, FilterError>;

    fn with<const N: usize>(self) -> Self::Output {
        let mut filter =
            filter::Filter::<N>::new(self.nav, &self.std, self.sensors, self.parameters)?;
        if let Some((position, velocity)) = &self.covariances {
            filter.set_position_velocity_covariance(position, velocity);
        }
        Ok(Box::new(filter))
    }
}
