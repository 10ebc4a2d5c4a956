//! A filter's memory, its start and its steps.

use crate::{
    capacity::{Inner, STATES},
    memory::{check_tag, finite, not_negative, numbers, read, write},
    status::{Status, call},
    types::{Prior, Sample, Sensor, Start, UNDRIFT_AXES, UNDRIFT_PARAMETERS},
};
use undrift_nav::{
    Vector3, attitude,
    covariance::AXES,
    earth::Geodetic,
    filter::InitialStd,
    mechanisation::NavState,
    parameters::{self, Parameter, Parameters},
    sample::ImuSample,
    shaping::ShapingFilter,
};

/// Bytes of a filter beside its covariance and estimates, at most; see UNDRIFT_FILTER_BYTES.
pub const UNDRIFT_FILTER_OVERHEAD: usize = 7680;

const _: () = assert!(UNDRIFT_AXES == AXES);
// The last kinds, of poses, of the air and of the correlated parts of a fix's errors, need more of a fix than is given here.
const _: () = assert!(UNDRIFT_PARAMETERS + 8 == Parameter::ALL.len());
const _: () =
    assert!(size_of::<Filter>() <= 8 * (STATES * STATES + STATES) + UNDRIFT_FILTER_OVERHEAD);

/// Distinguishes a filter from other memory.
const TAG: u64 = 0x7566_696c_7465_7201;

/// An error-state filter. Opaque; its memory is provided by the caller.
pub struct Filter {
    tag: u64,
    inner: Inner,
}

/// Checks that `at` could be a filter's memory that was initialised.
///
/// # Safety
/// `at` is null or points to memory of a filter's size.
unsafe fn check(at: *const Filter) -> Result<(), Status> {
    // SAFETY: passed on; the tag is within the filter.
    unsafe { check_tag(at, |at| &raw const (*at).tag, TAG) }
}

/// The filter at `at`, to read.
///
/// # Safety
/// As [`check`]; nobody changes it for `'a`.
pub(crate) unsafe fn filter_ref<'a>(at: *const Filter) -> Result<&'a Inner, Status> {
    // SAFETY: passed on.
    unsafe { check(at) }?;
    // SAFETY: the tag is written only once all else is.
    Ok(unsafe { &(*at).inner })
}

/// The filter at `at`, to change.
///
/// # Safety
/// As [`check`]; nobody else uses it for `'a`.
pub(crate) unsafe fn filter_mut<'a>(at: *mut Filter) -> Result<&'a mut Inner, Status> {
    // SAFETY: passed on.
    unsafe { check(at) }?;
    // SAFETY: the tag is written only once all else is.
    Ok(unsafe { &mut (*at).inner })
}

/// Most states a filter of this library holds.
#[unsafe(no_mangle)]
pub extern "C" fn undrift_max_states() -> usize {
    STATES
}

/// Bytes of a filter.
#[unsafe(no_mangle)]
pub extern "C" fn undrift_filter_size() -> usize {
    size_of::<Filter>()
}

/// Of which number of bytes a filter's address must be a multiple.
#[unsafe(no_mangle)]
pub extern "C" fn undrift_filter_align() -> usize {
    align_of::<Filter>()
}

/// Makes a filter in `memory` of `length` bytes, at least undrift_filter_size(), and sets `filter` to it.
/// `sensors` are UNDRIFT_AXES models at one interval: gyro x, y, z [rad/s], accelerometer x, y, z [m/s^2].
/// `parameters` are UNDRIFT_PARAMETERS priors, or null for none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_filter_init(
    memory: *mut core::ffi::c_void,
    length: usize,
    start: *const Start,
    sensors: *const Sensor,
    parameters: *const Prior,
    filter: *mut *mut Filter,
) -> Status {
    let place: *mut Filter = memory.cast();
    let make = || {
        if place.is_null() || filter.is_null() {
            return Err(Status::NullPointer);
        }
        if length < size_of::<Filter>() {
            return Err(Status::TooSmall);
        }
        if !place.is_aligned() {
            return Err(Status::Misaligned);
        }
        // SAFETY: aligned memory of a filter's size. Until all is well there is no filter.
        unsafe { (&raw mut (*place).tag).write(0) };
        // SAFETY: start is null or a start, and so on.
        let inner = unsafe { begin(start, sensors, parameters) }?;
        // SAFETY: as above; what was there before needs no dropping.
        unsafe { place.write(Filter { tag: TAG, inner }) };
        // SAFETY: not null, so it points to a pointer.
        unsafe { write(filter, place) }
    };
    let status = call(make);
    if status != Status::Ok {
        // SAFETY: null or a pointer; if it is null the status says so already.
        let _ = unsafe { write(filter, core::ptr::null_mut()) };
    }
    status
}

