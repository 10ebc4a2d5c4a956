//! A report as one HTML file that needs nothing else: no network, no other file. A reader can ask for the background of
//! a map, of pictures by OpenStreetMap.
//!
//! Text and tables are plain HTML, figures SVG that needs no script. The script in the file draws them again from
//! their numbers, to zoom, with [uPlot](https://github.com/leeoniya/uPlot) 1.6.32. A content security policy
//! allows that script and style alone, by their hashes, and pictures of that host where there is such a map.

use super::{
    Block, Document, Figure, Table, data,
    figure::style::style,
    figures,
    markup::{escape, file_stem},
};
use sha2::{Digest, Sha256};
use undrift_results::Usability;

const STYLES: [&str; 2] = [
    include_str!("assets/uPlot.min.css"),
    include_str!("assets/report.css"),
];

const SCRIPTS: [&str; 7] = [
    include_str!("assets/uPlot.iife.min.js"),
    include_str!("assets/shapes.js"),
    include_str!("assets/axes.js"),
    include_str!("assets/gestures.js"),
    include_str!("assets/tiles.js"),
    include_str!("assets/plot.js"),
    include_str!("assets/report.js"),
];

/// Where a reader can ask for the background of a map. The script names it too.
const TILES: &str = " https://tile.openstreetmap.org";

const NOTICE: &str = include_str!("assets/uPlot-LICENSE.txt");

