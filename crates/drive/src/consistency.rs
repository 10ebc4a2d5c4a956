//! Is a filter as good as it says? Its errors against its covariance.
//!
//! With a truth: the normalised estimation error squared (NEES) `eᵀ P⁻¹ e` of a group of states is
//! chi-squared with as many degrees of freedom as the group has states when the covariance is
//! right; above that the filter is optimistic, below it pessimistic. Without: the innovations,
//! normalised by the root of their covariance, are white with variance one ([`InnovationStatistics`]).
//! Bar-Shalom, Li & Kirubarajan 2001, section 5.4.
//!
//! The average NEES of N independent runs at one instant, times N, is chi-squared with N times the
//! freedom ([`average_bounds`]). Averaged over the time of one run it has the same mean, but its
//! samples are correlated, so those bounds do not hold for it.

mod innovations;

pub use innovations::{InnovationStatistics, LAGS, average_bounds};
pub use undrift_results::error_state::{COMPONENT_NAMES, COMPONENTS, GROUP, GROUPS};

use crate::estimator::{Estimator, mounting_covariance};
use nalgebra::{Const, Dyn, OMatrix};
use serde::Serialize;
use undrift_nav::{
    Matrix3, Vector3,
    covariance::{AXES, NAV},
    parameters::Parameter,
    sample::TruthSample,
};

type Vector = nalgebra::SVector<f64, COMPONENTS>;
type Matrix = nalgebra::SMatrix<f64, COMPONENTS, COMPONENTS>;

/// The error of a filter at one instant and the covariance that the filter gives it.
///
/// Signs as in `docs/conventions.md`: position \[m\], velocity [m/s] and misalignment \[rad\] estimate
/// less truth, north-east-down; biases [rad/s, m/s²] truth less estimate, body axes. A component
/// that is not known (no truth for it, or no state in the filter) counts in no group.
///
/// ```
/// # use undrift_drive as undrift;
/// use undrift::{consistency::{Consistency, ErrorState, GROUP}, engine::{Navigator, settings::Settings}};
/// # use undrift::nav::shaping::ShapingFilter;
/// # use undrift_simulate::{GnssNoise, Trajectory, simulate};
/// # let (gyro, accel) = (ShapingFilter::white(1e-4, 0.02)?, ShapingFilter::white(1e-3, 0.02)?);
/// # let sensors = [gyro, gyro, gyro, accel, accel, accel];
/// # let log = simulate(&Trajectory::car(180.0, 1), 50.0, Some(&sensors), &GnssNoise::default(), 1)?;
/// let mut navigator = Navigator::new(Settings::new(sensors));
/// for fix in &log.gnss {
///     navigator.fix(*fix)?;
/// }
/// let mut consistency = Consistency::default();
/// for (sample, truth) in log.imu.iter().zip(&log.truth) {
///     // The solution is one sample behind what was pushed, as the truth is here.
///     navigator.imu(*sample)?;
///     if let Some(filter) = navigator.filter() {
///         consistency.add(&ErrorState::new(filter, truth, None));
///     }
/// }
/// let position = consistency.nees[0].per_freedom().expect("aligned");
/// assert!((0.1..4.0).contains(&position), "{}: {position}", GROUP[0].0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorState {
    error: Vector,
    covariance: Matrix,
    known: [bool; COMPONENTS],
}

impl ErrorState {
    /// The error of `filter` against the truth at its time, whose attitude is that of the vehicle's axes; `bias` is what can be predicted of the next
    /// sensor errors, gyros [rad/s] and accelerometers [m/s²], where that is known.
    pub fn new(filter: &dyn Estimator, truth: &TruthSample, bias: Option<&[f64; AXES]>) -> Self {
        let (nav, p, sensors) = (filter.nav(), filter.covariance(), filter.sensors());
        let (q_nv, _) = filter.vehicle_attitude();
        let mut error = Vector::zeros();
        let mut known = [false; COMPONENTS];
        let mut note = |at: usize, part: Option<Vector3>| {
            if let Some(part) = part {
                error.fixed_rows_mut::<3>(at).copy_from(&part);
                known[at..at + 3].fill(true);
            }
        };
        note(0, Some(truth.position.offset_to(&nav.position)));
        note(3, truth.v_n.map(|v| nav.v_n - v));
        // The true attitude is the estimate turned by +ψ in the navigation frame.
        note(
            6,
            truth
                .rpy
                .map(|rpy| (undrift_nav::attitude::from_rpy(&rpy) * q_nv.inverse()).scaled_axis()),
        );
        let estimate = filter.sensor_error();
        for axis in 0..AXES {
            if let Some(bias) = bias
                && sensors.axis(axis).order > 0
            {
                error[NAV + axis] = bias[axis] - estimate[axis];
                known[NAV + axis] = true;
            }
        }

        // T P Tᵀ: T keeps the navigation errors, turns the attitude's to the vehicle's and forms H x of each axis.
        let mut terms = Vec::new();
        if let Some(start) = filter.parameters().start(Parameter::Mounting) {
            let (at, c_vn) = (sensors.states() + start, q_nv.to_rotation_matrix());
            for i in 0..3 {
                terms.push((6 + i, at, c_vn[(i, 1)]));
                terms.push((6 + i, at + 1, c_vn[(i, 2)]));
            }
        }
        for axis in 0..AXES {
            let (start, h) = (sensors.start(axis), &sensors.axis(axis).h);
            terms.extend((0..sensors.axis(axis).order).map(|i| (NAV + axis, start + i, h[i])));
        }
        let mut rows = OMatrix::<f64, Const<COMPONENTS>, Dyn>::zeros(p.ncols());
        rows.fixed_rows_mut::<NAV>(0)
            .copy_from(&p.fixed_rows::<NAV>(0));
        for &(to, from, factor) in &terms {
            let mut sum = rows.row_mut(to);
            sum += p.row(from) * factor;
        }
        let mut covariance = Matrix::zeros();
        covariance
            .fixed_columns_mut::<NAV>(0)
            .copy_from(&rows.fixed_columns::<NAV>(0));
        for (to, from, factor) in terms {
            let mut sum = covariance.column_mut(to);
            sum += rows.column(from) * factor;
        }
        let unknown = mounting_covariance(
            &q_nv.to_rotation_matrix().into_inner(),
            &filter.mounting_std(),
        );
        let mut attitude = covariance.fixed_view_mut::<3, 3>(6, 6);
        attitude += unknown;
        Self::from_parts(error, covariance, known)
    }

