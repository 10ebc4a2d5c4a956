//! The Kalman filter that whitens the residuals of a window, with the parameters' effect beside the data.
//!
//! Residuals of successive fixes are not independent: gyro and accelerometer noise between them makes velocity
//! and attitude wander. The filter predicts each fix from those before; what is new in it, over its standard
//! deviation, is white, and so are the columns of the parameters that went the same way. Sums of squares and
//! products of these are the normal equations of generalised least squares.
//!
//! For a sequence of scalar measurements with innovation r and variance s the sums are cost Σ r²/s,
//! gradient Σ j r/s and information Σ j jᵀ/s, j the row of derivatives that went through the same
//! filter (Rosenberg 1973; de Jong 1991). So the correlated residuals never need a matrix of the
//! size of the window.
//!
//! All loops are written out for a compile-time S; nothing allocates.

use nalgebra::{SMatrix, SVector};
use undrift_nav::{Matrix3, Quaternion, Vector3, preintegration::Preintegrated};

/// Attitude error at the start in body axes, gyro bias, accelerometer bias.
pub(super) type Unknowns = SVector<f64, 9>;
/// Their information matrix, JᵀJ of whitened residuals.
pub(super) type Information = SMatrix<f64, 9, 9>;

/// States of the filter that whitens velocities: velocity in `n` [m/s], what has wandered in the attitude, body
/// axes \[rad\], and by how much fixes hold later than their stamps \[s\].
pub(super) const BY_VELOCITY: usize = 7;
/// States of the filter that whitens positions: those, the position in `n` \[m\], and what the lever arm lacks, body axes \[m\].
pub(super) const BY_POSITION: usize = 13;
/// Place of the delay among the states of both.
pub(super) const LATE: usize = 6;
/// Place of the position.
pub(super) const PLACE: usize = 7;
/// Place of the lever arm.
pub(super) const ARM: usize = 10;

/// A guess put through the window up to some segment: cost with its linearisation `JᵀJ` and `Jᵀr`, and how far it came.
///
/// Cost in squared standard deviations; gradient and information in the parameters' units.
pub(super) struct Linearised<const S: usize> {
    pub(super) cost: f64,
    pub(super) information: Information,
    pub(super) gradient: Unknowns,
    /// Attitude at the end of the segments so far, by the guess; `state` holds what has wandered
    /// from it.
    pub(super) q_nb: Quaternion,
    /// The filter's states.
    pub(super) state: [f64; S],
    /// Covariance of the states' wander by the sensors' white noise.
    pub(super) wander: [[f64; S]; S],
    /// Effect of the parameters on the states, column by column.
    pub(super) effect: [[f64; S]; 9],
}

/// A matrix times a vector. Written out, like all that is done for each segment: it is where an alignment spends its
/// time, and nalgebra's products of small matrices call a function for each column.
#[inline(always)]
fn times(matrix: &Matrix3, x: &[f64; 3]) -> [f64; 3] {
    let mut product = [0.0; 3];
    for j in 0..3 {
        for i in 0..3 {
            product[i] += matrix[(i, j)] * x[j];
        }
    }
    product
}

/// Adds to three of a column, from a place on.
#[inline(always)]
pub(super) fn add<const S: usize>(column: &mut [f64; S], from: usize, part: &[f64; 3]) {
    for i in 0..3 {
        column[from + i] += part[i];
    }
}

/// Effect of a segment on errors of the states.
pub(super) struct Transition {
    /// Length of the segment \[s\].
    pub(super) dt: f64,
    /// Effect of an attitude error on velocity and on position.
    pub(super) lean: [Matrix3; 2],
    /// Rotation that carries the axes along.
    pub(super) back: Matrix3,
}

