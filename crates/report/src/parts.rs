//! What the reports share: numbers as text, curves as points, tables row by row.

use super::{Axis, Block, Cell, Figure, Panel, Series, Table};
use undrift::nav::earth::Geodetic;
use undrift::noise::order_statistics::quantile;
use undrift::results::{Curve, Number, Numbers, Track};

/// A number with three significant digits; a dash where there is none.
pub fn short(value: f64) -> String {
    match value.abs() {
        v if !v.is_finite() => "–".into(),
        0.0 => "0".into(),
        v if v < 9.995e-4 => format!("{value:.2e}"),
        v if v < 9.995e-3 => format!("{value:.5}"),
        v if v < 0.099_95 => format!("{value:.4}"),
        v if v < 0.9995 => format!("{value:.3}"),
        v if v < 9.995 => format!("{value:.2}"),
        v if v < 99.95 => format!("{value:.1}"),
        v if v < 9999.5 => format!("{value:.0}"),
        v if v < 999_500.0 => {
            let step = if v < 99_950.0 { 100.0 } else { 1000.0 };
            let sign = if value < 0.0 { "-" } else { "" };
            format!("{sign}{}", count(((v / step).round() * step) as u64))
        }
        _ => format!("{value:.2e}"),
    }
}

/// A number with seven significant digits, as it is where those are not enough to write it plain.
pub fn exact(value: f64) -> String {
    if !value.is_finite() {
        return "–".into();
    }
    let size = value.abs().log10().floor();
    if (-4.0..6.0).contains(&size) {
        format!("{value:.*}", (6.0 - size) as usize)
    } else {
        format!("{value:.6e}")
    }
}

/// A share in percent.
pub fn percent(share: f64) -> String {
    if share.is_finite() {
        format!("{:.1} %", 100.0 * share)
    } else {
        "–".into()
    }
}

