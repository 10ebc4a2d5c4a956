//! What the recordings of telephones have in common.

use undrift_nav::earth::Geodetic;
use undrift_nav::sample::{FixQuality, Position};
use undrift_nav::{Matrix3, Vector3};

use super::receiver::{Ready, one_stream};
use crate::entry::{Fix, Stream, StreamKind};
use crate::fix::{independent, on_earth};
use crate::source::Source;
use crate::table::lines::Lines;

mod join;
mod rows;

pub(super) use join::Join;
pub(crate) use rows::JoinedRows;

/// Standard deviations of an axis in a radius that holds 68 %: √(−2 ln 0.32).
pub(super) const RADIUS: f64 = 1.509_592_185_452;
/// A fix has no vertical speed: its standard deviation leaves that open [m/s].
const VERTICAL: f64 = 20.0;

/// A place as the telephone's operating system states it; the accuracies are radii or intervals of 68 %,
/// and below zero or missing where they are not known.
#[derive(Clone, Copy, Default)]
pub(super) struct Location {
    /// Latitude and longitude \[deg\], height above the ellipsoid \[m\].
    pub(super) place: [f64; 3],
    /// \[m\]
    pub(super) horizontal: Option<f64>,
    /// \[m\]
    pub(super) vertical: Option<f64>,
    /// [m/s] and clockwise from north \[deg\].
    pub(super) speed: Option<f64>,
    pub(super) bearing: Option<f64>,
    /// [m/s] and \[deg\].
    pub(super) speed_std: Option<f64>,
    pub(super) bearing_std: Option<f64>,
}

/// The streams of a text that are `known`, in this order: what each is called, what it holds, and that in words; `name`
/// says of which one a line is.
pub(super) fn streams(
    source: Source,
    known: &[(&str, StreamKind, &str)],
    name: impl Fn(&[u8]) -> Option<&str>,
) -> Vec<Stream> {
    let mut lines = Lines::new(source);
    let mut counts = vec![0; known.len()];
    while let Some(line) = lines.next_line() {
        let name = name(line);
        for ((known, ..), count) in known.iter().zip(&mut counts) {
            *count += u64::from(Some(*known) == name);
        }
    }
    let counted = known.iter().zip(counts);
    let streams =
        counted.map(|(&(name, kind, about), messages)| one_stream(name, kind, about, messages));
    streams.flatten().collect()
}

impl Location {
    /// The fix that it is at a time \[s\].
    pub(super) fn fix(&self, at: u64, time: f64, ready: &mut Ready) {
        let [lat, lon, height] = self.place;
        let place = ready.usable(at, on_earth(Geodetic::from_degrees(lat, lon, height)));
        let std = self
            .horizontal
            .zip(self.vertical)
            .map(|(radius, vertical)| {
                let each = radius / RADIUS;
                Vector3::new(each, each, vertical)
            });
        let covariance = std.and_then(|std| independent(&std));
        let position = place.map(|place| (Position::Geodetic(place), covariance));
        let velocity = self.velocity();
        if position.is_some() || velocity.is_some() {
            let quality = FixQuality::Unknown;
            let fix = Fix {
                mean_velocity: None,
                time,
                position,
                velocity,
                quality,
            };
            ready.fix(at, fix);
        }
    }

    fn velocity(&self) -> Option<(Vector3, Option<Matrix3>)> {
        let speed = self.speed.filter(|speed| *speed >= 0.0)?;
        let bearing = self.bearing.filter(|bearing| *bearing >= 0.0)?;
        let (east, north) = bearing.to_radians().sin_cos();
        let turn = Matrix3::new(north, -east, 0.0, east, north, 0.0, 0.0, 0.0, 1.0);
        let stds = self.speed_std.zip(self.bearing_std);
        // At rest the bearing says nothing, but the speed does in any direction.
        let own = stds
            .filter(|(_, bearing)| *bearing >= 0.0)
            .and_then(|(along, bearing)| {
                let across = (speed * bearing.to_radians()).max(along);
                independent(&Vector3::new(along, across, VERTICAL))
            });
        let velocity = turn * Vector3::new(speed, 0.0, 0.0);
        Some((velocity, own.map(|own| turn * own * turn.transpose())))
    }
}
