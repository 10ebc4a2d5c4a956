//! How the IMU sits by its forces: for drives too short or too slow to navigate in sensor axes.
//!
//! On average over a drive specific force points up. Across that it is what changes the speed, along the vehicle's
//! forward axis, and speed times turn rate, to its right: as complex numbers `F = c (v̇ + i v ω) + const` with the
//! argument of c the direction of forward in the level plane of the sensor, found by least squares.

use nalgebra::Complex;
use undrift_nav::{
    Matrix3, Quaternion, Vector3,
    attitude::to_rpy,
    earth::STANDARD_GRAVITY,
    sample::{GnssFix, ImuSample},
};

/// Fixes are taken this far apart \[s\], and no further than that.
const APART: (f64, f64) = (1.0, 3.0);
/// Least speed [m/s]: below it the course is noise.
const MIN_SPEED: f64 = 1.0;
/// Least number of spans.
const FEWEST: usize = 12;
/// The magnitude of c, which is 1 where the fixes and the sensors see the same motion.
const MAGNITUDE: (f64, f64) = (0.6, 1.4);
/// Largest standard deviation of the direction \[rad\].
const CERTAIN: f64 = 0.1;

/// Roll, pitch and yaw of the sensor in the vehicle, and the standard deviation of the yaw \[rad\]; from samples in
/// sensor axes and fixes with velocities. `None` where the motion does not show it.
pub fn by_force(imu: &[ImuSample], fixes: &[GnssFix]) -> Option<(Vector3, f64)> {
    let force: Vector3 = imu.iter().map(|sample| sample.dvel).sum();
    let down = -force.try_normalize(1e-9)?;
    // Level axes: the sensor axis that is the most level, and what is to the right of it.
    let ahead = Vector3::ith(down.iamin(), 1.0);
    let ahead = (ahead - down * down.dot(&ahead)).try_normalize(1e-9)?;
    let right = down.cross(&ahead);

    let mut pairs: Vec<(Complex<f64>, Complex<f64>)> = Vec::new();
    let mut before: Option<(f64, Vector3)> = None;
    for (time, v_n) in fixes
        .iter()
        .filter_map(|fix| Some((fix.time, fix.velocity?.0)))
    {
        let Some((last, v_last)) = before else {
            before = Some((time, v_n));
            continue;
        };
        let span = time - last;
        if span < APART.0 {
            continue;
        }
        before = Some((time, v_n));
        let (slow, fast) = (v_last.xy().norm(), v_n.xy().norm());
        if span > APART.1 || slow.min(fast) < MIN_SPEED {
            continue;
        }
        let from = imu.partition_point(|sample| sample.time <= last);
        let to = imu.partition_point(|sample| sample.time <= time);
        let samples = imu.get(from..to)?;
        let covered: f64 = samples.iter().map(|sample| sample.dt).sum();
        if (covered - span).abs() > 0.1 * span {
            continue;
        }
        let mean = samples.iter().map(|sample| sample.dvel).sum::<Vector3>() / covered;
        let turned = v_last.xy().perp(&v_n.xy());
        let turned = turned.atan2(v_last.xy().dot(&v_n.xy()));
        let motion = Complex::new(fast - slow, 0.5 * (fast + slow) * turned) / span;
        pairs.push((motion, Complex::new(mean.dot(&ahead), mean.dot(&right))));
    }
    let n = pairs.len();
    if n < FEWEST {
        return None;
    }
    let (motion, force) = pairs.iter().fold(
        Default::default(),
        |sum: (Complex<f64>, Complex<f64>), pair| (sum.0 + pair.0, sum.1 + pair.1),
    );
    let (motion, force) = (motion / n as f64, force / n as f64);
    let (mut product, mut power, mut total) = (Complex::new(0.0, 0.0), 0.0, 0.0);
    for (u, f) in &pairs {
        let (u, f) = (u - motion, f - force);
        product += u.conj() * f;
        power += u.norm_sqr();
        total += f.norm_sqr();
    }
    let c = product / power;
    let size = c.norm();
    let unexplained = (total - size * size * power).max(0.0) / (2 * n - 4) as f64;
    let std = (unexplained / power).sqrt() / size;
    if !(MAGNITUDE.0..MAGNITUDE.1).contains(&size) || std > CERTAIN {
        return None;
    }
    // What is left of the force where nothing changes: the level axes were not quite level.
    let tilt = force - c * motion;
    let down = (down * STANDARD_GRAVITY - ahead * tilt.re - right * tilt.im).try_normalize(1e-9)?;
    let forward = (ahead * c.re + right * c.im) / size;
    let forward = (forward - down * down.dot(&forward)).try_normalize(1e-9)?;
    let rows = [forward, down.cross(&forward), down].map(|axis| axis.transpose());
    let q_vb = Quaternion::from_matrix(&Matrix3::from_rows(&rows));
    Some((to_rpy(&q_vb), std))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::{GnssNoise, Trajectory, simulate};
    use undrift_nav::attitude::from_rpy;

    #[test]
    fn an_imu_in_any_place_is_found_by_its_forces() {
        for (seed, rpy) in [
            (1, [3.1, -0.1, 1.7]),
            (2, [0.1, 1.2, -0.5]),
            (3, [-1.5, 0.2, 2.9]),
        ] {
            let q_vb = from_rpy(&Vector3::from(rpy));
            let log = simulate(
                &Trajectory::car(300.0, seed),
                50.0,
                None,
                &GnssNoise::default(),
                seed,
            );
            let log = log.unwrap();
            let turned = log.imu.iter().map(|sample| ImuSample {
                dtheta: q_vb.inverse() * sample.dtheta,
                dvel: q_vb.inverse() * sample.dvel,
                ..*sample
            });
            let (found, std) = by_force(&Vec::from_iter(turned), &log.gnss).unwrap();
            let off = from_rpy(&found).angle_to(&q_vb);
            // Hills are no part of it.
            assert!(off < 3.0 * std + 0.02, "{off} {std}");
            assert!(std < 0.1, "{std}");
        }
    }

    #[test]
    fn what_stands_shows_nothing() {
        let log = simulate(
            &Trajectory::car(60.0, 1),
            50.0,
            None,
            &GnssNoise::default(),
            1,
        )
        .unwrap();
        assert_eq!(by_force(&log.imu, &log.gnss[..20]), None);
    }
}
