//! Gyroscopes and accelerometers at rates of their own in the rows of one table, blank where the one has no value.
//!
//! The faster of the two makes the samples of a record; the other has a value in some of them and NaN in the rest,
//! from which [`own_values`] takes its own samples.

use undrift_io::table::{Preview, TableOptions};

/// Share of the rows with one sensor alone that means rates of their own, not missing values.
const APART: f64 = 0.2;
/// Share of the intervals of a slower sensor that are within one row of the usual.
const REGULAR: f64 = 0.9;
/// Rows between values of a slower sensor, at least.
const SLOWER: f64 = 1.5;

/// The values of an axis that has one every few samples of its record, their positions in it, and the number of samples to a value;
/// `None` of an axis with about one in each, or with values here and there.
pub fn own_values(samples: &[f64]) -> Option<(Vec<f64>, Vec<usize>, f64)> {
    let finite = samples.iter().enumerate().filter(|(_, x)| x.is_finite());
    if finite.clone().count() as f64 * SLOWER > samples.len() as f64 {
        return None;
    }
    let (places, values): (Vec<usize>, Vec<f64>) = finite.map(|(k, x)| (k, *x)).unzip();
    let steps = places.windows(2).map(|pair| (pair[1] - pair[0]) as f64);
    let mut sorted: Vec<f64> = steps.clone().collect();
    if sorted.len() < 2 {
        return None;
    }
    // The mean of the middle half: neither gaps nor bursts.
    sorted.sort_by(f64::total_cmp);
    let middle = &sorted[sorted.len() / 4..=3 * sorted.len() / 4];
    let every = middle.iter().sum::<f64>() / middle.len() as f64;
    let regular = steps.filter(|step| (step - every).abs() < 1.0).count();
    let is = every >= SLOWER && regular as f64 >= REGULAR * sorted.len() as f64;
    is.then_some((values, places, every))
}

/// How the rows of a table with rates of their own become samples.
pub(super) struct Merge {
    /// Places in a row of the axes of the faster sensor, and of the other.
    fast: Vec<usize>,
    slow: Vec<usize>,
    /// A row of the slower one that waits for the next of the faster.
    waiting: Option<Vec<f64>>,
}

/// What a row is.
pub(super) enum Mixed {
    /// A sample.
    Row,
    /// A part of the next one.
    Waits,
    /// Neither sensor has all its axes.
    Nothing,
}

/// Whether the rows of a table have gyroscopes and accelerometers at rates of their own; `indices` are the axes that are
/// wanted, gyroscopes below 3.
pub(super) fn mixed(
    beginning: &Preview,
    wanted: &TableOptions,
    indices: &[usize],
) -> Option<Merge> {
    let columns = wanted.columns.iter().zip(indices);
    let of = |gyro: bool| -> Option<Vec<(usize, usize)>> {
        let those = columns.clone().enumerate();
        let those = those.filter(|(_, (_, index))| (**index < 3) == gyro);
        those
            .map(|(slot, (column, _))| Some((slot, beginning.place(&column.1)?)))
            .collect()
    };
    let (gyro, accel) = (of(true)?, of(false)?);
    if gyro.is_empty() || accel.is_empty() {
        return None;
    }
    let has = |row: &Vec<f64>, axes: &[(usize, usize)]| {
        axes.iter()
            .all(|(_, place)| row.get(*place).is_some_and(|x| x.is_finite()))
    };
    let mut counts = [0u32; 2];
    let mut apart = 0u32;
    for row in &beginning.rows {
        let there = [has(row, &gyro), has(row, &accel)];
        apart += u32::from(there[0] != there[1]);
        counts
            .iter_mut()
            .zip(there)
            .for_each(|(count, there)| *count += u32::from(there));
    }
    let rows = beginning.rows.len() as f64;
    if f64::from(apart) < APART * rows || counts.contains(&0) {
        return None;
    }
    let slots = |axes: Vec<(usize, usize)>| axes.into_iter().map(|(slot, _)| slot).collect();
    let (fast, slow) = match counts[0] >= counts[1] {
        true => (slots(gyro), slots(accel)),
        false => (slots(accel), slots(gyro)),
    };
    Some(Merge {
        fast,
        slow,
        waiting: None,
    })
}

