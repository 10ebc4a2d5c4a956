//! The likeliest disturbances beside the likeliest noise.

use super::{
    noise::{Noise, dot, normalised, orthogonal},
    shape::Shape,
};
use std::mem::discriminant;

/// Powers of 2 by which times are varied about the likeliest of them.
const NEARBY: [f64; 2] = [1.0 / 6.0, 1.0 / 36.0];
/// More than this is noise.
const MOST_FOUND: usize = 16;
/// What the first shape of a kind takes more than each by itself, to be found: most records have none.
pub(super) const FIRST: f64 = 8.0;
/// How often each shape is looked for again beside the others.
const ROUNDS: usize = 3;

/// A series in averages, what is known beside it, the noises that it may have and the shapes that are tried.
pub(super) struct Search<'a> {
    pub(super) averages: &'a [f64],
    /// Averages that are not missing.
    pub(super) present: f64,
    /// Columns that are in the series anyhow, its level among them.
    pub(super) known: &'a [Vec<f64>],
    pub(super) noises: Vec<Noise>,
    /// Shapes beside steps, which are tried at all places.
    pub(super) tried: Vec<Shape>,
}

/// A series under a noise, and what is left of it beside what is known.
pub(super) struct Whitened {
    /// Orthonormal columns of what is known.
    pub(super) basis: Vec<Vec<f64>>,
    /// What they leave of the series.
    rest: Vec<f64>,
    pub(super) squares: f64,
}

/// A shape, and −2 ln likelihood with it and what it takes to be found.
type Priced = (Shape, f64);

/// What a shape takes to be found beside others.
fn price(shape: &Shape, beside: &[Shape]) -> f64 {
    let kind = discriminant(shape);
    let is_first = beside.iter().all(|other| discriminant(other) != kind);
    shape.enough() + if is_first { FIRST } else { 0.0 }
}

/// What shapes take to be found together.
fn price_of(shapes: &[Shape]) -> f64 {
    let prices = shapes.iter().enumerate();
    prices.map(|(at, shape)| price(shape, &shapes[..at])).sum()
}

impl Whitened {
    pub(super) fn new(noise: &Noise, series: &[f64], known: &[Vec<f64>]) -> Self {
        let rest = noise.whitened(series);
        let squares = dot(&rest, &rest);
        let basis = Vec::new();
        let mut of = Self {
            basis,
            rest,
            squares,
        };
        of.add(noise, known);
        of
    }

    /// Takes columns for known, too.
    fn add(&mut self, noise: &Noise, columns: &[Vec<f64>]) {
        for column in columns {
            if let Some(column) = normalised(noise.whitened(column), &self.basis) {
                self.rest = orthogonal(
                    std::mem::take(&mut self.rest),
                    std::slice::from_ref(&column),
                );
                self.basis.push(column);
            }
        }
        self.squares = dot(&self.rest, &self.rest);
    }

    /// How much of the squares columns explain.
    fn explained(&self, noise: &Noise, columns: &[Vec<f64>]) -> f64 {
        let mut basis = self.basis.clone();
        let mut explained = 0.0;
        for column in columns {
            if let Some(column) = normalised(noise.whitened(column), &basis) {
                explained += dot(&column, &self.rest).powi(2);
                basis.push(column);
            }
        }
        explained
    }

