//! The spread of constants between records.

use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Probability of the interval and of the one-sided bound.
const PROBABILITY: f64 = 0.95;

/// The standard deviation of the constants between records, by the method of moments for one random effect: the variance of
/// the records' levels less the mean of their squared standard errors, `s² − v̄` (Hedges 1983, Psychological Bulletin 93,
/// 388-395; Searle, Casella & McCulloch 1992, chapter 3). Its interval is that of s² by χ² with n − 1 degrees of freedom,
/// less v̄: exact where the standard errors are equal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Between {
    /// Number n of records.
    pub records: usize,
    /// Mean of the levels \[unit\].
    pub mean: f64,
    /// Standard deviation between records \[unit\]; 0 where the levels scatter no more than each is uncertain.
    pub sigma: f64,
    /// Lower end of the 95 % interval of `sigma` \[unit\].
    pub low: f64,
    /// Upper end of the 95 % interval of `sigma` \[unit\]; infinite of one record.
    pub high: f64,
    /// Standard deviation s of the levels \[unit\], their uncertainty included.
    pub scatter: f64,
    /// Root mean square √v̄ of their standard errors \[unit\].
    pub within: f64,
}

impl Between {
    /// The spread of `levels`, each with its standard error \[unit\]; a level that nothing bounds does not count.
    pub(super) fn new(levels: impl Iterator<Item = (f64, f64)>) -> Self {
        let known = levels.filter(|(level, error)| level.is_finite() && error.is_finite());
        let known: Vec<(f64, f64)> = known.collect();
        let n = known.len() as f64;
        let mean = known.iter().map(|(level, _)| level).sum::<f64>() / n.max(1.0);
        let within = (known.iter().map(|(_, e)| e * e).sum::<f64>() / n.max(1.0)).sqrt();
        let squares: f64 = known.iter().map(|(level, _)| (level - mean).powi(2)).sum();
        let found = Self {
            records: known.len(),
            mean,
            within,
            scatter: (squares / (n - 1.0).max(1.0)).sqrt(),
            ..Self::default()
        };
        Self {
            sigma: found.less_within(1.0),
            low: found.at(0.5 + 0.5 * PROBABILITY),
            high: found.at(0.5 - 0.5 * PROBABILITY),
            ..found
        }
    }

    /// Degrees of freedom of the spread, n − 1.
    /// 0 of one record, which shows no spread.
    pub fn degrees_of_freedom(&self) -> usize {
        self.records.saturating_sub(1)
    }

    /// The standard deviation at which the levels' scatter has the probability `p` to be less.
    fn at(&self, p: f64) -> f64 {
        let freedom = self.degrees_of_freedom() as f64;
        match ChiSquared::new(freedom) {
            Ok(chi) if freedom > 0.0 => self.less_within((freedom / chi.inverse_cdf(p)).sqrt()),
            _ => f64::INFINITY,
        }
    }

    /// √(factor² s² − v̄), 0 where that is negative.
    fn less_within(&self, factor: f64) -> f64 {
        let total = factor * self.scatter;
        (total * total - self.within * self.within).max(0.0).sqrt()
    }

