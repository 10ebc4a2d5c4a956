use std::io::Write;

/// Powers of ten by which a double can be scaled with one rounding.
pub(super) const POWERS: [f64; 16] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
];
/// 2⁵². Below it the sum of it and a number is that number rounded to a whole one, which then are the
/// last bits of the sum.
const WHOLE: f64 = 4_503_599_627_370_496.0;
/// Digits that [`eight_digits`] makes, and of the largest number below [`WHOLE`].
const WORD: usize = 8;
const DIGITS: usize = 2 * WORD;

/// Longest number that [`put`] writes, with sign and point, and the room that it wants.
const LONGEST: usize = DIGITS + 2;
const ROOM: usize = 2 * DIGITS + 2;
/// Room for a row of them.
const LINE: usize = 768;

/// Appends `value` with a fixed number of decimals, as `format!("{value:.decimals$}")` would;
/// NaN and infinity become `nan`.
///
/// The value is scaled and rounded to a whole number. Where the scaled value is so close to a tie
/// that its own rounding could decide, or too large, the standard library writes it.
pub fn write_fixed(buf: &mut Vec<u8>, value: f64, decimals: usize) {
    match POWERS.get(decimals).map(|power| scaled(value, *power)) {
        Some((number, true)) => {
            let from = buf.len();
            buf.extend_from_slice(&[0; ROOM]);
            let text = buf.last_chunk_mut();
            let length = text.map_or(0, |text| put(text, value, number, decimals));
            buf.truncate(from + length);
        }
        _ => by_library(buf, value, decimals),
    }
}

/// The decimals of the numbers in a row. Writing all of them at once is quicker than one by one.
pub(super) struct FixedRow<const N: usize> {
    decimals: [usize; N],
    powers: [f64; N],
}

impl<const N: usize> FixedRow<N> {
    /// Of numbers with so many decimals each, 15 at most.
    pub(super) const fn new(decimals: [usize; N]) -> Self {
        let mut powers = [0.0; N];
        let mut k = 0;
        while k < N {
            powers[k] = POWERS[decimals[k]];
            k += 1;
        }
        Self { decimals, powers }
    }

    /// Appends numbers as [`write_fixed`] does, with commas between them.
    pub(super) fn write(&self, buf: &mut Vec<u8>, values: &[f64; N]) {
        const { assert!(N * (LONGEST + 1) + ROOM <= LINE) };
        let mut numbers = [0; N];
        let mut exact = true;
        for k in 0..N {
            let (number, is_exact) = scaled(values[k], self.powers[k]);
            numbers[k] = number;
            exact &= is_exact;
        }
        if !exact {
            for (k, (value, decimals)) in values.iter().zip(self.decimals).enumerate() {
                if k > 0 {
                    buf.push(b',');
                }
                write_fixed(buf, *value, decimals);
            }
            return;
        }
        let mut line = [0; LINE];
        let mut end = 0;
        for k in 0..N {
            if let Some(text) = line[end..].first_chunk_mut() {
                end += put(text, values[k], numbers[k], self.decimals[k]);
            }
            line[end] = b',';
            end += 1;
        }
        buf.extend_from_slice(&line[..end.saturating_sub(1)]);
    }
}

/// A value in units of its last decimal, `power` to one, rounded; and whether that is as it would be without a rounding
/// of the product. Below 2⁵² then.
#[inline]
fn scaled(value: f64, power: f64) -> (u64, bool) {
    let scaled = value.abs() * power;
    let sum = scaled + WHOLE;
    let rest = (scaled - (sum - WHOLE)).abs();
    // The product is off by half a unit in its last place at most, 2⁻⁵³ of itself. Not so for NaN.
    let exact = (scaled < WHOLE) & (0.5 - rest > scaled * f64::EPSILON);
    (sum.to_bits().wrapping_sub(WHOLE.to_bits()), exact)
}

/// Writes a value that is so many units of its last decimal, below 10^16, of at most 15; its length. Words are written
/// whole, which is quicker than as many bytes as there are.
#[inline]
fn put(text: &mut [u8; ROOM], value: f64, number: u64, decimals: usize) -> usize {
    text[0] = b'-';
    let at = usize::from(value.is_sign_negative());
    if number < 100_000_000 && decimals <= WORD {
        put_short(text, at, number, decimals)
    } else {
        put_long(text, at, number, decimals)
    }
}

/// Writes a number below 10^8 of at most 8 decimals from `at` on; where it ends.
#[inline]
fn put_short(text: &mut [u8; ROOM], at: usize, number: u64, decimals: usize) -> usize {
    let digits = eight_digits(number);
    let zeros = digits.trailing_zeros() as usize / 8;
    let digits = digits | ASCII;
    let point = WORD - decimals;
    // At least one digit comes before the point.
    let (whole, length) = match zeros < point {
        true => (digits >> (8 * zeros), point - zeros),
        false => (u64::from(b'0'), 1),
    };
    text[at..at + WORD].copy_from_slice(&whole.to_le_bytes());
    let end = at + length;
    if decimals == 0 {
        return end;
    }
    let fraction = digits >> (8 * point);
    text[end] = b'.';
    text[end + 1..end + 1 + WORD].copy_from_slice(&fraction.to_le_bytes());
    end + 1 + decimals
}

/// The same of any number.
#[inline]
fn put_long(text: &mut [u8; ROOM], at: usize, number: u64, decimals: usize) -> usize {
    let (high, low) = (number / 100_000_000, number % 100_000_000);
    let digits = u128::from(eight_digits(high)) | (u128::from(eight_digits(low)) << 64);
    // At least one digit comes before the point.
    let point = DIGITS - decimals;
    let first = (digits.trailing_zeros() as usize / 8).min(point - 1);
    let digits = digits | ((u128::from(ASCII) << 64) | u128::from(ASCII));
    let whole = digits >> (8 * first);
    text[at..at + DIGITS].copy_from_slice(&whole.to_le_bytes());
    let end = at + point - first;
    if decimals == 0 {
        return end;
    }
    let fraction = digits >> (8 * point);
    text[end] = b'.';
    text[end + 1..end + 1 + DIGITS].copy_from_slice(&fraction.to_le_bytes());
    end + 1 + decimals
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

    /// Every row, also with what the standard library writes in its midst.
    #[test]
    fn a_row_is_its_numbers_with_commas_between_them() {
        const ROW: FixedRow<5> = FixedRow::new([0, 4, 8, 11, 15]);
        let mut state = 11;
        for _ in 0..100_000 {
            let values = [0; 5].map(|_| {
                let size = 10f64.powi((next(&mut state) % 12) as i32 - 10);
                let value = (next(&mut state) as i64 as f64 / i64::MAX as f64) * size;
                match next(&mut state) % 100 {
                    0 => f64::NAN,
                    1 => 1e300,
                    2 => -0.0,
                    3 => 0.5,
                    _ => value,
                }
            });
            let mut buf = b"before ".to_vec();
            ROW.write(&mut buf, &values);
            let alone = values.iter().zip(ROW.decimals);
            let expected: Vec<String> = alone.map(|(x, decimals)| fixed(*x, decimals)).collect();
            assert_eq!(
                String::from_utf8(buf).unwrap(),
                format!("before {}", expected.join(","))
            );
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
