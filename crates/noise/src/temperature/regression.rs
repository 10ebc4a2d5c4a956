//! Generalised least squares on block averages: regressors under the covariance of a composite model, which is fitted
//! with them by restricted maximum likelihood (Patterson & Thompson 1971; Harville 1974).
//!
//! With whitened level and regressors X and record y the coefficients are `(XᵀX)⁻¹ Xᵀy`, and −2 log of the
//! restricted likelihood is `log|V| + log|XᵀX| + yᵀy − yᵀX(XᵀX)⁻¹Xᵀy` up to a constant. One pass of one filter
//! whitens all four signals: what it needs of the model, gain and variance, does not depend on the data.
//!
//! Why not ordinary least squares: residuals of a bias that walks are correlated over the whole
//! record, and the usual standard error of a slope is then far too small. The noise model is fitted
//! with the regressors, so that slope and walk compete fairly for what moves slowly.
//!
//! Called by [`super`] only. Rows are block averages; a pass is O(rows), a fit some hundreds of
//! passes.

use crate::composite::predictor::{Predictor, dot};
use crate::composite::{CompositeTerms, GaussMarkov, TermSet, block_average};
use crate::quasi_newton::{Objective, best_of};
use crate::terms::SCALES;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use undrift_nav::shaping::ShapingFilter;

/// Signals: the record, one, the first and the second regressor.
pub(super) const SIGNALS: usize = 4;
/// A row of them; the record's is NaN where it is missing.
pub(super) type Row = [f64; SIGNALS];

/// Averages over blocks of samples of a record and of its regressors.
pub(super) struct Averages {
    /// One a block, in time.
    pub(super) rows: Vec<Row>,
    /// Samples in a block, and the interval between samples \[s\].
    pub(super) block: usize,
    pub(super) interval: f64,
}

/// Which likelihood is maximised.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Likelihood {
    /// The likelihood of the record, which compares models with different regressors.
    Full,
    /// The likelihood with the coefficients integrated out: its noise is not too small by what they fit away.
    Restricted,
}

/// Products of the whitened signals.
struct Products {
    /// Σ aᵢ aⱼ/V of the whitened signals; V its innovation variance.
    of: [Row; SIGNALS],
    log_determinant: f64,
}

/// The normal equations of level and regressors, solved.
struct Solved {
    /// Of XᵀX.
    factor: Cholesky<f64, Dyn>,
    /// Level \[unit\], then a coefficient for each regressor.
    coefficients: DVector<f64>,
    /// Sum of squares that is left.
    squares: f64,
    /// Logarithm of the determinant of the normal equations.
    freedom: f64,
}

impl Products {
    /// Solves for the level and the first `regressors`; `None` where they are dependent.
    ///
    /// Residual squares by subtraction; the regressors should be scaled to about unit size.
    fn solved(&self, regressors: usize) -> Option<Solved> {
        let count = 1 + regressors;
        let normal = DMatrix::from_fn(count, count, |i, j| self.of[1 + i][1 + j]);
        let right = DVector::from_fn(count, |i, _| self.of[1 + i][0]);
        let factor = normal.cholesky()?;
        let coefficients = factor.solve(&right);
        Some(Solved {
            squares: self.of[0][0] - right.dot(&coefficients),
            freedom: 2.0 * factor.l_dirty().diagonal().map(f64::ln).sum(),
            coefficients,
            factor,
        })
    }
}

/// Coefficients of the regressors under a model.
#[derive(Clone, Debug)]
pub(super) struct Regression {
    /// Level, then one for each regressor.
    pub(super) coefficients: DVector<f64>,
    /// (XᵀX)⁻¹ under the fitted noise, in the order of the coefficients.
    pub(super) covariance: DMatrix<f64>,
    /// −2 log likelihood less a constant, plus twice the noise model's parameters.
    pub(super) aic: f64,
}

/// All signals predicted one step by one filter: prediction is linear, so the errors of the record less any
/// combination of the regressors are that combination of the errors.
///
/// `None` where the model leaves a row without variance.
fn products<const N: usize>(rows: &[Row], filter: &ShapingFilter) -> Option<Products> {
    let mut predictor = Predictor::<N>::new(filter);
    let mut states = [[0.0; N]; SIGNALS];
    let mut sums = Products {
        of: [[0.0; SIGNALS]; SIGNALS],
        log_determinant: 0.0,
    };
    // The variance soon stays the same: so do its logarithm and its inverse.
    let (mut last, mut log, mut inverse) = (1.0, 0.0, 1.0);
    for row in rows {
        if row[0].is_nan() {
            states.iter_mut().for_each(|x| *x = predictor.advance(x));
            predictor.skip();
            continue;
        }
        let (variance, gain) = (predictor.variance, predictor.gain);
        if !(variance > 0.0 && variance.is_finite()) {
            return None;
        }
        if variance != last {
            (last, log, inverse) = (variance, variance.ln(), 1.0 / variance);
        }
        let mut errors = [0.0; SIGNALS];
        for ((error, x), value) in errors.iter_mut().zip(&mut states).zip(row) {
            *error = value - dot(&predictor.h, x);
            *x = predictor.advance(x);
            for i in 0..N {
                x[i] += gain[i] * *error;
            }
        }
        for (i, of) in sums.of.iter_mut().enumerate() {
            let weighed = errors[i] * inverse;
            for (j, sum) in of.iter_mut().enumerate() {
                *sum += weighed * errors[j];
            }
        }
        sums.log_determinant += log;
        predictor.move_on();
    }
    Some(sums)
}

