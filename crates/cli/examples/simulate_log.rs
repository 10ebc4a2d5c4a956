//! Writes a simulated car drive as a log: imu.csv, gnss.csv, truth.csv and drive.toml.
//!
//! `cargo run --release -p undrift-cli --example simulate_log -- DIR [SECONDS [RATE_HZ [SEED]]]`, by
//! default eight hours at 100 Hz. The sensor is the preset adis16405 with all its terms.

use std::{
    fs::{File, create_dir_all, write},
    io::{BufWriter, Write},
    path::Path,
};
use undrift::{
    nav::sample::Position,
    noise::{BiasModel, ImuModel},
    simulate::{GnssFixes, GnssNoise, Increments, SensorErrors, Trajectory},
};

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().ok_or("give a folder to write to")?;
    let folder = Path::new(&folder);
    let mut number = |default: f64| -> Result<f64, Failure> {
        Ok(arguments.next().map_or(Ok(default), |text| text.parse())?)
    };
    let (duration, rate, seed) = (number(28_800.0)?, number(100.0)?, number(1.0)? as u64);
    create_dir_all(folder)?;
    let car = Trajectory::car(duration, seed);
    let model = ImuModel::preset("adis16405").ok_or("no such preset")?;
    let filters = model.shaping(BiasModel::GaussMarkov, 1.0 / rate)?;
    let mut errors = SensorErrors::new(&filters, rate, seed)?;

    let mut imu = BufWriter::new(File::create(folder.join("imu.csv"))?);
    let mut truth = BufWriter::new(File::create(folder.join("truth.csv"))?);
    writeln!(
        imu,
        "t_s,gx_radps,gy_radps,gz_radps,fx_mps2,fy_mps2,fz_mps2"
    )?;
    writeln!(
        truth,
        "t_s,lat_deg,lon_deg,height_m,roll_deg,pitch_deg,yaw_deg"
    )?;
    for (k, (ideal, reference)) in Increments::new(&car, rate).enumerate() {
        let sample = errors.apply(&ideal);
        let (w, f) = (sample.dtheta / sample.dt, sample.dvel / sample.dt);
        writeln!(
            imu,
            "{:.4},{:.9},{:.9},{:.9},{:.7},{:.7},{:.7}",
            sample.time, w.x, w.y, w.z, f.x, f.y, f.z
        )?;
        if k % 10 == 0
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
    imu.flush()?;
    truth.flush()?;

    let receiver = GnssNoise::default();
    let mut gnss = BufWriter::new(File::create(folder.join("gnss.csv"))?);
    writeln!(
        gnss,
        "t_s,lat_deg,lon_deg,height_m,sn_m,se_m,sd_m,vn_mps,ve_mps,vd_mps,svn_mps,sve_mps,svd_mps"
    )?;
    for fix in GnssFixes::new(&car, &receiver, seed)? {
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
        for value in [
            p[(0, 0)].sqrt(),
            p[(1, 1)].sqrt(),
            p[(2, 2)].sqrt(),
            v.x,
            v.y,
            v.z,
        ] {
            write!(gnss, ",{value:.5}")?;
        }
        for i in 0..3 {
            write!(gnss, ",{:.5}", r[(i, i)].sqrt())?;
        }
        writeln!(gnss)?;
    }
    gnss.flush()?;
    let lever = receiver.lever_arm;
    write(
        folder.join("drive.toml"),
        format!(
            r#"model = "adis16405"

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
            lever.x, lever.y, lever.z
        ),
    )?;
    println!("{}", folder.display());
    Ok(())
}
