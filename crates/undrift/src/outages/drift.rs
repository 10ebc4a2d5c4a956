//! How far a model drifts since the cut.

use super::errors::OutageErrors;

/// Root mean square over outages of the horizontal error \[m\] at each time since the cut \[s\], at the times the first one
/// was sampled.
pub fn drift_curve<'a>(outages: impl IntoIterator<Item = &'a OutageErrors>) -> Vec<(f64, f64)> {
    let outages = Vec::from_iter(outages);
    let times: Vec<f64> = outages
        .first()
        .map_or(Vec::new(), |o| o.drift.iter().map(|p| p.0).collect());
    let rms = |(i, &t): (usize, &f64)| {
        let squares: Option<Vec<f64>> = outages
            .iter()
            .map(|o| o.drift.get(i).map(|p| p.1 * p.1).filter(|s| s.is_finite()))
            .collect();
        let squares = squares?;
        let mean = squares.iter().sum::<f64>() / squares.len() as f64;
        Some((t, mean.sqrt()))
    };
    times.iter().enumerate().filter_map(rms).collect()
}
