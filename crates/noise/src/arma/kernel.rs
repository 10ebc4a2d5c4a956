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
//!
//! Cost: O(N (p + q)) per point once the start has died out, O(N (p + q + r)) before. The numbers
//! do not depend on the machine's vector width, but fused multiply-add, where there is one, changes
//! the last digits.

mod loops;
mod power;
mod products;
mod run;

use crate::vector::{LANES, Row, total, vectorised};
use loops::{SumsAbout, Turn};
pub(super) use power::PowerSum;
pub(super) use products::products;
use run::{Run, Scratch};

/// Samples of one piece; more than twice the highest order.
const PIECE: usize = 64;
/// Samples of one block.
const BLOCK: usize = LANES * PIECE;
/// Points that share a pass: what they hold stays in the second cache.
const TOGETHER: usize = 32;

/// φ and θ of one point.
///
/// φ1 … φp and θ1 … θq, the signs of docs/theory.md, section 1.
pub(super) type Coefficients = (Vec<f64>, Vec<f64>);

/// Sums over the record, g the impulse response of 1/θ(B), o the recursion over ones, r = max(p, q).
///
/// Units: those with `a` carry \[unit\] for each a, those of g and o none.
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

/// The sums at every point, in one pass over the record. Samples before the record count as
/// `centre`. Those of o are zero unless `with_ones`. All points are of the same order.
///
/// `centre` \[unit\] should be near the mean: sums of squares of a record far from zero lose
/// digits. The record has no gaps. The result has one entry a point, in their order.
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

/// The sums of [`TOGETHER`] points or fewer in one pass over the record.
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

/// Sum of `samples − centre` and of its absolute values.
///
/// One pass gives the mean and whether a sample is missing: a NaN makes both sums NaN.
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
#[cfg(test)]
mod tests;
