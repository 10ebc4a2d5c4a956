//! The order of an ARMA model by Pandit and Wu's F tests, as in part 1 of the source paper.
//!
//! ARMA(2n, 2n−1) is fitted for n = 1, 2, … until the fall of the residual sum of squares is no longer
//! significant,
//!
//! ```text
//! F = ((A0 − A1)/s) / (A1/(N − r)),    compared with F_0.05(s, N − r)
//! ```
//!
//! A0, A1 the sums of squares of the smaller and the larger model, s the parameters added, r those of
//! the larger (φ, θ and an estimated mean). The order is then stepped down by one pair at a time, (2n−1, 2n−2), …,
//! (2,1), (1,1), while that costs nothing significant. Pandit & Wu 1983, sections 4.4 and 4.5; Wang,
//! Lyu & Wu 2016, section 1.3.
//!
//! A is the sum of squares of the *exact* one-step prediction errors, `Σ v²/V`, at the
//! maximum-likelihood estimate, not a conditional sum of squares.
//!
//! The test is not F-distributed under the null, since the extra poles and zeros cancel: for a true
//! ARMA(2,1) it goes up to (4,3) in three of four records where 5 % are meant, and does not find its way
//! back, since the same critical value decides on the way down. Beside it is therefore the
//! order of least BIC on that way down, whose penalty of ln N per parameter outgrows what a
//! cancelling pair gains (docs/lab/arma.md). Use BIC and the drift score to decide, and F to say what the paper
//! would have said.
//!
//! ```
//! use undrift_noise::arma::FitOptions;
//! use undrift_noise::pandit_wu::{PanditWuOptions, pandit_wu};
//! let mut seed = 1u64;
//! let record: Vec<f64> = (0..300)
//!     .map(|_| {
//!         seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
//!         (seed >> 11) as f64 / (1u64 << 53) as f64
//!     })
//!     .collect();
//! let table = pandit_wu(&record, &PanditWuOptions { n_max: 2, ..Default::default() })?;
//! assert_eq!(table.rows[1].order(), (2, 1));
//! # Ok::<(), undrift_noise::arma::ArmaError>(())
//! ```

use crate::arma::{ArmaError, ArmaFit, FitOptions, Ladder, climb_to};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

/// F_0.05(2, ∞), with which the source paper compares at every step: −ln 0.05.
pub const PAPER_CRITICAL: f64 = 2.995_732_273_553_991;

/// Largest n.
const MOST: usize = 12;
/// Effort of the fits that only the table shows.
const TABLE_EFFORT: f64 = 0.05;

/// Largest order, level of the tests, and options of each fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PanditWuOptions {
    /// Largest n of ARMA(2n, 2n−1) that may be chosen, 1 to 12.
    pub n_max: usize,
    /// Rows of the table go on to this n, at most 12, to show what larger orders bring. They change no choice and are
    /// searched with little effort.
    pub table: usize,
    /// Level of the tests; 0.05 in the paper.
    pub level: f64,
    /// Options of each order's fit.
    pub fit: FitOptions,
}

impl Default for PanditWuOptions {
    /// n up to 3, 5 %, mean estimated; no further rows.
    fn default() -> Self {
        Self {
            n_max: 3,
            table: 0,
            level: 0.05,
            fit: FitOptions::default(),
        }
    }
}

/// One F test between two nested orders.
///
/// Both sums are of exact prediction errors of the same samples, so that `sum_larger` is the smaller of the two
/// but for the tolerance of the search and the weights V, which differ between the models.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrderTest {
    /// The smaller order (p, q).
    pub smaller: (usize, usize),
    /// The larger order (p, q).
    pub larger: (usize, usize),
    /// A0, sum of squares of the smaller model \[unit²\].
    pub sum_smaller: f64,
    /// A1, sum of squares of the larger model \[unit²\].
    pub sum_larger: f64,
    /// F statistic.
    pub f: f64,
    /// Degrees of freedom s of the numerator: parameters added.
    pub added: usize,
    /// Degrees of freedom N − r of the denominator.
    pub remaining: usize,
    /// Critical value F(s, N − r) at the level asked for.
    pub critical: f64,
    /// Probability of a larger F, were it F-distributed.
    pub p_value: f64,
    /// Whether F exceeds the critical value: the larger model is needed.
    pub significant: bool,
    /// Whether F exceeds [`PAPER_CRITICAL`], with which the source paper compares.
    pub significant_in_paper: bool,
}

