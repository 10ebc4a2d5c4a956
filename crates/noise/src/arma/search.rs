//! The search for the global optimum: many starts, thinned out in rounds, the best ones finished.
//!
//! The likelihood of an ARMA has many local optima, and the one that matters, a slow bias under white noise, is
//! narrow. So:
//!
//! 1. **Starts.** White noise, coefficients that the caller knows and those of Hannan and Rissanen are in every search.
//!    The optima of ARMA(p−1, q−1) come with a real pair of roots laid over, slow ones and a grid; those of
//!    ARMA(p−2, q−2) with a complex pair at a grid of frequencies.
//! 2. **Screening.** Where the record is long enough, all starts are searched by Whittle's likelihood
//!    ([`super::whittle`]), whose price does not depend on the length. What it finds is put to the exact likelihood.
//! 3. **Rounds.** A few iterations each, then only the best go on: what is 30 behind in log-likelihood at first, or 5
//!    after some iterations, does not come back.
//! 4. **The end.** The best is finished to 1e-5 in log-likelihood; where BFGS has stuck, Nelder-Mead shakes it loose.
//!    Optima at which the Kalman filter does not find the same likelihood are rounding and are dropped.
//!
//! Orders are climbed from below ([`Ladder`]): a model is inside the next larger one, so that its likelihood
//! can only rise.
//!
//! Effort is a factor on the number of likelihood evaluations (1 for a careful fit); the search is
//! deterministic, its random starts have a fixed seed. That it finds the global optimum is not
//! proven; [`crate::arma::ArmaFit::local_optima`] reports how many optima it met.
//!
//! What a search costs: up to some 30 000 evaluations of Whittle's likelihood, a few hundred bins
//! each whatever N, and the exact one at its optima, O(N (p + q)) an evaluation.

mod problem;

pub(super) use problem::Problem;

use super::ArmaError;
use super::optimise::{SCALES, nelder_mead};
use super::starts;
use super::whittle::Whittle;
use crate::quasi_newton::{Objective, Point, bfgs};

/// Decrease of the negative log-likelihood still to be expected where a search stops.
pub(super) const TOLERANCE: f64 = 1e-5;
/// Optima this close in log-likelihood count as the same one.
const SAME: f64 = 1e-4;
/// An optimum of the approximate likelihood so far below the best does not become the best.
const HOPELESS: f64 = 30.0;
/// [`HOPELESS`] after a few steps by the exact likelihood.
const NEAR: f64 = 5.0;
/// Local optima handed to the next order.
const KEPT: usize = 4;
/// Samples of a long record on which starts of short memory are ranked.
const GLANCE: usize = 25_000;

/// Local optima by order, so that a higher order builds on what was found below it.
///
/// A ladder belongs to one record (or one set of records) and one treatment of mean and unit root;
/// it must not be reused for another, since its optima are starts whose values are compared.
#[derive(Default)]
pub(crate) struct Ladder {
    /// Order (p, q) with its optima, best first.
    rungs: Vec<((usize, usize), Vec<Point>)>,
    /// Approximate likelihood of the record, once it is there.
    whittle: Option<Option<Whittle>>,
}

impl Ladder {
    /// Optima of an order that has been searched.
    fn at(&self, p: usize, q: usize) -> Option<&[Point]> {
        let rung = self.rungs.iter().find(|(order, _)| *order == (p, q));
        rung.map(|(_, points)| points.as_slice())
    }

    /// The best value found at ARMA(p−1, q−1), if there is that order.
    ///
    /// Negative log-likelihood. With it goes the likelihood ratio of one pair of roots.
    pub(super) fn below(&self, p: usize, q: usize) -> Option<f64> {
        let points = self.at(p.checked_sub(1)?, q.checked_sub(1)?)?;
        points.first().map(|point| point.value)
    }

    /// The best distinct local optima of ARMA(p, q), best first: every order (p−k, q−k) is searched
    /// from the optima of the one and the two below it. `known` are further starts.
    ///
    /// Orders that were searched before are not searched again unless there are new starts.
    ///
    /// # Errors
    /// [`ArmaError::NoOptimum`] where no start of some order has a finite likelihood.
    pub(super) fn climb(
        &mut self,
        problem: &Problem,
        p: usize,
        q: usize,
        effort: f64,
        known: &[Vec<f64>],
    ) -> Result<&[Point], ArmaError> {
        let whittle = self
            .whittle
            .take()
            .unwrap_or_else(|| Whittle::new(problem.samples, problem.centre, problem.unit_root));
        let climbed = self.climb_all(problem, (p, q), effort, known, whittle.as_ref());
        self.whittle = Some(whittle);
        climbed?;
        self.at(p, q).ok_or(ArmaError::NoOptimum)
    }

