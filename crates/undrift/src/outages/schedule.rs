//! Where the outages lie.

use crate::replay::Outage;

/// Where the outages lie, from the times of the fixes.
#[derive(Clone, Debug, PartialEq)]
pub enum Schedule {
    /// `count` of them, evenly from `start` [s after the first fix] to the end of the fixes.
    Count {
        /// After the first fix [s].
        start: f64,
        /// How many.
        count: usize,
    },
    /// From `start` [s after the first fix] on, one every `every` [s], at most `count`.
    Every {
        /// After the first fix [s].
        start: f64,
        /// From start to start [s].
        every: f64,
        /// At most so many, as many as fit if `None`.
        count: Option<usize>,
    },
    /// At these times in the log's own time base [s].
    At(Vec<f64>),
}

impl Schedule {
    /// The schedule that is asked for by times, or by the span between starts, or by a number; `None`
    /// if by none of them. `start` [s] is counted from the first fix.
    pub fn asked(
        at: Option<Vec<f64>>,
        every: Option<f64>,
        count: Option<usize>,
        start: f64,
    ) -> Option<Self> {
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
}

/// More outages than this are a mistake.
const MOST_OUTAGES: usize = 100_000;

/// The outages of `length` [s] a schedule asks for, given the first and last fix [s].
///
/// # Errors
/// A sentence for the user when they do not fit, overlap or are not positive.
pub fn schedule(
    plan: &Schedule,
    length: f64,
    first_fix: f64,
    last_fix: f64,
) -> Result<Vec<Outage>, String> {
    if !(length > 0.0 && length.is_finite()) {
        return Err(format!(
            "an outage must last longer than 0 s, not {length} s"
        ));
    }
    if let Schedule::Count { start, .. } | Schedule::Every { start, .. } = plan
        && !(*start >= 0.0 && start.is_finite())
    {
        return Err(format!(
            "the outages must start 0 s or more after the first fix, not {start} s"
        ));
    }
    let overlap = |count: usize| {
        format!("the outages overlap: {count} of {length} s do not fit apart from each other")
    };
    let too_many = || format!("more than {MOST_OUTAGES} outages; make them fewer");
    let starts: Vec<f64> = match plan {
        Schedule::Count { start, count } => {
            let from = first_fix + start;
            let room = last_fix - length - from;
            if *count == 0 || room < 0.0 {
                return Err(format!(
                    "no outage of {length} s fits between {start} s after the first fix and the last fix at {:.1} s",
                    last_fix - first_fix
                ));
            }
            if *count > MOST_OUTAGES {
                return Err(too_many());
            }
            let every = if *count > 1 {
                room / (*count - 1) as f64
            } else {
                0.0
            };
            if *count > 1 && every < length {
                return Err(overlap(*count));
            }
            (0..*count).map(|i| from + every * i as f64).collect()
        }
        Schedule::Every {
            start,
            every,
            count,
        } => {
            if !(*every > 0.0 && every.is_finite()) {
                return Err(format!(
                    "outages must be more than 0 s apart, not {every} s"
                ));
            }
            let from = first_fix + start;
            let fits = ((last_fix - length - from) / every + 1e-9).floor() + 1.0;
            if fits < 1.0 {
                return Err(format!(
                    "no outage of {length} s fits after {start} s: the fixes end {:.1} s after the first",
                    last_fix - first_fix
                ));
            }
            let fits = fits as usize;
            if *count == Some(0) {
                return Err("the number of outages must be above 0".into());
            }
            if fits > 1 && *every < length && count.is_none_or(|count| count > 1) {
                return Err(overlap(count.unwrap_or(fits)));
            }
            if let Some(count) = count.filter(|c| *c > fits) {
                return Err(format!(
                    "only {fits} of the {count} outages fit before the fixes end"
                ));
            }
            if count.unwrap_or(fits) > MOST_OUTAGES {
                return Err(too_many());
            }
            (0..count.unwrap_or(fits))
                .map(|i| from + every * i as f64)
                .collect()
        }
        Schedule::At(times) => {
            let mut times = times.clone();
            times.sort_by(f64::total_cmp);
            if let Some(time) = times
                .iter()
                .find(|t| !t.is_finite() || **t < first_fix || **t + length > last_fix + 1e-6)
            {
                return Err(format!(
                    "an outage of {length} s at {time} does not lie within the fixes, {first_fix} to {last_fix}"
                ));
            }
            times
        }
    };
    if starts.windows(2).any(|w| w[1] < w[0] + length) {
        return Err(overlap(starts.len()));
    }
    Ok(starts
        .into_iter()
        .map(|start| Outage {
            start,
            end: start + length,
        })
        .collect())
}
