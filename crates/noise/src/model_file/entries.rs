//! A TOML table as entries that know their line, and the reading of single entries with messages.

use super::ModelError;
use toml::de::{DeTable, DeValue};
use undrift_nav::units::{self, Quantity};

#[cfg(test)]
#[path = "../../../../tools/schema/page.rs"]
pub(super) mod page;
#[cfg(test)]
use page::Takes;

/// A table's entry with its line.
#[derive(Clone)]
pub(super) struct Entry {
    pub(super) key: String,
    pub(super) line: Option<usize>,
    pub(super) value: toml::Value,
    /// The entries of a table; empty for anything else.
    pub(super) inside: Vec<Entry>,
}

/// Where the messages say they are.
pub(super) struct Place<'a> {
    pub(super) file: &'a str,
    pub(super) path: &'a str,
}

impl Place<'_> {
    pub(super) fn error(
        &self,
        line: Option<usize>,
        key: &str,
        message: impl Into<String>,
    ) -> ModelError {
        let key = match (self.path.is_empty(), key.is_empty()) {
            (true, _) => key.to_owned(),
            (false, true) => self.path.to_owned(),
            (false, false) => format!("{}.{key}", self.path),
        };
        ModelError::Entry {
            file: self.file.to_owned(),
            line,
            key,
            message: message.into(),
        }
    }

    pub(super) fn known(
        &self,
        entries: &[Entry],
        keys: &[&str],
        prefix: &str,
    ) -> Result<(), ModelError> {
        match entries.iter().find(|e| !keys.contains(&e.key.as_str())) {
            Some(e) => {
                let message = format!("unknown key; known here: {}", keys.join(", "));
                Err(self.error(e.line, &format!("{prefix}{}", e.key), message))
            }
            None => Ok(()),
        }
    }

    /// Entries of a sub-table; the entry must be one.
    pub(super) fn table<'e>(&self, entry: &'e Entry, key: &str) -> Result<&'e [Entry], ModelError> {
        #[cfg(test)]
        note("", key, Takes::Table);
        match entry.value {
            toml::Value::Table(_) => Ok(&entry.inside),
            _ => Err(self.error(
                entry.line,
                key,
                format!("must be a table, not {}", kind(&entry.value)),
            )),
        }
    }

    pub(super) fn text(
        &self,
        entries: &[Entry],
        key: &str,
        prefix: &str,
    ) -> Result<Option<String>, ModelError> {
        #[cfg(test)]
        note(prefix, key, Takes::Text);
        let Some(entry) = find(entries, key) else {
            return Ok(None);
        };
        match &entry.value {
            toml::Value::String(text) => Ok(Some(text.clone())),
            other => Err(self.error(
                entry.line,
                &format!("{prefix}{key}"),
                format!("must be a string, not {}", kind(other)),
            )),
        }
    }

    /// A number with its unit, not negative.
    pub(super) fn measure(
        &self,
        entries: &[Entry],
        key: &str,
        prefix: &str,
        quantity: Quantity,
    ) -> Result<Option<f64>, ModelError> {
        #[cfg(test)]
        note(prefix, key, Takes::Quantity(quantity));
        match find(entries, key) {
            None => Ok(None),
            Some(entry) => with_unit(&entry.value, quantity)
                .map(Some)
                .map_err(|message| self.error(entry.line, &format!("{prefix}{key}"), message)),
        }
    }

    /// A number with its unit, or a list of such, each at least zero; empty where there is none.
    pub(super) fn measures(
        &self,
        entries: &[Entry],
        key: &str,
        prefix: &str,
        quantity: Quantity,
    ) -> Result<Vec<f64>, ModelError> {
        #[cfg(test)]
        note(prefix, key, Takes::Quantities(quantity));
        let Some(entry) = find(entries, key) else {
            return Ok(Vec::new());
        };
        let one = std::slice::from_ref(&entry.value);
        let items = entry.value.as_array().map_or(one, Vec::as_slice);
        items
            .iter()
            .map(|item| with_unit(item, quantity))
            .collect::<Result<_, _>>()
            .map_err(|message| self.error(entry.line, &format!("{prefix}{key}"), message))
    }

    pub(super) fn positive(
        &self,
        entries: &[Entry],
        key: &str,
        prefix: &str,
        quantity: Quantity,
    ) -> Result<Option<f64>, ModelError> {
        let value = self.measure(entries, key, prefix, quantity)?;
        if value == Some(0.0) {
            return Err(self.error(
                line_of(entries, key),
                &format!("{prefix}{key}"),
                "must be greater than zero",
            ));
        }
        Ok(value)
    }

    pub(super) fn numbers(
        &self,
        entries: &[Entry],
        key: &str,
        prefix: &str,
    ) -> Result<Vec<f64>, ModelError> {
        #[cfg(test)]
        note(prefix, key, Takes::Numbers);
        let Some(entry) = find(entries, key) else {
            return Ok(Vec::new());
        };
        let read = match &entry.value {
            toml::Value::Array(items) => items.iter().map(number).collect(),
            _ => None,
        };
        read.ok_or_else(|| {
            self.error(
                entry.line,
                &format!("{prefix}{key}"),
                "must be a list of finite numbers such as [1.0, -0.2]",
            )
        })
    }
}

