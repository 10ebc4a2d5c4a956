//! Rows of a table as fixes.

use undrift_nav::earth::{Geodetic, wrap_pi};
use undrift_nav::sample::{FixQuality, GnssFix, Position};
use undrift_nav::{Matrix3, Vector3};

use super::options::FixOptions;
use crate::angle::of_degrees_minutes;
use crate::fix::{VelocityAxes, diagonal, finite, on_earth, quality_of_rtklib};
use crate::reader::TableRow;
use crate::skipped::{SkipKind, Skipped};
use crate::table::{Column, TableOptions, check_time_scale, three};
use crate::utm::UtmZone;
use crate::{Key, ReadError};

/// Where the columns of a GNSS log are and what they mean.
#[derive(Clone, Debug)]
pub struct GnssFormat {
    /// Time column.
    pub time: Column,
    /// Column of dates, where that of times has times of day.
    pub date: Option<Column>,
    /// Factor from the time column to seconds.
    pub time_scale: f64,
    /// Position, if it is to be read.
    pub place: Option<PositionColumns>,
    /// Standard deviations of the position north, east, down, or along x, y, z of [`PositionColumns::Ecef`] \[m\];
    /// needed where the options have none.
    pub position_std: Option<[Column; 3]>,
    /// Velocity, if it is to be read.
    pub velocity: Option<[Column; 3]>,
    /// Factor from its columns to m/s; not of its standard deviations.
    pub velocity_scale: f64,
    /// Its axes.
    pub velocity_axes: VelocityAxes,
    /// Standard deviations of the velocity north, east, down, or along x, y, z of
    /// [`VelocityAxes::Ecef`] [m/s]; needed where the options have none.
    pub velocity_std: Option<[Column; 3]>,
    /// Kind of solution, in RTKLIB's codes: see [`crate::gnss::quality_of_rtklib`].
    pub quality: Option<Column>,
    /// The byte between fields; `None` finds out.
    pub delimiter: Option<u8>,
    /// How certain they are, and which are given out.
    pub fixes: FixOptions,
}

/// How a position is written.
#[derive(Clone, Debug)]
pub enum PositionColumns {
    /// Latitude, longitude, and height above the ellipsoid.
    Geodetic {
        /// Latitude, north positive; longitude, east positive; height.
        columns: [Column; 3],
        /// Factor from the columns of latitude and longitude to radians.
        angle_scale: f64,
        /// They are degrees times 100 and minutes, ddmm.mmmm, of which the factor is that of a degree.
        degrees_minutes: bool,
        /// Factor from the column of heights to metres.
        height_scale: f64,
        /// Height of all fixes \[m\] in place of the column's, of logs without one.
        height: Option<f64>,
    },
    /// Universal transverse Mercator: easting, northing \[m\], and height above the ellipsoid.
    Utm {
        /// Easting, northing, height.
        columns: [Column; 3],
        /// Their zone.
        zone: UtmZone,
        /// Factor from the column of heights to metres.
        height_scale: f64,
        /// As of [`PositionColumns::Geodetic`].
        height: Option<f64>,
    },
    /// Earth-centred, Earth-fixed x, y, z \[m\].
    Ecef([Column; 3]),
    /// Relative to a base station, north-east-down of the base \[m\].
    Baseline {
        /// Columns of north, east, down.
        ned: [Column; 3],
        /// The base station.
        base: Geodetic,
    },
}

/// Where in the row read three numbers are, and where their standard deviations: without a place, these
/// are the stated ones.
#[derive(Clone, Copy)]
struct At {
    values: usize,
    std: Option<usize>,
}

/// Makes fixes of rows.
pub(super) struct FixColumns {
    format: GnssFormat,
    place: Option<At>,
    velocity: Option<At>,
    quality: Option<usize>,
}

