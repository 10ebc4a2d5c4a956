//! Latitudes and longitudes as text, in degrees, minutes and seconds: `48°08'13.5"N`, `48 8 13.5 N`, `N48 08.225`,
//! `-48:08:13.5`, `48d08m13.5s`.

use crate::number;

/// Degrees and, behind them, minutes and seconds.
const PARTS: usize = 3;

/// The degrees of a text, and in how many parts it gives them: degrees alone, with minutes, with seconds. South and west
/// are negative.
pub(crate) fn degrees(text: &[u8]) -> Option<(f64, usize)> {
    let mut parts = [0.0; PARTS];
    let (mut count, mut hemisphere, mut has_fraction) = (0, None, false);
    let minus = [b"-".as_slice(), "\u{2212}".as_bytes()];
    let unsigned = minus.iter().find_map(|minus| text.strip_prefix(*minus));
    let negative = unsigned.is_some();
    let mut rest = unsigned.or(text.strip_prefix(b"+")).unwrap_or(text);
    let mut before = b' ';
    while let Some(&byte) = rest.first() {
        let length = match byte {
            b'0'..=b'9' => {
                let is_digit = |b: &u8| b.is_ascii_digit() || matches!(b, b'.' | b',');
                let length = rest.iter().take_while(|b| is_digit(b)).count();
                // Only the last has a fraction.
                if has_fraction {
                    return None;
                }
                let digits = rest.get(..length)?;
                *parts.get_mut(count)? = number::parse_with_comma(digits)?;
                has_fraction = digits.iter().any(|b| !b.is_ascii_digit());
                count += 1;
                length
            }
            b'A'..=b'Z' | b'a'..=b'z' => {
                match byte {
                    b'd' | b'D' if count == 1 => {}
                    b'm' | b'M' if count == 2 => {}
                    // Behind another letter as a mark a small s is one, too.
                    b's' if count == PARTS && text.contains(&b'd') => {}
                    letter if hemisphere.is_none() => hemisphere = Some(sign(letter)?),
                    _ => return None,
                }
                let is_word = |word: &&str| rest.starts_with(word.as_bytes());
                ["deg", "min", "sec"]
                    .iter()
                    .find(|w| is_word(w))
                    .map_or(1, |word| word.len())
            }
            b'-' if before.is_ascii_digit() => 1,
            b' ' | b'\'' | b'"' | b':' | 0x80.. => 1,
            _ => return None,
        };
        before = byte;
        rest = rest.get(length..)?;
    }
    let [degrees, minutes, seconds] = parts;
    let is_angle =
        count > 1 || hemisphere.is_some() || text.iter().any(|b| *b >= 0x80 || *b == b'd');
    if count == 0
        || !is_angle
        || minutes >= 60.0
        || seconds > 60.0
        || (count > 1 && degrees > 360.0)
    {
        return None;
    }
    let size = degrees + minutes / 60.0 + seconds / 3600.0;
    let is_negative = negative || hemisphere == Some(-1.0);
    Some((if is_negative { -size } else { size }, count))
}

/// What a column of hemispheres has: 1 of north and east, −1 of south and west.
pub(crate) fn hemisphere(text: &[u8]) -> Option<f64> {
    match text {
        [letter] => sign(*letter),
        _ => None,
    }
}

fn sign(letter: u8) -> Option<f64> {
    match letter.to_ascii_uppercase() {
        b'N' | b'E' => Some(1.0),
        b'S' | b'W' => Some(-1.0),
        _ => None,
    }
}

/// The degrees of a number ddmm.mmmm, as NMEA has them: degrees times 100 and minutes.
pub fn of_degrees_minutes(number: f64) -> f64 {
    let degrees = (number / 100.0).trunc();
    degrees + (number - 100.0 * degrees) / 60.0
}

/// The number ddmm.mmmm of degrees.
pub(crate) fn degrees_minutes(degrees: f64) -> f64 {
    100.0 * degrees.trunc() + 60.0 * degrees.fract()
}

/// Whether two numbers can be a latitude and a longitude as ddmm.mmmm, and not in degrees.
pub fn are_degrees_minutes(lat: f64, lon: f64) -> bool {
    let within = lat.abs() <= 9000.0 && lon.abs() <= 18_000.0;
    let minutes = [lat, lon]
        .iter()
        .all(|number| (number % 100.0).abs() < 60.0);
    within && minutes && (lat.abs() > 90.0 || lon.abs() > 180.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 48° + 8' / 60 + 13.5" / 3600.
    const EXPECTED: f64 = 48.137_083_333_333_33;

    #[test]
    fn notations_of_one_angle() {
        for text in [
            "48°08'13.5\"N",
            "48° 8′ 13,5″ N",
            "48 8 13.5 N",
            "48 08.225N",
            "N48 08.225",
            "N 48°08'13.50\"\"",
            "48:08:13.5",
            "+48:08:13.5",
            "48d08m13.5s",
            "48d 8m 13.5s N",
            "48-08-13.5n",
            "48deg 8min 13.5sec",
            "48º8.225'",
            "48.137083333333333 N",
            "48.137083333333333°",
        ] {
            let (found, _) = degrees(text.as_bytes()).unwrap_or_else(|| panic!("{text}"));
            assert!((found - EXPECTED).abs() < 1e-12, "{text}: {found}");
        }
        for text in [
            "-48:08:13.5",
            "\u{2212}48°08'13.5\"",
            "48 8 13.5 S",
            "48d08m13.5sW",
            "W48 08.225",
            "S48°08'13.5\"",
            "-48°08'13.5\"",
            "48 8 13.5 s",
        ] {
            let (found, _) = degrees(text.as_bytes()).unwrap_or_else(|| panic!("{text}"));
            assert!((found + EXPECTED).abs() < 1e-12, "{text}: {found}");
        }
        // Latin-1.
        assert_eq!(degrees(b"1\xb030'W").unwrap(), (-1.5, 2));
        assert_eq!(degrees(b"4808.225N").unwrap(), (4808.225, 1));
    }

    #[test]
    fn what_is_no_angle() {
        for text in [
            "",
            "N",
            "abc",
            "48.5",
            "48 60 0 N",
            "48 8 61 N",
            "48.5 8 N",
            "1 2 3 4",
            "48 N 8 E",
            "N48S",
            "2025-07-08",
            "48x8",
            "48 secs",
            "NaN",
            "1,2,3",
            "361 0 0",
            "48 8 -3",
        ] {
            assert_eq!(degrees(text.as_bytes()), None, "{text}");
        }
    }

    #[test]
    fn degrees_and_minutes_as_nmea_has_them() {
        assert!((of_degrees_minutes(4808.225) - EXPECTED).abs() < 1e-12);
        assert!((of_degrees_minutes(-13_130.0) + 131.5).abs() < 1e-12);
        assert!((degrees_minutes(-131.5) + 13_130.0).abs() < 1e-9);
        assert!(are_degrees_minutes(4808.2, 1131.0) && are_degrees_minutes(-3.2, 18_000.0));
        assert!(!are_degrees_minutes(48.2, 11.3) && !are_degrees_minutes(4808.2, 1171.0));
        assert!(!are_degrees_minutes(4_177_000.0, 855_000.0));
        assert_eq!(
            (hemisphere(b"w"), hemisphere(b"N"), hemisphere(b"x")),
            (Some(-1.0), Some(1.0), None)
        );
    }
}
