//! Course against heading: it shows a wrong heading that position and velocity hardly observe.
//!
//! A vehicle that drives straight goes where it points, but for a slip or a crab angle that changes slowly. How far
//! course and heading usually are apart is learned; where that changes for good, it is the heading that went wrong (a
//! gyro's bias that jumped, a scale factor), and its σ grows to what is seen.
//!
//! Differences are taken once a second, above 4 m/s, on a straight way, with a course known to 0.1 rad. The
//! usual difference is the median of up to 120 of them, its spread 1.4826 times their median deviation; the
//! present one is the median of eight. Where that has moved by four spreads and by two standard deviations of
//! the heading, what the heading's variance lacks is added to it, and a share to that of the vertical gyro. The IMU may sit in any way:
//! before its mounting is known, too.

use super::summary::Summary;
use crate::estimator::Estimator;
use crate::median::{median, upper_median};
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::{ComplexField, RealField};
use undrift_nav::{Matrix3, earth::wrap_pi, sample::GnssFix};

/// Differences that the usual one is taken from, one a second.
const USUAL: usize = 120;
/// Differences that the present one is taken from.
const RECENT: usize = 8;

/// Speed above which there is a course \[m/s\].
const SPEED: f64 = 4.0;
/// Largest standard deviation of the course \[rad\].
const COURSE_STD: f64 = 0.1;
/// Turn rate below which the vehicle goes straight \[rad/s\].
const STRAIGHT: f64 = 0.1;
/// Cosine of the angle between down and the body axis next to it below which there is no heading.
const LEVEL: f64 = 0.94;
/// Courses further apart than this do not belong together \[s\].
const APART: f64 = 30.0;
/// Differences of course and heading after which the usual one is known.
const LEAST: usize = 30;
/// Standard deviation of a heading from which the usual difference is learned \[rad\].
const KNOWN: f64 = 0.05;
/// Least spread of the usual difference \[rad\]: wind and slip.
const LEAST_SPREAD: f64 = 0.01;
/// Spreads of the usual difference by which it has changed where the heading is wrong.
const SPREADS: f64 = 4.0;
/// Standard deviations of the heading by which it has changed, too, where the heading is wrong.
const SIGMAS: f64 = 2.0;

/// Azimuth of the first body axis that is level, by C_b^n \[rad\]: the heading of a body whose z axis points down. `None` where no axis is within 20° of the
/// vertical.
fn azimuth(c_nb: &Matrix3) -> Option<f64> {
    let upright = (0..3).find(|axis| c_nb[(2, *axis)].abs() > LEVEL)?;
    let ahead = usize::from(upright == 0);
    Some(c_nb[(1, ahead)].atan2(c_nb[(0, ahead)]))
}

/// Watches the course against the heading.
#[derive(Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct CourseWatch {
    /// Time of the last difference \[s\].
    last: f64,
    /// Course less heading, while the heading was known to 0.05 rad \[rad\].
    #[cfg_attr(feature = "checkpoint", serde(with = "crate::kept::array"))]
    usual: [f64; USUAL],
    /// Differences learned so far.
    learned: usize,
    /// The last differences \[rad\].
    recent: [f64; RECENT],
    seen: usize,
    /// Whether the heading is in doubt.
    doubted: bool,
}

impl CourseWatch {
    /// Nothing is known of the usual difference: it takes 30 s of straight driving.
    pub(super) fn new() -> Self {
        Self {
            last: f64::NEG_INFINITY,
            usual: [0.0; USUAL],
            learned: 0,
            recent: [0.0; RECENT],
            seen: 0,
            doubted: false,
        }
    }

    /// Looks at a fix that the filter was shown.
    ///
    /// It may inflate the covariance of heading and gyro z; the heading itself it leaves to the fixes that follow.
    ///
    /// Fixes within a second of the last one, slow ones, and those in turns are passed over.
    pub(super) fn fix(&mut self, filter: &mut dyn Estimator, fix: &GnssFix, summary: &mut Summary) {
        let Some((v, r)) = fix.velocity else { return };
        let speed = v.xy().norm();
        let course_std = (0.5 * (r[(0, 0)] + r[(1, 1)])).max(0.0).sqrt() / speed;
        let straight = filter.omega_nb_b().norm() < STRAIGHT;
        let heading_std = filter.nav_std()[8];
        if fix.time - self.last < 1.0 || speed < SPEED || course_std > COURSE_STD || !straight {
            return;
        }
        let c_nb = filter.nav().q_nb.to_rotation_matrix().into_inner();
        let Some(heading) = azimuth(&c_nb) else {
            return;
        };
        if fix.time - self.last > APART {
            self.seen = 0;
        }
        self.last = fix.time;
        let off = wrap_pi(v.y.atan2(v.x) - heading);
        self.recent[self.seen % RECENT] = off;
        self.seen += 1;
        if self.seen < RECENT {
            return;
        }
        if self.learned < LEAST {
            self.learn(off, heading_std);
            return;
        }
        let mut usual = self.usual;
        let usual = &mut usual[..self.learned.min(USUAL)];
        let middle = upper_median(usual);
        usual
            .iter_mut()
            .for_each(|x| *x = wrap_pi(*x - middle).abs());
        let spread = (1.4826 * upper_median(usual)).max(LEAST_SPREAD);
        let shift = median(&self.recent.map(|x| wrap_pi(x - middle)));
        if shift.abs() < SPREADS * spread || shift.abs() < SIGMAS * heading_std {
            self.doubted &= shift.abs() > SPREADS * spread;
            if !self.doubted {
                self.learn(off, heading_std);
            }
            return;
        }
        let lacking = (shift * shift - heading_std * heading_std).sqrt();
        filter.inflate_heading(lacking, lacking / RECENT as f64);
        summary.heading_off(fix.time, shift, self.doubted);
        self.doubted = true;
    }

    /// Heading and body axes turned by so much \[rad\]: what is usual is so much less.
    pub(super) fn turn(&mut self, heading: f64) {
        for off in self.usual.iter_mut().chain(&mut self.recent) {
            *off = wrap_pi(*off - heading);
        }
    }

    /// Keeps how far the course was off a heading that is known well enough for that \[rad\].
    fn learn(&mut self, off: f64, heading_std: f64) {
        if heading_std < KNOWN {
            self.usual[self.learned % USUAL] = off;
            self.learned += 1;
        }
    }
}

#[cfg(test)]
mod tests;
