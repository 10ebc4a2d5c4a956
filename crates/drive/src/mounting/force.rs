//! How the IMU sits by its forces: for drives too short or too slow to navigate in sensor axes.
//!
//! On average over a drive specific force points up. Across that it is what changes the speed, along the vehicle's
//! forward axis, and speed times turn rate, to its right: as complex numbers `F = c (v̇ + i v ω) + slope` with the
//! argument of c the direction of forward in the level plane of the sensor, found by least squares. Speeds are those of
//! the fixes and turn rates those of the gyros, since one bad position bends a course by far more than a speed. The slope
//! of the road changes over longer than a manoeuvre takes: a running mean takes it out, and what is left of it in the
//! mean, where all goes up or down, is what the heights of the fixes show.

use nalgebra::Complex;
use undrift_engine::derived::antenna;
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
/// To each side of a span, of which the mean is taken out with the slope of the road \[s\].
const SLOPE: f64 = 10.0;
/// The magnitude of c, which is 1 where the fixes and the sensors see the same motion.
const MAGNITUDE: (f64, f64) = (0.6, 1.4);
/// Largest standard deviation of the direction \[rad\].
const CERTAIN: f64 = 0.1;
/// Least correlation of the turns of gyros and course that are compared.
const ALIKE: f64 = 0.7;

/// Motion from one fix to a later one.
struct Span {
    /// End of the span \[s\].
    time: f64,
    length: f64,
    /// Speeds at both ends [m/s], and the angle by which the course turns right \[rad\].
    speeds: [f64; 2],
    turned: f64,
    /// What its heights differ by \[m\].
    climb: Option<f64>,
    /// Mean specific force [m/s²] and angular rate [rad/s], sensor axes.
    force: Vector3,
    rate: Vector3,
}

/// Down in sensor axes, and what is driven between fixes; from samples in sensor axes and fixes with velocities.
fn spans(imu: &[ImuSample], fixes: &[GnssFix]) -> Option<(Vector3, Vec<Span>)> {
    let force: Vector3 = imu.iter().map(|sample| sample.dvel).sum();
    let down = -force.try_normalize(1e-9)?;
    let mut spans = Vec::new();
    let moving = |fix: &GnssFix| {
        Some((
            fix.time,
            fix.velocity?.0,
            antenna(fix).map(|place| place.height),
        ))
    };
    let mut before: Option<(f64, Vector3, Option<f64>)> = None;
    for (time, v_n, height) in fixes.iter().filter_map(moving) {
        let Some((last, v_last, last_height)) = before else {
            before = Some((time, v_n, height));
            continue;
        };
        let length = time - last;
        if length < APART.0 {
            continue;
        }
        before = Some((time, v_n, height));
        let (slow, fast) = (v_last.xy().norm(), v_n.xy().norm());
        if length > APART.1 || slow.min(fast) < MIN_SPEED {
            continue;
        }
        let from = imu.partition_point(|sample| sample.time <= last);
        let to = imu.partition_point(|sample| sample.time <= time);
        let samples = imu.get(from..to)?;
        let covered: f64 = samples.iter().map(|sample| sample.dt).sum();
        if (covered - length).abs() > 0.1 * length {
            continue;
        }
        let across = v_last.xy().perp(&v_n.xy());
        spans.push(Span {
            time,
            length,
            speeds: [slow, fast],
            turned: across.atan2(v_last.xy().dot(&v_n.xy())),
            climb: height.zip(last_height).map(|(height, last)| height - last),
            force: samples.iter().map(|sample| sample.dvel).sum::<Vector3>() / covered,
            rate: samples.iter().map(|sample| sample.dtheta).sum::<Vector3>() / covered,
        });
    }
    (spans.len() >= FEWEST).then_some((down, spans))
}

/// Ratio of the turns of the gyros to those of the course of the fixes [–]: 1 where units are right, 57.3 where deg/s are taken for rad/s;
/// `None` where it does not show.
pub fn turn_ratio(imu: &[ImuSample], fixes: &[GnssFix]) -> Option<f64> {
    let (correlation, ratio) = turns(imu, fixes)?;
    (correlation > ALIKE).then_some(ratio)
}

/// Whether the specific force has the opposite sign: with gravity where it points, the gyros turn against the course, and
/// reversed the forces are those of the motion.
pub fn is_force_reversed(imu: &[ImuSample], fixes: &[GnssFix]) -> bool {
    let against = turns(imu, fixes).is_some_and(|(correlation, _)| correlation < -ALIKE);
    let reversed = |sample: &ImuSample| ImuSample {
        dvel: -sample.dvel,
        ..*sample
    };
    against && by_force(&imu.iter().map(reversed).collect::<Vec<_>>(), fixes).is_some()
}

/// Correlation of the turns of gyros and course, and how many times as large those of the gyros are.
fn turns(imu: &[ImuSample], fixes: &[GnssFix]) -> Option<(f64, f64)> {
    let (down, spans) = spans(imu, fixes)?;
    let turns = |span: &Span| [span.turned / span.length, span.rate.dot(&down)];
    let count = spans.len() as f64;
    let mean = [0, 1].map(|k| spans.iter().map(|span| turns(span)[k]).sum::<f64>() / count);
    let (mut course, mut gyros, mut both) = (0.0, 0.0, 0.0);
    for span in &spans {
        let [turned, rate] = turns(span);
        let (turned, rate) = (turned - mean[0], rate - mean[1]);
        course += turned * turned;
        gyros += rate * rate;
        both += turned * rate;
    }
    // `down` is measured by gravity: the signs agree even if the sensor is upside down in the file.
    let correlation = both / (course * gyros).sqrt();
    let ratio = (gyros / course).sqrt();
    (correlation.is_finite() && ratio.is_finite()).then_some((correlation, ratio))
}

