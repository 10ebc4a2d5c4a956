//! Times of the outages.

use crate::replay::Outage;
use std::path::PathBuf;

/// Times of the outages, from those of the fixes.
#[derive(Clone, Debug, PartialEq)]
pub enum Schedule {
    /// `count` of them, evenly from `start` [s after the first fix] to the end of the fixes.
    Count {
        /// Start of the first outage after the first fix \[s\].
        start: f64,
        /// Number of outages.
        count: usize,
    },
    /// One every `every` \[s\] from `start` [s after the first fix] on, at most `count`.
    Every {
        /// Start of the first outage after the first fix \[s\].
        start: f64,
        /// Time from the start of one outage to that of the next \[s\].
        every: f64,
        /// Number of outages at most; as many as fit if `None`.
        count: Option<usize>,
    },
    /// At these starts, in the log's own time base \[s\].
    At(Vec<f64>),
}

impl Schedule {
    /// The schedule that is asked for by times, or by the span between starts, or by a number; `None`
    /// if by none of them. `start` \[s\] is counted from the first fix, without it [`FIRST`].
    pub fn asked(
        at: Option<Vec<f64>>,
        every: Option<f64>,
        count: Option<usize>,
        start: Option<f64>,
    ) -> Option<Self> {
        let start = start.unwrap_or(FIRST);
        match (at, every, count) {
            (Some(times), ..) => Some(Self::At(times)),
            (None, Some(every), count) => Some(Self::Every {
                start,
                every,
                count,
            }),
            (None, None, Some(count)) => Some(Self::Count { start, count }),
            (None, None, None) => None,
        }
    }

    /// The schedule where none is asked for: as many outages of `length` \[s\] as fit, a third of the time without GNSS;
    /// the first `start` \[s\] after the first fix or, without it, after [`FIRST`], sooner where the fixes `span` \[s\] little.
    ///
    /// ```
    /// # use undrift_drive as undrift;
    /// use undrift::outages::Schedule;
    /// // Outages of 10 s in ten minutes of fixes: one every half minute, from a minute on.
    /// let Schedule::Every { start, every, .. } = Schedule::usual(10.0, None, 600.0) else { panic!() };
    /// assert_eq!((start, every), (60.0, 30.0));
    /// ```
    pub fn usual(length: f64, start: Option<f64>, span: f64) -> Self {
        Self::Every {
            start: start.unwrap_or(FIRST.min((span / 3.0).round())),
            every: 3.0 * length,
            count: None,
        }
    }
}

/// Usual start of the first outage after the first fix \[s\].
pub const FIRST: f64 = 60.0;

/// More outages than this are a mistake.
const MOST_OUTAGES: usize = 100_000;

/// Why outages cannot be laid out; its text names the argument to change.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ScheduleError {
    /// There is nothing to count the outages from.
    #[error("{} contains no usable fix", .0.display())]
    NoFix(PathBuf),
    /// The length is not above zero.
    #[error("an outage must last longer than 0 s, not {0} s")]
    Length(f64),
    /// The start lies before the first fix.
    #[error("the outages must start 0 s or more after the first fix, not {0} s")]
    Start(f64),
    /// The span from start to start is not above zero.
    #[error("outages must be more than 0 s apart, not {0} s")]
    Every(f64),
    /// None is asked for.
    #[error("the number of outages must be above 0")]
    Zero,
    /// Too many are asked for.
    #[error("more than {MOST_OUTAGES} outages; reduce the number")]
    TooMany,
    /// They do not fit apart from each other.
    #[error(
        "the outages overlap: {count} of {length} s do not fit; reduce the number or the length"
    )]
    Overlap {
        /// How many.
        count: usize,
        /// Length of each \[s\].
        length: f64,
    },
    /// The start lies after the last fix.
    #[error("--start {start}: the last fix is only {end:.0} s after the first; reduce --start")]
    StartAfterFixes {
        /// After the first fix \[s\].
        start: f64,
        /// The last fix after the first \[s\].
        end: f64,
    },
    /// Not one fits between the start and the last fix.
    #[error(
        "--length {length}: only {:.0} s lie between --start {start} and the last fix; reduce --length or --start",
        end - start
    )]
    NoRoom {
        /// Length of an outage \[s\].
        length: f64,
        /// After the first fix \[s\].
        start: f64,
        /// The last fix after the first \[s\].
        end: f64,
    },
    /// Not all fit.
    #[error("only {fits} of the {count} outages fit before the last fix")]
    TooFew {
        /// How many do.
        fits: usize,
        /// How many are asked for.
        count: usize,
    },
    /// An outage is longer than the fixes.
    #[error("--length {length}: the fixes cover only {span:.0} s; reduce --length")]
    LongerThanFixes {
        /// Length \[s\].
        length: f64,
        /// Time from the first fix to the last \[s\].
        span: f64,
    },
    /// An outage reaches beyond the fixes.
    #[error(
        "--at {time}: a {length} s outage must begin between {first} s and {} s, within the fixes",
        ((last - length) * 1e3).floor() / 1e3
    )]
    BeyondFixes {
        /// Length \[s\].
        length: f64,
        /// Start \[s\].
        time: f64,
        /// First fix \[s\].
        first: f64,
        /// Last fix \[s\].
        last: f64,
    },
    /// An outage reaches beyond the truth.
    #[error(
        "the truth covers {:.3} to {:.3} s, not the outage from {:.3} to {:.3} s; check the time columns, or omit the truth to use the withheld fixes",
        truth[0], truth[1], outage.start, outage.end
    )]
    BeyondTruth {
        /// First and last time of the truth \[s\].
        truth: [f64; 2],
        /// The outage that reaches beyond.
        outage: Outage,
    },
}

