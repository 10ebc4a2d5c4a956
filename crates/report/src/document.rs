//! A report as data: sections of text, tables and figures.

use crate::{
    figure::panel::Panel,
    numbers::{count, short},
};
use undrift_results::{Number, Usability};

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
    /// Changes each text that is shown.
    pub(crate) fn each_text(&mut self, change: &mut dyn FnMut(&mut String)) {
        change(&mut self.title);
        for section in &mut self.sections {
            change(&mut section.title);
            change(&mut section.note);
            for block in &mut section.blocks {
                match block {
                    Block::Verdict(_, text) | Block::Text(text) | Block::Warning(text) => {
                        change(text);
                    }
                    Block::Warnings(all) => all.iter_mut().for_each(&mut *change),
                    Block::Table(table) => {
                        change(&mut table.caption);
                        table.head.iter_mut().for_each(&mut *change);
                        let cells = table.rows.iter_mut().flatten();
                        cells.for_each(|cell| change(&mut cell.text));
                    }
                    Block::Figure(figure) => {
                        change(&mut figure.caption);
                        for panel in &mut figure.panels {
                            change(&mut panel.title);
                            change(&mut panel.x.label);
                            change(&mut panel.y.label);
                            panel.series.iter_mut().for_each(|of| change(&mut of.name));
                        }
                    }
                }
            }
        }
    }

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
    /// Its content, in order.
    pub blocks: Vec<Block>,
    /// Its numbers in a few words, beside its heading in the contents; or empty.
    pub note: String,
    /// Whether it is shown on demand only.
    pub folded: bool,
}

impl Section {
    /// A section of some blocks; `None` without blocks.
    pub(crate) fn new(title: &str, blocks: impl IntoIterator<Item = Block>) -> Option<Self> {
        let blocks = Vec::from_iter(blocks);
        (!blocks.is_empty()).then(|| Self {
            title: title.into(),
            blocks,
            ..Self::default()
        })
    }

    /// The section with its numbers for the contents.
    pub(crate) fn noted(self, note: String) -> Self {
        Self { note, ..self }
    }

    /// The section, shown on demand.
    pub(crate) fn folded(self) -> Self {
        Self {
            folded: true,
            ..self
        }
    }
}

