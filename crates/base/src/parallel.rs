//! Work spread over all cores.

use rayon::prelude::*;
use std::sync::Mutex;

/// A parallel map: `one` of 0, 1, … `count` − 1, on rayon's threads; results in this order.
///
/// For work of which each part takes long against locking a mutex. The scheduling is compiled once for all callers:
/// rayon's parallel iterators are thousands of lines of code, monomorphised for each closure.
pub fn map<T: Send>(count: usize, one: impl Fn(usize) -> T + Sync) -> Vec<T> {
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
        let squares = map(1000, |k| map(2, |j| k * k + j));
        for (k, found) in squares.iter().enumerate() {
            assert_eq!(*found, [k * k, k * k + 1]);
        }
        assert!(map(0, |k| k).is_empty());
    }

    #[test]
    fn a_panic_of_one_part_is_one_of_the_whole() {
        let lost = std::panic::catch_unwind(|| map(4, |k| assert!(k != 2)));
        assert!(lost.is_err());
    }
}
