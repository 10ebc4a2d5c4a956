//! Places of a drive's logs: a folder, or memory.

use super::{
    error::{ConfigError, DriveError},
    keys,
};
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};
use undrift_config::Section;
use undrift_io::{
    Memory, Opened, ReadError,
    format::{FORMATS, Format},
    gnss::RinexFile,
    reader::{Kind, Reader},
    source::BytesRead,
};

/// Folder or memory that a drive's logs are in, and the part of them that is read.
#[derive(Clone, Debug, Default)]
pub struct Logs {
    /// Folder that the names of files are relative to.
    pub folder: PathBuf,
    /// First and last time that is read \[s\], in the logs' time base; all of it if absent.
    pub span: Option<(f64, f64)>,
    /// Logs in memory by the names that stand in the place of files: columns, and what pipes and standard
    /// input had, since a drive is read more than once.
    pub memory: BTreeMap<PathBuf, Memory>,
}

impl Logs {
    /// Opens the log `path` from its start; `read` counts its bytes.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn open(&self, path: &Path, read: &BytesRead) -> Result<Opened, ReadError> {
        match self.memory.get(path) {
            Some(held) => Opened::memory(path, held.clone(), read),
            None => Opened::counted(path, read),
        }
    }

    /// Opens the log `path` and reads its records from its start, of the kind `K`: samples, fixes, numbers, truth.
    ///
    /// # Errors
    /// If the file cannot be opened, is not of its format or lacks a column or stream.
    pub fn read<K: Kind>(&self, path: &Path, options: &K::Options) -> Result<Reader<K>, ReadError> {
        Reader::new(self.open(path, &BytesRead::default())?, options)
    }

    /// The log that a table names by `file`; what cannot be opened again is held in memory.
    pub(super) fn named(&mut self, section: &Section) -> Result<PathBuf, DriveError> {
        let name = keys::file_name(section, "file")?;
        self.held(name)
            .map_err(|error| cannot(section, "file", error))
    }

    /// The files that a list of names has, in the same way.
    pub(super) fn beside<'a>(
        &mut self,
        section: &Section<'a>,
        key: &'a str,
    ) -> Result<Vec<RinexFile>, DriveError> {
        let one = |name| {
            let path = self.held(name);
            let path = path.map_err(|error| cannot(section, key, error))?;
            let held = self.memory.get(&path).cloned();
            Ok((path, held))
        };
        section.texts(key)?.into_iter().map(one).collect()
    }

    fn held(&mut self, name: &str) -> Result<PathBuf, ReadError> {
        let path = match name {
            "-" => PathBuf::from("-"),
            name => self.folder.join(name),
        };
        if !self.memory.contains_key(&path)
            && let Some(held) = Opened::hold(&path)?
        {
            self.memory.insert(path.clone(), held);
        }
        Ok(path)
    }

    /// The format of a log, and the number of its columns where that identifies them: the format is
    /// stated; a table of named columns where the key `column` is there; else known by the content.
    pub(super) fn format<'a>(
        &self,
        section: &Section<'a>,
        path: &Path,
        column: &'a str,
    ) -> Result<(Format, usize), DriveError> {
        let words = FORMATS.map(|(name, format, _)| (name, format));
        let stated = section.word("format", &words)?;
        let named = section.get(column).map(|_| Format::Csv);
        match stated.or(named) {
            Some(format) if format != Format::KfGins => Ok((format, 0)),
            known => {
                let opened = self.open(path, &BytesRead::default());
                let opened = opened.map_err(|error| cannot(section, "file", error))?;
                Ok((known.unwrap_or_else(|| opened.format()), opened.width()))
            }
        }
    }
}

fn cannot(section: &Section, key: &str, error: ReadError) -> DriveError {
    let at: ConfigError = section.error(key, "");
    DriveError::Log {
        at,
        error: error.into(),
    }
}
