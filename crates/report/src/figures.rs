//! The figures of a report as files.

use super::{
    Document, Figure, Panel,
    figure::draw::{Drawing, drawing},
    markup::file_stem,
};
use std::{
    collections::HashMap,
    path::{Path, PathBuf},
};

/// Every figure of the document as the name and the text of an SVG file. Letters of a name that a file cannot have become
/// dashes; a second figure of one name becomes NAME-2.
pub fn svgs(document: &Document) -> impl Iterator<Item = (String, String)> {
    let mut names: HashMap<String, usize> = HashMap::new();
    document.figures().map(move |figure| {
        let stem = file_stem(&figure.name);
        let nth = names.entry(stem.clone()).or_insert(0);
        *nth += 1;
        let name = match nth {
            1 => format!("{stem}.svg"),
            _ => format!("{stem}-{nth}.svg"),
        };
        (name, draw(figure, "panel").file())
    })
}

/// Writes [`svgs`] into a directory, which is made where it is missing; returns what was written.
///
/// # Errors
/// A sentence for the user when a file cannot be written.
pub fn write(document: &Document, dir: &Path) -> Result<Vec<PathBuf>, String> {
    let at = |path: &Path, problem: String| format!("cannot write {}: {problem}", path.display());
    std::fs::create_dir_all(dir).map_err(|e| at(dir, e.to_string()))?;
    let mut written = Vec::new();
    for (name, svg) in svgs(document) {
        let path = dir.join(name);
        undrift_io::write::write_whole(&path, svg).map_err(|e| at(&path, e.to_string()))?;
        written.push(path);
    }
    Ok(written)
}

/// The picture of an experiment with outages as the text of an SVG file: the way driven, and the drift of each
/// model since the cut.
pub fn experiment(document: &Document) -> String {
    let titles = [
        ("trajectory", "Drive, GNSS outages in orange"),
        (
            "drift",
            "Horizontal drift since the cut, RMS over the outages",
        ),
    ];
    let panels: Vec<Panel> = titles
        .iter()
        .filter_map(|(name, title)| {
            let figure = document.figures().find(|figure| figure.name == *name)?;
            let panel = figure.panels.first()?.clone();
            Some(panel.titled(title))
        })
        .collect();
    drawing(&panels, 2, (573.0, 520.0), "panel").file()
}

/// The average NEES over time of a Monte Carlo as the text of an SVG file, a panel for each group of states.
pub fn consistency(document: &Document) -> String {
    let nees = document.figures().find(|figure| figure.name == "nees");
    let drawing = nees.map_or_else(
        || drawing(&[], 1, (580.0, 420.0), "panel"),
        |figure| draw(figure, "panel"),
    );
    drawing.file()
}

/// The drawing of a figure; `id` distinguishes those of one page.
pub(crate) fn draw(figure: &Figure, id: &str) -> Drawing {
    // Of one width on paper, however many panels stand side by side.
    let width: f64 = match figure.columns {
        0 | 1 => 840.0,
        2 => 580.0,
        _ => 440.0,
    };
    // A map is as high as it needs, and panels beside it are as high.
    let maps = figure.panels.iter().filter(|panel| panel.to_scale);
    let shapes = maps
        .map(|panel| panel.shape())
        .filter(|shape| shape.is_finite());
    let shape = shapes.reduce(f64::max).map(|shape| shape.clamp(0.5, 0.9));
    let height = shape.map_or(width.min(420.0), |shape| (width * shape).floor() + 80.0);
    drawing(&figure.panels, figure.columns, (width, height), id)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Block, Panel, PlotAxis, Section, Series};

    fn document() -> Document {
        let mut panel = Panel::new("Title", PlotAxis::new("x"), PlotAxis::new("y"));
        panel.add(Series::line("", 7, vec![(0.0, 0.0), (1.0, 1.0)]));
        let figure = Figure {
            name: "../a/b c".into(),
            caption: String::new(),
            columns: 1,
            panels: vec![panel],
        };
        Document {
            sections: vec![Section {
                title: String::new(),
                blocks: vec![Block::Figure(figure.clone()), Block::Figure(figure)],
                ..Section::default()
            }],
            ..Document::default()
        }
    }

    #[test]
    fn files_stay_in_their_directory() {
        let dir = tempfile::tempdir().unwrap();
        let inner = dir.path().join("inner");
        let written = write(&document(), &inner).unwrap();
        let names = ["a-b-c.svg", "a-b-c-2.svg"];
        assert_eq!(written, names.map(|name| inner.join(name)));
        let text = std::fs::read_to_string(&written[0]).unwrap();
        assert!(text.contains(">Title</text>") && text.contains("stroke=\"#0072b2\""));
    }
    #[test]
    fn a_map_is_as_high_as_it_needs_for_its_width() {
        let size = |columns: usize, wide: f64, map: bool| {
            let mut panel = Panel::new("", PlotAxis::new(""), PlotAxis::new(""));
            panel.add(Series::line("", 7, vec![(0.0, 0.0), (wide, 100.0)]));
            let figure = Figure {
                name: String::new(),
                caption: String::new(),
                columns,
                panels: vec![if map { panel.to_scale() } else { panel }],
            };
            let file = draw(&figure, "a").file();
            let (_, rest) = file.split_once("viewBox=\"0 0 ").unwrap();
            rest.split_once('"').unwrap().0.to_owned()
        };
        assert_eq!(
            [0, 1, 2, 3].map(|n| size(n, 1.0, false)),
            ["840 420", "840 420", "580 420", "440 420"]
        );
        // 110 m by 157.14: 0.7 of 840 and 80; at least a half, at most nine tenths.
        assert_eq!(size(1, 110.0 / 0.7, true), "840 668");
        assert_eq!(
            [size(1, 1e4, true), size(1, 10.0, true)],
            ["840 500", "840 836"]
        );
    }

    #[test]
    fn the_picture_of_an_experiment_has_the_way_and_the_drift() {
        let figure = |name: &str, x: f64| {
            let mut panel = Panel::new(name, PlotAxis::new(""), PlotAxis::new(""));
            panel.add(Series::line("", 7, vec![(0.0, 0.0), (x, 1.0)]));
            let other = Panel::new("second", PlotAxis::new(""), PlotAxis::new(""));
            Figure::block(name, "", 1, [panel, other]).unwrap()
        };
        let blocks = ["drift", "trajectory", "nees"].map(|name| figure(name, 1.0));
        let document = Document {
            sections: Section::new("", blocks).into_iter().collect(),
            ..Document::default()
        };
        let text = experiment(&document);
        let (way, drift) = (
            text.find("Drive, GNSS outages").unwrap(),
            text.find("Horizontal drift since the cut").unwrap(),
        );
        assert!(way < drift && !text.contains("second"), "{text}");
        assert!(text.contains("viewBox=\"0 0 1160 520\""), "{text}");
        let nees = consistency(&document);
        assert!(
            nees.contains(">nees</text>") && !nees.contains(">drift</text>"),
            "{nees}"
        );
        assert!(consistency(&Document::default()).contains("<svg"));
    }
}
