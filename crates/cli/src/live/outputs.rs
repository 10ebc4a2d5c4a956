//! Where the solution goes: rows in a format, or what shows it in its own way.

use super::ros2;
use anyhow::{Context, Result};
use std::str::FromStr;
use undrift_live::{
    foxglove::{self, Foxglove},
    output::{Output, OutputError},
    source::WITHOUT_ROS2,
    view::View,
};

/// An output that is asked for.
#[derive(Clone, Debug)]
pub enum Asked {
    /// Rows in a format.
    Rows(Output),
    /// A server for Foxglove at an address.
    Foxglove(String),
    /// Topics of ROS 2 at a place.
    Ros2(String),
}

impl FromStr for Asked {
    type Err = OutputError;

    fn from_str(text: &str) -> Result<Self, OutputError> {
        if let Some(place) = text.strip_prefix("ros2:") {
            return match ros2::OPEN.is_some() {
                true => Ok(Self::Ros2(place.to_owned())),
                false => Err(OutputError(text.to_owned(), WITHOUT_ROS2.to_owned())),
            };
        }
        match text.strip_prefix("foxglove://") {
            Some(address) => match address.strip_prefix(':') {
                Some(port) => Ok(Self::Foxglove(format!("127.0.0.1:{port}"))),
                None => Ok(Self::Foxglove(address.to_owned())),
            },
            None => text.parse().map(Self::Rows),
        }
    }
}

/// What shows the solution, with its name.
pub type Named = (String, Box<dyn View>);

/// Opens the views among the outputs; rows are `every` \[s\] apart, or as is usual there.
pub fn views(asked: &[Asked], every: Option<f64>) -> Result<Vec<Named>> {
    let mut views: Vec<Named> = Vec::new();
    for output in asked {
        match output {
            Asked::Rows(_) => {}
            Asked::Foxglove(address) => {
                let name = format!("foxglove://{address}");
                let opened = Foxglove::serve(address, every.unwrap_or(foxglove::EVERY));
                let opened = opened.with_context(|| format!("cannot open the output {name}"))?;
                views.push((name, Box::new(opened)));
            }
            Asked::Ros2(place) => {
                let name = format!("ros2:{place}");
                let opened = ros2::publish(place, every.unwrap_or(0.0));
                let opened = opened.with_context(|| format!("cannot open the output {name}"))?;
                views.push((name, opened));
            }
        }
    }
    Ok(views)
}