/// One order of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct OrderRow {
    /// n of ARMA(2n, 2n−1); 0 for ARMA(1,1), with which the source paper's table begins.
    pub n: usize,
    /// The fit: sum of squares, AIC, BIC, coefficients.
    pub fit: ArmaFit,
    /// The test against the row before; `None` in the first row, and where the models are not nested.
    pub test: Option<OrderTest>,
}

impl OrderRow {
    /// The order (p, q) of the row.
    pub fn order(&self) -> (usize, usize) {
        self.fit.order()
    }

    /// ln(A/N) + 2r/N, r = p + q + 1 with an estimated mean: Akaike's criterion for one sample without its constant 1 + ln 2π, as in Table 3
    /// of the source paper.
    pub fn aic_per_sample(&self) -> f64 {
        let n = self.fit.n as f64;
        let fitted = self.fit.parameters as f64 - 1.0;
        (self.fit.residual_sum_of_squares / n).ln() + 2.0 * fitted / n
    }
}

/// All fits and tests of the procedure, and the order that each criterion chooses: what the source paper's tables are made of.
#[derive(Clone, Debug, PartialEq)]
pub struct PanditWu {
    /// ARMA(1,1), then ARMA(2n, 2n−1), each tested against the row before. Ends with the first order
    /// that brings nothing significant, or with n_max, unless `table` asks for more.
    pub rows: Vec<OrderRow>,
    /// n of the last significant order: where the paper's loop stops.
    pub n: usize,
    /// Whether the loop ended because a test was not significant, not because n_max was reached.
    pub adequate: bool,
    /// The tests of stepping down from (2n, 2n−1), in the order made.
    pub step_down: Vec<OrderTest>,
    /// The neighbours (1,1), (2,1), (3,2), each tested against the next larger (the paper's section 1.3).
    pub neighbours: Vec<OrderTest>,
    /// All fits made, by order; the chosen ones are among them.
    pub fits: Vec<ArmaFit>,
    /// Order chosen by the F tests, after stepping down.
    pub by_f: (usize, usize),
    /// Order of least BIC on the whole way down, (2n, 2n−1), (2n−1, 2n−2), …, (2,1), (1,1).
    pub by_bic_step_down: (usize, usize),
    /// Order of least AIC among `fits`.
    pub by_aic: (usize, usize),
    /// Order of least BIC among `fits`.
    pub by_bic: (usize, usize),
}

impl PanditWu {
    /// The fit of `order` (p, q), if it was made.
    pub fn fit(&self, order: (usize, usize)) -> Option<&ArmaFit> {
        self.fits.iter().find(|fit| fit.order() == order)
    }
}

