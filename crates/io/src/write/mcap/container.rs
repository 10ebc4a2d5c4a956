//! The container: messages in compressed chunks, each followed by the places of its messages, and at the end a summary
//! that readers find chunks and channels by. MCAP format specification, version 0.

use std::io::{self, Write};

use crate::mcap_records::{MAGIC, crc32, op};

/// A chunk is written when it holds as many bytes before compression.
const CHUNK: usize = 768 << 10;

/// Fields one after the other, little-endian.
#[derive(Default)]
pub(super) struct Fields(Vec<u8>);

impl Fields {
    pub(super) fn bytes(&mut self, bytes: &[u8]) -> &mut Self {
        self.0.extend(bytes);
        self
    }

    pub(super) fn u8(&mut self, value: u8) -> &mut Self {
        self.bytes(&[value])
    }

    pub(super) fn u16(&mut self, value: u16) -> &mut Self {
        self.bytes(&value.to_le_bytes())
    }

    pub(super) fn u32(&mut self, value: u32) -> &mut Self {
        self.bytes(&value.to_le_bytes())
    }

    pub(super) fn u64(&mut self, value: u64) -> &mut Self {
        self.bytes(&value.to_le_bytes())
    }

    /// Bytes after their number: texts, lists and maps as well.
    pub(super) fn counted(&mut self, bytes: &[u8]) -> &mut Self {
        self.u32(bytes.len() as u32).bytes(bytes)
    }

    pub(super) fn text(&mut self, text: &str) -> &mut Self {
        self.counted(text.as_bytes())
    }

    /// As a record.
    pub(super) fn record(&self, kind: u8) -> Vec<u8> {
        let mut record = Self::default();
        record.u8(kind).u64(self.0.len() as u64).bytes(&self.0);
        record.0
    }
}

/// The record of a type of ROS 2; zero means no schema.
pub(super) fn schema(number: u16, type_name: &str, definition: &str) -> Vec<u8> {
    Fields::default()
        .u16(number)
        .text(type_name)
        .text("ros2msg")
        .text(definition)
        .record(op::SCHEMA)
}

/// The record of a channel.
pub(super) fn channel(number: u16, schema: u16, topic: &str, encoding: &str) -> Vec<u8> {
    Fields::default()
        .u16(number)
        .u16(schema)
        .text(topic)
        .text(encoding)
        .counted(&[])
        .record(op::CHANNEL)
}

/// First and last time of messages \[ns\], if there are any.
#[derive(Clone, Copy, Default)]
struct Span(Option<[u64; 2]>);

impl Span {
    fn add(&mut self, time: u64) {
        let [first, last] = self.0.unwrap_or([time; 2]);
        self.0 = Some([first.min(time), last.max(time)]);
    }

    /// Zeros without messages.
    fn times(self) -> [u64; 2] {
        self.0.unwrap_or_default()
    }
}

/// Messages of one topic.
#[derive(Default)]
struct Channel {
    messages: u64,
    /// Time and place of those in the present chunk.
    places: Fields,
}

/// Records of one kind for the summary, and how many.
#[derive(Default)]
struct Group {
    records: Vec<u8>,
    count: u32,
}

impl Group {
    fn add(&mut self, record: &[u8]) {
        self.records.extend(record);
        self.count += 1;
    }
}

/// A file being written.
pub(in crate::write) struct Container<W> {
    out: W,
    /// Bytes written.
    at: u64,
    channels: Vec<Channel>,
    span: Span,
    /// Records of the present chunk.
    chunk: Fields,
    of_chunk: Span,
    schema_records: Group,
    channel_records: Group,
    chunk_indices: Group,
    metadata_indices: Group,
}

impl<W: Write> Container<W> {
    /// Begins a file; `profile` says what the messages are.
    pub(in crate::write) fn new(out: W, profile: &str, library: &str) -> io::Result<Self> {
        let mut this = Self {
            out,
            at: 0,
            channels: Vec::new(),
            span: Span::default(),
            chunk: Fields::default(),
            of_chunk: Span::default(),
            schema_records: Group::default(),
            channel_records: Group::default(),
            chunk_indices: Group::default(),
            metadata_indices: Group::default(),
        };
        this.put(&MAGIC)?;
        let header = Fields::default()
            .text(profile)
            .text(library)
            .record(op::HEADER);
        this.put(&header)?;
        Ok(this)
    }

    fn put(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.out.write_all(bytes)?;
        self.at += bytes.len() as u64;
        Ok(())
    }

    /// The stream.
    #[cfg(test)]
    pub(in crate::write) fn stream(&mut self) -> &mut W {
        &mut self.out
    }

    /// Writes texts by their keys.
    pub(in crate::write) fn metadata(
        &mut self,
        name: &str,
        entries: &[(&str, &str)],
    ) -> io::Result<()> {
        let mut map = Fields::default();
        for (key, value) in entries {
            map.text(key).text(value);
        }
        let record = Fields::default()
            .text(name)
            .counted(&map.0)
            .record(op::METADATA);
        let index = Fields::default()
            .u64(self.at)
            .u64(record.len() as u64)
            .text(name)
            .record(op::METADATA_INDEX);
        self.metadata_indices.add(&index);
        self.put(&record)
    }

    /// Adds a channel for messages of one type of ROS 2, and gives its number.
    pub(in crate::write) fn channel(
        &mut self,
        topic: &str,
        type_name: &str,
        definition: &str,
    ) -> u16 {
        let number = self.channels.len() as u16;
        // Zero means no schema.
        let schema_number = number + 1;
        let schema = schema(schema_number, type_name, definition);
        let channel = channel(number, schema_number, topic, "cdr");
        self.chunk.bytes(&schema).bytes(&channel);
        self.schema_records.add(&schema);
        self.channel_records.add(&channel);
        self.channels.push(Channel::default());
        number
    }

