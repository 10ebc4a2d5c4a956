//! Ellipses along a line on a map, which hold the position with a probability of 95 %: at the ends of the line, once a minute, and
//! where the standard deviation has grown or shrunk by half since the last.

use std::f64::consts::TAU;

use undrift_nav::{Vector3, earth::Geodetic};

use super::{solution::SolutionRow, text::map_degrees};

/// Standard deviations of the ellipse that holds 95 % of two normal errors: √(−2 ln 0.05).
const SCALE: f64 = 2.447_746_830_680_816;
/// Corners of the polygon.
const CORNERS: usize = 24;
/// Longest time from one ellipse to the next \[s\].
const EVERY: f64 = 60.0;
/// Ratio of standard deviations from one ellipse to the next.
const GROWTH: f64 = 1.5;

/// Rows of a line whose ellipses are drawn behind it.
#[derive(Default)]
pub(super) struct Ellipses {
    due: Vec<SolutionRow>,
    last: Option<SolutionRow>,
}

impl Ellipses {
    /// Goes along the line, in order.
    pub fn pass(&mut self, row: &SolutionRow) {
        let size = |row: &SolutionRow| row.nav_std[0].hypot(row.nav_std[1]);
        let is_due = self.due.last().is_none_or(|drawn| {
            let ratio = size(row) / size(drawn);
            row.time - drawn.time >= EVERY || !(1.0 / GROWTH..=GROWTH).contains(&ratio)
        });
        match is_due && size(row).is_finite() {
            true => self.due.push(*row),
            false => self.last = Some(*row),
        }
    }

    /// The line has ended: rows and polygons, closed and counterclockwise, the last at its end. Polygons across the antimeridian, which maps
    /// draw around the Earth, are omitted.
    pub fn end(&mut self) -> Vec<(SolutionRow, Vec<Geodetic>)> {
        let last = self.last.take();
        let drawn = self.due.last().map(|row| row.time);
        let end = last.filter(|row| drawn.is_some_and(|drawn| row.time > drawn));
        let rows = std::mem::take(&mut self.due).into_iter().chain(end);
        let drawn = rows.map(|row| (row, polygon(&row)));
        drawn.filter(|(_, polygon)| !crosses(polygon)).collect()
    }
}

fn polygon(row: &SolutionRow) -> Vec<Geodetic> {
    let [north, east] = [0, 1].map(|axis| SCALE * row.nav_std[axis]);
    let corner = |k: usize| {
        let (sin, cos) = (TAU * (k % CORNERS) as f64 / CORNERS as f64).sin_cos();
        let offset = Vector3::new(north * sin, east * cos, 0.0);
        row.position.displaced(&offset)
    };
    (0..=CORNERS).map(corner).collect()
}

fn crosses(polygon: &[Geodetic]) -> bool {
    let longitudes = polygon.iter().map(|corner| map_degrees(corner)[1]);
    let (least, most) = longitudes.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), lon| {
        (a.min(lon), b.max(lon))
    });
    most - least > 180.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(time: f64, std: f64) -> SolutionRow {
        SolutionRow {
            nav_std: [std; 9],
            ..SolutionRow::at(time, Geodetic::from_degrees(50.0, 8.0, 100.0))
        }
    }

    fn times(rows: &[SolutionRow]) -> Vec<f64> {
        let mut along = Ellipses::default();
        rows.iter().for_each(|row| along.pass(row));
        along.end().iter().map(|(row, _)| row.time).collect()
    }

    #[test]
    fn they_are_where_the_standard_deviation_changes_and_at_the_ends() {
        let quiet = Vec::from_iter((0..=150).map(|k| row(f64::from(k), 1.0)));
        assert_eq!(times(&quiet), [0.0, 60.0, 120.0, 150.0]);
        // 1 m and 0.1 m/s: by half more at 5, 12.5 (in whole seconds 13) and so on.
        let outage = Vec::from_iter((0..=20).map(|k| row(f64::from(k), 1.0 + 0.1 * f64::from(k))));
        assert_eq!(times(&outage), [0.0, 6.0, 14.0, 20.0]);
        assert!(times(&[row(0.0, f64::NAN), row(1.0, f64::NAN)]).is_empty());
    }

    /// Of the polygon's corners, the eastern one is 2.448 σ away and comes first, the northern one a quarter turn later.
    #[test]
    fn it_holds_ninety_five_percent() {
        let mut along = Ellipses::default();
        along.pass(&SolutionRow {
            nav_std: [3.0, 2.0, 9.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            ..row(0.0, 1.0)
        });
        let (row, polygon) = along.end().swap_remove(0);
        let offsets = Vec::from_iter(polygon.iter().map(|corner| row.position.offset_to(corner)));
        assert_eq!((offsets.len(), offsets[0]), (CORNERS + 1, offsets[CORNERS]));
        assert!((offsets[0].y - 4.8955).abs() < 1e-3 && offsets[0].x.abs() < 1e-6);
        assert!((offsets[6].x - 7.3432).abs() < 1e-3 && offsets[6].y.abs() < 1e-6);
        let antimeridian = SolutionRow {
            position: Geodetic::from_degrees(50.0, 179.99999, 0.0),
            ..row
        };
        along.pass(&antimeridian);
        assert!(along.end().is_empty());
    }
}
