//! The container: messages in compressed chunks, each followed by the places of its messages, and at the end a summary
//! that readers find chunks and channels by. MCAP format specification, version 0.

use std::io::{self, Write};

use flate2::Crc;

use crate::mcap_records::{MAGIC, op};

/// A chunk is written when it holds as many bytes before compression.
const CHUNK: usize = 768 << 10;

/// Fields one after the other, little-endian.
#[derive(Default)]
struct Fields(Vec<u8>);

impl Fields {
    fn with(mut self, bytes: &[u8]) -> Self {
        self.0.extend(bytes);
        self
    }

    fn u8(self, value: u8) -> Self {
        self.with(&[value])
    }

    fn u16(self, value: u16) -> Self {
        self.with(&value.to_le_bytes())
    }

    fn u32(self, value: u32) -> Self {
        self.with(&value.to_le_bytes())
    }

    fn u64(self, value: u64) -> Self {
        self.with(&value.to_le_bytes())
    }

    /// Bytes after their number: texts, lists and maps as well.
    fn counted(self, bytes: &[u8]) -> Self {
        self.u32(bytes.len() as u32).with(bytes)
    }

    fn text(self, text: &str) -> Self {
        self.counted(text.as_bytes())
    }

    /// As a record.
    fn record(&self, kind: u8) -> Vec<u8> {
        let content = Self::default().u8(kind).u64(self.0.len() as u64);
        content.with(&self.0).0
    }
}

/// First and last time of messages \[ns\].
#[derive(Clone, Copy)]
struct Span([u64; 2]);

impl Span {
    fn with(span: Option<Self>, time: u64) -> Option<Self> {
        let Self([first, last]) = span.unwrap_or(Self([time; 2]));
        Some(Self([first.min(time), last.max(time)]))
    }

    fn times(span: Option<Self>) -> [u64; 2] {
        span.map_or([0; 2], |span| span.0)
    }
}

/// A file being written.
pub(super) struct Container<W> {
    out: W,
    /// Bytes written.
    at: u64,
    /// Records of the present chunk.
    chunk: Vec<u8>,
    of_chunk: Option<Span>,
    /// Of each channel, time and place of its messages in the present chunk.
    places: Vec<Fields>,
    /// Records for the summary.
    schemas: Vec<u8>,
    channels: Vec<u8>,
    metadata: Vec<u8>,
    chunks: Vec<u8>,
    /// How many there are.
    metadata_count: u32,
    chunk_count: u32,
    messages: Vec<u64>,
    span: Option<Span>,
}

impl<W: Write> Container<W> {
    /// Begins a file; `profile` says what the messages are.
    pub(super) fn new(out: W, profile: &str, library: &str) -> io::Result<Self> {
        let mut this = Self {
            out,
            at: 0,
            chunk: Vec::new(),
            of_chunk: None,
            places: Vec::new(),
            schemas: Vec::new(),
            channels: Vec::new(),
            metadata: Vec::new(),
            chunks: Vec::new(),
            metadata_count: 0,
            chunk_count: 0,
            messages: Vec::new(),
            span: None,
        };
        this.put(&MAGIC)?;
        let header = Fields::default().text(profile).text(library);
        this.put(&header.record(op::HEADER))?;
        Ok(this)
    }

    fn put(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.out.write_all(bytes)?;
        self.at += bytes.len() as u64;
        Ok(())
    }

    /// Writes texts by their keys.
    pub(super) fn metadata(&mut self, name: &str, entries: &[(&str, &str)]) -> io::Result<()> {
        let add = |fields: Fields, (key, value): &(&str, &str)| fields.text(key).text(value);
        let map = entries.iter().fold(Fields::default(), add);
        let record = Fields::default().text(name).counted(&map.0);
        let record = record.record(op::METADATA);
        let index = Fields::default().u64(self.at).u64(record.len() as u64);
        let index = index.text(name).record(op::METADATA_INDEX);
        self.metadata.extend(index);
        self.metadata_count += 1;
        self.put(&record)
    }

    /// Adds a channel for messages of one type of ROS 2, and gives its number.
    pub(super) fn channel(&mut self, topic: &str, type_name: &str, definition: &str) -> u16 {
        let channel = self.messages.len() as u16;
        // Zero stands for no schema.
        let number = channel + 1;
        let schema = Fields::default().u16(number).text(type_name);
        let schema = schema.text("ros2msg").text(definition).record(op::SCHEMA);
        let record = Fields::default().u16(channel).u16(number).text(topic);
        let record = record.text("cdr").counted(&[]).record(op::CHANNEL);
        self.chunk.extend(&schema);
        self.chunk.extend(&record);
        self.schemas.extend(schema);
        self.channels.extend(record);
        self.messages.push(0);
        self.places.push(Fields::default());
        channel
    }

