//! Logs of autopilots: PX4's ULog, the text of ArduPilot's DataFlash, MAVLink.

use super::log::{Event, Fix, Log, START, Sample, WEEK, week_ms};
use std::{
    fmt::Write as _,
    fs,
    path::{Path, PathBuf},
};
use undrift::nav::Vector3;

fn micros(time: f64) -> u64 {
    ((time + START) * 1e6).round() as u64
}

/// One number each for the horizontal axes of a position \[m\] and for a velocity [m/s], which the autopilots take for each axis.
fn each(place: &Vector3, velocity: &Vector3) -> (f64, f64) {
    (
        place.x.hypot(place.y) / 2f64.sqrt(),
        velocity.norm() / 3f64.sqrt(),
    )
}

/// sensor_combined and sensor_gps as PX4 1.14 defines them.
pub fn ulog(log: &Log, folder: &Path) -> Vec<PathBuf> {
    let mut out = b"ULog\x01\x12\x35\x01".to_vec();
    pack!(out; micros(log.samples[0].time.min(log.fixes[0].time)));
    let mut message = |kind: u8, body: &[u8]| {
        pack!(out; body.len() as u16, kind);
        out.extend(body);
    };
    message(b'B', &[0; 40]);
    message(
        b'F',
        b"sensor_combined:uint64_t timestamp;float[3] gyro_rad;uint32_t gyro_integral_dt;\
          int32_t accelerometer_timestamp_relative;float[3] accelerometer_m_s2;uint32_t accelerometer_integral_dt;\
          uint8_t accelerometer_clipping;uint8_t[3] _padding0;",
    );
    message(
        b'F',
        b"sensor_gps:uint64_t timestamp;uint64_t timestamp_sample;double latitude_deg;double longitude_deg;\
          double altitude_msl_m;double altitude_ellipsoid_m;uint32_t device_id;float s_variance_m_s;float eph;float epv;\
          float vel_n_m_s;float vel_e_m_s;float vel_d_m_s;uint8_t fix_type;bool vel_ned_valid;uint8_t[2] _padding0;",
    );
    message(b'A', b"\x00\x00\x00sensor_combined");
    message(b'A', b"\x00\x01\x00sensor_gps");
    for event in log.in_order() {
        let mut body = Vec::new();
        match event {
            Event::Sample(Sample {
                time,
                dt,
                gyro,
                accel,
            }) => {
                let dt = (dt * 1e6).round() as u32;
                let [gx, gy, gz]: [f32; 3] = gyro.map(|x| x as f32).into();
                let [ax, ay, az]: [f32; 3] = accel.map(|x| x as f32).into();
                pack!(body; 0u16, micros(*time), gx, gy, gz, dt, 0i32, ax, ay, az, dt, 0u8);
            }
            Event::Fix(Fix {
                time,
                place: [lat, lon, height],
                velocity,
                std: [place, of_velocity],
            }) => {
                let micros = micros(*time);
                let [n, e, d]: [f32; 3] = velocity.unwrap_or_default().map(|x| x as f32).into();
                let (horizontal, all) = each(place, of_velocity);
                pack!(body; 1u16, micros, micros, *lat, *lon, *height, *height, 3u32);
                pack!(body; all as f32, horizontal as f32, place.z as f32, n, e, d, 3u8, u8::from(velocity.is_some()));
            }
        }
        message(b'D', &body);
    }
    let file = folder.join("drive.ulg");
    fs::write(&file, out).unwrap();
    vec![file]
}