    /// Where a step explains most, and how much of the squares. Not at the ends, where it is an outlier.
    pub(super) fn likeliest_step(&self, noise: &Noise) -> (usize, f64) {
        let along = noise.with_steps(&self.rest);
        let mut lengths = noise.squares_of_steps();
        let before = lengths.clone();
        for column in &self.basis {
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
}

impl Search<'_> {
    /// −2 ln likelihood less a constant, its scale at its best, where so much of the squares is left.
    /// `log|V| + N ln(S/N)`.
    pub(super) fn cost(&self, noise: &Noise, squares: f64) -> f64 {
        self.present * (squares / self.present).ln() + noise.log_determinant
    }

    fn columns(&self, shapes: &[Shape]) -> Vec<Vec<f64>> {
        let count = self.averages.len();
        let of_shapes = shapes.iter().flat_map(|shape| shape.columns(count));
        self.known.iter().cloned().chain(of_shapes).collect()
    }

    fn whitened(&self, noise: &Noise, shapes: &[Shape]) -> Whitened {
        Whitened::new(noise, self.averages, &self.columns(shapes))
    }

    /// The likeliest noise beside shapes, and its cost.
    fn likeliest_noise(&self, shapes: &[Shape]) -> Option<(&Noise, f64)> {
        let columns = self.columns(shapes);
        let cost = |noise| {
            let squares = Whitened::new(noise, self.averages, &columns).squares;
            self.cost(noise, squares)
        };
        let costs = self.noises.iter().map(|noise| (noise, cost(noise)));
        costs.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    fn cost_of(&self, shapes: &[Shape]) -> f64 {
        self.likeliest_noise(shapes)
            .map_or(f64::INFINITY, |(_, cost)| cost)
    }

    /// The shape that lowers a cost most under a noise, after what it takes to be found beside others.
    fn best(&self, noise: &Noise, of: &Whitened, beside: &[Shape]) -> Priced {
        let count = self.averages.len();
        let priced = |shape: Shape, explained: f64| {
            let left = (of.squares - explained).max(1e-12 * of.squares);
            (shape, self.cost(noise, left) + price(&shape, beside))
        };
        let try_one = |shape: Shape| priced(shape, of.explained(noise, &shape.columns(count)));
        let least = |a: Priced, b: Priced| if b.1 < a.1 { b } else { a };
        let (at, explained) = of.likeliest_step(noise);
        let step = priced(Shape::Step { from: at, to: at }, explained);
        let Some(mut other) = self.tried.iter().copied().map(try_one).reduce(least) else {
            return step;
        };
        // What is not nearly enough is not better nearby.
        let is_near = other.1 - self.cost(noise, of.squares) < 0.5 * price(&other.0, beside);
        for power in NEARBY.into_iter().filter(|_| is_near) {
            let nearby = other.0.nearby(power).into_iter();
            other = nearby.map(try_one).fold(other, least);
        }
        least(step, other)
    }

    /// Adds shapes under a noise as long as they lower the cost; the cost with what they take to be found. Infinite where they are too
    /// many, or would be before it is as low as the `least` of other noises.
    fn under(&self, noise: &Noise, least: f64) -> (Vec<Shape>, f64) {
        let mut whitened = Whitened::new(noise, self.averages, self.known);
        let (mut shapes, mut taken) = (Vec::new(), 0.0);
        let mut own = self.cost(noise, whitened.squares);
        loop {
            let (shape, cost) = self.best(noise, &whitened, &shapes);
            let fall = own - cost - taken;
            if fall <= 0.0 {
                return (shapes, own);
            }
            // Each lowers it less than the one before.
            let more = MOST_FOUND.saturating_sub(shapes.len());
            if own - more as f64 * fall > least {
                return (Vec::new(), f64::INFINITY);
            }
            own = cost + taken;
            taken += price(&shape, &shapes);
            whitened.add(noise, &shape.columns(self.averages.len()));
            shapes.push(shape);
        }
    }

    /// Looks for each shape again, beside the others.
    fn refined(&self, mut shapes: Vec<Shape>) -> Vec<Shape> {
        let Some((noise, _)) = self.likeliest_noise(&shapes) else {
            return shapes;
        };
        for _ in 0..ROUNDS {
            let before = shapes.clone();
            for at in 0..shapes.len() {
                let one = shapes.remove(at);
                let others = self.whitened(noise, &shapes);
                let explained = others.explained(noise, &one.columns(self.averages.len()));
                let (shape, cost) = self.best(noise, &others, &shapes);
                let own = self.cost(noise, others.squares - explained) + price(&one, &shapes);
                let is_better = cost < own;
                shapes.insert(at, if is_better { shape } else { one });
            }
            if shapes == before {
                break;
            }
        }
        shapes
    }

    /// The shapes that, with the likeliest noise beside them, cost least, and by how much the cost is higher without each.
    pub(super) fn shapes(&self) -> Vec<(Shape, f64)> {
        let mut least = (Vec::new(), f64::INFINITY);
        let nothing = self.cost_of(&[]);
        least.1 = nothing;
        for noise in &self.noises {
            let of = self.under(noise, least.1);
            if of.1 < least.1 {
                least = of;
            }
        }
        let mut shapes = self.refined(least.0);
        loop {
            let cost = self.cost_of(&shapes);
            let taken = price_of(&shapes);
            if cost + taken >= nothing {
                return Vec::new();
            }
            let without = |at: usize| {
                let mut others = shapes.clone();
                others.remove(at);
                others
            };
            let falls = (0..shapes.len()).map(|at| self.cost_of(&without(at)) - cost);
            let falls = Vec::from_iter(falls);
            let spared = |at: &usize| falls[*at] + price_of(&without(*at)) - taken;
            let weakest = (0..shapes.len()).min_by(|a, b| spared(a).total_cmp(&spared(b)));
            match weakest.filter(|at| spared(at) < 0.0) {
                Some(at) => shapes.remove(at),
                None => return shapes.into_iter().zip(falls).collect(),
            };
        }
    }

    /// The coefficients of shapes beside each other under their likeliest noise.
    pub(super) fn coefficients(&self, shapes: &[Shape]) -> Vec<f64> {
        let columns = self.columns(shapes);
        let Some((noise, _)) = self.likeliest_noise(shapes) else {
            return vec![0.0; columns.len() - self.known.len()];
        };
        let series = noise.whitened(self.averages);
        let coefficient = |at: usize| {
            let others = [&columns[..at], &columns[at + 1..]].concat();
            let others = Whitened::new(noise, self.averages, &others).basis;
            let own = orthogonal(noise.whitened(&columns[at]), &others);
            dot(&own, &series) / dot(&own, &own)
        };
        (self.known.len()..columns.len()).map(coefficient).collect()
    }
}
