//! Panels of curves over two axes, linear or logarithmic: what is to be drawn.

use serde::{Deserialize, Serialize};
use std::ops::Range;
use undrift_nav::earth::Geodetic;

/// One axis of a panel.
#[derive(Clone, Debug)]
pub struct PlotAxis {
    pub(crate) label: String,
    pub(crate) logarithmic: bool,
    pub(crate) range: Option<Range<f64>>,
    /// Names of the values 0, 1, 2 …; empty on an axis of numbers.
    pub(crate) names: Vec<String>,
}

impl PlotAxis {
    /// A linear axis, as long as its curves.
    pub fn new(label: &str) -> Self {
        Self {
            label: label.to_owned(),
            logarithmic: false,
            range: None,
            names: Vec::new(),
        }
    }

    /// A logarithmic axis, as long as its curves. Points that are not positive are left out.
    pub fn logarithmic(label: &str) -> Self {
        Self {
            logarithmic: true,
            ..Self::new(label)
        }
    }

    /// An axis of x with names in place of numbers: 0 is the first, 1 the second.
    pub fn categories<S: Into<String>>(names: impl IntoIterator<Item = S>) -> Self {
        let names: Vec<String> = names.into_iter().map(Into::into).collect();
        Self {
            range: Some(-0.6..names.len().max(1) as f64 - 0.4),
            names,
            ..Self::new("")
        }
    }

    /// Limits of the axis; curves are clipped. A range without length, or from zero or less on a
    /// logarithmic axis, is ignored: then the axis fits its curves.
    pub fn within(self, range: Range<f64>) -> Self {
        let sound = range.start < range.end
            && (range.end - range.start).is_finite()
            && (!self.logarithmic || range.start > 0.0);
        Self {
            range: sound.then_some(range),
            ..self
        }
    }

    /// Whether a value has a place on the axis, be it beyond its ends.
    pub(crate) fn takes(&self, value: f64) -> bool {
        value.is_finite() && (!self.logarithmic || value > 0.0)
    }

    /// Whether a value can be drawn.
    pub(crate) fn holds(&self, value: f64) -> bool {
        self.takes(value)
            && self
                .range
                .as_ref()
                .is_none_or(|range| range.start <= value && value <= range.end)
    }

    /// The range given, or that of the values with a little room.
    pub(crate) fn range_of(&self, values: impl Iterator<Item = f64>, room: f64) -> Range<f64> {
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
        let margin = if high - low > 1e-12 * high.abs() {
            room * (high - low)
        } else if low == 0.0 || self.logarithmic {
            1.0
        } else {
            1e-3 * low.abs()
        };
        // The ends and what lies between them stay finite, whatever the values.
        if self.logarithmic {
            10f64.powf((low - margin).max(-307.0))..10f64.powf((high + margin).min(307.0))
        } else {
            const MOST: f64 = 0.4 * f64::MAX;
            (low - margin).max(-MOST)..(high + margin).min(MOST)
        }
    }
}

/// How a series is drawn: by this name also in the data of a page and, of lines, in `style.json`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Drawn {
    Thin,
    Line,
    Thick,
    Dashed,
    Dots,
    /// Small dots, of which there are many.
    Points,
    /// Between two curves.
    Band,
    /// From zero.
    Bars,
    /// Box and whiskers.
    Boxes,
}

/// One curve of a panel.
#[derive(Clone, Debug)]
pub struct Series {
    pub(crate) name: String,
    pub(crate) colour: usize,
    pub(crate) drawn: Drawn,
    pub(crate) x: Vec<f64>,
    /// Values at each x: one column; of a band its lower and upper bound; of boxes the minimum,
    /// first quartile, median, third quartile and maximum.
    pub(crate) y: Vec<Vec<f64>>,
    /// Which of the style's patterns its line has; 0 is one without gaps.
    pub(crate) dash: usize,
    /// On a map: when it was at each point, on the axis of its panel's clock; or empty.
    pub(crate) times: Vec<f64>,
    /// Standard deviations of points along x and y; or empty.
    pub(crate) sigma: Vec<[f64; 2]>,
}

impl Series {
    fn new(name: &str, colour: usize, drawn: Drawn, points: Vec<(f64, f64)>) -> Self {
        let (x, y) = points.into_iter().unzip();
        Self::of_columns(name, colour, drawn, x, vec![y])
    }

    fn of_columns(name: &str, colour: usize, drawn: Drawn, x: Vec<f64>, y: Vec<Vec<f64>>) -> Self {
        Self {
            name: name.to_owned(),
            colour,
            drawn,
            x,
            y,
            dash: 0,
            times: Vec::new(),
            sigma: Vec::new(),
        }
    }

    /// The line with one of the style's patterns.
    pub fn pattern(self, dash: usize) -> Self {
        Self { dash, ..self }
    }

