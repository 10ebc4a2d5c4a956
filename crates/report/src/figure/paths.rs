//! The curves of a panel as SVG paths, in pixels of the plot.

use super::{
    panel::{Drawn, Panel, Series},
    scale::{Scale, Window, bar_slot, px},
    style::style,
};

/// The paths of a series.
pub(super) fn paths(panel: &Panel, index: usize, window: &Window) -> String {
    let series = &panel.series[index];
    let column = |i: usize| series.y.get(i).map_or(&[][..], Vec::as_slice);
    match series.drawn {
        Drawn::Thin | Drawn::Line | Drawn::Thick | Drawn::Dashed => {
            path(series, &line(&series.x, column(0), window))
        }
        Drawn::Dots | Drawn::Points => path(series, &dots(&series.x, column(0), window)),
        Drawn::Band => path(series, &band(&series.x, [column(0), column(1)], window)),
        Drawn::Bars => {
            let bars = series.points().filter_map(|(x, y)| {
                let [left, right] = sides(x, bar_slot(panel, index), &window.x)?;
                Some(rectangle(left, window.y.base(), right, window.y.pixel(y)?))
            });
            path(series, &bars.collect::<String>())
        }
        Drawn::Boxes => {
            let slot = bar_slot(panel, index);
            let boxes = series.x.iter().enumerate().filter_map(|(i, &x)| {
                let mut levels = [0.0; 5];
                for (level, column) in levels.iter_mut().zip(&series.y) {
                    *level = window.y.pixel(*column.get(i)?)?;
                }
                Some((sides(x, slot, &window.x)?, levels))
            });
            let (mut areas, mut lines, mut medians) = (String::new(), String::new(), String::new());
            for ([left, right], [low, q1, median, q3, high]) in boxes {
                let (middle, area) = (
                    px(f64::midpoint(left, right)),
                    rectangle(left, q3, right, q1),
                );
                areas += &area;
                lines += &format!("{area}M{middle} {q1}V{low}M{middle} {q3}V{high}");
                medians += &format!("M{left} {median}H{right}");
            }
            let colour = style().colour(series.colour);
            fill(&areas, colour, style().tint)
                + &stroke(&lines, colour, style().width(Drawn::Thin))
                + &stroke(&medians, colour, style().width(Drawn::Thick))
        }
    }
}

/// The sample of a series beside its name, on 18 by 12 pixels.
pub(super) fn key(series: &Series) -> String {
    path(
        series,
        match series.drawn {
            Drawn::Thin | Drawn::Line | Drawn::Thick | Drawn::Dashed => "M0 6H18",
            Drawn::Dots | Drawn::Points => "M9 6h.01",
            Drawn::Band => "M0 1H18V11H0Z",
            Drawn::Bars | Drawn::Boxes => "M3 1H15V11H3Z",
        },
    )
}

/// A path in the manner of a series.
fn path(series: &Series, d: &str) -> String {
    let style = style();
    let colour = style.colour(series.colour);
    match series.drawn {
        Drawn::Band | Drawn::Boxes => fill(d, colour, style.tint),
        Drawn::Bars => fill(d, colour, 1.0),
        Drawn::Dots => round(d, colour, style.dot),
        Drawn::Points => round(d, colour, style.width(Drawn::Points)),
        Drawn::Dashed => dashed(d, colour, style.width(Drawn::Dashed), &style.dash),
        line if series.dash == 0 => stroke(d, colour, style.width(line)),
        line => dashed(d, colour, style.width(line), style.pattern(series.dash)),
    }
}

fn fill(d: &str, colour: &str, opacity: f64) -> String {
    format!("<path d=\"{d}\" fill=\"{colour}\" opacity=\"{opacity}\"/>")
}

fn stroke(d: &str, colour: &str, width: f64) -> String {
    format!(
        "<path d=\"{d}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" stroke-linejoin=\"round\"/>"
    )
}

fn round(d: &str, colour: &str, width: f64) -> String {
    stroke(d, colour, width).replace("/>", " stroke-linecap=\"round\"/>")
}

fn dashed(d: &str, colour: &str, width: f64, pattern: &str) -> String {
    stroke(d, colour, width).replace("/>", &format!(" stroke-dasharray=\"{pattern}\"/>"))
}

/// Left and right side of a bar.
fn sides(x: f64, slot: [f64; 2], scale: &Scale) -> Option<[f64; 2]> {
    Some([scale.pixel(x + slot[0])?, scale.pixel(x + slot[1])?])
}

fn rectangle(left: f64, top: f64, right: f64, bottom: f64) -> String {
    format!("M{left} {top}H{right}V{bottom}H{left}Z")
}

