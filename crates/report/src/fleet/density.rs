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
    #[test]
    fn a_cell_is_as_large_as_its_share_of_the_span_and_as_dark_as_its_points_are_many() {
        // Over 48 by 32: one point in the first cell of each axis, 16 in the last, 4 amid.
        let mut points = vec![(0.0, 0.0)];
        points.extend([(48.0, 32.0); 16]);
        points.extend([(24.5, 16.5); 4]);
        let panel = Panel::new("", PlotAxis::new(""), PlotAxis::new(""));
        let shades = density(&points, &panel);
        let names: Vec<&str> = shades.iter().map(|shade| &*shade.name).collect();
        assert_eq!(names, ["1 log or more", "4 or more", "16 or more"]);
        let corner = |left: f64, low: f64| ([left, left + 1.0], [low; 2], [low + 1.0; 2]);
        let cells = |shade: &Series| -> Vec<_> {
            let places = (0..shade.x.len()).step_by(3);
            places
                .map(|at| {
                    assert!(shade.y[0][at + 2].is_nan() && shade.y[1][at + 2].is_nan());
                    let pair = |of: &[f64]| [of[at], of[at + 1]];
                    (pair(&shade.x), pair(&shade.y[0]), pair(&shade.y[1]))
                })
                .collect()
        };
        let (first, amid, last) = (corner(0.0, 0.0), corner(24.0, 16.0), corner(47.0, 31.0));
        assert_eq!(cells(&shades[0]), [first, amid, last]);
        assert_eq!(cells(&shades[1]), [amid, last]);
        assert_eq!(cells(&shades[2]), [last]);
    }

    #[test]
    fn cells_of_a_logarithmic_axis_are_of_one_factor() {
        let top = 32f64.exp();
        let panel = Panel::new("", PlotAxis::new(""), PlotAxis::logarithmic(""));
        let shades = density(&[(0.0, 1.0), (48.0, top)], &panel);
        let [low, high] = [&shades[0].y[0], &shades[0].y[1]];
        for (low, high) in low.iter().zip(high).filter(|(low, _)| low.is_finite()) {
            assert!((high / low - 1f64.exp()).abs() < 1e-9, "{low} {high}");
        }
        assert!((high[4] / top - 1.0).abs() < 1e-9 && (low[0] - 1.0).abs() < 1e-9);
    }
}
