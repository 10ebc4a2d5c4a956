//! The figures of a report as files.

use super::{Block, Document, Figure};
use crate::figure::draw;
use resvg::{tiny_skia, usvg};
use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

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
/// what was written.
///
/// # Errors
/// A sentence for the user when a file cannot be written.
pub fn write(document: &Document, dir: &Path, formats: Formats) -> Result<Vec<PathBuf>, String> {
    let at = |path: &Path, problem: String| format!("cannot write {}: {problem}", path.display());
    std::fs::create_dir_all(dir).map_err(|e| at(dir, e.to_string()))?;
    let options = formats.png.then(text_options);
    let mut written = Vec::new();
    let mut save = |name: String, content: &[u8]| {
        let path = dir.join(name);
        std::fs::write(&path, content).map_err(|e| at(&path, e.to_string()))?;
        written.push(path);
        Ok::<(), String>(())
    };
    let blocks = document.sections.iter().flat_map(|s| &s.blocks);
    for block in blocks {
        let Block::Figure(figure) = block else {
            continue;
        };
        let name = super::file_stem(&figure.name);
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
    let shape = maps
        .map(|panel| panel.shape().clamp(0.5, 0.9))
        .reduce(f64::max);
    let height = shape.map_or(420.min(width), |shape| {
        (f64::from(width) * shape) as u32 + 80
    });
    draw::svg(&figure.panels, figure.columns, (width, height))
}

/// A font of our own, so that labels look alike on every machine; those of the system for letters
/// that it lacks.
fn text_options() -> usvg::Options<'static> {
    let mut fonts = usvg::fontdb::Database::new();
    fonts.load_font_data(include_bytes!("assets/DejaVuSans-subset.ttf").to_vec());
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
