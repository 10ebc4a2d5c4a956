//! The navigator: alignment, gates, faults and late fixes around the filter, in memory of the caller's allocator.

use crate::{
    allocator,
    memory::{check_tag, finite, not_negative, read, write},
    status::{Status, call},
    types::{Position, Prior, Sample, Sensor, State, UNDRIFT_AXES, Velocity},
};
use alloc::{boxed::Box, collections::VecDeque};
use undrift_engine::{
    Event, Measurement, Navigator as Inner, Part, PushError, Scalar, ScalarLog,
    align::{AlignSettings, Heading},
    settings::{Settings, fix_errors::FromFixes, magnetometer::Magnetometer},
    vehicle::{Air, Constraints, Profile},
};
use undrift_nav::{
    Vector3,
    earth::Geodetic,
    mechanisation::NavState,
    sample::{FixQuality, GnssFix, ImuSample, MagneticField, Position as Place},
};

/// What the vehicle is: what it cannot do constrains the solution.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Vehicle {
    /// Nothing is known of it.
    None = 0,
    /// A wheeled vehicle on a road: no side slip, at rest at times.
    Car = 1,
    /// An aircraft: it keeps its velocity through the air, and is at rest on the ground.
    Aircraft = 2,
    /// A person on foot.
    Pedestrian = 3,
    /// A copter: the drag of its rotors shows its velocity through the air.
    Copter = 4,
}

/// How a navigator works; undrift_navigator_defaults() sets the defaults of `undrift navigate`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct NavigatorSettings {
    /// By how much a measurement may come late \[s\]; its memory is some 60 kB for each fifth of a second.
    pub horizon: f64,
    /// IMU to antenna, body axes \[m\].
    pub lever_arm: [f64; 3],
    /// An undrift_vehicle.
    pub vehicle: i32,
    /// First heading from north to east \[rad\], where its standard deviation is above 0.
    pub heading: f64,
    /// Standard deviation of the heading \[rad\]; 0: the heading comes from the course over ground.
    pub heading_std: f64,
    /// Not 0: the IMU sits in the vehicle in an unknown way, which is to be found.
    pub find_mounting: i32,
    /// Not 0: the errors of fixes beyond their covariance are learned from the fixes.
    pub learn_fix_errors: i32,
    /// Direction of a second antenna as seen from the first in the body, from forward to right \[rad\]; how well it is known is the prior
    /// UNDRIFT_PARAMETER_HEADING_OFFSET.
    pub heading_baseline: f64,
    /// Standard deviation of errors of a magnetometer that last for some seconds \[T\]; its hard iron is the prior
    /// UNDRIFT_PARAMETER_HARD_IRON.
    pub magnetometer_lasting: f64,
    /// Year with its fraction, for the Earth's magnetic field; 0: about now.
    pub year: f64,
    /// Factors on the noise that vibration adds, gyro and accelerometer x, y, z; all 0: the noise is the model's throughout.
    pub vibration: [f64; UNDRIFT_AXES],
}

/// What happened.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EventKind {
    /// Navigation began; `value` is the standard deviation of the heading \[rad\].
    Started = 0,
    /// Samples of an axis could not be right and were replaced; `value` is the axis, 0 to 5.
    SampleFault = 1,
    /// Positions were rejected; `value` is the distance of the first \[m\].
    PositionRejected = 2,
    /// Velocities were rejected; `value` is the distance of the first [m/s].
    VelocityRejected = 3,
    /// The solution was reset to fixes that contradicted it; `value` is by what its position was inflated \[m\].
    AcceptedInTheEnd = 4,
    /// The course over ground contradicts the heading; `value` is by how much \[rad\].
    HeadingOff = 5,
    /// Innovations were biased to one side for a while.
    OneSided = 6,
    /// The solution ended and is aligned again.
    AlignsAgain = 7,
    /// What the fixes have shown of their errors is used; `value` is the factor on the standard deviation of positions.
    FixErrors = 8,
    /// The mounting was found: body axes are the vehicle's from here on.
    Mounting = 9,
    /// Another solution began.
    Resumed = 10,
    /// The solution diverged.
    Diverged = 11,
    /// A measurement came later than the horizon and is not used.
    TooLate = 12,
    /// Headings by two antennas were rejected; `value` is what the last of them was off by \[rad\].
    HeadingsRejected = 13,
    /// The magnetic field was disturbed and not used; `value` is what it was off by at most \[T\].
    FieldDisturbed = 14,
}

