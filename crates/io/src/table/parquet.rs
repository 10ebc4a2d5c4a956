//! Tables in Apache Parquet: the wanted columns as numbers, row by row. One batch of rows is held at a
//! time.
//!
//! Columns are the leaves of the schema; those of a group are called `group.leaf`. Integers, floats,
//! doubles and booleans are read. A timestamp, date or time is the number that is stored, in its own
//! unit: a scale of the time column has to make seconds of it. A decimal is scaled. Null is an empty
//! field.

mod headers;
#[cfg(test)]
mod tests;
#[cfg(any(test, target_family = "wasm"))]
mod zstd_pages;

use std::fs::File;
use std::io::Read;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use parquet::basic::{ConvertedType, LogicalType, Type};
#[cfg(any(test, target_family = "wasm"))]
use parquet::column::reader::get_column_reader;
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::metadata::ColumnChunkMetaData;
use parquet::file::reader::{ChunkReader, FileReader, Length, SerializedFileReader};
use parquet::schema::types::ColumnDescriptor;

use super::header::places;
use super::wanted::{Keep, NextRow, Preview, TableOptions, fill};
use crate::ReadError;

/// Rows that are read at once.
const BATCH: usize = 4096;

/// The whole of a table: Parquet is read from its end. Clones share it.
#[derive(Clone)]
pub(crate) enum Bytes {
    File(Arc<File>),
    Memory(bytes::Bytes),
}

impl Length for Bytes {
    fn len(&self) -> u64 {
        match self {
            Self::File(file) => Length::len(file.as_ref()),
            Self::Memory(bytes) => bytes.len() as u64,
        }
    }
}

impl ChunkReader for Bytes {
    type T = Box<dyn Read>;

    fn get_read(&self, start: u64) -> Result<Self::T, ParquetError> {
        Ok(match self {
            #[cfg(not(target_family = "wasm"))]
            Self::File(file) => Box::new(file.get_read(start)?),
            #[cfg(target_family = "wasm")]
            Self::File(file) => Box::new(FileFrom {
                file: file.clone(),
                at: start,
            }),
            Self::Memory(bytes) => Box::new(bytes.get_read(start)?),
        })
    }

    fn get_bytes(&self, start: u64, length: usize) -> Result<bytes::Bytes, ParquetError> {
        match self {
            #[cfg(not(target_family = "wasm"))]
            Self::File(file) => file.get_bytes(start, length),
            #[cfg(target_family = "wasm")]
            Self::File(_) => {
                let mut part = Vec::new();
                let read = self.get_read(start)?.take(length as u64);
                match std::io::BufReader::new(read).read_to_end(&mut part)? {
                    n if n == length => Ok(part.into()),
                    _ => Err(ParquetError::EOF(
                        "the file is shorter than it states".into(),
                    )),
                }
            }
            Self::Memory(bytes) => bytes.get_bytes(start, length),
        }
    }
}

/// A file from a place on. WebAssembly cannot open a descriptor once more, and has a single thread that reads.
#[cfg(target_family = "wasm")]
struct FileFrom {
    file: Arc<File>,
    at: u64,
}

#[cfg(target_family = "wasm")]
impl Read for FileFrom {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        use std::io::{Seek, SeekFrom};
        let mut file = self.file.as_ref();
        file.seek(SeekFrom::Start(self.at))?;
        let n = file.read(buffer)?;
        self.at += n as u64;
        Ok(n)
    }
}

/// The names of the columns and up to `rows` rows of those with numbers, NaN in the others.
///
/// # Errors
/// If the file is no Parquet, or has no usable row.
pub(super) fn preview(bytes: Bytes, rows: usize) -> Result<Preview, ReadError> {
    let reader = open(bytes.clone())?;
    let names = names(&reader);
    let schema = reader.metadata().file_metadata().schema_descr_ptr();
    let columns: Vec<WantedColumn> = (0..names.len())
        .filter_map(|index| WantedColumn::new(&schema.column(index), index, index).ok())
        .collect();
    let mut preview = Preview {
        header: names.clone(),
        names,
        rows: Vec::new(),
        ..Preview::default()
    };
    if columns.is_empty() {
        return Ok(preview);
    }
    let mut table = ParquetTable::from_reader(bytes, reader, columns);
    let mut row = vec![f64::NAN; preview.names.len()];
    while preview.rows.len() < rows
        && let NextRow::Row(..) = table.step(Keep::All, &mut row)
    {
        preview.rows.push(row.clone());
    }
    Ok(preview)
}

/// Reads the wanted columns of a Parquet file row by row.
pub(super) struct ParquetTable {
    bytes: Bytes,
    reader: SerializedFileReader<Bytes>,
    /// The next row group.
    group: usize,
    columns: Vec<WantedColumn>,
    /// Rows of the batch, and how many of them have been handed out.
    rows: usize,
    given: usize,
    seen: u64,
    finished: bool,
}

