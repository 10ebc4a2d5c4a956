//! Colours and widths of lines. `assets/style.json` is their one source: the page's
//! script reads it too.

use super::panel::Drawn;
use serde::Deserialize;
use std::{collections::BTreeMap, fmt::Write, sync::LazyLock};

/// The source, as embedded in a page.
pub(crate) const SOURCE: &str = include_str!("../assets/style.json");

/// On a light ground, on a dark one: `#rrggbb`.
type Colour = [String; 2];

/// What both drawers agree on.
#[derive(Deserialize)]
pub(crate) struct Style {
    inks: BTreeMap<String, Colour>,
    colours: Vec<Colour>,
    widths: BTreeMap<Drawn, f64>,
    /// Pixels drawn and left free of a dashed line.
    pub dash: String,
    /// Of other lines, which distinguish those of one panel without colours; the first is empty.
    dashes: Vec<String>,
    /// Diameter \[pixel\].
    pub dot: f64,
    /// How much of its colour a band has.
    pub tint: f64,
}

/// The style.
pub(crate) fn style() -> &'static Style {
    static STYLE: LazyLock<Style> =
        LazyLock::new(|| serde_json::from_str(SOURCE).expect("style.json is checked by a test"));
    &STYLE
}

impl Style {
    /// A colour of series on paper.
    pub fn colour(&self, index: usize) -> &str {
        &self.colours[index % self.colours.len()][0]
    }

    /// A pattern of a line, empty for one without gaps.
    pub fn pattern(&self, index: usize) -> &str {
        &self.dashes[index % self.dashes.len()]
    }

    /// A colour of what is around them on paper.
    pub fn ink(&self, name: &str) -> &str {
        self.inks.get(name).map_or("#000000", |ink| &ink[0])
    }

    /// Width of a kind of line \[pixel\].
    pub fn width(&self, kind: Drawn) -> f64 {
        self.widths.get(&kind).copied().unwrap_or(1.0)
    }

    /// The colours as variables of a style sheet: `--paper`, `--c0` …
    pub fn css(&self) -> String {
        let mut css = String::from(":root {\n");
        let series = self.colours.iter().enumerate();
        let series = series.map(|(i, colour)| (format!("c{i}"), colour));
        for (name, [light, dark]) in self.inks.iter().map(|(n, c)| (n.clone(), c)).chain(series) {
            // Writing into a string does not fail.
            let _ = writeln!(css, "  --{name}: light-dark({light}, {dark});");
        }
        css + "}\n"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_style_is_whole() {
        let style = style();
        assert_eq!(style.colours.len(), 8);
        let hex = |colour: &String| colour.len() == 7 && colour.starts_with('#');
        assert!(style.inks.values().chain(&style.colours).flatten().all(hex));
        assert!(style.dashes.len() > 4 && style.pattern(style.dashes.len()).is_empty());
        assert!(style.width(Drawn::Thick) > style.width(Drawn::Line));
        assert!(style.css().contains("--c7: light-dark(#0072b2, #4b9fe0);"));
    }
}
