//! Unit expressions: symbols, products, quotients, powers and square roots, with their dimension.
//!
//! ```text
//! product  = power { ("*" | "·" | "⋅" | "/" | nothing) power }        from left to right: a/b c is (a/b)·c
//! power    = factor [ ("^" | "**") exponent | superscript              m/s^2, m/s**2, m/s²
//!                   | "2" | "3" | "-1" | "-2" | "-3" without a space ]  m/s2, m s-2
//! factor   = "(" product ")" | "√" factor | ("sqrt" | "rt") ["-"] factor | number | symbol
//! exponent = number | "(" number [ "/" number ] ")"                    halves at most: ^0.5, ^(1/2)
//! ```
//!
//! Exponents are kept doubled, so that a root of a dimension is a whole number; a fourth root is refused.
//! Depth, exponents and lengths are bounded: whatever the text, reading ends.

use super::{UnitErrorKind, Word};
use crate::earth::STANDARD_GRAVITY;
use core::f64::consts::{PI, TAU};

/// Twice the exponents of time, length, angle, temperature and magnetic flux density.
pub(super) type Dimension = [i32; 5];

/// Reads a whole unit. Numbers belong to raw counts alone: `5 deg/s` is no unit, `LSB/131 deg/s` is one.
pub(super) fn read(unit: &str) -> Result<Unit, UnitErrorKind> {
    let mut reader = Reader {
        rest: unit,
        number: None,
    };
    let value = reader.product(0)?;
    reader.skip_space();
    match reader.number {
        _ if !reader.rest.is_empty() => Err(reader.malformed()),
        Some(number) if value.counts == 0 => Err(UnitErrorKind::Malformed(number)),
        _ => Ok(value),
    }
}

/// Bytes of the decimal number that `text` starts with.
///
/// Sign, digits, point, digits, and an exponent that has digits: `2e` is the number 2 before a unit `e`.
pub(super) fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits_from = |from: usize| {
        bytes[from..]
            .iter()
            .take_while(|b| b.is_ascii_digit())
            .count()
    };
    let mut end = usize::from(matches!(bytes.first(), Some(b'+' | b'-')));
    end += digits_from(end);
    if bytes.get(end) == Some(&b'.') {
        end += 1 + digits_from(end + 1);
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let exponent = digits_from((end + 1 + sign).min(bytes.len()));
        if exponent > 0 {
            end += 1 + sign + exponent;
        }
    }
    end
}

/// A unit: its factor to SI and its dimension.
#[derive(Clone, Copy)]
pub(super) struct Unit {
    pub(super) factor: f64,
    pub(super) dimension: Dimension,
    /// Twice the exponent of raw counts.
    pub(super) counts: i32,
}

impl Unit {
    /// The unit to the power `halves / 2`; `None` if an exponent would be a quarter or absurdly large.
    fn power(self, halves: i32) -> Option<Self> {
        let scaled = |exponent: i32| {
            let scaled = exponent.checked_mul(halves)?;
            (scaled % 2 == 0 && scaled.abs() <= 64).then_some(scaled / 2)
        };
        let mut dimension = self.dimension;
        for exponent in &mut dimension {
            *exponent = scaled(*exponent)?;
        }
        let counts = scaled(self.counts)?;
        let base = if halves % 2 == 0 {
            self.factor
        } else {
            libm::sqrt(self.factor)
        };
        let count = if halves % 2 == 0 { halves / 2 } else { halves };
        let mut factor = 1.0;
        for _ in 0..count.unsigned_abs() {
            factor *= base;
        }
        Some(Self {
            factor: if count < 0 { 1.0 / factor } else { factor },
            dimension,
            counts,
        })
    }

    /// The product, or with `sign` −1 the quotient.
    fn times(self, other: Self, sign: i32) -> Self {
        let mut dimension = self.dimension;
        for (mine, theirs) in dimension.iter_mut().zip(other.dimension) {
            *mine = mine.saturating_add(sign * theirs);
        }
        let factor = if sign < 0 {
            self.factor / other.factor
        } else {
            self.factor * other.factor
        };
        Self {
            factor,
            dimension,
            counts: self.counts.saturating_add(sign * other.counts),
        }
    }
}

/// Parentheses and roots deeper than this are refused.
const MAX_DEPTH: usize = 8;

struct Reader<'a> {
    rest: &'a str,
    /// The first number that is not 1 and no exponent.
    number: Option<Word>,
}

