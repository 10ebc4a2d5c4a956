//! Pieces of text that the formats share.

use undrift_nav::earth::Geodetic;

use super::fixed::{POWERS, write_fixed};

/// An angle \[deg\] in [0, 360) as it is written with so many decimals: what would be rounded to a full turn is zero.
pub(super) fn in_turn(degrees: f64, decimals: usize) -> f64 {
    let mut turn = match degrees < 0.0 {
        true => degrees + 360.0,
        false => degrees,
    };
    if !(0.0..360.0).contains(&turn) {
        turn = degrees.rem_euclid(360.0);
    }
    let nearly = 360.0 - 0.5 / POWERS.get(decimals).copied().unwrap_or(f64::INFINITY);
    match turn >= nearly {
        true => 0.0,
        false => turn,
    }
}

/// Appends an angle \[deg\] in [0, 360).
pub(super) fn write_turn(buf: &mut Vec<u8>, degrees: f64, decimals: usize) {
    write_fixed(buf, in_turn(degrees, decimals), decimals);
}

/// Latitude and longitude \[deg\] as a map takes them, longitude in [−180, 180).
pub(super) fn map_degrees(position: &Geodetic) -> [f64; 2] {
    let lon = (position.lon.to_degrees() * 1e9).round() / 1e9;
    let lon = if (-180.0..180.0).contains(&lon) {
        lon
    } else {
        (lon + 180.0).rem_euclid(360.0) - 180.0
    };
    [position.lat.to_degrees(), lon]
}

/// `longitude,latitude,height` [deg, m]; nine decimals of degrees are a tenth of a millimetre.
pub(super) fn place(position: &Geodetic) -> String {
    let [lat, lon] = map_degrees(position);
    format!("{lon:.9},{lat:.9},{:.3}", position.height)
}

/// Text of an XML element: what XML 1.0 does not allow becomes a space.
pub(super) fn xml(text: &str) -> String {
    let allowed = |c: char| match c {
        c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => ' ',
        c => c,
    };
    let text: String = text.chars().map(allowed).collect();
    quick_xml::escape::escape(text).into_owned()
}
