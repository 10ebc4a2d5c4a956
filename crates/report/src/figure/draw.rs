//! Panels as SVG: title, legend, axes, curves.

use super::{
    panel::Panel,
    paths::{key, paths},
    scale::{Window, px, text_width},
    style::style,
};
use crate::{markup::escape, numbers::short};
use std::path::Path;

/// Between panels \[pixel\].
const GAP: f64 = 14.0;
/// Between lines of text \[pixel\].
const LINE: f64 = 17.0;
/// Right of the plot: half of the last number below it.
const RIGHT: f64 = 22.0;
/// Letters of a name below the axis.
const LONGEST_NAME: usize = 24;

/// Panels side by side.
pub(crate) struct Drawing {
    /// The elements of each panel.
    panels: Vec<String>,
    /// What each shows, for those who hear the page.
    spoken: Vec<String>,
    columns: usize,
    /// Of each panel \[pixel\].
    size: (f64, f64),
}

/// Draws panels, `columns` side by side, each of a size \[pixel\]; `id` distinguishes the drawings of one page.
pub(crate) fn drawing(panels: &[Panel], columns: usize, size: (f64, f64), id: &str) -> Drawing {
    // Plots begin at one height and one distance from the left, so that their axes are in line.
    let most = |of: &dyn Fn(&Panel) -> f64| panels.iter().map(of).fold(0.0, f64::max);
    let title = most(&|panel| if panel.title.is_empty() { 8.0 } else { 28.0 });
    let left = most(&|panel| {
        let window = panel.window(size.0 - 80.0, size.1 - title - 60.0);
        let ticks = window.y.ticks();
        let numbers = ticks.iter().map(|tick| text_width(&tick.1));
        let label = if panel.y.label.is_empty() { 14.0 } else { 34.0 };
        (label + numbers.fold(12.0, f64::max)).min(0.4 * size.0)
    });
    let legends: Vec<(String, f64)> = panels
        .iter()
        .map(|panel| legend(panel, left, size.0))
        .collect();
    let below = legends.iter().map(|legend| legend.1).fold(0.0, f64::max);
    // A long legend takes nothing from the plot.
    let size = (size.0, size.1 + (below - 3.0 * LINE).max(0.0));
    let frame = Frame {
        left,
        title,
        top: title + below,
        size,
    };
    let spoken = panels.iter().map(spoken).collect();
    let panels = panels.iter().zip(&legends).enumerate();
    Drawing {
        spoken,
        panels: panels
            .map(|(i, (panel, (legend, _)))| frame.panel(panel, legend, &format!("{id}-{i}")))
            .collect(),
        columns: columns.max(1),
        size,
    }
}

impl Drawing {
    /// Each panel as an element of its own in a page.
    pub fn inline(&self) -> impl Iterator<Item = String> + '_ {
        self.panels.iter().zip(&self.spoken).map(|(panel, spoken)| {
            let spoken = escape(spoken);
            let attributes = format!("class=\"paper\" role=\"img\" aria-label=\"{spoken}\"");
            svg(&attributes, panel, self.size)
        })
    }

    /// All of them as the text of a file.
    pub fn file(&self) -> String {
        let columns = self.columns.min(self.panels.len()).max(1);
        let (width, height) = (self.size.0 + GAP, self.size.1 + GAP);
        let mut body = format!(
            "<rect width=\"100%\" height=\"100%\" fill=\"{}\"/>",
            style().ink("paper")
        );
        for (i, panel) in self.panels.iter().enumerate() {
            let (left, top) = ((i % columns) as f64 * width, (i / columns) as f64 * height);
            body += &format!("<g transform=\"translate({left} {top})\">{panel}</g>");
        }
        let rows = self.panels.len().div_ceil(columns) as f64;
        let size = (columns as f64 * width - GAP, (rows * height - GAP).max(1.0));
        svg("xmlns=\"http://www.w3.org/2000/svg\"", &body, size) + "\n"
    }
}

fn svg(attributes: &str, body: &str, (width, height): (f64, f64)) -> String {
    format!(
        "<svg {attributes} viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         font-family=\"sans-serif\" font-size=\"13\">{body}</svg>"
    )
}

/// Draws panels side by side into a file, `columns` to a row, each of a size \[pixel\].
///
/// # Errors
/// A sentence for the user when the file cannot be written.
pub fn draw(path: &Path, panels: &[Panel], columns: usize, size: (u32, u32)) -> Result<(), String> {
    let size = (f64::from(size.0), f64::from(size.1));
    undrift_io::write::write_whole(path, drawing(panels, columns, size, "panel").file())
        .map_err(|e| format!("cannot write {}: {e}", path.display()))
}

/// Where the parts of a panel are \[pixel\].
struct Frame {
    /// Left of the plot.
    left: f64,
    /// Above the legend.
    title: f64,
    /// Above the plot.
    top: f64,
    size: (f64, f64),
}

