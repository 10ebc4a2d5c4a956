//! What tests see of a report.

use crate::{Block, Figure, Panel, Section, Series, Table};
use undrift_results::{Curve, Number, Numbers};

/// The texts of a table, row by row.
pub(crate) fn cells(table: &Table) -> Vec<Vec<&str>> {
    let rows = table.rows.iter();
    rows.map(|row| row.iter().map(|cell| &*cell.text).collect())
        .collect()
}

/// Row and column of the cells that stand out.
pub(crate) fn strong(table: &Table) -> Vec<(usize, usize)> {
    let mut places = Vec::new();
    for (row, cells) in table.rows.iter().enumerate() {
        for (column, cell) in cells.iter().enumerate() {
            if cell.strong {
                places.push((row, column));
            }
        }
    }
    places
}

/// A block that is a figure.
pub(crate) fn figure(block: Option<Block>) -> Figure {
    match block {
        Some(Block::Figure(figure)) => figure,
        other => panic!("no figure: {other:?}"),
    }
}

/// The figure of a name in some sections.
pub(crate) fn figure_of<'a>(
    sections: impl IntoIterator<Item = &'a Section>,
    name: &str,
) -> &'a Figure {
    let blocks = sections.into_iter().flat_map(|section| &section.blocks);
    let mut figures = blocks.filter_map(|block| match block {
        Block::Figure(figure) => Some(figure),
        _ => None,
    });
    figures.find(|figure| figure.name == name).unwrap()
}

/// The paragraphs, verdicts and warnings of a section.
pub(crate) fn sentences(section: &Section) -> Vec<&str> {
    let blocks = section.blocks.iter();
    blocks
        .flat_map(|block| match block {
            Block::Verdict(_, text) | Block::Text(text) | Block::Warning(text) => vec![&**text],
            Block::Warnings(texts) => texts.iter().map(|text| &**text).collect(),
            Block::Table(_) | Block::Figure(_) => Vec::new(),
        })
        .collect()
}

/// Names of the blocks of a section that are tables or figures.
pub(crate) fn names(section: &Section) -> Vec<&str> {
    let blocks = section.blocks.iter();
    blocks
        .filter_map(|block| match block {
            Block::Table(table) => Some(&*table.name),
            Block::Figure(figure) => Some(&*figure.name),
            _ => None,
        })
        .collect()
}

/// Names of the series of a panel.
pub(crate) fn legend(panel: &Panel) -> Vec<&str> {
    panel.series.iter().map(|series| &*series.name).collect()
}

/// The points of a series of one column.
pub(crate) fn points(series: &Series) -> Vec<(f64, f64)> {
    assert_eq!(series.y.len(), 1);
    series.points().collect()
}

/// That points are these but for rounding.
pub(crate) fn assert_points(series: &Series, expected: &[(f64, f64)]) {
    let found = points(series);
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (a, b) in found.iter().zip(expected) {
        assert!(near(a.0, b.0) && near(a.1, b.1), "{found:?}");
    }
}

/// Equal but for rounding, or both missing.
pub(crate) fn near(a: f64, b: f64) -> bool {
    (a.is_nan() && b.is_nan()) || (a - b).abs() <= 1e-9 * a.abs().max(b.abs()).max(1e-9)
}

pub(crate) fn numbers(values: &[f64]) -> Vec<Number> {
    values.iter().copied().map(Number).collect()
}

pub(crate) fn curve(times: &[f64], values: &[f64]) -> Curve {
    Curve {
        time_s: numbers(times),
        value: numbers(values),
    }
}

/// Numbers by name.
pub(crate) fn by_name(pairs: &[(&str, f64)]) -> Numbers {
    let pairs = pairs.iter();
    pairs
        .map(|(name, value)| ((*name).to_owned(), Number(*value)))
        .collect()
}
