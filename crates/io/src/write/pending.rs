use std::ffi::{OsStr, OsString};
use std::fs::{self, File};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// A file that appears under its name only when it is finished: until then it is beside it under
/// a temporary name, `.NAME.partPID`. Dropped unfinished, it is removed; a killed process leaves the
/// temporary one, which goes when the same file is written again an hour later or more (on Linux, where
/// it can be told that the process is no more).
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
        hidden.push(".part");
        remove_stale(path, &hidden);
        hidden.push(std::process::id().to_string());
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

/// A temporary file that was written to within this may be that of a process on another machine, or in
/// another container, whose number says nothing here.
#[cfg(target_os = "linux")]
const STALE: std::time::Duration = std::time::Duration::from_secs(3600);

/// Removes what killed processes left beside `path` under names of `start` and a process id. Only files
/// of this user: processes of others may be hidden.
#[cfg(target_os = "linux")]
fn remove_stale(path: &Path, start: &OsStr) {
    use std::os::unix::fs::MetadataExt;

    let folder = match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let (Ok(entries), Ok(own)) = (fs::read_dir(folder), fs::metadata("/proc/self")) else {
        return;
    };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let process = name
            .as_encoded_bytes()
            .strip_prefix(start.as_encoded_bytes());
        let Some(process) = process.and_then(|id| str::from_utf8(id).ok()?.parse::<u32>().ok())
        else {
            continue;
        };
        let gone = matches!(
            Path::new(&format!("/proc/{process}")).try_exists(),
            Ok(false)
        );
        if gone
            && entry.metadata().is_ok_and(|file| {
                let age = file.modified().ok().and_then(|time| time.elapsed().ok());
                file.is_file() && file.uid() == own.uid() && age.is_some_and(|age| age > STALE)
            })
        {
            // What cannot be removed harms nobody.
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Elsewhere it cannot be told which processes live.
#[cfg(not(target_os = "linux"))]
fn remove_stale(_: &Path, _: &OsStr) {}

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

    #[test]
    #[cfg(target_os = "linux")]
    fn what_a_dead_process_left_goes_and_that_of_a_living_one_stays() {
        use std::process::Command;

        let dir = std::env::temp_dir().join(format!("undrift-io-stale-{}", std::process::id()));
        fs::create_dir_all(&dir).unwrap();
        let mut dead = Command::new("true").spawn().unwrap();
        dead.wait().unwrap();
        let mut living = Command::new("sleep").arg("600").spawn().unwrap();
        let put = |name: String| {
            let file = File::create(dir.join(name)).unwrap();
            file.set_modified(std::time::SystemTime::now() - 2 * STALE)
                .unwrap();
        };
        put(format!(".out.csv.part{}", dead.id()));
        let others = [
            format!(".out.csv.part{}", living.id()),
            // Another file's, and names that are none of ours.
            format!(".out.csv.gz.part{}", dead.id()),
            format!(".out.csv.part{}x", dead.id()),
            ".out.csv.part".to_owned(),
        ];
        others.iter().cloned().for_each(put);

        write_whole(&dir.join("out.csv"), "new").unwrap();
        living.kill().unwrap();
        living.wait().unwrap();
        let names = fs::read_dir(&dir).unwrap();
        let mut names: Vec<_> = names
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect();
        let mut expected = others.to_vec();
        expected.push("out.csv".to_owned());
        names.sort();
        expected.sort();
        fs::remove_dir_all(&dir).unwrap();
        assert_eq!(names, expected);
    }
}
