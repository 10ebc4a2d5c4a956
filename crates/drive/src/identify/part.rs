//! The part of a record in which its sensor lies still: without the seconds in which it was handled, bumps, what is
//! before or after a step, other sessions.

use super::{
    NotStatic,
    pieces::{beyond, longer, longest_between, longest_piece, within},
    slow::{self, Subtracted},
    steps::steps,
    windows::Windows,
};
use crate::record::Record;
use std::ops::Range;
use undrift_noise::identify::SHORTEST;
use undrift_results::{Omission, Omitted};

/// Windows that may move, as a knock or two do; and their share.
const KNOCKS: usize = 5;
const SHARE: f64 = 0.02;
/// Shortest rest that is worth identifying, or that ends the handling of the sensor \[s\].
const LEAST_REST: f64 = 12.0;
/// Share of a record that rests at least, where what was handled is at its ends.
const RESTS: f64 = 0.5;
/// A gap longer than this \[s\] and this share of the samples is between two sessions, as are stamps that go back as far.
const APART: f64 = 10.0;
const APART_SHARE: f64 = 0.1;
/// Stamps that go back by more \[s\] restart.
const BACK: f64 = 1.0;

/// A part of a record.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Part {
    /// The samples used.
    pub(super) used: Range<usize>,
    /// Samples of bumps, which are missing then.
    pub(super) bumps: Vec<Range<usize>>,
    /// What is not used, in order.
    pub(super) left_out: Vec<Omitted>,
    /// What is subtracted from the samples that are used.
    pub(super) subtracted: Vec<Subtracted>,
}

/// The part of a record at a rate \[Hz\] in which all its axes rest; gaps between its stamps are NaN, where that is possible.
///
/// # Errors
/// [`NotStatic::Moving`] where it moves for longer than knocks last and not just at its ends.
pub(super) fn part_at_rest(record: &Record, rate_hz: f64) -> Result<Part, NotStatic> {
    let windows = Windows::new(record, rate_hz);
    let seconds = |windows_: usize| (windows_ * windows.width) as f64 / rate_hz;
    let length = record.length() as f64 / rate_hz;
    let end_of = |window: usize| match window >= windows.count {
        true => length,
        false => seconds(window),
    };
    let mut left_out = Vec::new();
    let session = longest_session(record, &windows, rate_hz);
    left_out.extend(within(&(0..windows.count), &session).map(|part| Omitted {
        why: Omission::Session,
        start_s: seconds(part.start).into(),
        end_s: end_of(part.end).into(),
        ..Omitted::default()
    }));
    let mut masked = windows.bumped(&session);
    let loud = short_runs(&windows.loud(&session));
    for short in [loud, swings(&windows, &session)] {
        masked.iter_mut().zip(short).for_each(|(a, b)| *a |= b);
    }
    let found = steps(&windows, &session, &masked);
    let piece = longest_piece(&session, &found);
    left_out.extend(
        beyond(&found, &session, &piece).filter_map(|(step, range)| {
            let Range { start, end } = range;
            let (start_s, end_s) = (seconds(start).into(), end_of(end).into());
            let resting = (start..end).filter(|window| windows.rests(*window)).count();
            let lies_still = mostly(resting, end - start);
            let step = lies_still.then(|| (step.axis.to_owned(), step.size));
            (end > start).then(|| Omitted {
                why: if lies_still {
                    Omission::Step
                } else {
                    Omission::Handled
                },
                start_s,
                end_s,
                step: step.as_ref().map(|(_, size)| *size).into(),
                axis: step.map(|(axis, _)| axis),
                ..Omitted::default()
            })
        }),
    );
    let disturbed = disturbed(&windows, &piece);
    let moving = |range: Range<usize>| disturbed[range].iter().filter(|moves| **moves).count();
    let refused = || NotStatic::Moving {
        moving_s: seconds(moving(0..piece.len())),
        length_s: seconds(windows.count),
        rest: longest(&windows)
            .map(|rest| (seconds(rest.start).ceil(), seconds(rest.end).floor()))
            .filter(|(start, end)| {
                end - start >= LEAST_REST && (end - start) * rate_hz >= SHORTEST as f64
            }),
    };
    let rest = ((LEAST_REST / seconds(1)).ceil() as usize).clamp(1, (piece.len() / 4).max(1));
    let Some(still) = between_handling(&disturbed, rest) else {
        return match windows.count {
            0..3 => Ok(Part {
                used: 0..record.length(),
                ..Part::default()
            }),
            _ => Err(refused()),
        };
    };
    let count = moving(still.clone());
    if !mostly(still.len(), piece.len())
        || count > KNOCKS && count as f64 > SHARE * still.len() as f64
    {
        return Err(refused());
    }
    let kept = piece.start + still.start..piece.start + still.end;
    left_out.extend(within(&piece, &kept).map(|part| Omitted {
        why: Omission::Handled,
        start_s: seconds(part.start).into(),
        end_s: end_of(part.end).into(),
        ..Omitted::default()
    }));
    let slow = slow::without_slow(&windows, &kept, &disturbed[still.clone()], rate_hz);
    left_out.extend(slow.left_out);
    let still = slow.kept.start - piece.start..slow.kept.end - piece.start;
    let kept = slow.kept;
    let mut bumps = Vec::new();
    for run in runs(&disturbed[still.clone()]) {
        let run = kept.start + run.start..kept.start + run.end;
        left_out.push(Omitted {
            why: Omission::Bump,
            start_s: seconds(run.start).into(),
            end_s: seconds(run.end).into(),
            ..Omitted::default()
        });
        bumps.push(run.start * windows.width..run.end * windows.width);
    }
    left_out.sort_by(|a, b| a.start_s.0.total_cmp(&b.start_s.0));
    let end = match kept.end == windows.count {
        true => record.length(),
        false => kept.end * windows.width,
    };
    Ok(Part {
        used: kept.start * windows.width..end,
        bumps,
        left_out,
        subtracted: slow.subtracted,
    })
}