/// An event of the navigation.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct NavigatorEvent {
    /// When it began or happened \[s\].
    pub time: f64,
    /// What it is.
    pub kind: EventKind,
    /// See the kinds; 0 where they say nothing.
    pub value: f64,
}

/// Distinguishes a navigator from other memory.
const TAG: u64 = 0x756e_6176_6967_6101;

/// A navigator. Opaque; its memory is that of the allocator.
pub struct Navigator {
    tag: u64,
    inner: Inner,
    events: VecDeque<NavigatorEvent>,
}

/// Events that wait at most; the oldest go.
const MOST_EVENTS: usize = 256;

/// The navigator at `at`.
///
/// # Safety
/// `at` is null or points to memory of a navigator's size that nobody else uses for `'a`.
unsafe fn navigator_mut<'a>(at: *mut Navigator) -> Result<&'a mut Navigator, Status> {
    // SAFETY: passed on; the tag is within the navigator.
    unsafe { check_tag(at, |at| &raw const (*at).tag, TAG) }?;
    // SAFETY: a navigator, by its tag.
    Ok(unsafe { &mut *at })
}

impl From<PushError> for Status {
    fn from(error: PushError) -> Self {
        match error {
            PushError::NotFinite { .. } => Self::NotFinite,
            PushError::NotInOrder { .. } => Self::OutOfRange,
            PushError::Filter(error) => error.into(),
        }
    }
}

/// Sets the defaults: measurements up to 2 s late, antenna at the IMU, no vehicle, heading from the course, errors of the
/// fixes learned from them, noise that follows the vibration.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_navigator_defaults(settings: *mut NavigatorSettings) -> Status {
    let defaults = NavigatorSettings {
        horizon: 2.0,
        lever_arm: [0.0; 3],
        vehicle: Vehicle::None as i32,
        heading: 0.0,
        heading_std: 0.0,
        heading_baseline: 0.0,
        magnetometer_lasting: Magnetometer::default().lasting,
        year: 0.0,
        find_mounting: 0,
        learn_fix_errors: 1,
        vibration: [1.0; UNDRIFT_AXES],
    };
    // SAFETY: null or settings.
    call(|| unsafe { write(settings, defaults) })
}

/// Makes a navigator without data and sets `navigator` to it. `sensors` are UNDRIFT_AXES models at one interval, `parameters`
/// UNDRIFT_PARAMETERS priors of constants to estimate, or null for none. UNDRIFT_STATUS_NO_ALLOCATOR before undrift_set_allocator().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_navigator_new(
    settings: *const NavigatorSettings,
    sensors: *const Sensor,
    parameters: *const Prior,
    navigator: *mut *mut Navigator,
) -> Status {
    call(|| {
        // SAFETY: null or a pointer's place.
        unsafe { write(navigator, core::ptr::null_mut()) }?;
        if !allocator::is_set() {
            return Err(Status::NoAllocator);
        }
        // SAFETY: null or settings.
        let settings = unsafe { read(settings) }?;
        // SAFETY: null or as many as there are.
        let (sensors, parameters) = unsafe {
            (
                crate::filter::sensors(sensors)?,
                crate::filter::parameters(parameters)?,
            )
        };
        let horizon = settings.horizon;
        let mut made = engine_settings(&settings, sensors)?;
        made.parameters = match &made.constraints.air {
            Some(air) => air.with_states(parameters, Some(Air::WIND.std)),
            None => parameters,
        };
        let made = Box::new(Navigator {
            tag: TAG,
            inner: Inner::new(made).with_horizon(horizon),
            events: VecDeque::new(),
        });
        allocator::count(1);
        // SAFETY: as above.
        unsafe { write(navigator, Box::into_raw(made)) }
    })
}

/// The settings without parameters.
fn engine_settings(
    settings: &NavigatorSettings,
    sensors: [undrift_nav::shaping::ShapingFilter; UNDRIFT_AXES],
) -> Result<Settings, Status> {
    let numbers = [
        &settings.heading,
        &settings.heading_baseline,
        &settings.year,
    ];
    finite(settings.lever_arm.iter().chain(numbers))?;
    not_negative(
        settings
            .vibration
            .iter()
            .chain([&settings.horizon, &settings.heading_std])
            .chain([&settings.magnetometer_lasting]),
    )?;
    let vehicle = usize::try_from(settings.vehicle).ok();
    let profile = vehicle.and_then(|number| Profile::ALL.get(number));
    let profile = profile.ok_or(Status::OutOfRange)?;
    let heading = match settings.heading_std > 0.0 {
        true => Heading::Given(settings.heading, settings.heading_std),
        false => Heading::Course,
    };
    let follows = settings.vibration.iter().any(|factor| *factor > 0.0);
    Ok(Settings {
        lever_arm: settings.lever_arm.into(),
        constraints: Constraints {
            heading_baseline: settings.heading_baseline,
            ..profile.constraints()
        },
        align: AlignSettings {
            heading,
            ..AlignSettings::default()
        },
        magnetometer: Magnetometer {
            lasting: settings.magnetometer_lasting,
            year: Some(settings.year).filter(|year| *year != 0.0),
        },
        find_mounting: settings.find_mounting != 0,
        from_fixes: (settings.learn_fix_errors != 0).then(FromFixes::default),
        vibration: follows.then_some(settings.vibration),
        ..Settings::new(sensors)
    })
}

