//! Constants that are estimated beside the sensors' errors: scale factors, misalignment of the
//! sensor axes, lever arm, time offset, mounting, and what further sensors need.
//!
//! Each kind is a block of states behind the shaping filters' states, in the order of [`Parameter`],
//! there only when it is asked for. A parameter is a random constant, or a random walk or a Gauss-Markov
//! process where its prior says so, and its state is the correction to the configured value, from zero; its error is
//! what the correction still misses, truth less estimate, like a sensor state's.
//!
//! Scale factors and axis misalignment act through the sensor error, `ε_i = … + s_i u_i + Σ m_ij u_j`
//! with u the angular rate or the specific force (Groves 2013, section 4.4.6); so does the delay of the accelerometers, by the
//! rate of change of the specific force, `ε_i = … − τ ḟ_i`. All others act through the measurements only.

use crate::{Vector3, sample::AXES};

/// Kinds of parameters, in the order of their states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Parameter {
    /// Scale factor errors of gyro x, y, z [–].
    GyroScale,
    /// Scale factor errors of accelerometer x, y, z [–].
    AccelScale,
    /// Misalignment of the gyro axes, m_xy, m_xz, m_yx, m_yz, m_zx, m_zy \[rad\].
    GyroMisalignment,
    /// Misalignment of the accelerometer axes, in the same order \[rad\].
    AccelMisalignment,
    /// Lever arm IMU → antenna, body axes \[m\].
    LeverArm,
    /// By how much a fix is later than its stamp says \[s\]; of its position alone where
    /// [`Parameter::VelocityTimeOffset`] is estimated, too.
    TimeOffset,
    /// Small turn of the vehicle's axes against the body axes, about pitch and yaw \[rad\].
    Mounting,
    /// Distance IMU → axle that does not steer along the body's forward axis, beyond the configured \[m\].
    Axle,
    /// Scale factor error of the odometer [–].
    OdometerScale,
    /// Error of the barometric height \[m\].
    BarometerBias,
    /// By how much the velocity of a fix is later than its stamp says \[s\]: receivers find it in another way
    /// than the position, and not always at the same instant.
    VelocityTimeOffset,
    /// By how much both time offsets grow, from the filter's start on [s/s]: the clock that stamps the samples is not
    /// that of the receiver.
    ClockRate,
    /// By how much the accelerometers are later than the gyros \[s\]: two chips, two topics, or a filter on one of them.
    AccelDelay,
    /// Time-correlated part of the position's error (multipath, atmosphere, the receiver's own filter), in the axes of
    /// the fix, in units of its standard deviation [–]: 1 is what the receiver states of that part.
    PositionError,
    /// The same of the velocity's error.
    VelocityError,
}

impl Parameter {
    /// All kinds in order.
    pub const ALL: [Self; 15] = [
        Self::GyroScale,
        Self::AccelScale,
        Self::GyroMisalignment,
        Self::AccelMisalignment,
        Self::LeverArm,
        Self::TimeOffset,
        Self::Mounting,
        Self::Axle,
        Self::OdometerScale,
        Self::BarometerBias,
        Self::VelocityTimeOffset,
        Self::ClockRate,
        Self::AccelDelay,
        Self::PositionError,
        Self::VelocityError,
    ];

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::GyroScale => "gyro_scale",
            Self::AccelScale => "accel_scale",
            Self::GyroMisalignment => "gyro_misalignment",
            Self::AccelMisalignment => "accel_misalignment",
            Self::LeverArm => "lever_arm",
            Self::TimeOffset => "time_offset",
            Self::Mounting => "mounting",
            Self::Axle => "axle",
            Self::OdometerScale => "odometer_scale",
            Self::BarometerBias => "barometer_bias",
            Self::VelocityTimeOffset => "velocity_time_offset",
            Self::ClockRate => "clock_rate",
            Self::AccelDelay => "accel_delay",
            Self::PositionError => "position_error",
            Self::VelocityError => "velocity_error",
        }
    }

    /// States of a block.
    pub const fn width(self) -> usize {
        match self {
            Self::GyroScale
            | Self::AccelScale
            | Self::LeverArm
            | Self::PositionError
            | Self::VelocityError => 3,
            Self::GyroMisalignment | Self::AccelMisalignment => 6,
            Self::Mounting => 2,
            Self::TimeOffset
            | Self::Axle
            | Self::OdometerScale
            | Self::BarometerBias
            | Self::VelocityTimeOffset
            | Self::ClockRate
            | Self::AccelDelay => 1,
        }
    }
}

