//! Growth of a model's error since the cut.

use super::errors::OutageErrors;
use undrift_base::order_statistics::median;

/// Root mean square over outages of the horizontal error \[m\] at each time since the cut \[s\], at the times of the outage
/// that was sampled most often, until the first of them ends. One that has no sample near such a time, since its fix was
/// rejected, does not count there.
pub fn drift_curve<'a>(outages: impl IntoIterator<Item = &'a OutageErrors>) -> Vec<(f64, f64)> {
    let curves: Vec<&[(f64, f64)]> = outages.into_iter().map(|o| o.drift.as_slice()).collect();
    let Some(times) = curves.iter().rev().max_by_key(|curve| curve.len()) else {
        return Vec::new();
    };
    let steps: Vec<f64> = times.windows(2).map(|pair| pair[1].0 - pair[0].0).collect();
    let near = match steps.as_slice() {
        [] => f64::INFINITY,
        steps => 0.5 * median(steps),
    };
    let rms = |t: f64| {
        let goes_on = |curve: &&[(f64, f64)]| curve.last().is_some_and(|last| last.0 > t - near);
        if !curves.iter().all(goes_on) {
            return None;
        }
        let at = |curve: &&[(f64, f64)]| {
            let after = curve.partition_point(|point| point.0 <= t - near);
            let error = curve.get(after).filter(|point| point.0 <= t + near)?.1;
            error.is_finite().then_some(error * error)
        };
        let squares: Vec<f64> = curves.iter().filter_map(at).collect();
        let mean = squares.iter().sum::<f64>() / squares.len() as f64;
        (!squares.is_empty()).then(|| (t, mean.sqrt()))
    };
    times.iter().map_while(|point| rms(point.0)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::{Coverage, Errors};

    fn outage(drift: &[(f64, f64)]) -> OutageErrors {
        OutageErrors {
            start_s: 0.0,
            max: Errors::UNKNOWN,
            end: Errors::UNKNOWN,
            sigma: Errors::UNKNOWN,
            nees: [f64::NAN; 3],
            covered: Coverage::default(),
            drift: drift.to_vec(),
            way: Vec::new(),
        }
    }

    /// The second has no fix at 2 s, and its fixes come 0.2 s later.
    #[test]
    fn errors_are_compared_at_the_same_time_since_the_cut() {
        let first = outage(&[(1.0, 3.0), (2.0, 5.0), (3.0, 6.0), (4.0, 9.0)]);
        let second = outage(&[(1.2, 4.0), (3.2, 8.0), (4.2, 12.0)]);
        let rms = |a: f64, b: f64| ((a * a + b * b) / 2.0).sqrt();
        let expected = [
            (1.0, rms(3.0, 4.0)),
            (2.0, 5.0),
            (3.0, rms(6.0, 8.0)),
            (4.0, rms(9.0, 12.0)),
        ];
        assert_eq!(drift_curve([&first, &second]), expected);
        assert_eq!(drift_curve([&second, &first]), expected);
        // One that ends ends the curve.
        let early = outage(&[(1.0, 3.0), (2.0, 5.0)]);
        assert_eq!(drift_curve([&first, &early]).len(), 2);
        assert_eq!(drift_curve([&first, &outage(&[])]), []);
        assert_eq!(drift_curve([]), []);
    }
}
