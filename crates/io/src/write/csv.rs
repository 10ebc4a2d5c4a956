//! The navigation solution as CSV: the columns of [`super::solution`], and Unix time where the log has
//! a date.

use std::io::{self, Write};

use super::fixed::FixedRow;
use super::solution::{COLUMNS, SolutionRow, UNIX_TIME, YAW};
use super::text::in_turn;
use super::text_writer::{Beside, Body, TextFormat, TextWriter};
use super::write_fixed;

impl<W: Write> TextWriter<W> {
    /// Starts a CSV with a header, of every row.
    pub fn csv(out: W) -> Self {
        Self::new(out, format(false), None, 0.0)
    }
}

/// Rows of numbers behind a header, with Unix time where they are dated; what is not finite becomes `nan`.
pub(super) fn format(dated: bool) -> TextFormat {
    let names = COLUMNS.map(|(name, ..)| name).into_iter();
    let names = names.chain(dated.then_some(UNIX_TIME));
    TextFormat {
        head: Vec::from_iter(names).join(",") + "\n",
        body: Body::Rows(|_| true, write_row),
        tail: "",
    }
}

static ROW: FixedRow<{ COLUMNS.len() }> = FixedRow::new(decimals());

const fn decimals() -> [usize; COLUMNS.len()] {
    let mut decimals = [0; COLUMNS.len()];
    let mut k = 0;
    while k < COLUMNS.len() {
        decimals[k] = COLUMNS[k].1;
        k += 1;
    }
    decimals
}

fn write_row(buf: &mut Vec<u8>, row: &SolutionRow, beside: &Beside) -> io::Result<()> {
    let mut values = row.values();
    values[YAW] = in_turn(values[YAW], COLUMNS[YAW].1);
    ROW.write(buf, &values);
    if let Some(epoch) = beside.epoch {
        buf.push(b',');
        write_fixed(buf, row.unix_time(epoch), 6);
    }
    buf.push(b'\n');
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use undrift_nav::Vector3;
    use undrift_nav::earth::Geodetic;

    use super::*;
    use crate::write::PendingFile;

    fn row() -> SolutionRow {
        SolutionRow {
            time: 1.5,
            position: Geodetic::from_degrees(40.096_626_8, -105.147_448_3, 1601.474),
            v_n: Vector3::new(1.0, -2.0, 0.25),
            rpy: Vector3::new(PI / 180.0, -PI / 2.0, -PI / 2.0),
            nav_std: [0.1, 0.2, 0.3, 0.01, 0.02, 0.03, PI, PI / 2.0, f64::NAN],
            gyro_error: Vector3::new(PI / 180.0, 0.0, 0.0),
            accel_error: Vector3::new(0.5, f64::INFINITY, -1e-7),
            error_std: [PI / 180.0, 0.0, 0.0, 1.0, 2.0, 3.0],
        }
    }

    fn text_of(rows: &[SolutionRow]) -> String {
        let mut writer = TextWriter::csv(Vec::new());
        for row in rows {
            writer.write(row, false).unwrap();
        }
        String::from_utf8(writer.into_inner().unwrap()).unwrap()
    }

    #[test]
    fn header_units_and_order() {
        let text = text_of(&[row()]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 2);
        let names: Vec<&str> = lines[0].split(',').collect();
        let fields: Vec<&str> = lines[1].split(',').collect();
        assert_eq!((names.len(), fields.len()), (31, 31));
        let get = |name: &str| fields[names.iter().position(|n| *n == name).unwrap()];
        assert_eq!(get("time_s"), "1.5000");
        assert_eq!(get("lat_deg"), "40.09662680000");
        assert_eq!(get("lon_deg"), "-105.14744830000");
        assert_eq!(get("vd_mps"), "0.25000");
        assert_eq!(get("roll_deg"), "1.000000");
        assert_eq!(get("yaw_deg"), "270.000000");
        assert_eq!(get("down_std_m"), "0.3000");
        assert_eq!(get("roll_std_deg"), "180.000000");
        assert_eq!(get("yaw_std_deg"), "nan");
        assert_eq!(get("gyro_bias_x_dps"), "1.00000000");
        assert_eq!(get("accel_bias_y_mps2"), "nan");
        assert_eq!(get("accel_bias_z_mps2"), "-0.0000001");
        assert_eq!(get("gyro_bias_x_std_dps"), "1.00000000");
        assert_eq!(get("accel_bias_z_std_mps2"), "3.0000000");
    }

    #[test]
    fn yaw_stays_below_a_full_turn() {
        for yaw in [
            -1e-12,
            TAU,
            TAU - 1e-12,
            -3.0 * TAU,
            -0.5,
            359.9999996f64.to_radians(),
        ] {
            let mut turned = row();
            turned.rpy.z = yaw;
            let text = text_of(&[turned]);
            let yaw_deg = text.lines().nth(1).unwrap().split(',').nth(YAW).unwrap();
            let yaw_deg: f64 = yaw_deg.parse().unwrap();
            assert!((0.0..360.0).contains(&yaw_deg), "{yaw} {yaw_deg}");
        }
    }

    #[test]
    fn many_rows_reach_the_file_whole() {
        let path = std::env::temp_dir().join(format!("undrift-io-sol-{}.csv", std::process::id()));
        let mut writer = TextWriter::csv(PendingFile::create(&path).unwrap());
        for k in 0..1000 {
            let time = f64::from(k);
            let row = SolutionRow { time, ..row() };
            writer.write(&row, false).unwrap();
        }
        assert!(!path.exists());
        writer.into_inner().unwrap().finish().unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::remove_file(&path).unwrap();
        assert_eq!(text.lines().count(), 1001);
        assert!(text.lines().last().unwrap().starts_with("999.0000,"));
        assert!(text.ends_with('\n'));
    }
}
