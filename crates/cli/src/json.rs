//! Results as JSON.

use crate::{report, terminal};
use anyhow::Result;
use clap::Args;
use std::path::PathBuf;

/// Where a verb puts its result as JSON.
#[derive(Args)]
pub struct JsonOutput {
    /// Write the whole result as JSON; "-" for standard output instead of the text
    #[arg(long, value_name = "FILE|-", help_heading = "Output")]
    json: Option<PathBuf>,
}

impl JsonOutput {
    /// Writes the result if it is wanted; whether it went to standard output.
    pub fn write(&self, json: &str) -> Result<bool> {
        match &self.json {
            Some(path) if path.as_os_str() == "-" => terminal::result(json).map(|()| true),
            Some(path) => report::write_whole(path, json).map(|()| false),
            None => Ok(false),
        }
    }
}
