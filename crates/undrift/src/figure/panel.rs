//! Panels of curves over two axes, linear or logarithmic.

use super::COLOURS;
use plotters::{
    coord::ranged1d::{AsRangedCoord, Ranged, ValueFormatter},
    prelude::*,
};
use std::{ops::Range, path::Path};

type Failure = Box<dyn std::error::Error>;
type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

/// One axis of a panel.
#[derive(Clone, Debug)]
pub struct Axis {
    label: String,
    logarithmic: bool,
    range: Option<Range<f64>>,
}

impl Axis {
    /// A linear axis, as long as its curves.
    pub fn new(label: &str) -> Self {
        Self {
            label: label.to_owned(),
            logarithmic: false,
            range: None,
        }
    }

    /// A logarithmic axis, as long as its curves. Points that are not positive are left out.
    pub fn logarithmic(label: &str) -> Self {
        Self {
            logarithmic: true,
            ..Self::new(label)
        }
    }

    /// From and to where; curves are cut off.
    pub fn within(self, range: Range<f64>) -> Self {
        Self {
            range: Some(range),
            ..self
        }
    }

    /// Whether a value can be drawn.
    fn holds(&self, value: f64) -> bool {
        value.is_finite()
            && (!self.logarithmic || value > 0.0)
            && self
                .range
                .as_ref()
                .is_none_or(|range| range.start <= value && value <= range.end)
    }

    /// The range given, or that of the values with a little room.
    fn range_of(&self, values: impl Iterator<Item = f64>, room: f64) -> Range<f64> {
        if let Some(range) = &self.range {
            return range.clone();
        }
        let along = |v: f64| if self.logarithmic { v.log10() } else { v };
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values.map(along) {
            (low, high) = (low.min(value), high.max(value));
        }
        if low > high {
            (low, high) = (0.0, 1.0);
        }
        let margin = (room * (high - low)).max(1e-12 * high.abs()).max(1e-300);
        let (low, high) = (low - margin, high + margin);
        if self.logarithmic {
            10f64.powf(low)..10f64.powf(high)
        } else {
            low..high
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Style {
    Line(u32),
    Dashed,
    Area,
    Dots,
}

/// One curve of a panel.
#[derive(Clone, Debug)]
pub struct Series {
    name: String,
    colour: usize,
    style: Style,
    points: Vec<(f64, f64)>,
}

impl Series {
    fn new(name: &str, colour: usize, style: Style, points: Vec<(f64, f64)>) -> Self {
        Self {
            name: name.to_owned(),
            colour: colour % COLOURS.len(),
            style,
            points,
        }
    }

    /// A line in one of eight colours. Without a name it is not in the legend.
    pub fn line(name: &str, colour: usize, points: Vec<(f64, f64)>) -> Self {
        Self::new(name, colour, Style::Line(2), points)
    }

    /// A thin line, for a noisy curve.
    pub fn thin(name: &str, colour: usize, points: Vec<(f64, f64)>) -> Self {
        Self::new(name, colour, Style::Line(1), points)
    }

    /// A thick line, for the curve that matters.
    pub fn thick(name: &str, colour: usize, points: Vec<(f64, f64)>) -> Self {
        Self::new(name, colour, Style::Line(4), points)
    }

    /// A dashed line.
    pub fn dashed(name: &str, colour: usize, points: Vec<(f64, f64)>) -> Self {
        Self::new(name, colour, Style::Dashed, points)
    }

    /// Single points.
    pub fn dots(name: &str, colour: usize, points: Vec<(f64, f64)>) -> Self {
        Self::new(name, colour, Style::Dots, points)
    }

    /// A light band between a lower and an upper curve: x, lower, upper.
    pub fn band(name: &str, colour: usize, bounds: &[(f64, f64, f64)]) -> Self {
        let lower = bounds.iter().map(|&(x, low, _)| (x, low));
        let upper = bounds.iter().rev().map(|&(x, _, high)| (x, high));
        Self::new(name, colour, Style::Area, lower.chain(upper).collect())
    }
}

/// Where the legend of a panel stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Corner {
    /// Top left.
    UpperLeft,
    /// Top right.
    UpperRight,
    /// Bottom left.
    LowerLeft,
    /// Bottom right.
    LowerRight,
}

/// Curves over two axes.
#[derive(Clone, Debug)]
pub struct Panel {
    title: String,
    x: Axis,
    y: Axis,
    series: Vec<Series>,
    legend: Corner,
}

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
    /// An empty panel, its legend in the upper left.
    pub fn new(title: &str, x: Axis, y: Axis) -> Self {
        Self {
            title: title.to_owned(),
            x,
            y,
            series: Vec::new(),
            legend: Corner::UpperLeft,
        }
    }

    /// Puts the legend into another corner.
    pub fn legend(self, legend: Corner) -> Self {
        Self { legend, ..self }
    }

    /// Adds a curve, above those before it.
    pub fn add(&mut self, series: Series) {
        self.series.push(series);
    }

    /// Draws the panel into a part of a figure.
    pub(super) fn draw(&self, area: &Area) -> Result<(), Failure> {
        let points = || self.series.iter().flat_map(|s| &s.points);
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
                .points
                .iter()
                .copied()
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
                Style::Dots => {
                    chart.draw_series(points.map(|p| Circle::new(p, 3, colour.filled())))?
                }
                Style::Area => chart.draw_series(std::iter::once(Polygon::new(
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
                    Style::Area => 9,
                    Style::Dots => 5,
                };
                let ends = match style {
                    Style::Dashed => vec![(x, y), (x + 7, y)],
                    Style::Dots => vec![(x + 7, y), (x + 12, y)],
                    _ => vec![(x, y), (x + 18, y)],
                };
                let colour = if style == Style::Area {
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

    #[test]
    fn an_axis_holds_what_it_shows() {
        let axis = Axis::logarithmic("x").within(0.1..10.0);
        assert!(axis.holds(1.0) && !axis.holds(20.0) && !axis.holds(-1.0) && !axis.holds(f64::NAN));
        let range = Axis::new("y").range_of([1.0, 3.0].into_iter(), 0.1);
        assert!((range.start - 0.8).abs() < 1e-12 && (range.end - 3.2).abs() < 1e-12);
        assert!(Axis::new("y").range_of(std::iter::empty(), 0.0).end > 1.0);
    }
}
