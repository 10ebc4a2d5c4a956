//! Panels drawn as SVG.

use super::{
    COLOURS,
    panel::{Corner, Panel, Series, Style},
    shapes::{Scale, Window, bar_slot, runs},
};
use plotters::{
    coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged},
    element::{DashedPathElement, DynElement},
    prelude::*,
    style::text_anchor::{HPos, Pos, VPos},
};
use std::{ops::Range, path::Path};

type Failure = Box<dyn std::error::Error>;
pub(super) type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;
type Element<'a> = DynElement<'static, SVGBackend<'a>, (f64, f64)>;

/// The drawing library knows whole units only: so many to a pixel keep curves smooth.
const FINE: u32 = 8;

/// Draws panels side by side, `columns` to a row, each of a size \[pixel\].
///
/// # Errors
/// A sentence for the user when the file cannot be written.
pub fn draw(path: &Path, panels: &[Panel], columns: usize, size: (u32, u32)) -> Result<(), String> {
    svg(panels, columns, size)
        .and_then(|text| undrift::io::write::write_whole(path, text).map_err(|e| e.to_string()))
        .map_err(|e| format!("cannot draw {}: {e}", path.display()))
}

/// The text of an SVG file with panels side by side, `columns` to a row, each of a size \[pixel\].
///
/// # Errors
/// What the drawing library says.
pub(crate) fn svg(
    panels: &[Panel],
    columns: usize,
    (width, height): (u32, u32),
) -> Result<String, String> {
    let columns = columns.clamp(1, panels.len().max(1));
    let rows = panels.len().div_ceil(columns).max(1);
    let size = (width * columns as u32, height * rows as u32);
    let fine = (size.0 * FINE, size.1 * FINE);
    let mut text = String::new();
    let figure = |text: &mut String| -> Result<(), Failure> {
        let root = SVGBackend::with_string(text, fine).into_drawing_area();
        root.fill(&WHITE)?;
        for (area, panel) in root.split_evenly((rows, columns)).iter().zip(panels) {
            panel.draw(area, FINE)?;
        }
        root.present()?;
        Ok(())
    };
    figure(&mut text).map_err(|e| e.to_string())?;
    let measures = |(width, height)| format!("<svg width=\"{width}\" height=\"{height}\"");
    Ok(text.replacen(&measures(fine), &measures(size), 1))
}

/// What is left of an area below its title and inside its margin.
struct Frame<'a> {
    area: Area<'a>,
    /// Units of the area to a pixel.
    unit: u32,
    label_height: u32,
    upright_names: bool,
}

/// Room for the numbers of the y axis \[pixel\].
const LABEL_WIDTH: u32 = 72;

/// Letters of a name below the axis.
const LONGEST_NAME: usize = 24;

impl Panel {
    /// Draws the panel into a part of a figure with so many units to a pixel.
    pub(super) fn draw(&self, area: &Area, unit: u32) -> Result<(), Failure> {
        let frame = self.frame(area, unit)?;
        let (width, height) = frame.area.dim_in_pixel();
        let window = self.window(
            f64::from(width.saturating_sub(LABEL_WIDTH * unit).max(1)),
            f64::from(height.saturating_sub(frame.label_height).max(1)),
        );
        self.draw_over(&frame, &window)
    }

