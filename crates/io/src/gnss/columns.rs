//! Rows of a table as fixes.

use undrift_nav::earth::{Geodetic, wrap_pi};
use undrift_nav::sample::{FixQuality, GnssFix, Position};
use undrift_nav::{Matrix3, Vector3};

use crate::ReadError;
use crate::fix::{all_finite, diagonal, is_a_fix, quality_of_rtklib};
use crate::skipped::{SkipKind, Skipped};
use crate::table::{Column, TableOptions};

/// Where the columns of a GNSS log are and what they mean.
#[derive(Clone, Debug)]
pub struct GnssFormat {
    /// Time column.
    pub time: Column,
    /// Factor from the time column to seconds.
    pub time_scale: f64,
    /// Added to the time after scaling \[s\].
    pub time_offset: f64,
    /// Position, if it is to be read.
    pub position: Option<PositionFormat>,
    /// Velocity, if it is to be read.
    pub velocity: Option<VelocityFormat>,
    /// Kind of solution, in RTKLIB's codes: see [`crate::gnss::quality_of_rtklib`].
    pub quality: Option<Column>,
    /// The byte between fields; `None` finds out.
    pub delimiter: Option<u8>,
    /// First and last time \[s\] to give out, after the offset.
    pub span: Option<(f64, f64)>,
}

/// Columns of the position and what its uncertainty is.
#[derive(Clone, Debug)]
pub struct PositionFormat {
    /// The columns of the place.
    pub place: Place,
    /// Standard deviations north, east, down \[m\].
    pub std: Std,
    /// Factor on the standard deviations, for receivers that are too sure or too modest.
    pub std_factor: f64,
}

/// How a position is written.
#[derive(Clone, Debug)]
pub enum Place {
    /// Latitude, longitude, and height above the ellipsoid \[m\].
    Geodetic {
        /// Latitude, north positive.
        lat: Column,
        /// Longitude, east positive.
        lon: Column,
        /// Height \[m\].
        height: Column,
        /// Factor from the columns of latitude and longitude to radians.
        angle_scale: f64,
    },
    /// Relative to a base station, north-east-down of the base \[m\].
    Baseline {
        /// Columns of north, east, down.
        ned: [Column; 3],
        /// The base station.
        base: Geodetic,
    },
}

/// Columns of the velocity and what its uncertainty is.
#[derive(Clone, Debug)]
pub struct VelocityFormat {
    /// North, east, and down or up [m/s].
    pub columns: [Column; 3],
    /// The third component is up.
    pub up: bool,
    /// Standard deviations north, east, down [m/s].
    pub std: Std,
    /// Factor on the standard deviations.
    pub std_factor: f64,
}

/// Standard deviations north, east, down.
#[derive(Clone, Debug)]
pub enum Std {
    /// In columns of the file.
    Columns([Column; 3]),
    /// The same for every fix.
    Constant([f64; 3]),
}

/// A group of three columns in the row read, or three constants.
#[derive(Clone, Copy)]
enum Three {
    At(usize),
    Constant(Vector3),
}

impl Three {
    fn of(self, row: &[f64]) -> Vector3 {
        match self {
            Self::Constant(values) => values,
            Self::At(from) => {
                let get = |k: usize| row.get(from + k).copied().unwrap_or(f64::NAN);
                Vector3::new(get(0), get(1), get(2))
            }
        }
    }
}

/// The places of a fix in the row read.
pub(super) struct FixColumns {
    format: GnssFormat,
    place: Option<(Three, Three)>,
    velocity: Option<(Three, Three)>,
    quality: Option<usize>,
}

impl FixColumns {
    /// With what is wanted of the table.
    pub(super) fn new(format: &GnssFormat) -> Result<(Self, TableOptions), ReadError> {
        check(format)?;
        let mut columns = vec![("gnss.time".to_owned(), format.time.clone())];
        let mut add = |key: &str, three: [&Column; 3]| {
            let from = columns.len();
            columns.extend(three.map(|column| (key.to_owned(), column.clone())));
            Three::At(from)
        };
        let add_std =
            |key: &str, std: &Std, add: &mut dyn FnMut(&str, [&Column; 3]) -> Three| match std {
                Std::Columns(columns) => add(key, columns.each_ref()),
                Std::Constant(values) => Three::Constant(Vector3::from(*values)),
            };
        let place = format.position.as_ref().map(|position| {
            let place = match &position.place {
                Place::Geodetic {
                    lat, lon, height, ..
                } => add("gnss.position", [lat, lon, height]),
                Place::Baseline { ned, .. } => add("gnss.position", ned.each_ref()),
            };
            (place, add_std("gnss.position_std", &position.std, &mut add))
        });
        let velocity = format.velocity.as_ref().map(|velocity| {
            let from = add("gnss.velocity", velocity.columns.each_ref());
            (from, add_std("gnss.velocity_std", &velocity.std, &mut add))
        });
        let quality = format.quality.as_ref().map(|column| {
            columns.push(("gnss.quality".to_owned(), column.clone()));
            columns.len() - 1
        });
        let wanted = TableOptions {
            columns,
            delimiter: format.delimiter,
            keep_not_finite: true,
        };
        let fix_columns = Self {
            format: format.clone(),
            place,
            velocity,
            quality,
        };
        Ok((fix_columns, wanted))
    }

