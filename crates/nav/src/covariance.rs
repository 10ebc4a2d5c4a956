//! Covariance of the error state over one step, exploiting its structure.
//!
//! The error state is `[δr; δv; ψ; x; p]`: nine navigation errors, the shaping filters' states and
//! the parameters. Over one step, with ε the six sensor errors `H x + U p + D w`,
//!
//! ```text
//! n' = Φ n + Γ ε,    x' = F x + G w,    p' = p,    ε = H x + U p + D w
//! ```
//!
//! so the navigation block needs only the covariance of `(n, ε)`, fifteen wide whatever the order
//! of the models, and the cross block is the same linear map applied to the states' columns. The
//! same `w` drives ε and x, hence the cross terms `Γ D Gᵀ`. Φ and Γ are never formed: [`Transition::carry`]
//! applies them to rows.
//!
//! Error model: Groves 2013, section 14.2.4, with the signs of `docs/conventions.md`.

mod rows;

pub use rows::four_lanes;

use crate::{
    Matrix3, Vector3,
    attitude::skew,
    mechanisation::Step,
    parameters::Coupling,
    shaping::{MAX_ORDER, ShapingFilter},
};
use core::{array::from_fn, ops::Range};
use rows::{add_row, set_row, step_rows_of};

pub use crate::sample::AXES;

/// Number of navigation errors, the first states of every filter: position, velocity, misalignment, each north, east, down.
pub const NAV: usize = 9;
/// Columns that [`NAV`] are carried as, four at a time.
const EVEN: usize = NAV + 3;

/// The linear map of one step from navigation and sensor errors to navigation errors, `n' = Φ n + Γ ε`: Φ and Γ of the module's
/// text, kept as the physical quantities they are made of.
#[derive(Clone, Copy, Debug)]
pub struct Transition {
    half_dt: f64,
    /// C_b^n dt at the middle of the step \[s\].
    c_dt: Matrix3,
    /// Specific force integrated over the step, navigation frame [m/s].
    dvel_n: Vector3,
    /// Rotation of the navigation frame over the step \[rad\].
    frame_turn: Vector3,
    /// dt times the partial derivatives of the error model.
    rr: Matrix3,
    vr: Matrix3,
    vv: Matrix3,
    pr: Matrix3,
    pv: Matrix3,
}

impl Transition {
    /// The map of the mechanisation step `step`, with the rotation matrix C_b^n at its middle, `c_mid`.
    #[inline]
    pub fn new(step: &Step, c_mid: &Matrix3) -> Self {
        let Step {
            dt,
            earth,
            v_mid: v,
            dvel_n,
            earth_rate,
            transport_rate,
        } = step;
        let tan = earth.sin_lat / earth.cos_lat;
        let (rm, rn) = (earth.rm_h, earth.rn_h);
        // ∂ω_ie/∂δr and ∂ω_en/∂δr: latitude moves with δr_N / rm, height with −δr_D.
        let ie_r = Matrix3::new(
            earth_rate.z / rm,
            0.0,
            0.0,
            0.0,
            0.0,
            0.0,
            -earth_rate.x / rm,
            0.0,
            0.0,
        );
        let sec2 = 1.0 / (earth.cos_lat * earth.cos_lat);
        let en_r = Matrix3::new(
            0.0,
            0.0,
            v.y / (rn * rn),
            0.0,
            0.0,
            -v.x / (rm * rm),
            -v.y * sec2 / (rn * rm),
            0.0,
            -v.y * tan / (rn * rn),
        );
        let en_v = Matrix3::new(0.0, 1.0 / rn, 0.0, -1.0 / rm, 0.0, 0.0, 0.0, -tan / rn, 0.0);
        let v_skew = skew(v);
        let mut vr = v_skew * (ie_r * 2.0 + en_r);
        vr[(2, 2)] += 2.0 * earth.gravity / libm::sqrt(rm * rn);
        let rr = Matrix3::new(
            -v.z / rm,
            0.0,
            v.x / rm,
            v.y * tan / rm,
            -v.z / rn - v.x * tan / rm,
            v.y / rn,
            0.0,
            0.0,
            0.0,
        );
        Self {
            half_dt: 0.5 * dt,
            c_dt: c_mid * *dt,
            dvel_n: *dvel_n,
            frame_turn: (earth_rate + transport_rate) * *dt,
            rr: rr * *dt,
            vr: vr * *dt,
            vv: (v_skew * en_v - skew(&(earth_rate * 2.0 + transport_rate))) * *dt,
            pr: (ie_r + en_r) * *dt,
            pv: en_v * *dt,
        }
    }

