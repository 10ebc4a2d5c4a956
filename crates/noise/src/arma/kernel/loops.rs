//! The loops over the rows of a block.
//!
//! A row holds the same place of every piece. All loops go over rows, lane by lane, so that the feedback of the
//! recursion waits once a row, not once a sample. Each [`Task`] is compiled for plain and for wide vectors
//! ([`crate::vector`]).
//!
//! Layout. A block of `LANES × PIECE` samples is transposed once ([`Turn`]); from then on row k
//! holds sample k of every piece, and a recursion over k runs all pieces at once. Nothing here
//! allocates, and nothing knows of likelihoods: sums go back to [`super::run`] lane by lane.
//!
//! `FUSED` is whether the machine has fused multiply-add; results of the two differ in the last
//! digit only.

use super::{LANES, PIECE, Row};
use crate::vector::{Task, add_products, multiply_add};

/// `$body` with the slice `$name` as an array of known length where it is short, so that the loops
/// over it are unrolled.
macro_rules! with_known_length {
    ($name:ident => $body:expr; $($length:literal)*) => {
        match $name.len() {
            $($length => {
                let mut known = [$name[0]; $length];
                known.copy_from_slice($name);
                let $name: &[_] = &known;
                $body
            })*
            _ => $body,
        }
    };
}

/// `row_k ← row_k + θ1 row_{k−1} + … + θq row_{k−q}` after the first q rows.
///
/// The filter 1/θ(B), in place: rows before the first q are its history, zeros or what came before.
#[inline(always)]
pub(super) fn recurse_any<const FUSED: bool, const L: usize>(theta: &[f64], rows: &mut [[f64; L]]) {
    let q = theta.len();
    if q == 0 {
        return;
    }
    let mut newest = rows[q - 1];
    for k in 0..rows.len() - q {
        let window = &mut rows[k..=k + q];
        let mut row = window[q];
        // Oldest first: only the last product waits for the newest row.
        for j in (1..q).rev() {
            multiply_add::<FUSED, L>(&mut row, theta[j], &window[q - 1 - j]);
        }
        multiply_add::<FUSED, L>(&mut row, theta[0], &newest);
        window[q] = row;
        newest = row;
    }
}

/// The recursion with the loops of its length written out, up to six coefficients.
#[inline(always)]
fn recurse<const FUSED: bool, const L: usize>(theta: &[f64], rows: &mut [[f64; L]]) {
    with_known_length!(theta => recurse_any::<FUSED, L>(theta, rows); 1 2 3 4 5 6);
}

/// The recursion over rows, in place.
///
/// `rows` begins with q rows of history.
pub(super) struct Recurse<'a, const L: usize> {
    /// θ1 … θq.
    pub(super) theta: &'a [f64],
    pub(super) rows: &'a mut [[f64; L]],
}

impl<const L: usize> Task for Recurse<'_, L> {
    type Output = ();
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        recurse::<FUSED, L>(self.theta, self.rows);
    }
}

/// Lays the pieces of a block side by side, each with the samples before it that φ needs.
///
/// A transpose, four pieces at a time; `samples` begin p before the block, `turned` has p rows more than a piece.
pub(super) struct Turn<'a> {
    pub(super) samples: &'a [f64],
    pub(super) centre: f64,
    pub(super) turned: &'a mut [Row],
}

impl Task for Turn<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        const SIDE: usize = 4;
        let length = self.turned.len();
        for first in (0..LANES).step_by(SIDE) {
            let piece = |l: usize| &self.samples[(first + l) * PIECE..][..length];
            let pieces: [_; SIDE] = [piece(0), piece(1), piece(2), piece(3)];
            for (k, row) in self.turned.iter_mut().enumerate() {
                for l in 0..SIDE {
                    row[first + l] = pieces[l][k] - self.centre;
                }
            }
        }
    }
}

/// One block at one point: autoregression, recursion from zeros, correction by the history before
/// each piece. Leaves a in `work` after the first q rows and the history at the end in `history`.
///
/// `turned` are rows of [`Turn`]; `starts` and `history` have q entries, newest first.
pub(super) struct Block<'a> {
    pub(super) phi: &'a [f64],
    pub(super) theta: &'a [f64],
    pub(super) responses: &'a [[f64; PIECE]],
    pub(super) turned: &'a [Row],
    pub(super) work: &'a mut [Row],
    pub(super) starts: &'a mut [Row],
    pub(super) history: &'a mut [f64],
}

impl Task for Block<'_> {
    /// Sum and sum of squares of a.
    type Output = [Row; 2];
    #[inline(always)]
    fn run<const FUSED: bool>(self) -> [Row; 2] {
        let Self {
            phi,
            theta,
            responses,
            turned,
            work,
            starts,
            history,
        } = self;
        let q = theta.len();
        work[..q].fill([0.0; LANES]);
        let input = &mut work[q..];
        with_known_length!(phi => autoregress::<FUSED>(phi, turned, input); 1 2 3 4 5 6);
        recurse::<FUSED, LANES>(theta, work);
        let rows = &mut work[q..];
        propagate(responses, rows, history, starts);
        let starts = &*starts;
        with_known_length!(starts => correct::<FUSED>(responses, starts, rows); 1 2 3 4 5 6)
    }
}

/// The history before every piece, from what each makes of zeros.
///
/// One piece after the other, q values each: the only part of a block that is serial.
#[inline(always)]
fn propagate(responses: &[[f64; PIECE]], rows: &[Row], history: &mut [f64], starts: &mut [Row]) {
    let q = responses.len();
    for l in 0..LANES {
        for j in 0..q {
            starts[j][l] = history[j];
        }
        for j in 0..q {
            let place = PIECE - 1 - j;
            let mut end = rows[place][l];
            for i in 0..q {
                end += responses[i][place] * starts[i][l];
            }
            history[j] = end;
        }
    }
}

