//! Logs of telephones: GnssLogger's text and the folder of Sensor Logger.

use super::log::{Event, Fix, Log, START, Sample, UNIX};
use std::{
    fmt::Write as _,
    fs,
    path::{Path, PathBuf},
};

/// Standard deviation of one axis to the radius of 68 %: √(−2 ln 0.32).
const RADIUS: f64 = 1.509_592_185_452;

fn joined(values: &[f64]) -> String {
    let values: Vec<String> = values.iter().map(f64::to_string).collect();
    values.join(",")
}

/// Radius and vertical \[m\], speed [m/s] and bearing \[deg\]: a telephone has no more of their uncertainty.
fn accuracies(fix: &Fix) -> [f64; 4] {
    let [place, velocity] = fix.std;
    let horizontal = |std: &undrift::nav::Vector3| (0.5 * std.xy().norm_squared()).sqrt();
    let (speed, along) = (
        fix.course().map_or(0.0, |(speed, _)| speed),
        horizontal(&velocity),
    );
    let bearing = (along / speed.max(along).max(1e-3)).to_degrees();
    [RADIUS * horizontal(&place), place.z, along, bearing]
}

pub fn gnss_logger(log: &Log, folder: &Path) -> Vec<PathBuf> {
    const BOOT_NS: f64 = 123_456_000_000_000.0;
    let boot = |time: f64| (BOOT_NS + (time + START) * 1e9).round();
    let unix_ms = |time: f64| ((UNIX + START + time) * 1e3).round();
    let mut out = "\
# Header Description:
# Version: v3.0.6.4 Platform: 14 Manufacturer: Google Model: Pixel 7
# UncalAccel,utcTimeMillis,elapsedRealtimeNanos,UncalAccelXMps2,UncalAccelYMps2,UncalAccelZMps2,BiasXMps2,BiasYMps2,BiasZMps2
# UncalGyro,utcTimeMillis,elapsedRealtimeNanos,UncalGyroXRadPerSec,UncalGyroYRadPerSec,UncalGyroZRadPerSec,DriftXRadPerSec,DriftYRadPerSec,DriftZRadPerSec
# Fix,Provider,LatitudeDegrees,LongitudeDegrees,AltitudeMeters,SpeedMps,AccuracyMeters,BearingDegrees,UnixTimeMillis,SpeedAccuracyMps,BearingAccuracyDegrees,elapsedRealtimeNanos,VerticalAccuracyMeters,MockLocation
"
    .to_owned();
    for event in log.in_order() {
        match event {
            Event::Sample(Sample {
                time, gyro, accel, ..
            }) => {
                let (utc, boot) = (unix_ms(*time), boot(*time));
                for (name, values) in [("UncalAccel", accel), ("UncalGyro", gyro)] {
                    let _ = writeln!(
                        out,
                        "{name},{utc},{boot},{},0.0,0.0,0.0",
                        joined(values.as_slice())
                    );
                }
            }
            Event::Fix(fix) => {
                let (utc, boot) = (unix_ms(fix.time), boot(fix.time));
                let [horizontal, vertical, along, turn] = accuracies(fix);
                let (speed, bearing, along, turn) = match fix.course() {
                    Some((speed, course)) => (
                        speed.to_string(),
                        course.to_string(),
                        along.to_string(),
                        turn.to_string(),
                    ),
                    None => Default::default(),
                };
                let place = joined(&fix.place);
                let _ = writeln!(
                    out,
                    "Fix,GPS,{place},{speed},{horizontal},{bearing},{utc},{along},{turn},{boot},{vertical},0"
                );
            }
        }
    }
    let file = folder.join("phone.txt");
    fs::write(&file, out).unwrap();
    vec![file]
}

pub fn sensor_logger(log: &Log, folder: &Path) -> Vec<PathBuf> {
    let folder = folder.join("phone");
    fs::create_dir_all(&folder).unwrap();
    // Whole seconds and the rest apart: a double holds no Unix time to the nanosecond.
    let stamp = |time: f64| {
        (
            (UNIX + START) as i64 * 1_000_000_000 + (time * 1e9).round() as i64,
            time,
        )
    };
    let header = "time,seconds_elapsed,z,y,x\n";
    let [mut gyros, mut accels] = [header.to_owned(), header.to_owned()];
    for Sample {
        time, gyro, accel, ..
    } in &log.samples
    {
        let (ns, elapsed) = stamp(*time);
        for (out, v) in [(&mut gyros, gyro), (&mut accels, accel)] {
            let _ = writeln!(out, "{ns},{elapsed},{},{},{}", v.z, v.y, v.x);
        }
    }
    let mut places = "time,seconds_elapsed,bearingAccuracy,speedAccuracy,verticalAccuracy,horizontalAccuracy,speed,bearing,altitude,longitude,latitude\n".to_owned();
    for fix in &log.fixes {
        let ((ns, elapsed), [lat, lon, height]) = (stamp(fix.time), fix.place);
        let [horizontal, vertical, along, turn] = accuracies(fix);
        let motion = fix
            .course()
            .map_or([-1.0; 4], |(speed, course)| [speed, course, along, turn]);
        let [speed, bearing, along, turn] = motion;
        let _ = writeln!(
            places,
            "{ns},{elapsed},{turn},{along},{vertical},{horizontal},{speed},{bearing},{height},{lon},{lat}"
        );
    }
    for (name, text) in [
        ("Gyroscope", gyros),
        ("TotalAcceleration", accels),
        ("Location", places),
    ] {
        fs::write(folder.join(format!("{name}.csv")), text).unwrap();
    }
    vec![folder]
}