    /// The columns of Γ, one per sensor axis: what a unit error of it does to `[δr; δv; ψ]`.
    fn input(&self) -> [[f64; EVEN]; AXES] {
        let mut gamma = [[0.0; EVEN]; AXES];
        for axis in 0..3 {
            let c: Vector3 = self.c_dt.column(axis).into();
            // A gyro error turns by −c dt, by half of that while the specific force acts.
            let v = self.dvel_n.cross(&c) * -0.5;
            for i in 0..3 {
                gamma[axis][i] = self.half_dt * v[i];
                gamma[axis][3 + i] = v[i];
                gamma[axis][6 + i] = -c[i];
                gamma[3 + axis][i] = self.half_dt * c[i];
                gamma[3 + axis][3 + i] = c[i];
            }
        }
        gamma
    }

    /// `[Φ Γ]` times the rows `nav`, `[δr; δv; ψ]`, and `errors`, `[ε_gyro; ε_accel]`: `nav` becomes `[δr'; δv'; ψ']`.
    ///
    /// Misalignment first, velocity from the mean of old and new misalignment, position from the
    /// mean of old and new velocity: second order in the step.
    #[inline(always)]
    pub fn carry<const W: usize>(&self, nav: &mut [[f64; W]; NAV], errors: &[[f64; W]; AXES]) {
        let (rr, vr, vv, pr, pv, c) =
            (&self.rr, &self.vr, &self.vv, &self.pr, &self.pv, &self.c_dt);
        let (z, f) = (&self.frame_turn, &self.dvel_n);
        let h = self.half_dt;
        for k in 0..W {
            let r = [nav[0][k], nav[1][k], nav[2][k]];
            let v = [nav[3][k], nav[4][k], nav[5][k]];
            let p = [nav[6][k], nav[7][k], nav[8][k]];
            let g = [errors[0][k], errors[1][k], errors[2][k]];
            let a = [errors[3][k], errors[4][k], errors[5][k]];

            // ∂ω/∂δr has no east column, ∂ω_en/∂δv no down column.
            let turn = |i: usize| {
                pr[(i, 0)] * r[0] + pr[(i, 2)] * r[2] + pv[(i, 0)] * v[0] + pv[(i, 1)] * v[1]
                    - (c[(i, 0)] * g[0] + c[(i, 1)] * g[1] + c[(i, 2)] * g[2])
            };
            let p_new = [
                p[0] + turn(0) - (z.y * p[2] - z.z * p[1]),
                p[1] + turn(1) - (z.z * p[0] - z.x * p[2]),
                p[2] + turn(2) - (z.x * p[1] - z.y * p[0]),
            ];
            let m = [
                0.5 * (p[0] + p_new[0]),
                0.5 * (p[1] + p_new[1]),
                0.5 * (p[2] + p_new[2]),
            ];
            let push = |i: usize| {
                vr[(i, 0)] * r[0]
                    + vr[(i, 2)] * r[2]
                    + (vv[(i, 0)] * v[0] + vv[(i, 1)] * v[1] + vv[(i, 2)] * v[2])
                    + (c[(i, 0)] * a[0] + c[(i, 1)] * a[1] + c[(i, 2)] * a[2])
            };
            let v_new = [
                v[0] + push(0) + (f.y * m[2] - f.z * m[1]),
                v[1] + push(1) + (f.z * m[0] - f.x * m[2]),
                v[2] + push(2) + (f.x * m[1] - f.y * m[0]),
            ];
            nav[0][k] = r[0] + rr[(0, 0)] * r[0] + rr[(0, 2)] * r[2] + h * (v[0] + v_new[0]);
            nav[1][k] = r[1]
                + rr[(1, 0)] * r[0]
                + rr[(1, 1)] * r[1]
                + rr[(1, 2)] * r[2]
                + h * (v[1] + v_new[1]);
            nav[2][k] = r[2] + h * (v[2] + v_new[2]);
            for i in 0..3 {
                nav[3 + i][k] = v_new[i];
                nav[6 + i][k] = p_new[i];
            }
        }
    }
}

