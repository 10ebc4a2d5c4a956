//! Objects of JSON that are in an array, `[{…}, {…}]`, or one below the other over several lines, as lines of an object each.
//! The array may be a member of an object, `{"data": [{…}, …]}`.

use std::collections::VecDeque;
use std::io::{self, BufRead, BufReader, Read};

use crate::source::{Source, without_byte_order_mark};

/// Whether a text begins with such objects, which are rows of a table; lines of an object each are not meant.
pub(crate) fn are_there(start: &[u8]) -> bool {
    let text = without_byte_order_mark(start).trim_ascii_start();
    let first = text.split(|byte| *byte == b'\n').next();
    let first = first.unwrap_or_default().trim_ascii();
    let is_line = first.starts_with(b"{") && first.ends_with(b"}") && !text.ends_with(first);
    let begins = match text {
        [b'[', rest @ ..] => rest.trim_ascii_start().starts_with(b"{"),
        text => text.starts_with(b"{") && !is_line,
    };
    let mut rows = Vec::new();
    let beginning = Box::new(io::Cursor::new(start.to_vec()));
    begins && lines(beginning, start).read_to_end(&mut rows).is_ok() && super::are_json_lines(&rows)
}

/// A stream that begins so as lines of an object each.
pub(crate) fn lines(source: Source, start: &[u8]) -> Source {
    let text = without_byte_order_mark(start).trim_ascii_start();
    Box::new(BufReader::new(Objects {
        source,
        of_array: text.starts_with(b"[") || is_wrapped(text),
        open: Vec::new(),
        object: 0,
        quotes: Quotes::default(),
        held: VecDeque::new(),
    }))
}

/// Whether the first object has an array of objects in it.
fn is_wrapped(text: &[u8]) -> bool {
    let (mut depth, mut quotes, mut before) = (0_u32, Quotes::default(), b' ');
    for &byte in text {
        match byte {
            _ if quotes.are_around(byte) => {}
            b'{' if before == b'[' => return true,
            b'{' => depth += 1,
            b'}' if depth == 1 => return false,
            b'}' => depth -= 1,
            _ => {}
        }
        if !byte.is_ascii_whitespace() {
            before = byte;
        }
    }
    false
}

/// Whether a byte is in a text of JSON.
#[derive(Default)]
struct Quotes {
    open: bool,
    escaped: bool,
}

impl Quotes {
    /// Of the next byte; the mark that ends a text is of it, that before it is not.
    fn are_around(&mut self, byte: u8) -> bool {
        let around = self.open;
        match byte {
            _ if self.escaped => self.escaped = false,
            b'\\' if around => self.escaped = true,
            b'"' => self.open = !around,
            _ => {}
        }
        around
    }
}

struct Objects {
    source: Source,
    /// Only those in an array are rows.
    of_array: bool,
    /// The brackets that are open around the next object.
    open: Vec<u8>,
    /// Braces that are open in the present object; 0 between objects.
    object: u32,
    quotes: Quotes,
    /// Lines that are ready.
    held: VecDeque<u8>,
}

impl Objects {
    fn byte(&mut self, byte: u8) {
        let quoted = self.quotes.are_around(byte);
        if self.object > 0 {
            match byte {
                b'{' if !quoted => self.object += 1,
                b'}' if !quoted => self.object -= 1,
                _ => {}
            }
            let whitespace = !quoted && byte.is_ascii_whitespace();
            self.held.extend((!whitespace).then_some(byte));
            self.held.extend((self.object == 0).then_some(b'\n'));
            return;
        }
        let is_row = match self.open.last() {
            Some(around) => self.of_array && *around == b'[',
            None => !self.of_array,
        };
        match byte {
            _ if quoted => {}
            b'{' if is_row => {
                self.object = 1;
                self.held.push_back(byte);
            }
            b'{' | b'[' => self.open.push(byte),
            b'}' | b']' => drop(self.open.pop()),
            _ => {}
        }
    }
}

impl Read for Objects {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        while self.held.is_empty() {
            let buffer = self.source.fill_buf()?.to_vec();
            if buffer.is_empty() {
                return Ok(0);
            }
            buffer.iter().for_each(|byte| self.byte(*byte));
            self.source.consume(buffer.len());
        }
        self.held.read(into)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Option<String> {
        if !are_there(text.as_bytes()) {
            return None;
        }
        let source = BufReader::with_capacity(3, io::Cursor::new(text.as_bytes().to_vec()));
        let mut read = String::new();
        let mut lines = lines(Box::new(source), text.as_bytes());
        lines.read_to_string(&mut read).unwrap();
        Some(read)
    }

    #[test]
    fn objects_of_an_array_are_lines() {
        let lines = "{\"a\":1,\"b\":{\"c\":\"x ] } \\\" {\"}}\n{\"a\":2,\"d\":[1,{\"e\":3}]}\n";
        for text in [
            "[{\"a\":1,\"b\":{\"c\":\"x ] } \\\" {\"}},{\"a\":2,\"d\":[1,{\"e\":3}]}]",
            "\u{feff} [\n  {\n \"a\" : 1, \"b\": {\"c\": \"x ] } \\\" {\"}},\r\n {\"a\":2,\n\"d\":[1, {\"e\":3}]}\n]\n",
            "{\n\"name\": \"[{\", \"tags\": [], \"data\": [ {\"a\":1,\"b\":{\"c\":\"x ] } \\\" {\"}},{\"a\":2,\"d\":[1,{\"e\":3}]}]}",
            "{\n\"a\": 1,\n\"b\":{\"c\":\"x ] } \\\" {\"}\n}\n{\n\"a\":2,\"d\":[1,{\"e\":3}]}",
        ] {
            // The last has an array of objects in its second object, not in the first.
            assert_eq!(read(text).as_deref(), Some(lines), "{text}");
        }
        // What is cut ends where it is cut.
        let cut = "[{\"a\":1},{\"a\":2},{\"a\":";
        assert_eq!(read(cut).unwrap(), "{\"a\":1}\n{\"a\":2}\n{\"a\":");
    }

    #[test]
    fn other_texts_stay_as_they_are() {
        for text in [
            "",
            "t,a\n1,2\n",
            "[imu]\nfile = \"a\"\n",
            "[1,2]\n[3,4]\n",
            "{\"t\": [1, 2]}",
            "{\"t\":1}\n{\"t\":2}\n",
            "[{\"t\": 1}]",
        ] {
            assert_eq!(read(text), None, "{text}");
        }
    }
}
