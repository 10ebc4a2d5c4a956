//! Means, slopes and their differences by Student's t.

use super::{Log, SIGNIFICANCE};
use statrs::distribution::{ContinuousCDF, StudentsT};
use undrift_results::{Effect, Number, Slope, series::to_digits};

/// Share of the sum of squares of a cause that must lie within units for its effect to be estimated there: below it
/// units of ten logs that differ as much as their logs tell more (σ² (1 + 10) of a mean of ten against σ²).
const WITHIN: f64 = 0.1;
/// Differences of logarithms below this are rounding errors.
const ROUNDING: f64 = 1e-9;

/// A cause and a log's value.
#[derive(Clone, Copy)]
pub(super) struct Point {
    pub(super) unit: usize,
    pub(super) x: f64,
    pub(super) y: f64,
}

pub(super) fn mean(points: &[Point]) -> Point {
    let mean = |of: fn(&Point) -> f64| Moments::new(points.iter().map(of)).mean;
    Point {
        unit: 0,
        x: mean(|point| point.x),
        y: mean(|point| point.y),
    }
}

/// The slope of values on a cause with a level for each unit, if enough of the cause's spread is within units.
pub(super) fn within_units(points: &[Point]) -> Option<Estimate> {
    let within = Line::fit(points.chunk_by(|a, b| a.unit == b.unit));
    let all = Line::fit([points]);
    (within.xx >= WITHIN * all.xx).then(|| within.slope())?
}

/// Sums of squares and products about the means of groups.
#[derive(Default)]
pub(super) struct Line {
    xx: f64,
    xy: f64,
    yy: f64,
    freedom: f64,
}

impl Line {
    pub(super) fn fit<'a>(groups: impl IntoIterator<Item = &'a [Point]>) -> Self {
        let mut sums = Self {
            freedom: -1.0,
            ..Self::default()
        };
        for points in groups.into_iter().filter(|points| !points.is_empty()) {
            let middle = mean(points);
            for point in points {
                let (x, y) = (point.x - middle.x, point.y - middle.y);
                sums.xx += x * x;
                sums.xy += x * y;
                sums.yy += y * y;
            }
            sums.freedom += points.len() as f64 - 1.0;
        }
        sums
    }

    /// By least squares.
    pub(super) fn slope(&self) -> Option<Estimate> {
        if self.freedom < 1.0 || self.xx <= 0.0 {
            return None;
        }
        let value = self.xy / self.xx;
        let rest = (self.yy - value * self.xy).max(0.0);
        let error = (rest / self.freedom / self.xx).sqrt();
        Some(Estimate {
            value,
            error,
            freedom: self.freedom,
        })
    }
}

/// Difference of two means whose variances differ (Welch, Biometrika 34 (1947) 28).
pub(super) fn welch(a: &Moments, b: &Moments) -> Option<Estimate> {
    let term = |of: &Moments| Some((of.variance()? / of.n, of.n - 1.0));
    Some(Estimate::new(a.mean - b.mean, [term(a)?, term(b)?]))
}

/// Number, mean and sum of squares about the mean.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moments {
    pub(super) n: f64,
    pub(super) mean: f64,
    squares: f64,
}

impl Moments {
    pub(super) fn new(values: impl Iterator<Item = f64> + Clone) -> Self {
        let n = values.clone().count() as f64;
        let mean = values.clone().sum::<f64>() / n;
        let squares = values.map(|value| (value - mean).powi(2)).sum();
        Self { n, mean, squares }
    }

    pub(super) fn from_logs(logs: &[Log<'_>]) -> Self {
        Self::new(logs.iter().map(|log| log.value))
    }

    /// Those of the other values.
    pub(super) fn without(&self, value: f64) -> Self {
        let (n, apart) = (self.n - 1.0, value - self.mean);
        Self {
            n,
            mean: self.mean - apart / n,
            squares: (self.squares - apart * apart * self.n / n).max(0.0),
        }
    }

    pub(super) fn variance(&self) -> Option<f64> {
        (self.n > 1.0).then(|| self.squares / (self.n - 1.0))
    }
}

/// Scatter of logs within units.
pub(super) struct Spread {
    squares: f64,
    pub(super) freedom: f64,
}

impl Spread {
    pub(super) fn within(units: &[Moments]) -> Self {
        Self {
            squares: units.iter().map(|unit| unit.squares).sum(),
            freedom: units.iter().map(|unit| unit.n - 1.0).sum(),
        }
    }

