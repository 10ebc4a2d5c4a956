//! Reports of results: their JSON and nothing else becomes a [`Document`] as data, one self-contained
//! [`html`] file of it, and its [`figures`] as SVG and PNG.

mod compare;
mod document;
pub mod figures;
pub mod html;
mod identify;
mod montecarlo;
mod navigate;
mod outages;
mod parts;
mod read;

pub use crate::figure::panel::{Axis, Corner, Panel, Series};
pub use compare::of_results;
pub use document::{Block, Cell, Document, Figure, Section, Table};
