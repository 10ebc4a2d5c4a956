//! Axes of a panel: the part that is seen, and its ticks.

use super::panel::{Drawn, Panel, PlotAxis};
use std::ops::Range;

/// Which way an axis goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Along {
    X,
    Y,
}

/// One axis of a plot: from where to where, over how many pixels.
#[derive(Clone, Debug)]
pub(super) struct Scale {
    pub range: Range<f64>,
    pub length: f64,
    logarithmic: bool,
    /// From top to bottom.
    upright: bool,
}

impl Scale {
    pub fn new(axis: &PlotAxis, along: Along, range: Range<f64>, length: f64) -> Self {
        Self {
            range,
            length,
            logarithmic: axis.logarithmic,
            upright: along == Along::Y,
        }
    }

    /// The pixel of a value, to a tenth and near enough to be drawn; none of one that has no place.
    pub fn pixel(&self, value: f64) -> Option<f64> {
        const LIMIT: f64 = 1e5;
        let along = |v: f64| if self.logarithmic { v.ln() } else { v };
        let (start, end) = (along(self.range.start), along(self.range.end));
        let share = (along(value) - start) / (end - start);
        let share = if self.upright { 1.0 - share } else { share };
        let pixel = (share * self.length).clamp(-LIMIT, LIMIT);
        pixel.is_finite().then(|| px(pixel))
    }

    /// Where a bar begins: at zero, or at the foot of a logarithmic axis.
    pub fn base(&self) -> f64 {
        let zero = (!self.logarithmic).then(|| self.pixel(0.0)).flatten();
        zero.unwrap_or(self.length)
    }

    /// Where the axis has ticks: as many as it has room for, and of x as stand apart.
    pub fn ticks(&self) -> Vec<(f64, String)> {
        let (most, room) = if self.upright { (8, 28.0) } else { (10, 46.0) };
        let mut most = ((self.length / room) as usize).clamp(1, most);
        loop {
            let labels = labels(&if self.logarithmic {
                logarithmic(&self.range, most)
            } else {
                linear(&self.range, most)
            });
            let placed = labels
                .into_iter()
                .filter_map(|(tick, label)| Some((self.pixel(tick)?, label)));
            let placed: Vec<(f64, String)> = placed.collect();
            let apart = placed.windows(2).all(|pair| {
                let half = 0.5 * (text_width(&pair[0].1) + text_width(&pair[1].1));
                self.upright || pair[1].0 - pair[0].0 > half + 10.0
            });
            if apart || most <= 1 {
                return placed;
            }
            most -= 1;
        }
    }
}

/// A tenth of a pixel is fine enough.
pub(super) fn px(pixel: f64) -> f64 {
    (10.0 * pixel).round() / 10.0 + 0.0
}

/// About how wide a text is in letters 13 pixels high \[pixel\]; rather too wide.
pub(super) fn text_width(text: &str) -> f64 {
    let letter = |c: char| match c {
        'i' | 'j' | 'l' | 'f' | 't' | 'r' | 'I' | ' ' | '.' | ',' | ':' | ';' | '(' | ')' | '['
        | ']' | '/' | '-' | '|' | '\'' | '⁻' => 5.0,
        'm' | 'w' | 'M' | 'W' | '%' | '…' | '@' => 12.0,
        'A'..='Z' | '−' | '±' => 9.5,
        _ => 8.0,
    };
    text.chars().map(letter).sum()
}

/// Multiples of a round step, at most `most` of them.
fn linear(range: &Range<f64>, most: usize) -> Vec<f64> {
    let span = range.end - range.start;
    if !(span > 0.0 && span.is_finite()) {
        return Vec::new();
    }
    let power = 10f64.powf((span / most as f64).log10().floor());
    let mut steps = [1.0, 2.0, 5.0].into_iter().map(|step| step * power);
    let step = { steps.find(|step| span / step <= most as f64) }.unwrap_or(10.0 * power);
    let first = (range.start / step - 1e-9).ceil();
    (0..=most)
        .map(|i| (first + i as f64) * step)
        .take_while(|tick| *tick <= range.end + 1e-9 * step)
        .collect()
}

