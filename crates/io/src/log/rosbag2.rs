//! Bags of ROS 2: a SQLite database (`.db3`), or a folder of such or of MCAP files that belong together.
//! The messages are those that an MCAP holds: [`super::ros`].
//!
//! [`crate::opened`] and [`super::Log::of_bag`] call this. The database is read page by page without the SQLite library: its
//! format is documented, and a bag needs only two tables, from the first row to the last. Pages that are missing or damaged are counted;
//! all others are read.

mod database;
mod folder;
mod pages;
mod parts;
mod row;
#[cfg(test)]
mod tests;

pub(crate) use folder::parts as parts_of_folder;
pub(crate) use parts::{BagFile, MOST_HELD, too_large};

use parts::Parts;

use super::ros;
use crate::ReadError;
use crate::entry::{Entries, Stream, Wanted};
use crate::source::BytesRead;

/// Whether a file that starts so is a SQLite database.
pub(crate) fn detect(start: &[u8]) -> bool {
    pages::detect(start)
}

/// The entries of a bag in one or several parts.
pub(crate) fn entries(
    parts: Vec<BagFile>,
    read: &BytesRead,
    wanted: &Wanted,
) -> Result<Entries, ReadError> {
    ros::entries(Parts::open(parts, read)?, wanted)
}

/// The streams of a bag in one or several parts.
pub(crate) fn streams(parts: Vec<BagFile>) -> Result<Vec<Stream>, ReadError> {
    ros::streams(Parts::open(parts, &BytesRead::default())?)
}
