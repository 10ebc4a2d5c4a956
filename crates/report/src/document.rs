//! A report as data: sections of text, tables and figures.

use crate::figure::panel::Panel;

/// A report. All text is plain text, wherever it comes from.
#[derive(Clone, Debug, Default)]
pub struct Document {
    /// Title on top.
    pub title: String,
    /// A line below the title, or empty.
    pub subtitle: String,
    /// Sections in their order.
    pub sections: Vec<Section>,
}

impl Document {
    /// The figures in their order.
    pub fn figures(&self) -> impl Iterator<Item = &Figure> {
        let blocks = self.sections.iter().flat_map(|section| &section.blocks);
        blocks.filter_map(|block| match block {
            Block::Figure(figure) => Some(figure),
            _ => None,
        })
    }
}

/// A section of a report.
#[derive(Clone, Debug, Default)]
pub struct Section {
    /// Its heading.
    pub title: String,
    /// What stands in it, in order.
    pub blocks: Vec<Block>,
}

/// A piece of a section.
#[derive(Clone, Debug)]
pub enum Block {
    /// A paragraph.
    Text(String),
    /// A paragraph that must not be overlooked.
    Warning(String),
    /// Several of them, one below the other.
    Warnings(Vec<String>),
    /// A table.
    Table(Table),
    /// A figure.
    Figure(Figure),
}

/// A table with a head.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// Stem of the names of its files.
    pub name: String,
    /// What it shows, in a sentence.
    pub caption: String,
    /// Heads of the columns, with units.
    pub head: Vec<String>,
    /// Rows of as many cells.
    pub rows: Vec<Vec<Cell>>,
}

/// A cell of a table.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Cell {
    /// What stands there.
    pub text: String,
    /// Whether it stands out, such as the best of its row.
    pub strong: bool,
}

impl Cell {
    /// A number with so many digits after the point; a dash where there is none.
    pub fn number(value: f64, digits: usize) -> Self {
        if value.is_finite() {
            format!("{value:.digits$}").into()
        } else {
            "–".into()
        }
    }

    /// The cell, standing out.
    pub fn strong(self) -> Self {
        Self {
            strong: true,
            ..self
        }
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self {
            text,
            strong: false,
        }
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        text.to_owned().into()
    }
}

/// Panels with one caption.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Stem of the names of its files.
    pub name: String,
    /// What it shows, in a sentence.
    pub caption: String,
    /// How many panels stand side by side.
    pub columns: usize,
    /// The panels, row by row.
    pub panels: Vec<Panel>,
}
