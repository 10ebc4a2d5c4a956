//! A reader of logs that reads while its bytes come: on a thread of its own that runs only while it is handed bytes.

use std::{
    io::{self, Read},
    sync::mpsc::{Receiver, Sender, channel},
    thread,
};
use undrift_io::{Opened, ReadError};

/// What the reader's thread says.
enum Said<T> {
    Record(T),
    /// All bytes are read.
    Hungry,
    /// It ended, and why.
    Ended(Option<ReadError>),
}

/// Records of bytes that come in pieces of any size. The same bytes give the same records, whatever the pieces; only when
/// they are given follows from those.
pub(crate) struct Stream<T> {
    bytes: Sender<Vec<u8>>,
    said: Receiver<Said<T>>,
    ended: bool,
}

/// Gives what comes, a piece at a time.
struct Pieces<T> {
    bytes: Receiver<Vec<u8>>,
    said: Sender<Said<T>>,
    piece: Vec<u8>,
    at: usize,
}

impl<T> Read for Pieces<T> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        while self.at == self.piece.len() {
            // Of a session that is gone, nothing more comes.
            if self.said.send(Said::Hungry).is_err() {
                return Ok(0);
            }
            let Ok(piece) = self.bytes.recv() else {
                return Ok(0);
            };
            (self.piece, self.at) = (piece, 0);
        }
        let left = self.piece.get(self.at..).unwrap_or_default();
        let n = left.len().min(buffer.len());
        if let (Some(into), Some(from)) = (buffer.get_mut(..n), left.get(..n)) {
            into.copy_from_slice(from);
        }
        self.at += n;
        Ok(n)
    }
}

impl<T: Send + 'static> Stream<T> {
    /// A reader of the source `name`, which begins as `beginning` does; `read` makes its records of what is open.
    pub(crate) fn new<I>(
        name: String,
        beginning: Vec<u8>,
        read: impl FnOnce(Opened) -> Result<I, ReadError> + Send + 'static,
    ) -> Self
    where
        I: Iterator<Item = Result<T, ReadError>>,
    {
        let (bytes, pieces) = channel();
        let (say, said) = channel();
        let source = Pieces {
            bytes: pieces,
            said: say.clone(),
            piece: Vec::new(),
            at: 0,
        };
        thread::spawn(move || {
            let opened = Opened::live(name.as_ref(), &beginning, source);
            let why = match opened.and_then(read) {
                Ok(records) => records
                    .map(|record| record.map(|record| say.send(Said::Record(record))))
                    .find_map(Result::err),
                Err(error) => Some(error),
            };
            // Whoever listened may be gone.
            let _ = say.send(Said::Ended(why));
        });
        let mut this = Self {
            bytes,
            said,
            ended: false,
        };
        // Up to where it wants the first bytes.
        this.listen(&mut |_| {});
        this
    }

    /// Hands over bytes and gives each record that they complete to `take`; why the reader ended, if it did.
    pub(crate) fn feed(
        &mut self,
        bytes: &[u8],
        take: &mut dyn FnMut(T),
    ) -> Option<Option<ReadError>> {
        if self.ended || bytes.is_empty() || self.bytes.send(bytes.to_vec()).is_err() {
            return None;
        }
        self.listen(take)
    }

    fn listen(&mut self, take: &mut dyn FnMut(T)) -> Option<Option<ReadError>> {
        loop {
            match self.said.recv() {
                Ok(Said::Record(record)) => take(record),
                Ok(Said::Hungry) => return None,
                Ok(Said::Ended(why)) => {
                    self.ended = true;
                    return Some(why);
                }
                Err(_) => {
                    self.ended = true;
                    return Some(None);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_io::table::{Column, TableOptions};

    /// The second column of a table, with the number of the piece that gave it.
    fn numbers(pieces: &[&[u8]]) -> Vec<(usize, f64)> {
        let columns = ["t", "v"].map(|name| (name.into(), Column::Name(name.into())));
        let options = TableOptions {
            columns: columns.into(),
            ..TableOptions::default()
        };
        let mut stream = Stream::new("speeds".into(), b"t,v,w\n0,1,1\n".to_vec(), move |opened| {
            let (mut table, mut row) = (opened.table(&options)?, [0.0; 2]);
            Ok(std::iter::from_fn(move || {
                let next = table.next_row(&mut row).transpose()?;
                Some(next.map(|_| row[1]))
            }))
        });
        let mut all = Vec::new();
        for (k, piece) in pieces.iter().enumerate() {
            assert!(
                stream
                    .feed(piece, &mut |value| all.push((k, value)))
                    .is_none()
            );
        }
        all
    }

    #[test]
    fn a_record_is_given_with_the_piece_that_completes_it() {
        let all = numbers(&[b"t,v,w\n0", b",1,7\n1,2,7\n", b"2,", b"3", b",7\n"]);
        assert_eq!(all, [(1, 1.0), (1, 2.0), (4, 3.0)]);
    }
}
