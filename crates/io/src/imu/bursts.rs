//! Rows that share a time stamp, as a serial or USB port delivers them in bursts, spread evenly over the time to the next
//! stamp.

use super::Values;
use crate::skipped::{SkipKind, Skipped};
use std::collections::VecDeque;

/// A step this many times the one before is a gap, or a burst of which rows are missing.
const GAP: f64 = 1.5;

/// Collects the rows of one stamp, and gives them with times of their own once the next stamps are known.
#[derive(Default)]
pub(super) struct Bursts {
    /// Rows that share the stamp \[s\].
    burst: Option<(f64, Vec<Values>)>,
    /// The first burst, until the step of the second is known, and where it ends \[s\].
    first: Option<(f64, Vec<Values>)>,
    /// Time between rows of the last burst \[s\].
    step: Option<f64>,
    ready: VecDeque<(f64, Values)>,
}

impl Bursts {
    /// Takes in the next row; one that repeats the row before, stamp and values, is counted.
    pub(super) fn row(&mut self, line: u64, stamp: f64, values: Values, skipped: &mut Skipped) {
        match &mut self.burst {
            Some((time, rows)) if *time == stamp => {
                let same = rows
                    .last()
                    .is_some_and(|last| last.gyro == values.gyro && last.accel == values.accel);
                if same {
                    skipped.add(SkipKind::DuplicateTime, line, format_args!("{stamp} s"));
                } else {
                    rows.push(values);
                }
            }
            _ => {
                self.ends(Some(stamp));
                self.burst = Some((stamp, vec![values]));
            }
        }
    }

    /// The next row with its own time \[s\].
    pub(super) fn next(&mut self) -> Option<(f64, Values)> {
        self.ready.pop_front()
    }

    /// The same after the last row of the log.
    pub(super) fn last(&mut self) -> Option<(f64, Values)> {
        self.ends(None);
        self.next()
    }

    /// The burst ends where the next one begins \[s\].
    fn ends(&mut self, next: Option<f64>) {
        let Some((time, rows)) = self.burst.take() else {
            return;
        };
        let own = next
            .map(|next| (next - time) / rows.len() as f64)
            .filter(|step| *step > 0.0 && step.is_finite());
        let before = self
            .first
            .as_ref()
            .map(|(from, rows)| (time - from) / rows.len() as f64);
        let Some(usual) = self.step.or(own).or(before) else {
            return self.spread(time, rows, 0.0);
        };
        if self.step.is_none() && self.first.is_none() && next.is_some() {
            self.first = Some((time, rows));
            return;
        }
        let step = own.filter(|own| *own <= GAP * usual).unwrap_or(usual);
        if let Some((from, rows)) = self.first.take() {
            // Its beginning may be missing: it ends where this one begins.
            let length = (time - from).min(step * rows.len() as f64);
            let each = length / rows.len() as f64;
            self.spread(time - length, rows, each);
        }
        self.step = Some(step);
        self.spread(time, rows, step);
    }

    fn spread(&mut self, from: f64, rows: Vec<Values>, step: f64) {
        let rows = rows.into_iter().enumerate();
        self.ready
            .extend(rows.map(|(k, row)| (from + k as f64 * step, row)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_nav::Vector3;

    /// The times given to rows with these stamps; a row's rate is its number, or that of its `twin`.
    fn times(stamps: &[f64], twin: Option<usize>) -> (Vec<f64>, u64) {
        let (mut bursts, mut skipped) = (Bursts::default(), Skipped::default());
        let mut found = Vec::new();
        for (k, &stamp) in stamps.iter().enumerate() {
            let number = if Some(k) == twin { k - 1 } else { k };
            let values = Values {
                gyro: Vector3::repeat(number as f64),
                accel: Vector3::zeros(),
                temperature_c: f64::NAN,
            };
            bursts.row(k as u64 + 1, stamp, values, &mut skipped);
            found.extend(bursts.next());
        }
        found.extend(std::iter::from_fn(|| bursts.last()));
        let times = found.into_iter().map(|(time, _)| time).collect();
        (times, skipped.count(SkipKind::DuplicateTime))
    }

    #[test]
    fn rows_of_a_stamp_are_spread_to_the_next() {
        // Two of the first second are missing, and all from 4 s to 9 s.
        let stamps = [1., 1., 2., 2., 2., 2., 3., 3., 3., 3., 9., 9., 9., 9.];
        let (found, repeated) = times(&stamps, None);
        let expected = [
            1.5, 1.75, 2., 2.25, 2.5, 2.75, 3., 3.25, 3.5, 3.75, 9., 9.25, 9.5, 9.75,
        ];
        assert_eq!((found, repeated), (expected.to_vec(), 0));
    }

    #[test]
    fn a_row_that_repeats_the_one_before_is_left_out() {
        let stamps = [1., 1., 1., 2., 2., 3., 3.];
        let (found, repeated) = times(&stamps, Some(2));
        assert_eq!((found, repeated), (vec![1., 1.5, 2., 2.5, 3., 3.5], 1));
        // One stamp alone has no next: nothing shows the rate, and the times are left to the clock.
        assert_eq!(times(&[1., 1.], None).0, [1., 1.]);
        // Times that step back are left to it as well.
        let (found, _) = times(&[5., 5., 6., 6., 2., 2., 7., 7.], None);
        assert_eq!(found.len(), 8);
    }
}
