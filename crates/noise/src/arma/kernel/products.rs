//! Sums of products of the innovations with filtered series, which the gradient of the likelihood is made of: see
//! [`crate::arma::gradient`].
//!
//! Three filters run over the record in step, each by 1/θ(B): a from φ(B) y, w from y, v from a. So
//! all p + q derivatives of Σ a² cost three recursions, O(N (p + q)), where differences would take
//! p + q evaluations or more. Layout and blocks are those of [`super`].

use super::{
    BLOCK, LANES, PIECE, Row,
    loops::{Block, DelayedProducts, Turn},
    run::responses,
};
use crate::vector::{total, vectorised};

/// With y the record about its level, `a = (φ(B) y − x₀)/θ(B)` the innovations from a known state x₀, `w = y/θ(B)` and
/// `v = a/θ(B)`: the sums of products with a, delayed by 1, 2, ….
pub(in crate::arma) struct Products {
    /// Σ a_t w_{t−i}, i = 1…p.
    pub(in crate::arma) with_record: Vec<f64>,
    /// Σ a_t v_{t−j}, j = 1…q.
    pub(in crate::arma) with_own: Vec<f64>,
}

/// A series filtered by 1/θ(B), piece by piece.
///
/// Keeps as many rows before a block as the longest delay that is asked for, so that products
/// across the border of two blocks are complete.
struct Filtered {
    /// Rows before the pieces for the longest delay, then the pieces.
    rows: Vec<Row>,
    /// What of it comes before the block: the newest values, newest first.
    history: Vec<f64>,
    /// Longest delay, at least q.
    delays: usize,
}

impl Filtered {
    /// After the values of `head`, the newest last.
    /// Zeros stand for what comes before the head.
    fn after(head: &[f64], q: usize, delays: usize) -> Self {
        let delays = delays.max(q);
        let newest = head.iter().rev().copied().chain(std::iter::repeat(0.0));
        Self {
            rows: vec![[0.0; LANES]; delays + PIECE],
            history: newest.take(delays).collect(),
            delays,
        }
    }

    /// Goes on over a block of input rows, of which `phi` makes the input of the filter.
    fn block(
        &mut self,
        phi: &[f64],
        theta: &[f64],
        responses: &[[f64; PIECE]],
        input: &[Row],
        starts: &mut [Row],
    ) {
        let q = theta.len();
        let before = self.history.clone();
        vectorised(Block {
            phi,
            theta,
            responses,
            turned: input,
            work: &mut self.rows[self.delays - q..],
            starts: &mut starts[..q],
            history: &mut self.history[..q],
        });
        for m in 0..self.delays {
            let place = self.delays + PIECE - 1 - m;
            self.history[m] = self.rows[place][LANES - 1];
            let mut row = [before[m]; LANES];
            row[1..].copy_from_slice(&self.rows[place][..LANES - 1]);
            self.rows[self.delays - 1 - m] = row;
        }
    }

    /// The block's output, without the rows before it.
    fn pieces(&self) -> &[Row] {
        &self.rows[self.delays..]
    }
}

/// The sums, of a record about `centre` and from the state `start`.
///
/// `centre` is the level \[unit\]; `start` are the r numbers of x₀ \[unit\], which enter the first
/// r innovations only. The record has no gaps.
pub(in crate::arma) fn products(
    samples: &[f64],
    centre: f64,
    phi: &[f64],
    theta: &[f64],
    start: &[f64],
) -> Products {
    let (p, q) = (phi.len(), theta.len());
    let mut head = samples.len() % BLOCK;
    if head < p.max(q) {
        head += BLOCK;
    }
    let (head, rest) = samples.split_at(head.min(samples.len()));
    let y: Vec<f64> = head.iter().map(|x| x - centre).collect();
    let filtered = |input: &dyn Fn(usize) -> f64| {
        let mut out: Vec<f64> = Vec::with_capacity(y.len());
        for t in 0..y.len() {
            let past = theta.iter().zip(out.iter().rev()).map(|(c, x)| c * x);
            let value = input(t) + past.sum::<f64>();
            out.push(value);
        }
        out
    };
    let a = filtered(&|t| {
        let past: f64 = (1..=p.min(t)).map(|i| phi[i - 1] * y[t - i]).sum();
        y[t] - past - start.get(t).copied().unwrap_or(0.0)
    });
    let (w, v) = (filtered(&|t| y[t]), filtered(&|t| a[t]));
    let delayed = |of: &[f64], delay: usize| -> f64 {
        a.iter().skip(delay).zip(of).map(|(a, x)| a * x).sum()
    };
    let mut with_record: Vec<f64> = (1..=p).map(|i| delayed(&w, i)).collect();
    let mut with_own: Vec<f64> = (1..=q).map(|j| delayed(&v, j)).collect();
    if !rest.is_empty() {
        let responses = responses(theta, false);
        let mut series =
            [(&a, 0), (&w, p), (&v, q)].map(|(head, delays)| Filtered::after(head, q, delays));
        let mut turned = vec![[0.0; LANES]; p + PIECE];
        let mut starts = vec![[0.0; LANES]; q];
        let mut sums = vec![[0.0; LANES]; p + q];
        for block in (head.len()..samples.len()).step_by(BLOCK) {
            vectorised(Turn {
                samples: &samples[block - p..block + BLOCK],
                centre,
                turned: &mut turned,
            });
            let [a, w, v] = &mut series;
            a.block(phi, theta, &responses, &turned, &mut starts);
            w.block(&[], theta, &responses, &turned[p..], &mut starts);
            v.block(&[], theta, &responses, a.pieces(), &mut starts);
            let (with_w, with_v) = sums.split_at_mut(p);
            for (of, sums) in [(w, with_w), (v, with_v)] {
                vectorised(DelayedProducts {
                    a: a.pieces(),
                    rows: &of.rows,
                    sums,
                });
            }
        }
        for (sum, rows) in with_record.iter_mut().chain(&mut with_own).zip(sums) {
            *sum += total(rows);
        }
    }
    Products {
        with_record,
        with_own,
    }
}
