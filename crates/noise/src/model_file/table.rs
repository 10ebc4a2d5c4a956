//! A table of a TOML file whose keys know their line, and the reading of single keys with messages.
//!
//! Every reader of a key gives `None` where no layer has it, and an error with file, line and dotted key where
//! its value is of another kind. Lines are known only of the file's own text: a value of a preset has none.

use super::ModelError;
use crate::temperature::celsius;
use serde::Deserialize;
use toml::{
    Spanned,
    de::{DeTable, DeValue, ValueDeserializer},
};
use undrift_base::toml_text::line_at;
use undrift_nav::units::{self, Quantity};

#[cfg(test)]
#[path = "../../../../tools/schema/page.rs"]
pub(super) mod page;
#[cfg(test)]
use page::Takes;

/// A table with the text that it was read from, which gives its lines, where there is one.
pub(super) type Layer<'a> = (&'a DeTable<'a>, Option<&'a str>);

/// A table, or several one over the other.
#[derive(Clone)]
pub(super) struct Table<'a> {
    /// The first that has a key gives its value.
    pub(super) layers: Vec<Layer<'a>>,
    /// What messages call the file.
    pub(super) file: &'a str,
    /// Dotted path of the table in it.
    pub(super) path: String,
    /// Line where it begins, where it is known.
    pub(super) line: Option<usize>,
}

impl<'a> Table<'a> {
    /// The top of a file, or a table at a dotted path of another one.
    pub(super) fn top(
        table: &'a DeTable<'a>,
        text: Option<&'a str>,
        file: &'a str,
        path: &str,
    ) -> Self {
        Self {
            layers: vec![(table, text)],
            file,
            path: path.to_owned(),
            line: None,
        }
    }

    /// The value of a key and the layer that it is in.
    fn find(&self, key: &str) -> Option<(&'a Spanned<DeValue<'a>>, Layer<'a>)> {
        let mut layers = self.layers.iter();
        layers.find_map(|layer| Some((layer.0.get(key)?, *layer)))
    }

    /// The value of a key, of the first layer that has it.
    pub(super) fn get(&self, key: &str) -> Option<&'a DeValue<'a>> {
        self.find(key).map(|(value, _)| value.get_ref())
    }

    /// Line of a key, or else where the table begins.
    fn line_of(&self, key: &str) -> Option<usize> {
        let Some((_, (table, text))) = self.find(key) else {
            return self.line;
        };
        let (name, _) = table.get_key_value(key)?;
        text.map(|text| line_at(text, name.span().start))
    }

    /// An error at a key, or with an empty key at the table itself.
    pub(super) fn error(&self, key: &str, message: impl Into<String>) -> ModelError {
        ModelError::Entry {
            file: self.file.to_owned(),
            line: self.line_of(key),
            key: self.dotted(key),
            message: message.into(),
        }
    }

    /// Dotted path of a key, for messages.
    fn dotted(&self, key: &str) -> String {
        match (self.path.as_str(), key) {
            ("", key) => key.to_owned(),
            (path, "") => path.to_owned(),
            (path, key) => format!("{path}.{key}"),
        }
    }

    /// Refuses keys that are not in `known`.
    pub(super) fn only(&self, known: &[&str]) -> Result<(), ModelError> {
        let mut keys = self.layers.iter().flat_map(|(table, _)| table.keys());
        match keys.find(|key| !known.contains(&key.get_ref().as_ref())) {
            Some(key) => {
                let near = |known: &&&str| strsim::osa_distance(known, key.get_ref()) < 3;
                let near = known.iter().find(near);
                let near = near.map_or(String::new(), |near| format!("did you mean {near}? "));
                let message = format!("unknown key; {near}known here: {}", known.join(", "));
                Err(self.error(key.get_ref(), message))
            }
            None => Ok(()),
        }
    }

    /// A table in this one.
    pub(super) fn table(&self, key: &str) -> Result<Option<Self>, ModelError> {
        #[cfg(test)]
        page::note(&self.path, key, Takes::Table);
        let Some((value, (_, text))) = self.find(key) else {
            return Ok(None);
        };
        match value.get_ref() {
            DeValue::Table(inside) => Ok(Some(Self {
                layers: vec![(inside, text)],
                path: self.dotted(key),
                line: self.line_of(key),
                file: self.file,
            })),
            other => Err(self.error(key, format!("must be a table, not {}", other.type_str()))),
        }
    }

    /// The tables of a list, `[[key]]`; none where there is no such key.
    pub(super) fn tables(&self, key: &str) -> Result<Vec<Self>, ModelError> {
        #[cfg(test)]
        page::note(&self.path, key, Takes::Tables);
        let Some((value, (_, text))) = self.find(key) else {
            return Ok(Vec::new());
        };
        let items = match value.get_ref() {
            DeValue::Array(items) => items.iter(),
            other => {
                let found = other.type_str();
                return Err(self.error(key, format!("must be tables [[{key}]], not {found}")));
            }
        };
        let inside = |item: &'a Spanned<DeValue<'a>>| match item.get_ref() {
            DeValue::Table(inside) => Ok(Self {
                layers: vec![(inside, text)],
                path: self.dotted(key),
                line: text.map(|text| line_at(text, item.span().start)),
                file: self.file,
            }),
            other => Err(self.error(key, format!("must be tables, not {}", other.type_str()))),
        };
        items.map(inside).collect()
    }

