//! Samples: `.gcsv` of Gyroflow, `.lvm` of LabVIEW, and the stream of the app Sensorstream.

use super::{below, lines};

pub(super) fn is_gcsv(start: &[u8]) -> bool {
    let first = lines(start).next().unwrap_or_default();
    first.ends_with("IMU LOG")
        && lines(start)
            .take(50)
            .any(|line| line.starts_with("tscale,"))
}

/// Counts with their scales to s, rad/s and g in the header.
pub(super) fn of_gcsv(text: &[u8]) -> Option<String> {
    let mut all = lines(text);
    let mut scales = [1.0; 3];
    for line in all.by_ref() {
        let mut fields = line.split(',');
        let (name, value) = (fields.next()?, fields.next().unwrap_or_default());
        let scale = ["tscale", "gscale", "ascale"]
            .iter()
            .position(|s| *s == name);
        if let Some(scale) = scale {
            scales[scale] = value.trim().parse().ok()?;
        }
        if name == "t" {
            break;
        }
    }
    let row = |line: &str| {
        let numbers = line
            .split(',')
            .take(7)
            .map(|field| field.trim().parse::<f64>());
        let numbers = numbers.collect::<Result<Vec<_>, _>>().ok()?;
        let of = |place: usize| scales[place.div_ceil(3)];
        let scaled = numbers
            .iter()
            .enumerate()
            .map(|(k, x)| (x * of(k)).to_string());
        Some(Vec::from_iter(scaled).join(","))
    };
    below(
        "t_s,gx_rad_s,gy_rad_s,gz_rad_s,ax_g,ay_g,az_g",
        all.filter_map(row),
    )
}

/// Lines of a header, at most, and what ends it.
const HEADER: usize = 100;
const END: &str = "***End_of_Header***";

pub(super) fn is_lvm(start: &[u8]) -> bool {
    let first = lines(start).next().unwrap_or_default();
    first == "LabVIEW Measurement" && lines(start).any(|line| line.starts_with(END))
}

/// Without the headers of the file and of its first segment.
pub(super) fn of_lvm(text: &[u8]) -> Option<String> {
    let last = lines(text).take(HEADER).enumerate();
    let (last, _) = last.filter(|(_, line)| line.starts_with(END)).last()?;
    let mut rest = lines(text).skip(last + 1);
    below(rest.next()?, rest.map(str::to_owned))
}

/// Numbers of the app's sensors of three values, and what these are called.
const SENSORS: [(&str, &str); 4] = [
    ("1", "lat,lon,alt"),
    ("3", "ax,ay,az"),
    ("4", "gx,gy,gz"),
    ("5", "mx,my,mz"),
];
/// Rows that show the layout.
const ROWS: usize = 20;

/// The time of a row, and the three values of each of the [`SENSORS`].
fn streamed(line: &str) -> Option<(&str, [Option<String>; SENSORS.len()])> {
    let fields = Vec::from_iter(line.split(',').map(str::trim));
    let mut found: [Option<String>; SENSORS.len()] = Default::default();
    let (time, mut rest) = fields.split_first()?;
    while let [number, a, b, c, behind @ ..] = rest {
        if number.contains('.') || ![a, b, c].iter().all(|x| x.parse::<f64>().is_ok()) {
            break;
        }
        let sensor = SENSORS.iter().position(|(known, _)| known == number);
        if let Some(sensor) = sensor {
            found[sensor] = Some([*a, *b, *c].join(","));
        }
        rest = behind;
    }
    let is_imu = found[1].is_some() && found[2].is_some();
    (time.parse::<f64>().is_ok() && is_imu).then_some((time, found))
}

pub(super) fn is_stream(start: &[u8]) -> bool {
    let rows = lines(start).take(ROWS);
    let (all, known) = rows.fold((0, 0), |(all, known), line| {
        (all + 1, known + usize::from(streamed(line).is_some()))
    });
    all == ROWS && known > ROWS / 2
}

/// Behind the time the number of each sensor and its values.
pub(super) fn of_stream(text: &[u8]) -> Option<String> {
    let header = SENSORS.map(|(_, names)| names).join(",");
    let row = |line: &str| {
        let (time, values) = streamed(line)?;
        let values = values.map(|three| three.unwrap_or_else(|| ",,".to_owned()));
        Some(format!("{time},{}", values.join(",")))
    };
    below(&format!("time,{header}"), lines(text).filter_map(row))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_scaled_as_the_header_says() {
        let text = b"GYROFLOW IMU LOG\nversion,1.3\ntscale,0.5\ngscale,0.25\nascale,2\nt,gx,gy,gz,ax,ay,az\n3,4,8,-12,1,2,-3\n";
        assert!(is_gcsv(text));
        let table = of_gcsv(text).unwrap();
        assert_eq!(table.lines().nth(1), Some("1.5,1,2,-3,2,4,-6"));
        assert!(!is_gcsv(b"t,gx\n1,2\n"));
    }

    #[test]
    fn both_headers_are_left_away() {
        let text = b"LabVIEW Measurement\t\nSeparator\tTab\n***End_of_Header***\t\n\nChannels\t2\nX0\t0\t0\n***End_of_Header***\t\t\nX_Value\tgx\tgy\n0\t1\t2\n";
        assert!(is_lvm(text));
        assert_eq!(of_lvm(text).unwrap(), "X_Value\tgx\tgy\n0\t1\t2\n\n");
    }

    #[test]
    fn numbers_of_sensors_are_no_values() {
        let row = |k: i32| format!("{k}.5, 3, 1, 2, 9.8, 4, 0.1, 0.2, 0.3\n");
        let place = "30.5, 1, 48.1,11.5, 520, 3, 1, 2, 9.8, 4, 0.1, 0.2, 0.3, 5, 7, 8, 9\n";
        let text = (0..20).map(row).collect::<String>() + place;
        assert!(is_stream(text.as_bytes()));
        let table = of_stream(text.as_bytes()).unwrap();
        assert_eq!(table.lines().nth(1), Some("0.5,,,,1,2,9.8,0.1,0.2,0.3,,,"));
        let last = "30.5,48.1,11.5,520,1,2,9.8,0.1,0.2,0.3,7,8,9";
        assert_eq!(table.lines().last(), Some(last));
        assert!(!is_stream(b"1,2,3,4,5,6,7,8,9\n".repeat(30).as_slice()));
    }
}