    pub(super) fn variance(&self) -> f64 {
        if self.freedom > 0.0 {
            self.squares / self.freedom
        } else {
            0.0
        }
    }

    /// A log that is not counted against its unit.
    pub(super) fn beside(&self, value: f64, unit: &Moments) -> Estimate {
        let variance = self.variance() * (1.0 + 1.0 / unit.n);
        let error = variance.max(0.0).sqrt();
        Estimate {
            value: value - unit.mean,
            error,
            freedom: self.freedom,
        }
    }

    /// A log that is counted, against the rest of its unit.
    pub(super) fn deleted(&self, value: f64, unit: &Moments) -> Estimate {
        let rest = unit.without(value);
        let others = Self {
            squares: self.squares - (unit.squares - rest.squares),
            freedom: self.freedom - 1.0,
        };
        others.beside(value, &rest)
    }
}

/// A difference of logarithms, or a slope, with what Student's t needs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Estimate {
    pub(super) value: f64,
    pub(super) error: f64,
    pub(super) freedom: f64,
}

impl Estimate {
    /// With the sum of two variances, each with its degrees of freedom (Satterthwaite, Biometrics Bulletin 2 (1946) 110).
    pub(super) fn new(value: f64, variances: [(f64, f64); 2]) -> Self {
        let variance: f64 = variances.iter().map(|(variance, _)| variance).sum();
        let share = |(part, freedom): &(f64, f64)| (part / variance).powi(2) / freedom;
        let counted = variances.iter().filter(|(variance, _)| *variance > 0.0);
        let freedom = 1.0 / counted.map(share).sum::<f64>();
        Self {
            value,
            error: variance.sqrt(),
            freedom,
        }
    }

    fn student(&self) -> Option<StudentsT> {
        // Beyond this t is normal to 1e-6, and its quantile is found by bisection.
        (self.freedom > 0.0).then(|| StudentsT::new(0.0, 1.0, self.freedom.min(1e6)).ok())?
    }

    /// Two-sided p value: the probability of a magnitude at least this large without an effect.
    pub(super) fn probability(&self) -> f64 {
        let t = (self.value / self.error).abs();
        let known = t.is_finite() && self.value.abs() > ROUNDING;
        let student = self.student().filter(|_| known);
        student.map_or(1.0, |student| 2.0 * student.cdf(-t))
    }

    /// What the estimate and the ends of its 95 % interval are the logarithms of.
    pub(super) fn interval(&self, of: impl Fn(f64) -> f64) -> [Number; 3] {
        let quantile = self.student().map_or(f64::NAN, |t| t.inverse_cdf(0.975));
        let half = quantile * self.error;
        [self.value, self.value - half, self.value + half].map(|log| to_digits(of(log)).into())
    }

    pub(super) fn effect(&self, p: f64) -> Effect {
        let [times, low, high] = self.interval(f64::exp);
        Effect {
            times,
            low,
            high,
            freedom: to_digits(self.freedom).into(),
            p: to_digits(p).into(),
            found: p < SIGNIFICANCE,
        }
    }
}

pub(super) fn slope((slope, p): (Estimate, f64)) -> Slope {
    let [percent_per_k, low, high] = slope.interval(|log| 100.0 * log.exp_m1());
    Slope {
        percent_per_k,
        low,
        high,
        freedom: to_digits(slope.freedom).into(),
        p: to_digits(p).into(),
        found: p < SIGNIFICANCE,
    }
}

/// Probabilities adjusted for their number (Holm, Scandinavian Journal of Statistics 6 (1979) 65).
pub(super) fn holm(p: &[f64]) -> Vec<f64> {
    let mut order = Vec::from_iter(0..p.len());
    order.sort_by(|a, b| p[*a].total_cmp(&p[*b]));
    let (mut adjusted, mut most) = (p.to_vec(), 0.0_f64);
    for (rank, place) in order.into_iter().enumerate() {
        most = most.max(p[place] * (p.len() - rank) as f64).min(1.0);
        adjusted[place] = most;
    }
    adjusted
}
