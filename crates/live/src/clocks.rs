//! The times of a log on the time base of the solution, by when its records arrive.
//!
//! A record arrives later than it holds, by a delay that is never less than what the way takes. So the least delay of the
//! last seconds shows by how much two clocks differ, and whether one of them was set.

use std::collections::VecDeque;

/// Clocks that differ by more \[s\] are different clocks; below, the difference is that of the delays.
const APART: f64 = 5.0;
/// A delay that changes at once by more \[s\] is a clock that was set.
const STEP: f64 = 0.5;
/// Delays after a clock was set agree within this \[s\].
const SPREAD: f64 = 0.2;
/// Samples that are late for so long by the same are of a clock that was set back \[s\].
const LASTING: f64 = 3.0;
/// Records before a delay far below the least one is no longer taken for one of the first that was not late.
const FIRST: usize = 20;
/// The least delay is that of the last one or two of such spans \[s\].
const SPAN: f64 = 10.0;

/// Least delay of the last seconds.
#[derive(Clone, Copy, Debug, Default)]
struct Floor {
    /// When the present span began, its least delay, and that of the span before \[s\].
    since: f64,
    present: Option<f64>,
    before: Option<f64>,
    records: usize,
}

impl Floor {
    fn add(&mut self, at: f64, delay: f64) {
        self.records += 1;
        match self.present {
            Some(present) if at - self.since < SPAN => self.present = Some(present.min(delay)),
            present => {
                *self = Self {
                    since: at,
                    present: Some(delay),
                    before: present,
                    records: self.records,
                }
            }
        }
    }

    fn least(&self) -> Option<f64> {
        match (self.present, self.before) {
            (Some(present), Some(before)) => Some(present.min(before)),
            (present, before) => present.or(before),
        }
    }
}

/// Delays far from the least one, that are alike.
#[derive(Clone, Copy, Debug)]
struct Beyond {
    number: usize,
    /// When the first came \[s\].
    since: f64,
    least: f64,
    largest: f64,
}

impl Beyond {
    fn new(since: f64, delay: f64) -> Self {
        Self {
            number: 1,
            since,
            least: delay,
            largest: delay,
        }
    }

    fn with(self, delay: f64) -> Self {
        Self {
            number: self.number + 1,
            least: self.least.min(delay),
            largest: self.largest.max(delay),
            ..self
        }
    }

    fn spread(&self) -> f64 {
        self.largest - self.least
    }
}

/// What a clock was found to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ClockChange {
    /// It is another clock than that of the samples: this is added to its times \[s\].
    Apart(f64),
    /// It was set: this is added to its times from here on, beyond what was before \[s\].
    Set(f64),
}

/// Puts the times of one log on the time base of the solution.
pub(crate) struct LogClock<T> {
    /// Added to the times \[s\].
    shift: f64,
    floor: Floor,
    /// How many records decide.
    enough: usize,
    /// The delay that the first records are compared with, and what they may differ by, until that is decided \[s\].
    reference: Option<(f64, f64)>,
    /// Records whose times are not yet certain: arrival, time, record.
    held: VecDeque<(f64, f64, T)>,
    /// Consecutive delays beyond a step.
    beyond: Option<Beyond>,
    /// The last time as stamped \[s\].
    last: Option<f64>,
    /// Whether its records come as they are made, so that one that is late for long has a clock that was set back; fixes may be late
    /// for as long as they like.
    goes_with_arrivals: bool,
    /// The solution's last time in another run: records that follow it within the span \[s\] are of the same clock.
    follows: Option<(f64, f64)>,
}

impl<T> LogClock<T> {
    /// A clock of which nothing is known; `enough` records decide what it does. Samples come as they are made.
    pub(crate) fn new(enough: usize, goes_with_arrivals: bool) -> Self {
        Self {
            last: None,
            goes_with_arrivals,
            follows: None,
            shift: 0.0,
            floor: Floor::default(),
            enough,
            reference: None,
            held: VecDeque::new(),
            beyond: None,
        }
    }

    /// Goes on as it was in another run: what was added to its times and its least delay \[s\]. Records that follow the solution's last
    /// time within the span \[s\] show that it is the same clock.
    pub(crate) fn resume(&mut self, (shift, delay): (f64, f64), follows: Option<(f64, f64)>) {
        (self.shift, self.reference, self.follows) = (shift, Some((delay, STEP)), follows);
    }

