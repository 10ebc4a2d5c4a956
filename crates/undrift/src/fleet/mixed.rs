//! A linear mixed model with nested random intercepts: rows of logs, logs of units.
//!
//! y = Xβ + u(unit) + v(log) + e, each normal and independent, with the variances λ₂σ², λ₁σ² and σ². The
//! variance of a log's rows is σ²(1 + λ₁ 11′), that of a unit's σ²(A + λ₂ 11′): both invert by Sherman and
//! Morrison's formula, so nothing larger than X′X is ever formed, and an evaluation costs a few operations a log.
//! σ² and β are profiled out of the restricted likelihood (REML), which is minimised over the two ratios.
//!
//! A unit or log that is *set aside* has an intercept of its own: that is the limit of an infinite variance, in
//! which the same formulas hold.
//!
//! Source: Pinheiro and Bates, Mixed-Effects Models in S and S-PLUS (2000), section 2.2; degrees of freedom after
//! Satterthwaite as in Giesbrecht and Burns, Biometrics 41 (1985) 477.

mod fit;
mod scores;
#[cfg(test)]
mod tests;

pub use fit::{Contrast, Fit, quantile_95};
pub use scores::Shift;

use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// What the likelihood needs of the rows: sums by log, and products over all.
pub struct Nested {
    /// Columns of X, and y as the last one.
    columns: usize,
    /// Of all rows, \[X y\]′\[X y\].
    products: DMatrix<f64>,
    /// Of each log \[X y\]′1, one after the other.
    sums: Vec<f64>,
    /// Rows of each log.
    sizes: Vec<f64>,
    /// The logs of each unit.
    units: Vec<Range<usize>>,
    /// Whether a column of X is the same in all rows of a unit, in every unit.
    between: Vec<bool>,
    /// Units and logs with an intercept of their own.
    aside: [Vec<bool>; 2],
}

/// The levels of random intercepts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    Log,
    Unit,
}

/// The least of a pivot relative to its diagonal; below it a column is a combination of those before it.
const ALIASED: f64 = 1e-9;

impl Nested {
    /// For X of some columns.
    pub fn new(columns: usize) -> Self {
        Self {
            columns: columns + 1,
            products: DMatrix::zeros(columns + 1, columns + 1),
            sums: Vec::new(),
            sizes: Vec::new(),
            units: Vec::new(),
            between: vec![true; columns],
            aside: [Vec::new(), Vec::new()],
        }
    }

    /// Adds a unit by its logs, each the rows of X and y.
    pub fn add(&mut self, logs: &[Vec<(Vec<f64>, f64)>]) {
        let from = self.sizes.len();
        let mut first: Option<&[f64]> = None;
        for rows in logs.iter().filter(|rows| !rows.is_empty()) {
            let start = self.sums.len();
            self.sums.resize(start + self.columns, 0.0);
            for (x, y) in rows {
                let row = DVector::from_iterator(self.columns, x.iter().copied().chain([*y]));
                self.products.syger(1.0, &row, &row, 1.0);
                for (sum, value) in self.sums.iter_mut().skip(start).zip(row.iter()) {
                    *sum += value;
                }
                let first = first.get_or_insert(x);
                for ((between, a), b) in self.between.iter_mut().zip(first.iter()).zip(x) {
                    *between &= a == b;
                }
            }
            self.sizes.push(rows.len() as f64);
            self.aside[0].push(false);
        }
        if self.sizes.len() > from {
            self.units.push(from..self.sizes.len());
            self.aside[1].push(false);
        }
    }

    /// How many logs and units.
    pub fn count(&self, level: Level) -> usize {
        self.aside[level as usize].len()
    }

    /// Whether a unit or log has an intercept of its own.
    pub fn is_aside(&self, level: Level, which: usize) -> bool {
        self.aside[level as usize]
            .get(which)
            .copied()
            .unwrap_or(false)
    }

    /// Gives a unit or log an intercept of its own, or takes it back.
    pub fn set_aside(&mut self, level: Level, which: usize, aside: bool) {
        if let Some(slot) = self.aside[level as usize].get_mut(which) {
            *slot = aside;
        }
    }

