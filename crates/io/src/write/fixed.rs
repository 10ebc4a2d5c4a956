use std::io::Write;

/// Powers of ten by which a double can be scaled with one rounding.
const POWERS: [f64; 16] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
];
/// 2⁵². Below it the sum of it and a number is that number rounded to a whole one, which then are the
/// last bits of the sum.
const WHOLE: f64 = 4_503_599_627_370_496.0;
/// Digits of the largest number below [`WHOLE`].
const DIGITS: usize = 16;

/// Appends `value` with a fixed number of decimals, as `format!("{value:.decimals$}")` would;
/// NaN and infinity become `nan`.
///
/// The value is scaled and rounded to a whole number. Where the scaled value is so close to a tie
/// that its own rounding could decide, or too large, the standard library writes it.
pub fn write_fixed(buf: &mut Vec<u8>, value: f64, decimals: usize) {
    let Some(power) = POWERS.get(decimals) else {
        return by_library(buf, value, decimals);
    };
    let scaled = value.abs() * power;
    let sum = scaled + WHOLE;
    let rest = (scaled - (sum - WHOLE)).abs();
    // The product is off by half a unit in its last place at most, 2⁻⁵³ of itself. Not so for NaN.
    if scaled < WHOLE && 0.5 - rest > scaled * f64::EPSILON {
        let number = sum.to_bits() - WHOLE.to_bits();
        put(buf, value.is_sign_negative(), number, decimals);
    } else {
        by_library(buf, value, decimals);
    }
}

/// Appends a whole number of 10^−decimals, below 10^16; 15 decimals at most.
#[inline]
fn put(buf: &mut Vec<u8>, negative: bool, number: u64, decimals: usize) {
    // Sixteen digits, and as many bytes again that may be copied with the last of them.
    let mut digits = [0; 2 * DIGITS];
    let low = eight_digits(number % 100_000_000);
    digits[8..DIGITS].copy_from_slice(&(low | ASCII).to_le_bytes());
    let mut zeros = 8 + low.trailing_zeros() / 8;
    digits[..8].copy_from_slice(&ASCII.to_le_bytes());
    if number >= 100_000_000 {
        let high = eight_digits(number / 100_000_000);
        digits[..8].copy_from_slice(&(high | ASCII).to_le_bytes());
        zeros = high.trailing_zeros() / 8;
    }
    // One digit at least stands before the point.
    let point = DIGITS - decimals.min(DIGITS - 1);
    let first = (zeros as usize).min(point - 1);

    // Sixteen bytes at a time, which is quicker than as many as there are.
    let mut text = [0; 2 * DIGITS + 2];
    text[0] = b'-';
    let mut at = usize::from(negative);
    text[at..at + DIGITS].copy_from_slice(&digits[first..first + DIGITS]);
    at += point - first;
    if decimals > 0 {
        text[at] = b'.';
        text[at + 1..at + 1 + DIGITS].copy_from_slice(&digits[point..point + DIGITS]);
        at += 1 + decimals;
    }
    let end = buf.len() + at;
    buf.extend_from_slice(&text);
    buf.truncate(end);
}

/// The digit 0 in each of eight bytes.
const ASCII: u64 = 0x3030_3030_3030_3030;

/// The digits of a number below 10^8, a byte each, the first in the lowest: halved into four digits each,
/// two each, one each, all halves at once. Division by 100 below 10⁴ and by 10 below 100 is a
/// multiplication and a shift.
#[inline]
fn eight_digits(number: u64) -> u64 {
    let fours = (number / 10_000) | ((number % 10_000) << 32);
    let hundreds = ((fours * 10_486) >> 20) & 0x0000_007f_0000_007f;
    let twos = hundreds | ((fours - 100 * hundreds) << 16);
    let tens = ((twos * 103) >> 10) & 0x000f_000f_000f_000f;
    tens | ((twos - 10 * tens) << 8)
}

#[cold]
fn by_library(buf: &mut Vec<u8>, value: f64, decimals: usize) {
    if !value.is_finite() {
        buf.extend_from_slice(b"nan");
        return;
    }
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