    /// A way on a map, with the time of each place: time, east, north.
    pub(crate) fn on_map(self, way: &[(f64, (f64, f64))]) -> Self {
        let (x, y) = way.iter().map(|(_, place)| *place).unzip();
        Self {
            x,
            y: vec![y],
            times: way.iter().map(|(time, _)| *time).collect(),
            ..self
        }
    }

    /// Small dots with their standard deviations along x and y.
    pub(crate) fn points_within(name: &str, colour: usize, sigma: Vec<[f64; 2]>) -> Self {
        Self {
            sigma,
            ..Self::new(name, colour, Drawn::Points, Vec::new())
        }
    }

    /// A line in one of eight colours, broken where y is not a number. Without a name it is not in
    /// the legend.
    pub fn line(name: &str, colour: usize, points: Vec<(f64, f64)>) -> Self {
        Self::new(name, colour, Drawn::Line, points)
    }

    /// A thin line, for a noisy curve.
    pub fn thin(name: &str, colour: usize, points: Vec<(f64, f64)>) -> Self {
        Self::new(name, colour, Drawn::Thin, points)
    }

    /// A thick line, for the curve that matters.
    pub fn thick(name: &str, colour: usize, points: Vec<(f64, f64)>) -> Self {
        Self::new(name, colour, Drawn::Thick, points)
    }

    /// A dashed line.
    pub fn dashed(name: &str, colour: usize, points: Vec<(f64, f64)>) -> Self {
        Self::new(name, colour, Drawn::Dashed, points)
    }

    /// Single points.
    pub fn dots(name: &str, colour: usize, points: Vec<(f64, f64)>) -> Self {
        Self::new(name, colour, Drawn::Dots, points)
    }

    /// Bars from zero to y; of several series with bars at the same x they stand side by side.
    pub fn bars(name: &str, colour: usize, points: Vec<(f64, f64)>) -> Self {
        Self::new(name, colour, Drawn::Bars, points)
    }

    /// A light band between a lower and an upper curve: x, lower, upper.
    pub fn band(name: &str, colour: usize, bounds: &[(f64, f64, f64)]) -> Self {
        let x = bounds.iter().map(|b| b.0).collect();
        let lower = bounds.iter().map(|b| b.1).collect();
        let upper = bounds.iter().map(|b| b.2).collect();
        Self::of_columns(name, colour, Drawn::Band, x, vec![lower, upper])
    }

    /// Boxes with whiskers: x, and there the minimum, first quartile, median, third quartile and
    /// maximum. Of several series with boxes at the same x they stand side by side.
    pub fn boxes(name: &str, colour: usize, boxes: Vec<(f64, [f64; 5])>) -> Self {
        let y = (0..5).map(|i| boxes.iter().map(|b| b.1[i]).collect());
        let x = boxes.iter().map(|b| b.0).collect();
        Self::of_columns(name, colour, Drawn::Boxes, x, y.collect())
    }

    /// All points that the series passes through: x and y.
    pub(crate) fn points(&self) -> impl Iterator<Item = (f64, f64)> + Clone {
        self.y
            .iter()
            .flat_map(|column| self.x.iter().copied().zip(column.iter().copied()))
    }
}

/// Curves over two axes.
#[derive(Clone, Debug)]
pub struct Panel {
    pub(crate) title: String,
    pub(crate) x: PlotAxis,
    pub(crate) y: PlotAxis,
    pub(crate) series: Vec<Series>,
    /// Spans of x on a shaded ground.
    pub(crate) shades: Vec<(f64, f64)>,
    /// Those where something is wrong.
    pub(crate) alarms: Vec<(f64, f64)>,
    /// Whether a unit of x is as long as one of y.
    pub(crate) to_scale: bool,
    /// Over time, or a map with times: when its axis of time begins in the log's own time \[s\]. Such panels share a
    /// cursor and a zoom.
    pub(crate) clock: Option<f64>,
    /// Of a map of metres east and north: where on Earth its (0, 0) is. A reader can ask for a background there.
    pub(crate) origin: Option<Geodetic>,
}

impl Panel {
    /// An empty panel.
    pub fn new(title: &str, x: PlotAxis, y: PlotAxis) -> Self {
        Self {
            title: title.to_owned(),
            x,
            y,
            series: Vec::new(),
            shades: Vec::new(),
            alarms: Vec::new(),
            to_scale: false,
            clock: None,
            origin: None,
        }
    }

    /// The panel under another title.
    pub fn titled(self, title: &str) -> Self {
        Self {
            title: title.to_owned(),
            ..self
        }
    }

    /// Draws one unit of x as long as one of y, as on a map. For linear axes.
    pub fn to_scale(self) -> Self {
        Self {
            to_scale: true,
            ..self
        }
    }

    /// Where on Earth (0, 0) of a map of metres east and north is, if anywhere.
    pub fn georeferenced(self, origin: Option<Geodetic>) -> Self {
        Self { origin, ..self }
    }

