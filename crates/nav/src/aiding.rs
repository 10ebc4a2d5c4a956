//! Aiding: what each kind of measurement predicts, its innovation and its H, one file a kind.
//!
//! Every innovation is predicted less measured. Signs as derived in `docs/lab/measurement-rows.md`, each
//! matrix tested against a numerical derivative (`tests/it/jacobians.rs`, `tests/it/aiding.rs`).
//!
//! | measurement | row |
//! |---|---|
//! | GNSS position, velocity | [`Filter::observe_position`], [`Filter::observe_velocity`] |
//! | its mean over the time since a fix, by the carrier phase | [`Filter::observe_mean_velocity`] |
//! | the same along a direction, by few satellites | [`Filter::observe_mean_velocity_along`] |
//! | wheel speed; no side slip, no lift | [`Filter::observe_odometer`], [`Filter::observe_non_holonomic`] |
//! | course of a vehicle that drives where it points | [`Filter::observe_course`] |
//! | heading by two antennas | [`Filter::observe_heading`] |
//! | magnetic field | [`Filter::observe_magnetometer`] |
//! | drag of rotors; velocity through the air that wings keep | [`Filter::observe_rotor_drag`], [`Filter::observe_air_velocity`] |
//! | barometric height | [`Filter::observe_barometer`] |
//! | attitude of a marker, by motion capture or a camera | [`Filter::observe_attitude`] |
//! | rest: no velocity, gravity up, the Earth's rate | [`Filter::observe_zero_velocity`], [`Filter::observe_level`], [`Filter::observe_earth_rate`] |
//!
//! Each returns an [`Observation`] for [`Filter::update`], with the covariance of the measurement given there. Rows are stated for
//! `[δr, δv, ψ, sensors' states]`, then what parameters add where they are estimated.
//!
//! A car whose position is not measured any more keeps its speed and course by its wheels:
//!
//! ```
//! use undrift_nav::{Quaternion, Vector3, earth::Geodetic, mechanisation::NavState, sample::ImuSample};
//! use undrift_nav::{filter::{Filter, Gate, InitialStd}, parameters::Parameters, shaping::ShapingFilter};
//! use nalgebra::{Matrix1, Matrix2};
//!
//! // Northwards at 20 m/s, which the filter knows to 2 m/s only.
//! let nav = NavState {
//!     time: 0.0,
//!     position: Geodetic::from_degrees(47.0, 8.0, 400.0),
//!     v_n: Vector3::new(18.0, 0.5, 0.0),
//!     q_nb: Quaternion::identity(),
//! };
//! let std = InitialStd { position: Vector3::repeat(1.0), velocity: Vector3::repeat(2.0), attitude: Vector3::repeat(0.005) };
//! let sensors = [ShapingFilter::white(1e-3, 0.01)?; 6];
//! let mut filter = Filter::<9>::new(nav, &std, sensors, Parameters::none())?;
//! filter.step(&ImuSample::from_rates(0.01, 0.01, [0.0; 3], [0.0, 0.0, -9.8073]))?;
//!
//! let axle = Vector3::new(-1.2, 0.0, 0.4); // From the IMU to the rear axle [m].
//! let wheel = filter.observe_odometer(20.0, &axle);
//! filter.update(&wheel, &Matrix1::new(0.1 * 0.1), &Gate::OPEN)?;
//! let no_slip = filter.observe_non_holonomic(&axle);
//! filter.update(&no_slip, &Matrix2::from_diagonal_element(0.1 * 0.1), &Gate::OPEN)?;
//! assert!((filter.nav().v_n - Vector3::new(20.0, 0.0, 0.0)).norm() < 0.2); // [m/s]
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod air;
mod barometer;
mod course;
mod earth_rate;
mod heading;
mod level;
mod magnetometer;
mod mean_velocity;
mod non_holonomic;
mod odometer;
mod pose;
mod position;
mod velocity;
mod zero_velocity;

use crate::{
    Matrix3, Vector3, attitude,
    earth::wrap_pi,
    filter::Filter,
    parameters::{Coupling, Parameter},
};
use nalgebra::{SMatrix, SVector};

pub use crate::observation::Observation;
pub use mean_velocity::Stretch;

/// Observation of the azimuth of the direction `f` in `n` [rad, from north to east], by its innovation wrapped to (−π, π] and its
/// row on ψ; and the change of the azimuth with `f`. `None` where `f` points within 10° of up or down.
fn azimuth<const N: usize>(
    f: &Vector3,
    measured: f64,
) -> Option<(Observation<1, N>, impl Fn(&Vector3) -> f64)> {
    let f = *f;
    let level = f.x * f.x + f.y * f.y;
    if level < 0.03 {
        return None;
    }
    // d azimuth = (f_N df_E − f_E df_N) / (f_N² + f_E²).
    let change = move |df: &Vector3| (f.x * df.y - f.y * df.x) / level;
    let mut h = SMatrix::<f64, 1, N>::zeros();
    for i in 0..3 {
        h[(0, 6 + i)] = change(&f.cross(&Vector3::ith(i, 1.0)));
    }
    let observed = Observation {
        innovation: SVector::<f64, 1>::new(wrap_pi(libm::atan2(f.y, f.x) - measured)),
        h,
        extra: SMatrix::zeros(),
    };
    Some((observed, change))
}