/// Gives a navigator's memory back to the allocator; null is nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_navigator_free(navigator: *mut Navigator) {
    // SAFETY: null or a navigator that nobody else uses.
    if let Ok(at) = unsafe { navigator_mut(navigator) } {
        at.tag = 0;
        // SAFETY: it was made by `Box::into_raw`, and its tag shows that it was not freed.
        drop(unsafe { Box::from_raw(navigator) });
        allocator::count(usize::MAX);
    }
}

/// Pushes a sample, in order of time. The solution goes to the end of the sample before it: only the next shows whether one can
/// be right. UNDRIFT_STATUS_OUT_OF_RANGE for a time that does not go on or a length that is not above 0, the navigator
/// unchanged.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_navigator_imu(
    navigator: *mut Navigator,
    sample: *const Sample,
) -> Status {
    call(|| {
        // SAFETY: null or a navigator that nobody else uses.
        let navigator = unsafe { navigator_mut(navigator) }?;
        // SAFETY: null or a sample.
        let sample = unsafe { read(sample) }?;
        if sample.dt <= 0.0 {
            return Err(Status::OutOfRange);
        }
        Ok(navigator.inner.imu(ImuSample {
            time: sample.time,
            dt: sample.dt,
            dtheta: Vector3::from(sample.dtheta),
            dvel: Vector3::from(sample.dvel),
        })?)
    })
}

/// Pushes a fix of the antenna at `time` \[s\] on the clock of the samples, early or late: its position and its velocity, null for
/// what it lacks. UNDRIFT_STATUS_TOO_LATE, and nothing is used, where it came later than the horizon.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_navigator_fix(
    navigator: *mut Navigator,
    time: f64,
    position: *const Position,
    velocity: *const Velocity,
) -> Status {
    call(|| {
        // SAFETY: null or a navigator that nobody else uses.
        let navigator = unsafe { navigator_mut(navigator) }?;
        // SAFETY: each null or what it is called.
        let (position, velocity) = unsafe { (read(position).ok(), read(velocity).ok()) };
        let covariances = [
            position.map(|p| p.covariance),
            velocity.map(|v| v.covariance),
        ];
        for covariance in covariances.into_iter().flatten() {
            finite(covariance.iter().flatten())?;
            if !crate::update::is_positive(&covariance) {
                return Err(Status::BadMeasurement);
            }
        }
        let position = position.map(|at| {
            let place = Place::Geodetic(Geodetic {
                lat: at.latitude,
                lon: at.longitude,
                height: at.height,
            });
            (place, at.covariance.into())
        });
        let velocity = velocity.map(|v| (v.velocity.into(), v.covariance.into()));
        let in_time = navigator.inner.fix(GnssFix {
            attitude: None,
            mean_velocity: None,
            time,
            position,
            velocity,
            quality: FixQuality::Unknown,
        })?;
        in_time.then_some(()).ok_or(Status::TooLate)
    })
}

/// Pushes a measurement of one number, an undrift_scalar_kind, with its standard deviation, in the manner of undrift_navigator_fix().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_navigator_scalar(
    navigator: *mut Navigator,
    kind: i32,
    time: f64,
    value: f64,
    std: f64,
) -> Status {
    call(|| {
        // SAFETY: null or a navigator that nobody else uses.
        let navigator = unsafe { navigator_mut(navigator) }?;
        let kind = usize::try_from(kind).ok();
        let kind = kind.and_then(|number| ScalarLog::ALL.get(number));
        let kind = kind.ok_or(Status::OutOfRange)?;
        finite([&std])?;
        if std <= 0.0 {
            return Err(Status::OutOfRange);
        }
        let measurement = Measurement::of(*kind, Scalar { time, value, std });
        let in_time = navigator.inner.measure(measurement)?;
        in_time.then_some(()).ok_or(Status::TooLate)
    })
}

