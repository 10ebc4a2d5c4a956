//! Rest, detected by block means that agree, and the level and gyro bias that it gives.
//!
//! A span is at rest where the means of successive half seconds agree: of the rate to 0.003 rad/s, of the
//! specific force to 0.05 m/s², and five standard deviations of their white noise more. A steady turn and a
//! steady acceleration do that too. So GNSS has to agree, or, where it says nothing, the span has to last
//! longer and read as the rest before it did.
//!
//! | GNSS says | as the rest before | blocks needed |
//! |---|---|---|
//! | at rest | yes, or no rest before | 2 to 20, until the noise of the means is small |
//! | nothing | yes, or no rest before | at least 6 |
//! | at rest | no: another bias or slope | at least 10 |
//! | nothing | no | never |
//! | moving | – | never |

use super::basis::{bias_variances, noise_of_mean};
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_nav::{Vector3, shaping::ShapingFilter};

/// Length of the blocks that are compared \[s\].
pub(super) const BLOCK: f64 = 0.5;
/// Consecutive blocks that agree before they count as rest, or more where the noise asks for more.
const FEWEST_BLOCKS: u32 = 2;
/// Blocks that it takes while GNSS does not show that the vehicle is at rest: a steady turn has steady readings too.
const BLOCKS_UNSEEN: u32 = 6;
/// Blocks that a rest with another gyro bias than before takes, GNSS at rest.
const NEW_BIAS_BLOCKS: u32 = 10;
/// Blocks that noisy sensors need, at most.
const MOST_BLOCKS: u32 = 20;
/// White noise of the mean specific force that is small enough \[m/s²\]: 0.3 deg of level.
const FORCE_NOISE: f64 = 0.05;
/// White noise of the mean rate that is small enough \[rad/s\]: 0.05 deg/s.
const RATE_NOISE: f64 = 1e-3;
/// A block belongs to the rest while its means differ from the rest's by less than this many standard deviations of
/// their white noise and [`RATE`] or [`FORCE`].
const SIGMAS: f64 = 5.0;
/// What the mean rate of a rest wanders by beyond its white noise \[rad/s\].
const RATE: f64 = 0.003;
/// What the mean specific force of a rest wanders by beyond its white noise \[m/s²\].
const FORCE: f64 = 0.05;
/// What reads more than [`SIGMAS`] times the bias of a gyro switched on, at least this one \[rad/s\], turns on the spot.
const BIAS_FLOOR: f64 = 0.06;

/// Detects rest by comparing block means, and keeps its means.
#[derive(Clone, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Rest {
    /// Tolerances of a block's means [rad/s, m/s²].
    rate_tolerance: f64,
    force_tolerance: f64,
    /// Largest mean rates of a rest \[rad/s\].
    most_rate: Vector3,
    /// Blocks needed for the noise of the means to be small.
    needed: u32,
    /// Sums of the present block.
    duration: f64,
    dtheta: Vector3,
    dvel: Vector3,
    /// Blocks of the present span and their means.
    blocks: u32,
    mean_rate: Vector3,
    pub(super) mean_force: Vector3,
    /// Mean rate over all rest, what is called the gyro bias, and its blocks.
    pub(super) bias: Vector3,
    bias_blocks: u32,
    /// Mean specific force of the last rest [m/s²].
    rested_force: Option<Vector3>,
}

impl Rest {
    /// A detector for gyros and accelerometers of the given noise.
    pub(super) fn new(gyro: &[ShapingFilter], accel: &[ShapingFilter]) -> Self {
        let blocks = |axes, wanted: f64| noise_of_mean(axes, BLOCK) / (wanted * wanted);
        let needed = blocks(gyro, RATE_NOISE)
            .max(blocks(accel, FORCE_NOISE))
            .ceil();
        Self {
            rate_tolerance: RATE + SIGMAS * noise_of_mean(gyro, BLOCK).sqrt(),
            force_tolerance: FORCE + SIGMAS * noise_of_mean(accel, BLOCK).sqrt(),
            most_rate: bias_variances(gyro, BIAS_FLOOR).map(f64::sqrt) * SIGMAS,
            needed: (needed as u32).clamp(FEWEST_BLOCKS, MOST_BLOCKS),
            ..Self::default()
        }
    }

