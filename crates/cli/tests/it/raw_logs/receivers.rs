//! Logs of receivers with an IMU: UBX, NovAtel's ASCII, Septentrio's SBF.

use super::log::{Event, Fix, Log, START, Sample, WEEK, utc, week_ms};
use std::{
    fmt::Write as _,
    fs,
    path::{Path, PathBuf},
};
use undrift::nav::Vector3;

fn one(folder: &Path, name: &str, content: impl AsRef<[u8]>) -> Vec<PathBuf> {
    let file = folder.join(name);
    fs::write(&file, content).unwrap();
    vec![file]
}

fn rounded(values: &Vector3, unit: f64) -> [i32; 3] {
    (values / unit).map(|value| value.round() as i32).into()
}

fn ubx_message(out: &mut Vec<u8>, kind: [u8; 2], payload: &[u8]) {
    let mut body = kind.to_vec();
    pack!(body; payload.len() as u16);
    body.extend(payload);
    let (mut a, mut b) = (0u8, 0u8);
    for byte in &body {
        a = a.wrapping_add(*byte);
        b = b.wrapping_add(a);
    }
    out.extend([0xB5, 0x62]);
    out.extend(body);
    out.extend([a, b]);
}

/// ESF-RAW of one sample each; NAV-PVT, or NAV-SOL with NAV-POSLLH where there are no velocities.
pub fn ubx(log: &Log, folder: &Path) -> Vec<PathBuf> {
    const TICK: f64 = 39.0625e-6;
    let mut out = Vec::new();
    for event in log.in_order() {
        match event {
            Event::Sample(Sample {
                time, gyro, accel, ..
            }) => {
                let tag = ((time + START) / TICK).round() as u64 as u32 & 0x00FF_FFFF;
                let rates = rounded(&gyro.map(f64::to_degrees), 1.0 / 4096.0);
                let forces = rounded(accel, 1.0 / 1024.0);
                let mut payload = vec![0; 4];
                for (kind, value) in [14u32, 13, 5, 16, 17, 18]
                    .into_iter()
                    .zip([rates, forces].concat())
                {
                    pack!(payload; kind << 24 | value as u32 & 0x00FF_FFFF, tag);
                }
                ubx_message(&mut out, [0x10, 0x03], &payload);
            }
            Event::Fix(fix) => ubx_fix(&mut out, fix),
        }
    }
    one(folder, "drive.ubx", out)
}

fn ubx_fix(out: &mut Vec<u8>, fix: &Fix) {
    let ms = week_ms(fix.time);
    let [lat, lon] = [fix.place[0], fix.place[1]].map(|angle| (angle * 1e7).round() as i32);
    let height = (fix.place[2] * 1e3).round() as i32;
    let mm = |metres: f64| (metres * 1e3).round() as u32;
    let (horizontal, vertical) = (mm(fix.std[0].x.hypot(fix.std[0].y)), mm(fix.std[0].z));
    let Some(velocity) = fix.velocity else {
        let mut solution = Vec::new();
        pack!(solution; ms, 0i32, WEEK as i16, 3u8, 0b1101u8);
        pack!(solution; 0i32, 0i32, 0i32, 100u32, 0i32, 0i32, 0i32, 30u32, 180u16, 0u8, 9u8, 0u32);
        ubx_message(out, [0x01, 0x06], &solution);
        let mut place = Vec::new();
        pack!(place; ms, lon, lat, height, height, horizontal, vertical);
        return ubx_message(out, [0x01, 0x02], &place);
    };
    let (day, hour, minute, second) = utc(fix.time);
    let nano = (second.fract() * 1e9).round() as i32;
    let [n, e, d] = rounded(&velocity, 1e-3);
    let mut payload = Vec::new();
    pack!(payload; ms, 2025u16, 7u8, day as u8, hour as u8, minute as u8, second as u8, 7u8, 25u32, nano);
    pack!(payload; 3u8, 1u8, 0u8, 17u8, lon, lat, height, height, horizontal, vertical, n, e, d, 0i32, 0i32);
    pack!(payload; mm(fix.std[1].norm() / 3f64.sqrt()), 0u32, 150u16, 0u16, 0u32, 0i32, 0u32);
    ubx_message(out, [0x01, 0x07], &payload);
}

