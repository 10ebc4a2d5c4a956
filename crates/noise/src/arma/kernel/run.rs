//! The recursions at one point (φ, θ), from the start of the record to its end.
//!
//! The start of a record, up to a multiple of the block, goes sample by sample; blocks follow. While the
//! response to the state before the record is above rounding, its sums are taken too; from then on only a
//! itself is summed, and o stays at its limit.
//!
//! Which sums matter when: with |roots of θ| at most ρ, g falls as ρᵗ, so the sums with g end after
//! some 30/(1 − ρ) samples; for a gyro's θ = 0.9994 after 50 000. A record of millions of samples
//! thus spends nearly all of its time in [`Block`] alone.

use super::{
    Accumulated, BLOCK, LANES, PIECE, Row,
    loops::{Block, Lagged, ProductsWith, Recurse, Respond, recurse_any},
};
use crate::arma::MAX_FIT_ORDER;
use crate::vector::{total, vectorised};

/// Response to the start below which it is dropped: what is left out then is at most this times
/// √(P₁₁/(1−θ²)) ~ 10⁴ in log-likelihood.
const NEGLIGIBLE: f64 = 1e-13;

/// Working space of a block.
///
/// Allocated once a pass and shared by all points, which run one after the other over each block.
pub(super) struct Scratch {
    /// a after q rows of zeros.
    work: Vec<Row>,
    /// History before each piece.
    starts: Vec<Row>,
    /// g after the r rows before it, and o.
    impulse: Vec<Row>,
    ones: Vec<Row>,
    /// Sums of products with lagged g: of a, g and o for each lag.
    products: Vec<[Row; 3]>,
}

impl Scratch {
    /// Sized for orders (p, q).
    pub(super) fn new(p: usize, q: usize) -> Self {
        let r = p.max(q);
        let rows = |count| vec![[0.0; LANES]; count];
        Self {
            work: rows(q + PIECE),
            starts: rows(r + q),
            impulse: rows(r + PIECE),
            ones: rows(PIECE),
            products: vec![[[0.0; LANES]; 3]; r],
        }
    }
}

/// The recursions at one point, as far as they have come.
///
/// Holds no samples, so that many points may share one reading of the record.
pub(super) struct Run<'a> {
    phi: &'a [f64],
    theta: &'a [f64],
    /// Whether the mean is estimated, which needs the series o.
    with_ones: bool,
    /// The result so far.
    sums: Accumulated,
    /// Responses of a piece: to a unit at each place of the history, and to a constant input of 1
    /// (with ones).
    responses: Vec<[f64; PIECE]>,
    /// The newest q values of a, newest first.
    history: Vec<f64>,
    /// The newest r + q values of g, newest first.
    impulse: Vec<f64>,
    /// The newest q values of o, newest first.
    ones: Vec<f64>,
    /// Input of o once the start is over, 1 − Σφ.
    input: f64,
    /// g is below rounding for good, and o at its limit.
    settled: bool,
    /// Value of o in the limit, (1 − Σφ)/(1 − Σθ) \[–\].
    limit: f64,
}

impl<'a> Run<'a> {
    /// Runs over `head`; `goes_on` where blocks follow.
    pub(super) fn new(
        phi: &'a [f64],
        theta: &'a [f64],
        with_ones: bool,
        head: &[f64],
        centre: f64,
        goes_on: bool,
    ) -> Self {
        let (p, q, n) = (phi.len(), theta.len(), head.len());
        let r = p.max(q);
        // a, g and o side by side, after a history of zeros.
        let mut rows = vec![[0.0; 4]; q + n];
        let input = &mut rows[q..];
        let mut level = 1.0;
        for t in 0..n {
            let past: f64 = (1..=p.min(t))
                .map(|i| phi[i - 1] * (head[t - i] - centre))
                .sum();
            input[t][0] = head[t] - centre - past;
            if with_ones {
                input[t][2] = level;
                level -= phi.get(t).copied().unwrap_or(0.0);
            }
        }
        if let Some(first) = input.first_mut() {
            first[1] = 1.0;
        }
        vectorised(Recurse {
            theta,
            rows: &mut rows,
        });
        let rows = &rows[q..];
        let with_lag = |column: usize, lag: usize| {
            let mut products = [0.0; 4];
            for (row, past) in rows[lag.min(n)..].iter().zip(rows) {
                for l in 0..4 {
                    products[l] += row[l] * past[column];
                }
            }
            products
        };
        let (own, ones) = (with_lag(0, 0), with_lag(2, 0));
        let mut sums = Accumulated {
            squares: own[0],
            ones_cross: ones[0],
            ones_squares: ones[2],
            ..Accumulated::default()
        };
        for lag in 0..r {
            let [cross, lags, ones, _] = with_lag(1, lag);
            sums.state_cross.push(cross);
            sums.state_lags.push(lags);
            sums.ones_state.push(ones);
        }
        let newest = |column: usize, count: usize| -> Vec<f64> {
            let value = |k: usize| {
                rows.get(n.wrapping_sub(k + 1))
                    .map_or(0.0, |row| row[column])
            };
            (0..count).map(value).collect()
        };
        let mut run = Self {
            phi,
            theta,
            with_ones,
            sums,
            responses: Vec::new(),
            history: newest(0, q),
            impulse: newest(1, r + q),
            ones: newest(2, q),
            input: level,
            settled: r == 0 && !with_ones,
            limit: newest(2, 1)[0],
        };
        if goes_on {
            run.responses = responses(theta, with_ones);
        }
        run
    }

