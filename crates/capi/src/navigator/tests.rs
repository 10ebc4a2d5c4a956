//! The functions of the navigator against the navigator that they stand for.

use super::*;
use crate::{
    allocator::{Allocator, Callers, undrift_set_allocator},
    types::ScalarKind,
};
use core::{
    alloc::{GlobalAlloc, Layout},
    ffi::c_void,
    mem::MaybeUninit,
    ptr::{null, null_mut},
    sync::atomic::{AtomicUsize, Ordering},
};
use undrift_nav::shaping::ShapingFilter;
use undrift_simulate::{GnssNoise, Trajectory, simulate};

const T: f64 = 0.02;

/// Bytes that are given out: the context of the allocator.
static GIVEN: AtomicUsize = AtomicUsize::new(0);

unsafe extern "C" fn allocate(context: *mut c_void, size: usize, align: usize) -> *mut c_void {
    let given = context.cast::<AtomicUsize>();
    // SAFETY: it points to a number that lives as long as the program; the size is not 0.
    unsafe {
        (*given).fetch_add(size, Ordering::Relaxed);
        std::alloc::alloc(Layout::from_size_align_unchecked(size, align.max(16))).cast()
    }
}

unsafe extern "C" fn release(context: *mut c_void, memory: *mut c_void, size: usize) {
    let given = context.cast::<AtomicUsize>();
    // SAFETY: as above, and the memory is of that size; no test asks for more than 16 bytes of alignment.
    unsafe {
        (*given).fetch_sub(size, Ordering::Relaxed);
        std::alloc::dealloc(memory.cast(), Layout::from_size_align_unchecked(size, 16));
    }
}

struct Shared(Allocator);
// SAFETY: its context is a number that threads may share.
unsafe impl Sync for Shared {}

static ALLOCATOR: Shared = Shared(Allocator {
    context: (&raw const GIVEN).cast_mut().cast(),
    allocate: Some(allocate),
    release: Some(release),
});

fn sensors() -> [ShapingFilter; UNDRIFT_AXES] {
    let made = |white, constant| {
        let constant = ShapingFilter::constant(constant, T).unwrap();
        ShapingFilter::white(white, T).unwrap().plus(&constant)
    };
    let (gyro, accel) = (made(1e-4, 1e-3).unwrap(), made(1e-3, 0.02).unwrap());
    [gyro, gyro, gyro, accel, accel, accel]
}

fn settings() -> NavigatorSettings {
    let mut settings = MaybeUninit::uninit();
    // SAFETY: memory for settings.
    unsafe {
        let status = undrift_navigator_defaults(settings.as_mut_ptr());
        assert_eq!(status, Status::Ok);
        settings.assume_init()
    }
}

fn made(settings: &NavigatorSettings) -> *mut Navigator {
    let (sensors, mut navigator) = (sensors().map(Sensor::from), null_mut());
    // SAFETY: each is what it is called.
    let status = unsafe {
        let _ = undrift_set_allocator(&raw const ALLOCATOR.0);
        undrift_navigator_new(settings, sensors.as_ptr(), null(), &raw mut navigator)
    };
    assert_eq!(status, Status::Ok);
    navigator
}

fn plain_sample(sample: &ImuSample) -> Sample {
    Sample {
        time: sample.time,
        dt: sample.dt,
        dtheta: sample.dtheta.into(),
        dvel: sample.dvel.into(),
    }
}

/// Fixes 0.7 s late, one of them 3 s: the state is that of the engine to the last bit, and the events are.
#[test]
fn it_is_the_navigator_of_the_engine() {
    let sensors = sensors();
    let log = simulate(
        &Trajectory::car(120.0, 1),
        1.0 / T,
        Some(&sensors),
        &GnssNoise::default(),
        1,
    )
    .unwrap();
    let settings = NavigatorSettings {
        lever_arm: [0.1, 0.2, -1.0],
        vehicle: Vehicle::Car as i32,
        ..settings()
    };
    let navigator = made(&settings);
    let mut inner = Inner::new(engine_settings(&settings, sensors).unwrap()).with_horizon(2.0);
    let late = |k: usize| if k == 100 { 3.0 } else { 0.7 };
    let mut coming: std::vec::Vec<_> = log.gnss.iter().enumerate().collect();
    coming.sort_by(|a, b| (a.1.time + late(a.0)).total_cmp(&(b.1.time + late(b.0))));
    let (mut coming, mut too_late) = (coming.into_iter().peekable(), 0);
    for sample in &log.imu {
        inner.imu(*sample).unwrap();
        // SAFETY: a navigator and what is pushed, here and below.
        let status = unsafe { undrift_navigator_imu(navigator, &plain_sample(sample)) };
        assert_eq!(status, Status::Ok);
        while let Some((_, fix)) = coming.next_if(|(k, fix)| fix.time + late(*k) <= sample.time) {
            let in_time = inner.fix(*fix).unwrap();
            let (Place::Geodetic(at), covariance) = fix.position.unwrap() else {
                panic!("of a simulation");
            };
            let position = Position {
                latitude: at.lat,
                longitude: at.lon,
                height: at.height,
                covariance: covariance.into(),
            };
            let velocity = fix.velocity.map(|(v, r)| Velocity {
                velocity: v.into(),
                covariance: r.into(),
            });
            let velocity = velocity.as_ref().map_or(null(), core::ptr::from_ref);
            // SAFETY: as above.
            let status = unsafe { undrift_navigator_fix(navigator, fix.time, &position, velocity) };
            assert_eq!(status == Status::Ok, in_time, "{}", fix.time);
            too_late += usize::from(status == Status::TooLate);
        }
    }
    assert_eq!(too_late, 1);
    let mut state = MaybeUninit::<State>::uninit();
    // SAFETY: a navigator, and memory for a state that is written.
    let state = unsafe {
        let status = undrift_navigator_state(navigator, state.as_mut_ptr());
        assert_eq!(status, Status::Ok);
        state.assume_init()
    };
    let filter = inner.filter().unwrap();
    let place = filter.nav().position;
    assert_eq!(
        [state.latitude, state.longitude, state.height],
        [place.lat, place.lon, place.height]
    );
    assert_eq!(state.position_std, filter.nav_std()[..3]);
    assert_eq!(state.gyro_error, filter.sensor_error()[..3]);
    let mut events = std::vec::Vec::new();
    let mut event = MaybeUninit::<NavigatorEvent>::uninit();
    loop {
        // SAFETY: a navigator and memory for an event, which is written where the status is well.
        unsafe {
            if undrift_navigator_event(navigator, event.as_mut_ptr()) != Status::Ok {
                break;
            }
            events.push(event.assume_init());
        }
    }
    let expected: std::vec::Vec<_> = inner.events().iter().map(Event::time).collect();
    let times: std::vec::Vec<_> = events.iter().map(|event| event.time).collect();
    assert_eq!(times, expected);
    let kinds = [EventKind::Started, EventKind::TooLate];
    assert!(
        kinds
            .iter()
            .all(|kind| events.iter().any(|event| event.kind == *kind))
    );
    // SAFETY: a navigator.
    unsafe { undrift_navigator_free(navigator) };
}

