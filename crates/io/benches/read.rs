//! Reading inertial samples from CSV text, and writing the solution.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::{fmt::Write as _, io::Cursor, path::Path, time::Duration};
use undrift_io::{
    imu::{ImuFormat, ImuReader},
    table::Column,
    write::solution::{SolutionRow, SolutionWriter},
};
use undrift_nav::{Vector3, earth::Geodetic};

const ROWS: usize = 20_000;

fn read(c: &mut Criterion) {
    let mut text = String::from("t,gx,gy,gz,ax,ay,az\n");
    for k in 0..ROWS {
        let (time, small) = (k as f64 * 0.005, (k * 7919 % 1000) as f64 * 1.237e-5);
        let _ = writeln!(
            text,
            "{time:.3},{small:.9},{:.9},{:.9},{:.9},{:.9},{:.9}",
            -small,
            small + 1e-3,
            small + 0.3,
            small - 0.2,
            small - 9.8
        );
    }
    let n = Column::Number;
    let format = ImuFormat::new(Some(n(1)), [n(2), n(3), n(4)], [n(5), n(6), n(7)]);
    let mut group = c.benchmark_group("CSV");
    group.throughput(Throughput::Bytes(text.len() as u64));
    group.bench_function("inertial samples", |b| {
        b.iter(|| {
            let source = Box::new(Cursor::new(text.clone().into_bytes()));
            let reader = ImuReader::from_source(Path::new("imu.csv"), source, &format);
            reader.map(|samples| samples.filter(Result::is_ok).count())
        })
    });
}

fn write(c: &mut Criterion) {
    let mut group = c.benchmark_group("CSV");
    group.throughput(Throughput::Elements(ROWS as u64));
    group.bench_function("rows of the solution", |b| {
        b.iter(|| -> std::io::Result<()> {
            let mut writer = SolutionWriter::new(std::io::sink())?;
            for k in 0..ROWS {
                let small = (k % 1000) as f64 * 1.237e-4;
                writer.write(&SolutionRow {
                    time: k as f64 * 0.005,
                    position: Geodetic::from_degrees(40.1 + small, -105.1 - small, 1600.1 + small),
                    v_n: Vector3::new(15.0 + small, -3.0 - small, small),
                    rpy: Vector3::new(small, -small, 1.0 + small),
                    nav_std: [0.1 + small; 9],
                    gyro_error: Vector3::repeat(1e-3 + small),
                    accel_error: Vector3::repeat(-0.05 - small),
                    error_std: [1e-4 + small; 6],
                })?;
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
