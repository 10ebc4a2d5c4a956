//! Units and logs one by one: predictions (BLUP), and whether one has its place among the others.

use super::{
    Fit, Grouping, LogWeights, Nested,
    fit::{Likelihood, two_sided},
    log_weights,
    sums::Sums,
    unit_weights,
};
use nalgebra::{DMatrix, DVector};

/// A unit or log against the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shift {
    /// How far it lies from what the fixed effects, and of a log the unit, predict.
    pub estimate: f64,
    /// Standard deviation of that, were it like the others.
    pub spread: f64,
    /// Degrees of freedom of t.
    pub freedom: f64,
    /// Probability of as large a magnitude if it is like the others.
    pub probability: f64,
}

/// A unit's part of the likelihood.
struct Unit {
    /// X′A⁻¹1.
    sum: DVector<f64>,
    /// r′A⁻¹1.
    residual: f64,
    /// 1′A⁻¹1.
    weight: f64,
    /// λ₂/(1 + Wλ₂): the variance of its intercept given its rows, for σ² = 1.
    left: f64,
}

fn form(matrix: &DMatrix<f64>, vector: &DVector<f64>) -> f64 {
    vector.dot(&(matrix * vector))
}

impl Nested {
    fn weights(&self, log: usize, ratio: f64) -> LogWeights {
        log_weights(self.size(log), ratio, self.is_aside(Grouping::Log, log))
    }

    fn unit(&self, unit: usize, ratios: [f64; 2], beta: &DVector<f64>) -> Unit {
        let mut sum = vec![0.0; self.columns];
        let mut weight = 0.0;
        for log in self.units.get(unit).cloned().unwrap_or_default() {
            let scale = self.weights(log, ratios[0]).scale;
            weight += scale * self.size(log) as f64;
            for (total, value) in sum.iter_mut().zip(self.sum(log)) {
                *total += scale * value;
            }
        }
        let y = sum.pop().unwrap_or_default();
        let sum = DVector::from_vec(sum);
        Unit {
            residual: y - sum.dot(beta),
            weight,
            left: unit_weights(weight, ratios[1], self.is_aside(Grouping::Unit, unit)).0,
            sum,
        }
    }

    /// Each unit against the others. One with an intercept of its own has no part in what it is compared with; of
    /// the others the residual, standardised with it in, is transformed to one without it (Cook and Weisberg,
    /// Residuals and Influence in Regression, 1982, section 2.2.2). `None` of a unit that cannot be told from
    /// the fixed effects, such as the only one of its type.
    pub fn unit_shifts(&self, fit: &Fit) -> Vec<Option<Shift>> {
        let freedom = self.between_freedom(fit);
        let shift = |unit: usize| {
            let of = self.unit(unit, fit.ratios, &fit.profile.beta);
            let inverse = &fit.profile.inverse;
            if of.weight <= 0.0 {
                return None;
            }
            if self.is_aside(Grouping::Unit, unit) {
                let mean = &of.sum / of.weight;
                let square = fit.ratios[1] + 1.0 / of.weight + form(inverse, &mean);
                return Some(Shift::without(
                    of.residual / of.weight,
                    fit.variance * square,
                    freedom,
                ));
            }
            let scale = 1.0 / (1.0 + of.weight * fit.ratios[1]);
            let (score, own) = (scale * of.residual, scale * of.weight);
            let information = own - scale * scale * form(inverse, &of.sum);
            Shift::within(score, information, own, fit.variance, freedom)
        };
        (0..self.units.len()).map(shift).collect()
    }

    /// Each log against the others and the rest of its unit, as [`Self::unit_shifts`].
    pub fn log_shifts(&self, fit: &Fit) -> Vec<Option<Shift>> {
        let p = self.columns - 1;
        let Likelihood { beta, inverse, .. } = &fit.profile;
        let units: Vec<Unit> = (0..self.units.len())
            .map(|unit| self.unit(unit, fit.ratios, beta))
            .collect();
        let spent: f64 = units.iter().map(|unit| unit.left * unit.weight).sum();
        let aside = self.aside[0].iter().filter(|aside| **aside).count();
        let known = fit.profile.aliased.iter().filter(|a| !**a).count();
        let freedom = self.sizes.len() as f64 - aside as f64 - known as f64 - spent;
        let mut shifts = Vec::with_capacity(self.sizes.len());
        for (place, logs) in self.units.iter().enumerate() {
            let Some(unit) = units.get(place) else {
                continue;
            };
            for log in logs.clone() {
                let n = self.size(log) as f64;
                let sum = self.sum(log);
                let of_x = DVector::from_iterator(p, sum.iter().copied().take(p));
                let residual = sum.last().copied().unwrap_or_default() - of_x.dot(beta);
                let expected = unit.left * unit.residual;
                if self.is_aside(Grouping::Log, log) {
                    // A unit without another log says nothing about its own one.
                    let alone = unit.weight <= 0.0 && self.is_aside(Grouping::Unit, place);
                    let rest = &of_x / n - unit.left * &unit.sum;
                    let square = fit.ratios[0] + 1.0 / n + unit.left + form(inverse, &rest);
                    shifts.push((!alone).then(|| {
                        Shift::without(residual / n - expected, fit.variance * square, freedom)
                    }));
                    continue;
                }
                let scale = self.weights(log, fit.ratios[0]).scale;
                let weight = scale * n;
                let score = scale * residual - weight * expected;
                let own = weight - unit.left * weight * weight;
                let of_x = scale * of_x - (unit.left * weight) * &unit.sum;
                let information = own - form(inverse, &of_x);
                shifts.push(Shift::within(
                    score,
                    information,
                    own,
                    fit.variance,
                    freedom,
                ));
            }
        }
        shifts
    }

