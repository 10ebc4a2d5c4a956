//! The one shape of every result: plain structs, written as JSON under one head,
//! `{"undrift": version, "kind": "navigate", "schema": 1, …}`, and read back from it. Filled from what
//! the verbs found; tables, reports, fleets and other languages read these and nothing else.
//!
//! What is missing in a file that is read stays empty; a number that is null is NaN.

mod drive;
mod navigate;
mod number;
mod outages;
mod text;

pub use drive::{Curve, Drive, Track, name};
pub use navigate::{Navigate, NavigateSeries, Nis, Parameter, StdFactors, Summary};
pub(crate) use number::numbers;
pub use number::{Number, Numbers};
pub use outages::{Cut, Drift, ModelErrors, NisOfParts, OutageErrors, OutageSeries, Outages};
pub use text::text;

use serde_json::{Map, Value};

/// Version of the schema of results.
pub const SCHEMA: u32 = 1;

/// Version of the program.
pub(crate) const VERSION: &str = env!("CARGO_PKG_VERSION");

/// What made a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A static record into noise models.
    Identify,
    /// A drive into a solution.
    Navigate,
    /// A drive with its GNSS cut.
    Outages,
    /// Many simulated drives.
    MonteCarlo,
    /// The simulated experiment: identification and outages.
    Demo,
    /// Many logs.
    Fleet,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Identify,
        Self::Navigate,
        Self::Outages,
        Self::MonteCarlo,
        Self::Demo,
        Self::Fleet,
    ];

    /// The verb's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Identify => "identify",
            Self::Navigate => "navigate",
            Self::Outages => "outages",
            Self::MonteCarlo => "montecarlo",
            Self::Demo => "demo",
            Self::Fleet => "fleet",
        }
    }
}

/// A result with its head.
pub fn with_head(kind: Kind, body: Value) -> Value {
    let mut result = match body {
        Value::Object(map) => map,
        other => Map::from_iter([("result".to_owned(), other)]),
    };
    result.insert("undrift".into(), VERSION.into());
    result.insert("schema".into(), SCHEMA.into());
    result.insert("kind".into(), kind.name().into());
    result.into()
}
