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
    /// Scale factor errors of gyro x, y, z [–]: a gyro reads `(1 + s)` times the rate.
    GyroScale,
    /// Scale factor errors of accelerometer x, y, z [–]: an accelerometer reads `(1 + s)` times the specific force.
    AccelScale,
    /// Misalignment of the gyro axes, m_xy, m_xz, m_yx, m_yz, m_zx, m_zy \[rad\]: m_xy is what axis x reads of the rate about y.
    GyroMisalignment,
    /// Misalignment of the accelerometer axes, in the same order \[rad\].
    AccelMisalignment,
    /// Correction of the lever arm IMU → antenna, body axes \[m\]: true less configured.
    LeverArm,
    /// Time by which a fix is later than its stamp says \[s\]: one stamped `t` holds at `t` + offset. Of its position alone where
    /// [`Parameter::VelocityTimeOffset`] is estimated, too.
    TimeOffset,
    /// Small turn of the vehicle's axes against the body axes, about pitch and yaw \[rad\]: the vehicle's axes are the body's turned by it.
    Mounting,
    /// Distance IMU → axle that does not steer along the body's forward axis, beyond the configured \[m\].
    Axle,
    /// Scale factor error of the odometer [–]: it reads `(1 + s)` times the speed.
    OdometerScale,
    /// Error of the barometric height \[m\]: it reads height + bias.
    BarometerBias,
    /// Time by which the velocity of a fix is later than its stamp says \[s\]: receivers find it in another way
    /// than the position, and not always at the same instant.
    VelocityTimeOffset,
    /// Rate at which both time offsets grow, from the filter's start on [s/s]: the clock that stamps the samples is not
    /// that of the receiver. Quartz clocks differ by some 10⁻⁵.
    ClockRate,
    /// Time by which the accelerometers are later than the gyros \[s\]: two chips, two topics, or a filter on one of them.
    AccelDelay,
    /// Direction of the second of two antennas in the body, from forward to right \[rad\], beyond the configured.
    HeadingOffset,
    /// Hard iron of a magnetometer, body axes \[T\]: it reads field + this. Iron and currents that move with the vehicle.
    HardIron,
    /// Turn of a marker's axes against the configured ones, about the marker's axes \[rad\]: true less configured.
    MarkerRotation,
    /// Tilt of the frame of poses against the horizon, about north and east \[rad\]: the rotation that takes north, east, down to its axes.
    FrameTilt,
    /// Wind, the velocity of the air over ground, north and east [m/s]; vertical wind is taken as zero.
    Wind,
    /// Velocity through the air in body axes in which a craft is in trim [m/s]: the one an aircraft keeps, and the one in which a copter
    /// feels no drag across its thrust.
    TrimVelocity,
    /// Drag of rotors over mass [1/s], beyond the configured: deceleration across the thrust for each m/s through the air.
    RotorDrag,
    /// Half the variance of the times that a receiver's own filter takes the mean over, for positions and for velocities \[s²\]: both are late
    /// by the mean of those times ([`Parameter::TimeOffset`]), positions are off by this times the acceleration, velocities by this times
    /// its rate of change. A vehicle that leans outward in turns moves its antenna in the same way.
    Smoothing,
    /// Time-correlated part of the position's error (multipath, atmosphere, the receiver's own filter), in the axes of
    /// the fix, in units of its standard deviation [–]: 1 is what the receiver states of that part.
    PositionError,
    /// Time-correlated part of the velocity's error (the receiver's tracking loops), in the axes of the fix, in units of its standard
    /// deviation [–]: 1 is what the receiver states of that part.
    VelocityError,
}

impl Parameter {
    /// Every kind, in the order of their states in the filter.
    pub const ALL: [Self; 23] = [
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
        Self::HeadingOffset,
        Self::HardIron,
        Self::MarkerRotation,
        Self::FrameTilt,
        Self::Wind,
        Self::TrimVelocity,
        Self::RotorDrag,
        Self::Smoothing,
        Self::PositionError,
        Self::VelocityError,
    ];

