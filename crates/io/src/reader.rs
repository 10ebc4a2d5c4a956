//! One reader for all kinds of records: inertial samples, fixes, numbers, reference solutions.
//!
//! A kind says what it wants of a table or of a log and what it makes of a row or an entry; the reader
//! does what is the same for all: times that go forward, the span, the counting of what is left out, errors
//! that name the file.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::ReadError;
use crate::clock::{Clock, Tick};
use crate::entry::{Entry, Wanted};
use crate::epoch::Epoch;
use crate::format::Format;
use crate::log::Log;
use crate::opened::{HELD, Memory, Opened};
use crate::skipped::Skipped;
use crate::table::{Table, TableOptions};

/// What a kind wants of its file.
pub enum Want {
    /// Columns of a table.
    Table(TableOptions),
    /// Entries of a log that says itself what it holds.
    Log(Format, Wanted),
    /// Records in memory.
    Records,
}

/// How a file is read for a kind of record.
pub struct Plan<K> {
    /// What is made of its rows.
    pub kind: K,
    /// Where these are.
    pub source: Want,
    /// First and last time \[s\] to give out.
    pub span: Option<(f64, f64)>,
}

/// A row of a table.
#[derive(Clone, Copy)]
pub struct TableRow<'a> {
    /// The numbers in the order in which the columns are wanted.
    pub numbers: &'a [f64],
    /// How many rows are before it, the skipped ones included.
    pub index: u64,
    /// Line or number, the first is 1.
    pub line: u64,
}

/// A row whose time goes forward.
#[derive(Clone, Copy)]
pub struct Row<V> {
    /// \[s\]
    pub time: f64,
    /// Since the row before \[s\]; `None` for the first.
    pub dt: Option<f64>,
    /// Line or number, the first is 1.
    pub line: u64,
    /// What else the row has.
    pub values: V,
}

/// A kind of record.
pub trait Kind: Sized {
    /// Which file has what.
    type Options;
    /// A row without its time.
    type Values: Copy;
    /// What is made of it.
    type Record;
    /// Records in a row that must be earlier than the last accepted one to count as a clock set back.
    const PATIENCE: u32;

    /// What is wanted of a file.
    ///
    /// # Errors
    /// If the options contradict themselves.
    fn plan(options: &Self::Options) -> Result<Plan<Self>, ReadError>;

    /// Time \[s\] and values of a row of a table; what cannot be used is counted.
    fn of_row(&mut self, row: TableRow, skipped: &mut Skipped) -> Option<(f64, Self::Values)>;
    /// Time \[s\] and values of an entry of a log; what cannot be used is counted.
    fn of_entry(&mut self, entry: Entry, skipped: &mut Skipped) -> Option<(f64, Self::Values)>;

    /// The records of this kind that a log in memory has.
    fn held(memory: &Memory) -> Option<Arc<[Self::Record]>>;
    /// Time \[s\] and values of the record in memory of this number, from 1; what cannot be used is counted.
    fn of_record(
        &mut self,
        record: &Self::Record,
        number: u64,
        skipped: &mut Skipped,
    ) -> Option<(f64, Self::Values)>;

    /// Time \[s\] and values of the next row that was kept back until later ones were read; `line` is the last one's.
    ///
    /// # Errors
    /// If the rows before cannot be made into records.
    fn late(
        &mut self,
        _line: u64,
        _skipped: &mut Skipped,
    ) -> Result<Option<(f64, Self::Values)>, ReadError> {
        Ok(None)
    }

    /// Whether the interval of the first row is to be that of the second.
    fn needs_interval(&self) -> bool {
        false
    }

    /// The record of a row inside the span; `None`, counted, where there cannot be one.
    ///
    /// # Errors
    /// If rows like this make the file unusable.
    fn record(
        &mut self,
        row: &Row<Self::Values>,
        skipped: &mut Skipped,
    ) -> Result<Option<Self::Record>, ReadError>;

    /// What the times count from, where columns beside the time's tell it.
    fn epoch(&self) -> Option<Epoch> {
        None
    }

    /// What is wrong with a log that was read to its end.
    ///
    /// # Errors
    /// If something is.
    fn end(&self) -> Result<(), ReadError> {
        Ok(())
    }

    /// That there is no record at all; without a mend it gets what was left out.
    fn nothing(&self, skipped: &Skipped) -> ReadError;
}

/// Boxed: a table holds its place in the file and a row.
enum Input<R> {
    Table(Box<Table>, Vec<f64>),
    Log(Log),
    Records(Held<R>),
}

/// Records in memory, and how many of them were read.
struct Held<R> {
    records: Arc<[R]>,
    read: usize,
    skipped: Skipped,
}

/// Reads records one by one; after an error or the end it gives `None`.
pub struct Reader<K: Kind> {
    name: PathBuf,
    rows: Input<K::Record>,
    kind: K,
    clock: Clock,
    span: Option<(f64, f64)>,
    /// The second row, read for the interval of the first.
    held: Option<Row<K::Values>>,
    /// First and last time of the file up to here \[s\].
    covered: Option<(f64, f64)>,
    /// Records read inside the span, and records given.
    inside: u64,
    given: u64,
    finished: bool,
}

impl<K: Kind> Reader<K> {
    /// Opens a file, plain or gzip; "-" is standard input.
    ///
    /// # Errors
    /// If the file cannot be opened, or as [`Reader::new`].
    pub fn open(path: &Path, options: &K::Options) -> Result<Self, ReadError> {
        Self::new(Opened::open(path)?, options)
    }

