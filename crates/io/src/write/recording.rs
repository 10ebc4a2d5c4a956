//! What came from sources while a vehicle drove, byte by byte with the times of arrival, as MCAP: a channel of bytes for each
//! source and each text that belongs to the run. [`crate::recording`] reads it.

use std::io::{self, Write};

use super::mcap::container::Container;

/// What messages of the file are, by its header.
pub(crate) const PROFILE: &str = "undrift";
/// Begins the topic of a source; those of texts begin otherwise.
pub(crate) const SOURCE: &str = "/undrift/source/";
/// Begins the topic of a text.
pub(crate) const TEXT: &str = "/undrift/text/";

/// Writes a recording. A file that is not finished can be read up to the last [`RecordingWriter::flush`].
pub struct RecordingWriter<W: Write> {
    out: Container<W>,
    sources: Vec<u16>,
    messages: u32,
}

impl<W: Write> RecordingWriter<W> {
    /// Starts with texts by their names, such as that of the drive file, and the names of the sources.
    ///
    /// # Errors
    /// If `out` does not take them.
    pub fn new(out: W, texts: &[(&str, &str)], sources: &[&str]) -> io::Result<Self> {
        let library = concat!("undrift ", env!("CARGO_PKG_VERSION"));
        let mut out = Container::new(out, PROFILE, library)?;
        for (name, text) in texts {
            let channel = out.channel_of_bytes(&format!("{TEXT}{name}"));
            out.message(channel, 0, 0, text.as_bytes())?;
        }
        let topics = sources.iter().map(|name| format!("{SOURCE}{name}"));
        let sources = topics.map(|topic| out.channel_of_bytes(&topic)).collect();
        let mut this = Self {
            out,
            sources,
            messages: 0,
        };
        this.flush()?;
        Ok(this)
    }

    /// Adds what came from a source, by its number in the list of the sources, at a time of arrival \[ns\].
    ///
    /// # Errors
    /// If the stream does not take it, or there is no such source.
    pub fn write(&mut self, source: usize, at: u64, bytes: &[u8]) -> io::Result<()> {
        let Some(channel) = self.sources.get(source) else {
            let problem = format!("no source of number {source}");
            return Err(io::Error::new(io::ErrorKind::InvalidInput, problem));
        };
        self.messages = self.messages.wrapping_add(1);
        self.out.message(*channel, self.messages, at, bytes)
    }

    /// Hands over what has come so far.
    ///
    /// # Errors
    /// If the stream does not take it.
    pub fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }

    /// The stream, with what was handed over.
    #[cfg(test)]
    pub(crate) fn stream(&mut self) -> &mut W {
        self.out.stream()
    }

    /// Ends the file and gives the stream back.
    ///
    /// # Errors
    /// If the stream does not take it.
    pub fn finish(self) -> io::Result<W> {
        self.out.finish()
    }
}
