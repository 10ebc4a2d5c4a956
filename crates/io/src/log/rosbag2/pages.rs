//! The pages of a SQLite database and the rows of its tables. "Database File Format",
//! sqlite.org/fileformat2.html, sections 1.3 (header), 1.5 and 1.6 (trees of pages, overflow pages).

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use super::row::varint;
use crate::ReadError;

/// How every database begins.
const MAGIC: &[u8] = b"SQLite format 3\0";
/// Length of the header \[bytes\].
const HEADER: usize = 100;
/// Kinds of pages of tables.
const INTERIOR: u8 = 0x05;
const LEAF: u8 = 0x0d;
/// Deeper than any tree: a page has four children or more, and there are less than 2³² pages.
const MAX_DEPTH: usize = 20;

/// Whether a file that starts so is a SQLite database.
pub(super) fn detect(start: &[u8]) -> bool {
    start.starts_with(MAGIC)
}

/// Where the bytes of a database are.
pub(super) enum Bytes {
    /// In a file; what was read of it is counted from where the counter was.
    File {
        file: File,
        read: Arc<AtomicU64>,
        from: u64,
    },
    Memory(Vec<u8>),
}

impl Bytes {
    fn length(&self) -> u64 {
        match self {
            Self::File { file, .. } => file.metadata().map_or(0, |about| about.len()),
            Self::Memory(bytes) => bytes.len() as u64,
        }
    }

    /// Reads as many bytes as `into` has; `None` if there are fewer.
    fn read(&mut self, start: u64, into: &mut [u8]) -> Option<()> {
        match self {
            Self::File { file, read, from } => {
                file.seek(SeekFrom::Start(start)).ok()?;
                file.read_exact(into).ok()?;
                read.fetch_max(*from + start + into.len() as u64, Relaxed);
            }
            Self::Memory(bytes) => {
                let rest = bytes.get(usize::try_from(start).ok()?..)?;
                into.copy_from_slice(rest.get(..into.len())?);
            }
        }
        Some(())
    }
}

/// A database of which pages are read.
pub(super) struct Database {
    bytes: Bytes,
    /// Length of a page, and of the part of it that is used \[bytes\].
    page_size: usize,
    usable: usize,
    /// Pages that are there as a whole.
    pages: u64,
}

/// What is wrong with a page.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Fault {
    /// The file ends before this page.
    Missing(u32),
    /// It cannot be what it should be.
    Damaged(String),
}

impl Database {
    /// Reads the header.
    pub(super) fn open(mut bytes: Bytes) -> Result<Self, ReadError> {
        let mut header = [0; HEADER];
        let there = bytes.read(0, &mut header).is_some();
        if !there || !detect(&header) {
            return Err(ReadError::nameless("not a SQLite database"));
        }
        let page_size = match u16::from_be_bytes([header[16], header[17]]) {
            1 => 65_536,
            size => usize::from(size),
        };
        let usable = page_size.saturating_sub(usize::from(header[20]));
        if !page_size.is_power_of_two() || page_size < 512 || usable < 480 {
            let problem = format!("damaged SQLite header: pages of {page_size} bytes");
            return Err(ReadError::nameless(problem));
        }
        let encoding = u32::from_be_bytes([header[56], header[57], header[58], header[59]]);
        if encoding > 1 {
            return Err(ReadError::nameless("a SQLite database with UTF-16 text")
                .mend("ROS 2 writes UTF-8: convert it with `ros2 bag convert`"));
        }
        let pages = bytes.length() / page_size as u64;
        Ok(Self {
            bytes,
            page_size,
            usable,
            pages,
        })
    }

    fn page(&mut self, number: u32) -> Result<Vec<u8>, Fault> {
        if number == 0 {
            return Err(Fault::Damaged("a link to page 0".to_owned()));
        }
        if u64::from(number) > self.pages {
            return Err(Fault::Missing(number));
        }
        let mut page = vec![0; self.page_size];
        let start = u64::from(number - 1) * self.page_size as u64;
        let read = self.bytes.read(start, &mut page);
        read.map(|()| page)
            .ok_or_else(|| Fault::Damaged(format!("page {number} cannot be read")))
    }

    /// The rest of a row's bytes, after those on the page of its tree: into the same place.
    pub(super) fn overflow(
        &mut self,
        row: &LeafCell,
        most: u64,
        bytes: &mut Vec<u8>,
    ) -> Result<(), Fault> {
        let Some(mut number) = row.overflow else {
            return Ok(());
        };
        // What cannot be in the file is not there, whatever the row says.
        let all = self.pages.saturating_mul(self.page_size as u64);
        if row.length > most.min(all) {
            let detail = format!("row {} of {} bytes", row.id, row.length);
            return Err(Fault::Damaged(detail));
        }
        while (bytes.len() as u64) < row.length {
            let page = self.page(number)?;
            let (next, content) = page.split_first_chunk().unwrap_or((&[0; 4], &[]));
            let rest = row.length - bytes.len() as u64;
            let here = (rest.min(self.usable as u64 - 4)) as usize;
            bytes.extend_from_slice(content.get(..here).unwrap_or_default());
            number = u32::from_be_bytes(*next);
        }
        Ok(())
    }
}

