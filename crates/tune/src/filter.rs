//! The linear filter for the error of a replay's solution, and its reverse mode.
//!
//! Forward, with x the expected error and P its covariance: `x ← Φ x`, `P ← Φ P Φᵀ + Q` over a step; with a
//! measurement `ν = H e + v` of the solution of the replay `i = ν − H x`, `S = H P Hᵀ + R`, `K = P Hᵀ S⁻¹`,
//! `x ← x + K i`, `P ← (I − K H) P (I − K H)ᵀ + K R Kᵀ`; and what the replay took out of its solution is taken out of x.
//!
//! Backward, with x̄ and P̄ the derivatives of the objective by x and P after an operation, those before it, and on
//! the way those by Q and R. K is the best there is, so P after an update does not change with it to first order:
//!
//! ```text
//! step:    x̄ ← Φᵀ x̄,   Q̄ = P̄,   P̄ ← Φᵀ P̄ Φ
//! update:  g = (I − K H)ᵀ x̄,   e = S⁻¹ i,   R̄ = Kᵀ P̄ K − ½ (Kᵀ x̄ eᵀ + e x̄ᵀ K),
//!          P̄ ← (I − K H)ᵀ P̄ (I − K H) + ½ (g eᵀ H + Hᵀ e gᵀ),   x̄ ← g
//! ```
//!
//! to which a scored measurement adds `c Hᵀ e` to x̄ and `½ Hᵀ (c e eᵀ − S⁻¹) H` to P̄, the same without H to R̄, c the
//! derivative of its loss. What the linear algebra of Giles 2008 gives for the recursions of Kalman 1960.

use super::{
    noise::{self, LASTING, Noise, Vector, WALK, WHITE},
    steps::{Input, LinearStep, MOST},
};
use undrift_engine::vehicle::NonHolonomic;
use undrift_nav::covariance::{AXES, NAV};

/// Expected error and covariance.
#[derive(Clone, Debug)]
pub struct State<const N: usize> {
    /// Expected error.
    pub x: [f64; N],
    /// Covariance.
    pub p: [[f64; N]; N],
}

/// What the reverse mode needs of an update.
#[derive(Clone, Debug)]
pub struct Done<const N: usize> {
    gain: [[f64; MOST]; N],
    inverse: [[f64; MOST]; MOST],
    /// e = S⁻¹ i.
    weighted: [f64; MOST],
    /// Normalised innovation squared.
    pub nis: f64,
    /// ln det S.
    pub ln_det: f64,
}

/// What stays the same from noise to noise.
#[derive(Clone, Copy, Debug)]
pub struct Fixed {
    /// First state of the lasting part of position and velocity, where there is one.
    pub lasting: [Option<usize>; 2],
    /// First state of the gyros' scale factors and the variance that their walk gains in a second.
    pub scale: Option<(usize, f64)>,
    /// The constraint in the replay.
    pub rule: NonHolonomic,
    /// White noise of each axis beside what is sought [unit²·s].
    pub white: [f64; AXES],
}

/// ∫ s^i/i! s^j/j! over a span.
#[inline(always)]
fn moment(span: f64, i: usize, j: usize) -> f64 {
    const FACTORIAL: [f64; 4] = [1.0, 1.0, 2.0, 6.0];
    let mut power = span;
    for _ in 0..i + j {
        power *= span;
    }
    power / ((i + j + 1) as f64 * FACTORIAL[i] * FACTORIAL[j])
}

/// Blocks that noise reaches after so many integrations, with the direction in each: attitude, velocity, position.
#[inline(always)]
fn reach(input: &Input, gyro: bool) -> [(usize, [f64; 3], usize); 3] {
    let (a, v) = (input.attitude.into(), input.velocity.into());
    if gyro {
        [(6, a, 0), (3, v, 1), (0, v, 2)]
    } else {
        // Unused: the attitude.
        [(6, [0.0; 3], 0), (3, v, 0), (0, v, 1)]
    }
}

