//! The fixes of a table without names, by their numbers: latitudes and longitudes along a path, the velocities that fit
//! it, and accuracies behind them.

use super::found::Found;
use crate::columns::{FIX_STEP, time_unit};
use undrift_base::order_statistics::upper_median;
use undrift_nav::earth::{SEMI_MAJOR, wrap_pi};

/// Rows that show a path, at least.
const ROWS: usize = 10;
/// Largest range of a drive, longest step from row to row, and the noise of an antenna at rest \[deg\].
const RANGE: f64 = 5.0;
const STEP: f64 = 2e-3;
const REST: f64 = 2e-6;
/// A path is so many times as long as most of its steps; noise is not.
const LONG: f64 = 20.0;
/// Heights \[m\].
const HEIGHTS: std::ops::Range<f64> = -1000.0..20_000.0;
/// Heights below this beside radians show no place \[m\].
const LOW: f64 = 12.0;
/// Rows on either side over which a velocity is taken, and least speed of one that counts [m/s].
const ASIDE: usize = 2;
const MOVING: f64 = 1.0;
/// Differences of a velocity to that of the positions, and sizes of the vertical one, as shares of the speed.
const MISFIT: f64 = 0.15;
const CLIMB: f64 = 0.3;
/// How many times as large as in m/s a speed is in km/h, knots, cm/s and mm/s, to so much.
const SPEEDS: [f64; 5] = [1.0, 3.6, 1.944, 100.0, 1000.0];
const ALIKE: std::ops::Range<f64> = 0.8..1.25;
/// Most that a course differs from that of the positions \[rad\].
const COURSE: f64 = 0.2;
/// Accuracies are above zero and below this \[m\], [m/s].
const INACCURATE: f64 = 200.0;

/// Columns of a table by their numbers.
type Table<'a> = &'a [Vec<f64>];

impl Found {
    /// Whether a column is known to be something else than an inertial sensor.
    pub(super) fn uses(&self, column: usize) -> bool {
        let threes = [
            self.place,
            self.velocity,
            self.position_std,
            self.velocity_std,
            self.accuracy,
        ];
        let all = threes
            .as_flattened()
            .iter()
            .chain(&self.polar)
            .chain([&self.time]);
        all.flatten().any(|known| *known == column)
    }
}

/// Finds latitude, longitude and height where they follow a path, and what is behind them.
pub(super) fn find(columns: Table, found: &mut Found) {
    let has_time = |k: usize| found.time.is_some_and(|time| (k..k + 3).contains(&time));
    let all = 0..columns.len().saturating_sub(2);
    let orders = |k: usize| [[k, k + 1, k + 2], [k + 1, k, k + 2]];
    let all = all.filter(|k| !has_time(*k)).flat_map(orders);
    // Degrees, else radians.
    let degree = 1f64.to_radians();
    let mut both = [1.0, 1.0 / degree]
        .into_iter()
        .flat_map(|scale| all.clone().map(move |place| (place, scale)));
    let Some((place, scale)) = both.find(|(place, scale)| is_path(columns, *place, *scale)) else {
        return;
    };
    found.place = place.map(Some);
    let path = path(columns, place, scale, found.time);
    let course = if scale == 1.0 { degree } else { 1.0 };
    find_velocity(columns, &path, course, found);
    // A course in radians cannot be read.
    if scale != 1.0 && found.polar[1].take().is_some() {
        found.polar = [None; 2];
    } else {
        find_accuracies(columns, found);
    }
}