/// A row as stored in a leaf page of its table.
#[derive(Debug)]
pub(super) struct LeafCell {
    pub(super) id: i64,
    /// Length of its bytes.
    length: u64,
    /// Where those are that stand on the page of its tree.
    pub(super) local: Vec<u8>,
    /// First page of the others.
    overflow: Option<u32>,
}

/// A page of a tree being walked.
struct Node {
    page: Vec<u8>,
    number: u32,
    /// Where its header begins.
    start: usize,
    cells: usize,
    next: usize,
}

impl Node {
    fn byte(&self, at: usize) -> u8 {
        self.page.get(at).copied().unwrap_or_default()
    }

    fn u32(&self, at: usize) -> Option<u32> {
        let bytes = self.page.get(at..)?.first_chunk()?;
        Some(u32::from_be_bytes(*bytes))
    }

    fn is_leaf(&self) -> bool {
        self.byte(self.start) == LEAF
    }

    /// Where the next cell is; `None` after the last.
    fn cell(&mut self) -> Option<usize> {
        if self.next >= self.cells {
            return None;
        }
        let header = if self.is_leaf() { 8 } else { 12 };
        let at = self.start + header + 2 * self.next;
        self.next += 1;
        Some(usize::from(u16::from_be_bytes([
            self.byte(at),
            self.byte(at + 1),
        ])))
    }
}

/// The rows of a table in the order of their numbers. Every page is gone to once, whatever the links say.
pub(super) struct LeafCells {
    /// The next page to go to.
    pending: Option<u32>,
    path: Vec<Node>,
    /// A bit for each page.
    visited: Vec<u64>,
}

impl LeafCells {
    pub(super) fn new(root: u32) -> Self {
        Self {
            pending: Some(root),
            path: Vec::new(),
            visited: Vec::new(),
        }
    }

    /// The next row; after a fault it goes on with the next cell or page.
    pub(super) fn next(&mut self, database: &mut Database) -> Option<Result<LeafCell, Fault>> {
        loop {
            if let Some(number) = self.pending.take() {
                match self.node(database, number) {
                    Ok(node) => self.path.push(node),
                    Err(fault) => return Some(Err(fault)),
                }
            }
            let node = self.path.last_mut()?;
            let Some(at) = node.cell() else {
                let last = node.next == node.cells;
                node.next += 1;
                if last && !node.is_leaf() {
                    // The rightmost child comes after all cells.
                    self.pending = node.u32(node.start + 8);
                } else {
                    self.path.pop();
                }
                continue;
            };
            if node.is_leaf() {
                let number = node.number;
                let row = row(&node.page, at, database.usable);
                let fault = || Fault::Damaged(format!("page {number}: a row that does not fit"));
                return Some(row.ok_or_else(fault));
            }
            self.pending = node.u32(at);
        }
    }

    fn node(&mut self, database: &mut Database, number: u32) -> Result<Node, Fault> {
        let damaged = |what: &str| Fault::Damaged(format!("page {number}: {what}"));
        let page = database.page(number)?;
        let (word, bit) = (number as usize / 64, number % 64);
        if self.visited.len() <= word {
            self.visited.resize(word + 1, 0);
        }
        let visited = self.visited.get_mut(word);
        let first = visited.is_some_and(|bits| {
            let new = *bits & (1 << bit) == 0;
            *bits |= 1 << bit;
            new
        });
        if !first || self.path.len() >= MAX_DEPTH {
            return Err(damaged("linked to twice"));
        }
        let start = if number == 1 { HEADER } else { 0 };
        let mut node = Node {
            page,
            number,
            start,
            cells: 0,
            next: 0,
        };
        if !matches!(node.byte(start), INTERIOR | LEAF) {
            return Err(damaged("not a page of a table"));
        }
        let cells = u16::from_be_bytes([node.byte(start + 3), node.byte(start + 4)]);
        // Each takes two bytes for its place and four for itself.
        node.cells = usize::from(cells).min(database.page_size / 6);
        Ok(node)
    }
}

/// The row whose cell begins at `at`.
fn row(page: &[u8], at: usize, usable: usize) -> Option<LeafCell> {
    let cell = page.get(at..usable)?;
    let (length, rest) = varint(cell)?;
    let (id, rest) = varint(rest)?;
    let most = usable as u64 - 35;
    let here = if length <= most {
        length
    } else {
        let least = (usable as u64 - 12) * 32 / 255 - 23;
        let fitting = least + (length - least) % (usable as u64 - 4);
        if fitting <= most { fitting } else { least }
    };
    let (local, rest) = rest.split_at_checked(usize::try_from(here).ok()?)?;
    let overflow = match here < length {
        true => Some(u32::from_be_bytes(*rest.first_chunk()?)),
        false => None,
    };
    Some(LeafCell {
        id: id.cast_signed(),
        length,
        local: local.to_vec(),
        overflow,
    })
}
