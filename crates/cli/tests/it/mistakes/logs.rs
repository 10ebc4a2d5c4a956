//! Logs as other programs write them. Most of these once failed or misled.

use super::{
    Case, Log, Mistake,
    cases::{HEADER, record},
    drive, mistake,
};
use crate::bad_input::log::{Row, table};

/// Standard gravity \[m/s²\].
const GRAVITY: f64 = 9.80665;

/// The kinds, each with what is answered today.
pub fn logs() -> Vec<Mistake> {
    let logs = |what, files: fn(&Case)| mistake(what, "navigate imu.csv gnss.csv").files(files);
    let recording =
        |what, files: fn(&Case)| mistake(what, "identify record.csv -o imu.toml").files(files);
    vec![
        logs("units in the header", |case| {
            states_velocities(case);
            let header = "t [s],gx [deg/s],gy [deg/s],gz [deg/s],ax [g],ay [g],az [g]";
            imu(case, header, |row| {
                let values = in_degrees_and_g(row);
                row.put(1, &values);
            });
        }),
        logs("gyroscopes and accelerometers exchanged", |case| {
            states_velocities(case);
            imu(case, "t,gx,gy,gz,ax,ay,az", |row| {
                let [x, y, z, force @ ..] = [1, 2, 3, 4, 5, 6].map(|column| row.number(column));
                row.put(1, &force);
                row.put(4, &[x, y, z]);
            });
        }),
        logs("dates as times", |case| {
            states_velocities(case);
            ["imu.csv", "gnss.csv"]
                .into_iter()
                .for_each(|name| dated(case, name));
        }),
        drive("a counter of 32 bits that wraps, in µs", |log| {
            // It wraps 40 s after the beginning.
            let start = 4_294_967_296.0 - 40e6;
            for row in &mut log.imu {
                row.fields[0] = format!("{:.0}", (start + row.time * 1e6) % 4_294_967_296.0);
            }
            log.set(
                "time = \"t\"\ngyro",
                "time = \"t\"\ntime_unit = \"us\"\ngyro",
            );
            log.set("[truth]", "time_offset = \"4254.967296 s\"\n[truth]");
            log.set(
                "[\"roll\", \"pitch\", \"yaw\"]\n",
                "[\"roll\", \"pitch\", \"yaw\"]\ntime_offset = \"4254.967296 s\"\n",
            );
        }),
        drive("accelerometers of reversed sign", reverse),
        drive("the same, mended", |log| {
            reverse(log);
            log.set("\"m/s^2\"", "\"-m/s^2\"");
        }),
        logs("raw sentences in a column", |case| {
            states_velocities(case);
            let text = case.read("imu.csv").unwrap();
            let mut lines = text.lines();
            let mut made = lines.next().unwrap().to_owned() + ",raw\n";
            for line in lines {
                made += line;
                made += ",\"$VNYMR,+066.172,+003.948,+002.132,+00.2653*5A\"\n";
            }
            case.put("imu.csv", made.as_bytes());
        }),
        mistake(
            "Emlid's positions, without a header",
            "navigate imu.csv reach.LLH",
        )
        .files(|case| {
            dated(case, "imu.csv");
            case.put("reach.LLH", emlid().as_bytes());
        }),
        drive("a vertical speed that is stated as unknown", |log| {
            log.set("\"0.05 m/s\"", "\"0.05, 0.05, 20 m/s\"");
        }),
        drive("the height changes its datum", |log| {
            for row in log.gnss.iter_mut().filter(|row| row.time > 100.0) {
                let height = row.number(3) + 35.2;
                row.put(3, &[height]);
            }
        }),
        logs("tabs, decimal commas, hour to second in columns", |case| {
            states_velocities(case);
            for name in ["imu.csv", "gnss.csv"] {
                in_parts(case, name);
                let text = case.read(name).unwrap();
                let text = text.replace(',', "\t").replace('.', ",");
                case.put(name, text.as_bytes());
            }
        }),
        logs(
            "columns of JSON; degrees, minutes, seconds in columns",
            |case| {
                let imu = super::good().imu;
                let column = |k: usize| {
                    let value = |row: &Row| if k == 0 { row.time } else { row.number(k) };
                    format!("{:?}", Vec::from_iter(imu.iter().map(value)))
                };
                let [t, gx, gy, gz, ax, ay, az] = [0, 1, 2, 3, 4, 5, 6].map(column);
                let accel = format!("{{\"x\": {ax}, \"y\": {ay}, \"z\": {az}}}");
                let gyro = format!("\"gx\": {gx}, \"gy\": {gy}, \"gz\": {gz}");
                let json = format!("{{\"t\": {t}, {gyro}, \"acc\": {accel}}}");
                case.put("imu.csv", json.as_bytes());
                case.put("gnss.csv", in_three_columns().as_bytes());
            },
        ),
        logs(
            "hexadecimal counts; seconds of the day across midnight",
            |case| {
                states_velocities(case);
                imu(case, "t,AcX,AcY,AcZ,GyX,GyY,GyZ", |row| {
                    let count = |x: f64| format!("0x{:04X}", x.round() as i16);
                    let values = in_degrees_and_g(row);
                    let counts = values
                        .iter()
                        .zip([32.8, 32.8, 32.8, 4096.0, 4096.0, 4096.0]);
                    let counts = Vec::from_iter(counts.map(|(x, lsb)| count(x * lsb)));
                    row.fields[1..4].clone_from_slice(&counts[3..]);
                    row.fields[4..7].clone_from_slice(&counts[..3]);
                });
                for name in ["imu.csv", "gnss.csv"] {
                    let of_day = |time: f64| format!("{:.2}", (time + 86_320.0) % 86_400.0);
                    retimed(case, name, "sod", of_day);
                }
            },
        ),
        mistake("rows behind names of sensors", "navigate log.csv").files(|case| {
            states_velocities(case);
            let mut rows = Vec::new();
            for (name, file) in [("IMU", "imu.csv"), ("GPS", "gnss.csv")] {
                let text = case.read(file).unwrap();
                let time = |row: &str| row.split(',').next().and_then(|t| t.parse::<f64>().ok());
                let timed = text
                    .lines()
                    .filter_map(|row| Some((time(row)?, row.to_owned())));
                rows.extend(timed.map(|(time, row)| (time, format!("{name},{row}\n"))));
            }
            rows.sort_by(|a, b| a.0.total_cmp(&b.0));
            let text: String = rows.into_iter().map(|(_, row)| row).collect();
            case.put("log.csv", text.as_bytes());
        }),
        logs("several numbers in a cell, no times", |case| {
            states_velocities(case);
            // Of 100 Hz every second row.
            let rows = super::good().imu.into_iter().step_by(2).map(|row| {
                let [gx, gy, gz, ax, ay, az] = [1, 2, 3, 4, 5, 6].map(|k| row.number(k));
                format!("\"[{gx}, {gy}, {gz}]\",{ax} {ay} {az},7\n")
            });
            let text = "gyro,accel,state\n".to_owned() + &rows.collect::<String>();
            case.put("imu.csv", text.as_bytes());
        }),
        logs("thousandths, and axes before their sensors", |case| {
            states_velocities(case);
            let header = "time_boot_ms,RAW_IMU.xacc,RAW_IMU.yacc,RAW_IMU.zacc,RAW_IMU.xgyro,RAW_IMU.ygyro,RAW_IMU.zgyro";
            imu(case, header, |row| {
                let values = in_degrees_and_g(row).map(|x| format!("{:.2}", 1000.0 * x));
                let rates = [1, 2, 3].map(|k| format!("{:.2}", 1000.0 * row.number(k)));
                row.fields[0] = format!("{:.0}", row.time * 1000.0);
                row.fields[1..4].clone_from_slice(&values[3..]);
                row.fields[4..7].clone_from_slice(&rates);
            });
        }),
        logs("gyro x and y exchanged", |case| {
            states_velocities(case);
            imu(case, "t,gx,gy,gz,ax,ay,az", |row| row.fields.swap(1, 2));
        }),
        logs("samples of whole seconds, in feet", |case| {
            states_velocities(case);
            let rows = super::good().imu;
            let rows = rows.into_iter().step_by(100).zip(0..).map(|(mut row, k)| {
                let feet = [4, 5, 6].map(|column| row.number(column) / 0.3048);
                row.put(4, &feet);
                row.fields[0] = format!("{k}");
                row
            });
            let text = table("t,gx,gy,gz,ax,ay,az", &Vec::from_iter(rows));
            case.put("imu.csv", text.as_bytes());
        }),
        recording("ticks of unknown length", |case| {
            let text = record(30_000, HEADER, |_, _| ());
            let mut made = String::from("ticks,gx,gy,gz,ax,ay,az\n");
            for line in text.lines().skip(1) {
                let (time, rest) = line.split_once(',').unwrap();
                let ticks = 1e4 * time.parse::<f64>().unwrap();
                made += &format!("{ticks:.0},{rest}\n");
            }
            case.put("record.csv", made.as_bytes());
        }),
        recording("2 % of the packets are lost", |case| {
            let mut rows = 0_u32;
            let text = record(30_000, HEADER, |_, _| ());
            let mut kept = String::new();
            for line in text.lines() {
                rows += 1;
                if rows % 50 != 37 {
                    kept += line;
                    kept.push('\n');
                }
            }
            case.put("record.csv", kept.as_bytes());
        }),
        recording("accelerometers in every fourth row", |case| {
            let text = record(30_000, HEADER, |_, _| ());
            let mut mixed = String::new();
            for (at, line) in text.lines().enumerate() {
                let fields: Vec<&str> = line.split(',').collect();
                mixed += &match at % 4 {
                    0 => line.to_owned(),
                    _ => format!("{},,,", fields[..4].join(",")),
                };
                mixed.push('\n');
            }
            case.put("record.csv", mixed.as_bytes());
        }),
        recording("Kalibr's columns", |case| {
            let text = record(30_000, HEADER, |_, _| ());
            let mut made =
                String::from("timestamp,omega_x,omega_y,omega_z,alpha_x,alpha_y,alpha_z\n");
            for line in text.lines().skip(1) {
                let values: Vec<f64> = line.split(',').map(|x| x.parse().unwrap()).collect();
                let time = 1_700_000_000_000_000_000_u64 + (values[0] * 1e9).round() as u64;
                let rates = values[1..4].iter().map(|rate| rate.to_radians());
                let forces = values[4..].iter().map(|force| force * GRAVITY);
                let values: Vec<String> = rates.chain(forces).map(|x| format!("{x:.8}")).collect();
                made += &format!("{time},{}\n", values.join(","));
            }
            case.put("record.csv", made.as_bytes());
        }),
        recording("in the hand for the first seconds", |case| {
            let text = record(30_000, HEADER, |t, row| {
                if t < 4.5 {
                    row[0] += 40.0 * (3.0 * t).sin();
                    row[4] += 0.3 * (2.0 * t).cos();
                }
            });
            case.put("record.csv", text.as_bytes());
        }),
    ]
}