impl Transition {
    /// Carries one column of errors of the states over the segment, in place.
    ///
    /// δp ← δp + δv dt + lean₁ ψ, δv ← δv + lean₀ ψ, ψ ← back ψ; delay and lever arm stay.
    #[inline(always)]
    pub(super) fn carry<const S: usize>(&self, column: &mut [f64; S]) {
        let turned = [column[3], column[4], column[5]];
        if S == BY_POSITION {
            let moved = [0, 1, 2].map(|i| column[i] * self.dt);
            add(column, PLACE, &moved);
            add(column, PLACE, &times(&self.lean[1], &turned));
        }
        add(column, 0, &times(&self.lean[0], &turned));
        column[3..6].copy_from_slice(&times(&self.back, &turned));
    }
}

impl<const S: usize> Linearised<S> {
    /// Velocity in `n` \[m/s\].
    pub(super) fn v_n(&self) -> Vector3 {
        Vector3::new(self.state[0], self.state[1], self.state[2])
    }

    /// What has wandered in the attitude, body axes \[rad\].
    pub(super) fn turned(&self) -> Vector3 {
        Vector3::new(self.state[3], self.state[4], self.state[5])
    }

    /// Carries wander and effect over a segment: `c` takes its first axes to `n`.
    ///
    /// The wander is F W Fᵀ, by carrying its columns, transposing, and carrying again.
    #[inline(always)]
    pub(super) fn carry(&mut self, motion: &Preintegrated, c: &Matrix3, transition: &Transition) {
        for column in &mut self.effect {
            transition.carry(column);
        }
        for i in 0..3 {
            let column = |of: &Matrix3| of.column(i).into();
            let [by_g, by_a] = [&motion.dvel_by_g, &motion.dvel_by_a];
            add(&mut self.effect[3 + i], 0, &times(c, &column(by_g)));
            add(&mut self.effect[3 + i], 3, &column(&motion.turn_by_g));
            add(&mut self.effect[6 + i], 0, &times(c, &column(by_a)));
            if S == BY_POSITION {
                let [by_g, by_a] = [&motion.dpos_by_g, &motion.dpos_by_a];
                add(&mut self.effect[3 + i], PLACE, &times(c, &column(by_g)));
                add(&mut self.effect[6 + i], PLACE, &times(c, &column(by_a)));
            }
        }
        let wander = &mut self.wander;
        // Symmetric: carried on both sides.
        for _ in 0..2 {
            for column in &mut *wander {
                transition.carry(column);
            }
            for i in 0..S {
                for j in 0..i {
                    (wander[i][j], wander[j][i]) = (wander[j][i], wander[i][j]);
                }
            }
        }
    }

    /// Updates with a number that measures the sum of states, each times its weight.
    ///
    /// K ≤ 5 states have a weight in the row. A scalar Kalman update: gain W h/s, applied to the
    /// data's state and to the nine columns of derivatives alike.
    #[inline(always)]
    pub(super) fn update<const K: usize>(
        &mut self,
        weighed: [(usize, f64); K],
        measured: f64,
        variance: f64,
    ) {
        let (mut row, mut gain, mut residual, mut sum) = ([0.0; 9], [0.0; S], measured, variance);
        for (state, weight) in weighed {
            for i in 0..9 {
                row[i] += weight * self.effect[i][state];
            }
            for i in 0..S {
                gain[i] += weight * self.wander[state][i];
            }
            residual -= weight * self.state[state];
        }
        for (state, weight) in weighed {
            sum += weight * gain[state];
        }
        for of in &mut gain {
            *of /= sum;
        }
        self.cost += residual * residual / sum;
        for i in 0..9 {
            let weighed = row[i] / sum;
            self.gradient[i] += weighed * residual;
            for j in 0..9 {
                self.information[(j, i)] += weighed * row[j];
            }
            for j in 0..S {
                self.effect[i][j] -= gain[j] * row[i];
            }
        }
        for i in 0..S {
            self.state[i] += gain[i] * residual;
            for j in 0..S {
                self.wander[i][j] -= gain[i] * gain[j] * sum;
            }
        }
    }
}