/// What is known of a parameter before the log.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Prior {
    /// Standard deviation of each state about its configured value [the parameter's unit].
    pub std: f64,
    /// Random walk [unit/√s]; 0 for a constant.
    pub walk: f64,
    /// Correlation time of a Gauss-Markov process of that standard deviation \[s\], in place of the random
    /// walk; 0 for a random walk.
    pub time: f64,
}

impl Prior {
    /// A constant known to one standard deviation.
    pub const fn constant(std: f64) -> Self {
        Self {
            std,
            walk: 0.0,
            time: 0.0,
        }
    }

    /// Whether its state does not change by itself.
    pub(crate) fn is_constant(&self) -> bool {
        self.walk == 0.0 && self.time == 0.0
    }

    /// What of the state is left after `dt` \[s\], and the variance that comes in meanwhile.
    pub(crate) fn step(&self, dt: f64) -> (f64, f64) {
        if self.time > 0.0 {
            let left = libm::exp(-dt / self.time);
            (left, self.std * self.std * (1.0 - left * left))
        } else {
            (1.0, self.walk * self.walk * dt)
        }
    }
}

/// The parameters that are estimated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Parameters {
    priors: [Option<Prior>; Parameter::ALL.len()],
    /// States of the kinds before each, of those that are estimated, and of all.
    starts: [u8; Parameter::ALL.len()],
    states: u8,
}

impl Parameters {
    /// None.
    pub fn none() -> Self {
        Self::default()
    }

    /// These and one more.
    pub fn with(mut self, kind: Parameter, prior: Prior) -> Self {
        self.priors[kind as usize] = Some(prior);
        self.placed()
    }

    /// These but one.
    pub fn without(mut self, kind: Parameter) -> Self {
        self.priors[kind as usize] = None;
        self.placed()
    }

    /// With every kind at its place.
    fn placed(mut self) -> Self {
        self.states = 0;
        for kind in Parameter::ALL {
            self.starts[kind as usize] = self.states;
            if self.prior(kind).is_some() {
                self.states += kind.width() as u8;
            }
        }
        self
    }

    /// Prior of a kind, if it is estimated.
    #[inline]
    pub fn prior(&self, kind: Parameter) -> Option<Prior> {
        self.priors[kind as usize]
    }

    /// Number of their states.
    #[inline]
    pub fn states(&self) -> usize {
        usize::from(self.states)
    }

    /// Place of a kind's first state behind those of the sensors.
    #[inline]
    pub fn start(&self, kind: Parameter) -> Option<usize> {
        self.prior(kind)
            .map(|_| usize::from(self.starts[kind as usize]))
    }

    /// States and prior of every block, with so many states before the first.
    #[inline]
    pub(crate) fn ranges(
        &self,
        behind: usize,
    ) -> impl Iterator<Item = (core::ops::Range<usize>, Prior)> + '_ {
        self.blocks().map(move |(kind, at, prior)| {
            let start = behind + at;
            (start..start + kind.width(), prior)
        })
    }

    /// Kind, place of the first state and prior of every block.
    #[inline]
    pub fn blocks(&self) -> impl Iterator<Item = (Parameter, usize, Prior)> + '_ {
        let kinds = Parameter::ALL.into_iter();
        kinds.filter_map(move |kind| Some((kind, self.start(kind)?, self.prior(kind)?)))
    }
}

/// Time constant of [`jerk`]'s low-pass \[s\]: slower than vibration, quicker than what a vehicle does on purpose.
const SLOW: f64 = 0.1;

/// Rate of change of the specific force behind a low-pass \[m/s³\], of a sample with the mean `force` [m/s²] over `dt` \[s\].
/// `slow` is what the low-pass has kept of the samples before, and keeps this one.
#[inline]
pub fn jerk(slow: &mut Vector3, force: &Vector3, dt: f64) -> Vector3 {
    let jerk = (force - *slow) / (SLOW + dt);
    *slow += jerk * dt;
    jerk
}

/// The states that the six sensor errors of one sample depend on beside the shaping filters', with
/// their factors: `ε_axis = … + Σ factor x[index]`.
#[derive(Clone, Copy, Debug)]
pub struct Coupling {
    terms: [[(usize, f64); 4]; AXES],
    len: usize,
}

