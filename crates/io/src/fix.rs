//! What the formats of fixes share: which places and uncertainties can be such.

use undrift_nav::earth::Geodetic;
use undrift_nav::sample::{FixQuality, Position};
use undrift_nav::{Matrix3, Vector3};

use crate::skipped::{SkipKind, Skipped, Unfit};

/// A place on Earth other than the 0°, 0° of a receiver without a fix.
pub(crate) fn on_earth(place: Geodetic) -> Result<Geodetic, Unfit> {
    if place.is_valid() && !(place.lat == 0.0 && place.lon == 0.0) {
        return Ok(place);
    }
    Err((SkipKind::OutOfRange, shown(&Position::Geodetic(place))))
}

/// A position as messages show it.
pub(crate) fn shown(position: &Position) -> String {
    match position {
        Position::Geodetic(Geodetic { lat, lon, height }) => {
            let (lat_deg, lon_deg) = (lat.to_degrees(), lon.to_degrees());
            format!("{lat_deg}°, {lon_deg}°, {height} m")
        }
        Position::Baseline { ned, .. } => format!("{} m", three(ned)),
    }
}

/// Three numbers as messages show them.
pub(crate) fn three(v: &Vector3) -> String {
    format!("{}, {}, {}", v.x, v.y, v.z)
}

/// Three finite numbers.
pub(crate) fn finite(values: Vector3) -> Result<Vector3, Unfit> {
    if values.iter().all(|value| value.is_finite()) {
        return Ok(values);
    }
    Err((SkipKind::NotFinite, three(&values)))
}

/// Along which axes the columns of a velocity are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VelocityAxes {
    /// North, east, down.
    #[default]
    Down,
    /// North, east, up.
    Up,
    /// Earth-centred, Earth-fixed x, y, z.
    Ecef,
    /// Speed over ground, course \[deg\] clockwise from north; the third column is not looked at.
    Course,
    /// The same with the velocity down in the third.
    CourseDown,
    /// The same with the velocity up in the third.
    CourseUp,
}

impl VelocityAxes {
    /// The three numbers of a row as a vector, of the unit that has this factor to m/s.
    pub(crate) fn vector(self, row: Vector3, scale: f64) -> Vector3 {
        if !self.is_course() {
            return row * scale;
        }
        let (east, north) = row.y.to_radians().sin_cos();
        let vertical = if self == Self::Course { 0.0 } else { row.z };
        Vector3::new(row.x * north, row.x * east, vertical) * scale
    }

    /// Whether the first two columns are speed and course.
    pub(crate) fn is_course(self) -> bool {
        matches!(self, Self::Course | Self::CourseDown | Self::CourseUp)
    }

    /// What turns such a velocity to north, east, down at a place; `None` where that takes a place and
    /// there is none.
    pub(crate) fn to_ned(self, place: Option<Geodetic>) -> Option<Matrix3> {
        match self {
            Self::Down | Self::Course | Self::CourseDown => Some(Matrix3::identity()),
            Self::Up | Self::CourseUp => {
                Some(Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, -1.0)))
            }
            Self::Ecef => place.map(|place| place.ned_from_ecef()),
        }
    }
}

/// What RTKLIB's solution status Q means: 1 fixed, 2 float, 3 SBAS, 4 differential, 5 single,
/// 6 precise point positioning; anything else is unknown.
pub fn quality_of_rtklib(q: f64) -> FixQuality {
    // The comparison is of codes that some writers print with decimals.
    match q.round() {
        1.0 => FixQuality::Fixed,
        2.0 => FixQuality::Float,
        3.0 | 4.0 | 6.0 => FixQuality::Differential,
        5.0 => FixQuality::Single,
        _ => FixQuality::Unknown,
    }
}

/// Whether a number can be a standard deviation: above zero, and so is its square.
pub(crate) fn is_usable_std(std: f64) -> bool {
    std > 0.0 && (std * std).is_normal()
}

/// The covariance of independent components, or `None` where a standard deviation is unusable.
pub(crate) fn independent(std: &Vector3) -> Option<Matrix3> {
    let usable = std.iter().all(|std| is_usable_std(*std));
    usable.then(|| Matrix3::from_diagonal(&std.component_mul(std)))
}

/// Whether a matrix can be a covariance: finite and positive definite.
pub(crate) fn is_covariance(full: &Matrix3) -> bool {
    full.iter().all(|value| value.is_finite()) && full.cholesky().is_some()
}

/// [`independent`], counted where it is `None`.
pub(crate) fn diagonal(std: &Vector3, line: u64, skipped: &mut Skipped) -> Option<Matrix3> {
    let covariance = independent(std);
    if covariance.is_none() {
        skipped.add(SkipKind::Uncertainty, line, three(std));
    }
    covariance
}
