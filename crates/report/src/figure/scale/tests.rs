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
fn ticks_far_from_zero_are_distinguished() {
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
    let ratio =
        (window.x.range.end - window.x.range.start) / (window.y.range.end - window.y.range.start);
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
