//! Numbers as text.

use undrift_results::{Number, Numbers};

/// A number with three significant digits; a dash if it is not finite.
pub fn short(value: f64) -> String {
    match value.abs() {
        v if !v.is_finite() => "–".into(),
        0.0 => "0".into(),
        v if v < 9.995e-4 => format!("{value:.2e}"),
        v if v < 9.995e-3 => format!("{value:.5}"),
        v if v < 0.099_95 => format!("{value:.4}"),
        v if v < 0.9995 => format!("{value:.3}"),
        v if v < 9.995 => format!("{value:.2}"),
        v if v < 99.95 => format!("{value:.1}"),
        v if v < 9999.5 => format!("{value:.0}"),
        v if v < 999_500.0 => {
            let step = if v < 99_950.0 { 100.0 } else { 1000.0 };
            let sign = if value < 0.0 { "-" } else { "" };
            format!("{sign}{}", count(((v / step).round() * step) as u64))
        }
        _ => format!("{value:.2e}"),
    }
}

/// A number with seven significant digits, as it is where those are not enough to write it plain.
pub fn exact(value: f64) -> String {
    if !value.is_finite() {
        return "–".into();
    }
    let size = value.abs().log10().floor();
    if (-4.0..6.0).contains(&size) {
        format!("{value:.*}", (6.0 - size) as usize)
    } else {
        format!("{value:.6e}")
    }
}

/// A share in percent.
pub fn percent(share: Number) -> String {
    (share.get()).map_or("–".into(), |share| format!("{:.1} %", 100.0 * share))
}

/// A correlation, and what it stays below by chance.
pub fn bounded(correlation: Number, bound: Number) -> String {
    let text = |r: f64| format!("{r:.2} (±{:.2})", bound.0);
    correlation.get().map_or("–".into(), text)
}

/// A span of time \[s\] in the unit that suits it.
pub fn span(seconds: f64) -> String {
    match seconds {
        s if !s.is_finite() => "–".into(),
        s if s < 600.0 => format!("{s:.0} s"),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

/// A count with its thousands apart.
pub fn count(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

/// A standard error, with two significant digits.
pub fn error(value: f64) -> String {
    match value.abs() {
        v if !v.is_finite() => "–".into(),
        0.0 => "0".into(),
        v if v < 9.95e-5 => format!("{value:.1e}"),
        v if v < 9.95 => {
            let digits = (1.0 - v.log10().floor()).clamp(0.0, 6.0) as usize;
            format!("{value:.digits$}")
        }
        _ => short(value),
    }
}

/// A probability; very small ones as such.
pub fn probability(p: f64) -> String {
    if p < 1e-4 {
        "< 0.0001".into()
    } else {
        short(p)
    }
}

/// A number of a map; NaN where it has none.
pub fn get(numbers: &Numbers, name: &str) -> f64 {
    numbers.get(name).map_or(f64::NAN, |n| n.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_as_text() {
        for (value, text) in [
            (0.0, "0"),
            (0.000_123_4, "1.23e-4"),
            (-0.123_4, "-0.123"),
            (0.012_34, "0.0123"),
            (0.001_234, "0.00123"),
            (1.234, "1.23"),
            (99.99, "100"),
            (12_345.6, "12\u{202f}300"),
            (-232_966.0, "-233\u{202f}000"),
            (9_999.0, "9999"),
            (f64::NAN, "–"),
        ] {
            assert_eq!(short(value), text);
        }
        for (value, text) in [
            (3.432_190_9, "3.432191"),
            (0.0, "0.000000e0"),
            (1e-7, "1.000000e-7"),
        ] {
            assert_eq!(exact(value), text);
        }
        assert_eq!(count(1_234_567), "1\u{202f}234\u{202f}567");
        assert_eq!(count(123), "123");
        assert_eq!(span(3600.0), "60 min");
    }

    #[test]
    fn errors_have_two_digits() {
        for (value, text) in [
            (0.001_04, "0.0010"),
            (0.0944, "0.094"),
            (0.105, "0.10"),
            (4.16e-4, "0.00042"),
            (1.5, "1.5"),
            (198.3, "198"),
            (1e-7, "1.0e-7"),
        ] {
            assert_eq!(error(value), text);
        }
        assert_eq!(probability(7e-297), "< 0.0001");
        assert_eq!(probability(0.91), "0.910");
    }
    #[test]
    fn a_number_that_rounds_up_to_the_next_size_is_of_that() {
        for (value, text) in [
            (9.994e-4, "9.99e-4"),
            (9.996e-4, "0.00100"),
            (9.994e-3, "0.00999"),
            (9.996e-3, "0.0100"),
            (0.099_94, "0.0999"),
            (0.099_96, "0.100"),
            (0.9994, "0.999"),
            (0.9996, "1.00"),
            (9.994, "9.99"),
            (9.996, "10.0"),
            (99.94, "99.9"),
            (99.96, "100"),
            (9_999.4, "9999"),
            (9_999.6, "10\u{202f}000"),
            (99_940.0, "99\u{202f}900"),
            (99_960.0, "100\u{202f}000"),
            (123_456.0, "123\u{202f}000"),
            (999_400.0, "999\u{202f}000"),
            (999_600.0, "1.00e6"),
            (-1e7, "-1.00e7"),
            (f64::INFINITY, "–"),
        ] {
            assert_eq!(short(value), text);
        }
        for (value, text) in [
            (123_456.7, "123456.7"),
            (1_234_567.8, "1.234568e6"),
            (1.5e-4, "0.0001500000"),
            (9e-5, "9.000000e-5"),
            (f64::INFINITY, "–"),
        ] {
            assert_eq!(exact(value), text);
        }
        for (value, text) in [
            (9.94e-5, "9.9e-5"),
            (9.96e-5, "0.000100"),
            (9.94, "9.9"),
            (9.96, "9.96"),
            (-0.5, "-0.50"),
            (0.0, "0"),
            (f64::NAN, "–"),
        ] {
            assert_eq!(error(value), text);
        }
    }

    #[test]
    fn spans_shares_and_bounds_have_their_units() {
        for (seconds, text) in [
            (599.4, "599 s"),
            (600.0, "10 min"),
            (7199.0, "120 min"),
            (7200.0, "2.0 h"),
            (f64::NAN, "–"),
        ] {
            assert_eq!(span(seconds), text);
        }
        assert_eq!(percent(0.1234.into()), "12.3 %");
        assert_eq!(percent(Number::default()), "–");
        assert_eq!(bounded(0.256.into(), 0.05.into()), "0.26 (±0.05)");
        assert_eq!(bounded(Number::default(), 0.05.into()), "–");
        assert_eq!(
            [probability(1e-4), probability(9e-5)],
            ["1.00e-4", "< 0.0001"]
        );
        assert_eq!(count(1000), "1\u{202f}000");
        assert_eq!([count(0), count(999)], ["0", "999"]);
        let numbers = Numbers::from([("a".to_owned(), 2.0.into())]);
        assert!(get(&numbers, "a") == 2.0 && get(&numbers, "b").is_nan());
    }

    #[test]
    fn half_of_the_last_digit_is_rounded_up_to_the_next_size() {
        for (value, text) in [
            (9.995e-4, "0.00100"),
            (9.995e-3, "0.0100"),
            (0.099_95, "0.100"),
            (0.9995, "1.00"),
            (9.995, "10.0"),
            (99.95, "100"),
            (9_999.5, "10\u{202f}000"),
            (99_950.0, "100\u{202f}000"),
            (-9.995, "-10.0"),
        ] {
            assert_eq!(short(value), text);
        }
    }
}
