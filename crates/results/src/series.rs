//! Series for plots, streamed: their size is bounded whatever the length of what they show.

use crate::{Curve, Number, numbers};
use undrift_base::number::rounded;

/// Buckets of an [`Envelope`] that fill a plot's width.
pub const BUCKETS: usize = 1000;
/// Rows of a [`Thinned`] that make a smooth path.
pub const ROWS: usize = 4000;

/// A time \[s\] and a value.
pub type Point = (f64, f64);

/// Smallest and largest value of a bucket with their times.
#[derive(Clone, Copy, Debug)]
struct Bucket {
    least: Point,
    most: Point,
}

impl Bucket {
    fn new(point: Point) -> Self {
        Self {
            least: point,
            most: point,
        }
    }

    /// With a later one.
    fn with(self, later: Self) -> Self {
        Self {
            least: if later.least.1 < self.least.1 {
                later.least
            } else {
                self.least
            },
            most: if later.most.1 > self.most.1 {
                later.most
            } else {
                self.most
            },
        }
    }

    /// Its one or two points in order of time.
    fn points(self) -> impl Iterator<Item = Point> {
        let (first, last) = if self.least.0 <= self.most.0 {
            (self.least, self.most)
        } else {
            (self.most, self.least)
        };
        std::iter::once(first).chain((first.0 < last.0).then_some(last))
    }
}

/// A curve of unknown length as the smallest and largest value of equal stretches of it, with their
/// times. Stretches merge in pairs when there are too many: no extreme is ever lost.
#[derive(Clone, Debug)]
pub struct Envelope {
    buckets: Vec<Bucket>,
    most: usize,
    /// Samples in a full bucket, and in the last one.
    width: u64,
    filled: u64,
}

impl Envelope {
    /// Of at most `most` buckets (two or more), two points each.
    pub fn new(most: usize) -> Self {
        Self {
            buckets: Vec::new(),
            most: most.max(2),
            width: 1,
            filled: 1,
        }
    }

    /// Adds a value at a time \[s\] not before the last one's. What is not finite is left out.
    pub fn add(&mut self, time: f64, value: f64) {
        if !(time.is_finite() && value.is_finite()) {
            return;
        }
        let one = Bucket::new((time, value));
        if self.filled < self.width
            && let Some(last) = self.buckets.last_mut()
        {
            *last = last.with(one);
            self.filled += 1;
            return;
        }
        if self.buckets.len() >= self.most {
            // All are full here; an odd one at the end is half of one.
            self.filled = if self.buckets.len() % 2 == 1 {
                self.width
            } else {
                2 * self.width
            };
            self.buckets = self
                .buckets
                .chunks(2)
                .filter_map(|pair| pair.iter().copied().reduce(Bucket::with))
                .collect();
            self.width *= 2;
            self.add(time, value);
            return;
        }
        self.buckets.push(one);
        self.filled = 1;
    }

    /// Whether nothing was added.
    pub fn is_empty(&self) -> bool {
        self.buckets.is_empty()
    }

    /// The points in order of time: at most twice as many as buckets.
    pub fn points(&self) -> impl Iterator<Item = Point> + '_ {
        self.buckets.iter().flat_map(|bucket| bucket.points())
    }

    /// The points as columns, rounded.
    pub fn curve(&self) -> Curve {
        let rounded = |(time, value)| (Number(to_millisecond(time)), Number(to_digits(value)));
        let (time_s, value) = self.points().map(rounded).unzip();
        Curve { time_s, value }
    }
}

impl Default for Envelope {
    fn default() -> Self {
        Self::new(BUCKETS)
    }
}

/// Rows of unknown number thinned evenly: every one, every second, every fourth …
#[derive(Clone, Debug)]
pub struct Thinned<const N: usize> {
    rows: Vec<[f64; N]>,
    most: usize,
    every: u64,
    seen: u64,
}

impl<const N: usize> Thinned<N> {
    /// Of at most `most` rows (two or more).
    pub fn new(most: usize) -> Self {
        Self {
            rows: Vec::new(),
            most: most.max(2),
            every: 1,
            seen: 0,
        }
    }

    /// Adds a row.
    pub fn add(&mut self, row: [f64; N]) {
        if self.seen.is_multiple_of(self.every) {
            if self.rows.len() >= self.most {
                self.every *= 2;
                self.rows = self.rows.iter().copied().step_by(2).collect();
            }
            // The row itself may be one that the wider spacing leaves out.
            if self.seen.is_multiple_of(self.every) {
                self.rows.push(row);
            }
        }
        self.seen += 1;
    }

    /// The rows that are left.
    pub fn rows(&self) -> &[[f64; N]] {
        &self.rows
    }

    /// A column of them, rounded.
    pub fn column(&self, at: usize, round: fn(f64) -> f64) -> Vec<Number> {
        numbers(self.rows.iter().map(|row| round(row[at])))
    }
}

