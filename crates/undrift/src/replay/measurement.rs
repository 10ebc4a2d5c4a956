//! What the filter is aided with besides the samples: fixes, wheel speeds, barometric heights, merged in time.

use undrift_nav::sample::GnssFix;

/// One measurement.
// Nearly all are fixes, and few are held at once.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measurement {
    /// A GNSS fix.
    Gnss(GnssFix),
    /// Speed of a wheel, forward positive [m/s].
    Odometer(Scalar),
    /// Height by the barometer [m].
    Barometer(Scalar),
}

/// A measurement of one number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scalar {
    /// Time [s], in the log's time base.
    pub time: f64,
    /// The number.
    pub value: f64,
    /// Its standard deviation, in the same unit.
    pub std: f64,
}

impl Measurement {
    /// Time as stamped [s].
    pub fn time(&self) -> f64 {
        match self {
            Self::Gnss(fix) => fix.time,
            Self::Odometer(s) | Self::Barometer(s) => s.time,
        }
    }
}

/// Two streams, each in order of time, as one. An error is passed on where it stands.
pub fn merge<E>(
    first: impl Iterator<Item = Result<Measurement, E>>,
    second: impl Iterator<Item = Result<Measurement, E>>,
) -> impl Iterator<Item = Result<Measurement, E>> {
    let (mut first, mut second) = (first.peekable(), second.peekable());
    std::iter::from_fn(move || match (first.peek(), second.peek()) {
        (Some(Ok(a)), Some(Ok(b))) if b.time() < a.time() => second.next(),
        (None, Some(_)) | (Some(Ok(_)), Some(Err(_))) => second.next(),
        _ => first.next(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn merged_in_time() {
        let at = |time| {
            Ok::<_, ()>(Measurement::Odometer(Scalar {
                time,
                value: 0.0,
                std: 1.0,
            }))
        };
        let times = |items: Vec<Result<Measurement, ()>>| -> Vec<f64> {
            items
                .into_iter()
                .map(|m| m.map_or(-1.0, |m| m.time()))
                .collect()
        };
        let both = merge(
            [1.0, 2.0, 5.0].map(at).into_iter(),
            [0.5, 2.0, 3.0, 7.0].map(at).into_iter(),
        );
        assert_eq!(times(both.collect()), [0.5, 1.0, 2.0, 2.0, 3.0, 5.0, 7.0]);
        let broken = merge(
            [at(1.0), Err(())].into_iter(),
            [at(0.0), at(4.0)].into_iter(),
        );
        assert_eq!(times(broken.collect()), [0.0, 1.0, -1.0, 4.0]);
    }
}
