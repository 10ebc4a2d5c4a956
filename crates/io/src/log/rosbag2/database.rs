//! The topics and messages of a bag that is a SQLite database.

use std::collections::{HashMap, VecDeque};
use std::ops::Range;

use super::pages::{Bytes, Database, Fault, LeafCell, LeafCells};
use super::row;
use crate::ReadError;
use crate::error::{NAMES_SHOWN, the_file_has};
use crate::log::bytes::{MOST, unpack};
use crate::log::ros::{self, Declared, Encoding, Event, Events};
use crate::skipped::SkipKind;

/// Rows of the schema and of topics are not longer than this \[bytes\].
const LONGEST: u64 = 1 << 20;
/// Topics that are kept at most.
const MAX_TOPICS: usize = 1 << 16;
/// How a frame of zstd begins: messages may be compressed one by one.
const ZSTD_MAGIC: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];

/// A bag being read.
pub(super) struct Bag {
    database: Database,
    columns: Columns,
    /// The number of a topic here and whether its messages are read, by its number in the file.
    topics: HashMap<i64, (u32, bool)>,
    /// What there is to tell before the messages.
    first: VecDeque<Event>,
    rows: LeafCells,
    /// The first page that is not there.
    missing: Option<u32>,
    bytes: Vec<u8>,
}

/// Where in a row of a message is what.
struct Columns {
    id: usize,
    timestamp: usize,
    data: usize,
}

/// A table as the schema describes it.
struct Table {
    root: u32,
    columns: Vec<String>,
}

impl Table {
    fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column == name)
    }
}

impl Bag {
    /// Reads the schema and the topics.
    pub(super) fn open(bytes: Bytes) -> Result<Self, ReadError> {
        let mut database = Database::open(bytes)?;
        let mut tables = HashMap::new();
        let mut bag_damage = None;
        each_row(&mut database, 1, &mut bag_damage, |_, bytes| {
            let is_table = row::text(bytes, 0).is_some_and(|kind| kind == "table");
            let name = row::text(bytes, 1).filter(|_| is_table);
            let root = row::integer(bytes, 3).and_then(|root| u32::try_from(root).ok());
            if let (Some(name), Some(root)) = (name, root) {
                let sql = row::text(bytes, 4).unwrap_or_default();
                let columns = row::columns(&sql);
                tables.insert(name.into_owned(), Table { root, columns });
            }
            tables.len() < MAX_TOPICS
        });
        let (Some(topics), Some(messages)) = (tables.get("topics"), tables.get("messages")) else {
            return Err(no_bag(&tables, bag_damage));
        };
        let place = |table: &Table, name: &str| {
            let missing = || {
                let problem = format!("a ROS 2 bag whose table has no column {name}");
                ReadError::nameless(problem).mend(the_file_has(&table.columns, NAMES_SHOWN))
            };
            table.column(name).ok_or_else(missing)
        };
        let columns = Columns {
            id: place(messages, "topic_id")?,
            timestamp: place(messages, "timestamp")?,
            data: place(messages, "data")?,
        };
        let [name, kind] = [place(topics, "name")?, place(topics, "type")?];
        let format = topics.column("serialization_format");
        let mut bag = Self {
            rows: LeafCells::new(messages.root),
            columns,
            topics: HashMap::new(),
            first: VecDeque::new(),
            missing: None,
            bytes: Vec::new(),
            database,
        };
        let (known, first) = (&mut bag.topics, &mut bag.first);
        each_row(
            &mut bag.database,
            topics.root,
            &mut bag_damage,
            |id, bytes| {
                let (Some(name), Some(type_name)) =
                    (row::text(bytes, name), row::text(bytes, kind))
                else {
                    return true;
                };
                let is_cdr = match format {
                    Some(format) => row::text(bytes, format).is_some_and(|format| format == "cdr"),
                    None => true,
                };
                let number = known.len() as u32;
                known.insert(id, (number, is_cdr && ros::reads(&type_name)));
                first.push_back(Event::Topic(Declared {
                    number,
                    name: name.into_owned(),
                    type_name: type_name.into_owned(),
                    encoding: is_cdr.then_some(Encoding::Cdr),
                }));
                known.len() < MAX_TOPICS
            },
        );
        bag.note(bag_damage);
        Ok(bag)
    }

    /// Counts what is wrong with the tables before that of the messages.
    fn note(&mut self, fault: Option<Fault>) {
        match fault {
            Some(Fault::Missing(page)) => self.missing = Some(page),
            Some(Fault::Damaged(detail)) => {
                self.first
                    .push_back(Event::Skipped(SkipKind::Damaged, detail));
            }
            None => {}
        }
    }

