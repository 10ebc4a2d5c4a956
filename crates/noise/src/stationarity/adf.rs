//! Augmented Dickey-Fuller test (Dickey & Fuller 1979; Said & Dickey 1984), as Python's statsmodels
//! does it, in one pass over the record.
//!
//! `Δx_t = γ x_{t−1} + Σ δ_j Δx_{t−j} + deterministic + e_t`; the statistic is the t of γ. All lags
//! share one matrix of products: of those between lagged differences only one row is summed over the
//! record, the others follow by adding what enters and subtracting what leaves at the ends.
//!
//! Reading it: the null hypothesis is a unit root (a random walk in the record); a statistic below
//! the critical value rejects it. Two failures matter for inertial sensors. A moving-average root
//! near 1, that is white noise far above a slow walk, makes it reject whatever is true (Schwert
//! 1989); and a correlation time of a tenth of the record or more often makes it keep a unit root
//! that is not there. [`super::verdict()`] reads it beside KPSS.
//!
//! Cost O(N L) time for L lags and O(L²) memory, beyond the record nothing of length N.

use super::mackinnon::{critical_tau, p_tau};
use super::{Critical, Deterministic, schwert};
use crate::screening::record::{Compensated, RecordError, check_varying, dot};
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Number of lagged differences of the regression. Too few leave the residuals correlated, which falsifies the test; too many cost power.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lags {
    /// This number.
    Fixed(usize),
    /// The number up to `max` of least Akaike criterion, all compared on the sample that `max`
    /// leaves, then estimated on its own; without `max`, ⌈12 (n/100)^¼⌉.
    Aic(Option<usize>),
    /// The number of least Schwarz criterion, searched as in [`Lags::Aic`].
    Bic(Option<usize>),
    /// From `max` down to the first whose last lag has |t| ≥ 1.645.
    LastSignificant(Option<usize>),
}

/// Result of the augmented Dickey-Fuller test. Small (very negative) rejects the unit root.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Adf {
    /// t statistic of γ.
    pub statistic: f64,
    /// Probability of a smaller statistic under a unit root, by MacKinnon (1994), asymptotic.
    pub p_value: f64,
    /// Number of lagged differences used.
    pub lags: usize,
    /// Number of rows of the regression.
    #[serde(skip)]
    pub observations: usize,
    /// Critical values by MacKinnon (2010) for that many rows.
    pub critical: Critical,
    /// The criterion of the lag chosen (AIC, BIC or |t|), on the sample of the search.
    pub criterion: Option<f64>,
}

/// The test on a record. The null hypothesis is a unit root: reject it at 5 % where `statistic` is below `critical.five`.
/// The record is expected without gaps; with [`Deterministic::Trend`] a bias that drifts in a straight line counts as
/// stationary. White noise far above a random walk makes it reject, whatever the record's length
/// ([`verdict`](super::verdict())).
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::{stationarity::{Deterministic, Lags, adf}, synthesis::NoiseGenerator};
/// let slow = ShapingFilter::gauss_markov(1e-3, 0.5, 0.01)?; // 50 samples to the correlation time.
/// let record: Vec<f64> = NoiseGenerator::new(&slow, 1).take(5000).collect();
/// let test = adf(&record, Deterministic::Constant, Lags::Aic(None))?;
/// assert!(test.statistic < test.critical.one && test.p_value < 0.01);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Fewer samples than the regression has coefficients plus one, a sample that is not finite, a constant
/// record, or regressors that depend on each other (an exact line, a record of period two).
///
/// An exact example: for a record with no lags and no constant γ = Σ x_{t−1} Δx_t / Σ x²_{t−1}. Of
/// the record 1, 0, 1, 0, 1, 0 each sample before a fall is 1 and before a rise 0, so γ = −1 and
/// its t is −√6:
///
/// ```
/// use undrift_noise::stationarity::{Deterministic, Lags, adf};
/// let test = adf(&[1.0, 0.0, 1.0, 0.0, 1.0, 0.0], Deterministic::None, Lags::Fixed(0))?;
/// // Σ x Δx = −3, Σ x² = 3, residuals 0, 1, 0, 1, 0: s² = 2/4, t = −1/√(0.5/3).
/// assert!((test.statistic + 6f64.sqrt()).abs() < 1e-12);
/// assert_eq!((test.lags, test.observations, test.criterion), (0, 5, None));
/// # Ok::<(), undrift_noise::screening::RecordError>(())
/// ```
pub fn adf(x: &[f64], deterministic: Deterministic, lags: Lags) -> Result<Adf, RecordError> {
    let [found] = adf_by_rules(x, deterministic, [lags])?;
    Ok(found)
}

