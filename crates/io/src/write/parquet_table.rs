//! Tables of text and numbers as Parquet, any of which may be missing in a row.

use std::io;
use std::path::Path;
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical, ZstdLevel};
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, Int32Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use super::PendingFile;

/// Rows of a row group, which is held until it is full.
const GROUP: usize = 100_000;

/// The values of one column, row by row; `None` is null.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// UTF-8.
    Text(Vec<Option<String>>),
    /// 32-bit integers.
    Whole(Vec<Option<i32>>),
    /// Doubles; what is not finite should be `None`.
    Number(Vec<Option<f64>>),
}

/// A value of a column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value<'a> {
    /// Of a column of text.
    Text(Option<&'a str>),
    /// Of a column of integers.
    Whole(Option<i32>),
    /// Of a column of doubles.
    Number(Option<f64>),
}

impl Values {
    fn push(&mut self, value: Value<'_>) -> bool {
        match (self, value) {
            (Self::Text(values), Value::Text(value)) => values.push(value.map(str::to_owned)),
            (Self::Whole(values), Value::Whole(value)) => values.push(value),
            (Self::Number(values), Value::Number(value)) => values.push(value),
            _ => return false,
        }
        true
    }

    fn clear(&mut self) {
        match self {
            Self::Text(values) => values.clear(),
            Self::Whole(values) => values.clear(),
            Self::Number(values) => values.clear(),
        }
    }

    fn field(&self, name: &str) -> Result<Type, ParquetError> {
        let (physical, logical) = match self {
            Self::Text(_) => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
            Self::Whole(_) => (Physical::INT32, None),
            Self::Number(_) => (Physical::DOUBLE, None),
        };
        Type::primitive_type_builder(name, physical)
            .with_repetition(Repetition::OPTIONAL)
            .with_logical_type(logical)
            .build()
    }
}

/// Writes a table row by row, compressed with Zstandard. It appears under its name when it is finished.
pub struct ParquetTableWriter {
    writer: SerializedFileWriter<PendingFile>,
    columns: Vec<Values>,
    rows: usize,
}

impl ParquetTableWriter {
    /// Starts a table with columns by name and type.
    ///
    /// # Errors
    /// If the file cannot be created.
    pub fn create(path: &Path, columns: Vec<(&str, Values)>) -> io::Result<Self> {
        let fields = columns.iter().map(|(name, values)| values.field(name));
        let fields = fields.map(|field| field.map(Arc::new));
        let schema = Type::group_type_builder("table")
            .with_fields(fields.collect::<Result<_, _>>().map_err(failed)?)
            .build()
            .map_err(failed)?;
        let properties = WriterProperties::builder()
            .set_compression(Compression::ZSTD(ZstdLevel::default()))
            .build();
        let file = PendingFile::create(path)?;
        let writer = SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties));
        Ok(Self {
            writer: writer.map_err(failed)?,
            columns: columns.into_iter().map(|(_, values)| values).collect(),
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
            let wrong = "a row whose values are not those of the columns";
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
        for values in &mut self.columns {
            let Some(mut column) = group.next_column()? else {
                break;
            };
            match values {
                Values::Text(texts) => {
                    let bytes = texts
                        .iter()
                        .map(|text| text.as_deref().map(ByteArray::from));
                    write_column::<ByteArrayType>(&mut column, bytes)?;
                }
                Values::Whole(values) => {
                    write_column::<Int32Type>(&mut column, values.iter().copied())?;
                }
                Values::Number(values) => {
                    write_column::<DoubleType>(&mut column, values.iter().copied())?;
                }
            }
            column.close()?;
            values.clear();
        }
        group.close()?;
        self.rows = 0;
        Ok(())
    }

    /// Writes what is left and gives the file its name.
    ///
    /// # Errors
    /// If the file cannot be written or renamed; there is none under the name then.
    pub fn finish(mut self) -> io::Result<()> {
        if self.rows > 0 {
            self.write_group().map_err(failed)?;
        }
        self.writer.into_inner().map_err(failed)?.finish()
    }
}

/// Writes the values of a column that are there, and where they are: definition level 1.
fn write_column<T: DataType>(
    column: &mut parquet::file::writer::SerializedColumnWriter<'_>,
    values: impl Iterator<Item = Option<T::T>>,
) -> Result<(), ParquetError> {
    let mut levels = Vec::new();
    let mut there = Vec::new();
    for value in values {
        levels.push(i16::from(value.is_some()));
        there.extend(value);
    }
    let typed = column.typed::<T>();
    typed.write_batch(&there, Some(&levels), None).map(drop)
}

fn failed(error: ParquetError) -> io::Error {
    io::Error::other(error)
}

#[cfg(test)]
mod tests {
    use super::*;
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field;

    fn columns() -> Vec<(&'static str, Values)> {
        vec![
            ("log", Values::Text(Vec::new())),
            ("outage", Values::Whole(Vec::new())),
            ("error_m", Values::Number(Vec::new())),
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
