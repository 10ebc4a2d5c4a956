//! What a reader that begins again in the middle of a stream needs of its beginning.

use undrift_io::{format::Format, write::mcap::Declarations};

/// The beginning of a stream.
pub(super) enum Head {
    /// Of a table of text, the lines before its first row.
    Text(Header),
    /// Of a stream of MCAP, its channels.
    Mcap(Declarations),
}

impl Head {
    /// That of a log of a format, of a table without one; `None` where messages need nothing before them.
    pub(super) fn new(format: Option<Format>) -> Option<Self> {
        match format {
            None => Some(Self::Text(Header::default())),
            Some(Format::Mcap) => Some(Self::Mcap(Declarations::default())),
            Some(_) => None,
        }
    }

    pub(super) fn add(&mut self, bytes: &[u8]) {
        match self {
            Self::Text(header) => header.add(bytes),
            Self::Mcap(declared) => declared.add(bytes),
        }
    }

    /// What a reader is given first that begins again after these bytes, which were added last: the row or record that they break off
    /// in is whole in it, with what follows.
    pub(super) fn again(&self, bytes: &[u8]) -> Vec<u8> {
        match self {
            Self::Text(header) => {
                let whole = bytes
                    .iter()
                    .position(|byte| *byte == b'\n')
                    .map_or(bytes.len(), |end| end + 1);
                [&header.lines, bytes.get(whole..).unwrap_or_default()].concat()
            }
            Self::Mcap(declared) => declared.again(),
        }
    }
}

/// The lines before the first row.
#[derive(Default)]
pub(super) struct Header {
    lines: Vec<u8>,
    complete: bool,
}

/// Longest header \[bytes\].
const HEADER: usize = 64 * 1024;

impl Header {
    fn add(&mut self, bytes: &[u8]) {
        if self.complete {
            return;
        }
        self.lines.extend_from_slice(bytes);
        let mut end = 0;
        for line in self.lines.split_inclusive(|byte| *byte == b'\n') {
            let is_row = line
                .trim_ascii_start()
                .first()
                .is_some_and(|byte| matches!(byte, b'0'..=b'9' | b'-' | b'+' | b'.'));
            self.complete = is_row || end > HEADER;
            if self.complete || !line.ends_with(b"\n") {
                break;
            }
            end += line.len();
        }
        if self.complete {
            self.lines.truncate(end);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_header_is_what_comes_before_the_first_row() {
        let mut header = Header::default();
        for piece in ["# log", "ger\nt,g", "x\n", "0.1,2\n0.2,3\n"] {
            header.add(piece.as_bytes());
        }
        assert_eq!(header.lines, b"# logger\nt,gx\n");
        let mut header = Header::default();
        header.add(b"0,1\n");
        assert_eq!(header.lines, b"");
    }
}
