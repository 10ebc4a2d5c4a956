//! How the axes of a magnetometer lie in the IMU's, by how the field turns against the gyros.

use crate::{drive::Drive, replay::Measurement};
use undrift_nav::{
    Matrix3, Quaternion, Vector3,
    attitude::from_rotation_vector,
    sample::{ImuSample, MagneticField},
};
use undrift_results::inspect::{Known, Line, Note, Part};

/// Readings nearer than this to the one before are passed over \[s\]: the field turns by more than its noise.
const APART: f64 = 0.1;
/// Pairs further apart are not compared \[s\].
const GAP: f64 = 1.0;
/// Most pairs that are looked at.
const PAIRS: usize = 30_000;
/// Square of a reading's noise in a usual hard iron, 1 µT in 20 µT.
const SMALL_IRON: f64 = 2.5e-3;
/// Least turn of all pairs together \[rad\].
const LEAST_TURN: f64 = 6.0;
/// Axes fit where they leave so little of what the field turns by, in squares …
const FITS: f64 = 0.35;
/// … and are the only ones that do where others leave so many times as much.
const CLEAR: f64 = 1.5;

/// Two readings and what the gyros turned by between them, sensor axes.
struct Pair {
    before: Vector3,
    after: Vector3,
    /// Takes vectors of the axes before into those after.
    turn: Matrix3,
}

/// Writes the axes that `drive` shows into the part of its magnetometer; a note where none fit or motion does not show them: then there is
/// no such part.
pub(super) fn write(part: &mut Part, drive: &Drive) -> Option<Note> {
    match axes(drive) {
        Ok(axes) if axes == "x,y,z" => None,
        Ok(axes) => {
            part.lines.push(Line::new("axes", axes, Known::FieldTurns));
            None
        }
        Err(turned) => {
            let turned_deg = turned.to_degrees();
            Some(Note::NoMagnetometer { turned_deg })
        }
    }
}

/// The axes of the IMU by those of the magnetometer, as a drive file has them; else how far the gyros turned \[rad\].
fn axes(drive: &Drive) -> Result<String, f64> {
    let pairs = pairs(drive).unwrap_or_default();
    let angle = |pair: &Pair| Quaternion::from_matrix(&pair.turn).angle();
    let turned = pairs.iter().map(angle).sum();
    if turned < LEAST_TURN {
        return Err(turned);
    }
    let moved: f64 = pairs
        .iter()
        .map(|p| (p.after - p.before).norm_squared())
        .sum();
    let mut found: Vec<(f64, &str)> = every()
        .into_iter()
        .map(|(name, rotation)| (left(&pairs, &rotation) / moved, name))
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let same = found.iter().find(|(_, name)| *name == "x,y,z");
    let (best, second) = (found[0], found[1]);
    // Of a turn about one axis alone several fit: chips on one board have the same axes.
    match same {
        Some((left, name)) if *left < FITS && *left < CLEAR * best.0 => Ok((*name).to_owned()),
        _ if best.0 < FITS && CLEAR * best.0 < second.0 => Ok(best.1.to_owned()),
        _ => Err(turned),
    }
}

/// The rotations that take axes to axes, by the names that drive files have for them.
fn every() -> Vec<(&'static str, Matrix3)> {
    const NAMES: [&str; 24] = [
        "x,y,z", "x,-y,-z", "-x,y,-z", "-x,-y,z", "y,x,-z", "y,-x,z", "-y,x,z", "-y,-x,-z",
        "x,z,-y", "x,-z,y", "-x,z,y", "-x,-z,-y", "z,y,-x", "z,-y,x", "-z,y,x", "-z,-y,-x",
        "y,z,x", "y,-z,-x", "-y,z,-x", "-y,-z,x", "z,x,y", "z,-x,-y", "-z,x,-y", "-z,-x,y",
    ];
    let rotation = |name| crate::drive::imu::rotation_of_axes(name).ok();
    NAMES
        .into_iter()
        .filter_map(|name| Some((name, rotation(name)?)))
        .collect()
}

