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

/// Left and right edge of a bar or box, relative to its x: those of several series are side by
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
mod tests;