    /// Its name in snake case, as in models and events: `gyro_scale`. In results its key is the variant's name, `GyroScale`.
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
            Self::HeadingOffset => "heading_offset",
            Self::HardIron => "hard_iron",
            Self::PositionError => "position_error",
            Self::VelocityError => "velocity_error",
            Self::MarkerRotation => "marker_rotation",
            Self::FrameTilt => "frame_tilt",
            Self::Wind => "wind",
            Self::TrimVelocity => "trim_velocity",
            Self::RotorDrag => "rotor_drag",
            Self::Smoothing => "smoothing",
        }
    }

    /// Number of states of the kind's block, 1 to 6.
    pub const fn width(self) -> usize {
        match self {
            Self::GyroScale
            | Self::AccelScale
            | Self::LeverArm
            | Self::PositionError
            | Self::VelocityError
            | Self::HardIron
            | Self::MarkerRotation
            | Self::TrimVelocity => 3,
            Self::GyroMisalignment | Self::AccelMisalignment => 6,
            Self::Mounting | Self::FrameTilt | Self::Wind | Self::Smoothing => 2,
            Self::TimeOffset
            | Self::Axle
            | Self::OdometerScale
            | Self::BarometerBias
            | Self::VelocityTimeOffset
            | Self::ClockRate
            | Self::AccelDelay
            | Self::HeadingOffset
            | Self::RotorDrag => 1,
        }
    }
}

/// What is known of a parameter before the log, and how it changes: a constant, a random walk, or a Gauss-Markov process.
///
/// ```
/// use undrift_nav::parameters::Prior;
/// let scale = Prior::constant(0.01); // 1 %, from the data sheet.
/// // A barometer within 10 m, whose reference moves with the weather over half a day.
/// let barometer = Prior { std: 10.0, time: 12.0 * 3600.0, ..Prior::default() };
/// assert!(scale.walk == 0.0 && barometer.time > 0.0);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Prior {
    /// Standard deviation of each state about zero, that is of the parameter about its configured value [the parameter's unit].
    pub std: f64,
    /// Random walk of each state [the parameter's unit/√s]; 0 for a constant.
    pub walk: f64,
    /// Correlation time of a Gauss-Markov process with the standard deviation `std` \[s\], in place of the random
    /// walk; 0 for a random walk or a constant.
    pub time: f64,
}

impl Prior {
    /// A constant whose correction has the standard deviation `std` [the parameter's unit].
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

    /// Factor on the state over `dt` \[s\], and the variance of the noise that enters meanwhile.
    pub(crate) fn step(&self, dt: f64) -> (f64, f64) {
        if self.time > 0.0 {
            let left = libm::exp(-dt / self.time);
            (left, self.std * self.std * (1.0 - left * left))
        } else {
            (1.0, self.walk * self.walk * dt)
        }
    }
}

/// The parameters that are estimated, each with its prior: which states the filter has behind those of its sensors.
///
/// ```
/// use undrift_nav::parameters::{Parameter, Parameters, Prior};
/// let estimated = Parameters::none()
///     .with(Parameter::GyroScale, Prior::constant(0.01)) // 1 % each axis.
///     .with(Parameter::TimeOffset, Prior::constant(0.2)); // [s]
/// assert_eq!(estimated.states(), 4); // Three scale factors and an offset.
/// assert_eq!(estimated.start(Parameter::TimeOffset), Some(3));
/// assert_eq!(estimated.without(Parameter::GyroScale).states(), 1);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Parameters {
    priors: [Option<Prior>; Parameter::ALL.len()],
    /// States of the kinds before each, of those that are estimated, and of all.
    starts: [u8; Parameter::ALL.len()],
    states: u8,
}

impl Parameters {
    /// No parameter is estimated.
    pub fn none() -> Self {
        Self::default()
    }

    /// These parameters and `kind` with its `prior`; a prior it had is replaced. The order of calls does not matter.
    pub fn with(mut self, kind: Parameter, prior: Prior) -> Self {
        self.priors[kind as usize] = Some(prior);
        self.placed()
    }

    /// These parameters without `kind`.
    pub fn without(mut self, kind: Parameter) -> Self {
        self.priors[kind as usize] = None;
        self.placed()
    }

