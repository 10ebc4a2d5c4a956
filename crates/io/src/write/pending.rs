use std::ffi::{OsStr, OsString};
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A file that appears under its name only when it is finished: until then it is beside it under
/// a temporary name, `.NAME.partPID`. Dropped unfinished, it is removed; a process that is killed without
/// [`remove_unfinished`] leaves the temporary one, which goes when the same file is written again an hour later or more (on Linux, where
/// it is known that the process has ended).
///
/// A symbolic link stays and the file that it leads to is replaced; a file that is replaced hands on its
/// permissions. Devices, pipes and open descriptors (`/dev/null`, `/dev/stdout`, `/dev/fd/3`) are written
/// into as they are. `-` is standard output.
#[derive(Debug)]
pub struct PendingFile {
    file: File,
    /// Where to; without it the bytes go straight into what is there.
    replacing: Option<Replacing>,
}

/// Temporary files of this process.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes all unfinished files, for a process that is about to end: from here on none can be started or finished.
pub fn remove_unfinished() {
    let mut files = unfinished();
    for file in files.drain(..) {
        // Nothing can be done about a file that cannot be removed.
        let _ = fs::remove_file(file);
    }
    std::mem::forget(files);
}

/// The temporary file and the name that it gets.
#[derive(Debug)]
struct Replacing {
    target: PathBuf,
    temporary: PathBuf,
    finished: bool,
}

impl PendingFile {
    /// Starts a file; one that is already there stays untouched until [`PendingFile::finish`].
    ///
    /// # Errors
    /// If the directory cannot be written to, the device or pipe cannot be opened, the file is read-only, or the path
    /// names no file.
    pub fn create(path: &Path) -> io::Result<Self> {
        let (target, descriptor) = followed(path)?;
        let there = fs::metadata(&target).ok();
        if descriptor.is_some() || there.as_ref().is_some_and(|it| !it.is_file()) {
            return Ok(Self {
                file: open(&target, descriptor)?,
                replacing: None,
            });
        }
        if there.as_ref().is_some_and(|it| it.permissions().readonly()) {
            let message = "it is read-only; choose another name";
            return Err(io::Error::new(io::ErrorKind::PermissionDenied, message));
        }
        let Some(name) = target.file_name() else {
            return Err(io::Error::new(
                io::ErrorKind::InvalidInput,
                format!("{} is not a file name", path.display()),
            ));
        };
        let mut hidden = OsString::from(".");
        hidden.push(name);
        hidden.push(".part");
        remove_stale(&target, &hidden);
        hidden.push(process().to_string());
        let temporary = target.with_file_name(hidden);
        let mut files = unfinished();
        let file = File::create(&temporary)?;
        files.push(temporary.clone());
        drop(files);
        let file = Self {
            file,
            replacing: Some(Replacing {
                target,
                temporary,
                finished: false,
            }),
        };
        // WebAssembly has no permissions.
        if let Some(there) = there.filter(|_| cfg!(not(target_family = "wasm"))) {
            file.file.set_permissions(there.permissions())?;
        }
        Ok(file)
    }

    /// Gives the file its name, replacing one that is there.
    ///
    /// # Errors
    /// If what was written cannot be brought to the disk or the file cannot be renamed.
    pub fn finish(mut self) -> io::Result<()> {
        match &mut self.replacing {
            None => self.file.flush(),
            Some(replacing) => {
                self.file.sync_data()?;
                let mut files = unfinished();
                fs::rename(&replacing.temporary, &replacing.target)?;
                files.retain(|file| *file != replacing.temporary);
                replacing.finished = true;
                Ok(())
            }
        }
    }
}

/// The number of this process; WebAssembly has none.
fn process() -> u32 {
    match cfg!(target_family = "wasm") {
        true => 0,
        false => std::process::id(),
    }
}

/// Symbolic links that may lead from one to the next, as in Linux.
const LINKS: usize = 40;

/// Where symbolic links lead, and the number of the open descriptor if they lead to one
/// (`/dev/stdout`, `/dev/fd/N`): what is open must not be replaced under the one that opened it.
fn followed(path: &Path) -> io::Result<(PathBuf, Option<u32>)> {
    if path == Path::new("-") {
        return Ok((path.to_path_buf(), Some(1)));
    }
    let descriptors = fs::canonicalize("/dev/fd").ok();
    let mut path = path.to_path_buf();
    for _ in 0..LINKS {
        let folder = path.parent().map(Path::to_path_buf).unwrap_or_default();
        if descriptors.is_some() && fs::canonicalize(&folder).ok() == descriptors {
            let number = path
                .file_name()
                .and_then(|name| name.to_str()?.parse().ok());
            return Ok((path, number));
        }
        match fs::read_link(&path) {
            Ok(next) => path = folder.join(next),
            Err(_) => return Ok((path, None)),
        }
    }
    let message = format!("{}: too many symbolic links", path.display());
    Err(io::Error::new(io::ErrorKind::InvalidInput, message))
}

