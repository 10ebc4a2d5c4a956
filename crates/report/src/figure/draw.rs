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

/// Draws panels, `columns` side by side, each of a size \[pixel\]; `id` tells the drawings of one page apart.
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
mod tests {
    use super::*;
    use crate::figure::{
        panel::{PlotAxis, Series},
        scale::{Along, Scale},
    };

    /// A map of so many metres in five hundred pixels.
    fn map(metres: f64) -> Window {
        let axis = PlotAxis::new("");
        Window {
            x: Scale::new(&axis, Along::X, 0.0..metres, 500.0),
            y: Scale::new(&axis, Along::Y, 0.0..metres, 400.0),
        }
    }

    #[test]
    fn a_scale_bar_is_round_and_a_fifth_of_the_map_at_most() {
        for (metres, label, wide) in [
            (1000.0, "200 m", 100.0),
            (1200.0, "200 m", 250.0 / 3.0),
            (900.0, "100 m", 500.0 / 9.0),
            (26_000.0, "5 km", 2500.0 / 26.0),
            (5.0, "1 m", 100.0),
            (2.6, "50 cm", 250.0 / 2.6),
            (4e6, "500 km", 62.5),
        ] {
            let marks = map_marks(&map(metres));
            assert!(marks.contains(&format!(">{label}<")), "{metres}: {marks}");
            // From 12 pixels on, twelve above the lower edge, its length in the middle.
            let bar = format!("M12 {}v5h{}v-5", px(383.0), px(wide));
            assert!(marks.contains(&bar), "{bar}: {marks}");
            let middle = text(
                (12.0 + 0.5 * px(wide), 382.0),
                label,
                "text-anchor=\"middle\"",
            );
            assert!(marks.contains(&middle), "{middle}: {marks}");
        }
    }

    fn panel(names: &[&str]) -> Panel {
        let x = if names.is_empty() {
            PlotAxis::new("time [s]")
        } else {
            PlotAxis::categories(names.iter().copied())
        };
        let mut panel = Panel::new("Title", x, PlotAxis::new("error [m]"));
        panel.add(Series::line("<a & b>", 7, vec![(0.0, 0.0), (1.0, 1.0)]));
        panel
    }

    #[test]
    fn a_file_holds_its_panels() {
        let file = drawing(
            &[panel(&[]), panel(&[]), panel(&[])],
            2,
            (400.0, 300.0),
            "a",
        )
        .file();
        assert!(file.contains("viewBox=\"0 0 814 614\""), "{file}");
        assert_eq!(file.matches("&lt;a &amp; b&gt;").count(), 3);
        assert_eq!(file.matches("<clipPath id=\"a-").count(), 3);
        assert_eq!(file.matches("stroke=\"#0072b2\"").count(), 6);
        assert_eq!(file.matches("<g").count(), file.matches("</g>").count());
        assert!(!file.contains("NaN") && !file.contains("inf"));
        assert!(drawing(&[], 0, (400.0, 300.0), "a").file().contains("<svg"));
    }

    #[test]
    fn names_are_broken_or_stand_upright() {
        let of = |names: &[&str]| {
            let (drawn, _) = super::names(&panel(names), 300.0).unwrap();
            drawn.matches("rotate").count()
        };
        assert_eq!(
            lines("white, no constants", 60.0),
            ["white, ", "no ", "constants"]
        );
        assert_eq!(of(&["white, no constants", "b", "c"]), 0);
        assert_eq!(of(&["unbreakable_and_far_too_long", "b", "c"]), 3);
        assert_eq!(fit("horizontal error [m]", 300.0), "horizontal error [m]");
        assert!(fit("horizontal error [m]", 60.0).ends_with('…'));
    }
    #[test]
    fn labels_stand_in_the_middle_of_their_axes() {
        let file = drawing(&[panel(&[])], 1, (400.0, 300.0), "a").file();
        // Left of the plot 34 for the label and 21 for "0.2"; above it 28 for the title and 23 for a row of names; below it 47.
        assert!(
            file.contains("<g transform=\"translate(55 51)\" data-size=\"323 202\""),
            "{file}"
        );
        for text in [
            "<text x=\"55\" y=\"18\" font-size=\"15\"",
            "<text x=\"161.5\" y=\"243\" text-anchor=\"middle\">time [s]</text>",
            "<text x=\"-101\" y=\"-41\" text-anchor=\"middle\" transform=\"rotate(-90)\">error [m]</text>",
            "<path d=\"M0 0V202H323\"",
            "<rect width=\"323\" height=\"202\"/>",
        ] {
            assert!(file.contains(text), "{text}: {file}");
        }
        // From 0 to 1 with a twentieth of room above and below; of x from end to end.
        assert!(file.contains("d=\"M0 192.8l323-183.6\""), "{file}");
        assert!(
            file.contains("<path d=\"M-4 192.8H0\"") && file.contains("<text x=\"-8\" y=\"197.3\""),
            "{file}"
        );
        assert!(
            file.contains("<path d=\"M323 202v4\"") && file.contains("<text x=\"323\" y=\"219\""),
            "{file}"
        );
    }

