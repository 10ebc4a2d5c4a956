//! Sentences: what is wrong with poses.

use super::words::at;
use crate::numbers::short;
use undrift_results::inspect::PoseFault;

/// What is wrong with poses, or why nothing was found; `mended`: the drive reads them as they are.
pub(crate) fn fault(fault: &PoseFault, mended: bool) -> String {
    let cut = match mended {
        true => "the longest part without is used ([span] start, end)",
        false => "set [span] start or end there, and use each part by itself",
    };
    match fault {
        PoseFault::ScalarFirst => {
            "the quaternions have w first: only so do the turns of poses and gyros agree; set attitude_order = \"w,x,y,z\", as `undrift inspect` does".into()
        }
        PoseFault::Inverse => {
            "the quaternions are inverse: they turn the axes of the frame into the marker's, and are to turn the marker's into the frame's; change the sign of qx, qy and qz".into()
        }
        PoseFault::GyroUnit { ratio } => format!(
            "the poses turn {} times as far as the gyros: check imu.gyro_unit",
            short(*ratio)
        ),
        PoseFault::Unit(unit) => format!(
            "the positions are in {unit}, by the accelerations; set position_unit = \"{unit}\", as `undrift inspect` does"
        ),
        PoseFault::PositionAxes(axes) => format!(
            "positions and attitudes are of different frames: with the axes {} for x, y, z of the positions they agree; exchange these columns or their signs",
            axes.map(axis).join(", ")
        ),
        PoseFault::Mirrored => {
            "poses and IMU are mirror images: one of them has left-handed axes; reverse one axis of the poses, or of the IMU".into()
        }
        PoseFault::NoFit { correlation } => format!(
            "poses and gyros have no turns in common (correlation {correlation:.2}): other recordings, a marker that is not fixed to the IMU, or the gyros' unit or axes"
        ),
        PoseFault::Rate { ratio } => format!(
            "the clock of the poses runs {} % {}: multiply their times by {:.5}, or check the rate of the samples",
            short(100.0 * (ratio - 1.0).abs()),
            if *ratio > 1.0 { "fast" } else { "slow" },
            1.0 / ratio
        ),
        PoseFault::Clock { offset } => format!(
            "the poses have another clock: {} s are to be added to their times (time_offset, as `undrift inspect` sets it)",
            at(*offset)
        ),
        PoseFault::NoAttitudes => {
            "poses without attitudes: clock and lever arm are estimated, and the gyros' noise shows less".into()
        }
        PoseFault::Still { rate_deg } => format!(
            "the marker hardly turns ({rate_deg:.1} deg/s): its axes against the IMU's do not show; turn it about all axes at some 30 deg/s"
        ),
        PoseFault::OneAxis => {
            "the marker turns about one axis only, so its axes against the IMU's do not show; turn it about two or more".into()
        }
        PoseFault::TooShort { duration_s } => format!(
            "only {duration_s:.0} s of poses with an attitude: record a minute or more"
        ),
        PoseFault::NoPositions => {
            "too few positions that differ beside the attitudes: what the accelerometers err by shows in positions alone".into()
        }
        PoseFault::NoGravity { found } => format!(
            "what the accelerometers measure beyond the motion of the poses is {found:.2} m/s^2, and should be gravity: check imu.accel_unit and the unit and axes of the positions"
        ),
        PoseFault::Slipped {
            time,
            angle_deg,
            distance_m,
        } => {
            let turned = (*angle_deg > 0.0).then(|| format!("{}°", short(*angle_deg)));
            let moved = (*distance_m > 0.0).then(|| format!("{} cm", short(100.0 * distance_m)));
            let by = Vec::from_iter(turned.into_iter().chain(moved)).join(" and ");
            format!(
                "the marker slipped by {by} against the IMU at {} s: {cut}",
                at(*time)
            )
        }
        PoseFault::Slid {
            start,
            end,
            angle_deg,
        } => format!(
            "the marker slides against the IMU, by {}° from {} to {} s: {cut}; mount it better",
            short(*angle_deg),
            at(*start),
            at(*end)
        ),
        PoseFault::Jumped {
            time,
            angle_deg,
            lasting: true,
            ..
        } => format!(
            "the frame of the poses turns by {}° at {} s while the IMU does not: {cut}",
            short(*angle_deg),
            at(*time)
        ),
        PoseFault::Jumped {
            time,
            end,
            angle_deg,
            ..
        } => format!(
            "poses jump by {}° from {} to {} s while the IMU does not, as of another body or a lost marker; leave them away, or cut them out",
            short(*angle_deg),
            at(*time),
            at(*end)
        ),
        PoseFault::Shifted { time, distance_m } => format!(
            "the frame of the poses moves by {} cm at {} s while the IMU does not: {cut}",
            short(100.0 * distance_m),
            at(*time)
        ),
        PoseFault::Frozen { poses, time } => format!(
            "{poses} poses repeat the one before, the first at {} s, as of a lost marker; they are not used",
            at(*time)
        ),
        PoseFault::Piece { start, end } => format!(
            "marker, lever arm, clock and accuracy are those from {} to {} s",
            at(*start),
            at(*end)
        ),
    }
}

fn axis(of: i8) -> String {
    let sign = if of < 0 { "-" } else { "" };
    format!(
        "{sign}{}",
        ["x", "y", "z"][usize::from(of.unsigned_abs().clamp(1, 3)) - 1]
    )
}
