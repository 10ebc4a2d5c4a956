//! How far the models drift since the cut.

use super::errors::ModelRun;

/// How far one model drifts.
pub struct DriftCurve<'a> {
    /// Name of the model.
    pub name: &'a str,
    /// Root mean square over the outages of the horizontal error \[m\] at each time since the cut \[s\].
    pub points: Vec<(f64, f64)>,
}

/// The RMS drift over the outages of a model run, at the times the first one was sampled.
pub fn drift_curve(run: &ModelRun) -> DriftCurve<'_> {
    // Those that began before the solution come first.
    let outages = &run.errors.per_outage[run.errors.left_out..];
    let times: Vec<f64> = outages
        .first()
        .map_or(Vec::new(), |o| o.drift.iter().map(|p| p.0).collect());
    let points = times
        .iter()
        .enumerate()
        .filter_map(|(i, &t)| {
            let squares: Option<Vec<f64>> = outages
                .iter()
                .map(|o| o.drift.get(i).map(|p| p.1 * p.1).filter(|s| s.is_finite()))
                .collect();
            let squares = squares?;
            Some((
                t,
                (squares.iter().sum::<f64>() / squares.len() as f64).sqrt(),
            ))
        })
        .collect();
    DriftCurve {
        name: &run.name,
        points,
    }
}
