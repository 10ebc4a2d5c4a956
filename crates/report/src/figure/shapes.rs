//! What panels look like, before any drawing: the part that is seen, ticks, lines cut at its edges.

use super::panel::{Axis, Corner, Panel, Style};
use std::ops::Range;

/// One axis of a plot: from where to where.
#[derive(Clone, Debug)]
pub(super) struct Scale {
    pub range: Range<f64>,
    pub logarithmic: bool,
    pub ticks: Vec<f64>,
}

impl Scale {
    fn new(axis: &Axis, range: Range<f64>) -> Self {
        let ticks = if !axis.names.is_empty() {
            let whole = (0..axis.names.len()).map(|i| i as f64);
            whole.filter(|v| range.contains(v)).collect()
        } else if axis.logarithmic {
            log_ticks(&range)
        } else {
            linear_ticks(&range, 7.0)
        };
        Self {
            range,
            logarithmic: axis.logarithmic,
            ticks,
        }
    }

    /// The text at a tick, with digits enough to tell it from the next.
    pub fn label(&self, tick: f64) -> String {
        let size = self.range.start.abs().max(self.range.end.abs());
        let apart = match self.ticks[..] {
            [first, second, ..] if !self.logarithmic => (second - first).abs(),
            _ => size,
        };
        let digits = (size / apart).log10().ceil() + 1.0;
        self::tick(
            tick,
            if digits > 6.0 {
                digits.min(15.0) as usize
            } else {
                6
            },
        )
    }

    /// The nearest value inside; a value that is none stays so.
    pub fn clamp(&self, value: f64) -> f64 {
        if value.is_nan() {
            return value;
        }
        value.max(self.range.start).min(self.range.end)
    }

    /// Where a value is: 0 at the start, 1 at the end.
    pub fn place(&self, value: f64) -> f64 {
        let (start, end) = self.ends();
        (self.along(value) - start) / (end - start)
    }

    fn value(&self, place: f64) -> f64 {
        let (start, end) = self.ends();
        let along = start + place * (end - start);
        self.clamp(if self.logarithmic { along.exp() } else { along })
    }

    fn along(&self, value: f64) -> f64 {
        if self.logarithmic { value.ln() } else { value }
    }

    fn ends(&self) -> (f64, f64) {
        (self.along(self.range.start), self.along(self.range.end))
    }
}

/// The part of the plane that a panel shows.
pub(super) struct Window {
    pub x: Scale,
    pub y: Scale,
}

impl Window {
    pub fn holds(&self, x: f64, y: f64) -> bool {
        self.x.clamp(x) == x && self.y.clamp(y) == y
    }
}

impl Panel {
    /// From where to where the curves go, with a little room.
    fn extents(&self) -> (Range<f64>, Range<f64>) {
        let mut xs = Vec::new();
        let mut ys = Vec::new();
        let mut dots = false;
        for (i, series) in self.series.iter().enumerate() {
            let wide = matches!(series.style, Style::Bars | Style::Boxes);
            let slot = if wide { bar_slot(self, i) } else { [0.0; 2] };
            for (x, y) in series.points() {
                if self.x.holds(x) && self.y.holds(y) {
                    xs.extend(slot.map(|s| x + s));
                    ys.push(y);
                }
            }
            if series.style == Style::Dots {
                dots = true;
            }
            if series.style == Style::Bars && !self.y.logarithmic {
                ys.push(0.0);
            }
        }
        (
            // A dot at the edge is to be seen whole.
            self.x
                .range_of(xs.into_iter(), if dots { 0.01 } else { 0.0 }),
            self.y.range_of(ys.into_iter(), 0.05),
        )
    }

    /// How high the curves are for their width.
    pub(crate) fn shape(&self) -> f64 {
        let (x, y) = self.extents();
        (y.end - y.start) / (x.end - x.start)
    }

