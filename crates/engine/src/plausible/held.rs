//! Whether a receiver holds its position while it moves slowly: then the first position that moves again is further away than its velocity
//! says.

use super::APART;
use crate::derived::antenna;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_events::Mismatch;
use undrift_nav::{Vector3, earth::Geodetic, sample::GnssFix};

/// Times that it takes to be a habit.
const LEAST: u32 = 2;
/// Standard deviations of a position, and of the way by its velocity, beyond which a step is neither.
const SIGMAS: f64 = 5.0;
const FASTER: f64 = 1.5;

/// What is known so far.
#[derive(Clone, Copy, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Held {
    last: Option<(f64, Geodetic)>,
    /// Whether the last position was the one before, with a velocity of zero.
    stands: bool,
    steps: u32,
    /// The largest step \[m\].
    largest: f64,
}

impl Held {
    /// Takes in a fix; one without position and velocity is passed over.
    pub(super) fn fix(&mut self, fix: &GnssFix) {
        let (Some(place), Some((_, r)), Some((v_n, _))) =
            (antenna(fix), &fix.position, &fix.velocity)
        else {
            return;
        };
        let Some((time, last)) = self.last.replace((fix.time, place)) else {
            return;
        };
        if last == place {
            self.stands = *v_n == Vector3::zeros();
            return;
        }
        let dt = fix.time - time;
        let step = last.offset_to(&place).xy().norm();
        let std = r.fixed_view::<2, 2>(0, 0).trace().sqrt();
        let explained = FASTER * v_n.xy().norm() * dt + SIGMAS * std;
        if self.stands && dt < APART && step > explained {
            self.steps += 1;
            self.largest = self.largest.max(step);
        }
        self.stands = false;
    }

    pub(super) fn finding(&self) -> Option<Mismatch> {
        (self.steps >= LEAST).then_some(Mismatch::HeldPositions(self.largest))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_nav::Matrix3;

    /// What is found of a car that brakes and starts twice with 1 m/s², at 5 Hz, and whose receiver holds below this speed [m/s].
    fn found(holds: f64, std: f64) -> Option<Mismatch> {
        let start = Geodetic::from_degrees(47.0, 8.0, 400.0);
        let (mut held, mut at) = (Held::default(), 0.0);
        let mut last = start;
        for k in 0..300 {
            let phase = 0.2 * f64::from(k % 150);
            let speed = (phase - 15.0).abs() - 3.0;
            let speed = speed.clamp(0.0, 10.0);
            at += 0.2 * speed;
            let is_held = speed < holds;
            if !is_held {
                last = start.displaced(&Vector3::new(at, 0.0, 0.0));
            }
            let mut fix = GnssFix::at(0.2 * f64::from(k), last, [std; 3]);
            let v_n = Vector3::x() * if is_held { 0.0 } else { speed };
            fix.velocity = Some((v_n, Matrix3::identity() * 1e-4));
            held.fix(&fix);
        }
        held.finding()
    }

    #[test]
    fn a_position_that_is_held_steps_from_there() {
        // From 2 m/s to rest and back, 2 m each.
        let Some(Mismatch::HeldPositions(step)) = found(2.0, 0.02) else {
            panic!("not found");
        };
        assert!((step - 4.0).abs() < 0.5, "{step}");
        // A receiver that stands while the car stands, and one that states as much.
        assert_eq!(found(0.1, 0.02), None);
        assert_eq!(found(2.0, 1.0), None);
    }
}