impl<const N: usize> State<N> {
    /// Over a step, to the update at its end.
    #[inline(always)]
    pub fn predict(&mut self, step: &LinearStep<N>, noise: &Noise, fixed: &Fixed) {
        if step.span > 0.0 {
            let before = self.x;
            for i in 0..NAV {
                self.x[i] = dot(&step.nav[i], &before);
            }
            for i in NAV..N {
                self.x[i] *= step.left[i];
            }
            add(&mut self.x, -1.0, &step.shift);

            let mut rows = [[0.0; N]; NAV];
            for i in 0..NAV {
                rows[i] = combined(&step.nav[i], &self.p);
            }
            for i in 0..NAV {
                for j in 0..=i {
                    let value = dot(&rows[i], &step.nav[j]);
                    (self.p[i][j], self.p[j][i]) = (value, value);
                }
                for j in NAV..N {
                    let value = rows[i][j] * step.left[j];
                    (self.p[i][j], self.p[j][i]) = (value, value);
                }
            }
            for i in NAV..N {
                for j in NAV..N {
                    self.p[i][j] *= step.left[i] * step.left[j];
                }
            }
            for axis in 0..AXES {
                let white =
                    fixed.white[axis] + noise.white[axis] * noise.white[axis] * step.shape[axis];
                let walk = noise.walk[axis] * noise.walk[axis];
                each(step, axis, |i, j, of_white, of_walk| {
                    self.p[i][j] += white * of_white + walk * of_walk;
                });
            }
            for (factor, at) in noise.factors.correlated.iter().zip(fixed.lasting) {
                for i in at.into_iter().flat_map(|at| at..at + 3) {
                    self.p[i][i] += factor * factor * (1.0 - step.left[i] * step.left[i]);
                }
            }
            if let Some((at, variance)) = fixed.scale {
                for i in at..at + 3 {
                    self.p[i][i] += variance * step.span;
                }
            }
        }
    }

    /// The update at the end of a step; `None` where the innovation's covariance is not positive.
    #[inline(always)]
    pub fn update(
        &mut self,
        step: &LinearStep<N>,
        noise: &Noise,
        fixed: &Fixed,
    ) -> Option<Done<N>> {
        let size = step.size;
        // H P.
        let mut hp = [[0.0; N]; MOST];
        for a in 0..size {
            for i in 0..N {
                if step.h[a][i] != 0.0 {
                    add(&mut hp[a], step.h[a][i], &self.p[i]);
                }
            }
        }
        let mut s = noise::covariance(step, noise, &fixed.rule);
        let mut innovation = [0.0; MOST];
        for a in 0..size {
            innovation[a] = step.innovation[a] - dot(&step.h[a], &self.x);
            for b in 0..size {
                s[a][b] += dot(&step.h[a], &hp[b]);
            }
        }
        let (inverse, ln_det) = invert(&s, size)?;
        let mut weighted = [0.0; MOST];
        for a in 0..size {
            for b in 0..size {
                weighted[a] += inverse[a][b] * innovation[b];
            }
        }
        let mut gain = [[0.0; MOST]; N];
        for i in 0..N {
            for a in 0..size {
                for b in 0..size {
                    gain[i][a] += hp[b][i] * inverse[b][a];
                }
            }
        }
        for i in 0..N {
            for a in 0..size {
                self.x[i] += gain[i][a] * innovation[a];
            }
            self.x[i] -= step.correction[i];
            for a in 0..size {
                add(&mut self.p[i], -gain[i][a], &hp[a]);
            }
        }
        Some(Done {
            gain,
            inverse,
            weighted,
            nis: (0..size).map(|a| weighted[a] * innovation[a]).sum(),
            ln_det,
        })
    }

    /// A step without its update.
    pub fn skip(&mut self, step: &LinearStep<N>) {
        for (x, correction) in self.x.iter_mut().zip(&step.correction) {
            *x -= correction;
        }
    }

