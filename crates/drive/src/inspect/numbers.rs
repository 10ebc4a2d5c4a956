//! What the columns of a table are by their numbers alone.

use super::found::Found;
use super::places;
use super::units::{self, Force};
use crate::columns::{
    IMU_STEP, Meaning, is_of_another_quantity, meanings, ordinary_step, time_unit,
};
use undrift_io::table::Preview;
use undrift_results::inspect::Known;

/// Distances from the centre of the Earth of a place on it or in the air above \[m\].
const RADII: std::ops::Range<f64> = 6.33e6..6.41e6;
/// Samples of which a mean is taken.
const PART: usize = 25;

/// The column that is the time by its numbers alone: one of dates or times of day, else the first of those without another
/// meaning that only grows, and not by one from row to row, as a counter does.
pub(super) fn time_by_numbers(table: &Preview) -> Option<usize> {
    let known = meanings(&table.names);
    let unknown = |place: &usize| known.get(*place).is_none_or(Option::is_none);
    if let Some(time) = table.times.iter().find(|place| unknown(place)) {
        return Some(*time);
    }
    let grows = |place: &usize| {
        let column = |row: &Vec<f64>| row.get(*place).copied().unwrap_or(f64::NAN);
        let stamps: Vec<f64> = table.rows.iter().map(column).collect();
        let steps = || stamps.windows(2).map(|pair| pair[1] - pair[0]);
        stamps.len() > 2 && steps().all(|step| step > 0.0) && steps().any(|step| step != 1.0)
    };
    let width = table.rows.first().map_or(0, Vec::len);
    (0..width).filter(unknown).find(grows)
}

/// Finds the time by that it only grows, accelerometers by that gravity gives three columns a
/// constant magnitude, gyros beside them, and places by their range.
pub(super) fn by_numbers(table: &Preview) -> Found {
    let mut found = Found {
        known: Known::Numbers { several: false },
        ..Found::default()
    };
    let width = table.rows.first().map_or(0, Vec::len);
    let column = |k: usize| -> Vec<f64> {
        let value = |row: &Vec<f64>| row.get(k).copied().unwrap_or(f64::NAN);
        table.rows.iter().map(value).collect()
    };
    let columns: Vec<Vec<f64>> = (0..width).map(column).collect();
    let grows = |c: &&Vec<f64>| c.len() > 2 && c.windows(2).all(|pair| pair[1] > pair[0]);
    // A counter of the rows only where nothing else grows.
    let counts = |c: &Vec<f64>| c.windows(2).all(|pair| pair[1] - pair[0] == 1.0);
    let growing = |c: &Vec<f64>| grows(&c) && !counts(c);
    let time = columns.iter().position(growing);
    found.time = time.or_else(|| columns.iter().position(|c| grows(&c)));
    places::find(&columns, &mut found);
    // What a name says to be something else.
    let known = meanings(&table.names);
    let is_other = |column: usize| match known.get(column) {
        _ if table.times.contains(&column) => true,
        None => false,
        Some(None) => is_of_another_quantity(&table.names[column]),
        Some(Some((Meaning::Gyro(_) | Meaning::Accel(_), _))) => false,
        Some(Some(_)) => true,
    };
    let is_of_quaternion = of_quaternions(&columns);
    // Before the time or behind it.
    let free = |from: usize| {
        let mut three = from..from + 3;
        three.end <= width
            && !three
                .any(|column| found.uses(column) || is_other(column) || is_of_quaternion[column])
    };
    let samples = |k: usize| three_of(&table.rows, [k, k + 1, k + 2]);
    // The number of a sensor between the values is no value.
    let is_number = |k: usize| {
        let column = columns.get(k).map_or(&[][..], Vec::as_slice);
        let first = column.first().copied().unwrap_or_default();
        first != 0.0 && first.fract() == 0.0 && column.iter().all(|x| *x == first)
    };
    let beside = |accel: usize| {
        let free = |gyro: &usize| free(*gyro) && !samples(*gyro).is_empty();
        let of = |near: Option<usize>, number: Option<usize>, far: Option<usize>| {
            let far = far.filter(|_| number.is_some_and(is_number));
            far.filter(free).or(near.filter(free))
        };
        let back = |apart: usize| accel.checked_sub(apart);
        let before = of(back(3), back(1), back(4));
        let behind = of(Some(accel + 3), Some(accel + 3), Some(accel + 4));
        // A magnetometer is as steady as gravity.
        let mut both = before.iter().chain(&behind);
        let unsteady = both.find(|gyro| !steady(&samples(**gyro)));
        unsteady.copied().or(before).or(behind)
    };
    let of_force = |is_force: &dyn Fn(&[[f64; 3]]) -> bool| {
        (0..width).filter(|k| free(*k)).find_map(|k| {
            let samples = samples(k);
            let steady = steady(&samples) || steady(&means(&samples));
            (steady && is_force(&samples)).then_some(())?;
            Some((k, beside(k)?))
        })
    };
    let interval = found.time.and_then(|time| {
        let (_, factor) = time_unit(&columns[time], IMU_STEP)?;
        Some(ordinary_step(&columns[time])? * factor)
    });
    // The usual units before those whose gravity may be an angle.
    let usual = |samples: &[[f64; 3]]| {
        let unit = units::force(samples, None);
        matches!(unit, Force::Rates(("m/s^2" | "g", _)))
    };
    let increments = |samples: &[[f64; 3]]| {
        let unit = units::force(samples, interval);
        matches!(unit, Force::Increments(_))
    };
    let force = of_force(&usual)
        .or_else(|| of_force(&is_force))
        .or_else(|| of_force(&increments));
    let earth_fixed = |k: &usize| {
        let samples = samples(*k);
        let near = |v: &[f64; 3]| RADII.contains(&v.iter().map(|x| x * x).sum::<f64>().sqrt());
        samples.len() > 2 && samples.iter().all(near)
    };
    if force.is_none()
        && let Some(x) = (0..width).filter(|k| free(*k)).find(earth_fixed)
    {
        found.ecef = [0, 1, 2].map(|axis| Some(x + axis));
        return found;
    }
    if let Some((accel, gyro)) = force {
        // Rates at rest may look like gravity, which is steadier.
        let [force, rate] = [accel, gyro].map(|k| three_of(&table.rows, [k, k + 1, k + 2]));
        let (accel, gyro) = if is_force(&rate) && unsteadiness(&rate) < unsteadiness(&force) {
            (gyro, accel)
        } else {
            (accel, gyro)
        };
        found.accel = [0, 1, 2].map(|axis| Some(accel + axis));
        found.gyro = [0, 1, 2].map(|axis| Some(gyro + axis));
        return found;
    }
    let within = |k: usize, limit: f64| {
        columns.get(k).is_some_and(|c| {
            let (low, high) = c
                .iter()
                .fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(*x), h.max(*x)));
            low >= -limit
                && high <= limit
                && high - low < 5.0
                && low.abs() > 1.0
                && low.fract() != 0.0
        })
    };
    let from = found.time.map_or(0, |time| time + 1);
    if found.place[0].is_none()
        && let Some(lat) = (from..width.saturating_sub(2)).find(|&k| {
            let other = |column: usize| known.get(column).is_some_and(Option::is_some);
            within(k, 90.0) && within(k + 1, 180.0) && !(k..k + 3).any(other)
        })
    {
        found.place = [0, 1, 2].map(|k| Some(lat + k));
    }
    found
}

