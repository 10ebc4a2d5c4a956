//! The sums over the record that the exact likelihood is made of: see [`super::likelihood`].
//!
//! The work is the recursion `a_t = u_t + θ1 a_{t−1} + … + θq a_{t−q}`, `u = φ(B) x`, which is bound
//! by the latency of its own feedback. A block of [`BLOCK`] samples is therefore cut in [`LANES`]
//! consecutive pieces that run side by side, each from a history of zeros. Since the recursion is
//! linear, the truth is the outcome of that plus a multiple of the *responses* of a piece: with
//! `w_j` what a unit in place j of the history (newest first) makes of a piece whose input is zero,
//!
//! ```text
//! a = a from zeros + h_0 w_0 + … + h_{q−1} w_{q−1}
//! ```
//!
//! h the history at the start of the piece, which is the end of the piece before. The two other
//! series needed, the impulse response g of 1/θ(B) and the recursion o over a record of ones, are
//! no more than that, `g = Σ γ_j w_j` and `o = Σ ω_j w_j + c s`, s the response to a constant input
//! of 1: no recursion has to be run for them. (Their sums of products would be quadratic forms in those
//! of the w, at no cost per sample; but where roots of θ crowd at 1 the w are large and nearly
//! parallel, and that loses the digits that the state's variance then needs.) Once g is below
//! rounding for good, both are dropped.
//!
//! Only the first samples (what is left over from whole blocks) are run one by one.
//!
//! Several points (φ, θ) share one pass over the record, so that it is read and rearranged once.

/// Pieces of a block that run side by side.
const LANES: usize = 16;
/// Samples of one piece; more than twice the highest order.
const PIECE: usize = 64;
/// Samples of one block.
const BLOCK: usize = LANES * PIECE;
/// Points that share a pass: what they hold stays in the second cache.
const TOGETHER: usize = 32;
/// Response to the start below which it is dropped: what is left out then is at most this times
/// √(P₁₁/(1−θ²)) ~ 10⁴ in log-likelihood.
const NEGLIGIBLE: f64 = 1e-13;

/// φ and θ of one point.
pub(super) type Coefficients = (Vec<f64>, Vec<f64>);

/// Sums over the record, g the impulse response of 1/θ(B), o the recursion over ones, r = max(p, q).
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Accumulated {
    /// Σ a².
    pub(super) squares: f64,
    /// Σ o².
    pub(super) ones_squares: f64,
    /// Σ o a.
    pub(super) ones_cross: f64,
    /// Σ g_{t−i} a_t, i = 0…r−1.
    pub(super) state_cross: Vec<f64>,
    /// Σ g_{t−i} o_t.
    pub(super) ones_state: Vec<f64>,
    /// Σ g_t g_{t−i}.
    pub(super) state_lags: Vec<f64>,
    /// The newest r values of g, newest first.
    pub(super) last_impulse: Vec<f64>,
}

/// One row: the same place in every piece.
type Row = [f64; LANES];

/// The sums at every point, in one pass over the record. Samples before the record count as
/// `centre`. Those of o are zero unless `with_ones`. All points are of the same order.
pub(super) fn accumulate(
    samples: &[f64],
    centre: f64,
    points: &[Coefficients],
    with_ones: bool,
) -> Vec<Accumulated> {
    let groups = points.chunks(TOGETHER);
    groups
        .flat_map(|group| accumulate_group(samples, centre, group, with_ones))
        .collect()
}

fn accumulate_group(
    samples: &[f64],
    centre: f64,
    points: &[Coefficients],
    with_ones: bool,
) -> Vec<Accumulated> {
    let Some((phi, theta)) = points.first() else {
        return Vec::new();
    };
    let (p, q) = (phi.len(), theta.len());
    let mut head = samples.len() % BLOCK;
    // The start has no response to the past, and needs as many samples as the order to be over.
    if head < p.max(q) {
        head += BLOCK;
    }
    let (head, rest) = samples.split_at(head.min(samples.len()));
    let mut runs: Vec<Run> = points
        .iter()
        .map(|(phi, theta)| Run::new(phi, theta, with_ones, head, centre, !rest.is_empty()))
        .collect();
    if !rest.is_empty() {
        let mut turned = vec![[0.0; LANES]; p + PIECE];
        let mut scratch = Scratch::new(p, q);
        for start in (head.len()..samples.len()).step_by(BLOCK) {
            vectorised(Turn {
                samples: &samples[start - p..start + BLOCK],
                centre,
                turned: &mut turned,
            });
            for run in &mut runs {
                run.block(&turned, &mut scratch);
            }
        }
    }
    runs.into_iter().map(Run::finish).collect()
}

