//! Reading CSV text as a table and into inertial samples, and writing the solution.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::{fmt::Write as _, io::Cursor, path::Path, time::Duration};
use undrift_io::{
    Opened, ReadError,
    imu::{ImuFormat, ImuReader},
    table::{Column, TableOptions},
    write::{TextWriter, solution::SolutionRow},
};
use undrift_nav::{Vector3, earth::Geodetic};

const ROWS: usize = 20_000;

/// Six columns of noise behind a time, so many decimals.
fn text([time_decimals, decimals]: [usize; 2]) -> String {
    let mut text = String::from("t,gx,gy,gz,ax,ay,az\n");
    let mut state = 1u64;
    for k in 0..ROWS {
        let _ = write!(text, "{:.time_decimals$}", k as f64 * 0.005);
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

fn read(c: &mut Criterion) {
    let n = Column::Number;
    let format = ImuFormat::new(Some(n(1)), [n(2), n(3), n(4)], [n(5), n(6), n(7)]);
    let columns = TableOptions {
        columns: (1..=7).map(|k| ("column".into(), n(k))).collect(),
        ..TableOptions::default()
    };
    let mut group = c.benchmark_group("CSV");
    for (numbers, decimals) in [("short", [3, 5]), ("long", [9, 9]), ("18 digits", [9, 17])] {
        let text = text(decimals);
        let source = || Box::new(Cursor::new(text.clone().into_bytes()));
        group.throughput(Throughput::Bytes(text.len() as u64));
        group.bench_function(format!("table, {numbers} numbers"), |b| {
            b.iter(|| -> Result<u64, ReadError> {
                let mut table = Opened::stream(Path::new("imu.csv"), source())?.table(&columns)?;
                let mut row = [0.0; 7];
                while table.next_row(&mut row)?.is_some() {}
                Ok(table.rows_seen())
            })
        });
        group.bench_function(format!("inertial samples, {numbers} numbers"), |b| {
            b.iter(|| {
                let opened = Opened::stream(Path::new("imu.csv"), source())?;
                let reader = ImuReader::new(opened, &format);
                reader.map(|samples| samples.filter(Result::is_ok).count())
            })
        });
    }
}

fn write(c: &mut Criterion) {
    let mut group = c.benchmark_group("CSV");
    group.throughput(Throughput::Elements(ROWS as u64));
    group.bench_function("rows of the solution", |b| {
        b.iter(|| -> std::io::Result<()> {
            let mut writer = TextWriter::csv(std::io::sink());
            for k in 0..ROWS {
                let small = (k % 1000) as f64 * 1.237e-4;
                let row = SolutionRow {
                    time: k as f64 * 0.005,
                    position: Geodetic::from_degrees(40.1 + small, -105.1 - small, 1600.1 + small),
                    v_n: Vector3::new(15.0 + small, -3.0 - small, small),
                    rpy: Vector3::new(small, -small, 1.0 + small),
                    nav_std: [0.1 + small; 9],
                    gyro_error: Vector3::repeat(1e-3 + small),
                    accel_error: Vector3::repeat(-0.05 - small),
                    error_std: [1e-4 + small; 6],
                };
                writer.write(&row, false)?;
            }
            writer.into_inner().map(drop)
        })
    });
}

criterion_group! {
    name = all;
    config = Criterion::default().sample_size(20).measurement_time(Duration::from_secs(2)).warm_up_time(Duration::from_millis(300));
    targets = read, write
}
criterion_main!(all);
