//! Reading and writing text.

use std::{fmt::Write as _, hint::black_box, io::Cursor, path::Path};
use undrift::io::{
    Opened,
    imu::{ImuFormat, ImuReader},
    table::{Column, TableOptions},
    write::{TextWriter, solution::SolutionRow},
};
use undrift::nav::{Vector3, earth::Geodetic};

pub fn run(task: &str, rows: u32) -> Result<(), Box<dyn std::error::Error>> {
    let rows = rows as usize;
    match task {
        "text" => drop(black_box(text(rows))),
        "table" => table(&text(rows))?,
        "imu" => imu(&text(rows))?,
        "solution" => solution(rows)?,
        _ => return Err(format!("no task {task}").into()),
    }
    Ok(())
}

/// A log of 80 bytes a row, from a few rows over and over so that it costs little to make.
fn text(rows: usize) -> String {
    let mut text = String::from("t,gx,gy,gz,ax,ay,az\n");
    for k in 0..rows {
        let _ = write!(text, "{}.{:03}", 100_000 + k / 200, k % 200 * 5);
        text.push_str(
            ",0.012345678,-0.002345671,0.000123456,1.234567890,-0.987654321,-9.801234567\n",
        );
    }
    text
}

fn table(text: &str) -> Result<(), Box<dyn std::error::Error>> {
    let options = TableOptions {
        columns: (1..=7)
            .map(|n| ("column".into(), Column::Number(n)))
            .collect(),
        ..TableOptions::default()
    };
    let source = Box::new(Cursor::new(text.as_bytes().to_vec()));
    let mut table = Opened::stream(Path::new("hot.csv"), source)?.table(&options)?;
    let mut row = [0.0; 7];
    while table.next_row(&mut row)?.is_some() {
        black_box(&row);
    }
    Ok(())
}

fn imu(text: &str) -> Result<(), Box<dyn std::error::Error>> {
    let n = Column::Number;
    let format = ImuFormat::new(Some(n(1)), [n(2), n(3), n(4)], [n(5), n(6), n(7)]);
    let source = Box::new(Cursor::new(text.as_bytes().to_vec()));
    for sample in ImuReader::new(Opened::stream(Path::new("hot.csv"), source)?, &format)? {
        black_box(sample?);
    }
    Ok(())
}

fn solution(rows: usize) -> Result<(), Box<dyn std::error::Error>> {
    let mut writer = TextWriter::csv(std::io::sink());
    for k in 0..rows {
        let small = (k % 1000) as f64 * 1.237e-4;
        let row = SolutionRow {
            time: k as f64 * 0.005,
            position: Geodetic::from_degrees(40.096 + small, -105.147 - small, 1600.1 + small),
            v_n: Vector3::new(15.0 + small, -3.0 - small, small),
            rpy: Vector3::new(small, -small, 1.0 + small),
            nav_std: [0.1 + small; 9],
            gyro_error: Vector3::repeat(1e-3 + small),
            accel_error: Vector3::repeat(-0.05 - small),
            error_std: [1e-4 + small; 6],
        };
        writer.write(&row, false)?;
    }
    writer.into_inner()?;
    Ok(())
}