/// `u_k = x_k − φ1 x_{k−1} − … − φp x_{k−p}`, x after its first p rows.
/// The moving-average part of the whitening filter, without feedback.
#[inline(always)]
fn autoregress<const FUSED: bool>(phi: &[f64], x: &[Row], u: &mut [Row]) {
    let p = phi.len();
    for (k, slot) in u.iter_mut().enumerate() {
        let window = &x[k..=k + p];
        let mut row = window[p];
        for i in 0..p {
            multiply_add::<FUSED, LANES>(&mut row, -phi[i], &window[p - 1 - i]);
        }
        *slot = row;
    }
}

/// Adds what the history before each piece makes of it; sum and sum of squares.
///
/// A piece run from zeros plus h_0 w_0 + … + h_{q−1} w_{q−1}: the equation of [`super`].
///
/// Since the corrected rows are in registers, Σa and Σa² are taken in the same loop.
#[inline(always)]
fn correct<const FUSED: bool>(
    responses: &[[f64; PIECE]],
    starts: &[Row],
    rows: &mut [Row],
) -> [Row; 2] {
    let responses = &responses[..starts.len()];
    let (mut sum, mut squares) = ([0.0; LANES], [0.0; LANES]);
    for (k, slot) in rows.iter_mut().enumerate().take(PIECE) {
        let mut row = *slot;
        for j in 0..starts.len() {
            multiply_add::<FUSED, LANES>(&mut row, responses[j][k], &starts[j]);
        }
        for l in 0..LANES {
            sum[l] += row[l];
        }
        add_products::<FUSED>(&mut squares, &row, &row);
        *slot = row;
    }
    [sum, squares]
}

/// Sums of differences from `centre` and of their magnitudes, lane by lane.
///
/// One pass; the caller adds the lanes.
pub(super) struct SumsAbout<'a> {
    pub(super) rows: &'a [Row],
    pub(super) centre: f64,
}

impl Task for SumsAbout<'_> {
    type Output = [Row; 2];
    #[inline(always)]
    fn run<const FUSED: bool>(self) -> [Row; 2] {
        let (mut sum, mut size) = ([0.0; LANES], [0.0; LANES]);
        for row in self.rows {
            for l in 0..LANES {
                let difference = row[l] - self.centre;
                sum[l] += difference;
                size[l] += difference.abs();
            }
        }
        [sum, size]
    }
}

/// What the histories `starts` make of pieces without input.
///
/// Row k is Σ_j h_j w_j(k), h the history before each piece, w_j the response to its place j.
pub(super) struct Respond<'a> {
    pub(super) responses: &'a [[f64; PIECE]],
    pub(super) starts: &'a [Row],
    pub(super) rows: &'a mut [Row],
}

impl Task for Respond<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        for (k, slot) in self.rows.iter_mut().enumerate().take(PIECE) {
            let mut row = [0.0; LANES];
            for (response, start) in self.responses.iter().zip(self.starts) {
                multiply_add::<FUSED, LANES>(&mut row, response[k], start);
            }
            *slot = row;
        }
    }
}

/// Sums of products of rows with themselves and with a.
///
/// Σ o² and Σ o a, with o in `rows`.
pub(super) struct ProductsWith<'a> {
    pub(super) rows: &'a [Row],
    pub(super) a: &'a [Row],
}

impl Task for ProductsWith<'_> {
    type Output = [Row; 2];
    #[inline(always)]
    fn run<const FUSED: bool>(self) -> [Row; 2] {
        let (mut squares, mut cross) = ([0.0; LANES], [0.0; LANES]);
        for (row, a) in self.rows.iter().zip(self.a) {
            add_products::<FUSED>(&mut squares, row, row);
            add_products::<FUSED>(&mut cross, row, a);
        }
        [squares, cross]
    }
}

/// Sums of products of g, delayed by 0, 1, … rows, with a, g and o.
///
/// `impulse` begins r rows before the pieces, r the number of lags.
pub(super) struct Lagged<'a> {
    pub(super) impulse: &'a [Row],
    pub(super) a: &'a [Row],
    pub(super) ones: &'a [Row],
    pub(super) products: &'a mut [[Row; 3]],
}

impl Task for Lagged<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let r = self.products.len();
        for (lag, sums) in self.products.iter_mut().enumerate() {
            let now = &self.impulse[r..r + PIECE];
            let delayed = &self.impulse[r - lag..][..PIECE];
            for (sum, with) in sums.iter_mut().zip([self.a, now, self.ones]) {
                let mut total = [0.0; LANES];
                for (g, with) in delayed.iter().zip(with) {
                    add_products::<FUSED>(&mut total, g, with);
                }
                *sum = total;
            }
        }
    }
}

/// Adds the sums of products of a with rows delayed by 1, 2, …; the rows begin as many before a as it takes.
///
/// Used by the gradient: Σ a_t w_{t−i} for i = 1, 2, …
pub(super) struct DelayedProducts<'a> {
    pub(super) a: &'a [Row],
    pub(super) rows: &'a [Row],
    pub(super) sums: &'a mut [Row],
}

impl Task for DelayedProducts<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let before = self.rows.len() - self.a.len();
        for (lag, sum) in self.sums.iter_mut().enumerate() {
            let mut total = *sum;
            for (a, row) in self.a.iter().zip(&self.rows[before - lag - 1..]) {
                add_products::<FUSED>(&mut total, a, row);
            }
            *sum = total;
        }
    }
}