impl Coupling {
    /// No parameter acts on the sensors.
    pub const NONE: Self = Self {
        terms: [[(0, 0.0); 4]; AXES],
        len: 0,
    };

    /// Of a sample with mean angular rate `rate` [rad/s] and specific force `force` [m/s²], which changes by `jerk` [m/s³],
    /// body axes; `behind` is the place of the first parameter in the error state.
    #[inline]
    pub fn new(parameters: &Parameters, behind: usize, [rate, force, jerk]: [&Vector3; 3]) -> Self {
        let mut coupling = Self::NONE;
        coupling.follow(parameters, behind, [rate, force, jerk]);
        coupling
    }

    /// Becomes that of another sample, of the same parameters, in place.
    #[inline]
    pub(crate) fn follow(
        &mut self,
        parameters: &Parameters,
        behind: usize,
        [rate, force, jerk]: [&Vector3; 3],
    ) {
        use Parameter::{AccelDelay, AccelMisalignment, AccelScale, GyroMisalignment, GyroScale};
        let mut counts = [0; AXES];
        let mut add = |axis: usize, index: usize, factor: f64| {
            self.terms[axis][counts[axis]] = (behind + index, factor);
            counts[axis] += 1;
        };
        for (triad, u, scale, misalignment) in [
            (0, rate, GyroScale, GyroMisalignment),
            (3, force, AccelScale, AccelMisalignment),
        ] {
            if let Some(at) = parameters.start(scale) {
                for i in 0..3 {
                    add(triad + i, at + i, u[i]);
                }
            }
            if let Some(at) = parameters.start(misalignment) {
                for i in 0..3 {
                    let (j, k) = if i == 0 { (1, 2) } else { (0, 3 - i) };
                    add(triad + i, at + 2 * i, u[j]);
                    add(triad + i, at + 2 * i + 1, u[k]);
                }
            }
        }
        if let Some(at) = parameters.start(AccelDelay) {
            for i in 0..3 {
                add(3 + i, at, -jerk[i]);
            }
        }
        self.len = counts.into_iter().max().unwrap_or(0);
    }

    /// Whether no parameter acts on the sensors.
    pub(crate) fn is_none(&self) -> bool {
        self.len == 0
    }

    /// Calls `each` with every factor.
    pub(crate) fn factors(&mut self, each: &mut dyn FnMut(&mut f64)) {
        let terms = self.terms.iter_mut().flat_map(|axis| &mut axis[..self.len]);
        terms.for_each(|(_, factor)| each(factor));
    }

    /// States and factors of an axis; a factor may be zero.
    #[inline]
    pub fn axis(&self, axis: usize) -> &[(usize, f64)] {
        &self.terms[axis][..self.len]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_lie_one_behind_the_other() {
        let prior = Prior {
            std: 1.0,
            ..Prior::default()
        };
        let some = Parameters::none()
            .with(Parameter::TimeOffset, prior)
            .with(Parameter::GyroMisalignment, prior)
            .with(Parameter::AccelScale, prior);
        assert_eq!(some.states(), 10);
        assert_eq!(some.start(Parameter::AccelScale), Some(0));
        assert_eq!(some.start(Parameter::GyroMisalignment), Some(3));
        assert_eq!(some.start(Parameter::TimeOffset), Some(9));
        assert_eq!(some.start(Parameter::LeverArm), None);
    }

    #[test]
    fn every_axis_sees_the_two_others() {
        let prior = Prior::default();
        let all = Parameters::none()
            .with(Parameter::GyroScale, prior)
            .with(Parameter::GyroMisalignment, prior);
        let c = Coupling::new(
            &all,
            20,
            [
                &Vector3::new(1.0, 2.0, 3.0),
                &Vector3::zeros(),
                &Vector3::zeros(),
            ],
        );
        assert_eq!(c.axis(0), [(20, 1.0), (23, 2.0), (24, 3.0)]);
        assert_eq!(c.axis(1), [(21, 2.0), (25, 1.0), (26, 3.0)]);
        assert_eq!(c.axis(2), [(22, 3.0), (27, 1.0), (28, 2.0)]);
        assert_eq!(c.axis(3)[0].1, 0.0);
    }
}