/// Part of a sample interval that a step covers, since the shaping filters step once a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The interval does not end here: the sensors' states hold, white noise enters with the time.
    Inner,
    /// The interval ends here: the sensors' states make their step.
    Last,
}

/// The six shaping filters and where their states lie behind the nine navigation errors: those of gyro x first, each axis as many as
/// its order.
///
/// ```
/// use undrift_nav::{covariance::Sensors, shaping::ShapingFilter};
/// let gyro = ShapingFilter::white(1e-4, 0.01)?; // No state.
/// let accel = ShapingFilter::gauss_markov(1e-3, 300.0, 0.01)?; // One.
/// let sensors = Sensors::new([gyro, gyro, gyro, accel, accel, accel]);
/// assert_eq!((sensors.states(), sensors.start(4)), (12, 10));
/// # Ok::<(), undrift_nav::shaping::ShapingError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Sensors {
    axes: [ShapingFilter; AXES],
    start: [usize; AXES + 1],
}

impl Sensors {
    /// The six models in the order gyro x, y, z [rad/s], accelerometer x, y, z [m/s²]; all are to have the interval of the samples.
    pub fn new(axes: [ShapingFilter; AXES]) -> Self {
        let mut start = [NAV; AXES + 1];
        for i in 0..AXES {
            start[i + 1] = start[i] + axes[i].order;
        }
        Self { axes, start }
    }

    /// Number of navigation errors and sensor states together: the place of the first parameter in the error state.
    #[inline]
    pub fn states(&self) -> usize {
        self.start[AXES]
    }

    /// Shaping filter of sensor axis `axis`, 0 to 5.
    #[inline]
    pub fn axis(&self, axis: usize) -> &ShapingFilter {
        &self.axes[axis]
    }

    /// Sets the variance `r` of the white noise of a sample of each axis, [(rad/s)²] of the gyros, [(m/s²)²] of the accelerometers.
    pub fn set_white_noise(&mut self, variance: &[f64; AXES]) {
        for (axis, variance) in self.axes.iter_mut().zip(variance) {
            axis.r = *variance;
        }
    }

    /// Index of the first state of sensor axis `axis` in the error state; for an axis without states that of the next one's.
    #[inline]
    pub fn start(&self, axis: usize) -> usize {
        self.start[axis]
    }

    /// Predicted sensor error `H x + U p` of each axis [rad/s, m/s²]: what is subtracted from a sample. `x` is the whole error-state
    /// vector; `coupling` has U, the effect of scale factors and misalignment at the sample's rate and force.
    pub fn predicted_error<const N: usize>(
        &self,
        x: &[f64; N],
        coupling: &Coupling,
    ) -> [f64; AXES] {
        let (x, _) = x.as_chunks::<1>();
        let mut errors = [[0.0; 1]; AXES];
        self.errors_of(&mut errors, x, coupling);
        errors.map(|[error]| error)
    }