/// Pushes a magnetic field, three numbers in body axes \[T\], with the standard deviation of its white noise, in the manner of
/// undrift_navigator_fix().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_navigator_magnetometer(
    navigator: *mut Navigator,
    time: f64,
    field: *const f64,
    std: f64,
) -> Status {
    call(|| {
        // SAFETY: null or a navigator that nobody else uses.
        let navigator = unsafe { navigator_mut(navigator) }?;
        // SAFETY: null or three numbers.
        let field = unsafe { read(field.cast::<[f64; 3]>()) }?;
        finite([&std])?;
        if std <= 0.0 {
            return Err(Status::OutOfRange);
        }
        let field = field.into();
        let in_time = navigator
            .inner
            .magnetometer(MagneticField { time, field, std })?;
        in_time.then_some(()).ok_or(Status::TooLate)
    })
}

/// The solution, its attitude that of the vehicle's axes where the mounting is estimated. UNDRIFT_STATUS_NOT_ALIGNED, and nothing is
/// written, before the alignment and between a restart and the next one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_navigator_state(
    navigator: *mut Navigator,
    state: *mut State,
) -> Status {
    call(|| {
        // SAFETY: null or a navigator that nobody else uses.
        let navigator = unsafe { navigator_mut(navigator) }?;
        let filter = navigator.inner.filter().ok_or(Status::NotAligned)?;
        let (q_nv, attitude_std) = filter.vehicle_attitude();
        let [n, e, d, vn, ve, vd, ..] = filter.nav_std();
        let [north, east, down] = attitude_std;
        let nav = NavState {
            q_nb: q_nv,
            ..*filter.nav()
        };
        let solution = crate::read::solution(
            &nav,
            &filter.omega_nb_b(),
            [n, e, d, vn, ve, vd, north, east, down],
            [filter.sensor_error(), filter.sensor_error_std()],
        );
        // SAFETY: null or a state's.
        unsafe { write(state, solution) }
    })
}

/// The next event; an event that lasts comes at its start. UNDRIFT_STATUS_NO_EVENT where none is left.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn undrift_navigator_event(
    navigator: *mut Navigator,
    event: *mut NavigatorEvent,
) -> Status {
    call(|| {
        // SAFETY: null or a navigator that nobody else uses.
        let navigator = unsafe { navigator_mut(navigator) }?;
        if event.is_null() {
            return Err(Status::NullPointer);
        }
        if navigator.events.is_empty() {
            let new = navigator.inner.events();
            navigator.events.extend(new.iter().map(plain));
            while navigator.events.len() > MOST_EVENTS {
                navigator.events.pop_front();
            }
        }
        let next = navigator.events.pop_front().ok_or(Status::NoEvent)?;
        // SAFETY: not null, so it points to an event.
        unsafe { write(event, next) }
    })
}

/// An event as C sees it.
fn plain(event: &Event) -> NavigatorEvent {
    let (kind, value) = match event {
        Event::Started(_, alignment) => (EventKind::Started, alignment.heading_std),
        Event::SampleFault(fault) => (EventKind::SampleFault, fault.axis as f64),
        Event::Rejected(fixes) => match fixes.part {
            Part::Position => (EventKind::PositionRejected, fixes.first),
            Part::Velocity => (EventKind::VelocityRejected, fixes.first),
        },
        Event::Doubted(doubt) => (EventKind::AcceptedInTheEnd, doubt.position),
        Event::HeadingOff(off) => (EventKind::HeadingOff, off.angle),
        Event::HeadingsRejected(headings) => (EventKind::HeadingsRejected, headings.angle),
        Event::FieldDisturbed(field) => (EventKind::FieldDisturbed, field.strongest),
        Event::Leant(_) => (EventKind::OneSided, 0.0),
        Event::AlignsAgain(..) => (EventKind::AlignsAgain, 0.0),
        Event::FixErrors(_, errors) => (EventKind::FixErrors, errors.position_factor),
        Event::Mounting(..) => (EventKind::Mounting, 0.0),
        Event::Resumed(_) => (EventKind::Resumed, 0.0),
        Event::Diverged(_) => (EventKind::Diverged, 0.0),
        Event::TooLate(_) => (EventKind::TooLate, 0.0),
    };
    NavigatorEvent {
        time: event.time(),
        kind,
        value,
    }
}

#[cfg(test)]
mod tests;
