//! Whether the times of a log go forward.

use crate::ReadError;
use crate::skipped::{SkipKind, Skipped};

/// Times beyond this are no times of a log \[s\]: 30 000 years.
const MAX_TIME: f64 = 1e12;

/// Records in a row that are behind for the clock to have been set back, rather than records that overtook others.
const SET_BACK: u32 = 5;
/// Spells of records that others overtook from which on the rows are unsorted, and a longer spell is one more of them.
const UNSORTED: u32 = 3;

/// Keeps the time of the last accepted record and what came out of order after it.
pub(crate) struct Clock {
    last: Option<f64>,
    first_line: u64,
    /// Records accepted so far.
    accepted: u64,
    /// Records in a row earlier than `last` that mean the clock was set back for good.
    patience: u32,
    behind: u32,
    /// How often records were behind and later ones not.
    overtaken: u32,
    jump_line: u64,
    jump_to: f64,
    /// The last record behind, and whether each was earlier than the one before.
    behind_at: f64,
    descends: bool,
}

/// A record's place in time.
pub(crate) enum Tick {
    /// Accepted; the time since the last accepted record \[s\], `None` for the first.
    Forward(Option<f64>),
    /// Left out and counted.
    Skip,
}

impl Clock {
    /// A clock that is patient for so many records.
    pub(crate) fn new(patience: u32) -> Self {
        Self {
            last: None,
            first_line: 0,
            accepted: 0,
            patience,
            behind: 0,
            overtaken: 0,
            jump_line: 0,
            jump_to: 0.0,
            behind_at: 0.0,
            descends: false,
        }
    }

    /// Judges the time \[s\] of the record on `line`.
    ///
    /// # Errors
    /// When the clock has stayed behind for as many records as its patience.
    #[inline]
    pub(crate) fn tick(
        &mut self,
        time: f64,
        line: u64,
        skipped: &mut Skipped,
    ) -> Result<Tick, ReadError> {
        if time.is_nan() || time.abs() > MAX_TIME {
            skipped.add(SkipKind::OutOfRange, line, format_args!("time {time} s"));
            return Ok(Tick::Skip);
        }
        let Some(last) = self.last else {
            (self.last, self.first_line, self.accepted) = (Some(time), line, 1);
            return Ok(Tick::Forward(None));
        };
        if time > last {
            self.last = Some(time);
            self.accepted += 1;
            self.overtaken += u32::from(self.behind > 0);
            self.behind = 0;
            return Ok(Tick::Forward(Some(time - last)));
        }
        if time == last {
            skipped.add(SkipKind::DuplicateTime, line, format_args!("{time} s"));
            return Ok(Tick::Skip);
        }
        if self.behind == 0 {
            (self.jump_line, self.jump_to) = (line, time);
            (self.behind_at, self.descends) = (last, true);
        }
        self.descends &= time < self.behind_at;
        self.behind_at = time;
        self.behind += 1;
        skipped.add(
            SkipKind::TimeBackwards,
            line,
            format_args!("{time} s after {last} s"),
        );
        if self.behind == SET_BACK && self.overtaken < UNSORTED {
            skipped.set_back(self.jump_line, last - self.jump_to);
        }
        if self.behind >= self.patience {
            return Err(self.set_back(last));
        }
        Ok(Tick::Skip)
    }

