//! Rows in spans with and without GNSS, thinned.

use std::io;

use super::solution::SolutionRow;
use super::text::map_degrees;
use super::thinning::Thinning;

/// What a format of lines is told.
pub(super) enum Step<'a> {
    /// A line begins: with this first row, without GNSS or with it.
    Begin(&'a SolutionRow, bool),
    /// It goes on.
    Point(&'a SolutionRow),
    /// It ended with the last point.
    End(&'a SolutionRow, bool),
}

/// Makes lines of at least two points of rows: one for each span with or without GNSS, the first
/// row of a span also the last point of the one before. A line that crosses the antimeridian is cut
/// there (RFC 7946, section 3.1.9). The last row is always there.
#[derive(Debug)]
pub(super) struct Spans {
    thinning: Thinning,
    /// The last point, whether it is part of a line already, and of which kind the line is.
    last: Option<(SolutionRow, bool, bool)>,
    /// The last row, if it was left out.
    left_out: Option<SolutionRow>,
}

impl Spans {
    pub fn new(every: f64) -> Self {
        Self {
            thinning: Thinning::new(every),
            last: None,
            left_out: None,
        }
    }

    /// Takes a row; one without a finite position is left out.
    pub fn push(
        &mut self,
        row: &SolutionRow,
        outage: bool,
        mut tell: impl FnMut(Step<'_>) -> io::Result<()>,
    ) -> io::Result<()> {
        if !row.has_position() {
            return Ok(());
        }
        let due = self.thinning.takes(row.time);
        let Some((last, open, kind)) = self.last else {
            self.last = Some((*row, false, outage));
            return Ok(());
        };
        let [before, after] = [&last, row].map(|row| map_degrees(&row.position)[1]);
        let cut = (after - before).abs() > 180.0;
        if cut {
            if open {
                tell(Step::End(&last, kind))?;
            }
            self.last = Some((*row, false, outage));
            self.left_out = None;
        } else if due || kind != outage {
            if !open {
                tell(Step::Begin(&last, kind))?;
            }
            tell(Step::Point(row))?;
            if kind != outage {
                tell(Step::End(row, kind))?;
            }
            self.last = Some((*row, kind == outage, outage));
            self.left_out = None;
        } else {
            self.left_out = Some(*row);
        }
        Ok(())
    }

    /// Ends the last line.
    pub fn finish(&mut self, mut tell: impl FnMut(Step<'_>) -> io::Result<()>) -> io::Result<()> {
        let Some((last, open, kind)) = self.last.take() else {
            return Ok(());
        };
        let end = self.left_out.take();
        if let Some(row) = &end {
            if !open {
                tell(Step::Begin(&last, kind))?;
            }
            tell(Step::Point(row))?;
        }
        if open || end.is_some() {
            tell(Step::End(end.as_ref().unwrap_or(&last), kind))?;
        }
        Ok(())
    }
}
