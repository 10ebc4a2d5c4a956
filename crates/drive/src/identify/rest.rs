//! Whether a record is one of a sensor at rest, in the units that it is said to be in.

use super::part::{Part, part_at_rest};
use crate::{
    inspect::{Known, about_gravity, are_exchanged, unit_of_rates},
    record::{Record, own_values},
};
use undrift_base::order_statistics::upper_median;
use undrift_nav::{
    earth::STANDARD_GRAVITY,
    units::{Quantity, unit_factor},
};
pub use undrift_results::recording::{Likely, NotStatic};

/// Rate beyond any turn-on constant [rad/s]: 20 deg/s of the cheapest sensors.
const TURNING: f64 = 0.5;
/// Rates that scatter by more than this from sample to sample [rad/s], 2.9 deg/s, three times what the noisiest sensor has,
/// are no rad/s.
const SCATTERING: f64 = 0.05;
/// Whole numbers in more levels than this, called deg/s or rad/s, are counts.
const LEVELS: usize = 4;
/// Samples that a size is taken from.
const PROBE: usize = 10_000;

/// Why a record at a rate \[Hz\] is not a static recording; `None` if it is static. Uses the axes that are present;
/// gravity needs three accelerometers. A record that was handled before or after it lay still is
/// static: the handled part is removed ([`super::prepare`]).
pub fn not_static(record: &Record, rate_hz: f64) -> Option<NotStatic> {
    static_part(record, rate_hz).err()
}

/// The part of a record at a rate \[Hz\] in which its sensor lies still.
///
/// # Errors
/// Why it is no static recording.
pub(super) fn static_part(record: &Record, rate_hz: f64) -> Result<Part, NotStatic> {
    match wrong_numbers(record, rate_hz) {
        Some(problem) => Err(problem),
        None => part_at_rest(record, rate_hz),
    }
}