/// A piece of a section.
#[derive(Clone, Debug)]
pub enum Block {
    /// Whether the result is of use and why, in a sentence, before all else.
    Verdict(Usability, String),
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

/// The head of a column, and its cell of an item.
pub(crate) type Column<'a, T> = (&'a str, &'a dyn Fn(&T) -> Cell);

impl Table {
    /// A table with a row for each item.
    pub(crate) fn from_rows<T>(
        name: &str,
        caption: &str,
        items: impl IntoIterator<Item = T>,
        columns: &[Column<'_, T>],
    ) -> Self {
        let row = |item: T| columns.iter().map(|(_, cell)| cell(&item)).collect();
        Self {
            name: name.into(),
            caption: caption.into(),
            head: columns.iter().map(|(head, _)| (*head).into()).collect(),
            rows: items.into_iter().map(row).collect(),
        }
    }

    /// Adds a column with a cell for each row.
    pub(crate) fn add(&mut self, head: String, cells: impl IntoIterator<Item = Cell>) {
        self.head.push(head);
        for (row, cell) in self.rows.iter_mut().zip(cells) {
            row.push(cell);
        }
    }

    /// Adds a column of numbers whose least is marked.
    pub(crate) fn add_ranked(&mut self, head: String, values: &[f64]) {
        self.add(head, values.iter().map(|v| short(*v).into()));
        self.mark_least(self.head.len() - 1, values);
    }

    /// Makes the least number of a column stand out, and those that read the same, where others differ.
    pub(crate) fn mark_least(&mut self, column: usize, values: &[f64]) {
        let finite = || values.iter().copied().filter(|v| v.is_finite());
        let least = short(finite().fold(f64::INFINITY, f64::min));
        if short(finite().fold(f64::NEG_INFINITY, f64::max)) == least {
            return;
        }
        for (row, value) in self.rows.iter_mut().zip(values) {
            if let Some(cell) = row.get_mut(column) {
                cell.strong |= value.is_finite() && short(*value) == least;
            }
        }
    }

    /// Whether a column holds numbers, be they with a unit, a bound or an interval after them, and gaps at
    /// most. The first column names the rows: there a name may begin with a digit.
    pub(crate) fn is_numeric(&self, column: usize) -> bool {
        let is_number = |cell: &Cell| {
            let text = cell
                .text
                .trim_start_matches(['±', '<', '>', '+', '−', '-', ' ']);
            let number = text.replace('\u{202f}', "");
            let first = number.split([' ', ',']).next().unwrap_or_default();
            let alone = number.trim_end_matches([' ', '%']);
            let number = if column == 0 { alone } else { first };
            number.starts_with(|c: char| c.is_ascii_digit()) && number.parse::<f64>().is_ok()
        };
        let is_gap =
            |cell: &Cell| matches!(cell.text.as_str(), "" | "–" | "—" | "-" | "not detected");
        let cells = || self.rows.iter().filter_map(|row| row.get(column));
        cells().all(|cell| is_number(cell) || is_gap(cell))
            && cells().any(|cell| !cell.text.is_empty())
    }

    /// The table as a block with another caption, if it has a row.
    pub(crate) fn captioned(self, caption: &str) -> Option<Block> {
        let caption = caption.into();
        Self { caption, ..self }.block()
    }

    /// The table as a block, if it has a row.
    pub(crate) fn block(self) -> Option<Block> {
        (!self.rows.is_empty()).then_some(Block::Table(self))
    }
}

/// A cell of a table.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Cell {
    /// Text of the cell.
    pub text: String,
    /// Whether it is marked, such as the best of its row.
    pub strong: bool,
    /// What a page links it to: the address of another page, or a file relative to this one.
    pub link: Option<String>,
}

impl Cell {
    /// A number with so many digits after the point; a dash if it is not finite.
    pub fn number(value: f64, digits: usize) -> Self {
        if value.is_finite() {
            format!("{value:.digits$}").into()
        } else {
            "–".into()
        }
    }

    /// The cell, standing out.
    pub fn strong(self) -> Self {
        self.strong_if(true)
    }

    /// The cell, standing out if so.
    pub(crate) fn strong_if(self, strong: bool) -> Self {
        Self { strong, ..self }
    }