/// Roll, pitch and yaw of the sensor in the vehicle, and the standard deviation of the yaw \[rad\]; from samples in
/// sensor axes and fixes with velocities. `None` where the motion does not show it.
///
/// A first look without a solution, from the forces in turns and when speeding up; [`estimate`](super::estimate) is the better one.
pub fn by_force(imu: &[ImuSample], fixes: &[GnssFix]) -> Option<(Vector3, f64)> {
    let (down, spans) = spans(imu, fixes)?;
    // Level axes: the sensor axis that is the most level, and what is to the right of it.
    let ahead = Vector3::ith(down.iamin(), 1.0);
    let ahead = (ahead - down * down.dot(&ahead)).try_normalize(1e-9)?;
    let right = down.cross(&ahead);
    let pair = |span: &Span| {
        let [slow, fast] = span.speeds;
        let across = 0.5 * (slow + fast) * span.rate.dot(&down);
        let force = Complex::new(span.force.dot(&ahead), span.force.dot(&right));
        (Complex::new((fast - slow) / span.length, across), force)
    };
    let pairs: Vec<_> = spans.iter().map(pair).collect();
    let mean = |pairs: &[(Complex<f64>, Complex<f64>)]| {
        let sum = pairs
            .iter()
            .fold((Complex::ZERO, Complex::ZERO), |sum, pair| {
                (sum.0 + pair.0, sum.1 + pair.1)
            });
        let count = pairs.len() as f64;
        (sum.0 / count, sum.1 / count)
    };
    let (mut product, mut power, mut total, mut free) = (Complex::ZERO, 0.0, 0.0, -2.0);
    for (span, (motion, force)) in spans.iter().zip(&pairs) {
        let from = spans.partition_point(|other| other.time < span.time - SLOPE);
        let to = spans.partition_point(|other| other.time <= span.time + SLOPE);
        let around = &pairs[from..to];
        let (mean_motion, mean_force) = mean(around);
        let (u, f) = (motion - mean_motion, force - mean_force);
        product += u.conj() * f;
        power += u.norm_sqr();
        total += f.norm_sqr();
        free += 2.0 * (1.0 - 1.0 / around.len() as f64);
    }
    let c = product / power;
    let size = c.norm();
    let unexplained = (total - size * size * power).max(0.0) / free;
    let std = (unexplained / power).sqrt() / size;
    if free < FEWEST as f64 || !(MAGNITUDE.0..MAGNITUDE.1).contains(&size) || std > CERTAIN {
        return None;
    }
    // What is left of the force where nothing changes: the level axes were not quite level.
    let (motion, force) = mean(&pairs);
    let (mut climbed, mut driven) = (0.0, 0.0);
    for span in &spans {
        let length = 0.5 * (span.speeds[0] + span.speeds[1]) * span.length;
        climbed += span.climb.unwrap_or(0.0);
        driven += span.climb.map_or(0.0, |_| length);
    }
    let slope = if driven > 0.0 { climbed / driven } else { 0.0 };
    let tilt = force - c * motion - c / size * (STANDARD_GRAVITY * slope);
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
    use undrift_nav::{attitude::from_rpy, sample::Position};
    use undrift_simulate::{GnssNoise, Trajectory, simulate};

    #[test]
    fn an_imu_in_any_place_is_found_by_its_forces() {
        for (seed, rpy, slope) in [
            (1, [3.1, -0.1, 1.7], 0.0),
            (2, [0.1, 1.2, -0.5], 0.0),
            (3, [-1.5, 0.2, 2.9], 0.0),
            // All the way up, or down.
            (1, [3.1, -0.1, 1.7], 0.08),
            (3, [-1.5, 0.2, 2.9], -0.08),
        ] {
            let q_vb = from_rpy(&Vector3::from(rpy));
            let mut log = simulate(
                &Trajectory::car(300.0, seed),
                50.0,
                None,
                &GnssNoise::default(),
                seed,
            )
            .unwrap();
            let level = q_vb.inverse() * from_rpy(&Vector3::new(0.0, slope, 0.0)).inverse();
            let turned = log.imu.iter().map(|sample| ImuSample {
                dtheta: level * sample.dtheta,
                dvel: level * sample.dvel,
                ..*sample
            });
            let turned = Vec::from_iter(turned);
            let mut climbed = 0.0;
            let mut last = 0.0;
            for fix in &mut log.gnss {
                let speed = fix.velocity.map_or(0.0, |(v_n, _)| v_n.xy().norm());
                climbed += speed * f64::tan(slope) * (fix.time - last);
                last = fix.time;
                if let Some((Position::Geodetic(place), _)) = &mut fix.position {
                    place.height += climbed;
                }
            }
            let (found, std) = by_force(&turned, &log.gnss).unwrap();
            let off = from_rpy(&found).angle_to(&q_vb);
            // Of hills, what the simulated body rolls and pitches on its wheels is left.
            assert!(off < 3.0 * std + 0.02, "{off} {std}");
            assert!(std < 0.1, "{std}");
            let in_degrees = |sample: &ImuSample| ImuSample {
                dtheta: sample.dtheta * 1f64.to_degrees(),
                ..*sample
            };
            let wrong = Vec::from_iter(log.imu.iter().map(in_degrees));
            for (imu, wanted) in [(&log.imu, 1.0), (&wrong, 1f64.to_degrees())] {
                // The course is that of the antenna at the ends, the rate the mean between.
                let ratio = turn_ratio(imu, &log.gnss).unwrap() / wanted;
                assert!((0.9..1.1).contains(&ratio), "{ratio}");
            }
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
        assert_eq!(turn_ratio(&log.imu, &log.gnss[..20]), None);
    }
}
