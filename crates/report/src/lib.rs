//! Reports of results: their JSON and nothing else becomes a [`Document`] as data, one self-contained
//! [`html`] file of it, and its [`figures`] as SVG.

mod compare;
mod constants;
mod data;
mod date;
mod demo;
mod document;
pub mod figure;
pub mod figures;
mod fleet;
pub mod html;
mod identify;
pub mod inspect;
mod markup;
mod montecarlo;
mod navigate;
mod numbers;
mod outages;
mod paper;
mod parts;
mod plain;
mod read;
pub mod say;
pub mod text;
mod tune;

/// Whether the verdict on a result is `usable`, without reservation.
pub mod usable {
    pub use crate::{
        identify::is_usable as identify,
        tune::{is_usable as tune, is_worse as tuned_is_worse},
    };
}

pub use crate::figure::panel::{Panel, PlotAxis, Series};
pub use compare::{document, of_results};
pub use document::{Block, Cell, Document, Figure, Section, Table};
pub use numbers::short;
pub use read::read;

#[cfg(test)]
mod tests;
