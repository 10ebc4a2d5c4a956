//! Allan deviations as a plot of characters: logarithmic both ways, so that noise has its slopes.

use crate::{style, terminal};
use clap::builder::styling::AnsiColor;
use undrift::results::Identify;

/// Dots of a braille character, left and right column from top to bottom.
const BRAILLE: [[u32; 4]; 2] = [[0x01, 0x02, 0x04, 0x40], [0x08, 0x10, 0x20, 0x80]];
/// Dots of a character, across and down.
const DOTS: (usize, usize) = (2, 4);
/// Lines of the plot.
const HEIGHT: usize = 16;
/// Characters left of the axis.
const MARGIN: usize = 7;
/// Characters right of it, for half of the last label and the unit.
const OVERHANG: usize = 4;
/// Narrowest and widest plot [characters].
const WIDTHS: (usize, usize) = (40, 110);
/// Width where there is no terminal [characters].
const NO_TERMINAL: usize = 80;

/// A curve by the name of its axis.
type Curve<'a> = (&'a str, Vec<(f64, f64)>);

/// Size of the whole plot in characters, and how it is drawn.
#[derive(Clone, Copy)]
pub struct Look {
    width: usize,
    /// Braille dots in colours rather than letters.
    colours: bool,
    /// Lines and signs beyond ASCII.
    unicode: bool,
}

/// The Allan deviations of all axes, gyros in deg/h and accelerometers in mg.
pub fn allan(identified: &Identify) -> String {
    let unicode = is_utf8();
    let look = Look {
        width: width(),
        colours: terminal::has_colours() && unicode,
        unicode,
    };
    let kinds = [
        ("gyro", "deg/h", 3600f64.to_degrees()),
        ("accel", "mg", 1e3 / undrift::nav::earth::STANDARD_GRAVITY),
    ];
    let plots = kinds.into_iter().filter_map(|(kind, unit, factor)| {
        let found = identified.in_order();
        let found = found.filter(|(name, axis)| name.starts_with(kind) && axis.error.is_none());
        let curves = found.map(|(name, axis)| {
            let points = axis.allan.tau_s.iter().zip(&axis.allan.adev);
            (name, points.map(|(t, d)| (t.0, d.0 * factor)).collect())
        });
        let plot = draw(&curves.collect::<Vec<_>>(), unit, look)?;
        let title = format!("Allan deviation [{unit}] over averaging time [s]");
        Some(format!("{}\n{plot}", style::heading(&title)))
    });
    Vec::from_iter(plots).join("\n").trim_end().to_owned()
}

/// Short name of an axis: the last letter of its name.
fn letter(name: &str) -> char {
    name.chars().last().unwrap_or('*')
}

/// A text in the colour of an axis.
fn coloured(name: &str, text: &str) -> String {
    let colour = match letter(name) {
        'x' => AnsiColor::Red,
        'y' => AnsiColor::Green,
        _ => AnsiColor::Blue,
    };
    style::coloured(colour, text)
}

fn width() -> usize {
    let columns = std::env::var("COLUMNS").ok().and_then(|c| c.parse().ok());
    let terminal = console::Term::stdout().size_checked();
    terminal
        .map(|(_, columns)| usize::from(columns))
        .or(columns)
        .unwrap_or(NO_TERMINAL)
        .clamp(WIDTHS.0, WIDTHS.1)
}

/// Whether the locale's characters are Unicode's: the first that is set of what POSIX looks at.
fn is_utf8() -> bool {
    let locale = ["LC_ALL", "LC_CTYPE", "LANG"]
        .into_iter()
        .find_map(|name| std::env::var(name).ok().filter(|value| !value.is_empty()));
    let locale = locale.unwrap_or_default().to_ascii_lowercase();
    cfg!(windows) || locale.contains("utf-8") || locale.contains("utf8")
}

/// Whole decades around values: exponents of ten.
fn decades(values: impl Iterator<Item = f64>) -> Option<(i32, i32)> {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
        (low.min(v), high.max(v))
    });
    let (low, high) = (low.log10().floor(), high.log10().ceil());
    // Powers of ten that floats have.
    let known = (-300.0..=300.0).contains(&low) && (-300.0..=300.0).contains(&high);
    known.then(|| (low as i32, (high as i32).max(low as i32 + 1)))
}

