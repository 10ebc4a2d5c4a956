//! Pieces of text that the formats share.

use undrift_nav::earth::Geodetic;

use super::write_fixed;

/// Decimals of degrees on maps: a tenth of a millimetre.
const DEGREE_DECIMALS: usize = 9;

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

/// Appends `longitude,latitude,height` [deg, m].
pub(super) fn write_place(buf: &mut Vec<u8>, position: &Geodetic) {
    let [lat, lon] = map_degrees(position);
    write_fixed(buf, lon, DEGREE_DECIMALS);
    buf.push(b',');
    write_fixed(buf, lat, DEGREE_DECIMALS);
    buf.push(b',');
    write_fixed(buf, position.height, 3);
}

/// Text of an XML element: what XML 1.0 does not allow becomes a space.
pub(super) fn xml(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// A JSON string with its quotes (RFC 8259, section 7).
pub(super) fn json(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            c if u32::from(c) < 0x20 => out.push_str(&format!("\\u{:04x}", u32::from(c))),
            c => out.push(c),
        }
    }
    out.push('"');
    out
}
