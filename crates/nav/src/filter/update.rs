//! The Kalman update: a measurement past its gate, taken into the state and its covariance.

use super::{Filter, FilterError};
use crate::{
    Vector3,
    covariance::{AXES, NAV},
    mechanisation::NavState,
    observation::Observation,
    tape::{Tape, turn_rows},
};
use nalgebra::{SMatrix, SVector};

/// What an update did: the statistics of the innovation, and whether the measurement was used. All are computed before the gate, so
/// that a rejected measurement has them, too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Update {
    /// Normalised innovation squared `νᵀ S⁻¹ ν`, of the measurement at its stated covariance;
    /// chi-squared with `dof` degrees of freedom when the model is right. Bar-Shalom, Li &
    /// Kirubarajan section 5.4.
    pub nis: f64,
    /// Number of scalar measurements M, the degrees of freedom of `nis`.
    pub dof: usize,
    /// The first three components of the whitened innovation `L⁻¹ ν`, S = L Lᵀ: the first M are
    /// independent and standard normal when the model is right; the others are zero.
    pub whitened: [f64; 3],
    /// Derivative of the log-likelihood by the logarithm of a common factor on the measurement's
    /// covariance R: `½ (νᵀ S⁻¹ R S⁻¹ ν − tr S⁻¹ R)`. On average zero when R is right.
    pub score: f64,
    /// Variance of the score when the model is right, the information about that factor: `½ tr (S⁻¹ R)²`.
    pub information: f64,
    /// Whether it was used, down-weighted or rejected.
    pub outcome: Outcome,
}

/// What a [`Gate`] decided about a measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// Used with the covariance it came with.
    Used,
    /// Used with its covariance multiplied by this factor.
    Weakened(f64),
    /// Not used; the filter is as if the measurement had not come.
    Rejected,
}

impl Outcome {
    /// Factor on the measurement's covariance: 1 of one used as it was, above 1 of one down-weighted, infinite of one
    /// rejected, which counts as if it had not been made.
    ///
    /// ```
    /// use undrift_nav::filter::Outcome;
    /// assert_eq!(Outcome::Used.factor(), 1.0);
    /// assert_eq!(Outcome::Weakened(4.0).factor(), 4.0); // As with twice the standard deviation.
    /// assert!(Outcome::Rejected.factor().is_infinite());
    /// ```
    pub fn factor(self) -> f64 {
        match self {
            Self::Used => 1.0,
            Self::Weakened(factor) => factor,
            Self::Rejected => f64::INFINITY,
        }
    }

    /// "used", "weakened" or "rejected".
    pub fn name(self) -> &'static str {
        match self {
            Self::Used => "used",
            Self::Weakened(_) => "weakened",
            Self::Rejected => "rejected",
        }
    }
}

/// Limits of the normalised innovation squared. Up to `weaken` a measurement is used as it is;
/// above, its covariance grows in proportion to how far it is above; above `reject` it is not used.
///
/// Limits follow from the chi-squared distribution of M degrees of freedom: of 3, one right measurement in a thousand has a NIS above 16.3.
/// After an outage the solution is what is uncertain, and a limit that rejects one right fix in a thousand rejects too many.
///
/// ```
/// use undrift_nav::filter::Gate;
/// // Down-weights beyond 99.9 % of what a fix of three numbers does, and rejects what is beyond doubt.
/// let gate = Gate { weaken: 16.3, reject: 100.0 };
/// assert!(gate.weaken < gate.reject && Gate::OPEN.reject == f64::INFINITY);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gate {
    /// NIS above which the covariance is enlarged, to NIS/limit times itself (Huber's weights; Zhang 1997).
    pub weaken: f64,
    /// NIS above which the measurement is rejected.
    pub reject: f64,
}

impl Gate {
    /// Uses every measurement at its own covariance.
    pub const OPEN: Self = Self {
        weaken: f64::INFINITY,
        reject: f64::INFINITY,
    };
}