    /// What there is of a fix in a row; `None` if the row is to be skipped.
    pub(super) fn fix(&self, row: &[f64], line: u64, skipped: &mut Skipped) -> Option<GnssFix> {
        let stamp = row.first().copied().unwrap_or(f64::NAN);
        if !stamp.is_finite() {
            skipped.add(SkipKind::NotFinite, line, format_args!("time {stamp}"));
            return None;
        }
        let quality = self.quality.and_then(|at| row.get(at));
        Some(GnssFix {
            time: stamp * self.format.time_scale + self.format.time_offset,
            position: self.position(row, line, skipped)?,
            velocity: self.velocity(row, line, skipped),
            quality: quality.map_or(FixQuality::Unknown, |&q| quality_of_rtklib(q)),
        })
    }

    /// The position; `Some(None)` without one, `None` if the row is to be skipped.
    fn position(
        &self,
        row: &[f64],
        line: u64,
        skipped: &mut Skipped,
    ) -> Option<Option<(Position, Matrix3)>> {
        let (Some(format), Some((place, std))) = (&self.format.position, self.place) else {
            return Some(None);
        };
        let values = place.of(row);
        if !all_finite(&values, line, skipped) {
            return Some(None);
        }
        let position = match &format.place {
            Place::Geodetic { angle_scale, .. } => {
                let place = Geodetic {
                    lat: values.x * angle_scale,
                    lon: values.y * angle_scale,
                    height: values.z,
                };
                if !is_a_fix(&place) {
                    let detail = format_args!("{}, {}, {}", values.x, values.y, values.z);
                    skipped.add(SkipKind::OutOfRange, line, detail);
                    return None;
                }
                // From 0° to 360° as well as from −180° to 180°.
                let lon = match place.lon {
                    lon if lon.abs() > std::f64::consts::PI => wrap_pi(lon),
                    lon => lon,
                };
                Position::Geodetic(Geodetic { lon, ..place })
            }
            Place::Baseline { base, .. } => Position::Baseline {
                base: *base,
                ned: values,
            },
        };
        let std = std.of(row) * format.std_factor;
        Some(diagonal(&std, line, skipped).map(|covariance| (position, covariance)))
    }

    fn velocity(
        &self,
        row: &[f64],
        line: u64,
        skipped: &mut Skipped,
    ) -> Option<(Vector3, Matrix3)> {
        let (format, (at, std)) = (self.format.velocity.as_ref()?, self.velocity?);
        let mut velocity = at.of(row);
        if !all_finite(&velocity, line, skipped) {
            return None;
        }
        if format.up {
            velocity.z = -velocity.z;
        }
        let std = std.of(row) * format.std_factor;
        diagonal(&std, line, skipped).map(|covariance| (velocity, covariance))
    }
}

fn check(format: &GnssFormat) -> Result<(), ReadError> {
    let bad = |key: &str, problem: String| Err(ReadError::nameless(problem).key(key));
    if format.position.is_none() && format.velocity.is_none() {
        return bad("gnss", "neither position nor velocity is asked for".into());
    }
    if !(format.time_scale.is_finite() && format.time_scale > 0.0) {
        return bad(
            "gnss.time",
            format!("a time scale of {}", format.time_scale),
        );
    }
    let position = format.position.as_ref().map(|p| (&p.std, p.std_factor));
    let velocity = format.velocity.as_ref().map(|v| (&v.std, v.std_factor));
    let parts = [
        ("gnss.position_std", position),
        ("gnss.velocity_std", velocity),
    ];
    for (key, part) in parts {
        let Some((std, factor)) = part else { continue };
        let positive = |value: f64| value.is_finite() && value > 0.0;
        if !positive(factor) {
            return bad(
                key,
                format!("a factor of {factor} on the standard deviations"),
            );
        }
        if let Std::Constant(values) = std
            && let Some(value) = values.iter().find(|&&value| !positive(value))
        {
            return bad(key, format!("a standard deviation of {value}"));
        }
    }
    Ok(())
}
