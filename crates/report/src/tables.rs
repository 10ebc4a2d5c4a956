//! A report as a file: the whole page as HTML, or its tables alone as Markdown, LaTeX or CSV.

use crate::{Block, Cell, Document, Table, html, markup::file_stem};
use std::path::Path;
use undrift_io::visible;

/// What a report is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReportFormat {
    /// One self-contained page with tables and figures.
    Html,
    /// The tables as those of GitHub.
    Markdown,
    /// The tables with the rules of the package booktabs.
    Latex,
    /// The tables as one, with a column of their names.
    Csv,
}

impl ReportFormat {
    /// By the extension of a file: html, md, tex or csv; without one it is HTML. None of another extension.
    pub fn from_path(path: &Path) -> Option<Self> {
        let Some(extension) = path.extension() else {
            return Some(Self::Html);
        };
        match extension.to_string_lossy().to_lowercase().as_str() {
            "html" | "htm" => Some(Self::Html),
            "md" => Some(Self::Markdown),
            "tex" => Some(Self::Latex),
            "csv" => Some(Self::Csv),
            _ => None,
        }
    }

    /// The report as text.
    pub fn render(self, document: &Document) -> String {
        match self {
            Self::Html => html::render(document),
            Self::Markdown => markdown(document),
            Self::Latex => latex(document),
            Self::Csv => csv(document),
        }
    }
}

/// What a gap of a table reads.
const GAPS: [&str; 3] = ["–", "—", "-"];

/// Sections with the tables that they have.
fn sections(document: &Document) -> impl Iterator<Item = (&str, Vec<&Table>)> {
    let sections = document.sections.iter().map(|section| {
        let blocks = section.blocks.iter();
        let tables = blocks.filter_map(|block| match block {
            Block::Table(table) => Some(table),
            _ => None,
        });
        (section.title.as_str(), tables.collect())
    });
    sections.filter(|(_, tables): &(&str, Vec<&Table>)| !tables.is_empty())
}

fn markdown(document: &Document) -> String {
    let mut text = format!("# {}\n", of_markdown(&document.title));
    for (title, tables) in sections(document) {
        text += &format!("\n## {}\n", of_markdown(title));
        for table in tables {
            let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
            let head = table.head.iter().map(|head| of_markdown(head)).collect();
            let rule = (0..table.head.len()).map(|column| match table.is_numeric(column) {
                true => "---:".to_owned(),
                false => "---".to_owned(),
            });
            let cell = |cell: &Cell| match (of_markdown(&cell.text), cell.strong) {
                (text, true) if !text.is_empty() => format!("**{text}**"),
                (text, _) => text,
            };
            if !table.caption.is_empty() {
                text += &format!("\n{}\n", of_markdown(&table.caption));
            }
            text += "\n";
            text += &line(head);
            text += &line(rule.collect());
            for row in &table.rows {
                text += &line(row.iter().map(cell).collect());
            }
        }
    }
    text
}

/// Text in a line of Markdown.
fn of_markdown(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in visible(text).chars() {
        let is_link = c == '(' && out.ends_with(']');
        if is_link || matches!(c, '\\' | '`' | '*' | '_' | '<' | '>' | '|' | '~') {
            out.push('\\');
        }
        out.push(c);
    }
    out
}

fn latex(document: &Document) -> String {
    let mut text = format!(
        "% {}\n% In the preamble: \\usepackage{{booktabs}}\n",
        visible(&document.title)
    );
    for (title, tables) in sections(document) {
        text += &format!("\n% {}\n", visible(title));
        for table in tables {
            let line = |cells: Vec<String>| format!("{} \\\\\n", cells.join(" & "));
            let columns: String = (0..table.head.len())
                .map(|column| if table.is_numeric(column) { 'r' } else { 'l' })
                .collect();
            let cell = |cell: &Cell| match (of_latex(&cell.text), cell.strong) {
                (text, true) if !text.is_empty() => format!("\\textbf{{{text}}}"),
                (text, _) => text,
            };
            text += "\\begin{table}\n\\centering\n";
            text += &format!(
                "\\caption{{{}}}\n\\label{{tab:{}}}\n",
                of_latex(&table.caption),
                file_stem(&table.name)
            );
            text += &format!("\\begin{{tabular}}{{{columns}}}\n\\toprule\n");
            text += &line(table.head.iter().map(|head| of_latex(head)).collect());
            text += "\\midrule\n";
            for row in &table.rows {
                text += &line(row.iter().map(cell).collect());
            }
            text += "\\bottomrule\n\\end{tabular}\n\\end{table}\n";
        }
    }
    text
}

