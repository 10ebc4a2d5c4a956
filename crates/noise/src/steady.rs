//! Exact sums of squares of a record under a linear model whose prediction has a steady state.
//!
//! In steady state the model is its innovations form, `v = y − H x̂`, `x̂ ← A x̂ + K y`, `A = F − K H`, v white of
//! variance V. Whatever the state's covariance P at some sample, with e the state's error there beyond that of the
//! steady state, the steady filter's `v_k` is `H Aᵏ e` plus the white innovations, so
//!
//! ```text
//! b = Σ (H Aᵏ)ᵀ v_k/V    M = Σ (H Aᵏ)ᵀ H Aᵏ/V    Δ = P − P∞    e ~ (m, Δ)
//! Σ v²/V  less  2 mᵀb − mᵀM m + (b − M m)ᵀ Δ (I + M Δ)⁻¹ (b − M m),    log|V|  plus  log |I + M Δ|
//! ```
//!
//! is exact over any stretch without a gap, Δ positive or not: the start of a record needs no transient. A missing
//! sample ends a stretch: e goes on as `F e`, P as `F P Fᵀ + Q`. (de Jong 1988; Anderson & Moore 1979, chapter 4.)
//! A stretch is cut in pieces of 64 samples, eight side by side, each run from a state of zeros: the recursion being
//! linear, sums of products with tables of `H Aᵏ` say what the true state makes of it.
//!
//! Why not the plain filter: a search evaluates a record many times, and the recursion waits for its own result
//! at every sample. Pieces from zero do not wait for one another.
//!
//! Called by [`crate::arma`] for records with gaps (orders up to 6) and by [`crate::composite`] for
//! every model that has a steady state. Cost: O(r) a sample with the companion form, O(r²) without,
//! plus O(r³) a piece while the start is still seen; r is the constant N of the types.
//!
//! What it assumes: a model that does not change in time, the same for all samples of the record. A
//! time-varying filter (gates, varying intervals) has no steady state and does not belong here.

mod matrix;
mod pieces;
mod riccati;

use matrix::{Matrix, Vector, add, apply, dot, identity, product, solve, transposed};
use pieces::{LANES, PIECE, Summary, Tables};
pub(crate) use riccati::{Steps, steady_state};

/// Largest entry of Aᵏ below which a stretch no longer says anything of the state at its start.
const FORGOTTEN: f64 = 1e-15;

/// A model in steady state, variances in units of V.
#[derive(Clone, Debug)]
pub(crate) struct Innovations<const N: usize> {
    /// Transition F of the state over one sample.
    pub(crate) f: Matrix<N>,
    /// Output H: the sample is H x plus a noise of its own.
    pub(crate) h: Vector<N>,
    /// Steady gain K of x̂ ← F x̂ + K v.
    pub(crate) gain: Vector<N>,
    /// Driving noise of a missing sample.
    pub(crate) q: Matrix<N>,
    /// P∞, the covariance of the prediction once it has settled.
    pub(crate) p: Matrix<N>,
}

/// Sums over a record; o is the same filter's error for a record of ones. Squares are \[unit²\], the determinant is less n log V.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sums {
    /// Σ v²/V times V: the sum of squares of the record's innovations, each over its relative
    /// variance.
    pub(crate) squares: f64,
    /// Σ v o, for the generalised least squares of the level \[unit\].
    pub(crate) cross: f64,
    /// Σ o²; level = cross/ones, and its variance is V/ones.
    pub(crate) ones: f64,
    /// Σ ln (variance of a sample / V).
    pub(crate) log_determinant: f64,
    /// Samples that are not missing.
    pub(crate) present: usize,
}

/// The record's series or that of ones.
#[derive(Clone, Copy)]
struct Series<const N: usize> {
    /// Steady filter's state.
    x: Vector<N>,
    /// m, and b of the stretch.
    m: Vector<N>,
    b: Vector<N>,
}

/// The state of a pass over a record: sums, what the state before the record is still seen by, and the two series.
///
/// Invariant: `record.x` is the state of the steady filter at the present sample, started from zero
/// at the first sample; e, by which the process differs from it beyond the steady state's error, has
/// the mean m and the covariance Δ at the start of the stretch. b, M and Aᵏ gather what the stretch
/// shows of it; [`Walk::close`], before a missing sample and at the end, makes use of them.
struct Walk<'a, const N: usize> {
    model: &'a Innovations<N>,
    /// Products for pieces of every length, built once a record.
    tables: &'a Tables<N>,
    record: Series<N>,
    ones: Series<N>,
    /// Δ = P − P∞ at the start of the stretch; not necessarily positive.
    delta: Matrix<N>,
    /// M of the stretch, and Aᵏ over it.
    information: Matrix<N>,
    reach: Matrix<N>,
    /// Aᵏ has vanished: the rest of the stretch is the steady filter's alone.
    forgotten: bool,
    sums: Sums,
}

/// The sums over a record about `centre`, from a state of covariance `p0` (in units of V). NaN is a missing sample.
/// None where the model leaves no positive variance.
///
/// `centre` \[unit\] is taken off every sample first. Samples are finite or NaN.
pub(crate) fn sums<const N: usize>(
    record: &[f64],
    centre: f64,
    model: &Innovations<N>,
    p0: &Matrix<N>,
) -> Option<Sums> {
    let tables = Tables::new(model);
    let series = Series {
        x: [0.0; N],
        m: [0.0; N],
        b: [0.0; N],
    };
    let mut walk = Walk {
        model,
        tables: &tables,
        record: series,
        ones: series,
        delta: add(p0, &model.p, -1.0),
        information: [[0.0; N]; N],
        reach: identity(),
        forgotten: N == 0,
        sums: Sums::default(),
    };
    let (blocks, rest) = record.as_chunks::<{ LANES * PIECE }>();
    for block in blocks {
        let summaries = tables.summaries(block, centre);
        for (summary, piece) in summaries.iter().zip(block.as_chunks::<PIECE>().0) {
            // A missing sample leaves no square.
            if summary.squares.is_nan() {
                walk.broken(piece, centre)?;
            } else {
                walk.piece(PIECE, summary);
            }
        }
    }
    for piece in rest.chunks(PIECE) {
        walk.broken(piece, centre)?;
    }
    walk.close()?;
    Some(walk.sums)
}

