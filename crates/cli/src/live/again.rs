//! `undrift navigate run.mcap`: the solution of a recorded run again.

use super::say;
use anyhow::{Result, bail};
use std::path::Path;
use undrift::{SolutionRow, drive::Drive, io::write::SolutionFile};
use undrift_live::{
    Notice, Sink,
    plan::{self, Plan},
    session::is_without_gnss,
};

/// A recording of `undrift live --record`.
pub struct Recorded {
    plan: Plan,
    recording: undrift::io::recording::Recording,
}

impl Recorded {
    /// The recording at a path; `None` of anything else.
    pub fn open(path: &Path) -> Result<Option<Self>> {
        let is_named_so = path
            .extension()
            .is_some_and(|extension| extension.eq_ignore_ascii_case("mcap"));
        if !is_named_so || !path.is_file() {
            return Ok(None);
        }
        let opened = plan::recorded(path)?;
        Ok(opened.map(|(plan, recording)| Self { plan, recording }))
    }

    /// The run again: its rows to the files that `open` gives once the drive is known. A line about the solution.
    pub fn navigate(
        self,
        open: &mut dyn FnMut(&Drive) -> Result<Vec<SolutionFile>>,
    ) -> Result<String> {
        let mut session = self.plan.session()?;
        let mut again = Again {
            open,
            files: Vec::new(),
            failed: None,
            rows: 0,
            first: 0.0,
            last: None,
        };
        for arrival in self.recording {
            session.take(&arrival?, &mut again)?;
            if let Some(error) = again.failed.take() {
                return Err(error);
            }
        }
        let Some(last) = again.last else {
            bail!("no solution: {}", say::without_solution(&session));
        };
        for file in again.files {
            file.finish()?;
        }
        let [north, east, down, ..] = last.nav_std;
        Ok(format!(
            "the live run again: {} rows, {:.1} to {:.1} s; σ at the end {north:.2}, {east:.2}, {down:.2} m north, east, down",
            again.rows, again.first, last.time
        ))
    }
}

struct Again<'a> {
    open: &'a mut dyn FnMut(&Drive) -> Result<Vec<SolutionFile>>,
    files: Vec<SolutionFile>,
    failed: Option<anyhow::Error>,
    rows: u64,
    first: f64,
    last: Option<SolutionRow>,
}

impl Sink for Again<'_> {
    fn ready(&mut self, drive: &Drive) {
        match (self.open)(drive) {
            Ok(files) => self.files = files,
            Err(error) => self.failed = Some(error),
        }
    }

    fn row(&mut self, row: &SolutionRow, since_fix: Option<f64>) {
        if self.rows == 0 {
            self.first = row.time;
        }
        self.rows += 1;
        self.last = Some(*row);
        let without_gnss = is_without_gnss(since_fix);
        let mut files = self.files.iter_mut();
        if let Err(error) = files.try_for_each(|file| file.write(row, without_gnss)) {
            self.failed.get_or_insert(error.into());
        }
    }

    fn notice(&mut self, time: Option<f64>, notice: Notice) {
        if say::is_worth_a_word(&notice) {
            say::print(time, &say::notice(&notice), say::is_warning(&notice));
        }
    }
}