/// What is left of the field's changes with a constant hard iron b, whose squares are least: `m' − b = C (m − b)`.
fn left(pairs: &[Pair], rotation: &Matrix3) -> f64 {
    let (mut normal, mut right, mut all) = (Matrix3::zeros(), Vector3::zeros(), 0.0);
    for pair in pairs {
        let off = rotation * pair.after - pair.turn * (rotation * pair.before);
        let row = Matrix3::identity() - pair.turn;
        normal += row.transpose() * row;
        right += row.tr_mul(&off);
        all += off.norm_squared();
    }
    // About one axis alone the hard iron along it does not show: it is taken for small.
    normal += Matrix3::identity() * SMALL_IRON;
    let iron = normal
        .try_inverse()
        .map_or(Vector3::zeros(), |inverse| inverse * right);
    (all - iron.dot(&right)).max(0.0)
}

/// Readings of the drive with the turns between them.
fn pairs(drive: &Drive) -> Option<Vec<Pair>> {
    let imu = drive.open_imu().ok()?.collect::<Result<Vec<_>, _>>().ok()?;
    let mut fields = Vec::new();
    for reader in drive.open_sensors().ok()? {
        for reading in reader {
            if let Ok(Measurement::Magnetometer(field)) = reading {
                fields.push(field);
            }
        }
    }
    Some(turned(&imu, &fields))
}

fn turned(imu: &[ImuSample], fields: &[MagneticField]) -> Vec<Pair> {
    let mut pairs: Vec<Pair> = Vec::new();
    let mut samples = imu.iter().peekable();
    let mut before: Option<MagneticField> = None;
    for field in fields {
        let Some(last) = before else {
            before = Some(*field);
            continue;
        };
        if field.time - last.time < APART {
            continue;
        }
        before = Some(*field);
        let mut q = Quaternion::identity();
        let mut covered = 0.0;
        while let Some(sample) = samples.peek()
            && sample.time - sample.dt < field.time
        {
            let start = last.time.max(sample.time - sample.dt);
            let span = field.time.min(sample.time) - start;
            if span > 0.0 {
                q *= from_rotation_vector(&(sample.dtheta * (span / sample.dt)));
                covered += span;
            }
            if sample.time > field.time {
                break;
            }
            samples.next();
        }
        let length = field.time - last.time;
        if length < GAP && covered > 0.99 * length && pairs.len() < PAIRS {
            pairs.push(Pair {
                before: last.field,
                after: field.field,
                turn: q.inverse().to_rotation_matrix().into_inner(),
            });
        }
    }
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;
    use undrift_simulate::{GnssNoise, Magnetometer, Trajectory, simulate};

    fn drive(about_all: bool, mounted: &str) -> Drive {
        let mut motion = Trajectory::rest(120.0);
        for k in 0..10 {
            let start = 5.0 + 10.0 * f64::from(k);
            motion
                .turn_rate
                .step_to(start, 1.0, if k % 2 == 0 { 0.4 } else { -0.3 });
            if about_all {
                motion
                    .pitch
                    .profile
                    .step_to(start, 2.0, 0.5 * f64::from(k % 3) - 0.4);
                motion
                    .roll
                    .profile
                    .step_to(start + 3.0, 2.0, 0.6 - 0.5 * f64::from(k % 4));
            }
        }
        let log = simulate(&motion, 50.0, None, &GnssNoise::default(), 1).unwrap();
        let fields = Magnetometer::default().measure(&motion, 1).unwrap();
        let rotation = crate::drive::imu::rotation_of_axes(mounted).unwrap();
        let turned = |of: MagneticField| MagneticField {
            field: rotation.tr_mul(&of.field),
            ..of
        };
        let fields: Vec<_> = fields.map(turned).collect();
        Drive::from_samples(&log.imu, &log.gnss).with_magnetometer(&fields)
    }

    #[test]
    fn axes_are_those_in_which_the_field_turns_against_the_gyros() {
        for (name, _) in every() {
            assert_eq!(axes(&drive(true, name)).as_deref(), Ok(name));
        }
        // About the vertical alone the usual axes fit, others cannot be distinguished.
        assert_eq!(axes(&drive(false, "x,y,z")).as_deref(), Ok("x,y,z"));
        assert!(axes(&drive(false, "x,-y,-z")).is_err());
    }
}
