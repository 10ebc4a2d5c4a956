//! What this version knows of lists that other versions may have more kinds in.

use crate::findings::Finding;
use serde::{Deserialize, Deserializer, de::DeserializeOwned, de::Error};
use serde_json::Value;

/// Those of a list that this version knows.
pub(crate) fn known<'de, D: Deserializer<'de>, T: DeserializeOwned>(
    list: D,
) -> Result<Vec<T>, D::Error> {
    readable(list, T::deserialize)
}

/// The findings of a list that this version knows.
///
/// # Errors
/// What is no list.
pub fn known_findings<'de, D: Deserializer<'de>>(list: D) -> Result<Vec<Finding>, D::Error> {
    readable(list, read)
}

/// A finding, if there is one.
///
/// # Errors
/// A kind that this version does not have.
pub fn known_finding<'de, D: Deserializer<'de>>(one: D) -> Result<Option<Finding>, D::Error> {
    let one = Option::<Value>::deserialize(one)?;
    one.map(read).transpose().map_err(D::Error::custom)
}

fn readable<'de, D: Deserializer<'de>, T>(
    list: D,
    read: fn(Value) -> serde_json::Result<T>,
) -> Result<Vec<T>, D::Error> {
    let list = Vec::<Value>::deserialize(list)?;
    Ok(list.into_iter().filter_map(|of| read(of).ok()).collect())
}

/// Of a value, so that the many kinds are compiled once and not for each format and crate that reads them.
fn read(value: Value) -> serde_json::Result<Finding> {
    Finding::deserialize(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Deserialize)]
    struct Found {
        #[serde(deserialize_with = "known_findings")]
        findings: Vec<Finding>,
        #[serde(default, deserialize_with = "known_finding")]
        finding: Option<Finding>,
    }

    #[test]
    fn findings_of_other_versions_are_passed_over() {
        let text = r#"{"findings": [{"finding": "no_such"}, {"finding": "diverged", "time": 3.5}], "finding": null}"#;
        let found: Found = serde_json::from_str(text).unwrap();
        assert_eq!(found.findings, [Finding::Diverged { time: 3.5 }]);
        assert_eq!(found.finding, None);
        let alone = r#"{"findings": [], "finding": {"finding": "no_such"}}"#;
        let error = serde_json::from_str::<Found>(alone).err().unwrap();
        assert!(error.to_string().contains("no_such"), "{error}");
        assert_eq!(error.line(), 1);
    }
}