/// A line, broken where it has no place. What would only go over a column of pixels that is drawn
/// already is left out.
fn line(x: &[f64], y: &[f64], window: &Window) -> String {
    let mut d = String::new();
    // Where the pen is, and from where to where its column of pixels is drawn.
    let mut pen: Option<([f64; 2], f64, f64)> = None;
    // Where a piece begins that has but one point so far.
    let mut begun = 0;
    for (&x, &y) in x.iter().zip(y) {
        let (Some(left), Some(top)) = (window.x.pixel(x), window.y.pixel(y)) else {
            pen = None;
            continue;
        };
        let (mut low, mut high) = (top, top);
        match pen {
            None => {
                d += &format!("M{left} {top}");
                begun = d.len();
            }
            Some(([_, _], least, most))
                if here(pen) == left.round() && least <= top && top <= most =>
            {
                continue;
            }
            Some((from, least, most)) => {
                if here(pen) == left.round() {
                    (low, high) = (least.min(top), most.max(top));
                }
                if d.len() == begun {
                    d.push('l');
                }
                step(&mut d, left - from[0]);
                step(&mut d, top - from[1]);
            }
        }
        pen = Some(([left, top], low, high));
    }
    d
}

/// The column of pixels where a pen is.
fn here(pen: Option<([f64; 2], f64, f64)>) -> f64 {
    pen.map_or(f64::NAN, |(at, ..)| at[0].round())
}

/// A number of a path relative to the one before, in few letters.
fn step(d: &mut String, by: f64) {
    let number = px(by)
        .to_string()
        .replacen("0.", ".", usize::from(by.abs() < 1.0));
    if !d.ends_with('l') && !number.starts_with('-') {
        d.push(' ');
    }
    d.push_str(&number);
}

/// Points as lines without length, whose round ends are drawn.
fn dots(x: &[f64], y: &[f64], window: &Window) -> String {
    let points = x.iter().zip(y);
    let pixels = points.filter_map(|(x, y)| Some((window.x.pixel(*x)?, window.y.pixel(*y)?)));
    let mut pixels: Vec<(f64, f64)> = pixels.collect();
    pixels.dedup();
    pixels
        .into_iter()
        .map(|(left, top)| format!("M{left} {top}h.01"))
        .collect()
}

