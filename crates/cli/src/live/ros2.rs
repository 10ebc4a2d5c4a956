//! ROS 2, with the feature of that name: DDS takes long to compile, and few need it.

use std::io;
use undrift_live::{source::OpenRos2, view::View};

/// Opens topics as a source; `None` without the feature.
pub const OPEN: Option<OpenRos2> = {
    #[cfg(feature = "ros2")]
    let open: Option<OpenRos2> = Some(undrift_ros2::subscribe);
    #[cfg(not(feature = "ros2"))]
    let open = None;
    open
};

/// Publishes the solution.
#[cfg(feature = "ros2")]
pub fn publish(place: &str, every: f64) -> io::Result<Box<dyn View>> {
    Ok(Box::new(undrift_ros2::Publisher::open(place, every)?))
}

/// Is never asked for without the feature.
#[cfg(not(feature = "ros2"))]
pub fn publish(_: &str, _: f64) -> io::Result<Box<dyn View>> {
    Err(io::Error::other(undrift_live::source::WITHOUT_ROS2))
}