    /// The part to show in a plot of a size \[pixel\].
    pub(super) fn window(&self, width: f64, height: f64) -> Window {
        let (mut x, mut y) = self.extents();
        if self.to_scale {
            // The shorter axis takes in more.
            let span = |range: &Range<f64>| range.end - range.start;
            let pixel = (span(&x) / width).max(span(&y) / height) * 1.04;
            let around = |range: &Range<f64>, pixels: f64| {
                let middle = f64::midpoint(range.start, range.end);
                middle - 0.5 * pixel * pixels..middle + 0.5 * pixel * pixels
            };
            (x, y) = (around(&x, width), around(&y, height));
        }
        Window {
            x: Scale::new(&self.x, x),
            y: Scale::new(&self.y, y),
        }
    }
}

impl Panel {
    /// Where the legend covers the fewest points.
    pub(super) fn legend_corner(&self, window: &Window) -> Corner {
        const WIDTH: f64 = 0.4;
        let height = 0.08 + 0.06 * self.series.iter().filter(|s| !s.name.is_empty()).count() as f64;
        // Where x and y count from the corner.
        let corners = [
            (Corner::UpperLeft, false, true),
            (Corner::UpperRight, true, true),
            (Corner::LowerRight, true, false),
            (Corner::LowerLeft, false, false),
        ];
        let covered = |(_, right, upper): &(Corner, bool, bool)| {
            let from = |place: f64, far: bool| if far { 1.0 - place } else { place };
            let hidden = |x: f64, y: f64| {
                (0.0..WIDTH).contains(&from(window.x.place(x), *right))
                    && (0.0..height).contains(&from(window.y.place(y), *upper))
            };
            self.series
                .iter()
                // A share of each series, so that the longest does not decide alone.
                .map(|s| {
                    let covered = s.points().filter(|&(x, y)| hidden(x, y)).count();
                    covered as f64 / s.points().count().max(1) as f64
                })
                .sum::<f64>()
        };
        self.legend.unwrap_or_else(|| {
            let best = corners
                .iter()
                .min_by(|a, b| covered(a).total_cmp(&covered(b)));
            best.map_or(Corner::UpperLeft, |corner| corner.0)
        })
    }
}

/// From where to where a bar or box stands, seen from its x: those of several series stand side by
/// side where two are at one x.
pub(super) fn bar_slot(panel: &Panel, index: usize) -> [f64; 2] {
    let wide = |style: Style| matches!(style, Style::Bars | Style::Boxes);
    let of_kind = || {
        panel
            .series
            .iter()
            .enumerate()
            .filter(|(_, s)| wide(s.style))
    };
    let mut xs: Vec<f64> = of_kind().flat_map(|(_, s)| s.x.iter().copied()).collect();
    xs.retain(|x| x.is_finite());
    xs.sort_by(f64::total_cmp);
    let gap = xs
        .windows(2)
        .map(|w| w[1] - w[0])
        .filter(|gap| *gap > 0.0)
        .fold(f64::INFINITY, f64::min);
    let group = 0.8 * if gap.is_finite() { gap } else { 1.0 };
    let shared = xs.windows(2).any(|w| w[0] == w[1]);
    let (place, of) = if shared {
        let place = of_kind().position(|(i, _)| i == index).unwrap_or(0);
        (place as f64, of_kind().count().max(1) as f64)
    } else {
        (0.0, 1.0)
    };
    let width = group / of;
    // A little air between neighbours.
    let left = place * width - 0.5 * group;
    [left + 0.04 * width, left + 0.96 * width]
}

