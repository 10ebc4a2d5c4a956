//! Topics of ROS 2 as sources and outputs of a live run, without an installation of ROS: DDS is spoken by crate `rustdds`.
//!
//! A source is a stream of MCAP of the messages as they are serialised, so that the readers of recordings read it. An
//! output publishes what a recording of the solution has. This crate converts no number: it carries bytes.
//!
//! Names are those of ROS 2 on DDS: topic `/imu` is `rt/imu`, type `sensor_msgs/msg/Imu` is `sensor_msgs::msg::dds_::Imu_`. Not
//! `ros2-client`, which is made for messages as Rust types: here they stay bytes, and it brings 34 crates more.

#![cfg(feature = "dds")]

mod publish;
mod raw;
mod subscribe;

pub use publish::Publisher;
pub use subscribe::subscribe;

use rustdds::{DomainParticipant, DomainParticipantBuilder};
use std::{
    collections::HashMap,
    env, io,
    net::{IpAddr, Ipv4Addr},
    sync::{Mutex, PoisonError},
};

/// The participants of this process: sources and outputs of a domain share one.
static PARTICIPANTS: Mutex<Option<HashMap<u16, DomainParticipant>>> = Mutex::new(None);

/// What this process is in a domain.
fn participant(domain: u16) -> io::Result<DomainParticipant> {
    let mut all = PARTICIPANTS.lock().unwrap_or_else(PoisonError::into_inner);
    let all = all.get_or_insert_with(HashMap::new);
    if let Some(known) = all.get(&domain) {
        return Ok(known.clone());
    }
    let mut builder = DomainParticipantBuilder::new(domain);
    if is_local() {
        builder = builder.with_only_networks([IpAddr::V4(Ipv4Addr::LOCALHOST)]);
    }
    let new = builder.build().map_err(io::Error::other)?;
    all.insert(domain, new.clone());
    Ok(new)
}

/// Whether the environment keeps ROS 2 on this machine, as its own nodes read it.
fn is_local() -> bool {
    let is = |name, value| env::var(name).is_ok_and(|set| set.eq_ignore_ascii_case(value));
    is("ROS_LOCALHOST_ONLY", "1") || is("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
}

/// What is written before `?domain=N`, and the domain: without it that of the environment, else 0.
fn with_domain(text: &str) -> io::Result<(&str, u16)> {
    let (place, options) = text.split_once('?').unwrap_or((text, ""));
    let asked = match options.split_once('=') {
        None if options.is_empty() => env::var("ROS_DOMAIN_ID").unwrap_or_default(),
        Some(("domain", value)) => value.to_owned(),
        _ => {
            let problem = format!("unknown option \"{options}\"; available: domain");
            return Err(io::Error::new(io::ErrorKind::InvalidInput, problem));
        }
    };
    let domain = match asked.as_str() {
        "" => Some(0),
        // The ports of larger ones do not exist.
        number => number.parse().ok().filter(|number| *number <= 232),
    };
    let domain = domain.ok_or_else(|| {
        let problem = format!("invalid domain \"{asked}\": 0 to 232");
        io::Error::new(io::ErrorKind::InvalidInput, problem)
    })?;
    Ok((place, domain))
}

/// What DDS calls a topic, `/imu`.
fn dds_topic(topic: &str) -> String {
    format!("rt{topic}")
}

/// What DDS calls a type, `sensor_msgs/msg/Imu`.
fn dds_type(type_name: &str) -> String {
    let (package, name) = type_name.rsplit_once('/').unwrap_or(("", type_name));
    format!("{}::dds_::{name}_", package.replace('/', "::"))
}

/// The type of ROS 2 that DDS calls so.
fn ros_type(dds: &str) -> Option<String> {
    let (package, name) = dds.rsplit_once("::dds_::")?;
    Some(format!(
        "{}/{}",
        package.replace("::", "/"),
        name.strip_suffix('_')?
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_ros_on_dds() {
        assert_eq!(dds_topic("/imu/data"), "rt/imu/data");
        let dds = dds_type("sensor_msgs/msg/Imu");
        assert_eq!(dds, "sensor_msgs::msg::dds_::Imu_");
        assert_eq!(ros_type(&dds).as_deref(), Some("sensor_msgs/msg/Imu"));
        assert_eq!(ros_type("Imu"), None);
    }

    #[test]
    fn a_domain_is_a_number_up_to_232() {
        assert_eq!(with_domain("/imu?domain=42").unwrap(), ("/imu", 42));
        for (text, why) in [
            ("/imu?domain=233", "0 to 232"),
            ("/imu?dom=1", "available: domain"),
        ] {
            let error = with_domain(text).unwrap_err().to_string();
            assert!(error.contains(why), "{error}");
        }
    }
}