/// The F test of `larger` against `smaller` at the given `level`, from their sums of squares, both fitted to the same record. `None`
/// where `larger` has no more parameters or not enough samples remain.
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::{arma::{FitOptions, fit}, pandit_wu::f_test, synthesis::NoiseGenerator};
/// let process = ShapingFilter::arma(&[0.9], &[0.5], 1e-3, 0.01)?;
/// let record: Vec<f64> = NoiseGenerator::new(&process, 1).take(1000).collect();
/// let [smaller, larger] = [fit(&record, 1, 0, &FitOptions::default())?, fit(&record, 1, 1, &FitOptions::default())?];
/// let test = f_test(&smaller, &larger, 0.05).expect("nested");
/// assert!(test.significant && test.added == 1 && test.sum_larger < test.sum_smaller);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn f_test(smaller: &ArmaFit, larger: &ArmaFit, level: f64) -> Option<OrderTest> {
    // σ² is in `parameters` and not in r.
    let added = larger.parameters.checked_sub(smaller.parameters)?;
    let remaining = larger.n.checked_sub(larger.parameters - 1)?;
    if added == 0 || remaining == 0 {
        return None;
    }
    let (a0, a1) = (
        smaller.residual_sum_of_squares,
        larger.residual_sum_of_squares,
    );
    let f = ((a0 - a1) / added as f64) / (a1 / remaining as f64);
    let distribution = FisherSnedecor::new(added as f64, remaining as f64).ok()?;
    let critical = critical_value(added, remaining, level)?;
    Some(OrderTest {
        smaller: smaller.order(),
        larger: larger.order(),
        sum_smaller: a0,
        sum_larger: a1,
        f,
        added,
        remaining,
        critical,
        p_value: if f > 0.0 { distribution.sf(f) } else { 1.0 },
        significant: f > critical,
        significant_in_paper: f > PAPER_CRITICAL,
    })
}

/// The value that F with `added` and `remaining` degrees of freedom exceeds with probability `level`, or `None` for a level outside (0, 1).
///
/// ```
/// use undrift_noise::pandit_wu::{PAPER_CRITICAL, critical_value};
/// let long = critical_value(2, 1_000_000, 0.05).expect("a level within (0, 1)");
/// assert!((long - PAPER_CRITICAL).abs() < 1e-4);
/// assert!(critical_value(2, 20, 0.05) > Some(3.4), "short records need more");
/// ```
pub fn critical_value(added: usize, remaining: usize, level: f64) -> Option<f64> {
    if !(level > 0.0 && level < 1.0) {
        return None;
    }
    let distribution = FisherSnedecor::new(added as f64, remaining as f64).ok()?;
    // By bisection of the tail: the library's own inverse stops at a fixed absolute accuracy.
    let (mut low, mut high) = (0.0, 1.0);
    while distribution.sf(high) > level && high < 1e300 {
        low = high;
        high *= 2.0;
    }
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if distribution.sf(middle) > level {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(0.5 * (low + high))
}

/// Fits of one record, each order once.
///
/// A smaller model is a start of each larger one, so that a test between them is not decided by a search that
/// missed the optimum.
struct Fits<'a> {
    samples: &'a [f64],
    options: &'a FitOptions,
    ladder: Ladder,
    made: Vec<ArmaFit>,
}

impl Fits<'_> {
    /// The fit of an order, made once, from the optima below it.
    fn at(&mut self, p: usize, q: usize) -> Result<ArmaFit, ArmaError> {
        if let Some(fit) = self.made.iter().find(|fit| fit.order() == (p, q)) {
            return Ok(fit.clone());
        }
        // Models inside this one: the sum of squares should not rise with the order.
        let inside: Vec<_> = self
            .made
            .iter()
            .filter(|fit| fit.ar.len() <= p && fit.ma.len() <= q)
            .map(|fit| (fit.ar.clone(), fit.ma.clone()))
            .collect();
        let fit = climb_to(self.samples, p, q, self.options, &inside, &mut self.ladder)?;
        self.made.push(fit.clone());
        Ok(fit)
    }
}

