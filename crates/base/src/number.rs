//! Numbers of results: rounded ones, and those that may not be finite.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A number rounded to so many significant digits.
pub fn rounded(number: f64, digits: usize) -> f64 {
    format!("{number:.*e}", digits - 1)
        .parse()
        .unwrap_or(number)
}

/// For `#[serde(with = "OrNull")]`: a number that is not finite is null, and null is NaN.
pub struct OrNull;

impl OrNull {
    /// A number, or null.
    ///
    /// # Errors
    /// Those of the serializer.
    pub fn serialize<S: Serializer>(number: &f64, to: S) -> Result<S::Ok, S::Error> {
        number.is_finite().then_some(number).serialize(to)
    }

    /// A number; NaN where there is null.
    ///
    /// # Errors
    /// Those of the deserializer.
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
        Ok(Option::deserialize(from)?.unwrap_or(f64::NAN))
    }
}

#[cfg(feature = "schema")]
impl schemars::JsonSchema for OrNull {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Number".into()
    }

    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        Option::<f64>::json_schema(generator)
    }
}
