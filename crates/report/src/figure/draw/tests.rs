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
    assert!(shades[0].starts_with("M0 0H20V50H0Z") && shades[1].starts_with("M80 0H100V50H80Z"));
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
    let (drawn, height) = super::names(&panel(&["a", "white, no constants", "c"]), 320.0).unwrap();
    for (left, top, name) in [
        ("60", 17, "a"),
        ("160", 17, "white, no "),
        ("160", 34, "constants"),
        ("260", 17, "c"),
    ] {
        let text = format!("<text x=\"{left}\" y=\"{top}\" text-anchor=\"middle\">{name}</text>");
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
