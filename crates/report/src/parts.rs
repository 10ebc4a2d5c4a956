//! What the reports share: sentences, curves as points, colours.

use crate::{Block, PlotAxis, Series, say};
use undrift_base::order_statistics::quantile;
use undrift_nav::earth::Geodetic;
use undrift_results::findings::{self, Finding};
use undrift_results::{Curve, Number, Track};

/// A result with its name; the name of a single one is empty.
pub type Run<'a, T> = (String, &'a T);

/// Components of errors with the heads of their columns, as [`undrift_results::COMPONENTS`].
pub const COMPONENTS: [(&str, &str); 10] = [
    ("north_m", "N [m]"),
    ("east_m", "E [m]"),
    ("down_m", "D [m]"),
    ("horizontal_m", "horizontal [m]"),
    ("vn_mps", "vN [m/s]"),
    ("ve_mps", "vE [m/s]"),
    ("vd_mps", "vD [m/s]"),
    ("roll_deg", "roll [°]"),
    ("pitch_deg", "pitch [°]"),
    ("yaw_deg", "yaw [°]"),
];

/// Sentences one after the other.
pub fn text(sentences: impl IntoIterator<Item = String>) -> Option<Block> {
    let sentences = sentences.into_iter().filter(|s| !s.is_empty());
    let sentences: Vec<String> = sentences.collect();
    (!sentences.is_empty()).then(|| Block::Text(sentences.join(" ")))
}

/// A text whose first letter is large.
pub fn capital(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().into_iter().flat_map(char::to_uppercase);
    first.chain(letters).collect()
}

/// Warnings as one block to be seen, the first letter of each large.
pub fn warnings<'a>(warnings: impl IntoIterator<Item = &'a String>) -> Option<Block> {
    let sentence = |warning: &String| {
        let stop = if warning.ends_with(['.', '!', '?']) {
            ""
        } else {
            "."
        };
        capital(warning) + stop
    };
    let mut sentences: Vec<String> = warnings.into_iter().map(sentence).collect();
    match sentences.len() {
        0 => None,
        1 => sentences.pop().map(Block::Warning),
        _ => Some(Block::Warnings(sentences)),
    }
}

/// Whether a result can be used, and why, by what was found out about it.
pub fn verdict_of(name: &str, findings: &[Finding]) -> Block {
    let (severity, cause) = findings::verdict(findings);
    let verdict = match cause {
        None => "usable: no fault found in the logs or the solution".into(),
        Some(_) => say::verdict(findings),
    };
    Block::Verdict(severity.into(), prefixed(name, &(capital(&verdict) + ".")))
}

/// "a, b and c".
pub fn spoken_list(names: &[String]) -> String {
    match names.split_last() {
        Some((last, before)) if !before.is_empty() => format!("{} and {last}", before.join(", ")),
        _ => names.concat(),
    }
}

/// A text after the name of the run that it is of, where the run has one.
pub fn prefixed(name: &str, text: &str) -> String {
    match name {
        "" => text.to_owned(),
        name => format!("{name}: {text}"),
    }
}

/// A warning, and in which run, where that has a name.
pub fn of_which(name: &str, warning: &str) -> String {
    match name {
        "" => warning.to_owned(),
        name => format!("in {name}: {warning}"),
    }
}

/// Where a result has a name: the name before a sentence, which goes on with a small letter.
pub fn named(name: &str, sentence: &str) -> String {
    let rest = ["The ", "It ", "On "]
        .into_iter()
        .find_map(|start| Some((start, sentence.strip_prefix(start)?)));
    match rest {
        Some((start, rest)) if !name.is_empty() => {
            format!("{name}: {}{rest}", start.to_lowercase())
        }
        _ => prefixed(name, sentence),
    }
}

/// The first few names of a list, and how many there are more.
pub fn first_few(names: &[String], most: usize) -> String {
    let shown = names.iter().take(most).map(String::as_str);
    let shown = Vec::from_iter(shown).join(", ");
    match names.len().saturating_sub(most) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}