/// The plot; `None` without a point.
fn draw(curves: &[Curve], unit: &str, look: Look) -> Option<String> {
    let usable = |&&(x, y): &&(f64, f64)| x > 0.0 && y > 0.0 && (x * y).is_finite();
    let points = || curves.iter().flat_map(|c| c.1.iter().filter(usable));
    let x_range = decades(points().map(|p| p.0))?;
    let y_range = decades(points().map(|p| p.1))?;
    let columns = look.width.saturating_sub(MARGIN + 1 + OVERHANG).max(10);
    let mut canvas = Canvas::new(columns);
    // Dots from the left and from the top.
    let place = |value: f64, (low, high): (i32, i32), dots: usize| {
        (value.log10() - f64::from(low)) / f64::from(high - low) * (dots - 1) as f64
    };
    let (across, down) = (columns * DOTS.0, HEIGHT * DOTS.1);
    for (index, (_, points)) in curves.iter().enumerate() {
        let dots = points.iter().filter(usable).map(|&(x, y)| {
            let y = place(y, y_range, down);
            (place(x, x_range, across), (down - 1) as f64 - y)
        });
        canvas.line(&dots.collect::<Vec<_>>(), index);
    }
    let (bar, tick, corner, dash, cross) = match look.unicode {
        true => ('│', '┤', '└', '─', '┴'),
        false => ('|', '+', '+', '-', '+'),
    };
    let mut signs = vec![(String::new(), bar); HEIGHT];
    for exponent in every(y_range, HEIGHT / 2) {
        let y = place(10f64.powi(exponent), y_range, down);
        signs[HEIGHT - 1 - (y / DOTS.1 as f64) as usize] = (power(exponent), tick);
    }
    let mut text = String::new();
    for (line, (label, sign)) in signs.iter().enumerate() {
        let cells = canvas.line_text(line, curves, look.colours);
        text += format!("{label:>MARGIN$}{sign}{cells}").trim_end();
        text.push('\n');
    }
    let mut axis = vec![dash; columns];
    let mut below = vec![' '; MARGIN + 1 + columns + OVERHANG];
    for exponent in every(x_range, columns / 8) {
        let x = place(10f64.powi(exponent), x_range, across);
        let column = (x / DOTS.0 as f64) as usize;
        axis[column] = cross;
        let label = power(exponent);
        let start = (MARGIN + 1 + column).saturating_sub(label.len() / 2);
        for (cell, sign) in below.iter_mut().skip(start).zip(label.chars()) {
            *cell = sign;
        }
    }
    let (axis, below) = (String::from_iter(axis), String::from_iter(below));
    let legend = curves.iter().map(|(name, _)| match look.colours {
        true => coloured(name, name),
        false => format!("{} {name}", letter(name)),
    });
    text += &format!("{unit:>MARGIN$}{corner}{axis}\n{} s\n", below.trim_end());
    text += &format!("{:MARGIN$} {}\n", "", Vec::from_iter(legend).join("   "));
    Some(text)
}

/// The decades of a range, or every second, third, … so that at most `most` are left.
fn every((low, high): (i32, i32), most: usize) -> impl Iterator<Item = i32> {
    let step = ((high - low) as usize).div_ceil(most.max(1)).max(1);
    (low..=high).step_by(step)
}

/// A power of ten as a label.
fn power(exponent: i32) -> String {
    match exponent {
        -2..=4 => format!("{}", 10f64.powi(exponent)),
        _ => format!("1e{exponent}"),
    }
}

/// Dots, and whose they are.
struct Canvas {
    columns: usize,
    /// Line by line: the dots set, and the curve that set the last of them.
    cells: Vec<(u32, usize)>,
}

impl Canvas {
    fn new(columns: usize) -> Self {
        Self {
            columns,
            cells: vec![(0, 0); columns * HEIGHT],
        }
    }

    /// Straight lines from dot to dot.
    fn line(&mut self, dots: &[(f64, f64)], curve: usize) {
        for pair in dots.windows(2) {
            let [(x0, y0), (x1, y1)] = [pair[0], pair[1]];
            let steps = (x1 - x0).abs().max((y1 - y0).abs()).ceil().max(1.0);
            for step in 0..=steps as usize {
                let share = step as f64 / steps;
                self.set(x0 + share * (x1 - x0), y0 + share * (y1 - y0), curve);
            }
        }
        if let [(x, y)] = dots {
            self.set(*x, *y, curve);
        }
    }

    fn set(&mut self, x: f64, y: f64, curve: usize) {
        let (x, y) = (x.round() as usize, y.round() as usize);
        let (column, line) = (x / DOTS.0, y / DOTS.1);
        if column < self.columns
            && let Some(cell) = self.cells.get_mut(line * self.columns + column)
        {
            *cell = (cell.0 | BRAILLE[x % DOTS.0][y % DOTS.1], curve);
        }
    }

