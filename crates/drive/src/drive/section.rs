//! Access to one table of a TOML file, with errors that name file, line, key and what was expected.

use super::error::{ConfigError, DriveError};
use std::{
    cell::RefCell,
    io::{ErrorKind, Read},
    path::Path,
};
use toml::{
    Spanned,
    de::{DeTable, DeValue},
};
use undrift_io::{
    foreign::{self, Foreign},
    nearby,
    table::Column,
};
use undrift_nav::{
    Vector3,
    units::{self, Quantity},
};
use undrift_noise::{ImuModel, ModelError};

#[cfg(test)]
#[path = "../../../../tools/schema/page.rs"]
pub(crate) mod page;
#[cfg(test)]
use page::Takes;

/// The unit of latitudes and longitudes that are degrees times 100 and minutes, as NMEA has them.
pub(crate) const DEGREES_MINUTES: &str = "ddmm.mmmm";

/// One table of a file; remembers which keys were asked for, so that the others can be refused.
pub struct Section<'a> {
    table: Option<&'a DeTable<'a>>,
    text: &'a str,
    file: &'a str,
    path: &'a str,
    line: Option<usize>,
    asked: RefCell<Vec<&'a str>>,
}

/// Line of a byte offset, from 1.
pub fn line_at(text: &str, offset: usize) -> usize {
    text.as_bytes()
        .iter()
        .take(offset)
        .filter(|&&b| b == b'\n')
        .count()
        + 1
}

/// The text of a configuration file and what messages call it.
///
/// # Errors
/// A file that cannot be read, is too large or no text.
pub fn read_text(path: &Path) -> Result<(String, String), ConfigError> {
    let file = path.display().to_string();
    text_of(path)
        .map(|text| (text, file.clone()))
        .map_err(|message| ConfigError {
            file,
            line: None,
            key: String::new(),
            message,
        })
}

/// Size of a configuration file at most \[bytes\]: a manifest of 100 000 logs has some 10 MB.
const MOST: u64 = 16 << 20;

fn text_of(path: &Path) -> Result<String, String> {
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path);
    let read = file.and_then(|file| file.take(MOST + 1).read_to_end(&mut bytes));
    match read.map_err(|error| (error.kind(), error)) {
        Err((ErrorKind::NotFound, _)) => {
            let names = undrift_io::nearby::names(path).map(|names| format!("; {names}"));
            return Err(format!("no such file{}", names.unwrap_or_default()));
        }
        Err((ErrorKind::IsADirectory, _)) => return Err(format!("is a folder; {EXPECTED}")),
        Err((_, error)) => return Err(format!("cannot be read: {error}")),
        Ok(_) => {}
    }
    match foreign::known(&bytes) {
        Some(Foreign {
            what: "a model file",
            ..
        }) => {
            return Err(format!(
                "is a model file, not a drive file; give the drive file here, and the model with --model {}",
                path.display()
            ));
        }
        Some(Foreign { what, .. }) if what != "a drive file" => {
            return Err(format!("is {what}; {EXPECTED}"));
        }
        _ if bytes.len() as u64 > MOST => {
            return Err(format!("is larger than {} MB; {EXPECTED}", MOST >> 20));
        }
        _ => {}
    }
    let text = String::from_utf8(bytes).map_err(|_| format!("is not UTF-8 text; {EXPECTED}"))?;
    if is_table(&text) {
        return Err(format!(
            "is a log, not a drive file; `undrift inspect {} -o drive.toml` writes one",
            path.display()
        ));
    }
    Ok(text)
}

/// Whether a text begins as a table of numbers does.
fn is_table(text: &str) -> bool {
    let is_number = |field: &str| field.trim().parse::<f64>().is_ok();
    let is_row = |line: &str| {
        let mut fields = line.split([',', ';', '\t']);
        let (first, second) = (fields.next(), fields.next());
        first.is_some_and(is_number) && second.is_some_and(is_number)
    };
    let mut lines = text.lines().filter(|line| !line.starts_with(['#', '%']));
    let first = lines.next().unwrap_or_default();
    !first.contains(['=', '[']) && (is_row(first) || lines.next().is_some_and(is_row))
}

/// What is expected of a file that is none of configuration.
const EXPECTED: &str =
    "expected TOML, such as the drive file that `undrift inspect LOG -o drive.toml` writes";