impl FixColumns {
    /// With what is wanted of the table.
    pub(super) fn new(format: &GnssFormat) -> Result<(Self, TableOptions), ReadError> {
        check_time_scale(format.time_scale, "gnss.time")?;
        format.fixes.check()?;
        let fixes = &format.fixes;
        let mut wanted = TableOptions {
            keep_not_finite: true,
            of_one_sensor: true,
            ..TableOptions::finite(format.delimiter)
        };
        let date = format.date.as_ref();
        wanted.want_time("gnss", &format.time, date, format.time_scale);
        let mut part = |name: &str,
                        key: Key,
                        values: &[Column; 3],
                        std: &Option<[Column; 3]>,
                        stated: Option<[f64; 3]>| {
            let values = wanted.want(&format!("gnss.{name}"), values);
            let std = match (std, stated) {
                (_, Some(_)) => None,
                (Some(std), None) => Some(wanted.want(&key.to_string(), std)),
                (None, None) => {
                    return Err(ReadError::nameless("no standard deviations").key(key));
                }
            };
            Ok(At { values, std })
        };
        let place = format.place.as_ref().map(|place| {
            let (PositionColumns::Geodetic { columns, .. }
            | PositionColumns::Utm { columns, .. }
            | PositionColumns::Baseline { ned: columns, .. }
            | PositionColumns::Ecef(columns)) = place;
            part(
                "position",
                Key::PositionStd,
                columns,
                &format.position_std,
                fixes.position_std,
            )
        });
        let velocity = format.velocity.as_ref().map(|columns| {
            part(
                "velocity",
                Key::VelocityStd,
                columns,
                &format.velocity_std,
                fixes.velocity_std,
            )
        });
        let (place, velocity) = (place.transpose()?, velocity.transpose()?);
        if let (
            Some(at),
            Some(PositionColumns::Geodetic {
                angle_scale,
                degrees_minutes,
                ..
            }),
        ) = (place, &format.place)
        {
            wanted.want_angles(at.values, *angle_scale, *degrees_minutes);
        }
        let placed = format.place.as_ref();
        let turned = velocity.is_some() && format.velocity_axes == VelocityAxes::Ecef;
        if turned && placed.is_none_or(|place| matches!(place, PositionColumns::Baseline { .. })) {
            let problem = "a velocity along Earth-fixed axes needs the place beside it";
            let error = ReadError::nameless(problem).key("gnss.velocity_axes");
            return Err(error.mend("set gnss.position or gnss.ecef"));
        }
        if place.is_none() && velocity.is_none() {
            let problem = "neither position nor velocity requested";
            return Err(ReadError::nameless(problem).key("gnss"));
        }
        let quality = format.quality.as_ref();
        let quality = quality.map(|column| wanted.want("gnss.quality", [column]));
        let columns = Self {
            format: format.clone(),
            place,
            velocity,
            quality,
        };
        Ok((columns, wanted))
    }

    /// What there is of a fix in a row; `None` if the row is to be skipped.
    pub(super) fn fix(&self, row: TableRow, skipped: &mut Skipped) -> Option<GnssFix> {
        let stamp = row.numbers.first().copied().unwrap_or(f64::NAN);
        if !stamp.is_finite() {
            skipped.add(SkipKind::NotFinite, row.line, format_args!("time {stamp}"));
            return None;
        }
        let quality = self.quality.and_then(|at| row.numbers.get(at));
        let place = self.place(row, skipped)?;
        let position = place.and_then(|place| self.position(place, row, skipped));
        Some(GnssFix {
            attitude: None,
            mean_velocity: None,
            time: stamp * self.format.time_scale + self.format.fixes.time_offset,
            position,
            velocity: self.velocity(place, row, skipped),
            quality: quality.map_or(FixQuality::Unknown, |&q| quality_of_rtklib(q)),
        })
    }

