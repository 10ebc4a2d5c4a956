//! The undrift command.
fn main() {}