/// The parts of a line inside the window, cut at its edges and broken where a value is missing.
pub(super) fn runs(x: &[f64], y: &[f64], window: &Window) -> Vec<Vec<(f64, f64)>> {
    let mut runs: Vec<Vec<(f64, f64)>> = Vec::new();
    let mut run = Vec::new();
    let mut before = [f64::NAN; 2];
    let point = |[x, y]: [f64; 2]| (window.x.value(x), window.y.value(y));
    for (&x, &y) in x.iter().zip(y) {
        let here = [window.x.place(x), window.y.place(y)];
        match cut(before, here) {
            Some((from, to)) => {
                if run.is_empty() {
                    run.push(point(from));
                }
                run.push(point(to));
                if to != here {
                    runs.push(std::mem::take(&mut run));
                }
            }
            None if !run.is_empty() => runs.push(std::mem::take(&mut run)),
            None => {}
        }
        before = here;
    }
    if !run.is_empty() {
        runs.push(run);
    }
    runs
}

/// The part of a way inside the unit square (Liang & Barsky 1984), where its ends are finite.
fn cut(a: [f64; 2], b: [f64; 2]) -> Option<([f64; 2], [f64; 2])> {
    if !a.iter().chain(&b).all(|v| v.is_finite()) {
        return None;
    }
    let (mut first, mut last) = (0.0f64, 1.0f64);
    for (from, to) in a.into_iter().zip(b) {
        let way = to - from;
        if way == 0.0 {
            if !(0.0..=1.0).contains(&from) {
                return None;
            }
            continue;
        }
        let (enter, leave) = (-from / way, (1.0 - from) / way);
        first = first.max(enter.min(leave));
        last = last.min(enter.max(leave));
    }
    let at = |share: f64| match share {
        0.0 => a,
        1.0 => b,
        _ => std::array::from_fn(|i| a[i] + share * (b[i] - a[i])),
    };
    (first <= last).then(|| (at(first), at(last)))
}