    fn set_back(&self, last: f64) -> ReadError {
        if self.accepted == 1 && self.descends {
            let problem = format!(
                "the rows are in reverse order ({last} s in line {}, then {} s)",
                self.first_line, self.jump_to
            );
            return ReadError::nameless(problem).mend("sort them by time");
        }
        let jump = self.jump_to - last;
        let mend = if (jump + 604_800.0).abs() < 60.0 {
            "the GPS week rolls over here: add 604800 s to the later times"
        } else if (jump + 86_400.0).abs() < 60.0 {
            "the day rolls over here: add 86400 s to the later times"
        } else {
            "split the file there, or remove the earlier rows with wrong times"
        };
        ReadError::nameless(format!(
            "time jumps back by {:.3} s, from {last} s to {} s, and does not recover",
            -jump, self.jump_to
        ))
        .at(self.jump_line)
        .mend(mend)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(times: &[f64], patience: u32) -> (Vec<f64>, Skipped, Option<ReadError>) {
        let (mut clock, mut skipped) = (Clock::new(patience), Skipped::default());
        let mut accepted = Vec::new();
        for (k, &time) in times.iter().enumerate() {
            match clock.tick(time, k as u64 + 1, &mut skipped) {
                Ok(Tick::Forward(_)) => accepted.push(time),
                Ok(Tick::Skip) => {}
                Err(error) => return (accepted, skipped, Some(error)),
            }
        }
        (accepted, skipped, None)
    }

    #[test]
    fn single_setbacks_are_skipped() {
        let (accepted, skipped, error) = run(&[1.0, 2.0, 2.0, 1.5, 3.0, 1e300, 4.0], 2);
        assert_eq!(accepted, [1.0, 2.0, 3.0, 4.0]);
        assert_eq!(skipped.count(SkipKind::DuplicateTime), 1);
        assert_eq!(skipped.count(SkipKind::TimeBackwards), 1);
        assert_eq!(skipped.count(SkipKind::OutOfRange), 1);
        assert!(error.is_none());
    }

    #[test]
    fn a_clock_that_goes_on_from_an_earlier_time_was_set_back() {
        let rows =
            |back: f64| (0..40).map(move |k| 0.1 * k as f64 - if k < 20 { 0.0 } else { back });
        let (accepted, skipped, error) = run(&rows(0.75).collect::<Vec<_>>(), 20);
        assert!(error.is_none());
        assert_eq!(accepted.len(), 33);
        let found = skipped.largest_set_back().unwrap();
        assert_eq!(found.line, 21);
        assert!((found.step - 0.65).abs() < 1e-9, "{found:?}");
        // Records that overtook others.
        let (_, skipped, _) = run(&rows(0.35).collect::<Vec<_>>(), 20);
        assert_eq!(skipped.largest_set_back(), None);
    }

    /// Rows that several threads write, now and then five behind, are not those of a clock that is set back.
    #[test]
    fn unsorted_rows_are_no_clock_that_was_set_back() {
        let set_back = |spells: usize| {
            let spell = |k: usize| [10.0 * k as f64 + 1.0, 10.0 * k as f64];
            let mut times = Vec::from_iter((0..spells).flat_map(spell));
            times.extend((0..7).map(|k| [99.0, 90.0][k.min(1)] + 0.1 * k as f64));
            times.push(100.0);
            run(&times, 20).1.largest_set_back().is_some()
        };
        assert!(set_back(0) && set_back(2));
        assert!(!set_back(3));
    }

    #[test]
    fn a_clock_set_back_for_good_is_an_error_that_names_the_jump() {
        let (_, _, error) = run(&[604_799.0, 604_799.5, 0.0, 0.5, 1.0], 3);
        let error = error.unwrap();
        assert_eq!(error.line, Some(3));
        assert!(
            error.to_string().contains("back by 604799.500 s"),
            "{error}"
        );
        assert!(error.to_string().contains("GPS week"), "{error}");
    }

    #[test]
    fn rows_in_reverse_order_are_not_a_clock_that_was_set_back() {
        let reversed = |times: &[f64]| {
            let (_, _, error) = run(times, 4);
            error.unwrap().to_string().contains("reverse order")
        };
        assert!(reversed(&[5.0, 4.5, 4.0, 3.5, 3.0]));
        // A file after another, and a first row with a wrong time.
        assert!(!reversed(&[4.0, 5.0, 4.5, 4.0, 3.5, 3.0]));
        assert!(!reversed(&[5.0, 0.0, 0.5, 1.0, 1.5]));
    }
}