    /// Counts time from `zero` of the log's own time \[s\], for all that the panel shows.
    pub fn over_time(self, zero: f64) -> Self {
        Self {
            clock: Some(zero),
            ..self
        }
    }

    /// Adds a curve, above those before it.
    pub fn add(&mut self, series: Series) {
        self.series.push(series);
    }

    /// Shades the ground over a span of x, such as an outage.
    pub fn shade(&mut self, from: f64, to: f64) {
        self.shades.push((from, to));
    }

    /// The same in the colour of what is wrong.
    pub fn alarm(&mut self, from: f64, to: f64) {
        self.alarms.push((from, to));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_holds_what_it_shows() {
        let axis = PlotAxis::logarithmic("x").within(0.1..10.0);
        assert!(axis.holds(1.0) && !axis.holds(20.0) && !axis.holds(-1.0) && !axis.holds(f64::NAN));
        let range = PlotAxis::new("y").range_of([1.0, 3.0].into_iter(), 0.1);
        assert!((range.start - 0.8).abs() < 1e-12 && (range.end - 3.2).abs() < 1e-12);
        assert!(PlotAxis::logarithmic("x").within(0.0..1.0).range.is_none());
        assert!(PlotAxis::new("y").range_of(std::iter::empty(), 0.0).end >= 1.0);
    }
    #[test]
    fn an_axis_has_a_little_room_beyond_its_values() {
        let close = |range: Range<f64>, start: f64, end: f64| {
            let near = |a: f64, b: f64| (a - b).abs() <= 1e-12 * b.abs().max(1e-12);
            assert!(
                near(range.start, start) && near(range.end, end),
                "{range:?}"
            );
        };
        let linear = |values: &[f64]| PlotAxis::new("").range_of(values.iter().copied(), 0.05);
        let logarithmic =
            |values: &[f64]| PlotAxis::logarithmic("").range_of(values.iter().copied(), 0.05);
        close(linear(&[3.0, -1.0, 2.0]), -1.2, 3.2);
        close(linear(&[-3.0, -1.0]), -3.1, -0.9);
        // A twentieth of two decades.
        close(logarithmic(&[0.1, 10.0]), 10f64.powf(-1.1), 10f64.powf(1.1));
        // One value: a thousandth of it, one about zero, a decade.
        close(linear(&[5.0]), 4.995, 5.005);
        close(linear(&[-5.0]), -5.005, -4.995);
        close(linear(&[0.0]), -1.0, 1.0);
        close(logarithmic(&[10.0]), 1.0, 100.0);
        // None at all.
        close(linear(&[]), -0.05, 1.05);
        let given = PlotAxis::new("").within(2.0..3.0);
        close(given.range_of([9.0].into_iter(), 0.05), 2.0, 3.0);
        // Whatever the values, ends and length are finite.
        let far = linear(&[-f64::MAX, f64::MAX]);
        assert!((far.end - far.start).is_finite());
        let far = logarithmic(&[1e-307, 1e307]);
        assert!(far.start > 0.0 && far.end.is_finite());
    }

    #[test]
    fn a_range_without_length_is_none() {
        let within = |range: Range<f64>| PlotAxis::new("").within(range).range;
        assert_eq!(within(1.0..2.0), Some(1.0..2.0));
        assert!(within(2.0..2.0).is_none() && within(0.0..f64::INFINITY).is_none());
        assert!(within(f64::NAN..1.0).is_none());
        let names = PlotAxis::categories(["a", "b", "c"]);
        assert_eq!(names.range, Some(-0.6..2.6));
        assert_eq!(PlotAxis::categories([""; 0]).range, Some(-0.6..0.6));
        let axis = PlotAxis::new("").within(1.0..2.0);
        assert!(axis.holds(1.0) && axis.holds(2.0) && !axis.holds(0.9) && !axis.holds(2.1));
        assert!(axis.takes(9.0) && axis.takes(-9.0) && !PlotAxis::logarithmic("").takes(0.0));
    }

    #[test]
    fn bands_and_boxes_have_their_columns() {
        let band = Series::band("", 0, &[(0.0, 1.0, 2.0), (5.0, 3.0, 4.0)]);
        assert_eq!(band.x, [0.0, 5.0]);
        assert_eq!(band.y, [[1.0, 3.0], [2.0, 4.0]]);
        let boxes = Series::boxes("", 0, vec![(7.0, [1.0, 2.0, 3.0, 4.0, 5.0])]);
        assert_eq!(
            (&boxes.x[..], boxes.y.concat()),
            (&[7.0][..], vec![1.0, 2.0, 3.0, 4.0, 5.0])
        );
        let points: Vec<(f64, f64)> = band.points().collect();
        assert_eq!(points, [(0.0, 1.0), (5.0, 3.0), (0.0, 2.0), (5.0, 4.0)]);
    }
}
