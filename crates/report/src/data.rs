//! The numbers of figures as JSON, in few bytes.

use super::{Figure, Panel, PlotAxis, Series, figure::style, markup::file_stem};
use serde_json::{Value, json};
use std::{collections::HashMap, ops::Range};

/// The figures for the script: `style`, what it draws in the manner of; `x`, the lists of x that series refer to by their place, and
/// `figures`. It can stand in a script element.
pub(super) fn json(figures: &[&Figure]) -> String {
    let mut lists = Lists::default();
    let figures: Vec<Value> = figures
        .iter()
        .map(|figure| {
            let panels = figure.panels.iter().map(|p| panel(p, &mut lists));
            json!({
                "name": file_stem(&figure.name),
                "columns": figure.columns.max(1),
                "panels": panels.collect::<Vec<_>>(),
            })
        })
        .collect();
    // Only strings hold this character, and there it may be written so.
    let style: Value = serde_json::from_str(style::SOURCE).unwrap_or_default();
    json!({ "style": style, "x": lists.lists, "figures": figures })
        .to_string()
        .replace('<', "\\u003c")
}

fn panel(panel: &Panel, lists: &mut Lists) -> Value {
    let series = panel.series.iter().map(|s| self::series(s, lists));
    let (x, y) = panel.extents();
    let mut value = json!({
        "title": panel.title,
        "x": axis(&panel.x, x),
        "y": axis(&panel.y, y),
        "scale": panel.to_scale,
        "shades": panel.shades,
        "alarms": panel.alarms,
        "clock": panel.clock,
        "series": series.collect::<Vec<_>>(),
    });
    if let Some(origin) = panel.origin {
        // To a tenth of a millimetre.
        let degrees = |angle: f64| number(angle.to_degrees(), 9);
        value["origin"] = json!({ "lat_deg": degrees(origin.lat), "lon_deg": degrees(origin.lon) });
    }
    value
}

/// An axis: from where to where it goes at first, and whether it does so whatever is hidden.
fn axis(axis: &PlotAxis, seen: Range<f64>) -> Value {
    json!({
        "label": axis.label,
        "log": axis.logarithmic,
        "range": [seen.start, seen.end],
        "fixed": axis.range.is_some(),
        "names": axis.names,
    })
}

fn series(series: &Series, lists: &mut Lists) -> Value {
    let columns = series.y.iter().map(|column| {
        let values = column.iter().map(|v| number(*v, significant(*v)));
        values.collect::<Vec<_>>()
    });
    let mut value = json!({
        "name": series.name,
        "colour": series.colour,
        "style": series.drawn,
        "x": lists.place(&series.x),
        "y": columns.collect::<Vec<_>>(),
    });
    if series.dash > 0 {
        value["dash"] = series.dash.into();
    }
    if !series.times.is_empty() {
        value["t"] = lists.place(&series.times).into();
    }
    if !series.sigma.is_empty() {
        let along = |axis: usize| series.sigma.iter().map(move |s| number(s[axis], 3));
        value["sigma"] = [0, 1].map(|axis| Vec::from_iter(along(axis))).into();
    }
    value
}

/// Lists of x, each kept once.
#[derive(Default)]
struct Lists {
    lists: Vec<Value>,
    places: HashMap<Vec<u64>, usize>,
}

impl Lists {
    fn place(&mut self, x: &[f64]) -> usize {
        let bits: Vec<u64> = x.iter().map(|v| v.to_bits()).collect();
        *self.places.entry(bits).or_insert_with(|| {
            self.lists.push(list(x));
            self.lists.len() - 1
        })
    }
}

/// Values as a list, or as start, step and count where they are evenly spaced; to a ten millionth of
/// their span.
fn list(x: &[f64]) -> Value {
    let finite = || x.iter().copied().filter(|v| v.is_finite());
    let span = finite().fold(f64::NEG_INFINITY, f64::max) - finite().fold(f64::INFINITY, f64::min);
    if let (&[start, .., end], true) = (x, span > 0.0) {
        let step = (end - start) / (x.len() - 1) as f64;
        let even = |(i, v): (usize, &f64)| (start + i as f64 * step - v).abs() <= 1e-7 * span;
        if x.len() > 3 && x.iter().enumerate().all(even) {
            return json!({ "start": start, "step": step, "count": x.len() });
        }
    }
    let decimals = 7 - span.log10().ceil().clamp(-300.0, 300.0) as i32;
    // Small values of a logarithmic axis keep their digits too.
    let values = x.iter().map(|v| number(*v, decimals.max(significant(*v))));
    values.collect()
}

/// Decimals for seven significant digits.
fn significant(value: f64) -> i32 {
    if value == 0.0 || !value.is_finite() {
        return 0;
    }
    6 - value.abs().log10().floor() as i32
}

