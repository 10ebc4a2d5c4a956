//! Pieces of a record: before, between and after what is left out.

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
