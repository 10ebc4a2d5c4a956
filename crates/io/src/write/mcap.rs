//! The navigation solution as MCAP with messages of ROS 2, for Foxglove, rviz and whatever else
//! reads recordings of robots:
//!
//! * `/undrift/fix`, sensor_msgs/msg/NavSatFix: position with its covariance east-north-up.
//! * `/undrift/odom`, nav_msgs/msg/Odometry: the pose of `base_link` in `map`, and the velocity in
//!   `base_link`.
//! * `/undrift/imu`, sensor_msgs/msg/Imu: the attitude of `base_link` in east-north-up where it is;
//!   angular rate and specific force are marked as not given.
//!
//! Frames are those of REP-103 and REP-105: `base_link` is forward-left-up, `map` east-north-up with
//! its origin at the first row. Over long distances `map`'s up is no longer up where the vehicle is;
//! the poses allow for that. Covariances are of standard deviations alone, all zero (unknown) where
//! one of them is not finite.

mod cdr;
pub(super) mod container;
mod messages;
mod stream;

pub use messages::{Level, Messages, OfRow, Pose, Stamp, Status};
pub use stream::{Declarations, Stream};

use std::io::{self, Write};

use super::solution::SolutionRow;
use crate::epoch::Epoch;
use container::Container;

/// Topics: name, type and definition, which is followed by those of the types that it needs.
const TOPICS: [[&str; 3]; 3] = [
    [
        "/undrift/fix",
        "sensor_msgs/msg/NavSatFix",
        include_str!("mcap/NavSatFix.msg"),
    ],
    [
        "/undrift/odom",
        "nav_msgs/msg/Odometry",
        include_str!("mcap/Odometry.msg"),
    ],
    [
        "/undrift/imu",
        "sensor_msgs/msg/Imu",
        include_str!("mcap/Imu.msg"),
    ],
];

/// Writes solution rows as MCAP.
pub struct McapWriter<W: Write> {
    out: Container<W>,
    topics: [u16; 3],
    messages: Messages,
    rows: u32,
}

impl<W: Write> McapWriter<W> {
    /// Starts with the definitions. Messages are collected here; `out` needs no buffer. `epoch` is what the
    /// rows' times count from; without it the stamps are the rows' own times, and the metadata say so.
    ///
    /// # Errors
    /// If `out` does not take them.
    pub fn new(out: W, epoch: Option<Epoch>) -> io::Result<Self> {
        let library = concat!("undrift ", env!("CARGO_PKG_VERSION"));
        let mut out = Container::new(out, "ros2", library)?;
        let stamps = match epoch {
            Some(_) => "Unix time (UTC)",
            None => "seconds of the log's own clock: its date is unknown",
        };
        let mut about = vec![("stamps", stamps)];
        about.extend(epoch.map(|epoch| ("clock", epoch.clock.name())));
        out.metadata("undrift", &about)?;
        let topics = TOPICS.map(|[topic, name, definition]| out.channel(topic, name, definition));
        Ok(Self {
            out,
            topics,
            messages: Messages::new(epoch),
            rows: 0,
        })
    }

    /// Writes one row as three messages.
    ///
    /// # Errors
    /// If `out` does not take them, a value but a standard deviation is not finite, or the time is
    /// outside of what a stamp holds, 1901 to 2038.
    pub fn write(&mut self, row: &SolutionRow) -> io::Result<()> {
        let stamp = self.messages.stamp(row)?;
        self.rows = self.rows.wrapping_add(1);
        for (topic, message) in self.topics.into_iter().zip(Messages::OF_A_ROW) {
            let content = message(&mut self.messages, row, stamp);
            self.out
                .message(topic, self.rows, stamp.nanoseconds(), content)?;
        }
        Ok(())
    }

    /// Writes what is left and gives `out` back.
    ///
    /// # Errors
    /// If `out` does not take it.
    pub fn into_inner(self) -> io::Result<W> {
        self.out.finish()
    }
}

#[cfg(test)]
mod tests;