    /// The cell, linked to a file or page; other addresses, which may be programs, are not links.
    pub(crate) fn linked(self, to: Option<&str>) -> Self {
        let is_page = |to: &&str| {
            let scheme = to.split_once(':').map(|(scheme, _)| scheme);
            scheme.is_none_or(|scheme| ["http", "https", "file"].contains(&scheme))
        };
        Self {
            link: to.filter(is_page).map(str::to_owned),
            ..self
        }
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self {
            text,
            ..Self::default()
        }
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        text.to_owned().into()
    }
}

impl From<&String> for Cell {
    fn from(text: &String) -> Self {
        text.clone().into()
    }
}

/// A dash where there is no text.
impl From<&Option<String>> for Cell {
    fn from(text: &Option<String>) -> Self {
        text.as_deref().unwrap_or("–").into()
    }
}

/// Three significant digits; a dash where there is no number.
impl From<Number> for Cell {
    fn from(number: Number) -> Self {
        short(number.0).into()
    }
}

/// A count.
impl From<u64> for Cell {
    fn from(n: u64) -> Self {
        count(n).into()
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

impl Figure {
    /// A figure of some panels; `None` without panels.
    pub(crate) fn block(
        name: &str,
        caption: &str,
        columns: usize,
        panels: impl IntoIterator<Item = Panel>,
    ) -> Option<Block> {
        let panels = Vec::from_iter(panels);
        (!panels.is_empty()).then(|| {
            Block::Figure(Self {
                name: name.into(),
                caption: caption.into(),
                columns,
                panels,
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn those_that_read_the_same_stand_out_together() {
        let mut t = Table::default();
        let values = [3.831, 3.834, 6.0];
        t.rows = vec![Vec::new(); 3];
        t.add_ranked("a".into(), &values);
        let strong: Vec<bool> = t.rows.iter().map(|r| r[0].strong).collect();
        assert_eq!(strong, [true, true, false]);
    }

    #[test]
    fn columns_of_numbers_are_distinguished_from_text() {
        let row = |a: &str, b: &str, c: &str| vec![a.into(), b.into(), c.into()];
        let table = Table {
            rows: vec![row("1", "−2.5 %", "–"), row("x", "–", "")],
            ..Table::default()
        };
        // Of gaps alone it was to be one of numbers.
        assert_eq!([0, 1, 2].map(|i| table.is_numeric(i)), [false, true, true]);
        let of = |text: &str| Table {
            rows: vec![row("", text, ""), row("", "–", "")],
            ..Table::default()
        };
        for text in [
            "-98.0 (-2.86)",
            "2.35 °/√h",
            "1.2e-4 ± 3e-5 (2e-4)",
            "1\u{202f}234",
            "0.1, 0.2, 0.3",
        ] {
            assert!(of(text).is_numeric(1), "{text}");
        }
        for text in ["ARMA(1,1)", "consistent", "3D", "5-state", "inf"] {
            assert!(!of(text).is_numeric(1), "{text}");
        }
    }
    #[test]
    fn nothing_stands_out_where_all_read_the_same() {
        let strong = |values: &[f64]| {
            let mut table = Table {
                rows: vec![Vec::new(); values.len()],
                ..Table::default()
            };
            table.add_ranked("a".into(), values);
            crate::tests::strong(&table)
        };
        assert_eq!(strong(&[1.001, 1.002, f64::NAN]), []);
        assert_eq!(strong(&[2.0, f64::NAN, -1.0]), [(2, 0)]);
        assert_eq!(strong(&[f64::INFINITY, 2.0, 3.0]), [(1, 0)]);
    }

    #[test]
    fn a_first_column_of_numbers_alone_is_numeric() {
        let of = |texts: &[&str]| Table {
            rows: texts.iter().map(|text| vec![Cell::from(*text)]).collect(),
            ..Table::default()
        };
        for texts in [
            ["10 %", "20"],
            ["1\u{202f}000", "not detected"],
            ["< 5", "±3"],
        ] {
            assert!(of(&texts).is_numeric(0), "{texts:?}");
        }
        for texts in [["10 s", "20"], ["", ""], ["1", "a"]] {
            assert!(!of(&texts).is_numeric(0), "{texts:?}");
        }
    }

    #[test]
    fn cells_are_numbers_counts_or_a_dash() {
        assert_eq!(Cell::number(1.25, 1).text, "1.2");
        assert_eq!(Cell::number(f64::INFINITY, 1).text, "–");
        assert_eq!(Cell::from(1234u64).text, "1\u{202f}234");
        assert_eq!(Cell::from(Number(0.5)).text, "0.500");
        assert_eq!(Cell::from(&None::<String>).text, "–");
        assert_eq!(Cell::from(&Some("a".to_owned())).text, "a");
        assert!(Cell::from("a").strong().strong && !Cell::from("a").strong_if(false).strong);
        assert!(Table::default().block().is_none() && Section::new("a", []).is_none());
        assert!(Figure::block("a", "", 1, []).is_none());
        let section = Section::new("a", [Block::Text("b".into())]).unwrap();
        assert!(!section.folded && section.clone().folded().folded);
        assert_eq!(section.noted("n".into()).note, "n");
    }
}