    /// A table of free form; empty where there is none.
    pub(super) fn free(&self, key: &str) -> Result<toml::Table, ModelError> {
        let value = self.table(key)?.and_then(|_| self.find(key));
        let read = |(value, _): (&Spanned<DeValue>, _)| {
            toml::Table::deserialize(ValueDeserializer::from(value.clone()))
        };
        let read = value.map(read).transpose();
        Ok(read
            .map_err(|error| self.error(key, error.message()))?
            .unwrap_or_default())
    }

    /// A string.
    pub(super) fn text(&self, key: &str) -> Result<Option<String>, ModelError> {
        #[cfg(test)]
        page::note(&self.path, key, Takes::Text);
        match self.get(key) {
            None => Ok(None),
            Some(DeValue::String(text)) => Ok(Some(text.to_string())),
            Some(other) => {
                Err(self.error(key, format!("must be a string, not {}", other.type_str())))
            }
        }
    }

    /// A whole number, zero or above.
    pub(super) fn whole(&self, key: &str) -> Result<Option<u64>, ModelError> {
        #[cfg(test)]
        page::note(&self.path, key, Takes::Whole);
        let whole = |value: &DeValue| {
            let number = value.as_integer()?;
            u64::from_str_radix(number.as_str(), number.radix()).ok()
        };
        self.get(key)
            .map(|value| whole(value).ok_or_else(|| self.error(key, "must be a whole number")))
            .transpose()
    }

    /// A number with its unit.
    pub(super) fn signed(&self, key: &str, quantity: Quantity) -> Result<Option<f64>, ModelError> {
        #[cfg(test)]
        page::note(&self.path, key, Takes::Quantity(quantity));
        let read = self.get(key).map(|value| with_unit(value, quantity));
        read.transpose().map_err(|message| self.error(key, message))
    }

    /// A temperature with its unit [°C].
    pub(super) fn celsius(&self, key: &str) -> Result<Option<f64>, ModelError> {
        let read = |text: String| {
            celsius(&text).ok_or_else(|| {
                self.error(
                    key,
                    format!("{text:?}: must be such as \"25 degC\" or \"298 K\""),
                )
            })
        };
        self.text(key)?.map(read).transpose()
    }

    /// A number with its unit, not negative.
    pub(super) fn measure(&self, key: &str, quantity: Quantity) -> Result<Option<f64>, ModelError> {
        #[cfg(test)]
        page::note(&self.path, key, Takes::Quantity(quantity));
        let read = self.get(key).map(|value| not_negative(value, quantity));
        read.transpose().map_err(|message| self.error(key, message))
    }

    /// A number with its unit, or a list of such, each at least zero; empty where there is none.
    pub(super) fn measures(&self, key: &str, quantity: Quantity) -> Result<Vec<f64>, ModelError> {
        #[cfg(test)]
        page::note(&self.path, key, Takes::Quantities(quantity));
        let read: Result<_, _> = match self.get(key) {
            None => Ok(Vec::new()),
            Some(DeValue::Array(items)) => items
                .iter()
                .map(|item| not_negative(item.get_ref(), quantity))
                .collect(),
            Some(one) => not_negative(one, quantity).map(|one| vec![one]),
        };
        read.map_err(|message| self.error(key, message))
    }

    /// A number with its unit, above zero.
    pub(super) fn positive(
        &self,
        key: &str,
        quantity: Quantity,
    ) -> Result<Option<f64>, ModelError> {
        match self.measure(key, quantity)? {
            Some(0.0) => Err(self.error(key, "must be greater than zero")),
            value => Ok(value),
        }
    }

    /// A list of finite numbers without unit; empty where there is none.
    pub(super) fn numbers(&self, key: &str) -> Result<Vec<f64>, ModelError> {
        #[cfg(test)]
        page::note(&self.path, key, Takes::Numbers);
        let read = match self.get(key) {
            None => Some(Vec::new()),
            Some(DeValue::Array(items)) => {
                items.iter().map(|item| number(item.get_ref())).collect()
            }
            Some(_) => None,
        };
        read.ok_or_else(|| self.error(key, "must be a list of finite numbers such as [1.0, -0.2]"))
    }
}

/// [`with_unit`], not negative.
fn not_negative(value: &DeValue, quantity: Quantity) -> Result<f64, String> {
    match (value, with_unit(value, quantity)?) {
        (_, number) if number >= 0.0 => Ok(number),
        (DeValue::String(text), _) => Err(format!(
            "{text:?} must not be negative; remove the minus sign"
        )),
        _ => Err("is negative".into()),
    }
}

/// The number of a value with its unit in `quantity`'s SI unit; or what is wrong.
fn with_unit(value: &DeValue, quantity: Quantity) -> Result<f64, String> {
    match value {
        DeValue::String(text) => {
            units::parse(text, quantity).map_err(|error| format!("{text:?}: {error}"))
        }
        DeValue::Integer(_) | DeValue::Float(_) => Err(format!(
            "the number needs a unit: write {} as a string such as {}",
            quantity.name(),
            quantity.examples()
        )),
        other => Err(format!(
            "must be {} in a string, not {}",
            quantity.name(),
            other.type_str()
        )),
    }
}

/// A finite number without unit.
fn number(value: &DeValue) -> Option<f64> {
    let number = match value {
        DeValue::Float(x) => x.as_str().parse().ok(),
        DeValue::Integer(i) => i64::from_str_radix(i.as_str(), i.radix())
            .ok()
            .map(|i| i as f64),
        _ => None,
    };
    number.filter(|x: &f64| x.is_finite())
}
