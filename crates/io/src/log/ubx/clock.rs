//! The time of the inertial sensors in GPS time.
//!
//! Sensor messages have time tags of a counter of their own, whose rate is that of an uncalibrated
//! oscillator: off by up to some percent. What ties it to GPS time is the order of the file: at the
//! first message of an epoch, the last tag before it belongs to about the epoch's time. Through the
//! ties of the last minute goes a straight line, which gives the samples their times; so neither
//! the unit of the tags nor their drift has to be known. A receiver sends an epoch's messages some
//! tens of milliseconds after it; that delay stays in the times as a constant, the samples being
//! stamped too early by it, and is what the time offset of a drive file is for.
//!
//! NAV-STATUS has milliseconds since startup next to the time of week. Where the sensor messages
//! are calibrated to that counter, the ties are these pairs and exact. So they are for ESF-RAW of
//! receivers that fill its first word, reserved by the interface descriptions, with the
//! milliseconds since startup of its first measurement: it is believed where it is within a second
//! of NAV-STATUS.
//!
//! Before the first ten seconds of ties, samples are held back. In a file without a fix, or after
//! ten minutes of samples without one, the times are those of the counter at its nominal rate.

use std::collections::VecDeque;

use super::imu::Sample;

/// Ties over less time do not show the rate \[s\].
const SPAN: f64 = 10.0;
/// Ties older than this are dropped \[s\].
const WINDOW: f64 = 60.0;
/// The most ties in a window: those of 20 Hz.
const MAX_TIES: usize = 1200;
/// The most samples that are held back: 10 minutes at 100 Hz.
const MAX_HELD: usize = 60_000;
/// A tie that is off by more is one of a counter that started again \[s\].
const BROKEN: f64 = 0.5;

/// Counter [s at its nominal rate] → GPS time \[s\].
#[derive(Clone, Copy)]
struct Line {
    /// A point of it: counter and time.
    at: (f64, f64),
    rate: f64,
}

impl Line {
    fn time(&self, counter: f64) -> f64 {
        self.at.1 + self.rate * (counter - self.at.0)
    }
}

/// Makes times of tags.
#[derive(Default)]
pub(super) struct SensorClock {
    /// Counter \[s\] and GPS time \[s\].
    ties: VecDeque<(f64, f64)>,
    line: Option<Line>,
    held: VecDeque<(f64, Sample)>,
    /// Whether the ties are those of NAV-STATUS.
    exact: bool,
    /// Whether the times are the counter's own, for good.
    own: bool,
}

/// A fix came after the times had been those of the counter.
pub(super) struct TooLate;

impl SensorClock {
    /// A sample at a counter \[s\]; `give` gets what has a time.
    pub(super) fn sample(
        &mut self,
        counter: f64,
        reading: Sample,
        give: &mut impl FnMut(f64, Sample),
    ) {
        match self.line {
            Some(line) => give(line.time(counter), reading),
            None if self.own => give(counter, reading),
            None => {
                self.held.push_back((counter, reading));
                if self.held.len() > MAX_HELD {
                    self.end(give);
                }
            }
        }
    }

    /// A GPS time \[s\] at a counter \[s\], `exact` if by NAV-STATUS.
    pub(super) fn tie(
        &mut self,
        counter: f64,
        time: f64,
        exact: bool,
        give: &mut impl FnMut(f64, Sample),
    ) -> Result<(), TooLate> {
        if self.own {
            return Err(TooLate);
        }
        if self.exact && !exact {
            return Ok(());
        }
        let broken = |line: Line| (line.time(counter) - time).abs() > BROKEN;
        if exact != self.exact || self.line.is_some_and(broken) {
            self.ties.clear();
            self.line = None;
            self.exact = exact;
        }
        self.ties.push_back((counter, time));
        let old = |tie: &(f64, f64)| time - tie.1 > WINDOW;
        while self.ties.len() > MAX_TIES || self.ties.front().is_some_and(old) {
            self.ties.pop_front();
        }
        let span = self.ties.front().map_or(0.0, |first| time - first.1);
        if self.line.is_some() || span >= SPAN {
            self.draw();
            self.give_held(give);
        }
        Ok(())
    }

    /// Starts again with another counter; the number of samples that were held back.
    pub(super) fn restart(&mut self) -> usize {
        let held = self.held.len();
        *self = Self {
            own: self.own,
            ..Self::default()
        };
        held
    }

    /// Gives out all that is held, by what is known of the time.
    pub(super) fn end(&mut self, give: &mut impl FnMut(f64, Sample)) {
        if self.line.is_none() {
            self.draw();
        }
        self.own = self.line.is_none();
        self.give_held(give);
    }

