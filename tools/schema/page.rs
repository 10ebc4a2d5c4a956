//! JSON Schema of a file that is read key by key: what each key takes as its reader asks for it, what it
//! means as the file's page in docs/ says. Included by the tests beside the readers:
//! `UPDATE=1 cargo test schema` rewrites docs/schema.

// Each file's reader takes some of these only.
#![allow(dead_code)]

use serde_json::{Map, Value, json};
use std::{cell::RefCell, collections::BTreeMap, path::Path};
use undrift_config::Takes;

/// Table and key.
type Key = (String, String);

/// What readers asked for.
#[derive(Default)]
pub(crate) struct Asked(RefCell<BTreeMap<Key, Vec<Takes>>>);

impl Asked {
    /// Notes that a reader asked for a key of a table.
    pub(crate) fn note(&self, table: &str, key: &str, takes: Takes) {
        let mut asked = self.0.borrow_mut();
        let all = asked.entry((table.into(), key.into())).or_default();
        if !all.contains(&takes) {
            all.push(takes);
        }
    }

    pub(crate) fn all(self) -> BTreeMap<Key, Vec<Takes>> {
        self.0.into_inner()
    }
}

/// What a page says of a key.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    meaning: String,
    default: Option<Value>,
    required: bool,
}

/// The rows of a page's tables, by the table of the file in their heading, "" before the first.
pub(crate) fn rows(page: &str) -> BTreeMap<Key, Row> {
    let mut rows = BTreeMap::new();
    let mut table = String::new();
    for line in page.lines() {
        if let Some(heading) = line.strip_prefix("## ") {
            table = heading.trim_matches(['`', '[', ']']).to_owned();
        }
        let Some(line) = line.strip_prefix("| `") else {
            continue;
        };
        let cells: Vec<&str> = line.trim_end_matches(" |").split(" | ").collect();
        let (Some(keys), Some(meaning)) = (cells.first(), cells.last()) else {
            continue;
        };
        let keys: Vec<&str> = keys
            .split(", ")
            .map(|key| key.trim_matches(['`', '[', ']']))
            .collect();
        let default = if cells.len() == 4 { cells[2] } else { "" };
        let mut defaults = default.split(", ");
        for key in &keys {
            let own = if keys.len() == 1 {
                Some(default)
            } else {
                defaults.next()
            };
            let row = Row {
                meaning: without_links(meaning),
                default: own.and_then(value_of),
                required: own == Some("required"),
            };
            rows.insert((table.clone(), (*key).to_owned()), row);
        }
    }
    rows
}

/// A default that is alone in its cell.
fn value_of(cell: &str) -> Option<Value> {
    serde_json::from_str(cell.trim_matches('`')).ok()
}

/// `[text](address)` becomes text.
fn without_links(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once("](") {
        let (front, name) = before.rsplit_once('[').unwrap_or(("", before));
        out += &format!("{front}{name}");
        rest = after.split_once(')').map_or("", |(_, rest)| rest);
    }
    out + rest
}

/// Schemas of the tables of one file.
pub(crate) struct Tables<'a> {
    pub(crate) asked: &'a BTreeMap<Key, Vec<Takes>>,
    pub(crate) rows: &'a BTreeMap<Key, Row>,
    /// The table of the page that describes a table of the file.
    pub(crate) page: &'a dyn Fn(&str) -> String,
    /// The name of a table inside a table.
    pub(crate) inside: &'a dyn Fn(&str, &str) -> String,
}

