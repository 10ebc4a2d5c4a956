//! Recordings of ROS: a bag of ROS 1, and MCAP of ROS 2. A `.db3` of ROS 2 holds the messages of the MCAP.

use super::log::{Event, Fix, Log, START, Sample, UNIX};
use std::{
    fs,
    path::{Path, PathBuf},
};
use undrift::nav::Vector3;

const TOPICS: [(&str, &str); 3] = [
    ("/imu/data", "Imu"),
    ("/gps/fix", "NavSatFix"),
    ("/gps/vel", "TwistWithCovarianceStamped"),
];

/// A message being serialised: in ROS 2's CDR numbers begin at multiples of their size behind four bytes,
/// texts end with a zero, and headers have no number.
struct Message {
    bytes: Vec<u8>,
    cdr: bool,
}

impl Message {
    fn number<const N: usize>(&mut self, number: [u8; N]) {
        if self.cdr {
            let padded = 4 + (self.bytes.len() - 4).next_multiple_of(N);
            self.bytes.resize(padded, 0);
        }
        self.bytes.extend(number);
    }

    fn numbers<'a>(&mut self, numbers: impl IntoIterator<Item = &'a f64>) {
        numbers
            .into_iter()
            .for_each(|n| self.number(n.to_le_bytes()));
    }

    /// Begins with a header.
    fn new(cdr: bool, nanos: u64, frame: &str) -> Self {
        let bytes = if cdr { vec![0, 1, 0, 0] } else { vec![0; 4] };
        let mut message = Self { bytes, cdr };
        message.number(((nanos / 1_000_000_000) as u32).to_le_bytes());
        message.number(((nanos % 1_000_000_000) as u32).to_le_bytes());
        let frame = if cdr {
            format!("{frame}\0")
        } else {
            frame.to_owned()
        };
        message.number((frame.len() as u32).to_le_bytes());
        message.bytes.extend(frame.as_bytes());
        message
    }
}

/// Of a diagonal from variances north, east, down: east, north, up.
fn covariance(std: &Vector3) -> [f64; 9] {
    let [n, e, d] = std.map(|std| std * std).into();
    [e, 0.0, 0.0, 0.0, n, 0.0, 0.0, 0.0, d]
}

/// The messages: place of the topic, time \[ns\], content.
fn messages(log: &Log, cdr: bool) -> Vec<(usize, u64, Vec<u8>)> {
    let nanos = |time: f64| {
        ((UNIX + START) as u64 * 1_000_000_000).wrapping_add_signed((time * 1e9).round() as i64)
    };
    let mut messages = Vec::new();
    for event in log.in_order() {
        match event {
            Event::Sample(Sample {
                time, gyro, accel, ..
            }) => {
                let mut message = Message::new(cdr, nanos(*time), "imu_link");
                message.numbers(&[0.0, 0.0, 0.0, 1.0]);
                let [mut orientation, known] = [[0.0; 9], [0.0; 9]];
                orientation[0] = -1.0;
                message.numbers(&orientation);
                for vector in [gyro, accel] {
                    message.numbers(vector);
                    message.numbers(&known);
                }
                messages.push((0, nanos(*time), message.bytes));
            }
            Event::Fix(Fix {
                time,
                place,
                velocity,
                std,
            }) => {
                let mut message = Message::new(cdr, nanos(*time), "gps");
                message.number([0]);
                message.number(1u16.to_le_bytes());
                message.numbers(place);
                message.numbers(&covariance(&std[0]));
                message.number([2]);
                messages.push((1, nanos(*time), message.bytes));
                let Some(v) = velocity else { continue };
                let mut message = Message::new(cdr, nanos(*time), "gps");
                message.numbers(&[v.y, v.x, -v.z, 0.0, 0.0, 0.0]);
                let mut six = [0.0; 36];
                for (k, variance) in covariance(&std[1]).into_iter().enumerate() {
                    six[6 * (k / 3) + k % 3] = variance;
                }
                message.numbers(&six);
                messages.push((2, nanos(*time), message.bytes));
            }
        }
    }
    messages
}

fn package(kind: &str) -> &'static str {
    if kind.starts_with("Twist") {
        "geometry_msgs"
    } else {
        "sensor_msgs"
    }
}