/// Whether columns are latitude and longitude, by so much in degrees, and height.
fn is_path(columns: Table, place: [usize; 3], scale: f64) -> bool {
    let [Some(north), Some(east), Some(height)] = place.map(|k| columns.get(k)) else {
        return false;
    };
    let rows = north.iter().zip(east).zip(height);
    let rows = rows.filter(|((lat, lon), _)| lat.is_finite() && lon.is_finite());
    let (places, heights): (Vec<(f64, f64)>, Vec<f64>) = rows
        .map(|((lat, lon), height)| ((scale * lat, scale * lon), *height))
        .unzip();
    let on_earth =
        |(lat, lon): &(f64, f64)| (1.0..=90.0).contains(&lat.abs()) && lon.abs() <= 180.0;
    let fine = |degrees: f64| (1e4 * degrees - (1e4 * degrees).round()).abs() > 1e-3;
    let fine = places
        .iter()
        .filter(|(lat, lon)| fine(*lat) || fine(*lon))
        .count();
    let high = heights
        .iter()
        .filter(|height| HEIGHTS.contains(height))
        .count();
    // In radians a field or a quaternion is as small, but nothing behind it as large as most heights.
    let low = heights.iter().filter(|height| height.abs() < LOW).count();
    if scale != 1.0 && 2 * low > heights.len() {
        return false;
    }
    let whole = |of: fn(&(f64, f64)) -> f64| places.iter().all(|place| of(place).fract() == 0.0);
    if whole(|place| place.0) || whole(|place| place.1) {
        return false;
    }
    if places.len() < ROWS
        || !places.iter().all(on_earth)
        || 2 * fine < places.len()
        || 2 * high < places.len()
    {
        return false;
    }
    let range = |of: fn(&(f64, f64)) -> f64| {
        let (low, high) = places
            .iter()
            .map(of)
            .fold((f64::MAX, f64::MIN), |(low, high), x| {
                (low.min(x), high.max(x))
            });
        high - low
    };
    let range = range(|place| place.0).max(range(|place| place.1));
    let step = |pair: &[(f64, f64)]| {
        (pair[1].0 - pair[0].0)
            .abs()
            .max((pair[1].1 - pair[0].1).abs())
    };
    let mut steps: Vec<f64> = places.windows(2).map(step).collect();
    steps.sort_by(f64::total_cmp);
    let most = steps.get(steps.len() * 9 / 10).copied().unwrap_or(f64::NAN);
    range < RANGE && most < STEP && (most <= REST || range >= LONG * most)
}

/// A row in which the positions move: its number, and their velocity north, east, down [m/s].
struct Moving {
    row: usize,
    v: [f64; 3],
}

impl Moving {
    fn speed(&self) -> f64 {
        self.v[0].hypot(self.v[1])
    }
}

/// The rows in which the positions move.
fn path(columns: Table, place: [usize; 3], angle: f64, time: Option<usize>) -> Vec<Moving> {
    let stamps = time
        .and_then(|time| columns.get(time))
        .map_or(&[][..], Vec::as_slice);
    let scale = time_unit(stamps, FIX_STEP).map_or(1.0, |(_, factor)| factor);
    let moved = |row: usize| {
        let at =
            |column: &[f64]| Some(column.get(row + ASIDE)? - column.get(row.checked_sub(ASIDE)?)?);
        let of = |k: usize| at(columns.get(*place.get(k)?)?);
        let dt = at(stamps)? * scale;
        let radius = SEMI_MAJOR;
        let angle = angle.to_radians();
        let parallel = radius * (angle * columns.get(place[0])?.get(row)?).cos();
        let v = [radius * angle * of(0)?, parallel * angle * of(1)?, -of(2)?].map(|d| d / dt);
        let moving = Moving { row, v };
        (moving.speed() > MOVING && moving.speed().is_finite() && v[2].is_finite())
            .then_some(moving)
    };
    (0..stamps.len()).filter_map(moved).collect()
}

