//! Work spread over all cores.

use rayon::prelude::*;
use std::sync::Mutex;

/// What `one` makes of 0, 1, … `count` − 1, worked out on rayon's threads, in order.
///
/// For work of which each part takes long against the lock of its place. The spreading itself is compiled once for all
/// that is spread: rayon's own chains are thousands of lines of code for each closure.
pub fn collect<T: Send>(count: usize, one: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let places: Vec<Mutex<Option<T>>> = (0..count).map(|_| Mutex::new(None)).collect();
    each(count, &|at| {
        let made = one(at);
        // A panic of another part ends the whole; no lock is held meanwhile.
        if let Ok(mut place) = places[at].lock() {
            *place = Some(made);
        }
    });
    let made = places.into_iter().map(Mutex::into_inner);
    made.filter_map(|place| place.ok().flatten()).collect()
}

fn each(count: usize, one: &(dyn Fn(usize) + Sync)) {
    (0..count).into_par_iter().for_each(one);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_keep_their_order() {
        let squares = collect(1000, |k| collect(2, |j| k * k + j));
        for (k, found) in squares.iter().enumerate() {
            assert_eq!(*found, [k * k, k * k + 1]);
        }
        assert!(collect(0, |k| k).is_empty());
    }

    #[test]
    fn a_panic_of_one_part_is_one_of_the_whole() {
        let lost = std::panic::catch_unwind(|| collect(4, |k| assert!(k != 2)));
        assert!(lost.is_err());
    }
}