    /// Searches the orders (p − k, q − k) from the lowest up, each from the optima of those below it, where it has none yet.
    fn climb_all(
        &mut self,
        problem: &Problem,
        (p, q): (usize, usize),
        effort: f64,
        known: &[Vec<f64>],
        whittle: Option<&Whittle>,
    ) -> Result<(), ArmaError> {
        let lowest = p.min(q);
        for down in (0..=lowest).rev() {
            let (p, q) = (p - down, q - down);
            if self.at(p, q).is_some() && (down > 0 || known.is_empty()) {
                continue;
            }
            let by = |pairs| Some((p.checked_sub(pairs)?, q.checked_sub(pairs)?));
            let one = by(1).and_then(|(p, q)| self.at(p, q));
            let two = by(2).and_then(|(p, q)| self.at(p, q));
            let starts = if down == 0 { known } else { &[] };
            let found = optima(
                problem,
                (p, q),
                effort,
                starts,
                one.unwrap_or_default(),
                two.unwrap_or_default(),
                whittle,
            )?;
            self.rungs.retain(|(order, _)| *order != (p, q));
            self.rungs.push(((p, q), found));
        }
        Ok(())
    }
}

/// The best distinct optima of one order: from all starts by the approximate likelihood where there is one, else by the exact one.
///
/// Best first, at most eight; `known` are starts in search coordinates.
/// # Errors
/// [`ArmaError::NoOptimum`] where no start has a finite likelihood.
///
/// A best optimum of a higher cost than that of ARMA(p−1, q−1) is marked as not converged: the
/// smaller model is inside the larger one, so the search has missed something.
fn optima(
    problem: &Problem,
    (p, q): (usize, usize),
    effort: f64,
    known: &[Vec<f64>],
    one_below: &[Point],
    two_below: &[Point],
    whittle: Option<&Whittle>,
) -> Result<Vec<Point>, ArmaError> {
    let function = |z: &[Vec<f64>]| problem.objective(z, p);
    let gradient = |z: &[f64]| problem.gradient_bridged(z, p);
    let mut objective = Objective::new(&function, SCALES).with_gradient(&gradient);
    let dimension = p + q;
    let budget = problem.budget(dimension, effort);
    let mut candidates: Vec<Vec<f64>> = vec![vec![0.0; dimension]];
    candidates.extend(known.iter().filter(|z| z.len() == dimension).cloned());
    if dimension > 0 {
        candidates.extend(starts::hannan_rissanen(
            problem.samples,
            problem.centre,
            p,
            q,
        ));
    }
    let privileged = candidates.len();
    real_starts(problem, one_below, (p, q), &mut candidates);
    let mut lines = Vec::new();
    line_starts(problem.samples.len(), two_below, p, &mut lines);
    let found =
        match whittle.filter(|_| dimension > 0) {
            Some(whittle) => {
                candidates.extend(lines);
                let mut narrow = Vec::new();
                for optimum in two_below.iter().take(1) {
                    let (phi, theta) = Problem::plain(&optimum.z, p - 2);
                    narrow.extend(whittle.narrow(&phi, &theta).iter().map(|n| {
                        starts::with_complex_pair(&optimum.z, p - 2, n.omega, n.ar, n.ma)
                    }));
                }
                let approximate = |z: &[Vec<f64>]| {
                    let points: Vec<_> = z.iter().map(|z| Problem::plain(z, p)).collect();
                    whittle.objective(&points)
                };
                let slope = |z: &[f64]| {
                    let (phi, theta) = Problem::plain(z, p);
                    let (by_phi, by_theta) = whittle.gradient(&phi, &theta);
                    Problem::by_search(z, &by_phi, &by_theta)
                };
                let mut approximate = Objective::new(&approximate, SCALES).with_gradient(&slope);
                let budget = Problem::screening_budget(dimension, effort);
                screened(
                    &mut objective,
                    &mut approximate,
                    candidates,
                    privileged,
                    narrow,
                    (budget, effort),
                )
            }
            None => {
                candidates.extend(glance(problem, lines, p, budget));
                rounds(&mut objective, candidates, privileged, budget, dimension)
            }
        };
    let mut found = distinct(found);
    let confirmed: Vec<bool> = found
        .iter()
        .map(|point| problem.is_confirmed(&point.z, p))
        .collect();
    if confirmed.contains(&true) {
        let mut confirmed = confirmed.into_iter();
        found.retain(|_| confirmed.next() == Some(true));
    }
    // A model one pair smaller is inside this one: nothing may end below it.
    let lower = one_below.first().map_or(f64::INFINITY, |l| l.value);
    let best = found.first_mut().ok_or(ArmaError::NoOptimum)?;
    best.converged &= best.value < lower + 1e-3;
    found.truncate(2 * KEPT);
    Ok(found)
}