    fn line_text(&self, line: usize, curves: &[Curve], colours: bool) -> String {
        let cells = self.cells.iter().skip(line * self.columns);
        let cells = cells.take(self.columns).map(|(dots, curve)| {
            let sign = char::from_u32(0x2800 + dots).unwrap_or('*');
            match curves.get(*curve).filter(|_| *dots > 0) {
                None => " ".into(),
                Some((name, _)) if colours => coloured(name, &sign.to_string()),
                Some((name, _)) => letter(name).to_string(),
            }
        });
        cells.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// White noise: the deviation falls with the root of the averaging time.
    fn white() -> Vec<(f64, f64)> {
        (0..=16)
            .map(|k| 0.01 * f64::powi(2.0, k))
            .map(|tau| (tau, 30.0 / tau.sqrt()))
            .collect()
    }

    const LOOK: Look = Look {
        width: 88,
        colours: true,
        unicode: true,
    };

    fn plain(look: Look, points: Vec<(f64, f64)>) -> Vec<String> {
        let drawn = draw(&[("gyro_x", points)], "deg/h", look).unwrap();
        let plain = anstream::adapter::strip_str(&drawn).to_string();
        plain.lines().map(str::to_owned).collect()
    }

    /// Dots of braille cells, from the left and from the top.
    fn dots(lines: &[String]) -> Vec<(usize, usize)> {
        let mut dots = Vec::new();
        for (line, text) in lines.iter().take(HEIGHT).enumerate() {
            for (column, sign) in text.chars().skip(MARGIN + 1).enumerate() {
                let bits = (sign as u32).wrapping_sub(0x2800);
                for (x, bits_of) in BRAILLE.iter().enumerate() {
                    for (y, bit) in bits_of.iter().enumerate() {
                        if bits < 256 && bits & bit != 0 {
                            dots.push((column * DOTS.0 + x, line * DOTS.1 + y));
                        }
                    }
                }
            }
        }
        dots.sort();
        dots
    }

    #[test]
    fn white_noise_falls_by_half_a_decade_a_decade() {
        let lines = plain(LOOK, white());
        let dots = dots(&lines);
        let (first, last) = (dots[0], dots[dots.len() - 1]);
        // 0.01 s to 655 s lie in five decades, 1.17 to 300 deg/h in three.
        let across = (last.0 - first.0) as f64 * 5.0 / (2.0 * 76.0 - 1.0);
        let down = (last.1 as f64 - first.1 as f64) * 3.0 / (4.0 * 16.0 - 1.0);
        // A dot is 0.031 decades wide and 0.048 high, at both ends of 4.8 decades: 1 %.
        assert!(
            (down / across - 0.5).abs() < 0.015,
            "{down} {across}\n{}",
            lines.join("\n")
        );
        // Without holes: a dot in every column between.
        let columns: std::collections::BTreeSet<usize> = dots.iter().map(|d| d.0).collect();
        assert_eq!(columns.len(), last.0 - first.0 + 1);
    }

    #[test]
    fn axes_have_decades_and_units() {
        let lines = plain(LOOK, white());
        let labels: Vec<&str> = lines[..HEIGHT]
            .iter()
            .filter_map(|line| line.split_once('┤').map(|(label, _)| label.trim()))
            .collect();
        assert_eq!(labels, ["1000", "100", "10", "1"]);
        assert_eq!(lines[HEIGHT].chars().filter(|c| *c == '┴').count(), 6);
        assert!(lines[HEIGHT].starts_with("  deg/h└"), "{}", lines[HEIGHT]);
        let below: Vec<&str> = lines[HEIGHT + 1].split_whitespace().collect();
        assert_eq!(below, ["0.01", "0.1", "1", "10", "100", "1000", "s"]);
        assert_eq!(lines[HEIGHT + 2].trim(), "gyro_x");
        for line in &lines {
            assert!(line.chars().count() <= LOOK.width, "{line}");
        }
    }

    #[test]
    fn without_colours_and_unicode_there_are_letters() {
        let look = Look {
            colours: false,
            unicode: false,
            width: 40,
        };
        let points = white();
        let above = points.iter().map(|(x, y)| (*x, 10.0 * y)).collect();
        let curves = [("accel_y", points), ("accel_z", above)];
        let text = draw(&curves, "mg", look).unwrap();
        assert!(text.is_ascii(), "{text}");
        let first = |letter| text.lines().position(|line| line.contains(letter)).unwrap();
        assert!(first('z') < first('y'), "{text}");
        assert!(text.contains("y accel_y   z accel_z"), "{text}");
        assert!(text.lines().all(|line| line.len() <= 40), "{text}");
    }

    #[test]
    fn what_cannot_be_drawn_is_left_out() {
        assert!(draw(&[], "mg", LOOK).is_none());
        let nothing = vec![
            (1.0, 0.0),
            (f64::NAN, 1.0),
            (1.0, f64::INFINITY),
            (-1.0, 1.0),
        ];
        assert!(draw(&[("gyro_x", nothing)], "mg", LOOK).is_none());
        assert_eq!(
            dots(&plain(LOOK, vec![(1.0, 1.0), (2.0, f64::NAN)])).len(),
            1
        );
    }
}