/// The log of the receiver with the accuracies of its velocities.
fn states_velocities(case: &Case) {
    let text = case.read("gnss.csv").unwrap();
    let mut lines = text.lines();
    let mut made = lines.next().unwrap().to_owned() + ",vn_std,ve_std,vd_std\n";
    for line in lines {
        made += line;
        made += ",0.05,0.05,0.05\n";
    }
    case.put("gnss.csv", made.as_bytes());
}

/// A log with other times under another name.
fn retimed(case: &Case, name: &str, header: &str, of: impl Fn(f64) -> String) {
    let text = case.read(name).unwrap();
    let mut lines = text.lines();
    let (_, names) = lines.next().unwrap().split_once(',').unwrap();
    let mut made = format!("{header},{names}\n");
    for line in lines {
        let (time, rest) = line.split_once(',').unwrap();
        made += &format!("{},{rest}\n", of(time.parse().unwrap()));
    }
    case.put(name, made.as_bytes());
}

/// A log with year, month, day, hour, minute and second in columns.
fn in_parts(case: &Case, name: &str) {
    let parts = |time: f64| {
        let (minutes, seconds) = ((time / 60.0).floor(), time % 60.0);
        format!("2026,3,1,10,{minutes},{seconds:.4}")
    };
    retimed(case, name, "year,month,day,hour,minute,second", parts);
}

