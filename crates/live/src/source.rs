//! Where bytes come from: serial ports, sockets, pipes.

use crate::Arrival;
use serial2::SerialPort;
use std::{
    fmt,
    fs::File,
    io::{self, BufRead, BufReader, Read, Write},
    net::{TcpStream, ToSocketAddrs, UdpSocket},
    path::PathBuf,
    str::FromStr,
    sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel},
    thread,
    time::{Duration, Instant},
};

/// Baud rate of a serial port unless stated.
const BAUD: u32 = 115_200;
/// Port of gpsd.
const GPSD: u16 = 2947;
/// From one attempt to open a source to the next \[s\], at first and at most.
const BACK_OFF: [f64; 2] = [0.25, 5.0];
/// Bytes that are read at once.
const PIECE: usize = 4096;
/// Pieces that may wait: where the session cannot follow, the operating system's own buffers fill.
const WAITING: usize = 4096;
/// Longest a read waits on a port that gives nothing \[s\].
const READ: f64 = 1.0;
/// Longest an attempt to connect lasts \[s\].
const CONNECT: f64 = 5.0;

/// A source of bytes.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Source {
    /// A serial port and its baud rate.
    Serial(PathBuf, u32),
    /// A server, `host:port`.
    Tcp(String),
    /// Datagrams that come to an address, `address:port`.
    Udp(String),
    /// The raw bytes of the receivers of a gpsd, `host:port`.
    Gpsd(String),
    /// Standard input.
    Stdin,
    /// A file, FIFO or device, read once.
    File(PathBuf),
    /// Topics of ROS 2, `/imu,/fix?domain=0`, opened by what the program brings along for that.
    Ros2(String),
}

/// Opens topics of ROS 2, as they are written behind `ros2:`, as a stream of MCAP.
pub type OpenRos2 = fn(&str) -> io::Result<Box<dyn Read + Send>>;

/// What is no source.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("\"{0}\" is no source: {1}")]
pub struct SourceError(pub String, pub String);

/// The ways to write a source.
pub const SOURCES: &str = "serial:/dev/ttyACM0?baud=115200, tcp://host:port, udp://:port, gpsd://host:2947, ros2:/topic, - (standard input) or a FIFO";

impl FromStr for Source {
    type Err = SourceError;

    fn from_str(text: &str) -> Result<Self, SourceError> {
        let wrong = |why: &str| SourceError(text.to_owned(), why.to_owned());
        let address = |rest: &str, usual: Option<u16>| match (rest.rsplit_once(':'), usual) {
            (Some((host, port)), _) if port.parse::<u16>().is_ok() => Ok(format!("{host}:{port}")),
            (None, Some(port)) if !rest.is_empty() => Ok(format!("{rest}:{port}")),
            _ => Err(wrong("host:port is expected behind //")),
        };
        if text == "-" {
            Ok(Self::Stdin)
        } else if let Some(rest) = text.strip_prefix("serial:") {
            let (path, baud) = serial(rest).map_err(|why| wrong(&why))?;
            Ok(Self::Serial(path, baud))
        } else if let Some(rest) = text.strip_prefix("tcp://") {
            address(rest, None).map(Self::Tcp)
        } else if let Some(rest) = text.strip_prefix("udp://") {
            let address = address(rest, None)?;
            // All addresses of this machine.
            Ok(Self::Udp(match address.strip_prefix(':') {
                Some(port) => format!("0.0.0.0:{port}"),
                None => address,
            }))
        } else if let Some(rest) = text.strip_prefix("gpsd://") {
            let rest = rest.trim_end_matches('/');
            let host = if rest.is_empty() { "localhost" } else { rest };
            address(host, Some(GPSD)).map(Self::Gpsd)
        } else if let Some(topics) = text.strip_prefix("ros2:") {
            match topics.starts_with('/') {
                true => Ok(Self::Ros2(topics.to_owned())),
                false => Err(wrong(
                    "topics are expected behind it, such as ros2:/imu/data",
                )),
            }
        } else if text.contains("://") || text.is_empty() {
            Err(wrong(&format!("use {SOURCES}")))
        } else {
            Ok(Self::File(text.into()))
        }
    }
}