/// Rounded to six significant digits, more than a plot shows.
pub fn to_digits(value: f64) -> f64 {
    rounded(value, 6)
}

/// Rounded to a thousandth: times \[s\], heights \[m\].
pub fn to_millisecond(value: f64) -> f64 {
    (value * 1e3).round() / 1e3
}

/// Rounded to 10⁻⁸: degrees of latitude and longitude, to a millimetre.
pub fn to_millimetre(degrees: f64) -> f64 {
    (degrees * 1e8).round() / 1e8
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn envelope(values: &[f64], most: usize) -> Envelope {
        let mut envelope = Envelope::new(most);
        for (k, value) in values.iter().enumerate() {
            envelope.add(k as f64, *value);
            assert!(envelope.buckets.len() <= most.max(2));
        }
        envelope
    }

    proptest! {
        #[test]
        fn extremes_are_kept_at_their_times_in_order(
            values in prop::collection::vec(-1e6f64..1e6, 1..2000),
            most in 2usize..50,
        ) {
            let points: Vec<Point> = envelope(&values, most).points().collect();
            prop_assert!(points.len() <= 2 * most);
            prop_assert!(points.windows(2).all(|w| w[0].0 < w[1].0));
            for (time, value) in &points {
                prop_assert_eq!(values[*time as usize], *value);
            }
            let least = |all: &mut dyn Iterator<Item = f64>| all.fold(f64::INFINITY, f64::min);
            let all = least(&mut values.iter().copied());
            prop_assert_eq!(all, least(&mut points.iter().map(|p| p.1)));
            let all = least(&mut values.iter().map(|v| -v));
            prop_assert_eq!(all, least(&mut points.iter().map(|p| -p.1)));
        }

        #[test]
        fn every_stretch_of_the_curve_is_shown(
            values in prop::collection::vec(-1e6f64..1e6, 1..2000),
            most in 2usize..50,
        ) {
            let envelope = envelope(&values, most);
            // At least a quarter of the buckets is in use once there is enough to fill them.
            let enough = values.len().min(most / 4).max(1);
            prop_assert!(envelope.buckets.len() >= enough);
            // The extremes of each stretch are among its values.
            for (stretch, bucket) in values.chunks(envelope.width as usize).zip(&envelope.buckets) {
                if envelope.buckets.len() == values.len().div_ceil(envelope.width as usize) && most % 2 == 0 {
                    let least = stretch.iter().copied().fold(f64::INFINITY, f64::min);
                    prop_assert_eq!(least, bucket.least.1);
                }
            }
        }

        #[test]
        fn thinned_rows_are_evenly_spaced(count in 0usize..3000, most in 2usize..50) {
            let mut thinned = Thinned::new(most);
            for k in 0..count {
                thinned.add([k as f64]);
                assert!(thinned.rows().len() <= most);
            }
            let every = thinned.every as f64;
            for (k, row) in thinned.rows().iter().enumerate() {
                prop_assert_eq!(row[0], k as f64 * every);
            }
            prop_assert_eq!(thinned.rows().len(), count.div_ceil(thinned.every as usize));
        }
    }

    #[test]
    fn what_is_not_finite_is_left_out() {
        let envelope = envelope(&[f64::NAN, 1.0, f64::INFINITY, 2.0], 10);
        assert_eq!(
            envelope.points().collect::<Vec<_>>(),
            [(1.0, 1.0), (3.0, 2.0)]
        );
    }

    #[test]
    fn rounding() {
        assert_eq!(to_digits(0.123_456_789), 0.123_457);
        assert_eq!(to_digits(-1.234_567_89e-12), -1.234_57e-12);
        assert_eq!(to_digits(0.0), 0.0);
        assert_eq!(to_millisecond(345_678.123_456), 345_678.123);
        assert_eq!(to_millimetre(45.123_456_789_1), 45.123_456_79);
    }
    /// Of values that are the same the first.
    #[test]
    fn an_extreme_is_where_it_first_was() {
        let bucket = |time: f64, value: f64| Bucket::new((time, value));
        let low = bucket(1.0, 5.0)
            .with(bucket(2.0, 5.0))
            .with(bucket(3.0, 7.0))
            .with(bucket(4.0, 7.0));
        let points: Vec<Point> = low.points().collect();
        assert_eq!(points, [(1.0, 5.0), (3.0, 7.0)]);
        let falling = bucket(1.0, 7.0)
            .with(bucket(2.0, 5.0))
            .with(bucket(3.0, 5.0));
        assert_eq!(Vec::from_iter(falling.points()), [(1.0, 7.0), (2.0, 5.0)]);
        assert_eq!(Vec::from_iter(bucket(1.0, 7.0).points()), [(1.0, 7.0)]);
    }
}
