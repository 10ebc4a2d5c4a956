//! Pieces of a record: before, between and after what is excluded.

use super::steps::Step;
use std::ops::Range;

/// What of a whole is before and after its part.
pub(super) fn within(
    whole: &Range<usize>,
    part: &Range<usize>,
) -> impl Iterator<Item = Range<usize>> + use<> {
    let parts = [whole.start..part.start, part.end..whole.end];
    parts.into_iter().filter(|part| !part.is_empty())
}

/// Each of the steps of a part, in order, with what is beyond it, seen from the piece that is used.
pub(super) fn beyond<'a>(
    steps: &'a [Step],
    part: &Range<usize>,
    piece: &Range<usize>,
) -> impl Iterator<Item = (&'a Step, Range<usize>)> {
    let range = |k: usize| {
        let at = &steps[k].at;
        let last = k.checked_sub(1).map(|last| steps[last].at.end);
        let next = steps.get(k + 1).map(|next| next.at.start);
        match at.end <= piece.start {
            true => last.unwrap_or(part.start)..at.end,
            false => at.start..next.unwrap_or(part.end),
        }
    };
    let ranges: Vec<Range<usize>> = (0..steps.len()).map(range).collect();
    steps.iter().zip(ranges)
}

/// The longest piece of a part between its steps.
pub(super) fn longest_piece(part: &Range<usize>, steps: &[Step]) -> Range<usize> {
    longest_between(part, steps.iter().map(|step| step.at.clone()))
}

/// The longest of the pieces between breaks in order.
pub(super) fn longest_between(
    part: &Range<usize>,
    breaks: impl Iterator<Item = Range<usize>>,
) -> Range<usize> {
    let (mut best, mut start) = (0..0, part.start);
    for at in breaks.chain(std::iter::once(part.end..part.end)) {
        best = longer(best, start..at.start.max(start));
        start = start.max(at.end);
    }
    best
}

/// The longer of two parts, the first where they are as long.
pub(super) fn longer(one: Range<usize>, other: Range<usize>) -> Range<usize> {
    if other.len() > one.len() { other } else { one }
}