impl<const N: usize> Filter<N> {
    /// Kalman update with a measurement of covariance `r`: innovation ν = predicted less measured,
    /// `ν = h·error + noise`, past a gate ([`Gate::OPEN`]: every one is used). Joseph's form, in two rank-M passes; Groves
    /// section 3.2.2.
    ///
    /// The estimated error is removed from navigation state, sensors' states and parameters at once (closed loop). May be called
    /// between samples or, after [`Filter::begin`] and [`Filter::advance`], inside one.
    ///
    /// # Errors
    /// A covariance of the innovation that is not positive, or a correction after which there is no solution; the
    /// filter is then as it was.
    ///
    /// ```
    /// use undrift_nav::{Matrix3, filter::{Gate, Outcome}, sample::Position};
    /// # use undrift_nav::{Quaternion, Vector3, earth::Geodetic, mechanisation::NavState};
    /// # use undrift_nav::{filter::{Filter, InitialStd}, parameters::Parameters, shaping::ShapingFilter};
    /// # let place = Geodetic::from_degrees(47.0, 8.0, 400.0);
    /// # let nav = NavState { time: 0.0, position: place, v_n: Vector3::new(20.0, 0.0, 0.0), q_nb: Quaternion::identity() };
    /// # let std = InitialStd { position: Vector3::repeat(1.0), velocity: Vector3::repeat(0.1), attitude: Vector3::repeat(0.01) };
    /// # let mut filter = Filter::<9>::new(nav, &std, [ShapingFilter::white(1e-3, 0.01)?; 6], Parameters::none())?;
    /// let place = filter.nav().position;
    /// let far = Position::Geodetic(place.displaced(&Vector3::new(100.0, 0.0, 0.0)));
    /// let fix = filter.observe_position(&far, &Vector3::zeros());
    /// // 100 m off where 1 m of the filter and 1 m of the fix are expected: ν²/S = 10 000/2.
    /// let before = *filter.nav();
    /// let update = filter.update(&fix, &Matrix3::identity(), &Gate { weaken: 16.3, reject: 100.0 })?;
    /// assert!((update.nis - 5000.0).abs() < 0.1 && update.outcome == Outcome::Rejected && *filter.nav() == before);
    /// // Let in at equal weights it takes the filter half of the way.
    /// filter.update(&fix, &Matrix3::identity(), &Gate::OPEN)?;
    /// assert!((place.offset_to(&filter.nav().position).x - 50.0).abs() < 0.01);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn update<const M: usize>(
        &mut self,
        observed: &Observation<M, N>,
        r: &SMatrix<f64, M, M>,
        gate: &Gate,
    ) -> Result<Update, FilterError> {
        self.update_with(observed, r, gate, None)
    }

    /// Does [`Filter::update`] and records it on `tape` for a smoother; a rejected measurement records nothing.
    ///
    /// # Errors
    /// As [`Filter::update`].
    pub fn update_recorded<const M: usize>(
        &mut self,
        observed: &Observation<M, N>,
        r: &SMatrix<f64, M, M>,
        gate: &Gate,
        tape: &mut Tape<N>,
    ) -> Result<Update, FilterError> {
        self.update_with(observed, r, gate, Some(tape))
    }

    fn update_with<const M: usize>(
        &mut self,
        observed: &Observation<M, N>,
        r: &SMatrix<f64, M, M>,
        gate: &Gate,
        tape: Option<&mut Tape<N>>,
    ) -> Result<Update, FilterError> {
        let (h, z) = (&observed.h, &observed.innovation);
        let stated = r;
        let mut r = r + observed.extra;
        let pht = self.p * h.transpose();
        let mut s = h * pht + r;
        let mut factor = nalgebra::Cholesky::new(s).ok_or(FilterError::BadMeasurement)?;
        let white = factor
            .l_dirty()
            .solve_lower_triangular(z)
            .ok_or(FilterError::BadMeasurement)?;
        let nis = white.norm_squared();
        if !nis.is_finite() {
            return Err(FilterError::BadMeasurement);
        }
        let mut whitened = [0.0; 3];
        for (slot, value) in whitened.iter_mut().zip(white.iter()) {
            *slot = *value;
        }
        let inverse = factor.inverse();
        let (weighted, share) = (inverse * z, inverse * stated);
        let mut update = Update {
            nis,
            dof: M,
            whitened,
            score: 0.5 * ((stated * weighted).dot(&weighted) - share.trace()),
            information: 0.5 * (share * share).trace(),
            outcome: Outcome::Used,
        };
        if nis > gate.reject {
            update.outcome = Outcome::Rejected;
            return Ok(update);
        }
        if nis > gate.weaken {
            let factor_of_r = nis / gate.weaken;
            update.outcome = Outcome::Weakened(factor_of_r);
            r *= factor_of_r;
            s = h * pht + r;
            factor = nalgebra::Cholesky::new(s).ok_or(FilterError::BadMeasurement)?;
        }
        let gain = factor.solve(&pht.transpose()).transpose();
        let error = gain * z;
        let corrected = self.without_error(&error);
        if !(corrected.is_valid() && error.iter().all(|number| number.is_finite())) {
            return Err(FilterError::Implausible);
        }

        // (I − K H) P (I − K H)ᵀ + K R Kᵀ
        let mut p = self.p - gain * pht.transpose();
        p -= (p * h.transpose()) * gain.transpose();
        p += gain * r * gain.transpose();
        for i in 0..N {
            for j in 0..i {
                let mean = 0.5 * (p[(i, j)] + p[(j, i)]);
                p[(i, j)] = mean;
                p[(j, i)] = mean;
            }
        }
        self.p = p;
        if let Some(tape) = tape {
            let turn = Vector3::new(error[6], error[7], error[8]);
            tape.update(h, &factor.inverse(), &factor.solve(z), &gain, &turn);
        }
        self.correct(corrected, &error);
        Ok(update)
    }

    fn without_error(&self, error: &SVector<f64, N>) -> NavState {
        let part = |at: usize| Vector3::new(error[at], error[at + 1], error[at + 2]);
        self.nav.without_error(&part(0), &part(3), &part(6))
    }

    /// Removes an estimated `error`, in the order of the error state and estimate less truth for its first nine, from the navigation
    /// state, and adds the rest to the sensors' states and the parameters. The covariance keeps its size and is turned to the corrected
    /// attitude. For an error that was found outside of the filter, as a smoother's.
    pub fn apply_correction(&mut self, error: &SVector<f64, N>) {
        self.correct(self.without_error(error), error);
    }

    fn correct(&mut self, nav: NavState, error: &SVector<f64, N>) {
        self.nav = nav;
        self.reset_attitude(&Vector3::new(error[6], error[7], error[8]));
        self.c_nb = self.nav.q_nb.to_rotation_matrix().into_inner();
        let before = self.sensors.predicted_error(&self.x, &self.coupling);
        for i in NAV..N {
            self.x[i] += error[i];
        }
        // The rate, and what is left of the present sample, follow the new estimate.
        let after = self.sensors.predicted_error(&self.x, &self.coupling);
        let change: [f64; AXES] = core::array::from_fn(|i| after[i] - before[i]);
        let gyro = Vector3::new(change[0], change[1], change[2]);
        let accel = Vector3::new(change[3], change[4], change[5]);
        self.omega_ib_b -= gyro;
        self.force_b -= accel;
        if let Some((increments, _)) = &mut self.current {
            increments.rotation -= gyro * increments.dt;
            increments.dvel -= accel * increments.dt;
        }
    }

    /// Moves the misalignment's covariance to the corrected attitude. It matters while the heading is
    /// far less certain than the level.
    fn reset_attitude(&mut self, delta: &Vector3) {
        turn_rows(&mut self.p, delta);
        self.p.transpose_mut();
        turn_rows(&mut self.p, delta);
        for (i, j) in [(6, 7), (6, 8), (7, 8)] {
            self.p[(i, j)] = self.p[(j, i)];
        }
    }
}