    /// The first records are compared with the delay that is usual \[s\].
    pub(crate) fn compare(&mut self, delay: f64) {
        self.reference = Some((delay, APART));
    }

    /// Whether there was no record yet to compare.
    pub(crate) fn is_new(&self) -> bool {
        self.reference.is_none() && self.floor.least().is_none()
    }

    /// Its source or reader begins again: the next records are compared with those before.
    pub(crate) fn restart(&mut self) {
        if let Some(delay) = self.floor.least() {
            self.reference = Some((delay, STEP));
        }
        self.beyond = None;
    }

    /// What is added to the times \[s\], and the least delay, once that is known \[s\].
    pub(crate) fn kept(&self) -> Option<(f64, f64)> {
        Some((self.shift, self.floor.least()?))
    }

    /// Takes a record of a time \[s\] that arrived \[s\]; gives those whose times are certain, with them.
    pub(crate) fn take(
        &mut self,
        at: f64,
        time: f64,
        record: T,
        give: &mut dyn FnMut(f64, T),
    ) -> Option<ClockChange> {
        let delay = at - (time + self.shift);
        let before = self.last.replace(time);
        if let Some((last, span)) = self.follows.take()
            && (last..last + span).contains(&(time + self.shift))
        {
            self.reference = None;
        }
        if let Some((reference, most)) = self.reference {
            if (delay - reference).abs() <= most && self.held.is_empty() {
                self.reference = None;
            } else {
                self.held.push_back((at, time, record));
                if self.held.len() < self.enough {
                    return None;
                }
                self.reference = None;
                let least = self.least_held();
                let by = self.shift_by(least - reference, give);
                return Some(match most == APART {
                    true => ClockChange::Apart(by),
                    false => ClockChange::Set(by),
                });
            }
        }
        let Some(floor) = self.floor.least() else {
            self.floor.add(at, delay);
            give(time + self.shift, record);
            return None;
        };
        let first = delay < floor && self.floor.records < FIRST;
        if first || (delay - floor).abs() <= STEP {
            self.beyond = None;
            self.floor.add(at, delay);
            self.release(give);
            give(time + self.shift, record);
            return None;
        }
        // A burst after a pause is no clock that was set: its times go on.
        let jumps = before.is_none_or(|before| time - before > STEP) || !self.held.is_empty();
        if delay < floor && !jumps {
            self.beyond = None;
            self.floor.add(at, delay);
            give(time + self.shift, record);
            return None;
        }
        let beyond = match self.beyond {
            // From the future they are held until there are enough; a delay that lasts has to stay the same.
            Some(beyond) if delay < floor || beyond.with(delay).spread() <= SPREAD => {
                beyond.with(delay)
            }
            _ => Beyond::new(at, delay),
        };
        self.beyond = Some(beyond);
        if delay > floor {
            // Late, or of a clock that was set back: it holds as it is stamped until that is certain.
            if !self.goes_with_arrivals || at - beyond.since < LASTING {
                give(time + self.shift, record);
                return None;
            }
            self.held.push_back((at, time, record));
        } else {
            // From the future.
            self.held.push_back((at, time, record));
            if beyond.number < self.enough {
                return None;
            }
        }
        self.beyond = None;
        Some(ClockChange::Set(self.shift_by(beyond.least - floor, give)))
    }

    fn least_held(&self) -> f64 {
        let delays = self
            .held
            .iter()
            .map(|(at, time, _)| at - (time + self.shift));
        delays.fold(f64::INFINITY, f64::min)
    }

    /// Adds to the shift, and gives what was held; returns what was added.
    fn shift_by(&mut self, by: f64, give: &mut dyn FnMut(f64, T)) -> f64 {
        self.shift += by;
        self.release(give);
        by
    }

