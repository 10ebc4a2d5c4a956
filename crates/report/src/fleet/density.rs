//! Many points as cells: the more points in one, the darker.

use crate::{Panel, Series};

/// Cells along x and y.
const CELLS: (usize, usize) = (48, 32);
/// Shades, each on top of the one before.
const SHADES: u32 = 5;
/// Colour of the cells.
const INK: usize = 0;

/// The points as bands: the first over all cells with a point, each further one over those with four times as many.
pub(super) fn density(points: &[(f64, f64)], panel: &Panel) -> Vec<Series> {
    let logarithmic = panel.y.logarithmic;
    let along = |y: f64| if logarithmic { y.ln() } else { y };
    let back = |y: f64| if logarithmic { y.exp() } else { y };
    let sound = |(x, y): &&(f64, f64)| x.is_finite() && panel.y.takes(*y);
    let points = || points.iter().filter(sound).map(|(x, y)| (*x, along(*y)));
    let ends = |values: &mut dyn Iterator<Item = f64>| {
        let start = (f64::INFINITY, f64::NEG_INFINITY);
        values.fold(start, |(low, high), v| (low.min(v), high.max(v)))
    };
    let x = ends(&mut points().map(|p| p.0));
    let y = ends(&mut points().map(|p| p.1));
    let step = |(low, high): (f64, f64), n: usize| ((high - low) / n as f64).max(1e-9);
    let (wide, high) = (step(x, CELLS.0), step(y, CELLS.1));
    let place = |v: f64, low: f64, step: f64, n: usize| (((v - low) / step) as usize).min(n - 1);
    let mut counts = vec![0u32; CELLS.0 * CELLS.1];
    for (px, py) in points() {
        let at = place(px, x.0, wide, CELLS.0) * CELLS.1 + place(py, y.0, high, CELLS.1);
        if let Some(count) = counts.get_mut(at) {
            *count += 1;
        }
    }
    let shade = |k: u32| {
        let least = 4u32.pow(k);
        let mut bounds = Vec::new();
        for (at, _) in counts.iter().enumerate().filter(|(_, n)| **n >= least) {
            let left = x.0 + (at / CELLS.1) as f64 * wide;
            let low = y.0 + (at % CELLS.1) as f64 * high;
            let (low, top) = (back(low), back(low + high));
            let gap = (left + wide, f64::NAN, f64::NAN);
            bounds.extend([(left, low, top), (left + wide, low, top), gap]);
        }
        let name = if k == 0 {
            "1 log or more".into()
        } else {
            format!("{least} or more")
        };
        (!bounds.is_empty()).then(|| Series::band(&name, INK, &bounds))
    };
    (0..SHADES).filter_map(shade).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PlotAxis;

    #[test]
    fn cells_hold_all_points_and_little_else() {
        let points: Vec<(f64, f64)> = (0..100_000u32)
            .map(|k| (f64::from(k % 317), 1.0 + f64::from(k % 1009)))
            .chain([(f64::NAN, 1.0), (3.0, -1.0)])
            .collect();
        let panel = Panel::new("", PlotAxis::new(""), PlotAxis::logarithmic(""));
        let shades = density(&points, &panel);
        assert!((2..=SHADES as usize).contains(&shades.len()));
        // Three points a cell, and no more cells than there are.
        assert!(shades[0].x.len() <= 3 * CELLS.0 * CELLS.1);
        assert!(
            shades
                .windows(2)
                .all(|pair| pair[0].x.len() >= pair[1].x.len())
        );
        assert!(density(&[], &panel).is_empty());
    }
}