/// A line broken between two points that are apart.
fn broken_where(
    points: Vec<(f64, f64)>,
    apart: impl Fn((f64, f64), (f64, f64)) -> bool,
) -> Vec<(f64, f64)> {
    let mut broken: Vec<(f64, f64)> = Vec::with_capacity(points.len());
    for point in points {
        if let Some(last) = broken.last().copied().filter(|last| apart(*last, point)) {
            broken.push((f64::midpoint(last.0, point.0), f64::NAN));
        }
        broken.push(point);
    }
    broken
}

/// A line broken inside spans of time, where it has nothing to say.
pub fn broken(points: Vec<(f64, f64)>, spans: &[(f64, f64)]) -> Vec<(f64, f64)> {
    broken_where(points, |last, point| {
        let middle = f64::midpoint(last.0, point.0);
        spans.iter().any(|s| s.0 < middle && middle < s.1)
    })
}

/// A line broken where an angle goes through ±180°.
pub fn unwrapped(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    broken_where(points, |last, point| (point.1 - last.1).abs() > 180.0)
}

/// The colour of a run of several.
pub fn run_colour(place: usize) -> usize {
    [7, 6, 4, 5, 2, 0][place % 6]
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
        _ => [0, 2, 4, 3, 5, 1, 7, 6][place % 8],
    }
}

/// The pattern of a bias model's lines, the same in all figures.
pub fn model_pattern(name: &str) -> usize {
    match name {
        "white" => 2,
        "paper" => 3,
        "gauss-markov" => 1,
        "random-walk" => 4,
        "ar" => 5,
        _ => 0,
    }
}

/// How much of the larger of two values they may differ by and still be drawn as one.
const ONE_LINE: f64 = 0.01;

/// Curves that lie on each other, by their places: each group is drawn as one.
pub fn coinciding(curves: &[&[(f64, f64)]]) -> Vec<Vec<usize>> {
    let same = |a: &[(f64, f64)], b: &[(f64, f64)]| {
        let near = |a: f64, b: f64| (a - b).abs() <= ONE_LINE * a.abs().max(b.abs());
        a.len() == b.len()
            && a.iter()
                .zip(b)
                .all(|(p, q)| (p.0 - q.0).abs() < 1e-9 && near(p.1, q.1))
    };
    grouped(curves.len(), |a, b| same(curves[a], curves[b]))
}

/// The first so many numbers, those together that are the same as the first of their group.
pub fn grouped(count: usize, same: impl Fn(usize, usize) -> bool) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for at in 0..count {
        match groups.iter_mut().find(|group| same(group[0], at)) {
            Some(group) => group.push(at),
            None => groups.push(vec![at]),
        }
    }
    groups
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

    /// Where the axis begins, in the log's own time \[s\].
    pub fn zero(self) -> f64 {
        self.0
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
        let points = points(&curve.time_s, &curve.value, factor).into_iter();
        points.map(|(t, v)| (self.at(t), v)).collect()
    }
}

/// Values times a factor against others, as points.
pub fn points(x: &[Number], y: &[Number], factor: f64) -> Vec<(f64, f64)> {
    x.iter().zip(y).map(|(x, y)| (x.0, factor * y.0)).collect()
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
    let (lat, lon) = track.lat_deg.first().zip(track.lon_deg.first())?;
    let known = lat.0.is_finite() && lon.0.is_finite();
    known.then(|| Geodetic::from_degrees(lat.0, lon.0, 0.0))
}

/// An axis for values, logarithmic where the values reach over more than a decade and a half.
pub fn axis_for(values: &[f64], label: &str) -> PlotAxis {
    let (least, most) = (quantile(values, 0.0), quantile(values, 1.0));
    if least > 0.0 && most / least > 30.0 {
        PlotAxis::logarithmic(label)
    } else {
        PlotAxis::new(label)
    }
}