/// Of a program that was built without what ROS 2 needs.
pub const WITHOUT_ROS2: &str =
    "this undrift is without ROS 2: cargo install undrift-cli --features ros2";

/// Path and baud rate of `/dev/ttyACM0?baud=115200`.
///
/// # Errors
/// What is wrong with it.
pub(crate) fn serial(rest: &str) -> Result<(PathBuf, u32), String> {
    let (path, options) = rest.split_once('?').unwrap_or((rest, ""));
    let mut baud = BAUD;
    for option in options.split('&').filter(|option| !option.is_empty()) {
        match option.split_once('=') {
            Some(("baud", value)) => {
                let value = value.parse().ok().filter(|value| *value > 0);
                baud = value.ok_or("baud is a number, such as 115200")?;
            }
            // Of an output.
            Some(("format", _)) => {}
            _ => return Err(format!("unknown option \"{option}\"; available: baud")),
        }
    }
    match path {
        "" => Err("the port is missing, such as /dev/ttyACM0".into()),
        path => Ok((path.into(), baud)),
    }
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Serial(path, baud) => write!(f, "serial:{}?baud={baud}", path.display()),
            Self::Tcp(address) => write!(f, "tcp://{address}"),
            Self::Udp(address) => write!(f, "udp://{address}"),
            Self::Gpsd(address) => write!(f, "gpsd://{address}"),
            Self::Stdin => write!(f, "-"),
            Self::File(path) => write!(f, "{}", path.display()),
            Self::Ros2(topics) => write!(f, "ros2:{topics}"),
        }
    }
}

impl Source {
    /// Whether it can be opened again where it ends.
    fn comes_back(&self) -> bool {
        !matches!(self, Self::Stdin | Self::File(_))
    }

    /// Opens it for reading; a read gives what there is, 0 bytes at its end, and an error of kind `TimedOut` or
    /// `WouldBlock` where nothing came for long.
    ///
    /// # Errors
    /// If it cannot be opened.
    pub fn open(&self, ros2: Option<OpenRos2>) -> io::Result<Box<dyn Read + Send>> {
        let wait = Duration::from_secs_f64(READ);
        match self {
            Self::Serial(path, baud) => {
                let mut port = SerialPort::open(path, *baud)?;
                port.set_read_timeout(wait)?;
                Ok(Box::new(port))
            }
            Self::Tcp(address) => Ok(Box::new(connect(address)?)),
            Self::Udp(address) => {
                let socket = UdpSocket::bind(address)?;
                socket.set_read_timeout(Some(wait))?;
                Ok(Box::new(Datagrams(socket)))
            }
            Self::Gpsd(address) => watch(connect(address)?),
            Self::Stdin => Ok(Box::new(io::stdin())),
            Self::File(path) => Ok(Box::new(File::open(path)?)),
            Self::Ros2(topics) => match ros2 {
                Some(open) => open(topics),
                None => Err(io::Error::new(io::ErrorKind::Unsupported, WITHOUT_ROS2)),
            },
        }
    }
}

fn connect(address: &str) -> io::Result<TcpStream> {
    let mut failed = io::Error::new(io::ErrorKind::NotFound, "the host has no address");
    for address in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, Duration::from_secs_f64(CONNECT)) {
            Ok(stream) => {
                stream.set_nodelay(true)?;
                stream.set_read_timeout(Some(Duration::from_secs_f64(READ)))?;
                return Ok(stream);
            }
            Err(error) => failed = error,
        }
    }
    Err(failed)
}

