//! A report as one HTML file that needs nothing else: no network, no other file.
//!
//! Text and tables are plain HTML, figures SVG that needs no script. The script in the file draws them again from
//! their numbers, to zoom, with [uPlot](https://github.com/leeoniya/uPlot) 1.6.32. A content security policy
//! allows that script and style alone, by their hashes.

use super::{
    Block, Cell, Document, Figure, Section, Table, data, figure::style::style, figures,
    markup::escape, names::file_stem,
};
use sha2::{Digest, Sha256};
use std::fmt::Write;

const STYLES: [&str; 2] = [
    include_str!("assets/uPlot.min.css"),
    include_str!("assets/report.css"),
];

const SCRIPTS: [&str; 4] = [
    include_str!("assets/uPlot.iife.min.js"),
    include_str!("assets/shapes.js"),
    include_str!("assets/plot.js"),
    include_str!("assets/report.js"),
];

const NOTICE: &str = include_str!("assets/uPlot-LICENSE.txt");

/// The document as one self-contained HTML file.
pub fn render(document: &Document) -> String {
    let (style, script) = (style().css() + &STYLES.concat(), SCRIPTS.join("\n"));
    let policy = format!(
        "default-src 'none'; style-src 'sha256-{}'; script-src 'sha256-{}'; img-src data: blob:; \
         base-uri 'none'; form-action 'none'",
        hash(&style),
        hash(&script)
    );
    let title = escape(&document.title);
    let mut contents = String::new();
    let mut main = String::new();
    let mut numbers = Numbers::default();
    for (i, section) in document.sections.iter().enumerate() {
        let number = i + 1;
        push(
            &mut contents,
            format_args!(
                "<li><a href=\"#section-{number}\">{}</a></li>\n",
                escape(&section.title)
            ),
        );
        render_section(&mut main, section, number, &mut numbers);
    }
    let subtitle = if document.subtitle.is_empty() {
        String::new()
    } else {
        format!("<p class=\"subtitle\">{}</p>\n", escape(&document.subtitle))
    };
    format!(
        "<!doctype html>
<html lang=\"en\">
<head>
<meta charset=\"utf-8\">
<meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">
<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">
<title>{title}</title>
<!-- Plots: uPlot 1.6.32, https://github.com/leeoniya/uPlot

{NOTICE}-->
<style>{style}</style>
</head>
<body>
<header>
<h1>{title}</h1>
{subtitle}</header>
<nav aria-label=\"Contents\"><ol>
{contents}</ol></nav>
<main>
{main}</main>
<div id=\"status\" role=\"status\"></div>
<script type=\"application/json\" id=\"data\">{}</script>
<script>{script}</script>
</body>
</html>
",
        data::json(&Vec::from_iter(document.figures()))
    )
}

/// How many tables and figures stood so far.
#[derive(Default)]
struct Numbers {
    tables: usize,
    figures: usize,
}

fn render_section(out: &mut String, section: &Section, number: usize, numbers: &mut Numbers) {
    let title = escape(&section.title);
    push(
        out,
        format_args!("<section id=\"section-{number}\">\n<h2>{title}</h2>\n"),
    );
    for block in &section.blocks {
        match block {
            Block::Text(text) => push(out, format_args!("<p>{}</p>\n", escape(text))),
            Block::Warning(text) => push(
                out,
                format_args!("<p class=\"warning\"><b>Warning</b>{}</p>\n", escape(text)),
            ),
            Block::Warnings(texts) => {
                out.push_str("<div class=\"warning\"><b>Warnings</b><ul>\n");
                for text in texts {
                    push(out, format_args!("<li>{}</li>\n", escape(text)));
                }
                out.push_str("</ul></div>\n");
            }
            Block::Table(table) => {
                numbers.tables += 1;
                render_table(out, table, numbers.tables);
            }
            Block::Figure(figure) => {
                numbers.figures += 1;
                render_figure(out, figure, numbers.figures);
            }
        }
    }
    out.push_str("</section>\n");
}