    /// Reverse of [`State::predict`], of derivatives.
    #[inline(always)]
    pub fn back_predict(
        &mut self,
        step: &LinearStep<N>,
        noise: &Noise,
        fixed: &Fixed,
        gradient: &mut Vector,
    ) {
        if step.span <= 0.0 {
            return;
        }
        for axis in 0..AXES {
            let (mut by_white, mut by_walk) = (0.0, 0.0);
            each(step, axis, |i, j, of_white, of_walk| {
                by_white += of_white * self.p[i][j];
                by_walk += of_walk * self.p[i][j];
            });
            let white = noise.white[axis] * noise.white[axis] * step.shape[axis];
            gradient[WHITE + axis] += 2.0 * white * by_white;
            gradient[WALK + axis] += 2.0 * noise.walk[axis] * noise.walk[axis] * by_walk;
        }
        for (k, at) in fixed.lasting.into_iter().enumerate() {
            for i in at.into_iter().flat_map(|at| at..at + 3) {
                let variance = noise.factors.correlated[k] * noise.factors.correlated[k];
                let entered = 1.0 - step.left[i] * step.left[i];
                gradient[LASTING + k] += 2.0 * variance * entered * self.p[i][i];
            }
        }
        let mut x = [0.0; N];
        for i in NAV..N {
            x[i] = self.x[i] * step.left[i];
        }
        for i in 0..NAV {
            add(&mut x, self.x[i], &step.nav[i]);
        }
        self.x = x;
        // P̄ Φ, then Φᵀ of that.
        let mut right = [[0.0; N]; N];
        for i in 0..N {
            right[i] = combined(&self.p[i][..NAV], &step.nav);
            for j in NAV..N {
                right[i][j] += self.p[i][j] * step.left[j];
            }
        }
        let (of_nav, _) = right.split_at(NAV);
        for i in 0..N {
            let mut factors = [0.0; NAV];
            for k in 0..NAV {
                factors[k] = step.nav[k][i];
            }
            self.p[i] = combined(&factors, of_nav);
            if i >= NAV {
                add(&mut self.p[i], step.left[i], &right[i]);
            }
        }
    }

    /// Reverse of [`State::update`], of derivatives; `scored` is the weight of the measurement in the objective and c.
    #[inline(always)]
    pub fn back_update(
        &mut self,
        step: &LinearStep<N>,
        done: &Done<N>,
        scored: Option<(f64, f64)>,
        noise: &Noise,
        fixed: &Fixed,
        gradient: &mut Vector,
    ) {
        let size = step.size;
        let e = &done.weighted;
        // Kᵀ x̄, Kᵀ P̄ and Kᵀ P̄ K.
        let mut kx = [0.0; MOST];
        let mut kp = [[0.0; N]; MOST];
        for i in 0..N {
            for a in 0..size {
                kx[a] += done.gain[i][a] * self.x[i];
                add(&mut kp[a], done.gain[i][a], &self.p[i]);
            }
        }
        let mut kpk = [[0.0; MOST]; MOST];
        for a in 0..size {
            for b in 0..size {
                for i in 0..N {
                    kpk[a][b] += kp[a][i] * done.gain[i][b];
                }
            }
        }
        let mut by_r = [[0.0; MOST]; MOST];
        // What multiplies Hᵀ · H in P̄, and Hᵀ in x̄.
        let mut inner = kpk;
        let mut outer: [f64; MOST] = std::array::from_fn(|a| -kx[a]);
        for a in 0..size {
            for b in 0..size {
                by_r[a][b] = kpk[a][b] - 0.5 * (kx[a] * e[b] + e[a] * kx[b]);
                // ½ (g eᵀ H + …) with the part of g that is −Hᵀ Kᵀ x̄.
                inner[a][b] -= 0.5 * (kx[a] * e[b] + e[a] * kx[b]);
                if let Some((weight, c)) = scored {
                    let own = 0.5 * weight * (c * e[a] * e[b] - done.inverse[a][b]);
                    by_r[a][b] += own;
                    inner[a][b] += own;
                }
            }
            if let Some((weight, c)) = scored {
                outer[a] += weight * c * e[a];
            }
        }
        noise::add_covariance_gradient(step, noise, &fixed.rule, &by_r, gradient);
        // P̄ ← P̄ − Hᵀ (Kᵀ P̄) − (…)ᵀ + Hᵀ inner H + ½ (x̄ eᵀ H + …).
        let mut of_h = [[0.0; N]; MOST];
        for a in 0..size {
            for i in 0..N {
                of_h[a][i] = 0.5 * self.x[i] * e[a] - kp[a][i];
            }
            for b in 0..size {
                add(&mut of_h[a], 0.5 * inner[a][b], &step.h[b]);
            }
        }
        for a in 0..size {
            for i in 0..N {
                if step.h[a][i] != 0.0 {
                    add(&mut self.p[i], step.h[a][i], &of_h[a]);
                }
            }
            for i in 0..N {
                add(&mut self.p[i], of_h[a][i], &step.h[a]);
            }
            add(&mut self.x, outer[a], &step.h[a]);
        }
    }
}