/// The fixes with latitude and longitude in degrees, minutes and seconds.
fn in_three_columns() -> String {
    let parts = |degrees: f64| {
        let minutes = degrees.fract() * 60.0;
        format!(
            "{},{},{:.7}",
            degrees.trunc(),
            minutes.trunc(),
            minutes.fract() * 60.0
        )
    };
    let rows = super::good().gnss.into_iter().map(|row| {
        let [lat, lon, height] = [1, 2, 3].map(|k| row.number(k));
        let [vn, ve, vd] = [4, 5, 6].map(|k| row.number(k));
        let place = format!("{},{},{height}", parts(lat), parts(lon));
        format!(
            "{},{place},{vn},{ve},{vd},0.05,0.05,0.05,0.5,0.5,1\n",
            row.time
        )
    });
    let header = "t,lat_deg,lat_min,lat_sec,lon_deg,lon_min,lon_sec,height,vn,ve,vd,vn_std,ve_std,vd_std,north_std,east_std,down_std\n";
    header.to_owned() + &rows.collect::<String>()
}

/// The time of a day, hh:mm:ss.
fn clock(time: f64) -> String {
    let (minutes, seconds) = ((time / 60.0).floor(), time % 60.0);
    format!("10:{minutes:02}:{seconds:07.4}")
}

