//! Measurements. Each takes a gate, null for none, and says what it did in `done` unless that is null.

use crate::{
    capacity::{Inner, STATES},
    filter::{Filter, filter_mut},
    memory::{finite, read, read_or, write},
    status::{Status, call},
    types::{Gate, Outcome, Position, Update, Velocity},
};
use undrift_nav::{
    Matrix3, Vector3, aiding::Observation, earth::Geodetic, filter, magnetic, sample,
};

/// A measurement update, gated; what it did goes to `done`.
///
/// # Safety
/// `at` is null or a filter that nobody else uses, `gate` and `done` are null or valid.
unsafe fn run<const M: usize>(
    at: *mut Filter,
    gate: *const Gate,
    done: *mut Update,
    observe: impl FnOnce(&Inner) -> Result<(Observation<M, STATES>, [[f64; M]; M]), Status>,
) -> Status {
    call(|| {
        // SAFETY: null or a filter that nobody else uses.
        let filter = unsafe { filter_mut(at) }?;
        let open = Gate {
            weaken: f64::INFINITY,
            reject: f64::INFINITY,
        };
        // SAFETY: null or a gate.
        let gate = unsafe { read_or(gate, open) };
        if gate.weaken.is_nan() || gate.reject.is_nan() {
            return Err(Status::NotFinite);
        }
        if gate.weaken <= 0.0 || gate.reject < gate.weaken {
            return Err(Status::OutOfRange);
        }
        let gate = filter::Gate {
            weaken: gate.weaken,
            reject: gate.reject,
        };
        let (observed, r) = observe(filter)?;
        finite(r.iter().flatten())?;
        if !is_positive(&r) {
            return Err(Status::BadMeasurement);
        }
        // By columns or by rows: it is symmetric.
        let update = filter.update(&observed, &r.into(), &gate)?;
        let outcome = match update.outcome {
            filter::Outcome::Used => Outcome::Used,
            filter::Outcome::Weakened(_) => Outcome::Weakened,
            filter::Outcome::Rejected => Outcome::Rejected,
        };
        if !done.is_null() {
            let update = Update {
                nis: update.nis,
                dof: M as i32,
                outcome,
                factor: update.outcome.factor(),
            };
            // SAFETY: not null, so it points to an update.
            unsafe { write(done, update) }?;
        }
        Ok(())
    })
}

/// Whether a matrix of up to three rows is symmetric to rounding and its leading minors are positive.
pub(crate) fn is_positive<const M: usize>(r: &[[f64; M]; M]) -> bool {
    let mut whole = Matrix3::identity();
    for i in 0..M {
        for j in 0..M {
            whole[(i, j)] = r[i][j];
            let size = r[i][i].max(r[j][j]);
            if (r[i][j] - r[j][i]).abs() > 1e-9 * size {
                return false;
            }
        }
    }
    whole.cholesky().is_some()
}

/// The three numbers at `from`, zeros if it is null.
///
/// # Safety
/// `from` is null or points to three numbers.
unsafe fn lever_arm(from: *const f64) -> Result<Vector3, Status> {
    // SAFETY: null or three numbers.
    let lever = unsafe { read_or(from.cast::<[f64; 3]>(), [0.0; 3]) };
    finite(&lever)?;
    Ok(lever.into())
}

/// The variance of a standard deviation, which must be positive.
fn variance(std: f64) -> Result<f64, Status> {
    finite([&std])?;
    if std > 0.0 {
        Ok(std * std)
    } else {
        Err(Status::OutOfRange)
    }
}

/// Updates with the position of the antenna; `lever` is the vector from the IMU to it, three numbers [m, body axes],
/// null if it is at the IMU. As every update: without a `gate` (null) nothing is rejected, `done` may be null, and a measurement that
/// the gate rejects is a success whose outcome says so. After a failure the filter is as before;
/// UNDRIFT_STATUS_OUT_OF_RANGE is also returned for a measurement that would move the solution off the Earth.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_update_position(
    filter: *mut Filter,
    position: *const Position,
    lever: *const f64,
    gate: *const Gate,
    done: *mut Update,
) -> Status {
    let observe = |filter: &Inner| {
        // SAFETY: null or a position.
        let fix = unsafe { read(position) }?;
        // SAFETY: null or three numbers.
        let lever = unsafe { lever_arm(lever) }?;
        finite([&fix.latitude, &fix.longitude, &fix.height])?;
        let place = Geodetic {
            lat: fix.latitude,
            lon: fix.longitude,
            height: fix.height,
        };
        if !place.is_valid() {
            return Err(Status::OutOfRange);
        }
        let observed = filter.observe_position(&sample::Position::Geodetic(place), &lever);
        Ok((observed, fix.covariance))
    };
    // SAFETY: passed on.
    unsafe { run(filter, gate, done, observe) }
}

/// Updates with the velocity of the antenna; `lever` as for the position.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_update_velocity(
    filter: *mut Filter,
    velocity: *const Velocity,
    lever: *const f64,
    gate: *const Gate,
    done: *mut Update,
) -> Status {
    let observe = |filter: &Inner| {
        // SAFETY: null or a velocity.
        let fix = unsafe { read(velocity) }?;
        // SAFETY: null or three numbers.
        let lever = unsafe { lever_arm(lever) }?;
        finite(&fix.velocity)?;
        let observed = filter.observe_velocity(&fix.velocity.into(), &lever);
        Ok((observed, fix.covariance))
    };
    // SAFETY: passed on.
    unsafe { run(filter, gate, done, observe) }
}