/// The ground between two curves, a piece for each run without gaps.
fn band(x: &[f64], bounds: [&[f64]; 2], window: &Window) -> String {
    let mut d = String::new();
    let (mut upper, mut lower) = (Vec::new(), Vec::new());
    let mut flush = |upper: &mut Vec<String>, lower: &mut Vec<String>| {
        if upper.len() > 1 {
            lower.reverse();
            d += &format!("M{}L{}Z", upper.join("L"), lower.join("L"));
        }
        upper.clear();
        lower.clear();
    };
    for ((&x, &low), &high) in x.iter().zip(bounds[0]).zip(bounds[1]) {
        let place = || {
            Some((
                window.x.pixel(x)?,
                window.y.pixel(low)?,
                window.y.pixel(high)?,
            ))
        };
        match place() {
            Some((left, bottom, top)) => {
                upper.push(format!("{left} {top}"));
                lower.push(format!("{left} {bottom}"));
            }
            None => flush(&mut upper, &mut lower),
        }
    }
    flush(&mut upper, &mut lower);
    d
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::panel::PlotAxis;

    fn window() -> Window {
        let axis = || PlotAxis::new("").within(0.0..10.0);
        Panel::new("", axis(), axis()).window(100.0, 100.0)
    }

    #[test]
    fn lines_break_where_a_value_is_missing() {
        let x = [0.0, 4.0, 6.0, 7.0, 8.0, 9.0];
        let y = [0.0, 5.0, 0.0, f64::NAN, 5.0, 5.0];
        assert_eq!(line(&x, &y, &window()), "M0 100l40-50 20 50M80 50l10 0");
        let both = band(&x, [&y, &y.map(|y| y + 1.0)], &window());
        assert_eq!(both.matches('M').count(), 2);
        assert_eq!(dots(&x, &y, &window()).matches('M').count(), 5);
    }

    #[test]
    fn a_dense_line_keeps_its_extremes_and_few_points() {
        let x: Vec<f64> = (0..100_000).map(|i| f64::from(i) * 1e-4).collect();
        let mut y: Vec<f64> = x.iter().map(|x| 5.0 + (1e3 * x).sin()).collect();
        y[31_415] = 9.5;
        let d = line(&x, &y, &window());
        assert!(d.contains(".9-35"), "the extreme is missing");
        assert!(d.len() < 40_000, "{}", d.len());
    }
    fn window_of(panel: &Panel) -> Window {
        panel.window(100.0, 100.0)
    }

    fn panel_with(series: Series) -> Panel {
        let axis = || PlotAxis::new("").within(0.0..10.0);
        let mut panel = Panel::new("", axis(), axis());
        panel.add(series);
        panel
    }

    #[test]
    fn a_bar_goes_from_zero_to_its_value_about_its_x() {
        let panel = panel_with(Series::bars("", 7, vec![(2.0, 4.0), (7.0, 1.0)]));
        let drawn = paths(&panel, 0, &window_of(&panel));
        // Of a distance of 5 a bar has 0.8, less four hundredths at each side: 1.84 each way.
        assert!(
            drawn.contains("d=\"M1.6 100H38.4V60H1.6ZM51.6 100H88.4V90H51.6Z\""),
            "{drawn}"
        );
        assert!(drawn.contains("fill=\"#0072b2\" opacity=\"1\""), "{drawn}");
    }

    #[test]
    fn a_box_has_its_quartiles_whiskers_and_median() {
        let panel = panel_with(Series::boxes("", 7, vec![(5.0, [1.0, 2.0, 4.0, 6.0, 9.0])]));
        let drawn = paths(&panel, 0, &window_of(&panel));
        // 0.368 each way of 5.
        let area = "M46.3 40H53.7V80H46.3Z";
        assert!(
            drawn.contains(&format!(
                "<path d=\"{area}\" fill=\"#0072b2\" opacity=\"0.2\"/>"
            )),
            "{drawn}"
        );
        assert!(
            drawn.contains(&format!(
                "d=\"{area}M50 80V90M50 40V10\" fill=\"none\" stroke=\"#0072b2\" stroke-width=\"1\""
            )),
            "{drawn}"
        );
        assert!(
            drawn.contains(
                "d=\"M46.3 60H53.7\" fill=\"none\" stroke=\"#0072b2\" stroke-width=\"2.8\""
            ),
            "{drawn}"
        );
    }

    #[test]
    fn a_band_is_closed_along_its_lower_curve() {
        let x = [0.0, 5.0, 10.0];
        let drawn = band(&x, [&[1.0, 2.0, 3.0], &[4.0, 5.0, 6.0]], &window());
        assert_eq!(drawn, "M0 60L50 50L100 40L100 70L50 80L0 90Z");
        // A single point is no band.
        assert_eq!(band(&x[..1], [&[1.0], &[2.0]], &window()), "");
    }

    #[test]
    fn lines_have_their_width_and_pattern() {
        let line = || vec![(0.0, 0.0), (10.0, 10.0)];
        let drawn = |series: Series| {
            let panel = panel_with(series);
            paths(&panel, 0, &window_of(&panel))
        };
        for (series, width, pattern) in [
            (Series::thin("", 7, line()), "1", None),
            (Series::line("", 7, line()), "1.6", None),
            (Series::thick("", 7, line()), "2.8", None),
            (Series::dashed("", 7, line()), "1.6", Some("6,4")),
            (Series::line("", 7, line()).pattern(2), "1.6", Some("2,3")),
        ] {
            let text = drawn(series);
            assert!(
                text.starts_with("<path d=\"M0 100l100-100\" fill=\"none\" stroke=\"#0072b2\""),
                "{text}"
            );
            assert!(
                text.contains(&format!("stroke-width=\"{width}\"")),
                "{text}"
            );
            assert_eq!(
                text.split_once("dasharray=\"").map(|(_, rest)| &rest[..3]),
                pattern
            );
        }
        let dots = drawn(Series::dots("", 7, line()));
        assert!(
            dots.contains("M0 100h.01M100 0h.01")
                && dots.contains("stroke-width=\"5\"")
                && dots.contains("linecap=\"round\""),
            "{dots}"
        );
        let keys = [
            (Series::line("", 0, Vec::new()), "M0 6H18"),
            (Series::dots("", 0, Vec::new()), "M9 6h.01"),
            (Series::band("", 0, &[]), "M0 1H18V11H0Z"),
            (Series::boxes("", 0, Vec::new()), "M3 1H15V11H3Z"),
        ];
        for (series, path) in keys {
            assert!(key(&series).starts_with(&format!("<path d=\"{path}\"")));
        }
    }

    #[test]
    fn steps_of_a_path_have_no_needless_letters() {
        let of = |steps: &[f64]| {
            let mut d = "l".to_owned();
            for by in steps {
                step(&mut d, *by);
            }
            d
        };
        assert_eq!(of(&[0.5, 10.0, -0.5, 10.5, 0.04]), "l.5 10-.5 10.5 0");
    }
}