/// Asks a gpsd for the bytes of its receivers as they are; its own words before them are passed over.
fn watch(stream: TcpStream) -> io::Result<Box<dyn Read + Send>> {
    (&stream).write_all(b"?WATCH={\"enable\":true,\"json\":false,\"raw\":2}\n")?;
    let mut reader = BufReader::new(stream);
    let mut line = Vec::new();
    loop {
        match reader.read_until(b'\n', &mut line) {
            Ok(0) => {
                let problem = "gpsd closed the connection before it answered";
                return Err(io::Error::new(io::ErrorKind::UnexpectedEof, problem));
            }
            // Its words come at once, or not at all.
            Err(error) if is_patient(&error) => break,
            Err(error) => return Err(error),
            Ok(_) if !line.starts_with(b"{") => break,
            Ok(_) => {
                let answers = line.windows(15).any(|part| part == b"\"class\":\"WATCH\"");
                line.clear();
                if answers {
                    break;
                }
            }
        }
    }
    Ok(Box::new(io::Cursor::new(line).chain(reader)))
}

/// Whether a read only has nothing yet.
fn is_patient(error: &io::Error) -> bool {
    use io::ErrorKind as Kind;
    matches!(
        error.kind(),
        Kind::Interrupted | Kind::TimedOut | Kind::WouldBlock
    )
}

/// Datagrams one after the other.
struct Datagrams(UdpSocket);

impl Read for Datagrams {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.0.recv(buffer)
    }
}

/// What happens at the sources.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Happened {
    /// Bytes came.
    Bytes(Arrival),
    /// A source cannot be opened or was lost, and why; it is tried again.
    Lost(usize, String),
    /// It is open, for the first time or again.
    Open(usize),
    /// It ended for good.
    Ended(usize),
}

/// Sources that are read, each on a thread of its own; a source that is lost is opened again.
pub struct Sources {
    happened: Receiver<Happened>,
}

impl Sources {
    /// Opens and reads them. Times of arrival \[ns\] are those of this machine's clock when it starts, and go on from there
    /// whatever is done to that clock.
    pub fn open(sources: &[Source], start: u64, ros2: Option<OpenRos2>) -> Self {
        let (sender, happened) = sync_channel(WAITING);
        let begin = Instant::now();
        for (number, source) in sources.iter().cloned().enumerate() {
            let sender = sender.clone();
            let now = move || start + begin.elapsed().as_nanos() as u64;
            thread::spawn(move || {
                read(
                    &|| source.open(ros2),
                    source.comes_back(),
                    number,
                    &now,
                    &sender,
                )
            });
        }
        Self { happened }
    }

    /// What happens next; `None` where nothing did for so long. An error once all sources have ended.
    ///
    /// # Errors
    /// [`AllEnded`].
    pub fn next(&self, wait: Duration) -> Result<Option<Happened>, AllEnded> {
        match self.happened.recv_timeout(wait) {
            Ok(happened) => Ok(Some(happened)),
            Err(RecvTimeoutError::Timeout) => Ok(None),
            Err(RecvTimeoutError::Disconnected) => Err(AllEnded),
        }
    }
}

/// Every source has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("all sources have ended")]
pub struct AllEnded;

/// Reads a source until it ends for good or nobody listens.
fn read(
    open: &dyn Fn() -> io::Result<Box<dyn Read + Send>>,
    comes_back: bool,
    number: usize,
    now: &dyn Fn() -> u64,
    sender: &SyncSender<Happened>,
) {
    let [first, most] = BACK_OFF;
    let (mut back_off, mut said) = (first, None);
    loop {
        let why = match open() {
            Err(error) => error.to_string(),
            Ok(mut stream) => {
                if sender.send(Happened::Open(number)).is_err() {
                    return;
                }
                said = None;
                let (got, why) = pass_on(&mut stream, number, now, sender);
                let Some(why) = why else { return };
                if !comes_back {
                    // Whoever listened may be gone.
                    let _ = sender.send(Happened::Ended(number));
                    return;
                }
                if got {
                    back_off = first;
                }
                why
            }
        };
        if said.as_ref() != Some(&why) {
            said = Some(why.clone());
            if sender.send(Happened::Lost(number, why)).is_err() {
                return;
            }
        }
        thread::sleep(Duration::from_secs_f64(back_off));
        back_off = (2.0 * back_off).min(most);
    }
}

/// Why a stream is read no more where it came to its end.
const END: &str = "it was closed";

