//! A linear mixed model with nested random intercepts: rows of logs, logs of units.
//!
//! y = Xβ + u(unit) + v(log) + e, each normal and independent, with the variances λ₂σ², λ₁σ² and σ². The
//! variance of a log's rows is σ²(1 + λ₁ 11′), that of a unit's σ²(A + λ₂ 11′): both invert by Sherman and
//! Morrison's formula, so nothing larger than X′X is ever formed.
//! σ² and β are profiled out of the restricted likelihood (REML), which is minimised over the two ratios.
//!
//! A unit or log that is *set aside* has an intercept of its own: that is the limit of an infinite variance, in
//! which the same formulas hold.
//!
//! Source: Pinheiro and Bates, Mixed-Effects Models in S and S-PLUS (2000), section 2.2; degrees of freedom after
//! Satterthwaite as in Giesbrecht and Burns, Biometrics 41 (1985) 477.

mod fit;
mod scores;
mod sums;
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
    sizes: Vec<usize>,
    /// The logs of each unit.
    units: Vec<Range<usize>>,
    /// Whether a column of X is the same in all rows of a unit, in every unit.
    between: Vec<bool>,
    /// Units and logs with an intercept of their own.
    aside: [Vec<bool>; 2],
}

/// The levels of random intercepts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grouping {
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
            self.sizes.push(rows.len());
            self.aside[0].push(false);
        }
        if self.sizes.len() > from {
            self.units.push(from..self.sizes.len());
            self.aside[1].push(false);
        }
    }

    /// How many logs and units.
    pub fn count(&self, level: Grouping) -> usize {
        self.aside[level as usize].len()
    }

    /// Whether a unit or log has an intercept of its own.
    pub fn is_aside(&self, level: Grouping, which: usize) -> bool {
        self.aside[level as usize]
            .get(which)
            .copied()
            .unwrap_or(false)
    }

    /// Gives a unit or log an intercept of its own, or takes it back.
    pub fn set_aside(&mut self, level: Grouping, which: usize, aside: bool) {
        if let Some(slot) = self.aside[level as usize].get_mut(which) {
            *slot = aside;
        }
    }

    /// Whether the intercepts of a level can be told from those of the one below.
    pub fn has(&self, level: Grouping) -> bool {
        match level {
            Grouping::Log => self.sizes.iter().any(|n| *n > 1),
            Grouping::Unit => self.units.len() > 1 && self.units.iter().any(|logs| logs.len() > 1),
        }
    }

    fn rows(&self) -> f64 {
        self.sizes.iter().sum::<usize>() as f64
    }

    /// The rows of a log.
    fn size(&self, log: usize) -> usize {
        self.sizes.get(log).copied().unwrap_or(1)
    }

    fn sum(&self, log: usize) -> &[f64] {
        let start = log * self.columns;
        self.sums
            .get(start..start + self.columns)
            .unwrap_or_default()
    }

    /// Intercepts of their own, which cost a degree of freedom each.
    fn intercepts(&self) -> f64 {
        let logs = self.aside[0].iter().filter(|aside| **aside).count();
        let of_unit =
            |logs: &Range<usize>| logs.clone().any(|log| !self.is_aside(Grouping::Log, log));
        let units = self.units.iter().zip(&self.aside[1]);
        let units = units.filter(|(logs, aside)| **aside && of_unit(logs));
        (logs + units.count()) as f64
    }
}

/// How a log's rows enter the likelihood.
struct LogWeights {
    /// Of the square of its sum, which is subtracted: λ₁/(1 + nλ₁).
    less: f64,
    /// Of its sum in that of its unit: 1/(1 + nλ₁).
    scale: f64,
    /// ln|A|.
    determinant: f64,
}

fn log_weights(rows: usize, ratio: f64, aside: bool) -> LogWeights {
    let n = rows as f64;
    if aside {
        return LogWeights {
            less: 1.0 / n,
            scale: 0.0,
            determinant: n.ln(),
        };
    }
    let scale = 1.0 / (1.0 + n * ratio);
    LogWeights {
        less: ratio * scale,
        scale,
        determinant: -scale.ln(),
    }
}

/// What is subtracted of the square of a unit's weighted sum, λ₂/(1 + Wλ₂) with W = 1′A⁻¹1, and the determinant's
/// share.
fn unit_weights(weight: f64, ratio: f64, aside: bool) -> (f64, f64) {
    if aside && weight > 0.0 {
        (1.0 / weight, weight.ln())
    } else {
        let scale = 1.0 / (1.0 + weight * ratio);
        (ratio * scale, -scale.ln())
    }
}