impl<const N: usize> Walk<'_, N> {
    /// A piece in which samples may be missing.
    fn broken(&mut self, piece: &[f64], centre: f64) -> Option<()> {
        let mut from = 0;
        while from < piece.len() {
            let rest = &piece[from..];
            let length = rest.iter().position(|y| y.is_nan()).unwrap_or(rest.len());
            if length > 0 {
                let summary = self.tables.summary(&rest[..length], centre);
                self.piece(length, &summary);
                from += length;
            } else {
                self.skip()?;
                from += 1;
            }
        }
        Some(())
    }

    /// Goes on over `length` samples that are all there.
    ///
    /// `piece` is its summary from a state of zeros; the true start enters by `powers` and `grams`.
    fn piece(&mut self, length: usize, piece: &Summary<N>) {
        let tables = self.tables;
        let (power, gram) = (&tables.powers[length], &tables.grams[length]);
        let (level, constant) = (&tables.level[length], &tables.constant[length]);
        let (x, o) = (self.record.x, self.ones.x);
        let (gx, go) = (apply(gram, &x), apply(gram, &o));
        self.sums.present += length;
        self.sums.squares += piece.squares - 2.0 * dot(&x, &piece.b) + dot(&x, &gx);
        self.sums.cross += piece.level - dot(&x, level) - dot(&o, &piece.b) + dot(&x, &go);
        self.sums.ones += tables.level_squares[length] - 2.0 * dot(&o, level) + dot(&o, &go);
        let (ax, ao) = (apply(power, &x), apply(power, &o));
        if !self.forgotten {
            let back = transposed(&self.reach);
            let b = apply(&back, &std::array::from_fn(|i| piece.b[i] - gx[i]));
            let c = apply(&back, &std::array::from_fn(|i| level[i] - go[i]));
            for i in 0..N {
                self.record.b[i] += b[i];
                self.ones.b[i] += c[i];
            }
            let seen = product(&back, &product(gram, &self.reach));
            self.information = add(&self.information, &seen, 1.0);
            self.reach = product(power, &self.reach);
            let largest = self
                .reach
                .iter()
                .flatten()
                .fold(0.0f64, |m, v| m.max(v.abs()));
            self.forgotten = largest < FORGOTTEN;
        }
        for i in 0..N {
            self.record.x[i] = ax[i] + piece.end[i];
            self.ones.x[i] = ao[i] + constant[i];
        }
    }

    /// Ends a stretch: what it says of e.
    ///
    /// `None` where `I + M Δ` is singular or has no positive determinant.
    fn close(&mut self) -> Option<()> {
        let m = self.information;
        let away = |series: &Series<N>| -> Vector<N> {
            let mm = apply(&m, &series.m);
            std::array::from_fn(|i| series.b[i] - mm[i])
        };
        let (b, c) = (away(&self.record), away(&self.ones));
        // Δ (I + M Δ)⁻¹ = ((I + Δ M)⁻¹ Δ), symmetric.
        let weight = add(&identity(), &product(&self.delta, &m), 1.0);
        let (posterior, determinant) = solve(&weight, &self.delta)?;
        if !(determinant > 0.0 && determinant.is_finite()) {
            return None;
        }
        let (db, dc) = (apply(&posterior, &b), apply(&posterior, &c));
        let lost = |s: &Series<N>, t: &Series<N>, s_b: &Vector<N>, d: &Vector<N>| {
            // mᵀb' + m'ᵀb − mᵀM m', with b = (b − M m) + M m.
            dot(&s.m, &t.b) + dot(&t.m, s_b) + dot(s_b, d)
        };
        self.sums.squares -= lost(&self.record, &self.record, &b, &db);
        self.sums.cross -= lost(&self.record, &self.ones, &b, &dc);
        self.sums.ones -= lost(&self.ones, &self.ones, &c, &dc);
        self.sums.log_determinant += determinant.ln();
        for (series, d) in [(&mut self.record, &db), (&mut self.ones, &dc)] {
            let end: Vector<N> = std::array::from_fn(|i| series.m[i] + d[i]);
            series.m = apply(&self.reach, &end);
            series.b = [0.0; N];
        }
        self.delta = product(&self.reach, &product(&posterior, &transposed(&self.reach)));
        self.information = [[0.0; N]; N];
        self.reach = identity();
        self.forgotten = N == 0;
        Some(())
    }

    /// Goes over a missing sample.
    ///
    /// The state is predicted without a sample: P grows by one step of the driving noise.
    fn skip(&mut self) -> Option<()> {
        self.close()?;
        let Innovations { f, q, p, .. } = self.model;
        for series in [&mut self.record, &mut self.ones] {
            series.x = apply(f, &series.x);
            series.m = apply(f, &series.m);
        }
        let ahead = product(f, &product(&add(&self.delta, p, 1.0), &transposed(f)));
        self.delta = add(&add(&ahead, q, 1.0), p, -1.0);
        Some(())
    }
}

#[cfg(test)]
mod tests;