    /// The intercept of each unit, its best linear unbiased prediction, with its variance. That of one set aside is
    /// its own mean. The spread between units is uncertain: both are means over its restricted likelihood (as over
    /// a posterior with a flat prior of the standard deviation; Gelman, Bayesian Analysis 1 (2006) 515), since at
    /// the one most likely value, which can be zero, intervals are too short.
    pub fn predictions(&self, fit: &Fit) -> Vec<(f64, f64)> {
        let mut sums = vec![(0.0, 0.0, 0.0); self.units.len()];
        let known = Sums::of(self);
        for (ratio, likelihood) in self.spreads(&known, fit) {
            let ratios = [fit.ratios[0], ratio];
            let Some(profile) = Likelihood::of(&known, ratios) else {
                continue;
            };
            for (sum, (mean, square)) in sums.iter_mut().zip(self.predicted(ratios, &profile)) {
                sum.0 += likelihood;
                sum.1 += likelihood * mean;
                sum.2 += likelihood * (square + mean * mean);
            }
        }
        let moments = |(all, mean, square): (f64, f64, f64)| {
            let mean = mean / all;
            (mean, (square / all - mean * mean).max(0.0))
        };
        sums.into_iter().map(moments).collect()
    }

    /// The same at some ratios.
    pub(super) fn predicted(&self, ratios: [f64; 2], profile: &Likelihood) -> Vec<(f64, f64)> {
        let variance = profile.squares / profile.freedom;
        let inverse = &profile.inverse;
        let one = |place: usize| {
            let unit = self.unit(place, ratios, &profile.beta);
            let own = form(inverse, &unit.sum);
            let square = unit.left + unit.left * unit.left * own;
            (unit.left * unit.residual, variance * square)
        };
        (0..self.units.len()).map(one).collect()
    }

    /// Ratios of the variance between units at equal steps of its root, with their likelihoods relative to the
    /// largest.
    fn spreads(&self, sums: &Sums, fit: &Fit) -> Vec<(f64, f64)> {
        const STEPS: u8 = 16;
        /// −2 ln of the likelihood that is left.
        const LEFT: f64 = 9.0;
        if !self.has(Grouping::Unit) {
            return vec![(fit.ratios[1], 1.0)];
        }
        let at = |root: f64| sums.criterion([fit.ratios[0], root * root]);
        let least = sums.criterion(fit.ratios);
        let mut last = fit.ratios[1].sqrt().max(0.02);
        for _ in 0..40 {
            if at(last) - least > LEFT {
                break;
            }
            last *= 1.4;
        }
        let roots = (0..=STEPS).map(|k| last * f64::from(k) / f64::from(STEPS));
        roots
            .map(|root| (root * root, (0.5 * (least - at(root))).exp()))
            .collect()
    }
}

impl Shift {
    /// Of one that the variances do not contain.
    fn without(estimate: f64, square: f64, freedom: f64) -> Self {
        let spread = square.sqrt();
        Self {
            estimate,
            spread,
            freedom,
            probability: if freedom >= 1.0 {
                two_sided(estimate / spread, freedom)
            } else {
                1.0
            },
        }
    }

    /// Of one that they contain, from the derivative of the likelihood by its shift and the information on it.
    fn within(score: f64, information: f64, own: f64, variance: f64, freedom: f64) -> Option<Self> {
        if own <= 0.0 || information <= 1e-9 * own {
            return None;
        }
        let spread = (variance / information).sqrt();
        let estimate = score / information;
        let square = (estimate / spread).powi(2);
        // Without it there is one degree of freedom less.
        let rest = freedom - 1.0;
        let probability = if rest < 1.0 {
            1.0
        } else if square < freedom {
            two_sided((square * rest / (freedom - square)).sqrt(), rest)
        } else {
            0.0
        };
        Some(Self {
            estimate,
            spread,
            freedom: rest,
            probability,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Estimate and spread 1/2; of one degree of freedom t is Cauchy's, with half of it beyond one.
    #[test]
    fn below_one_degree_of_freedom_nothing_stands_out() {
        let within = |score: f64, freedom| Shift::within(score, 8.0, 9.0, 2.0, freedom).unwrap();
        let shift = within(4.0, 2.0);
        assert_eq!((shift.estimate, shift.spread), (0.5, 0.5));
        assert_eq!(shift.freedom, 1.0);
        assert!((shift.probability - 0.5).abs() < 1e-12, "{shift:?}");
        for freedom in [1.2, 1.99] {
            assert_eq!(within(4.0, freedom).probability, 1.0);
        }
        // As much as all that the rows vary.
        assert_eq!(within(16.0, 2.0).probability, 0.0);
        assert_eq!(Shift::within(4.0, 0.0, 9.0, 2.0, 2.0), None);
        assert_eq!(Shift::within(4.0, 8.0, 0.0, 2.0, 2.0), None);
        let shift = Shift::without(3.0, 9.0, 1.0);
        assert!((shift.probability - 0.5).abs() < 1e-12, "{shift:?}");
        assert_eq!(Shift::without(3.0, 9.0, 0.99).probability, 1.0);
    }
}
