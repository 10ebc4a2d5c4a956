//! Pieces of text that the formats share.

use undrift_nav::earth::Geodetic;

use super::write_fixed;

/// Appends an angle \[deg\] in [0, 360): just below a full turn rounds to zero.
pub(super) fn write_turn(buf: &mut Vec<u8>, degrees: f64, decimals: usize) {
    let from = buf.len();
    write_fixed(buf, degrees.rem_euclid(360.0), decimals);
    if buf[from..].starts_with(b"360") {
        buf.truncate(from);
        write_fixed(buf, 0.0, decimals);
    }
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
