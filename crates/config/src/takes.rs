//! What a key takes.

use undrift_nav::units::Quantity;

/// What a reader takes from a key, for the schema of its file: see [`Section::watched`](crate::Section::watched).
#[derive(Clone, Debug, PartialEq)]
pub enum Takes {
    /// A string.
    Text,
    /// A list of one or more strings.
    Texts,
    /// One of a few words.
    Words(Vec<String>),
    /// A list of one or more of a few words.
    ListOf(Vec<String>),
    /// True or false.
    Switch,
    /// A whole number, 0 or more.
    Whole,
    /// A number above zero.
    Positive,
    /// A list of finite numbers.
    Numbers,
    /// A column of a log, by name or number.
    Column,
    /// A list of three of those.
    ThreeColumns,
    /// A list of four of those.
    FourColumns,
    /// A number with its unit.
    Quantity(Quantity),
    /// One or a list of those.
    Quantities(Quantity),
    /// One or three numbers with their unit.
    Vector(Quantity),
    /// A unit without number.
    Unit(Quantity),
    /// A table.
    Table,
    /// A list of tables.
    Tables,
    /// A noise model: a preset, a file or a table.
    Model,
}