impl Tables<'_> {
    /// A table with all its keys; one of which no key is ever asked for may hold anything.
    pub(crate) fn table(&self, name: &str) -> Value {
        let (mut properties, mut required) = (Map::new(), Vec::new());
        for ((_, key), takes) in self.asked.iter().filter(|((table, _), _)| table == name) {
            let row = self.row(name, key);
            let mut kinds: Vec<Value> = takes
                .iter()
                .map(|takes| self.kind(name, key, takes))
                .collect();
            let mut property = match kinds.len() {
                1 => kinds.remove(0),
                _ => json!({"anyOf": kinds}),
            };
            property["description"] = described(row.map_or("", |row| &row.meaning), takes).into();
            if let Some(default) = row.and_then(|row| row.default.clone()) {
                property["default"] = default;
            }
            if row.is_some_and(|row| row.required && key == "file") {
                required.push(key.clone());
            }
            properties.insert(key.clone(), property);
        }
        if properties.is_empty() {
            return json!({"type": "object"});
        }
        json!({
            "type": "object",
            "properties": properties,
            "required": required,
            "additionalProperties": false,
        })
    }

    /// The row of a key, else that of its table.
    fn row(&self, name: &str, key: &str) -> Option<&Row> {
        let page = (self.page)(name);
        let own = self.rows.get(&(page, key.to_owned()));
        own.or_else(|| {
            self.rows
                .iter()
                .find(|((_, key), _)| key == name)
                .map(|(_, row)| row)
        })
    }

    fn kind(&self, name: &str, key: &str, takes: &Takes) -> Value {
        match takes {
            Takes::Text | Takes::Quantity(_) | Takes::Vector(_) | Takes::Unit(_) => {
                json!({"type": "string"})
            }
            Takes::Texts => {
                json!({"type": "array", "items": {"type": "string"}, "minItems": 1})
            }
            Takes::Words(words) => json!({"enum": words}),
            Takes::ListOf(words) => {
                json!({"type": "array", "items": {"enum": words}, "minItems": 1})
            }
            Takes::Switch => json!({"type": "boolean"}),
            Takes::Whole => json!({"type": "integer", "minimum": 0}),
            Takes::Positive => json!({"type": "number", "exclusiveMinimum": 0}),
            Takes::Numbers => json!({"type": "array", "items": {"type": "number"}}),
            Takes::Column => column(),
            Takes::FourColumns => {
                json!({"type": "array", "items": column(), "minItems": 4, "maxItems": 4})
            }
            Takes::ThreeColumns => {
                // Of places without a height two.
                let least = if (name, key) == ("gnss", "position") {
                    2
                } else {
                    3
                };
                json!({"type": "array", "items": column(), "minItems": least, "maxItems": 3})
            }
            Takes::Quantities(_) => json!({
                "type": ["string", "array"], "items": {"type": "string"}, "minItems": 1,
            }),
            Takes::Table => self.table(&(self.inside)(name, key)),
            Takes::Tables => {
                json!({"type": "array", "items": self.table(&(self.inside)(name, key))})
            }
            Takes::Model => json!({"anyOf": [
                {"type": "string"}, {"$ref": "imu.schema.json#/$defs/model"},
            ]}),
        }
    }
}

fn column() -> Value {
    json!({"type": ["string", "integer"], "minimum": 1})
}

/// The meaning of a key, and the units that it takes.
fn described(meaning: &str, takes: &[Takes]) -> String {
    let mut text = meaning.to_owned();
    for takes in takes {
        let (what, quantity) = match takes {
            Takes::Quantity(quantity) => ("Takes", quantity),
            Takes::Quantities(quantity) => ("Takes one or a list of", quantity),
            Takes::Vector(quantity) => ("Takes one or three of", quantity),
            Takes::Unit(quantity) => ("The unit alone of", quantity),
            _ => continue,
        };
        if !text.is_empty() {
            text += ". ";
        }
        text += &format!(
            "{what} {}, such as {}",
            quantity.name(),
            quantity.examples()
        );
    }
    text
}

/// Compares a schema with the one published, or publishes it where UPDATE is set.
pub(crate) fn publish(path: &Path, schema: &Value) {
    let text = serde_json::to_string_pretty(schema).unwrap() + "\n";
    if std::env::var_os("UPDATE").is_some() {
        std::fs::write(path, text).unwrap();
    } else {
        let published = std::fs::read_to_string(path).unwrap_or_default();
        assert!(
            published == text,
            "{} is not what the reader takes: UPDATE=1 cargo test schema",
            path.display()
        );
    }
}