fn render_table(out: &mut String, table: &Table, number: usize) {
    let columns = table.rows.iter().map(Vec::len).max().unwrap_or(0);
    let numeric: Vec<bool> = (0..columns.max(table.head.len()))
        .map(|column| is_numeric(table, column))
        .collect();
    push(
        out,
        format_args!(
            "<figure id=\"table-{number}\" data-table=\"{}\">\n<figcaption class=\"caption\">\
             <span><b>Table {number}.</b>{}</span></figcaption>\n\
             <div class=\"scroll\" tabindex=\"0\"><table class=\"data\">\n",
            escape(&file_stem(&table.name)),
            escape(&table.caption)
        ),
    );
    let class = |column: usize, strong: bool| match (numeric.get(column) == Some(&true), strong) {
        (true, true) => " class=\"number strong\"",
        (true, false) => " class=\"number\"",
        (false, true) => " class=\"strong\"",
        (false, false) => "",
    };
    out.push_str("<thead><tr>");
    for (i, head) in table.head.iter().enumerate() {
        push(
            out,
            format_args!("<th scope=\"col\"{}>{}</th>", class(i, false), escape(head)),
        );
    }
    out.push_str("</tr></thead>\n<tbody>\n");
    for row in &table.rows {
        out.push_str("<tr>");
        for (i, cell) in row.iter().enumerate() {
            let class = class(i, cell.strong);
            let text = if numeric.get(i) == Some(&true) {
                cell.text.replace('-', "−")
            } else {
                cell.text.clone()
            };
            push(out, format_args!("<td{class}>{}</td>", escape(&text)));
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</tbody></table></div>\n</figure>\n");
}

/// Whether a column holds numbers, be they with a unit, a bound or an interval after them, and gaps at
/// most. The first column names the rows: there a name may begin with a digit.
fn is_numeric(table: &Table, column: usize) -> bool {
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
    let is_gap = |cell: &Cell| matches!(cell.text.as_str(), "" | "–" | "—" | "-" | "not seen");
    let cells = || table.rows.iter().filter_map(|row| row.get(column));
    cells().all(|cell| is_number(cell) || is_gap(cell)) && cells().any(|cell| !cell.text.is_empty())
}

fn render_figure(out: &mut String, figure: &Figure, number: usize) {
    let class = match figure.columns {
        0 | 1 => "panels",
        2 => "panels two",
        _ => "panels three",
    };
    let drawing = figures::of(figure, &format!("figure-{number}"));
    let panels: Vec<String> = drawing
        .inline()
        .map(|panel| format!("<div class=\"panel\">{panel}</div>\n"))
        .collect();
    push(
        out,
        format_args!(
            "<figure id=\"figure-{number}\">\n<div class=\"{class}\">\n{}</div>\n\
             <figcaption class=\"caption\"><span><b>Figure {number}.</b>{}</span></figcaption>\n\
             </figure>\n",
            panels.concat(),
            escape(&figure.caption)
        ),
    );
}

fn push(out: &mut String, text: std::fmt::Arguments) {
    // Writing into a string does not fail.
    let _ = out.write_fmt(text);
}

/// The SHA-256 of a script or style as policies write it.
fn hash(text: &str) -> String {
    base64(&Sha256::digest(text))
}

fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let group = |chunk: &[u8]| {
        let bits = (0..3).fold(0u32, |bits, i| {
            bits << 8 | u32::from(chunk.get(i).copied().unwrap_or(0))
        });
        let letter = |i: usize| {
            if i > chunk.len() {
                return '=';
            }
            char::from(LETTERS[(bits >> (18 - 6 * i)) as usize & 63])
        };
        [0, 1, 2, 3].map(letter)
    };
    bytes.chunks(3).flat_map(group).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOSTILE: &str = "</script><img src=x onerror=alert(1)><!--\"'&";

    #[test]
    fn base64_as_in_rfc_4648() {
        for (plain, coded) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
    }

    #[test]
    fn text_stays_text() {
        let table = Table {
            name: HOSTILE.into(),
            caption: HOSTILE.into(),
            head: vec![HOSTILE.into()],
            rows: vec![vec![HOSTILE.into()]],
        };
        let figure = Figure {
            name: HOSTILE.into(),
            caption: HOSTILE.into(),
            columns: 1,
            panels: Vec::new(),
        };
        let blocks = [
            Block::Text(HOSTILE.into()),
            Block::Warning(HOSTILE.into()),
            Block::Table(table),
            Block::Figure(figure),
        ];
        let html = render(&Document {
            title: HOSTILE.into(),
            subtitle: HOSTILE.into(),
            sections: vec![Section {
                title: HOSTILE.into(),
                blocks: blocks.into(),
            }],
        });
        assert!(!html.contains("<img"));
        assert_eq!(html.matches("</script").count(), 2);
        // The one comment is the notice.
        assert_eq!(html.matches("<!--").count(), 1);
        assert_eq!(html.matches("&lt;img src=x onerror").count(), 11);
    }

    #[test]
    fn the_page_names_no_other_resource() {
        let html = render(&Document::default());
        for marker in [
            " src=",
            "@import",
            "url(http",
            "fetch(",
            "XMLHttpRequest",
            "<link",
        ] {
            assert!(!html.contains(marker), "{marker}");
        }
        assert!(html.contains("default-src 'none'"));
    }

    #[test]
    fn columns_of_numbers_are_told_from_text() {
        let row = |a: &str, b: &str, c: &str| vec![a.into(), b.into(), c.into()];
        let table = Table {
            rows: vec![row("1", "−2.5 %", "–"), row("x", "–", "")],
            ..Table::default()
        };
        // Of gaps alone it was to be one of numbers.
        assert_eq!(
            [0, 1, 2].map(|i| is_numeric(&table, i)),
            [false, true, true]
        );
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
            assert!(is_numeric(&of(text), 1), "{text}");
        }
        for text in ["ARMA(1,1)", "consistent", "3D", "5-state", "inf"] {
            assert!(!is_numeric(&of(text), 1), "{text}");
        }
    }
}
