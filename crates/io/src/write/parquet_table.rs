//! Tables of text and numbers as Parquet, any of which may be missing in a row.

use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical, ZstdLevel};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int32Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::Type;

use super::PendingFile;

/// Rows of a row group, which is held until it is full.
pub(super) const GROUP: usize = 100_000;

/// A value of a column, or the type of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value<'a> {
    /// UTF-8; `None` is null.
    Text(Option<&'a str>),
    /// A 32-bit integer.
    Whole(Option<i32>),
    /// A double; what is not finite should be `None`.
    Number(Option<f64>),
    /// A double that is there in every row; NaN where there is no number.
    Exact(f64),
}

/// The values of a column that are there, and the definition level of each row: 1 of those.
struct Column {
    values: Values,
    levels: Option<Vec<i16>>,
}

enum Values {
    Text(Vec<ByteArray>),
    Whole(Vec<i32>),
    Number(Vec<f64>),
}

impl Column {
    /// Of values like this one.
    fn like(value: Value<'_>) -> Self {
        let optional = !matches!(value, Value::Exact(_));
        Self {
            values: match value {
                Value::Text(_) => Values::Text(Vec::new()),
                Value::Whole(_) => Values::Whole(Vec::new()),
                Value::Number(_) | Value::Exact(_) => Values::Number(Vec::new()),
            },
            levels: optional.then(Vec::new),
        }
    }

    /// Takes a value, if it is one of the column's.
    fn push(&mut self, value: Value<'_>) -> bool {
        let there = match (&mut self.values, value) {
            (Values::Text(values), Value::Text(value)) => {
                values.extend(value.map(ByteArray::from));
                value.is_some()
            }
            (Values::Whole(values), Value::Whole(value)) => {
                values.extend(value);
                value.is_some()
            }
            (Values::Number(values), Value::Number(value)) if self.levels.is_some() => {
                values.extend(value);
                value.is_some()
            }
            (Values::Number(values), Value::Exact(value)) if self.levels.is_none() => {
                values.push(value);
                true
            }
            _ => return false,
        };
        if let Some(levels) = &mut self.levels {
            levels.push(i16::from(there));
        }
        true
    }

    fn field(&self, name: &str) -> Result<Type, ParquetError> {
        let (physical, logical) = match self.values {
            Values::Text(_) => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
            Values::Whole(_) => (Physical::INT32, None),
            Values::Number(_) => (Physical::DOUBLE, None),
        };
        let repetition = match self.levels {
            Some(_) => Repetition::OPTIONAL,
            None => Repetition::REQUIRED,
        };
        Type::primitive_type_builder(name, physical)
            .with_repetition(repetition)
            .with_logical_type(logical)
            .build()
    }

    /// Writes what it holds and holds nothing after.
    fn write(&mut self, to: &mut SerializedColumnWriter<'_>) -> Result<(), ParquetError> {
        let levels = self.levels.as_deref();
        match &mut self.values {
            Values::Text(texts) => {
                to.typed::<ByteArrayType>()
                    .write_batch(texts, levels, None)?;
                texts.clear();
            }
            Values::Whole(numbers) => {
                to.typed::<Int32Type>().write_batch(numbers, levels, None)?;
                numbers.clear();
            }
            Values::Number(numbers) => {
                to.typed::<DoubleType>()
                    .write_batch(numbers, levels, None)?;
                numbers.clear();
            }
        }
        if let Some(levels) = &mut self.levels {
            levels.clear();
        }
        Ok(())
    }
}

/// Writes a table row by row, compressed with Zstandard. The rows are buffered here.
pub struct ParquetTableWriter<W: Write + Send = PendingFile> {
    writer: SerializedFileWriter<W>,
    columns: Vec<Column>,
    rows: usize,
}

impl ParquetTableWriter<PendingFile> {
    /// Starts a file that appears under its name at [`ParquetTableWriter::finish`], with columns by name
    /// and a value like theirs.
    ///
    /// # Errors
    /// If the file cannot be created.
    pub fn create(path: &Path, columns: Vec<(&str, Value)>) -> io::Result<Self> {
        Self::new(PendingFile::create(path)?, "table", columns)
    }

    /// Writes what is left and gives the file its name.
    ///
    /// # Errors
    /// If the file cannot be written or renamed; then there is no file of that name.
    pub fn finish(self) -> io::Result<()> {
        self.into_inner()?.finish()
    }
}

