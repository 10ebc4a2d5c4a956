//! Tables in Apache Parquet, read as [`crate::table::Table`] reads delimited text: the wanted columns
//! as numbers, row by row. One batch of rows is held at a time.
//!
//! Columns are the leaves of the schema; those of a group are called `group.leaf`. Integers, floats,
//! doubles and booleans are read. A timestamp, date or time is the number that is stored, in its own
//! unit: a scale of the time column has to make seconds of it. A decimal is scaled. Null is an empty
//! field.

mod headers;
#[cfg(test)]
mod tests;

use std::fs::File;
use std::io::Read;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use parquet::basic::{ConvertedType, LogicalType, Type};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::metadata::ColumnChunkMetaData;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::schema::types::ColumnDescriptor;

use crate::ReadError;
use crate::skipped::{SkipKind, Skipped};
use crate::table::{Column, Defect, Preview, TableOptions, is_parquet, no_rows, places};

/// First and last bytes of a file.
const MAGIC: &[u8] = b"PAR1";
const GZIP_MAGIC: &[u8] = &[0x1f, 0x8b];
/// Rows that are read at once.
const BATCH: usize = 4096;

/// Names of the columns in their order.
///
/// # Errors
/// If the file cannot be opened or is no Parquet.
pub fn column_names(path: &Path) -> Result<Vec<String>, ReadError> {
    Ok(names(&open(path)?))
}

/// The names of the columns and up to `rows` rows of those with numbers, NaN in the others.
///
/// # Errors
/// If the file cannot be opened, is no Parquet, or has no usable row.
pub(crate) fn preview(path: &Path, rows: usize) -> Result<Preview, ReadError> {
    let reader = open(path)?;
    let names = names(&reader);
    let schema = reader.metadata().file_metadata().schema_descr_ptr();
    let numbers: Vec<usize> = (0..names.len())
        .filter(|&index| conversion(&schema.column(index)).is_ok())
        .collect();
    let options = TableOptions {
        columns: numbers
            .iter()
            .map(|index| (String::new(), Column::Number(index + 1)))
            .collect(),
        keep_not_finite: true,
        ..TableOptions::default()
    };
    let mut table = ParquetTable::open(path, &options)?;
    let mut row = vec![f64::NAN; numbers.len()];
    let mut preview = Preview {
        names,
        rows: Vec::new(),
    };
    while preview.rows.len() < rows && table.next_row(&mut row)?.is_some() {
        let mut whole = vec![f64::NAN; preview.names.len()];
        for (index, value) in numbers.iter().zip(&row) {
            if let Some(place) = whole.get_mut(*index) {
                *place = *value;
            }
        }
        preview.rows.push(whole);
    }
    Ok(preview)
}

/// Reads the wanted columns of a Parquet file row by row.
pub struct ParquetTable {
    path: PathBuf,
    reader: SerializedFileReader<File>,
    /// The next row group.
    group: usize,
    columns: Vec<Wanted>,
    /// Rows of the batch, and how many of them have been handed out.
    rows: usize,
    given: usize,
    width: usize,
    keep_not_finite: bool,
    rows_read: u64,
    rows_seen: u64,
    finished: bool,
    skipped: Skipped,
}

/// A wanted column.
struct Wanted {
    index: usize,
    slot: usize,
    scale: f64,
    unsigned: bool,
    /// Definition level of a number; below it stands null.
    deepest: i16,
    /// Of the row group being read.
    reader: Option<ColumnReader>,
    batch: Vec<Option<f64>>,
}

impl ParquetTable {
    /// Opens a file and finds the wanted columns; the delimiter of the options does not matter.
    ///
    /// # Errors
    /// If the file cannot be opened, is no Parquet or compressed as a whole, or lacks a wanted column,
    /// or that holds no numbers.
    pub fn open(path: &Path, options: &TableOptions) -> Result<Self, ReadError> {
        let reader = open(path)?;
        let schema = reader.metadata().file_metadata().schema_descr_ptr();
        let names = names(&reader);
        let mut columns = Vec::new();
        for (index, slot) in places(path, &names, options)? {
            let key = options.columns.get(slot).map_or("", |(key, _)| key);
            let problem = |what: &str| {
                let name = names.get(index).map_or("", String::as_str);
                ReadError::new(path, format!("column \"{name}\" holds {what}")).key(key)
            };
            let (scale, unsigned) = conversion(&schema.column(index)).map_err(problem)?;
            let deepest = schema.column(index).max_def_level();
            columns.push(Wanted {
                index,
                slot,
                scale,
                unsigned,
                deepest,
                reader: None,
                batch: Vec::new(),
            });
        }
        Ok(Self {
            path: path.to_path_buf(),
            reader,
            group: 0,
            columns,
            rows: 0,
            given: 0,
            width: options.columns.len(),
            keep_not_finite: options.keep_not_finite,
            rows_read: 0,
            rows_seen: 0,
            finished: false,
            skipped: Skipped::default(),
        })
    }

