//! Random models and records for the property tests.

use proptest::prelude::*;

/// The same cases at every run; PROPTEST_CASES asks for more of them.
pub fn seeded() -> ProptestConfig {
    ProptestConfig {
        rng_seed: prop::test_runner::RngSeed::Fixed(1),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

/// Partial autocorrelations of a polynomial of order 0 … `orders`.
pub fn partials(orders: usize) -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(-0.95..0.95f64, 0..=orders)
}

/// The polynomial `1 − c1 B − …` of partial autocorrelations, by Durbin's recursion.
pub fn polynomial(partials: &[f64]) -> Vec<f64> {
    let mut c: Vec<f64> = Vec::new();
    for &kappa in partials {
        let turned: Vec<f64> = c.iter().rev().copied().collect();
        c.iter_mut().zip(turned).for_each(|(c, t)| *c -= kappa * t);
        c.push(kappa);
    }
    c
}

/// A stationary or invertible polynomial of order 0 … `orders`.
pub fn stable(orders: usize) -> impl Strategy<Value = Vec<f64>> {
    partials(orders).prop_map(|partials| polynomial(&partials))
}

/// A record of numbers about zero that are not all the same.
pub fn record(lengths: std::ops::Range<usize>) -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(-1.0..1.0f64, lengths)
}

/// Back to front.
pub fn reversed(x: &[f64]) -> Vec<f64> {
    x.iter().rev().copied().collect()
}
