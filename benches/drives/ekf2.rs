//! Navigates a pass of a drive with PX4's EKF2 through the crate ekf2: `FOLDER PASS MODEL OUT`. Its own start, its own defaults but for
//! the noise of the sensor and the lever arm. Built by `drives.py` in a throw-away crate.

use ekf2::{
    Ekf, EkfConfig, HeightReference, MagFusionType,
    types::{GnssSample, ImuSample},
};
use std::{env, error::Error, fs, path::Path};

fn read(path: &Path) -> Result<Vec<f64>, Box<dyn Error>> {
    let bytes = fs::read(path)?;
    let (numbers, _) = bytes.as_chunks::<8>();
    Ok(numbers.iter().map(|b| f64::from_le_bytes(*b)).collect())
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [folder, pass, model, out] = &arguments[..] else {
        return Err("give the folder, pass, model and output".into());
    };
    let folder = Path::new(folder);
    let get = |name: &str| read(&folder.join(format!("{name}.f64")));
    let (imu, gnss, lever) = (get("imu")?, get(&format!("pass{pass}"))?, get("lever")?);
    let wanted = get(&format!("wanted{pass}"))?;
    let (first, last) = (imu[0], imu[imu.len() - 7]);
    let step = (last - first) / (imu.len() / 7 - 1) as f64;
    let mut filter =
        Ekf::with_config(EkfConfig::default()).map_err(|error| format!("{error:?}"))?;
    {
        let mut params = filter.params_mut();
        if model != "default" {
            let model = get(&format!("model-{model}"))?;
            // Its noises are those of a step of its own, 0.01 s.
            let a_step = |density: f64| (density / 0.1) as f32;
            params.set_gyro_noise(a_step(model[0]));
            params.set_gyro_bias_noise(a_step(model[1]));
            params.set_gyro_bias_init((model[2] as f32).min(0.2));
            params.set_accel_noise(a_step(model[3]));
            params.set_accel_bias_noise(a_step(model[4]));
            params.set_accel_bias_init((model[5] as f32).min(0.5));
        }
        params.set_hgt_ref(HeightReference::Gnss);
        params.set_mag_fusion_type(MagFusionType::None);
        params.set_gps_delay_ms(0.0);
        params.set_gps_pos_body([lever[0] as f32, lever[1] as f32, lever[2] as f32]);
        // Not to be dropped after a few seconds without a fix.
        params.set_no_aid_timeout_us(120_000_000);
    }
    let micros = |time: f64| ((time - first) * 1e6) as u64 + 1_000_000;
    let (mut rows, mut fix, mut want) = (Vec::new(), 0, 0);
    let mut before = first - step;
    for row in imu.chunks_exact(7) {
        let dt = ((row[0] - before) as f32).clamp(1e-4, 0.1);
        before = row[0];
        let scaled = |at: usize| {
            [
                row[at] as f32 * dt,
                row[at + 1] as f32 * dt,
                row[at + 2] as f32 * dt,
            ]
        };
        filter.set_imu_data(&ImuSample::new(
            micros(row[0]),
            scaled(1),
            scaled(4),
            dt,
            dt,
        ));
        while fix + 13 <= gnss.len() && gnss[fix] <= row[0] {
            let g = &gnss[fix..fix + 13];
            fix += 13;
            let velocity = [g[4] as f32, g[5] as f32, g[6] as f32];
            filter.set_gps_data(&GnssSample::new(
                micros(g[0]),
                g[1].to_degrees(),
                g[2].to_degrees(),
                g[3] as f32,
                velocity,
                g[7].max(g[8]) as f32,
                g[9] as f32,
                g[10].max(g[11]) as f32,
                1.0,
                3,
                12,
            ));
        }
        filter.update();
        while want < wanted.len() && row[0] >= wanted[want] {
            want += 1;
            let (lat, lon, height) = filter.lat_lon_alt();
            let valid = filter.attitude_valid() && lat != 0.0;
            let place = if valid {
                [lat.to_radians(), lon.to_radians()]
            } else {
                [f64::NAN; 2]
            };
            let [w, x, y, z] = filter.quaternion().map(f64::from);
            rows.extend([row[0], place[0], place[1], f64::from(height)]);
            rows.extend(filter.velocity_ned().map(f64::from));
            rows.extend(filter.pos_variance().map(|v| f64::from(v).sqrt()));
            rows.push((2.0 * (w * z + x * y)).atan2(1.0 - 2.0 * (y * y + z * z)));
        }
    }
    let bytes: Vec<u8> = rows
        .iter()
        .flat_map(|value: &f64| value.to_le_bytes())
        .collect();
    Ok(fs::write(out, bytes)?)
}
