use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// A file that appears under its name only when it is finished: until then it is beside it under
/// a temporary name. Dropped unfinished, it is removed; a killed process leaves the temporary one.
#[derive(Debug)]
pub struct PendingFile {
    file: File,
    target: PathBuf,
    temporary: PathBuf,
    finished: bool,
}

impl PendingFile {
    /// Starts a file; one that is already there stays untouched until [`PendingFile::finish`].
    ///
    /// # Errors
    /// If the directory cannot be written to, or the path names no file.
    pub fn create(path: &Path) -> io::Result<Self> {
        let Some(name) = path.file_name() else {
            return Err(io::Error::new(
                io::ErrorKind::InvalidInput,
                format!("{} names no file", path.display()),
            ));
        };
        let mut hidden = OsString::from(".");
        hidden.push(name);
        hidden.push(format!(".part{}", std::process::id()));
        let temporary = path.with_file_name(hidden);
        Ok(Self {
            file: File::create(&temporary)?,
            target: path.to_path_buf(),
            temporary,
            finished: false,
        })
    }

    /// Gives the file its name, replacing one that is there.
    ///
    /// # Errors
    /// If what was written cannot be brought to the disk or the file cannot be renamed.
    pub fn finish(mut self) -> io::Result<()> {
        self.file.sync_data()?;
        fs::rename(&self.temporary, &self.target)?;
        self.finished = true;
        Ok(())
    }
}

/// Writes a file whole or not at all, replacing one that is there.
///
/// # Errors
/// If it cannot be written; what was under the name is still there then.
pub fn write_whole(path: &Path, content: impl AsRef<[u8]>) -> io::Result<()> {
    let mut file = PendingFile::create(path)?;
    file.write_all(content.as_ref())?;
    file.finish()
}

impl Write for PendingFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Seek for PendingFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

impl Drop for PendingFile {
    fn drop(&mut self) {
        if !self.finished {
            // Nothing can be done about a file that cannot be removed.
            let _ = fs::remove_file(&self.temporary);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_holds_the_old_file_or_the_whole_new_one() {
        let dir = std::env::temp_dir().join(format!("undrift-io-pending-{}", std::process::id()));
        fs::create_dir_all(&dir).unwrap();
        let path = dir.join("out.csv");
        fs::write(&path, "old").unwrap();

        let mut dropped = PendingFile::create(&path).unwrap();
        dropped.write_all(b"half").unwrap();
        drop(dropped);
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");

        let mut whole = PendingFile::create(&path).unwrap();
        whole.write_all(b"new").unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        whole.finish().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
        assert_eq!(fs::read_dir(&dir).unwrap().count(), 1);
        fs::remove_dir_all(&dir).unwrap();

        assert!(PendingFile::create(&path).is_err());
        assert!(PendingFile::create(Path::new("/")).is_err());
    }
}
