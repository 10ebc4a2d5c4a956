//! The steady recursion `a_t = u_t + θ1 a_{t−1} + … + θq a_{t−q}` over blocks.
//!
//! A recursion is bound by the latency of its own feedback, a multiplication and an addition per
//! sample. A block of [`BLOCK`] samples is therefore cut in [`LANES`] consecutive pieces. A first
//! pass runs every piece from a history of zeros; the true history at the start of each piece then
//! follows exactly, since the recursion is linear (history at the end = end from zeros + power of
//! the companion matrix times the history at the start); a second pass runs every piece from its
//! true history and sums.

/// Pieces of a block that run side by side.
const LANES: usize = 8;
/// Samples of one piece.
const PIECE: usize = 128;
/// Samples of one block.
pub(super) const BLOCK: usize = LANES * PIECE;

/// Sum and sum of squares of the values a block produced.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Sums {
    pub(super) sum: f64,
    pub(super) squares: f64,
}

/// `1/θ(B)` as a running filter: the coefficients, the last q outputs (newest first) and the
/// q-by-q response of the history to a piece.
#[derive(Clone, Debug)]
pub(super) struct Recursion {
    theta: Vec<f64>,
    history: Vec<f64>,
    piece_response: Vec<f64>,
}

impl Recursion {
    /// The recursion with all past outputs zero. `samples` is how many it will run over: below a
    /// block the response over a piece is not needed.
    pub(super) fn new(theta: &[f64], samples: usize) -> Self {
        let q = theta.len();
        let mut piece_response = Vec::new();
        if samples >= BLOCK {
            piece_response = vec![0.0; q * q];
            for column in 0..q {
                let mut unit = vec![0.0; q];
                unit[column] = 1.0;
                for _ in 0..PIECE {
                    let next: f64 = theta.iter().zip(&unit).map(|(t, h)| t * h).sum();
                    unit.rotate_right(1);
                    unit[0] = next;
                }
                for row in 0..q {
                    piece_response[row * q + column] = unit[row];
                }
            }
        }
        Self {
            theta: theta.to_vec(),
            history: vec![0.0; q],
            piece_response,
        }
    }

    /// Replaces `block` (u) by a and returns the sums of a.
    pub(super) fn run(&mut self, block: &mut [f64]) -> Sums {
        self.dispatch::<true>(block)
    }

    /// The sums of a only; what `block` holds afterwards is of no use.
    pub(super) fn run_sums(&mut self, block: &mut [f64]) -> Sums {
        self.dispatch::<false>(block)
    }

    fn dispatch<const STORE: bool>(&mut self, block: &mut [f64]) -> Sums {
        match self.theta.len() {
            0 => plain_sums(block),
            1 => self.run_order::<1, STORE>(block),
            2 => self.run_order::<2, STORE>(block),
            3 => self.run_order::<3, STORE>(block),
            4 => self.run_order::<4, STORE>(block),
            5 => self.run_order::<5, STORE>(block),
            6 => self.run_order::<6, STORE>(block),
            7 => self.run_order::<7, STORE>(block),
            _ => self.run_any(block),
        }
    }

    fn run_order<const Q: usize, const STORE: bool>(&mut self, block: &mut [f64]) -> Sums {
        let mut theta = [0.0; Q];
        let mut history = [0.0; Q];
        theta.copy_from_slice(&self.theta);
        history.copy_from_slice(&self.history);
        let sums = match <&mut [f64; BLOCK]>::try_from(&mut *block) {
            Ok(full) if self.piece_response.len() == Q * Q => {
                lanes::<Q, STORE>(&theta, &mut history, &self.piece_response, full)
            }
            _ => scalar(&theta, &mut history, block),
        };
        self.history.copy_from_slice(&history);
        sums
    }

    fn run_any(&mut self, block: &mut [f64]) -> Sums {
        let mut sums = Sums::default();
        for slot in block {
            let carried: f64 = self
                .theta
                .iter()
                .zip(&self.history)
                .map(|(t, h)| t * h)
                .sum();
            let a = *slot + carried;
            self.history.rotate_right(1);
            self.history[0] = a;
            sums.sum += a;
            sums.squares += a * a;
            *slot = a;
        }
        sums
    }
}

