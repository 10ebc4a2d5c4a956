//! Access to one table of a TOML file, with errors that name file, line, key and what was expected.

use crate::{ConfigError, Table, Takes, Value, text::line_at};
use std::{cell::RefCell, fmt::Display};
use undrift_base::nearby;

/// One table of a file, or several one over another; remembers which keys were asked for, so that the others can be refused with the names
/// of those known.
///
/// ```
/// use undrift_config::{Section, parse};
/// use undrift_nav::units::Quantity;
/// let text = "[wheel]\nspeed_std = \"10 cm/s\"\nlever = 3\n";
/// let tables = parse(text, "car.toml", "expected a drive file")?;
/// let wheel = Section::top(tables.get_ref(), text, "car.toml").section("wheel")?;
/// assert_eq!(wheel.quantity("speed_std", Quantity::Velocity)?, Some(0.1)); // [m/s]
/// let error = wheel.vector("lever", Quantity::Length).unwrap_err();
/// assert_eq!((error.line, error.key.as_str()), (Some(3), "wheel.lever"));
/// # Ok::<(), undrift_config::ConfigError>(())
/// ```
#[derive(Clone)]
pub struct Section<'a> {
    /// What messages call the file.
    pub file: &'a str,
    /// Dotted path of the table in it; empty of the top.
    pub path: String,
    /// The first that has a key gives its value; none of a table that the file does not have.
    layers: Vec<Layer<'a>>,
    asked: RefCell<Vec<String>>,
    watch: Option<Watch<'a>>,
}

/// Takes the path of a table, a key, and what the key takes.
type Watch<'a> = &'a dyn Fn(&str, &str, Takes);

#[derive(Clone, Copy)]
struct Layer<'a> {
    table: Table<'a>,
    text: Option<&'a str>,
    /// Place of its name in the text \[bytes\].
    at: Option<usize>,
}

impl<'a> Layer<'a> {
    fn line(&self, at: Option<usize>) -> Option<usize> {
        self.text.zip(at).map(|(text, at)| line_at(text, at))
    }
}

impl<'a> Section<'a> {
    /// The top table of a file with this `text`, which gives its lines; `file` is its name in messages.
    pub fn top(table: &'a toml::de::DeTable<'a>, text: &'a str, file: &'a str) -> Self {
        let mut top = Self::values(Table::Parsed(table, None), file);
        top.layers[0].text = Some(text);
        top
    }

    /// A table without a text, as a program has it; errors name no line.
    pub fn values(table: Table<'a>, file: &'a str) -> Self {
        let layer = Layer {
            table,
            text: None,
            at: None,
        };
        Self {
            file,
            path: String::new(),
            layers: vec![layer],
            asked: RefCell::default(),
            watch: None,
        }
    }

    /// The same table at a dotted path of another one.
    pub fn under(self, path: &str) -> Self {
        let path = path.to_owned();
        Self { path, ..self }
    }

    /// The same table over another: that one gives the values of the keys that this one does not have.
    pub fn over(mut self, beneath: Self) -> Self {
        self.layers.extend(beneath.layers);
        self
    }

    /// The same table, which calls `watch` with the path of the table, the key and what the key takes, of each key that is asked for from
    /// here on, in the tables inside as well.
    pub fn watched(self, watch: Watch<'a>) -> Self {
        let watch = Some(watch);
        Self { watch, ..self }
    }

    /// What a key takes that a reader looks at with [`Section::get`].
    pub fn note(&self, key: &str, takes: Takes) {
        if let Some(watch) = self.watch {
            watch(&self.path, key, takes);
        }
    }

    /// A table inside this one.
    fn inside(&self, key: &str, layers: Vec<Layer<'a>>) -> Self {
        Self {
            path: self.dotted(key),
            layers,
            asked: RefCell::default(),
            ..*self
        }
    }

    /// The sub-table `key`; an absent one has no keys, see [`Section::exists`].
    ///
    /// # Errors
    /// If the value is no table.
    pub fn section(&self, key: &str) -> Result<Self, ConfigError> {
        self.note(key, Takes::Table);
        let layers = match self.find(key) {
            None => Vec::new(),
            Some((Value::Table(table), layer)) => vec![Layer { table, ..layer }],
            Some((other, _)) => return Err(self.unlike(key, "a table", &other)),
        };
        Ok(self.inside(key, layers))
    }