/// Where a linear axis has ticks: at most `most` of them, at multiples of 1, 2 or 5 times a power of
/// ten.
pub(super) fn linear_ticks(range: &Range<f64>, most: f64) -> Vec<f64> {
    let span = range.end - range.start;
    if !(span > 0.0 && span.is_finite()) {
        return Vec::new();
    }
    let power = 10f64.powf((span / most).log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .map(|m| m * power)
        .into_iter()
        .find(|step| span / step <= most)
        .unwrap_or(10.0 * power);
    let first = (range.start / step).ceil();
    (0..=most as usize)
        .map(|i| (first + i as f64) * step)
        .filter(|tick| range.contains(tick))
        .collect()
}

/// Where a logarithmic axis has ticks: at powers of ten, and where those are few, at 2 and 5 too.
pub(super) fn log_ticks(range: &Range<f64>) -> Vec<f64> {
    let (first, last) = (range.start.log10(), range.end.log10());
    if !(first.is_finite() && last.is_finite()) {
        return Vec::new();
    }
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

/// A number beside an axis: as many digits as it needs, at most so many after the first.
fn tick(value: f64, digits: usize) -> String {
    // Ticks are sums of steps: few digits leave the rounding behind.
    let rounded: f64 = format!("{value:.digits$e}").parse().unwrap_or(value);
    match rounded.abs() {
        0.0 => "0".to_owned(),
        1e-3..1e5 => format!("{rounded}"),
        size if size >= 1.0 && digits > 6 => format!("{rounded}"),
        _ => format!("{rounded:e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::panel::Series;

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
            assert_eq!(tick(value, 6), text);
        }
    }

    #[test]
    fn ticks_far_from_zero_are_told_apart() {
        let scale = Scale::new(&Axis::new(""), 1e9..1e9 + 0.009);
        let labels: Vec<String> = scale.ticks.iter().map(|t| scale.label(*t)).collect();
        assert_eq!(labels[..2], ["1000000000", "1000000000.002"]);
    }

    #[test]
    fn ticks_are_round_numbers_inside_the_range() {
        assert_eq!(
            linear_ticks(&(-1.0..10.5), 7.0),
            [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]
        );
        assert_eq!(linear_ticks(&(3.0..3.0), 7.0), [0.0; 0]);
        assert_eq!(log_ticks(&(0.05..2e4)), [0.1, 1.0, 10.0, 100.0, 1e3, 1e4]);
        assert_eq!(log_ticks(&(90.0..700.0)), [100.0, 200.0, 500.0]);
        assert_eq!(log_ticks(&(90.0..450.0)).len(), 5);
    }

    #[test]
    fn lines_are_cut_at_the_edges() {
        // Up through the top at x = 2, down through it at x = 4, then a gap, then inside.
        let panel = Panel::new(
            "",
            Axis::new("").within(0.0..10.0),
            Axis::new("").within(0.0..1.0),
        );
        let window = panel.window(1.0, 1.0);
        let x = [0.0, 4.0, 6.0, 7.0, 8.0, 9.0];
        let y = [0.0, 2.0, 0.0, f64::NAN, 0.5, 0.5];
        let lines = runs(&x, &y, &window);
        let ends: Vec<_> = lines.iter().map(|l| (l[0], l[l.len() - 1])).collect();
        assert_eq!(
            ends,
            [
                ((0.0, 0.0), (2.0, 1.0)),
                ((5.0, 1.0), (6.0, 0.0)),
                ((8.0, 0.5), (9.0, 0.5))
            ]
        );
        assert!(runs(&[1.0, 2.0], &[3.0, 4.0], &window).is_empty());
    }

    #[test]
    fn to_scale_a_metre_is_a_metre() {
        let mut panel = Panel::new("", Axis::new("east"), Axis::new("north")).to_scale();
        panel.add(Series::line("", 0, vec![(0.0, 0.0), (100.0, 10.0)]));
        let window = panel.window(400.0, 200.0);
        let ratio = (window.x.range.end - window.x.range.start)
            / (window.y.range.end - window.y.range.start);
        assert!((ratio - 2.0).abs() < 1e-12);
        assert!(window.holds(0.0, 0.0) && window.holds(100.0, 10.0));
    }

    #[test]
    fn the_legend_leaves_the_curves_free() {
        let of = |points: Vec<(f64, f64)>| {
            let mut panel = Panel::new("", Axis::new(""), Axis::new(""));
            panel.add(Series::line("name", 0, points));
            let window = panel.window(1.0, 1.0);
            (
                panel.legend_corner(&window),
                panel.legend(Corner::LowerLeft).legend_corner(&window),
            )
        };
        let falling = (0..50).map(|i| (f64::from(i), -f64::from(i))).collect();
        assert_eq!(of(falling), (Corner::UpperRight, Corner::LowerLeft));
        let rising = (0..50).map(|i| (f64::from(i), f64::from(i))).collect();
        assert_eq!(of(rising).0, Corner::UpperLeft);
    }

    #[test]
    fn bars_of_two_series_stand_side_by_side() {
        let mut panel = Panel::new("", Axis::categories(["a", "b"]), Axis::new("y"));
        panel.add(Series::bars("one", 1, vec![(0.0, 1.0), (1.0, 2.0)]));
        panel.add(Series::line("between", 3, vec![(0.0, 1.0)]));
        panel.add(Series::bars("two", 2, vec![(0.0, 1.0), (1.0, 2.0)]));
        let (one, two) = (bar_slot(&panel, 0), bar_slot(&panel, 2));
        assert!(-0.4 < one[0] && one[1] < two[0] && two[1] < 0.4);
        assert_eq!(panel.window(1.0, 1.0).y.range.start, -0.1);
        // Each at an x of its own: above its name.
        let mut panel = Panel::new("", Axis::categories(["a", "b"]), Axis::new("y"));
        panel.add(Series::bars("one", 1, vec![(0.0, 1.0)]));
        panel.add(Series::bars("two", 2, vec![(1.0, 2.0)]));
        for index in [0, 1] {
            let [left, right] = bar_slot(&panel, index);
            assert!((left + right).abs() < 1e-12 && right > 0.3);
        }
    }
}
