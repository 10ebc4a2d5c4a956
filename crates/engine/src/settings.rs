//! Settings of a navigator: sensors, vehicle, alignment, what is estimated, and which fixes are used and how far they are believed.

pub mod align;
pub mod magnetometer;
pub mod quality;

pub use undrift_events::{Doubt, GnssUse, Outage, fix_errors};

use crate::{
    estimator::LogTo,
    settings::{align::AlignSettings, magnetometer::Magnetometer, quality::QualityStd},
    vehicle::Constraints,
};
use alloc::vec::Vec;
#[allow(unused_imports, reason = "the standard library has its methods itself")]
use nalgebra::ComplexField;
use undrift_events::fix_errors::{FixErrors, FromFixes};
use undrift_nav::{
    Matrix3, Quaternion, Vector3,
    covariance::AXES,
    parameters::{Parameter, Parameters},
    shaping::ShapingFilter,
};

/// All that a [`Navigator`](crate::Navigator) is configured by. [`Settings::new`] gives the defaults; what is known beyond the sensors'
/// noise is set on top:
///
/// ```
/// use undrift_engine::{align::{AlignSettings, Heading}, settings::Settings, vehicle::Profile};
/// use undrift_nav::{Vector3, parameters::{Parameter, Parameters, Prior}, shaping::ShapingFilter};
/// let (gyro, accel) = (ShapingFilter::white(1e-4, 0.01)?, ShapingFilter::white(1e-3, 0.01)?);
/// let settings = Settings {
///     lever_arm: Vector3::new(0.3, 0.0, -1.2), // The antenna is 0.3 m ahead of the IMU and 1.2 m above it.
///     constraints: Profile::Car.constraints(),
///     align: AlignSettings { heading: Heading::Given(1.57, 0.05), ..AlignSettings::default() }, // East.
///     parameters: Parameters::none().with(Parameter::TimeOffset, Prior::constant(0.1)), // Latency within 0.1 s.
///     ..Settings::new([gyro, gyro, gyro, accel, accel, accel])
/// };
/// assert!(settings.gating && settings.restart && settings.constraints.non_holonomic.is_some());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Settings {
    /// Noise models of gyro x, y, z [rad/s] and accelerometer x, y, z [m/s²] at the log's sample interval, as
    /// `ImuModel::shaping` of `undrift-noise` makes them. Their states are estimated.
    pub sensors: [ShapingFilter; AXES],
    /// Rotation from the sensor's own axes to the body's, which the samples pushed are in already: spikes and stuck values are
    /// looked for along the sensor's own axes.
    pub rotation: Matrix3,
    /// Whether samples come in the axes of a sensor that sits in the vehicle in an unknown way. Body axes are the
    /// sensor's then until the mounting is found, and the vehicle's from then on; what is stated here is in the
    /// vehicle's axes and waits for them. Not beside `nodes` or `log`.
    pub find_mounting: bool,
    /// IMU → antenna, body axes \[m\]: forward, right and down positive, so an antenna on the roof has a negative third component. It is
    /// estimated beside this value where [`Parameter::LeverArm`] is among the parameters.
    pub lever_arm: Vector3,
    /// Axes of the marker in the body, `q_bk`, which turns vectors of the marker's axes into the body's, where the fixes are poses of a
    /// marker. It is estimated beside this value where [`Parameter::MarkerRotation`] is among the parameters.
    pub marker: Option<Quaternion>,
    /// Whether the navigation frame turns with the Earth; not in a room whose heading against north is unknown. `true` by default.
    pub earth_rate: bool,
    /// Parts of a fix that update the solution. Alignment takes the position in any case.
    ///
    /// ```
    /// use undrift_engine::settings::{GnssUse, Settings};
    /// # use undrift_nav::shaping::ShapingFilter;
    /// # let sensors = [ShapingFilter::white(1e-3, 0.01)?; 6];
    /// // A receiver whose velocities lag: its positions alone update the solution.
    /// let settings = Settings { gnss_use: GnssUse::Position, ..Settings::new(sensors) };
    /// assert_ne!(settings.gnss_use, GnssUse::default());
    /// # Ok::<(), undrift_nav::shaping::ShapingError>(())
    /// ```
    pub gnss_use: GnssUse,
    /// How the first position, velocity and attitude are found.
    pub align: AlignSettings,
    /// Spans whose fixes are withheld, in order of time: to measure the drift without GNSS.
    pub outages: Vec<Outage>,
    /// Constants that are estimated beside the sensors' errors, each with its prior; none by default.
    pub parameters: Parameters,
    /// What the vehicle cannot do ([`Profile::constraints`](crate::vehicle::Profile::constraints)); nothing by default.
    pub constraints: Constraints,
    /// How well it is known how the IMU sits, one standard deviation about the vehicle's axes, roll, pitch, yaw \[rad\]: attitudes of the
    /// vehicle are so much less certain. Zero by default; replaced where the mounting is found on the way.
    pub mounting_std: Vector3,
    /// Scale factor errors of the accelerometers that are no states and that the covariance has to cover, one standard deviation [–]: velocity
    /// is as uncertain as 5 s of the acceleration between fixes times that make it. 0 by default.
    pub accel_scale_error: f64,
    /// What is known of the magnetometer, where there is one.
    pub magnetometer: Magnetometer,
    /// Whether fixes pass a gate, a diverged solution is re-initialised, and the covariance has the products of errors, which a linear
    /// filter leaves out. `true` by default.
    pub gating: bool,
    /// Whether a solution that does not agree with the fixes for half a minute is re-initialised, too. `true` by default.
    pub restart: bool,
    /// Whether the stated standard deviations of the fixes are scaled by what the innovations show (recursive maximum likelihood).
    pub adapt: bool,
    /// Rule for the standard deviation of a position by the kind of solution; as stated by default.
    pub quality: QualityStd,
    /// Where the white noise of the sensors follows their vibration: factors on the standard deviation of what exceeds the model's, gyro and
    /// accelerometer x, y, z ([`Vibration`](crate::vibration::Vibration)). `None`: the model's white noise throughout.
    pub vibration: Option<[f64; AXES]>,
    /// Errors of the fixes beyond what they state: from the start, or until the fixes show them themselves ([`Settings::from_fixes`]).
    pub fix_errors: FixErrors,
    /// Whether the fixes' errors are learnt from the fixes as they come, and what is stated of them. Not beside `nodes` or `log`: the states
    /// of a smoother stay the same.
    pub from_fixes: Option<FromFixes>,
    /// Longest span between two nodes for a smoother \[s\]; `None`: no nodes.
    pub nodes: Option<f64>,
    /// Error of the first state after alignment, in the order of the error state, estimate less truth for its first nine: as a smoother
    /// has found it in a run before. It is removed before navigation begins.
    pub start: Option<Vec<f64>>,
    /// Where a pass before has found the solution to go wrong: the covariance grows over these spans, in place of
    /// at the one instant at which that was found.
    ///
    /// ```
    /// use undrift_engine::settings::{Doubt, Settings};
    /// use undrift_nav::shaping::ShapingFilter;
    /// // A first pass followed fixes at 130 s after it had rejected them from 118 s on.
    /// let doubt = Doubt { start: 118.0, end: 130.0, position: 8.0, velocity: 0.7, tilt: 0.01 };
    /// let settings = Settings { doubts: vec![doubt], ..Settings::new([ShapingFilter::white(1e-3, 0.01)?; 6]) };
    /// assert_eq!(settings.doubts.len(), 1);
    /// # Ok::<(), undrift_nav::shaping::ShapingError>(())
    /// ```
    pub doubts: Vec<Doubt>,
    /// Receives every update of the filter, for tuning; `None`: no updates are kept.
    pub log: Option<LogTo>,
}

