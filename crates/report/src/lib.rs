//! Reports of results: their JSON and nothing else becomes a [`Document`] as data, one self-contained
//! [`html`] file of it, and its [`figures`] as SVG and PNG.

mod compare;
mod data;
mod document;
pub mod figure;
pub mod figures;
mod fleet;
pub mod html;
mod identify;
pub mod inspect;
mod montecarlo;
mod navigate;
mod outages;
mod parts;
pub mod say;
mod table;

pub use crate::figure::panel::{Axis, Corner, Panel, Series};
pub use compare::{document, of_results};
pub use document::{Block, Cell, Document, Figure, Section, Table};
pub use table::outage_table;

/// A name that can be a file's on every system, whatever stood in it.
fn file_stem(name: &str) -> String {
    let plain = |c: char| {
        if c.is_alphanumeric() || "-_".contains(c) {
            c
        } else {
            '-'
        }
    };
    let stem: String = name.chars().take(100).map(plain).collect();
    let stem = stem.trim_matches('-');
    if stem.is_empty() {
        "unnamed".to_owned()
    } else {
        stem.to_owned()
    }
}
