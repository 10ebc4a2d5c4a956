//! Steps, a warm-up and slow cycles of the level of a record, beside its noise.
//!
//! Any of them looks like a random walk, and a random walk like any of them. So each is a regressor of generalised least
//! squares under white noise with a random walk or a Gauss-Markov process, whose parameters are fitted with it and without: what is left of its
//! likelihood ratio is what such noise does not explain. Steps at all places take one backward recursion (de Jong & Penzer 1998,
//! "Diagnosing shocks in time series", JASA 93).
//!
//! Cost: O(noises × shapes × averages), at most 360 averages whatever the record's length.

use std::f64::consts::TAU;

/// Fall of −2 ln likelihood that a warm-up or a cycle takes, and a step, which has as many places as there are averages. Of
/// honest random walks, flicker and Gauss-Markov noise fewer than one record in a hundred reaches either.
const ENOUGH: f64 = 25.0;
const ENOUGH_OF_STEP: f64 = 32.0;
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
/// Powers of 2 by which times are varied about the likeliest of them.
const NEARBY: [f64; 2] = [1.0 / 6.0, 1.0 / 36.0];
/// More than this is noise.
const MOST_FOUND: usize = 16;

/// Shape of a disturbance, its times in values of the series.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// The level is another one: before `from` surely the old, from `to` on surely the new.
    Step {
        /// First value that may have the new level.
        from: usize,
        /// First value that has the new level.
        to: usize,
    },
    /// exp(−t/τ) from the first value on, τ in values.
    WarmUp(f64),
    /// A sine of a period in values.
    Cycle(f64),
}

/// A disturbance of a level: a step, a warm-up or a slow cycle.
///
/// ```
/// use undrift_noise::screening::{Disturbance, Shape};
/// let warm_up = Disturbance { shape: Shape::WarmUp(10.0), coefficients: [2.0, 0.0], fall: 100.0 };
/// assert_eq!(warm_up.size(), 2.0);
/// assert!((warm_up.value(10.0) - 2.0 / std::f64::consts::E).abs() < 1e-12); // After one time constant.
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disturbance {
    /// Shape, with its times.
    pub shape: Shape,
    /// Coefficients of the shape \[unit\]: of a step its height, of a warm-up its value at the start, of a cycle the parts of sine and cosine.
    pub coefficients: [f64; 2],
    /// Fall of −2 ln likelihood by it: its evidence.
    pub fall: f64,
}

impl Disturbance {
    /// Height of a step, value of a warm-up at the start, amplitude of a cycle \[unit\].
    pub fn size(&self) -> f64 {
        match self.shape {
            Shape::Cycle(_) => self.coefficients[0].hypot(self.coefficients[1]),
            Shape::Step { .. } | Shape::WarmUp(_) => self.coefficients[0],
        }
    }

    /// Its value \[unit\] at a time in values: 0.5 is amid the first.
    pub fn value(&self, time: f64) -> f64 {
        let parts = self.shape.parts(time);
        parts[0] * self.coefficients[0] + parts[1] * self.coefficients[1]
    }
}

impl Shape {
    /// Values of its two parts at a time, for coefficients of 1.
    fn parts(self, time: f64) -> [f64; 2] {
        match self {
            Self::Step { to, .. } => [f64::from(time > to as f64), 0.0],
            Self::WarmUp(tau) => [(-time / tau).exp(), 0.0],
            Self::Cycle(period) => {
                let (sine, cosine) = (TAU * time / period).sin_cos();
                [sine, cosine]
            }
        }
    }

    /// The shape as regressors of `count` values: two of a cycle, one of others.
    fn columns(self, count: usize) -> Vec<Vec<f64>> {
        let parts = match self {
            Self::Cycle(_) => 2,
            Self::Step { .. } | Self::WarmUp(_) => 1,
        };
        let column = |part: usize| {
            let values = (0..count).map(|k| self.parts(k as f64 + 0.5)[part]);
            values.collect()
        };
        (0..parts).map(column).collect()
    }

