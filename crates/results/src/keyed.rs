//! Values that are fields of the result which holds them, one for each of a set of keys.

use serde::{Deserialize, Deserializer, Serialize, Serializer, de, ser::SerializeMap};
use std::{
    fmt,
    marker::PhantomData,
    ops::{Index, IndexMut},
};

/// What values may be kept by, each a field of a result.
pub trait Key: Copy + PartialEq + 'static {
    /// All of them, in the order of the fields.
    const ALL: &'static [Self];
    /// The name of its field.
    fn key(self) -> String;
    /// What the field holds, for the schema.
    fn describe(self) -> &'static str;
}

/// A value for each key, got by `values[key]`; held with `#[serde(flatten)]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Keyed<K, V> {
    values: Vec<V>,
    keys: PhantomData<K>,
}

impl<K: Key, V> Keyed<K, V> {
    /// The value of every key.
    pub fn new(value: impl FnMut(K) -> V) -> Self {
        Self {
            values: K::ALL.iter().copied().map(value).collect(),
            keys: PhantomData,
        }
    }

    /// Keys and values in the order of the fields.
    pub fn iter(&self) -> impl Iterator<Item = (K, &V)> {
        K::ALL.iter().copied().zip(&self.values)
    }
}

impl<K: Key, V: Default> Default for Keyed<K, V> {
    fn default() -> Self {
        Self::new(|_| V::default())
    }
}

/// The place of a key among all.
fn place<K: Key>(key: K) -> usize {
    let at = K::ALL.iter().position(|other| *other == key);
    at.unwrap_or_default()
}

impl<K: Key, V> Index<K> for Keyed<K, V> {
    type Output = V;

    fn index(&self, key: K) -> &V {
        &self.values[place(key)]
    }
}

impl<K: Key, V> IndexMut<K> for Keyed<K, V> {
    fn index_mut(&mut self, key: K) -> &mut V {
        &mut self.values[place(key)]
    }
}

impl<K: Key, V: Serialize> Serialize for Keyed<K, V> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.values.len()))?;
        for (key, value) in self.iter() {
            map.serialize_entry(&key.key(), value)?;
        }
        map.end()
    }
}

impl<'de, K: Key, V: Default + Deserialize<'de>> Deserialize<'de> for Keyed<K, V> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(Fields(PhantomData))
    }
}

struct Fields<K, V>(PhantomData<(K, V)>);

impl<'de, K: Key, V: Default + Deserialize<'de>> de::Visitor<'de> for Fields<K, V> {
    type Value = Keyed<K, V>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("fields")
    }

    fn visit_map<A: de::MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let mut read = Keyed::default();
        while let Some(name) = map.next_key::<String>()? {
            match K::ALL.iter().position(|key| key.key() == name) {
                Some(at) => read.values[at] = map.next_value()?,
                None => {
                    map.next_value::<de::IgnoredAny>()?;
                }
            }
        }
        Ok(read)
    }
}

#[cfg(feature = "schema")]
impl<K: Key, V: Default + Serialize + schemars::JsonSchema> schemars::JsonSchema for Keyed<K, V> {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Keyed".into()
    }

    fn inline_schema() -> bool {
        true
    }

    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let mut fields = schemars::Schema::default();
        for key in K::ALL {
            let mut field = generator.subschema_for::<V>();
            let about = schemars::json_schema!({
                "default": V::default(),
                "description": key.describe(),
            });
            for (name, value) in about.as_object().into_iter().flatten() {
                field.insert(name.clone(), value.clone());
            }
            fields.insert(key.key(), field.to_value());
        }
        let required: Vec<String> = match generator.contract().is_serialize() {
            true => K::ALL.iter().map(|key| key.key()).collect(),
            false => Vec::new(),
        };
        schemars::json_schema!({
            "type": "object",
            "properties": fields,
            "required": required,
        })
    }
}