/// Most that the norm of a quaternion differs from one in a text.
const NORM: f64 = 2e-4;

/// Which columns are of four that are a quaternion in every row.
fn of_quaternions(columns: &[Vec<f64>]) -> Vec<bool> {
    let is_unit = |four: &[Vec<f64>]| {
        let norm = |row: usize| four.iter().map(|column| column[row].powi(2)).sum::<f64>();
        let rows = four[0].len();
        rows > 2 && (0..rows).all(|row| (norm(row).sqrt() - 1.0).abs() < NORM)
    };
    let mut found = vec![false; columns.len()];
    for (first, four) in columns.windows(4).enumerate() {
        if is_unit(four) {
            found[first..first + 4].fill(true);
        }
    }
    found
}

/// Whether the size of samples is that of gravity in a unit of accelerometers, or in their counts.
pub(super) fn is_force(samples: &[[f64; 3]]) -> bool {
    !matches!(units::force(samples, None), Force::Unknown(_)) || units::counts(samples).is_some()
}

/// Whether what is called angular rates is gravity, and what is called specific force is not, or less steadily so.
pub(crate) fn are_exchanged(rates: &[[f64; 3]], forces: &[[f64; 3]]) -> bool {
    let [rate, force] = [rates, forces].map(|samples| unsteadiness(&means(samples)));
    let clearly = if is_force(forces) { 3.0 } else { 1.0 };
    is_force(rates) && rate < 1.0 / 3.0 && clearly * rate < force
}

/// Means over a part of the rows, without vibration.
pub(super) fn means(samples: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let parts = samples.chunks_exact(PART);
    let mean =
        |part: &[[f64; 3]]| [0, 1, 2].map(|k| part.iter().map(|v| v[k]).sum::<f64>() / PART as f64);
    parts.map(mean).collect()
}

/// Whether the magnitude varies by less than a third.
pub(super) fn steady(samples: &[[f64; 3]]) -> bool {
    samples.len() > 2 && unsteadiness(samples) < 1.0 / 3.0
}

/// Between the magnitudes that one tenth and nine tenths of the samples do not exceed, over their median.
fn unsteadiness(samples: &[[f64; 3]]) -> f64 {
    let mut sizes: Vec<f64> = samples
        .iter()
        .map(|v| v.iter().map(|x| x * x).sum::<f64>().sqrt())
        .collect();
    sizes.sort_by(f64::total_cmp);
    let at = |share: usize| {
        sizes
            .get(sizes.len() * share / 100)
            .copied()
            .unwrap_or(f64::NAN)
    };
    (at(90) - at(10)) / at(50)
}

/// The values of three columns, row by row, where all of them are finite.
pub(crate) fn three_of(rows: &[Vec<f64>], places: [usize; 3]) -> Vec<[f64; 3]> {
    rows.iter()
        .map(|row| places.map(|k| row.get(k).copied().unwrap_or(f64::NAN)))
        .filter(|v| v.iter().all(|x| x.is_finite()))
        .collect()
}

#[cfg(test)]
mod tests;
