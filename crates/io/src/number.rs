//! Decimal numbers from bytes, bit for bit what `str::parse::<f64>` gives, faster.
//!
//! The short way is Clinger's: a mantissa below 2⁵³ and a power of ten up to 10²² are both exact
//! doubles, so one multiplication or division rounds once and correctly (Clinger 1990, "How to
//! read floating point numbers accurately"). Anything else goes to the standard library. The same by
//! `fast-float2` 0.2.4 takes a third to a half longer for numbers as logs have them.

const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
];
const TENS: [u64; 8] = [1, 10, 100, 1000, 10_000, 100_000, 1_000_000, 10_000_000];
const MAX_EXACT_MANTISSA: u64 = 1 << 53;
/// Digits that fit a `u64` whatever they are.
const MAX_DIGITS: usize = 19;

/// Parses a whole field; `None` if it is not a number. Accepts what `str::parse::<f64>` accepts,
/// so also `nan` and `inf`.
pub fn parse(field: &[u8]) -> Option<f64> {
    match parse_prefix(field) {
        Some((value, length)) if length == field.len() => Some(value),
        _ => std::str::from_utf8(field).ok()?.parse().ok(),
    }
}

/// The same; `None` if it is not finite either.
pub(crate) fn parse_finite(field: &[u8]) -> Option<f64> {
    parse(field).filter(|value| value.is_finite())
}

/// The same of a field whose decimal mark may be a comma.
pub(crate) fn parse_with_comma(field: &[u8]) -> Option<f64> {
    parse(field).or_else(|| {
        let at = field.iter().position(|byte| *byte == b',')?;
        let mut field = field.to_vec();
        *field.get_mut(at)? = b'.';
        parse(&field)
    })
}

/// Parses the decimal number that `bytes` starts with: its value and its length in bytes. `None`
/// if there is none, which includes `nan` and `inf`.
#[inline]
pub fn parse_prefix(bytes: &[u8]) -> Option<(f64, usize)> {
    let negative = bytes.first() == Some(&b'-');
    let mut at = usize::from(negative || bytes.first() == Some(&b'+'));
    let mut mantissa = 0;
    let whole_from = at;
    at = digits(bytes, at, &mut mantissa);
    let mut digit_count = at - whole_from;
    let mut exponent = 0;
    if bytes.get(at) == Some(&b'.') {
        let fraction_from = at + 1;
        at = many_digits(bytes, fraction_from, &mut mantissa);
        digit_count += at - fraction_from;
        exponent = -((at - fraction_from) as i64);
    }
    if digit_count == 0 {
        return None;
    }
    if let Some(b'e' | b'E') = bytes.get(at) {
        let (written, end) = exponent_at(bytes, at + 1)?;
        exponent += written;
        at = end;
    }
    if digit_count <= MAX_DIGITS && mantissa <= MAX_EXACT_MANTISSA {
        let size = mantissa as f64;
        let value = match exponent {
            -22..=-1 => size / POWERS[-exponent as usize],
            0..=22 => size * POWERS[exponent as usize],
            _ => return by_library(bytes, at),
        };
        return Some((if negative { -value } else { value }, at));
    }
    by_library(bytes, at)
}

/// Adds the digits from `at` on to the mantissa (wrapping where they are too many); where they end.
#[inline]
fn digits(bytes: &[u8], mut at: usize, mantissa: &mut u64) -> usize {
    let mut m = *mantissa;
    while let Some(&byte) = bytes.get(at) {
        let digit = byte.wrapping_sub(b'0');
        if digit > 9 {
            break;
        }
        m = m.wrapping_mul(10).wrapping_add(u64::from(digit));
        at += 1;
    }
    *mantissa = m;
    at
}

/// The same, eight bytes at a time, which is quicker where there are several digits.
#[inline]
fn many_digits(bytes: &[u8], mut at: usize, mantissa: &mut u64) -> usize {
    while let Some(word) = bytes.get(at..).and_then(|rest| rest.first_chunk()) {
        // What is a digit becomes 0 to 9, anything else more.
        let word = u64::from_le_bytes(*word) ^ 0x3030_3030_3030_3030;
        let beyond_9 = (word | word.wrapping_add(0x7676_7676_7676_7676)) & 0x8080_8080_8080_8080;
        let count = beyond_9.trailing_zeros() as usize / 8;
        let Some(power) = TENS.get(count) else {
            *mantissa = mantissa
                .wrapping_mul(100_000_000)
                .wrapping_add(eight_digits(word));
            at += 8;
            continue;
        };
        // Less than eight: behind as many zeros as there are other bytes.
        let word = (word << 8) << (56 - 8 * count);
        *mantissa = mantissa
            .wrapping_mul(*power)
            .wrapping_add(eight_digits(word));
        return at + count;
    }
    digits(bytes, at, mantissa)
}