impl Reader<'_> {
    fn skip_space(&mut self) {
        self.rest = self.rest.trim_start();
    }

    /// Takes a symbol behind spaces, if it is next.
    fn take(&mut self, symbol: &str) -> bool {
        self.skip_space();
        match self.rest.strip_prefix(symbol) {
            Some(rest) => {
                self.rest = rest;
                true
            }
            None => false,
        }
    }

    fn malformed(&self) -> UnitErrorKind {
        UnitErrorKind::Malformed(Word::new(self.rest))
    }

    /// power { ("*" | "·" | "/" | nothing) power }, from left to right.
    fn product(&mut self, depth: usize) -> Result<Unit, UnitErrorKind> {
        if depth > MAX_DEPTH {
            return Err(self.malformed());
        }
        let mut value = self.power(depth)?;
        loop {
            let sign = if self.take("/") { -1 } else { 1 };
            if sign > 0 && !["*", "·", "⋅"].iter().any(|times| self.take(times)) {
                self.skip_space();
                if self.rest.is_empty() || self.rest.starts_with(')') {
                    return Ok(value);
                }
            }
            value = value.times(self.power(depth)?, sign);
        }
    }

    /// factor [ "^" exponent | superscript | exponent without a space, as in `m/s2` and `m s-2` ].
    fn power(&mut self, depth: usize) -> Result<Unit, UnitErrorKind> {
        let base = self.factor(depth)?;
        let superscripts = [
            ("⁻¹", -2),
            ("⁻²", -4),
            ("⁻³", -6),
            ("²", 4),
            ("³", 6),
            ("½", 1),
        ];
        let adjacent = number_length(self.rest);
        let halves = if let Some(halves) = [("2", 4), ("3", 6), ("-1", -2), ("-2", -4), ("-3", -6)]
            .iter()
            .find_map(|(digits, halves)| (self.rest[..adjacent] == **digits).then_some(*halves))
        {
            self.rest = &self.rest[adjacent..];
            halves
        } else if self.take("^") || self.take("**") {
            self.exponent()?
        } else if let Some((_, halves)) = superscripts.iter().find(|(s, _)| self.take(s)) {
            *halves
        } else {
            return Ok(base);
        };
        base.power(halves).ok_or_else(|| self.malformed())
    }

    /// Twice the exponent: `2`, `-1`, `0.5`, `1.5`, or in parentheses `(3/2)`.
    fn exponent(&mut self) -> Result<i32, UnitErrorKind> {
        let parenthesis = self.take("(");
        let mut value = self.number()?;
        if parenthesis {
            if self.take("/") {
                value /= self.number()?;
            }
            if !self.take(")") {
                return Err(self.malformed());
            }
        }
        let halves = 2.0 * value;
        if libm::floor(halves) == halves && halves.abs() <= 16.0 {
            Ok(halves as i32)
        } else {
            Err(self.malformed())
        }
    }

    fn number(&mut self) -> Result<f64, UnitErrorKind> {
        self.skip_space();
        let (number, rest) = self.rest.split_at(number_length(self.rest));
        let value = number.parse().map_err(|_| self.malformed())?;
        self.rest = rest;
        Ok(value)
    }

    /// A parenthesis, a root, a number, or a symbol.
    fn factor(&mut self, depth: usize) -> Result<Unit, UnitErrorKind> {
        if self.take("(") {
            let inside = self.product(depth + 1)?;
            return if self.take(")") {
                Ok(inside)
            } else {
                Err(self.malformed())
            };
        }
        if self.take("√") {
            return self.root(depth);
        }
        self.skip_space();
        if self.rest.starts_with(|c: char| c.is_ascii_digit()) {
            let word = Word::new(self.rest);
            let factor = self.number()?;
            if factor != 1.0 {
                self.number.get_or_insert(word);
            }
            return Ok(Unit {
                factor,
                dimension: [0; 5],
                counts: 0,
            });
        }
        let length = self
            .rest
            .char_indices()
            .find(|(_, c)| !(c.is_alphabetic() || matches!(c, '°' | 'º' | '%' | '\'' | '"')))
            .map_or(self.rest.len(), |(at, _)| at);
        let word = &self.rest[..length];
        if word.is_empty() {
            return Err(self.malformed());
        }
        if let Some(unit) = symbol(word) {
            self.rest = &self.rest[length..];
            return Ok(unit);
        }
        for prefix in ["sqrt", "rt"] {
            if let Some(rest) = self.rest.strip_prefix(prefix)
                && (length == prefix.len() || symbol(&word[prefix.len()..]).is_some())
            {
                self.rest = rest.strip_prefix('-').unwrap_or(rest);
                return self.root(depth);
            }
        }
        Err(UnitErrorKind::UnknownUnit(Word::new(word)))
    }

    /// The root of one factor: `√Hz`, `sqrt(Hz)`; of `√Hz s` only Hz is under it.
    fn root(&mut self, depth: usize) -> Result<Unit, UnitErrorKind> {
        if depth >= MAX_DEPTH {
            return Err(self.malformed());
        }
        let under = self.factor(depth + 1)?;
        under.power(1).ok_or_else(|| self.malformed())
    }
}