/// A record of a bag: named fields and data, each behind its length.
fn record(out: &mut Vec<u8>, fields: &[(&str, &[u8])], data: &[u8]) {
    let header: Vec<u8> = fields
        .iter()
        .flat_map(|(name, value)| field(name, value))
        .collect();
    pack!(*out; header.len() as u32);
    out.extend(header);
    pack!(*out; data.len() as u32);
    out.extend(data);
}

fn field(name: &str, value: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    pack!(out; (name.len() + 1 + value.len()) as u32);
    out.extend(name.as_bytes());
    out.push(b'=');
    out.extend(value);
    out
}

pub fn bag(log: &Log, folder: &Path) -> Vec<PathBuf> {
    const PER_CHUNK: usize = 5000;
    let connection = |out: &mut Vec<u8>, number: usize| {
        let (topic, kind) = TOPICS[number];
        let kind = format!("{}/{kind}", package(kind));
        let data = [
            field("topic", topic.as_bytes()),
            field("type", kind.as_bytes()),
        ]
        .concat();
        let number = (number as u32).to_le_bytes();
        record(
            out,
            &[("op", &[7]), ("conn", &number), ("topic", topic.as_bytes())],
            &data,
        );
    };
    let messages = messages(log, false);
    let chunks: Vec<_> = messages.chunks(PER_CHUNK).collect();
    let mut out = b"#ROSBAG V2.0\n".to_vec();
    let count = (chunks.len() as u32).to_le_bytes();
    // Where the index begins is not looked at, only whether there is one.
    let fields: [(&str, &[u8]); 4] = [
        ("op", &[3]),
        ("index_pos", &1u64.to_le_bytes()),
        ("conn_count", &3u32.to_le_bytes()),
        ("chunk_count", &count),
    ];
    record(&mut out, &fields, &[b' '; 4000]);
    for chunk in &chunks {
        let mut data = Vec::new();
        (0..TOPICS.len()).for_each(|number| connection(&mut data, number));
        for (topic, nanos, content) in *chunk {
            let mut time = Vec::new();
            pack!(time; (nanos / 1_000_000_000) as u32, (nanos % 1_000_000_000) as u32);
            let number = (*topic as u32).to_le_bytes();
            record(
                &mut data,
                &[("op", &[2]), ("conn", &number), ("time", &time)],
                content,
            );
        }
        let size = (data.len() as u32).to_le_bytes();
        record(
            &mut out,
            &[("op", &[5]), ("compression", b"none"), ("size", &size)],
            &data,
        );
    }
    (0..TOPICS.len()).for_each(|number| connection(&mut out, number));
    chunks
        .iter()
        .for_each(|_| record(&mut out, &[("op", &[6])], &[]));
    let file = folder.join("drive.bag");
    fs::write(&file, out).unwrap();
    vec![file]
}

pub fn mcap(log: &Log, folder: &Path) -> Vec<PathBuf> {
    const MAGIC: &[u8] = b"\x89MCAP0\r\n";
    let mut out = MAGIC.to_vec();
    let text = |out: &mut Vec<u8>, text: &str| {
        pack!(*out; text.len() as u32);
        out.extend(text.as_bytes());
    };
    let mut record = |kind: u8, content: &[u8]| {
        pack!(out; kind, content.len() as u64);
        out.extend(content);
    };
    let mut head = Vec::new();
    text(&mut head, "ros2");
    text(&mut head, "");
    record(1, &head);
    for (number, (topic, kind)) in (1u16..).zip(TOPICS) {
        let mut schema = Vec::new();
        pack!(schema; number);
        text(&mut schema, &format!("{}/msg/{kind}", package(kind)));
        text(&mut schema, "ros2msg");
        text(&mut schema, "");
        record(3, &schema);
        let mut channel = Vec::new();
        pack!(channel; number, number);
        text(&mut channel, topic);
        text(&mut channel, "cdr");
        pack!(channel; 0u32);
        record(4, &channel);
    }
    for (count, (topic, nanos, content)) in (0u32..).zip(messages(log, true)) {
        let mut message = Vec::new();
        pack!(message; topic as u16 + 1, count, nanos, nanos);
        message.extend(content);
        record(5, &message);
    }
    record(0x0F, &[0; 4]);
    record(2, &[0; 20]);
    out.extend(MAGIC);
    let file = folder.join("drive.mcap");
    fs::write(&file, out).unwrap();
    vec![file]
}