/// Runs the procedure on a record (constant removed or not; NaN for a missing sample).
///
/// # Errors
/// As [`crate::arma::fit`] where not even ARMA(2,1) can be fitted; [`ArmaError::BadOption`] for a
/// level outside (0, 1) or n_max outside 1…12.
///
/// Each order is fitted once by [`crate::arma::fit()`], with the optima of the orders inside it as further
/// starts. Identification runs it on a record's first [`SEARCH_SAMPLES`](crate::identify::SEARCH_SAMPLES) and
/// at reduced effort.
///
/// ```
/// use undrift_nav::shaping::ShapingFilter;
/// use undrift_noise::{pandit_wu::{PanditWuOptions, pandit_wu}, synthesis::NoiseGenerator};
/// let process = ShapingFilter::arma(&[0.95], &[0.5], 1e-3, 0.01)?;
/// let record: Vec<f64> = NoiseGenerator::new(&process, 1).take(800).collect();
/// let found = pandit_wu(&record, &PanditWuOptions { n_max: 1, ..Default::default() })?;
/// // The table begins with ARMA(1,1), then (2,1); the first step down asks whether (2,1) was needed.
/// assert_eq!(found.rows.iter().map(|row| row.order()).collect::<Vec<_>>(), [(1, 1), (2, 1)]);
/// assert_eq!((found.step_down[0].smaller, found.step_down[0].larger), ((1, 1), (2, 1)));
/// assert!(found.fit(found.by_f).is_some() && found.fit((7, 6)).is_none());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn pandit_wu(samples: &[f64], options: &PanditWuOptions) -> Result<PanditWu, ArmaError> {
    if !(1..=MOST).contains(&options.n_max) {
        return Err(ArmaError::BadOption("n_max"));
    }
    if !(options.level > 0.0 && options.level < 1.0) {
        return Err(ArmaError::BadOption("the level of the tests"));
    }
    let level = options.level;
    let mut fits = Fits {
        samples,
        options: &options.fit,
        ladder: Ladder::default(),
        made: Vec::new(),
    };
    // Smaller than all of the table, and a start for each.
    fits.at(1, 0)?;
    let mut rows = vec![OrderRow {
        n: 0,
        fit: fits.at(1, 1)?,
        test: None,
    }];
    let mut n = 1;
    let mut adequate = false;
    for next in 1..=options.n_max {
        let fit = match fits.at(2 * next, 2 * next - 1) {
            Ok(fit) => fit,
            // The record is too short for more: that ends the loop too.
            Err(ArmaError::TooShort { .. }) if next > 1 => break,
            Err(error) => return Err(error),
        };
        let test = rows.last().and_then(|row| f_test(&row.fit, &fit, level));
        rows.push(OrderRow { n: next, fit, test });
        if next > 1 {
            // Too few samples for a test counts as not significant.
            if test.is_some_and(|test| test.significant) {
                n = next;
            } else {
                adequate = true;
                break;
            }
        }
    }
    let mut chosen = fits.at(2 * n, 2 * n - 1)?;
    let mut least_bic = chosen.clone();
    let mut step_down = Vec::new();
    let mut stepping = true;
    let candidates = (2..2 * n).rev().map(|p| (p, p - 1)).chain([(1, 1)]);
    for (p, q) in candidates {
        let smaller = fits.at(p, q)?;
        if smaller.bic < least_bic.bic {
            least_bic = smaller.clone();
        }
        let test = f_test(&smaller, &chosen, level).filter(|_| stepping);
        stepping = test.is_some_and(|test| !test.significant);
        step_down.extend(test);
        if stepping {
            chosen = smaller;
        }
    }
    let mut neighbours = Vec::new();
    for ((p, q), (larger_p, larger_q)) in [((1, 1), (2, 1)), ((2, 1), (3, 2)), ((1, 1), (3, 2))] {
        let pair = (fits.at(p, q), fits.at(larger_p, larger_q));
        if let (Ok(smaller), Ok(larger)) = pair {
            neighbours.extend(f_test(&smaller, &larger, level));
        }
    }
    let made = fits.made.clone();
    let least = |score: fn(&ArmaFit) -> f64| {
        let best = made.iter().min_by(|a, b| score(a).total_cmp(&score(b)));
        best.map_or((1, 0), ArmaFit::order)
    };
    let cheap = FitOptions {
        effort: options.fit.effort.min(TABLE_EFFORT),
        ..options.fit
    };
    fits.options = &cheap;
    let first = rows.last().map_or(1, |row| row.n + 1);
    for n in first..=options.table.min(MOST) {
        let Ok(fit) = fits.at(2 * n, 2 * n - 1) else {
            break;
        };
        let test = rows.last().and_then(|row| f_test(&row.fit, &fit, level));
        rows.push(OrderRow { n, fit, test });
    }
    Ok(PanditWu {
        rows,
        n,
        adequate,
        step_down,
        neighbours,
        by_f: chosen.order(),
        by_bic_step_down: least_bic.order(),
        by_aic: least(|fit| fit.aic),
        by_bic: least(|fit| fit.bic),
        fits: made,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(order: (usize, usize), n: usize, squares: f64) -> ArmaFit {
        let samples: Vec<f64> = (0..60).map(|k| f64::from(k * k * 37 % 17)).collect();
        let options = FitOptions {
            effort: 0.1,
            ..FitOptions::default()
        };
        let made = crate::arma::fit(&samples, order.0, order.1, &options).unwrap();
        ArmaFit {
            n,
            residual_sum_of_squares: squares,
            ..made
        }
    }

    /// P(F(2, ν) > f) = (1 + 2f/ν)^(−ν/2), and the same the other way round.
    #[test]
    fn critical_values_of_two_degrees_of_freedom_are_in_closed_form() {
        for remaining in [1usize, 2, 7, 100, 5000] {
            for level in [0.999f64, 0.5, 0.05, 0.01] {
                let nu = remaining as f64;
                let exact = 0.5 * nu * (level.powf(-2.0 / nu) - 1.0);
                let found = critical_value(2, remaining, level).unwrap();
                assert!(
                    (found / exact - 1.0).abs() < 1e-6,
                    "{remaining} {level}: {found} {exact}"
                );
            }
        }
        for level in [0.0, 1.0, -0.1, f64::NAN] {
            assert_eq!(critical_value(2, 10, level), None);
        }
    }

    #[test]
    fn an_f_test_is_of_the_fall_of_the_sum_of_squares_for_each_parameter_added() {
        let (small, large) = (of((1, 0), 40, 100.0), of((2, 1), 40, 80.0));
        let found = f_test(&small, &large, 0.05).unwrap();
        assert_eq!((found.smaller, found.larger), ((1, 0), (2, 1)));
        // p + q + 1 with the mean: 4 of 40 are fitted.
        assert_eq!((found.added, found.remaining), (2, 36));
        let f = 20.0 / 2.0 / (80.0 / 36.0);
        assert!((found.f - f).abs() < 1e-12);
        assert!((found.p_value / (1.0 + f / 18.0).powi(-18) - 1.0).abs() < 1e-9);
        assert!((found.critical - 18.0 * (0.05f64.powf(-1.0 / 18.0) - 1.0)).abs() < 1e-6);
        assert!(found.significant && found.significant_in_paper == (f > PAPER_CRITICAL));
        assert_eq!((found.sum_smaller, found.sum_larger), (100.0, 80.0));
        // 3.26 at 5 %: a fall to 85 is not enough.
        let less = f_test(&small, &of((2, 1), 40, 85.0), 0.05).unwrap();
        assert!(!less.significant && less.f < less.critical);
        // A sum that rises is no sign of anything.
        let more = f_test(&small, &of((2, 1), 40, 101.0), 0.05).unwrap();
        assert!(more.f < 0.0 && more.p_value == 1.0 && !more.significant);
    }

    #[test]
    fn an_f_test_needs_more_parameters_and_samples_beyond_them() {
        let small = of((1, 0), 40, 100.0);
        assert!(f_test(&small, &of((0, 1), 40, 80.0), 0.05).is_none());
        assert!(f_test(&of((2, 1), 40, 80.0), &small, 0.05).is_none());
        assert!(f_test(&small, &of((2, 1), 5, 80.0), 0.05).is_some());
        assert!(f_test(&small, &of((2, 1), 4, 80.0), 0.05).is_none());
        assert!(f_test(&small, &of((2, 1), 3, 80.0), 0.05).is_none());
    }
}