/// A lever arm that is known to so small a part of the fixes' standard deviation is not worth estimating.
const LITTLE: f64 = 0.1;

impl Settings {
    /// The parameters that a filter estimates from fixes of this covariance \[m²\] on: without the lever arm where it is known to a
    /// tenth of their standard deviation.
    pub(crate) fn worthwhile(&self, position: &Matrix3) -> Parameters {
        let least = position[(0, 0)].min(position[(1, 1)]).sqrt();
        match self.parameters.prior(Parameter::LeverArm) {
            Some(prior) if prior.std < LITTLE * least => {
                self.parameters.without(Parameter::LeverArm)
            }
            _ => self.parameters,
        }
    }

    /// Settings for sensors of these models: antenna at the IMU, alignment by itself, no outages, no
    /// parameters, no vehicle, fixes gated.
    pub fn new(sensors: [ShapingFilter; AXES]) -> Self {
        Self {
            sensors,
            rotation: Matrix3::identity(),
            find_mounting: false,
            lever_arm: Vector3::zeros(),
            marker: None,
            earth_rate: true,
            gnss_use: GnssUse::Both,
            align: AlignSettings::default(),
            outages: Vec::new(),
            parameters: Parameters::none(),
            mounting_std: Vector3::zeros(),
            accel_scale_error: 0.0,
            constraints: Constraints::default(),
            magnetometer: Magnetometer::default(),
            gating: true,
            restart: true,
            adapt: false,
            quality: QualityStd::AsStated,
            vibration: None,
            fix_errors: FixErrors::default(),
            from_fixes: None,
            nodes: None,
            start: None,
            doubts: Vec::new(),
            log: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::sensors;
    use undrift_nav::parameters::Prior;

    #[test]
    fn a_lever_arm_known_to_a_tenth_of_the_fixes_is_not_estimated() {
        let with = |arm: f64| {
            let mut settings = Settings::new(sensors());
            settings.parameters = Parameters::none()
                .with(Parameter::LeverArm, Prior::constant(arm))
                .with(Parameter::TimeOffset, Prior::constant(0.1));
            // 0.3 m north, 0.2 m east; the height does not count.
            let position = Matrix3::from_diagonal(&Vector3::new(0.09, 0.04, 1e-4));
            settings.worthwhile(&position)
        };
        assert_eq!(with(0.021).states(), 4);
        assert_eq!(with(0.019).states(), 1);
        assert!(with(0.019).prior(Parameter::TimeOffset).is_some());
    }
}