    /// Adds a message of a channel; `time` is Unix time \[ns\].
    pub(super) fn message(
        &mut self,
        channel: u16,
        sequence: u32,
        time: u64,
        content: &[u8],
    ) -> io::Result<()> {
        let at = self.chunk.len() as u64;
        let head = Fields(std::mem::take(&mut self.chunk)).u8(op::MESSAGE);
        let head = head.u64(22 + content.len() as u64);
        let head = head.u16(channel).u32(sequence).u64(time).u64(time);
        self.chunk = head.with(content).0;
        let place = &mut self.places[usize::from(channel)];
        *place = std::mem::take(place).u64(time).u64(at);
        self.messages[usize::from(channel)] += 1;
        self.of_chunk = Span::with(self.of_chunk, time);
        self.span = Span::with(self.span, time);
        match self.chunk.len() < CHUNK {
            true => Ok(()),
            false => self.end_chunk(),
        }
    }

    /// Writes the present chunk and the places of its messages.
    fn end_chunk(&mut self) -> io::Result<()> {
        let mut checksum = Crc::new();
        checksum.update(&self.chunk);
        let size = self.chunk.len() as u64;
        let (method, packed) = packed(&self.chunk)?;
        let packed_size = packed.len() as u64;
        let [first, last] = Span::times(self.of_chunk.take());
        let record = Fields::default().u64(first).u64(last).u64(size);
        let record = record.u32(checksum.sum()).text(method);
        let record = record.u64(packed_size).with(&packed).record(op::CHUNK);
        self.chunk.clear();
        let start = self.at;
        self.put(&record)?;

        let (mut offsets, before) = (Fields::default(), self.at);
        for channel in 0..self.places.len() {
            let places = std::mem::take(&mut self.places[channel]);
            if !places.0.is_empty() {
                offsets = offsets.u16(channel as u16).u64(self.at);
                let index = Fields::default().u16(channel as u16).counted(&places.0);
                self.put(&index.record(op::MESSAGE_INDEX))?;
            }
        }
        let index = Fields::default().u64(first).u64(last);
        let index = index.u64(start).u64(record.len() as u64);
        let index = index.counted(&offsets.0).u64(self.at - before);
        let index = index.text(method).u64(packed_size).u64(size);
        self.chunks.extend(index.record(op::CHUNK_INDEX));
        self.chunk_count += 1;
        Ok(())
    }

    fn statistics(&self) -> Vec<u8> {
        let channels = self.messages.len();
        let numbered = (0u16..).zip(&self.messages);
        let add = |fields: Fields, (channel, &count)| fields.u16(channel).u64(count);
        let counts = numbered.fold(Fields::default(), add);
        let [first, last] = Span::times(self.span);
        // A schema for each channel; no attachments.
        Fields::default()
            .u64(self.messages.iter().sum())
            .u16(channels as u16)
            .u32(channels as u32)
            .u32(0)
            .u32(self.metadata_count)
            .u32(self.chunk_count)
            .u64(first)
            .u64(last)
            .counted(&counts.0)
            .record(op::STATISTICS)
    }

    /// Ends the file and gives `out` back.
    pub(super) fn finish(mut self) -> io::Result<W> {
        if !self.chunk.is_empty() {
            self.end_chunk()?;
        }
        // No checksum of all data.
        self.put(&Fields::default().u32(0).record(op::DATA_END))?;

        let (mut summary, mut offsets) = (Vec::new(), Vec::new());
        let groups = [
            (op::SCHEMA, std::mem::take(&mut self.schemas)),
            (op::CHANNEL, std::mem::take(&mut self.channels)),
            (op::STATISTICS, self.statistics()),
            (op::CHUNK_INDEX, std::mem::take(&mut self.chunks)),
            (op::METADATA_INDEX, std::mem::take(&mut self.metadata)),
        ];
        for (kind, records) in groups.iter().filter(|(_, records)| !records.is_empty()) {
            let start = self.at + summary.len() as u64;
            let offset = Fields::default().u8(*kind).u64(start);
            let offset = offset.u64(records.len() as u64);
            offsets.extend(offset.record(op::SUMMARY_OFFSET));
            summary.extend(records);
        }
        let (start, end) = (self.at, self.at + summary.len() as u64);
        summary.extend(offsets);
        // The checksum is of all from the summary's start to itself.
        let footer = Fields::default().u64(start).u64(end).u32(0);
        summary.extend(footer.record(op::FOOTER));
        summary.truncate(summary.len() - size_of::<u32>());
        let mut checksum = Crc::new();
        checksum.update(&summary);
        summary.extend(checksum.sum().to_le_bytes());
        summary.extend(MAGIC);
        self.put(&summary)?;
        Ok(self.out)
    }
}

/// Compressed records, and by what method.
#[cfg(not(target_family = "wasm"))]
fn packed(records: &[u8]) -> io::Result<(&'static str, Vec<u8>)> {
    let packed = zstd::bulk::compress(records, zstd::DEFAULT_COMPRESSION_LEVEL)?;
    Ok(("zstd", packed))
}

/// As they are: no compressor without C.
#[cfg(target_family = "wasm")]
fn packed(records: &[u8]) -> io::Result<(&'static str, Vec<u8>)> {
    Ok(("", records.to_vec()))
}
