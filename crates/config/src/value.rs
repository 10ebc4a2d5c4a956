//! Values of a table: from a file's text, or as a program has them.

use serde::Deserialize;
use std::borrow::Cow;
use toml::{
    Spanned,
    de::{DeTable, DeValue, ValueDeserializer},
};

/// A table, with or without a text behind it.
#[derive(Clone, Copy)]
pub enum Table<'a> {
    /// A table of a file's text, and where it begins there \[bytes\], where that is known.
    Parsed(&'a DeTable<'a>, Option<usize>),
    /// A table made in a program.
    Values(&'a toml::Table),
}

/// A value of a key.
pub enum Value<'a> {
    /// A string.
    Text(&'a str),
    /// A whole number, in decimal digits.
    Whole(Cow<'a, str>),
    /// Any other number, in decimal digits.
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

    /// Where it begins in the text \[bytes\].
    pub(super) fn place(self) -> Option<usize> {
        match self {
            Self::Parsed(_, at) => at,
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

    /// It as a program has it; or what is wrong with a value in it.
    pub(super) fn to_values(self) -> Result<toml::Table, String> {
        match self {
            Self::Parsed(table, _) => {
                let value = Spanned::new(0..0, DeValue::Table(table.clone()));
                toml::Table::deserialize(ValueDeserializer::from(value))
                    .map_err(|error| error.message().to_owned())
            }
            Self::Values(table) => Ok(table.clone()),
        }
    }
}

impl Value<'_> {
    /// What it is, for messages.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Text(_) => "a string",
            Self::Whole(_) | Self::Decimal(_) => "a number",
            Self::Switch(_) => "a boolean",
            Self::List(_) => "a list",
            Self::Table(_) => "a table",
            Self::Other => "a date or time",
        }
    }

    /// A number without unit, which may be infinite or NaN.
    pub(super) fn number(&self) -> Option<f64> {
        match self {
            Self::Whole(digits) | Self::Decimal(digits) => digits.parse().ok(),
            _ => None,
        }
    }
}

/// Digits without the underscores that TOML allows between them.
fn digits(text: &str) -> Cow<'_, str> {
    match text.contains('_') {
        true => text.replace('_', "").into(),
        false => text.into(),
    }
}

impl<'a> From<&'a Spanned<DeValue<'a>>> for Value<'a> {
    fn from(value: &'a Spanned<DeValue<'a>>) -> Self {
        match value.get_ref() {
            DeValue::String(text) => Self::Text(text),
            DeValue::Integer(number) => match number.radix() {
                10 => Self::Whole(digits(number.as_str())),
                // `0x32` is held without its prefix.
                radix => i64::from_str_radix(&digits(number.as_str()), radix)
                    .map_or(Self::Other, |number| Self::Whole(number.to_string().into())),
            },
            DeValue::Float(number) => Self::Decimal(digits(number.as_str())),
            DeValue::Boolean(on) => Self::Switch(*on),
            DeValue::Datetime(_) => Self::Other,
            DeValue::Array(items) => Self::List(items.iter().map(Self::from).collect()),
            DeValue::Table(table) => Self::Table(Table::Parsed(table, Some(value.span().start))),
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
