//! The figures of a report as files.

use super::{Block, Document, Figure};
use crate::figure::draw;
use resvg::{tiny_skia, usvg};
use std::{
    collections::HashMap,
    path::{Path, PathBuf},
    sync::Arc,
};

/// Latin, Greek and Cyrillic letters of DejaVu Sans; the licence stands beside it.
const FONT: &[u8] = include_bytes!("assets/DejaVuSans-subset.ttf");

/// Which files are written of each figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Formats {
    /// NAME.svg.
    pub svg: bool,
    /// NAME.png, of twice as many pixels.
    pub png: bool,
}

impl Default for Formats {
    fn default() -> Self {
        Self {
            svg: true,
            png: true,
        }
    }
}

/// Writes every figure of the document into a directory, which is made where it is missing; returns
/// what was written. Letters of a name that a file cannot have become dashes; a second figure of one
/// name becomes NAME-2.
///
/// # Errors
/// A sentence for the user when a file cannot be written.
pub fn write(document: &Document, dir: &Path, formats: Formats) -> Result<Vec<PathBuf>, String> {
    let at = |path: &Path, problem: String| format!("cannot write {}: {problem}", path.display());
    std::fs::create_dir_all(dir).map_err(|e| at(dir, e.to_string()))?;
    let options = formats.png.then(text_options);
    let mut written = Vec::new();
    let mut names: HashMap<String, usize> = HashMap::new();
    let mut save = |name: String, content: &[u8]| {
        let path = dir.join(name);
        undrift::io::write::write_whole(&path, content).map_err(|e| at(&path, e.to_string()))?;
        written.push(path);
        Ok::<(), String>(())
    };
    let blocks = document.sections.iter().flat_map(|s| &s.blocks);
    for block in blocks {
        let Block::Figure(figure) = block else {
            continue;
        };
        let stem = super::file_stem(&figure.name);
        let nth = names.entry(stem.clone()).or_insert(0);
        *nth += 1;
        let name = if *nth > 1 {
            format!("{stem}-{nth}")
        } else {
            stem
        };
        let drawn = svg(figure).map_err(|e| format!("cannot draw {name}: {e}"))?;
        if let Some(options) = &options {
            let png = png(&drawn, options).map_err(|e| format!("cannot draw {name}: {e}"))?;
            save(format!("{name}.png"), &png)?;
        }
        if formats.svg {
            save(format!("{name}.svg"), drawn.as_bytes())?;
        }
    }
    Ok(written)
}

/// A figure as the text of an SVG file.
fn svg(figure: &Figure) -> Result<String, String> {
    // Of one width on paper, however many panels stand side by side.
    let width = match figure.columns {
        0 | 1 => 840,
        2 => 580,
        _ => 440,
    };
    // A map is as high as it needs, and panels beside it are as high.
    let maps = figure.panels.iter().filter(|panel| panel.to_scale);
    let shapes = maps
        .map(|panel| panel.shape())
        .filter(|shape| shape.is_finite());
    let shape = shapes.reduce(f64::max).map(|shape| shape.clamp(0.5, 0.9));
    let height = shape.map_or(420.min(width), |shape| {
        (f64::from(width) * shape) as u32 + 80
    });
    draw::svg(&figure.panels, figure.columns, (width, height))
}

/// A font of our own, so that labels look alike on every machine; those of the system for letters
/// that it lacks.
fn text_options() -> usvg::Options<'static> {
    let mut fonts = usvg::fontdb::Database::new();
    fonts.load_font_data(FONT.to_vec());
    fonts.load_system_fonts();
    fonts.set_sans_serif_family("DejaVu Sans");
    usvg::Options {
        fontdb: Arc::new(fonts),
        ..usvg::Options::default()
    }
}

/// An SVG file as a PNG file of twice its size.
fn png(svg: &str, options: &usvg::Options) -> Result<Vec<u8>, String> {
    const SCALE: f32 = 2.0;
    let tree = usvg::Tree::from_str(svg, options).map_err(|e| e.to_string())?;
    let size = tree.size().to_int_size();
    let pixels = (size.width() * SCALE as u32, size.height() * SCALE as u32);
    let mut image = tiny_skia::Pixmap::new(pixels.0, pixels.1).ok_or("the figure is too large")?;
    let scale = tiny_skia::Transform::from_scale(SCALE, SCALE);
    resvg::render(&tree, scale, &mut image.as_mut());
    image.encode_png().map_err(|e| e.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Axis, Panel, Section, Series};

    fn document() -> Document {
        let mut panel = Panel::new("Title", Axis::new("x"), Axis::new("y"));
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
            }],
            ..Document::default()
        }
    }

    #[test]
    fn files_stay_in_their_directory() {
        let dir = tempfile::tempdir().unwrap();
        let inner = dir.path().join("inner");
        let written = write(&document(), &inner, Formats::default()).unwrap();
        let names = ["a-b-c.png", "a-b-c.svg", "a-b-c-2.png", "a-b-c-2.svg"];
        assert_eq!(written, names.map(|name| inner.join(name)));
        assert!(written.iter().all(|path| path.is_file()));
        let none = Formats {
            svg: false,
            png: false,
        };
        assert!(write(&document(), &inner, none).unwrap().is_empty());
    }

    #[test]
    fn png_files_have_text_and_curve() {
        let Block::Figure(figure) = document().sections.remove(0).blocks.remove(0) else {
            panic!("a figure");
        };
        // With the font of our own alone.
        let mut options = usvg::Options::default();
        let mut fonts = usvg::fontdb::Database::new();
        fonts.load_font_data(FONT.to_vec());
        fonts.set_sans_serif_family("DejaVu Sans");
        options.fontdb = Arc::new(fonts);
        let image = png(&svg(&figure).unwrap(), &options).unwrap();
        let image = tiny_skia::Pixmap::decode_png(&image).unwrap();
        assert_eq!((image.width(), image.height()), (1680, 840));
        let dark = |y: u32| {
            let row = (0..image.width()).filter_map(|x| image.pixel(x, y));
            row.filter(|pixel| pixel.red() < 100).count()
        };
        // "Title" in letters 18 pixels high, twice enlarged, is some hundreds of dark pixels.
        let title: usize = (28..72).map(dark).sum();
        assert!((100..5000).contains(&title), "{title}");
        // The diagonal passes through every row.
        assert!((300..500).all(|y| dark(y) > 4));
    }
}
