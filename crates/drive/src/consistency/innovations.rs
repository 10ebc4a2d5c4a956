//! Whether innovations are as large as their covariance says, and white.

use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::collections::VecDeque;
use undrift_noise::correlation::white_bound;

/// Lags of the autocorrelation of [`InnovationStatistics`].
pub const LAGS: usize = 10;

/// Whiteness and size of one kind of innovations, streamed: any filter can feed it.
///
/// ```
/// # use undrift_drive as undrift;
/// use undrift::consistency::InnovationStatistics;
/// let mut statistics = InnovationStatistics::new();
/// for k in 0..100 {
///     let alternating = if k % 2 == 0 { 1.0 } else { -1.0 };
///     statistics.add(f64::from(k), &[alternating, 0.5]);
/// }
/// assert_eq!((statistics.updates(), statistics.freedom()), (100, 200));
/// assert!((statistics.autocorrelation(0, 1).unwrap() + 0.99).abs() < 1e-12);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InnovationStatistics {
    updates: u64,
    freedom: u64,
    nis: f64,
    above: u64,
    /// First and last time \[s\].
    span: Option<(f64, f64)>,
    components: Vec<Lagged>,
}

/// Products of one component with its past.
#[derive(Clone, Debug, Default, PartialEq)]
struct Lagged {
    count: u64,
    /// Sums of products at lags 0 … [`LAGS`].
    products: [f64; LAGS + 1],
    recent: VecDeque<f64>,
}

impl InnovationStatistics {
    /// Statistics of no update.
    pub fn new() -> Self {
        Self::default()
    }

    /// Counts the innovation of an update at `time` \[s\], whitened: each component in its standard deviations, independent of the others [–].
    pub fn add(&mut self, time: f64, normalised: &[f64]) {
        let nis: f64 = normalised.iter().map(|v| v * v).sum();
        let freedom = normalised.len();
        self.updates += 1;
        self.freedom += freedom as u64;
        self.nis += nis;
        self.above += u64::from(nis > chi_squared_95(freedom));
        self.span = Some((self.span.map_or(time, |(first, _)| first), time));
        self.components
            .resize_with(self.components.len().max(freedom), Lagged::default);
        for (lagged, &value) in self.components.iter_mut().zip(normalised) {
            lagged.count += 1;
            lagged.products[0] += value * value;
            for (product, past) in lagged.products[1..].iter_mut().zip(&lagged.recent) {
                *product += value * past;
            }
            lagged.recent.truncate(LAGS - 1);
            lagged.recent.push_front(value);
        }
    }

    /// Takes in the sums of another run of the same kind of measurement.
    pub fn merge(&mut self, other: &Self) {
        self.updates += other.updates;
        self.freedom += other.freedom;
        self.nis += other.nis;
        self.above += other.above;
        self.span = match (self.span, other.span) {
            (Some(a), Some(b)) => Some((a.0.min(b.0), a.1.max(b.1))),
            (a, b) => a.or(b),
        };
        let most = self.components.len().max(other.components.len());
        self.components.resize_with(most, Lagged::default);
        for (mine, more) in self.components.iter_mut().zip(&other.components) {
            mine.count += more.count;
            mine.recent.clear();
            for (sum, product) in mine.products.iter_mut().zip(more.products) {
                *sum += product;
            }
        }
    }

    /// Number of updates.
    pub fn updates(&self) -> u64 {
        self.updates
    }

    /// Sum of the degrees of freedom: what [`InnovationStatistics::nis`] is on average when the
    /// filter is right.
    pub fn freedom(&self) -> u64 {
        self.freedom
    }

    /// Sum of the normalised innovations squared.
    pub fn nis(&self) -> f64 {
        self.nis
    }

    /// NIS per degree of freedom: 1 when the filter is right. `None` if unknown or all zero.
    pub fn per_freedom(&self) -> Option<f64> {
        (self.freedom > 0).then(|| self.nis / self.freedom as f64)
    }

    /// Two-sided 95 % bounds of [`InnovationStatistics::per_freedom`]; innovations are independent
    /// of each other when the filter is right, so they hold along one run too.
    pub fn bounds(&self) -> (f64, f64) {
        average_bounds(1, self.freedom as usize)
    }

    /// Share of the updates whose NIS is above the 95 % point of its chi-squared: 0.05 when right.
    pub fn share_above_95(&self) -> Option<f64> {
        (self.updates > 0).then(|| self.above as f64 / self.updates as f64)
    }

