//! What is known of the vehicle: which constraints hold and how firmly.
//!
//! They are pseudo-measurements of the filter: no velocity along the vehicle's right and down axes while it drives, no velocity and
//! no angular rate but the Earth's at rest, the heading along the course over ground (Groves 2013, section 15.4.1 for land vehicles). The standard deviations are larger than the
//! scatter of the motion itself, since its errors are correlated in time and the filter takes them for white
//! ([`NonHolonomic::CAR`]).

use undrift_events::Aid;
use undrift_nav::{
    Vector3,
    parameters::{Parameter, Parameters, Prior},
};

/// What the vehicle is, as a set of defaults.
///
/// ```
/// use undrift_engine::vehicle::Profile;
/// let car = Profile::Car.constraints();
/// assert!(car.non_holonomic.is_some() && car.zero_velocity == Some(0.02)); // [m/s]
/// assert!(Profile::Aircraft.constraints().non_holonomic.is_none());
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub enum Profile {
    /// Nothing is known of it: no constraint.
    #[default]
    None,
    /// A wheeled vehicle on a road: no side slip, no hopping, at rest at times.
    Car,
    /// An aircraft: it keeps its velocity through the air, and may be at rest on the ground.
    Aircraft,
    /// A person on foot carrying the sensor: at rest at times.
    Pedestrian,
    /// A copter: the drag of its rotors shows its velocity through the air.
    Copter,
}

/// What the air does to a craft in flight. Standard deviations are the scatter itself, which lasts for about two seconds
/// ([`Air::INTERVAL`], [`Air::LASTS`]); where fixes show that there is more, they grow.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub enum Air {
    /// The velocity through the air stays that of trim in body axes, to this standard deviation [m/s].
    Wings(f64),
    /// The specific force across the thrust, which is along z, is the drag of the rotors.
    Rotors {
        /// Standard deviation of the specific force [m/s²].
        std: f64,
        /// Drag over mass [1/s], beside which [`Parameter::RotorDrag`] is estimated.
        drag: f64,
    },
}

impl Air {
    /// Time from one update to the next \[s\].
    pub const INTERVAL: f64 = 0.2;
    /// Time over which gusts, manoeuvres and angles of attack last \[s\]: white noise of the same power at one update every
    /// [`Air::INTERVAL`] has √(2 LASTS/INTERVAL) times their standard deviation.
    pub const LASTS: f64 = 2.0;
    /// An aircraft; on two of 2 and 20 kg the velocity through the air scatters by 1.5 to 4 m/s about a slow mean.
    pub const WINGS: Self = Self::Wings(1.5);
    /// Drag of a copter's rotors over its mass [1/s]; quadrotors have 0.2 to 0.35.
    pub const DRAG: f64 = 0.25;
    /// A copter.
    pub const ROTORS: Self = Self::Rotors {
        std: 0.2,
        drag: Self::DRAG,
    };
    /// Prior of the wind: gales are rare, and near the ground it changes by some 0.8 m/s in a minute.
    pub const WIND: Prior = Prior {
        std: 6.0,
        walk: 0.1,
        time: 0.0,
    };
    /// Prior of the rotors' drag beside the configured [1/s].
    pub const ROTOR_DRAG: Prior = Prior::constant(0.1);

    /// `parameters` with those that the motion through the air takes, without which it is not used: trim, drag of rotors, and wind
    /// with this standard deviation at the start [m/s]; `None` for still air, as indoors.
    ///
    /// ```
    /// use undrift_engine::vehicle::Air;
    /// use undrift_nav::parameters::{Parameter, Parameters};
    /// let estimated = Air::WINGS.with_states(Parameters::none(), Some(6.0));
    /// assert_eq!(estimated.states(), 5);
    /// assert!(estimated.prior(Parameter::RotorDrag).is_none());
    /// ```
    pub fn with_states(&self, parameters: Parameters, wind: Option<f64>) -> Parameters {
        let mut parameters = parameters.with(Parameter::TrimVelocity, self.trim());
        if let Some(std) = wind {
            parameters = parameters.with(Parameter::Wind, Prior { std, ..Self::WIND });
        }
        match self {
            Self::Wings(_) => parameters,
            Self::Rotors { .. } => parameters.with(Parameter::RotorDrag, Self::ROTOR_DRAG),
        }
    }

    /// Prior of the velocity in trim: that of any aircraft, which changes by 2 m/s in a minute, or a thrust that is turned by 2° against
    /// the body's z.
    const fn trim(&self) -> Prior {
        match self {
            Self::Wings(_) => Prior {
                std: 20.0,
                walk: 0.3,
                time: 0.0,
            },
            Self::Rotors { .. } => Prior {
                std: 1.5,
                walk: 0.01,
                time: 0.0,
            },
        }
    }
}