const TIME: Dimension = [2, 0, 0, 0, 0];
const FREQUENCY: Dimension = [-2, 0, 0, 0, 0];
const LENGTH: Dimension = [0, 2, 0, 0, 0];
const ANGLE: Dimension = [0, 0, 2, 0, 0];
const RATE: Dimension = [-2, 0, 2, 0, 0];
const ACCELERATION: Dimension = [-4, 2, 0, 0, 0];
const VELOCITY: Dimension = [-2, 2, 0, 0, 0];
const TEMPERATURE: Dimension = [0, 0, 0, 2, 0];
const FIELD: Dimension = [0, 0, 0, 0, 2];
const DEG: f64 = PI / 180.0;

/// Symbols with their prefix, their factor to SI and dimension. `m` is the metre, `h` the hour, `g` standard gravity; a
/// degree Celsius is a kelvin: temperatures are differences.
pub(super) const SYMBOLS: [(&[&str], f64, Dimension); 50] = [
    (&["s", "sec", "secs", "second", "seconds"], 1.0, TIME),
    (&["ms", "msec"], 1e-3, TIME),
    (&["us", "µs", "μs", "usec"], 1e-6, TIME),
    (&["ns", "nsec"], 1e-9, TIME),
    (&["min", "minute", "minutes"], 60.0, TIME),
    (&["h", "hr", "hrs", "hour", "hours"], 3600.0, TIME),
    (&["d", "day", "days"], 86_400.0, TIME),
    (&["Hz", "hz"], 1.0, FREQUENCY),
    (&["mHz"], 1e-3, FREQUENCY),
    (&["kHz", "khz"], 1e3, FREQUENCY),
    (&["MHz"], 1e6, FREQUENCY),
    (&["m", "metre", "metres", "meter", "meters"], 1.0, LENGTH),
    (&["mm"], 1e-3, LENGTH),
    (&["cm"], 1e-2, LENGTH),
    (&["km"], 1e3, LENGTH),
    (&["ft", "feet"], 0.3048, LENGTH),
    (&["rad", "radian", "radians"], 1.0, ANGLE),
    (&["mrad"], 1e-3, ANGLE),
    (&["urad", "µrad", "μrad"], 1e-6, ANGLE),
    (&["deg", "degs", "degree", "degrees", "°", "º"], DEG, ANGLE),
    (&["mdeg"], 1e-3 * DEG, ANGLE),
    (&["arcmin"], DEG / 60.0, ANGLE),
    (&["arcsec", "asec"], DEG / 3600.0, ANGLE),
    (&["rev", "turn"], TAU, ANGLE),
    (&["dps"], DEG, RATE),
    (&["mdps"], 1e-3 * DEG, RATE),
    (&["udps", "µdps", "μdps"], 1e-6 * DEG, RATE),
    (&["dph"], DEG / 3600.0, RATE),
    (&["rpm"], TAU / 60.0, RATE),
    (&["g"], STANDARD_GRAVITY, ACCELERATION),
    (&["mg"], 1e-3 * STANDARD_GRAVITY, ACCELERATION),
    (&["ug", "µg", "μg"], 1e-6 * STANDARD_GRAVITY, ACCELERATION),
    (&["ng"], 1e-9 * STANDARD_GRAVITY, ACCELERATION),
    (&["Gal"], 1e-2, ACCELERATION),
    (&["mGal"], 1e-5, ACCELERATION),
    (&["uGal", "µGal", "μGal"], 1e-8, ACCELERATION),
    (&["mps"], 1.0, VELOCITY),
    (&["kmh", "kph"], 1.0 / 3.6, VELOCITY),
    (&["mph"], 0.44704, VELOCITY),
    (
        &["kn", "kt", "kts", "knot", "knots"],
        1852.0 / 3600.0,
        VELOCITY,
    ),
    (&["K", "kelvin", "degC", "°C", "celsius"], 1.0, TEMPERATURE),
    (&["mK"], 1e-3, TEMPERATURE),
    (&["T", "tesla"], 1.0, FIELD),
    (&["mT"], 1e-3, FIELD),
    (&["uT", "µT", "μT"], 1e-6, FIELD),
    (&["nT"], 1e-9, FIELD),
    (&["G", "Gs", "gauss", "Gauss"], 1e-4, FIELD),
    (&["mG", "mGs", "mgauss", "mGauss"], 1e-7, FIELD),
    (&["%"], 1e-2, [0; 5]),
    (&["ppm"], 1e-6, [0; 5]),
];

/// One symbol, raw counts among them.
fn symbol(word: &str) -> Option<Unit> {
    let unit = |factor, dimension, counts| Unit {
        factor,
        dimension,
        counts,
    };
    if matches!(word, "LSB" | "lsb" | "counts") {
        return Some(unit(1.0, [0; 5], 2));
    }
    let (_, factor, dimension) = SYMBOLS.iter().find(|(names, ..)| names.contains(&word))?;
    Some(unit(*factor, *dimension, 0))
}