/// A span of time \[s\] in the unit that suits it.
pub fn span(seconds: f64) -> String {
    match seconds {
        s if !s.is_finite() => "–".into(),
        s if s < 600.0 => format!("{s:.0} s"),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

/// A count with its thousands apart.
pub fn count(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

/// A number of a map; NaN where it has none.
pub fn get(numbers: &Numbers, name: &str) -> f64 {
    numbers.get(name).map_or(f64::NAN, |n| n.0)
}

/// Sentences one after the other.
pub fn text(sentences: &[String]) -> Option<Block> {
    let told: Vec<&str> = sentences
        .iter()
        .map(String::as_str)
        .filter(|s| !s.is_empty())
        .collect();
    (!told.is_empty()).then(|| Block::Text(told.join(" ")))
}

/// Warnings as one block to be seen, the first letter of each large.
pub fn warnings<'a>(warnings: impl IntoIterator<Item = &'a String>) -> Option<Block> {
    let sentence = |warning: &String| {
        let mut letters = warning.chars();
        let first: String = letters
            .next()
            .into_iter()
            .flat_map(char::to_uppercase)
            .collect();
        let text = first + letters.as_str();
        if text.ends_with(['.', '!', '?']) {
            text
        } else {
            text + "."
        }
    };
    let mut told: Vec<String> = warnings.into_iter().map(sentence).collect();
    match told.len() {
        0 => None,
        1 => told.pop().map(Block::Warning),
        _ => Some(Block::Warnings(told)),
    }
}

/// A table without rows.
pub fn table(name: &str, caption: &str, head: &[&str]) -> Table {
    Table {
        name: name.into(),
        caption: caption.into(),
        head: head.iter().map(|h| (*h).to_owned()).collect(),
        rows: Vec::new(),
    }
}

/// Numbers of three digits as cells; with `best`, the smallest stands out.
pub fn cell(value: f64) -> Cell {
    short(value).into()
}

/// A standard error, with two significant digits.
pub fn error(value: f64) -> String {
    match value.abs() {
        v if !v.is_finite() => "–".into(),
        0.0 => "0".into(),
        v if v < 9.95e-5 => format!("{value:.1e}"),
        v if v < 9.95 => {
            let digits = (1.0 - v.log10().floor()).clamp(0.0, 6.0) as usize;
            format!("{value:.digits$}")
        }
        _ => short(value),
    }
}

/// A probability; very small ones as such.
pub fn probability(p: f64) -> String {
    if p < 1e-4 {
        "< 0.0001".into()
    } else {
        short(p)
    }
}

/// Where a result has a name: the name before a sentence, which goes on with a small letter.
pub fn named(name: &str, sentence: &str) -> String {
    if name.is_empty() {
        return sentence.to_owned();
    }
    let rest = ["The ", "It ", "On "]
        .into_iter()
        .find_map(|start| Some((start, sentence.strip_prefix(start)?)));
    match rest {
        Some((start, rest)) => format!("{name}: {}{rest}", start.to_lowercase()),
        None => format!("{name}: {sentence}"),
    }
}

/// A line broken inside spans of time, where it has nothing to say.
pub fn broken(points: Vec<(f64, f64)>, spans: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut out: Vec<(f64, f64)> = Vec::with_capacity(points.len());
    for point in points {
        if let Some(before) = out.last().map(|p| p.0) {
            let middle = f64::midpoint(before, point.0);
            if spans.iter().any(|s| s.0 < middle && middle < s.1) {
                out.push((middle, f64::NAN));
            }
        }
        out.push(point);
    }
    out
}

/// The colour of a bias model, the same in all figures; of others one by their place.
pub fn model_colour(name: &str, place: usize) -> usize {
    match name {
        "white" => 1,
        "paper" => 6,
        "gauss-markov" => 4,
        "random-walk" => 5,
        "ar" => 3,
        "arma" => 7,
        _ => [0, 2][place % 2],
    }
}

/// Makes the smallest number of a column stand out, and those that read the same, where others differ.
pub fn mark_least(table: &mut Table, column: usize, values: &[f64]) {
    let finite = || values.iter().copied().filter(|v| v.is_finite());
    let (least, most) = (
        finite().fold(f64::INFINITY, f64::min),
        finite().fold(f64::NEG_INFINITY, f64::max),
    );
    let least = short(least);
    if short(most) == least {
        return;
    }
    let best = values.iter().map(|v| v.is_finite() && short(*v) == least);
    for (row, _) in table.rows.iter_mut().zip(best).filter(|(_, best)| *best) {
        if let Some(cell) = row.get_mut(column) {
            *cell = cell.clone().strong();
        }
    }
}

/// The time that plots count from \[s\]: 0, or the whole second before the start where a log's own
/// times are large.
#[derive(Clone, Copy, Debug)]
pub struct Clock(f64);

impl Clock {
    /// For a log that starts at a time \[s\].
    pub fn starting(start: f64) -> Self {
        Self(if start.is_finite() && start.abs() >= 1000.0 {
            start.floor()
        } else {
            0.0
        })
    }

    /// What the axis says.
    pub fn label(self) -> String {
        if self.0 == 0.0 {
            "time [s]".into()
        } else {
            format!("time since {:.0} s [s]", self.0)
        }
    }

    /// A time on the axis.
    pub fn at(self, time: f64) -> f64 {
        time - self.0
    }

    /// A curve times a factor.
    pub fn points(self, curve: &Curve, factor: f64) -> Vec<(f64, f64)> {
        let points = curve.time_s.iter().zip(&curve.value);
        points.map(|(t, v)| (self.at(t.0), factor * v.0)).collect()
    }
}

/// Values against 0, 1, 2 …, or others; as points.
pub fn zip(x: &[Number], y: &[Number]) -> Vec<(f64, f64)> {
    x.iter().zip(y).map(|(x, y)| (x.0, y.0)).collect()
}

/// A line broken where an angle goes through ±180°.
pub fn unwrapped(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    let mut broken: Vec<(f64, f64)> = Vec::with_capacity(points.len());
    for point in points {
        if let Some(last) = broken.last().copied()
            && (point.1 - last.1).abs() > 180.0
        {
            broken.push((0.5 * (last.0 + point.0), f64::NAN));
        }
        broken.push(point);
    }
    broken
}

/// A way in metres east and north of an origin, with its times \[s\].
pub fn on_the_ground(track: &Track, origin: Option<&Geodetic>) -> Vec<(f64, (f64, f64))> {
    let places = track.time_s.iter().zip(&track.lat_deg).zip(&track.lon_deg);
    let Some(origin) = origin else {
        return Vec::new();
    };
    places
        .map(|((time, lat), lon)| {
            let ned = origin.ned_to(&Geodetic::from_degrees(lat.0, lon.0, origin.height));
            (time.0, (ned.y, ned.x))
        })
        .filter(|(_, (east, north))| east.is_finite() && north.is_finite())
        .collect()
}

/// Where a way begins.
pub fn origin(track: &Track) -> Option<Geodetic> {
    let place = track.lat_deg.first().zip(track.lon_deg.first());
    place.map(|(lat, lon)| Geodetic::from_degrees(lat.0, lon.0, 0.0))
}

/// An axis for values, logarithmic where the values reach over more than a decade and a half.
pub fn axis_for(values: &[f64], label: &str) -> Axis {
    let (least, most) = (quantile(values, 0.0), quantile(values, 1.0));
    if least > 0.0 && most / least > 30.0 {
        Axis::logarithmic(label)
    } else {
        Axis::new(label)
    }
}

/// A horizontal line from the first to the last x of points.
pub fn level(name: &str, colour: usize, x: (f64, f64), y: f64) -> Series {
    Series::dashed(name, colour, vec![(x.0, y), (x.1, y)])
}

/// First and last x.
pub fn extent(points: &[(f64, f64)]) -> (f64, f64) {
    let ends = points.first().zip(points.last());
    ends.map_or((0.0, 1.0), |(a, b)| (a.0, b.0))
}

/// A figure of the panels that there are.
pub fn figure(name: &str, caption: &str, columns: usize, panels: Vec<Panel>) -> Option<Block> {
    (!panels.is_empty()).then(|| {
        Block::Figure(Figure {
            name: name.into(),
            caption: caption.into(),
            columns,
            panels,
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_as_text() {
        for (value, text) in [
            (0.0, "0"),
            (0.000_123_4, "1.23e-4"),
            (-0.123_4, "-0.123"),
            (0.012_34, "0.0123"),
            (0.001_234, "0.00123"),
            (1.234, "1.23"),
            (99.99, "100"),
            (12_345.6, "12\u{202f}300"),
            (-232_966.0, "-233\u{202f}000"),
            (9_999.0, "9999"),
            (f64::NAN, "–"),
        ] {
            assert_eq!(short(value), text);
        }
        for (value, text) in [
            (3.432_190_9, "3.432191"),
            (0.0, "0.000000e0"),
            (1e-7, "1.000000e-7"),
        ] {
            assert_eq!(exact(value), text);
        }
        assert_eq!(count(1_234_567), "1\u{202f}234\u{202f}567");
        assert_eq!(count(123), "123");
        assert_eq!(span(3600.0), "60 min");
    }

    #[test]
    fn errors_have_two_digits() {
        for (value, text) in [
            (0.001_04, "0.0010"),
            (0.0944, "0.094"),
            (0.105, "0.10"),
            (4.16e-4, "0.00042"),
            (1.5, "1.5"),
            (198.3, "198"),
            (1e-7, "1.0e-7"),
        ] {
            assert_eq!(error(value), text);
        }
        assert_eq!(probability(7e-297), "< 0.0001");
        assert_eq!(probability(0.91), "0.910");
    }

    #[test]
    fn those_that_read_the_same_stand_out_together() {
        let mut t = table("", "", &["a"]);
        let values = [3.831, 3.834, 6.0];
        t.rows = values.iter().map(|v| vec![cell(*v)]).collect();
        mark_least(&mut t, 0, &values);
        let strong: Vec<bool> = t.rows.iter().map(|r| r[0].strong).collect();
        assert_eq!(strong, [true, true, false]);
    }

    #[test]
    fn lines_break_in_spans() {
        let points = broken(vec![(0.0, 1.0), (1.0, 1.0), (5.0, 2.0)], &[(1.0, 5.0)]);
        assert_eq!(points.len(), 4);
        assert!(points[2].1.is_nan());
    }

    #[test]
    fn angles_break_at_the_turn() {
        let points = unwrapped(vec![(0.0, 170.0), (1.0, -170.0), (2.0, -160.0)]);
        assert_eq!(points.len(), 4);
        assert!(points[1].1.is_nan());
    }
}
