//! Reference values and series of the public data.

pub mod generators;
pub mod random_starts;

use crate::public;
use flate2::read::GzDecoder;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng;
use serde_json::Value;
use std::fs::File;
use std::io::Read;

/// The classical series in the reference file.
pub const CLASSIC: [&str; 8] = [
    "lh",
    "LakeHuron",
    "sunspot.year",
    "Nile",
    "lynx",
    "SeriesA",
    "SeriesB",
    "SeriesF",
];

/// The classical series and a simulated one.
pub fn names() -> impl Iterator<Item = &'static str> {
    CLASSIC.into_iter().chain(["z100k"])
}

/// White noise of unit variance.
pub fn white_noise(seed: u64, count: usize) -> Vec<f64> {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    (0..count)
        .map(|_| StandardNormal.sample(&mut rng))
        .collect()
}

/// The file of reference values, if it is there.
pub fn reference() -> Option<Value> {
    let text = std::fs::read_to_string(public::find("series/reference.json")?).unwrap();
    // The file writes what is undefined as NaN, which is not JSON.
    Some(serde_json::from_str(&text.replace("NaN", "null")).expect("valid JSON"))
}

/// Columns of a gzip'd CSV, its header left out.
pub fn columns(path: &str) -> Vec<Vec<f64>> {
    let mut text = String::new();
    let file = File::open(public::folder().join(path)).expect("a file of the public data");
    GzDecoder::new(file)
        .read_to_string(&mut text)
        .expect("text");
    let mut columns: Vec<Vec<f64>> = Vec::new();
    for line in text.lines() {
        let values: Result<Vec<f64>, _> = line.split(',').map(str::parse).collect();
        let Ok(values) = values else { continue };
        columns.resize(values.len(), Vec::new());
        for (column, value) in columns.iter_mut().zip(values) {
            column.push(value);
        }
    }
    columns
}

/// The columns of a record of the public data, if it is there.
pub fn record(path: &str) -> Option<Vec<Vec<f64>>> {
    public::find(path).map(|_| columns(path))
}

/// One simulated series, or a classical one out of the reference file.
pub fn series(reference: &Value, name: &str) -> Vec<f64> {
    let classic = &reference["classic"][name]["data"];
    if classic.is_array() {
        numbers(classic)
    } else {
        columns(&format!("series/{name}.csv.gz")).swap_remove(0)
    }
}

/// A list of numbers.
pub fn numbers(value: &Value) -> Vec<f64> {
    let items = value.as_array().expect("a list");
    items
        .iter()
        .map(|v| v.as_f64().expect("a number"))
        .collect()
}

/// A number.
pub fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

/// Panics unless |value / expected − 1| ≤ tolerance (both 0 is equal).
pub fn close(value: f64, expected: f64, tolerance: f64, what: &str) {
    let error = (value - expected).abs();
    assert!(
        error <= tolerance * expected.abs(),
        "{what}: {value:e} for {expected:e}, relative {:e}",
        error / expected.abs()
    );
}

/// Panics unless |value − expected| ≤ tolerance.
pub fn near(value: f64, expected: f64, tolerance: f64, what: &str) {
    assert!(
        (value - expected).abs() <= tolerance,
        "{what}: {value:e} for {expected:e}"
    );
}

/// Log-likelihood with all variances of the model scaled by the best common factor `Σ(v²/V)/n`.
pub fn with_best_scale(found: &undrift_noise::composite::RecordLikelihood) -> f64 {
    let n = found.observations as f64;
    let scale = found.sum_of_squares / n;
    -0.5 * (n * (std::f64::consts::TAU * scale).ln() + n + found.log_determinant)
}