/// The entries of the covariance that unit noise of an axis brings over a step: of white noise, and of a random walk.
#[inline(always)]
fn each<const N: usize>(
    step: &LinearStep<N>,
    axis: usize,
    mut entry: impl FnMut(usize, usize, f64, f64),
) {
    let blocks = reach(&step.inputs[axis], axis < 3);
    let blocks = if axis < 3 { &blocks[..] } else { &blocks[1..] };
    let span = step.span;
    let bias = NAV + axis;
    entry(bias, bias, 0.0, span);
    for &(at, direction, order) in blocks {
        let with_bias = moment(span, 0, order + 1);
        for i in 0..3 {
            entry(at + i, bias, 0.0, with_bias * direction[i]);
            entry(bias, at + i, 0.0, with_bias * direction[i]);
        }
        for &(to, other, power) in blocks {
            let white = moment(span, order, power);
            let walk = moment(span, order + 1, power + 1);
            for i in 0..3 {
                for j in 0..3 {
                    let product = direction[i] * other[j];
                    entry(at + i, to + j, white * product, walk * product);
                }
            }
        }
    }
}

// Indices here and above: iterators would be inlined only where the compiler happens to put both in one unit.
#[inline(always)]
fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    let mut sums = [0.0; 4];
    let (a4, a_rest) = a.as_chunks::<4>();
    let (b4, b_rest) = b.as_chunks::<4>();
    for i in 0..a4.len() {
        for k in 0..4 {
            sums[k] += a4[i][k] * b4[i][k];
        }
    }
    let mut rest = 0.0;
    for i in 0..a_rest.len() {
        rest += a_rest[i] * b_rest[i];
    }
    sums[0] + sums[1] + sums[2] + sums[3] + rest
}

/// Σ factor · row, eight columns at a time so that the sums stay in registers.
#[inline(always)]
fn combined<const N: usize>(factors: &[f64], rows: &[[f64; N]]) -> [f64; N] {
    let mut out = [0.0; N];
    let (blocks, _) = out.as_chunks_mut::<8>();
    for (b, sum) in blocks.iter_mut().enumerate() {
        let mut own = [0.0; 8];
        for i in 0..factors.len() {
            let (row, _) = rows[i].as_chunks::<8>();
            for k in 0..8 {
                own[k] += factors[i] * row[b][k];
            }
        }
        *sum = own;
    }
    out
}

#[inline(always)]
fn add<const N: usize>(to: &mut [f64; N], factor: f64, from: &[f64; N]) {
    for i in 0..N {
        to[i] += factor * from[i];
    }
}

/// Inverse of the leading block and the logarithm of its determinant, by Cholesky's factor.
fn invert(s: &[[f64; MOST]; MOST], size: usize) -> Option<([[f64; MOST]; MOST], f64)> {
    let matrix = nalgebra::Matrix3::from_fn(|i, j| match () {
        () if i < size && j < size => 0.5 * (s[i][j] + s[j][i]),
        () => f64::from(u8::from(i == j)),
    });
    let factor = nalgebra::Cholesky::new(matrix)?;
    let ln_det = 2.0
        * factor
            .l_dirty()
            .diagonal()
            .iter()
            .map(|d| d.ln())
            .sum::<f64>();
    let inverse = factor.inverse();
    let inverse = std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            if i < size && j < size {
                inverse[(i, j)]
            } else {
                0.0
            }
        })
    });
    ln_det.is_finite().then_some((inverse, ln_det))
}
