//! The rows of a structure's vectors as entries.

use undrift_nav::Vector3;
use undrift_nav::earth::Geodetic;
use undrift_nav::sample::{FixQuality, Position, TruthSample};

use super::mat::{Numbers, Variable};
use crate::entry::{Fix, ImuReading, StreamKind, What};
use crate::fix::{self, independent, on_earth};
use crate::skipped::{SkipKind, Unfit};

impl Numbers {
    /// How many vectors there are: the longer side.
    pub(super) fn len(&self) -> usize {
        self.rows.max(self.columns)
    }

    /// The components of one of `count` vectors, whether they are rows or columns.
    pub(super) fn some<const N: usize>(&self, index: usize, count: usize) -> [f64; N] {
        let as_rows = self.rows == count && self.columns == N;
        std::array::from_fn(|i| match as_rows {
            true => self.at(index, i),
            false => self.at(i, index),
        })
    }

    /// A component of a vector along either side.
    fn one(&self, index: usize) -> f64 {
        if self.columns == 1 {
            self.at(index, 0)
        } else {
            self.at(0, index)
        }
    }

    /// Whether it is `count` vectors of this width.
    fn is(&self, count: usize, width: usize) -> bool {
        let sides = (self.rows, self.columns);
        sides == (count, width) || sides == (width, count)
    }
}

/// What a row of a structure gives, by its place and its time \[s\].
type ReadRow = Box<dyn Fn(usize, f64) -> Result<What, Unfit> + Send>;

/// How many rows a structure has, and what each gives; `Err` says which field is not what it has to be.
pub(super) fn rows(
    mut variable: Variable,
    kind: StreamKind,
) -> Result<(usize, impl Fn(usize) -> What + Send), String> {
    let time = variable.take("t").ok_or("no field t")?;
    let count = time.len();
    if !time.is(count, 1) {
        return Err(format!("t is {}×{}", time.rows, time.columns));
    }
    let read = match kind {
        StreamKind::Imu => imu(&mut variable, count)?,
        StreamKind::Poses => poses(&mut variable, count)?,
        _ => fixes(&mut variable, count)?,
    };
    let row = move |index: usize| match time.one(index) {
        time if time.is_finite() => What::from_read(read(index, time)),
        time => What::Skipped(SkipKind::NotFinite, format!("t = {time}")),
    };
    Ok((count, row))
}

/// A field of `count` vectors of a width, or of one for all rows where that fits; an empty one is absent.
fn field(
    variable: &mut Variable,
    name: &str,
    counts: &[usize],
    width: usize,
) -> Result<Option<Numbers>, String> {
    match variable.take(name) {
        Some(numbers) if counts.iter().any(|count| numbers.is(*count, width)) => Ok(Some(numbers)),
        Some(numbers) if numbers.len() > 0 => {
            let (rows, columns) = (numbers.rows, numbers.columns);
            let count = counts.first().copied().unwrap_or_default();
            Err(format!("{name} is {rows}×{columns}, t has {count} values"))
        }
        _ => Ok(None),
    }
}

fn needed(
    variable: &mut Variable,
    name: &str,
    count: usize,
    width: usize,
) -> Result<Numbers, String> {
    field(variable, name, &[count], width)?.ok_or_else(|| format!("no field {name}"))
}

/// Three components of a row, if all are finite.
fn finite(numbers: &Numbers, index: usize, count: usize) -> Option<Vector3> {
    fix::finite(Vector3::from(numbers.some(index, count))).ok()
}

fn imu(variable: &mut Variable, count: usize) -> Result<ReadRow, String> {
    let force = needed(variable, "fb", count, 3)?;
    let rate = needed(variable, "wb", count, 3)?;
    Ok(Box::new(move |index, time| {
        match (finite(&rate, index, count), finite(&force, index, count)) {
            (Some(gyro), Some(accel)) => Ok(What::Imu(ImuReading::new(time, gyro, accel))),
            _ => {
                let [wb, fb] = [&rate, &force].map(|numbers| numbers.some::<3>(index, count));
                Err((SkipKind::NotFinite, format!("wb {wb:?}, fb {fb:?}")))
            }
        }
    }))
}

fn fixes(variable: &mut Variable, count: usize) -> Result<ReadRow, String> {
    let place = place(variable, count)?;
    let velocity = field(variable, "vel", &[count], 3)?;
    let std = field(variable, "stdm", &[count, 1], 3)?;
    let velocity_std = field(variable, "stdv", &[count, 1], 3)?;
    Ok(Box::new(move |index, time| {
        let place = place(index)?;
        let covariance = |std: &Option<Numbers>| {
            let std = std.as_ref()?;
            let std = match std.is(count, 3) {
                true => std.some(index, count),
                false => std.some(0, 1),
            };
            independent(&Vector3::from(std))
        };
        let velocity = velocity.as_ref().and_then(|v| finite(v, index, count));
        Ok(What::Fix(Fix {
            mean_velocity: None,
            time,
            position: Some((Position::Geodetic(place), covariance(&std))),
            velocity: velocity.map(|velocity| (velocity, covariance(&velocity_std))),
            quality: FixQuality::Unknown,
        }))
    }))
}

fn poses(variable: &mut Variable, count: usize) -> Result<ReadRow, String> {
    let place = place(variable, count)?;
    let velocity = field(variable, "vel", &[count], 3)?;
    let mut angle = |name| field(variable, name, &[count], 1);
    let angles = [angle("roll")?, angle("pitch")?, angle("yaw")?];
    let attitude: Box<dyn Fn(usize) -> Vector3 + Send> = match angles {
        [Some(roll), Some(pitch), Some(yaw)] => {
            Box::new(move |index| Vector3::new(roll.one(index), pitch.one(index), yaw.one(index)))
        }
        _ => {
            let matrices = needed(variable, "DCMnb_m", count, 9)?;
            Box::new(move |index| angles_of(&matrices.some(index, count)))
        }
    };
    Ok(Box::new(move |index, time| {
        let position = place(index)?;
        Ok(What::Pose(TruthSample {
            time,
            position,
            v_n: velocity.as_ref().and_then(|v| finite(v, index, count)),
            rpy: Some(attitude(index)).filter(|rpy| rpy.iter().all(|x| x.is_finite())),
        }))
    }))
}

/// The place of a row.
fn place(
    variable: &mut Variable,
    count: usize,
) -> Result<impl Fn(usize) -> Result<Geodetic, Unfit> + Send + use<>, String> {
    let mut side = |name| needed(variable, name, count, 1);
    let sides = [side("lat")?, side("lon")?, side("h")?];
    Ok(move |index| {
        let [lat, lon, height] = sides.each_ref().map(|numbers| numbers.one(index));
        on_earth(Geodetic { lat, lon, height })
    })
}

/// Roll, pitch and yaw of a matrix from navigation to body axes, column by column.
fn angles_of(c_bn: &[f64; 9]) -> Vector3 {
    let [c11, _, _, c12, _, _, c13, c23, c33] = *c_bn;
    Vector3::new(c23.atan2(c33), -c13.clamp(-1.0, 1.0).asin(), c12.atan2(c11))
}