/// RAWIMUSX of an Epson G370, BESTPOS and BESTVEL.
pub fn novatel(log: &Log, folder: &Path) -> Vec<PathBuf> {
    let gyro_unit = 0.015_151_5f64.to_radians() / 65_536.0;
    let accel_unit = 0.4e-3 * 9.80665 / 65_536.0;
    let mut out = String::new();
    for event in log.in_order() {
        match event {
            Event::Sample(Sample {
                time, gyro, accel, ..
            }) => {
                let seconds = time + START;
                let [gx, gy, gz] = rounded(gyro, gyro_unit);
                let [ax, ay, az] = rounded(accel, accel_unit);
                let text = format!(
                    "RAWIMUSXA,{WEEK},{seconds:.3};00,61,{WEEK},{seconds:.6},00000000,{az},{},{ax},{gz},{},{gx}",
                    -ay, -gy
                );
                let _ = writeln!(out, "%{text}*{:08x}\r", crc_32(text.as_bytes()));
            }
            Event::Fix(fix) => {
                let mut message = |name: &str, body: String| {
                    let seconds = fix.time + START;
                    let text = format!(
                        "{name}A,COM1,0,58.5,FINESTEERING,{WEEK},{seconds:.3},02000020,cdba,16809;SOL_COMPUTED,SINGLE,{body}"
                    );
                    let _ = writeln!(out, "#{text}*{:08x}\r", crc_32(text.as_bytes()));
                };
                let ([lat, lon, height], std) = (fix.place, fix.std[0]);
                let satellites = "\"TSTR\",0.000,0.000,20,19,19,18,00,00,7f,37";
                let body = format!(
                    "{lat},{lon},{height},0.0,WGS84,{},{},{},{satellites}",
                    std.x, std.y, std.z
                );
                message("BESTPOS", body);
                if let (Some(velocity), Some((speed, course))) = (fix.velocity, fix.course()) {
                    message(
                        "BESTVEL",
                        format!("0.000,0.000,{speed},{course},{},0.0", -velocity.z),
                    );
                }
            }
        }
    }
    one(folder, "drive.asc", out)
}

/// As NovAtel's: it begins with 0 and is not inverted.
fn crc_32(bytes: &[u8]) -> u32 {
    let mut crc = 0_u32;
    for byte in bytes {
        crc ^= u32::from(*byte);
        for _ in 0..8 {
            crc = crc >> 1 ^ if crc & 1 == 1 { 0xEDB8_8320 } else { 0 };
        }
    }
    crc
}

/// ExtSensorMeas, PVTGeodetic, PosCovGeodetic and VelCovGeodetic.
pub fn sbf(log: &Log, folder: &Path) -> Vec<PathBuf> {
    const UNKNOWN: f32 = -2e10;
    let mut out = Vec::new();
    for event in log.in_order() {
        let mut body = Vec::new();
        match event {
            Event::Sample(Sample {
                time, gyro, accel, ..
            }) => {
                pack!(body; 2u8, 28u8);
                for (kind, values) in [(0u8, *accel), (1, gyro.map(f64::to_degrees))] {
                    pack!(body; 1u8, 11u8, kind, 0u8, values.x, values.y, values.z);
                }
                sbf_block(&mut out, 4050, *time, &body);
            }
            Event::Fix(fix) => {
                let [lat, lon, height] = fix.place;
                let up = fix.velocity.map(|v| [v.x as f32, v.y as f32, -v.z as f32]);
                let [vn, ve, vu] = up.unwrap_or([UNKNOWN; 3]);
                pack!(body; 1u8, 0u8, lat.to_radians(), lon.to_radians(), height, 0f32, vn, ve, vu, 0f32, 0f64, 0f32);
                pack!(body; 0u8, 0u8, 20u8, 0u8, 0u16, 100u16, 0u32, 0u8);
                sbf_block(&mut out, 4007, fix.time, &body);
                for (number, std) in [(5906, fix.std[0]), (5908, fix.std[1])] {
                    if number == 5908 && fix.velocity.is_none() {
                        continue;
                    }
                    let [n, e, u]: [f32; 3] = std.map(|std| (std * std) as f32).into();
                    let mut body = Vec::new();
                    pack!(body; 1u8, 0u8, n, e, u, 1f32, 0f32, 0f32, 0f32, 0f32, 0f32, 0f32);
                    sbf_block(&mut out, number, fix.time, &body);
                }
            }
        }
    }
    one(folder, "drive.sbf", out)
}

fn sbf_block(out: &mut Vec<u8>, number: u16, time: f64, body: &[u8]) {
    let mut covered = Vec::new();
    let length = (8 + 6 + body.len()).next_multiple_of(4);
    pack!(covered; number, length as u16, week_ms(time), WEEK as u16);
    covered.extend(body);
    covered.resize(length - 4, 0);
    let mut crc = 0_u16;
    for byte in &covered {
        crc ^= u16::from(*byte) << 8;
        for _ in 0..8 {
            crc = crc << 1 ^ if crc >> 15 == 1 { 0x1021 } else { 0 };
        }
    }
    out.extend(b"$@");
    pack!(*out; crc);
    out.extend(covered);
}