    #[test]
    fn without_title_label_or_names_the_plot_has_their_room() {
        let mut bare = Panel::new("", PlotAxis::new(""), PlotAxis::new(""));
        bare.add(Series::line("", 7, vec![(0.0, 0.0), (1.0, 1.0)]));
        let file = drawing(&[bare], 1, (400.0, 300.0), "a").file();
        // 14 + 21 on the left, 8 above, 8 + 17 + 4 below.
        assert!(
            file.contains("translate(35 8)\" data-size=\"343 263\""),
            "{file}"
        );
    }

    #[test]
    fn panels_stand_in_rows() {
        let three = [panel(&[]), panel(&[]), panel(&[])];
        let file = drawing(&three, 2, (400.0, 300.0), "a").file();
        for place in ["0 0", "414 0", "0 314"] {
            assert!(
                file.contains(&format!("<g transform=\"translate({place})\"><text")),
                "{place}"
            );
        }
        let inline: Vec<String> = drawing(&three, 2, (400.0, 300.0), "a").inline().collect();
        assert_eq!(inline.len(), 3);
        assert!(
            inline[0].contains("viewBox=\"0 0 400 300\""),
            "{}",
            inline[0]
        );
        assert!(
            inline[0].contains(
                "aria-label=\"Plot. Title: error [m] over time [s]. &lt;a &amp; b&gt; 0 to 1.00.\""
            ),
            "{}",
            inline[0]
        );
    }

    #[test]
    fn a_legend_goes_on_in_the_next_row_where_there_is_no_room() {
        let with = |names: &[&str]| {
            let mut panel = Panel::new("", PlotAxis::new(""), PlotAxis::new(""));
            for name in names {
                panel.add(Series::line(name, 7, Vec::new()));
            }
            legend(&panel, 50.0, 200.0)
        };
        // A letter is 8 wide, its sample and the air 38.
        let (drawn, height) = with(&["a", "", "b", "c", "d"]);
        for (place, series) in [("50 0", 0), ("96 0", 2), ("142 0", 3), ("50 19", 4)] {
            let group = format!("<g data-series=\"{series}\" transform=\"translate({place})\">");
            assert!(drawn.contains(&group), "{group}: {drawn}");
        }
        assert_eq!(height, 42.0);
        // The first is drawn in the first row however long it is.
        let (drawn, height) = with(&["a long name that does not fit"]);
        assert!(
            drawn.contains("translate(50 0)") && drawn.contains('…'),
            "{drawn}"
        );
        assert_eq!(height, 23.0);
        assert_eq!(with(&["", ""]), (String::new(), 0.0));
        // More than two rows make the drawing higher.
        let mut high = panel(&[]);
        for _ in 0..9 {
            high.add(Series::line(&"n".repeat(40), 7, Vec::new()));
        }
        // Ten rows of 19 and 4.
        let file = drawing(&[high], 1, (400.0, 300.0), "a").file();
        let height = 300.0 + (9.0 * 19.0 + 23.0) - 51.0;
        assert!(
            file.contains(&format!("viewBox=\"0 0 400 {height}\"")),
            "{file}"
        );
    }

