//! Recordings of what came while a vehicle drove, as [`crate::write::recording`] writes them.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

use crate::ReadError;
use crate::log::mcap;
use crate::log::{Container, Event, Events};
use crate::source;
use crate::write::recording::{SOURCE, TEXT};

/// A recording, opened: its texts and sources, and an iterator of what came.
pub struct Recording {
    /// Texts by their names.
    pub texts: BTreeMap<String, String>,
    /// Names of the sources.
    pub sources: Vec<String>,
    container: Container,
    /// What the channels of the file are.
    channels: BTreeMap<u32, Channel>,
    /// The first message, which was read to know all of the channels.
    first: Option<Arrived>,
    name: std::path::PathBuf,
}

enum Channel {
    Text(String),
    Source(usize),
}

/// What came from a source.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Arrived {
    /// Number of the source.
    pub source: usize,
    /// When \[ns\], of a clock that goes on.
    pub at: u64,
    /// What.
    pub bytes: Vec<u8>,
}

impl Recording {
    /// Opens a file; `None` of a file that is no recording of this kind.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn open(path: &Path) -> Result<Option<Self>, ReadError> {
        let source = source::open(path)?;
        let Ok(container) = mcap::open(source) else {
            return Ok(None);
        };
        let mut this = Self {
            texts: BTreeMap::new(),
            sources: Vec::new(),
            container,
            channels: BTreeMap::new(),
            first: None,
            name: path.to_path_buf(),
        };
        this.first = this.read()?;
        Ok((!this.sources.is_empty()).then_some(this))
    }

    /// The next message of a source.
    fn read(&mut self) -> Result<Option<Arrived>, ReadError> {
        loop {
            let event = self.container.next();
            match event.map_err(|error| error.in_log(&self.name))? {
                None => return Ok(None),
                Some(Event::Topic(topic)) => self.declare(topic.number, &topic.name),
                Some(Event::Message {
                    number,
                    time: (seconds, nanos),
                    bytes,
                }) => {
                    let at = seconds.unsigned_abs() * 1_000_000_000 + u64::from(nanos);
                    if let Some(arrived) = self.message(number, at, bytes) {
                        return Ok(Some(arrived));
                    }
                }
                // What breaks off was not yet written when the run ended.
                Some(Event::Skipped(..)) => {}
            }
        }
    }

    fn declare(&mut self, number: u32, topic: &str) {
        if self.channels.contains_key(&number) {
            return;
        }
        if let Some(name) = topic.strip_prefix(TEXT) {
            self.channels.insert(number, Channel::Text(name.to_owned()));
        } else if let Some(name) = topic.strip_prefix(SOURCE) {
            let source = Channel::Source(self.sources.len());
            self.channels.insert(number, source);
            self.sources.push(name.to_owned());
        }
    }

    fn message(&mut self, number: u32, at: u64, bytes: Range<usize>) -> Option<Arrived> {
        let bytes = self.container.bytes(bytes);
        match self.channels.get(&number)? {
            Channel::Text(name) => {
                let text = String::from_utf8_lossy(bytes).into_owned();
                self.texts.insert(name.clone(), text);
                None
            }
            Channel::Source(source) => Some(Arrived {
                source: *source,
                at,
                bytes: bytes.to_vec(),
            }),
        }
    }
}

impl Iterator for Recording {
    type Item = Result<Arrived, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        match self.first.take() {
            Some(first) => Some(Ok(first)),
            None => self.read().transpose(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::write::recording::RecordingWriter;

    fn written(cut: bool) -> Vec<u8> {
        let texts = [("drive", "[imu]\n"), ("interval", "0.01")];
        let mut writer = RecordingWriter::new(Vec::new(), &texts, &["imu", "gnss"]).unwrap();
        writer.write(0, 5, b"t,gx\n1,2").unwrap();
        writer.write(1, 1_500_000_007, &[0xb5, 0x62, 0]).unwrap();
        writer.flush().unwrap();
        writer.write(0, 1_500_000_009, b"\n").unwrap();
        assert!(writer.write(2, 0, b"").is_err());
        match cut {
            false => writer.finish().unwrap(),
            true => std::mem::take(writer.stream()),
        }
    }

    fn read(bytes: &[u8], name: &str) -> Option<(Recording, Vec<Arrived>)> {
        let path = std::env::temp_dir().join(format!("undrift-{}-{name}", std::process::id()));
        std::fs::write(&path, bytes).unwrap();
        let mut recording = Recording::open(&path).unwrap()?;
        let all = recording.by_ref().collect::<Result<_, _>>().unwrap();
        std::fs::remove_file(&path).unwrap();
        Some((recording, all))
    }

    #[test]
    fn what_was_recorded_is_read_back_in_order() {
        let (recording, all) = read(&written(false), "recorded.mcap").unwrap();
        assert_eq!(recording.sources, ["imu", "gnss"]);
        assert_eq!(recording.texts["drive"], "[imu]\n");
        assert_eq!(recording.texts["interval"], "0.01");
        let arrived = |source, at, bytes: &[u8]| Arrived {
            source,
            at,
            bytes: bytes.to_vec(),
        };
        let whole = [
            arrived(0, 5, b"t,gx\n1,2"),
            arrived(1, 1_500_000_007, &[0xb5, 0x62, 0]),
            arrived(0, 1_500_000_009, b"\n"),
        ];
        assert_eq!(all, whole);
        // Of one that was never finished, what was handed over.
        let (recording, all) = read(&written(true), "cut.mcap").unwrap();
        assert_eq!((recording.sources.len(), &all[..]), (2, &whole[..2]));
        assert!(read(b"t,gx,gy\n", "table.csv").is_none());
    }
}