    /// Standard deviations of the sensor errors `H x` [rad/s, m/s²] under a covariance of the error state, `covariance(row, column)`.
    pub fn error_std(&self, covariance: impl Fn(usize, usize) -> f64) -> [f64; AXES] {
        from_fn(|axis| {
            let (filter, at) = (&self.axes[axis], self.start[axis]);
            let mut variance = 0.0;
            for i in 0..filter.order {
                for j in 0..filter.order {
                    variance += filter.h[i] * filter.h[j] * covariance(at + i, at + j);
                }
            }
            libm::sqrt(variance.max(0.0))
        })
    }

    /// Steps the sensor states in `x`, a whole error-state vector, by one sample: `x ← F x`.
    pub fn step_mean<const N: usize>(&self, x: &mut [f64; N]) {
        let (x, _) = x.as_chunks_mut::<1>();
        self.step_rows(x, 0..1);
    }

    /// Makes `errors` the six sensor errors `H x + U p` of the states whose rows these are, in the first columns.
    #[inline(always)]
    fn errors_of<const W: usize, const N: usize>(
        &self,
        errors: &mut [[f64; W]; AXES],
        rows: &[[f64; N]],
        coupling: &Coupling,
    ) {
        for (axis, filter) in self.axes.iter().enumerate() {
            let (error, from) = (&mut errors[axis], self.start[axis]);
            // Most axes have a state: its row is where the sum begins.
            match filter.order {
                0 => *error = [0.0; W],
                _ => set_row(error, filter.h[0], &rows[from]),
            }
            for i in 1..filter.order {
                add_row(error, filter.h[i], &rows[from + i]);
            }
            for (index, factor) in coupling.axis(axis) {
                add_row(error, *factor, &rows[*index]);
            }
        }
    }

    /// `M ← Φ M`, Φ the transition of the whole error state over a step: what carries the product of
    /// transitions along for a smoother.
    pub fn carry<const N: usize>(
        &self,
        m: &mut [[f64; N]; N],
        transition: &Transition,
        coupling: &Coupling,
        part: Part,
    ) {
        four_lanes(
            #[inline(always)]
            || {
                let mut errors = [[0.0; N]; AXES];
                self.errors_of(&mut errors, m, coupling);
                if let Some(nav) = m.first_chunk_mut() {
                    transition.carry(nav, &errors);
                }
                if part == Part::Last {
                    self.step_rows(m, 0..N);
                }
            },
        );
    }

    /// `P ← [Φ ΓH; 0 F] P […]ᵀ + Q` over a step of `transition`, `dt` seconds long.
    ///
    /// White noise keeps its density: over `dt` it enters with variance `r T / dt`.
    pub fn propagate<const N: usize>(
        &self,
        p: &mut [[f64; N]; N],
        transition: &Transition,
        coupling: &Coupling,
        dt: f64,
        part: Part,
    ) {
        four_lanes(
            #[inline(always)]
            || self.propagate_inlined(p, transition, coupling, dt, part),
        );
    }