/// Text of LaTeX, for engines that know few characters beyond ASCII too.
fn of_latex(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in visible(text).chars() {
        let command = match c {
            '\\' => "\\textbackslash{}",
            '~' => "\\textasciitilde{}",
            '^' => "\\textasciicircum{}",
            '<' => "\\textless{}",
            '>' => "\\textgreater{}",
            '|' => "\\textbar{}",
            '&' => "\\&",
            '%' => "\\%",
            '$' => "\\$",
            '#' => "\\#",
            '_' => "\\_",
            '{' => "\\{",
            '}' => "\\}",
            '–' => "--",
            '—' => "---",
            '…' => "\\dots{}",
            '\u{202f}' => "\\,",
            '\u{a0}' => "~",
            '°' => "\\textdegree{}",
            'µ' | 'μ' => "\\textmu{}",
            '√' => "$\\surd$",
            '−' => "$-$",
            '±' => "$\\pm$",
            '×' => "$\\times$",
            '·' => "$\\cdot$",
            '≈' => "$\\approx$",
            '≤' => "$\\le$",
            '≥' => "$\\ge$",
            '→' => "$\\rightarrow$",
            'σ' => "$\\sigma$",
            'θ' => "$\\theta$",
            'φ' => "$\\varphi$",
            'τ' => "$\\tau$",
            'χ' => "$\\chi$",
            'ν' => "$\\nu$",
            'ᵀ' => "$^{T}$",
            '⁻' => "$^{-}$",
            '⁰' => "$^{0}$",
            '¹' => "$^{1}$",
            '²' => "$^{2}$",
            '³' => "$^{3}$",
            '⁴' => "$^{4}$",
            '⁵' => "$^{5}$",
            '⁶' => "$^{6}$",
            '⁷' => "$^{7}$",
            '⁸' => "$^{8}$",
            '⁹' => "$^{9}$",
            c => {
                out.push(c);
                continue;
            }
        };
        out.push_str(command);
    }
    out
}

/// All tables as one: the name of the table, then the columns of all of them by their heads.
fn csv(document: &Document) -> String {
    let tables: Vec<&Table> = sections(document).flat_map(|(_, tables)| tables).collect();
    let mut heads: Vec<(&str, usize)> = Vec::new();
    for table in &tables {
        for head in numbered(&table.head) {
            if !heads.contains(&head) {
                heads.push(head);
            }
        }
    }
    let line = |cells: Vec<String>| cells.join(",") + "\n";
    let head = |(head, nth): &(&str, usize)| match nth {
        1 => of_csv(head),
        nth => of_csv(&format!("{head} {nth}")),
    };
    let first = std::iter::once("table".to_owned());
    let mut text = line(first.chain(heads.iter().map(head)).collect());
    for table in tables {
        let places: Vec<(&str, usize)> = numbered(&table.head).collect();
        for row in &table.rows {
            let cell = |head: &(&str, usize)| {
                let place = places.iter().position(|place| place == head);
                let cell = place.and_then(|place| row.get(place));
                cell.map_or(String::new(), |cell| of_csv(&cell.text))
            };
            let first = std::iter::once(of_csv(&table.name));
            text += &line(first.chain(heads.iter().map(cell)).collect());
        }
    }
    text
}

/// Heads, each with how many of its name there are up to it.
fn numbered(heads: &[String]) -> impl Iterator<Item = (&str, usize)> {
    heads.iter().enumerate().map(|(at, head)| {
        let nth = heads[..=at].iter().filter(|other| *other == head).count();
        (head.as_str(), nth)
    })
}