/// The least, the quartiles and the largest of values.
pub fn quartiles(values: &[f64]) -> Option<[f64; 5]> {
    let quartiles = [0.0, 0.25, 0.5, 0.75, 1.0].map(|share| quantile(values, share));
    quartiles.iter().all(|q| q.is_finite()).then_some(quartiles)
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

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_results::Usability;

    #[test]
    fn points_are_values_times_a_factor_at_their_times() {
        let numbers = |values: [f64; 2]| values.map(Number);
        let (x, y) = (numbers([1001.5, 1002.5]), numbers([3.0, -4.0]));
        assert_eq!(points(&x, &y, 10.0), [(1001.5, 30.0), (1002.5, -40.0)]);
        let curve = Curve {
            time_s: x.to_vec(),
            value: y.to_vec(),
        };
        let clock = Clock::starting(1001.5);
        assert_eq!(clock.points(&curve, 2.0), [(0.5, 6.0), (1.5, -8.0)]);
        assert_eq!((clock.zero(), clock.at(1003.0)), (1001.0, 2.0));
        // Short times stay as they are.
        for start in [0.0, 999.0, f64::NAN] {
            assert_eq!(Clock::starting(start).zero(), 0.0);
        }
        assert_eq!(Clock::starting(-2000.5).zero(), -2001.0);
    }

    #[test]
    fn lines_break_in_spans() {
        let points = broken(vec![(0.0, 1.0), (1.0, 1.0), (5.0, 2.0)], &[(1.0, 5.0)]);
        assert_eq!(points.len(), 4);
        assert!(points[2].1.is_nan());
    }

    #[test]
    fn curves_that_lie_on_each_other_are_one() {
        let [a, b, c] = [1.0, 1.005, 1.02].map(|k| [(0.0, k), (1.0, 5.0 * k)]);
        assert_eq!(coinciding(&[&a, &c, &b]), [vec![0, 2], vec![1]]);
        assert_eq!(coinciding(&[&a, &a[..1]]).len(), 2);
    }

    #[test]
    fn angles_break_at_the_turn() {
        let points = unwrapped(vec![(0.0, 170.0), (1.0, -170.0), (2.0, -160.0)]);
        assert_eq!(points.len(), 4);
        assert!(points[1].1.is_nan());
    }
    #[test]
    fn lists_are_spoken_with_an_and_and_cut_short() {
        let names = |n: usize| -> Vec<String> {
            ["a", "b", "c"]
                .into_iter()
                .take(n)
                .map(String::from)
                .collect()
        };
        assert_eq!(
            [0, 1, 2, 3].map(|n| spoken_list(&names(n))),
            ["", "a", "a and b", "a, b and c"]
        );
        assert_eq!(
            [2, 3].map(|n| first_few(&names(n), 2)),
            ["a, b", "a, b and 1 more"]
        );
        assert_eq!(capital("übel"), "Übel");
        assert_eq!([prefixed("", "x"), prefixed("a", "x")], ["x", "a: x"]);
        assert_eq!([of_which("", "x"), of_which("a", "x")], ["x", "in a: x"]);
        assert_eq!(named("a", "On it"), "a: on it");
        assert_eq!(named("", "The end"), "The end");
        assert_eq!(named("a", "Then"), "a: Then");
    }

    #[test]
    fn warnings_are_sentences() {
        let of = |texts: &[&str]| {
            let texts: Vec<String> = texts.iter().map(|text| (*text).to_owned()).collect();
            warnings(&texts)
        };
        assert!(of(&[]).is_none());
        assert!(matches!(of(&["late"]), Some(Block::Warning(text)) if text == "Late."));
        let Some(Block::Warnings(texts)) = of(&["late!", "why?", "so."]) else {
            panic!("no list");
        };
        assert_eq!(texts, ["Late!", "Why?", "So."]);
        let joined = text(["One.".to_owned(), String::new(), "Two.".to_owned()]);
        assert!(matches!(joined, Some(Block::Text(text)) if text == "One. Two."));
        assert!(text([String::new()]).is_none());
    }

    #[test]
    fn a_verdict_without_a_cause_says_that_nothing_was_found() {
        let verdict = |findings: &[Finding]| match verdict_of("a", findings) {
            Block::Verdict(usability, text) => (usability, text),
            other => panic!("{other:?}"),
        };
        let none = "a: Usable: no fault found in the logs or the solution.";
        assert_eq!(verdict(&[]), (Usability::Usable, none.to_owned()));
        let ended = "a: Not usable: the solution diverged at 9 s and ends there.";
        assert_eq!(
            verdict(&[Finding::Diverged { time: 9.0 }]),
            (Usability::NotUsable, ended.to_owned())
        );
    }

    #[test]
    fn values_over_more_than_a_decade_and_a_half_are_on_a_logarithmic_axis() {
        let logarithmic = |values: &[f64]| axis_for(values, "y").logarithmic;
        assert!(logarithmic(&[1.0, 30.1]) && !logarithmic(&[1.0, 30.0]));
        assert!(!logarithmic(&[0.0, 100.0]) && !logarithmic(&[-1.0, 100.0]) && !logarithmic(&[]));
        assert_eq!(axis_for(&[1.0, 100.0], "y").label, "y");
        assert_eq!(
            quartiles(&[1.0, 2.0, 3.0, 4.0, 5.0]),
            Some([1.0, 2.0, 3.0, 4.0, 5.0])
        );
        assert_eq!(quartiles(&[]), None);
    }

    #[test]
    fn a_way_is_in_metres_from_where_it_begins() {
        let numbers =
            |values: &[f64]| -> Vec<Number> { values.iter().copied().map(Number).collect() };
        let track = Track {
            time_s: numbers(&[1.0, 2.0, 3.0]),
            lat_deg: numbers(&[45.0, 45.001, f64::NAN]),
            lon_deg: numbers(&[7.0, 7.001, 7.0]),
            ..Track::default()
        };
        let origin = origin(&track).unwrap();
        let way = on_the_ground(&track, Some(&origin));
        // A thousandth of a degree at 45° is 111.13 m to the north and 78.85 m to the east.
        assert_eq!(way.len(), 2);
        let (time, (east, north)) = way[1];
        assert!(
            (time, east.round(), north.round()) == (2.0, 79.0, 111.0),
            "{way:?}"
        );
        assert!(on_the_ground(&track, None).is_empty());
        for (lat, lon) in [(f64::NAN, 7.0), (45.0, f64::NAN)] {
            let track = Track {
                lat_deg: numbers(&[lat]),
                lon_deg: numbers(&[lon]),
                ..Track::default()
            };
            assert_eq!(super::origin(&track), None);
        }
    }

    #[test]
    fn a_clock_says_from_when_it_counts() {
        assert_eq!(Clock::starting(12.5).label(), "time [s]");
        assert_eq!(Clock::starting(1000.5).label(), "time since 1000 s [s]");
        assert_eq!(extent(&[(1.0, 5.0), (2.0, 6.0), (4.0, 7.0)]), (1.0, 4.0));
        assert_eq!(extent(&[]), (0.0, 1.0));
        let level = level("a", 2, (1.0, 4.0), 3.0);
        assert_eq!(Vec::from_iter(level.points()), [(1.0, 3.0), (4.0, 3.0)]);
    }

    #[test]
    fn a_line_is_broken_in_the_middle_of_a_span_alone() {
        let line = vec![(0.0, 1.0), (1.0, 2.0), (2.0, 3.0)];
        let gaps = broken(line.clone(), &[(1.2, 1.8)]);
        assert_eq!((gaps.len(), gaps[2].0, gaps[2].1.is_nan()), (4, 1.5, true));
        // Between the points, but not where its middle is.
        for span in [(1.5, 1.8), (1.2, 1.5), (5.0, 6.0)] {
            assert_eq!(broken(line.clone(), &[span]).len(), 3, "{span:?}");
        }
        let half = unwrapped(vec![(0.0, -90.0), (1.0, 90.0), (2.0, -90.1)]);
        assert_eq!(half.len(), 4);
    }
}
