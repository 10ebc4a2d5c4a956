//! Columns that are in memory, read as a table is.

use std::path::Path;
use std::sync::Arc;

use super::fields::Defect;
use super::header::places;
use super::wanted::{Preview, Step, TableOptions};
use crate::ReadError;

/// Columns of equal length in memory, each under its name; clones share them.
#[derive(Clone, Debug)]
pub struct Columns(Arc<Inner>);

#[derive(Debug)]
struct Inner {
    names: Vec<String>,
    columns: Vec<Vec<f64>>,
    rows: usize,
}

impl Columns {
    /// Of these names and values; `table` is what messages call it.
    ///
    /// # Errors
    /// If the columns have different lengths.
    pub fn new(table: &Path, columns: Vec<(String, Vec<f64>)>) -> Result<Self, ReadError> {
        let (names, columns): (Vec<String>, Vec<Vec<f64>>) = columns.into_iter().unzip();
        let rows = columns.first().map_or(0, Vec::len);
        let other = names.iter().zip(&columns).find(|(_, c)| c.len() != rows);
        if let (Some((name, column)), Some(first)) = (other, names.first()) {
            let problem = format!(
                "column \"{name}\" has {} rows, column \"{first}\" has {rows}",
                column.len()
            );
            return Err(ReadError::new(table, problem));
        }
        let inner = Inner {
            names,
            columns,
            rows,
        };
        Ok(Self(Arc::new(inner)))
    }

    /// Names of the columns in their order.
    pub fn names(&self) -> &[String] {
        &self.0.names
    }

    /// The names of the columns and up to `rows` rows of them, as of a file.
    pub fn preview(&self, rows: usize) -> Preview {
        let columns = &self.0.columns;
        let row = |k: usize| columns.iter().filter_map(|c| c.get(k).copied()).collect();
        Preview {
            header: self.0.names.clone(),
            names: self.0.names.clone(),
            rows: (0..rows.min(self.0.rows)).map(row).collect(),
        }
    }
}

/// Reads the wanted ones of columns in memory row by row.
pub(super) struct MemoryTable {
    columns: Columns,
    /// Wanted columns: (index of the column, index in the row read).
    wanted: Vec<(usize, usize)>,
    seen: usize,
}

impl MemoryTable {
    /// Finds the wanted columns.
    ///
    /// # Errors
    /// If a wanted column is missing.
    pub(super) fn new(columns: Columns, options: &TableOptions) -> Result<Self, ReadError> {
        Ok(Self {
            wanted: places(columns.names(), options)?,
            columns,
            seen: 0,
        })
    }

    /// Reads the next row into `out`, in the order of the wanted columns; its number, the first is 1.
    pub(super) fn step(&mut self, keep: bool, out: &mut [f64]) -> Step {
        let row = self.seen;
        if row >= self.columns.0.rows {
            return Step::End(None);
        }
        self.seen += 1;
        Step::Row(self.seen as u64, self.read(row, keep, out))
    }

    fn read(&self, row: usize, keep: bool, out: &mut [f64]) -> Result<(), Defect> {
        for &(index, slot) in &self.wanted {
            let column = self.columns.0.columns.get(index);
            let value = column.and_then(|c| c.get(row)).copied();
            let value = value.unwrap_or(f64::NAN);
            if !(value.is_finite() || keep) {
                return Err(Defect::NotFinite(value));
            }
            if let Some(place) = out.get_mut(slot) {
                *place = value;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::BytesRead;
    use crate::table::{Column, Table};
    use crate::{Memory, Opened};

    fn options(keep_not_finite: bool) -> TableOptions {
        TableOptions {
            columns: vec![
                ("imu.gyro".into(), Column::Name("g".into())),
                ("imu.time".into(), Column::Number(1)),
            ],
            delimiter: None,
            keep_not_finite,
        }
    }

    fn open(path: &Path, columns: Columns, options: &TableOptions) -> Result<Table, ReadError> {
        let read = BytesRead::default();
        Opened::memory(path, Memory::Columns(columns), &read)?.table(options)
    }

    fn columns() -> Columns {
        let gyro = vec![0.1, f64::NAN, 0.3];
        let columns = vec![("t".into(), vec![1.0, 2.0, 3.0]), ("g".into(), gyro)];
        Columns::new(Path::new("<imu>"), columns).unwrap()
    }

    #[test]
    fn rows_and_what_is_skipped_are_as_of_a_file() {
        let path = Path::new("<imu>");
        let mut table = open(path, columns(), &options(false)).unwrap();
        let mut row = [0.0; 2];
        assert_eq!(table.next_row(&mut row).unwrap(), Some(1));
        assert_eq!(row, [0.1, 1.0]);
        assert_eq!(table.next_row(&mut row).unwrap(), Some(3));
        assert_eq!(table.next_row(&mut row).unwrap(), None);
        assert_eq!(
            table.skipped().to_string(),
            "1 row with NaN or infinity, at line 2: NaN"
        );
        let mut table = open(path, columns(), &options(true)).unwrap();
        table.next_row(&mut row).unwrap();
        table.next_row(&mut row).unwrap();
        assert!(row[0].is_nan() && row[1] == 2.0);
    }

    #[test]
    fn what_is_wrong_is_told_as_of_a_file() {
        let path = Path::new("<imu>");
        let mut wrong = options(false);
        wrong.columns[0].1 = Column::Name("gx".into());
        let error = open(path, columns(), &wrong).err().unwrap();
        assert_eq!(
            error.to_string(),
            "<imu>: no column \"gx\" (key imu.gyro); the file has: t, g"
        );
        let uneven = vec![("t".into(), vec![1.0]), ("g".into(), vec![])];
        let error = Columns::new(path, uneven).unwrap_err().to_string();
        assert_eq!(error, "<imu>: column \"g\" has 0 rows, column \"t\" has 1");
        let empty = Columns::new(path, vec![("t".into(), vec![]), ("g".into(), vec![])]).unwrap();
        let mut table = open(path, empty, &options(false)).unwrap();
        let error = table.next_row(&mut [0.0; 2]).unwrap_err();
        assert_eq!(error.problem, "no row of data");
    }
}