/// Opens what is no file that could be replaced: the standard streams as they are, at their position.
fn open(path: &Path, descriptor: Option<u32>) -> io::Result<File> {
    #[cfg(unix)]
    {
        use std::os::fd::AsFd;
        let copy = |stream: &dyn AsFd| stream.as_fd().try_clone_to_owned().map(File::from);
        match descriptor {
            Some(1) => return copy(&io::stdout()),
            Some(2) => return copy(&io::stderr()),
            _ => {}
        }
    }
    #[cfg(not(unix))]
    let _ = descriptor;
    OpenOptions::new().append(true).open(path)
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

/// Elsewhere it is not known which processes live.
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

impl Drop for PendingFile {
    fn drop(&mut self) {
        if let Some(replacing) = &self.replacing
            && !replacing.finished
        {
            // Nothing can be done about a file that cannot be removed.
            let _ = fs::remove_file(&replacing.temporary);
            unfinished().retain(|file| *file != replacing.temporary);
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
    #[cfg(unix)]
    fn links_stay_and_permissions_are_kept() {
        use std::os::unix::fs::{PermissionsExt, symlink};

        let dir = std::env::temp_dir().join(format!("undrift-io-links-{}", std::process::id()));
        fs::create_dir_all(dir.join("deep")).unwrap();
        let real = dir.join("deep/real.csv");
        fs::write(&real, "old").unwrap();
        fs::set_permissions(&real, fs::Permissions::from_mode(0o640)).unwrap();
        symlink("deep/real.csv", dir.join("first")).unwrap();
        symlink("first", dir.join("second")).unwrap();
        symlink("deep/not-yet.csv", dir.join("dangling")).unwrap();
        symlink("round", dir.join("round")).unwrap();

        write_whole(&dir.join("second"), "new").unwrap();
        write_whole(&dir.join("dangling"), "made").unwrap();
        assert!(write_whole(&dir.join("round"), "").is_err());
        assert_eq!(fs::read_to_string(&real).unwrap(), "new");
        assert_eq!(
            fs::metadata(&real).unwrap().permissions().mode() & 0o777,
            0o640
        );
        assert_eq!(
            fs::read_to_string(dir.join("deep/not-yet.csv")).unwrap(),
            "made"
        );
        for link in ["first", "second", "dangling", "round"] {
            assert!(dir.join(link).is_symlink(), "{link}");
        }
        assert_eq!(fs::read_dir(dir.join("deep")).unwrap().count(), 2);
        fs::remove_dir_all(&dir).unwrap();
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn devices_and_pipes_are_written_into() {
        use std::io::Read;
        use std::os::fd::AsRawFd;
        use std::os::unix::fs::FileTypeExt;

        write_whole(Path::new("/dev/null"), "nothing").unwrap();
        let null = fs::metadata("/dev/null").unwrap();
        assert!(null.file_type().is_char_device());

        let (mut reader, writer) = io::pipe().unwrap();
        let path = PathBuf::from(format!("/dev/fd/{}", writer.as_raw_fd()));
        let mut file = PendingFile::create(&path).unwrap();
        file.write_all(b"through").unwrap();
        file.finish().unwrap();
        drop(writer);
        let mut text = String::new();
        reader.read_to_string(&mut text).unwrap();
        assert_eq!(text, "through");

        // An open file is added to: whoever opened it still holds the same one.
        let dir = std::env::temp_dir().join(format!("undrift-io-open-{}", std::process::id()));
        fs::create_dir_all(&dir).unwrap();
        let mut held = File::create(dir.join("held")).unwrap();
        held.write_all(b"first, ").unwrap();
        let path = PathBuf::from(format!("/dev/fd/{}", held.as_raw_fd()));
        write_whole(&path, "then").unwrap();
        assert_eq!(fs::read_to_string(dir.join("held")).unwrap(), "first, then");
        assert_eq!(fs::read_dir(&dir).unwrap().count(), 1);
        assert!(PendingFile::create(&dir).is_err());
        fs::remove_dir_all(&dir).unwrap();
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
            // Another file's, and names that this program does not give.
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
