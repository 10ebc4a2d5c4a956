//! What a smoother needs of a span of filtering: the adjoint of everything that happened in it.
//!
//! Let e be the error after the filter's last correction at the start of the span. Steps and updates
//! inside the span carry it to `T e` plus noise at the end, and the innovations inside contribute
//!
//! ```text
//! λ_start = a + Tᵀ λ_end,    Λ_start = A + Tᵀ Λ_end T
//! a = Σ (H T_k)ᵀ S⁻¹ ν,      A = Σ (H T_k)ᵀ S⁻¹ (H T_k)
//! ```
//!
//! with `T_k` the product up to update k, so that the expected error given all later measurements is
//! `P λ` and its covariance `P − P Λ P`, P the filter's covariance at the start. This is the modified
//! Bryson-Frazier smoother (Bierman 1977, section X; Rauch, Tung & Striebel 1965 give the same
//! numbers), which inverts nothing but the innovations' covariances: states without noise and
//! singular covariances are no trouble.

use crate::{
    Vector3,
    covariance::{Part, Sensors, Transition},
    parameters::Coupling,
};
use core::ops::Range;
use nalgebra::{SMatrix, SVector};

/// The adjoint of one span, accumulated as the filter runs through it: [`Filter::advance_recorded`](crate::filter::Filter::advance_recorded)
/// and [`Filter::update_recorded`](crate::filter::Filter::update_recorded) add to it.
///
/// ```
/// use undrift_nav::{Matrix3, Quaternion, Vector3, earth::Geodetic, mechanisation::NavState, tape::Tape};
/// use undrift_nav::{filter::{Filter, Gate, InitialStd}, parameters::Parameters};
/// use undrift_nav::{sample::{ImuSample, Position}, shaping::ShapingFilter};
/// use nalgebra::{SMatrix, SVector};
///
/// let here = Geodetic::from_degrees(47.0, 8.0, 400.0);
/// # let nav = NavState { time: 0.0, position: here, v_n: Vector3::zeros(), q_nb: Quaternion::identity() };
/// # let std = InitialStd { position: Vector3::repeat(5.0), velocity: Vector3::repeat(0.1), attitude: Vector3::repeat(0.01) };
/// let sensors = [ShapingFilter::white(1e-3, 0.01)?; 6];
/// let mut filter = Filter::<9>::new(nav, &std, sensors, Parameters::none())?;
/// let (start, p) = (*filter.nav(), *filter.covariance());
///
/// // A span: one second, then a fix that is 3 m north of the prediction.
/// let mut tape = Tape::default();
/// for k in 1..=100 {
///     filter.begin(&ImuSample::from_rates(0.01 * f64::from(k), 0.01, [0.0; 3], [0.0, 0.0, -9.8073]));
///     filter.advance_recorded(1.0, &mut tape);
/// }
/// let fix = Position::Geodetic(here.displaced(&Vector3::new(3.0, 0.0, 0.0)));
/// let row = filter.observe_position(&fix, &Vector3::zeros());
/// filter.update_recorded(&row, &Matrix3::identity(), &Gate::OPEN, &mut tape)?;
///
/// // The start of the span with the fix in it: expected error P λ, covariance P − P Λ P.
/// let (mut lambda, mut information) = (SVector::zeros(), SMatrix::zeros());
/// tape.back(&mut lambda, &mut information);
/// let error: SVector<f64, 9> = p * lambda;
/// let smoothed = start.without_error(
///     &error.fixed_rows::<3>(0).into(), &error.fixed_rows::<3>(3).into(), &error.fixed_rows::<3>(6).into(),
/// );
/// assert!((start.position.offset_to(&smoothed.position).x - 2.9).abs() < 0.1); // 5 m against 1 m of doubt.
/// assert!((p - p * information * p)[(0, 0)] < 1.1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Tape<const N: usize> {
    /// T, by rows.
    t: [[f64; N]; N],
    /// a, the part of λ that the span's measurements bring, N entries in the inverse units of the error state (1/m, s/m, 1/rad …).
    pub gradient: SVector<f64, N>,
    /// A, the part of Λ that the span's measurements bring, N × N, symmetric: the information about the error at the start of the span.
    pub information: SMatrix<f64, N, N>,
}