    /// The tables of a list, `[[key]]`; none where it is absent.
    ///
    /// # Errors
    /// If the value is no list of tables.
    pub fn sections(&self, key: &str) -> Result<Vec<Self>, ConfigError> {
        self.note(key, Takes::Tables);
        let wrong = |other: &Value| self.unlike(key, &format!("tables: write [[{key}]]"), other);
        let (items, layer) = match self.find(key) {
            None => return Ok(Vec::new()),
            Some((Value::List(items), layer)) => (items, layer),
            Some((other, _)) => return Err(wrong(&other)),
        };
        let section = |item| match item {
            Value::Table(table) => {
                let at = table.place();
                Ok(self.inside(key, vec![Layer { table, at, ..layer }]))
            }
            other => Err(wrong(&other)),
        };
        items.into_iter().map(section).collect()
    }

    /// Whether the file has this table.
    pub fn exists(&self) -> bool {
        !self.layers.is_empty()
    }

    /// The keys of the table, in alphabetical order.
    pub fn keys(&self) -> Vec<&'a str> {
        let layers = self.layers.iter();
        let mut keys = Vec::from_iter(layers.flat_map(|layer| layer.table.keys()));
        keys.sort_unstable();
        keys.dedup();
        keys
    }

    /// The value of a key, which counts as asked for.
    pub fn get(&self, key: &str) -> Option<Value<'a>> {
        self.find(key).map(|(value, _)| value)
    }

    /// The value of a key, which counts as asked for, and the layer that it is in, at the place of the key.
    fn find(&self, key: &str) -> Option<(Value<'a>, Layer<'a>)> {
        self.asked.borrow_mut().push(key.to_owned());
        self.look(key)
    }

    fn look(&self, key: &str) -> Option<(Value<'a>, Layer<'a>)> {
        self.layers.iter().find_map(|layer| {
            let (value, at) = layer.table.get(key)?;
            Some((value, Layer { at, ..*layer }))
        })
    }

    /// Line of a key in the file's text, from 1.
    pub fn line_of(&self, key: &str) -> Option<usize> {
        let (_, layer) = self.look(key)?;
        layer.line(layer.at)
    }

    /// Dotted path of a key, or with an empty key of the table itself.
    fn dotted(&self, key: &str) -> String {
        match (self.path.as_str(), key) {
            ("", key) => key.to_owned(),
            (path, "") => path.to_owned(),
            (path, key) => format!("{path}.{key}"),
        }
    }

    /// An error at `key` of this table, or with an empty key at the table itself, with its file, line and dotted path.
    pub fn error(&self, key: &str, message: impl Into<String>) -> ConfigError {
        let own = || self.layers.first().and_then(|layer| layer.line(layer.at));
        ConfigError {
            file: self.file.to_owned(),
            line: self.line_of(key).or_else(own),
            key: self.dotted(key),
            message: message.into(),
        }
    }

    /// The error of a value that is something else.
    fn unlike(&self, key: &str, expected: &str, value: &Value) -> ConfigError {
        self.error(key, format!("must be {expected}, not {}", value.kind()))
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
        let is_asked = |there: &str| asked.iter().any(|key| key == there);
        let mut keys = self.keys().into_iter();
        keys.find(|there| !is_asked(there) && nearby::misspelt(there, key))
    }

    /// Refuses keys that are not in `known`.
    ///
    /// # Errors
    /// If there is another key; the message names those known.
    pub fn only(&self, known: &[&str]) -> Result<(), ConfigError> {
        let is_unknown = |key: &&str| !known.contains(key);
        let Some(key) = self.keys().into_iter().find(is_unknown) else {
            return Ok(());
        };
        let mut known = known.to_vec();
        known.sort_unstable();
        known.dedup();
        let near = nearby::known(key, known.iter().copied());
        let near = near.map_or(String::new(), |near| near + " ");
        let known = known.join(", ");
        Err(self.error(key, format!("unknown key; {near}known here: {known}")))
    }

    /// Refuses keys that were never asked for.
    ///
    /// # Errors
    /// If there is such a key; the message names those known.
    pub fn only_known(&self) -> Result<(), ConfigError> {
        let asked = self.asked.borrow();
        self.only(&Vec::from_iter(asked.iter().map(String::as_str)))
    }

    /// A table of free form; empty where it is absent.
    ///
    /// # Errors
    /// If the value is no table, or holds one that TOML's types cannot.
    pub fn free(&self, key: &str) -> Result<toml::Table, ConfigError> {
        match self.section(key)?.layers.as_slice() {
            [layer, ..] => {
                let values = layer.table.to_values();
                values.map_err(|message| self.error(key, message))
            }
            [] => Ok(toml::Table::new()),
        }
    }

    /// A string; `None` where the key is absent, as in all functions below.
    ///
    /// # Errors
    /// If the value is no string.
    pub fn text(&self, key: &str) -> Result<Option<&'a str>, ConfigError> {
        self.note(key, Takes::Text);
        self.string(key)
    }

    pub(super) fn string(&self, key: &str) -> Result<Option<&'a str>, ConfigError> {
        match self.get(key) {
            None => Ok(None),
            Some(Value::Text(text)) => Ok(Some(text)),
            Some(other) => Err(self.unlike(key, "a string", &other)),
        }
    }

    /// One of a few words, as the value that stands beside it in `words`.
    ///
    /// # Errors
    /// If the value is no string or none of `words`.
    pub fn word<T: Copy>(&self, key: &str, words: &[(&str, T)]) -> Result<Option<T>, ConfigError> {
        self.note(key, Takes::Words(names(words)));
        let text = self.string(key)?;
        text.map(|text| self.one_of(key, text, words)).transpose()
    }

    fn one_of<T: Copy>(
        &self,
        key: &str,
        text: &str,
        words: &[(&str, T)],
    ) -> Result<T, ConfigError> {
        let found = words.iter().find(|(word, _)| *word == text);
        found.map(|(_, value)| *value).ok_or_else(|| {
            let known: Vec<String> = words.iter().map(|(w, _)| format!("\"{w}\"")).collect();
            let known = known.join(", ");
            self.error(key, format!("\"{text}\" is not one of {known}"))
        })
    }

    /// A list of one or more strings; none where the key is absent.
    ///
    /// # Errors
    /// If the value is no list, an empty one, or not of strings.
    pub fn texts(&self, key: &str) -> Result<Vec<&'a str>, ConfigError> {
        self.note(key, Takes::Texts);
        let wrong = || self.error(key, "must be a list of strings such as [\"a\", \"b\"]");
        let one = |item: Value<'a>| match item {
            Value::Text(text) => Ok(text),
            _ => Err(wrong()),
        };
        Ok(self.list(key, one, wrong)?.unwrap_or_default())
    }

    /// A list of one or more values, each as `one` makes it; the error of another value is `wrong`.
    fn list<T>(
        &self,
        key: &str,
        one: impl Fn(Value<'a>) -> Result<T, ConfigError>,
        wrong: impl Fn() -> ConfigError,
    ) -> Result<Option<Vec<T>>, ConfigError> {
        match self.get(key) {
            None => Ok(None),
            Some(Value::List(items)) if !items.is_empty() => items
                .into_iter()
                .map(one)
                .collect::<Result<_, _>>()
                .map(Some),
            Some(_) => Err(wrong()),
        }
    }

    /// A list of one or more of a few words.
    ///
    /// # Errors
    /// If the value is no list, an empty one, or holds a word that is not in `words`.
    pub fn words<T: Copy>(
        &self,
        key: &str,
        words: &[(&str, T)],
    ) -> Result<Option<Vec<T>>, ConfigError> {
        self.note(key, Takes::ListOf(names(words)));
        let wrong = || {
            let first = words.first().map_or("", |(word, _)| word);
            let message = format!("must be a list of words such as [\"{first}\"]");
            self.error(key, message)
        };
        let one = |item: Value<'a>| match item {
            Value::Text(text) => self.one_of(key, text, words),
            _ => Err(wrong()),
        };
        self.list(key, one, wrong)
    }

    /// A switch, as `gate = true`.
    ///
    /// # Errors
    /// If the value is neither `true` nor `false`.
    pub fn switch(&self, key: &str) -> Result<Option<bool>, ConfigError> {
        self.note(key, Takes::Switch);
        match self.get(key) {
            None => Ok(None),
            Some(Value::Switch(on)) => Ok(Some(on)),
            Some(_) => Err(self.error(key, "must be true or false")),
        }
    }
}

fn names<T>(words: &[(&str, T)]) -> Vec<String> {
    words.iter().map(|(word, _)| (*word).to_owned()).collect()
}
