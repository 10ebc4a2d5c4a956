//! Numbers as text.

use undrift::results::{Number, Numbers};

/// A number with three significant digits; a dash where there is none.
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
}