    /// What a filter gets \[unit\] of records of the axes of one sensor, `alike`, of which this is one. With more than
    /// three records Student's t distribution of the next constant has the variance s² (n − 1)/(n − 3); with two or
    /// three it has none, and the axes are taken as draws of one distribution: the upper 95 % bound of their pooled
    /// scatter. Where the scatter is within the uncertainty, that upper bound too. The constant `common` to all
    /// records is added in squares: a filter starts from zero.
    ///
    /// ```
    /// use undrift_noise::identify::Between;
    /// // Five switch-ons that scatter by 1: the next constant has the variance (n − 1)/(n − 3) = 2.
    /// let axis = Between { records: 5, sigma: 1.0, scatter: 1.0, ..Between::default() };
    /// assert_eq!(axis.degrees_of_freedom(), 4);
    /// assert!((axis.for_filter(&[axis], 0.0) - 2f64.sqrt()).abs() < 1e-12);
    /// assert!((axis.for_filter(&[axis], 1.0) - 3f64.sqrt()).abs() < 1e-12); // With a constant of 1 common to all.
    /// ```
    pub fn for_filter(&self, alike: &[Self], common: f64) -> f64 {
        let freedom = self.degrees_of_freedom() as f64;
        let spread = match freedom {
            3.0.. if self.sigma > 0.0 => self.less_within((freedom / (freedom - 2.0)).sqrt()),
            3.0.. => self.at(1.0 - PROBABILITY).max(self.within),
            _ => {
                let freedoms = || alike.iter().map(|axis| axis.degrees_of_freedom() as f64);
                let squares = alike.iter().zip(freedoms());
                let squares: f64 = squares.map(|(axis, n)| n * axis.scatter.powi(2)).sum();
                let total: f64 = freedoms().sum();
                let bound = ChiSquared::new(total).map_or(f64::INFINITY, |chi| {
                    squares / chi.inverse_cdf(1.0 - PROBABILITY)
                });
                (bound - self.within * self.within)
                    .max(self.within * self.within)
                    .max(self.sigma * self.sigma)
                    .sqrt()
            }
        };
        spread.hypot(common)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn by_hand() {
        // Levels 1, 2, 3, 6 about 3: s² = 14/3; v̄ = (4 · 0.25 + 0)/4.
        let levels = [(1.0, 0.5), (2.0, 0.5), (3.0, 0.5), (6.0, 0.5)];
        let found = Between::new(levels.into_iter());
        assert_eq!((found.records, found.degrees_of_freedom()), (4, 3));
        assert_eq!(found.mean, 3.0);
        assert!((found.sigma - (14.0f64 / 3.0 - 0.25).sqrt()).abs() < 1e-12);
        // χ² with 3 degrees of freedom: 0.215795 and 9.348404 (tables).
        assert!((found.low - (14.0f64 / 9.348_404 - 0.25).sqrt()).abs() < 1e-5);
        assert!((found.high - (14.0f64 / 0.215_795 - 0.25).sqrt()).abs() < 1e-4);
        // Student's t of 3 degrees of freedom has the variance 3.
        let wanted = (14.0f64 - 0.25).sqrt().hypot(3.0);
        assert!((found.for_filter(&[found], 3.0) - wanted).abs() < 1e-9);
    }

    #[test]
    fn of_two_records_all_axes_of_the_sensor_count() {
        let pair = |by: f64| Between::new([(by, 0.0), (-by, 0.0)].into_iter());
        let alike = [pair(1.0), pair(2.0), pair(3.0)];
        // 2 (1 + 4 + 9) over the 5 % point of χ² with 3 degrees of freedom, 0.351846 (tables).
        let wanted = (28.0f64 / 0.351_846).sqrt();
        assert!((alike[0].for_filter(&alike, 0.0) / wanted - 1.0).abs() < 1e-5);
        // One axis alone: √(2/0.00393214).
        let alone = pair(1.0).for_filter(&[pair(1.0)], 0.0);
        assert!((alone / (2.0f64 / 0.003_932_14).sqrt() - 1.0).abs() < 1e-5);
    }

    #[test]
    fn a_scatter_within_the_uncertainty_is_bounded() {
        let found = Between::new([-0.1, 0.0, 0.1, 0.05, -0.05].map(|x| (x, 1.0)).into_iter());
        assert_eq!((found.sigma, found.low), (0.0, 0.0));
        assert!(found.for_filter(&[found], 0.0) >= 1.0);
    }

    #[test]
    fn what_is_not_known_does_not_count_and_one_record_bounds_nothing() {
        let levels = [
            (1.0, 0.5),
            (f64::NAN, 0.1),
            (3.0, 0.5),
            (9.0, f64::INFINITY),
        ];
        let found = Between::new(levels.into_iter());
        assert_eq!((found.records, found.mean, found.within), (2, 2.0, 0.5));
        assert!((found.scatter - 2f64.sqrt()).abs() < 1e-15);
        let one = Between::new([(4.0, 0.5)].into_iter());
        assert_eq!(
            (one.records, one.mean, one.scatter, one.sigma),
            (1, 4.0, 0.0, 0.0)
        );
        assert_eq!((one.low, one.high), (f64::INFINITY, f64::INFINITY));
        assert_eq!(one.for_filter(&[one], 1.0), f64::INFINITY);
        let none = Between::new(std::iter::empty());
        assert_eq!(
            (none.records, none.degrees_of_freedom(), none.mean),
            (0, 0, 0.0)
        );
    }

    #[test]
    fn the_standard_errors_are_taken_out_of_every_bound() {
        let of = |by: &[f64], error| Between::new(by.iter().map(|x| (*x, error)));
        for levels in [
            &[1.0, -2.0, 3.0, 0.0, 1.5][..],
            &[1.0, -2.0, 3.0],
            &[1.0, 4.0],
        ] {
            let (exact, vague) = (of(levels, 0.0), of(levels, 0.4));
            for (a, b) in [
                (exact.sigma, vague.sigma),
                (exact.low, vague.low),
                (exact.high, vague.high),
                (
                    exact.for_filter(&[exact], 0.0),
                    vague.for_filter(&[vague], 0.0),
                ),
            ] {
                assert!(
                    (a * a - b * b - 0.16).abs() < 1e-9 * (1.0 + a * a),
                    "{a} {b}"
                );
            }
            assert_eq!(exact.scatter, exact.sigma);
            let common = vague.for_filter(&[vague], 3.0).powi(2);
            assert!((common - vague.for_filter(&[vague], 0.0).powi(2) - 9.0).abs() < 1e-9 * common);
        }
    }

    #[test]
    fn a_small_scatter_gives_at_least_the_uncertainty() {
        // Three records or two: the bound of the scatter, or where that is less, what each is uncertain.
        let levels = [(1.0, 50.0), (2.0, 50.0), (3.0, 50.0)];
        let found = Between::new(levels.into_iter());
        assert_eq!(found.for_filter(&[found], 0.0), 50.0);
        // Four: the upper bound by χ² with 3 degrees of freedom at 5 %, 0.351846 (tables), s² = 4/3.
        let levels = [-1.0, -1.0, 1.0, 1.0].map(|x| (x, 1.2));
        let found = Between::new(levels.into_iter());
        assert_eq!(found.sigma, 0.0);
        let bound = (4.0f64 / 0.351_846 - 1.44).sqrt();
        assert!((found.for_filter(&[found], 0.0) / bound - 1.0).abs() < 1e-5);
    }
}