    /// Fall of −2 ln likelihood that it takes to be found.
    fn enough(self) -> f64 {
        match self {
            Self::Step { .. } => ENOUGH_OF_STEP,
            Self::WarmUp(_) | Self::Cycle(_) => ENOUGH,
        }
    }

    /// The shape in a series whose values are `width` averages each.
    fn in_values(self, width: usize) -> Self {
        match self {
            Self::Step { to, .. } => Self::Step {
                from: (to - 1) * width,
                to: (to + 1) * width,
            },
            Self::WarmUp(tau) => Self::WarmUp(tau * width as f64),
            Self::Cycle(period) => Self::Cycle(period * width as f64),
        }
    }

    /// Shapes of nearby times, that grow by a factor of 2 to this power; of a cycle by a quarter of it.
    fn nearby(self, power: f64) -> Vec<Self> {
        let times = (-5..=5).map(|k| f64::from(k) * power);
        match self {
            Self::Step { .. } => vec![self],
            Self::WarmUp(tau) => times.map(|k| Self::WarmUp(tau * k.exp2())).collect(),
            Self::Cycle(period) => times
                .map(|k| Self::Cycle(period * (0.25 * k).exp2()))
                .collect(),
        }
    }
}

/// The noise under which averages are looked at: white noise of variance 1 and a slow part.
///
/// The slow part is an AR(1) of averages, a walk where its memory is infinite, with a scalar Kalman filter's
/// gains computed once: they depend on what is missing, not on values.
struct Noise {
    /// Part of the slow noise that is left after an average.
    left: f64,
    /// 1/√F of each innovation, 0 where the average is missing, and the gain.
    weights: Vec<(f64, f64)>,
    log_determinant: f64,
}

impl Noise {
    /// The noise of a drive and a correlation time in averages.
    fn new(drive: f64, memory: f64, present: &[bool]) -> Self {
        let left = (-1.0 / memory).exp();
        // An average of a walk is later than its end by a third of its steps: as much negative white noise.
        let white = 1.0 - drive / 6.0;
        let mut variance = match left < 1.0 {
            true => drive / (1.0 - left * left),
            false => 0.5 * drive,
        };
        let mut log_determinant = 0.0;
        let weights = present.iter().map(|is_present| {
            let (mut weight, mut gain) = (0.0, 0.0);
            if *is_present {
                let innovation = variance + white;
                log_determinant += innovation.ln();
                (weight, gain) = (innovation.sqrt().recip(), left * variance / innovation);
                variance -= variance * variance / innovation;
            }
            variance = left * left * variance + drive;
            (weight, gain)
        });
        Self {
            left,
            weights: weights.collect(),
            log_determinant,
        }
    }

    /// The innovations of a series over their standard deviations.
    ///
    /// 0 where the average is missing.
    fn whitened(&self, series: &[f64]) -> Vec<f64> {
        let mut state = 0.0;
        let whitened_value = |(value, &(weight, gain)): (&f64, &(f64, f64))| {
            let error = if weight > 0.0 { value - state } else { 0.0 };
            state = self.left * state + gain * error;
            weight * error
        };
        series
            .iter()
            .zip(&self.weights)
            .map(whitened_value)
            .collect()
    }

    /// The products of a whitened series with whitened steps at every place.
    ///
    /// One backward recursion gives all places: a step from k on is the sum of what starts there and what a
    /// step from k + 1 on is.
    fn with_steps(&self, whitened: &[f64]) -> Vec<f64> {
        let (mut carried, mut sum) = (0.0, 0.0);
        let product = |(value, &(weight, gain)): (&f64, &(f64, f64))| {
            let error = if weight > 0.0 {
                weight * value + gain * carried
            } else {
                0.0
            };
            carried = self.left * carried - error;
            sum += error;
            sum
        };
        let back = whitened.iter().zip(&self.weights).rev();
        let mut products: Vec<f64> = back.map(product).collect();
        products.reverse();
        products
    }