impl Merge {
    /// Makes a sample of a row: the axes that it lacks are NaN, or those of a row of the slower sensor before it.
    pub(super) fn take(&mut self, row: &mut [f64]) -> Mixed {
        let all = |slots: &[usize]| {
            slots
                .iter()
                .all(|slot| row.get(*slot).is_some_and(|x| x.is_finite()))
        };
        let timed = row.last().is_none_or(|time| time.is_finite());
        match (all(&self.fast) && timed, all(&self.slow)) {
            (true, true) => self.waiting = None,
            (true, false) => {
                let waiting = self.waiting.take();
                for (k, slot) in self.slow.iter().enumerate() {
                    let value = waiting.as_ref().and_then(|values| values.get(k));
                    if let Some(place) = row.get_mut(*slot) {
                        *place = value.copied().unwrap_or(f64::NAN);
                    }
                }
            }
            (false, true) => {
                self.waiting = Some(self.slow.iter().map(|slot| row[*slot]).collect());
                return Mixed::Waits;
            }
            (false, false) => return Mixed::Nothing,
        }
        Mixed::Row
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_io::table::Column;

    #[test]
    fn sensors_have_rates_of_their_own_where_a_fifth_of_the_rows_has_one_alone() {
        let indices = [0, 1, 2, 3, 4, 5];
        let wanted = TableOptions {
            columns: indices
                .map(|k| ("imu".to_owned(), Column::Number(k + 2)))
                .to_vec(),
            ..TableOptions::default()
        };
        // The places of the faster and of the slower one of a hundred rows.
        let of = |has: &dyn Fn(usize) -> [bool; 2]| {
            let row = |k: usize| {
                let [gyro, accel] = has(k).map(|has| if has { 1.0 } else { f64::NAN });
                vec![k as f64, gyro, gyro, gyro, accel, accel, accel]
            };
            let beginning = Preview {
                rows: (0..100).map(row).collect(),
                ..Preview::default()
            };
            let merge = mixed(&beginning, &wanted, &indices)?;
            Some((merge.fast, merge.slow))
        };
        let (gyro, accel) = (vec![0, 1, 2], vec![3, 4, 5]);
        let gyro_first = Some((gyro.clone(), accel.clone()));
        assert_eq!(of(&|k| [true, k % 4 == 0]), gyro_first);
        assert_eq!(of(&|k| [k % 4 == 0, true]), Some((accel, gyro)));
        assert_eq!(of(&|k| [k % 2 == 0, k % 2 == 1]), gyro_first);
        assert_eq!(of(&|k| [true, k % 5 > 0]), gyro_first);
        assert_eq!(of(&|k| [true, k % 6 > 0]), None);
        assert_eq!(of(&|_| [true; 2]), None);
        // One that never has a value.
        assert_eq!(of(&|_| [true, false]), None);
        assert_eq!(of(&|_| [false, true]), None);
    }

    #[test]
    fn values_of_a_slower_sensor_are_its_own() {
        let at = |every: usize| -> Vec<f64> {
            let value = |k: usize| match k % every {
                0 => k as f64,
                _ => f64::NAN,
            };
            (0..1000).map(value).collect()
        };
        for every in [2, 4, 10] {
            let (values, places, found) = own_values(&at(every)).unwrap();
            assert_eq!(found, every as f64);
            assert!(places.iter().all(|place| place % every == 0));
            assert_eq!(values.len(), 1000_usize.div_ceil(every));
        }
        // 63 of 400: every sixth or seventh.
        let value = |k: usize| if k * 63 % 400 < 63 { 1.0 } else { f64::NAN };
        let (_, _, every) = own_values(&(0..4000).map(value).collect::<Vec<_>>()).unwrap();
        assert!((every - 400.0 / 63.0).abs() < 0.5, "{every}");
        // One a sample, a gap, values here and there.
        assert_eq!(own_values(&at(1)), None);
        let gap = |k: usize| {
            if (100..900).contains(&k) {
                f64::NAN
            } else {
                1.0
            }
        };
        assert_eq!(own_values(&(0..1000).map(gap).collect::<Vec<_>>()), None);
        let some = |k: usize| if k * 7919 % 1009 < 400 { 1.0 } else { f64::NAN };
        assert_eq!(own_values(&(0..1000).map(some).collect::<Vec<_>>()), None);
        assert_eq!(own_values(&[f64::NAN; 9]), None);
    }
}