impl Frame {
    /// A panel. What the page's script draws again of a part of it has a class, and the plot its size.
    fn panel(&self, panel: &Panel, legend: &str, id: &str) -> String {
        let width = self.size.0 - self.left - RIGHT;
        let names = names(panel, width);
        let label = if panel.x.label.is_empty() { 4.0 } else { 22.0 };
        let below = 8.0 + names.as_ref().map_or(LINE, |names| names.1) + label;
        let height = (self.size.1 - self.top - below).max(40.0);
        let window = panel.window(width, height);
        let (ink, soft) = (style().ink("ink"), style().ink("soft"));
        let mut out = String::new();
        if !panel.title.is_empty() {
            out += &text(
                (self.left, 18.0),
                &fit(&panel.title, 0.85 * width),
                &format!("font-size=\"15\" font-weight=\"600\" fill=\"{ink}\""),
            );
        }
        out += &format!("<g transform=\"translate(0 {})\">{legend}</g>", self.title);
        let (ground, ticks) = axes(panel, &window);
        let curves = (0..panel.series.len()).map(|i| paths(panel, i, &window));
        let curves: String = curves.collect();
        out += &format!(
            "<g transform=\"translate({left} {top})\" data-size=\"{width} {height}\" fill=\"{soft}\">\
             <clipPath id=\"{id}\"><rect width=\"{width}\" height=\"{height}\"/></clipPath>\
             <g class=\"ground\">{ground}</g>\
             <g class=\"curves\" clip-path=\"url(#{id})\">{curves}</g>\
             <path d=\"M0 0V{height}H{width}\" fill=\"none\" stroke=\"{soft}\"/>\
             <g class=\"ticks\">{ticks}</g>{}\
             <g transform=\"translate(0 {height})\">{}</g>",
            if panel.to_scale {
                format!("<g class=\"map\">{}</g>", map_marks(&window))
            } else {
                String::new()
            },
            names.map_or(String::new(), |names| names.0),
            left = px(self.left),
            top = px(self.top),
            width = px(width),
            height = px(height),
        );
        let middle = "text-anchor=\"middle\"";
        out += &text(
            (0.5 * width, height + below - 6.0),
            &fit(&panel.x.label, width),
            middle,
        );
        let upright = format!("{middle} transform=\"rotate(-90)\"");
        out += &text(
            (-0.5 * height, 14.0 - self.left),
            &fit(&panel.y.label, height),
            &upright,
        );
        out + "</g>"
    }
}

/// Shades and grid behind the curves; marks and numbers beside the axes.
fn axes(panel: &Panel, window: &Window) -> (String, String) {
    let (grid, soft) = (style().ink("grid"), style().ink("soft"));
    let (width, height) = (px(window.x.length), px(window.y.length));
    let (mut ground, mut marks) = (String::new(), String::new());
    let side = |v: f64| Some(window.x.pixel(v)?.clamp(0.0, width));
    for (spans, ink) in [(&panel.shades, "shade"), (&panel.alarms, "alarm")] {
        let ink = style().ink(ink);
        for (from, to) in spans {
            if let (Some(from), Some(to)) = (side(*from), side(*to))
                && from < to
            {
                ground += &format!("<path d=\"M{from} 0H{to}V{height}H{from}Z\" fill=\"{ink}\"/>");
            }
        }
    }
    for (top, label) in window.y.ticks() {
        ground += &format!("<path d=\"M0 {top}H{width}\" stroke=\"{grid}\"/>");
        marks += &format!("<path d=\"M-4 {top}H0\" stroke=\"{soft}\"/>");
        marks += &text((-8.0, top + 4.5), &label, "text-anchor=\"end\"");
    }
    if panel.x.names.is_empty() {
        for (left, label) in window.x.ticks() {
            ground += &format!("<path d=\"M{left} 0V{height}\" stroke=\"{grid}\"/>");
            marks += &format!("<path d=\"M{left} {height}v4\" stroke=\"{soft}\"/>");
            marks += &text((left, height + LINE), &label, "text-anchor=\"middle\"");
        }
    }
    (ground, marks)
}

/// Scale bar, of a fifth of the width at most, and north arrow of a map.
fn map_marks(window: &Window) -> String {
    let pixels = window.x.length / (window.x.range.end - window.x.range.start).abs();
    let metres = 0.2 * window.x.length / pixels;
    let power = 10f64.powf(metres.log10().floor());
    let length = [5.0, 2.0, 1.0].map(|m| m * power);
    let Some(length) = length.into_iter().find(|m| *m <= metres) else {
        return String::new();
    };
    let wide = length * pixels;
    if !(wide > 0.0 && wide < window.x.length) {
        return String::new();
    }
    let (wide, bottom) = (px(wide), px(window.y.length - 12.0));
    let label = match length {
        1e3.. => format!("{} km", length / 1e3),
        1.0.. => format!("{length} m"),
        _ => format!("{} cm", (1e4 * length).round() / 100.0),
    };
    let soft = style().ink("soft");
    let middle = "text-anchor=\"middle\"";
    format!(
        "<path d=\"M12 {}v5h{wide}v-5M18 46V24l-5 9M18 24l5 9\" fill=\"none\" stroke=\"{soft}\" stroke-width=\"1.5\"/>{}{}",
        px(bottom - 5.0),
        text((12.0 + 0.5 * wide, bottom - 6.0), &label, middle),
        text((18.0, 18.0), "N", middle)
    )
}

