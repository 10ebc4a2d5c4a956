//! Where the solution goes while it is made. An output that is slow, or gone, never delays the solution: what it does not
//! take in time is dropped, the oldest first, and counted.

mod queue;

pub use queue::{Broadcast, Queue};

use crate::{session::is_without_gnss, source};
use serial2::SerialPort;
use std::{
    fs::File,
    io::{self, Write},
    net::{TcpListener, UdpSocket},
    path::PathBuf,
    str::FromStr,
    sync::{Arc, Mutex, PoisonError},
    thread,
    time::Duration,
};
use undrift_io::write::{SolutionFile, SolutionFormat, SolutionOptions, solution::SolutionRow};

/// Where rows go.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Target {
    /// Standard output.
    Stdout,
    /// A file, FIFO or device.
    File(PathBuf),
    /// A server at an address: whoever connects gets the rows from then on.
    Tcp(String),
    /// Datagrams to an address, one a row.
    Udp(String),
    /// A serial port.
    Serial(PathBuf, u32),
}

/// An output: where and how.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Output {
    /// Where.
    pub target: Target,
    /// How.
    pub format: SolutionFormat,
    /// As it was written.
    name: String,
}

impl Output {
    /// As it was written.
    pub fn name(&self) -> &str {
        &self.name
    }
}

/// What is no output.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("\"{0}\" is no output: {1}")]
pub struct OutputError(pub String, pub String);

/// Formats that can be read while they are written.
const STREAMED: &str = "csv, jsonl, nmea, mavlink, tum or kf-gins";

impl FromStr for Output {
    type Err = OutputError;

    fn from_str(text: &str) -> Result<Self, OutputError> {
        let wrong = |why: String| OutputError(text.to_owned(), why);
        let (place, options) = text.split_once('?').unwrap_or((text, ""));
        let mut format = None;
        for option in options.split('&').filter(|option| !option.is_empty()) {
            match option.split_once('=') {
                Some(("format", name)) => {
                    let known = name.parse::<SolutionFormat>();
                    format = Some(known.map_err(|error| wrong(error.to_string()))?);
                }
                Some(("baud", _)) if place.starts_with("serial:") => {}
                _ => {
                    return Err(wrong(format!(
                        "unknown option \"{option}\"; available: format"
                    )));
                }
            }
        }
        let (target, usual) = if place == "-" {
            (Target::Stdout, Some(SolutionFormat::Csv))
        } else if let Some(rest) = text.strip_prefix("serial:") {
            let (path, baud) = source::serial(rest).map_err(wrong)?;
            (Target::Serial(path, baud), Some(SolutionFormat::Nmea))
        } else if let Some((scheme, address)) = place.split_once("://") {
            let address = match address.strip_prefix(':') {
                Some(port) => format!("127.0.0.1:{port}"),
                None => address.to_owned(),
            };
            let port = address
                .rsplit_once(':')
                .map(|(_, port)| port.parse::<u16>());
            let target = match (scheme, port) {
                (_, None | Some(Err(_))) => {
                    return Err(wrong("address:port is expected behind //".into()));
                }
                ("tcp", _) => Target::Tcp(address),
                ("udp", _) => Target::Udp(address),
                _ => {
                    return Err(wrong(
                        "use a file, -, tcp://:port, udp://host:port, serial:/dev/… or foxglove://:port".into(),
                    ));
                }
            };
            (target, Some(SolutionFormat::JsonLines))
        } else {
            (
                Target::File(place.into()),
                SolutionFormat::from_path(place.as_ref()),
            )
        };
        let format = format.or(usual);
        let format = format.ok_or_else(|| wrong(format!("unknown extension; use {STREAMED}")))?;
        let streamed = [
            SolutionFormat::Csv,
            SolutionFormat::JsonLines,
            SolutionFormat::Nmea,
            SolutionFormat::KfGins,
            SolutionFormat::Mavlink,
            SolutionFormat::Tum,
        ];
        if !streamed.contains(&format) {
            let name = format.name();
            return Err(wrong(format!(
                "{name} is complete only at its end; use {STREAMED}"
            )));
        }
        Ok(Self {
            target,
            format,
            name: text.to_owned(),
        })
    }
}