/// A wanted column.
struct WantedColumn {
    index: usize,
    slot: usize,
    scale: f64,
    unsigned: bool,
    /// Definition level of a number; below it is null.
    deepest: i16,
    /// Of the row group being read.
    reader: Option<ColumnReader>,
    batch: Vec<Option<f64>>,
}

impl ParquetTable {
    /// Finds the wanted columns; the delimiter of the options does not matter.
    ///
    /// # Errors
    /// If it is no Parquet, or lacks a wanted column, or that holds no numbers.
    pub(super) fn new(bytes: Bytes, options: &TableOptions) -> Result<Self, ReadError> {
        let reader = open(bytes.clone())?;
        let schema = reader.metadata().file_metadata().schema_descr_ptr();
        let names = names(&reader);
        let mut columns = Vec::new();
        for (index, slot) in places(Some(&names), options)? {
            let column = WantedColumn::new(&schema.column(index), index, slot);
            columns.push(column.map_err(|what| {
                let key = options.columns.get(slot).map_or("", |(key, _)| key);
                let name = names.get(index).map_or("", String::as_str);
                ReadError::nameless(format!("column \"{name}\" holds {what}")).key(key)
            })?);
        }
        Ok(Self::from_reader(bytes, reader, columns))
    }

    fn from_reader(
        bytes: Bytes,
        reader: SerializedFileReader<Bytes>,
        columns: Vec<WantedColumn>,
    ) -> Self {
        Self {
            bytes,
            reader,
            group: 0,
            columns,
            rows: 0,
            given: 0,
            seen: 0,
            finished: false,
        }
    }

    /// Reads the next row into `out`, in the order of the wanted columns; its number, the first is 1. What is
    /// damaged ends the table.
    pub(super) fn step(&mut self, keep: Keep, out: &mut [f64]) -> NextRow {
        if self.given == self.rows && !self.finished {
            match guarded(|| self.fill()) {
                Ok(0) => self.finished = true,
                Ok(rows) => (self.rows, self.given) = (rows, 0),
                Err(error) => {
                    self.finished = true;
                    return NextRow::End(Some((self.seen, error.to_string())));
                }
            }
        }
        if self.finished {
            return NextRow::End(None);
        }
        let row = self.given;
        self.given += 1;
        self.seen += 1;
        let number = |of: &WantedColumn| (of.slot, of.index, of.batch.get(row).copied().flatten());
        let filled = fill(out, keep, self.columns.iter().map(number));
        NextRow::Row(self.seen, filled)
    }

    /// Reads a batch of every column; the number of rows, 0 at the end.
    fn fill(&mut self) -> Result<usize, ParquetError> {
        loop {
            let mut lengths = Vec::with_capacity(self.columns.len());
            for wanted in &mut self.columns {
                lengths.push(wanted.fill()?);
            }
            let rows = lengths.first().copied().unwrap_or(0);
            if lengths.iter().any(|length| *length != rows) {
                let problem = "columns of different lengths".to_owned();
                return Err(ParquetError::General(problem));
            }
            if rows > 0 {
                return Ok(rows);
            }
            if self.group >= self.reader.num_row_groups() {
                return Ok(0);
            }
            let group = self.reader.get_row_group(self.group)?;
            self.group += 1;
            for wanted in &mut self.columns {
                let (start, length) = group.metadata().column(wanted.index).byte_range();
                if !headers::pages_are_sound(&self.bytes, start, start.saturating_add(length))? {
                    let problem = "a header of a page is damaged".to_owned();
                    return Err(ParquetError::General(problem));
                }
                #[cfg(any(test, target_family = "wasm"))]
                if zstd_pages::has_them(group.metadata().column(wanted.index)) {
                    let column = group.metadata().column(wanted.index);
                    let rows = usize::try_from(group.metadata().num_rows())?;
                    let pages = zstd_pages::ZstdPages::new(self.bytes.clone(), column, rows)?;
                    let pages = Box::new(pages);
                    wanted.reader = Some(get_column_reader(column.column_descr_ptr(), pages));
                    continue;
                }
                wanted.reader = Some(group.get_column_reader(wanted.index)?);
            }
        }
    }
}