/// What the parser of TOML refuses, with the remedy of common mistakes.
fn not_toml(text: &str, error: &toml::de::Error) -> String {
    let start = error.span().map_or(0, |span| span.start);
    let line = text
        .lines()
        .nth(line_at(text, start) - 1)
        .unwrap_or_default();
    let value = line.split_once('=').map_or("", |(_, value)| value.trim());
    match error.message() {
        _ if !line.contains(['=', '[']) => format!("not TOML; {EXPECTED}"),
        _ if value.contains('\\') => {
            "a backslash starts an escape sequence; write paths with / or between single quotes"
                .into()
        }
        _ if value.starts_with(char::is_alphabetic) => {
            let text = value.split(" #").next().unwrap_or(value).trim();
            format!("text needs quotes: write \"{text}\"")
        }
        "duplicate key" => already(text, start),
        message => format!("not TOML: {message}"),
    }
}

/// That what stands at an offset was there before: a table, or a key.
fn already(text: &str, start: usize) -> String {
    let here = line_at(text, start);
    let lines = || text.lines().map(str::trim).zip(1..).take(here - 1);
    let line = text.lines().nth(here - 1).unwrap_or_default().trim();
    let stands = |line: &str| {
        line.split(['=', '#'])
            .next()
            .unwrap_or_default()
            .trim()
            .to_owned()
    };
    let what = stands(line);
    // A key is of the table above it.
    let table = lines().filter(|(line, _)| line.starts_with('[')).last();
    let from = match (what.starts_with('['), table) {
        (false, Some((_, at))) => at,
        _ => 0,
    };
    let before = lines().skip(from).find(|(line, _)| stands(line) == what);
    match before {
        Some((_, at)) => format!("{what} is already defined at line {at}; merge the two"),
        None => format!("{what} is defined twice; merge the two"),
    }
}

/// The unit that lacks its stroke: "deg/s" of "degs".
fn per_second(unit: &str, quantity: Quantity) -> Option<String> {
    let meant = format!("{}/s", unit.strip_suffix('s')?);
    units::unit_factor(&meant, quantity).ok().map(|_| meant)
}

/// The tables of a configuration file's text; `file` is what messages call it.
///
/// # Errors
/// Text that is not TOML, with its line.
pub fn parse<'a>(text: &'a str, file: &str) -> Result<Spanned<DeTable<'a>>, ConfigError> {
    DeTable::parse(text).map_err(|e| ConfigError {
        file: file.to_owned(),
        line: e.span().map(|s| line_at(text, s.start)),
        key: String::new(),
        message: not_toml(text, &e),
    })
}

impl<'a> Section<'a> {
    /// The top of a file.
    pub fn top(table: &'a DeTable<'a>, text: &'a str, file: &'a str) -> Self {
        Self {
            table: Some(table),
            text,
            file,
            path: "",
            line: None,
            asked: RefCell::default(),
        }
    }