    /// Adds to the present block; true when it is complete and was compared.
    pub(super) fn add(&mut self, span: f64, dtheta: &Vector3, dvel: &Vector3) -> bool {
        self.duration += span;
        self.dtheta += dtheta;
        self.dvel += dvel;
        if self.duration < BLOCK - 1e-9 {
            return false;
        }
        let (rate, force) = (self.dtheta / self.duration, self.dvel / self.duration);
        let agrees = (rate - self.mean_rate).norm() < self.rate_tolerance
            && (force - self.mean_force).norm() < self.force_tolerance;
        if !agrees {
            self.blocks = 0;
        }
        self.blocks += 1;
        let weight = 1.0 / f64::from(self.blocks);
        self.mean_rate += (rate - self.mean_rate) * weight;
        self.mean_force += (force - self.mean_force) * weight;
        self.duration = 0.0;
        self.dtheta = Vector3::zeros();
        self.dvel = Vector3::zeros();
        true
    }

    /// Whether the present span is rest; `at_rest_by_gnss` is what GNSS says, if it says something. A steady
    /// turn has steady readings too, and so has a vehicle that pulls away steadily, and a fix may be old:
    /// so rate and force must be those of the rest before, unless GNSS has said for a while that the
    /// vehicle is at rest.
    pub(super) fn holds(&self, at_rest_by_gnss: Option<bool>) -> bool {
        if (self.mean_rate.abs() - self.most_rate).max() > 0.0 {
            return false;
        }
        let steady = self.bias_blocks == 0 || (self.is_steady() && self.force_is_as_before());
        let needed = match (at_rest_by_gnss, steady) {
            (Some(false), _) | (None, false) => return false,
            (Some(true), true) => self.needed,
            (None, true) => self.needed.max(BLOCKS_UNSEEN),
            (Some(true), false) => self.needed.max(NEW_BIAS_BLOCKS),
        };
        self.blocks >= needed
    }

    /// Whether the present span turns no faster than the rest before it did.
    fn is_steady(&self) -> bool {
        (self.mean_rate - self.bias).norm() < self.rate_tolerance
    }

    /// Whether the present span is on the slope of the rest before.
    fn force_is_as_before(&self) -> bool {
        self.rested_force
            .is_none_or(|force| (self.mean_force - force).norm() < self.force_tolerance)
    }

    /// Takes the latest blocks of the present span into the bias; where they say another one (a
    /// sensor warming up, or calibrating itself), only the present span counts.
    pub(super) fn take_bias(&mut self) {
        if !self.is_steady() {
            self.bias_blocks = 0;
        }
        self.rested_force = Some(self.mean_force);
        // The whole span when it has just become rest, later the newest block.
        let fresh = if self.bias_blocks == 0 || self.fresh_span() {
            self.blocks
        } else {
            1
        };
        self.bias_blocks += fresh;
        self.bias +=
            (self.mean_rate - self.bias) * (f64::from(fresh) / f64::from(self.bias_blocks));
    }

    /// Ends the present span.
    pub(super) fn interrupt(&mut self) {
        self.blocks = 0;
        self.duration = 0.0;
        self.dtheta = Vector3::zeros();
        self.dvel = Vector3::zeros();
    }

    /// Forgets all rest: it turned out to be motion.
    pub(super) fn forget(&mut self) {
        self.interrupt();
        self.bias_blocks = 0;
        self.bias = Vector3::zeros();
        self.rested_force = None;
    }

    /// Whether the present span is no longer than what makes a rest.
    fn fresh_span(&self) -> bool {
        self.blocks <= self.needed
    }

    /// Length of the present span \[s\].
    pub(super) fn span(&self) -> f64 {
        f64::from(self.blocks) * BLOCK
    }

    /// Length of all rest \[s\].
    pub(super) fn bias_span(&self) -> f64 {
        f64::from(self.bias_blocks.max(1)) * BLOCK
    }
}
