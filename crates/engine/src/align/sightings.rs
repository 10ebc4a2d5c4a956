//! What the fixes of a window say of the antenna: velocities, or positions alone.

use crate::{
    derived::{antenna, white_variance},
    estimator::STAMP_ROUNDING,
};
use alloc::{collections::VecDeque, vec::Vec};
use undrift_nav::{Vector3, sample::GnssFix};

/// Positions that a velocity about one of them is read from lie no further from it than this \[s\].
const NEAR: f64 = 1.1;
/// Least share of their stated variance that positions have in the search: nothing is exact.
const LEAST_SHARE: f64 = 4e-4;
/// Standard deviation of a position without information \[m\].
const NOTHING: f64 = 1e6;

/// What a fix says of the antenna.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sighting {
    pub(super) time: f64,
    /// Velocity [m/s]; where positions are what is measured, about.
    pub(super) v_n: Vector3,
    /// Position in `n` against the first \[m\], where that is measured.
    pub(super) place: Vector3,
    /// Variances of what is measured.
    pub(super) variance: Vector3,
}

/// What the fixes of a window say: their velocities, or of positions `alone` their places, with the variance that they show by
/// their scatter times `looser`, at most what they state.
pub(super) fn sightings(fixes: &VecDeque<GnssFix>, alone: bool, looser: f64) -> Vec<Sighting> {
    if !alone {
        let velocity = |fix: &GnssFix| {
            fix.velocity.map(|(v_n, covariance)| Sighting {
                time: fix.time,
                v_n,
                variance: covariance.diagonal(),
                ..Sighting::default()
            })
        };
        return fixes.iter().filter_map(velocity).collect();
    }
    let Some(first) = fixes.front().and_then(antenna) else {
        return Vec::new();
    };
    let position = |fix: &GnssFix| {
        Some(Sighting {
            time: fix.time,
            place: first.offset_to(&antenna(fix)?),
            variance: fix.position?.1.diagonal(),
            ..Sighting::default()
        })
    };
    let mut seen: Vec<Sighting> = fixes.iter().filter_map(position).collect();
    let track: Vec<(f64, Vector3)> = seen.iter().map(|s| (s.time, s.place)).collect();
    // What is common to all of them is no matter here: where it is shown, their white part alone counts.
    let white = white_variance(&track);
    let (mut from, mut to) = (0, 0);
    for (k, of) in seen.iter_mut().enumerate() {
        while of.time - track[from].0 > NEAR && from < k {
            from += 1;
        }
        while to + 1 < track.len() && (track[to + 1].0 - of.time <= NEAR || to < k) {
            to += 1;
        }
        let ((begin, here), (end, there)) = (track[from], track[to]);
        if end > begin {
            of.v_n = (there - here) / (end - begin);
        }
        if let Some(white) = white {
            let least = white.sup(&(of.variance * LEAST_SHARE));
            of.variance = (least * looser).inf(&of.variance);
        }
    }
    seen
}

/// Positions that hold `late` \[s\] after their stamps, those after the window's `end` \[s\] excluded; the last sighting is
/// that end, without information.
pub(super) fn held_late(seen: &[Sighting], late: f64, end: f64) -> Vec<Sighting> {
    let held = seen.iter().map(|of| Sighting {
        time: of.time + late,
        ..*of
    });
    let mut held: Vec<Sighting> = held.filter(|of| of.time < end - STAMP_ROUNDING).collect();
    let last = held.last().copied().unwrap_or_default();
    held.push(Sighting {
        time: end,
        variance: Vector3::repeat(NOTHING * NOTHING),
        ..last
    });
    held
}

/// How far apart velocities are over ground: the diagonal of the box that holds them \[m/s\].
pub(super) fn spread(seen: &[Sighting]) -> f64 {
    let wide = Vector3::repeat(f64::INFINITY);
    let (low, high) = seen.iter().fold((wide, -wide), |(low, high), fix| {
        (low.inf(&fix.v_n), high.sup(&fix.v_n))
    });
    (high - low).xy().norm()
}
