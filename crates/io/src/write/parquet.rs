//! The navigation solution as Parquet: the columns of [`super::solution`] as doubles, with the same
//! names and units, not rounded; what is not finite is NaN.

use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;

use parquet::basic::{Compression, Repetition, Type as Physical, ZstdLevel};
use parquet::data_type::DoubleType;
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use super::PendingFile;
use super::solution::{COLUMNS, SolutionRow, YAW};

/// Rows of a row group, which is held until it is full: 25 MB.
const GROUP: usize = 100_000;

/// Writes solution rows as Parquet, compressed with Zstandard.
pub struct ParquetSolutionWriter<W: Write + Send> {
    writer: SerializedFileWriter<W>,
    /// The row group column by column.
    columns: Vec<Vec<f64>>,
    rows: usize,
}

impl ParquetSolutionWriter<PendingFile> {
    /// Starts a file that appears under its name at [`ParquetSolutionWriter::finish`].
    ///
    /// # Errors
    /// If the file cannot be created.
    pub fn create(path: &Path) -> io::Result<Self> {
        Self::new(PendingFile::create(path)?)
    }

    /// Writes what is left and gives the file its name.
    ///
    /// # Errors
    /// If the file cannot be written or renamed; there is none under the name then.
    pub fn finish(self) -> io::Result<()> {
        self.into_inner()?.finish()
    }
}

impl<W: Write + Send> ParquetSolutionWriter<W> {
    /// Starts with the head of the file. The rows are buffered here; `out` needs no buffer.
    ///
    /// # Errors
    /// If `out` does not take it.
    pub fn new(out: W) -> io::Result<Self> {
        let field = |(name, _): &(&str, usize)| {
            Type::primitive_type_builder(name, Physical::DOUBLE)
                .with_repetition(Repetition::REQUIRED)
                .build()
                .map(Arc::new)
        };
        let fields = COLUMNS.iter().map(field).collect::<Result<Vec<_>, _>>();
        let schema = Type::group_type_builder("solution")
            .with_fields(fields.map_err(failed)?)
            .build()
            .map_err(failed)?;
        let properties = WriterProperties::builder()
            .set_compression(Compression::ZSTD(ZstdLevel::default()))
            .set_dictionary_enabled(false)
            .build();
        let writer = SerializedFileWriter::new(out, Arc::new(schema), Arc::new(properties));
        Ok(Self {
            writer: writer.map_err(failed)?,
            columns: vec![Vec::new(); COLUMNS.len()],
            rows: 0,
        })
    }

    /// Writes one row.
    ///
    /// # Errors
    /// If `out` does not take it.
    pub fn write(&mut self, row: &SolutionRow) -> io::Result<()> {
        for (k, (column, value)) in self.columns.iter_mut().zip(row.values()).enumerate() {
            let value = match value {
                yaw if k == YAW => yaw.rem_euclid(360.0),
                value => value,
            };
            column.push(match value {
                // Just below a full turn rounds to one.
                yaw if k == YAW && yaw >= 360.0 => 0.0,
                value if value.is_finite() => value,
                _ => f64::NAN,
            });
        }
        self.rows += 1;
        if self.rows == GROUP {
            self.write_group()?;
        }
        Ok(())
    }

    fn write_group(&mut self) -> io::Result<()> {
        self.try_write_group().map_err(failed)
    }

    fn try_write_group(&mut self) -> Result<(), ParquetError> {
        let mut group = self.writer.next_row_group()?;
        for values in &mut self.columns {
            if let Some(mut column) = group.next_column()? {
                column
                    .typed::<DoubleType>()
                    .write_batch(values, None, None)?;
                column.close()?;
            }
            values.clear();
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
            self.write_group()?;
        }
        self.writer.into_inner().map_err(failed)
    }
}

