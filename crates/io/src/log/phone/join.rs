//! Gyroscopes and accelerometers that are stamped apart, as telephones have them, as one stream.
//!
//! A sample is a rate of the gyroscopes, with the specific force at its time on the straight line
//! between the accelerometers' values before and after it. That is done only where both have about the same
//! rate, so that the line spans one interval of motion, not several; [`Join::slower`] lets it span several, for sensors
//! whose accelerometers are made slower than their gyroscopes.

use std::collections::VecDeque;

use undrift_nav::Vector3;

use crate::ReadError;
use crate::entry::{ImuReading, What};
use crate::gaps::{Gap, GapWatch};
use crate::log::receiver::Ready;
use crate::skipped::SkipKind;

/// Rates that differ by no more than this factor are alike.
const ALIKE: f64 = 2.0;
/// The same of accelerometers that are made slower.
const SLOWER: f64 = 16.0;
/// Of rates by stamps that are rounded.
const ROUNDING: f64 = 1.05;
/// Values of each that their rates are judged by.
const JUDGED: u64 = 50;
/// Accelerometer values further apart than so many of their usual intervals are a gap.
const GAP: f64 = 5.0;
/// Rates and forces that wait: 20 s at 500 Hz.
const MOST: usize = 10_000;

/// A value at a line and time \[s\].
type Value = (u64, f64, Vector3);

#[derive(Default)]
pub(in crate::log) struct Join {
    gyro: VecDeque<Value>,
    accel: VecDeque<Value>,
    rates: [Rate; 2],
    slower: bool,
    pub(in crate::log) given: bool,
}

/// The usual interval of a sensor.
#[derive(Default)]
struct Rate {
    watch: GapWatch,
    last: Option<f64>,
    count: u64,
}

impl Rate {
    /// Whether the time goes forward.
    fn add(&mut self, at: u64, time: f64) -> bool {
        let last = self.last.replace(time);
        let length = last.map_or(0.0, |last| time - last);
        if last.is_some() && length <= 0.0 {
            self.last = last;
            return false;
        }
        if let Some(start) = last {
            self.watch.add(Gap {
                start,
                length,
                line: at,
            });
        }
        self.count += 1;
        true
    }

    fn interval(&self) -> f64 {
        self.watch.summary().nominal_interval
    }
}

impl Join {
    /// Of accelerometers that may be several times slower than the gyroscopes.
    pub(in crate::log) fn slower() -> Self {
        Self {
            slower: true,
            ..Self::default()
        }
    }

    /// A rate [rad/s] of the gyroscopes.
    ///
    /// # Errors
    /// If the two have different rates.
    pub(in crate::log) fn gyro(
        &mut self,
        value: Value,
        ready: &mut Ready,
    ) -> Result<(), ReadError> {
        self.add(0, value, ready)
    }

    /// A specific force [m/s²] of the accelerometers.
    ///
    /// # Errors
    /// If the two have different rates.
    pub(in crate::log) fn accel(
        &mut self,
        value: Value,
        ready: &mut Ready,
    ) -> Result<(), ReadError> {
        self.add(1, value, ready)
    }

    fn add(&mut self, which: usize, value: Value, ready: &mut Ready) -> Result<(), ReadError> {
        let (at, time, _) = value;
        let [gyro, accel] = &mut self.rates;
        let rate = if which == 0 { &mut *gyro } else { &mut *accel };
        if !rate.add(at, time) {
            ready.skip(at, SkipKind::TimeBackwards, format!("{time} s"));
            return Ok(());
        }
        if rate.count == JUDGED && gyro.count.min(accel.count) >= JUDGED {
            let slowest = if self.slower { SLOWER } else { ALIKE };
            alike(gyro.interval(), accel.interval(), slowest).map_err(|error| error.at(at))?;
        }
        let queue = if which == 0 {
            &mut self.gyro
        } else {
            &mut self.accel
        };
        queue.push_back(value);
        if queue.len() > MOST {
            queue.pop_front();
            if which == 0 {
                ready.skip(
                    at,
                    SkipKind::MissingField,
                    "a rate without a specific force",
                );
            }
        }
        self.give(ready);
        Ok(())
    }

    /// Gives out the rates that have a force on both sides.
    fn give(&mut self, ready: &mut Ready) {
        while let (Some((at, time, gyro)), Some((_, newest, _))) =
            (self.gyro.front().copied(), self.accel.back().copied())
        {
            if newest < time {
                return;
            }
            self.gyro.pop_front();
            while self.accel.get(1).is_some_and(|(_, next, _)| *next <= time) {
                self.accel.pop_front();
            }
            match self.force(time) {
                Some(accel) => {
                    self.given = true;
                    ready.push(at, What::Imu(ImuReading::new(time, gyro, accel)));
                }
                None => ready.skip(
                    at,
                    SkipKind::MissingField,
                    "a rate without a specific force",
                ),
            }
        }
    }

    /// The force at a time between the first two that are held.
    fn force(&self, time: f64) -> Option<Vector3> {
        let (_, before, from) = *self.accel.front()?;
        if before == time {
            return Some(from);
        }
        let (_, after, to) = *self.accel.get(1)?;
        let usual = self.rates[1].interval();
        let between = before < time && after - before <= GAP * usual.max(f64::MIN_POSITIVE);
        between.then(|| from + (to - from) * ((time - before) / (after - before)))
    }
}

fn alike(gyro: f64, accel: f64, slowest: f64) -> Result<(), ReadError> {
    let ratio = gyro / accel;
    if (1.0 / (ROUNDING * slowest)..=ROUNDING * ALIKE).contains(&ratio) {
        return Ok(());
    }
    let problem = format!(
        "gyroscopes at {:.1} Hz and accelerometers at {:.1} Hz: samples of one cannot be interpolated to the other",
        1.0 / gyro,
        1.0 / accel
    );
    Err(ReadError::nameless(problem).mend("record both at the same rate"))
}
