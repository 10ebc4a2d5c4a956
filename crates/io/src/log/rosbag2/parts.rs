//! The files that a bag consists of, read one after the other as one recording.

use std::collections::VecDeque;
use std::io::{BufRead, Cursor, Read};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering::Relaxed;

use super::database::Bag;
use super::pages::{self, Bytes};
use crate::ReadError;
use crate::log::mcap;
use crate::log::ros::{Event, Events};
use crate::skipped::SkipKind;
use crate::source::{self, BytesRead, Source};

/// A database that is compressed or comes from a pipe is held in memory, up to this size \[bytes\].
pub(crate) const MOST_HELD: u64 = 2 << 30;

/// A file of a bag.
pub(crate) enum BagFile {
    File(PathBuf),
    /// What a pipe had, and what it is called.
    Held(PathBuf, Vec<u8>),
}

impl BagFile {
    pub(crate) fn name(&self) -> &Path {
        match self {
            Self::File(path) | Self::Held(path, _) => path,
        }
    }
}

/// The parts of a bag, of which one is open.
pub(super) struct Parts {
    waiting: VecDeque<BagFile>,
    present: Option<Box<dyn Events>>,
    /// Its name.
    name: PathBuf,
    /// Parts that cannot be read, to be counted.
    left_out: VecDeque<Event>,
    /// Parts opened so far, this one included.
    number: u32,
    several: bool,
    read: BytesRead,
    messages: u64,
    /// Messages up to the beginning of this part.
    before: u64,
    /// The first thing that cannot be read.
    damage: Option<String>,
    /// A log of changes beside a database that has not been written back.
    changes: Option<PathBuf>,
}

impl Parts {
    /// Opens the first part that can be read.
    ///
    /// # Errors
    /// If no part is found.
    pub(super) fn open(parts: Vec<BagFile>, read: &BytesRead) -> Result<Self, ReadError> {
        read.restart();
        let mut bag = Self {
            several: parts.len() > 1,
            waiting: parts.into(),
            present: None,
            name: PathBuf::new(),
            left_out: VecDeque::new(),
            number: 0,
            read: read.clone(),
            messages: 0,
            before: 0,
            damage: None,
            changes: None,
        };
        let mut first = None;
        while let Some(turned) = bag.turn() {
            match turned {
                Ok(()) => return Ok(bag),
                Err(error) => {
                    first.get_or_insert(error);
                }
            }
        }
        Err(first.unwrap_or_else(|| ReadError::nameless("a bag without a file")))
    }

    /// What is wrong with this part, with its name where there are others.
    fn skipped(&self, kind: SkipKind, detail: &str) -> Event {
        let file = self.name.file_name().filter(|_| self.several);
        Event::Skipped(
            kind,
            match file {
                Some(file) => format!("{}: {detail}", file.display()),
                None => detail.to_owned(),
            },
        )
    }

    /// Goes to the next part, if there is one; that it cannot be read is counted too.
    fn turn(&mut self) -> Option<Result<(), ReadError>> {
        let part = self.waiting.pop_front()?;
        self.number += 1;
        self.before = self.messages;
        self.name = part.name().to_path_buf();
        let opened = open(part, &self.read).map_err(|error| error.in_log(&self.name));
        let turned = opened.map(|events| self.present = Some(events));
        if let Err(error) = &turned {
            let detail = [error.problem.as_str(), &error.mend].join("; ");
            let detail = detail.trim_end_matches("; ");
            let skipped = self.skipped(SkipKind::Damaged, detail);
            self.left_out.push_back(skipped);
        }
        Some(turned)
    }

    fn no_messages(&self) -> ReadError {
        let error = ReadError::nameless("a ROS 2 bag without messages");
        match (&self.changes, &self.damage) {
            (Some(changes), _) => error.mend(unwritten(changes)),
            (None, Some(damage)) => error.mend(damage.as_str()),
            (None, None) => error,
        }
    }

    /// What there is to tell at the end of this part.
    fn end(&mut self) -> Option<Event> {
        self.present = None;
        let changes = changes_of(&self.name)?;
        let grew = self.messages > self.before;
        let detail = format!("the last messages are in {}, not read", changes.display());
        self.changes = Some(changes);
        grew.then(|| self.skipped(SkipKind::EndsEarly, &detail))
    }
}

