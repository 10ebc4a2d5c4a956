//! Panels drawn as SVG.

use super::{
    COLOURS,
    panel::{Corner, Panel, Style},
};
use plotters::{
    coord::ranged1d::{AsRangedCoord, Ranged, ValueFormatter},
    prelude::*,
};
use std::{ops::Range, path::Path};

type Failure = Box<dyn std::error::Error>;
type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

/// Draws panels side by side, `columns` to a row, each of a size [pixel].
///
/// # Errors
/// A sentence for the user when the file cannot be written.
pub fn draw(
    path: &Path,
    panels: &[Panel],
    columns: usize,
    (width, height): (u32, u32),
) -> Result<(), String> {
    let columns = columns.max(1);
    let rows = panels.len().div_ceil(columns);
    let size = (width * columns as u32, height * rows as u32);
    let figure = || -> Result<(), Failure> {
        let root = SVGBackend::new(path, size).into_drawing_area();
        root.fill(&WHITE)?;
        for (area, panel) in root.split_evenly((rows, columns)).iter().zip(panels) {
            panel.draw(area)?;
        }
        root.present()?;
        Ok(())
    };
    figure().map_err(|e| format!("cannot draw {}: {e}", path.display()))
}

impl Panel {
    /// Draws the panel into a part of a figure.
    pub(super) fn draw(&self, area: &Area) -> Result<(), Failure> {
        let points = || self.series.iter().flat_map(|s| s.points());
        let shown = || points().filter(|(x, y)| self.x.holds(*x) && self.y.holds(*y));
        let x = self.x.range_of(shown().map(|p| p.0), 0.0);
        let y = self.y.range_of(shown().map(|p| p.1), 0.05);
        let decades = |range: Range<f64>| {
            let ticks = log_ticks(&range);
            range.log_scale().with_key_points(ticks)
        };
        match (self.x.logarithmic, self.y.logarithmic) {
            (false, false) => self.draw_over(area, x, y),
            (false, true) => self.draw_over(area, x, decades(y)),
            (true, false) => self.draw_over(area, decades(x), y),
            (true, true) => self.draw_over(area, decades(x), decades(y)),
        }
    }

    fn draw_over<X, Y>(&self, area: &Area, x: X, y: Y) -> Result<(), Failure>
    where
        X: AsRangedCoord<Value = f64>,
        Y: AsRangedCoord<Value = f64>,
        X::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
        Y::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
    {
        let mut chart = ChartBuilder::on(area)
            .margin(14)
            .caption(&self.title, ("sans-serif", 18))
            .x_label_area_size(38)
            .y_label_area_size(62)
            .build_cartesian_2d(x, y)?;
        chart
            .configure_mesh()
            .x_desc(&self.x.label)
            .y_desc(&self.y.label)
            .light_line_style(WHITE)
            .bold_line_style(RGBColor(225, 225, 225))
            .label_style(("sans-serif", 13))
            .x_labels(7)
            .y_labels(7)
            .x_label_formatter(&|v| tick(*v))
            .y_label_formatter(&|v| tick(*v))
            .draw()?;
        for series in &self.series {
            let colour = COLOURS[series.colour];
            let points = series
                .points()
                .filter(|(x, y)| self.x.holds(*x) && self.y.holds(*y));
            let drawn = match series.style {
                Style::Line(width) => {
                    chart.draw_series(LineSeries::new(points, colour.stroke_width(width)))?
                }
                Style::Dashed => chart.draw_series(DashedLineSeries::new(
                    points,
                    6,
                    4,
                    colour.stroke_width(2),
                ))?,
                Style::Dots | Style::Bars | Style::Boxes => {
                    chart.draw_series(points.map(|p| Circle::new(p, 3, colour.filled())))?
                }
                Style::Band => chart.draw_series(std::iter::once(Polygon::new(
                    points.collect::<Vec<_>>(),
                    colour.mix(0.2),
                )))?,
            };
            if series.name.is_empty() {
                continue;
            }
            let style = series.style;
            drawn.label(&series.name).legend(move |(x, y)| {
                let width = match style {
                    Style::Line(width) => width,
                    Style::Dashed => 2,
                    Style::Band => 9,
                    _ => 5,
                };
                let ends = match style {
                    Style::Dashed => vec![(x, y), (x + 7, y)],
                    Style::Dots => vec![(x + 7, y), (x + 12, y)],
                    _ => vec![(x, y), (x + 18, y)],
                };
                let colour = if style == Style::Band {
                    colour.mix(0.2)
                } else {
                    colour.to_rgba()
                };
                PathElement::new(ends, colour.stroke_width(width))
            });
        }
        if self.series.iter().any(|s| !s.name.is_empty()) {
            chart
                .configure_series_labels()
                .position(match self.legend {
                    Corner::UpperLeft => SeriesLabelPosition::UpperLeft,
                    Corner::UpperRight => SeriesLabelPosition::UpperRight,
                    Corner::LowerLeft => SeriesLabelPosition::LowerLeft,
                    Corner::LowerRight => SeriesLabelPosition::LowerRight,
                })
                .background_style(WHITE.mix(0.85))
                .border_style(RGBColor(200, 200, 200))
                .label_font(("sans-serif", 13))
                .draw()?;
        }
        Ok(())
    }
}

/// Where a logarithmic axis has ticks: at powers of ten, and where those are few, at 2 and 5 too.
fn log_ticks(range: &Range<f64>) -> Vec<f64> {
    let (first, last) = (range.start.log10(), range.end.log10());
    let steps: &[f64] = match last - first {
        span if span > 3.0 => &[1.0],
        span if span > 0.8 => &[1.0, 2.0, 5.0],
        _ => &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0],
    };
    (first.floor() as i32..=last.floor() as i32)
        .flat_map(|power| steps.iter().map(move |step| step * 10f64.powi(power)))
        .filter(|tick| range.contains(tick))
        .collect()
}

/// A number beside an axis: as many digits as it needs.
fn tick(value: f64) -> String {
    // Ticks are sums of steps: seven digits leave the rounding behind.
    let rounded: f64 = format!("{value:.6e}").parse().unwrap_or(value);
    match rounded.abs() {
        0.0 => "0".to_owned(),
        1e-3..1e5 => format!("{rounded}"),
        _ => format!("{rounded:e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_short() {
        for (value, text) in [
            (0.0, "0"),
            (0.1 + 0.2, "0.3"),
            (1000.0, "1000"),
            (1e-5, "1e-5"),
            (-2.5, "-2.5"),
            (3e6, "3e6"),
        ] {
            assert_eq!(tick(value), text);
        }
    }

    #[test]
    fn short_logarithmic_axes_have_ticks_too() {
        assert_eq!(log_ticks(&(0.05..2e4)), [0.1, 1.0, 10.0, 100.0, 1e3, 1e4]);
        assert_eq!(log_ticks(&(90.0..700.0)), [100.0, 200.0, 500.0]);
        assert_eq!(log_ticks(&(90.0..450.0)).len(), 5);
    }
}
