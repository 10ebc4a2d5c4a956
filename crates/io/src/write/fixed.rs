use std::io::Write;

/// Powers of ten by which a double can be scaled with one rounding.
const POWERS: [f64; 16] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
];
/// Below this every whole number is a double.
const EXACT: f64 = 9_007_199_254_740_992.0;

const PAIRS: [u8; 200] = digit_pairs();

const fn digit_pairs() -> [u8; 200] {
    let mut pairs = [0; 200];
    let mut k = 0;
    while k < 100 {
        pairs[2 * k] = b'0' + (k / 10) as u8;
        pairs[2 * k + 1] = b'0' + (k % 10) as u8;
        k += 1;
    }
    pairs
}

/// Appends `value` with a fixed number of decimals, as `format!("{value:.decimals$}")` would;
/// NaN and infinity become `nan`.
///
/// The value is scaled and rounded as a whole number. Where the scaled value is so close to a tie
/// that its own rounding could decide, or too large, the standard library writes it.
pub fn write_fixed(buf: &mut Vec<u8>, value: f64, decimals: usize) {
    if !value.is_finite() {
        buf.extend_from_slice(b"nan");
        return;
    }
    let Some(power) = POWERS.get(decimals) else {
        return by_library(buf, value, decimals);
    };
    let scaled = value.abs() * power;
    if scaled >= EXACT {
        return by_library(buf, value, decimals);
    }
    let whole = scaled as u64;
    let rest = scaled - whole as f64;
    // The product is off by half a unit in its last place at most, 2⁻⁵³ of itself.
    if (rest - 0.5).abs() <= scaled * f64::EPSILON {
        return by_library(buf, value, decimals);
    }
    let rounded = whole + u64::from(rest > 0.5);
    put(buf, value.is_sign_negative(), rounded, decimals);
}

/// Appends a whole number of 10^−decimals.
#[inline]
fn put(buf: &mut Vec<u8>, negative: bool, mut number: u64, decimals: usize) {
    // Up to 16 digits, or 15 decimals and a leading zero; the sign and the point.
    let mut text = [b'0'; 24];
    let mut at = text.len();
    let mut left = decimals;
    while left >= 2 {
        at -= 2;
        text[at..at + 2].copy_from_slice(pair(number % 100));
        number /= 100;
        left -= 2;
    }
    if left == 1 {
        at -= 1;
        text[at] = b'0' + (number % 10) as u8;
        number /= 10;
    }
    if decimals > 0 {
        at -= 1;
        text[at] = b'.';
    }
    while number >= 10 {
        at -= 2;
        text[at..at + 2].copy_from_slice(pair(number % 100));
        number /= 100;
    }
    // One digit is left, or two were written of an even number of them.
    if number > 0 || text.get(at).is_none_or(|&byte| byte == b'.') {
        at -= 1;
        text[at] = b'0' + number as u8;
    }
    if negative {
        at -= 1;
        text[at] = b'-';
    }
    buf.extend_from_slice(&text[at..]);
}

#[inline]
fn pair(number: u64) -> &'static [u8] {
    let at = 2 * number as usize;
    &PAIRS[at..at + 2]
}

#[cold]
fn by_library(buf: &mut Vec<u8>, value: f64, decimals: usize) {
    // Writing to a vector cannot fail.
    let _ = write!(buf, "{value:.decimals$}");
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fixed(value: f64, decimals: usize) -> String {
        let mut buf = Vec::new();
        write_fixed(&mut buf, value, decimals);
        String::from_utf8(buf).unwrap()
    }

    fn next(state: &mut u64) -> u64 {
        *state ^= *state << 13;
        *state ^= *state >> 7;
        *state ^= *state << 17;
        *state
    }

    /// Equality, not a tolerance: near ties are left to the standard library.
    #[test]
    fn equals_the_standard_library() {
        let mut state = 7;
        for _ in 0..300_000 {
            let decimals = (next(&mut state) % 18) as usize;
            let size = 10f64.powi((next(&mut state) % 24) as i32 - 12);
            let value = (next(&mut state) as i64 as f64 / i64::MAX as f64) * size;
            assert_eq!(fixed(value, decimals), format!("{value:.decimals$}"));
            // Ties and what is next to them.
            let tie = ((next(&mut state) % 2_000_000) as f64 + 0.5) / POWERS[decimals.min(12)];
            for value in [tie, tie.next_up(), tie.next_down(), -tie] {
                assert_eq!(fixed(value, decimals), format!("{value:.decimals$}"));
            }
            let any = f64::from_bits(next(&mut state));
            if any.is_finite() {
                assert_eq!(fixed(any, decimals), format!("{any:.decimals$}"));
            }
        }
    }

    #[test]
    fn corners() {
        assert_eq!(fixed(0.0, 3), "0.000");
        assert_eq!(fixed(-0.0004, 3), "-0.000");
        assert_eq!(fixed(0.9999, 3), "1.000");
        assert_eq!(fixed(5.0, 0), "5");
        assert_eq!(fixed(0.0, 0), "0");
        assert_eq!(fixed(1e-9, 15), "0.000000001000000");
        assert_eq!(fixed(9.007_199_254_740_991, 15), "9.007199254740991");
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(fixed(bad, 4), "nan");
        }
    }
}
