//! Innovations as a noise would make them: what they scatter by is what its likelihood's slope scatters by.

use super::Objective;
use crate::{
    filter::{Fixed, State},
    noise::{self, Noise},
    steps::{LinearSegment, MOST},
};
use undrift_nav::shaping::ShapingFilter;
use undrift_noise::synthesis::NoiseGenerator;

/// Innovations of the updates of each segment.
pub type Innovations = Vec<Vec<[f64; MOST]>>;

/// Independent normal values of variance one, the same each time.
pub fn normal() -> NoiseGenerator {
    let white = ShapingFilter::white(1.0, 1.0).expect("white noise of one");
    NoiseGenerator::new(&white, 1)
}

/// Lower triangular L with `L Lᵀ` = `p`, zero where that has no variance left.
fn factor<const N: usize>(p: &[[f64; N]; N]) -> [[f64; N]; N] {
    let mut l = [[0.0; N]; N];
    for j in 0..N {
        let left = p[j][j] - (0..j).map(|k| l[j][k] * l[j][k]).sum::<f64>();
        if left <= ROUNDING * p[j][j] {
            continue;
        }
        l[j][j] = left.sqrt();
        for i in j + 1..N {
            let others = (0..j).map(|k| l[i][k] * l[j][k]).sum::<f64>();
            l[i][j] = (p[i][j] - others) / l[j][j];
        }
    }
    l
}

/// What is left of a variance by rounding.
const ROUNDING: f64 = 1e-12;

/// A draw with a covariance, of independent ones.
fn draw<const N: usize>(p: &[[f64; N]; N], one: &mut NoiseGenerator) -> [f64; N] {
    let l = factor(p);
    let mut drawn = [0.0; N];
    for j in (0..N).filter(|j| l[*j][*j] > 0.0) {
        let w = one.sample();
        for i in j..N {
            drawn[i] += l[i][j] * w;
        }
    }
    drawn
}

/// The innovations of a solution whose errors are drawn, from the alignment on.
fn drawn<const N: usize>(
    segment: &LinearSegment<N>,
    noise: &Noise,
    fixed: &Fixed,
    one: &mut NoiseGenerator,
) -> Vec<[f64; MOST]> {
    let mut x = draw(&segment.covariance, one);
    // Of what the fixes soon show, the start says nothing to the slopes.
    for (i, x) in x.iter_mut().enumerate() {
        let lasts = |at: usize| (at..at + 3).contains(&i);
        if !fixed.lasting.into_iter().flatten().any(lasts) {
            *x = 0.0;
        }
    }
    let innovation = |step| {
        let mut state = State {
            x,
            p: [[0.0; N]; N],
        };
        state.predict(step, noise, fixed);
        let entered = draw(&state.p, one);
        let measured = draw(&noise::covariance(step, noise, &fixed.rule), one);
        for (x, entered) in state.x.iter_mut().zip(entered) {
            *x += entered;
        }
        let innovation = std::array::from_fn(|a| {
            let predicted = step.h[a].iter().zip(&state.x).map(|(h, x)| h * x);
            predicted.sum::<f64>() + measured[a]
        });
        state.skip(step);
        x = state.x;
        innovation
    };
    segment.steps.iter().map(innovation).collect()
}

impl<const N: usize> Objective<N> {
    /// Innovations as they would be if errors of the sensors and of the fixes were draws under a noise.
    pub fn drawn(&self, noise: &Noise, one: &mut NoiseGenerator) -> Innovations {
        let of = |segment| drawn(segment, noise, &self.fixed, one);
        self.segments.iter().map(of).collect()
    }

    /// The innovations, in exchange for others.
    pub fn exchange(&mut self, others: &mut Innovations) {
        for (segment, others) in self.segments.iter_mut().zip(others) {
            for (step, other) in segment.steps.iter_mut().zip(others) {
                std::mem::swap(&mut step.innovation, other);
            }
            for (last, sum) in segment.without_fixes.iter_mut().flatten() {
                sum.innovation = segment.steps[*last].innovation;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Also of what has no variance in a direction, or none at all.
    #[test]
    fn a_factor_is_one_of_what_is_not_definite() {
        let rows = [[2.0, 1.0, 0.0], [0.5, 0.25, 0.0], [1.0, 3.0, 0.0]];
        let p: [[f64; 3]; 3] = std::array::from_fn(|i| {
            std::array::from_fn(|j| (0..3).map(|k| rows[i][k] * rows[j][k]).sum())
        });
        let l = factor(&p);
        for i in 0..3 {
            for j in 0..3 {
                let back: f64 = (0..3).map(|k| l[i][k] * l[j][k]).sum();
                assert!((back - p[i][j]).abs() < 1e-9, "{i} {j}: {back} {}", p[i][j]);
                assert!(i >= j || l[i][j] == 0.0);
            }
        }
        assert_eq!(factor(&[[0.0; 2]; 2]), [[0.0; 2]; 2]);
    }
}
