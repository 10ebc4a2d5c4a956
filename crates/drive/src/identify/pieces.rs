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

#[cfg(test)]
mod tests {
    use super::*;

    fn step(at: Range<usize>) -> Step {
        Step {
            axis: "gyro_x",
            size: 1.0,
            at,
        }
    }

    #[test]
    fn what_is_beyond_a_step_reaches_to_the_next_one_or_the_end() {
        let (part, steps) = (10..100, [step(20..22), step(50..51), step(80..83)]);
        let of = |piece: Range<usize>| {
            let all = beyond(&steps, &part, &piece);
            all.map(|(step, range)| {
                assert!(steps.contains(step));
                range
            })
            .collect::<Vec<_>>()
        };
        // Each step goes with what is farther away from the piece.
        assert_eq!(of(22..50), [10..22, 50..80, 80..100]);
        assert_eq!(of(51..80), [10..22, 22..51, 80..100]);
        assert_eq!(of(83..100), [10..22, 22..51, 51..83]);
        assert_eq!(of(10..20), [20..50, 50..80, 80..100]);
        assert_eq!(beyond(&[], &part, &part).count(), 0);
    }

    #[test]
    fn the_longest_piece_lies_between_steps_or_an_end() {
        let of = |steps: &[Step]| longest_piece(&(10..100), steps);
        assert_eq!(of(&[]), 10..100);
        assert_eq!(of(&[step(20..22), step(50..51)]), 51..100);
        assert_eq!(of(&[step(20..22), step(80..83)]), 22..80);
        assert_eq!(of(&[step(60..62)]), 10..60);
        // The first where they are as long, and what overlaps has no piece.
        assert_eq!(of(&[step(50..60)]), 10..50);
        assert_eq!(
            longest_between(&(0..100), [20..70, 30..40].into_iter()),
            70..100
        );
        assert_eq!(longest_between(&(0..10), std::iter::once(0..10)), 0..0);
        assert_eq!((longer(0..5, 7..12), longer(0..5, 7..13)), (0..5, 7..13));
    }

    #[test]
    fn what_is_left_of_a_whole_is_before_and_after_its_part() {
        let of = |part: Range<usize>| {
            let ends = |part: Range<usize>| (part.start, part.end);
            within(&(10..20), &part).map(ends).collect::<Vec<_>>()
        };
        assert_eq!(of(13..18), [(10, 13), (18, 20)]);
        assert_eq!((of(10..18), of(13..20)), (vec![(18, 20)], vec![(10, 13)]));
        assert!(of(10..20).is_empty());
    }
}