    /// Adds a channel of bytes that no schema describes, and gives its number.
    pub(in crate::write) fn channel_of_bytes(&mut self, topic: &str) -> u16 {
        let number = self.channels.len() as u16;
        let channel = channel(number, 0, topic, "bytes");
        self.chunk.bytes(&channel);
        self.channel_records.add(&channel);
        self.channels.push(Channel::default());
        number
    }

    /// Writes what there is of the present chunk, so that a file that is not finished has it.
    pub(in crate::write) fn flush(&mut self) -> io::Result<()> {
        if !self.chunk.0.is_empty() {
            self.end_chunk()?;
        }
        self.out.flush()
    }

    /// Adds a message of a channel; `time` is Unix time \[ns\].
    pub(in crate::write) fn message(
        &mut self,
        channel: u16,
        sequence: u32,
        time: u64,
        content: &[u8],
    ) -> io::Result<()> {
        let of = &mut self.channels[usize::from(channel)];
        of.messages += 1;
        of.places.u64(time).u64(self.chunk.0.len() as u64);
        self.span.add(time);
        self.of_chunk.add(time);
        // Written straight into the chunk: there are three for each row.
        self.chunk
            .u8(op::MESSAGE)
            .u64(22 + content.len() as u64)
            .u16(channel)
            .u32(sequence)
            .u64(time)
            .u64(time)
            .bytes(content);
        match self.chunk.0.len() < CHUNK {
            true => Ok(()),
            false => self.end_chunk(),
        }
    }

    /// Writes the present chunk and the places of its messages.
    fn end_chunk(&mut self) -> io::Result<()> {
        let size = self.chunk.0.len() as u64;
        let [first, last] = std::mem::take(&mut self.of_chunk).times();
        let (method, packed) = compressed(&self.chunk.0)?;
        let record = Fields::default()
            .u64(first)
            .u64(last)
            .u64(size)
            .u32(crc32(&self.chunk.0))
            .text(method)
            .u64(packed.len() as u64)
            .bytes(&packed)
            .record(op::CHUNK);
        self.chunk.0.clear();
        let start = self.at;
        self.put(&record)?;

        let (mut offsets, mut indices) = (Fields::default(), Vec::new());
        let after = self.at;
        for (number, channel) in (0u16..).zip(&mut self.channels) {
            if channel.places.0.is_empty() {
                continue;
            }
            offsets.u16(number).u64(after + indices.len() as u64);
            let index = Fields::default()
                .u16(number)
                .counted(&channel.places.0)
                .record(op::MESSAGE_INDEX);
            indices.extend(index);
            channel.places.0.clear();
        }
        self.put(&indices)?;
        let index = Fields::default()
            .u64(first)
            .u64(last)
            .u64(start)
            .u64(record.len() as u64)
            .counted(&offsets.0)
            .u64(indices.len() as u64)
            .text(method)
            .u64(packed.len() as u64)
            .u64(size)
            .record(op::CHUNK_INDEX);
        self.chunk_indices.add(&index);
        Ok(())
    }

    fn statistics(&self) -> Vec<u8> {
        let mut counts = Fields::default();
        for (number, channel) in (0u16..).zip(&self.channels) {
            counts.u16(number).u64(channel.messages);
        }
        let [first, last] = self.span.times();
        // No attachments.
        Fields::default()
            .u64(self.channels.iter().map(|channel| channel.messages).sum())
            .u16(self.schema_records.count as u16)
            .u32(self.channel_records.count)
            .u32(0)
            .u32(self.metadata_indices.count)
            .u32(self.chunk_indices.count)
            .u64(first)
            .u64(last)
            .counted(&counts.0)
            .record(op::STATISTICS)
    }

    /// Ends the file and gives `out` back.
    pub(in crate::write) fn finish(mut self) -> io::Result<W> {
        if !self.chunk.0.is_empty() {
            self.end_chunk()?;
        }
        // No checksum of all data.
        self.put(&Fields::default().u32(0).record(op::DATA_END))?;

        let (mut summary, mut offsets) = (Fields::default(), Vec::new());
        for (kind, records) in [
            (op::SCHEMA, &self.schema_records.records),
            (op::CHANNEL, &self.channel_records.records),
            (op::STATISTICS, &self.statistics()),
            (op::CHUNK_INDEX, &self.chunk_indices.records),
            (op::METADATA_INDEX, &self.metadata_indices.records),
        ] {
            if records.is_empty() {
                continue;
            }
            let start = self.at + summary.0.len() as u64;
            let offset = Fields::default()
                .u8(kind)
                .u64(start)
                .u64(records.len() as u64)
                .record(op::SUMMARY_OFFSET);
            offsets.extend(offset);
            summary.bytes(records);
        }
        let offsets_start = self.at + summary.0.len() as u64;
        // The footer: its checksum is of all from the summary's start to itself.
        summary
            .bytes(&offsets)
            .u8(op::FOOTER)
            .u64(20)
            .u64(self.at)
            .u64(offsets_start);
        let checksum = crc32(&summary.0);
        summary.u32(checksum).bytes(&MAGIC);
        self.put(&summary.0)?;
        Ok(self.out)
    }
}

/// Compressed records, and by what method.
#[cfg(not(target_family = "wasm"))]
fn compressed(records: &[u8]) -> io::Result<(&'static str, Vec<u8>)> {
    let packed = zstd::bulk::compress(records, zstd::DEFAULT_COMPRESSION_LEVEL)?;
    Ok(("zstd", packed))
}

/// As they are: no compressor without C.
#[cfg(target_family = "wasm")]
fn compressed(records: &[u8]) -> io::Result<(&'static str, Vec<u8>)> {
    Ok(("", records.to_vec()))
}