/// The outages of `length` \[s\] a schedule asks for, given the first and last fix \[s\], in order of time. Each lies within the
/// fixes, so that there is a reference at its end.
///
/// ```
/// # use undrift_drive as undrift;
/// use undrift::outages::{Schedule, schedule};
/// // Fixes from 10 s to 400 s; the first outage begins 60 s after the first fix, then one every 90 s.
/// let every = Schedule::Every { start: 60.0, every: 90.0, count: None };
/// let outages = schedule(&every, 30.0, 10.0, 400.0)?;
/// let starts: Vec<f64> = outages.iter().map(|outage| outage.start).collect();
/// assert_eq!(starts, [70.0, 160.0, 250.0, 340.0]);
/// assert!(schedule(&Schedule::At(vec![390.0]), 30.0, 10.0, 400.0).is_err(), "ends after the last fix");
/// # Ok::<(), undrift::outages::ScheduleError>(())
/// ```
///
/// # Errors
/// When they do not fit, overlap or are not positive.
pub fn schedule(
    plan: &Schedule,
    length: f64,
    first_fix: f64,
    last_fix: f64,
) -> Result<Vec<Outage>, ScheduleError> {
    let positive = |value: f64| value > 0.0 && value.is_finite();
    if !positive(length) {
        return Err(ScheduleError::Length(length));
    }
    let starts = match plan {
        Schedule::At(times) => {
            let mut times = times.clone();
            times.sort_by(f64::total_cmp);
            let is_beyond =
                |t: &&f64| !t.is_finite() || **t < first_fix || **t + length > last_fix + 1e-6;
            if let Some(&time) = times.iter().find(is_beyond) {
                let (first, last) = (first_fix, last_fix);
                let span = last - first;
                return Err(match span < length {
                    true => ScheduleError::LongerThanFixes { length, span },
                    false => ScheduleError::BeyondFixes {
                        length,
                        time,
                        first,
                        last,
                    },
                });
            }
            times
        }
        Schedule::Count { start, .. } | Schedule::Every { start, .. } => {
            if *start < 0.0 || !start.is_finite() {
                return Err(ScheduleError::Start(*start));
            }
            let (count, every) = spread(plan, length, *start, last_fix - first_fix)?;
            let from = first_fix + start;
            (0..count).map(|i| from + every * i as f64).collect()
        }
    };
    if starts.windows(2).any(|w| w[1] < w[0] + length) {
        let count = starts.len();
        return Err(ScheduleError::Overlap { count, length });
    }
    let outage = |start| Outage {
        start,
        end: start + length,
    };
    Ok(starts.into_iter().map(outage).collect())
}

/// How many outages there are and how far apart they begin \[s\], when the first one starts so long after
/// the first fix and the fixes end so long after it \[s\].
fn spread(
    plan: &Schedule,
    length: f64,
    start: f64,
    end: f64,
) -> Result<(usize, f64), ScheduleError> {
    let room = end - length - start;
    let (wanted, every) = match *plan {
        Schedule::Every { every, .. } if !(every > 0.0 && every.is_finite()) => {
            return Err(ScheduleError::Every(every));
        }
        Schedule::Every { every, count, .. } => (count, every),
        Schedule::Count { count, .. } if count > 1 => (Some(count), room / (count - 1) as f64),
        Schedule::Count { count, .. } => (Some(count), f64::INFINITY),
        Schedule::At(_) => (None, f64::INFINITY),
    };
    // The last of them may end with the fixes, but for rounding.
    let fits = (room / every + 1e-9).floor() + 1.0;
    if start >= end {
        return Err(ScheduleError::StartAfterFixes { start, end });
    }
    if room < 0.0 || fits < 1.0 {
        return Err(ScheduleError::NoRoom { length, start, end });
    }
    let fits = fits as usize;
    let count = wanted.unwrap_or(fits);
    let too_many = |count: usize| count > MOST_OUTAGES;
    match count {
        0 => Err(ScheduleError::Zero),
        _ if wanted.is_some_and(too_many) => Err(ScheduleError::TooMany),
        2.. if fits != 1 && every < length => Err(ScheduleError::Overlap { count, length }),
        _ if count > fits => Err(ScheduleError::TooFew { fits, count }),
        _ if too_many(count) => Err(ScheduleError::TooMany),
        _ => Ok((count, if count > 1 { every } else { 0.0 })),
    }
}

#[cfg(test)]
mod tests;
