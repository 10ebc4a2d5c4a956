//! Speed of reading and writing on this machine: `cargo run --release -p undrift-io --example speed`.

use std::fmt::Write as _;
use std::io::{Cursor, Read};
use std::path::Path;
use std::time::Instant;

use undrift_io::imu::{ImuFormat, ImuReader};
use undrift_io::source;
use undrift_io::table::{Column, Table, TableOptions};
use undrift_io::write::solution::{SolutionRow, SolutionWriter};
use undrift_nav::{Vector3, earth::Geodetic};

const ROWS: usize = 1_000_000;

fn main() {
    for (name, decimals) in [("short", [3, 5]), ("long", [9, 9])] {
        let text = table(decimals);
        let megabytes = text.len() as f64 / 1e6;
        let rows = best(|| read_table(&text));
        println!("table, {name} numbers: {:.0} MB/s", megabytes / rows);
        let samples = best(|| read_imu(&text));
        println!(
            "inertial samples, {name} numbers: {:.0} MB/s",
            megabytes / samples
        );
    }
    let text = table([17, 17]);
    let seconds = best(|| read_table(&text));
    println!(
        "table, 18 digits: {:.0} MB/s",
        text.len() as f64 / 1e6 / seconds
    );
    for file in std::env::args().skip(1) {
        let path = Path::new(&file);
        let mut size = 0;
        let inflate = best(|| {
            let mut bytes = Vec::new();
            size = source::open(path).unwrap().read_to_end(&mut bytes).unwrap();
        });
        let all = best(|| drain(Table::open(path, &columns(1..=6)).unwrap()));
        let megabytes = size as f64 / 1e6;
        println!(
            "{file}: {:.0} MB/s of text, {:.0} MB/s decompressed only",
            megabytes / all,
            megabytes / inflate
        );
    }
    let seconds = best(write_solution);
    println!("solution row: {:.0} ns", seconds / ROWS as f64 * 1e9);
}

fn best(mut work: impl FnMut()) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..5 {
        let start = Instant::now();
        work();
        best = best.min(start.elapsed().as_secs_f64());
    }
    best
}

fn table([time_decimals, decimals]: [usize; 2]) -> String {
    let mut text = String::from("t,gx,gy,gz,ax,ay,az\n");
    let mut state = 1u64;
    for k in 0..ROWS {
        let _ = write!(text, "{:.*}", time_decimals.min(9), k as f64 * 0.005);
        for axis in 0..6 {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            let unit = (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
            let size = if axis < 3 { 0.1 } else { 20.0 };
            let _ = write!(text, ",{:.decimals$}", unit * size);
        }
        text.push('\n');
    }
    text
}

fn columns(numbers: std::ops::RangeInclusive<usize>) -> TableOptions {
    TableOptions {
        columns: numbers
            .map(|n| ("column".into(), Column::Number(n)))
            .collect(),
        ..TableOptions::default()
    }
}

fn read_table(text: &str) {
    let source = Box::new(Cursor::new(text.as_bytes().to_vec()));
    drain(Table::from_source(Path::new("speed.csv"), source, &columns(1..=7)).unwrap());
}

fn drain(mut table: Table) {
    let width = if table.path().as_os_str() == "speed.csv" {
        7
    } else {
        6
    };
    let (mut row, mut sum) = ([0.0; 7], 0.0);
    while table.next_row(&mut row[..width]).unwrap().is_some() {
        sum += row[1];
    }
    assert!(sum.is_finite() && table.rows_seen() > 0);
}

fn read_imu(text: &str) {
    let n = Column::Number;
    let format = ImuFormat::new(Some(n(1)), [n(2), n(3), n(4)], [n(5), n(6), n(7)]);
    let source = Box::new(Cursor::new(text.as_bytes().to_vec()));
    let reader = ImuReader::from_source(Path::new("speed.csv"), source, &format).unwrap();
    let count = reader.filter(Result::is_ok).count();
    assert_eq!(count, ROWS);
}

fn write_solution() {
    let mut writer = SolutionWriter::new(std::io::sink()).unwrap();
    for k in 0..ROWS {
        let t = k as f64 * 0.005;
        let small = (k % 1000) as f64 * 1.237e-4;
        let row = SolutionRow {
            time: t,
            position: Geodetic::from_degrees(40.096 + small, -105.147 - small, 1600.1 + small),
            v_n: Vector3::new(15.0 + small, -3.0 - small, small),
            rpy: Vector3::new(small, -small, 1.0 + small),
            nav_std: [0.1 + small; 9],
            gyro_error: Vector3::repeat(1e-3 + small),
            accel_error: Vector3::repeat(-0.05 - small),
            error_std: [1e-4 + small; 6],
        };
        writer.write(&row).unwrap();
    }
    writer.into_inner().unwrap();
}
