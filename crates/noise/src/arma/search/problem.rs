//! The likelihood that is searched, and its gradient.
//!
//! Search coordinates are the artanh of partial autocorrelations, φ's and then θ's
//! ([`crate::arma::polynomial`]): every point of them is stationary and invertible, and near a unit root they
//! are the logarithm of its distance.
//!
//! A [`Problem`] is what is constant during a search; it owns no optimum and changes nothing. The
//! value to be minimised is −log L in natural logarithms, σ² and the mean at their best for each
//! point, so that a difference of 1 is comparable whatever the unit of the record.

use crate::arma::{
    gradient::At,
    kalman,
    kernel::Coefficients,
    likelihood::{self, Likelihood, Mean},
    polynomial::{by_search, from_search, multiply},
};

use super::{GLANCE, SAME};

/// The record, or several, and what is asked of it. With a unit root `p` counts the other AR roots only, and an
/// unbroken record is held as its differences, whose likelihood that is.
///
/// Joint fits: the records share φ, θ and σ², each has its own start and mean; see
/// [`Likelihood::and`].
pub(in crate::arma) struct Problem<'a> {
    /// The record \[unit\]; NaN is a missing sample.
    pub(in crate::arma) samples: &'a [f64],
    /// Whether the mean is known or estimated with the rest.
    pub(in crate::arma) mean: Mean,
    /// A value near the mean, taken off first \[unit\].
    pub(in crate::arma) centre: f64,
    /// Some samples are missing: the Kalman filter is needed.
    pub(in crate::arma) gaps: bool,
    /// Of a record with gaps: these bridged; none where it has a unit root on top or more missing than a search may
    /// overlook.
    pub(in crate::arma) bridged: Option<&'a [f64]>,
    /// φ gets a root at 1 on top (records with gaps only).
    pub(in crate::arma) unit_root: bool,
    /// Further records of the same process, each with a start and a mean of its own.
    pub(in crate::arma) rest: &'a [Problem<'a>],
}