/// Zero-velocity update: the velocity is zero with standard deviation `std` [m/s] along each axis.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_update_zero_velocity(
    filter: *mut Filter,
    std: f64,
    gate: *const Gate,
    done: *mut Update,
) -> Status {
    let observe = |filter: &Inner| {
        let v = variance(std)?;
        let r = [[v, 0.0, 0.0], [0.0, v, 0.0], [0.0, 0.0, v]];
        Ok((filter.observe_zero_velocity(), r))
    };
    // SAFETY: passed on.
    unsafe { run(filter, gate, done, observe) }
}

/// Non-holonomic constraint: at the point `lever` from the IMU [m, body axes], on the axle that does not steer,
/// the lateral and the vertical velocity are zero, with these standard deviations [m/s].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_update_non_holonomic(
    filter: *mut Filter,
    lever: *const f64,
    sideways_std: f64,
    up_std: f64,
    gate: *const Gate,
    done: *mut Update,
) -> Status {
    let observe = |filter: &Inner| {
        // SAFETY: null or three numbers.
        let lever = unsafe { lever_arm(lever) }?;
        let r = [[variance(sideways_std)?, 0.0], [0.0, variance(up_std)?]];
        Ok((filter.observe_non_holonomic(&lever), r))
    };
    // SAFETY: passed on.
    unsafe { run(filter, gate, done, observe) }
}

/// Updates with the speed [m/s, forward positive] of the wheel at `lever` from the IMU [m, body axes], with standard deviation `std` [m/s].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_update_odometer(
    filter: *mut Filter,
    speed: f64,
    std: f64,
    lever: *const f64,
    gate: *const Gate,
    done: *mut Update,
) -> Status {
    let observe = |filter: &Inner| {
        // SAFETY: null or three numbers.
        let lever = unsafe { lever_arm(lever) }?;
        finite([&speed])?;
        Ok((filter.observe_odometer(speed, &lever), [[variance(std)?]]))
    };
    // SAFETY: passed on.
    unsafe { run(filter, gate, done, observe) }
}

/// Updates with a barometric height of the IMU above the ellipsoid \[m\], which may be off by
/// UNDRIFT_PARAMETER_BAROMETER_BIAS, with standard deviation `std` \[m\].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_update_height(
    filter: *mut Filter,
    height: f64,
    std: f64,
    gate: *const Gate,
    done: *mut Update,
) -> Status {
    let observe = |filter: &Inner| {
        finite([&height])?;
        Ok((filter.observe_barometer(height), [[variance(std)?]]))
    };
    // SAFETY: passed on.
    unsafe { run(filter, gate, done, observe) }
}

/// Updates with the azimuth of a second antenna as seen from the first, from north to east \[rad\], with standard deviation `std` \[rad\].
/// The second lies in the direction `baseline` in the body, from forward to right \[rad\], which may be off by
/// UNDRIFT_PARAMETER_HEADING_OFFSET. UNDRIFT_STATUS_OUT_OF_RANGE where one is above the other.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_update_heading(
    filter: *mut Filter,
    heading: f64,
    std: f64,
    baseline: f64,
    gate: *const Gate,
    done: *mut Update,
) -> Status {
    let observe = |filter: &Inner| {
        finite([&heading, &baseline])?;
        let observed = filter.observe_heading(heading, baseline);
        Ok((observed.ok_or(Status::OutOfRange)?, [[variance(std)?]]))
    };
    // SAFETY: passed on.
    unsafe { run(filter, gate, done, observe) }
}

/// Updates with a magnetic field, three numbers in body axes, with standard deviation `std` each; `earth` is the Earth's field north,
/// east, down of undrift_magnetic_field(), all in \[T\]. The hard iron is UNDRIFT_PARAMETER_HARD_IRON.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_update_magnetometer(
    filter: *mut Filter,
    field: *const f64,
    std: f64,
    earth: *const f64,
    gate: *const Gate,
    done: *mut Update,
) -> Status {
    let observe = |filter: &Inner| {
        // SAFETY: null or three numbers each.
        let [field, earth] = unsafe {
            [
                read(field.cast::<[f64; 3]>())?,
                read(earth.cast::<[f64; 3]>())?,
            ]
        };
        finite(field.iter().chain(&earth))?;
        let observed = filter.observe_magnetometer(&field.into(), &earth.into());
        let variance = variance(std)?;
        let noise = Matrix3::identity() * variance;
        Ok((observed, noise.into()))
    };
    // SAFETY: passed on.
    unsafe { run(filter, gate, done, observe) }
}

/// The Earth's magnetic field north, east, down \[T\], three numbers to `earth`, at a place [rad, rad, m] in a year with its fraction:
/// the World Magnetic Model 2025, made for 2025 to 2030.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_magnetic_field(
    latitude: f64,
    longitude: f64,
    height: f64,
    year: f64,
    earth: *mut f64,
) -> Status {
    call(|| {
        finite([&latitude, &longitude, &height, &year])?;
        let place = Geodetic {
            lat: latitude,
            lon: longitude,
            height,
        };
        let field: [f64; 3] = magnetic::field(&place, year).into();
        // SAFETY: null or three numbers.
        unsafe { write(earth.cast::<[f64; 3]>(), field) }
    })
}
