//! The solution of a drive by poses as the poses were: the marker in their frame and by their clock, as TUM writes it, `time x y z qx qy qz
//! qw` \[s, m\]. The attitude is that of the marker's axes in the frame.

use std::io;

use super::solution::SolutionRow;
use super::text_writer::{Beside, Body, TextFormat};
use super::write_fixed;

pub(super) fn format() -> TextFormat {
    TextFormat {
        head: String::from("# timestamp tx ty tz qx qy qz qw\n"),
        body: Body::Rows(SolutionRow::is_whole, write_row),
        tail: "",
    }
}

fn write_row(buf: &mut Vec<u8>, row: &SolutionRow, beside: &Beside) -> io::Result<()> {
    let Some(frame) = beside.frame else {
        return Ok(());
    };
    let (p, q) = frame.pose(row);
    let stamped = SolutionRow {
        time: row.time - frame.time_offset,
        ..*row
    };
    let time = beside.epoch.map(|epoch| stamped.unix_time(epoch));
    write_fixed(buf, time.unwrap_or(stamped.time), 6);
    for (value, decimals) in [
        (p.x, 6),
        (p.y, 6),
        (p.z, 6),
        (q.i, 9),
        (q.j, 9),
        (q.k, 9),
        (q.w, 9),
    ] {
        buf.push(b' ');
        write_fixed(buf, value, decimals);
    }
    buf.push(b'\n');
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use undrift_nav::{Vector3, attitude::from_rpy, earth::Geodetic};

    use super::*;
    use crate::write::{PoseFrame, SolutionFile, SolutionFormat, SolutionOptions};

    /// A body 2 m north, 1 m east and 3 m above the origin that faces east, its marker 0.5 m ahead and turned to the right; the frame's x
    /// is east, y north, z up: the marker lies at (1.5, 2, 3) and looks south, −y. Clock 10 s early.
    #[test]
    fn a_row_is_the_marker_in_the_frame_of_the_poses() {
        let origin = Geodetic::from_degrees(45.0, 0.0, 0.0);
        let right = from_rpy(&Vector3::new(0.0, 0.0, FRAC_PI_2));
        let row = SolutionRow {
            v_n: Vector3::zeros(),
            rpy: Vector3::new(0.0, 0.0, FRAC_PI_2),
            ..SolutionRow::at(12.5, origin.displaced(&Vector3::new(2.0, 1.0, -3.0)))
        };
        let options = SolutionOptions {
            frame: Some(PoseFrame {
                origin,
                rotation: from_rpy(&Vector3::new(std::f64::consts::PI, 0.0, FRAC_PI_2)),
                marker: right,
                lever_arm: Vector3::new(0.5, 0.0, 0.0),
                time_offset: 10.0,
            }),
            ..SolutionOptions::default()
        };
        let mut file = SolutionFile::new(Vec::new(), SolutionFormat::Tum, &options).unwrap();
        file.write(&row, false).unwrap();
        let text = String::from_utf8(file.into_inner().unwrap()).unwrap();
        let row = text.lines().nth(1).unwrap().split(' ');
        let row = Vec::from_iter(row.map(|number| number.parse::<f64>().unwrap()));
        for (got, expected) in row.iter().zip([2.5, 1.5, 2.0, 3.0]) {
            assert!((got - expected).abs() < 5e-6, "{row:?}"); // What the Earth curves in 2 m, and rounding.
        }
        let q = crate::rotation::of_quaternion(row[7], [row[4], row[5], row[6]])
            .unwrap()
            .unwrap();
        let (ahead, down) = (q * Vector3::x(), q * Vector3::z());
        assert!((ahead + Vector3::y()).norm() < 1e-8, "{ahead}");
        assert!((down + Vector3::z()).norm() < 1e-8, "{down}");
    }

    /// A drive by fixes has no frame.
    #[test]
    fn without_poses_there_is_no_such_file() {
        let none = SolutionFile::new(Vec::new(), SolutionFormat::Tum, &SolutionOptions::default());
        let error = none.err().unwrap().to_string();
        assert!(error.contains("[poses]"), "{error}");
    }
}