/// Curves of one panel that its spoken text goes into.
const SPOKEN: usize = 8;

/// A panel in words: its axes and from where to where its curves go.
fn spoken(panel: &Panel) -> String {
    let axes = [panel.y.label.as_str(), panel.x.label.as_str()];
    let axes = Vec::from_iter(axes.into_iter().filter(|label| !label.is_empty())).join(" over ");
    let title = [panel.title.as_str(), axes.as_str()];
    let title = Vec::from_iter(title.into_iter().filter(|text| !text.is_empty())).join(": ");
    let known = panel.series.iter().filter(|series| !series.name.is_empty());
    let ranges = known.clone().take(SPOKEN).map(|series| {
        let values = || series.points().map(|p| p.1).filter(|v| v.is_finite());
        let least = values().fold(f64::INFINITY, f64::min);
        let most = values().fold(f64::NEG_INFINITY, f64::max);
        match (panel.to_scale, least <= most) {
            (false, true) => format!("{} {} to {}", series.name, short(least), short(most)),
            _ => series.name.clone(),
        }
    });
    let ranges = Vec::from_iter(ranges).join("; ");
    let more = match known.count().saturating_sub(SPOKEN) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    let map = if panel.to_scale { "Map" } else { "Plot" };
    match ranges.as_str() {
        "" => format!("{map}. {title}."),
        ranges => format!("{map}. {title}. {ranges}{more}."),
    }
}

/// The names of the series with their samples, in rows, and how high they are; what the script hides
/// goes by its place.
fn legend(panel: &Panel, left: f64, width: f64) -> (String, f64) {
    let (mut out, mut across, mut top) = (String::new(), left, 0.0);
    for (i, series) in panel.series.iter().enumerate() {
        if series.name.is_empty() {
            continue;
        }
        let wide = 38.0 + text_width(&series.name);
        if across > left && across + wide > width {
            (across, top) = (left, top + LINE + 2.0);
        }
        let name = text(
            (24.0, 10.5),
            &fit(&series.name, width - left - 30.0),
            &format!("fill=\"{}\"", style().ink("ink")),
        );
        out += &format!(
            "<g data-series=\"{i}\" transform=\"translate({} {top})\">{}{name}</g>",
            px(across),
            key(series)
        );
        across += wide;
    }
    let height = if out.is_empty() {
        0.0
    } else {
        top + LINE + 6.0
    };
    (out, height)
}

/// The names below an axis of names and how high they are: in up to three lines, upright where that
/// is not enough.
fn names(panel: &Panel, width: f64) -> Option<(String, f64)> {
    let names = &panel.x.names;
    if names.is_empty() {
        return None;
    }
    let window = panel.window(width, 1.0);
    let room = window.x.pixel(1.0)? - window.x.pixel(0.0)? - 8.0;
    let broken: Vec<Vec<String>> = names.iter().map(|name| lines(name, room)).collect();
    let fits =
        |lines: &Vec<String>| lines.len() <= 3 && lines.iter().all(|line| text_width(line) <= room);
    let (mut out, mut height) = (String::new(), LINE);
    if broken.iter().all(fits) {
        for (i, lines) in broken.iter().enumerate() {
            let left = window.x.pixel(i as f64)?;
            for (k, line) in lines.iter().enumerate() {
                let top = LINE * (k + 1) as f64;
                out += &text((left, top), line, "text-anchor=\"middle\"");
                height = height.max(top);
            }
        }
    } else {
        for (i, name) in names.iter().enumerate() {
            let left = window.x.pixel(i as f64)? + 4.5;
            let shown = match name.char_indices().nth(LONGEST_NAME) {
                Some((end, _)) => format!("{}…", &name[..end]),
                None => name.clone(),
            };
            height = height.max(text_width(&shown));
            out += &text(
                (-8.0, left),
                &shown,
                "text-anchor=\"end\" transform=\"rotate(-90)\"",
            );
        }
    }
    Some((out, height))
}

/// A name broken after spaces and dashes into lines that have room.
fn lines(name: &str, room: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in name.split_inclusive([' ', '-', '–', '/']) {
        match lines.last_mut() {
            Some(last) if text_width(last) + text_width(word.trim_end()) <= room => *last += word,
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// A text, as much of it as has room.
fn fit(content: &str, room: f64) -> String {
    let mut width = 0.0;
    let long = content.char_indices().find(|(at, c)| {
        width += text_width(c.encode_utf8(&mut [0; 4]));
        // Widths are rather too large.
        *at > 0 && width > 1.1 * room
    });
    long.map_or(content.to_owned(), |(end, _)| {
        format!("{}…", &content[..end])
    })
}

fn text((left, top): (f64, f64), content: &str, attributes: &str) -> String {
    if content.is_empty() {
        return String::new();
    }
    let (left, top, content) = (px(left), px(top), escape(content));
    format!("<text x=\"{left}\" y=\"{top}\" {attributes}>{content}</text>")
}

#[cfg(test)]
mod tests;