impl<const N: usize> Default for Tape<N> {
    fn default() -> Self {
        let mut t = [[0.0; N]; N];
        for (i, row) in t.iter_mut().enumerate() {
            row[i] = 1.0;
        }
        Self {
            t,
            gradient: SVector::zeros(),
            information: SMatrix::zeros(),
        }
    }
}

impl<const N: usize> Tape<N> {
    /// T, N × N: takes an error at the start of the span to what remains of it at the end, after the updates in between.
    pub fn transition(&self) -> SMatrix<f64, N, N> {
        SMatrix::from_fn(|i, j| self.t[i][j])
    }

    /// The tape of a span that begins with a correction of the attitude by `turn` \[rad\], as an update ends with one: T is then the
    /// Jacobian of that reset.
    pub fn after(turn: &Vector3) -> Self {
        let mut tape = Self::default();
        let mut t = tape.transition();
        turn_rows(&mut t, turn);
        for i in 0..N {
            for j in 0..N {
                tape.t[i][j] = t[(i, j)];
            }
        }
        tape
    }

    /// Carries `λ` and `Λ` (`information`) from the end of the span to its start; zeros are those of the end of a drive, where no measurement
    /// follows. For tests and single spans; a smoother of whole drives does the same with matrices read from its store.
    pub fn back(&self, lambda: &mut SVector<f64, N>, information: &mut SMatrix<f64, N, N>) {
        let t = self.transition();
        *lambda = self.gradient + t.tr_mul(lambda);
        let carried = t.tr_mul(&(*information * t));
        *information = self.information + (carried + carried.transpose()) * 0.5;
    }

    /// A step of the filter: T ← Φ T.
    pub(crate) fn step(
        &mut self,
        sensors: &Sensors,
        transition: &Transition,
        coupling: &Coupling,
        part: Part,
    ) {
        sensors.carry(&mut self.t, transition, coupling, part);
    }

    /// Scales the rows of Gauss-Markov parameters by their transition over a step, exp(−Δt/τ).
    pub(crate) fn decay(&mut self, states: Range<usize>, factor: f64) {
        if factor != 1.0 {
            let rows = self.t[states].iter_mut().flatten();
            rows.for_each(|value| *value *= factor);
        }
    }

    /// An update: its H, S⁻¹, S⁻¹ν, gain, and the attitude correction that followed it.
    pub(crate) fn update<const M: usize>(
        &mut self,
        h: &SMatrix<f64, M, N>,
        s_inverse: &SMatrix<f64, M, M>,
        weighted: &SVector<f64, M>,
        gain: &SMatrix<f64, N, M>,
        turn: &Vector3,
    ) {
        let t = self.transition();
        let seen = h * t;
        self.gradient += seen.tr_mul(weighted);
        self.information += seen.tr_mul(&(s_inverse * seen));
        let mut t = t - gain * seen;
        turn_rows(&mut t, turn);
        for i in 0..N {
            for j in 0..N {
                self.t[i][j] = t[(i, j)];
            }
        }
    }
}

/// The reset of the attitude after a correction by δ \[rad\], `ψ ← ψ + ½ δ × ψ`, on the misalignment's rows 6 to 8 of a covariance or of T.
/// Markley & Crassidis 2014, section 6.2.
pub(crate) fn turn_rows<const N: usize>(m: &mut SMatrix<f64, N, N>, delta: &Vector3) {
    for j in 0..N {
        let psi = Vector3::new(m[(6, j)], m[(7, j)], m[(8, j)]);
        let turned = psi + delta.cross(&psi) * 0.5;
        for i in 0..3 {
            m[(6 + i, j)] = turned[i];
        }
    }
}
