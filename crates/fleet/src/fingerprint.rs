//! What an outcome depends on, as one number.

use super::{Job, Task};
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};
use undrift_base::hash;
use undrift_drive::drive;
use undrift_io::Opened;
use undrift_noise::ImuModel;

/// What outcomes are like: another number makes all of them out of date.
const FORMAT: u32 = 2;

/// The files that a job reads: what each is for, and where it is. Files that a drive file names but that
/// are missing are among them.
pub fn inputs(job: &Job) -> Vec<(String, PathBuf)> {
    let path = job.path();
    let mut inputs = vec![(job.task.name().to_owned(), path.clone())];
    let is_file = |model: &str| !ImuModel::preset_names().contains(&model);
    if let Some(model) = job.model.as_ref().filter(|model| is_file(model)) {
        inputs.push(("stated model".into(), Path::new(&job.folder).join(model)));
    }
    if matches!(job.task, Task::Identify(_)) {
        return inputs;
    }
    let (home, data) = job.folders();
    let text = std::fs::read_to_string(&path).unwrap_or_default();
    for (key, name) in drive::files_named(&text) {
        let folder = match key {
            "model" if job.model.is_some() || !is_file(&name) => continue,
            "model" => &home,
            _ => &data,
        };
        inputs.push((key.to_owned(), folder.join(name)));
    }
    for name in drive::files_beside(&text) {
        inputs.push((format!("observations {name}"), data.join(name)));
    }
    inputs
}

/// SHA-256, hexadecimal, of all that the outcome of a job depends on: the job without its folders, the
/// contents of the files that it reads, the version of this program. It is the name of the outcome: the
/// same name, the same outcome. A file that cannot be read counts as such.
pub fn fingerprint(job: &Job) -> String {
    let mut sum = Sha256::new();
    let version = env!("CARGO_PKG_VERSION");
    sum.update(format!("undrift {version}, fleet {FORMAT}\n"));
    let placeless = Job {
        folder: String::new(),
        data: None,
        drive: None,
        ..job.clone()
    };
    // A job is text and numbers: it can always be written.
    sum.update(serde_json::to_string(&placeless).unwrap_or_default());
    for (key, path) in inputs(job) {
        // A bag may be a folder of several files.
        for file in Opened::files(&path) {
            let content = hash::of_file(&file).unwrap_or_else(|error| error.kind().to_string());
            sum.update(format!("\n{key} {content}"));
        }
    }
    hash::hexadecimal(sum)
}