/// Does [`adf`] for several rules of one record, whose sums of products are found once.
///
/// # Errors
/// As [`adf`].
pub(crate) fn adf_by_rules<const K: usize>(
    x: &[f64],
    deterministic: Deterministic,
    rules: [Lags; K],
) -> Result<[Adf; K], RecordError> {
    let mut sums = Vec::new();
    let mut all = Vec::with_capacity(K);
    for lags in rules {
        all.push(one(x, deterministic, lags, &mut sums)?);
    }
    Ok(std::array::from_fn(|k| all[k]))
}

/// The test by one rule; `sums` are kept.
fn one(
    x: &[f64],
    deterministic: Deterministic,
    lags: Lags,
    sums: &mut Vec<Products>,
) -> Result<Adf, RecordError> {
    let (mean, _) = check_varying(x, 4 + deterministic.columns())?;
    let centre = if deterministic == Deterministic::None {
        0.0
    } else {
        mean
    };
    let (chosen, criterion) = match lags {
        Lags::Fixed(count) => (count, None),
        Lags::Aic(max) | Lags::Bic(max) | Lags::LastSignificant(max) => {
            let most = (x.len() / 2).saturating_sub(deterministic.columns() + 1);
            let max = max
                .unwrap_or(schwert(x.len(), 12.0).ceil() as usize)
                .min(most);
            let (lag, criterion) = search(products(x, centre, max, sums)?, deterministic, lags)?;
            (lag, Some(criterion))
        }
    };
    let products = products(x, centre, chosen, sums)?;
    // The level last: its t is then the last element of the solved right-hand side.
    let mut order = products.deterministic(deterministic);
    order.extend((1..=chosen).map(Column::Difference));
    order.push(Column::Level);
    let (solved, residual) = products.solve(&order)?;
    let freedom = products.rows as f64 - order.len() as f64;
    if freedom <= 0.0 {
        return Err(RecordError::TooShort {
            needed: x.len() + order.len() + 1 - products.rows,
            got: x.len(),
        });
    }
    let (last, rest) = (solved[order.len() - 1], residual[order.len() - 1]);
    let statistic = last / (rest / freedom).sqrt();
    Ok(Adf {
        statistic,
        p_value: p_tau(statistic, deterministic),
        lags: chosen,
        observations: products.rows,
        critical: critical_tau(deterministic, products.rows),
        criterion,
    })
}

/// The sums of a number of lags, found before or now.
fn products<'a>(
    x: &[f64],
    centre: f64,
    lags: usize,
    found: &'a mut Vec<Products>,
) -> Result<&'a Products, RecordError> {
    let at = match found.iter().position(|of| of.lags == lags) {
        Some(at) => at,
        None => {
            found.push(Products::new(x, centre, lags)?);
            found.len() - 1
        }
    };
    Ok(&found[at])
}

/// The lag that the rule picks, and its criterion.
///
/// Akaike's and Schwarz' criteria of all lags come from one Cholesky factor: its leading blocks are the
/// regressions with fewer lags.
///
/// All lags are compared on the rows that the largest leaves: criteria of different rows are not
/// comparable.
fn search(
    products: &Products,
    deterministic: Deterministic,
    rule: Lags,
) -> Result<(usize, f64), RecordError> {
    let mut order = products.deterministic(deterministic);
    order.push(Column::Level);
    let first = order.len();
    order.extend((1..=products.lags).map(Column::Difference));
    let (solved, residual) = products.solve(&order)?;
    let rows = products.rows as f64;
    let freedom = |lag: usize| rows - (first + lag) as f64;
    if freedom(products.lags) <= 0.0 {
        return Err(RecordError::TooShort {
            needed: order.len() + products.lags + 2,
            got: products.rows,
        });
    }
    let t_of = |lag: usize| {
        let column = first + lag - 1;
        (solved[column] / (residual[column] / freedom(lag)).sqrt()).abs()
    };
    if let Lags::LastSignificant(_) = rule {
        // 95 % point of the normal distribution.
        let significant = (1..=products.lags)
            .rev()
            .find(|&lag| t_of(lag) >= 1.644_853_626_951_472_2);
        return Ok(significant.map_or((0, t_of(0)), |lag| (lag, t_of(lag))));
    }
    let price = if matches!(rule, Lags::Bic(_)) {
        rows.ln()
    } else {
        2.0
    };
    let criterion = |lag: usize| {
        let columns = first + lag;
        rows * ((2.0 * PI * residual[columns - 1] / rows).ln() + 1.0) + price * columns as f64
    };
    let mut best = (0, criterion(0));
    for lag in 1..=products.lags {
        let value = criterion(lag);
        if value < best.1 {
            best = (lag, value);
        }
    }
    Ok(best)
}

