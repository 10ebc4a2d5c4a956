//! Values of a table: from a file's text, or as a program has them.

use std::borrow::Cow;
use toml::{
    Spanned,
    de::{DeTable, DeValue},
};
use undrift_base::toml_text::line_at;

/// A table, with or without a text behind it.
#[derive(Clone, Copy)]
pub enum Table<'a> {
    /// A table of a file's text, and where it begins there \[bytes\].
    Parsed(&'a DeTable<'a>, usize),
    /// A table made in a program.
    Values(&'a toml::Table),
}

/// A value of a key.
pub enum Value<'a> {
    /// A string.
    Text(&'a str),
    /// A whole number, in digits.
    Whole(Cow<'a, str>),
    /// Any other number, in digits.
    Decimal(Cow<'a, str>),
    /// A switch, true or false.
    Switch(bool),
    /// A list.
    List(Vec<Value<'a>>),
    /// A table.
    Table(Table<'a>),
    /// Dates and times, which no key takes.
    Other,
}

impl<'a> Table<'a> {
    /// The keys, in alphabetical order.
    pub fn keys(self) -> Vec<&'a str> {
        match self {
            Self::Parsed(table, _) => table.keys().map(|key| key.get_ref().as_ref()).collect(),
            Self::Values(table) => table.keys().map(String::as_str).collect(),
        }
    }

    /// The line where it begins in the text.
    pub(super) fn line(self, text: &str) -> Option<usize> {
        match self {
            Self::Parsed(_, at) => Some(line_at(text, at)),
            Self::Values(_) => None,
        }
    }

    /// The value of a key, and where in the text the key is \[bytes\].
    pub(super) fn get(self, key: &str) -> Option<(Value<'a>, Option<usize>)> {
        match self {
            Self::Parsed(table, _) => {
                let (name, value) = table.get_key_value(key)?;
                Some((value.into(), Some(name.span().start)))
            }
            Self::Values(table) => Some((table.get(key)?.into(), None)),
        }
    }
}

impl<'a> From<&'a Spanned<DeValue<'a>>> for Value<'a> {
    fn from(value: &'a Spanned<DeValue<'a>>) -> Self {
        match value.get_ref() {
            DeValue::String(text) => Self::Text(text),
            DeValue::Integer(number) => match number.radix() {
                10 => Self::Whole(number.as_str().into()),
                // `0x32` is held without its prefix.
                radix => i64::from_str_radix(&number.as_str().replace('_', ""), radix)
                    .map_or(Self::Other, |number| Self::Whole(number.to_string().into())),
            },
            DeValue::Float(number) => Self::Decimal(number.as_str().into()),
            DeValue::Boolean(on) => Self::Switch(*on),
            DeValue::Datetime(_) => Self::Other,
            DeValue::Array(items) => Self::List(items.iter().map(Self::from).collect()),
            DeValue::Table(table) => Self::Table(Table::Parsed(table, value.span().start)),
        }
    }
}

impl<'a> From<&'a toml::Value> for Value<'a> {
    fn from(value: &'a toml::Value) -> Self {
        match value {
            toml::Value::String(text) => Self::Text(text),
            toml::Value::Integer(number) => Self::Whole(number.to_string().into()),
            toml::Value::Float(number) => Self::Decimal(number.to_string().into()),
            toml::Value::Boolean(on) => Self::Switch(*on),
            toml::Value::Datetime(_) => Self::Other,
            toml::Value::Array(items) => Self::List(items.iter().map(Self::from).collect()),
            toml::Value::Table(table) => Self::Table(Table::Values(table)),
        }
    }
}
