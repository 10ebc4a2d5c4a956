//! Clock of a solution's times, and what its standard deviations contain of the doubt about it.

use crate::estimator::ReceiverClock;
use undrift_nav::{Vector3, covariance::NAV, mechanisation::NavState};

/// Time over which the acceleration is averaged \[s\].
const AVERAGED: f64 = 0.1;

/// Clock of a solution's times (docs/conventions.md, Whose times).
///
/// ```
/// # use undrift_drive as undrift;
/// use undrift::navigate::Clock;
/// assert_eq!("gnss".parse::<Clock>().ok(), Some(Clock::Gnss));
/// assert!("utc".parse::<Clock>().is_err());
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Clock {
    /// The samples', as stamped. Where they turn out to be late, the standard deviations contain what is moved meanwhile: nothing
    /// says which of the two clocks is right.
    #[default]
    Unstated,
    /// The samples', stated to be right.
    Imu,
    /// The fixes': the samples' less the time offset that is estimated.
    Gnss,
}

impl Clock {
    /// Its name in arguments and results.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Unstated => "unstated",
            Self::Imu => "imu",
            Self::Gnss => "gnss",
        }
    }
}

/// A name that is not that of a clock.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("\"{0}\" is no clock: imu or gnss")]
pub struct UnknownClock(String);

impl std::str::FromStr for Clock {
    type Err = UnknownClock;

    fn from_str(name: &str) -> Result<Self, UnknownClock> {
        [Self::Imu, Self::Gnss]
            .into_iter()
            .find(|clock| clock.name() == name)
            .ok_or_else(|| UnknownClock(name.into()))
    }
}

/// Puts a solution on a clock, instant by instant.
pub(super) struct Timing {
    pub(super) clock: Clock,
    /// Time of the last row, on its clock \[s\].
    last: f64,
    /// Time and velocity of the last instant, and the acceleration [s, m/s, m/s²].
    before: Option<(f64, Vector3)>,
    acceleration: Vector3,
}

impl Timing {
    pub(super) fn new(clock: Clock) -> Self {
        Self {
            clock,
            last: f64::NEG_INFINITY,
            before: None,
            acceleration: Vector3::zeros(),
        }
    }

    /// The state and its standard deviations with the time of the clock; `omega_n` gives the angular rate, north, east, down [rad/s].
    /// `None` where the clock's time does not go on: an offset that is estimated changes.
    pub(super) fn put(
        &mut self,
        (mut nav, mut std): (NavState, [f64; NAV]),
        receiver: Option<&ReceiverClock>,
        omega_n: impl FnOnce() -> Vector3,
    ) -> Option<(NavState, [f64; NAV])> {
        if receiver.is_some()
            && let Some((time, v_n)) = self.before.replace((nav.time, nav.v_n))
            && nav.time > time
        {
            let span = nav.time - time;
            let new = (span / AVERAGED).min(1.0);
            self.acceleration += ((nav.v_n - v_n) / span - self.acceleration) * new;
        }
        match (self.clock, receiver) {
            (Clock::Gnss, Some(receiver)) => {
                nav.time -= receiver.offset;
                std[..3].copy_from_slice(&receiver.position_std);
            }
            (Clock::Unstated, Some(receiver)) => {
                let late = receiver.lateness();
                // Mostly they are not late beyond chance.
                if late != 0.0 {
                    let moved = [nav.v_n, self.acceleration, omega_n()].map(|rate| rate * late);
                    for (std, moved) in std.iter_mut().zip(moved.iter().flatten()) {
                        *std = std.hypot(*moved);
                    }
                }
            }
            (Clock::Imu, _) | (_, None) => {}
        }
        let goes_on = nav.time > self.last;
        self.last = self.last.max(nav.time);
        goes_on.then_some((nav, std))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_nav::{Quaternion, earth::Geodetic};

    /// At 10 m/s north, braking by 2 m/s² and turning by 0.3 rad/s, with samples that are 100 ms late beyond chance.
    fn put(clock: Clock) -> (f64, [f64; NAV]) {
        let receiver = ReceiverClock {
            offset: 0.11,
            offset_std: 0.01,
            position_std: [0.01, 0.02, 0.03],
            interval: 0.01,
        };
        let mut timing = Timing::new(clock);
        let mut last = None;
        for k in 0..200 {
            let time = 0.01 * f64::from(k);
            let nav = NavState {
                time,
                position: Geodetic::from_degrees(45.0, 7.0, 300.0),
                v_n: Vector3::new(10.0 - 2.0 * (time - 1.99), 0.0, 0.0),
                q_nb: Quaternion::identity(),
            };
            let turn = Vector3::new(0.0, 0.0, 0.3);
            last = timing.put((nav, [0.6; NAV]), Some(&receiver), || turn);
        }
        let (nav, std) = last.unwrap();
        (nav.time, std)
    }

    #[test]
    fn what_is_moved_while_the_samples_are_late_is_in_the_standard_deviations() {
        let (time, std) = put(Clock::Unstated);
        assert_eq!(time, 1.99);
        let hypot = |moved: f64| (0.36 + moved * moved).sqrt();
        let expected = [
            hypot(1.0),
            0.6,
            0.6,
            hypot(0.2),
            0.6,
            0.6,
            0.6,
            0.6,
            hypot(0.03),
        ];
        for (std, expected) in std.iter().zip(expected) {
            assert!((std - expected).abs() < 1e-6, "{std} {expected}");
        }
    }

    #[test]
    fn a_clock_that_is_stated_is_right() {
        assert_eq!(put(Clock::Imu), (1.99, [0.6; NAV]));
        let (time, std) = put(Clock::Gnss);
        assert!((time - 1.88).abs() < 1e-12);
        assert_eq!(std, [0.01, 0.02, 0.03, 0.6, 0.6, 0.6, 0.6, 0.6, 0.6]);
    }

    #[test]
    fn times_go_on() {
        let mut timing = Timing::new(Clock::Gnss);
        let mut at = |time: f64, offset: f64| {
            let nav = NavState {
                time,
                position: Geodetic::from_degrees(45.0, 7.0, 300.0),
                v_n: Vector3::zeros(),
                q_nb: Quaternion::identity(),
            };
            let receiver = ReceiverClock {
                offset,
                ..ReceiverClock::default()
            };
            let put = timing.put((nav, [1.0; NAV]), Some(&receiver), Vector3::zeros);
            put.is_some()
        };
        assert!(at(10.0, 0.0) && !at(10.01, 0.02) && at(10.03, 0.02));
        assert!(!at(10.03, 0.02));
        assert_eq!("gnss".parse(), Ok(Clock::Gnss));
        assert!("unstated".parse::<Clock>().is_err());
    }
}