    /// Whether the intercepts of a level can be told from those of the one below.
    pub fn has(&self, level: Level) -> bool {
        match level {
            Level::Log => self.sizes.iter().any(|n| *n > 1.0),
            Level::Unit => self.units.len() > 1 && self.units.iter().any(|logs| logs.len() > 1),
        }
    }

    fn rows(&self) -> f64 {
        self.sizes.iter().sum()
    }

    fn sum(&self, log: usize) -> &[f64] {
        let start = log * self.columns;
        self.sums
            .get(start..start + self.columns)
            .unwrap_or_default()
    }

    /// What is subtracted of a log: λ₁/(1 + nλ₁), the weight of its sum, 1/(1 + nλ₁), and ln|A|.
    fn log_weights(&self, log: usize, ratio: f64) -> (f64, f64, f64) {
        let n = self.sizes.get(log).copied().unwrap_or(1.0);
        if self.is_aside(Level::Log, log) {
            (1.0 / n, 0.0, n.ln())
        } else {
            let scale = 1.0 / (1.0 + n * ratio);
            (ratio * scale, scale, -scale.ln())
        }
    }

    /// What is subtracted of a unit's weighted sum, λ₂/(1 + Wλ₂), and the determinant's share.
    fn unit_weights(&self, unit: usize, weight: f64, ratio: f64) -> (f64, f64) {
        if self.is_aside(Level::Unit, unit) && weight > 0.0 {
            (1.0 / weight, weight.ln())
        } else {
            let scale = 1.0 / (1.0 + weight * ratio);
            (ratio * scale, -scale.ln())
        }
    }

    /// The weighted sum of a unit's logs, S = X′A⁻¹1 with y in the last place, and W = 1′A⁻¹1.
    fn unit_sum(&self, unit: usize, ratio: f64, sum: &mut [f64]) -> f64 {
        sum.fill(0.0);
        let mut weight = 0.0;
        for log in self.units.get(unit).cloned().unwrap_or_default() {
            let (_, scale, _) = self.log_weights(log, ratio);
            weight += scale * self.sizes.get(log).copied().unwrap_or(0.0);
            for (total, value) in sum.iter_mut().zip(self.sum(log)) {
                *total += scale * value;
            }
        }
        weight
    }

    /// \[X y\]′V⁻¹\[X y\], its lower triangle, and ln|V|, both for σ² = 1.
    fn weighted(&self, ratios: [f64; 2]) -> (DMatrix<f64>, f64) {
        let q = self.columns;
        let mut taken = vec![0.0; q * q];
        let mut less = |sum: &[f64], by: f64| {
            for (row, a) in taken.chunks_exact_mut(q).zip(sum) {
                let scaled = by * a;
                if scaled != 0.0 {
                    for (slot, b) in row.iter_mut().zip(sum) {
                        *slot += scaled * b;
                    }
                }
            }
        };
        let mut determinant = 0.0;
        let mut sum = vec![0.0; q];
        for (unit, logs) in self.units.iter().enumerate() {
            for log in logs.clone() {
                let (by, _, share) = self.log_weights(log, ratios[0]);
                less(self.sum(log), by);
                determinant += share;
            }
            let weight = self.unit_sum(unit, ratios[0], &mut sum);
            let (by, share) = self.unit_weights(unit, weight, ratios[1]);
            less(&sum, by);
            determinant += share;
        }
        let taken = DMatrix::from_row_slice(q, q, &taken);
        (&self.products - taken, determinant)
    }

    /// Intercepts of their own, which cost a degree of freedom each.
    fn intercepts(&self) -> f64 {
        let logs = self.aside[0].iter().filter(|aside| **aside).count();
        let of_unit = |logs: &Range<usize>| logs.clone().any(|log| !self.is_aside(Level::Log, log));
        let units = self.units.iter().zip(&self.aside[1]);
        let units = units.filter(|(logs, aside)| **aside && of_unit(logs));
        (logs + units.count()) as f64
    }
}
