//! One client of the server: its handshake, what it subscribes to, and what is sent to it.

use super::greeting;
use crate::output::Queue;
use serde_json::Value;
use std::{collections::BTreeMap, io, net::TcpStream, time::Duration};
use tungstenite::{
    Error, Message, WebSocket, accept_hdr_with_config,
    handshake::server::{ErrorResponse, Request, Response},
    http::{HeaderValue, StatusCode},
    protocol::WebSocketConfig,
};
use undrift_io::write::mcap::Stamp;

/// Names of the protocol, which are the same for what is used of it; the newer one first.
const PROTOCOLS: [&str; 2] = ["foxglove.sdk.v1", "foxglove.websocket.v1"];
const PROTOCOL: &str = "Sec-WebSocket-Protocol";
/// Longest a client may take to open the connection \[s\].
const OPENING: f64 = 5.0;
/// How long rows, and then what the client says, are waited for \[s\].
const ROWS: f64 = 0.02;
const SAYS: f64 = 0.001;
/// Longest message of a client \[bytes\].
const MOST: usize = 64 << 10;
/// The binary opcode of a message of a channel.
const MESSAGE_DATA: u8 = 1;
/// Bytes before the content of a message of a bundle: channel, time, length.
const HEAD: usize = 1 + 8 + 4;

/// Adds a message of a channel to what is sent at once.
pub(super) fn add(bundle: &mut Vec<u8>, channel: u8, stamp: Stamp, content: &Value) {
    let content = content.to_string();
    bundle.push(channel);
    bundle.extend(stamp.nanoseconds().to_le_bytes());
    bundle.extend((content.len() as u32).to_le_bytes());
    bundle.extend(content.as_bytes());
}

/// The messages of a bundle: channel, time as it is sent, content.
fn parts(mut bundle: &[u8]) -> impl Iterator<Item = (u8, [u8; 8], &[u8])> {
    std::iter::from_fn(move || {
        let (head, rest) = bundle.split_first_chunk::<HEAD>()?;
        let [channel, time @ .., a, b, c, d] = *head;
        let length = u32::from_le_bytes([a, b, c, d]) as usize;
        let (content, rest) = rest.split_at_checked(length)?;
        bundle = rest;
        Some((channel, time, content))
    })
}

/// Opens the connection; `None` where the client does not speak the protocol.
pub(super) fn accept(stream: TcpStream) -> Option<WebSocket<TcpStream>> {
    let opening = Some(Duration::from_secs_f64(OPENING));
    stream.set_read_timeout(opening).ok()?;
    stream.set_nodelay(true).ok()?;
    let config = WebSocketConfig::default()
        .max_message_size(Some(MOST))
        .max_frame_size(Some(MOST));
    let socket = accept_hdr_with_config(stream, choose, Some(config)).ok()?;
    let says = Some(Duration::from_secs_f64(SAYS));
    socket.get_ref().set_read_timeout(says).ok()?;
    Some(socket)
}

/// Chooses the protocol among those that the client knows.
#[expect(clippy::result_large_err, reason = "the callback of a handshake")]
fn choose(request: &Request, mut response: Response) -> Result<Response, ErrorResponse> {
    let offered = request.headers().get_all(PROTOCOL).iter();
    let offered = offered.filter_map(|header| header.to_str().ok());
    let offered = Vec::from_iter(offered.flat_map(|list| list.split(',').map(str::trim)));
    match PROTOCOLS.into_iter().find(|name| offered.contains(name)) {
        Some(name) => {
            let headers = response.headers_mut();
            headers.insert(PROTOCOL, HeaderValue::from_static(name));
            Ok(response)
        }
        None => {
            let problem = format!("use the subprotocol {}", PROTOCOLS.join(" or "));
            let mut refused = ErrorResponse::new(Some(problem));
            *refused.status_mut() = StatusCode::BAD_REQUEST;
            Err(refused)
        }
    }
}

/// Sends what it subscribes to until it leaves.
pub(super) fn serve(mut socket: WebSocket<TcpStream>, queue: &Queue) -> Result<(), Error> {
    for text in greeting() {
        socket.send(Message::text(text))?;
    }
    // Its number of a subscription by our number of the channel.
    let mut subscribed = BTreeMap::new();
    // Notices of before it subscribed to them.
    let mut missed: Vec<([u8; 8], Vec<u8>)> = Vec::new();
    while let Some(bundles) = queue.take(Duration::from_secs_f64(ROWS)) {
        for bundle in &bundles {
            for (channel, time, content) in parts(bundle) {
                match subscribed.get(&channel) {
                    Some(id) => socket.write(data(*id, time, content))?,
                    None if channel == super::NOTICES => {
                        missed.push((time, content.to_vec()));
                        let over = missed.len().saturating_sub(super::MOST_NOTICES);
                        missed.drain(..over);
                    }
                    None => {}
                }
            }
        }
        socket.flush()?;
        match socket.read() {
            Ok(Message::Text(text)) => {
                subscribe(&mut subscribed, &text);
                if let Some(id) = subscribed.get(&super::NOTICES) {
                    for (time, content) in missed.drain(..) {
                        socket.write(data(*id, time, &content))?;
                    }
                }
            }
            Ok(_) => {}
            Err(Error::Io(error)) if is_patient(&error) => {}
            Err(error) => return Err(error),
        }
    }
    socket.close(None)?;
    socket.flush()
}

fn is_patient(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut | io::ErrorKind::Interrupted
    )
}

/// A message of a channel for whoever subscribed to it by that number.
fn data(id: u32, time: [u8; 8], content: &[u8]) -> Message {
    let id = id.to_le_bytes();
    Message::binary([&[MESSAGE_DATA], &id[..], &time, content].concat())
}

/// What a client says: it subscribes, or does so no more; the rest is not offered to it.
fn subscribe(subscribed: &mut BTreeMap<u8, u32>, text: &str) {
    let Ok(said) = serde_json::from_str::<Value>(text) else {
        return;
    };
    let items = |list: &str| said[list].as_array().into_iter().flatten();
    match said["op"].as_str() {
        Some("subscribe") => {
            let pair = |item: &Value| {
                let channel = u8::try_from(item["channelId"].as_u64()?).ok()?;
                Some((channel, u32::try_from(item["id"].as_u64()?).ok()?))
            };
            subscribed.extend(items("subscriptions").filter_map(pair));
        }
        Some("unsubscribe") => {
            let ids = Vec::from_iter(items("subscriptionIds").filter_map(Value::as_u64));
            subscribed.retain(|_, id| !ids.contains(&u64::from(*id)));
        }
        _ => {}
    }
}
