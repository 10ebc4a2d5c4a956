//! The navigation solution as Parquet: the columns of [`super::solution`] as doubles, with the same
//! names and units, not rounded, and Unix time where the log has a date; what is not finite is NaN.

use std::io::{self, Write};

use super::parquet_table::{ParquetTableWriter, Value};
use super::solution::{COLUMNS, SolutionRow, UNIX_TIME, YAW};
use crate::epoch::Epoch;

/// Starts with the head of the file.
pub(super) fn create<W: Write + Send>(out: W, dated: bool) -> io::Result<ParquetTableWriter<W>> {
    let names = COLUMNS.map(|(name, ..)| name).into_iter();
    let columns = names
        .chain(dated.then_some(UNIX_TIME))
        .map(|name| (name, Value::Exact(0.0)));
    ParquetTableWriter::new(out, "solution", columns)
}

/// The values of a row.
pub(super) fn values(
    row: &SolutionRow,
    epoch: Option<Epoch>,
) -> impl Iterator<Item = Value<'static>> {
    let state = row.values().into_iter().enumerate().map(|(k, value)| {
        let value = match value {
            // Just below a full turn rounds to one.
            yaw if k == YAW => yaw.rem_euclid(360.0) % 360.0,
            value => value,
        };
        Value::Exact(if value.is_finite() { value } else { f64::NAN })
    });
    state.chain(epoch.map(|epoch| Value::Exact(row.unix_time(epoch))))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};
    use std::path::Path;

    use undrift_nav::Vector3;
    use undrift_nav::earth::Geodetic;

    use super::*;
    use crate::Opened;
    use crate::table::{Column, TableOptions};
    use crate::write::parquet_table::GROUP;
    use crate::write::{SolutionFile, SolutionFormat, SolutionOptions};

    fn create(path: &Path) -> SolutionFile {
        let options = SolutionOptions::default();
        SolutionFile::create(path, SolutionFormat::Parquet, &options).unwrap()
    }

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
            keep_not_finite: true,
            ..TableOptions::default()
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
        let mut writer = create(&path);
        let yaws = [-PI / 2.0, -1e-18, TAU];
        for (k, yaw) in yaws.into_iter().enumerate() {
            let mut turned = row(k as f64);
            turned.rpy.z = yaw;
            writer.write(&turned, false).unwrap();
        }
        assert!(!path.exists());
        writer.finish().unwrap();
        let names = Opened::open(&path).unwrap().preview(0).unwrap().names;
        assert_eq!(names, COLUMNS.map(|(name, ..)| name));
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
        let mut writer = create(&path);
        for k in 0..=GROUP {
            writer.write(&row(k as f64), false).unwrap();
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
        create(&path).finish().unwrap();
        assert_eq!(
            Opened::open(&path).unwrap().preview(0).unwrap().names.len(),
            COLUMNS.len()
        );
        std::fs::remove_file(&path).unwrap();
        // Dropped unfinished, there is no file.
        drop(create(&path));
        assert!(!path.exists());
    }
}
