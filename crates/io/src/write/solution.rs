//! The navigation solution as CSV: state, its standard deviations, estimated sensor errors.

use std::io::{self, Write};
use std::path::Path;

use undrift_nav::Vector3;
use undrift_nav::earth::Geodetic;

use super::block::Block;
use super::text::write_turn;
use super::thinning::Thinning;
use super::{PendingFile, write_fixed};

/// Columns and their decimals: a latitude of 1e-11° is a micrometre; of sensor errors there are
/// as many as a navigation-grade unit would need.
pub(super) const COLUMNS: [(&str, usize); 31] = [
    ("time_s", 4),
    ("lat_deg", 11),
    ("lon_deg", 11),
    ("height_m", 4),
    ("vn_mps", 5),
    ("ve_mps", 5),
    ("vd_mps", 5),
    ("roll_deg", 6),
    ("pitch_deg", 6),
    ("yaw_deg", 6),
    ("north_std_m", 4),
    ("east_std_m", 4),
    ("down_std_m", 4),
    ("vn_std_mps", 5),
    ("ve_std_mps", 5),
    ("vd_std_mps", 5),
    ("roll_std_deg", 6),
    ("pitch_std_deg", 6),
    ("yaw_std_deg", 6),
    ("gyro_bias_x_dps", 8),
    ("gyro_bias_y_dps", 8),
    ("gyro_bias_z_dps", 8),
    ("accel_bias_x_mps2", 7),
    ("accel_bias_y_mps2", 7),
    ("accel_bias_z_mps2", 7),
    ("gyro_bias_x_std_dps", 8),
    ("gyro_bias_y_std_dps", 8),
    ("gyro_bias_z_std_dps", 8),
    ("accel_bias_x_std_mps2", 7),
    ("accel_bias_y_std_mps2", 7),
    ("accel_bias_z_std_mps2", 7),
];
/// The column of the yaw.
pub(super) const YAW: usize = 9;

/// One instant of the solution, in SI units and radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolutionRow {
    /// Time \[s\].
    pub time: f64,
    /// Position.
    pub position: Geodetic,
    /// Velocity north, east, down [m/s].
    pub v_n: Vector3,
    /// Roll, pitch, yaw \[rad\]; yaw of any turn.
    pub rpy: Vector3,
    /// Standard deviations: position north, east, down \[m\], velocity north, east, down [m/s],
    /// roll, pitch, yaw \[rad\].
    pub nav_std: [f64; 9],
    /// Estimated slow gyro error, body axes [rad/s].
    pub gyro_error: Vector3,
    /// Estimated slow accelerometer error, body axes [m/s²].
    pub accel_error: Vector3,
    /// Standard deviations of the gyro [rad/s] and accelerometer errors [m/s²], x y z each.
    pub error_std: [f64; 6],
}

impl SolutionRow {
    /// A row of which nothing is known but time \[s\] and place.
    pub fn at(time: f64, position: Geodetic) -> Self {
        let unknown = Vector3::repeat(f64::NAN);
        Self {
            time,
            position,
            v_n: unknown,
            rpy: unknown,
            nav_std: [f64::NAN; 9],
            gyro_error: unknown,
            accel_error: unknown,
            error_std: [f64::NAN; 6],
        }
    }

    /// Whether time and position are numbers.
    pub(super) fn has_position(&self) -> bool {
        let p = &self.position;
        [self.time, p.lat, p.lon, p.height]
            .iter()
            .all(|x| x.is_finite())
    }

    /// The numbers in the order and units of the columns.
    pub(super) fn values(&self) -> [f64; 31] {
        let deg = f64::to_degrees;
        let (p, v, a) = (&self.position, &self.v_n, &self.rpy);
        let (g, f) = (&self.gyro_error, &self.accel_error);
        let [n, e, d, vn, ve, vd, roll, pitch, yaw] = self.nav_std;
        let [gx, gy, gz, fx, fy, fz] = self.error_std;
        [
            self.time,
            deg(p.lat),
            deg(p.lon),
            p.height,
            v.x,
            v.y,
            v.z,
            deg(a.x),
            deg(a.y),
            deg(a.z),
            n,
            e,
            d,
            vn,
            ve,
            vd,
            deg(roll),
            deg(pitch),
            deg(yaw),
            deg(g.x),
            deg(g.y),
            deg(g.z),
            f.x,
            f.y,
            f.z,
            deg(gx),
            deg(gy),
            deg(gz),
            fx,
            fy,
            fz,
        ]
    }
}

/// Writes solution rows as CSV with a header.
#[derive(Debug)]
pub struct SolutionWriter<W: Write> {
    block: Block<W>,
    thinning: Thinning,
}

impl SolutionWriter<PendingFile> {
    /// Starts a file that appears under its name at [`SolutionWriter::finish`].
    ///
    /// # Errors
    /// If the file cannot be created.
    pub fn create(path: &Path) -> io::Result<Self> {
        Self::new(PendingFile::create(path)?)
    }

    /// Writes what is left and gives the file its name.
    ///
    /// # Errors
    /// If the file cannot be written or renamed; there is none under the name then.
    pub fn finish(self) -> io::Result<()> {
        self.into_inner()?.finish()
    }
}