/// Finds the velocity along axes or as speed and course, which is by so much in radians.
fn find_velocity(columns: Table, path: &[Moving], course: f64, found: &mut Found) {
    let value = |k: usize, at: &Moving| {
        columns
            .get(k)
            .and_then(|c| c.get(at.row))
            .copied()
            .unwrap_or(f64::NAN)
    };
    let driven: f64 = path.iter().map(Moving::speed).sum();
    if path.len() < ROWS {
        return;
    }
    let unknown: Vec<usize> = (0..columns.len()).filter(|k| !found.uses(*k)).collect();
    let misfit = |k: usize, axis: usize| -> f64 {
        let apart = path.iter().map(|at| (value(k, at) - at.v[axis]).abs());
        apart.sum::<f64>() / driven
    };
    let small = |k: usize| path.iter().map(|at| value(k, at).abs()).sum::<f64>() < CLIMB * driven;
    for three in unknown.windows(3) {
        let [a, b, c] = [three[0], three[1], three[2]];
        if c != a + 2 || !small(c) {
            continue;
        }
        let enu = misfit(a, 1) < MISFIT && misfit(b, 0) < MISFIT;
        if enu || (misfit(a, 0) < MISFIT && misfit(b, 1) < MISFIT) {
            // By how it goes with the heights, else as usual in that order.
            let sum = |of: &dyn Fn(&Moving) -> f64| path.iter().map(of).sum::<f64>();
            let both = sum(&|at| value(c, at) * at.v[2]);
            let sizes = sum(&|at| value(c, at).powi(2)) * sum(&|at| at.v[2].powi(2));
            let certain = both.powi(2) > 0.1 * sizes;
            found.up = if certain { both < 0.0 } else { enu };
            let [north, east] = if enu { [b, a] } else { [a, b] };
            found.velocity = [Some(north), Some(east), Some(c)];
            return;
        }
    }
    let is_speed = |k: &usize| {
        let mut ratios: Vec<f64> = path.iter().map(|at| value(*k, at) / at.speed()).collect();
        if ratios.iter().any(|ratio| !ratio.is_finite()) {
            return false;
        }
        let median = upper_median(&mut ratios);
        let alike = |ratio: &&f64| ALIKE.contains(&(**ratio / median));
        10 * ratios.iter().filter(alike).count() >= 9 * ratios.len()
            && SPEEDS.iter().any(|unit| ALIKE.contains(&(median / unit)))
    };
    let is_course = |k: &usize| {
        let apart = |at: &Moving| wrap_pi(course * value(*k, at) - at.v[1].atan2(at.v[0])).abs();
        let mut apart: Vec<f64> = path.iter().map(apart).collect();
        apart.iter().all(|angle| angle.is_finite()) && upper_median(&mut apart) < COURSE
    };
    let speed = unknown.iter().find(|k| is_speed(k)).copied();
    let course = unknown
        .iter()
        .filter(|k| Some(**k) != speed)
        .find(|k| is_course(k))
        .copied();
    if speed.and(course).is_some() {
        found.polar = [speed, course];
    }
}

/// Finds the accuracies behind what is known: of the horizontal position, the height and the speed, or north, east and
/// down.
fn find_accuracies(columns: Table, found: &mut Found) {
    let Some(last) = (0..columns.len()).rfind(|k| found.uses(*k)) else {
        return;
    };
    let numbers = |k: &usize| {
        columns
            .get(*k)
            .into_iter()
            .flatten()
            .filter(|x| x.is_finite())
    };
    let counts = |k: &usize| numbers(k).all(|x| x.fract() == 0.0);
    let is_accuracy = |k: &usize| !counts(k) && numbers(k).all(|x| *x > 0.0 && *x < INACCURATE);
    let behind = (last + 1..columns.len())
        .skip_while(counts)
        .take_while(is_accuracy);
    let behind: Vec<usize> = behind.collect();
    let size = |k: usize| upper_median(&mut numbers(&k).copied().collect::<Vec<f64>>());
    let moves = found.velocity[0].or(found.polar[0]).is_some();
    match *behind.as_slice() {
        [n, e, d, vn, ve, vd, ..] if moves => {
            found.position_std = [n, e, d].map(Some);
            found.velocity_std = [vn, ve, vd].map(Some);
        }
        // A speed is more accurate than a position, a height is not.
        [across, up, fast, ..] if size(fast) < size(across) => {
            found.accuracy = [across, up, fast].map(Some);
        }
        [n, e, d, ..] => found.position_std = [n, e, d].map(Some),
        [across, up] => found.accuracy = [Some(across), Some(up), None],
        _ => {}
    }
}

#[cfg(test)]
mod tests;