/// The number whose digits these bytes are, the first in the lowest: joined to two digits each, four each, all
/// eight, all pairs at once.
#[inline]
fn eight_digits(word: u64) -> u64 {
    let twos = (word * 10 + (word >> 8)) & 0x00ff_00ff_00ff_00ff;
    let fours = (twos * 100 + (twos >> 16)) & 0x0000_ffff_0000_ffff;
    (fours * 10_000 + (fours >> 32)) & 0xffff_ffff
}

/// The signed exponent at `at` and where it ends; sizes beyond any double are kept bounded.
fn exponent_at(bytes: &[u8], mut at: usize) -> Option<(i64, usize)> {
    let negative = bytes.get(at) == Some(&b'-');
    at += usize::from(negative || bytes.get(at) == Some(&b'+'));
    let from = at;
    let mut size = 0i64;
    while let Some(digit @ b'0'..=b'9') = bytes.get(at) {
        size = (size * 10 + i64::from(digit - b'0')).min(1_000_000);
        at += 1;
    }
    (at > from).then_some((if negative { -size } else { size }, at))
}

#[cold]
fn by_library(bytes: &[u8], length: usize) -> Option<(f64, usize)> {
    let value = std::str::from_utf8(&bytes[..length]).ok()?.parse().ok()?;
    Some((value, length))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(text: &str) {
        let expected: f64 = text.parse().unwrap();
        let got = parse(text.as_bytes()).unwrap_or_else(|| panic!("{text} not parsed"));
        assert_eq!(got.to_bits(), expected.to_bits(), "{text}: {got:e}");
        let (prefix, length) = parse_prefix(format!("{text},9").as_bytes()).unwrap();
        assert_eq!((prefix.to_bits(), length), (expected.to_bits(), text.len()));
    }

    /// SplitMix64: any seed gives a full-period stream.
    fn next(state: &mut u64) -> u64 {
        *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = *state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    #[test]
    fn equals_the_standard_library_bit_for_bit() {
        let mut state = 1;
        for _ in 0..200_000 {
            let any = f64::from_bits(next(&mut state));
            if any.is_finite() {
                check(&format!("{any}"));
                check(&format!("{any:e}"));
            }
            let decimals = (next(&mut state) % 20) as usize;
            let plain =
                (next(&mut state) as i64 as f64) / 10f64.powi((next(&mut state) % 18) as i32);
            check(&format!("{plain:.decimals$}"));
            // The fast way and its borders: up to 18 digits, exponents about ±22.
            let digits = next(&mut state) % 10u64.pow((next(&mut state) % 19) as u32);
            let exponent = (next(&mut state) % 60) as i64 - 30;
            check(&format!("-{digits}e{exponent}"));
        }
    }

    /// Where the digits end and what they are does not depend on the bytes around them.
    #[test]
    fn eight_bytes_at_a_time_agree_with_one_at_a_time() {
        let mut state = 3;
        for _ in 0..200_000 {
            let any = next(&mut state).to_le_bytes();
            let mut bytes = [b'0'; 20];
            for (k, byte) in bytes.iter_mut().enumerate() {
                let random = next(&mut state);
                *byte = match random % 16 {
                    0 => any[k % 8],
                    1 => b"./:,\r\0"[(random >> 8) as usize % 6],
                    _ => b'0' + (random >> 8) as u8 % 10,
                };
            }
            let bytes = &bytes[..next(&mut state) as usize % 21];
            let [mut one, mut eight] = [7; 2];
            let ends = [
                digits(bytes, 0, &mut one),
                many_digits(bytes, 0, &mut eight),
            ];
            assert_eq!((ends[0], one), (ends[1], eight), "{bytes:?}");
        }
    }

    #[test]
    fn borders() {
        for text in [
            "0",
            "-0",
            "+1",
            "1.",
            ".5",
            "-.5e-3",
            "9007199254740992",
            "9007199254740993",
            "9007199254740991e22",
            "1e23",
            "18446744073709551616",
            "99999999999999999999",
            "1E+5",
            "0e999999999999",
            "1e-400",
            "1e400",
            "00000000000000000000000001.5",
            "4.9e-324",
            "2.2250738585072011e-308",
            "179769313486231580793728971405303415e274",
        ] {
            check(text);
        }
    }

    #[test]
    fn what_is_no_number() {
        for text in [
            "", "-", ".", "e5", "1e", "1e+", "abc", "1.2.3", "0x10", "1,5", " 1", "--1",
        ] {
            assert!(text.parse::<f64>().is_err());
            assert_eq!(parse(text.as_bytes()), None, "{text}");
        }
        assert!(parse(b"NaN").unwrap().is_nan());
        assert_eq!(parse(b"-inf"), Some(f64::NEG_INFINITY));
        assert_eq!(parse(&[0xff, 0xfe]), None);
        assert_eq!(parse_with_comma(b"1,5"), Some(1.5));
        assert_eq!(parse_with_comma(b"-1.5"), Some(-1.5));
        for text in ["1,2,3", "1.2,3", ",", ""] {
            assert_eq!(parse_with_comma(text.as_bytes()), None, "{text}");
        }
    }
}