/// The lower optima with a real AR and a real MA root laid over.
///
/// A pair (α, μ) of nearly cancelling roots is laid over a lower optimum at no loss of likelihood,
/// which is the direction in which the likelihood of the larger model rises. Slow pairs come from
/// block averages ([`starts::slow_bias`]) and from a grid.
fn real_starts(
    problem: &Problem,
    lower: &[Point],
    (p, q): (usize, usize),
    candidates: &mut Vec<Vec<f64>>,
) {
    let n = problem.samples.len();
    let slow = if lower.is_empty() {
        Vec::new()
    } else {
        starts::slow_bias(problem.samples, problem.centre)
    };
    for (k, optimum) in lower.iter().take(KEPT).enumerate() {
        // The fine grid for the lowest order; the slow pairs are what must not be missed.
        let per_decade = match k {
            0 if p == 1 && q == 1 => 2.0,
            0 => 1.0,
            _ => 0.7,
        };
        let grid = starts::real_pairs(n, per_decade);
        for (alpha, mu) in slow.iter().chain(&grid) {
            candidates.push(starts::with_real_pair(&optimum.z, p - 1, *alpha, *mu));
        }
    }
}

/// The optima two orders below with a complex pair of AR and one of MA roots laid over.
///
/// A pair of complex roots makes a resonance (AR radius above the MA radius) or a notch (below). 20
/// or 60 frequencies between 0 and π rad/sample, five pairs of radii each.
fn line_starts(n: usize, lower: &[Point], p: usize, candidates: &mut Vec<Vec<f64>>) {
    const RADII: [(f64, f64); 5] = [
        (0.9, 0.98),
        (0.98, 0.9),
        (0.94, 0.96),
        (0.96, 0.94),
        (0.7, 0.4),
    ];
    // A longer record resolves narrower lines.
    let frequencies = if n < 1000 { 20 } else { 60 };
    for optimum in lower.iter().take(KEPT) {
        for k in 0..frequencies {
            let omega = core::f64::consts::PI * (k as f64 + 0.5) / frequencies as f64;
            for (ar, ma) in RADII {
                candidates.push(starts::with_complex_pair(&optimum.z, p - 2, omega, ar, ma));
            }
        }
    }
}

/// The candidates that are best on the first part of a long record; all of them for a short one.
///
/// A resonance shows in [`GLANCE`] samples as well as in all, at a fraction of the cost of an
/// evaluation.
fn glance(problem: &Problem, candidates: Vec<Vec<f64>>, p: usize, budget: f64) -> Vec<Vec<f64>> {
    if problem.samples.len() <= 2 * GLANCE {
        return candidates;
    }
    let part = Problem {
        samples: &problem.samples[..GLANCE],
        rest: &[],
        ..*problem
    };
    let function = |z: &[Vec<f64>]| part.objective(z, p);
    let mut objective = Objective::new(&function, SCALES);
    let mut points = distinct(objective.points(candidates));
    points.truncate((budget / 20.0) as usize);
    points.into_iter().map(|point| point.z).collect()
}

