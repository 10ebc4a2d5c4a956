//! A simulated drive as the files of a log.

use std::{
    io::{self, BufWriter, Write},
    path::Path,
};
use undrift_io::write::{PendingFile, write_whole};
use undrift_nav::{sample::Position, shaping::ShapingFilter};
use undrift_simulate::{
    GnssFixes, GnssNoise, IdealImu, PoseNoise, SensorErrors, SimulationError, Trajectory,
};

/// A drive and its sensors.
#[derive(Clone, Copy, Debug)]
pub struct SimulatedLog<'a> {
    /// The motion.
    pub trajectory: &'a Trajectory,
    /// Rate of the inertial samples \[Hz\].
    pub rate_hz: f64,
    /// Errors of gyros and accelerometers.
    pub filters: &'a [ShapingFilter; 6],
    /// The receiver.
    pub gnss: &'a GnssNoise,
    /// Seed of all noise.
    pub seed: u64,
    /// What the drive file names as the noise model.
    pub model: &'a str,
    /// Temperature [°C], a column of the inertial log.
    pub temperature_c: Option<f64>,
}

/// Rows of the inertial log for one of the truth, which has the last one too.
const TRUTH_EVERY: usize = 10;

impl SimulatedLog<'_> {
    /// The files that [`SimulatedLog::write`] makes in its folder.
    pub const FILES: [&'static str; 4] = ["imu.csv", "truth.csv", "gnss.csv", "drive.toml"];

    /// Writes a drive into a folder, streamed; each file whole or not at all.
    ///
    /// # Errors
    /// What cannot be simulated or written.
    pub fn write(&self, folder: &Path) -> io::Result<()> {
        std::fs::create_dir_all(folder)?;
        let [imu, truth, gnss, drive] = Self::FILES.map(|name| folder.join(name));
        let [mut imu, mut truth, mut gnss] = [create(&imu)?, create(&truth)?, create(&gnss)?];
        self.write_inertial(&mut imu, &mut truth)?;
        self.write_fixes(&mut gnss)?;
        for file in [imu, truth, gnss] {
            file.into_inner()?.finish()?;
        }
        write_whole(&drive, self.drive_file())
    }

    /// The files that [`SimulatedLog::write_room`] makes in its folder.
    pub const ROOM: [&'static str; 2] = ["imu.csv", "poses.txt"];

    /// Writes a motion in a room into a folder: the inertial log, and `every` of its samples a pose of a marker in a file of TUM.
    ///
    /// # Errors
    /// What cannot be simulated or written.
    pub fn write_room(&self, folder: &Path, marker: &PoseNoise, every: usize) -> io::Result<()> {
        std::fs::create_dir_all(folder)?;
        let [imu, poses] = Self::ROOM.map(|name| folder.join(name));
        self.write_record(&imu)?;
        let mut file = create(&poses)?;
        let truth = IdealImu::new(self.trajectory, self.rate_hz).map(|(_, truth)| truth);
        let seen = truth.step_by(every.max(1));
        for pose in marker.measure(seen, &self.trajectory.start, self.seed) {
            let ([x, y, z], q) = (pose.position.into(), pose.attitude);
            let [time, x, y, z]: [f64; 4] = [pose.time, x, y, z];
            let [qx, qy, qz, qw] = [q.i, q.j, q.k, q.w];
            writeln!(
                file,
                "{time:.4} {x:.5} {y:.5} {z:.5} {qx:.7} {qy:.7} {qz:.7} {qw:.7}"
            )?;
        }
        file.into_inner()?.finish()
    }

    /// Writes the inertial log alone, whole or not at all.
    ///
    /// # Errors
    /// What cannot be simulated or written.
    pub fn write_record(&self, file: &Path) -> io::Result<()> {
        let mut imu = create(file)?;
        self.write_inertial(&mut imu, io::sink())?;
        imu.into_inner()?.finish()
    }

    fn write_inertial(&self, mut imu: impl Write, mut truth: impl Write) -> io::Result<()> {
        let errors = SensorErrors::new(self.filters, self.rate_hz, self.seed);
        let mut errors = errors.map_err(invalid)?;
        write!(
            imu,
            "t_s,gx_radps,gy_radps,gz_radps,fx_mps2,fy_mps2,fz_mps2"
        )?;
        if self.temperature_c.is_some() {
            write!(imu, ",temp_C")?;
        }
        writeln!(imu)?;
        writeln!(
            truth,
            "t_s,lat_deg,lon_deg,height_m,roll_deg,pitch_deg,yaw_deg"
        )?;
        let mut samples = IdealImu::new(self.trajectory, self.rate_hz)
            .enumerate()
            .peekable();
        while let Some((k, (ideal, reference))) = samples.next() {
            let sample = errors.apply(&ideal);
            let (w, f) = (sample.dtheta / sample.dt, sample.dvel / sample.dt);
            write!(
                imu,
                "{:.4},{:.9},{:.9},{:.9},{:.7},{:.7},{:.7}",
                sample.time, w.x, w.y, w.z, f.x, f.y, f.z
            )?;
            if let Some(temperature) = self.temperature_c {
                write!(imu, ",{temperature:.2}")?;
            }
            writeln!(imu)?;
            if (k % TRUTH_EVERY == 0 || samples.peek().is_none())
                && let Some(rpy) = reference.rpy
            {
                let place = reference.position;
                writeln!(
                    truth,
                    "{:.4},{:.10},{:.10},{:.4},{:.6},{:.6},{:.6}",
                    reference.time,
                    place.lat.to_degrees(),
                    place.lon.to_degrees(),
                    place.height,
                    rpy.x.to_degrees(),
                    rpy.y.to_degrees(),
                    rpy.z.to_degrees()
                )?;
            }
        }
        Ok(())
    }

    fn write_fixes(&self, mut gnss: impl Write) -> io::Result<()> {
        writeln!(
            gnss,
            "t_s,lat_deg,lon_deg,height_m,sn_m,se_m,sd_m,vn_mps,ve_mps,vd_mps,svn_mps,sve_mps,svd_mps"
        )?;
        let fixes = GnssFixes::new(self.trajectory, self.gnss, self.seed).map_err(invalid)?;
        for fix in fixes {
            let (Some((Position::Geodetic(place), p)), Some((v, r))) = (fix.position, fix.velocity)
            else {
                continue;
            };
            write!(
                gnss,
                "{:.4},{:.10},{:.10},{:.4}",
                fix.time,
                place.lat.to_degrees(),
                place.lon.to_degrees(),
                place.height
            )?;
            for value in p.diagonal().iter().map(|variance| variance.sqrt()) {
                write!(gnss, ",{value:.5}")?;
            }
            for value in v
                .iter()
                .copied()
                .chain(r.diagonal().iter().map(|x| x.sqrt()))
            {
                write!(gnss, ",{value:.5}")?;
            }
            writeln!(gnss)?;
        }
        Ok(())
    }

    fn drive_file(&self) -> String {
        let lever = self.gnss.lever_arm;
        format!(
            r#"model = "{}"

[imu]
file = "imu.csv"
time = "t_s"
gyro = ["gx_radps", "gy_radps", "gz_radps"]
gyro_unit = "rad/s"
accel = ["fx_mps2", "fy_mps2", "fz_mps2"]
accel_unit = "m/s^2"

[gnss]
file = "gnss.csv"
time = "t_s"
position = ["lat_deg", "lon_deg", "height_m"]
position_std_columns = ["sn_m", "se_m", "sd_m"]
velocity = ["vn_mps", "ve_mps", "vd_mps"]
velocity_std_columns = ["svn_mps", "sve_mps", "svd_mps"]
lever_arm = "{}, {}, {} m"

[truth]
file = "truth.csv"
time = "t_s"
position = ["lat_deg", "lon_deg", "height_m"]
attitude = ["roll_deg", "pitch_deg", "yaw_deg"]
"#,
            self.model, lever.x, lever.y, lever.z
        )
    }
}

fn create(file: &Path) -> io::Result<BufWriter<PendingFile>> {
    PendingFile::create(file).map(BufWriter::new)
}

fn invalid(error: SimulationError) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, error)
}