    #[inline(always)]
    fn propagate_inlined<const N: usize>(
        &self,
        p: &mut [[f64; N]; N],
        transition: &Transition,
        coupling: &Coupling,
        dt: f64,
        part: Part,
    ) {
        debug_assert!(self.states() <= N);
        let states = self.states();
        // A [P_n; H P_x + U P_p], A = [Φ Γ]: the navigation rows of the new covariance, before the
        // sensors' own step and the white noise.
        let mut errors = [[0.0; N]; AXES];
        self.errors_of(&mut errors, p, coupling);
        let Some(moved) = p.first_chunk_mut::<NAV>() else {
            return;
        };
        transition.carry(moved, &errors);
        // Lying down, so that what is done to a state is done to a row; row by row, so that no wide read
        // waits for narrow writes.
        let mut nav = [[0.0; EVEN]; NAV];
        for j in 0..NAV {
            for i in 0..NAV {
                nav[j][i] = p[i][j];
            }
        }
        for j in NAV..N {
            for i in 0..NAV {
                p[j][i] = p[i][j];
            }
        }

        // Navigation block: A J Aᵀ as A (A J)ᵀ, J the joint covariance of (n, ε). Behind its columns there is whatever
        // the rows have there, which nothing reads.
        let gamma = transition.input();
        let mut errors = [[0.0; EVEN]; AXES];
        self.errors_of(&mut errors, p, coupling);
        for (axis, filter) in self.axes.iter().enumerate() {
            let variance = filter.r * filter.interval / dt;
            add_row(&mut errors[axis], variance, &gamma[axis]);
        }
        transition.carry(&mut nav, &errors);
        for i in 0..NAV {
            for j in 0..=i {
                p[i][j] = nav[i][j];
                p[j][i] = nav[i][j];
            }
        }

        // Cross block: the states' step, and the noise that drives both. The parameters' columns are there already.
        if part == Part::Last {
            self.step_states(p);
            for (axis, filter) in self.axes.iter().enumerate() {
                for k in 0..filter.order {
                    // Few models have any.
                    if filter.s[k] != 0.0 {
                        // Behind the navigation errors Γ has zeros.
                        add_row(&mut p[self.start[axis] + k], filter.s[k], &gamma[axis]);
                    }
                }
            }
        }
        for i in 0..NAV {
            for j in NAV..states {
                p[i][j] = p[j][i];
            }
        }
    }

    /// `P_xx ← F P_xx Fᵀ + q`, `P_xp ← F P_xp`, `P_xn ← F P_xn`, by the rows of the states; their mirror in the rows of the
    /// parameters, too, not in those of the navigation errors.
    #[inline(always)]
    fn step_states<const N: usize>(&self, p: &mut [[f64; N]; N]) {
        let states = self.states();
        if self.axes.iter().all(|filter| filter.order <= 1) {
            // F is diagonal.
            let mut factors = [1.0; N];
            for (axis, filter) in self.axes.iter().enumerate() {
                if filter.order > 0 {
                    factors[self.start[axis]] = filter.f[0][0];
                }
            }
            for i in NAV..states {
                let factor = factors[i];
                for k in 0..N {
                    p[i][k] = p[i][k] * factors[k] * factor;
                }
            }
        } else {
            // Row by row both times: F P, then F of its transpose, which is the symmetric F P Fᵀ.
            self.step_rows(p, 0..N);
            for i in NAV..states {
                for j in NAV..i {
                    (p[i][j], p[j][i]) = (p[j][i], p[i][j]);
                }
            }
            match states == N {
                // As constants: the rows are then copied without a loop.
                true => self.step_rows(p, NAV..N),
                false => self.step_rows(p, NAV..states),
            }
        }
        for (axis, filter) in self.axes.iter().enumerate() {
            let at = self.start[axis];
            for i in 0..filter.order {
                for j in 0..filter.order {
                    p[at + i][at + j] += filter.q[i][j];
                }
            }
        }
        for i in NAV..states {
            for j in i + 1..N {
                p[j][i] = p[i][j];
            }
        }
    }

    /// F times the rows of the sensors' states, in these columns.
    #[inline(always)]
    fn step_rows<const W: usize>(&self, rows: &mut [[f64; W]], columns: Range<usize>) {
        for (axis, filter) in self.axes.iter().enumerate() {
            let (f, rows) = (&filter.f, &mut rows[self.start[axis]..]);
            let columns = columns.clone();
            match filter.order {
                0 => {}
                1 => step_rows_of::<1, W>(f, rows, columns),
                2 => step_rows_of::<2, W>(f, rows, columns),
                3 => step_rows_of::<3, W>(f, rows, columns),
                4 => step_rows_of::<4, W>(f, rows, columns),
                5 => step_rows_of::<5, W>(f, rows, columns),
                _ => step_rows_of::<MAX_ORDER, W>(f, rows, columns),
            }
        }
    }
}

#[cfg(all(test, feature = "simd"))]
mod tests;
