//! The slow process of a simulator, which draws one Gauss-Markov process and at most a random walk beside it: those whose Allan deviation is
//! nearest to that of the model over the times that a simulation is of.
//!
//! The process whose filter drifts least over an outage ([`super::outage`]) is another: it is right at one time, and a walk grows beyond.

use crate::allan::gauss_markov::gauss_markov_variance;
use crate::bias_model::Slow;
use crate::composite::GaussMarkov;
use crate::quasi_newton::{Objective, best_of};
use crate::terms::SCALES;

/// Averaging times that are compared \[s\].
pub(super) const TIMES_S: [f64; 2] = [0.1, 1000.0];
/// Of them so many, evenly by their logarithms.
const COUNT: i32 = 41;
/// A ratio of variances this far off, by its logarithm, costs 1; farther ones with the fourth power, so that the worst counts most.
const UNIT: f64 = 0.1;
/// Correlation times that a search starts from \[s\].
const STARTS_S: [f64; 3] = [3.0, 30.0, 300.0];

/// The averaging times \[s\].
fn times() -> impl Iterator<Item = f64> {
    let [first, last] = TIMES_S;
    let step = (last / first).ln() / f64::from(COUNT - 1);
    (0..COUNT).map(move |k| first * (step * f64::from(k)).exp())
}

/// Allan variance \[unit²\] of white noise [unit·√s] and a bias at an averaging time \[s\].
fn variance(white: f64, slow: &Slow, time_s: f64) -> f64 {
    let walk = slow.walk.unwrap_or(0.0);
    let of = |one: &GaussMarkov| gauss_markov_variance(time_s, one.sigma, one.tau_s);
    let processes: f64 = slow.processes.iter().map(of).sum();
    white * white / time_s + walk * walk * time_s / 3.0 + processes
}

/// How far the Allan deviations of two biases beside the same white noise are apart at most, as a factor.
pub(super) fn factor(white: f64, one: &Slow, other: &Slow) -> f64 {
    let apart = times().map(|t| (variance(white, one, t) / variance(white, other, t)).ln());
    (0.5 * apart.map(f64::abs).fold(0.0, f64::max)).exp()
}

/// The process, of a correlation time \[s\] where that is given, with a walk where the simulator has one, that is nearest to a bias of several
/// terms beside white noise [unit·√s]. `None` of no bias.
pub(super) fn nearest(
    white: f64,
    slow: &Slow,
    with_walk: bool,
    tau_s: Option<f64>,
) -> Option<Slow> {
    let targets = Vec::from_iter(times().map(|t| (t, variance(white, slow, t))));
    let bias = |z: &[f64]| Slow {
        processes: vec![GaussMarkov {
            sigma: z[0].exp(),
            tau_s: tau_s.unwrap_or_else(|| z[z.len() - 1].exp()),
        }],
        walk: with_walk.then(|| z[1].exp()),
    };
    let cost = |z: &Vec<f64>| -> f64 {
        let bias = bias(z);
        let off = targets
            .iter()
            .map(|(t, target)| (variance(white, &bias, *t) / target).ln() / UNIT);
        off.map(|off| off.powi(4)).sum()
    };
    let all = slow.processes.iter().map(|one| one.sigma * one.sigma);
    let sigma = all.sum::<f64>().sqrt();
    let starts = STARTS_S.map(|start_s| {
        let drive = slow.drive();
        // Of a walk alone what it is at the start's time.
        let sigma = sigma.max(drive * start_s.sqrt());
        let mut z = vec![sigma.ln()];
        z.extend(with_walk.then(|| (0.3 * drive).ln()));
        z.extend(tau_s.is_none().then(|| start_s.ln()));
        z
    });
    let costs = |z: &[Vec<f64>]| z.iter().map(cost).collect();
    let mut objective = Objective::new(&costs, SCALES);
    let best = best_of(&mut objective, starts.to_vec(), 3, 1e-6, 200)?;
    Some(bias(&best.z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terms::CompositeTerms;

    fn flicker(b: f64) -> Slow {
        let terms = CompositeTerms {
            flicker: b,
            ..CompositeTerms::default()
        };
        let (processes, walk) = terms.slow();
        Slow {
            processes,
            walk: Some(walk),
        }
    }

    /// The least largest factors that scipy's Nelder-Mead finds for B of 0.3 N with N free are 1.061 and 1.125; N is held here, and the fourth
    /// power is not quite the largest.
    #[test]
    fn flicker_noise_is_a_process_and_a_walk_within_a_tenth() {
        let slow = flicker(0.3);
        for (with_walk, most) in [(true, 1.09), (false, 1.20)] {
            let found = nearest(1.0, &slow, with_walk, None).unwrap();
            let apart = factor(1.0, &found, &slow);
            assert!(apart > 1.05 && apart < most, "{apart} {found:?}");
            assert_eq!(found.walk.is_some(), with_walk);
        }
    }

    #[test]
    fn what_a_simulator_has_is_found_again() {
        let slow = Slow {
            processes: vec![GaussMarkov {
                sigma: 0.4,
                tau_s: 70.0,
            }],
            walk: Some(0.02),
        };
        assert_eq!(factor(1.0, &slow, &slow), 1.0);
        let found = nearest(1.0, &slow, true, None).unwrap();
        assert!(factor(1.0, &found, &slow) < 1.01, "{found:?}");
        // With another correlation time the walk makes up for it.
        let found = nearest(1.0, &slow, true, Some(50.0)).unwrap();
        assert_eq!(found.processes[0].tau_s, 50.0);
        assert!(factor(1.0, &found, &slow) < 1.1, "{found:?}");
        // A tenth and a thousand seconds: white noise at the one, at the other the walk and the process.
        let ends = TIMES_S.map(|t| variance(1.0, &slow, t));
        let exact = 1e-3 + 0.4 / 3.0 + 0.16 * 0.14 * (1.0 - 3.0 * 0.035);
        assert!((ends[0] / 10.0 - 1.0).abs() < 0.01 && (ends[1] / exact - 1.0).abs() < 1e-3);
    }
}
