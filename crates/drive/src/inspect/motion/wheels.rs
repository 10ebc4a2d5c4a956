//! Whether a craft moves as wheels do: the side slip and the vertical speed of the solution in the vehicle's axes, with
//! the fixes whole and without any constraint (Groves 2013, section 15.4.1, is what a car's profile promises of them).

use crate::{
    align::Heading,
    drive::Drive,
    estimator::Estimator,
    navigate::{NavigateError, Wanted, navigate, settings},
    replay::{Measurement, Observer, ReplayError, replay},
    vehicle::Profile,
};
use undrift_nav::{Matrix3, Vector3, earth::wrap_pi};
use undrift_noise::BiasModel;

/// Time from one velocity to the next \[s\], speed above which they count [m/s], and length of the windows of motion \[s\].
const EVERY: f64 = 0.2;
const MIN_SPEED: f64 = 1.0;
const WINDOW: f64 = 30.0;
/// Part of a log that is looked at \[s\].
pub(super) const LONGEST: f64 = 3600.0;
/// Motion \[s\], turning \[rad\] and speed [m/s] that a test takes: a current or a crosswind shows itself only where the craft
/// points elsewhere in it, and what goes at a walk may be on foot.
const LEAST: (f64, f64, f64) = (30.0, 0.78, 3.0);
/// Standard deviation of the solution's own velocity to the side from which nothing is seen beside it [m/s].
const BLIND: f64 = 0.4;
/// Side slip and vertical speed of wheels [m/s, RMS] beyond what the solution's standard deviations explain: 0 to 0.1 on 16
/// drives of eight cars; 0.13 for a boat in a current of 0.2 m/s and 0.15 in a swell of 0.2 m/s, 0.7 to 4.4 for aircraft.
const WHEELS: f64 = 0.12;
/// How much more it may be in the worst window.
const WORST: f64 = 2.5;

/// How much a craft moves across its own forward axis beyond the solution's own error, RMS [m/s], when what a turned mounting,
/// an axle elsewhere and slip in proportion to the lateral acceleration make of it is taken out.
pub(super) struct Slip {
    pub(super) right: f64,
    pub(super) down: f64,
}

impl Slip {
    /// Whether wheels slip and hop so little.
    pub(super) fn is_of_wheels(&self) -> bool {
        self.right < WHEELS && self.down < WHEELS
    }
}

/// How much a drive moves across its vehicle's axes, which its body axes are to a few degrees; `None` where it cannot be
/// navigated, or is too short, too straight or too slow to show it.
pub(super) fn side_slip(drive: &Drive) -> Option<Slip> {
    let watch = watched(drive).ok()?;
    watch.judge()
}

/// Whether the constraints of a car hold while such a drive is navigated with them from its start, as it will be.
pub(super) fn is_held(drive: &Drive) -> bool {
    let drive = drive.clone().with_vehicle(Profile::Car);
    let report = navigate(&drive, BiasModel::Arma, Wanted::default());
    report.is_ok_and(|report| report.summary.side_slip.is_none())
}

/// Navigates without constraints.
fn watched(drive: &Drive) -> Result<SlipWatch, NavigateError> {
    let mut settings = settings(drive, BiasModel::Arma)?;
    settings.align.heading = Heading::Auto;
    let mut watch = SlipWatch::default();
    let mut fixes = drive.open_gnss()?.map(|fix| fix.map(Measurement::Gnss));
    replay(&mut drive.open_imu()?, &mut fixes, &settings, &mut watch)?;
    Ok(watch)
}

/// Velocities in body axes, of every [`EVERY`] seconds of motion.
#[derive(Default)]
struct SlipWatch {
    last: Option<f64>,
    moving: Vec<Moving>,
}

struct Moving {
    /// Forward, right, down [m/s].
    velocity: Vector3,
    /// Variances of the last two as the solution has them [m²/s²].
    variance: [f64; 2],
    /// Rate of turn [rad/s].
    turn: f64,
    heading: f64,
}

impl Observer for SlipWatch {
    fn sample(&mut self, filter: &dyn Estimator) -> Result<(), ReplayError> {
        let nav = filter.nav();
        if self.last.is_some_and(|last| nav.time < last + EVERY) {
            return Ok(());
        }
        self.last = Some(nav.time);
        let velocity = nav.q_nb.inverse() * nav.v_n;
        if velocity.x.abs() > MIN_SPEED {
            let [_, _, _, north, east, down, roll, pitch, yaw] = filter.nav_std();
            let half = |a: f64, b: f64| 0.5 * (a * a + b * b);
            let speed = velocity.x * velocity.x;
            self.moving.push(Moving {
                velocity,
                variance: [
                    half(north, east) + yaw * yaw * speed,
                    down * down + half(roll, pitch) * speed,
                ],
                turn: filter.omega_nb_b().z,
                heading: nav.q_nb.euler_angles().2,
            });
        }
        Ok(())
    }
}

