//! Settings of a magnetometer.

use undrift_nav::{Vector3, earth::Geodetic, magnetic};

/// What is known of a magnetometer beyond its hard iron, whose prior is that of
/// [`Parameter::HardIron`](undrift_nav::parameters::Parameter::HardIron).
///
/// ```
/// use undrift_engine::settings::{Settings, magnetometer::Magnetometer};
/// use undrift_nav::{parameters::{Parameter, Parameters}, shaping::ShapingFilter};
/// // A log of the summer of 2026.
/// let settings = Settings {
///     magnetometer: Magnetometer { year: Some(2026.5), ..Magnetometer::default() },
///     parameters: Parameters::none().with(Parameter::HardIron, Magnetometer::HARD_IRON),
///     ..Settings::new([ShapingFilter::white(1e-3, 0.01)?; 6])
/// };
/// assert_eq!(settings.magnetometer.lasting, 2e-6); // [T]
/// # Ok::<(), undrift_nav::shaping::ShapingError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Magnetometer {
    /// Standard deviation of errors that last for some seconds, each axis \[T\]: soft iron, currents of motors, iron in the
    /// surroundings.
    pub lasting: f64,
    /// Year of the log with its fraction, for the Earth's field; `None`: about now.
    pub year: Option<f64>,
}

/// A year unknown may be so many years off the model's epoch, one standard deviation …
const YEARS: f64 = 4.0;
/// … and the field changes by so much in one, each axis \[T\].
const CHANGE: f64 = 0.05e-6;

impl Default for Magnetometer {
    fn default() -> Self {
        Self {
            lasting: 2e-6,
            year: None,
        }
    }
}

impl Magnetometer {
    /// A hard iron that nobody has calibrated, or a calibration of another day: 5 µT, a quarter of the horizontal field in Europe, and
    /// 1 µT more in seven minutes.
    pub const HARD_IRON: undrift_nav::parameters::Prior = undrift_nav::parameters::Prior {
        std: 5e-6,
        walk: 0.05e-6,
        time: 0.0,
    };

    /// The Earth's field at a place, north, east, down \[T\].
    pub(crate) fn field(&self, place: &Geodetic) -> Vector3 {
        magnetic::field(place, self.year.unwrap_or(magnetic::EPOCH))
    }

    /// Variance of what lasts for a while, each axis \[T²\]: of the readings and of the model of the field.
    pub(crate) fn lasting_variance(&self) -> f64 {
        let model = match self.year {
            Some(year) => magnetic::uncertainty(year),
            None => magnetic::UNMODELLED.max(YEARS * CHANGE),
        };
        self.lasting * self.lasting + model * model
    }
}