    /// The sums of squares of whitened steps at every place.
    fn squares_of_steps(&self) -> Vec<f64> {
        // Of an error u at a place, what follows is a u² + 2 b u + c.
        let (mut a, mut b, mut c) = (0.0, 0.0, 0.0);
        let returned = 1.0 - self.left;
        let square = |&(weight, gain): &(f64, f64)| {
            let kept = self.left - gain;
            c += returned * (a * returned + 2.0 * b);
            b = kept * (a * returned + b);
            a = weight * weight + kept * kept * a;
            a + 2.0 * b + c
        };
        let mut squares: Vec<f64> = self.weights.iter().rev().map(square).collect();
        squares.reverse();
        squares
    }
}

/// Scalar product.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Takes the part along orthonormal columns out of one.
fn orthogonal(mut column: Vec<f64>, basis: &[Vec<f64>]) -> Vec<f64> {
    for other in basis {
        let along = dot(&column, other);
        column
            .iter_mut()
            .zip(other)
            .for_each(|(x, b)| *x -= along * b);
    }
    column
}

/// A column's orthogonal part over its length; nothing where it hardly has one.
fn normalised(column: Vec<f64>, basis: &[Vec<f64>]) -> Option<Vec<f64>> {
    let before = dot(&column, &column);
    let column = orthogonal(column, basis);
    let squares = dot(&column, &column);
    let length = squares.sqrt();
    (squares > 1e-9 * before).then(|| column.iter().map(|x| x / length).collect())
}

/// A series in averages, and the noises that it may have.
struct Search<'a> {
    averages: &'a [f64],
    present: f64,
    noises: Vec<Noise>,
}

/// A series and what is known of it under a noise.
struct Whitened {
    /// Orthonormal columns of what is known.
    basis: Vec<Vec<f64>>,
    /// What it leaves of the series.
    rest: Vec<f64>,
    squares: f64,
}

impl Search<'_> {
    fn whitened(&self, noise: &Noise, known: &[Vec<f64>]) -> Whitened {
        let mut basis: Vec<Vec<f64>> = Vec::new();
        for column in known {
            let column = normalised(noise.whitened(column), &basis);
            basis.extend(column);
        }
        let rest = orthogonal(noise.whitened(self.averages), &basis);
        let squares = dot(&rest, &rest);
        Whitened {
            basis,
            rest,
            squares,
        }
    }

    /// −2 ln likelihood less a constant, its scale at its best, where so much of the squares is explained.
    /// `log|V| + N ln((S − explained)/N)`.
    fn cost(&self, noise: &Noise, squares: f64, explained: f64) -> f64 {
        let left = (squares - explained).max(1e-12 * squares);
        self.present * (left / self.present).ln() + noise.log_determinant
    }

    /// The likeliest of some shapes, and of all steps if wanted, beside what is known; `None` where none is enough.
    fn best(&self, known: &[Vec<f64>], shapes: &[Shape], with_steps: bool) -> Option<(Shape, f64)> {
        let count = self.averages.len();
        let columns: Vec<_> = shapes.iter().map(|shape| shape.columns(count)).collect();
        let mut without = f64::INFINITY;
        let mut least = vec![f64::INFINITY; shapes.len()];
        let mut step = (0, f64::INFINITY);
        for noise in &self.noises {
            let whitened = self.whitened(noise, known);
            without = without.min(self.cost(noise, whitened.squares, 0.0));
            for (least, columns) in least.iter_mut().zip(&columns) {
                let mut basis = whitened.basis.clone();
                let mut explained = 0.0;
                for column in columns {
                    if let Some(column) = normalised(noise.whitened(column), &basis) {
                        explained += dot(&column, &whitened.rest).powi(2);
                        basis.push(column);
                    }
                }
                *least = least.min(self.cost(noise, whitened.squares, explained));
            }
            if with_steps {
                let (at, explained) = likeliest_step(noise, &whitened);
                let cost = self.cost(noise, whitened.squares, explained);
                if cost < step.1 {
                    step = (at, cost);
                }
            }
        }
        let at = Shape::Step {
            from: step.0,
            to: step.0,
        };
        let all = shapes.iter().copied().zip(least);
        let all = all.chain([(at, step.1)].into_iter().filter(|_| with_steps));
        let falls = all.map(|(shape, cost)| (shape, without - cost));
        let enough = falls.filter(|(shape, fall)| *fall > shape.enough());
        enough.max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The coefficients of columns beside each other under their likeliest noise.
    fn coefficients(&self, columns: &[Vec<f64>]) -> Vec<f64> {
        let cost = |noise: &&Noise| {
            let squares = self.whitened(noise, columns).squares;
            self.cost(noise, squares, 0.0)
        };
        let costs = self.noises.iter().map(|noise| (noise, cost(&noise)));
        let Some((noise, _)) = costs.min_by(|a, b| a.1.total_cmp(&b.1)) else {
            return vec![0.0; columns.len()];
        };
        let series = noise.whitened(self.averages);
        let coefficient = |at: usize| {
            let others = [&columns[..at], &columns[at + 1..]].concat();
            let others = self.whitened(noise, &others).basis;
            let own = orthogonal(noise.whitened(&columns[at]), &others);
            dot(&own, &series) / dot(&own, &own)
        };
        (0..columns.len()).map(coefficient).collect()
    }
}

