//! Times that start again: those of a counter of a limited number of bits, from its lowest value after its highest, and
//! seconds of the day or of the GPS week.

use crate::time::{DAY, WEEK};

/// Counters: the first number that is too high for one, how far it goes back there, and within how many usual steps of its
/// ends a step back is that; `micros()` and the like, without and with sign.
const COUNTERS: [(f64, f64, f64); 4] = [
    (4_294_967_296.0, 4_294_967_296.0, 1000.0),
    (2_147_483_648.0, 4_294_967_296.0, 1000.0),
    (65_536.0, 65_536.0, 20.0),
    (32_768.0, 65_536.0, 20.0),
];
/// Seconds of the hour, of the day and of the GPS week; and within how many seconds of its ends a step back is the next.
const CALENDARS: [(f64, f64); 3] = [(3600.0, 10.0), (DAY, 600.0), (WEEK, 600.0)];
/// What a program may have divided the counter by before it wrote it.
const DIVISORS: [f64; 3] = [1.0, 1e3, 1e6];
/// Day numbers of MATLAB are larger than this, and by so much larger than those of spreadsheets.
const MATLAB_DAYS: (f64, f64) = (700_000.0, 693_960.0);
/// Usual steps between two ends of a counter, at least.
const STEPS: f64 = 200.0;

/// Counts the numbers of a column on past the end of its counter.
#[derive(Clone, Debug)]
pub(super) struct Counter {
    last: Option<f64>,
    /// The last step forward.
    step: f64,
    /// The counter that this is, once it started again: the first number too high for it, its length, and how near its
    /// ends a number is beside one.
    ends: Option<(f64, f64, f64)>,
    /// Added to the numbers.
    added: f64,
    /// Factor to seconds.
    scale: f64,
    /// The numbers are days: those of MATLAB are made those of spreadsheets, of which more is in a double.
    days: bool,
}

/// What a number of the column is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Counted {
    /// The number, counted on.
    pub(super) value: f64,
    /// What was added from here on, where the counter started again here.
    pub(super) started: Option<f64>,
}

impl Counter {
    /// Of a column with this factor to seconds.
    pub(super) fn new(scale: f64) -> Self {
        Self {
            last: None,
            step: 0.0,
            ends: None,
            added: 0.0,
            scale,
            days: scale == DAY,
        }
    }

    /// The next number of the column.
    #[inline]
    pub(super) fn count(&mut self, number: f64) -> Counted {
        let number = match MATLAB_DAYS {
            (least, later) if self.days && number > least => number - later,
            _ => number,
        };
        let last = self.last.unwrap_or(number);
        // A row of the counter before, which comes late.
        if let Some((top, length, near)) = self.ends
            && number > top - near
            && last < top - length + near
        {
            let value = number + self.added - length;
            return Counted {
                value,
                started: None,
            };
        }
        self.last = Some(number);
        let mut started = None;
        if number > last {
            self.step = number - last;
        } else if number < last {
            started = self.starts_again(last, number);
        }
        Counted {
            value: number + self.added,
            started,
        }
    }