    /// A sub-table; an absent one has no keys.
    ///
    /// # Errors
    /// If the value is no table.
    pub fn section(&self, key: &'a str) -> Result<Section<'a>, ConfigError> {
        #[cfg(test)]
        self.note(key, Takes::Table);
        let mut section = Section {
            table: None,
            text: self.text,
            file: self.file,
            path: key,
            line: None,
            asked: RefCell::default(),
        };
        if let Some((value, line)) = self.get(key) {
            section.line = Some(line);
            section.table = match value {
                DeValue::Table(table) => Some(table),
                _ => return Err(self.error(key, "must be a table")),
            };
        }
        Ok(section)
    }

    /// The tables of a list, `[[key]]`; none where it is absent.
    ///
    /// # Errors
    /// If the value is no list of tables.
    pub fn sections(&self, key: &'a str) -> Result<Vec<Section<'a>>, ConfigError> {
        let wrong = || self.error(key, format!("must be tables: write [[{key}]]"));
        let Some((value, _)) = self.get(key) else {
            return Ok(Vec::new());
        };
        let DeValue::Array(items) = value else {
            return Err(wrong());
        };
        let section = |item: &'a Spanned<DeValue<'a>>| match item.get_ref() {
            DeValue::Table(table) => Ok(Section {
                table: Some(table),
                text: self.text,
                file: self.file,
                path: key,
                line: Some(line_at(self.text, item.span().start)),
                asked: RefCell::default(),
            }),
            _ => Err(wrong()),
        };
        items.iter().map(section).collect()
    }

    /// Whether the table is there.
    pub fn exists(&self) -> bool {
        self.table.is_some()
    }

    /// The keys, in the order of the alphabet.
    pub fn keys(&self) -> Vec<&'a str> {
        let keys = self.table.into_iter().flat_map(|table| table.keys());
        keys.map(|key| key.get_ref().as_ref()).collect()
    }

    /// The value of a key and its line.
    pub fn get(&self, key: &'a str) -> Option<(&'a DeValue<'a>, usize)> {
        self.asked.borrow_mut().push(key);
        let (name, value) = self
            .table?
            .iter()
            .find(|(k, _)| k.get_ref().as_ref() == key)?;
        Some((value.get_ref(), line_at(self.text, name.span().start)))
    }

    fn dotted(&self, key: &str) -> String {
        if self.path.is_empty() {
            key.to_owned()
        } else {
            format!("{}.{key}", self.path)
        }
    }

    /// An error at a key of this table; of a key that is missing it shows one that is there and nearly so called.
    pub fn error(&self, key: &str, message: impl Into<String>) -> ConfigError {
        let message = message.into();
        if message.starts_with("missing")
            && let Some(there) = self.nearly(key)
        {
            return self.error(there, format!("unknown key; did you mean {key}?"));
        }
        let found = self
            .table
            .and_then(|t| t.iter().find(|(k, _)| k.get_ref().as_ref() == key));
        ConfigError {
            file: self.file.to_owned(),
            line: found
                .map(|(k, _)| line_at(self.text, k.span().start))
                .or(self.line),
            key: self.dotted(key),
            message,
        }
    }

    /// A key that is there, was not asked for and is nearly so called.
    fn nearly(&self, key: &str) -> Option<&'a str> {
        let asked = self.asked.borrow();
        let mut keys = self.table?.keys().map(|there| there.get_ref().as_ref());
        keys.find(|there| !asked.contains(there) && nearby::misspelt(there, key))
    }

