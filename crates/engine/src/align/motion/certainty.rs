//! How certain the attitude of a window has to be.

/// Largest standard deviation of the attitude about any axis for a start at once \[rad\]: the filter, unlike the window,
/// cannot undo what it took from an attitude that was some degrees off.
const GOOD: f64 = 0.017;
/// After so long without a start \[s\] it may be larger …
const PATIENT: f64 = 20.0;
/// … by so much for each second more \[rad/s\] …
const LENIENT: f64 = 0.0009;
/// … up to 3 deg after a minute, and from four minutes on further \[s\]: windows that say little have wrong minima, too …
const PLATEAU: [f64; 2] = [60.0, 240.0];
/// … and never larger than this \[rad\].
const CERTAIN: f64 = 0.2;

/// Standard deviation of the attitude \[rad\] that is enough for a start, and beyond which a solution is dropped, after so
/// long \[s\] without a start; of a window of positions `alone` or of velocities, which still `grows` or not.
pub(super) fn certainty(waited: f64, alone: bool, grows: bool) -> (f64, f64) {
    let lenient = |waited: f64| (GOOD + LENIENT * (waited - PATIENT).max(0.0)).min(CERTAIN);
    let [from, to] = PLATEAU;
    let by_now = lenient(waited.min(from) + (waited - to).max(0.0));
    // Velocities become certain soon: their window is waited for.
    let settled = by_now.max(lenient(from));
    match (alone, grows) {
        (true, _) => (by_now, CERTAIN),
        (false, true) => (GOOD, settled),
        (false, false) => (settled, settled),
    }
}