    /// Goes on over a block.
    ///
    /// `turned` is the block transposed, with p rows before it; a block must directly follow what
    /// came before.
    pub(super) fn block(&mut self, turned: &[Row], scratch: &mut Scratch) {
        let q = self.theta.len();
        let [sum, squares] = vectorised(Block {
            phi: self.phi,
            theta: self.theta,
            responses: &self.responses[..q],
            turned,
            work: &mut scratch.work,
            starts: &mut scratch.starts[..q],
            history: &mut self.history,
        });
        self.sums.squares += total(squares);
        if !self.settled {
            self.start_and_ones(scratch);
        } else if self.with_ones {
            self.sums.ones_cross += self.limit * total(sum);
            self.sums.ones_squares += self.limit * self.limit * BLOCK as f64;
        }
    }

    /// Adds the sums with g and o over a block.
    ///
    /// Called until g has vanished; decides itself when that is so.
    fn start_and_ones(&mut self, scratch: &mut Scratch) {
        let q = self.theta.len();
        let r = self.sums.state_cross.len();
        let Scratch {
            work,
            starts,
            impulse,
            ones,
            products,
        } = scratch;
        let a = &work[q..];
        let (response, constant) = self.responses.split_at(q);
        if self.with_ones {
            histories(response, &mut self.ones, starts, |place| {
                self.input * constant[0][place]
            });
            vectorised(Respond {
                responses: response,
                starts: &starts[..q],
                rows: ones,
            });
            for (row, s) in ones.iter_mut().zip(&constant[0]) {
                for value in row {
                    *value += self.input * s;
                }
            }
            let [squares, cross] = vectorised(ProductsWith { rows: ones, a });
            self.sums.ones_squares += total(squares);
            self.sums.ones_cross += total(cross);
        }
        histories(response, &mut self.impulse, starts, |_| 0.0);
        for i in 0..r {
            impulse[r - 1 - i] = starts[i];
        }
        vectorised(Respond {
            responses: response,
            starts: &starts[..q],
            rows: &mut impulse[r..],
        });
        vectorised(Lagged {
            impulse,
            a,
            ones,
            products,
        });
        for (i, [cross, lags, ones]) in products.iter().enumerate() {
            self.sums.state_cross[i] += total(*cross);
            self.sums.state_lags[i] += total(*lags);
            self.sums.ones_state[i] += total(*ones);
        }
        // A slow oscillation may pass zero: the whole last piece must be small.
        let last = impulse.iter().map(|row| row[LANES - 1].abs());
        self.settled = last.fold(0.0, f64::max) < NEGLIGIBLE;
        self.limit = ones[PIECE - 1][LANES - 1];
    }

    /// The sums, with the last responses to the state before the record.
    /// They are what [`information`](crate::arma::likelihood::information) takes off along its diagonals.
    pub(super) fn finish(mut self) -> Accumulated {
        let r = self.sums.state_cross.len();
        self.sums.last_impulse = self.impulse[..r].to_vec();
        self.sums
    }
}

/// What a unit at each place of the history makes of a piece without input; with `ones` also what a
/// constant input of 1 makes of a history of zeros.
pub(super) fn responses(theta: &[f64], ones: bool) -> Vec<[f64; PIECE]> {
    let q = theta.len();
    let mut rows = vec![[0.0]; q + PIECE];
    (0..q + usize::from(ones))
        .map(|j| {
            rows.fill([0.0]);
            if j < q {
                rows[q - 1 - j] = [1.0];
            } else {
                rows[q..].fill([1.0]);
            }
            recurse_any::<false, 1>(theta, &mut rows);
            core::array::from_fn(|k| rows[q + k][0])
        })
        .collect()
}

/// Continues a series of given response over the pieces of a block: `starts` gets what precedes each,
/// newest first, `history` that at the end. `input` adds to place k of a piece.
///
/// Serial over the [`LANES`] pieces: O(LANES q²) a block, no loop over samples.
fn histories(
    responses: &[[f64; PIECE]],
    history: &mut [f64],
    starts: &mut [Row],
    input: impl Fn(usize) -> f64,
) {
    let mut next = [0.0; 2 * MAX_FIT_ORDER];
    for l in 0..LANES {
        for (start, value) in starts.iter_mut().zip(&*history) {
            start[l] = *value;
        }
        for m in 0..history.len() {
            let place = PIECE - 1 - m;
            let mut value = input(place);
            for (w, h) in responses.iter().zip(&*history) {
                value += w[place] * h;
            }
            next[m] = value;
        }
        let length = history.len();
        history.copy_from_slice(&next[..length]);
    }
}
