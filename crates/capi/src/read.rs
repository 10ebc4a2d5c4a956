//! What the filter knows.

use crate::{
    filter::{Filter, filter_ref},
    memory::write,
    status::{Status, call},
    types::State,
};
use undrift_nav::{
    Vector3, attitude,
    covariance::{AXES, NAV},
    mechanisation::NavState,
    parameters::Parameter,
};

/// The solution of these parts: `sensors` has the sensors' errors and their standard deviations.
pub(crate) fn solution(
    nav: &NavState,
    omega_nb_b: &Vector3,
    [n, e, d, vn, ve, vd, roll, pitch, yaw]: [f64; NAV],
    sensors: [[f64; AXES]; 2],
) -> State {
    let q = nav.q_nb.quaternion();
    let [[gx, gy, gz, ax, ay, az], std] = sensors;
    let [gx_std, gy_std, gz_std, ax_std, ay_std, az_std] = std;
    State {
        time: nav.time,
        latitude: nav.position.lat,
        longitude: nav.position.lon,
        height: nav.position.height,
        velocity: nav.v_n.into(),
        quaternion: [q.w, q.i, q.j, q.k],
        roll_pitch_yaw: attitude::to_rpy(&nav.q_nb).into(),
        gyro_error: [gx, gy, gz],
        accel_error: [ax, ay, az],
        angular_rate: (*omega_nb_b).into(),
        position_std: [n, e, d],
        velocity_std: [vn, ve, vd],
        attitude_std: [roll, pitch, yaw],
        gyro_error_std: [gx_std, gy_std, gz_std],
        accel_error_std: [ax_std, ay_std, az_std],
    }
}

/// Number of states in use; 0 for what is no filter.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_states(filter: *const Filter) -> usize {
    // SAFETY: null or a filter that nobody changes meanwhile.
    unsafe { filter_ref(filter) }.map_or(0, |filter| filter.states())
}

/// The solution.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_get_state(filter: *const Filter, state: *mut State) -> Status {
    call(|| {
        // SAFETY: null or a filter that nobody changes meanwhile.
        let filter = unsafe { filter_ref(filter) }?;
        let solution = solution(
            filter.nav(),
            &filter.omega_nb_b(),
            filter.nav_std(),
            [filter.sensor_error(), filter.sensor_error_std()],
        );
        // SAFETY: null or a state's.
        unsafe { write(state, solution) }
    })
}

/// The covariance of the error state, undrift_states() rows of as many numbers, into an array of `count`
/// numbers: position \[m\], velocity [m/s], misalignment \[rad\], each north, east, down, then the sensors'
/// states, then the parameters.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_get_covariance(
    filter: *const Filter,
    covariance: *mut f64,
    count: usize,
) -> Status {
    call(|| {
        // SAFETY: null or a filter that nobody changes meanwhile.
        let filter = unsafe { filter_ref(filter) }?;
        let n = filter.states();
        if covariance.is_null() {
            return Err(Status::NullPointer);
        }
        if count < n * n {
            return Err(Status::TooSmall);
        }
        for i in 0..n {
            for j in 0..n {
                // SAFETY: below the count of numbers that there is memory for.
                unsafe { write(covariance.add(i * n + j), filter.covariance()[(i, j)]) }?;
            }
        }
        Ok(())
    })
}

/// The estimated correction of a parameter (undrift_parameter) to what was given, and its standard
/// deviation: up to six numbers each, as many as the parameter has states.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_get_parameter(
    filter: *const Filter,
    parameter: i32,
    value: *mut f64,
    std: *mut f64,
) -> Status {
    call(|| {
        // SAFETY: null or a filter that nobody changes meanwhile.
        let filter = unsafe { filter_ref(filter) }?;
        let kind = (Parameter::ALL.into_iter()).find(|kind| *kind as i32 == parameter);
        let kind = kind.ok_or(Status::OutOfRange)?;
        let (values, stds) = filter.parameter(kind).ok_or(Status::NotEstimated)?;
        if value.is_null() || std.is_null() {
            return Err(Status::NullPointer);
        }
        for i in 0..kind.width() {
            // SAFETY: there is memory for as many numbers as the parameter has states.
            unsafe { write(value.add(i), values[i]) }?;
            // SAFETY: as above.
            unsafe { write(std.add(i), stds[i]) }?;
        }
        Ok(())
    })
}

/// UNDRIFT_STATUS_OK while the solution is one: finite, possible, its covariance not negative.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_check(filter: *const Filter) -> Status {
    call(|| {
        // SAFETY: null or a filter that nobody changes meanwhile.
        let filter = unsafe { filter_ref(filter) }?;
        Ok(filter.check()?)
    })
}
