//! Results with the sentences of their values, for JSON.

use serde::Serialize;
use std::collections::BTreeMap;

/// A value, and beside its own keys one with sentences about it.
#[derive(Serialize)]
pub(crate) struct Shown<T, S> {
    #[serde(flatten)]
    value: T,
    #[serde(flatten)]
    sentences: BTreeMap<&'static str, S>,
}

impl<T, S> Shown<T, S> {
    pub(crate) fn new(key: &'static str, sentences: S, value: T) -> Self {
        let sentences = BTreeMap::from([(key, sentences)]);
        Self { value, sentences }
    }
}
