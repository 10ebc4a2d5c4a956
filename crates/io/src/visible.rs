//! Text of unknown origin (names of files, columns, sensors and keys) as terminals and reports may show it.

use std::borrow::Cow;

/// Whether a character acts on a terminal or on the text around it instead of being shown: controls, line and
/// paragraph separators, marks and overrides of the writing direction, invisible format characters.
pub fn is_hidden(c: char) -> bool {
    c.is_control()
        || matches!(
            c,
            '\u{61c}'
                | '\u{180e}'
                | '\u{200b}'
                | '\u{200e}'
                | '\u{200f}'
                | '\u{2028}'..='\u{202e}'
                | '\u{2060}'..='\u{206f}'
                | '\u{feff}'
                | '\u{fff9}'..='\u{fffb}'
                | '\u{e0000}'..='\u{e007f}'
        )
}

/// The text with such characters escaped: `\n`, `\u{1b}`.
pub fn visible(text: &str) -> Cow<'_, str> {
    if !text.chars().any(is_hidden) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        match is_hidden(c) {
            true => out.extend(c.escape_default()),
            false => out.push(c),
        }
    }
    Cow::Owned(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hidden_characters_are_escaped_and_others_kept() {
        for plain in [
            "",
            "imu.csv",
            "größe\u{202f}5 °C",
            "C:\\logs \"a\"",
            "e\u{301}",
            "日本",
        ] {
            assert!(matches!(visible(plain), Cow::Borrowed(same) if same == plain));
        }
        for (text, shown) in [
            ("a\u{1b}[31mb", "a\\u{1b}[31mb"),
            ("a\r\n\tb\0", "a\\r\\n\\tb\\u{0}"),
            ("\u{7}\u{7f}\u{9b}", "\\u{7}\\u{7f}\\u{9b}"),
            ("gnp.\u{202e}vsc\u{2066}", "gnp.\\u{202e}vsc\\u{2066}"),
            ("\u{2028}\u{feff}", "\\u{2028}\\u{feff}"),
        ] {
            assert_eq!(visible(text), shown);
        }
    }
}