    /// Reads the next usable row into `out`, in the order of the wanted columns, and gives its
    /// number, the first is 1; `None` at the end.
    ///
    /// # Errors
    /// If the file ends without one usable row, or `out` has another length than there are wanted
    /// columns.
    pub fn next_row(&mut self, out: &mut [f64]) -> Result<Option<u64>, ReadError> {
        if out.len() != self.width {
            let problem = format!("{} places for {} columns", out.len(), self.width);
            return Err(ReadError::new(&self.path, problem));
        }
        while !self.finished {
            if self.given == self.rows && !self.next_batch()? {
                break;
            }
            let row = self.given;
            self.given += 1;
            self.rows_seen += 1;
            match self.read(row, out) {
                Ok(()) => {
                    self.rows_read += 1;
                    return Ok(Some(self.rows_seen));
                }
                Err(defect) => self.skipped.add(defect.kind(), self.rows_seen, &defect),
            }
        }
        Ok(None)
    }

    /// What was left out so far.
    pub fn skipped(&self) -> &Skipped {
        &self.skipped
    }

    /// The file as it was given.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Rows met so far, the skipped ones included.
    pub fn rows_seen(&self) -> u64 {
        self.rows_seen
    }

    pub(crate) fn skipped_mut(&mut self) -> &mut Skipped {
        &mut self.skipped
    }

    fn read(&self, row: usize, out: &mut [f64]) -> Result<(), Defect> {
        for wanted in &self.columns {
            let value = match wanted.batch.get(row).copied().flatten() {
                Some(value) if value.is_finite() || self.keep_not_finite => value,
                Some(value) => return Err(Defect::NotFinite(value)),
                None if self.keep_not_finite => f64::NAN,
                None => {
                    let column = wanted.index + 1;
                    return Err(Defect::Empty { column });
                }
            };
            if let Some(place) = out.get_mut(wanted.slot) {
                *place = value;
            }
        }
        Ok(())
    }

    /// Reads the next batch; false at the end. What is damaged ends the table, counted.
    fn next_batch(&mut self) -> Result<bool, ReadError> {
        let failure = match guarded(|| self.fill()) {
            Ok(0) => None,
            Ok(rows) => {
                (self.rows, self.given) = (rows, 0);
                return Ok(true);
            }
            Err(error) => Some(error),
        };
        self.finished = true;
        if let Some(error) = failure {
            self.skipped.add(SkipKind::EndsEarly, self.rows_seen, error);
        }
        if self.rows_read > 0 {
            return Ok(false);
        }
        Err(no_rows(&self.path, self.rows_seen, &self.skipped))
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
            let mut file = File::open(&self.path)?;
            for wanted in &mut self.columns {
                let (start, length) = group.metadata().column(wanted.index).byte_range();
                if !headers::pages_are_sound(&mut file, start, start.saturating_add(length))? {
                    let problem = "a header of a page is damaged".to_owned();
                    return Err(ParquetError::General(problem));
                }
                wanted.reader = Some(group.get_column_reader(wanted.index)?);
            }
        }
    }
}

impl Wanted {
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

fn open(path: &Path) -> Result<SerializedFileReader<File>, ReadError> {
    let failed = |problem: String| ReadError::new(path, problem);
    // For the messages of a file that cannot be opened.
    drop(crate::source::open(path)?);
    let mut file = File::open(path).map_err(|error| failed(format!("cannot be read: {error}")))?;
    let mut start = Vec::new();
    file.by_ref()
        .take(MAGIC.len() as u64)
        .read_to_end(&mut start)
        .map_err(|error| failed(format!("cannot be read: {error}")))?;
    if start.is_empty() {
        return Err(failed("is empty".into()));
    }
    if start.starts_with(GZIP_MAGIC) {
        return Err(failed("is compressed as a whole".into())
            .mend("decompress it: Parquet is read from its end, and compressed inside"));
    }
    if !is_parquet(&start) {
        return Err(failed("is no Parquet file".into()));
    }
    let length = file.metadata().map_or(0, |metadata| metadata.len());
    let unreadable = |error| failed(format!("is no Parquet file that can be read: {error}"));
    if !headers::footer_is_sound(&mut file).is_ok_and(|sound| sound) {
        return Err(unreadable(ParquetError::General(
            "the footer is damaged".into(),
        )));
    }
    let reader = guarded(|| SerializedFileReader::new(file)).map_err(unreadable)?;
    let groups = reader.metadata().row_groups().iter();
    let mut chunks = groups.flat_map(|group| group.columns());
    if !chunks.all(|chunk| is_inside(chunk, length)) {
        return Err(failed("has columns outside of the file".into()));
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

fn names(reader: &SerializedFileReader<File>) -> Vec<String> {
    let schema = reader.metadata().file_metadata().schema_descr();
    let columns = schema.columns().iter();
    columns.map(|column| column.path().string()).collect()
}

/// The factor to the numbers of a column and whether its integers have no sign; `Err` says what else
/// the column holds.
fn conversion(column: &ColumnDescriptor) -> Result<(f64, bool), &'static str> {
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
    let decimal = column.converted_type() == ConvertedType::DECIMAL;
    let scale = if decimal {
        0.1f64.powi(column.type_scale())
    } else {
        1.0
    };
    Ok((scale, unsigned))
}
