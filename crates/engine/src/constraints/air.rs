//! What the air does to a craft in flight: rotors are dragged by it, wings keep a velocity through it.
//!
//! | craft | measurement | in flight while |
//! |---|---|---|
//! | [`Air::Rotors`] | mean specific force across the thrust over [`Air::INTERVAL`] | since it was surely faster than [`TAKES_OFF`] |
//! | [`Air::Wings`] | no velocity through the air beside that of trim | it is faster than [`FLIES`] through the air |
//!
//! The covariance is that of white noise with the power of what lasts for [`Air::LASTS`], times what fixes show of it ([`Slip`]). The
//! accelerations are those of the mechanisation, too; their white noise is less than a tenth of this.

use super::{constrain, non_holonomic::Slip};
use crate::{aid::Aiding, estimator::Estimator, summary::Summary, vehicle::Air};
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_events::Aid;
use undrift_nav::{Matrix3, Vector3, parameters::Parameter, sample::ImuSample};

/// Speed over ground, beyond three of its standard deviations, at which a copter flies [m/s].
const TAKES_OFF: f64 = 2.0;
/// Speed through the air at which an aircraft flies [m/s].
const FLIES: f64 = 8.0;

/// The motion through the air since the last update.
#[derive(Clone, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Flight {
    /// Whether it has taken off.
    flies: bool,
    /// Change of velocity by the specific force since the last update [m/s], body axes, and time since then \[s\].
    sum: Vector3,
    duration: f64,
    /// How much more there is of gusts and manoeuvres than is assumed.
    gusts: Slip,
}

impl Flight {
    /// Body axes turn by `c`.
    pub(super) fn turn(&mut self, c: &Matrix3) {
        self.sum = c * self.sum;
    }

    /// A sample that was processed; `aided` is whether fixes show the velocity.
    pub(super) fn sample(
        &mut self,
        filter: &mut dyn Estimator,
        (air, sample): (&Air, &ImuSample),
        aided: bool,
        summary: &mut Summary,
    ) {
        self.sum += sample.dvel;
        self.duration += sample.dt;
        if self.duration < Air::INTERVAL - 0.5 * sample.dt {
            return;
        }
        let force = self.sum / self.duration;
        (self.sum, self.duration) = (Vector3::zeros(), 0.0);
        let (aiding, std) = match *air {
            Air::Wings(std) => {
                self.flies = through_air(filter) > FLIES;
                (Aiding::AirVelocity, std)
            }
            Air::Rotors { std, drag } => {
                let [.., north, east, down, _, _, _] = filter.nav_std();
                let unsure = 3.0 * (north * north + east * east + down * down).sqrt();
                self.flies |= aided && filter.nav().v_n.norm() > TAKES_OFF + unsure;
                (Aiding::RotorDrag { force, drag }, std)
            }
        };
        let known = filter.parameters().prior(Parameter::TrimVelocity).is_some();
        if !(self.flies && known) {
            return;
        }
        let factor = self.gusts.factor();
        let noise = Matrix3::identity() * (std * std * factor * 2.0 * Air::LASTS / Air::INTERVAL);
        if let Some(update) = constrain(filter, &aiding, &noise) {
            summary.innovations[Aid::Air].add(update);
            if aided {
                self.gusts.learn(factor, &update);
            }
        }
    }
}

/// Speed through the air [m/s], in the wind as estimated.
fn through_air(filter: &dyn Estimator) -> f64 {
    let wind = filter.parameter(Parameter::Wind);
    let wind = wind.map_or(Vector3::zeros(), |(wind, _)| {
        Vector3::new(wind[0], wind[1], 0.0)
    });
    (filter.nav().v_n - wind).norm()
}