/// Whether what rests is enough of a part.
fn mostly(resting: usize, windows: usize) -> bool {
    resting as f64 >= RESTS * windows as f64
}

/// The windows of the longest session: between long gaps, and stamps that restart.
fn longest_session(record: &Record, windows: &Windows, rate_hz: f64) -> Range<usize> {
    let least = (APART * rate_hz).max(APART_SHARE * record.length() as f64);
    let mut ends: Vec<Range<usize>> = Vec::new();
    // Filled gaps are windows without a sample; between stamps that are there, they are not filled.
    let missing: Vec<bool> = (0..windows.count).map(|k| !windows.has(k)).collect();
    let long = |run: &Range<usize>| (run.len() * windows.width) as f64 > least;
    ends.extend(runs(&missing).filter(long));
    if let Some(timing) = record.timing.as_ref().filter(|_| !record.stamps.is_empty()) {
        let gaps = timing.gaps.iter();
        let gaps = gaps.filter(|gap| gap.length_s * rate_hz > least);
        let stamps = &record.stamps;
        let back = |k: &&usize| stamps[**k - 1] - stamps[**k] > BACK;
        let back = timing.not_increasing.iter().filter(back).copied();
        let breaks = gaps.map(|gap| gap.index + 1).chain(back);
        ends.extend(breaks.map(|at| at / windows.width..at.div_ceil(windows.width)));
    }
    ends.sort_by_key(|end| end.start);
    longest_between(&(0..windows.count), ends.into_iter())
}

/// Which windows of a part move, or shake beside ones that do, or for a moment, or swing for one.
fn disturbed(windows: &Windows, part: &Range<usize>) -> Vec<bool> {
    let (mut disturbed, loud) = (windows.moving(part), windows.loud(part));
    let short = short_runs(&loud);
    for run in runs(&loud) {
        let near = run.start.saturating_sub(1)..(run.end + 1).min(disturbed.len());
        if short[run.start] || disturbed[near].contains(&true) {
            disturbed[run].fill(true);
        }
    }
    let swings = swings(windows, part);
    disturbed.iter_mut().zip(swings).for_each(|(a, b)| *a |= b);
    disturbed
}

/// Which windows of a part swing for a moment, and those beside them, into which a gentle swing reaches.
fn swings(windows: &Windows, part: &Range<usize>) -> Vec<bool> {
    let swings = short_runs(&windows.swings(part));
    let near = |k: usize| k.saturating_sub(1)..(k + 2).min(swings.len());
    (0..swings.len())
        .map(|k| swings[near(k)].contains(&true))
        .collect()
}

/// The runs that are as short as a knock, where they are few: an engine is not a knock.
fn short_runs(flags: &[bool]) -> Vec<bool> {
    let short = || runs(flags).filter(|run| run.len() <= KNOCKS);
    let total: usize = short().map(|run| run.len()).sum();
    let mut found = vec![false; flags.len()];
    if total <= KNOCKS || total as f64 <= SHARE * flags.len() as f64 {
        short().for_each(|run| found[run].fill(true));
    }
    found
}

/// From the first rest of so many windows to the end of the last, a window less where the record begins or ends otherwise.
fn between_handling(disturbed: &[bool], rest: usize) -> Option<Range<usize>> {
    let count = disturbed.len();
    let rests = |from: &usize| !disturbed[*from..from + rest].contains(&true);
    let mut places = 0..(count + 1).saturating_sub(rest);
    let first = places.clone().find(rests)?;
    let end = places.rfind(rests)? + rest;
    let still = inside(&(first..end), count);
    (!still.is_empty()).then_some(still)
}

/// A rest, a window less at either end where the record of `count` windows goes on.
fn inside(rest: &Range<usize>, count: usize) -> Range<usize> {
    let start = if rest.start == 0 { 0 } else { rest.start + 1 };
    let end = if rest.end == count {
        count
    } else {
        rest.end - 1
    };
    start..end
}

/// The runs of windows that have a flag.
fn runs(flags: &[bool]) -> impl Iterator<Item = Range<usize>> {
    let mut at = 0;
    std::iter::from_fn(move || {
        let start = at + flags[at..].iter().position(|flag| *flag)?;
        let length = flags[start..].iter().position(|flag| !flag);
        at = length.map_or(flags.len(), |length| start + length);
        Some(start..at)
    })
}

/// The longest run of windows that rest, without the first and last where the record goes on.
fn longest(windows: &Windows) -> Option<Range<usize>> {
    let rests: Vec<bool> = (0..windows.count).map(|k| windows.rests(k)).collect();
    let runs = runs(&rests).map(|run| inside(&run, windows.count));
    let longest = runs.fold(0..0, longer);
    (!longest.is_empty()).then_some(longest)
}

#[cfg(test)]
mod tests;