/// The document as one self-contained HTML file.
pub fn render(document: &Document) -> String {
    let (style, script) = (style().css() + &STYLES.concat(), SCRIPTS.join("\n"));
    let mut panels = document.figures().flat_map(|figure| &figure.panels);
    let tiles = if panels.any(|panel| panel.origin.is_some()) {
        TILES
    } else {
        ""
    };
    let policy = format!(
        "default-src 'none'; style-src 'sha256-{}'; script-src 'sha256-{}'; img-src data: blob:{tiles}; \
         base-uri 'none'; form-action 'none'",
        hash(&style),
        hash(&script)
    );
    let title = escape(&document.title);
    let mut contents = String::new();
    let mut main = String::new();
    let mut numbers = Numbers::default();
    for (section, number) in document.sections.iter().zip(1..) {
        let title = escape(&section.title);
        let note = |tag: &str| match section.note.as_str() {
            "" => String::new(),
            note => format!(" {}", element(tag, tag, note)),
        };
        contents += &format!(
            "<li><a href=\"#section-{number}\">{title}</a>{}</li>\n",
            note("small")
        );
        let blocks = section.blocks.iter();
        let blocks: String = blocks.map(|b| self::block(b, &mut numbers)).collect();
        main += &match section.folded {
            // A link into it unfolds it.
            true => format!(
                "<section>\n<details><summary><h2>{title}</h2>{}</summary>\n<a id=\"section-{number}\"></a>\n{blocks}</details></section>\n",
                note("span")
            ),
            false => {
                format!("<section id=\"section-{number}\">\n<h2>{title}</h2>\n{blocks}</section>\n")
            }
        };
    }
    let subtitle = match document.subtitle.as_str() {
        "" => String::new(),
        text => element("p class=\"subtitle\"", "p", text) + "\n",
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

/// An element around a text.
fn element(tag: &str, end: &str, text: &str) -> String {
    format!("<{tag}>{}</{end}>", escape(text))
}

fn block(block: &Block, numbers: &mut Numbers) -> String {
    match block {
        Block::Verdict(usability, text) => {
            let class = match usability {
                Usability::Usable => "verdict",
                Usability::WithCare => "verdict care",
                Usability::NotUsable => "verdict unusable",
            };
            element(&format!("p class=\"{class}\""), "p", text) + "\n"
        }
        Block::Text(text) => element("p", "p", text) + "\n",
        Block::Warning(text) => {
            let text = escape(text);
            format!("<p class=\"warning\"><b>Warning</b>{text}</p>\n")
        }
        Block::Warnings(texts) => {
            let items = texts.iter().map(|text| element("li", "li", text) + "\n");
            let items: String = items.collect();
            format!("<div class=\"warning\"><b>Warnings</b><ul>\n{items}</ul></div>\n")
        }
        Block::Table(table) => {
            numbers.tables += 1;
            self::table(table, numbers.tables)
        }
        Block::Figure(figure) => {
            numbers.figures += 1;
            self::figure(figure, numbers.figures)
        }
    }
}

fn table(table: &Table, number: usize) -> String {
    let columns = table.rows.iter().map(Vec::len).max().unwrap_or(0);
    let columns = 0..columns.max(table.head.len());
    let numeric: Vec<bool> = columns.map(|column| table.is_numeric(column)).collect();
    let class = |column: usize, strong: bool| match (numeric[column], strong) {
        (true, true) => " class=\"number strong\"",
        (true, false) => " class=\"number\"",
        (false, true) => " class=\"strong\"",
        (false, false) => "",
    };
    let heads = table.head.iter().enumerate().map(|(i, head)| {
        let class = class(i, false);
        element(&format!("th scope=\"col\"{class}"), "th", head)
    });
    let heads: String = heads.collect();
    let mut rows = String::new();
    for row in &table.rows {
        rows += "<tr>";
        for (i, cell) in row.iter().enumerate() {
            let minus = if numeric[i] { "−" } else { "-" };
            let text = cell.text.replace('-', minus);
            let text = match &cell.link {
                Some(to) => element(&format!("a href=\"{}\"", escape(to)), "a", &text),
                None => escape(&text),
            };
            rows += &format!("<td{}>{text}</td>", class(i, cell.strong));
        }
        rows += "</tr>\n";
    }
    format!(
        "<figure id=\"table-{number}\" data-table=\"{}\">\n<figcaption class=\"caption\">\
         <span><b>Table {number}.</b>{}</span></figcaption>\n\
         <div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Table {number}\"><table class=\"data\">\n\
         <thead><tr>{heads}</tr></thead>\n<tbody>\n{rows}</tbody></table></div>\n</figure>\n",
        escape(&file_stem(&table.name)),
        escape(&table.caption)
    )
}

fn figure(figure: &Figure, number: usize) -> String {
    let class = match figure.columns {
        0 | 1 => "panels",
        2 => "panels two",
        _ => "panels three",
    };
    let drawing = figures::draw(figure, &format!("figure-{number}"));
    let panels = drawing
        .inline()
        .map(|panel| format!("<div class=\"panel\">{panel}</div>\n"));
    format!(
        "<figure id=\"figure-{number}\">\n<div class=\"{class}\">\n{}</div>\n\
         <figcaption class=\"caption\"><span><b>Figure {number}.</b>{}</span></figcaption>\n\
         </figure>\n",
        panels.collect::<String>(),
        escape(&figure.caption)
    )
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
    use crate::{Cell, Panel, PlotAxis, Section};
    use undrift_nav::earth::Geodetic;

    #[test]
    fn only_files_and_pages_are_linked() {
        let link = |to| Cell::from("log").linked(Some(to)).link;
        for to in ["logs/7.html", "../7 (2).html", "https://a.example/7?x=1:2"] {
            assert_eq!(link(to).as_deref(), Some(to));
        }
        for to in ["javascript:alert(1)", "data:text/html,x", "\tJavaScript:x"] {
            assert_eq!(link(to), None);
        }
    }

    const HOSTILE: &str = "</script><img src=x onerror=alert(1)><!--\"'&";

    #[test]
    fn tables_and_figures_are_counted_each_for_itself() {
        let table = || {
            Block::Table(Table {
                name: "t".into(),
                caption: "of numbers".into(),
                head: vec!["a".into()],
                rows: vec![vec![Cell::from("1")]],
            })
        };
        let figure = || {
            Block::Figure(Figure {
                name: "f".into(),
                caption: "of curves".into(),
                columns: 1,
                panels: Vec::new(),
            })
        };
        let mut numbers = Numbers::default();
        let blocks = [table(), figure(), table(), table(), figure()];
        let texts: Vec<String> = blocks.iter().map(|b| block(b, &mut numbers)).collect();
        let expected = ["Table 1", "Figure 1", "Table 2", "Table 3", "Figure 2"];
        for (text, number) in texts.iter().zip(expected) {
            assert!(text.contains(number), "{number}: {text}");
        }
    }

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
            rows: vec![vec![Cell::from(HOSTILE).linked(Some(HOSTILE))]],
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
                ..Section::default()
            }],
        });
        assert!(!html.contains("<img"));
        assert_eq!(html.matches("</script").count(), 2);
        // The one comment is the notice.
        assert_eq!(html.matches("<!--").count(), 1);
        assert_eq!(html.matches("&lt;img src=x onerror").count(), 12);
    }

    #[test]
    fn tiles_are_allowed_below_a_map_with_a_place_alone() {
        let with = |origin: Option<Geodetic>| {
            let map = Panel::new("", PlotAxis::new(""), PlotAxis::new("")).to_scale();
            let figure = Figure::block("map", "", 1, [map.georeferenced(origin)]);
            render(&Document {
                sections: Section::new("", figure).into_iter().collect(),
                ..Document::default()
            })
        };
        let (without, with) = (
            with(None),
            with(Some(Geodetic::from_degrees(47.5, -8.25, 0.0))),
        );
        assert!(without.contains("img-src data: blob:;"));
        assert!(!without.contains("\"origin\":"));
        assert!(with.contains("img-src data: blob: https://tile.openstreetmap.org;"));
        assert!(with.contains(r#""origin":{"lat_deg":47.5,"lon_deg":-8.25}"#));
        // Nothing else differs.
        let bare = with.replacen(TILES, "", 1);
        let bare = bare.replacen(r#""origin":{"lat_deg":47.5,"lon_deg":-8.25},"#, "", 1);
        assert_eq!(bare, without);
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
    fn numbers_stand_to_the_right_with_a_true_minus() {
        let row = |a: &str, b: &str| vec![Cell::from(a), Cell::from(b).strong_if(b == "2")];
        let html = table(
            &Table {
                name: "t/1".into(),
                caption: "c".into(),
                head: vec!["model-1".into(), "E [m]".into()],
                rows: vec![row("a-b", "-1"), row("c", "2")],
            },
            3,
        );
        assert!(
            html.contains(
                "<th scope=\"col\">model-1</th><th scope=\"col\" class=\"number\">E [m]</th>"
            ),
            "{html}"
        );
        assert!(
            html.contains("<tr><td>a-b</td><td class=\"number\">−1</td></tr>"),
            "{html}"
        );
        assert!(
            html.contains("<tr><td>c</td><td class=\"number strong\">2</td></tr>"),
            "{html}"
        );
        assert!(
            html.contains("<figure id=\"table-3\" data-table=\"t-1\">")
                && html.contains("<b>Table 3.</b>c<"),
            "{html}"
        );
        let text = table(
            &Table {
                rows: vec![vec![Cell::from("x").strong()]],
                ..Table::default()
            },
            1,
        );
        assert!(text.contains("<td class=\"strong\">x</td>"), "{text}");
    }

    #[test]
    fn figures_stand_in_columns_and_sections_fold() {
        let figure = |columns: usize| Figure {
            name: String::new(),
            caption: "c".into(),
            columns,
            panels: vec![Panel::new("", PlotAxis::new(""), PlotAxis::new(""))],
        };
        for (columns, class) in [
            (0, "panels"),
            (1, "panels"),
            (2, "panels two"),
            (3, "panels three"),
            (4, "panels three"),
        ] {
            let html = super::figure(&figure(columns), 2);
            assert!(
                html.contains(&format!(
                    "<div class=\"{class}\">\n<div class=\"panel\"><svg"
                )),
                "{html}"
            );
            assert!(
                html.contains("<figure id=\"figure-2\">") && html.contains("<b>Figure 2.</b>c<"),
                "{html}"
            );
        }
        let section = |title: &str, note: &str| Section {
            title: title.into(),
            blocks: vec![
                Block::Warnings(vec!["a".into(), "b".into()]),
                Block::Verdict(Usability::Usable, "v".into()),
                Block::Verdict(Usability::WithCare, "w".into()),
                Block::Verdict(Usability::NotUsable, "x".into()),
            ],
            note: note.into(),
            folded: false,
        };
        let html = render(&Document {
            title: "t".into(),
            subtitle: "s".into(),
            sections: vec![section("one", ""), section("two", "5 m").folded()],
        });
        for text in [
            "<p class=\"subtitle\">s</p>",
            "<li><a href=\"#section-1\">one</a></li>",
            "<li><a href=\"#section-2\">two</a> <small>5 m</small></li>",
            "<section id=\"section-1\">\n<h2>one</h2>\n<div class=\"warning\"><b>Warnings</b><ul>\n<li>a</li>\n<li>b</li>\n</ul></div>\n<p class=\"verdict\">v</p>\n<p class=\"verdict care\">w</p>\n<p class=\"verdict unusable\">x</p>\n</section>",
            "<details><summary><h2>two</h2> <span>5 m</span></summary>\n<a id=\"section-2\"></a>",
        ] {
            assert!(html.contains(text), "{text}");
        }
    }
}
