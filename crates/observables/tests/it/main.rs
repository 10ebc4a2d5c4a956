//! Ephemerides against other software, displacements against made-up satellites.

mod displacement;
mod ephemerides;
mod sky;