/// A column of the regression.
#[derive(Clone, Copy, PartialEq)]
enum Column {
    /// A column of ones.
    Constant,
    /// The time, from −1 to 1 over the rows.
    Trend,
    /// x_{t−1} less the centre.
    Level,
    /// Δx_{t−j}; 0 is the left-hand side.
    Difference(usize),
}

/// Sums of products of the columns over rows t = lags+1 … n−1.
///
/// `Σ Δx_{t−i−1} Δx_{t−j−1}` is `Σ Δx_{t−i} Δx_{t−j}` with the first product of the rows added and the last
/// taken off, so that one row of lags is summed over the record and the others are corrections of its ends: O(N
/// L) instead of O(N L²).
struct Products {
    lags: usize,
    rows: usize,
    level_level: f64,
    level_sum: f64,
    level_trend: f64,
    /// Σ (x_{t−1} − c) Δx_{t−j}, by j from 0.
    level_difference: Vec<f64>,
    difference_sum: Vec<f64>,
    difference_trend: Vec<f64>,
    /// Σ Δx_{t−i} Δx_{t−j}, row by row.
    difference_difference: Vec<f64>,
}

/// Rows summed before the sums are added up with compensation.
const BLOCK: usize = 1024;

impl Products {
    /// Sums of products over the record with up to `lags` lagged differences, about `centre`.
    fn new(x: &[f64], centre: f64, lags: usize) -> Result<Self, RecordError> {
        let count = x.len();
        if count < lags.saturating_add(3) {
            return Err(RecordError::TooShort {
                needed: lags.saturating_add(3),
                got: count,
            });
        }
        let (first, rows) = (lags + 1, count - 1 - lags);
        // Trend from −1 to 1 over the rows.
        let step = 2.0 / (rows as f64 - 1.0).max(1.0);
        let trend = |row: f64| -1.0 + step * row;
        let mut sums = [Compensated::default(); 3];
        let mut trend_first = Compensated::default();
        let mut level_difference = vec![Compensated::default(); lags + 1];
        let mut first_row = vec![Compensated::default(); lags + 1];
        let (mut level, mut slope, mut differences) =
            (vec![0.0; BLOCK], vec![0.0; BLOCK], vec![0.0; BLOCK + lags]);
        for start in (0..rows).step_by(BLOCK) {
            let size = BLOCK.min(rows - start);
            for k in 0..size {
                level[k] = x[first + start + k - 1] - centre;
                slope[k] = trend((start + k) as f64);
            }
            // differences[lags + k] is Δx of row k of the block.
            for (k, slot) in differences[..size + lags].iter_mut().enumerate() {
                let t = first + start + k - lags;
                *slot = x[t] - x[t - 1];
            }
            let (level, slope) = (&level[..size], &slope[..size]);
            sums[0].add(dot(level, level));
            sums[1].add(level.iter().sum());
            sums[2].add(dot(level, slope));
            let current = &differences[lags..lags + size];
            trend_first.add(dot(slope, current));
            for j in 0..=lags {
                let lagged = &differences[lags - j..lags - j + size];
                first_row[j].add(dot(current, lagged));
                level_difference[j].add(dot(level, lagged));
            }
        }
        let difference = |t: usize| x[t] - x[t - 1];
        let side = lags + 1;
        let mut square = vec![0.0; side * side];
        for j in 0..side {
            square[j] = first_row[j].value();
            square[j * side] = square[j];
        }
        for i in 0..lags {
            for j in i..lags {
                let enters = difference(lags - i) * difference(lags - j);
                let leaves = difference(count - 1 - i) * difference(count - 1 - j);
                let value = square[i * side + j] + (enters - leaves);
                square[(i + 1) * side + j + 1] = value;
                square[(j + 1) * side + i + 1] = value;
            }
        }
        let difference_sum: Vec<f64> = (0..=lags).map(|j| x[count - 1 - j] - x[lags - j]).collect();
        let mut difference_trend = vec![trend_first.value()];
        for j in 0..lags {
            let (enters, leaves) = (difference(lags - j), difference(count - 1 - j));
            let moved = difference_trend[j] + (trend(-1.0) * enters - leaves);
            difference_trend.push(moved + step * (difference_sum[j] + (enters - leaves)));
        }
        Ok(Self {
            lags,
            rows,
            level_level: sums[0].value(),
            level_sum: sums[1].value(),
            level_trend: sums[2].value(),
            level_difference: level_difference.iter().map(|s| s.value()).collect(),
            difference_sum,
            difference_trend,
            difference_difference: square,
        })
    }