    /// The place; `Some(None)` without one, `None` if the row is to be skipped.
    fn place(&self, row: TableRow, skipped: &mut Skipped) -> Option<Option<Position>> {
        let (Some(place), Some(at)) = (&self.format.place, self.place) else {
            return Some(None);
        };
        let Some(values) = self.finite(row, at, skipped) else {
            return Some(None);
        };
        Some(Some(match place {
            PositionColumns::Baseline { base, .. } => Position::Baseline {
                base: *base,
                ned: values,
            },
            place => {
                let place = match place {
                    PositionColumns::Geodetic {
                        angle_scale,
                        height_scale,
                        height,
                        degrees_minutes,
                        ..
                    } => {
                        let [lat, lon] = match degrees_minutes {
                            true => [values.x, values.y].map(of_degrees_minutes),
                            false => [values.x, values.y],
                        };
                        Some(Geodetic {
                            lat: lat * angle_scale,
                            lon: lon * angle_scale,
                            height: height.unwrap_or(values.z * height_scale),
                        })
                    }
                    PositionColumns::Utm {
                        zone,
                        height_scale,
                        height,
                        ..
                    } => {
                        let height = height.unwrap_or(values.z * height_scale);
                        zone.place(values.x, values.y, height)
                    }
                    _ => Some(Geodetic::from_ecef(&values)),
                };
                let Some(place) = place.filter(|place| on_earth(*place).is_ok()) else {
                    let detail = format_args!("{}, {}, {}", values.x, values.y, values.z);
                    skipped.add(SkipKind::OutOfRange, row.line, detail);
                    return None;
                };
                // From 0° to 360° as well as from −180° to 180°.
                let lon = match place.lon {
                    lon if lon.abs() > std::f64::consts::PI => wrap_pi(lon),
                    lon => lon,
                };
                Position::Geodetic(Geodetic { lon, ..place })
            }
        }))
    }

    /// The place with its covariance.
    fn position(
        &self,
        place: Position,
        row: TableRow,
        skipped: &mut Skipped,
    ) -> Option<(Position, Matrix3)> {
        let (at, fixes) = (self.place?, &self.format.fixes);
        let std = at.std(row.numbers, fixes.position_std) * fixes.position_std_factor;
        let covariance = diagonal(&std, row.line, skipped)?;
        let turn = match (place, &self.format.place) {
            (Position::Geodetic(place), Some(PositionColumns::Ecef(_))) if at.std.is_some() => {
                place.ned_from_ecef()
            }
            _ => Matrix3::identity(),
        };
        Some((place, turn * covariance * turn.transpose()))
    }

    fn velocity(
        &self,
        place: Option<Position>,
        row: TableRow,
        skipped: &mut Skipped,
    ) -> Option<(Vector3, Matrix3)> {
        let at = self.velocity?;
        let velocity = self.finite(row, at, skipped)?;
        // Telephones write −1 for a speed or course that they do not know.
        if self.format.velocity_axes.is_course() && velocity.x.min(velocity.y) == -1.0 {
            return None;
        }
        let scale = self.format.velocity_scale;
        let velocity = self.format.velocity_axes.vector(velocity, scale);
        let geodetic = match place {
            Some(Position::Geodetic(place)) => Some(place),
            _ => None,
        };
        let turn = self.format.velocity_axes.to_ned(geodetic)?;
        let fixes = &self.format.fixes;
        let std = at.std(row.numbers, fixes.velocity_std) * fixes.velocity_std_factor;
        let covariance = diagonal(&std, row.line, skipped)?;
        let covariance = match (self.format.velocity_axes, at.std) {
            (VelocityAxes::Ecef, Some(_)) => turn * covariance * turn.transpose(),
            _ => covariance,
        };
        Some((turn * velocity, covariance))
    }

    /// Three numbers, if they are finite; counted where not.
    fn finite(&self, row: TableRow, at: At, skipped: &mut Skipped) -> Option<Vector3> {
        let values = finite(three(row.numbers, at.values));
        values
            .map_err(|(kind, detail)| skipped.add(kind, row.line, detail))
            .ok()
    }
}

impl At {
    fn std(self, row: &[f64], stated: Option<[f64; 3]>) -> Vector3 {
        let own = self.std.map(|from| three(row, from));
        own.or(stated.map(Vector3::from))
            .unwrap_or_else(|| Vector3::repeat(f64::NAN))
    }
}