impl Events for Parts {
    fn next(&mut self) -> Result<Option<Event>, ReadError> {
        loop {
            if let Some(event) = self.left_out.pop_front() {
                return Ok(Some(event));
            }
            let Some(events) = &mut self.present else {
                match self.turn() {
                    Some(_) => continue,
                    None if self.messages == 0 => return Err(self.no_messages()),
                    None => return Ok(None),
                }
            };
            let next = events.next().map_err(|error| error.in_log(&self.name))?;
            let first = self.number << 16;
            let event = match next {
                // Topics of another part may have the same numbers.
                Some(Event::Topic(mut topic)) => {
                    topic.number = topic.number.wrapping_add(first);
                    Event::Topic(topic)
                }
                Some(Event::Message {
                    number,
                    time,
                    bytes,
                }) => {
                    self.messages += 1;
                    Event::Message {
                        number: number.wrapping_add(first),
                        time,
                        bytes,
                    }
                }
                Some(Event::Skipped(kind, detail)) => {
                    let skipped = self.skipped(kind, &detail);
                    self.damage.get_or_insert(detail);
                    skipped
                }
                None => match self.end() {
                    Some(event) => event,
                    None => continue,
                },
            };
            return Ok(Some(event));
        }
    }

    fn bytes(&self, range: Range<usize>) -> &[u8] {
        self.present
            .as_ref()
            .map_or(&[], |events| events.bytes(range))
    }
}

fn unwritten(changes: &Path) -> String {
    let name = changes.display();
    format!(
        "the recorder was stopped before it wrote {name} back: open the bag once with ROS 2 or sqlite3, which does that"
    )
}

/// The log of changes that a recorder which was stopped leaves beside its database.
fn changes_of(path: &Path) -> Option<PathBuf> {
    let mut name = path.as_os_str().to_owned();
    name.push("-wal");
    let path = PathBuf::from(name);
    let is_there = std::fs::metadata(&path).is_ok_and(|about| about.len() > 0);
    is_there.then_some(path)
}

/// Opens a part by its content.
fn open(part: BagFile, read: &BytesRead) -> Result<Box<dyn Events>, ReadError> {
    match part {
        BagFile::File(path) => of_file(&path, read).map_err(|error| match changes_of(&path) {
            Some(changes) => error.mend(unwritten(&changes)),
            None => error,
        }),
        BagFile::Held(_, bytes) => of_bytes(bytes),
    }
}

fn of_file(path: &Path, read: &BytesRead) -> Result<Box<dyn Events>, ReadError> {
    let from = read.bytes().load(Relaxed);
    let (mut source, compressed) = source::decompressed(path, source::file(path)?, read)?;
    if !is_database(&mut source)? {
        return mcap(source);
    }
    let bytes = if compressed {
        held(source)?
    } else {
        Bytes::File {
            file: source::file(path)?,
            read: read.bytes(),
            from,
        }
    };
    Ok(Box::new(Bag::open(bytes)?))
}

fn of_bytes(bytes: Vec<u8>) -> Result<Box<dyn Events>, ReadError> {
    if pages::detect(&bytes) {
        return Ok(Box::new(Bag::open(Bytes::Memory(bytes))?));
    }
    mcap(Box::new(Cursor::new(bytes)))
}

fn is_database(source: &mut Source) -> Result<bool, ReadError> {
    let start = source.fill_buf();
    let start = start.map_err(|error| ReadError::nameless(format!("cannot be read: {error}")))?;
    if start.is_empty() {
        return Err(ReadError::nameless("is empty"));
    }
    if !pages::detect(start) && !mcap::detect(start) {
        let problem = "neither SQLite nor MCAP, which ROS 2 bags consist of";
        return Err(ReadError::nameless(problem));
    }
    Ok(pages::detect(start))
}

fn mcap(source: Source) -> Result<Box<dyn Events>, ReadError> {
    Ok(Box::new(mcap::open(source)?))
}

/// A database in memory, as far as it can be decompressed.
fn held(source: Source) -> Result<Bytes, ReadError> {
    let mut bytes = Vec::new();
    // Pages after a damage are missing, which is counted.
    let _ = source.take(MOST_HELD + 1).read_to_end(&mut bytes);
    if bytes.len() as u64 > MOST_HELD {
        return Err(too_large());
    }
    Ok(Bytes::Memory(bytes))
}

/// That a database is too large to be held in memory.
pub(crate) fn too_large() -> ReadError {
    let gigabytes = MOST_HELD >> 30;
    let problem = format!("a compressed SQLite database of more than {gigabytes} GiB");
    ReadError::nameless(problem).mend("decompress it to a file first: it is not read in one pass")
}
