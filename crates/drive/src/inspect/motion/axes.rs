//! Finds wrong signs or a wrong order of the IMU's axes: tries each that people get wrong, and keeps the one with which samples and
//! fixes fit together.

use crate::{
    drive::Drive,
    inspect::{Known, Line, Part},
    mounting::{LONGEST_PASS, Mounting},
    navigate::{Wanted, navigate, resolve_mounting},
    replay::Aid,
};
use undrift_io::imu::ImuSource;
use undrift_nav::Vector3;
use undrift_noise::BiasModel;

/// Combinations of signs of gyros and accelerometers that no rotation of the sensor makes right: one axis of one sensor, all gyros, or
/// one axis of both (left-handed axes; any one serves for all, since they differ by a rotation).
const REVERSED: [[[f64; 3]; 2]; 8] = {
    const AS_THEY_ARE: [f64; 3] = [1.0, 1.0, 1.0];
    const X: [f64; 3] = [-1.0, 1.0, 1.0];
    const Y: [f64; 3] = [1.0, -1.0, 1.0];
    const Z: [f64; 3] = [1.0, 1.0, -1.0];
    [
        [X, AS_THEY_ARE],
        [Y, AS_THEY_ARE],
        [Z, AS_THEY_ARE],
        [AS_THEY_ARE, X],
        [AS_THEY_ARE, Y],
        [AS_THEY_ARE, Z],
        [[-1.0; 3], AS_THEY_ARE],
        [Y, Y],
    ]
};

/// NIS per degree of freedom of the velocities, or of positions alone, up to which samples and fixes fit together \[–\].
const MOST_NIS: f64 = 2.0;
/// How many times as large it is, at least, with the next best axes \[–\].
const CLEARLY: f64 = 1.3;
/// Largest share of rejected fixes with which they fit together \[–\].
const REJECTED: f64 = 0.02;

/// The drive cut to its first `length` \[s\]; `None` without samples.
pub(super) fn beginning(mut drive: Drive, length: f64) -> Option<Drive> {
    let first = drive.open_imu().ok()?.next()?.ok()?.time;
    let span = drive.imu.1.span.unwrap_or((first, f64::INFINITY));
    drive.imu.1.span = Some((span.0, span.1.min(first + length)));
    Some(drive)
}

/// The mounting of a drive where that was found, and the NIS per degree of freedom of the solution with it in the first
/// [`LONGEST_PASS`] of the log; `None` where no mounting was found, the drive cannot be
/// navigated, more than [`REJECTED`] of the fixes are rejected, or units, axes, signs or times are implausible.
pub(super) fn fit((drive, mounting): (Drive, Option<Mounting>)) -> Option<(Mounting, f64)> {
    let drive = beginning(drive, LONGEST_PASS)?;
    let summary = navigate(&drive, BiasModel::Arma, Wanted::default())
        .ok()?
        .summary;
    let aids = [Aid::Velocity, Aid::Position].map(|aid| &summary.innovations[aid]);
    let sums = aids.into_iter().find(|sums| sums.updates > 0)?;
    let all = sums.updates + sums.rejected;
    let fits = summary.implausible.is_empty() && sums.rejected as f64 <= REJECTED * all as f64;
    Some((mounting?, sums.per_dof().filter(|_| fits)?))
}

/// Whether samples and fixes fit together with the mounting that was found.
pub(super) fn is_fitting(resolved: (Drive, Option<Mounting>)) -> bool {
    fit(resolved).is_some_and(|(_, nis)| nis <= MOST_NIS)
}

/// Reverses axes of a log that does not fit together as it is where it does so with them reversed, and with no others.
pub(super) fn reversed_axes(imu: &mut Part, drive: &Drive) -> Option<Mounting> {
    let with = |[gyro, accel]: &[[f64; 3]; 2]| {
        let mut drive = drive.clone();
        let format = &mut drive.imu.1;
        let (gyro, accel) = (Vector3::from(*gyro), Vector3::from(*accel));
        format.gyro_scale.component_mul_assign(&gyro);
        format.accel_scale.component_mul_assign(&accel);
        fit(resolve_mounting(&drive).ok()?)
    };
    let fits = REVERSED
        .iter()
        .filter_map(|signs| Some((signs, with(signs)?)));
    let (signs, found) = clear_best(fits.collect())?;
    let keys = [("gyro_unit", "rad/s"), ("accel_unit", "m/s^2")];
    for ((key, si), signs) in keys.into_iter().zip(signs) {
        if !signs.contains(&-1.0) {
            continue;
        }
        let stated = imu.lines.iter().position(|line| line.key == key);
        let stated = stated.map(|at| imu.lines.remove(at).value);
        let unit = stated.as_ref().and_then(|unit| unit.as_str()).unwrap_or(si);
        let reversed = match unit.strip_prefix('-') {
            Some(unit) => unit.to_owned(),
            None => format!("-{unit}"),
        };
        let units = signs.map(|sign| if sign < 0.0 { &*reversed } else { unit });
        let line = Line::new(key, units.join(", "), Known::ReversedAxes);
        imu.lines.push(line);
    }
    Some(found)
}

/// Orders of the axes of one sensor, where those of the other are right: of the gyros all, of the accelerometers those that
/// exchange two, as the others are those of the gyros turned.
const ORDERS: [(&str, [usize; 3]); 8] = [
    ("gyro", [1, 0, 2]),
    ("gyro", [2, 1, 0]),
    ("gyro", [0, 2, 1]),
    ("gyro", [1, 2, 0]),
    ("gyro", [2, 0, 1]),
    ("accel", [1, 0, 2]),
    ("accel", [2, 1, 0]),
    ("accel", [0, 2, 1]),
];

/// Reorders the columns of one sensor, where a table that does not fit together as it is does so in exactly one order.
pub(super) fn exchanged_axes(imu: &mut Part, drive: &Drive) -> Option<Mounting> {
    let with = |(sensor, order): &(&str, [usize; 3])| {
        let mut drive = drive.clone();
        let format = &mut drive.imu.1;
        let ImuSource::Table { gyro, accel, .. } = &mut format.source else {
            return None;
        };
        let (columns, scale) = match *sensor {
            "gyro" => (gyro, &mut format.gyro_scale),
            _ => (accel, &mut format.accel_scale),
        };
        *columns = order.map(|axis| columns[axis].clone());
        *scale = Vector3::from(order.map(|axis| scale[axis]));
        fit(resolve_mounting(&drive).ok()?)
    };
    let fits = ORDERS
        .iter()
        .filter_map(|order| Some((order, with(order)?)));
    let ((sensor, order), mounting) = clear_best(fits.collect())?;
    let line = imu.lines.iter_mut().find(|line| line.key == *sensor)?;
    let columns = line.value.as_array()?;
    let columns: Option<Vec<_>> = order
        .iter()
        .map(|axis| columns.get(*axis).cloned())
        .collect();
    *line = Line::new(sensor, columns?, Known::ExchangedAxes);
    Some(mounting)
}

/// The best fit, where it is good and clearly better than the next.
fn clear_best<T: Copy>(mut fits: Vec<(T, (Mounting, f64))>) -> Option<(T, Mounting)> {
    fits.sort_by(|(_, (_, a)), (_, (_, b))| a.total_cmp(b));
    let (which, (found, nis)) = *fits.first()?;
    let next = fits.get(1).map_or(f64::INFINITY, |(_, (_, nis))| *nis);
    (nis <= MOST_NIS && next >= CLEARLY * nis).then_some((which, found))
}