fn plain_sums(values: &[f64]) -> Sums {
    // Two passes over what lies in the first cache: in one, the compiler pairs the two sums up and
    // shuffles more than it adds.
    let mut sum = [0.0; LANES];
    let chunks = values.chunks_exact(LANES);
    let rest: f64 = chunks.remainder().iter().sum();
    for chunk in chunks {
        for l in 0..LANES {
            sum[l] += chunk[l];
        }
    }
    Sums {
        sum: sum.iter().sum::<f64>() + rest,
        squares: dot(values, values),
    }
}

#[inline(always)]
fn step<const Q: usize>(theta: &[f64; Q], history: &mut [f64; Q], u: f64) -> f64 {
    // Oldest first: only the last product waits for the newest output.
    let mut a = u;
    for j in (0..Q).rev() {
        a += theta[j] * history[j];
    }
    for j in (1..Q).rev() {
        history[j] = history[j - 1];
    }
    history[0] = a;
    a
}

fn scalar<const Q: usize>(theta: &[f64; Q], history: &mut [f64; Q], block: &mut [f64]) -> Sums {
    let mut sums = Sums::default();
    for slot in block {
        let a = step(theta, history, *slot);
        sums.sum += a;
        sums.squares += a * a;
        *slot = a;
    }
    sums
}

/// One time step of all lanes.
#[inline(always)]
fn step_lanes<const Q: usize>(
    theta: &[f64; Q],
    history: &mut [[f64; LANES]; Q],
    u: &[f64; LANES],
) -> [f64; LANES] {
    let mut a = *u;
    for j in (0..Q).rev() {
        for l in 0..LANES {
            a[l] += theta[j] * history[j][l];
        }
    }
    for j in (1..Q).rev() {
        history[j] = history[j - 1];
    }
    history[0] = a;
    a
}

fn lanes<const Q: usize, const STORE: bool>(
    theta: &[f64; Q],
    history: &mut [f64; Q],
    piece_response: &[f64],
    block: &mut [f64; BLOCK],
) -> Sums {
    // Samples of the same place in every piece side by side.
    let mut turned = [[0.0; LANES]; PIECE];
    let mut from_zero = [[0.0; LANES]; Q];
    for (k, row) in turned.iter_mut().enumerate() {
        for l in 0..LANES {
            row[l] = block[l * PIECE + k];
        }
        step_lanes(theta, &mut from_zero, row);
    }
    let mut lanes_history = [[0.0; LANES]; Q];
    for l in 0..LANES {
        for j in 0..Q {
            lanes_history[j][l] = history[j];
        }
        let start = *history;
        for i in 0..Q {
            let mut end = from_zero[i][l];
            for j in 0..Q {
                end += piece_response[i * Q + j] * start[j];
            }
            history[i] = end;
        }
    }
    for row in &mut turned {
        *row = step_lanes(theta, &mut lanes_history, row);
    }
    if STORE {
        for k in 0..PIECE {
            for l in 0..LANES {
                block[l * PIECE + k] = turned[k][l];
            }
        }
    }
    plain_sums(turned.as_flattened())
}

/// `u_t = (x_t − c) − φ1 (x_{t−1} − c) − … − φp (x_{t−p} − c)` for t from `start`, as many as `u`
/// holds. Samples before the record count as c.
pub(super) fn autoregress(phi: &[f64], samples: &[f64], centre: f64, start: usize, u: &mut [f64]) {
    let p = phi.len();
    let end = start + u.len();
    let mut k = 0;
    while start + k < end && start + k < p {
        let t = start + k;
        let past: f64 = (1..=t)
            .map(|i| phi[i - 1] * (samples[t - i] - centre))
            .sum();
        u[k] = samples[t] - centre - past;
        k += 1;
    }
    if start + k == end {
        return;
    }
    let shift = centre * (1.0 - phi.iter().sum::<f64>());
    let window = &samples[start + k - p..end];
    let u = &mut u[k..];
    match p {
        0 => fixed_order::<0>(phi, window, shift, u),
        1 => fixed_order::<1>(phi, window, shift, u),
        2 => fixed_order::<2>(phi, window, shift, u),
        3 => fixed_order::<3>(phi, window, shift, u),
        4 => fixed_order::<4>(phi, window, shift, u),
        5 => fixed_order::<5>(phi, window, shift, u),
        6 => fixed_order::<6>(phi, window, shift, u),
        _ => {
            for (k, slot) in u.iter_mut().enumerate() {
                let past: f64 = (1..=p).map(|i| phi[i - 1] * window[k + p - i]).sum();
                *slot = window[k + p] - shift - past;
            }
        }
    }
}