impl<const N: usize> Filter<N> {
    /// Lever arm IMU → antenna, body axes \[m\]: `nominal` as configured, plus the estimated correction where
    /// [`Parameter::LeverArm`] is estimated. All predictions of a fix use it.
    pub fn lever_arm(&self, nominal: &Vector3) -> Vector3 {
        match self.parameter(Parameter::LeverArm) {
            Some((x, _)) => nominal + Vector3::new(x[0], x[1], x[2]),
            None => *nominal,
        }
    }

    /// The observation of a fix whose error has a time-correlated part, estimated as `kind`: [`Parameter::PositionError`] or
    /// [`Parameter::VelocityError`]. `std` is the standard deviation of that part in the axes of the fix [m or m/s]; the
    /// covariance given to the update is then that of the rest, without it.
    ///
    /// Adds the estimated part to the innovation and the column `−diag(std)` to H; an observation of a filter that does not estimate
    /// `kind` is returned as it is.
    pub fn observe_fix_error(
        &self,
        mut observed: Observation<3, N>,
        kind: Parameter,
        std: &Vector3,
    ) -> Observation<3, N> {
        if let Some(at) = self.parameter_start(kind) {
            for i in 0..3 {
                observed.innovation[i] += std[i] * self.estimates()[at + i];
                observed.h[(i, at + i)] = -std[i];
            }
        }
        observed
    }

    /// Rotation matrix C_b^v from body axes to the vehicle's (forward, right, down of the vehicle): `exp([−m×])` with the estimated
    /// mounting m about pitch and yaw \[rad\], or the identity where [`Parameter::Mounting`] is not estimated.
    pub fn c_bv(&self) -> Matrix3 {
        match self.parameter(Parameter::Mounting) {
            Some((x, _)) => attitude::from_rotation_vector(&-Vector3::new(0.0, x[0], x[1]))
                .to_rotation_matrix()
                .into_inner(),
            None => Matrix3::identity(),
        }
    }

    /// Velocity over ground of the point at `lever_b` [m, body axes, from the IMU] in the vehicle's axes, forward, right, down [m/s]:
    /// `C_b^v (C_n^b v^n + ω_nb^b × l^b)`.
    pub fn vehicle_velocity(&self, lever_b: &Vector3) -> Vector3 {
        let v_b = self.c_nb().tr_mul(&self.nav().v_n) + self.omega_nb_b().cross(lever_b);
        self.c_bv() * v_b
    }

    /// Derivative of [`Filter::vehicle_velocity`] by the error state: rows
    /// `[0, C_b^v C_n^b, −C_b^v C_n^b [v^n×], −C_b^v [l×] H_g, …, −[v^v×]]`, the last for the mounting;
    /// and the covariance of the present sample's white noise in it.
    fn vehicle_velocity_rows(&self, lever_b: &Vector3) -> (SMatrix<f64, 3, N>, Matrix3) {
        let c_bv = self.c_bv();
        let c_nv = c_bv * self.c_nb().transpose();
        let lever = c_bv * attitude::skew(lever_b);
        let mut h = SMatrix::<f64, 3, N>::zeros();
        h.fixed_view_mut::<3, 3>(0, 3).copy_from(&c_nv);
        h.fixed_view_mut::<3, 3>(0, 6)
            .copy_from(&(-c_nv * attitude::skew(&self.nav().v_n)));
        let white = self.rate_columns(&mut h, &-lever);
        if let Some(at) = self.parameter_start(Parameter::Mounting) {
            let v = -attitude::skew(&self.vehicle_velocity(lever_b));
            h.fixed_view_mut::<3, 2>(0, at)
                .copy_from(&v.fixed_columns::<2>(1));
        }
        (h, white)
    }

    /// Puts `column` at `at`, the place of the time offset, and its multiple by the filter's age at the clock's rate, where that is estimated.
    fn time_columns(&self, h: &mut SMatrix<f64, 3, N>, at: usize, column: &Vector3) {
        h.fixed_view_mut::<3, 1>(0, at).copy_from(column);
        if let Some(rate) = self.parameter_start(Parameter::ClockRate) {
            h.fixed_view_mut::<3, 1>(0, rate)
                .copy_from(&(column * self.since_start()));
        }
    }

    /// Adds `factor · ε_g` to the rows of `h`, ε_g the gyros' errors of the present sample; returns the
    /// covariance that their white noise makes there.
    fn rate_columns(&self, h: &mut SMatrix<f64, 3, N>, factor: &Matrix3) -> Matrix3 {
        let mut white = Matrix3::zeros();
        for axis in 0..3 {
            self.error_columns(h, axis, &factor.column(axis).into(), self.coupling());
            white[(axis, axis)] = self.sensors().axis(axis).r;
        }
        factor * white * factor.transpose()
    }

    /// Adds `column` times the error of sensor axis `axis` to `h`.
    fn error_columns<const M: usize>(
        &self,
        h: &mut SMatrix<f64, M, N>,
        axis: usize,
        column: &SVector<f64, M>,
        coupling: &Coupling,
    ) {
        let (filter, at) = (self.sensors().axis(axis), self.sensors().start(axis));
        for i in 0..filter.order {
            for row in 0..M {
                h[(row, at + i)] += column[row] * filter.h[i];
            }
        }
        for (index, factor) in coupling.axis(axis) {
            for row in 0..M {
                h[(row, *index)] += column[row] * factor;
            }
        }
    }
}