/// IMU, GPS and GPA as text.
pub fn dataflash(log: &Log, folder: &Path) -> Vec<PathBuf> {
    let mut out = "\
FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns
FMT, 173, 36, IMU, QBffffff, TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ
FMT, 174, 51, GPS, QBBIHBcLLeffffB, TimeUS,I,Status,GMS,GWk,NSats,HDop,Lat,Lng,Alt,Spd,GCrs,VZ,Yaw,U
FMT, 175, 21, GPA, QBCCCCB, TimeUS,I,VDop,HAcc,VAcc,SAcc,VV
"
    .to_owned();
    for event in log.in_order() {
        match event {
            Event::Sample(Sample {
                time,
                gyro: g,
                accel: a,
                ..
            }) => {
                let _ = writeln!(
                    out,
                    "IMU, {}, 0, {}, {}, {}, {}, {}, {}",
                    micros(*time),
                    g.x as f32,
                    g.y as f32,
                    g.z as f32,
                    a.x as f32,
                    a.y as f32,
                    a.z as f32
                );
            }
            Event::Fix(fix) => {
                let ([lat, lon, height], now) = (fix.place, micros(fix.time));
                let (speed, course) = fix.course().unwrap_or_default();
                let down = fix.velocity.unwrap_or_default().z;
                let _ = writeln!(
                    out,
                    "GPS, {now}, 0, 3, {}, {WEEK}, 14, 0.70, {lat:.7}, {lon:.7}, {height:.2}, {}, {}, {}, 0, 1",
                    week_ms(fix.time),
                    speed as f32,
                    course as f32,
                    down as f32
                );
                let [place, velocity] = fix.std;
                let (horizontal, all) = each(&place, &velocity);
                let valid = u8::from(fix.velocity.is_some());
                let _ = writeln!(
                    out,
                    "GPA, {now}, 0, 1.20, {horizontal:.2}, {:.2}, {all:.2}, {valid}",
                    place.z
                );
            }
        }
    }
    let file = folder.join("drive.log");
    fs::write(&file, out).unwrap();
    vec![file]
}

/// HIGHRES_IMU and GPS_RAW_INT of MAVLink 2, with a HEARTBEAT now and then.
pub fn mavlink(log: &Log, folder: &Path) -> Vec<PathBuf> {
    const UNKNOWN: u16 = u16::MAX;
    let mut out = Vec::new();
    let mut sequence = 0u8;
    let mut message = |number: u32, extra: u8, body: &[u8]| {
        let end = body
            .iter()
            .rposition(|byte| *byte != 0)
            .map_or(1, |at| at + 1);
        let mut covered = vec![end as u8, 0, 0, sequence, 1, 1];
        sequence = sequence.wrapping_add(1);
        covered.extend(&number.to_le_bytes()[..3]);
        covered.extend(&body[..end]);
        let sum = covered
            .iter()
            .chain([&extra])
            .fold(0xFFFF_u16, |sum, byte| {
                (0..8).fold(sum ^ u16::from(*byte), |sum, _| {
                    sum >> 1 ^ if sum & 1 == 1 { 0x8408 } else { 0 }
                })
            });
        out.push(0xFD);
        out.extend(covered);
        pack!(out; sum);
    };
    for (k, event) in log.in_order().enumerate() {
        let mut body = Vec::new();
        match event {
            Event::Sample(Sample {
                time, gyro, accel, ..
            }) => {
                pack!(body; micros(*time));
                for value in accel.iter().chain(gyro.iter()).copied().chain([0.0; 7]) {
                    pack!(body; value as f32);
                }
                pack!(body; 0x3Fu16, 0u8);
                message(105, 93, &body);
            }
            Event::Fix(fix) => {
                let [lat, lon] = [0, 1].map(|k| (fix.place[k] * 1e7).round() as i32);
                let height = (fix.place[2] * 1e3).round() as i32;
                let (speed, course) = fix.course().map_or((UNKNOWN, UNKNOWN), |(speed, course)| {
                    (
                        (speed * 100.0).round() as u16,
                        (course * 100.0).round() as u16 % 36_000,
                    )
                });
                let [place, velocity] = fix.std.map(|std| std * 1e3);
                let [h, v, s] = [
                    place.x.hypot(place.y),
                    place.z,
                    velocity.x.hypot(velocity.y),
                ]
                .map(|std| std.round() as u32);
                pack!(body; micros(fix.time), lat, lon, height, 80u16, 120u16, speed, course, 3u8, 12u8);
                pack!(body; height, h, v, s, 0u32, 0u16);
                message(24, 24, &body);
            }
        }
        if k % 500 == 0 {
            message(0, 50, &[0, 0, 0, 0, 2, 3, 0, 4, 3]);
        }
    }
    let file = folder.join("drive.mavlink");
    fs::write(&file, out).unwrap();
    vec![file]
}