/// What a key takes, for the schema of the file; `prefix` and `key` are its dotted path.
#[cfg(test)]
pub(super) fn note(prefix: &str, key: &str, takes: Takes) {
    let path = format!("{prefix}{key}");
    let (table, key) = path.rsplit_once('.').unwrap_or(("", &path));
    page::note(table, key, takes);
}

/// The number of a value with its unit in `quantity`'s SI unit, not negative; or what is wrong.
fn with_unit(value: &toml::Value, quantity: Quantity) -> Result<f64, String> {
    match value {
        toml::Value::String(text) => match units::parse(text, quantity) {
            Ok(value) if value >= 0.0 => Ok(value),
            Ok(_) => Err(format!("{text:?} is negative")),
            Err(error) => Err(format!("{text:?}: {error}")),
        },
        toml::Value::Integer(_) | toml::Value::Float(_) => Err(format!(
            "the number needs a unit: write {} as a string such as {}",
            quantity.name(),
            quantity.examples()
        )),
        other => Err(format!(
            "must be {} in a string, not {}",
            quantity.name(),
            kind(other)
        )),
    }
}

fn kind(value: &toml::Value) -> &'static str {
    value.type_str()
}

fn number(value: &toml::Value) -> Option<f64> {
    match value {
        toml::Value::Float(x) if x.is_finite() => Some(*x),
        toml::Value::Integer(i) => Some(*i as f64),
        _ => None,
    }
}

pub(super) fn find<'a>(entries: &'a [Entry], key: &str) -> Option<&'a Entry> {
    entries.iter().find(|e| e.key == key)
}

pub(super) fn line_of(entries: &[Entry], key: &str) -> Option<usize> {
    find(entries, key).and_then(|e| e.line)
}

pub(super) fn line_at(text: &str, offset: usize) -> usize {
    1 + text.bytes().take(offset).filter(|b| *b == b'\n').count()
}

pub(super) fn spanned_entries(table: &DeTable<'_>, text: &str) -> Vec<Entry> {
    table
        .iter()
        .map(|(key, value)| Entry {
            key: key.get_ref().to_string(),
            line: Some(line_at(text, key.span().start)),
            value: plain_value(value.get_ref()),
            inside: value
                .get_ref()
                .as_table()
                .map(|t| spanned_entries(t, text))
                .unwrap_or_default(),
        })
        .collect()
}

pub(super) fn plain_entries(table: &toml::Table) -> Vec<Entry> {
    table
        .iter()
        .map(|(key, value)| Entry {
            key: key.clone(),
            line: None,
            value: value.clone(),
            inside: value.as_table().map(plain_entries).unwrap_or_default(),
        })
        .collect()
}

/// The value without its places. Numbers out of range become infinite, which no entry accepts.
fn plain_value(value: &DeValue<'_>) -> toml::Value {
    match value {
        DeValue::String(text) => toml::Value::String(text.to_string()),
        DeValue::Integer(i) => match i64::from_str_radix(i.as_str(), i.radix()) {
            Ok(i) => toml::Value::Integer(i),
            Err(_) => toml::Value::Float(f64::INFINITY),
        },
        DeValue::Float(x) => toml::Value::Float(x.as_str().parse().unwrap_or(f64::INFINITY)),
        DeValue::Boolean(b) => toml::Value::Boolean(*b),
        DeValue::Datetime(d) => toml::Value::Datetime(*d),
        DeValue::Array(items) => {
            toml::Value::Array(items.iter().map(|v| plain_value(v.get_ref())).collect())
        }
        DeValue::Table(table) => toml::Value::Table(
            table
                .iter()
                .map(|(k, v)| (k.get_ref().to_string(), plain_value(v.get_ref())))
                .collect(),
        ),
    }
}
