//! A page that shows the solution in a browser while it is made: one document, without any request to elsewhere, and a
//! stream of events (Server-Sent Events).

use crate::{
    output::{Broadcast, Queue},
    session::is_without_gnss,
    view::View,
};
use std::{
    collections::VecDeque,
    io::{self, Write},
    net::{SocketAddr, ToSocketAddrs},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    thread,
    time::{Duration, Instant},
};
use tiny_http::{Header, Request, Response, Server};
use undrift_io::{epoch::Epoch, write::solution::SolutionRow};

const PAGE: &str = include_str!("page/page.html");
/// Least time between rows that are sent \[s\].
const EVERY: f64 = 0.1;
/// Notices and places that are kept for whoever opens the page later.
const MOST_NOTICES: usize = 200;
const MOST_PLACES: usize = 4000;

/// The page, served.
pub struct Page {
    readers: Arc<Broadcast>,
    history: Arc<Mutex<History>>,
    address: SocketAddr,
    /// When a row was sent.
    last: Option<Instant>,
}

impl Page {
    /// Serves the page at an address, `host:port`.
    ///
    /// # Errors
    /// If it is not an address, or in use.
    pub fn serve(address: &str) -> io::Result<Self> {
        let unknown = || {
            io::Error::new(
                io::ErrorKind::InvalidInput,
                "not an address such as 127.0.0.1:8080",
            )
        };
        let address = address
            .to_socket_addrs()
            .map_err(|_| unknown())?
            .next()
            .ok_or_else(unknown)?;
        let server = Server::http(address).map_err(io::Error::other)?;
        let address = server.server_addr().to_ip().unwrap_or(address);
        let readers = Arc::new(Broadcast::default());
        let history = Arc::new(Mutex::new(History::default()));
        let (broadcast, before) = (readers.clone(), history.clone());
        thread::spawn(move || {
            for request in server.incoming_requests() {
                answer(request, &broadcast, &before);
            }
        });
        Ok(Self {
            readers,
            history,
            address,
            last: None,
        })
    }

    /// Where it is.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    fn history(&self) -> MutexGuard<'_, History> {
        self.history.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl View for Page {
    fn ready(&mut self, _: Option<Epoch>) {}

    /// Several within a tenth of a second count as one.
    fn row(&mut self, row: &SolutionRow, since_fix: Option<f64>) {
        let now = Instant::now();
        if self
            .last
            .is_some_and(|last| now - last < Duration::from_secs_f64(EVERY))
        {
            return;
        }
        self.last = Some(now);
        let degrees = |v: undrift_nav::Vector3| [v.x, v.y, v.z].map(f64::to_degrees);
        let data = serde_json::json!({
            "time": row.time,
            "lat": row.position.lat.to_degrees(),
            "lon": row.position.lon.to_degrees(),
            "height": row.position.height,
            "velocity": [row.v_n.x, row.v_n.y, row.v_n.z],
            "rpy": degrees(row.rpy),
            "position_std": row.nav_std[..3],
            "yaw_std": row.nav_std[8].to_degrees(),
            "gyro_bias": degrees(row.gyro_error),
            "gyro_bias_std": row.error_std.first_chunk::<3>().map(|std| std.map(f64::to_degrees)),
            "accel_bias": [row.accel_error.x, row.accel_error.y, row.accel_error.z],
            "accel_bias_std": row.error_std[3..],
            "since_fix": since_fix,
            "without_gnss": is_without_gnss(since_fix),
        });
        self.history().track(
            [row.position.lat, row.position.lon].map(f64::to_degrees),
            is_without_gnss(since_fix),
        );
        self.readers
            .give(format!("event: row\ndata: {data}\n\n").into_bytes());
    }

    fn notice(&mut self, time: Option<f64>, sentence: &str, _: bool) {
        let data = serde_json::json!({ "time": time, "text": sentence });
        let event = format!("event: notice\ndata: {data}\n\n");
        let mut history = self.history();
        history.notices.push_back(event.clone());
        if history.notices.len() > MOST_NOTICES {
            history.notices.pop_front();
        }
        self.readers.give(event.into_bytes());
    }

    /// A page shows what is now: what it misses is no loss.
    fn dropped(&self) -> u64 {
        0
    }
}

/// What a page that is opened later is sent first.
#[derive(Default)]
struct History {
    notices: VecDeque<String>,
    /// Latitude, longitude \[deg\], and 1 without GNSS.
    track: Vec<[f64; 3]>,
    /// Of how many rows one is kept; doubles when there are [`MOST_PLACES`].
    each: usize,
    /// Rows since the last one that was kept.
    since: usize,
}

impl History {
    fn track(&mut self, [lat, lon]: [f64; 2], without_gnss: bool) {
        self.since += 1;
        if self.since < self.each {
            return;
        }
        self.since = 0;
        self.track
            .push([lat, lon, f64::from(u8::from(without_gnss))]);
        if self.track.len() >= MOST_PLACES {
            let mut k = 0;
            self.track.retain(|_| {
                k += 1;
                k % 2 == 1
            });
            self.each = 2 * self.each.max(1);
        }
    }