/// # Safety
/// Each is null or points to what [`undrift_filter_init`] says.
unsafe fn begin(
    start: *const Start,
    sensors: *const Sensor,
    parameters: *const Prior,
) -> Result<Inner, Status> {
    // SAFETY: null or a start.
    let start = unsafe { read(start) }?;
    finite(start.velocity.iter().chain(&start.roll_pitch_yaw))?;
    finite([
        &start.time,
        &start.latitude,
        &start.longitude,
        &start.height,
    ])?;
    not_negative(
        (start.position_std.iter())
            .chain(&start.velocity_std)
            .chain(&start.attitude_std),
    )?;
    let nav = NavState {
        time: start.time,
        position: Geodetic {
            lat: start.latitude,
            lon: start.longitude,
            height: start.height,
        },
        v_n: start.velocity.into(),
        q_nb: attitude::from_rpy(&start.roll_pitch_yaw.into()),
    };
    if !nav.is_valid() {
        return Err(Status::OutOfRange);
    }
    let std = InitialStd {
        position: start.position_std.into(),
        velocity: start.velocity_std.into(),
        attitude: start.attitude_std.into(),
    };
    // SAFETY: passed on.
    let (axes, estimated) = unsafe { (self::sensors(sensors)?, self::parameters(parameters)?) };
    Ok(Inner::new(nav, &std, axes, estimated)?)
}

/// The models of all axes, at one interval.
///
/// # Safety
/// `sensors` is null or points to as many as there are axes.
pub(crate) unsafe fn sensors(sensors: *const Sensor) -> Result<[ShapingFilter; AXES], Status> {
    let mut axes = [ShapingFilter::none(1.0)?; AXES];
    for (axis, slot) in axes.iter_mut().enumerate() {
        if sensors.is_null() {
            return Err(Status::NullPointer);
        }
        // SAFETY: there are as many sensors as axes.
        *slot = unsafe { read(sensors.add(axis)) }?.shaping()?;
    }
    if axes.iter().any(|axis| axis.interval != axes[0].interval) {
        return Err(Status::IntervalsDiffer);
    }
    Ok(axes)
}

/// The parameters to estimate.
///
/// # Safety
/// `priors` is null, for none, or points to UNDRIFT_PARAMETERS priors.
pub(crate) unsafe fn parameters(priors: *const Prior) -> Result<Parameters, Status> {
    let mut estimated = Parameters::none();
    for (i, kind) in Parameter::ALL[..UNDRIFT_PARAMETERS].iter().enumerate() {
        if priors.is_null() {
            break;
        }
        // SAFETY: there are as many priors as parameters.
        let Prior { std, walk, time } = unsafe { read(priors.add(i)) }?;
        not_negative([&std, &walk, &time])?;
        if std > 0.0 {
            estimated = estimated.with(*kind, parameters::Prior { std, walk, time });
        }
    }
    Ok(estimated)
}

/// Sets the estimated errors of gyro x, y, z [rad/s] and accelerometer x, y, z [m/s^2], UNDRIFT_AXES
/// numbers: what a rest before the start has shown. How uncertain they are stays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_set_sensor_error(
    filter: *mut Filter,
    error: *const f64,
) -> Status {
    call(|| {
        // SAFETY: null or a filter that nobody else uses.
        let filter = unsafe { filter_mut(filter) }?;
        // SAFETY: null or as many numbers as axes.
        let error = unsafe { numbers::<AXES>(error, AXES) }?;
        finite(&error)?;
        filter.set_sensor_error(&error);
        Ok(())
    })
}

/// Carries the filter over one whole sample. UNDRIFT_STATUS_GAP, the filter unchanged, if the sample does
/// not begin where the one before ended, to half its length: samples were lost, or came twice. One that
/// spans the gap, of up to 10 s, takes the filter across. UNDRIFT_STATUS_OUT_OF_RANGE, the filter unchanged,
/// if it is longer than that, or if no solution would be left after it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_predict(filter: *mut Filter, sample: *const Sample) -> Status {
    // SAFETY: passed on.
    match unsafe { undrift_sample_begin(filter, sample) } {
        // SAFETY: passed on.
        Status::Ok => unsafe { undrift_sample_end(filter) },
        failure => failure,
    }
}

/// Takes up a sample without moving yet, for a fix that lies within it: undrift_sample_advance() to the
/// fix, update, then undrift_sample_end(). What is left of the sample before is done first.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_sample_begin(
    filter: *mut Filter,
    sample: *const Sample,
) -> Status {
    call(|| {
        // SAFETY: null or a filter that nobody else uses.
        let filter = unsafe { filter_mut(filter) }?;
        // SAFETY: null or a sample.
        let sample = unsafe { read(sample) }?;
        let sample = ImuSample {
            time: sample.time,
            dt: sample.dt,
            dtheta: Vector3::from(sample.dtheta),
            dvel: Vector3::from(sample.dvel),
        };
        Ok(filter.begin_step(&sample)?)
    })
}

/// Moves to `time` \[s\] within the sample taken up, not back; a time beyond its end is its end, one within
/// `rounding` \[s\] of it too.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_sample_advance(
    filter: *mut Filter,
    time: f64,
    rounding: f64,
) -> Status {
    call(|| {
        // SAFETY: null or a filter that nobody else uses.
        let filter = unsafe { filter_mut(filter) }?;
        finite([&time])?;
        not_negative([&rounding])?;
        filter.advance_to(time, rounding);
        Ok(filter.check()?)
    })
}

/// Moves to the end of the sample taken up.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_sample_end(filter: *mut Filter) -> Status {
    call(|| {
        // SAFETY: null or a filter that nobody else uses.
        let filter = unsafe { filter_mut(filter) }?;
        filter.advance(1.0);
        Ok(filter.check()?)
    })
}