impl Averages {
    /// Of this record under a model of the full rate, averaged over blocks exactly.
    fn products(&self, filter: &ShapingFilter) -> Option<Products> {
        let filter = block_average(filter, self.block).ok()?;
        match filter.order {
            0 => products::<0>(&self.rows, &filter),
            1 => products::<1>(&self.rows, &filter),
            2 => products::<2>(&self.rows, &filter),
            3 => products::<3>(&self.rows, &filter),
            4 => products::<4>(&self.rows, &filter),
            5 => products::<5>(&self.rows, &filter),
            _ => products::<6>(&self.rows, &filter),
        }
    }

    /// The regression on the level and the first `regressors` under a model; `None` where they are dependent or the
    /// model has no variance.
    pub(super) fn under(
        &self,
        terms: &CompositeTerms,
        regressors: usize,
        likelihood: Likelihood,
    ) -> Option<Regression> {
        let sums = self.products(&terms.to_shaping(self.interval).ok()?)?;
        let found = sums.solved(regressors)?;
        let freedom = match likelihood {
            Likelihood::Full => 0.0,
            Likelihood::Restricted => found.freedom,
        };
        let parameters = terms.set().parameters() as f64;
        let aic = sums.log_determinant + freedom + found.squares + 2.0 * parameters;
        aic.is_finite().then(|| Regression {
            covariance: found.factor.inverse(),
            coefficients: found.coefficients,
            aic,
        })
    }

    /// What the restricted log-likelihood of a model changes by where the coefficients of the first `regressors` are
    /// integrated out too, under a flat prior as the level is.
    ///
    /// Half the change of `log|XᵀX| + S` from the level alone to level and regressors, with the sign turned:
    /// models are compared by what they say of the record beyond what temperature may explain.
    pub(super) fn restriction(&self, filter: &ShapingFilter, regressors: usize) -> Option<f64> {
        let sums = self.products(filter)?;
        let [level, all] = [sums.solved(0)?, sums.solved(regressors)?];
        let change = level.freedom + level.squares - all.freedom - all.squares;
        Some(0.5 * change).filter(|change| change.is_finite())
    }

    /// The regression under white noise.
    ///
    /// Its standard errors assume white noise: for starts and outliers only.
    pub(super) fn plain(&self, regressors: usize) -> Option<Regression> {
        let white = CompositeTerms {
            white: 1.0,
            ..CompositeTerms::default()
        };
        self.under(&white, regressors, Likelihood::Full)
    }

    /// The regression under the most likely model of a set of terms, fitted with the regressors.
    ///
    /// Two searches from the best of nine starts. `None` where no start has a likelihood.
    pub(super) fn fit(
        &self,
        set: TermSet,
        regressors: usize,
        likelihood: Likelihood,
    ) -> Option<Regression> {
        let length_s = (self.rows.len() * self.block) as f64 * self.interval;
        let first_tau = set.amplitudes();
        let taus = (self.block as f64 * self.interval).ln()..(1e3 * length_s).ln();
        let cost = |z: &Vec<f64>| {
            if !z[first_tau..].iter().all(|tau| taus.contains(tau)) {
                return f64::INFINITY;
            }
            let found = self.under(&set.terms(z), regressors, likelihood);
            found.map_or(f64::INFINITY, |found| 0.5 * found.aic)
        };
        let costs = |z: &[Vec<f64>]| z.iter().map(cost).collect();
        let starts = self.starts(set, regressors, length_s)?;
        let best = best_of(&mut Objective::new(&costs, SCALES), starts, 2, 1e-3, 60)?;
        self.under(&set.terms(&best.z), regressors, likelihood)
    }