    /// First and last time \[s\].
    pub fn span(&self) -> Option<(f64, f64)> {
        self.span
    }

    /// Components seen: the most degrees of freedom of an update.
    pub fn components(&self) -> usize {
        self.components.len()
    }

    /// Autocorrelation of a component at a lag of 0 … [`LAGS`] updates, about zero, which the mean
    /// of an innovation is when the filter is right. `None` if unknown or all zero.
    pub fn autocorrelation(&self, component: usize, lag: usize) -> Option<f64> {
        let products = &self.components.get(component)?.products;
        let product = products.get(lag)?;
        (products[0] > 0.0).then(|| product / products[0])
    }

    /// 95 % bound of the autocorrelations of a component that is white: ±1.96/√n.
    pub fn white_bound(&self, component: usize) -> Option<f64> {
        let lagged = self.components.get(component)?;
        Some(white_bound(lagged.count as usize))
    }
}

/// The 95 % point of chi-squared, computed once for the freedoms of usual measurements.
fn chi_squared_95(freedom: usize) -> f64 {
    use std::sync::LazyLock;
    fn point(freedom: usize) -> f64 {
        ChiSquared::new(freedom as f64).map_or(f64::INFINITY, |law| law.inverse_cdf(0.95))
    }
    static POINTS: LazyLock<[f64; 7]> = LazyLock::new(|| std::array::from_fn(point));
    POINTS
        .get(freedom)
        .copied()
        .unwrap_or_else(|| point(freedom))
}

/// Two-sided 95 % bounds of the average of `count` independent chi-squared values of `freedom` each.
/// NaN without any.
///
/// ```
/// # use undrift_drive as undrift;
/// use undrift::consistency::average_bounds;
/// // The NEES of the position, three states, of 50 runs at one instant.
/// let (low, high) = average_bounds(3, 50);
/// assert!((low - 2.36).abs() < 0.01 && (high - 3.72).abs() < 0.01);
/// ```
pub fn average_bounds(freedom: usize, count: usize) -> (f64, f64) {
    let n = count as f64;
    ChiSquared::new(freedom as f64 * n).map_or((f64::NAN, f64::NAN), |law| {
        (law.inverse_cdf(0.025) / n, law.inverse_cdf(0.975) / n)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sums of two runs are those of both, but for what is correlated over the end of the first.
    #[test]
    fn merged_statistics_are_those_of_all_updates() {
        let runs = [
            [[3.0, 0.1], [0.2, -0.5], [1.0, 2.5]],
            [[-2.0, 2.0], [0.3, 0.4], [0.1, 3.5]],
        ];
        let of = |run: &[[f64; 2]; 3], start: f64| {
            let mut statistics = InnovationStatistics::new();
            for (k, values) in run.iter().enumerate() {
                statistics.add(start + k as f64, values);
            }
            statistics
        };
        let mut both = of(&runs[0], 10.0);
        both.merge(&of(&runs[1], 100.0));
        let squares: f64 = runs.concat().concat().iter().map(|v| v * v).sum();
        assert_eq!(
            (both.updates(), both.freedom(), both.components()),
            (6, 12, 2)
        );
        assert!((both.nis() - squares).abs() < 1e-12);
        assert!((both.per_freedom().unwrap() - squares / 12.0).abs() < 1e-12);
        // χ² of two degrees of freedom is above 5.99 in four: 9.0, 7.2, 8.0, 12.3.
        assert_eq!(both.share_above_95(), Some(4.0 / 6.0));
        assert_eq!(both.span(), Some((10.0, 102.0)));
        // Lag one of the first component: two products of each run.
        let products = 3.0 * 0.2 + 0.2 * 1.0 - 2.0 * 0.3 + 0.3 * 0.1;
        let power = 9.0 + 0.04 + 1.0 + 4.0 + 0.09 + 0.01;
        let expected = products / power;
        assert!((both.autocorrelation(0, 1).unwrap() - expected).abs() < 1e-12);
        // Nothing changes with a run without updates.
        let mut same = both.clone();
        same.merge(&InnovationStatistics::new());
        assert_eq!(
            (same.updates(), same.span(), same.share_above_95()),
            (6, both.span(), Some(4.0 / 6.0))
        );
    }
}
