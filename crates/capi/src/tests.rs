//! The C functions against the filter they stand for; examples/abuse.c tries what C can do wrong.

use crate::{
    capacity::{Inner, STATES},
    filter::*,
    read::*,
    sensor::*,
    status::*,
    types::*,
    update::*,
};
use core::{
    mem::MaybeUninit,
    ptr::{null, null_mut},
};
use undrift_nav::{
    Matrix3, Vector3, attitude,
    earth::Geodetic,
    filter::InitialStd,
    mechanisation::NavState,
    parameters::Parameters,
    sample::{ImuSample, Position as Place},
    shaping::ShapingFilter,
};

const T: f64 = 0.01;
const LEVER: [f64; 3] = [0.5, 0.2, -1.2];

fn model() -> ShapingFilter {
    ShapingFilter::arma(&[0.99, -0.1], &[0.4], 1e-3, T)
        .unwrap()
        .plus(&ShapingFilter::constant(1e-2, T).unwrap())
        .unwrap()
}

fn made() -> Sensor {
    let mut sensor = MaybeUninit::<Sensor>::uninit();
    let mut constant = MaybeUninit::<Sensor>::uninit();
    let (phi, theta) = ([0.99, -0.1], [0.4]);
    // SAFETY: everything points to what it says.
    unsafe {
        let out = sensor.as_mut_ptr();
        assert_eq!(
            undrift_sensor_arma(phi.as_ptr(), 2, theta.as_ptr(), 1, 1e-3, T, out),
            Status::Ok
        );
        assert_eq!(
            undrift_sensor_constant(1e-2, T, constant.as_mut_ptr()),
            Status::Ok
        );
        assert_eq!(undrift_sensor_add(out, constant.as_ptr(), out), Status::Ok);
        sensor.assume_init()
    }
}

fn start() -> Start {
    Start {
        time: 5.0,
        latitude: 0.5,
        longitude: 2.0,
        height: 25.0,
        velocity: [9.0, -5.0, 0.1],
        roll_pitch_yaw: [0.01, -0.02, -0.5],
        position_std: [1.0, 2.0, 3.0],
        velocity_std: [0.1, 0.2, 0.3],
        attitude_std: [0.01, 0.02, 0.05],
    }
}

fn direct() -> Inner {
    let from = start();
    let nav = NavState {
        time: from.time,
        position: Geodetic {
            lat: from.latitude,
            lon: from.longitude,
            height: from.height,
        },
        v_n: from.velocity.into(),
        q_nb: attitude::from_rpy(&from.roll_pitch_yaw.into()),
    };
    let std = InitialStd {
        position: from.position_std.into(),
        velocity: from.velocity_std.into(),
        attitude: from.attitude_std.into(),
    };
    Inner::new(nav, &std, [model(); 6], Parameters::none()).unwrap()
}

#[test]
fn a_step_and_an_update_are_the_filters_own() {
    let mut memory = MaybeUninit::<Filter>::uninit();
    let sensors = [made(); UNDRIFT_AXES];
    let mut filter = null_mut();
    let sample = Sample {
        time: 5.0 + T,
        dt: T,
        dtheta: [1e-4, -2e-4, 3e-3],
        dvel: [0.01, -0.02, -0.0978],
    };
    let fix = Position {
        latitude: 0.5 + 1e-7,
        longitude: 2.0,
        height: 26.0,
        covariance: [[1.0, 0.1, 0.0], [0.1, 2.0, 0.0], [0.0, 0.0, 3.0]],
    };
    let mut state = MaybeUninit::<State>::uninit();
    let mut covariance = [0.0; STATES * STATES];
    // SAFETY: everything points to what it says.
    let (state, n) = unsafe {
        let made = undrift_filter_init(
            memory.as_mut_ptr().cast(),
            size_of::<Filter>(),
            &start(),
            sensors.as_ptr(),
            null(),
            &mut filter,
        );
        assert_eq!(made, Status::Ok);
        assert_eq!(undrift_predict(filter, &sample), Status::Ok);
        let updated = undrift_update_position(filter, &fix, LEVER.as_ptr(), null(), null_mut());
        assert_eq!(updated, Status::Ok);
        assert_eq!(undrift_get_state(filter, state.as_mut_ptr()), Status::Ok);
        let got = undrift_get_covariance(filter, covariance.as_mut_ptr(), covariance.len());
        assert_eq!(got, Status::Ok);
        (state.assume_init(), undrift_states(filter))
    };

    let mut other = direct();
    other.predict(&ImuSample {
        time: sample.time,
        dt: sample.dt,
        dtheta: sample.dtheta.into(),
        dvel: sample.dvel.into(),
    });
    let place = Place::Geodetic(Geodetic {
        lat: fix.latitude,
        lon: fix.longitude,
        height: fix.height,
    });
    let observed = other.observe_position(&place, &Vector3::from(LEVER));
    other
        .update(
            &observed,
            &Matrix3::from(fix.covariance),
            &undrift_nav::filter::Gate::OPEN,
        )
        .unwrap();

    // The same code on the same numbers: to the last bit.
    let nav = other.nav();
    assert_eq!(n, other.states());
    assert_eq!(
        (state.time, state.latitude, state.longitude, state.height),
        (
            nav.time,
            nav.position.lat,
            nav.position.lon,
            nav.position.height
        )
    );
    assert_eq!(Vector3::from(state.velocity), nav.v_n);
    assert_eq!(
        Vector3::from(state.roll_pitch_yaw),
        attitude::to_rpy(&nav.q_nb)
    );
    assert_eq!(state.gyro_error, other.sensor_error()[..3]);
    assert_eq!(state.accel_error_std, other.sensor_error_std()[3..]);
    for i in 0..n {
        for j in 0..n {
            assert_eq!(covariance[i * n + j], other.covariance()[(i, j)]);
        }
    }
}

#[test]
fn a_model_survives_the_way_through_c() {
    assert_eq!(made().shaping(), Ok(model()));
    let mut bad = made();
    bad.q[0][1] += 1e-6;
    assert_eq!(bad.shaping(), Err(Status::BadSensor));
    let mut bad = made();
    bad.p0[0][0] = -1e-6;
    assert_eq!(bad.shaping(), Err(Status::BadSensor));
    let mut bad = made();
    bad.order = 7;
    assert_eq!(bad.shaping(), Err(Status::TooManyStates));
    // What lies beyond the order counts for nothing.
    let mut more = made();
    more.f[5][5] = f64::NAN;
    assert_eq!(more.shaping(), Ok(model()));
}

#[test]
fn every_status_has_a_text_of_its_own() {
    let text = |status: i32| {
        // SAFETY: it ends with zero and lives as long as the program.
        unsafe { core::ffi::CStr::from_ptr(undrift_error_text(status)) }
    };
    let last = Status::NoEvent as i32;
    for status in 0..=last {
        assert!((status + 1..=last + 1).all(|other| text(other) != text(status)));
    }
    assert_eq!(text(-1), text(last + 1));
}
