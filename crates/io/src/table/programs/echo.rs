//! Messages as `ros2 topic echo` and `rostopic echo` print them, a line `---` behind each: sensor_msgs/Imu, sensor_msgs/NavSatFix.

use super::{below, lines};

/// The values of a message that are read: the key at the left and the key below it, and the column.
const VALUES: [(&str, &str, &str); 9] = [
    ("angular_velocity", "x", "gx_rad_s"),
    ("angular_velocity", "y", "gy_rad_s"),
    ("angular_velocity", "z", "gz_rad_s"),
    ("linear_acceleration", "x", "ax_m_s2"),
    ("linear_acceleration", "y", "ay_m_s2"),
    ("linear_acceleration", "z", "az_m_s2"),
    ("latitude", "", "latitude"),
    ("longitude", "", "longitude"),
    ("altitude", "", "altitude"),
];
/// Values of an Imu; behind them those of a NavSatFix.
const IMU: usize = 6;

pub(super) fn is_there(start: &[u8]) -> bool {
    let has = |wanted: &str| lines(start).any(|line| line.starts_with(wanted));
    has("---") && has("stamp:") && (has("angular_velocity:") || has("latitude:"))
}

pub(super) fn table(text: &[u8]) -> Option<String> {
    let whole = std::str::from_utf8(text).ok()?;
    let is_imu = lines(text).any(|line| line == "angular_velocity:");
    let kept = if is_imu { 0..IMU } else { IMU..VALUES.len() };
    let names = VALUES.get(kept.clone())?.iter().map(|(.., name)| *name);
    let header = format!("stamp,{}", Vec::from_iter(names).join(","));
    let row = |message: &str| {
        let (mut left, mut stamp) = ("", [None, None]);
        let mut values: [Option<&str>; VALUES.len()] = [None; VALUES.len()];
        for line in message.lines() {
            let Some((key, value)) = line.split_once(':') else {
                continue;
            };
            let (key, value, is_left) = (key.trim(), value.trim(), !key.starts_with(' '));
            if is_left {
                left = key;
            }
            let part = match key {
                "sec" | "secs" => Some(0),
                "nanosec" | "nsecs" => Some(1),
                _ => None,
            };
            if let (Some(part), "header") = (part, left) {
                stamp[part] = value.parse::<u64>().ok();
            }
            let below = if is_left { "" } else { key };
            let known = VALUES.iter().position(|of| (of.0, of.1) == (left, below));
            if let Some(place) = known {
                values[place] = Some(value);
            }
        }
        let values = values.get(kept.clone())?.iter().copied();
        let values: Vec<&str> = values.collect::<Option<_>>()?;
        let [sec, nsec] = stamp;
        Some(format!("{}.{:09},{}", sec?, nsec?, values.join(",")))
    };
    below(&header, whole.split("\n---").filter_map(row))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_is_a_row() {
        let text = "header:\n  stamp:\n    sec: 17\n    nanosec: 20000000\n  frame_id: imu\norientation:\n  x: 0.5\nangular_velocity:\n  x: 1.0\n  y: 2.0\n  z: -3.0\nangular_velocity_covariance:\n- 0.0\nlinear_acceleration:\n  x: 4.0\n  y: 5.0\n  z: 9.8\n---\n";
        assert!(is_there(text.as_bytes()));
        let table = table(text.repeat(2).as_bytes()).unwrap();
        let row = "17.020000000,1.0,2.0,-3.0,4.0,5.0,9.8";
        assert_eq!(Vec::from_iter(table.lines().skip(1)), [row, row]);
        let fix = "header: \n  seq: 1\n  stamp: \n    secs: 17\n    nsecs: 5\nstatus: \n  status: 0\nlatitude: 48.1\nlongitude: 11.5\naltitude: 520.0\n---\n";
        let table = super::table(fix.as_bytes()).unwrap();
        assert_eq!(
            table,
            "stamp,latitude,longitude,altitude\n17.000000005,48.1,11.5,520.0\n"
        );
    }
}