    fn release(&mut self, give: &mut dyn FnMut(f64, T)) {
        while let Some((at, time, record)) = self.held.pop_front() {
            self.floor.add(at, at - (time + self.shift));
            give(time + self.shift, record);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Arrival and stamp of records into times.
    fn run(
        clock: &mut LogClock<usize>,
        records: &[(f64, f64)],
    ) -> (Vec<(f64, usize)>, Vec<ClockChange>) {
        let (mut given, mut changes) = (Vec::new(), Vec::new());
        for (k, (at, time)) in records.iter().enumerate() {
            changes.extend(clock.take(*at, *time, k, &mut |time, k| given.push((time, k))));
        }
        (given, changes)
    }

    fn near(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-9
    }

    #[test]
    fn late_records_keep_their_stamps() {
        let mut clock = LogClock::new(5, false);
        let delays = [0.1, 1.4, 0.2, 1.1, 0.9, 1.5, 0.8, 0.1, 1.2, 0.7];
        let records: Vec<_> = (0..10).map(|k| (k as f64 + delays[k], k as f64)).collect();
        let (given, changes) = run(&mut clock, &records);
        assert_eq!(changes, []);
        assert!(given.iter().all(|(time, k)| *time == *k as f64) && given.len() == 10);
    }

    #[test]
    fn another_clock_is_put_on_that_of_the_samples() {
        let mut clock = LogClock::new(3, false);
        clock.compare(0.01);
        let records: Vec<_> = (0..6)
            .map(|k| (k as f64 + [0.3, 0.11, 0.2][k % 3], 1000.0 + k as f64))
            .collect();
        let (given, changes) = run(&mut clock, &records);
        assert!(
            matches!(changes[..], [ClockChange::Apart(by)] if near(by, -999.9)),
            "{changes:?}"
        );
        assert!(
            given.iter().all(|(time, k)| near(*time, *k as f64 + 0.1)),
            "{given:?}"
        );
        // The same clock with another delay is not.
        let mut clock = LogClock::new(3, false);
        clock.compare(0.01);
        let (given, changes) = run(&mut clock, &[(1.4, 0.0), (1.1, 1.0)]);
        assert_eq!((given.len(), changes.len()), (2, 0));
    }

    #[test]
    fn a_clock_that_is_set_goes_on() {
        for by in [1.0, -1.0, 3600.0] {
            let mut clock = LogClock::new(20, true);
            let stamp = |k: usize| 0.01 * k as f64 + if k < 500 { 0.0 } else { by };
            let records: Vec<_> = (0..1000)
                .map(|k| (0.01 * k as f64 + 0.002, stamp(k)))
                .collect();
            let (given, changes) = run(&mut clock, &records);
            assert!(
                matches!(changes[..], [ClockChange::Set(shift)] if near(shift, -by)),
                "{changes:?}"
            );
            assert_eq!(given.len(), 1000);
            let right = given
                .iter()
                .filter(|(time, k)| near(*time, 0.01 * *k as f64));
            // Of one set back those of the first 3 s are as stamped.
            assert_eq!(right.count(), if by > 0.0 { 1000 } else { 700 });
        }
    }

    /// As of a log that is played 40 times as fast, with a pause of the machine.
    #[test]
    fn a_burst_after_a_pause_is_no_clock_that_was_set() {
        let mut clock = LogClock::new(20, true);
        let paused = |at: f64| if (2.0..2.5).contains(&at) { 2.5 } else { at };
        let records: Vec<_> = (0..8000)
            .map(|k| (paused(0.02 * k as f64 / 40.0), 0.02 * k as f64))
            .collect();
        let (given, changes) = run(&mut clock, &records);
        assert_eq!((given.len(), changes.len()), (8000, 0), "{changes:?}");
    }

    #[test]
    fn a_sensor_that_begins_again_at_zero_goes_on() {
        let mut clock = LogClock::new(20, true);
        run(
            &mut clock,
            &Vec::from_iter((0..500).map(|k| (0.01 * k as f64, 7.0 + 0.01 * k as f64))),
        );
        clock.restart();
        let records: Vec<_> = (0..100)
            .map(|k| (10.0 + 0.01 * k as f64, 0.01 * k as f64))
            .collect();
        let (given, changes) = run(&mut clock, &records);
        assert!(
            matches!(changes[..], [ClockChange::Set(by)] if near(by, 17.0)),
            "{changes:?}"
        );
        assert!(
            given.len() == 100
                && given
                    .iter()
                    .all(|(time, k)| near(*time, 17.0 + 0.01 * *k as f64))
        );
        let (shift, delay) = clock.kept().unwrap();
        assert!(near(shift, 17.0) && near(delay, -7.0));
    }
}
