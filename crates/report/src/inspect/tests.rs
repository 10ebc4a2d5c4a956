//! Sentences of an inspection.

use super::*;

#[test]
fn fixes_are_counted_by_the_kinds_that_there_are() {
    let of = |kinds, velocities| content(&Content::Fixes { kinds, velocities });
    assert_eq!(
        of([30, 0, 2, 0, 1], 4),
        "fixes: 30 fixed, 2 differential, 1 of unknown kind; 4 with a velocity"
    );
    assert_eq!(
        of([0, 5, 0, 7, 0], 0),
        "fixes: 5 float, 7 single; 0 with a velocity"
    );
}
