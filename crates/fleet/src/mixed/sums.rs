//! What the likelihood needs of the logs, whatever the variances. Weights are the same for all logs with as many rows
//! and all units with as many such logs: the products of each kind are added up once, so an evaluation costs the
//! kinds of logs and the units whose logs have different numbers of rows, and not the logs.

use super::{Grouping, Nested, log_weights, unit_weights};
use nalgebra::DMatrix;
use std::collections::BTreeMap;

/// Sufficient statistics, for the units and logs that are set aside at the time.
pub(super) struct Sums {
    /// Of all rows, \[X y\]′\[X y\].
    pub products: DMatrix<f64>,
    /// Rows less intercepts of units and logs that are set aside.
    pub freedom: f64,
    /// Logs by whether they are set aside, and their rows.
    logs: BTreeMap<(bool, usize), Alike>,
    /// Units by whether they are set aside, the rows of each log, and their logs.
    units: BTreeMap<(bool, usize, usize), Alike>,
    /// Units whose logs have different numbers of rows, and whether they are set aside.
    uneven: Vec<(bool, Vec<AlikeLogs>)>,
}

/// Logs or units with the same weights: how many, and Σss′ of their sums s = \[X y\]′1, its lower triangle by rows.
#[derive(Default)]
struct Alike {
    count: f64,
    squares: Vec<f64>,
}

/// Logs of a unit with the same number of rows: that, how many, and their sum \[X y\]′1.
struct AlikeLogs {
    rows: usize,
    count: usize,
    sum: Vec<f64>,
}

impl Alike {
    fn add(&mut self, sum: &[f64]) {
        self.count += 1.0;
        self.squares.resize(sum.len() * (sum.len() + 1) / 2, 0.0);
        add_square(&mut self.squares, 1.0, sum);
    }
}

/// Adds a multiple of ss′ to a lower triangle by rows.
fn add_square(to: &mut [f64], by: f64, sum: &[f64]) {
    let mut rest = to;
    for (k, value) in sum.iter().enumerate() {
        let Some((row, below)) = rest.split_at_mut_checked(k + 1) else {
            return;
        };
        let scaled = by * value;
        // Most columns are of other levels.
        if scaled != 0.0 {
            add_to(row, scaled, sum);
        }
        rest = below;
    }
}

fn add_to(to: &mut [f64], by: f64, values: &[f64]) {
    for (slot, value) in to.iter_mut().zip(values) {
        *slot += by * value;
    }
}

impl Sums {
    pub fn of(nested: &Nested) -> Self {
        let mut sums = Self {
            products: nested.products.clone(),
            freedom: nested.rows() - nested.intercepts(),
            logs: BTreeMap::new(),
            units: BTreeMap::new(),
            uneven: Vec::new(),
        };
        for (unit, logs) in nested.units.iter().enumerate() {
            let mut kinds: Vec<AlikeLogs> = Vec::new();
            for log in logs.clone() {
                let (rows, sum) = (nested.size(log), nested.sum(log));
                let aside = nested.is_aside(Grouping::Log, log);
                sums.logs.entry((aside, rows)).or_default().add(sum);
                if aside {
                    continue;
                }
                if let Some(kind) = kinds.iter_mut().find(|kind| kind.rows == rows) {
                    kind.count += 1;
                    add_to(&mut kind.sum, 1.0, sum);
                } else {
                    kinds.push(AlikeLogs {
                        rows,
                        count: 1,
                        sum: sum.to_vec(),
                    });
                }
            }
            let aside = nested.is_aside(Grouping::Unit, unit);
            match kinds.as_slice() {
                [] => {}
                [all] => {
                    let kind = (aside, all.rows, all.count);
                    sums.units.entry(kind).or_default().add(&all.sum);
                }
                _ => sums.uneven.push((aside, kinds)),
            }
        }
        sums
    }

    /// \[X y\]′V⁻¹\[X y\], its lower triangle, and ln|V|, both for σ² = 1.
    pub fn weighted(&self, ratios: [f64; 2]) -> (DMatrix<f64>, f64) {
        let q = self.products.nrows();
        let mut taken = vec![0.0; q * (q + 1) / 2];
        let mut determinant = 0.0;
        for ((aside, rows), logs) in &self.logs {
            let weights = log_weights(*rows, ratios[0], *aside);
            add_to(&mut taken, weights.less, &logs.squares);
            determinant += logs.count * weights.determinant;
        }
        for ((aside, rows, count), units) in &self.units {
            let scale = log_weights(*rows, ratios[0], false).scale;
            let weight = scale * (rows * count) as f64;
            let (less, share) = unit_weights(weight, ratios[1], *aside);
            add_to(&mut taken, less * scale * scale, &units.squares);
            determinant += units.count * share;
        }
        let mut sum = vec![0.0; q];
        for (aside, kinds) in &self.uneven {
            sum.fill(0.0);
            let mut weight = 0.0;
            for logs in kinds {
                let scale = log_weights(logs.rows, ratios[0], false).scale;
                weight += scale * (logs.rows * logs.count) as f64;
                add_to(&mut sum, scale, &logs.sum);
            }
            let (less, share) = unit_weights(weight, ratios[1], *aside);
            add_square(&mut taken, less, &sum);
            determinant += share;
        }
        let mut left = self.products.clone();
        let places = (0..q).flat_map(|i| (0..=i).map(move |j| (i, j)));
        for (place, taken) in places.zip(taken) {
            left[place] -= taken;
        }
        (left, determinant)
    }
}
