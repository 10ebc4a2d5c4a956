//! Access to one table of a TOML file, with errors that name file, line, key and what was expected.

mod quantities;
mod value;

pub use quantities::PlaceUnit;
pub use value::{Table, Value};

use super::error::{ConfigError, DriveError};
use std::{cell::RefCell, fmt::Display, path::Path};
use toml::de::DeTable;
use undrift_base::toml_text::line_at;
use undrift_io::nearby;
use undrift_noise::{ImuModel, ModelError};

#[cfg(test)]
#[path = "../../../../tools/schema/page.rs"]
pub(crate) mod page;
#[cfg(test)]
use page::Takes;

/// The unit of latitudes and longitudes that are degrees times 100 and minutes, as NMEA has them.
pub(crate) const DEGREES_MINUTES: &str = "ddmm.mmmm";
/// What the unit of eastings and northings begins with, before their zone.
pub(crate) const UTM: &str = "UTM";

/// One table of a file; remembers which keys were asked for, so that the others can be refused with the names of those known.
///
/// ```
/// # use undrift_drive as undrift;
/// use undrift::drive::{Section, parse};
/// use undrift::nav::units::Quantity;
/// let text = "[wheel]\nspeed_std = \"10 cm/s\"\nlever = 3\n";
/// let tables = parse(text, "car.toml")?;
/// let wheel = Section::top(tables.get_ref(), text, "car.toml").section("wheel")?;
/// assert_eq!(wheel.quantity("speed_std", Quantity::Velocity)?, Some(0.1)); // [m/s]
/// let error = wheel.vector("lever", Quantity::Length).unwrap_err();
/// assert_eq!((error.line, error.key.as_str()), (Some(3), "wheel.lever"));
/// # Ok::<(), undrift::drive::ConfigError>(())
/// ```
pub struct Section<'a> {
    table: Option<Table<'a>>,
    text: &'a str,
    file: &'a str,
    path: &'a str,
    line: Option<usize>,
    asked: RefCell<Vec<&'a str>>,
}

impl<'a> Section<'a> {
    /// The top table of a file with this `text`, which gives its lines; `file` is its name in messages.
    pub fn top(table: &'a DeTable<'a>, text: &'a str, file: &'a str) -> Self {
        Self {
            text,
            ..Self::values(Table::Parsed(table, 0), file)
        }
    }

    /// A table without a text, as a program has it; errors name no line.
    pub fn values(table: Table<'a>, file: &'a str) -> Self {
        Self {
            table: Some(table),
            text: "",
            file,
            path: "",
            line: None,
            asked: RefCell::default(),
        }
    }

    /// A table below this one.
    fn below(&self, table: Option<Table<'a>>, key: &'a str, line: Option<usize>) -> Self {
        Self {
            table,
            path: key,
            line,
            asked: RefCell::default(),
            ..*self
        }
    }

    /// The sub-table `key`; an absent one has no keys, see [`Section::exists`].
    ///
    /// # Errors
    /// If the value is no table.
    pub fn section(&self, key: &'a str) -> Result<Section<'a>, ConfigError> {
        #[cfg(test)]
        self.note(key, Takes::Table);
        match self.get(key) {
            None => Ok(self.below(None, key, None)),
            Some(Value::Table(table)) => Ok(self.below(Some(table), key, self.line_of(key))),
            Some(_) => Err(self.error(key, "must be a table")),
        }
    }

    /// The tables of a list, `[[key]]`; none where it is absent.
    ///
    /// # Errors
    /// If the value is no list of tables.
    pub fn sections(&self, key: &'a str) -> Result<Vec<Section<'a>>, ConfigError> {
        let wrong = || self.error(key, format!("must be tables: write [[{key}]]"));
        let items = match self.get(key) {
            None => return Ok(Vec::new()),
            Some(Value::List(items)) => items,
            Some(_) => return Err(wrong()),
        };
        let section = |item: Value<'a>| match item {
            Value::Table(table) => Ok(self.below(Some(table), key, table.line(self.text))),
            _ => Err(wrong()),
        };
        items.into_iter().map(section).collect()
    }

    /// Whether the file has this table.
    pub fn exists(&self) -> bool {
        self.table.is_some()
    }

    /// The keys of the table, in alphabetical order.
    pub fn keys(&self) -> Vec<&'a str> {
        self.table.map(Table::keys).unwrap_or_default()
    }

