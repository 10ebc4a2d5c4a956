//! Pieces of a record run from a state of zeros, eight side by side.
//!
//! The state that a piece really starts from adds `H Aᵏ x` to its innovations; the sums of [`Summary`] and the
//! tables of [`Tables`] give all products of that with the piece, so that no sample is looked at twice.
//!
//! With the closed loop A = F − K H: the innovations of a piece from state x are `v_k − H Aᵏ x`, so
//! Σ v² = Σ v₀² − 2 xᵀb + xᵀ (Σ (H Aᵏ)ᵀ H Aᵏ) x, b = Σ (H Aᵏ)ᵀ v₀. The Gram matrices do not depend
//! on the record: [`Tables`] has them for every length up to [`PIECE`], so that a gap may end a
//! piece anywhere.

use super::Innovations;
use super::matrix::{Matrix, Vector, add, apply, dot, identity, product, transposed};
use crate::vector::{Task, multiply_add, vectorised};

/// Pieces side by side.
pub(super) const LANES: usize = 8;
/// Samples of a piece.
pub(super) const PIECE: usize = 64;

/// Sums over a piece, run from a state of zeros.
#[derive(Clone, Copy)]
pub(super) struct Summary<const N: usize> {
    /// Σ v², v the innovations.
    pub(super) squares: f64,
    /// Σ v c, c the errors for a record of ones.
    pub(super) level: f64,
    /// Σ (H Aᵏ)ᵀ v_k.
    pub(super) b: Vector<N>,
    /// The state at the end.
    pub(super) end: Vector<N>,
}

/// Matrices of a model for pieces of 0 to [`PIECE`] samples.
pub(super) struct Tables<const N: usize> {
    /// A = F − K H.
    closed: Matrix<N>,
    /// A is a companion matrix and H its first row: products need only its first column.
    companion: bool,
    h: Vector<N>,
    gain: Vector<N>,
    /// H Aᵏ, and the error of a record of ones from a state of zeros.
    rows: [Vector<N>; PIECE],
    /// c_k, the innovations of a record of ones.
    errors: [f64; PIECE],
    /// Aᵏ, A the closed loop F − K H.
    pub(super) powers: Vec<Matrix<N>>,
    /// Σ (H Aᵏ)ᵀ H Aᵏ.
    pub(super) grams: Vec<Matrix<N>>,
    /// Σ (H Aᵏ)ᵀ c_k, Σ c², and the state that ones end in.
    ///
    /// Σ (H Aᵏ)ᵀ c_k.
    pub(super) level: Vec<Vector<N>>,
    /// Σ c_k².
    pub(super) level_squares: Vec<f64>,
    /// State in which a record of ones ends.
    pub(super) constant: Vec<Vector<N>>,
}

impl<const N: usize> Tables<N> {
    /// O(PIECE N³), once a model.
    pub(super) fn new(model: &Innovations<N>) -> Self {
        let Innovations { f, h, gain, .. } = model;
        let closed: Matrix<N> =
            std::array::from_fn(|i| std::array::from_fn(|j| f[i][j] - gain[i] * h[j]));
        let mut tables = Self {
            companion: N > 0 && is_companion(&closed, h),
            closed,
            h: *h,
            gain: *gain,
            rows: [[0.0; N]; PIECE],
            errors: [0.0; PIECE],
            powers: vec![identity()],
            grams: vec![[[0.0; N]; N]],
            level: vec![[0.0; N]],
            level_squares: vec![0.0],
            constant: vec![[0.0; N]],
        };
        let turned = transposed(&closed);
        let (mut row, mut state, mut power) = (*h, [0.0; N], identity());
        let (mut gram, mut level, mut squares) = ([[0.0; N]; N], [0.0; N], 0.0);
        for k in 0..PIECE {
            let error = 1.0 - dot(h, &state);
            tables.rows[k] = row;
            tables.errors[k] = error;
            let outer = std::array::from_fn(|i| std::array::from_fn(|j| row[i] * row[j]));
            gram = add(&gram, &outer, 1.0);
            for i in 0..N {
                level[i] += row[i] * error;
            }
            squares += error * error;
            let next = apply(&closed, &state);
            state = std::array::from_fn(|i| next[i] + gain[i]);
            row = apply(&turned, &row);
            power = product(&closed, &power);
            tables.powers.push(power);
            tables.grams.push(gram);
            tables.level.push(level);
            tables.level_squares.push(squares);
            tables.constant.push(state);
        }
        tables
    }