    fn give_held(&mut self, give: &mut impl FnMut(f64, Sample)) {
        for (counter, reading) in self.held.drain(..) {
            let time = self.line.map_or(counter, |line| line.time(counter));
            give(time, reading);
        }
    }

    /// The line by least squares; with the nominal rate where the ties do not show another.
    fn draw(&mut self) {
        let n = self.ties.len() as f64;
        let sum = self
            .ties
            .iter()
            .fold((0.0, 0.0), |sum, tie| (sum.0 + tie.0, sum.1 + tie.1));
        let mean = (sum.0 / n, sum.1 / n);
        let (mut xx, mut xy) = (0.0, 0.0);
        for (counter, time) in &self.ties {
            xx += (counter - mean.0).powi(2);
            xy += (counter - mean.0) * (time - mean.1);
        }
        let spans = |tie: &(f64, f64)| (tie.1 - mean.1).abs() >= 0.4 * SPAN;
        let rate = if self.ties.iter().any(spans) && xy > 0.0 {
            xy / xx
        } else {
            1.0
        };
        self.line = (n > 0.0 && rate.is_finite()).then_some(Line { at: mean, rate });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_nav::Vector3;

    fn reading(at: u64) -> Sample {
        let (gyro, accel) = (Vector3::zeros(), Vector3::zeros());
        Sample { at, gyro, accel }
    }

    /// A counter that is `fast`, sampled at 100 Hz, and fixes at 1 Hz that are sent `delay(k)`
    /// after their time 345 600 + k; the samples' errors of time by their numbers.
    fn errors(seconds: u64, fast: f64, delay: impl Fn(u64) -> f64) -> Vec<(u64, f64)> {
        let mut clock = SensorClock::default();
        let mut out = Vec::new();
        let time_of = |sample: u64| 345_600.0 + 0.01 * sample as f64;
        let mut give = |time: f64, reading: Sample| {
            out.push((reading.at, time - time_of(reading.at)));
        };
        let counter = |sample: u64| 17.0 + fast * 0.01 * sample as f64;
        let mut next_fix = 0;
        for sample in 0..100 * seconds {
            let elapsed = 0.01 * sample as f64;
            while next_fix as f64 + delay(next_fix) < elapsed {
                let tied = clock.tie(
                    counter(sample.saturating_sub(1)),
                    345_600.0 + next_fix as f64,
                    false,
                    &mut give,
                );
                assert!(tied.is_ok());
                next_fix += 1;
            }
            clock.sample(counter(sample), reading(sample), &mut give);
        }
        clock.end(&mut give);
        out
    }

    #[test]
    fn the_delay_of_the_fixes_is_all_that_is_left() {
        for fast in [0.98, 1.0, 1.005] {
            let errors = errors(300, fast, |_| 0.045);
            assert_eq!(errors.len(), 30_000);
            for (k, (at, error)) in errors.iter().enumerate() {
                assert_eq!(*at, k as u64);
                // The last sample before is of 40 ms after the fix; roundings of 6e5 s.
                assert!((error + 0.04).abs() < 1e-8, "{at} {error}");
            }
        }
    }

    #[test]
    fn an_unsteady_delay_is_averaged() {
        // 20 to 80 ms, by the golden ratio: spread evenly in any minute.
        let delay = |k: u64| 0.02 + 0.06 * (k as f64 * 0.618_034).fract();
        let errors = errors(300, 1.005, delay);
        // Of 60 ties with a standard deviation of 17 ms, the end of a straight line has 2 × 17 ms /
        // √60 = 4.5 ms; of the first ten 11 ms, two of which are allowed.
        for (at, error) in &errors {
            let allowed = if *at < 6_000 { 0.022 } else { 0.009 };
            assert!((error + 0.045).abs() < allowed, "{at} {error}");
        }
    }

    #[test]
    fn a_counter_that_starts_again_is_tied_again() {
        let mut clock = SensorClock::default();
        let mut last = 0.0;
        let mut give = |time: f64, _: Sample| last = time;
        for k in 0..60 {
            let counter = if k < 30 { 5000.0 } else { 0.0 } + f64::from(k);
            clock.sample(counter, reading(0), &mut give);
            assert!(
                clock
                    .tie(counter, 1000.0 + f64::from(k), false, &mut give)
                    .is_ok()
            );
        }
        assert!((last - 1059.0).abs() < 1e-9, "{last}");
    }

    #[test]
    fn a_fix_after_the_counters_own_times_is_refused() {
        let mut clock = SensorClock::default();
        let mut given = 0;
        for k in 0..=MAX_HELD {
            clock.sample(k as f64, reading(0), &mut |_, _| given += 1);
        }
        assert_eq!(given, MAX_HELD + 1);
        assert!(clock.tie(1.0, 2.0, false, &mut |_, _| {}).is_err());
    }
}