    /// The value of a key, which counts as asked for.
    pub fn get(&self, key: &'a str) -> Option<Value<'a>> {
        self.asked.borrow_mut().push(key);
        Some(self.table?.get(key)?.0)
    }

    /// Line of a key in the file's text, from 1.
    pub fn line_of(&self, key: &str) -> Option<usize> {
        let (_, at) = self.table?.get(key)?;
        at.map(|at| line_at(self.text, at))
    }

    fn dotted(&self, key: &str) -> String {
        if self.path.is_empty() {
            key.to_owned()
        } else {
            format!("{}.{key}", self.path)
        }
    }

    /// An error at `key` of this table with its file, line and dotted path.
    pub fn error(&self, key: &str, message: impl Into<String>) -> ConfigError {
        ConfigError {
            file: self.file.to_owned(),
            line: self.line_of(key).or(self.line),
            key: self.dotted(key),
            message: message.into(),
        }
    }

    /// The error of a key that is missing, by what it would say; or, where a key of nearly that name is there, of that one.
    pub fn missing(&self, key: &str, what: impl Display) -> ConfigError {
        match self.nearly(key) {
            Some(there) => self.error(there, format!("unknown key; did you mean {key}?")),
            None => self.error(key, format!("missing: {what}")),
        }
    }

    /// A key that is there, was not asked for, and has nearly this name.
    fn nearly(&self, key: &str) -> Option<&'a str> {
        let asked = self.asked.borrow();
        let mut keys = self.keys().into_iter();
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
        let unknown = self.keys().into_iter().find(|key| !asked.contains(key));
        match unknown {
            None => Ok(()),
            Some(key) => {
                let mut known: Vec<&str> = asked.clone();
                known.sort_unstable();
                known.dedup();
                let near = nearby::known(key, known.iter().copied());
                let near = near.map_or(String::new(), |near| near + " ");
                Err(self.error(
                    key,
                    format!("unknown key; {near}known here: {}", known.join(", ")),
                ))
            }
        }
    }

    /// A string; `None` where the key is absent, as in all functions below.
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
            Some(Value::Text(text)) => Ok(Some(text)),
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
    pub(super) fn note_std(&self, key: &str, quantity: undrift_nav::units::Quantity) {
        self.note(key, Takes::Quantity(quantity));
        if quantity == undrift_nav::units::Quantity::Dimensionless {
            self.note(key, Takes::Positive);
        }
    }

    /// The name of a file, which must be there and not be empty.
    ///
    /// # Errors
    /// If the key or its whole table is missing, or the value is no string or empty.
    pub fn file(&self, key: &'a str) -> Result<&'a str, ConfigError> {
        match self.text(key)? {
            Some(name) if !name.is_empty() => Ok(name),
            Some(_) => Err(self.error(key, "the file name is empty")),
            None if self.exists() => Err(self.missing(key, "the file name")),
            None => {
                let table = format!(
                    "add a [{}] table with file = \"NAME OF THE LOG\"",
                    self.path
                );
                Err(self.missing(key, table))
            }
        }
    }

    /// One of a few words, as the value that stands beside it in `words`.
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
        let Some(value) = self.get(key) else {
            return Ok(None);
        };
        let wrong = || {
            let first = words.first().map_or("", |(w, _)| w);
            self.error(
                key,
                format!("must be a list of words such as [\"{first}\"]"),
            )
        };
        let Value::List(items) = value else {
            return Err(wrong());
        };
        if items.is_empty() {
            return Err(wrong());
        }
        let one = |item: &Value| match item {
            Value::Text(text) => self.one_of(key, text, words),
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
            Some(Value::Text(name)) => match ImuModel::resolve(name, home) {
                Ok(model) => Ok(Some(model)),
                // Not the model's fault but the name's.
                Err(e @ ModelError::Read { .. }) => Err(self.error(key, e.to_string()).into()),
                Err(other) => Err(other.into()),
            },
            Some(Value::Table(Table::Parsed(table, _))) => {
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

    /// A whole number, zero or above.
    ///
    /// # Errors
    /// If the value is no whole number, negative or beyond 64 bits.
    pub fn whole(&self, key: &'a str) -> Result<Option<u64>, ConfigError> {
        #[cfg(test)]
        self.note(key, Takes::Whole);
        let number = match self.get(key) {
            None => return Ok(None),
            Some(Value::Whole(x)) => x.replace('_', "").parse().ok(),
            Some(_) => None,
        };
        match number {
            Some(x) => Ok(Some(x)),
            None => Err(self.error(key, "must be a whole number, 0 or more")),
        }
    }
}