/// Ticks within each decade of a logarithmic axis of so many decades at most.
const LOGARITHMIC: [(f64, &[f64]); 4] = [
    (0.8, &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0]),
    (4.0, &[1.0, 2.0, 5.0]),
    (4.0, &[1.0, 3.0]),
    (20.0, &[1.0]),
];

/// Round numbers of a logarithmic axis, at most `most` of them; every n-th power of ten where those of a list are too
/// many, and as on a linear axis where they are too few.
fn logarithmic(range: &Range<f64>, most: usize) -> Vec<f64> {
    let (first, last) = (range.start.log10(), range.end.log10());
    let span = last - first;
    if !(span > 0.0 && span.is_finite()) {
        return Vec::new();
    }
    let within = |every: i32, at: &[f64]| -> Vec<f64> {
        let powers = (first.floor() as i32..=last.ceil() as i32).filter(|p| p % every == 0);
        let ticks = powers.flat_map(|p| at.iter().map(move |m| m * 10f64.powi(p)));
        let held = range.start * (1.0 - 1e-9)..=range.end * (1.0 + 1e-9);
        ticks.filter(|tick| held.contains(tick)).collect()
    };
    let ticks = LOGARITHMIC.iter();
    let ticks = ticks
        .filter(|(decades, _)| span <= *decades)
        .map(|(_, at)| within(1, at))
        .find(|ticks| (2..=most).contains(&ticks.len()))
        .unwrap_or_else(|| within((span / most as f64).ceil().max(1.0) as i32, &[1.0]));
    if ticks.len() > 1 {
        return ticks;
    }
    let ticks = linear(range, most).into_iter();
    ticks.filter(|tick| *tick > 0.0).collect()
}

/// Ticks with their text, of as many digits as tell them apart.
fn labels(ticks: &[f64]) -> Vec<(f64, String)> {
    let size = ticks.iter().fold(0.0f64, |size, tick| size.max(tick.abs()));
    let step = match ticks {
        [first, second, ..] => (second - first).abs(),
        _ => size,
    };
    let digits = ((size / step).log10().ceil() + 2.0).clamp(4.0, 15.0) as usize;
    let label = |tick: &f64| {
        let tick = if tick.abs() < 1e-9 * step { 0.0 } else { *tick };
        (tick, number(tick, digits))
    };
    ticks.iter().map(label).collect()
}

/// A number beside an axis: a true minus, and powers of ten where there would be many zeros.
fn number(value: f64, digits: usize) -> String {
    let scientific = format!("{value:.*e}", digits - 1);
    let rounded: f64 = scientific.parse().unwrap_or(value);
    let plain = match rounded.abs() {
        0.0 => "0".to_owned(),
        size if (1e-3..1e6).contains(&size) || (digits > 7 && (1.0..1e16).contains(&size)) => {
            format!("{rounded}")
        }
        _ => {
            let scientific = format!("{rounded:e}");
            let (mantissa, power) = scientific.split_once('e').unwrap_or((&scientific, "0"));
            let raised = power.chars().map(|c| match c {
                '-' => '⁻',
                digit => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹']
                    [digit.to_digit(10).unwrap_or(0) as usize],
            });
            let raised: String = ['1', '0'].into_iter().chain(raised).collect();
            match mantissa {
                "1" => raised,
                "-1" => format!("-{raised}"),
                _ => format!("{mantissa}·{raised}"),
            }
        }
    };
    plain.replacen('-', "−", 1)
}

/// The part of the plane that a panel shows.
pub(super) struct Window {
    pub x: Scale,
    pub y: Scale,
}