fn fixed_order<const P: usize>(phi: &[f64], window: &[f64], shift: f64, u: &mut [f64]) {
    let n = u.len();
    let mut coefficient = [0.0; P];
    coefficient.copy_from_slice(&phi[..P]);
    let now = &window[P..P + n];
    let past: [&[f64]; P] = core::array::from_fn(|i| &window[P - 1 - i..P - 1 - i + n]);
    for k in 0..n {
        let mut value = now[k] - shift;
        for i in 0..P {
            value -= coefficient[i] * past[i][k];
        }
        u[k] = value;
    }
}

/// Sum of products in eight parallel partial sums.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; LANES];
    let (left, right) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest: f64 = left
        .remainder()
        .iter()
        .zip(right.remainder())
        .map(|(x, y)| x * y)
        .sum();
    for (x, y) in left.zip(right) {
        for l in 0..LANES {
            sums[l] += x[l] * y[l];
        }
    }
    sums.iter().sum::<f64>() + rest
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

    #[test]
    fn lanes_are_the_plain_recursion() {
        for theta in [
            &[0.9999][..],
            &[-0.7],
            &[1.2, -0.5],
            &[0.3, -0.2, 0.8],
            &[0.1, 0.2, 0.1, -0.3, 0.2, 0.1, 0.05],
            &[0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -0.4],
        ] {
            let n = 3 * BLOCK + 77;
            let u = noise(n);
            let mut plain = vec![0.0; n];
            for t in 0..n {
                let past: f64 = (1..=theta.len().min(t))
                    .map(|j| theta[j - 1] * plain[t - j])
                    .sum();
                plain[t] = u[t] + past;
            }
            let mut ours = u.clone();
            let mut recursion = Recursion::new(theta, n);
            let mut sums_only = recursion.clone();
            let (mut sums, mut again) = (Sums::default(), Sums::default());
            for block in ours.chunks_mut(BLOCK) {
                let part = sums_only.run_sums(&mut block.to_vec());
                again.sum += part.sum;
                again.squares += part.squares;
                let part = recursion.run(block);
                sums.sum += part.sum;
                sums.squares += part.squares;
            }
            // Rounding of a recursion with gain at most 1e4 over 3e3 samples.
            for (a, b) in ours.iter().zip(&plain) {
                assert!((a - b).abs() < 1e-11, "{a} {b} {theta:?}");
            }
            let squares: f64 = plain.iter().map(|a| a * a).sum();
            let sum: f64 = plain.iter().sum();
            assert!((sums.squares - squares).abs() < 1e-11 * squares);
            assert!((sums.sum - sum).abs() < 1e-10 * squares.sqrt() * (n as f64).sqrt());
            assert_eq!(sums, again);
        }
    }

    #[test]
    fn autoregression_counts_the_past_as_the_centre() {
        let x = noise(40);
        for p in 0..9 {
            let phi: Vec<f64> = (0..p).map(|i| 0.3 - 0.1 * i as f64).collect();
            let mut u = vec![0.0; 40];
            autoregress(&phi, &x, 0.2, 0, &mut u[..13]);
            autoregress(&phi, &x, 0.2, 13, &mut u[13..]);
            for t in 0..40 {
                let past: f64 = (1..=p.min(t)).map(|i| phi[i - 1] * (x[t - i] - 0.2)).sum();
                assert!((u[t] - (x[t] - 0.2 - past)).abs() < 1e-14);
            }
        }
    }
}