    /// Reads what is open.
    ///
    /// # Errors
    /// If it is not of the format, lacks a column or a stream, or the options contradict themselves.
    pub fn new(opened: Opened, options: &K::Options) -> Result<Self, ReadError> {
        let name = opened.name().to_path_buf();
        let patience = opened
            .patience
            .map_or(K::PATIENCE, |few| few.min(K::PATIENCE));
        let plan = K::plan(options).map_err(|error| error.in_log(&name))?;
        let rows = match plan.source {
            Want::Table(wanted) => {
                let row = vec![0.0; wanted.columns.len()];
                Input::Table(Box::new(opened.table(&wanted)?), row)
            }
            Want::Log(format, wanted) => Input::Log(opened.log(format, &wanted)?),
            Want::Records => Input::Records(Held {
                records: (opened.records().and_then(K::held))
                    .ok_or_else(|| ReadError::new(&name, HELD))?,
                read: 0,
                skipped: Skipped::of_samples(),
            }),
        };
        Ok(Self {
            name,
            rows,
            kind: plan.kind,
            clock: Clock::new(patience),
            span: plan.span,
            held: None,
            covered: None,
            inside: 0,
            given: 0,
            finished: false,
        })
    }

    /// What was left out so far.
    pub fn skipped(&self) -> &Skipped {
        match &self.rows {
            Input::Table(table, _) => table.skipped(),
            Input::Log(log) => log.skipped(),
            Input::Records(held) => &held.skipped,
        }
    }

    /// What the file's own times count from, without the offset of the options, as far as the records read
    /// tell it.
    pub fn epoch(&self) -> Option<Epoch> {
        let of_rows = match &self.rows {
            Input::Table(table, _) => table.epoch(),
            Input::Log(log) => log.epoch(),
            Input::Records(_) => None,
        };
        self.kind.epoch().or(of_rows)
    }

    pub(crate) fn kind(&self) -> &K {
        &self.kind
    }

    /// The next row whose time goes forward.
    #[inline]
    fn forward(&mut self) -> Result<Option<Row<K::Values>>, ReadError> {
        loop {
            let (found, line, skipped) = match &mut self.rows {
                Input::Table(table, row) => {
                    let next = table.next_row(row)?;
                    let index = table.rows_seen().saturating_sub(1);
                    let skipped = table.skipped_mut();
                    match next {
                        Some(line) => {
                            let row = TableRow {
                                numbers: row,
                                index,
                                line,
                            };
                            (self.kind.of_row(row, skipped), line, skipped)
                        }
                        None => match self.kind.late(index, skipped)? {
                            None => {
                                self.kind.end()?;
                                return Ok(None);
                            }
                            late => (late, index, skipped),
                        },
                    }
                }
                Input::Log(log) => {
                    let Some(entry) = log.next()? else {
                        self.kind.end()?;
                        return Ok(None);
                    };
                    let line = entry.at;
                    let skipped = log.skipped_mut();
                    (self.kind.of_entry(entry, skipped), line, skipped)
                }
                Input::Records(held) => {
                    let Some(record) = held.records.get(held.read) else {
                        return Ok(None);
                    };
                    held.read += 1;
                    let (number, skipped) = (held.read as u64, &mut held.skipped);
                    (
                        self.kind.of_record(record, number, skipped),
                        number,
                        skipped,
                    )
                }
            };
            let Some((time, values)) = found else {
                continue;
            };
            if let Tick::Forward(dt) = self.clock.tick(time, line, skipped)? {
                return Ok(Some(Row {
                    time,
                    dt,
                    line,
                    values,
                }));
            }
        }
    }

    /// The next record inside the span.
    #[inline]
    fn next_record(&mut self) -> Result<Option<K::Record>, ReadError> {
        loop {
            let next = match self.held.take() {
                Some(held) => Some(held),
                None => self.forward()?,
            };
            let Some(mut row) = next else { break };
            if row.dt.is_none() && self.kind.needs_interval() {
                self.held = self.forward()?;
                row.dt = self.held.and_then(|second| second.dt);
            }
            let start = self.covered.map_or(row.time, |(start, _)| start);
            self.covered = Some((start, row.time));
            if self.span.is_some_and(|(_, to)| row.time > to) {
                break;
            }
            if self.span.is_some_and(|(from, _)| row.time < from) {
                continue;
            }
            self.inside += 1;
            let skipped = match &mut self.rows {
                Input::Table(table, _) => table.skipped_mut(),
                Input::Log(log) => log.skipped_mut(),
                Input::Records(held) => &mut held.skipped,
            };
            if let Some(record) = self.kind.record(&row, skipped)? {
                self.given += 1;
                return Ok(Some(record));
            }
        }
        match (self.span, self.covered) {
            _ if self.given > 0 => Ok(None),
            (Some((from, to)), Some((first, last))) if self.inside == 0 => {
                let problem = if first > to {
                    format!("begins at {first} s, after [span] ends at {to} s")
                } else if last < from {
                    format!("ends at {last} s, before [span] begins at {from} s")
                } else {
                    format!("no record in [span], {from} s to {to} s")
                };
                Err(ReadError::nameless(problem).mend("correct [span]"))
            }
            _ => {
                let mut error = self.kind.nothing(self.skipped());
                if error.mend.is_empty() {
                    error.mend = self.skipped().in_one_line();
                }
                Err(error)
            }
        }
    }
}

impl<K: Kind> Iterator for Reader<K> {
    type Item = Result<K::Record, ReadError>;

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        if self.finished {
            return None;
        }
        let item = self.next_record().map_err(|error| error.in_log(&self.name));
        let item = item.transpose();
        self.finished = !matches!(item, Some(Ok(_)));
        item
    }
}
