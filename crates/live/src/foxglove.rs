//! The solution for Foxglove: a WebSocket server of its protocol (<https://github.com/foxglove/ws-protocol>), whose messages are JSON.
//!
//! * `/undrift/fix`, foxglove.LocationFix: position, its covariance, heading and velocity.
//! * `/undrift/pose`, foxglove.PoseInFrame: the pose of `base_link` in `map`, east-north-up from the first row.
//! * `/undrift/state`: the columns of a row of CSV by their names, whether there is GNSS, and how old the newest fix is.
//! * `/undrift/notices`, foxglove.Log: what happened.
//!
//! Crate `foxglove` is not used: its server runs on tokio and brings 110 crates; the part of the protocol that is needed here is small.

mod client;

use crate::{output::Broadcast, session::is_without_gnss, view::View};
use serde_json::{Value, json};
use std::{
    collections::VecDeque,
    io,
    net::{SocketAddr, TcpListener},
    sync::{Arc, Mutex, PoisonError},
    thread,
    time::{SystemTime, UNIX_EPOCH},
};
use undrift_io::{
    epoch::Epoch,
    write::{
        Thinning,
        mcap::{Messages, Stamp},
        solution::SolutionRow,
    },
};

/// Least time between rows unless stated \[s\].
pub const EVERY: f64 = 0.1;
/// Notices that are kept for whoever connects later.
const MOST_NOTICES: usize = 200;

/// Channels by their numbers: topic and name of the schema.
const CHANNELS: [(&str, &str); 4] = [
    ("/undrift/fix", "foxglove.LocationFix"),
    ("/undrift/pose", "foxglove.PoseInFrame"),
    ("/undrift/state", "undrift.State"),
    ("/undrift/notices", "foxglove.Log"),
];
const FIX: u8 = 0;
const POSE: u8 = 1;
const STATE: u8 = 2;
const NOTICES: u8 = 3;

/// Schemas by their names, that of the state aside.
const SCHEMAS: &str = include_str!("foxglove/schemas.json");

/// A server for Foxglove.
pub struct Foxglove {
    readers: Arc<Broadcast>,
    notices: Arc<Mutex<VecDeque<Vec<u8>>>>,
    address: SocketAddr,
    thinning: Thinning,
    messages: Messages,
    /// Of the newest row.
    stamp: Option<Stamp>,
}

impl Foxglove {
    /// Serves at an address, `host:port`; rows are `every` \[s\] apart at least.
    ///
    /// # Errors
    /// If it is not an address, or in use.
    pub fn serve(address: &str, every: f64) -> io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        let address = listener.local_addr()?;
        let readers = Arc::new(Broadcast::default());
        let notices = Arc::new(Mutex::new(VecDeque::new()));
        let (broadcast, before) = (readers.clone(), notices.clone());
        thread::spawn(move || {
            for stream in listener.incoming().map_while(Result::ok) {
                let (broadcast, before) = (broadcast.clone(), before.clone());
                thread::spawn(move || {
                    let Some(socket) = client::accept(stream) else {
                        return;
                    };
                    let notices = before.lock().unwrap_or_else(PoisonError::into_inner);
                    let queue = broadcast.join(notices.iter().flatten().copied().collect());
                    drop(notices);
                    // Until it leaves.
                    let _ = client::serve(socket, &queue);
                    queue.leave();
                });
            }
        });
        Ok(Self {
            readers,
            notices,
            address,
            thinning: Thinning::new(every),
            messages: Messages::new(None),
            stamp: None,
        })
    }

    /// Where it is.
    pub fn address(&self) -> SocketAddr {
        self.address
    }
}

impl View for Foxglove {
    fn ready(&mut self, epoch: Option<Epoch>) {
        self.messages = Messages::new(epoch);
    }