/// A log with dates in UTC for times.
fn dated(case: &Case, name: &str) {
    let text = case.read(name).unwrap();
    let mut lines = text.lines();
    let mut dated = lines.next().unwrap().to_owned() + "\n";
    for line in lines {
        let (time, rest) = line.split_once(',').unwrap();
        let time = clock(time.parse().unwrap());
        dated += &format!("2026-03-01T{time}Z,{rest}\n");
    }
    case.put(name, dated.as_bytes());
}

/// The fixes as RTKLIB's rows, in GPS time, which is 18 s ahead of UTC.
fn emlid() -> String {
    let rows = super::good().gnss.into_iter().map(|row| {
        let [lat, lon, height] = [1, 2, 3].map(|column| row.number(column));
        let time = clock(row.time + 18.0);
        format!(
            "2026/03/01 {time} {lat:.9} {lon:.9} {height:.4} 1 12 0.5000 0.5000 1.0000 0.0010 0.0010 0.0010 0.50 5.0\n"
        )
    });
    rows.collect()
}

fn reverse(log: &mut Log) {
    for row in &mut log.imu {
        let force = [4, 5, 6].map(|column| -row.number(column));
        row.put(4, &force);
    }
}

fn in_degrees_and_g(row: &Row) -> [f64; 6] {
    [1, 2, 3, 4, 5, 6].map(|column| match column {
        1..=3 => row.number(column).to_degrees(),
        _ => row.number(column) / GRAVITY,
    })
}

/// The inertial log under another header, its rows changed.
fn imu(case: &Case, header: &str, change: fn(&mut Row)) {
    let mut rows = super::good().imu;
    rows.iter_mut().for_each(change);
    case.put("imu.csv", table(header, &rows).as_bytes());
}
