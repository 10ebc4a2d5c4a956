//! Rows without a header in a layout that is known: those that `ros2 topic echo --csv` prints of sensor_msgs/Imu and NavSatFix, and those of
//! KITTI's `oxts`, also with a date and a time before each.

use super::fields::{Delimiter, Fields};
use super::wanted::starts_a_row;
use crate::number;

/// Rows that have to be alike.
const ROWS: usize = 3;

/// Names of the values of a message; nine numbers of a covariance have none.
const IMU: [&str; 6] = [
    "sec,nanosec,frame_id,qx,qy,qz,qw",
    NINE,
    "angular_velocity.x,angular_velocity.y,angular_velocity.z",
    NINE,
    "linear_acceleration.x,linear_acceleration.y,linear_acceleration.z",
    NINE,
];
const FIX: [&str; 3] = [
    "sec,nanosec,frame_id,status,service,latitude,longitude,altitude",
    NINE,
    "",
];
const NINE: &str = ",,,,,,,,";
const OXTS: &str = "lat,lon,alt,roll_rad,pitch_rad,yaw_rad,vn,ve,,,vu,ax,ay,az,,,,wx,wy,wz,,,,pos_accuracy,vel_accuracy,,,,,";
/// Fields of KITTI's rows, and with a date and a time of day.
const OF_OXTS: usize = 30;
/// Place of the name of the frame.
const FRAME: usize = 2;

/// The header of such rows, separated as these are.
pub(super) fn header(lines: &[Vec<u8>]) -> Option<Vec<u8>> {
    let mut rows = lines.iter().filter(|line| starts_a_row(line));
    let first = rows.next()?;
    let delimiter = Delimiter::detect(first);
    let separator = match delimiter {
        Delimiter::Byte(byte) => char::from(byte),
        Delimiter::Blanks => ' ',
    };
    let fields = |line: &[u8]| Vec::from_iter(Fields::new(line, delimiter).map(<[u8]>::to_vec));
    let first = fields(first);
    let is_number = |field: &Vec<u8>| number::parse(field).is_some();
    let value = |place: usize| first.get(place).and_then(|field| number::parse(field));
    let texts = Vec::from_iter((0..first.len()).filter(|k| !is_number(&first[*k])));
    let is_stamp = || {
        value(1).is_some_and(|part| part.fract() == 0.0 && (0.0..1e9).contains(&part))
            && value(0).is_some_and(|sec| sec.fract() == 0.0)
    };
    let is_place = |lat: usize| {
        let within = |place: usize, most: f64| value(place).is_some_and(|x| x.abs() <= most);
        within(lat, 90.0) && within(lat + 1, 180.0)
    };
    let names = match first.len() {
        40 if texts == [FRAME] && is_stamp() => IMU.join(","),
        18 if texts == [FRAME] && is_stamp() && is_place(5) => FIX.join(","),
        OF_OXTS if texts.is_empty() && is_place(0) && is_yaw(value(5)) => OXTS.to_owned(),
        width if width == OF_OXTS + 2 && is_place(2) && is_yaw(value(7)) => {
            format!("date,time,{OXTS}")
        }
        _ => return None,
    };
    let alike = rows
        .take(ROWS)
        .filter(|row| fields(row).len() == first.len());
    let names = names.split(',').enumerate();
    let named = names.map(|(place, name)| match name {
        "" => format!("field_{}", place + 1),
        _ => name.to_owned(),
    });
    let named = Vec::from_iter(named.take(first.len()));
    (alike.count() == ROWS && named.len() == first.len())
        .then(|| named.join(&separator.to_string()).into_bytes())
}

/// Whether a heading of KITTI is in radians.
fn is_yaw(value: Option<f64>) -> bool {
    value.is_some_and(|yaw| yaw.abs() <= std::f64::consts::TAU)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(row: &str) -> Option<String> {
        let lines = vec![row.as_bytes().to_vec(); 5];
        Some(String::from_utf8(header(&lines)?).unwrap())
    }

    #[test]
    fn rows_of_ros_and_kitti_get_their_names() {
        let nine = "0.0,".repeat(9);
        let imu = format!("17,20000000,imu,0,0,0,1,{nine}1,2,3,{nine}4,5,9.8,{nine}");
        let imu = imu.trim_end_matches(',');
        let names = named(imu).unwrap();
        let place = |name: &str| names.split(',').position(|other| other == name);
        assert_eq!(place("angular_velocity.x"), Some(16));
        assert_eq!(place("linear_acceleration.z"), Some(30));
        assert_eq!(names.split(',').count(), 40);
        let fix = format!("17,20000000,gps,0,1,48.1,11.5,520,{nine}2");
        let names = named(&fix).unwrap();
        assert_eq!(
            names.split(',').position(|name| name == "altitude"),
            Some(7)
        );
        // A frame in another place is another message.
        assert_eq!(named(&imu.replace("imu,0", "0,imu")), None);
        let oxts = format!("48.1 11.5 520{}", " 0.5".repeat(27));
        let names = named(&oxts).unwrap();
        assert_eq!(names.split(' ').nth(17), Some("wx"));
        let dated = named(&format!("2011-09-26 13:02:25.9 {oxts}")).unwrap();
        assert!(dated.starts_with("date time lat lon"), "{dated}");
        assert_eq!(named(&oxts.replace("0.5", "9.5")), None);
    }
}
