//! Steps, a warm-up and slow cycles of the level of a record, beside its noise.
//!
//! Any of them looks like a random walk, and a random walk like any of them. So each is a regressor of generalised least
//! squares under white noise with a random walk or a Gauss-Markov process. Shapes are added under each such noise by itself; of all noises
//! with their shapes the likeliest counts, each shape at its price. (One shape at a time, the noise fitted again, would not see two steps up and down:
//! beside the second the first is a walk.) Steps at all places take one backward recursion (de Jong & Penzer 1998,
//! "Diagnosing shocks in time series", JASA 93).
//!
//! Cost: O(noises × shapes × averages), at most 360 averages whatever the record's length.

mod noise;
mod search;
mod shape;

pub use shape::{Disturbance, Shape};

use noise::Noise;
use search::Search;

/// Averages of a record, at most, and the fewest that are looked at.
const MOST: usize = 360;
const FEWEST: usize = 60;
/// Time constants of a warm-up and periods of a cycle, as shares of the record.
const WARM_UPS: [f64; 8] = [
    1.0 / 120.0,
    1.0 / 60.0,
    1.0 / 30.0,
    1.0 / 16.0,
    0.125,
    0.25,
    0.5,
    1.0,
];
const CYCLES: [f64; 7] = [0.75, 0.5, 0.4, 1.0 / 3.0, 0.25, 0.2, 1.0 / 6.0];
/// Correlation times of the noise, as shares of the record; infinite of a random walk.
const MEMORIES: [f64; 4] = [f64::INFINITY, 1.0 / 3.0, 0.1, 1.0 / 30.0];
/// Variances of an average's share of the slow noise's drive over that of its white noise: ten to these quarters, and 0.
const DRIVES: std::ops::Range<i32> = -24..9;
/// Averages of `width` values each, NaN where half of them or more are missing.
fn averages(series: &[f64], width: usize) -> Vec<f64> {
    let average = |block: &[f64]| {
        let (sum, count) = block
            .iter()
            .filter(|x| !x.is_nan())
            .fold((0.0, 0), |(sum, n), x| (sum + x, n + 1));
        match 2 * count > width {
            true => sum / count as f64,
            false => f64::NAN,
        }
    };
    series.chunks_exact(width).map(average).collect()
}

/// The disturbances of a level whose means are taken at even intervals, NaN where one is missing, beside what goes with each of
/// `known`: finite, of one value a mean. Empty for fewer than 60 means, or where there are so many disturbances that they are noise.
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::{screening::{Shape, disturbances}, synthesis::NoiseGenerator};
/// let mut means: Vec<f64> = NoiseGenerator::new(&ShapingFilter::white(1.0, 1.0)?, 1).take(200).collect();
/// assert!(disturbances(&means, &[]).is_empty());
/// means[120..].iter_mut().for_each(|mean| *mean += 10.0);
/// let found = disturbances(&means, &[]);
/// let Shape::Step { from, to } = found[0].shape else { panic!("{found:?}") };
/// assert!(from <= 120 && 120 <= to && (found[0].coefficients[0] - 10.0).abs() < 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn disturbances(means: &[f64], known: &[Vec<f64>]) -> Vec<Disturbance> {
    let width = means.len().div_ceil(MOST).max(1);
    let series = averages(means, width);
    let count = series.len();
    let present: Vec<bool> = series.iter().map(|x| x.is_finite()).collect();
    let there = present.iter().filter(|is_there| **is_there).count();
    let varies = series.windows(2).any(|pair| pair[1] != pair[0]);
    if there < FEWEST || !varies {
        return Vec::new();
    }
    let noises = MEMORIES.iter().flat_map(|share| {
        // A walk of no drive is white noise; the walks' drives are twice as close as those of processes, which have a memory besides.
        let is_walk = share.is_infinite();
        let none = is_walk.then_some(0.0);
        let drives = DRIVES.step_by(if is_walk { 1 } else { 2 });
        let drives = drives.map(|quarters| 10f64.powf(0.25 * f64::from(quarters)));
        let memory = share * count as f64;
        let present = &present;
        let noise = move |drive| Noise::new(drive, memory, present);
        none.into_iter().chain(drives).map(noise)
    });
    let of_record = |share: &f64| share * count as f64;
    let warm_ups = WARM_UPS.iter().map(of_record).map(Shape::WarmUp);
    let cycles = CYCLES.iter().map(of_record).map(Shape::Cycle);
    let level = std::iter::once(vec![1.0; count]);
    let known = level.chain(known.iter().map(|known| averages(known, width)));
    let search = Search {
        averages: &series,
        present: there as f64,
        known: &Vec::from_iter(known),
        noises: noises.collect(),
        tried: warm_ups.chain(cycles).collect(),
    };
    let found = search.shapes();
    let shapes = Vec::from_iter(found.iter().map(|(shape, _)| *shape));
    let mut coefficients = search.coefficients(&shapes).into_iter();
    let found = found.into_iter().map(|(shape, fall)| {
        let mut next = || coefficients.next().unwrap_or(0.0);
        let coefficients = match shape {
            Shape::Cycle(_) => [next(), next()],
            Shape::Step { .. } | Shape::WarmUp(_) => [next(), 0.0],
        };
        Disturbance {
            shape: shape.in_values(width),
            coefficients,
            fall,
        }
    });
    found.collect()
}

#[cfg(test)]
mod tests;