    fn events(&self) -> Vec<u8> {
        let track = serde_json::json!(self.track);
        let notices: String = self.notices.iter().map(String::as_str).collect();
        format!("event: track\ndata: {track}\n\n{notices}").into_bytes()
    }
}

fn answer(request: Request, readers: &Broadcast, history: &Mutex<History>) {
    match request.url() {
        "/events" => {
            // Held until the reader has joined: a notice in between would be lost to it, or come twice.
            let history = history.lock().unwrap_or_else(PoisonError::into_inner);
            let queue = readers.join(history.events());
            drop(history);
            thread::spawn(move || stream(request, &queue));
        }
        "/" => {
            let response = Response::from_string(PAGE);
            let html = Header::from_bytes("Content-Type", "text/html; charset=utf-8");
            let _ = match html {
                Ok(html) => request.respond(response.with_header(html)),
                Err(()) => request.respond(response),
            };
        }
        _ => {
            let _ = request.respond(Response::empty(404));
        }
    }
}

fn stream(request: Request, queue: &Queue) {
    let mut writer = request.into_writer();
    let head =
        b"HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\nCache-Control: no-store\r\n\r\n";
    if writer.write_all(head).and_then(|()| writer.flush()).is_ok() {
        // Until the reader leaves.
        let _ = queue.pour(writer);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::{
        io::{BufRead, BufReader, Read},
        net::TcpStream,
    };
    use undrift_nav::earth::Geodetic;

    fn get(address: SocketAddr, path: &str) -> BufReader<TcpStream> {
        let mut stream = TcpStream::connect(address).unwrap();
        write!(
            stream,
            "GET {path} HTTP/1.1\r\nHost: here\r\nConnection: close\r\n\r\n"
        )
        .unwrap();
        BufReader::new(stream)
    }

    #[test]
    fn the_page_asks_for_nothing_from_elsewhere_and_its_events_come() {
        let mut page = Page::serve("127.0.0.1:0").unwrap();
        let mut text = String::new();
        get(page.address(), "/").read_to_string(&mut text).unwrap();
        assert!(
            text.starts_with("HTTP/1.1 200") && text.contains("</html>"),
            "{text}"
        );
        assert!(!text.contains("http://") && !text.contains("https://"));
        let mut events = get(page.address(), "/events");
        let mut line = String::new();
        while line != "\r\n" {
            line.clear();
            events.read_line(&mut line).unwrap();
        }
        page.row(
            &SolutionRow::at(1.5, Geodetic::from_degrees(40.5, -105.25, 1600.0)),
            None,
        );
        page.notice(Some(2.0), "the receiver is silent", true);
        let lines: Vec<String> = events.lines().skip(3).take(5).map(Result::unwrap).collect();
        assert_eq!(
            (lines[0].as_str(), lines[3].as_str()),
            ("event: row", "event: notice")
        );
        let row: serde_json::Value = serde_json::from_str(&lines[1][6..]).unwrap();
        assert_eq!(
            (&row["lon"], &row["without_gnss"]),
            (&(-105.25).into(), &true.into())
        );
        assert!(lines[4].contains("the receiver is silent"), "{}", lines[4]);
        // Who comes later sees the track and the notices of before.
        let later = get(page.address(), "/events").lines().skip(4).take(4);
        let later: Vec<String> = later.map(Result::unwrap).collect();
        assert_eq!(later[0], "event: track");
        assert_eq!(later[1], "data: [[40.5,-105.25,1.0]]");
        assert_eq!(later[3], "event: notice");
        let mut missing = String::new();
        get(page.address(), "/other")
            .read_to_string(&mut missing)
            .unwrap();
        assert!(missing.starts_with("HTTP/1.1 404"));
    }
}
