//! Rows in spans with and without GNSS, thinned.

use std::io;

use super::solution::SolutionRow;
use super::text::map_degrees;
use super::thinning::Thinning;

/// A piece of a line.
pub(super) enum Piece<'a> {
    /// A line begins at a row: the first of all or a later one, without GNSS or with it.
    Begin {
        row: &'a SolutionRow,
        first: bool,
        outage: bool,
    },
    /// It goes on.
    Point(&'a SolutionRow),
    /// It ended with the last point; the times of its first and last \[s\].
    End { start: f64, end: f64, outage: bool },
}

/// Makes lines of at least two points of rows: one for each span with or without GNSS, the first
/// row of a span also the last point of the one before. A line that crosses the antimeridian is cut
/// there (RFC 7946, section 3.1.9). The last row is always there.
#[derive(Debug)]
pub(super) struct Spans {
    thinning: Thinning,
    /// The last point, of a line that is open or of one that may follow.
    last: Option<SolutionRow>,
    /// Whether that is without GNSS.
    outage: bool,
    /// Time at which the open line began \[s\].
    start: Option<f64>,
    /// No line has begun.
    first: bool,
    /// The last row, if it was left out.
    left_out: Option<SolutionRow>,
}

impl Spans {
    pub fn new(every: f64) -> Self {
        Self {
            thinning: Thinning::new(every),
            last: None,
            outage: false,
            start: None,
            first: true,
            left_out: None,
        }
    }

    /// Takes a row; one without a finite position is left out.
    pub fn push(
        &mut self,
        row: &SolutionRow,
        outage: bool,
        mut give: impl FnMut(Piece<'_>) -> io::Result<()>,
    ) -> io::Result<()> {
        if !row.has_position() {
            return Ok(());
        }
        let due = self.thinning.takes(row.time);
        if let Some(last) = self.last {
            let [before, after] = [&last, row].map(|row| map_degrees(&row.position)[1]);
            if (after - before).abs() > 180.0 {
                self.end(last.time, &mut give)?;
            } else if due || self.outage != outage {
                self.point(&last, row, &mut give)?;
                if self.outage != outage {
                    self.end(row.time, &mut give)?;
                }
            } else {
                self.left_out = Some(*row);
                return Ok(());
            }
        }
        (self.last, self.outage, self.left_out) = (Some(*row), outage, None);
        Ok(())
    }

    /// Ends the last line.
    pub fn finish(&mut self, mut give: impl FnMut(Piece<'_>) -> io::Result<()>) -> io::Result<()> {
        let Some(last) = self.last.take() else {
            return Ok(());
        };
        let end = self.left_out.take();
        if let Some(row) = &end {
            self.point(&last, row, &mut give)?;
        }
        self.end(end.unwrap_or(last).time, &mut give)
    }

    /// Goes on from the last point to a row, by a new line if none is open.
    fn point(
        &mut self,
        last: &SolutionRow,
        row: &SolutionRow,
        give: &mut impl FnMut(Piece<'_>) -> io::Result<()>,
    ) -> io::Result<()> {
        if self.start.is_none() {
            self.start = Some(last.time);
            give(Piece::Begin {
                row: last,
                first: std::mem::take(&mut self.first),
                outage: self.outage,
            })?;
        }
        give(Piece::Point(row))
    }

    fn end(
        &mut self,
        end: f64,
        give: &mut impl FnMut(Piece<'_>) -> io::Result<()>,
    ) -> io::Result<()> {
        let outage = self.outage;
        match self.start.take() {
            Some(start) => give(Piece::End { start, end, outage }),
            None => Ok(()),
        }
    }
}