    /// What is not known is given an error of zero and a variance of one, apart from all else: it
    /// adds nothing to any NEES.
    fn from_parts(
        mut error: Vector,
        mut covariance: Matrix,
        mut known: [bool; COMPONENTS],
    ) -> Self {
        for i in 0..COMPONENTS {
            known[i] &= covariance[(i, i)] > 0.0;
            if !known[i] {
                error[i] = 0.0;
                covariance.row_mut(i).fill(0.0);
                covariance.column_mut(i).fill(0.0);
                covariance[(i, i)] = 1.0;
            }
        }
        Self {
            error,
            covariance,
            known,
        }
    }

    /// NEES of group `group` of [`GROUP`] and its degrees of freedom; `None` where nothing of it is
    /// known or its covariance is not positive definite.
    pub fn nees(&self, group: usize) -> Option<(f64, usize)> {
        let (_, from, count) = GROUP[group];
        let freedom = self.known[from..from + count]
            .iter()
            .filter(|known| **known)
            .count();
        let value = if count == 3 {
            let e: Vector3 = self.error.fixed_rows::<3>(from).into();
            let p: Matrix3 = self.covariance.fixed_view::<3, 3>(from, from).into();
            e.dot(&nalgebra::Cholesky::new(p)?.solve(&e))
        } else {
            let factor = nalgebra::Cholesky::new(self.covariance)?;
            self.error.dot(&factor.solve(&self.error))
        };
        (freedom > 0 && value.is_finite()).then_some((value, freedom))
    }

    /// Error of component `component` in its standard deviations [–]; `None` where it is not known.
    pub fn normalised(&self, component: usize) -> Option<f64> {
        self.known[component]
            .then(|| self.error[component] / self.covariance[(component, component)].sqrt())
    }
}

/// Mean of one group's NEES over the time of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct MeanNees {
    /// Sum of the NEES.
    pub sum: f64,
    /// Sum of their degrees of freedom.
    pub freedom: u64,
    /// Number of instants.
    pub count: u64,
}

impl MeanNees {
    /// Mean NEES per degree of freedom: 1 when the covariance is right, above when it is too small. `None` without instants.
    pub fn per_freedom(&self) -> Option<f64> {
        (self.freedom > 0).then(|| self.sum / self.freedom as f64)
    }
}

/// NEES and coverage over the time of a run, or of many.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Consistency {
    /// Group by group, in the order of [`GROUP`].
    pub nees: [MeanNees; GROUPS],
    /// Number of instants at which the error of each component was within 1, 2 and 3 standard deviations.
    pub within: [[u64; 3]; COMPONENTS],
    /// Number of instants at which each component was known.
    pub instants: [u64; COMPONENTS],
}

impl Consistency {
    /// Counts one instant.
    pub fn add(&mut self, state: &ErrorState) {
        for (group, mean) in self.nees.iter_mut().enumerate() {
            if let Some((value, freedom)) = state.nees(group) {
                mean.sum += value;
                mean.freedom += freedom as u64;
                mean.count += 1;
            }
        }
        for component in 0..COMPONENTS {
            if let Some(z) = state.normalised(component) {
                self.instants[component] += 1;
                for (sigmas, within) in self.within[component].iter_mut().enumerate() {
                    *within += u64::from(z.abs() <= (sigmas + 1) as f64);
                }
            }
        }
    }

    /// Adds the sums of another run.
    pub fn merge(&mut self, other: &Self) {
        for (mean, more) in self.nees.iter_mut().zip(&other.nees) {
            mean.sum += more.sum;
            mean.freedom += more.freedom;
            mean.count += more.count;
        }
        for i in 0..COMPONENTS {
            self.instants[i] += other.instants[i];
            for k in 0..3 {
                self.within[i][k] += other.within[i][k];
            }
        }
    }

    /// Shares of the instants within 1, 2 and 3 standard deviations: 0.683, 0.954 and 0.997 when
    /// the covariance is right and the errors are normal. `None` where the component is not known.
    pub fn coverage(&self, component: usize) -> Option<[f64; 3]> {
        let n = self.instants[component];
        (n > 0).then(|| self.within[component].map(|k| k as f64 / n as f64))
    }
}

#[cfg(test)]
mod tests;