#[test]
fn what_is_wrong_has_a_status() {
    let navigator = made(&settings());
    let still = Sample {
        time: 1.0,
        dt: T,
        dtheta: [0.0; 3],
        dvel: [0.0, 0.0, -9.81 * T],
    };
    let mut state = MaybeUninit::<State>::uninit();
    let mut event = MaybeUninit::<NavigatorEvent>::uninit();
    // SAFETY: each is null or what it is called.
    unsafe {
        let status = undrift_set_allocator(&raw const ALLOCATOR.0);
        assert_eq!(status, Status::InUse);
        assert_eq!(undrift_set_allocator(null()), Status::NullPointer);
        assert_eq!(
            undrift_navigator_imu(null_mut(), &still),
            Status::NullPointer
        );
        assert_eq!(
            undrift_navigator_imu(navigator, null()),
            Status::NullPointer
        );
        assert_eq!(undrift_navigator_imu(navigator, &still), Status::Ok);
        assert_eq!(undrift_navigator_imu(navigator, &still), Status::OutOfRange);
        let endless = Sample {
            time: f64::NAN,
            ..still
        };
        assert_eq!(
            undrift_navigator_imu(navigator, &endless),
            Status::NotFinite
        );
        let none = Sample { dt: 0.0, ..still };
        assert_eq!(undrift_navigator_imu(navigator, &none), Status::OutOfRange);
        let status = undrift_navigator_state(navigator, state.as_mut_ptr());
        assert_eq!(status, Status::NotAligned);
        let status = undrift_navigator_event(navigator, event.as_mut_ptr());
        assert_eq!(status, Status::NoEvent);
        let fix = Position {
            latitude: 0.5,
            longitude: 2.0,
            height: 10.0,
            covariance: [[1.0, 2.0, 0.0], [2.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        };
        let status = undrift_navigator_fix(navigator, 1.0, &fix, null());
        assert_eq!(status, Status::BadMeasurement);
        let scalar = |kind: i32, std| undrift_navigator_scalar(navigator, kind, 1.0, 3.0, std);
        let kinds = [
            ScalarKind::Odometer,
            ScalarKind::Barometer,
            ScalarKind::Heading,
        ];
        let kinds = kinds.map(|kind| kind as i32);
        assert_eq!(scalar(kinds[0], 0.0), Status::OutOfRange);
        assert_eq!(scalar(kinds[2] + 1, 1.0), Status::OutOfRange);
        assert_eq!(kinds.map(|kind| scalar(kind, 1.0)), [Status::Ok; 3]);
        // The numbers are those of the engine.
        let names = kinds.map(|kind| ScalarLog::ALL[kind as usize].name());
        assert_eq!(names, ["odometer", "barometer", "heading"]);
        let mut other = navigator;
        let sensors = self::sensors().map(Sensor::from);
        let wrong = NavigatorSettings {
            vehicle: 5,
            ..settings()
        };
        let status = undrift_navigator_new(&wrong, sensors.as_ptr(), null(), &raw mut other);
        assert_eq!((status, other.is_null()), (Status::OutOfRange, true));
        undrift_navigator_free(navigator);
        undrift_navigator_free(null_mut());
    }
}

#[test]
fn memory_is_asked_for_at_the_callers_allocator() {
    let layout = Layout::from_size_align(1000, 16).unwrap();
    // SAFETY: an allocator that stays, and memory that is given back as it was given.
    unsafe {
        let _ = undrift_set_allocator(&raw const ALLOCATOR.0);
        let before = GIVEN.load(Ordering::Relaxed);
        let memory = Callers.alloc(layout);
        assert!(!memory.is_null() && GIVEN.load(Ordering::Relaxed) >= before + 1000);
        memory.write_bytes(7, 1000);
        Callers.dealloc(memory, layout);
        assert_eq!(GIVEN.load(Ordering::Relaxed), before);
    }
}