/// Working space of a block.
struct Scratch {
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
    fn new(p: usize, q: usize) -> Self {
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
struct Run<'a> {
    phi: &'a [f64],
    theta: &'a [f64],
    with_ones: bool,
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
    limit: f64,
}

impl<'a> Run<'a> {
    /// Runs over `head`; `goes_on` where blocks follow.
    fn new(
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
    fn block(&mut self, turned: &[Row], scratch: &mut Scratch) {
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

    fn finish(mut self) -> Accumulated {
        let r = self.sums.state_cross.len();
        self.sums.last_impulse = self.impulse[..r].to_vec();
        self.sums
    }
}

/// What a unit at each place of the history makes of a piece without input; with `ones` also what a
/// constant input of 1 makes of a history of zeros.
fn responses(theta: &[f64], ones: bool) -> Vec<[f64; PIECE]> {
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
fn histories(
    responses: &[[f64; PIECE]],
    history: &mut [f64],
    starts: &mut [Row],
    input: impl Fn(usize) -> f64,
) {
    let mut next = [0.0; 2 * super::MAX_FIT_ORDER];
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

/// A loop that is compiled twice: for every processor, and for those with 256-bit vectors and
/// fused multiply-add, where they are found at run time. The two differ by rounding.
trait Task {
    type Output;
    fn run<const FUSED: bool>(self) -> Self::Output;
}

fn vectorised<T: Task>(task: T) -> T::Output {
    #[cfg(target_arch = "x86_64")]
    {
        struct Fused<T>(T);
        impl<T: Task> pulp::NullaryFnOnce for Fused<T> {
            type Output = T::Output;
            #[inline(always)]
            fn call(self) -> T::Output {
                self.0.run::<true>()
            }
        }
        if let Some(avx2) = pulp::x86::V3::try_new() {
            return avx2.vectorize(Fused(task));
        }
    }
    // Part of the base instructions of 64-bit ARM.
    task.run::<{ cfg!(target_arch = "aarch64") }>()
}

/// Sum over the lanes. Not to be done inside a task: the compiler would arrange the lanes for it.
fn total(row: Row) -> f64 {
    row.iter().sum()
}

#[inline(always)]
fn multiply_add<const FUSED: bool, const L: usize>(sum: &mut [f64; L], a: f64, b: &[f64; L]) {
    for l in 0..L {
        sum[l] = if FUSED {
            a.mul_add(b[l], sum[l])
        } else {
            sum[l] + a * b[l]
        };
    }
}

#[inline(always)]
fn add_products<const FUSED: bool>(sum: &mut Row, a: &Row, b: &Row) {
    for l in 0..LANES {
        sum[l] = if FUSED {
            a[l].mul_add(b[l], sum[l])
        } else {
            sum[l] + a[l] * b[l]
        };
    }
}

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
#[inline(always)]
fn recurse_any<const FUSED: bool, const L: usize>(theta: &[f64], rows: &mut [[f64; L]]) {
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

#[inline(always)]
fn recurse<const FUSED: bool, const L: usize>(theta: &[f64], rows: &mut [[f64; L]]) {
    with_known_length!(theta => recurse_any::<FUSED, L>(theta, rows); 1 2 3 4 5 6);
}

/// The recursion over rows, in place.
struct Recurse<'a, const L: usize> {
    theta: &'a [f64],
    rows: &'a mut [[f64; L]],
}

impl<const L: usize> Task for Recurse<'_, L> {
    type Output = ();
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        recurse::<FUSED, L>(self.theta, self.rows);
    }
}

/// Lays the pieces of a block side by side, each with the samples before it that φ needs.
struct Turn<'a> {
    samples: &'a [f64],
    centre: f64,
    turned: &'a mut [Row],
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
struct Block<'a> {
    phi: &'a [f64],
    theta: &'a [f64],
    responses: &'a [[f64; PIECE]],
    turned: &'a [Row],
    work: &'a mut [Row],
    starts: &'a mut [Row],
    history: &'a mut [f64],
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

/// Sum of `samples − centre` and of its absolute values.
pub(super) fn sums_about(samples: &[f64], centre: f64) -> (f64, f64) {
    let (rows, rest) = samples.as_chunks::<LANES>();
    let mut last = [centre; LANES];
    last[..rest.len()].copy_from_slice(rest);
    let sums = vectorised(SumsAbout { rows, centre });
    let rest = vectorised(SumsAbout {
        rows: &[last],
        centre,
    });
    (
        total(sums[0]) + total(rest[0]),
        total(sums[1]) + total(rest[1]),
    )
}

struct SumsAbout<'a> {
    rows: &'a [Row],
    centre: f64,
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
struct Respond<'a> {
    responses: &'a [[f64; PIECE]],
    starts: &'a [Row],
    rows: &'a mut [Row],
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
struct ProductsWith<'a> {
    rows: &'a [Row],
    a: &'a [Row],
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
struct Lagged<'a> {
    impulse: &'a [Row],
    a: &'a [Row],
    ones: &'a [Row],
    products: &'a mut [[Row; 3]],
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

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(n: usize) -> Vec<f64> {
        let mut s = 1u64;
        (0..n)
            .map(|_| {
                s = s
                    .wrapping_mul(6364136223846793005)
                    .wrapping_add(1442695040888963407);
                (s >> 11) as f64 / (1u64 << 53) as f64 - 0.5
            })
            .collect()
    }

    /// The sums by their definition, one sample after the other.
    fn plainly(x: &[f64], centre: f64, phi: &[f64], theta: &[f64]) -> Accumulated {
        let (n, r) = (x.len(), phi.len().max(theta.len()));
        let recursion = |u: &dyn Fn(usize) -> f64| {
            let mut a = vec![0.0; n];
            for t in 0..n {
                let past: f64 = (1..=theta.len().min(t))
                    .map(|j| theta[j - 1] * a[t - j])
                    .sum();
                a[t] = u(t) + past;
            }
            a
        };
        let autoregression = |x: &dyn Fn(usize) -> f64, t: usize| {
            let past: f64 = (1..=phi.len().min(t)).map(|i| phi[i - 1] * x(t - i)).sum();
            x(t) - past
        };
        let a = recursion(&|t| autoregression(&|t| x[t] - centre, t));
        let o = recursion(&|t| autoregression(&|_| 1.0, t));
        let g = recursion(&|t| f64::from(t == 0));
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum();
        let lags = |of: &[f64]| (0..r).map(|i| dot(&of[i..], &g)).collect();
        Accumulated {
            squares: dot(&a, &a),
            ones_squares: dot(&o, &o),
            ones_cross: dot(&o, &a),
            state_cross: lags(&a),
            ones_state: lags(&o),
            state_lags: lags(&g),
            last_impulse: (0..r).map(|k| g[n - 1 - k]).collect(),
        }
    }

    #[test]
    fn pieces_make_the_plain_sums() {
        for (phi, theta) in [
            (&[0.99995][..], &[0.9994][..]),
            (&[0.3], &[-0.7]),
            (&[0.999, 0.0005], &[1.99, -0.9901]),
            (&[0.5, 0.2, -0.1, 0.05], &[0.3, -0.2, 0.8]),
            (&[0.5], &[0.1, 0.2, 0.1, -0.3, 0.2, 0.1, 0.05]),
            (&[], &[0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -0.4]),
            (&[1.2, -0.5], &[]),
            (&[], &[]),
        ] {
            for n in [700, 3 * BLOCK, 5 * BLOCK + 77] {
                let x = noise(n);
                let point = (phi.to_vec(), theta.to_vec());
                let twice = accumulate(&x, 0.1, &[point.clone(), point], true);
                assert_eq!(twice[0], twice[1]);
                let (ours, plain) = (&twice[0], plainly(&x, 0.1, phi, theta));
                let near = |a: f64, b: f64, size: f64| {
                    // Rounding of recursions with gain at most 1e4 over 5e3 samples.
                    assert!(
                        (a - b).abs() <= 1e-10 * size,
                        "{a} {b} {phi:?} {theta:?} {n}"
                    );
                };
                near(ours.squares, plain.squares, plain.squares);
                near(ours.ones_squares, plain.ones_squares, plain.ones_squares);
                let ones = plain.ones_squares.sqrt();
                let record = plain.squares.sqrt();
                near(ours.ones_cross, plain.ones_cross, ones * record);
                for i in 0..plain.state_lags.len() {
                    let impulse = plain.state_lags[0].sqrt();
                    near(ours.state_cross[i], plain.state_cross[i], impulse * record);
                    near(ours.ones_state[i], plain.ones_state[i], impulse * ones);
                    near(ours.state_lags[i], plain.state_lags[i], impulse * impulse);
                    near(ours.last_impulse[i], plain.last_impulse[i], impulse);
                }
                // Without ones nothing else changes.
                let known = accumulate(&x, 0.1, &[(phi.to_vec(), theta.to_vec())], false);
                assert_eq!(known[0].state_cross, ours.state_cross);
                assert_eq!(known[0].ones_cross, 0.0);
            }
        }
    }

    #[test]
    fn both_ways_of_compiling_agree() {
        let mut fused = noise(PIECE * LANES);
        fused.extend([0.0; LANES]);
        let mut rows: Vec<Row> = fused
            .chunks_exact(LANES)
            .map(|c| c.try_into().unwrap())
            .collect();
        let mut plain = rows.clone();
        vectorised(Recurse {
            theta: &[0.9],
            rows: &mut rows,
        });
        Recurse {
            theta: &[0.9],
            rows: &mut plain,
        }
        .run::<false>();
        for (a, b) in rows.iter().flatten().zip(plain.iter().flatten()) {
            // Rounding of sums of about ten terms below 1.
            assert!((a - b).abs() < 1e-14);
        }
    }
}