    /// Columns of the deterministic part.
    fn deterministic(&self, kind: Deterministic) -> Vec<Column> {
        [Column::Constant, Column::Trend][..kind.columns()].to_vec()
    }

    /// Sum of products of two columns over the rows.
    ///
    /// All products are sums that [`Products::new`] has made, or closed forms.
    fn product(&self, a: Column, b: Column) -> f64 {
        use Column::{Constant, Difference, Level, Trend};
        let rows = self.rows as f64;
        match (a, b) {
            (Constant, Constant) => rows,
            (Constant, Trend) | (Trend, Constant) => 0.0,
            // Σ (−1 + 2k/(n−1))².
            (Trend, Trend) => rows * (rows + 1.0) / (3.0 * (rows - 1.0).max(1.0)),
            (Level, Level) => self.level_level,
            (Level, Constant) | (Constant, Level) => self.level_sum,
            (Level, Trend) | (Trend, Level) => self.level_trend,
            (Level, Difference(j)) | (Difference(j), Level) => self.level_difference[j],
            (Constant, Difference(j)) | (Difference(j), Constant) => self.difference_sum[j],
            (Trend, Difference(j)) | (Difference(j), Trend) => self.difference_trend[j],
            (Difference(i), Difference(j)) => self.difference_difference[i * (self.lags + 1) + j],
        }
    }

    /// Cholesky factor of the columns scaled to unit length, applied to the left-hand side: one
    /// element a column, and the sum of squared residuals with the columns up to it. An element over
    /// the residual deviation of the model up to it is the t of that column there.
    ///
    /// `order` gives the columns; the first factor rows are the regressions with fewer of them.
    ///
    /// # Errors
    /// Columns that depend on each other to 1e-13, or residuals of nothing: a straight line, a
    /// repeating pattern.
    fn solve(&self, order: &[Column]) -> Result<(Vec<f64>, Vec<f64>), RecordError> {
        let degenerate = Err(RecordError::Argument(
            "the regression is degenerate: the recording is a straight line or a repeating pattern",
        ));
        let size = order.len();
        let scale: Vec<f64> = order.iter().map(|&c| self.product(c, c).sqrt()).collect();
        let total = self.product(Column::Difference(0), Column::Difference(0));
        if !total.is_normal() || scale.iter().any(|s| !s.is_normal()) {
            return degenerate;
        }
        let scaled = |a, b| self.product(order[a], order[b]) / scale[a] / scale[b];
        let Some(factor) = DMatrix::from_fn(size, size, scaled).cholesky() else {
            return degenerate;
        };
        let factor = factor.unpack();
        let left =
            |i: usize, _| self.product(order[i], Column::Difference(0)) / scale[i] / total.sqrt();
        let left = DVector::from_fn(size, left);
        let Some(mut solved) = factor.solve_lower_triangular(&left) else {
            return degenerate;
        };
        let (mut residuals, mut residual) = (Vec::with_capacity(size), 1.0);
        for (pivot, value) in factor.diagonal().iter().zip(&solved) {
            residual -= value * value;
            if pivot * pivot <= 1e-13 || residual.is_nan() || residual <= 1e-14 {
                return degenerate;
            }
            residuals.push(residual * total);
        }
        solved *= total.sqrt();
        Ok((solved.as_slice().to_vec(), residuals))
    }
}