    /// The sums over a short piece.
    ///
    /// At most [`PIECE`] samples, none missing.
    pub(super) fn summary(&self, piece: &[f64], centre: f64) -> Summary<N> {
        let mut sums = Summary {
            squares: 0.0,
            level: 0.0,
            b: [0.0; N],
            end: [0.0; N],
        };
        for ((y, row), error) in piece.iter().zip(&self.rows).zip(&self.errors) {
            let y = y - centre;
            let v = y - dot(&self.h, &sums.end);
            sums.squares += v * v;
            sums.level += v * error;
            for i in 0..N {
                sums.b[i] += v * row[i];
            }
            let next = apply(&self.closed, &sums.end);
            sums.end = std::array::from_fn(|i| next[i] + self.gain[i] * y);
        }
        sums
    }

    /// The sums over the pieces of a block.
    ///
    /// A missing sample (NaN) makes the squares of its piece NaN, by which the caller finds it.
    pub(super) fn summaries(
        &self,
        block: &[f64; LANES * PIECE],
        centre: f64,
    ) -> [Summary<N>; LANES] {
        let tables = self;
        let ([squares, level], b, end) = if self.companion {
            vectorised(Side::<N, true> {
                tables,
                block,
                centre,
            })
        } else {
            vectorised(Side::<N, false> {
                tables,
                block,
                centre,
            })
        };
        std::array::from_fn(|l| Summary {
            squares: squares[l],
            level: level[l],
            b: std::array::from_fn(|i| b[i][l]),
            end: std::array::from_fn(|i| end[i][l]),
        })
    }
}

/// Whether H is the first unit vector, and ones stand above the diagonal of A and zeros elsewhere but in its first
/// column: most products are then with nothing.
fn is_companion<const N: usize>(closed: &Matrix<N>, h: &Vector<N>) -> bool {
    let plain = |i: usize, j: usize| j == 0 || closed[i][j] == f64::from(j == i + 1);
    (0..N).all(|i| h[i] == f64::from(i == 0) && (0..N).all(|j| plain(i, j)))
}

/// Values of every lane: of two sums, and of two vectors.
type LaneValues<const N: usize> = ([[f64; LANES]; 2], [[f64; LANES]; N], [[f64; LANES]; N]);

/// The vectorised loop: N states of [`LANES`] pieces, one sample of each at a time.
struct Side<'a, const N: usize, const COMPANION: bool> {
    tables: &'a Tables<N>,
    block: &'a [f64; LANES * PIECE],
    centre: f64,
}

impl<const N: usize, const COMPANION: bool> Task for Side<'_, N, COMPANION> {
    /// Squares and level, b, end. Not taken apart here: the compiler would arrange the lanes for it.
    type Output = LaneValues<N>;
    #[inline(always)]
    fn run<const FUSED: bool>(self) -> LaneValues<N> {
        let Tables {
            closed,
            h,
            gain,
            rows,
            errors,
            ..
        } = self.tables;
        let (closed, h, gain) = (*closed, *h, *gain);
        let zeros = [0.0; LANES];
        // Side by side: a row holds one place of every piece.
        let mut turned = [zeros; PIECE];
        for (l, piece) in self.block.as_chunks::<PIECE>().0.iter().enumerate() {
            for (row, y) in turned.iter_mut().zip(piece) {
                row[l] = y - self.centre;
            }
        }
        let (mut squares, mut level) = (zeros, zeros);
        let (mut b, mut x) = ([zeros; N], [zeros; N]);
        for (k, y) in turned.iter().enumerate() {
            let mut v = *y;
            if COMPANION {
                for l in 0..LANES {
                    v[l] -= x[0][l];
                }
            } else {
                for i in 0..N {
                    multiply_add::<FUSED, LANES>(&mut v, -h[i], &x[i]);
                }
            }
            for l in 0..LANES {
                squares[l] = if FUSED {
                    v[l].mul_add(v[l], squares[l])
                } else {
                    squares[l] + v[l] * v[l]
                };
            }
            multiply_add::<FUSED, LANES>(&mut level, errors[k], &v);
            let mut next = [zeros; N];
            for i in 0..N {
                multiply_add::<FUSED, LANES>(&mut b[i], rows[k][i], &v);
                if COMPANION {
                    if i + 1 < N {
                        next[i] = x[i + 1];
                    }
                    multiply_add::<FUSED, LANES>(&mut next[i], closed[i][0], &x[0]);
                } else {
                    for j in 0..N {
                        multiply_add::<FUSED, LANES>(&mut next[i], closed[i][j], &x[j]);
                    }
                }
                multiply_add::<FUSED, LANES>(&mut next[i], gain[i], y);
            }
            x = next;
        }
        ([squares, level], b, x)
    }
}