impl<W: Write + Send> ParquetTableWriter<W> {
    /// Starts with the head of the file, of columns by name and a value like theirs.
    pub(super) fn new<'a>(
        out: W,
        name: &str,
        columns: impl IntoIterator<Item = (&'a str, Value<'a>)>,
    ) -> io::Result<Self> {
        let (mut fields, mut values, mut repeats) = (Vec::new(), Vec::new(), false);
        for (name, like) in columns {
            let column = Column::like(like);
            fields.push(Arc::new(column.field(name).map_err(failed)?));
            // Exact numbers seldom repeat.
            repeats |= column.levels.is_some();
            values.push(column);
        }
        let schema = Type::group_type_builder(name).with_fields(fields).build();
        let properties = WriterProperties::builder()
            .set_compression(Compression::ZSTD(ZstdLevel::default()))
            .set_dictionary_enabled(repeats)
            .build();
        let schema = Arc::new(schema.map_err(failed)?);
        let writer = SerializedFileWriter::new(out, schema, Arc::new(properties));
        Ok(Self {
            writer: writer.map_err(failed)?,
            columns: values,
            rows: 0,
        })
    }

    /// Writes a row: a value for each column.
    ///
    /// # Errors
    /// If the file cannot be written, or the values are not those of the columns.
    pub fn write<'a>(&mut self, row: impl IntoIterator<Item = Value<'a>>) -> io::Result<()> {
        let mut values = row.into_iter();
        let mut fits = true;
        for column in &mut self.columns {
            fits &= values.next().is_some_and(|value| column.push(value));
        }
        if !fits || values.next().is_some() {
            let wrong = "the row's values do not match the columns";
            return Err(io::Error::new(io::ErrorKind::InvalidInput, wrong));
        }
        self.rows += 1;
        if self.rows == GROUP {
            self.write_group().map_err(failed)?;
        }
        Ok(())
    }

    fn write_group(&mut self) -> Result<(), ParquetError> {
        let mut group = self.writer.next_row_group()?;
        for column in &mut self.columns {
            if let Some(mut writer) = group.next_column()? {
                column.write(&mut writer)?;
                writer.close()?;
            }
        }
        group.close()?;
        self.rows = 0;
        Ok(())
    }

    /// Writes what is left and gives `out` back.
    ///
    /// # Errors
    /// If `out` does not take it.
    pub fn into_inner(mut self) -> io::Result<W> {
        if self.rows > 0 {
            self.write_group().map_err(failed)?;
        }
        self.writer.into_inner().map_err(failed)
    }
}

fn failed(error: ParquetError) -> io::Error {
    io::Error::other(error)
}

#[cfg(test)]
mod tests {
    use super::*;
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field;

    fn columns() -> Vec<(&'static str, Value<'static>)> {
        vec![
            ("log", Value::Text(None)),
            ("outage", Value::Whole(None)),
            ("error_m", Value::Number(None)),
        ]
    }

    fn path(name: &str) -> std::path::PathBuf {
        std::env::temp_dir().join(format!(
            "undrift-io-{}-table-{name}.parquet",
            std::process::id()
        ))
    }

    #[test]
    fn what_is_written_is_read_back_with_its_holes() {
        let path = path("holes");
        let mut writer = ParquetTableWriter::create(&path, columns()).unwrap();
        for k in 0..3i32 {
            let there = k != 1;
            writer
                .write([
                    Value::Text(there.then_some("a, \"b\"\n°")),
                    Value::Whole((k != 2).then_some(k)),
                    Value::Number(there.then_some(0.1 * f64::from(k))),
                ])
                .unwrap();
        }
        assert!(!path.exists());
        writer.finish().unwrap();
        let reader = SerializedFileReader::new(std::fs::File::open(&path).unwrap()).unwrap();
        let rows: Vec<Vec<Field>> = reader
            .get_row_iter(None)
            .unwrap()
            .map(|row| {
                row.unwrap()
                    .get_column_iter()
                    .map(|(_, f)| f.clone())
                    .collect()
            })
            .collect();
        std::fs::remove_file(&path).unwrap();
        let text = Field::Str("a, \"b\"\n°".into());
        assert_eq!(
            rows,
            [
                vec![text.clone(), Field::Int(0), Field::Double(0.0)],
                vec![Field::Null, Field::Int(1), Field::Null],
                vec![text, Field::Null, Field::Double(0.2)],
            ]
        );
    }

    #[test]
    fn rows_go_over_several_groups_and_wrong_ones_are_refused() {
        let path = path("groups");
        let mut writer = ParquetTableWriter::create(&path, columns()).unwrap();
        let row = |k: usize| {
            [
                Value::Text(Some("log")),
                Value::Whole(None),
                Value::Number(Some(k as f64)),
            ]
        };
        for k in 0..=GROUP {
            writer.write(row(k)).unwrap();
        }
        writer.finish().unwrap();
        let reader = SerializedFileReader::new(std::fs::File::open(&path).unwrap()).unwrap();
        assert_eq!(
            reader.metadata().file_metadata().num_rows(),
            GROUP as i64 + 1
        );
        assert_eq!(reader.metadata().num_row_groups(), 2);
        std::fs::remove_file(&path).unwrap();

        let mut writer = ParquetTableWriter::create(&path, columns()).unwrap();
        assert!(writer.write([Value::Text(None)]).is_err());
        assert!(writer.write(vec![Value::Number(None); 3]).is_err());
        drop(writer);
        assert!(!path.exists());
    }
}