impl Panel {
    /// From where to where the curves go, with a little room.
    pub(crate) fn extents(&self) -> (Range<f64>, Range<f64>) {
        let mut xs = Vec::new();
        let mut ys = Vec::new();
        let mut dots = false;
        for (i, series) in self.series.iter().enumerate() {
            let wide = matches!(series.drawn, Drawn::Bars | Drawn::Boxes);
            let slot = if wide { bar_slot(self, i) } else { [0.0; 2] };
            for (x, y) in series.points() {
                if self.x.holds(x) && self.y.holds(y) {
                    xs.extend(slot.map(|s| x + s));
                    ys.push(y);
                }
            }
            if matches!(series.drawn, Drawn::Dots | Drawn::Points) {
                dots = true;
            }
            if series.drawn == Drawn::Bars && !self.y.logarithmic {
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
            x: Scale::new(&self.x, Along::X, x, width),
            y: Scale::new(&self.y, Along::Y, y, height),
        }
    }
}

/// From where to where a bar or box stands, seen from its x: those of several series stand side by
/// side where two are at one x.
pub(super) fn bar_slot(panel: &Panel, index: usize) -> [f64; 2] {
    let wide = |drawn: Drawn| matches!(drawn, Drawn::Bars | Drawn::Boxes);
    let of_kind = || {
        panel
            .series
            .iter()
            .enumerate()
            .filter(|(_, s)| wide(s.drawn))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::panel::Series;

    #[test]
    fn an_axis_that_begins_and_ends_at_a_round_number_has_ticks_there() {
        assert_eq!(linear(&(2.0..10.0), 7), [2.0, 4.0, 6.0, 8.0, 10.0]);
        // A range that is a rounding beside one.
        let ticks = linear(&(0.1 * 3.0..0.7), 7);
        assert!(
            (ticks[0] - 0.3).abs() < 1e-12 && ticks.len() == 5,
            "{ticks:?}"
        );
        // As many as are asked for and no more, of steps 1, 2, 5.
        assert_eq!(linear(&(0.0..6.0), 6).len(), 7);
        assert_eq!(linear(&(0.0..6.0), 5), [0.0, 2.0, 4.0, 6.0]);
        assert_eq!(linear(&(0.0..40.0), 4), [0.0, 10.0, 20.0, 30.0, 40.0]);
    }

    #[test]
    fn an_axis_has_the_same_ticks_in_any_unit() {
        // The last one is a rounding beyond the range, the next one half of a step.
        for unit in [1e-9, 1e-3, 1.0, 1e6] {
            for end in [0.7 * (1.0 - 1e-12), 0.75] {
                let ticks = linear(&(0.3 * unit..end * unit), 7);
                assert_eq!(ticks.len(), 5, "{unit} {end} {ticks:?}");
                assert!((ticks[4] / unit - 0.7).abs() < 1e-12, "{ticks:?}");
            }
        }
    }

    #[test]
    fn ticks_are_short() {
        for (value, text) in [
            (0.0, "0"),
            (0.1 + 0.2, "0.3"),
            (1000.0, "1000"),
            (1e-5, "10⁻⁵"),
            (-2.5, "−2.5"),
            (3e6, "3·10⁶"),
        ] {
            assert_eq!(number(value, 6), text);
        }
    }

    #[test]
    fn ticks_far_from_zero_are_told_apart() {
        let ticks = labels(&linear(&(1e9..1e9 + 0.009), 7));
        let texts: Vec<&str> = ticks.iter().map(|t| t.1.as_str()).collect();
        assert_eq!(texts[..2], ["1000000000", "1000000000.002"]);
    }

    #[test]
    fn ticks_are_round_numbers_inside_the_range() {
        assert_eq!(linear(&(-1.0..10.5), 7), [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]);
        assert_eq!(linear(&(3.0..3.0), 7), [0.0; 0]);
        let log_ticks = |range| logarithmic(&range, 7);
        assert_eq!(log_ticks(0.05..2e4), [0.1, 1.0, 10.0, 100.0, 1e3, 1e4]);
        assert_eq!(log_ticks(90.0..700.0), [100.0, 200.0, 500.0]);
        assert_eq!(log_ticks(90.0..450.0).len(), 5);
    }

    #[test]
    fn labels_stand_apart() {
        let axis = PlotAxis::new("");
        for length in [60.0, 200.0, 400.0, 2000.0] {
            let ticks = Scale::new(&axis, Along::X, 0.0..1e5, length).ticks();
            assert!(!ticks.is_empty() && ticks.len() <= 11);
            for pair in ticks.windows(2) {
                assert!(pair[1].0 - pair[0].0 > text_width(&pair[1].1), "{ticks:?}");
            }
        }
    }

    #[test]
    fn to_scale_a_metre_is_a_metre() {
        let mut panel = Panel::new("", PlotAxis::new("east"), PlotAxis::new("north")).to_scale();
        panel.add(Series::line("", 0, vec![(0.0, 0.0), (100.0, 10.0)]));
        let window = panel.window(400.0, 200.0);
        let ratio = (window.x.range.end - window.x.range.start)
            / (window.y.range.end - window.y.range.start);
        assert!((ratio - 2.0).abs() < 1e-12);
        for (x, y) in [(0.0, 0.0), (100.0, 10.0)] {
            assert!(window.x.range.contains(&x) && window.y.range.contains(&y));
        }
    }

    #[test]
    fn bars_of_two_series_stand_side_by_side() {
        let mut panel = Panel::new("", PlotAxis::categories(["a", "b"]), PlotAxis::new("y"));
        panel.add(Series::bars("one", 1, vec![(0.0, 1.0), (1.0, 2.0)]));
        panel.add(Series::line("between", 3, vec![(0.0, 1.0)]));
        panel.add(Series::bars("two", 2, vec![(0.0, 1.0), (1.0, 2.0)]));
        let (one, two) = (bar_slot(&panel, 0), bar_slot(&panel, 2));
        assert!(-0.4 < one[0] && one[1] < two[0] && two[1] < 0.4);
        assert_eq!(panel.window(1.0, 1.0).y.range.start, -0.1);
        // Each at an x of its own: above its name.
        let mut panel = Panel::new("", PlotAxis::categories(["a", "b"]), PlotAxis::new("y"));
        panel.add(Series::bars("one", 1, vec![(0.0, 1.0)]));
        panel.add(Series::bars("two", 2, vec![(1.0, 2.0)]));
        for index in [0, 1] {
            let [left, right] = bar_slot(&panel, index);
            assert!((left + right).abs() < 1e-12 && right > 0.3);
        }
    }
    #[test]
    fn a_value_has_its_pixel_by_its_share_of_the_axis() {
        let (axis, log) = (PlotAxis::new(""), PlotAxis::logarithmic(""));
        let x = Scale::new(&axis, Along::X, 2.0..6.0, 200.0);
        assert_eq!(
            [x.pixel(2.0), x.pixel(3.0), x.pixel(6.0)],
            [0.0, 50.0, 200.0].map(Some)
        );
        let y = Scale::new(&axis, Along::Y, -1.0..3.0, 200.0);
        assert_eq!(
            [y.pixel(-1.0), y.pixel(0.0), y.pixel(3.0)],
            [200.0, 150.0, 0.0].map(Some)
        );
        let decades = Scale::new(&log, Along::X, 1.0..1000.0, 300.0);
        assert_eq!(
            [decades.pixel(10.0), decades.pixel(100.0)],
            [100.0, 200.0].map(Some)
        );
        assert_eq!(
            [decades.pixel(0.0), decades.pixel(-1.0)],
            [Some(-1e5), None]
        );
        assert_eq!(
            [x.pixel(f64::NAN), x.pixel(1e9), x.pixel(-1e9)],
            [None, Some(1e5), Some(-1e5)]
        );
        // Bars begin at zero, or at the foot of a logarithmic axis.
        assert_eq!(y.base(), 150.0);
        assert_eq!(Scale::new(&log, Along::Y, 1.0..10.0, 200.0).base(), 200.0);
        // To a tenth of a pixel.
        assert_eq!([px(1.04), px(1.06), px(-0.01)], [1.0, 1.1, 0.0]);
    }

    #[test]
    fn ticks_are_as_many_as_there_is_room_for() {
        let ticks = |along, range, length| {
            let ticks = Scale::new(&PlotAxis::new(""), along, range, length).ticks();
            ticks
                .into_iter()
                .map(|(_, label)| label)
                .collect::<Vec<_>>()
        };
        // 28 pixels each along y, of which eight are enough; 46 along x.
        assert_eq!(ticks(Along::Y, 0.0..10.0, 84.0), ["0", "5", "10"]);
        assert_eq!(
            ticks(Along::Y, 0.0..10.0, 140.0),
            ["0", "2", "4", "6", "8", "10"]
        );
        assert_eq!(ticks(Along::Y, 0.0..16.0, 1000.0).len(), 9);
        assert_eq!(ticks(Along::X, 0.0..10.0, 460.0).len(), 11);
        assert_eq!(
            ticks(Along::X, 0.0..10.0, 230.0),
            ["0", "2", "4", "6", "8", "10"]
        );
        let placed = Scale::new(&PlotAxis::new(""), Along::X, 0.0..10.0, 230.0).ticks();
        assert_eq!(placed[1], (46.0, "2".to_owned()));
    }

    #[test]
    fn a_curve_fills_its_panel_with_room_for_dots_and_bars() {
        let with = |series: Series| {
            let mut panel = Panel::new("", PlotAxis::new(""), PlotAxis::new(""));
            panel.add(series);
            panel.extents()
        };
        let points = vec![(0.0, 1.0), (100.0, 3.0), (f64::NAN, 9.0)];
        let close = |range: &Range<f64>, start: f64, end: f64| {
            assert!(
                (range.start - start).abs() < 1e-9 && (range.end - end).abs() < 1e-9,
                "{range:?}"
            );
        };
        let (x, y) = with(Series::line("", 0, points.clone()));
        close(&x, 0.0, 100.0);
        close(&y, 0.9, 3.1);
        let (x, _) = with(Series::dots("", 0, points.clone()));
        close(&x, -1.0, 101.0);
        // Bars of 0.8 of the distance less a little air, from zero on.
        let (x, y) = with(Series::bars("", 0, points[..2].to_vec()));
        close(&x, -36.8, 136.8);
        close(&y, -0.15, 3.15);
        let mut panel = Panel::new("", PlotAxis::new(""), PlotAxis::new("")).to_scale();
        panel.add(Series::line("", 0, vec![(0.0, 0.0), (200.0, 100.0)]));
        // Five metres of room above and below.
        assert!((panel.shape() - 0.55).abs() < 1e-12);
        // 200 m in 100 pixels, 1.04 times: 2.08 m a pixel both ways, about the middle.
        let window = panel.window(100.0, 100.0);
        close(&window.x.range, -4.0, 204.0);
        close(&window.y.range, -54.0, 154.0);
    }

    #[test]
    fn widths_of_letters_are_rather_too_large() {
        assert_eq!(text_width("il. "), 20.0);
        assert_eq!(text_width("mW%"), 36.0);
        assert_eq!(text_width("AZ−"), 28.5);
        assert_eq!(text_width("an0"), 24.0);
    }

    #[test]
    fn to_scale_a_metre_is_a_metre_wherever_the_way_is() {
        let of = |east: f64, north: f64| {
            let mut panel = Panel::new("", PlotAxis::new(""), PlotAxis::new("")).to_scale();
            let points = [(0.0, 0.0), (200.0, 100.0)].map(|(x, y)| (east + x, north + y));
            panel.add(Series::line("", 0, points.to_vec()));
            panel.window(100.0, 100.0)
        };
        for (east, north) in [(0.0, 0.0), (5000.0, 700.0), (-900.0, -1e4)] {
            let window = of(east, north);
            // 200 m and 4 % in 100 pixels of both axes, about the middle.
            for (range, middle) in [
                (&window.x.range, east + 100.0),
                (&window.y.range, north + 50.0),
            ] {
                assert!((range.start - (middle - 104.0)).abs() < 1e-9, "{range:?}");
                assert!((range.end - (middle + 104.0)).abs() < 1e-9, "{range:?}");
            }
        }
    }
}
