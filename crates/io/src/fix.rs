//! What the formats of fixes share: which places and uncertainties can be such.

use undrift_nav::earth::Geodetic;
use undrift_nav::sample::FixQuality;
use undrift_nav::{Matrix3, Vector3};

use crate::skipped::{SkipKind, Skipped};

/// Whether this is a place on Earth other than the 0°, 0° of a receiver without a fix.
pub(crate) fn is_a_fix(place: &Geodetic) -> bool {
    place.is_valid() && !(place.lat == 0.0 && place.lon == 0.0)
}

/// A place as messages show it.
pub(crate) fn shown(place: &Geodetic) -> String {
    let (lat_deg, lon_deg) = (place.lat.to_degrees(), place.lon.to_degrees());
    format!("{lat_deg}°, {lon_deg}°, {} m", place.height)
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

/// The covariance of independent components, or `None` where a standard deviation is unusable.
pub(crate) fn independent(std: &Vector3) -> Option<Matrix3> {
    let usable = |s: &f64| s.is_finite() && *s > 0.0 && (s * s).is_normal();
    let usable = std.iter().all(usable);
    usable.then(|| Matrix3::from_diagonal(&std.component_mul(std)))
}

/// The same, counted where it is `None`.
pub(crate) fn diagonal(std: &Vector3, line: u64, skipped: &mut Skipped) -> Option<Matrix3> {
    let covariance = independent(std);
    if covariance.is_none() {
        let detail = format_args!("{}, {}, {}", std.x, std.y, std.z);
        skipped.add(SkipKind::Uncertainty, line, detail);
    }
    covariance
}

/// Whether three numbers of a position or velocity are finite; counted where not.
pub(crate) fn all_finite(values: &Vector3, line: u64, skipped: &mut Skipped) -> bool {
    let finite = values.iter().all(|value| value.is_finite());
    if !finite {
        let detail = format_args!("{}, {}, {}", values.x, values.y, values.z);
        skipped.add(SkipKind::NotFinite, line, detail);
    }
    finite
}