    #[cold]
    fn starts_again(&mut self, last: f64, number: f64) -> Option<f64> {
        let all = DIVISORS.iter().flat_map(|divisor| {
            COUNTERS.map(|(top, length, steps)| (top / divisor, length / divisor, steps))
        });
        let calendars = CALENDARS.map(|(length, near)| {
            let length = length / self.scale;
            (length, length, near / self.scale)
        });
        let (top, length, near) = all
            .map(|(top, length, steps)| (top, length, steps * self.step))
            .chain(calendars.into_iter().filter(|_| !self.days))
            .find(|(top, length, near)| {
                let (above, below) = (last > top - near, number < top - length + near);
                let inside = last < *top && number >= top - length;
                above && below && inside && *length > STEPS * self.step
            })
            .filter(|_| self.step > 0.0)?;
        self.ends = Some((top, length, near.min(0.1 * length)));
        self.added += length;
        Some(self.added)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counted(numbers: impl IntoIterator<Item = f64>) -> Vec<f64> {
        let mut counter = Counter::new(1.0);
        let count = |number| counter.count(number).value;
        numbers.into_iter().map(count).collect()
    }

    /// A counter from `first` by `step`, inside its bits.
    fn wrapped(first: f64, step: f64, lowest: f64, length: f64) -> impl Iterator<Item = f64> {
        (0..600).map(move |k| (first + step * f64::from(k) - lowest).rem_euclid(length) + lowest)
    }

    #[test]
    fn counters_of_many_kinds_go_on() {
        let (long, short) = (4_294_967_296.0, 65_536.0);
        for (first, step, lowest, length) in [
            (long - 2_345_678.0, 10_000.0, 0.0, long),
            (long / 2.0 - 1e6, 10_000.0, -long / 2.0, long),
            (long - 2_345.0, 10.0, 0.0, long),
            ((long - 2e6) / 1e6, 0.01, 0.0, long / 1e6),
            (short - 100.0, 1.0, 0.0, short),
            (short - 1234.0, 10.0, 0.0, short),
        ] {
            let found = counted(wrapped(first, step, lowest, length));
            for (k, number) in found.iter().enumerate() {
                let expected = first + step * k as f64;
                // A double of 4.3e9 has steps of 5e-7.
                assert!((number - expected).abs() < 1e-6, "{number} {expected}");
            }
        }
        // Twice around, in steps that leave it seldom.
        let steps = (0..20_000).map(|k| (f64::from(k) * 10.0).rem_euclid(short));
        assert_eq!(counted(steps).last(), Some(&199_990.0));
    }

    #[test]
    fn rows_may_be_missing_or_late_where_a_counter_starts_again() {
        let top = 4_294_967_296.0;
        let numbers = [top - 3e4, top - 2e4, 1e4, top - 1e4, 2e4, 3e4];
        let expected = [
            top - 3e4,
            top - 2e4,
            top + 1e4,
            top - 1e4,
            top + 2e4,
            top + 3e4,
        ];
        assert_eq!(counted(numbers), expected);
    }

    #[test]
    fn seconds_of_the_day_and_of_the_week_go_on() {
        for (length, scale) in [
            (DAY, 1.0),
            (WEEK, 1.0),
            (1e3 * DAY, 1e-3),
            (1e6 * WEEK, 1e-6),
        ] {
            let mut counter = Counter::new(scale);
            // The first fix of the next day may be missing for minutes.
            for (behind, step) in [(0.0, 0.02 / scale), (300.0 / scale, 1.0 / scale)] {
                let first = length - 2.0 * step;
                for (k, number) in [first, first + step, behind].into_iter().enumerate() {
                    let found = counter.count(number);
                    let added = if k == 2 { length } else { 0.0 };
                    assert_eq!(found.value, number + added, "{length} {step}");
                    assert_eq!(found.started, (k == 2).then_some(length));
                }
                counter = Counter::new(scale);
            }
        }
    }

    #[test]
    fn days_are_those_of_spreadsheets() {
        // datenum(2025, 7, 8) = 739806 and DATEVALUE("2025-07-08") = 45846.
        for (scale, expected) in [(DAY, 45_846.5), (1.0, 739_806.5)] {
            assert_eq!(Counter::new(scale).count(739_806.5).value, expected);
        }
    }

    #[test]
    fn clocks_that_are_set_back_are_no_counters() {
        for numbers in [
            [604_799.0, 604_799.5, 1000.0, 1000.5],
            [86_399.0, 86_400.0, 0.0, 1.0],
            [85_000.0, 85_001.0, 0.0, 1.0],
            [65_000.0, 65_001.0, 0.0, 1.0],
            [4.2e9, 4.2e9 + 1e4, 0.0, 1e4],
            [1.7e18, 1.7e18 + 1e7, 0.0, 1e7],
            [5.0, 4.0, 3.0, 2.0],
        ] {
            assert_eq!(counted(numbers), numbers, "{numbers:?}");
        }
    }
}
