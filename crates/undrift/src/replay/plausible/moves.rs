//! Whether positions move as velocities say.

use super::Implausible;
use undrift_nav::{
    Vector3,
    earth::Geodetic,
    sample::{GnssFix, Position},
};

/// Length of the windows over which position and velocity are compared [s], and how many there must be.
const MOVE_WINDOW: f64 = 2.0;
const LEAST_MOVES: u32 = 8;
/// Fixes further apart than this do not belong together [s].
const APART: f64 = 2.5;
/// Least share of windows of motion that are as they should be.
const LEAST_SANE: f64 = 0.4;
/// Two displacements agree to this part of the larger one.
const AGREE: f64 = 0.2;

/// What a velocity may be instead of north, east in m/s, and the matrix that mends it.
const MENDS: [(&str, [f64; 4]); 12] = [
    ("", [1.0, 0.0, 0.0, 1.0]),
    (
        "the velocity is east, north, not north, east",
        [0.0, 1.0, 1.0, 0.0],
    ),
    ("latitude and longitude are swapped", [0.0, 1.0, 1.0, 0.0]),
    (
        "the velocity east (or the longitude) has the wrong sign",
        [1.0, 0.0, 0.0, -1.0],
    ),
    (
        "the velocity north (or the latitude) has the wrong sign",
        [-1.0, 0.0, 0.0, 1.0],
    ),
    ("the velocity has the wrong signs", [-1.0, 0.0, 0.0, -1.0]),
    ("the velocity is in km/h", [1.0 / 3.6, 0.0, 0.0, 1.0 / 3.6]),
    ("the velocity is in knots", [0.514_444, 0.0, 0.0, 0.514_444]),
    ("the velocity is in ft/s", [0.3048, 0.0, 0.0, 0.3048]),
    ("the velocity is in cm/s", [0.01, 0.0, 0.0, 0.01]),
    ("the velocity is in mm/s", [0.001, 0.0, 0.0, 0.001]),
    (
        "latitude and longitude are in rad, not deg",
        [0.017_453_3, 0.0, 0.0, 0.017_453_3],
    ),
];
/// Place of swapped latitude and longitude in [`MENDS`].
const SWAPPED: usize = 2;

/// A fix with velocity: time [s], velocity and position.
type Place = (f64, Vector3, Option<(Geodetic, f64)>);

/// What is known so far.
#[derive(Default)]
pub(super) struct Moves {
    /// The last fix, where the present window of motion began, and how far velocity went since [m].
    last: Option<Place>,
    began: Option<(f64, Geodetic)>,
    moved: Vector3,
    /// Windows of motion, those that are as they should be, and the sum of what each of [`MENDS`] leaves
    /// unexplained.
    moves: u32,
    sane: u32,
    unexplained: [f64; MENDS.len()],
}

impl Moves {
    /// Takes in a fix of this velocity.
    pub(super) fn fix(&mut self, fix: &GnssFix, velocity: &Vector3) {
        let (time, velocity) = (fix.time, *velocity);
        let position = match &fix.position {
            Some((Position::Geodetic(place), r)) => {
                Some((*place, r.fixed_view::<2, 2>(0, 0).trace().sqrt()))
            }
            _ => None,
        };
        let last = self.last.replace((time, velocity, position));
        let Some((position, std)) = position else {
            self.began = None;
            return;
        };
        let (Some((last, before, _)), Some((start, origin))) = (last, self.began) else {
            (self.began, self.moved) = (Some((time, position)), Vector3::zeros());
            return;
        };
        self.moved += (velocity + before) * (0.5 * (time - last));
        if time - last <= APART && time - start < MOVE_WINDOW {
            return;
        }
        let (seen, told) = (origin.offset_to(&position), self.moved);
        let together = time - last <= APART;
        (self.began, self.moved) = (Some((time, position)), Vector3::zeros());
        let size = seen.xy().norm().max(told.xy().norm());
        // Noise of two positions is to be small against the way.
        if !together || size < 2.0 + 10.0 * std || !size.is_finite() {
            return;
        }
        self.moves += 1;
        for (k, (_, matrix)) in MENDS.iter().enumerate() {
            let [nn, mut ne, mut en, ee] = *matrix;
            if k == SWAPPED {
                // The circle of latitude that is meant is that of the longitude given.
                (ne, en) = (1.0 / position.lon.cos(), position.lat.cos());
            }
            let mended = [nn * told.x + ne * told.y, en * told.x + ee * told.y];
            let size = seen.xy().norm().max(mended[0].hypot(mended[1]));
            let left = (seen.x - mended[0]).hypot(seen.y - mended[1]);
            self.unexplained[k] += (left / size).min(1.0);
            self.sane += u32::from(k == 0 && left < AGREE * size + 3.0 * std);
        }
    }

    /// What the moves show.
    pub(super) fn finding(&self) -> Option<Implausible> {
        let moves = f64::from(self.moves);
        if self.moves < LEAST_MOVES || f64::from(self.sane) >= LEAST_SANE * moves {
            return None;
        }
        let best = (1..MENDS.len())
            .min_by(|a, b| self.unexplained[*a].total_cmp(&self.unexplained[*b]))
            .filter(|k| self.unexplained[*k] < AGREE * moves);
        Some(Implausible::Velocity(best.map(|k| MENDS[k].0)))
    }
}