impl<W: Write> SolutionWriter<W> {
    /// Starts with the header. The rows are buffered here; `out` needs no buffer.
    ///
    /// # Errors
    /// None now; what cannot be written shows with the rows.
    pub fn new(out: W) -> io::Result<Self> {
        let mut block = Block::new(out);
        for (k, (name, _)) in COLUMNS.iter().enumerate() {
            if k > 0 {
                block.bytes.push(b',');
            }
            block.bytes.extend_from_slice(name.as_bytes());
        }
        block.bytes.push(b'\n');
        Ok(Self {
            block,
            thinning: Thinning::new(0.0),
        })
    }

    /// Leaves out rows that are closer than so many seconds, 0 or more.
    pub(super) fn every(mut self, seconds: f64) -> Self {
        self.thinning = Thinning::new(seconds);
        self
    }

    /// Writes one row; what is not finite becomes `nan`.
    ///
    /// # Errors
    /// If `out` does not take it.
    pub fn write(&mut self, row: &SolutionRow) -> io::Result<()> {
        if !self.thinning.takes(row.time) {
            return Ok(());
        }
        let buf = &mut self.block.bytes;
        for (k, (value, (_, decimals))) in row.values().into_iter().zip(COLUMNS).enumerate() {
            if k > 0 {
                buf.push(b',');
            }
            if k == YAW {
                write_turn(buf, value, decimals);
            } else {
                write_fixed(buf, value, decimals);
            }
        }
        buf.push(b'\n');
        self.block.spill()
    }

    /// Writes what is left and gives `out` back.
    ///
    /// # Errors
    /// If `out` does not take it.
    pub fn into_inner(self) -> io::Result<W> {
        self.block.into_inner()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    fn row() -> SolutionRow {
        SolutionRow {
            time: 1.5,
            position: Geodetic::from_degrees(40.096_626_8, -105.147_448_3, 1601.474),
            v_n: Vector3::new(1.0, -2.0, 0.25),
            rpy: Vector3::new(PI / 180.0, -PI / 2.0, -PI / 2.0),
            nav_std: [0.1, 0.2, 0.3, 0.01, 0.02, 0.03, PI, PI / 2.0, f64::NAN],
            gyro_error: Vector3::new(PI / 180.0, 0.0, 0.0),
            accel_error: Vector3::new(0.5, f64::INFINITY, -1e-7),
            error_std: [PI / 180.0, 0.0, 0.0, 1.0, 2.0, 3.0],
        }
    }

    fn text_of(rows: &[SolutionRow]) -> String {
        let mut writer = SolutionWriter::new(Vec::new()).unwrap();
        for row in rows {
            writer.write(row).unwrap();
        }
        String::from_utf8(writer.into_inner().unwrap()).unwrap()
    }

    #[test]
    fn header_units_and_order() {
        let text = text_of(&[row()]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 2);
        let names: Vec<&str> = lines[0].split(',').collect();
        let fields: Vec<&str> = lines[1].split(',').collect();
        assert_eq!((names.len(), fields.len()), (31, 31));
        let get = |name: &str| fields[names.iter().position(|n| *n == name).unwrap()];
        assert_eq!(get("time_s"), "1.5000");
        assert_eq!(get("lat_deg"), "40.09662680000");
        assert_eq!(get("lon_deg"), "-105.14744830000");
        assert_eq!(get("vd_mps"), "0.25000");
        assert_eq!(get("roll_deg"), "1.000000");
        assert_eq!(get("yaw_deg"), "270.000000");
        assert_eq!(get("down_std_m"), "0.3000");
        assert_eq!(get("roll_std_deg"), "180.000000");
        assert_eq!(get("yaw_std_deg"), "nan");
        assert_eq!(get("gyro_bias_x_dps"), "1.00000000");
        assert_eq!(get("accel_bias_y_mps2"), "nan");
        assert_eq!(get("accel_bias_z_mps2"), "-0.0000001");
        assert_eq!(get("gyro_bias_x_std_dps"), "1.00000000");
        assert_eq!(get("accel_bias_z_std_mps2"), "3.0000000");
    }

    #[test]
    fn yaw_stays_below_a_full_turn() {
        for yaw in [-1e-12, TAU, TAU - 1e-12, -3.0 * TAU] {
            let mut turned = row();
            turned.rpy.z = yaw;
            let text = text_of(&[turned]);
            let yaw_deg = text.lines().nth(1).unwrap().split(',').nth(YAW).unwrap();
            let yaw_deg: f64 = yaw_deg.parse().unwrap();
            assert!((0.0..360.0).contains(&yaw_deg), "{yaw} {yaw_deg}");
        }
    }

    #[test]
    fn many_rows_reach_the_file_whole() {
        let path = std::env::temp_dir().join(format!("undrift-io-sol-{}.csv", std::process::id()));
        let mut writer = SolutionWriter::create(&path).unwrap();
        for k in 0..1000 {
            let time = f64::from(k);
            writer.write(&SolutionRow { time, ..row() }).unwrap();
        }
        assert!(!path.exists());
        writer.finish().unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::remove_file(&path).unwrap();
        assert_eq!(text.lines().count(), 1001);
        assert!(text.lines().last().unwrap().starts_with("999.0000,"));
        assert!(text.ends_with('\n'));
    }
}