/// A number with so many decimals, fewer where the last are zeros; null if it is not finite.
fn number(value: f64, decimals: i32) -> Value {
    if !value.is_finite() {
        return Value::Null;
    }
    let rounded = match usize::try_from(decimals) {
        Ok(n) => format!("{value:.n$}").parse().unwrap_or(value),
        // More than seven digits before the point.
        Err(_) => format!("{value:.6e}").parse().unwrap_or(value),
    };
    if rounded.fract() == 0.0 && rounded.abs() < 1e15 {
        Value::from(rounded as i64)
    } else {
        Value::from(rounded)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_seven_digits() {
        for (value, text) in [
            (1.0 / 3.0, "0.3333333"),
            (-2.0e7 / 3.0, "-6666667"),
            (12.0, "12"),
            (2.0e-15 / 3.0, "6.666667e-16"),
            (2.0e30 / 3.0, "6.666667e+29"),
            (f64::NAN, "null"),
            (f64::NEG_INFINITY, "null"),
        ] {
            let kept = number(value, significant(value)).to_string();
            assert_eq!(kept, text);
        }
    }

    #[test]
    fn times_keep_their_resolution() {
        // A day of the week in GPS time, hundredths of seconds, one missing.
        let x = [345_600.01, 345_600.02, 345_600.04, 345_600.05];
        assert_eq!(
            list(&x).to_string(),
            "[345600.01,345600.02,345600.04,345600.05]"
        );
        let even: Vec<f64> = (0..1000).map(|i| 345_600.0 + 0.01 * f64::from(i)).collect();
        assert_eq!(list(&even)["count"], 1000);
        assert!((list(&even)["step"].as_f64().unwrap() - 0.01).abs() < 1e-9);
    }

    #[test]
    fn equal_lists_are_kept_once() {
        let mut panel = Panel::new("", PlotAxis::new(""), PlotAxis::new(""));
        let points: Vec<(f64, f64)> = vec![(0.0, f64::NAN), (1.0, 2.0), (5.0, 3.0)];
        panel.add(Series::line("</script>", 0, points.clone()));
        panel.add(Series::line("b", 1, points));
        let figure = Figure {
            name: "a/b".into(),
            caption: String::new(),
            columns: 0,
            panels: vec![panel],
        };
        let text = json(&[&figure]);
        assert!(!text.contains('<'));
        let value: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(value["x"], json!([[0, 1, 5]]));
        let series = &value["figures"][0]["panels"][0]["series"];
        assert_eq!(series[0]["y"], json!([[null, 2, 3]]));
        assert_eq!(
            (&series[0]["name"], &series[1]["x"]),
            (&json!("</script>"), &json!(0))
        );
    }
    #[test]
    fn values_in_a_tiny_span_are_distinguished() {
        let x = [1.0, 1.0 + 1e-12, 1.0 + 3e-12, 1.0 + 7e-12];
        let Value::Array(kept) = list(&x) else {
            panic!("no list");
        };
        for (kept, x) in kept.iter().zip(x) {
            assert!((kept.as_f64().unwrap() - x).abs() < 1e-15, "{kept} {x}");
        }
    }

    #[test]
    fn three_evenly_spaced_values_are_a_list_and_four_a_step() {
        assert_eq!(list(&[1.0, 2.0, 3.0]), json!([1, 2, 3]));
        let even = json!({ "start": 1.0, "step": 1.0, "count": 4 });
        assert_eq!(list(&[1.0, 2.0, 3.0, 4.0]), even);
        // A ten millionth of the span from where it should be.
        assert_eq!(list(&[1.0, 2.0 + 2e-7, 3.0, 4.0]), even);
        assert_eq!(
            list(&[1.0, 2.0 + 4e-6, 3.0, 4.0]),
            json!([1, 2.000004, 3, 4])
        );
        assert_eq!(list(&[5.0, 5.0, 5.0, 5.0]), json!([5, 5, 5, 5]));
        // Small values of a logarithmic axis beside large ones.
        assert_eq!(list(&[1.234567e-5, 1e5]), json!([1.234567e-5, 100000]));
        assert_eq!(list(&[123456.789, 0.0]), json!([123456.8, 0]));
    }

    #[test]
    fn a_series_has_what_it_is_drawn_with() {
        let mut lists = Lists::default();
        let plain = series(&Series::line("a", 3, vec![(0.0, 1.0)]), &mut lists);
        assert_eq!(
            plain,
            json!({ "name": "a", "colour": 3, "style": "line", "x": 0, "y": [[1]] })
        );
        let way = [(7.0, (0.0, 2.0)), (8.0, (1.0, 3.0))];
        let points = Series::points_within("b", 1, vec![[2.0, 0.12345], [3.0, 0.5]]);
        let points = points.on_map(&way).pattern(2);
        let value = series(&points, &mut lists);
        assert_eq!(value["dash"], 2);
        // East with the east's, north with the north's.
        assert_eq!(value["sigma"], json!([[2, 3], [0.123, 0.5]]));
        assert_eq!((&value["x"], &value["t"]), (&json!(1), &json!(2)));
        assert_eq!(lists.lists[2], json!([7, 8]));
        assert_eq!(value["y"], json!([[2, 3]]));
    }

    #[test]
    fn a_panel_has_its_axes_shades_and_clock() {
        let x = PlotAxis::categories(["a", "b"]);
        let mut panel = Panel::new("T", x, PlotAxis::logarithmic("y").within(1.0..10.0));
        panel.shade(1.0, 2.0);
        panel.alarm(1.5, 1.75);
        let value = super::panel(&panel.over_time(1000.0), &mut Lists::default());
        assert_eq!(
            value,
            json!({
                "title": "T",
                "x": { "label": "", "log": false, "range": [-0.6, 1.6], "fixed": true, "names": ["a", "b"] },
                "y": { "label": "y", "log": true, "range": [1.0, 10.0], "fixed": true, "names": [] },
                "scale": false,
                "shades": [[1.0, 2.0]],
                "alarms": [[1.5, 1.75]],
                "clock": 1000.0,
                "series": [],
            })
        );
        let free = Panel::new("", PlotAxis::new(""), PlotAxis::new("")).to_scale();
        let value = super::panel(&free, &mut Lists::default());
        assert_eq!(
            (&value["x"]["fixed"], &value["scale"]),
            (&json!(false), &json!(true))
        );
    }
}
