//! Topics as a source.

use crate::{
    dds_topic, participant,
    raw::{AsIs, Raw},
    ros_type, with_domain,
};
use rustdds::{
    DomainParticipant, QosPolicyBuilder, Subscriber, TopicKind,
    mio1::{Events, Interest, Poll, Token},
    no_key::DataReader,
    policy::{Durability, History, Reliability},
};
use std::{
    collections::VecDeque,
    io::{self, Read},
    time::{Duration, Instant, SystemTime, UNIX_EPOCH},
};
use undrift_io::write::mcap::Stream;

/// Longest a read waits for messages, and from one look for publishers to the next \[s\].
const READ: f64 = 0.5;
/// Messages of a topic that wait at most.
const WAITING: i32 = 4096;
/// Types that are read.
const TYPES: [&str; 8] = [
    "sensor_msgs/msg/Imu",
    "sensor_msgs/msg/NavSatFix",
    "geometry_msgs/msg/TwistStamped",
    "geometry_msgs/msg/TwistWithCovarianceStamped",
    "geometry_msgs/msg/PoseStamped",
    "geometry_msgs/msg/PoseWithCovarianceStamped",
    "geometry_msgs/msg/TransformStamped",
    "nav_msgs/msg/Odometry",
];

/// Subscribes to topics, `/imu,/fix?domain=0`, which are a stream of MCAP. Publishers may begin later, end, and begin again.
///
/// # Errors
/// If they are written otherwise, or there can be no participant in the domain.
pub fn subscribe(text: &str) -> io::Result<Box<dyn Read + Send>> {
    let (topics, domain) = with_domain(text)?;
    let participant = participant(domain)?;
    let qos = QosPolicyBuilder::new().build();
    let subscriber = participant.create_subscriber(&qos);
    Ok(Box::new(Topics {
        subscriber: subscriber.map_err(io::Error::other)?,
        participant,
        missing: topics.split(',').map(str::to_owned).collect(),
        looked: None,
        found: Vec::new(),
        stream: Stream::default(),
        poll: Poll::new()?,
        ready: Stream::head().into(),
    }))
}

/// Topics that are read.
struct Topics {
    participant: DomainParticipant,
    subscriber: Subscriber,
    /// Those that nobody has published so far.
    missing: Vec<String>,
    /// When they were looked for last.
    looked: Option<Instant>,
    found: Vec<Found>,
    stream: Stream,
    poll: Poll,
    /// Bytes of the stream.
    ready: VecDeque<u8>,
}

/// A topic whose type is known.
struct Found {
    number: u16,
    reader: DataReader<Raw, AsIs>,
}

impl Topics {
    /// Looks for publishers of topics that had none.
    fn look(&mut self) -> io::Result<()> {
        let wait = Duration::from_secs_f64(READ);
        if self.missing.is_empty() || self.looked.is_some_and(|last| last.elapsed() < wait) {
            return Ok(());
        }
        self.looked = Some(Instant::now());
        let mut missing = std::mem::take(&mut self.missing);
        let mut looked = Ok(());
        for writer in self.participant.discovered_writers() {
            let data = writer.publication_topic_data;
            let name = |topic: &String| dds_topic(topic) == data.topic_name;
            let Some(at) = missing.iter().position(name) else {
                continue;
            };
            let topic = missing.swap_remove(at);
            looked = self.begin(&topic, &data.type_name, data.reliability);
            if looked.is_err() {
                break;
            }
        }
        self.missing = missing;
        looked
    }

    /// Reads a topic as its publisher offers it: a publisher that sends again what was lost is asked to.
    fn begin(
        &mut self,
        topic: &str,
        dds_type: &str,
        reliability: Option<Reliability>,
    ) -> io::Result<()> {
        let known = ros_type(dds_type).filter(|name| TYPES.contains(&name.as_str()));
        let type_name = known.ok_or_else(|| {
            let types = TYPES.map(|name| name.replace("/msg", "")).join(", ");
            let problem = format!("{topic} has messages of {dds_type}; what is read: {types}");
            io::Error::new(io::ErrorKind::InvalidData, problem)
        })?;
        let qos = QosPolicyBuilder::new()
            .reliability(reliability.unwrap_or(Reliability::BestEffort))
            .durability(Durability::Volatile)
            .history(History::KeepLast { depth: WAITING })
            .build();
        let name = dds_topic(topic);
        let dds = dds_type.to_owned();
        let dds = self
            .participant
            .create_topic(name, dds, &qos, TopicKind::NoKey);
        let dds = dds.map_err(io::Error::other)?;
        let mut reader = self
            .subscriber
            .create_datareader_no_key::<Raw, AsIs>(&dds, Some(qos))
            .map_err(io::Error::other)?;
        let registry = self.poll.registry();
        registry.register(&mut reader, Token(self.found.len()), Interest::READABLE)?;
        let (number, records) = self.stream.topic(topic, &type_name);
        self.ready.extend(records);
        self.found.push(Found { number, reader });
        Ok(())
    }

    /// Takes the messages that wait.
    fn take(&mut self) -> io::Result<()> {
        let now = SystemTime::now().duration_since(UNIX_EPOCH);
        let now = now.unwrap_or_default().as_nanos() as u64;
        for found in &mut self.found {
            while let Some(sample) = found.reader.take_next_sample().map_err(io::Error::other)? {
                let record = Stream::message(found.number, now, sample.value());
                self.ready.extend(record);
            }
        }
        Ok(())
    }
}

impl Read for Topics {
    /// # Errors
    /// `TimedOut` where nothing came.
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.ready.is_empty() {
            self.look()?;
            self.take()?;
        }
        if self.ready.is_empty() {
            let mut events = Events::with_capacity(16);
            let wait = Duration::from_secs_f64(READ);
            self.poll.poll(&mut events, Some(wait))?;
            self.take()?;
        }
        match self.ready.read(buffer)? {
            0 => Err(io::ErrorKind::TimedOut.into()),
            n => Ok(n),
        }
    }
}
