//! What an inspection guesses of a table's columns and units.

use crate::{
    drive::{Section, Table, column, columns},
    inspect,
};
use undrift_io::table::{Column, Preview};

/// Six columns, their units and the time.
pub(super) struct Guess {
    gyro: [Column; 3],
    accel: [Column; 3],
    /// Units of gyros and accelerometers.
    units: [String; 2],
    pub(super) time: Option<Column>,
    increments: bool,
}

const INCREMENTS: &str = "by their size the columns are increments: describe them in a drive file (undrift inspect FILE -o drive.toml) and give \
     that instead";

impl Guess {
    /// Guesses from the names and the first rows of a table; `None` where they do not show six axes.
    pub(super) fn from_preview(beginning: &Preview) -> Option<Self> {
        let parts = inspect::of_table(beginning.clone());
        let imu = parts.into_iter().find(|part| part.table == "imu")?;
        let lines = imu.lines.into_iter();
        let lines = lines.map(|line| (line.key.to_owned(), line.value));
        let lines = toml::Table::from_iter(lines);
        let keys = Section::values(Table::Values(&lines), "");
        let unit = |key| Some(keys.text(key).ok()??.to_owned());
        Some(Self {
            gyro: columns(&keys, "gyro").ok()??,
            accel: columns(&keys, "accel").ok()??,
            units: [unit("gyro_unit")?, unit("accel_unit")?],
            time: column(&keys, "time").ok()?,
            increments: keys.text("data").ok()? == Some("increments"),
        })
    }

    /// The columns of the axes of a record, in their order.
    pub(super) fn columns(&self) -> impl Iterator<Item = &Column> {
        self.gyro.iter().chain(&self.accel)
    }

    /// The units of gyros and accelerometers.
    ///
    /// # Errors
    /// If the columns are increments.
    pub(super) fn units(&self) -> Result<&[String; 2], String> {
        match self.increments {
            true => Err(INCREMENTS.into()),
            false => Ok(&self.units),
        }
    }
}