    /// Refuses keys that are not in `known`.
    ///
    /// # Errors
    /// If there is another key; the message names those known.
    pub fn only(&self, known: &[&'a str]) -> Result<(), ConfigError> {
        self.asked.borrow_mut().extend_from_slice(known);
        self.only_known()
    }

    /// Refuses keys that were never asked for.
    ///
    /// # Errors
    /// If there is such a key; the message names those known.
    pub fn only_known(&self) -> Result<(), ConfigError> {
        let asked = self.asked.borrow();
        let unknown = self
            .table
            .and_then(|t| t.keys().find(|k| !asked.contains(&k.get_ref().as_ref())));
        match unknown {
            None => Ok(()),
            Some(key) => {
                let mut known: Vec<&str> = asked.clone();
                known.sort_unstable();
                known.dedup();
                let near = nearby::known(key.get_ref(), known.iter().copied());
                let near = near.map_or(String::new(), |near| near + " ");
                Err(self.error(
                    key.get_ref(),
                    format!("unknown key; {near}known here: {}", known.join(", ")),
                ))
            }
        }
    }

    /// A string.
    ///
    /// # Errors
    /// If the value is no string.
    pub fn text(&self, key: &'a str) -> Result<Option<&'a str>, ConfigError> {
        #[cfg(test)]
        self.note(key, Takes::Text);
        self.string(key)
    }

    fn string(&self, key: &'a str) -> Result<Option<&'a str>, ConfigError> {
        match self.get(key) {
            None => Ok(None),
            Some((DeValue::String(s), _)) => Ok(Some(s.as_ref())),
            Some(_) => Err(self.error(key, "must be a string")),
        }
    }

    /// What a key takes, for the schema of the file.
    #[cfg(test)]
    pub(crate) fn note(&self, key: &str, takes: Takes) {
        page::note(self.path, key, takes);
    }

    /// A standard deviation, which may be a bare number where it has no unit.
    #[cfg(test)]
    pub(super) fn note_std(&self, key: &str, quantity: Quantity) {
        self.note(key, Takes::Quantity(quantity));
        if quantity == Quantity::Dimensionless {
            self.note(key, Takes::Positive);
        }
    }

    /// The name of a file, which must be there.
    ///
    /// # Errors
    /// If the key or its whole table is missing, or the value is no string or empty.
    pub fn file(&self, key: &'a str) -> Result<&'a str, ConfigError> {
        match self.text(key)? {
            Some(name) if !name.is_empty() => Ok(name),
            Some(_) => Err(self.error(key, "the file name is empty")),
            None if self.exists() => Err(self.error(key, "missing: the file name")),
            None => Err(self.error(
                key,
                format!(
                    "missing: add a [{}] table with file = \"NAME OF THE LOG\"",
                    self.path
                ),
            )),
        }
    }

    /// One of a few words.
    ///
    /// # Errors
    /// If the value is no string or none of `words`.
    pub fn word<T: Copy>(
        &self,
        key: &'a str,
        words: &[(&str, T)],
    ) -> Result<Option<T>, ConfigError> {
        #[cfg(test)]
        self.note(
            key,
            Takes::Words(words.iter().map(|(word, _)| (*word).into()).collect()),
        );
        let Some(text) = self.string(key)? else {
            return Ok(None);
        };
        self.one_of(key, text, words).map(Some)
    }

    fn one_of<T: Copy>(
        &self,
        key: &str,
        text: &str,
        words: &[(&str, T)],
    ) -> Result<T, ConfigError> {
        match words.iter().find(|(w, _)| *w == text) {
            Some((_, value)) => Ok(*value),
            None => {
                let known: Vec<String> = words.iter().map(|(w, _)| format!("\"{w}\"")).collect();
                Err(self.error(
                    key,
                    format!("\"{text}\" is not one of {}", known.join(", ")),
                ))
            }
        }
    }

    /// A list of one or more of a few words.
    ///
    /// # Errors
    /// If the value is no list, an empty one, or holds a word that is not in `words`.
    pub fn words<T: Copy>(
        &self,
        key: &'a str,
        words: &[(&str, T)],
    ) -> Result<Option<Vec<T>>, ConfigError> {
        #[cfg(test)]
        self.note(
            key,
            Takes::ListOf(words.iter().map(|(word, _)| (*word).into()).collect()),
        );
        let Some((value, _)) = self.get(key) else {
            return Ok(None);
        };
        let wrong = || {
            let first = words.first().map_or("", |(w, _)| w);
            self.error(
                key,
                format!("must be a list of words such as [\"{first}\"]"),
            )
        };
        let DeValue::Array(items) = value else {
            return Err(wrong());
        };
        if items.is_empty() {
            return Err(wrong());
        }
        let one = |item: &toml::Spanned<DeValue>| match item.get_ref() {
            DeValue::String(text) => self.one_of(key, text, words),
            _ => Err(wrong()),
        };
        items.iter().map(one).collect::<Result<_, _>>().map(Some)
    }

    /// A noise model: a preset, a file relative to `home`, or a table.
    ///
    /// # Errors
    /// If the value is not one of the three, there is no such preset or file, or the model cannot be read.
    pub fn model(&self, key: &'a str, home: &Path) -> Result<Option<ImuModel>, DriveError> {
        #[cfg(test)]
        self.note(key, Takes::Model);
        match self.get(key) {
            None => Ok(None),
            Some((DeValue::String(name), _)) => match ImuModel::resolve(name, home) {
                Ok(model) => Ok(Some(model)),
                // Not the model's fault but the name's.
                Err(e @ ModelError::Read { .. }) => Err(self.error(key, e.to_string()).into()),
                Err(other) => Err(other.into()),
            },
            Some((DeValue::Table(table), _)) => {
                let path = self.dotted(key);
                Ok(Some(ImuModel::from_spanned(
                    table, self.text, self.file, &path,
                )?))
            }
            Some(_) => Err(self
                .error(key, "must be a preset's name, a file, or a table")
                .into()),
        }
    }

    /// A whole number, not negative.
    ///
    /// # Errors
    /// If the value is no whole number, negative or beyond 64 bits.
    pub fn whole(&self, key: &'a str) -> Result<Option<u64>, ConfigError> {
        #[cfg(test)]
        self.note(key, Takes::Whole);
        let number = match self.get(key) {
            None => return Ok(None),
            Some((DeValue::Integer(x), _)) => x.as_str().replace('_', "").parse().ok(),
            Some(_) => None,
        };
        match number {
            Some(x) => Ok(Some(x)),
            None => Err(self.error(key, "must be a whole number, 0 or more")),
        }
    }

    /// A bare positive number.
    ///
    /// # Errors
    /// If the value is no number, not finite or not above zero.
    pub fn factor(&self, key: &'a str) -> Result<Option<f64>, ConfigError> {
        #[cfg(test)]
        self.note(key, Takes::Positive);
        let number = match self.get(key) {
            None => return Ok(None),
            Some((DeValue::Float(x), _)) => x.as_str().replace('_', "").parse().ok(),
            Some((DeValue::Integer(x), _)) => x.as_str().replace('_', "").parse().ok(),
            Some(_) => None,
        };
        match number.filter(|x: &f64| x.is_finite() && *x > 0.0) {
            Some(x) => Ok(Some(x)),
            None => Err(self.error(key, "must be a positive number")),
        }
    }

    /// A column by name or, as a person counts, by number.
    ///
    /// # Errors
    /// If the value is neither a string nor a whole number from 1 on.
    pub fn column(&self, key: &'a str) -> Result<Option<Column>, ConfigError> {
        #[cfg(test)]
        self.note(key, Takes::Column);
        self.get(key)
            .map(|(value, _)| self.column_of(key, value))
            .transpose()
    }

    fn column_of(&self, key: &str, value: &DeValue) -> Result<Column, ConfigError> {
        match value {
            DeValue::String(name) => Ok(Column::Name(name.to_string())),
            DeValue::Integer(number) => match number.as_str().parse::<usize>() {
                Ok(n) if n > 0 => Ok(Column::Number(n)),
                _ => Err(self.error(key, "columns are numbered from 1")),
            },
            _ => Err(self.error(key, "must be a column's name or number")),
        }
    }

    /// Three columns.
    ///
    /// # Errors
    /// If the value is no list of three, or as [`Section::column`] of one of them.
    pub fn columns(&self, key: &'a str) -> Result<Option<[Column; 3]>, ConfigError> {
        #[cfg(test)]
        self.note(key, Takes::ThreeColumns);
        let Some((value, _)) = self.get(key) else {
            return Ok(None);
        };
        let wrong = || {
            self.error(
                key,
                "must be a list of three columns such as [\"x\", \"y\", \"z\"] or [2, 3, 4]",
            )
        };
        let DeValue::Array(items) = value else {
            return Err(wrong());
        };
        let columns = items
            .iter()
            .map(|item| self.column_of(key, item.get_ref()))
            .collect::<Result<Vec<_>, _>>()?;
        columns.try_into().map(Some).map_err(|_| wrong())
    }

    /// A number with its unit.
    ///
    /// # Errors
    /// If the value is no string, or its text no finite number with a unit of `quantity`.
    pub fn quantity(&self, key: &'a str, quantity: Quantity) -> Result<Option<f64>, ConfigError> {
        #[cfg(test)]
        self.note(key, Takes::Quantity(quantity));
        match self.get(key) {
            None => Ok(None),
            Some((DeValue::String(text), _)) => units::parse(text, quantity)
                .map(Some)
                .map_err(|e| self.error(key, format!("\"{text}\": {e}"))),
            Some((value, _)) => Err(self.error(key, needs_unit(value, quantity))),
        }
    }

    /// The unit of latitudes and longitudes, degrees without one: its factor to radians, and whether they are
    /// degrees and minutes.
    ///
    /// # Errors
    /// As [`Section::unit`].
    pub fn place_unit(&self, key: &'a str) -> Result<(f64, bool), ConfigError> {
        let degree = 1f64.to_radians();
        if self.string(key)? == Some(DEGREES_MINUTES) {
            return Ok((degree, true));
        }
        Ok((self.unit(key, Quantity::Angle, degree)?, false))
    }

    /// The factor to SI of a unit without number, `default` where the key is absent; of a velocity or an angle a
    /// minus before the unit reverses the sign.
    ///
    /// # Errors
    /// If the value is no string, or its text no unit of `quantity`.
    pub fn unit(&self, key: &'a str, quantity: Quantity, default: f64) -> Result<f64, ConfigError> {
        #[cfg(test)]
        self.note(key, Takes::Unit(quantity));
        let text = self.string(key)?;
        text.map_or(Ok(default), |text| self.factor_of(key, text, quantity))
    }

    /// The factors to SI of the units of what an inertial sensor measures about x, y and z: one unit, or one of each,
    /// `"deg/s, deg/s, -deg/s"`; a minus before a unit reverses the sign. 1 where the key is absent.
    ///
    /// # Errors
    /// As [`Section::unit`]; for another number of units.
    pub fn units(&self, key: &'a str, quantity: Quantity) -> Result<Vector3, ConfigError> {
        #[cfg(test)]
        self.note(key, Takes::Unit(quantity));
        let Some(text) = self.string(key)? else {
            return Ok(Vector3::repeat(1.0));
        };
        let factor = |unit: &str| self.factor_of(key, unit.trim(), quantity);
        match *text.split(',').collect::<Vec<_>>() {
            [all] => Ok(Vector3::repeat(factor(all)?)),
            [x, y, z] => Ok(Vector3::new(factor(x)?, factor(y)?, factor(z)?)),
            _ => Err(self.error(
                key,
                format!(
                    "\"{text}\" is neither one unit nor three of x, y, z with commas between them"
                ),
            )),
        }
    }

    fn factor_of(&self, key: &'a str, text: &str, quantity: Quantity) -> Result<f64, ConfigError> {
        use Quantity::{Acceleration, Angle, AngularRate, Velocity};
        let signed = matches!(quantity, Acceleration | Angle | AngularRate | Velocity);
        let minus = text.trim_start().strip_prefix(['-', '\u{2212}']);
        let (unit, sign) = match minus.filter(|_| signed) {
            Some(unit) => (unit.trim_start(), -1.0),
            None => (text, 1.0),
        };
        let factor = units::unit_factor(unit, quantity).map_err(|e| {
            let message = match per_second(unit, quantity) {
                Some(meant) => format!(
                    "\"{unit}\" is not {}; did you mean \"{meant}\"?",
                    quantity.name()
                ),
                None => format!("\"{unit}\": {e}"),
            };
            self.error(key, message)
        })?;
        Ok(sign * factor)
    }

    /// Three numbers with one unit, `"0.1, -0.3, 0 m"`; one number means it for all three.
    ///
    /// # Errors
    /// If the value is no string, or its text neither one nor three finite numbers with a unit of `quantity`.
    pub fn vector(&self, key: &'a str, quantity: Quantity) -> Result<Option<Vector3>, ConfigError> {
        #[cfg(test)]
        self.note(key, Takes::Vector(quantity));
        let text = match self.get(key) {
            None => return Ok(None),
            Some((DeValue::String(text), _)) => text,
            Some((value, _)) => {
                return Err(self.error(key, needs_unit(value, quantity)));
            }
        };
        let wrong = |e: &dyn std::fmt::Display| self.error(key, format!("\"{text}\": {e}"));
        let parts: Vec<&str> = text.split(',').map(str::trim).collect();
        match parts.as_slice() {
            [one] => Ok(Some(Vector3::repeat(
                units::parse(one, quantity).map_err(|e| wrong(&e))?,
            ))),
            [x, y, z] => {
                let end = z
                    .find(|c: char| !(c.is_ascii_digit() || ".+-eE\u{2212}".contains(c)))
                    .unwrap_or(z.len());
                let unit = &z[end..];
                let number = |n: &str| {
                    // A unit of its own, or the last one's.
                    let own = !n.ends_with(|c: char| c.is_ascii_digit() || c == '.');
                    let text = if own {
                        n.to_owned()
                    } else {
                        format!("{n}{unit}")
                    };
                    units::parse(&text, quantity).map_err(|e| wrong(&e))
                };
                Ok(Some(Vector3::new(
                    number(x)?,
                    number(y)?,
                    number(&z[..end])?,
                )))
            }
            _ => Err(wrong(
                &"expected one number, or three with commas between them, and a unit",
            )),
        }
    }
}

fn needs_unit(value: &DeValue, quantity: Quantity) -> String {
    let number = match value {
        DeValue::Float(number) => number.as_str(),
        DeValue::Integer(number) => number.as_str(),
        _ => "1",
    };
    let examples = quantity.examples();
    let unit = examples.split('"').nth(1).unwrap_or_default();
    format!("the number needs a unit: write \"{number} {unit}\"")
}
