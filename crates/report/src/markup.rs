//! Text in HTML and SVG, and names of files.

use undrift_io::is_hidden;

/// Text escaped for an element or a quoted attribute, without the characters that XML has no place for or that
/// act on the text around them.
pub(crate) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\n' | '\t' => out.push(c),
            '\u{fffe}' | '\u{ffff}' => out.push('\u{fffd}'),
            c if is_hidden(c) => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// A name that can be a file's on every system, whatever stood in it.
pub(crate) fn file_stem(name: &str) -> String {
    let plain = |c: char| {
        if c.is_alphanumeric() || "-_".contains(c) {
            c
        } else {
            '-'
        }
    };
    let stem: String = name.chars().take(100).map(plain).collect();
    let stem = stem.trim_matches('-');
    if stem.is_empty() {
        "unnamed".to_owned()
    } else {
        stem.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_escaped_for_elements_and_attributes() {
        assert_eq!(escape("a<b>&\"c'\n\td"), "a&lt;b&gt;&amp;&quot;c&#39;\n\td");
        // What acts on the text around it, and what XML has no place for.
        for hidden in ['\u{0}', '\u{202e}', '\u{fffe}', '\u{ffff}'] {
            assert_eq!(escape(&format!("a{hidden}b")), "a\u{fffd}b", "{hidden:?}");
        }
    }

    #[test]
    fn a_file_has_a_plain_name() {
        assert_eq!(file_stem("../a b/ü_1-2."), "a-b-ü_1-2");
        assert_eq!([file_stem(""), file_stem("...")], ["unnamed"; 2]);
        assert_eq!(file_stem(&"a".repeat(101)), "a".repeat(100));
    }
}