    /// Writes the title; names below the axis stand upright where they are too long side by side.
    fn frame<'a>(&self, area: &Area<'a>, unit: u32) -> Result<Frame<'a>, Failure> {
        const LETTER: usize = 8;
        let area = area.margin(14 * unit, 14 * unit, 14 * unit, 22 * unit);
        let area = if self.title.is_empty() {
            area
        } else {
            area.titled(&self.title, ("sans-serif", 18 * unit))?
        };
        let names = &self.x.names;
        let longest = names.iter().map(|n| n.chars().count()).max().unwrap_or(0) * LETTER;
        let room = (area.dim_in_pixel().0 / unit).saturating_sub(LABEL_WIDTH) as usize;
        let upright_names = longest * names.len() > room;
        let label_height = match (names.is_empty(), upright_names) {
            (true, _) => 38,
            (false, false) => 26,
            (false, true) => longest.min((LONGEST_NAME + 1) * LETTER) as u32 + 16,
        };
        Ok(Frame {
            area,
            unit,
            label_height: label_height * unit,
            upright_names,
        })
    }

    fn draw_over(&self, frame: &Frame, window: &Window) -> Result<(), Failure> {
        let unit = frame.unit;
        let font = ("sans-serif", 13 * unit);
        let mut chart = ChartBuilder::on(&frame.area)
            .x_label_area_size(frame.label_height)
            .y_label_area_size(LABEL_WIDTH * unit)
            .build_cartesian_2d(window.x.clone(), window.y.clone())?;
        for &(from, to) in &self.shades {
            let (from, to) = (window.x.clamp(from), window.x.clamp(to));
            if from < to {
                chart.draw_series([Rectangle::new(
                    [(from, window.y.range.start), (to, window.y.range.end)],
                    RGBColor(240, 240, 240).filled(),
                )])?;
            }
        }
        let named = !self.x.names.is_empty();
        let x_label = |v: &f64| {
            if named {
                String::new()
            } else {
                window.x.label(*v)
            }
        };
        let y_label = |v: &f64| window.y.label(*v);
        let mut mesh = chart.configure_mesh();
        mesh.x_desc(&self.x.label)
            .y_desc(&self.y.label)
            .light_line_style(TRANSPARENT)
            .bold_line_style(RGBColor(225, 225, 225).stroke_width(unit))
            .axis_style(BLACK.stroke_width(unit))
            .set_all_tick_mark_size(5 * unit)
            .label_style(font)
            .axis_desc_style(font)
            .x_label_formatter(&x_label)
            .y_label_formatter(&y_label);
        if named {
            mesh.disable_x_mesh();
        }
        mesh.draw()?;
        self.draw_names(frame, &window.x)?;
        for (i, series) in self.series.iter().enumerate() {
            let drawn = chart.draw_series(self.elements(i, series, window, unit))?;
            if !series.name.is_empty() {
                let (colour, style) = (COLOURS[series.colour % COLOURS.len()], series.style);
                drawn
                    .label(&series.name)
                    .legend(move |at| key(at, colour, style, unit));
            }
        }
        if self.series.iter().any(|s| !s.name.is_empty()) {
            chart
                .configure_series_labels()
                .position(match self.legend_corner(window) {
                    Corner::UpperLeft => SeriesLabelPosition::UpperLeft,
                    Corner::UpperRight => SeriesLabelPosition::UpperRight,
                    Corner::LowerLeft => SeriesLabelPosition::LowerLeft,
                    Corner::LowerRight => SeriesLabelPosition::LowerRight,
                })
                .background_style(WHITE.mix(0.85))
                .border_style(RGBColor(200, 200, 200).stroke_width(unit))
                .margin(10 * unit)
                .legend_area_size(30 * unit)
                .label_font(font)
                .draw()?;
        }
        Ok(())
    }

    /// Writes the names below the axis.
    fn draw_names(&self, frame: &Frame, scale: &Scale) -> Result<(), Failure> {
        let (width, height) = frame.area.dim_in_pixel();
        let unit = frame.unit;
        let (left, right) = ((LABEL_WIDTH * unit) as i32, width as i32);
        let top = height as i32 - frame.label_height as i32 + 9 * unit as i32;
        let font = ("sans-serif", 13 * unit).into_font();
        let (font, across, below) = if frame.upright_names {
            let upright = font.transform(FontTransform::Rotate270);
            (upright, HPos::Right, VPos::Center)
        } else {
            (font, HPos::Center, VPos::Top)
        };
        let style = TextStyle::from(font).pos(Pos::new(across, below));
        for (i, name) in self.x.names.iter().enumerate() {
            let at = (scale.map(&(i as f64), (left, right)), top);
            let shown = match name.char_indices().nth(LONGEST_NAME) {
                Some((end, _)) => format!("{}…", &name[..end]),
                None => name.clone(),
            };
            frame.area.draw(&Text::new(shown, at, style.clone()))?;
        }
        Ok(())
    }

    /// What a series looks like inside the window.
    fn elements<'a>(
        &self,
        index: usize,
        series: &Series,
        window: &Window,
        unit: u32,
    ) -> Vec<Element<'a>> {
        let colour = COLOURS[series.colour % COLOURS.len()];
        let column = |i: usize| series.y.get(i).map_or(&[][..], Vec::as_slice);
        match series.style {
            Style::Line(width) => runs(&series.x, column(0), window)
                .into_iter()
                .map(|run| PathElement::new(run, colour.stroke_width(width * unit)).into_dyn())
                .collect(),
            Style::Dashed => runs(&series.x, column(0), window)
                .into_iter()
                .map(|run| {
                    DashedPathElement::new(run, 6 * unit, 4 * unit, colour.stroke_width(2 * unit))
                        .into_dyn()
                })
                .collect(),
            Style::Dots => series
                .points()
                .filter(|&(x, y)| window.holds(x, y))
                .map(|point| Circle::new(point, 3 * unit, colour.filled()).into_dyn())
                .collect(),
            Style::Band => {
                // What is beyond the window goes along its edge, so that both bounds have the same runs.
                let edged = |bound: &[f64]| -> Vec<f64> {
                    bound.iter().map(|y| window.y.clamp(*y)).collect()
                };
                let lower = runs(&series.x, &edged(column(0)), window);
                let upper = runs(&series.x, &edged(column(1)), window);
                lower
                    .into_iter()
                    .zip(upper)
                    .map(|(low, high)| {
                        let outline: Vec<_> =
                            low.into_iter().chain(high.into_iter().rev()).collect();
                        Polygon::new(outline, colour.mix(0.2)).into_dyn()
                    })
                    .collect()
            }
            Style::Bars => {
                let slot = bar_slot(self, index);
                let base = window.y.clamp(0.0);
                series
                    .points()
                    .filter(|&(x, y)| window.holds(x, window.y.clamp(y)))
                    .map(|(x, y)| {
                        let [left, right] = slot.map(|s| window.x.clamp(x + s));
                        let corners = [(left, base), (right, window.y.clamp(y))];
                        Rectangle::new(corners, colour.filled()).into_dyn()
                    })
                    .collect()
            }
            Style::Boxes => {
                let slot = bar_slot(self, index);
                let one = |i: usize, x: f64| -> Vec<Element<'a>> {
                    let at = |k: usize| column(k).get(i).copied().unwrap_or(f64::NAN);
                    let level = std::array::from_fn::<f64, 5, _>(at);
                    if !level.iter().all(|v| self.y.takes(*v))
                        || !window.holds(x, window.y.range.start)
                    {
                        return Vec::new();
                    }
                    let [low, q1, median, q3, high] = level.map(|v| window.y.clamp(v));
                    let [left, right] = slot.map(|s| window.x.clamp(x + s));
                    let middle = f64::midpoint(left, right);
                    let path = |points: Vec<(f64, f64)>, width: u32| {
                        PathElement::new(points, colour.stroke_width(width * unit)).into_dyn()
                    };
                    let frame = [(left, q1), (right, q1), (right, q3), (left, q3), (left, q1)];
                    vec![
                        Rectangle::new([(left, q1), (right, q3)], colour.mix(0.2).filled())
                            .into_dyn(),
                        path(frame.to_vec(), 1),
                        path(vec![(middle, low), (middle, q1)], 1),
                        path(vec![(middle, q3), (middle, high)], 1),
                        path(vec![(left, median), (right, median)], 3),
                    ]
                };
                let boxes = series.x.iter().enumerate();
                boxes.flat_map(|(i, &x)| one(i, x)).collect()
            }
        }
    }
}

