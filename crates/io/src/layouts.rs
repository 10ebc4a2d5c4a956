//! Column layouts of tables whose columns never change: KF-GINS, EuRoC. Descriptions only; `undrift-drive` chooses one by the
//! file's format and gives it to the readers.

use crate::gnss::{FixOptions, GnssFormat, PositionColumns, VelocityAxes};
use crate::imu::ImuFormat;
use crate::table::Column;
use crate::truth::TruthFormat;

fn three(from: usize) -> [Column; 3] {
    [from, from + 1, from + 2].map(Column::Number)
}

/// KF-GINS inertial text: time \[s\], angle increments \[rad\], velocity increments [m/s], axes forward,
/// right, down.
pub fn kf_gins_imu() -> ImuFormat {
    ImuFormat {
        increments: true,
        ..ImuFormat::new(Some(Column::Number(1)), three(2), three(5))
    }
}

/// Columns of a KF-GINS GNSS text with velocities; without them it has 7.
pub const KF_GINS_WITH_VELOCITY: usize = 13;

/// KF-GINS GNSS text: time \[s\], latitude, longitude \[deg\], height \[m\]; if `columns` is
/// [`KF_GINS_WITH_VELOCITY`], velocity [m/s]; then the standard deviations of the position and, if there is one, of the
/// velocity. Each is north, east, down.
pub fn kf_gins_gnss(columns: usize) -> GnssFormat {
    let with_velocity = columns >= KF_GINS_WITH_VELOCITY;
    GnssFormat {
        time: Column::Number(1),
        date: None,
        time_scale: 1.0,
        place: Some(PositionColumns::Geodetic {
            columns: three(2),
            angle_scale: 1f64.to_radians(),
            degrees_minutes: false,
            height_scale: 1.0,
            height: None,
        }),
        position_std: Some(three(if with_velocity { 8 } else { 5 })),
        velocity: with_velocity.then(|| three(5)),
        velocity_scale: 1.0,
        velocity_axes: VelocityAxes::Down,
        velocity_std: with_velocity.then(|| three(11)),
        quality: None,
        delimiter: None,
        fixes: FixOptions::default(),
    }
}

/// KF-GINS solution: week, second of week, latitude, longitude \[deg\], height \[m\], velocity [m/s]
/// north, east, down, roll, pitch, yaw \[deg\].
pub fn kf_gins_truth() -> TruthFormat {
    TruthFormat {
        week: Some(Column::Number(1)),
        velocity: Some(three(6)),
        attitude: Some(three(9)),
        ..TruthFormat::degrees(Column::Number(2), three(3))
    }
}

/// EuRoC inertial CSV: time \[ns\], angular rates [rad/s], specific forces [m/s²], sensor axes.
pub fn euroc_imu() -> ImuFormat {
    ImuFormat {
        time_scale: 1e-9,
        ..ImuFormat::new(Some(Column::Number(1)), three(2), three(5))
    }
}