fn failed(error: ParquetError) -> io::Error {
    io::Error::other(error)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use undrift_nav::Vector3;
    use undrift_nav::earth::Geodetic;

    use super::*;
    use crate::Opened;
    use crate::table::{Column, TableOptions};

    fn row(time: f64) -> SolutionRow {
        SolutionRow {
            time,
            position: Geodetic::from_degrees(40.096_626_8, -105.147_448_3, 1601.474),
            v_n: Vector3::new(1.0, -2.0, 0.25),
            rpy: Vector3::new(PI / 180.0, -PI / 2.0, -PI / 2.0),
            nav_std: [0.1, 0.2, 0.3, 0.01, 0.02, 0.03, PI, PI / 2.0, f64::NAN],
            gyro_error: Vector3::new(PI / 180.0, 0.0, 0.0),
            accel_error: Vector3::new(0.5, f64::INFINITY, -1e-7),
            error_std: [PI / 180.0, 0.0, 0.0, 1.0, 2.0, 3.0],
        }
    }

    fn read(path: &Path) -> Vec<[f64; 31]> {
        let column = |number| (String::new(), Column::Number(number));
        let options = TableOptions {
            columns: (1..=31).map(column).collect(),
            delimiter: None,
            keep_not_finite: true,
        };
        let mut table = Opened::open(path).unwrap().table(&options).unwrap();
        let (mut rows, mut row) = (Vec::new(), [0.0; 31]);
        while table.next_row(&mut row).unwrap().is_some() {
            rows.push(row);
        }
        rows
    }

    fn path(name: &str) -> std::path::PathBuf {
        std::env::temp_dir().join(format!("undrift-io-{}-{name}.parquet", std::process::id()))
    }

    #[test]
    fn what_is_written_is_read_back() {
        let path = path("solution");
        let mut writer = ParquetSolutionWriter::create(&path).unwrap();
        let yaws = [-PI / 2.0, -1e-18, TAU];
        for (k, yaw) in yaws.into_iter().enumerate() {
            let mut turned = row(k as f64);
            turned.rpy.z = yaw;
            writer.write(&turned).unwrap();
        }
        assert!(!path.exists());
        writer.finish().unwrap();
        let names = Opened::open(&path).unwrap().preview(0).unwrap().names;
        assert_eq!(names, COLUMNS.map(|(name, _)| name));
        let rows = read(&path);
        std::fs::remove_file(&path).unwrap();
        assert_eq!(
            rows.iter().map(|row| row[YAW]).collect::<Vec<_>>(),
            [270.0, 0.0, 0.0]
        );
        for (k, values) in rows.iter().enumerate() {
            for ((ours, written), name) in values.iter().zip(row(k as f64).values()).zip(&names) {
                let equal = ours.to_bits() == written.to_bits();
                let not_finite = !written.is_finite() && ours.is_nan();
                assert!(
                    equal || not_finite || name == "yaw_deg",
                    "{name}: {ours} {written}"
                );
            }
        }
    }

    #[test]
    fn rows_go_over_several_groups() {
        let path = path("groups");
        let mut writer = ParquetSolutionWriter::create(&path).unwrap();
        for k in 0..=GROUP {
            writer.write(&row(k as f64)).unwrap();
        }
        writer.finish().unwrap();
        let rows = read(&path);
        std::fs::remove_file(&path).unwrap();
        assert_eq!(rows.len(), GROUP + 1);
        assert!(rows.iter().enumerate().all(|(k, row)| row[0] == k as f64));
    }

    #[test]
    fn a_file_without_rows_names_its_columns() {
        let path = path("none");
        ParquetSolutionWriter::create(&path)
            .unwrap()
            .finish()
            .unwrap();
        assert_eq!(
            Opened::open(&path).unwrap().preview(0).unwrap().names.len(),
            COLUMNS.len()
        );
        std::fs::remove_file(&path).unwrap();
        // Dropped unfinished, there is no file.
        drop(ParquetSolutionWriter::create(&path).unwrap());
        assert!(!path.exists());
    }
}
