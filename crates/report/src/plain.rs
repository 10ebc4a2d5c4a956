//! Blocks and tables as plain text.

use crate::{Block, Cell, Table};
use undrift_io::visible;

/// How a terminal marks emphasised text; another place takes [`unmarked`].
pub type Mark = fn(&str) -> String;

/// Text as it is.
pub fn unmarked(text: &str) -> String {
    text.to_owned()
}

/// The blocks there are with an empty line between them: verdicts marked, tables below their captions, no figures.
pub(crate) fn plain(blocks: impl IntoIterator<Item = Option<Block>>, mark: Mark) -> String {
    let texts = blocks
        .into_iter()
        .flatten()
        .filter_map(|block| match block {
            Block::Verdict(_, text) => Some(mark(&text)),
            Block::Text(text) | Block::Warning(text) => Some(text),
            Block::Warnings(texts) => Some(texts.join("\n")),
            Block::Table(table) => Some(table.caption.clone() + "\n" + &plain_table(&table, mark)),
            Block::Figure(_) => None,
        });
    let texts = texts.map(|text| text.trim_matches('\n').to_owned());
    Vec::from_iter(texts).join("\n\n")
}

/// A table in columns of their own width: names from the left, numbers to the right; heads are marked, and
/// emphasised cells.
pub(crate) fn plain_table(table: &Table, mark: Mark) -> String {
    let heads: Vec<Cell> = table.head.iter().map(|head| head.as_str().into()).collect();
    let one_line = |cell: &Cell| Cell {
        text: visible(&cell.text).into_owned(),
        ..cell.clone()
    };
    let rows: Vec<Vec<Cell>> = std::iter::once(&heads)
        .chain(&table.rows)
        .map(|row| row.iter().map(one_line).collect())
        .collect();
    let rows = || rows.iter();
    let length = |text: &str| text.chars().count();
    let columns: Vec<(bool, usize)> = (0..heads.len())
        .map(|i| {
            let lengths = rows().filter_map(|row| Some(length(&row.get(i)?.text)));
            (table.is_numeric(i), lengths.max().unwrap_or(0))
        })
        .collect();
    let mut text = String::new();
    for (at, row) in rows().enumerate() {
        let mut line = String::new();
        for (cell, (numeric, width)) in row.iter().zip(&columns) {
            let room = " ".repeat(width - length(&cell.text));
            let shown = match cell.text.as_str() {
                "" => String::new(),
                text if at == 0 || cell.strong => mark(text),
                text => text.to_owned(),
            };
            line += &match numeric {
                true => format!("{room}{shown}  "),
                false => format!("{shown}{room}  "),
            };
        }
        text += line.trim_end();
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_stand_in_line_and_the_least_of_each_is_marked() {
        let names = ["white, none", "our 2", "lost"];
        let mut table = Table::from_rows("", "", names, &[("maximum", &|name| (*name).into())]);
        table.add_ranked("N [m]".into(), &[3.1, 2e-3, f64::NAN]);
        table.add_ranked("E [m]".into(), &[0.5, 0.5, f64::NAN]);
        table.add_ranked("D [m]".into(), &[0.25, -12_345.0, 1.5]);
        let plain = "\
maximum        N [m]  E [m]    D [m]
white, none     3.10  0.500    0.250
our 2        0.00200  0.500  -12\u{202f}300
lost               –      –     1.50
";
        assert_eq!(plain_table(&table, unmarked), plain);
        let bold = plain_table(&table, |text| format!("<{text}>"));
        for wanted in [
            "<maximum>        <N [m]>  <E [m]>    <D [m]>\n",
            "our 2        <0.00200>  0.500  <-12\u{202f}300>\n",
        ] {
            assert!(bold.contains(wanted), "{wanted:?} in {bold:?}");
        }
    }
}