impl WantedColumn {
    /// A column of numbers; `Err` says what else it holds.
    fn new(column: &ColumnDescriptor, index: usize, slot: usize) -> Result<Self, &'static str> {
        if column.max_rep_level() > 0 {
            return Err("lists");
        }
        match column.physical_type() {
            Type::BOOLEAN | Type::INT32 | Type::INT64 | Type::FLOAT | Type::DOUBLE => {}
            Type::INT96 => return Err("timestamps of 96 bits"),
            Type::BYTE_ARRAY | Type::FIXED_LEN_BYTE_ARRAY => return Err("text or bytes"),
        }
        let unsigned = match column.logical_type_ref() {
            Some(LogicalType::Integer(integer)) => !integer.is_signed,
            _ => matches!(
                column.converted_type(),
                ConvertedType::UINT_8
                    | ConvertedType::UINT_16
                    | ConvertedType::UINT_32
                    | ConvertedType::UINT_64
            ),
        };
        let scale = match column.converted_type() {
            ConvertedType::DECIMAL => 0.1f64.powi(column.type_scale()),
            _ => 1.0,
        };
        Ok(Self {
            index,
            slot,
            scale,
            unsigned,
            deepest: column.max_def_level(),
            reader: None,
            batch: Vec::new(),
        })
    }

    /// Reads a batch; the number of rows, 0 at the end of the row group.
    fn fill(&mut self) -> Result<usize, ParquetError> {
        let (unsigned, deepest) = (self.unsigned, self.deepest);
        let out = &mut self.batch;
        match &mut self.reader {
            None => out.clear(),
            Some(ColumnReader::BoolColumnReader(r)) => {
                read(r, out, deepest, |v| f64::from(u8::from(v)))?
            }
            Some(ColumnReader::Int32ColumnReader(r)) if unsigned => {
                read(r, out, deepest, |v| f64::from(v.cast_unsigned()))?;
            }
            Some(ColumnReader::Int32ColumnReader(r)) => read(r, out, deepest, f64::from)?,
            Some(ColumnReader::Int64ColumnReader(r)) if unsigned => {
                read(r, out, deepest, |v| v.cast_unsigned() as f64)?;
            }
            Some(ColumnReader::Int64ColumnReader(r)) => read(r, out, deepest, |v| v as f64)?,
            Some(ColumnReader::FloatColumnReader(r)) => read(r, out, deepest, f64::from)?,
            Some(ColumnReader::DoubleColumnReader(r)) => read(r, out, deepest, |v| v)?,
            Some(_) => return Err(ParquetError::General("no column of numbers".into())),
        }
        if self.scale != 1.0 {
            for value in out.iter_mut().flatten() {
                *value *= self.scale;
            }
        }
        Ok(out.len())
    }
}

fn read<T: DataType>(
    reader: &mut ColumnReaderImpl<T>,
    out: &mut Vec<Option<f64>>,
    deepest: i16,
    number: impl Fn(T::T) -> f64,
) -> Result<(), ParquetError> {
    out.clear();
    let (mut values, mut levels) = (Vec::new(), Vec::new());
    let (rows, _, _) = reader.read_records(BATCH, Some(&mut levels), None, &mut values)?;
    let mut values = values.into_iter().map(number);
    if deepest == 0 {
        out.extend(values.map(Some));
    } else {
        let number = |level| {
            if level == deepest {
                values.next()
            } else {
                None
            }
        };
        out.extend(levels.into_iter().map(number));
    }
    out.truncate(rows);
    Ok(())
}

fn open(bytes: Bytes) -> Result<SerializedFileReader<Bytes>, ReadError> {
    let length = bytes.len();
    let unreadable =
        |error| ReadError::nameless(format!("is not a readable Parquet file: {error}"));
    if !headers::footer_is_sound(&bytes).is_ok_and(|sound| sound) {
        return Err(unreadable(ParquetError::General(
            "the footer is damaged".into(),
        )));
    }
    let reader = guarded(|| SerializedFileReader::new(bytes)).map_err(unreadable)?;
    let groups = reader.metadata().row_groups().iter();
    let mut chunks = groups.flat_map(|group| group.columns());
    if !chunks.all(|chunk| is_inside(chunk, length)) {
        return Err(ReadError::nameless(
            "has columns beyond the end of the file",
        ));
    }
    Ok(reader)
}

/// Whether a column of a row group is where the file has bytes: the crate trusts in that.
fn is_inside(chunk: &ColumnChunkMetaData, length: u64) -> bool {
    let start = chunk
        .dictionary_page_offset()
        .unwrap_or_else(|| chunk.data_page_offset());
    let end = start.checked_add(chunk.compressed_size());
    let end = end.and_then(|end| u64::try_from(end).ok());
    start >= 0
        && chunk.compressed_size() >= 0
        && chunk.num_values() >= 0
        && end.is_some_and(|end| end <= length)
}

/// Damaged files can make the crate panic: that is an error like any other.
fn guarded<T>(read: impl FnOnce() -> Result<T, ParquetError>) -> Result<T, ParquetError> {
    catch_unwind(AssertUnwindSafe(read)).unwrap_or_else(|_| {
        let problem = "the file is damaged".to_owned();
        Err(ParquetError::General(problem))
    })
}

fn names(reader: &SerializedFileReader<Bytes>) -> Vec<String> {
    let schema = reader.metadata().file_metadata().schema_descr();
    let columns = schema.columns().iter();
    columns.map(|column| column.path().string()).collect()
}
