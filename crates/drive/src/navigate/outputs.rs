//! The files of a solution, and where it was without GNSS.

use std::io;
use undrift_io::write::{SolutionFile, solution::SolutionRow};

/// A solution is without GNSS when the last fix that was used is older than this \[s\].
pub const FRESH: f64 = 2.0;

/// The files of a solution. While the fixes come, a span without GNSS is known [`FRESH`] after it began;
/// once they have ended, for a smoothed solution, from its beginning.
pub(super) struct Outputs {
    files: Vec<SolutionFile>,
    /// The last fix used \[s\], or where the solution began.
    last: Option<f64>,
    /// Spans without GNSS \[s\], in order; each is longer than [`FRESH`].
    spans: Vec<(f64, f64)>,
    ended: bool,
}

impl Outputs {
    pub fn new(files: Vec<SolutionFile>) -> Self {
        Self {
            files,
            last: None,
            spans: Vec::new(),
            ended: false,
        }
    }

    pub fn is_empty(&self) -> bool {
        self.files.is_empty()
    }

    /// The solution has reached `time` \[s\].
    pub fn begin(&mut self, time: f64) {
        self.last.get_or_insert(time);
    }

    /// A fix at `time` \[s\] was used.
    pub fn fix(&mut self, time: f64) {
        if let Some(last) = self.last.replace(time)
            && time - last > FRESH
        {
            self.spans.push((last, time));
        }
    }

    /// No fix follows.
    pub fn fixes_end(&mut self) {
        self.ended = true;
    }

    fn without_gnss(&self, time: f64) -> bool {
        let stale = self.last.is_some_and(|last| time - last > FRESH);
        if !self.ended || stale {
            return stale;
        }
        let next = self.spans.partition_point(|(_, end)| *end <= time);
        self.spans.get(next).is_some_and(|(start, _)| time > *start)
    }

    pub fn write(&mut self, row: &SolutionRow) -> io::Result<()> {
        self.begin(row.time);
        let outage = self.without_gnss(row.time);
        self.files
            .iter_mut()
            .try_for_each(|file| file.write(row, outage))
    }

    /// Gives the files their names.
    pub fn finish(self) -> io::Result<()> {
        self.files.into_iter().try_for_each(SolutionFile::finish)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_are_known_later_while_the_fixes_come() {
        let mut outputs = Outputs::new(Vec::new());
        outputs.begin(0.0);
        for time in [1.0, 2.0, 3.0] {
            outputs.fix(time);
            assert!(!outputs.without_gnss(time + 2.0) && outputs.without_gnss(time + 2.1));
        }
        for time in [10.0, 11.0] {
            outputs.fix(time);
        }
        assert!(!outputs.without_gnss(5.0), "the past is not looked up");
        outputs.fixes_end();
        let without = |time| outputs.without_gnss(time);
        assert_eq!(
            [2.5, 3.0, 3.1, 9.9, 10.0, 11.0].map(without),
            [false, false, true, true, false, false]
        );
        assert!(!without(13.0) && without(13.1));
    }
}