/// A field of CSV: a gap is empty, a number has no spaces between its digits.
fn of_csv(text: &str) -> String {
    if GAPS.contains(&text) {
        return String::new();
    }
    let text = visible(text).replace('\u{202f}', "");
    let number = text.replace('−', "-");
    if number.parse::<f64>().is_ok() {
        return number;
    }
    match text.contains([',', '"']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Section;

    /// Two tables, of which the second has other columns.
    fn document() -> Document {
        let table = |name: &str, head: &[&str], rows: &[&[&str]]| {
            let cells = |row: &&[&str]| row.iter().map(|text| Cell::from(*text)).collect();
            Block::Table(Table {
                name: name.into(),
                caption: format!("Of {name}, 5 %."),
                head: head.iter().map(|head| (*head).into()).collect(),
                rows: rows.iter().map(cells).collect(),
            })
        };
        let mut first = table(
            "rms",
            &["model", "N °/√h"],
            &[&["a_b|c", "12\u{202f}300"], &["white, \"x\"", "–"]],
        );
        if let Block::Table(table) = &mut first {
            table.rows[0][1].strong = true;
        }
        let second = table("nees", &["model", "NEES", "NEES"], &[&["d", "1.5", "−2"]]);
        let text = Block::Text("not a table".into());
        Document {
            title: "GNSS & more".into(),
            sections: [("Errors", vec![text, first, second]), ("Empty", vec![])]
                .into_iter()
                .filter_map(|(title, blocks)| Section::new(title, blocks))
                .collect(),
            ..Document::default()
        }
    }

    #[test]
    fn markdown_has_a_table_under_each_caption() {
        let expected = "\
# GNSS & more

## Errors

Of rms, 5 %.

| model | N °/√h |
| --- | ---: |
| a\\_b\\|c | **12\u{202f}300** |
| white, \"x\" | – |

Of nees, 5 %.

| model | NEES | NEES |
| --- | ---: | ---: |
| d | 1.5 | −2 |
";
        assert_eq!(ReportFormat::Markdown.render(&document()), expected);
        assert_eq!(of_markdown("N [m] [a](b)"), "N [m] [a]\\(b)");
    }

    #[test]
    fn latex_is_escaped_and_has_the_rules_of_booktabs() {
        let expected = "\
% GNSS & more
% In the preamble: \\usepackage{booktabs}

% Errors
\\begin{table}
\\centering
\\caption{Of rms, 5 \\%.}
\\label{tab:rms}
\\begin{tabular}{lr}
\\toprule
model & N \\textdegree{}/$\\surd$h \\\\
\\midrule
a\\_b\\textbar{}c & \\textbf{12\\,300} \\\\
white, \"x\" & -- \\\\
\\bottomrule
\\end{tabular}
\\end{table}
";
        let text = ReportFormat::Latex.render(&document());
        assert!(text.starts_with(expected), "{text}");
        assert!(text.contains("d & 1.5 & $-$2 \\\\\n"), "{text}");
        assert_eq!(
            of_latex("\\{~^$#}"),
            "\\textbackslash{}\\{\\textasciitilde{}\\textasciicircum{}\\$\\#\\}"
        );
    }

    #[test]
    fn csv_is_one_table_whose_numbers_are_numbers() {
        let expected = "\
table,model,N °/√h,NEES,NEES 2
rms,a_b|c,12300,,
rms,\"white, \"\"x\"\"\",,,
nees,d,,1.5,-2
";
        assert_eq!(ReportFormat::Csv.render(&document()), expected);
    }

    #[test]
    fn the_extension_decides() {
        let of = |name: &str| ReportFormat::from_path(Path::new(name));
        assert_eq!(of("a"), Some(ReportFormat::Html));
        assert_eq!(of("a.HTM"), Some(ReportFormat::Html));
        assert_eq!(of("a.md"), Some(ReportFormat::Markdown));
        assert_eq!(of("a.tex"), Some(ReportFormat::Latex));
        assert_eq!(of("a.CSV"), Some(ReportFormat::Csv));
        assert_eq!(of("a.pdf"), None);
    }
}