/// The constraints in force; `None` switches one off, and the default has none. Standard deviations are of one update.
///
/// ```
/// use undrift_engine::vehicle::{Constraints, NonHolonomic, Profile};
/// use undrift_nav::Vector3;
/// // A car whose IMU sits 1.2 m ahead of the rear axle and 0.3 m above it.
/// let lever = Vector3::new(-1.2, 0.0, 0.3);
/// let constraints = Constraints {
///     non_holonomic: Some(NonHolonomic { lever, ..NonHolonomic::CAR }),
///     ..Profile::Car.constraints()
/// };
/// assert_eq!(constraints.non_holonomic.map(|axle| axle.right), Some(0.2)); // [m/s]
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct Constraints {
    /// No velocity along the vehicle's right and down axes.
    pub non_holonomic: Option<NonHolonomic>,
    /// Standard deviation of the velocity at rest [m/s]: how much a parked vehicle sways.
    pub zero_velocity: Option<f64>,
    /// Standard deviation of the angular rate at rest beyond the gyros' noise [rad/s].
    pub zero_angular_rate: Option<f64>,
    /// Standard deviation of the heading against the course over ground \[rad\], and the speed above
    /// which it holds [m/s].
    pub course: Option<(f64, f64)>,
    /// What the air does to the craft, where the parameters of [`Air::with_states`] are estimated.
    pub air: Option<Air>,
    /// IMU → wheel that turns the odometer, body axes \[m\].
    pub odometer_lever: Vector3,
    /// Direction of the second antenna as seen from the first in the body, from forward to right \[rad\].
    pub heading_baseline: f64,
}

impl Constraints {
    /// These without the one whose updates are counted as `aid`; levers and directions of sensors stay.
    ///
    /// ```
    /// use undrift_engine::{Aid, vehicle::Profile};
    /// let car = Profile::Car.constraints().without(Aid::NonHolonomic);
    /// assert!(car.non_holonomic.is_none() && car.zero_velocity.is_some());
    /// ```
    #[must_use]
    pub fn without(mut self, aid: Aid) -> Self {
        match aid {
            Aid::NonHolonomic => self.non_holonomic = None,
            Aid::Air => self.air = None,
            Aid::ZeroVelocity => (self.zero_velocity, self.zero_angular_rate) = (None, None),
            _ => {}
        }
        self
    }
}

/// The non-holonomic constraint: the middle of the axle that does not steer moves along the vehicle's forward axis alone.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct NonHolonomic {
    /// Standard deviation of the velocity to the right [m/s].
    pub right: f64,
    /// Standard deviation of the velocity down [m/s]: springs and bumps.
    pub down: f64,
    /// Side slip: added to `right` for every m/s² of lateral acceleration [m/s per m/s²].
    pub slip: f64,
    /// Time from one update to the next \[s\].
    pub interval: f64,
    /// IMU → the middle of the axle that does not steer, body axes \[m\].
    pub lever: Vector3,
    /// Speed below which it is not applied [m/s].
    /// Below it a car may be manoeuvring with slip.
    pub min_speed: f64,
}

impl NonHolonomic {
    /// A car on roads.
    ///
    /// The velocity to the right of four smoothed drives of four cars scatters by 0.03 to 0.08 m/s and
    /// is correlated over two seconds, the one down by 0.06 to 0.08 m/s over four; in a turn the axle
    /// slips by 0.04 m/s for every m/s². White noise of the same power at one update every Δt has
    /// √(2 τ/Δt) times those standard deviations: 0.2, 0.4 and 0.15.
    pub const CAR: Self = Self {
        right: 0.2,
        down: 0.4,
        slip: 0.15,
        interval: 0.2,
        lever: Vector3::new(0.0, 0.0, 0.0),
        min_speed: 1.0,
    };
}

impl Profile {
    /// Every profile, that without knowledge first.
    pub const ALL: [Self; 5] = [
        Self::None,
        Self::Car,
        Self::Aircraft,
        Self::Pedestrian,
        Self::Copter,
    ];

    /// Its name in a drive file: `vehicle = "car"`.
    ///
    /// ```
    /// use undrift_engine::vehicle::Profile;
    /// let car = Profile::ALL.into_iter().find(|profile| profile.name() == "car");
    /// assert_eq!(car, Some(Profile::Car));
    /// ```
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Car => "car",
            Self::Aircraft => "aircraft",
            Self::Pedestrian => "pedestrian",
            Self::Copter => "copter",
        }
    }

    /// The constraints that the profile stands for, with the wheel and the axle at the IMU until their levers are set.
    pub fn constraints(self) -> Constraints {
        let rest = Constraints {
            zero_velocity: Some(0.02),
            zero_angular_rate: Some(2e-4),
            ..Constraints::default()
        };
        match self {
            Self::None => Constraints::default(),
            Self::Car => Constraints {
                non_holonomic: Some(NonHolonomic::CAR),
                ..rest
            },
            Self::Pedestrian => rest,
            Self::Aircraft => Constraints {
                air: Some(Air::WINGS),
                ..rest
            },
            Self::Copter => Constraints {
                air: Some(Air::ROTORS),
                ..Constraints::default()
            },
        }
    }
}
