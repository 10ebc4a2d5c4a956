//! Which format a log has, by its beginning.

use crate::format::Format;
use crate::{log, number, table};

/// The format of a log that begins so: [`Format::Csv`] where no other format fits.
pub(crate) fn format(start: &[u8]) -> Format {
    match log::detect(start) {
        Some(format) => format,
        None if table::is_parquet(start) => Format::Parquet,
        None => detect_table(start),
    }
}

/// Rows that are looked at.
const ROWS: usize = 20;

/// Tables whose columns are known, else [`Format::Csv`].
fn detect_table(start: &[u8]) -> Format {
    if start.starts_with(b"#timestamp [ns],w_RS_S_x [rad s^-1]") {
        return Format::Euroc;
    }
    let rows = numbers(start);
    match rows.first() {
        Some(first) if rows.len() > 1 && rows.iter().all(|row| row.len() == first.len()) => {
            let times = if first.len() == 11 { 1 } else { 0 };
            let steps: Vec<f64> = rows
                .windows(2)
                .map(|pair| pair[1][times] - pair[0][times])
                .collect();
            let fitting = rows.iter().zip(&steps);
            let fitting = fitting.filter(|(row, step)| kf_gins(row, **step)).count();
            // A sensor may begin with zeros, and a step be a gap.
            let known = steps.iter().all(|step| *step > 0.0) && 10 * fitting >= 9 * steps.len();
            if known { Format::KfGins } else { Format::Csv }
        }
        _ => Format::Csv,
    }
}

/// Whether a row, `step` \[s\] before the next, can be one of the three texts of KF-GINS.
fn kf_gins(row: &[f64], step: f64) -> bool {
    let place = |row: &[f64]| row[0].abs() <= 90.0 && row[1].abs() <= 180.0 && row[2].abs() < 1e5;
    let stds = |row: &[f64]| row[..3].iter().all(|std| *std > 0.0 && *std < 1e3);
    match row.len() {
        7 => increments(&row[1..], step) || step > 0.05 && place(&row[1..]) && stds(&row[4..]),
        13 => place(&row[1..]) && stds(&row[7..]) && stds(&row[10..]),
        11 => {
            row[0].fract() == 0.0
                && (0.0..604_800.0).contains(&row[1])
                && place(&row[2..])
                && row[8..].iter().all(|angle| angle.abs() <= 360.0)
        }
        _ => false,
    }
}

/// Specific force of the order of gravity, turning less than ten full turns a second, faster than 10 Hz.
fn increments(row: &[f64], step: f64) -> bool {
    let force = row[3..].iter().map(|v| v * v).sum::<f64>().sqrt() / step;
    let turn = row[..3].iter().all(|angle| angle.abs() < 60.0 * step);
    step < 0.1 && turn && (3.0..30.0).contains(&force)
}

/// The first rows of a text of numbers with blanks between; none if there is anything else.
fn numbers(start: &[u8]) -> Vec<Vec<f64>> {
    let complete = start.iter().rposition(|byte| *byte == b'\n').unwrap_or(0);
    let mut rows = Vec::new();
    for line in start[..complete].split(|byte| *byte == b'\n').take(ROWS) {
        let fields = line
            .split(|byte| byte.is_ascii_whitespace())
            .filter(|field| !field.is_empty());
        match fields.map(number::parse).collect::<Option<Vec<f64>>>() {
            Some(row) if row.is_empty() => {}
            Some(row) => rows.push(row),
            None => return Vec::new(),
        }
    }
    rows
}

/// Columns of the first row of a text of numbers with blanks between; 0 for any other text.
pub(crate) fn width(start: &[u8]) -> usize {
    numbers(start).first().map_or(0, Vec::len)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_whose_columns_are_known() {
        let imu = "91620.000 1e-5 2e-5 -1e-5 0.001 -0.002 -0.0489\n91620.005 1e-5 2e-5 -1e-5 0.001 -0.002 -0.0489\n";
        let line = |k: u32, force: f64| format!("{} 0.01 0 0 0 0 {force}\n", f64::from(k) * 0.02);
        let first_zero: String = (0..20)
            .map(|k| line(k, if k == 0 { 0.0 } else { -0.2 }))
            .collect();
        let gnss = "456300.00 30.444787369 114.471863247 20.899 0.012 0.011 0.027\n456301.00 30.44 114.47 20.9 0.012 0.011 0.027\n";
        let both = "456300 30.4 114.4 20.9 1 2 0.1 0.01 0.01 0.02 0.05 0.05 0.05\n456301 30.4 114.4 20.9 1 2 0.1 0.01 0.01 0.02 0.05 0.05 0.05\n";
        let nav = "0 456300.005 30.44 114.47 20.9 0.1 0.2 0.0 0.85 -2.0 185.7\n0 456300.010 30.44 114.47 20.9 0.1 0.2 0.0 0.85 -2.0 185.7\n";
        for text in [imu, &first_zero, gnss, both, nav] {
            assert_eq!(detect_table(text.as_bytes()), Format::KfGins, "{text}");
        }
        let euroc = "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1]\n1403636579758555392,-0.1,0.2\n";
        assert_eq!(detect_table(euroc.as_bytes()), Format::Euroc);
        for text in [
            "",
            "1 2 3",
            "t gx gy gz fx fy fz\n1 2 3 4 5 6 7\n2 3 4 5 6 7 8\n",
            "1,2,3,4,5,6,7\n2,3,4,5,6,7,8\n",
            // Rates instead of increments.
            "0.000 0.01 0.02 0.01 0.1 0.2 -9.8\n0.005 0.01 0.02 0.01 0.1 0.2 -9.8\n",
            // Time goes back.
            "2 30 114 20 0.1 0.1 0.2\n1 30 114 20 0.1 0.1 0.2\n",
        ] {
            assert_eq!(detect_table(text.as_bytes()), Format::Csv, "{text}");
        }
    }
}