    /// Counts each kind's place again, after one came or went.
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

    /// Number of states of all that are estimated.
    #[inline]
    pub fn states(&self) -> usize {
        usize::from(self.states)
    }

    /// Place of the first state of `kind` among the parameters' states, if it is estimated; in the error state it is that far behind
    /// [`Sensors::states`](crate::covariance::Sensors::states).
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

    /// Kind, place of the first state among the parameters' states, and prior of each that is estimated, in order.
    #[inline]
    pub fn blocks(&self) -> impl Iterator<Item = (Parameter, usize, Prior)> + '_ {
        let kinds = Parameter::ALL.into_iter();
        kinds.filter_map(move |kind| Some((kind, self.start(kind)?, self.prior(kind)?)))
    }
}

/// Time constant of [`jerk`]'s low-pass \[s\]: slower than vibration, quicker than what a vehicle does on purpose.
const SLOW: f64 = 0.1;

/// Rate of change of the specific force behind a low-pass of 0.1 s [m/s³, body axes], at a sample with the mean `force` [m/s²] over
/// `dt` \[s\]. `slow` is the state of the low-pass [m/s²]: the first force to begin with; it is updated.
///
/// ```
/// use undrift_nav::{Vector3, parameters::jerk};
/// // A force that grows by 2 m/s² a second, at 100 Hz: once the low-pass has followed, its rate of change.
/// let mut slow = Vector3::zeros();
/// let found = (1..=200).fold(Vector3::zeros(), |_, k| jerk(&mut slow, &Vector3::new(0.02 * f64::from(k), 0.0, 0.0), 0.01));
/// assert!((found.x - 2.0).abs() < 1e-6);
/// ```
#[inline]
pub fn jerk(slow: &mut Vector3, force: &Vector3, dt: f64) -> Vector3 {
    let jerk = (force - *slow) / (SLOW + dt);
    *slow += jerk * dt;
    jerk
}

/// Two low-passes of [`jerk`], one behind the other, step on at an acceleration over ground [m/s²]: what a vehicle does on purpose, and by
/// their difference how that changes.
#[inline]
pub(crate) fn smooth(slow: &mut [Vector3; 2], acceleration: &Vector3, dt: f64) {
    let [first, second] = slow;
    jerk(first, acceleration, dt);
    jerk(second, first, dt);
}

/// Acceleration [m/s²] and its rate of change [m/s³] by [`smooth`].
pub(crate) fn slow_motion([first, second]: &[Vector3; 2]) -> [Vector3; 2] {
    [*first, (first - second) / SLOW]
}

/// The parameters that the six sensor errors of one sample depend on beside the shaping filters' states, with their factors: the rows
/// of U in `ε = H x + U p + D w`, `ε_axis = … + Σ factor x[index]`. Groves section 4.4.6.
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

    /// Coupling at a sample with mean angular rate `rate` [rad/s] and specific force `force` [m/s²], which changes by `jerk` [m/s³], all in
    /// body axes; `behind` is the place of the first parameter in the error state.
    ///
    /// ```
    /// use undrift_nav::{Vector3, parameters::{Coupling, Parameter, Parameters, Prior}};
    /// let estimated = Parameters::none().with(Parameter::GyroScale, Prior::constant(0.01));
    /// let (rate, none) = (Vector3::new(0.1, 0.2, 0.3), Vector3::zeros());
    /// let coupling = Coupling::new(&estimated, 15, [&rate, &none, &none]);
    /// // An error s of gyro z's scale factor makes it read s · 0.3 rad/s too much: its state is the 18th.
    /// assert_eq!(coupling.axis(2), [(17, 0.3)]);
    /// ```
    #[inline]
    pub fn new(parameters: &Parameters, behind: usize, [rate, force, jerk]: [&Vector3; 3]) -> Self {
        let mut coupling = Self::NONE;
        coupling.follow(parameters, behind, [rate, force, jerk]);
        coupling
    }

    /// Becomes the coupling at another sample, for the same parameters, in place.
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

    /// States, by their index in the error state, and factors of sensor axis `axis`, 0 to 5; a factor may be zero.
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