    /// Contents of a row of the messages.
    fn message(&mut self, row: LeafCell) -> Event {
        self.read_message(row).unwrap_or_else(|fault| match fault {
            Fault::Missing(page) => {
                self.missing.get_or_insert(page);
                let detail = format!("a message that continues on page {page}, which is missing");
                Event::Skipped(SkipKind::Damaged, detail)
            }
            Fault::Damaged(detail) => Event::Skipped(SkipKind::Damaged, detail),
        })
    }

    fn read_message(&mut self, row: LeafCell) -> Result<Event, Fault> {
        let damaged = |what: &str| Fault::Damaged(format!("row {}: {what}", row.id));
        self.bytes.clone_from(&row.local);
        // Where the numbers are is usually known before the row goes over to other pages.
        let numbers = |bytes: &[u8]| {
            let topic = row::integer(bytes, self.columns.id)?;
            Some((topic, row::integer(bytes, self.columns.timestamp)?))
        };
        let early = numbers(&self.bytes);
        if early.is_none() {
            self.database.overflow(&row, MOST, &mut self.bytes)?;
        }
        let found = early.or_else(|| numbers(&self.bytes));
        let (topic, time) = found.ok_or_else(|| damaged("no topic or no time"))?;
        let Some(&(number, is_read)) = self.topics.get(&topic) else {
            return Err(damaged(&format!(
                "topic number {topic}, which is not declared"
            )));
        };
        if is_read && early.is_some() {
            self.database.overflow(&row, MOST, &mut self.bytes)?;
        }
        let data = row::field(&self.bytes, self.columns.data);
        let data = data.ok_or_else(|| damaged("no data"))?;
        let mut range = data.start..data.start.saturating_add(data.length);
        let packed = self.bytes.get(range.clone()).unwrap_or_default();
        if is_read && packed.starts_with(&ZSTD_MAGIC) {
            self.bytes = unpack(packed).map_err(|why| damaged(&why))?;
            range = 0..self.bytes.len();
        }
        let nanoseconds = time.rem_euclid(1_000_000_000);
        Ok(Event::Message {
            number,
            time: (time.div_euclid(1_000_000_000), nanoseconds as u32),
            bytes: range,
        })
    }
}

impl Events for Bag {
    fn next(&mut self) -> Result<Option<Event>, ReadError> {
        if let Some(event) = self.first.pop_front() {
            return Ok(Some(event));
        }
        loop {
            match self.rows.next(&mut self.database) {
                Some(Ok(row)) => return Ok(Some(self.message(row))),
                Some(Err(Fault::Damaged(detail))) => {
                    return Ok(Some(Event::Skipped(SkipKind::Damaged, detail)));
                }
                Some(Err(Fault::Missing(page))) => {
                    self.missing.get_or_insert(page);
                }
                None => {
                    return Ok(self.missing.take().map(|page| {
                        let detail = format!("page {page} of the database and others are missing");
                        Event::Skipped(SkipKind::EndsEarly, detail)
                    }));
                }
            }
        }
    }

    fn bytes(&self, range: Range<usize>) -> &[u8] {
        self.bytes.get(range).unwrap_or_default()
    }
}

/// Goes through the rows of a short table, as long as it is wanted; the first fault is kept.
fn each_row(
    database: &mut Database,
    root: u32,
    fault: &mut Option<Fault>,
    mut take: impl FnMut(i64, &[u8]) -> bool,
) {
    let mut rows = LeafCells::new(root);
    while let Some(row) = rows.next(database) {
        let whole = row.and_then(|row| {
            let mut bytes = row.local.clone();
            let rest = database.overflow(&row, LONGEST, &mut bytes);
            rest.map(|()| (row.id, bytes))
        });
        match whole {
            Ok((id, bytes)) if take(id, &bytes) => {}
            Ok(_) => return,
            Err(found) => {
                fault.get_or_insert(found);
            }
        }
    }
}

fn no_bag(tables: &HashMap<String, Table>, damage: Option<Fault>) -> ReadError {
    let problem = "a SQLite database without the tables topics and messages of a ROS 2 bag";
    let mut names: Vec<&String> = tables.keys().collect();
    names.sort();
    let mend = match damage {
        Some(Fault::Missing(page)) => format!("the file breaks off: page {page} is missing"),
        Some(Fault::Damaged(detail)) => format!("it is damaged: {detail}"),
        None if names.is_empty() => "it has no tables".to_owned(),
        None => the_file_has(&names, NAMES_SHOWN),
    };
    ReadError::nameless(problem).mend(mend)
}