    #[test]
    fn shades_are_cut_off_at_the_ends_of_the_plot() {
        let mut panel = Panel::new(
            "",
            PlotAxis::new("").within(0.0..10.0),
            PlotAxis::new("").within(0.0..1.0),
        );
        panel.shade(-5.0, 2.0);
        panel.shade(8.0, 20.0);
        panel.shade(4.0, 4.0);
        panel.shade(11.0, 20.0);
        panel.shade(6.0, 5.0);
        panel.alarm(3.0, 5.0);
        let (ground, marks) = axes(&panel, &panel.window(100.0, 50.0));
        let of = |ink: &str| -> Vec<&str> {
            let paths = ground.split("<path d=\"");
            paths
                .filter(|path| path.contains(style().ink(ink)))
                .collect()
        };
        let (shades, alarms) = (of("shade"), of("alarm"));
        assert!(alarms.len() == 1 && alarms[0].starts_with("M30 0H50V50H30Z"));
        assert_eq!(shades.len(), 2, "{ground}");
        assert!(
            shades[0].starts_with("M0 0H20V50H0Z") && shades[1].starts_with("M80 0H100V50H80Z")
        );
        // A tick at the foot of the axis, and its line across.
        assert!(
            ground.contains("<path d=\"M0 50H100\"") && marks.contains("<text x=\"-8\" y=\"54.5\"")
        );
    }

    #[test]
    fn a_panel_is_spoken_with_the_range_of_its_first_curves() {
        let mut plot = Panel::new("", PlotAxis::new("x"), PlotAxis::new(""));
        assert_eq!(spoken(&plot), "Plot. x.");
        for k in 0..10u32 {
            let y = f64::from(k);
            plot.add(Series::line(
                &k.to_string(),
                0,
                vec![(0.0, -y), (1.0, f64::NAN), (2.0, y)],
            ));
        }
        plot.add(Series::line("", 0, vec![(0.0, 5.0)]));
        let text = spoken(&plot);
        assert!(
            text.starts_with("Plot. x. 0 0 to 0; 1 -1.00 to 1.00; ")
                && text.ends_with("; 7 -7.00 to 7.00 and 2 more."),
            "{text}"
        );
        let mut map = Panel::new("way", PlotAxis::new("east"), PlotAxis::new("north")).to_scale();
        map.add(Series::line("driven", 0, vec![(0.0, 1.0)]));
        assert_eq!(spoken(&map), "Map. way: north over east. driven.");
        let mut none = Panel::new("", PlotAxis::new("x"), PlotAxis::new(""));
        none.add(Series::line("a", 0, Vec::new()));
        assert_eq!(spoken(&none), "Plot. x. a.");
    }

    #[test]
    fn names_stand_below_their_places() {
        // Three in 320 pixels over -0.6 to 2.6: 100 apart, the first at 60.
        let (drawn, height) =
            super::names(&panel(&["a", "white, no constants", "c"]), 320.0).unwrap();
        for (left, top, name) in [
            ("60", 17, "a"),
            ("160", 17, "white, no "),
            ("160", 34, "constants"),
            ("260", 17, "c"),
        ] {
            let text =
                format!("<text x=\"{left}\" y=\"{top}\" text-anchor=\"middle\">{name}</text>");
            assert!(drawn.contains(&text), "{text}: {drawn}");
        }
        assert_eq!(height, 34.0);
        // Upright ones have 24 letters at most, and the room of the longest.
        let long = "n".repeat(30);
        let (drawn, height) = super::names(&panel(&[&long, "b", "c"]), 320.0).unwrap();
        let text = format!(
            "<text x=\"-8\" y=\"64.5\" text-anchor=\"end\" transform=\"rotate(-90)\">{}…</text>",
            "n".repeat(24)
        );
        assert!(drawn.contains(&text), "{text}: {drawn}");
        assert_eq!(height, 24.0 * 8.0 + 12.0);
        assert!(super::names(&panel(&[]), 320.0).is_none());
    }

    #[test]
    fn a_text_is_cut_where_it_leaves_a_tenth_more_than_its_room() {
        // Ten letters of 8.
        assert_eq!(fit("nnnnnnnnnn", 73.0), "nnnnnnnnnn");
        assert_eq!(fit("nnnnnnnnnn", 72.0), "nnnnnnnnn…");
        assert_eq!(fit("nn", 0.0), "n…");
        assert_eq!(
            text((1.04, 2.06), "a<b", "k"),
            "<text x=\"1\" y=\"2.1\" k>a&lt;b</text>"
        );
        assert_eq!(text((1.0, 2.0), "", "k"), "");
    }
}
