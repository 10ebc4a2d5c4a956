//! Reports: a [`Document`] as data, one self-contained [`html`] file of it, and its [`figures`] as
//! SVG and PNG.

mod document;
pub mod figures;
pub mod html;

pub use crate::figure::panel::{Axis, Corner, Panel, Series};
pub use document::{Block, Cell, Document, Figure, Section, Table};