impl Problem<'_> {
    /// φ (the factor 1 − B included where there is one) and θ at search coordinates.
    pub(in crate::arma) fn coefficients(&self, z: &[f64], p: usize) -> Coefficients {
        let phi = from_search(&z[..p]);
        let theta = from_search(&z[p..]);
        if self.unit_root {
            (multiply(&phi, &[1.0]), theta)
        } else {
            (phi, theta)
        }
    }

    /// The coefficients without the unit root.
    pub(super) fn plain(z: &[f64], p: usize) -> Coefficients {
        (from_search(&z[..p]), from_search(&z[p..]))
    }

    /// Derivatives by the search coordinates, `None` where one is not finite.
    ///
    /// Chain rule through [`by_search`]; `z` holds p coordinates of φ, then those of θ.
    pub(super) fn by_search(z: &[f64], by_phi: &[f64], by_theta: &[f64]) -> Option<Vec<f64>> {
        let (phi, theta) = z.split_at(by_phi.len());
        let mut by = by_search(phi, by_phi);
        by.extend(by_search(theta, by_theta));
        by.iter().all(|by| by.is_finite()).then_some(by)
    }

    /// The likelihood at several points of the same order: of an unbroken record in one pass.
    ///
    /// `None` for a point that has no likelihood: φ not stationary to working precision.
    pub(in crate::arma) fn likelihoods(&self, points: &[Coefficients]) -> Vec<Option<Likelihood>> {
        if self.gaps {
            return self.one_by_one(points);
        }
        let own = likelihood::unbroken(self.samples, self.mean, self.centre, points);
        self.with_rest(own, |other| other.likelihoods(points))
    }

    /// The likelihoods of this record with those of the further ones.
    ///
    /// Joint likelihood of independent records; `None` as soon as one of them has none.
    pub(super) fn with_rest(
        &self,
        own: Vec<Option<Likelihood>>,
        of: impl Fn(&Problem<'_>) -> Vec<Option<Likelihood>>,
    ) -> Vec<Option<Likelihood>> {
        self.rest.iter().fold(own, |joint, other| {
            let pairs = joint.into_iter().zip(of(other));
            pairs.map(|(a, b)| a?.and(b?)).collect()
        })
    }

    /// Likelihoods by the Kalman filter, for records with gaps.
    pub(super) fn one_by_one(&self, points: &[Coefficients]) -> Vec<Option<Likelihood>> {
        let one = |(phi, theta): &Coefficients| {
            kalman::with_gaps(
                self.samples,
                self.mean,
                self.centre,
                phi,
                theta,
                self.unit_root,
            )
        };
        let own = points.iter().map(one).collect();
        self.with_rest(own, |other| other.one_by_one(points))
    }

    /// Likelihood at one point.
    pub(in crate::arma) fn likelihood(&self, phi: &[f64], theta: &[f64]) -> Option<Likelihood> {
        let point = (phi.to_vec(), theta.to_vec());
        self.likelihoods(&[point]).pop().flatten()
    }

    /// Negative log-likelihoods at search coordinates, +∞ where the likelihood is undefined.
    ///
    /// `z` are points of p + q coordinates each, `p` of them of φ.
    pub(in crate::arma) fn objective(&self, z: &[Vec<f64>], p: usize) -> Vec<f64> {
        let points: Vec<_> = z.iter().map(|z| self.coefficients(z, p)).collect();
        // Of one root the steady state loses no digits, and does without a response that may last for long.
        let single = points
            .iter()
            .all(|(phi, theta)| phi.len().max(theta.len()) == 1);
        let found = if single {
            self.one_by_one(&points)
        } else {
            self.likelihoods(&points)
        };
        found
            .iter()
            .map(|at| at.map_or(f64::INFINITY, |at| -at.log_likelihood))
            .collect()
    }

    /// The gradient of the objective, of unbroken records; `None` where differences cost as little: see [`Self::objective`].
    ///
    /// A record with gaps has no exact gradient here: differences take its place near the end of a
    /// search.
    pub(in crate::arma) fn gradient(&self, z: &[f64], p: usize) -> Option<Vec<f64>> {
        if self.gaps {
            return None;
        }
        self.gradient_bridged(z, p)
    }

    /// The gradient; of a record with gaps that of its bridged one, near enough for a search far from its end.
    ///
    /// Exact for unbroken records; O(N (p + q)) for all derivatives together. For orders with
    /// max(p, q) < 2 the differences are as cheap, and `None` is returned.
    pub(super) fn gradient_bridged(&self, z: &[f64], p: usize) -> Option<Vec<f64>> {
        let (phi, theta) = self.coefficients(z, p);
        if phi.len().max(theta.len()) < 2 {
            return None;
        }
        let mut records = Vec::with_capacity(1 + self.rest.len());
        for of in std::iter::once(self).chain(self.rest) {
            let whole = if of.gaps { of.bridged? } else { of.samples };
            records.push(At::new(whole, of.mean, of.centre, &phi, &theta)?);
        }
        let observations: usize = records.iter().map(At::observations).sum();
        let weight = observations as f64 / records.iter().map(|at| at.squares).sum::<f64>();
        let mut by = (vec![0.0; phi.len()], vec![0.0; theta.len()]);
        for record in &records {
            let (by_phi, by_theta) = record.gradient(weight);
            by.0.iter_mut().zip(by_phi).for_each(|(sum, by)| *sum += by);
            by.1.iter_mut()
                .zip(by_theta)
                .for_each(|(sum, by)| *sum += by);
        }
        Self::by_search(z, &by.0, &by.1)
    }

    /// Whether the Kalman filter finds the same likelihood there, on the first part of a long record. Where roots nearly
    /// coincide on the edge of the invertible region, that of an unbroken record may be rounding: no optimum.
    ///
    /// Agreement to 1e-4 in log-likelihood counts as the same.
    pub(super) fn is_confirmed(&self, z: &[f64], p: usize) -> bool {
        let part = Problem {
            samples: &self.samples[..self.samples.len().min(GLANCE)],
            rest: &[],
            ..*self
        };
        let (phi, theta) = self.coefficients(z, p);
        let (mean, centre) = (self.mean, self.centre);
        let exact = kalman::filtered(part.samples, mean, centre, &phi, &theta, self.unit_root);
        match (part.likelihood(&phi, &theta), exact) {
            (Some(at), Some(exact)) => (at.log_likelihood - exact.log_likelihood).abs() < SAME,
            _ => true,
        }
    }

    /// Evaluations of the approximate likelihood that a search may spend.
    pub(super) fn screening_budget(dimension: usize, effort: f64) -> f64 {
        (effort * 30_000.0).max(40.0 * (dimension + 2) as f64)
    }

    /// Likelihood evaluations that a search may spend: seconds for a long record, thoroughness
    /// for a short one.
    pub(super) fn budget(&self, dimension: usize, effort: f64) -> f64 {
        let per_sample = if self.gaps { 2.0 } else { 1.0 } * (1.0 + 0.5 * dimension as f64);
        let rest: usize = self.rest.iter().map(|other| other.samples.len()).sum();
        let cost = (self.samples.len() + rest) as f64 * per_sample + 3_000.0;
        (effort * 2e9 / cost).clamp(40.0 * (dimension + 2) as f64, effort * 100_000.0)
    }
}