/// The search over all starts by the approximate likelihood; the exact one from its optima.
///
/// The first `privileged` candidates (white noise, known coefficients, Hannan-Rissanen) and the
/// `narrow` ones are always put to the exact likelihood; the others only if Whittle's likelihood
/// keeps them.
fn screened(
    objective: &mut Objective,
    approximate: &mut Objective,
    candidates: Vec<Vec<f64>>,
    privileged: usize,
    narrow: Vec<Vec<f64>>,
    (budget, effort): (f64, f64),
) -> Vec<Point> {
    let dimension = candidates[0].len();
    let mut starts = candidates[..privileged].to_vec();
    starts.extend(narrow);
    let mut starts = objective.points(starts);
    let mut seen = rounds(approximate, candidates, privileged, budget, dimension);
    let values = seen.iter().map(|point| point.z.clone()).collect();
    for (point, exact) in seen.iter_mut().zip(objective.points(values)) {
        point.value = exact.value;
    }
    starts.extend(seen);
    starts = distinct(starts);
    let keep = match effort {
        ..0.25 => KEPT / 2,
        ..1.0 => KEPT,
        _ => 2 * KEPT,
    };
    // What a few steps bring nowhere near the best is not finished.
    for (iterations, behind) in [(4, HOPELESS), (60, NEAR)] {
        let best = starts.first().map_or(f64::INFINITY, |best| best.value);
        starts.retain(|start| start.value < best + behind);
        starts.truncate(keep);
        let searched = starts
            .iter()
            .map(|start| bfgs(objective, start, 1e-3, iterations));
        starts = distinct(searched.collect());
    }
    if let Some(best) = starts.first_mut() {
        let end = bfgs(objective, best, TOLERANCE, 200);
        if end.value <= best.value {
            *best = end;
        }
        if effort >= 1.0 {
            polish(objective, best, dimension);
        }
    }
    starts
}

/// Short searches from many starts; the best quarter goes on, longer; the last few to the end.
/// The first `privileged` candidates are in the first round whatever their value.
///
/// Successive halving, by quarters: 6 iterations of BFGS for all, then four times as many for the
/// best quarter, until a few are left, which are finished to [`TOLERANCE`].
fn rounds(
    objective: &mut Objective,
    candidates: Vec<Vec<f64>>,
    privileged: usize,
    budget: f64,
    dimension: usize,
) -> Vec<Point> {
    let per_iteration = dimension as f64 + 2.0;
    let places = ((budget / (20.0 * per_iteration)) as usize).clamp(6, 600);
    let last = if places < 20 { 2 } else { 2 * KEPT };
    let mut points = objective.points(candidates);
    let mut ranked = distinct(points.split_off(privileged));
    let random = if dimension == 0 {
        0
    } else if dimension > 2 {
        (places / 3).min(40 * dimension)
    } else {
        (places / 8).min(8)
    };
    ranked.truncate(places.saturating_sub(points.len() + random));
    points.extend(ranked);
    points.extend(objective.points(starts::random_points(dimension, random)));
    points = distinct(points);
    let mut iterations = 6;
    while points.len() > last {
        let searched = points
            .iter()
            .map(|start| bfgs(objective, start, 1e-3, iterations));
        let searched = searched.collect();
        points = distinct(searched);
        points.truncate((points.len().div_ceil(4)).max(last));
        iterations *= 4;
        if iterations > 100 {
            points.truncate(last);
        }
    }
    let finished = points
        .iter()
        .map(|start| bfgs(objective, start, TOLERANCE, 200));
    let finished = finished.collect();
    points = distinct(finished);
    if let Some(best) = points.first_mut() {
        polish(objective, best, dimension);
    }
    points
}

/// Nelder-Mead around the best point where BFGS has stuck, then BFGS again, as long as that helps.
///
/// At most three rounds; ends as soon as a search has converged, or gains less than [`TOLERANCE`].
fn polish(objective: &mut Objective, best: &mut Point, dimension: usize) {
    for _ in 0..3 {
        if best.converged {
            return;
        }
        let before = best.value;
        let moved = nelder_mead(objective, best, 0.1, 1e-6, 60 * dimension);
        let again = bfgs(objective, &moved, TOLERANCE, 100);
        if again.value <= best.value {
            *best = again;
        }
        // On the flat edge of the invertible region nothing is left to gain.
        best.converged |= before - best.value < TOLERANCE;
    }
}

/// Best first, one of each value.
///
/// Two points are the same optimum where their values differ by less than 1e-4: roots that change places give
/// the same model.
fn distinct(mut points: Vec<Point>) -> Vec<Point> {
    points.retain(|point| point.value.is_finite());
    points.sort_by(|a, b| a.value.total_cmp(&b.value));
    points.dedup_by(|b, a| b.value - a.value < SAME);
    points
}

#[cfg(test)]
mod tests;
