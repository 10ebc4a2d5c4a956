//! Columns that are in memory, read as a table is.

use std::path::Path;
use std::sync::Arc;

use super::header::places;
use super::wanted::{Keep, NextRow, Preview, TableOptions, fill};
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
            ..Preview::default()
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
            wanted: places(Some(columns.names()), options)?,
            columns,
            seen: 0,
        })
    }

    /// Reads the next row into `out`, in the order of the wanted columns; its number, the first is 1.
    pub(super) fn step(&mut self, keep: Keep, out: &mut [f64]) -> NextRow {
        let row = self.seen;
        if row >= self.columns.0.rows {
            return NextRow::End(None);
        }
        self.seen += 1;
        let number = |&(index, slot): &(usize, usize)| {
            let column = self.columns.0.columns.get(index);
            (slot, index, column.and_then(|c| c.get(row)).copied())
        };
        let filled = fill(out, keep, self.wanted.iter().map(number));
        NextRow::Row(self.seen as u64, filled)
    }
}