/// Bytes that a writer leaves behind.
#[derive(Clone, Default)]
struct Left(Arc<Mutex<Vec<u8>>>);

impl Left {
    fn take(&self) -> Vec<u8> {
        std::mem::take(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Write for Left {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// An open output.
pub struct Outlet {
    writer: SolutionFile<Left>,
    left: Left,
    readers: Arc<Broadcast>,
    name: String,
    threads: Vec<thread::JoinHandle<()>>,
}

/// Takes what goes wrong at an output: its name and why.
pub type Complain = Arc<dyn Fn(&str, &str) + Send + Sync>;

/// An output whose port, socket or file is open, before there are rows.
pub struct Place {
    output: Output,
    opened: Opened,
}

enum Opened {
    Tcp(TcpListener),
    Udp(UdpSocket),
    Serial(SerialPort, PathBuf, u32),
    Stdout,
    File(File),
}

impl Place {
    /// Opens the place of an output.
    ///
    /// # Errors
    /// If it cannot be opened: a port that is in use, a folder that is not there.
    pub fn open(output: &Output) -> io::Result<Self> {
        let opened = match &output.target {
            Target::Tcp(address) => Opened::Tcp(TcpListener::bind(address)?),
            Target::Udp(address) => {
                let socket = UdpSocket::bind("0.0.0.0:0")?;
                socket.connect(address)?;
                Opened::Udp(socket)
            }
            Target::Serial(path, baud) => {
                let mut port = SerialPort::open(path, *baud)?;
                port.set_write_timeout(Duration::from_secs(1))?;
                Opened::Serial(port, path.clone(), *baud)
            }
            Target::Stdout => Opened::Stdout,
            Target::File(path) => Opened::File(File::create(path)?),
        };
        Ok(Self {
            output: output.clone(),
            opened,
        })
    }

    /// As it was written.
    pub fn name(&self) -> &str {
        self.output.name()
    }

    /// Begins to give rows; what goes wrong later is given to `complain`.
    ///
    /// # Errors
    /// If the options are wrong.
    pub fn start(self, options: &SolutionOptions, complain: &Complain) -> io::Result<Outlet> {
        let left = Left::default();
        let mut writer = SolutionFile::new(left.clone(), self.output.format, options)?;
        writer.flush()?;
        let head = left.take();
        let readers = Arc::new(Broadcast::default());
        let mut threads = Vec::new();
        let (name, complain) = (self.output.name, complain.clone());
        let outlet_name = name.clone();
        match self.opened {
            Opened::Tcp(listener) => {
                let readers = readers.clone();
                thread::spawn(move || {
                    for stream in listener.incoming().map_while(Result::ok) {
                        let queue = readers.join(head.clone());
                        thread::spawn(move || queue.pour(stream));
                    }
                });
            }
            Opened::Udp(socket) => {
                let queue = readers.join(head);
                threads.push(thread::spawn(move || {
                    while let Some(row) = queue.next() {
                        // Nobody may listen yet.
                        let _ = socket.send(&row);
                    }
                }));
            }
            Opened::Serial(mut port, path, baud) => {
                let queue = readers.join(head);
                thread::spawn(move || {
                    while let Err(error) = queue.pour(&port) {
                        complain(&name, &error.to_string());
                        thread::sleep(Duration::from_secs(1));
                        if let Ok(again) = SerialPort::open(&path, baud) {
                            port = again;
                        }
                    }
                });
            }
            Opened::Stdout => {
                let queue = readers.join(head);
                threads.push(thread::spawn(move || {
                    if let Err(error) = queue.pour(io::stdout()) {
                        complain(&name, &error.to_string());
                    }
                }));
            }
            Opened::File(file) => {
                let queue = readers.join(head);
                threads.push(thread::spawn(move || {
                    if let Err(error) = queue.pour(file) {
                        complain(&name, &error.to_string());
                    }
                }));
            }
        }
        Ok(Outlet {
            writer,
            left,
            readers,
            name: outlet_name,
            threads,
        })
    }
}

impl Outlet {
    /// Gives a row; the newest fix is so much older \[s\].
    pub fn row(&mut self, row: &SolutionRow, since_fix: Option<f64>) {
        let without_gnss = is_without_gnss(since_fix);
        // Into memory.
        let _ = self
            .writer
            .write(row, without_gnss)
            .and_then(|()| self.writer.flush());
        let bytes = self.left.take();
        if !bytes.is_empty() {
            self.readers.give(bytes);
        }
    }

    /// Its name, and how many rows its readers did not take in time.
    pub fn dropped(&self) -> (&str, u64) {
        (&self.name, self.readers.dropped())
    }

    /// Waits until what there is was written.
    pub fn finish(self) {
        self.readers.close();
        for thread in self.threads {
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::{
        io::{BufRead, BufReader},
        net::TcpStream,
    };
    use undrift_nav::earth::Geodetic;

    #[test]
    fn outputs_are_read_with_their_formats() {
        let read = |text: &str| {
            text.parse::<Output>()
                .map(|output| (output.target, output.format))
        };
        use SolutionFormat as F;
        assert_eq!(read("-"), Ok((Target::Stdout, F::Csv)));
        assert_eq!(
            read("a/nav.jsonl"),
            Ok((Target::File("a/nav.jsonl".into()), F::JsonLines))
        );
        assert_eq!(
            read("tcp://:2000?format=nmea"),
            Ok((Target::Tcp("127.0.0.1:2000".into()), F::Nmea))
        );
        assert_eq!(
            read("udp://pi:5"),
            Ok((Target::Udp("pi:5".into()), F::JsonLines))
        );
        assert_eq!(
            read("serial:/dev/ttyS0?baud=9600"),
            Ok((Target::Serial("/dev/ttyS0".into(), 9600), F::Nmea))
        );
        for (text, why) in [
            ("nav.kml", "complete only at its end"),
            ("nav", "extension"),
            ("tcp://pi", "address:port"),
            ("http://a:1", "use a file"),
            ("-?form=csv", "available: format"),
        ] {
            let error = read(text).unwrap_err().to_string();
            assert!(error.contains(why), "{error}");
        }
    }

    /// One client reads from its connection on, with the header; one reads nothing, and delays nobody.
    #[test]
    fn a_client_that_reads_nothing_delays_nobody() {
        let free = TcpListener::bind("127.0.0.1:0")
            .unwrap()
            .local_addr()
            .unwrap();
        let output: Output = format!("tcp://{free}?format=csv").parse().unwrap();
        let complain: Complain = Arc::new(|_, _| {});
        let options = SolutionOptions {
            every: Some(0.0),
            ..SolutionOptions::default()
        };
        let place = Place::open(&output).unwrap();
        assert!(Place::open(&output).is_err(), "the port is in use");
        let mut outlet = place.start(&options, &complain).unwrap();
        let _sleeper = TcpStream::connect(free).unwrap();
        let mut reader = BufReader::new(TcpStream::connect(free).unwrap());
        let mut line = String::new();
        reader.read_line(&mut line).unwrap();
        assert!(line.starts_with("time_s,lat_deg"), "{line}");
        let reading = thread::spawn(move || reader.lines().map_while(Result::ok).last());
        let place = Geodetic::from_degrees(40.5, -105.25, 1600.0);
        let begin = std::time::Instant::now();
        for k in 0..200_000 {
            outlet.row(&SolutionRow::at(0.01 * f64::from(k), place), Some(0.5));
        }
        assert!(begin.elapsed() < Duration::from_secs(60));
        assert!(outlet.dropped().1 > 0, "the sleeper's");
        outlet.finish();
        assert!(
            reading
                .join()
                .unwrap()
                .unwrap()
                .starts_with("1999.9900,40.5")
        );
    }
}