    fn row(&mut self, row: &SolutionRow, since_fix: Option<f64>) {
        let Ok(stamp) = self.messages.stamp(row) else {
            return;
        };
        self.stamp = Some(stamp);
        if !self.thinning.takes(row.time) {
            return;
        }
        let mut bundle = Vec::new();
        client::add(&mut bundle, FIX, stamp, &fix(row, stamp));
        let pose = self.messages.pose(row);
        let (at, q) = (pose.position, pose.orientation);
        let pose = json!({
            "timestamp": time(stamp),
            "frame_id": "map",
            "pose": {
                "position": { "x": at.x, "y": at.y, "z": at.z },
                "orientation": { "x": q.i, "y": q.j, "z": q.k, "w": q.w },
            },
        });
        client::add(&mut bundle, POSE, stamp, &pose);
        let numbers = row.named().map(|(name, value)| (name.into(), value.into()));
        let mut state: serde_json::Map<String, Value> = numbers.collect();
        state.insert("timestamp".into(), time(stamp));
        state.insert("since_fix_s".into(), since_fix.into());
        state.insert("without_gnss".into(), is_without_gnss(since_fix).into());
        client::add(&mut bundle, STATE, stamp, &state.into());
        self.readers.give(bundle);
    }

    fn notice(&mut self, _: Option<f64>, sentence: &str, is_warning: bool) {
        let stamp = self.stamp.unwrap_or_else(now);
        // Levels of foxglove.Log.
        let level = if is_warning { 3 } else { 2 };
        let log = json!({
            "timestamp": time(stamp),
            "level": level,
            "message": sentence,
            "name": "undrift",
            "file": "",
            "line": 0,
        });
        let mut bundle = Vec::new();
        client::add(&mut bundle, NOTICES, stamp, &log);
        let mut notices = self.notices.lock().unwrap_or_else(PoisonError::into_inner);
        notices.push_back(bundle.clone());
        if notices.len() > MOST_NOTICES {
            notices.pop_front();
        }
        self.readers.give(bundle);
    }

    fn dropped(&self) -> u64 {
        self.readers.dropped()
    }
}

/// Before the first row, by the machine's clock.
fn now() -> Stamp {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    let since = since.unwrap_or_default();
    Stamp {
        seconds: i32::try_from(since.as_secs()).unwrap_or(i32::MAX),
        nanoseconds: since.subsec_nanos(),
    }
}

fn time(stamp: Stamp) -> Value {
    json!({ "sec": stamp.seconds, "nsec": stamp.nanoseconds })
}

/// foxglove.LocationFix: angles in degrees but for the heading, covariance and velocity east-north-up.
fn fix(row: &SolutionRow, stamp: Stamp) -> Value {
    let [north, east, down, ..] = row.nav_std.map(|std| std * std);
    let is_known = (north + east + down).is_finite();
    let covariance = match is_known {
        true => [east, 0.0, 0.0, 0.0, north, 0.0, 0.0, 0.0, down],
        false => [0.0; 9],
    };
    json!({
        "timestamp": time(stamp),
        "frame_id": "base_link",
        "latitude": row.position.lat.to_degrees(),
        "longitude": row.position.lon.to_degrees(),
        "altitude": row.position.height,
        "position_covariance": covariance,
        // 2: its diagonal is known, 0: it is not known.
        "position_covariance_type": if is_known { 2 } else { 0 },
        "heading": row.rpy.z,
        "velocity": { "x": row.v_n.y, "y": row.v_n.x, "z": -row.v_n.z },
    })
}

/// The first messages for a client: what the server is, and its channels.
fn greeting() -> [String; 2] {
    let mut schemas: Value = serde_json::from_str(SCHEMAS).unwrap_or_default();
    let row = SolutionRow::at(
        0.0,
        undrift_nav::earth::Geodetic::from_degrees(0.0, 0.0, 0.0),
    );
    let number = || json!({ "type": ["number", "null"] });
    let columns = row.named().map(|(name, _)| (name.to_owned(), number()));
    let mut properties: serde_json::Map<String, Value> = columns.collect();
    properties.insert("since_fix_s".into(), number());
    properties.insert("without_gnss".into(), json!({ "type": "boolean" }));
    let timestamp = schemas["foxglove.Log"]["properties"]["timestamp"].clone();
    properties.insert("timestamp".into(), timestamp);
    schemas["undrift.State"] = json!({ "type": "object", "properties": properties });
    let channels = CHANNELS.iter().zip(0..).map(|((topic, name), number)| {
        json!({
            "id": number,
            "topic": topic,
            "encoding": "json",
            "schemaName": name,
            "schemaEncoding": "jsonschema",
            "schema": schemas[name].to_string(),
        })
    });
    let channels = Vec::from_iter(channels);
    [
        json!({ "op": "serverInfo", "name": "undrift live", "capabilities": [] }).to_string(),
        json!({ "op": "advertise", "channels": channels }).to_string(),
    ]
}

#[cfg(test)]
mod tests;