impl SlipWatch {
    fn judge(&self) -> Option<Slip> {
        let moving = &self.moving;
        let fast = moving.iter().filter(|at| at.velocity.x.abs() > LEAST.2);
        let short = (moving.len() as f64 * EVERY) < LEAST.0 || 10 * fast.count() < moving.len();
        if short || turned(moving) < LEAST.1 {
            return None;
        }
        let [right, down] = [0, 1].map(|axis| across(moving, axis));
        let slip = Slip { right, down };
        let variance = moving.iter().map(|at| at.variance[0]).sum::<f64>() / moving.len() as f64;
        let blind = variance > BLIND * BLIND;
        (!blind || !slip.is_of_wheels()).then_some(slip)
    }
}

/// RMS of what goes to the right (0) or down (1) [m/s] beyond the solution's own standard deviations: that of all, or that of
/// the worst window beyond two of them, which may be [`WORST`] times as large.
fn across(moving: &[Moving], axis: usize) -> f64 {
    let residuals = residuals(moving, 1 + axis);
    let beyond = |part: &[(f64, f64)], times: f64| {
        let sum: f64 = part.iter().map(|(square, own)| square - times * own).sum();
        (sum / part.len() as f64).max(0.0).sqrt()
    };
    let squares = residuals.into_iter().zip(moving);
    let squares: Vec<_> = squares
        .map(|(residual, at)| (residual * residual, at.variance[axis]))
        .collect();
    let windows = squares.chunks((WINDOW / EVERY) as usize);
    let windows = windows.map(|window| beyond(window, 4.0) / WORST);
    windows.fold(beyond(&squares, 1.0), f64::max)
}

/// The widest angle between two headings along the way \[rad\], without whole turns taken off.
fn turned(moving: &[Moving]) -> f64 {
    let (mut at, mut least, mut most) = (0.0, 0.0f64, 0.0f64);
    for pair in moving.windows(2) {
        at += wrap_pi(pair[1].heading - pair[0].heading);
        (least, most) = (least.min(at), most.max(at));
    }
    most - least
}

/// The velocity along one axis [m/s] without what a turned mounting (proportional to the speed), an axle elsewhere (to the
/// rate of turn) and slip in turns (to the lateral acceleration) make of it, by least squares.
fn residuals(moving: &[Moving], axis: usize) -> Vec<f64> {
    let terms = |at: &Moving| Vector3::new(at.velocity.x, at.turn, at.velocity.x * at.turn);
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for at in moving {
        let terms = terms(at);
        normal += terms * terms.transpose();
        right += terms * at.velocity[axis];
    }
    let fitted = normal
        .cholesky()
        .map_or(Vector3::zeros(), |root| root.solve(&right));
    let residual = |at: &Moving| at.velocity[axis] - fitted.dot(&terms(at));
    moving.iter().map(residual).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A minute and a half at 10 m/s in a circle, `turns` of them, with a mounting 0.02 rad off, an axle 1.5 m behind and slip, on
    /// water that flows to the north [m/s], known to `std` [m/s].
    fn judged(turns: f64, current: f64, std: f64) -> Option<Slip> {
        let moving = (0..450).map(|k| {
            let heading = turns * 2.0 * std::f64::consts::PI * f64::from(k) / 450.0;
            // A wheel that turns more and less.
            let turn = 0.1 * (0.07 * f64::from(k)).sin();
            let of_wheels = 0.02 * 10.0 + 1.5 * turn - 0.02 * 10.0 * turn;
            let flows = [current * heading.cos(), -current * heading.sin()];
            Moving {
                velocity: Vector3::new(10.0 + flows[0], of_wheels + flows[1], 0.0),
                variance: [std * std; 2],
                turn,
                heading,
            }
        });
        let watch = SlipWatch {
            last: None,
            moving: moving.collect(),
        };
        watch.judge()
    }

    #[test]
    fn what_flows_across_is_no_wheels() {
        let slip = judged(1.0, 0.0, 0.0).unwrap();
        assert!(slip.right < 1e-9 && slip.down < 1e-9 && slip.is_of_wheels());
        // The RMS of a sine, but for what the mounting takes of it.
        let slip = judged(1.0, 0.3, 0.0).unwrap();
        let expected = 0.3 * 0.5f64.sqrt();
        assert!((slip.right / expected - 1.0).abs() < 0.1, "{}", slip.right);
        assert!(!slip.is_of_wheels());
        // The solution's own error explains it, or hides it.
        assert!(judged(1.0, 0.3, 0.25).unwrap().is_of_wheels());
        assert!(judged(1.0, 0.3, 0.5).is_none());
        // Straight on nothing shows.
        assert!(judged(0.1, 0.3, 0.0).is_none());
    }
}