/// Where a step explains most, and how much of the squares. Not at the ends, where it is an outlier.
fn likeliest_step(noise: &Noise, of: &Whitened) -> (usize, f64) {
    let along = noise.with_steps(&of.rest);
    let mut lengths = noise.squares_of_steps();
    let before = lengths.clone();
    for column in &of.basis {
        let products = noise.with_steps(column).into_iter();
        let lengths = lengths.iter_mut().zip(products);
        lengths.for_each(|(length, product)| *length -= product * product);
    }
    let places = 2..along.len().saturating_sub(1);
    let places = places.filter(|at| lengths[*at] > 1e-6 * before[*at]);
    let explained = places.map(|at| (at, along[at] * along[at] / lengths[at]));
    let most = explained.max_by(|a, b| a.1.total_cmp(&b.1));
    most.unwrap_or((2, 0.0))
}

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
    let search = Search {
        averages: &series,
        present: there as f64,
        noises: noises.collect(),
    };
    let of_record = |share: &f64| share * count as f64;
    let warm_ups = WARM_UPS.iter().map(of_record).map(Shape::WarmUp);
    let cycles = CYCLES.iter().map(of_record).map(Shape::Cycle);
    let tried: Vec<Shape> = warm_ups.chain(cycles).collect();
    let level = std::iter::once(vec![1.0; count]);
    let known: Vec<Vec<f64>> = level
        .chain(known.iter().map(|known| averages(known, width)))
        .collect();
    let with = |found: &[(Shape, f64)]| {
        let of_found = found.iter().flat_map(|(shape, _)| shape.columns(count));
        known.iter().cloned().chain(of_found).collect::<Vec<_>>()
    };
    let mut found: Vec<(Shape, f64)> = Vec::new();
    while let Some((shape, fall)) = search.best(&with(&found), &tried, true) {
        let known = with(&found);
        let mut likeliest = (shape, fall);
        for power in NEARBY {
            let nearby = likeliest.0.nearby(power);
            likeliest = search.best(&known, &nearby, false).unwrap_or(likeliest);
        }
        found.push(likeliest);
        if found.len() > MOST_FOUND {
            return Vec::new();
        }
    }
    if found.is_empty() {
        return Vec::new();
    }
    let coefficients = search.coefficients(&with(&found));
    let mut coefficients = coefficients.into_iter().skip(known.len());
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