/// What in a record's numbers no sensor at rest reads in the units stated.
fn wrong_numbers(record: &Record, rate_hz: f64) -> Option<NotStatic> {
    // Of a sensor that is slower than the record its own samples.
    let own = record.samples.iter().map(|samples| own_values(samples));
    let own: Vec<_> = own.collect();
    let named = |sensor: &str| -> (Vec<(&'static str, &[f64])>, f64) {
        let axes = record.axes.iter().zip(record.samples.iter().zip(&own));
        let axes = axes.filter(|(name, _)| name.starts_with(sensor));
        let mut own_hz = rate_hz;
        let axes = axes.map(|(name, (samples, own))| match own {
            Some((values, _, every)) => {
                own_hz = rate_hz / every;
                (*name, values.as_slice())
            }
            None => (*name, samples.as_slice()),
        });
        let axes = axes.collect();
        (axes, own_hz)
    };
    let ((gyros, _), (accels, accel_hz)) = (named("gyro"), named("accel"));
    let (gyro_unit, accel_unit) = record.units.clone().unwrap_or_default();
    force(&accels, &gyros, &accel_unit, &gyro_unit, accel_hz)
        .or_else(|| counts(&gyros, &gyro_unit, &accel_unit))
        .or_else(|| scattering(&gyros, &gyro_unit, &accel_unit))
        .or_else(|| turning(&gyros))
}

fn force(
    accels: &[(&'static str, &[f64])],
    gyros: &[(&'static str, &[f64])],
    unit: &str,
    gyro_unit: &str,
    rate_hz: f64,
) -> Option<NotStatic> {
    let forces = probed(accels)?;
    let size = |[x, y, z]: &[f64; 3]| (x * x + y * y + z * z).sqrt();
    let mut sizes: Vec<f64> = forces.iter().map(size).collect();
    let force = upper_median(&mut sizes);
    if about_gravity([0.0, 0.0, force]) {
        return None;
    }
    let factor = |unit, quantity| unit_factor(unit, quantity).unwrap_or(1.0);
    let number = force / factor(unit, Quantity::Acceleration);
    let in_unit = |samples: Vec<[f64; 3]>, factor: f64| {
        Vec::from_iter(samples.iter().map(|v| v.map(|x| x / factor)))
    };
    let forces = in_unit(forces, factor(unit, Quantity::Acceleration));
    let rates = in_unit(
        probed(gyros).unwrap_or_default(),
        factor(gyro_unit, Quantity::AngularRate),
    );
    let near = |value: f64| (0.85..1.15).contains(&(number / value));
    const SIZES: [(&str, f64); 9] = [
        ("m/s^2", STANDARD_GRAVITY),
        ("g", 1.0),
        ("mg", 1e3),
        ("ug", 1e6),
        ("LSB/16384 g", 16384.0),
        ("LSB/8192 g", 8192.0),
        ("LSB/4096 g", 4096.0),
        ("LSB/2048 g", 2048.0),
        ("LSB/256 g", 256.0),
    ];
    let likely = match SIZES.iter().find(|(_, gravity)| near(*gravity)) {
        _ if are_exchanged(&rates, &forces) => Likely::Exchanged,
        Some((unit, _)) => Likely::Unit(unit),
        None if near(STANDARD_GRAVITY / rate_hz) => Likely::Increments,
        None if force < 0.1 * STANDARD_GRAVITY => Likely::GravityRemoved,
        None => Likely::Unknown,
    };
    Some(NotStatic::Force {
        force,
        likely,
        gyro_unit: gyro_unit.to_owned(),
    })
}

/// Samples of three axes; `None` without them.
fn probed(axes: &[(&'static str, &[f64])]) -> Option<Vec<[f64; 3]>> {
    let [(_, x), (_, y), (_, z)] = axes else {
        return None;
    };
    let stride = (x.len() / PROBE).max(1);
    let triples = x.iter().zip(*y).zip(*z).step_by(stride);
    let triples = triples.map(|((x, y), z)| [*x, *y, *z]);
    let finite = triples.filter(|v| v.iter().all(|x| x.is_finite()));
    Some(finite.collect()).filter(|samples: &Vec<_>| !samples.is_empty())
}

/// Gyros of whole numbers: a step of 1 deg/s is coarser than any has.
fn counts(gyros: &[(&'static str, &[f64])], unit: &str, accel_unit: &str) -> Option<NotStatic> {
    let factor = unit_factor(unit, Quantity::AngularRate).ok()?;
    if factor < 1f64.to_radians() * (1.0 - 1e-9) {
        return None;
    }
    gyros.iter().find_map(|(axis, samples)| {
        let numbers = samples.iter().filter(|x| !x.is_nan());
        let numbers = numbers.map(|x| x / factor);
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        for number in numbers {
            // Turned from the unit into SI and back.
            if (number - number.round()).abs() > 1e-9 * number.abs().max(1.0) {
                return None;
            }
            range = [range[0].min(number.round()), range[1].max(number.round())];
        }
        (range[1] - range[0] >= LEVELS as f64).then(|| NotStatic::Counts {
            axis,
            unit: unit.to_owned(),
            accel_unit: accel_unit.to_owned(),
            range,
        })
    })
}

fn scattering(gyros: &[(&'static str, &[f64])], unit: &str, accel_unit: &str) -> Option<NotStatic> {
    let radians = unit_factor(unit, Quantity::AngularRate).ok()? == 1.0;
    gyros
        .iter()
        .filter(|_| radians)
        .find_map(|(axis, samples)| {
            let begin = samples.iter().take(PROBE).map(|rate| [*rate; 3]);
            match unit_of_rates(&Vec::from_iter(begin)) {
                (_, Known::LargeScatter(scatter)) if scatter > SCATTERING => {
                    Some(NotStatic::Scattering {
                        axis,
                        scatter,
                        accel_unit: accel_unit.to_owned(),
                    })
                }
                _ => None,
            }
        })
}

fn turning(gyros: &[(&'static str, &[f64])]) -> Option<NotStatic> {
    gyros.iter().find_map(|(axis, samples)| {
        let finite = samples.iter().filter(|x| !x.is_nan());
        let (sum, count) = finite.fold((0.0, 0.0), |(sum, count), x| (sum + x, count + 1.0));
        let rate: f64 = sum / count;
        (rate.abs() > TURNING).then_some(NotStatic::Turning { axis, rate })
    })
}

#[cfg(test)]
mod tests;
