//! Tables: delimited text in several fashions, Parquet, and the texts of KF-GINS, RTKLIB and NMEA.

use super::log::{Fix, Log, START, Sample, UNIX, WEEK, utc};
use std::{
    fmt::Write as _,
    fs,
    path::{Path, PathBuf},
};
use undrift::{
    io::epoch::{ClockSource, Epoch},
    io::write::{
        SolutionFile, SolutionFormat, SolutionOptions,
        parquet_table::{ParquetTableWriter, Value},
        solution::SolutionRow,
    },
    nav::{Vector3, earth::Geodetic},
};

const STANDARD_GRAVITY: f64 = 9.80665;

/// Two texts: of the samples and of the fixes.
fn two(folder: &Path, imu: &str, gnss: &str) -> Vec<PathBuf> {
    let files = [("imu.csv", imu), ("gnss.csv", gnss)];
    let write = |(name, text)| {
        let file = folder.join(name);
        fs::write(&file, text).unwrap();
        file
    };
    files.map(write).to_vec()
}

fn joined<'a>(values: impl IntoIterator<Item = &'a f64>, between: &str) -> String {
    let values: Vec<String> = values.into_iter().map(f64::to_string).collect();
    values.join(between)
}

/// Rates in deg/s, forces in g, velocities up: by the names of the columns.
pub fn degrees_and_g(log: &Log, folder: &Path) -> Vec<PathBuf> {
    let mut imu = "time_s,acc_x_g,acc_y_g,acc_z_g,gyro_x_dps,gyro_y_dps,gyro_z_dps\n".to_owned();
    for Sample {
        time, gyro, accel, ..
    } in &log.samples
    {
        let (gyro, accel) = (gyro.map(f64::to_degrees), accel / STANDARD_GRAVITY);
        let _ = writeln!(imu, "{time},{},{}", joined(&accel, ","), joined(&gyro, ","));
    }
    let velocities = log.fixes.iter().any(|fix| fix.velocity.is_some());
    let mut gnss = "time_s,latitude,longitude,height_m,std_n,std_e,std_d".to_owned();
    gnss += match velocities {
        true => ",vel_north,vel_east,vel_up,sdvn,sdve,sdvu\n",
        false => "\n",
    };
    for fix in &log.fixes {
        let up = Vector3::new(1.0, 1.0, -1.0);
        let [position, velocity] = fix.std.map(|std| joined(&std, ","));
        let _ = write!(gnss, "{},{},{position}", fix.time, joined(&fix.place, ","));
        if let Some(v) = fix.velocity {
            let _ = write!(gnss, ",{},{velocity}", joined(&v.component_mul(&up), ","));
        }
        gnss.push('\n');
    }
    two(folder, &imu, &gnss)
}

/// Semicolons, dates of ISO 8601, units in brackets, the gyro first, latitude behind longitude.
pub fn dates(log: &Log, folder: &Path) -> Vec<PathBuf> {
    let date = |time: f64| {
        let (day, hour, minute, second) = utc(time);
        format!("2025-07-{day:02}T{hour:02}:{minute:02}:{second:07.4}Z")
    };
    let mut imu =
        "timestamp;wx [rad/s];wy [rad/s];wz [rad/s];ax [m/s^2];ay [m/s^2];az [m/s^2]\n".to_owned();
    for Sample {
        time, gyro, accel, ..
    } in &log.samples
    {
        let _ = writeln!(
            imu,
            "{};{};{}",
            date(*time),
            joined(gyro, ";"),
            joined(accel, ";")
        );
    }
    let mut gnss =
        "timestamp;lon;lat;alt;vn;ve;vd;sigma_n;sigma_e;sigma_d;sigma_vn;sigma_ve;sigma_vd\n"
            .to_owned();
    for Fix {
        time,
        place: [lat, lon, height],
        velocity,
        std,
    } in &log.fixes
    {
        let velocity = velocity.map_or(";;".into(), |v| joined(&v, ";"));
        let [place, of_velocity] = std.map(|std| joined(&std, ";"));
        let _ = writeln!(
            gnss,
            "{};{lon};{lat};{height};{velocity};{place};{of_velocity}",
            date(*time)
        );
    }
    two(folder, &imu, &gnss)
}

/// Unix time in milliseconds, names without units, fixes without accuracies.
pub fn unix_ms(log: &Log, folder: &Path) -> Vec<PathBuf> {
    let ms = |time: f64| ((UNIX + START + time) * 1e3).round();
    let mut imu = "timestamp,AccX,AccY,AccZ,GyroX,GyroY,GyroZ,Temperature\n".to_owned();
    for Sample {
        time, gyro, accel, ..
    } in &log.samples
    {
        let gyro = gyro.map(f64::to_degrees);
        let _ = writeln!(
            imu,
            "{},{},{},25.5",
            ms(*time),
            joined(accel, ","),
            joined(&gyro, ",")
        );
    }
    let mut gnss = "timestamp,latitude,longitude,altitude,vel_n,vel_e,vel_d\n".to_owned();
    for Fix {
        time,
        place,
        velocity,
        ..
    } in &log.fixes
    {
        let velocity = velocity.map_or(",,".into(), |v| joined(&v, ","));
        let _ = writeln!(gnss, "{},{},{velocity}", ms(*time), joined(place, ","));
    }
    two(folder, &imu, &gnss)
}