/// Passes on what a stream gives: whether there was anything, and why it ended; `None` if nobody listens.
fn pass_on(
    stream: &mut dyn Read,
    number: usize,
    now: &dyn Fn() -> u64,
    sender: &SyncSender<Happened>,
) -> (bool, Option<String>) {
    let (mut buffer, mut got) = ([0; PIECE], false);
    loop {
        match stream.read(&mut buffer) {
            Ok(0) => return (got, Some(END.into())),
            Ok(n) => {
                got = true;
                let bytes = buffer.get(..n).unwrap_or_default().to_vec();
                let arrival = Arrival {
                    source: number,
                    at: now(),
                    bytes,
                };
                if sender.send(Happened::Bytes(arrival)).is_err() {
                    return (got, None);
                }
            }
            Err(error) if is_patient(&error) => {}
            Err(error) => return (got, Some(error.to_string())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::net::TcpListener;

    #[test]
    fn sources_are_read_and_written_alike() {
        for text in [
            "serial:/dev/ttyACM0?baud=9600",
            "tcp://pi:4001",
            "udp://0.0.0.0:5000",
            "gpsd://pi:2947",
            "-",
            "/tmp/fifo",
            "ros2:/imu/data,/fix?domain=3",
        ] {
            let source: Source = text.parse().unwrap();
            assert_eq!(source.to_string(), text);
        }
        let read = |text: &str| text.parse::<Source>();
        assert_eq!(
            read("serial:/dev/ttyS0"),
            Ok(Source::Serial("/dev/ttyS0".into(), 115_200))
        );
        assert_eq!(read("udp://:7"), Ok(Source::Udp("0.0.0.0:7".into())));
        assert_eq!(read("gpsd://"), Ok(Source::Gpsd("localhost:2947".into())));
        for (text, why) in [
            ("tcp://pi", "host:port"),
            ("serial:", "missing"),
            ("serial:/dev/x?boud=1", "available: baud"),
            ("http://pi:1", "use serial:"),
            ("ros2:imu", "topics are expected"),
        ] {
            let error = read(text).unwrap_err().to_string();
            assert!(error.contains(why), "{error}");
        }
    }

    /// The server closes after each piece: the source is opened again, and what comes is in order.
    #[test]
    fn a_source_that_is_lost_is_opened_again() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap().to_string();
        thread::spawn(move || {
            for piece in [b"one", b"two"] {
                let (mut stream, _) = listener.accept().unwrap();
                stream.write_all(piece).unwrap();
            }
        });
        let sources = Sources::open(&[Source::Tcp(address)], 7, None);
        let mut seen = Vec::new();
        let mut bytes = Vec::new();
        while bytes != b"onetwo" {
            match sources.next(Duration::from_secs(10)).unwrap().unwrap() {
                Happened::Bytes(arrival) => {
                    assert!(arrival.at > 7);
                    bytes.extend(arrival.bytes);
                    seen.push("bytes");
                }
                Happened::Lost(0, why) => {
                    assert_eq!(why, END);
                    seen.push("lost");
                }
                Happened::Open(0) => seen.push("open"),
                other => panic!("{other:?}"),
            }
        }
        seen.dedup();
        assert_eq!(seen, ["open", "bytes", "lost", "open", "bytes"]);
    }

    #[test]
    fn the_words_of_gpsd_before_the_bytes_are_passed_over() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap().to_string();
        let server = thread::spawn(move || {
            let (mut stream, _) = listener.accept().unwrap();
            stream.write_all(b"{\"class\":\"VERSION\"}\r\n").unwrap();
            let mut asked = String::new();
            BufReader::new(stream.try_clone().unwrap())
                .read_line(&mut asked)
                .unwrap();
            stream
                .write_all(b"{\"class\":\"DEVICES\"}\n{\"class\":\"WATCH\",\"raw\":2}\n\xb5b")
                .unwrap();
            asked
        });
        let mut stream = Source::Gpsd(address).open(None).unwrap();
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes).unwrap();
        assert_eq!(bytes, b"\xb5b");
        assert!(server.join().unwrap().contains("\"raw\":2"));
    }
}