    /// White noise by the differences of neighbours, and slow terms by what least squares leave, at several shares and
    /// correlation times.
    ///
    /// `None` where the averages do not vary.
    fn starts(&self, set: TermSet, regressors: usize, length_s: f64) -> Option<Vec<Vec<f64>>> {
        let present = || self.rows.iter().filter(|row| !row[0].is_nan());
        let pairs = present().zip(present().skip(1));
        let squares: f64 = pairs.map(|(a, b)| 0.5 * (b[0] - a[0]).powi(2)).sum();
        let count = present().count() as f64;
        let fast = (squares / (count - 1.0)).sqrt();
        let plain = self.plain(regressors)?;
        let residual = |row: &Row| row[0] - combined(&plain.coefficients, row);
        let slow = (present().map(|row| residual(row).powi(2)).sum::<f64>() / count).sqrt();
        if !(fast > 0.0 && slow > 0.0) {
            return None;
        }
        let white = fast * (self.block as f64 * self.interval).sqrt();
        let mut starts = Vec::new();
        for share in [1.0, 0.2, 0.04] {
            for tau_share in [0.003, 0.03, 0.3] {
                let (sigma, tau_s) = (share * slow, tau_share * length_s);
                let process = GaussMarkov { sigma, tau_s };
                starts.push(set.coordinates(&CompositeTerms {
                    white,
                    random_walk: process.drive(),
                    flicker: sigma,
                    gauss_markov: [process; 2],
                    ..CompositeTerms::default()
                }));
            }
        }
        Some(starts)
    }
}

/// The level and the regressors of a row, each times its coefficient.
pub(super) fn combined(coefficients: &DVector<f64>, row: &Row) -> f64 {
    coefficients.iter().zip(&row[1..]).map(|(c, x)| c * x).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_restriction_is_that_of_the_whole_covariance() {
        let terms = CompositeTerms {
            white: 0.3,
            gauss_markov: [
                GaussMarkov {
                    sigma: 0.7,
                    tau_s: 9.0,
                },
                GaussMarkov::default(),
            ],
            ..CompositeTerms::default()
        };
        let filter = terms.to_shaping(1.0).unwrap();
        let count = 40;
        let mut lags = vec![0.0; count];
        filter.autocovariance(&mut lags);
        let covariance = DMatrix::from_fn(count, count, |i, j| lags[i.abs_diff(j)]);
        let row = |k: usize| -> Row {
            let t = k as f64;
            [(0.7 * t).sin() + 0.1 * t, 1.0, 0.05 * t, (0.2 * t).cos()]
        };
        let rows: Vec<Row> = (0..count).map(row).collect();
        let factor = covariance.cholesky().unwrap();
        // ln |XᵀV⁻¹X| and the sum of squares left, for X of the first columns.
        let restricted = |columns: usize| {
            let x = DMatrix::from_fn(count, columns, |k, i| rows[k][1 + i]);
            let y = DVector::from_fn(count, |k, _| rows[k][0]);
            let normal = x.transpose() * factor.solve(&x);
            let right = x.transpose() * factor.solve(&y);
            let squares =
                y.dot(&factor.solve(&y)) - right.dot(&normal.clone().lu().solve(&right).unwrap());
            -0.5 * (normal.determinant().ln() + squares)
        };
        let averages = Averages {
            rows: rows.clone(),
            block: 1,
            interval: 1.0,
        };
        for regressors in [1, 2] {
            let found = averages.restriction(&filter, regressors).unwrap();
            let expected = restricted(1 + regressors) - restricted(1);
            // Rounding of 40 samples' sums.
            assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        }
    }
    /// Averages that alternate by one: √2 by the differences of neighbours, 1 by what the level leaves.
    #[test]
    fn a_search_begins_with_noise_of_the_size_of_what_is_seen() {
        let rows = |of: fn(f64) -> f64| -> Vec<Row> {
            let signs = [1.0, -1.0, 1.0, -1.0];
            signs.map(|sign| [of(sign), 1.0, sign, 0.0]).into()
        };
        let averages = |rows: Vec<Row>| Averages {
            rows,
            block: 50,
            interval: 0.02,
        };
        let set = TermSet {
            white: true,
            random_walk: true,
            gauss_markov: 1,
            ..TermSet::default()
        };
        let found = averages(rows(|sign| 3.0 + sign))
            .starts(set, 0, 1000.0)
            .unwrap();
        let mut expected = Vec::new();
        for sigma in [1.0, 0.2, 0.04] {
            for tau_s in [3.0, 30.0, 300.0] {
                let process = GaussMarkov { sigma, tau_s };
                expected.push(set.coordinates(&CompositeTerms {
                    // A block of a second.
                    white: 2f64.sqrt(),
                    // The walk of its driving noise, σ √(2/τ).
                    random_walk: sigma * (2.0 / tau_s).sqrt(),
                    gauss_markov: [process; 2],
                    ..CompositeTerms::default()
                }));
            }
        }
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.concat().into_iter().zip(expected.concat()) {
            assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        }
        // Averages that are all the same, or that the regressor is all of, have no noise.
        assert!(averages(rows(|_| 3.0)).starts(set, 0, 1000.0).is_none());
        assert!(averages(rows(|sign| sign)).starts(set, 1, 1000.0).is_none());
    }
}
