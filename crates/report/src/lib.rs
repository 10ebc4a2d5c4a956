//! Reports of results: their JSON and nothing else becomes a [`Document`] as data, one self-contained
//! [`html`] file of it, its tables as Markdown, LaTeX or CSV ([`ReportFormat`]), and its [`figures`] as SVG.

mod compare;
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
mod parameters;
mod parts;
mod plain;
mod read;
pub mod say;
mod sentence;
mod shown;
mod tables;
pub mod text;
mod tune;

/// Whether the verdict on a result is `usable`, without reservation.
pub mod usable {
    pub use crate::{
        identify::is_usable as identify,
        tune::{is_usable as tune, is_worse as tuned_is_worse},
    };
}

/// Whether a result can be used, and why not: the first line of what is printed of it.
pub mod verdict {
    pub use crate::{
        identify::verdict as identify,
        say::verdict_of as of_findings,
        tune::{usability as tune_usability, verdict as tune},
    };
}

pub use crate::figure::panel::{Panel, PlotAxis, Series};
pub use compare::{document, of_results};
pub use document::{Block, Cell, Document, Figure, Section, Table};
pub use numbers::short;
pub use read::read;
pub use sentence::{sentence, sentence_of};
pub use tables::ReportFormat;

#[cfg(test)]
mod tests;