pub fn parquet(log: &Log, folder: &Path) -> Vec<PathBuf> {
    let write = |name: &str, columns: &[&str], rows: Vec<Vec<f64>>| {
        let file = folder.join(name);
        let columns = columns
            .iter()
            .map(|name| (*name, Value::Exact(0.0)))
            .collect();
        let mut out = ParquetTableWriter::create(&file, columns).unwrap();
        for row in rows {
            out.write(row.into_iter().map(Value::Exact)).unwrap();
        }
        out.finish().unwrap();
        file
    };
    let samples = log.samples.iter().map(|sample| {
        let values = sample.gyro.iter().chain(&sample.accel);
        [sample.time].iter().chain(values).copied().collect()
    });
    let names = [
        "time", "gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z",
    ];
    let imu = write("imu.parquet", &names, samples.collect());
    let fixes = log.fixes.iter().map(|fix| {
        let velocity = fix.velocity.iter().flat_map(|v| v.iter());
        let values = fix.place.iter().chain(&fix.std[0]).chain(velocity);
        [fix.time].iter().chain(values).copied().collect()
    });
    let names = [
        "time", "lat", "lon", "height", "std_n", "std_e", "std_d", "vn", "ve", "vd",
    ];
    let velocities = log.fixes.iter().any(|fix| fix.velocity.is_some());
    let names = if velocities { &names[..] } else { &names[..7] };
    let gnss = write("gnss.parquet", names, fixes.collect());
    vec![imu, gnss]
}

/// Increments; fixes with 13 columns, without velocities 7.
pub fn kf_gins(log: &Log, folder: &Path) -> Vec<PathBuf> {
    let mut imu = String::new();
    let usual = log.samples[log.samples.len() / 2].dt;
    for Sample {
        time,
        dt,
        gyro,
        accel,
    } in &log.samples
    {
        // Behind a gap what one interval collected.
        let dt = if *dt < 1.5 * usual { *dt } else { usual };
        let _ = writeln!(
            imu,
            "{time} {} {}",
            joined(&(gyro * dt), " "),
            joined(&(accel * dt), " ")
        );
    }
    let mut gnss = String::new();
    for Fix {
        time,
        place,
        velocity,
        std: [position, of_velocity],
    } in &log.fixes
    {
        let _ = write!(gnss, "{time} {}", joined(place, " "));
        if let Some(velocity) = velocity {
            let _ = write!(gnss, " {} {}", joined(velocity, " "), joined(position, " "));
        }
        let last = if velocity.is_some() {
            of_velocity
        } else {
            position
        };
        let _ = writeln!(gnss, " {}", joined(last, " "));
    }
    two(folder, &imu, &gnss)
}

/// Samples beside fixes of a format without them, in seconds of the GPS week.
fn samples(log: &Log) -> String {
    let mut imu = "gps_sow_s,gx_radps,gy_radps,gz_radps,ax_mps2,ay_mps2,az_mps2\n".to_owned();
    for Sample {
        time, gyro, accel, ..
    } in &log.samples
    {
        let _ = writeln!(
            imu,
            "{},{},{}",
            time + START,
            joined(gyro, ","),
            joined(accel, ",")
        );
    }
    imu
}

pub fn rtklib(log: &Log, folder: &Path) -> Vec<PathBuf> {
    let mut pos =
        "%  GPST latitude(deg) longitude(deg) height(m) Q ns sdn(m) sde(m) sdu(m)".to_owned();
    let velocities = log.fixes.iter().any(|fix| fix.velocity.is_some());
    pos += match velocities {
        true => " vn(m/s) ve(m/s) vu(m/s) sdvn sdve sdvu\n",
        false => "\n",
    };
    for Fix {
        time,
        place,
        velocity,
        std: [position, of_velocity],
    } in &log.fixes
    {
        // GPS time, not UTC.
        let (day, hour, minute, second) = utc(time + super::log::LEAP);
        let _ = write!(
            pos,
            "2025/07/{day:02} {hour:02}:{minute:02}:{second:07.4} {} 5 9 {}",
            joined(place, " "),
            joined(position, " ")
        );
        if let Some(v) = velocity {
            let _ = write!(
                pos,
                " {} {} {} {}",
                v.x,
                v.y,
                -v.z,
                joined(of_velocity, " ")
            );
        }
        pos.push('\n');
    }
    two(folder, &samples(log), &pos)
}

pub fn nmea(log: &Log, folder: &Path) -> Vec<PathBuf> {
    let file = folder.join("gnss.nmea");
    let options = SolutionOptions {
        epoch: Some(Epoch::of_week(WEEK, ClockSource::Gnss)),
        every: Some(0.0),
        ..SolutionOptions::default()
    };
    let mut out = SolutionFile::create(&file, SolutionFormat::Nmea, &options).unwrap();
    for Fix {
        time,
        place: [lat, lon, height],
        velocity,
        std,
    } in &log.fixes
    {
        let mut row = SolutionRow::at(time + START, Geodetic::from_degrees(*lat, *lon, *height));
        row.v_n = velocity.unwrap_or(row.v_n);
        row.nav_std[..3].copy_from_slice(std[0].as_slice());
        out.write(&row, false).unwrap();
    }
    out.finish().unwrap();
    let imu = folder.join("imu.csv");
    fs::write(&imu, samples(log)).unwrap();
    vec![imu, file]
}
