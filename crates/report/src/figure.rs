//! Figures: what is to be drawn, and its drawing as SVG.

pub mod draw;
pub mod panel;
mod paths;
mod scale;
pub(crate) mod style;