impl Ranged for Scale {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (first, last): (i32, i32)) -> i32 {
        let place = self.place(*value).clamp(0.0, 1.0);
        first + (place * f64::from(last - first)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        self.ticks.clone()
    }

    fn range(&self) -> Range<f64> {
        self.range.clone()
    }
}

/// The sample of a series beside its name.
fn key<'a>(
    (x, y): (i32, i32),
    colour: RGBColor,
    style: Style,
    unit: u32,
) -> DynElement<'static, SVGBackend<'a>, (i32, i32)> {
    let px = |n: i32| n * unit as i32;
    let line = |to: i32, width: u32| {
        PathElement::new(
            vec![(x, y), (x + px(to), y)],
            colour.stroke_width(width * unit),
        )
        .into_dyn()
    };
    let patch = |share: f64| {
        let corners = [(x, y - px(5)), (x + px(18), y + px(5))];
        Rectangle::new(corners, colour.mix(share).filled()).into_dyn()
    };
    match style {
        Style::Line(width) => line(18, width),
        Style::Dashed => line(7, 2),
        Style::Dots => Circle::new((x + px(9), y), 3 * unit, colour.filled()).into_dyn(),
        Style::Band | Style::Boxes => patch(0.2),
        Style::Bars => patch(1.0),
    }
}
